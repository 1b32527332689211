/* Neighbouring labels: one pass over the image, then a sort. */
#include "tools/impostor/borders.h"

/* Runs along a row are counted in the pair's low bits. */
#define RUN_BITS 12
#define LABEL_BITS 26

static void add(struct borders *borders, uint32_t a, uint32_t b)
{
	if (!a || !b || a == b)
		return;
	uint64_t low = a < b ? a : b, high = a < b ? b : a;
	uint64_t key = (low << LABEL_BITS | high) << RUN_BITS;
	if (borders->pairs.count) {
		uint64_t *last = &borders->pairs.items[borders->pairs.count - 1];
		if (*last >> RUN_BITS == key >> RUN_BITS && (*last & ((1u << RUN_BITS) - 1)) < (1u << RUN_BITS) - 1) {
			++*last;
			return;
		}
	}
	ARRAY_PUSH(&borders->pairs, key + 1);
}

static int by_value(const void *left, const void *right)
{
	uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
	return (a > b) - (a < b);
}

void borders_find(struct borders *borders, const uint32_t *label, uint32_t width, uint32_t height)
{
	borders->pairs.count = borders->items.count = 0;
	for (uint32_t y = 0; y < height; y++) {
		const uint32_t *row = label + (size_t)y * width;
		for (uint32_t x = 1; x < width; x++)
			add(borders, row[x - 1], row[x]);
		for (uint32_t x = 0; y && x < width; x++)
			add(borders, label[(size_t)(y - 1) * width + x], row[x]);
	}
	ARRAY_SORT(&borders->pairs, by_value);
	const uint64_t *pairs = borders->pairs.items;
	struct border *last = NULL;
	for (size_t i = 0; pairs && i < borders->pairs.count; i++) {
		uint64_t pair = pairs[i] >> RUN_BITS;
		uint32_t run = (uint32_t)(pairs[i] & ((1u << RUN_BITS) - 1));
		uint32_t a = (uint32_t)(pair >> LABEL_BITS), b = (uint32_t)(pair & ((1u << LABEL_BITS) - 1));
		if (last && last->a == a && last->b == b) {
			last->sides += run;
			continue;
		}
		ARRAY_PUSH(&borders->items, (struct border){ a, b, run });
		last = &borders->items.items[borders->items.count - 1];
	}
}

void borders_finish(struct borders *borders)
{
	ARRAY_FINISH(&borders->items);
	ARRAY_FINISH(&borders->pairs);
}
