/*
 * Ways into segments, joined where they name the same node. Then two mends that need distances: a street that ends
 * within GRAPH_NEAR_MISS_M of another one is joined to it, and ends where the data ends are marked as such.
 */
#include <math.h>
#include <stdlib.h>

#include "tools/city/graph_net.h"

#define BORDER_M 40.0

static int level_of(const struct way *way)
{
	int level = way->layer;
	if (way->bridge && level <= 0)
		level = 1;
	if (way->tunnel && level >= 0)
		level = -1;
	return level < -15 ? -15 : level > 15 ? 15 : level;
}

static uint32_t vertex_of_node(struct net *net, const struct way_node *node)
{
	uint32_t vertex = node->id ? net_vertex_by_id(net, node->id) : PKG_NONE;
	if (vertex == PKG_NONE)
		vertex =
			net_vertex_add(net, node->id, (int32_t)lround(node->at.x * 1000.0), (int32_t)lround(node->at.y * 1000.0));
	struct net_vertex *at = &net->vertices.items[vertex];
	at->flags |= node->flags;
	at->keep |= (node->flags & ~(uint32_t)PKG_NODE_BOUNDARY) != 0;
	return vertex;
}

static bool representable(const struct way_node *node)
{
	return fabs(node->at.x) * 1000.0 < LINE_LIMIT_MM && fabs(node->at.y) * 1000.0 < LINE_LIMIT_MM; /* NaN: false */
}

static void split_way(struct net *net, uint32_t index)
{
	const struct way *way = &net->city->ways.items[index];
	struct net_segment segment = {
		.way = index,
		.level = (int8_t)level_of(way),
		.drivable = way->drivable && way->street_class < PKG_STREET_CLASS_COUNT,
		.forward = way->oneway >= 0,
		.backward = way->oneway <= 0,
		.fresh = true,
	};
	uint32_t last = PKG_NONE;
	for (size_t i = 0; i < way->node_count; i++) {
		if (!representable(&way->nodes[i])) {
			report_fault(net->city->report, FAULT_BAD_GEOMETRY, FAULT_DROPPED, way->id);
			last = PKG_NONE;
			continue;
		}
		uint32_t vertex = vertex_of_node(net, &way->nodes[i]);
		if (last != PKG_NONE && last != vertex) {
			segment.a = last;
			segment.b = vertex;
			ARRAY_PUSH(&net->segments, segment);
		}
		last = vertex;
	}
}

void split_ways(struct net *net)
{
	for (size_t i = 0; i < net->city->ways.count; i++)
		split_way(net, (uint32_t)i);
	for (size_t i = 0; i < net->city->restrictions.count; i++) {
		uint32_t via = net_vertex_by_id(net, net->city->restrictions.items[i].via_node);
		if (via != PKG_NONE)
			net->vertices.items[via].keep = true;
	}
}

/* Where a dead end belongs: a vertex (cut PKG_NONE), or a place on a segment. */
struct landing {
	double distance_mm;
	uint32_t vertex, segment;
	int32_t x, y;
};

static void consider(const struct net *net, uint32_t end, uint32_t index, struct landing *best)
{
	const struct net_vertex *v = &net->vertices.items[end];
	struct line_mm line = net_line(net, &net->segments.items[index]);
	double dx = (double)line.bx - line.ax, dy = (double)line.by - line.ay, length2 = dx * dx + dy * dy;
	double t = length2 > 0.0 ? (((double)v->x - line.ax) * dx + ((double)v->y - line.ay) * dy) / length2 : 0.0;
	t = fmin(fmax(t, 0.0), 1.0);
	double x = line.ax + t * dx, y = line.ay + t * dy;
	double distance = hypot(x - v->x, y - v->y);
	if (distance >= best->distance_mm)
		return;
	*best = (struct landing){ distance, PKG_NONE, index, (int32_t)lround(x), (int32_t)lround(y) };
	double from_a = t * sqrt(length2), from_b = (1.0 - t) * sqrt(length2);
	if (fmin(from_a, from_b) < GRAPH_NEAR_MISS_M * 1000.0)
		best->vertex = from_a <= from_b ? net->segments.items[index].a : net->segments.items[index].b;
}

static uint32_t root_of(uint32_t *to, uint32_t vertex)
{
	while (to[vertex] != vertex)
		vertex = to[vertex] = to[to[vertex]];
	return vertex;
}

static void mend_end(struct net *net, struct line_grid *grid, uint32_t end, uint32_t own, uint32_t *to, cut_array *cuts,
	index_array *near)
{
	struct landing best = { .distance_mm = GRAPH_NEAR_MISS_M * 1000.0, .vertex = PKG_NONE, .segment = PKG_NONE };
	struct net_vertex *at = &net->vertices.items[end];
	const struct net_segment *stub = &net->segments.items[own];
	uint32_t other = stub->a == end ? stub->b : stub->a;
	line_grid_near(grid, (struct line_mm){ at->x, at->y, at->x, at->y }, (int64_t)(GRAPH_NEAR_MISS_M * 1000.0), near);
	for (size_t i = 0; i < near->count; i++) {
		const struct net_segment *s = &net->segments.items[near->items[i]];
		bool touches_stub = s->a == other || s->b == other || s->a == end || s->b == end;
		if (near->items[i] != own && s->drivable && s->level == stub->level && !touches_stub)
			consider(net, end, near->items[i], &best);
	}
	if (best.segment == PKG_NONE)
		return;
	report_fault(net->city->report, FAULT_NEAR_MISS_NODE, FAULT_MENDED, net->city->ways.items[stub->way].id);
	if (best.vertex != PKG_NONE) {
		to[root_of(to, end)] = root_of(to, best.vertex);
		return;
	}
	at->x = best.x;
	at->y = best.y;
	ARRAY_PUSH(cuts, (struct net_cut){ best.segment, end });
}

void split_mend_ends(struct net *net)
{
	size_t count = net->segments.count, capacity = 0;
	struct line_mm *lines = array_grow(NULL, &capacity, count + 1, sizeof(*lines));
	for (size_t i = 0; i < count; i++)
		lines[i] = net_line(net, &net->segments.items[i]);
	capacity = 0;
	uint32_t *to = array_grow(NULL, &capacity, net->vertices.count + 1, sizeof(uint32_t));
	for (size_t v = 0; v < net->vertices.count; v++)
		to[v] = (uint32_t)v;
	struct net_stars stars;
	struct line_grid grid;
	index_array near = { 0 };
	cut_array cuts = { 0 };
	net_stars_init(&stars, net, NET_DRIVABLE);
	line_grid_init(&grid, lines, count);
	for (uint32_t v = 0; v < net->vertices.count; v++)
		if (stars.first[v + 1] - stars.first[v] == 1)
			mend_end(net, &grid, v, stars.segments[stars.first[v]], to, &cuts, &near);
	for (uint32_t v = 0; v < net->vertices.count; v++)
		to[v] = root_of(to, v);
	net_apply_cuts(net, &cuts);
	net_merge_vertices(net, to, true);
	ARRAY_FINISH(&near);
	ARRAY_FINISH(&cuts);
	line_grid_finish(&grid);
	net_stars_finish(&stars);
	array_free(to);
	array_free(lines);
}

/* A dead end goes on beyond the data when it lies at the border of all streets, or when its class does not end. */
void split_mark_boundary(struct net *net)
{
	struct net_stars stars;
	net_stars_init(&stars, net, NET_DRIVABLE);
	int64_t west = INT64_MAX, south = INT64_MAX, east = INT64_MIN, north = INT64_MIN,
			border = (int64_t)(BORDER_M * 1000);
	for (uint32_t v = 0; v < net->vertices.count; v++) {
		if (stars.first[v + 1] == stars.first[v])
			continue;
		const struct net_vertex *at = &net->vertices.items[v];
		west = at->x < west ? at->x : west;
		east = at->x > east ? at->x : east;
		south = at->y < south ? at->y : south;
		north = at->y > north ? at->y : north;
	}
	for (uint32_t v = 0; v < net->vertices.count; v++) {
		struct net_vertex *at = &net->vertices.items[v];
		if (stars.first[v + 1] - stars.first[v] != 1) {
			at->flags &= ~(uint32_t)PKG_NODE_BOUNDARY;
			continue;
		}
		const struct net_segment *only = &net->segments.items[stars.segments[stars.first[v]]];
		bool at_border =
			at->x < west + border || at->x > east - border || at->y < south + border || at->y > north - border;
		if (at_border || net->city->ways.items[only->way].street_class <= PKG_STREET_TERTIARY)
			at->flags |= PKG_NODE_BOUNDARY;
	}
	net_stars_finish(&stars);
}
