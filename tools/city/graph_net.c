#include "tools/city/graph_net.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"

static size_t slot_of(const struct net *net, int64_t id)
{
	size_t slot = (size_t)hash_u64((uint64_t)id) & net->id_mask;
	while (net->id_slots[slot] && net->vertices.items[net->id_slots[slot] - 1].id != id)
		slot = (slot + 1) & net->id_mask;
	return slot;
}

uint32_t net_vertex_add(struct net *net, int64_t id, int32_t x, int32_t y)
{
	uint32_t vertex = (uint32_t)net->vertices.count;
	ARRAY_PUSH(&net->vertices, (struct net_vertex){ .id = id, .x = x, .y = y, .same_as = vertex });
	if (id)
		net->id_slots[slot_of(net, id)] = vertex + 1;
	return vertex;
}

uint32_t net_vertex_by_id(const struct net *net, int64_t id)
{
	uint32_t found = net->id_slots[slot_of(net, id)];
	if (!found)
		return PKG_NONE;
	uint32_t vertex = found - 1;
	while (net->vertices.items[vertex].same_as != vertex)
		vertex = net->vertices.items[vertex].same_as;
	return vertex;
}

void net_init(struct net *net, struct city *city)
{
	*net = (struct net){ .city = city };
	size_t nodes = 0, slots = 1024, capacity = 0;
	for (size_t i = 0; i < city->ways.count; i++)
		nodes += city->ways.items[i].node_count;
	while (slots < nodes * 2)
		slots *= 2;
	net->id_slots = array_grow(NULL, &capacity, slots, sizeof(uint32_t));
	memset(net->id_slots, 0, slots * sizeof(uint32_t));
	net->id_mask = slots - 1;
	split_ways(net);
}

void net_finish(struct net *net)
{
	ARRAY_FINISH(&net->vertices);
	ARRAY_FINISH(&net->segments);
	array_free(net->id_slots);
	net->id_slots = NULL;
}

static unsigned kind_of(const struct net_segment *segment)
{
	return segment->drivable ? NET_DRIVABLE : NET_OTHER;
}

void net_stars_init(struct net_stars *stars, const struct net *net, unsigned kinds)
{
	size_t capacity = 0, count = net->vertices.count;
	stars->first = array_grow(NULL, &capacity, count + 2, sizeof(uint32_t));
	memset(stars->first, 0, (count + 2) * sizeof(uint32_t));
	for (size_t i = 0; i < net->segments.count; i++) {
		const struct net_segment *segment = &net->segments.items[i];
		if (!(kind_of(segment) & kinds))
			continue;
		stars->first[segment->a + 2]++;
		stars->first[segment->b + 2]++;
	}
	for (size_t i = 1; i <= count; i++)
		stars->first[i + 1] += stars->first[i];
	capacity = 0;
	stars->segments = array_grow(NULL, &capacity, (size_t)stars->first[count + 1] + 1, sizeof(uint32_t));
	for (size_t i = 0; i < net->segments.count; i++) {
		const struct net_segment *segment = &net->segments.items[i];
		if (!(kind_of(segment) & kinds))
			continue;
		stars->segments[stars->first[segment->a + 1]++] = (uint32_t)i;
		stars->segments[stars->first[segment->b + 1]++] = (uint32_t)i;
	}
}

void net_stars_finish(struct net_stars *stars)
{
	array_free(stars->first);
	array_free(stars->segments);
	*stars = (struct net_stars){ 0 };
}

struct line_mm net_line(const struct net *net, const struct net_segment *segment)
{
	const struct net_vertex *a = &net->vertices.items[segment->a], *b = &net->vertices.items[segment->b];
	return (struct line_mm){ a->x, a->y, b->x, b->y };
}

double net_length(const struct net *net, const struct net_segment *segment)
{
	struct line_mm line = net_line(net, segment);
	return hypot((double)line.bx - line.ax, (double)line.by - line.ay) / 1000.0;
}

struct placed_cut {
	uint32_t segment, vertex;
	int64_t along;
};

static int order_cuts(const void *left, const void *right)
{
	const struct placed_cut *a = left, *b = right;
	if (a->segment != b->segment)
		return a->segment < b->segment ? -1 : 1;
	if (a->along != b->along)
		return a->along < b->along ? -1 : 1;
	return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

static int64_t place_along(const struct net *net, const struct net_segment *segment, uint32_t vertex)
{
	struct line_mm line = net_line(net, segment);
	const struct net_vertex *at = &net->vertices.items[vertex];
	return ((int64_t)at->x - line.ax) * ((int64_t)line.bx - line.ax) +
		   ((int64_t)at->y - line.ay) * ((int64_t)line.by - line.ay);
}

void net_apply_cuts(struct net *net, cut_array *cuts)
{
	if (!cuts->count)
		return;
	size_t capacity = 0;
	struct placed_cut *placed = array_grow(NULL, &capacity, cuts->count, sizeof(*placed));
	for (size_t i = 0; i < cuts->count; i++) {
		struct net_cut cut = cuts->items[i];
		placed[i] = (struct placed_cut){
			cut.segment,
			cut.vertex,
			place_along(net, &net->segments.items[cut.segment], cut.vertex),
		};
	}
	qsort(placed, cuts->count, sizeof(*placed), order_cuts);
	ARRAY(struct net_segment) pieces = { 0 };
	ARRAY_RESERVE(&pieces, net->segments.count + cuts->count);
	size_t next = 0;
	for (size_t i = 0; i < net->segments.count; i++) {
		struct net_segment piece = net->segments.items[i];
		uint32_t end = piece.b;
		for (; next < cuts->count && placed[next].segment == i; next++) {
			uint32_t at = placed[next].vertex;
			piece.fresh = true;
			if (at == piece.a || at == end)
				continue;
			piece.b = at;
			ARRAY_PUSH(&pieces, piece);
			piece.a = at;
		}
		piece.b = end;
		ARRAY_PUSH(&pieces, piece);
	}
	array_free(placed);
	array_free(net->segments.items);
	net->segments.items = pieces.items;
	net->segments.count = pieces.count;
	net->segments.capacity = pieces.capacity;
	cuts->count = 0;
}

struct stretch {
	uint32_t low, high, segment;
	int8_t level;
};

static int order_stretches(const void *left, const void *right)
{
	const struct stretch *a = left, *b = right;
	if (a->low != b->low)
		return a->low < b->low ? -1 : 1;
	if (a->high != b->high)
		return a->high < b->high ? -1 : 1;
	if (a->level != b->level)
		return a->level < b->level ? -1 : 1;
	return (a->segment > b->segment) - (a->segment < b->segment);
}

/* The earlier one stays and may be driven in every direction in which either may be. */
static void join_permissions(struct net_segment *stays, const struct net_segment *goes)
{
	bool same_way_round = stays->a == goes->a;
	stays->forward |= same_way_round ? goes->forward : goes->backward;
	stays->backward |= same_way_round ? goes->backward : goes->forward;
}

/* Marks a == b on the later of two drivable segments between the same vertices. */
static void drop_duplicates(struct net *net, bool count_them)
{
	ARRAY(struct stretch) stretches = { 0 };
	for (size_t i = 0; i < net->segments.count; i++) {
		const struct net_segment *s = &net->segments.items[i];
		if (s->drivable && s->a != s->b)
			ARRAY_PUSH(&stretches,
				(struct stretch){ s->a < s->b ? s->a : s->b, s->a < s->b ? s->b : s->a, (uint32_t)i, s->level });
	}
	if (stretches.count)
		qsort(stretches.items, stretches.count, sizeof(struct stretch), order_stretches);
	for (size_t i = 1, stays = 0; i < stretches.count; i++) {
		const struct stretch *a = &stretches.items[stays], *b = &stretches.items[i];
		if (a->low != b->low || a->high != b->high || a->level != b->level) {
			stays = i;
			continue;
		}
		struct net_segment *goes = &net->segments.items[b->segment];
		join_permissions(&net->segments.items[a->segment], goes);
		goes->b = goes->a;
		if (count_them)
			report_fault(net->city->report, FAULT_DUPLICATE_EDGE, FAULT_MENDED, net->city->ways.items[goes->way].id);
	}
	ARRAY_FINISH(&stretches);
}

void net_merge_vertices(struct net *net, const uint32_t *to, bool count_duplicates)
{
	for (size_t v = 0; v < net->vertices.count; v++) {
		if (to[v] == v)
			continue;
		struct net_vertex *stays = &net->vertices.items[to[v]];
		stays->flags |= net->vertices.items[v].flags;
		stays->keep |= net->vertices.items[v].keep;
		net->vertices.items[v].same_as = to[v];
	}
	for (size_t i = 0; i < net->segments.count; i++) {
		struct net_segment *segment = &net->segments.items[i];
		segment->a = to[segment->a];
		segment->b = to[segment->b];
	}
	drop_duplicates(net, count_duplicates);
	size_t kept = 0;
	for (size_t i = 0; i < net->segments.count; i++)
		if (net->segments.items[i].a != net->segments.items[i].b)
			net->segments.items[kept++] = net->segments.items[i];
	net->segments.count = kept;
}
