/* A page is 64 rows of 64 bits: trying a place is an AND per row. */
#include "tools/impostor/pack.h"

#include <stdbool.h>

#include "tools/city/pool.h"

struct page {
	uint64_t rows[PACK_BLOCKS];
	uint32_t room; /* blocks not taken */
};

struct by_size {
	uint32_t blocks, shape;
};

static uint32_t blocks_of(const struct pack_shape *shape)
{
	uint32_t sum = 0;
	for (uint32_t y = 0; y < shape->height; y++)
		sum += (uint32_t)__builtin_popcountll(shape->rows[y]);
	return sum;
}

static int larger_first(const void *left, const void *right)
{
	const struct by_size *a = left, *b = right;
	return a->blocks != b->blocks ? (a->blocks < b->blocks) - (a->blocks > b->blocks)
								  : (a->shape > b->shape) - (a->shape < b->shape);
}

static bool fits(const struct page *page, const struct pack_shape *shape, uint32_t x, uint32_t y)
{
	for (uint32_t row = 0; row < shape->height; row++)
		if (page->rows[y + row] & shape->rows[row] << x)
			return false;
	return true;
}

static bool place(struct page *page, struct pack_shape *shape, uint32_t blocks)
{
	if (page->room < blocks)
		return false;
	for (uint32_t y = 0; y + shape->height <= PACK_BLOCKS; y++) {
		for (uint32_t x = 0; x + shape->width <= PACK_BLOCKS; x++) {
			if (!fits(page, shape, x, y))
				continue;
			for (uint32_t row = 0; row < shape->height; row++)
				page->rows[y + row] |= shape->rows[row] << x;
			page->room -= blocks;
			shape->x = x;
			shape->y = y;
			return true;
		}
	}
	return false;
}

uint32_t pack_shapes(struct pack_shape *shapes, size_t count, uint32_t pages_max)
{
	ARRAY(struct by_size) order = { 0 };
	ARRAY(struct page) pages = { 0 };
	bool has_room = true;
	for (uint32_t i = 0; i < count; i++)
		ARRAY_PUSH(&order, (struct by_size){ blocks_of(&shapes[i]), i });
	ARRAY_SORT(&order, larger_first);
	for (size_t i = 0; i < order.count && has_room; i++) {
		struct pack_shape *shape = &shapes[order.items[i].shape];
		shape->page = 0;
		while (shape->page < pages.count && !place(&pages.items[shape->page], shape, order.items[i].blocks))
			shape->page++;
		if (shape->page < pages.count)
			continue;
		has_room = pages.count < pages_max;
		ARRAY_PUSH(&pages, (struct page){ .room = PACK_BLOCKS * PACK_BLOCKS });
		place(&pages.items[pages.count - 1], shape, order.items[i].blocks);
	}
	uint32_t page_count = has_room ? (uint32_t)pages.count : 0;
	ARRAY_FINISH(&order);
	ARRAY_FINISH(&pages);
	return page_count;
}
