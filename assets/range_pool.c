/* A singly linked list of holes in address order: take walks for the first that fits, give walks for its neighbours.
 * Both are linear in the number of holes, which loading by neighbourhood keeps small. */
#include "assets/range_pool.h"

#include <assert.h>
#include <errno.h>

/* n ranges leave at most n + 1 holes */
static uint32_t nodes_for(uint32_t ranges_max)
{
	return ranges_max + 2;
}

uint64_t range_pool_bytes(uint32_t ranges_max)
{
	return (uint64_t)nodes_for(ranges_max) * sizeof(struct range_node);
}

int range_pool_init(struct range_pool *pool, struct arena *arena, uint32_t capacity, uint32_t ranges_max)
{
	uint32_t count = nodes_for(ranges_max);
	*pool = (struct range_pool){ .node_count = count, .capacity = capacity, .free_units = capacity };
	pool->nodes = ARENA_ARRAY(arena, struct range_node, count);
	if (!pool->nodes)
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++)
		pool->nodes[i].next = i + 1 < count ? i + 1 : RANGE_NONE;
	pool->spare_head = 1;
	pool->free_head = 0;
	pool->nodes[0] = (struct range_node){ .first = 0, .count = capacity, .next = RANGE_NONE };
	return 0;
}

static void unlink_hole(struct range_pool *pool, uint32_t previous, uint32_t node)
{
	if (previous == RANGE_NONE)
		pool->free_head = pool->nodes[node].next;
	else
		pool->nodes[previous].next = pool->nodes[node].next;
	pool->nodes[node].next = pool->spare_head;
	pool->spare_head = node;
}

uint32_t range_pool_take(struct range_pool *pool, uint32_t count)
{
	if (!count)
		return 0;
	uint32_t previous = RANGE_NONE;
	for (uint32_t at = pool->free_head; at != RANGE_NONE; previous = at, at = pool->nodes[at].next) {
		struct range_node *hole = &pool->nodes[at];
		if (hole->count < count)
			continue;
		uint32_t first = hole->first;
		hole->first += count;
		hole->count -= count;
		pool->free_units -= count;
		if (!hole->count)
			unlink_hole(pool, previous, at);
		return first;
	}
	return RANGE_NONE;
}

static uint32_t insert_hole(struct range_pool *pool, uint32_t previous, uint32_t first, uint32_t count)
{
	uint32_t node = pool->spare_head;
	assert(node != RANGE_NONE && "more ranges than the pool was made for");
	pool->spare_head = pool->nodes[node].next;
	uint32_t *link = previous == RANGE_NONE ? &pool->free_head : &pool->nodes[previous].next;
	pool->nodes[node] = (struct range_node){ .first = first, .count = count, .next = *link };
	*link = node;
	return node;
}

/* Joins `node` with the hole after it when they touch. */
static void join_next(struct range_pool *pool, uint32_t node)
{
	uint32_t next = pool->nodes[node].next;
	if (next == RANGE_NONE || pool->nodes[node].first + pool->nodes[node].count != pool->nodes[next].first)
		return;
	pool->nodes[node].count += pool->nodes[next].count;
	unlink_hole(pool, node, next);
}

void range_pool_give(struct range_pool *pool, uint32_t first, uint32_t count)
{
	if (!count)
		return;
	uint32_t previous = RANGE_NONE, at = pool->free_head;
	while (at != RANGE_NONE && pool->nodes[at].first < first) {
		previous = at;
		at = pool->nodes[at].next;
	}
	assert(at == RANGE_NONE || first + count <= pool->nodes[at].first);
	pool->free_units += count;
	bool touches = previous != RANGE_NONE && pool->nodes[previous].first + pool->nodes[previous].count == first;
	if (touches)
		pool->nodes[previous].count += count;
	else
		previous = insert_hole(pool, previous, first, count);
	join_next(pool, previous);
}
