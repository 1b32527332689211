/* Keys: solid before faded, slice, pass, then the depth's float bits (which order as integers when positive). Least
 * significant digit radix sort: 5 passes of 8 bits over what differs. */
#include "render/draw_list.h"

#include <errno.h>
#include <string.h>

int draw_list_init(struct draw_list *list, struct arena *arena, uint32_t capacity)
{
	*list = (struct draw_list){
		.items = ARENA_ARRAY(arena, struct draw_item, capacity),
		.spare = ARENA_ARRAY(arena, struct draw_item, capacity),
		.capacity = capacity,
	};
	return list->items && list->spare ? 0 : -ENOMEM;
}

void draw_list_clear(struct draw_list *list)
{
	list->count = list->solid_count = 0;
}

void draw_list_add(struct draw_list *list, const struct draw_item *item, float depth_m)
{
	if (!item->count)
		return;
	if (list->count == list->capacity) {
		list->dropped++;
		return;
	}
	uint32_t bits;
	depth_m = depth_m > 0.0f ? depth_m : 0.0f;
	memcpy(&bits, &depth_m, sizeof(bits));
	uint64_t solid = item->opacity == 255;
	struct draw_item *out = &list->items[list->count++];
	*out = *item;
	out->key = (uint64_t)!solid << 34 | (uint64_t)item->slice << 33 | (uint64_t)item->pass << 32 | bits;
}

static void sort_by_byte(const struct draw_item *from, struct draw_item *to, uint32_t count, int shift)
{
	uint32_t start[257] = { 0 };
	for (uint32_t i = 0; i < count; i++)
		start[(from[i].key >> shift & 0xFF) + 1]++;
	for (int i = 0; i < 256; i++)
		start[i + 1] += start[i];
	for (uint32_t i = 0; i < count; i++)
		to[start[from[i].key >> shift & 0xFF]++] = from[i];
}

void draw_list_sort(struct draw_list *list)
{
	for (int shift = 0; shift < 40; shift += 8) {
		sort_by_byte(list->items, list->spare, list->count, shift);
		struct draw_item *sorted = list->spare;
		list->spare = list->items;
		list->items = sorted;
	}
	for (uint32_t i = 0; i < list->count; i++)
		list->solid_count += list->items[i].opacity == 255;
}
