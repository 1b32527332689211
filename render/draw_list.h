/*
 * The frame's draws, packed for sorting: solid before faded, nearest slice first, opaque before decals, front to back.
 * Capacity is fixed; what does not fit is dropped and counted.
 */
#ifndef BLVD_RENDER_DRAW_LIST_H
#define BLVD_RENDER_DRAW_LIST_H

#include <stdint.h>

#include "assets/cell_cache.h"
#include "assets/pkg_format.h"
#include "platform/base/arena.h"
#include "render/gfx.h"
#include "render/view.h"

/* Indices on the GPU that are not a chunk's own: a cell's set of triangles. */
struct draw_set {
	gfx_buffer indices, vertices;       /* no vertices: those of the chunks */
	uint32_t first_index, first_vertex; /* of the set, in the buffers */
	const struct cell_set *cells;
};

struct draw_item {
	uint64_t key;
	const struct draw_set *set; /* NULL: the chunk's own indices. Borrowed until the frame has been drawn */
	uint32_t range;             /* of the set */
	uint32_t chunk;
	uint32_t first, count; /* indices, from the chunk's first, or the set's */
	uint8_t slice;         /* enum view_slice_id */
	uint8_t pass;          /* enum pkg_pass */
	uint8_t look;          /* enum city_look */
	uint8_t opacity;       /* 255 solid; less lets see through */
};

struct draw_list {
	struct draw_item *items, *spare; /* `spare` is the sort's other half */
	uint32_t count, capacity;
	uint32_t solid_count; /* after sorting: the first ones */
	uint64_t dropped;     /* since start */
};

/* Returns 0 or -ENOMEM. */
int draw_list_init(struct draw_list *list, struct arena *arena, uint32_t capacity);
void draw_list_clear(struct draw_list *list);
/* Fills in the key; `depth_m` is the distance to sort by, >= 0. Draws of no index are left out. */
void draw_list_add(struct draw_list *list, const struct draw_item *item, float depth_m);
/* Stable, so equal keys keep the order they were added in. */
void draw_list_sort(struct draw_list *list);

#endif
