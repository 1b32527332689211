/* A* over half-edges with a binary heap. Cost of a whole search: O(h log h) for h half-edges settled; a step is bounded
 * by its caller. */
#include "nav/route.h"

#include <errno.h>
#include <string.h>

#define CAPACITY_MAX 65536u
#define PARENT_NONE UINT32_MAX
#define PARENT_START (UINT32_MAX - 1) /* set off along leg_start.half */
#define PARENT_START_TWIN (UINT32_MAX - 2)
#define NOT_IN_HEAP UINT32_MAX
#define COST_MAX (UINT32_MAX / 2)
#define BOUND_MAX 5e8 /* ms, well below COST_MAX */

#define PRIVATE_MS 600000u
#define U_TURN_DEAD_END_MS 20000u
#define U_TURN_MS 120000u
#define SIGNALS_MS 5000u
#define STOP_MS 3000u
#define GIVE_WAY_MS 1500u

/* Share of the limit that a car really reaches, by class, in percent. */
static const uint8_t class_percent[PKG_STREET_CLASS_COUNT] = { 95, 88, 78, 72, 68, 62, 60, 50, 45 };
static const uint8_t class_kmh[PKG_STREET_CLASS_COUNT] = { 110, 80, 50, 50, 50, 50, 30, 20, 15 };

static uint32_t edge_speed(const struct pkg_edge *edge)
{
	uint32_t class = edge->street_class < PKG_STREET_CLASS_COUNT ? edge->street_class : PKG_STREET_SERVICE;
	uint32_t kmh = edge->speed_kmh ? edge->speed_kmh : class_kmh[class];
	uint32_t mm_s = kmh * class_percent[class] * 10000u / 3600u;
	return mm_s < 1000 ? 1000 : mm_s;
}

static uint32_t travel_ms(uint64_t length_mm, uint32_t mm_s)
{
	uint64_t ms = (length_mm * 1000u + mm_s - 1) / mm_s;
	if (ms < 1)
		return 1; /* no way round costs nothing, so parents never form a ring */
	return ms > COST_MAX / 4 ? COST_MAX / 4 : (uint32_t)ms;
}

uint32_t route_part_ms(const struct route_search *search, uint32_t half, double length_m)
{
	return length_m > 0.0 ? travel_ms((uint64_t)(length_m * 1e3), search->edge_mm_s[half >> 1]) : 0;
}

/* Turn from centre to side: nothing up to 30 degrees, across the traffic dearer than beside it. */
static uint32_t angle_ms(const struct graph *graph, int32_t turn_bam)
{
	double deg = bam_to_rad(turn_bam) * (180.0 / BLVD_PI);
	bool across = graph->right_hand ? deg < 0.0 : deg > 0.0;
	double size = fabs(deg);
	if (size < 30.0)
		return 0;
	if (size < 60.0)
		return across ? 2500 : 1500;
	return (across ? 6000u : 3000u) + (size > 135.0 ? 3000u : 0u);
}

static uint32_t node_ms(const struct pkg_node *node)
{
	if (node->flags & PKG_NODE_SIGNALS)
		return SIGNALS_MS;
	if (node->flags & PKG_NODE_STOP)
		return STOP_MS;
	return node->flags & PKG_NODE_GIVE_WAY ? GIVE_WAY_MS : 0;
}

static bool is_dead_end(const struct graph *graph, uint32_t half)
{
	const struct pkg_node *node = &graph->net->nodes[graph_end(graph, half)];
	for (uint32_t i = 0; i < node->out_count; i++) {
		uint32_t to = graph->net->outs[node->first_out + i];
		if (to != graph_twin(half) && graph_drivable(graph, to))
			return false;
	}
	return true;
}

uint32_t route_turn_ms(const struct graph *graph, uint32_t from, uint32_t to)
{
	if (graph_origin(graph, to) != graph_end(graph, from) || !graph_drivable(graph, to) ||
		graph_turn_forbidden(graph, from, to))
		return ROUTE_FORBIDDEN;
	const struct pkg_edge *edge_from = graph_edge(graph, from), *edge_to = graph_edge(graph, to);
	uint32_t cost = node_ms(&graph->net->nodes[graph_end(graph, from)]);
	if (to == graph_twin(from))
		return cost + (is_dead_end(graph, from) ? U_TURN_DEAD_END_MS : U_TURN_MS);
	if (!((edge_from->flags | edge_to->flags) & PKG_EDGE_ROUNDABOUT))
		cost += angle_ms(graph, graph_turn_bam(graph, from, to));
	if ((edge_to->flags & PKG_EDGE_PRIVATE) && !(edge_from->flags & PKG_EDGE_PRIVATE))
		cost += PRIVATE_MS;
	return cost;
}

int route_init(struct route_search *search, struct arena *arena, const struct graph *graph, uint32_t capacity)
{
	const struct pkg_graph *net = graph->net;
	*search = (struct route_search){ .graph = graph };
	uint32_t halves = net->half_count + 1; /* the last one is the goal */
	if (!capacity)
		capacity = halves + ROUTE_STOPS_MAX < CAPACITY_MAX ? halves + ROUTE_STOPS_MAX : CAPACITY_MAX;
	search->edge_ms = ARENA_ARRAY(arena, uint32_t, net->edge_count + 1);
	search->edge_mm_s = ARENA_ARRAY(arena, uint32_t, net->edge_count + 1);
	search->labels = ARENA_ARRAY(arena, struct route_label, halves);
	search->heap = ARENA_ARRAY(arena, uint32_t, halves);
	search->heap_key = ARENA_ARRAY(arena, uint32_t, halves);
	search->route.halves = ARENA_ARRAY(arena, uint32_t, capacity);
	search->route.capacity = capacity;
	if (!search->edge_ms || !search->edge_mm_s || !search->labels || !search->heap || !search->heap_key ||
		!search->route.halves)
		return -ENOMEM;
	search->fastest_mm_s = 1000;
	for (uint32_t e = 0; e < net->edge_count; e++) {
		search->edge_mm_s[e] = edge_speed(&net->edges[e]);
		search->edge_ms[e] = travel_ms((uint64_t)llrint(graph_length_m(graph, e * 2) * 1e3), search->edge_mm_s[e]);
		if (search->edge_mm_s[e] > search->fastest_mm_s)
			search->fastest_mm_s = search->edge_mm_s[e];
	}
	return 0;
}

/* --- heap of half-edges by key, then number --- */

static bool heap_less(const struct route_search *search, uint32_t a, uint32_t b)
{
	uint32_t half_a = search->heap[a], half_b = search->heap[b];
	uint32_t key_a = search->heap_key[half_a], key_b = search->heap_key[half_b];
	return key_a != key_b ? key_a < key_b : half_a < half_b;
}

static void heap_swap(struct route_search *search, uint32_t a, uint32_t b)
{
	uint32_t half = search->heap[a];
	search->heap[a] = search->heap[b];
	search->heap[b] = half;
	search->labels[search->heap[a]].heap_at = a;
	search->labels[search->heap[b]].heap_at = b;
}

static void heap_up(struct route_search *search, uint32_t at)
{
	for (; at > 0 && heap_less(search, at, (at - 1) / 2); at = (at - 1) / 2)
		heap_swap(search, at, (at - 1) / 2);
}

static void heap_down(struct route_search *search, uint32_t at)
{
	for (;;) {
		uint32_t least = at;
		for (uint32_t child = 2 * at + 1; child <= 2 * at + 2 && child < search->heap_count; child++)
			if (heap_less(search, child, least))
				least = child;
		if (least == at)
			return;
		heap_swap(search, at, least);
		at = least;
	}
}

static void heap_put(struct route_search *search, uint32_t half, uint32_t key)
{
	struct route_label *label = &search->labels[half];
	search->heap_key[half] = key;
	if (label->heap_at == NOT_IN_HEAP) {
		label->heap_at = search->heap_count;
		search->heap[search->heap_count++] = half;
	}
	heap_up(search, label->heap_at);
}

static uint32_t heap_take(struct route_search *search)
{
	uint32_t half = search->heap[0];
	heap_swap(search, 0, search->heap_count - 1);
	search->heap_count--;
	heap_down(search, 0);
	search->labels[half].heap_at = NOT_IN_HEAP;
	return half;
}

/* --- search --- */

static uint32_t goal_of(const struct route_search *search)
{
	return search->graph->net->half_count;
}

/* Never more than the true rest: the straight line at the graph's fastest speed. */
static uint32_t bound_ms(const struct route_search *search, uint32_t half, struct dvec3 goal_at)
{
	const int32_t *at = search->graph->net->nodes[graph_origin(search->graph, half)].pos_mm;
	double mm = hypot(goal_at.x * 1e3 - at[0], goal_at.y * 1e3 - at[1]);
	/* Lengths along polylines are rounded to 1 mm a point, so the bound gives some away. */
	return (uint32_t)fmin(fmax(mm - 100.0, 0.0) * 0.999 * 1000.0 / search->fastest_mm_s, BOUND_MAX);
}

static void relax(struct route_search *search, uint32_t half, uint32_t cost, uint32_t parent, uint32_t bound)
{
	struct route_label *label = &search->labels[half];
	if (label->stamp != search->stamp)
		*label = (struct route_label){ COST_MAX, PARENT_NONE, NOT_IN_HEAP, search->stamp };
	if (cost > label->cost_ms || (cost == label->cost_ms && parent >= label->parent))
		return;
	bool cheaper = cost < label->cost_ms;
	label->cost_ms = cost;
	label->parent = parent;
	if (cheaper && cost < COST_MAX / 2)
		heap_put(search, half, cost + bound);
}

/* Where on `half` the leg's stop lies, or a negative number when it is not on that edge. */
static double stop_along(const struct route_search *search, uint32_t half)
{
	const struct route_place *stop = &search->request.stops[search->leg];
	if (stop->half >> 1 != half >> 1)
		return -1.0;
	double length = graph_length_m(search->graph, half);
	double along = fmin(fmax(stop->along_m, 0.0), length);
	return half == stop->half ? along : length - along;
}

static void relax_goal(struct route_search *search, uint32_t half, uint32_t cost, double from_m, uint32_t parent)
{
	double along = stop_along(search, half);
	if (along < 0.0 || along < from_m || !graph_drivable(search->graph, half))
		return;
	relax(search, goal_of(search), cost + route_part_ms(search, half, along - from_m), parent, 0);
}

static void relax_moves(
	struct route_search *search, uint32_t from, uint32_t cost_at_end, uint32_t parent, struct dvec3 goal_at)
{
	const struct pkg_node *node = &search->graph->net->nodes[graph_end(search->graph, from)];
	for (uint32_t i = 0; i < node->out_count; i++) {
		uint32_t to = search->graph->net->outs[node->first_out + i];
		uint32_t turn = route_turn_ms(search->graph, from, to);
		if (turn != ROUTE_FORBIDDEN)
			relax(search, to, cost_at_end + turn, parent, bound_ms(search, to, goal_at));
	}
}

static struct dvec3 goal_at(const struct route_search *search)
{
	const struct route_place *stop = &search->request.stops[search->leg];
	return graph_at(search->graph, stop->half, stop->along_m).at_m;
}

static void set_off(struct route_search *search, uint32_t half, double along_m, uint32_t parent)
{
	double rest = graph_length_m(search->graph, half) - along_m;
	relax_goal(search, half, 0, along_m, parent);
	relax_moves(search, half, route_part_ms(search, half, rest), parent, goal_at(search));
}

static void begin_leg(struct route_search *search)
{
	search->stamp++;
	search->heap_count = 0;
	uint32_t half = search->leg_start.half;
	double length = graph_length_m(search->graph, half);
	double along = fmin(fmax(search->leg_start.along_m, 0.0), length);
	search->leg_start.along_m = along;
	set_off(search, half, along, PARENT_START);
	if (search->leg_either && graph_drivable(search->graph, graph_twin(half)))
		set_off(search, graph_twin(half), length - along, PARENT_START_TWIN);
}

static bool request_valid(const struct route_search *search)
{
	const struct route_request *request = &search->request;
	uint32_t halves = search->graph->net->half_count;
	if (!request->stop_count || request->stop_count > ROUTE_STOPS_MAX || request->start.half >= halves)
		return false;
	for (uint32_t i = 0; i < request->stop_count; i++)
		if (request->stops[i].half >= halves || !isfinite(request->stops[i].along_m))
			return false;
	return isfinite(request->start.along_m);
}

void route_begin(struct route_search *search, const struct route_request *request)
{
	search->request = *request;
	search->leg = 0;
	search->settled = 0;
	search->route.count = search->route.leg_count = 0;
	search->route.cost_ms = 0;
	search->state = ROUTE_NONE;
	if (!request_valid(search))
		return;
	search->state = ROUTE_WORKING;
	search->leg_start = request->start;
	search->leg_either = request->start_either;
	begin_leg(search);
}

/* Half-edge that the leg sets off on, by the mark at the root of a path. */
static uint32_t start_half(const struct route_search *search, uint32_t mark)
{
	return mark == PARENT_START ? search->leg_start.half : graph_twin(search->leg_start.half);
}

static bool is_mark(uint32_t parent)
{
	return parent == PARENT_START || parent == PARENT_START_TWIN;
}

/* Appends the leg's path. The first half-edge of a later leg is the last one of the leg before. */
static bool append_leg(struct route_search *search)
{
	struct route *route = &search->route;
	uint32_t goal_parent = search->labels[goal_of(search)].parent, steps = 0, mark = goal_parent;
	for (uint32_t h = goal_parent; !is_mark(h); h = search->labels[h].parent) {
		steps++;
		mark = search->labels[h].parent;
	}
	uint32_t first = route->count, base = search->leg ? first - 1 : 0;
	if (base + steps + 1 > route->capacity)
		return false;
	if (!search->leg) {
		route->halves[0] = start_half(search, mark);
		double length = graph_length_m(search->graph, route->halves[0]);
		route->start_along_m = mark == PARENT_START ? search->leg_start.along_m : length - search->leg_start.along_m;
	}
	uint32_t at = base + steps;
	for (uint32_t h = goal_parent; !is_mark(h); h = search->labels[h].parent)
		route->halves[at--] = h;
	route->count = base + steps + 1;
	uint32_t last = route->halves[route->count - 1];
	route->end_along_m = stop_along(search, last);
	route->leg_last[search->leg] = route->count - 1;
	route->leg_along_m[search->leg] = route->end_along_m;
	route->leg_count = search->leg + 1;
	route->cost_ms += search->labels[goal_of(search)].cost_ms;
	return true;
}

static void finish_leg(struct route_search *search)
{
	if (!append_leg(search)) {
		search->state = ROUTE_TOO_LONG;
		return;
	}
	search->leg++;
	if (search->leg == search->request.stop_count) {
		search->state = ROUTE_FOUND;
		return;
	}
	search->leg_start.half = search->route.halves[search->route.count - 1];
	search->leg_start.along_m = search->route.end_along_m;
	search->leg_either = false;
	begin_leg(search);
}

static void settle(struct route_search *search, uint32_t half, struct dvec3 at)
{
	uint32_t cost = search->labels[half].cost_ms;
	relax_goal(search, half, cost, 0.0, half);
	relax_moves(search, half, cost + route_edge_ms(search, half), half, at);
}

enum route_state route_step(struct route_search *search, uint32_t max_settled)
{
	struct dvec3 at = { 0 };
	if (search->state == ROUTE_WORKING)
		at = goal_at(search);
	for (uint32_t n = 0; n < max_settled && search->state == ROUTE_WORKING; n++) {
		if (!search->heap_count) {
			search->state = ROUTE_NONE;
			break;
		}
		uint32_t half = heap_take(search);
		search->settled++;
		if (half != goal_of(search)) {
			settle(search, half, at);
			continue;
		}
		finish_leg(search);
		if (search->state == ROUTE_WORKING)
			at = goal_at(search);
	}
	return search->state;
}

enum route_state route_find(struct route_search *search, const struct route_request *request)
{
	route_begin(search, request);
	while (search->state == ROUTE_WORKING)
		route_step(search, UINT32_MAX);
	return search->state;
}

bool route_snap(const struct graph *graph, struct dvec2 at_m, double radius_m, struct route_place *out)
{
	struct graph_hit hits[24];
	uint32_t count = 0;
	for (double r = 30.0; !count && r < radius_m; r *= 4.0)
		count = graph_nearest(graph, at_m, r, hits, 24);
	if (!count)
		count = graph_nearest(graph, at_m, radius_m, hits, 24);
	if (!count)
		return false;
	uint32_t best = 0;
	for (uint32_t i = 0; i < count && hits[i].distance_m < hits[0].distance_m + 40.0; i++) {
		if (!graph->net->nodes[graph_origin(graph, hits[i].edge * 2)].component) {
			best = i;
			break;
		}
	}
	bool forward = graph_drivable(graph, hits[best].edge * 2);
	out->half = hits[best].edge * 2 + !forward;
	out->along_m = forward ? hits[best].along_m : graph_length_m(graph, out->half) - hits[best].along_m;
	return true;
}
