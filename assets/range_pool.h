/*
 * Ranges of a fixed pool of units: first fit, neighbours joined when freed. Nodes come from a fixed array, so a pool
 * never grows; what finds no place is refused. No GL here.
 */
#ifndef BLVD_ASSETS_RANGE_POOL_H
#define BLVD_ASSETS_RANGE_POOL_H

#include <stdbool.h>
#include <stdint.h>

#include "platform/base/arena.h"

struct range_node {
	uint32_t first, count;
	uint32_t next; /* node, ascending by first; or RANGE_NONE */
};
#define RANGE_NONE UINT32_MAX

struct range_pool {
	struct range_node *nodes; /* free ranges are linked from `free_head`, unused nodes from `spare_head` */
	uint32_t node_count;
	uint32_t free_head, spare_head;
	uint32_t capacity, free_units;
};

/* What range_pool_init() takes from the arena, but for padding. */
uint64_t range_pool_bytes(uint32_t ranges_max);
/* `ranges_max`: most ranges that live at once. Returns 0 or -ENOMEM. */
int range_pool_init(struct range_pool *pool, struct arena *arena, uint32_t capacity, uint32_t ranges_max);
/* The first unit of a range, or RANGE_NONE when no hole is long enough. A count of 0 gets 0. */
uint32_t range_pool_take(struct range_pool *pool, uint32_t count);
/* Gives back exactly what one take returned. */
void range_pool_give(struct range_pool *pool, uint32_t first, uint32_t count);

#endif
