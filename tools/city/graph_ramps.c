/* Humps and dips by distance along the streets: Dijkstra from the place that must be lifted, as far as the ramp goes.
 */
#include <math.h>
#include <stdlib.h>

#include "tools/city/graph_heights.h"

struct heap_entry {
	double distance;
	uint32_t vertex;
};

struct ramp_search {
	double *distance; /* by vertex; HUGE_VAL between searches */
	index_array reached;
	ARRAY(struct heap_entry) heap;
};

struct ramp_search *ramp_search_new(size_t vertex_count)
{
	size_t capacity = 0;
	struct ramp_search *search = array_grow(NULL, &capacity, 1, sizeof(*search));
	*search = (struct ramp_search){ 0 };
	capacity = 0;
	search->distance = array_grow(NULL, &capacity, vertex_count + 1, sizeof(double));
	for (size_t v = 0; v < vertex_count; v++)
		search->distance[v] = HUGE_VAL;
	return search;
}

void ramp_search_free(struct ramp_search *search)
{
	if (!search)
		return;
	array_free(search->distance);
	ARRAY_FINISH(&search->reached);
	ARRAY_FINISH(&search->heap);
	array_free(search);
}

static bool before(struct heap_entry a, struct heap_entry b)
{
	return a.distance < b.distance || (a.distance == b.distance && a.vertex < b.vertex);
}

static void heap_push(struct ramp_search *search, double distance, uint32_t vertex)
{
	ARRAY_PUSH(&search->heap, (struct heap_entry){ distance, vertex });
	struct heap_entry *heap = search->heap.items;
	for (size_t i = search->heap.count - 1; i && before(heap[i], heap[(i - 1) / 2]); i = (i - 1) / 2) {
		struct heap_entry swap = heap[i];
		heap[i] = heap[(i - 1) / 2];
		heap[(i - 1) / 2] = swap;
	}
}

static struct heap_entry heap_pop(struct ramp_search *search)
{
	struct heap_entry *heap = search->heap.items, top = heap[0];
	heap[0] = heap[--search->heap.count];
	for (size_t i = 0;;) {
		size_t least = i;
		for (size_t child = 2 * i + 1; child <= 2 * i + 2; child++)
			if (child < search->heap.count && before(heap[child], heap[least]))
				least = child;
		if (least == i)
			return top;
		struct heap_entry swap = heap[i];
		heap[i] = heap[least];
		heap[least] = swap;
		i = least;
	}
}

static void reach(struct ramp_search *search, double *distance, uint32_t vertex, double at)
{
	if (at >= distance[vertex])
		return;
	if (distance[vertex] == HUGE_VAL)
		ARRAY_PUSH(&search->reached, vertex);
	distance[vertex] = at;
	heap_push(search, at, vertex);
}

/* What a ramp should end before: distances, HUGE_VAL if there is nothing. */
struct obstacles {
	double pinned, junction;
};

/* Settles all vertices within `limit`. */
static struct obstacles spread(
	struct ramp_search *search, const struct heights *heights, double *distance, double limit, bool structures_only)
{
	const struct net *net = heights->net;
	struct obstacles met = { HUGE_VAL, HUGE_VAL };
	while (search->heap.count) {
		struct heap_entry top = heap_pop(search);
		if (top.distance > distance[top.vertex])
			continue;
		if (heights->pinned[top.vertex])
			met.pinned = fmin(met.pinned, top.distance);
		if (heights->junction[top.vertex])
			met.junction = fmin(met.junction, top.distance);
		for (uint32_t i = heights->stars.first[top.vertex]; i < heights->stars.first[top.vertex + 1]; i++) {
			uint32_t segment = heights->stars.segments[i];
			const struct net_segment *s = &net->segments.items[segment];
			double next = top.distance + net_length(net, s);
			if (next <= limit && !(structures_only && !heights_is_structure(heights, segment)))
				reach(search, distance, s->a == top.vertex ? s->b : s->a, next);
		}
	}
	return met;
}

void ramp_spread(struct ramp_search *search, const struct heights *heights, double *distance)
{
	search->reached.count = search->heap.count = 0;
	for (uint32_t v = 0; v < heights->net->vertices.count; v++) {
		if (distance[v] == 0.0)
			heap_push(search, 0.0, v);
		else
			distance[v] = HUGE_VAL;
	}
	spread(search, heights, distance, HUGE_VAL, true);
	search->reached.count = 0;
}

static void lift(struct heights *heights, const struct ramp *ramp, uint32_t vertex, double distance, double run)
{
	double height = ramp->height_m;
	if (distance > ramp->flat_m)
		height *= run > 0.0 ? 1.0 - ease((distance - ramp->flat_m) / run) : 0.0;
	if (heights->pinned[vertex] || height == 0.0)
		return;
	if (height > heights->up[vertex])
		heights->up[vertex] = height;
	if (height < heights->down[vertex])
		heights->down[vertex] = height;
}

void ramp_add(struct heights *heights, const struct ramp *ramp)
{
	struct ramp_search *search = heights->search;
	const struct net_segment *on = &heights->net->segments.items[ramp->segment];
	double length = net_length(heights->net, on);
	double run = EASE_STEEPEST * fabs(ramp->height_m) / ramp->grade;
	double shortest = EASE_STEEPEST * fabs(ramp->height_m) / ramp->steepest;
	search->reached.count = search->heap.count = 0;
	reach(search, search->distance, on->a, length * ramp->t);
	reach(search, search->distance, on->b, length * (1.0 - ramp->t));
	struct obstacles met = spread(search, heights, search->distance, ramp->flat_m + run, false);
	struct ramp fitted = *ramp;
	if (met.junction < ramp->flat_m + run)
		run = fmax(met.junction - ramp->flat_m, shortest);
	if (met.pinned < ramp->flat_m + run) {
		fitted.flat_m = fmin(ramp->flat_m, met.pinned * 0.3);
		run = met.pinned - fitted.flat_m;
	}
	heights->on_ramp[ramp->segment] = true;
	for (size_t i = 0; i < search->reached.count; i++) {
		uint32_t vertex = search->reached.items[i];
		double distance = search->distance[vertex];
		search->distance[vertex] = HUGE_VAL;
		lift(heights, &fitted, vertex, distance, run);
		if (distance >= fitted.flat_m + run)
			continue;
		for (uint32_t k = heights->stars.first[vertex]; k < heights->stars.first[vertex + 1]; k++)
			heights->on_ramp[heights->stars.segments[k]] = true;
	}
}
