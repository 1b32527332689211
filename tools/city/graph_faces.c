/*
 * The planar subdivision: half-edges around their nodes, face cycles, areas, components, and which face holds which
 * component. All decisions are exact in integers.
 */
#include <stdlib.h>
#include <string.h>

#include "tools/city/graph_net.h"

struct heading {
	int64_t dx, dy;
	uint32_t half;
};

static struct heading heading_of(const struct graph_data *graph, uint32_t half)
{
	const struct pkg_edge *edge = &graph->edges.items[half / 2];
	const struct pkg_point *p = &graph->points.items[edge->first_point];
	uint32_t at = half & 1 ? edge->point_count - 1 : 0, next = half & 1 ? at - 1 : 1;
	return (struct heading){ (int64_t)p[next].pos_mm[0] - p[at].pos_mm[0], (int64_t)p[next].pos_mm[1] - p[at].pos_mm[1],
		half };
}

/* Counter-clockwise from east. */
static int order_headings(const void *left, const void *right)
{
	const struct heading *a = left, *b = right;
	bool a_low = a->dy < 0 || (a->dy == 0 && a->dx < 0), b_low = b->dy < 0 || (b->dy == 0 && b->dx < 0);
	if (a_low != b_low)
		return a_low ? 1 : -1;
	int64_t cross = a->dx * b->dy - a->dy * b->dx;
	if (cross)
		return cross > 0 ? -1 : 1;
	return (a->half > b->half) - (a->half < b->half);
}

static void list_outs(struct graph_data *graph)
{
	size_t halves = graph->halves.count, capacity = 0;
	for (size_t h = 0; h < halves; h++)
		graph->nodes.items[graph->halves.items[h].origin].out_count++;
	uint32_t first = 0;
	for (size_t n = 0; n < graph->nodes.count; n++) {
		graph->nodes.items[n].first_out = first;
		first += graph->nodes.items[n].out_count;
		graph->nodes.items[n].out_count = 0;
	}
	struct heading *headings = array_grow(NULL, &capacity, halves + 1, sizeof(*headings));
	for (uint32_t h = 0; h < halves; h++) {
		struct pkg_node *node = &graph->nodes.items[graph->halves.items[h].origin];
		headings[node->first_out + node->out_count++] = heading_of(graph, h);
	}
	for (size_t n = 0; n < graph->nodes.count; n++) {
		const struct pkg_node *node = &graph->nodes.items[n];
		qsort(headings + node->first_out, node->out_count, sizeof(*headings), order_headings);
	}
	for (size_t i = 0; i < halves; i++)
		ARRAY_PUSH(&graph->outs, headings[i].half);
	array_free(headings);
}

static bool in_plane(const struct graph_data *graph, uint32_t half)
{
	return !(graph->edges.items[half / 2].flags & PKG_EDGE_OFF_PLANE);
}

static void follow(struct graph_data *graph, uint32_t half, uint32_t next)
{
	graph->halves.items[half].next = next;
	graph->halves.items[next].prev = half;
}

/* The face to the left goes on with the next street clockwise from where one came. */
static void link_halves(struct graph_data *graph)
{
	for (uint32_t h = 0; h < graph->halves.count; h++)
		if (!in_plane(graph, h))
			follow(graph, h, h ^ 1);
	for (size_t n = 0; n < graph->nodes.count; n++) {
		const struct pkg_node *node = &graph->nodes.items[n];
		uint32_t first = PKG_NONE, last = PKG_NONE;
		for (uint32_t i = 0; i < node->out_count; i++) {
			uint32_t out = graph->outs.items[node->first_out + i];
			if (!in_plane(graph, out))
				continue;
			if (last == PKG_NONE)
				first = out;
			else
				follow(graph, out ^ 1, last);
			last = out;
		}
		if (first != PKG_NONE)
			follow(graph, first ^ 1, last);
	}
}

/* Twice the area in mm^2 under one half-edge's polyline. */
static __int128 area_along(const struct graph_data *graph, uint32_t half)
{
	const struct pkg_edge *edge = &graph->edges.items[half / 2];
	const struct pkg_point *p = &graph->points.items[edge->first_point];
	__int128 sum = 0;
	for (uint32_t i = 1; i < edge->point_count; i++, p++)
		sum += (__int128)p[0].pos_mm[0] * p[1].pos_mm[1] - (__int128)p[1].pos_mm[0] * p[0].pos_mm[1];
	return half & 1 ? -sum : sum;
}

static void trace_faces(struct graph_data *graph)
{
	for (uint32_t h = 0; h < graph->halves.count; h++)
		graph->halves.items[h].face = PKG_NONE;
	for (uint32_t h = 0; h < graph->halves.count; h++) {
		if (graph->halves.items[h].face != PKG_NONE)
			continue;
		uint32_t id = (uint32_t)graph->faces.count;
		struct pkg_face face = { .first_half = h, .parent = PKG_NONE };
		__int128 twice = 0;
		uint32_t at = h;
		do {
			graph->halves.items[at].face = id;
			twice += area_along(graph, at);
			face.half_count++;
			at = graph->halves.items[at].next;
		} while (at != h);
		face.area_m2 = (double)twice / 2e6;
		face.flags = !in_plane(graph, h) ? PKG_FACE_OFF_PLANE : twice <= 0 ? PKG_FACE_OUTER : 0;
		if (face.flags & PKG_FACE_OFF_PLANE)
			face.area_m2 = 0.0;
		ARRAY_PUSH(&graph->faces, face);
	}
}

struct outer {
	int32_t x, y; /* westernmost point, of these the southernmost */
	uint32_t face;
};

static int order_outers(const void *left, const void *right)
{
	const struct outer *a = left, *b = right;
	if (a->x != b->x)
		return a->x < b->x ? -1 : 1;
	if (a->y != b->y)
		return a->y < b->y ? -1 : 1;
	return (a->face > b->face) - (a->face < b->face);
}

static struct outer westernmost(const struct graph_data *graph, uint32_t face)
{
	struct outer out = { INT32_MAX, INT32_MAX, face };
	uint32_t h = graph->faces.items[face].first_half;
	do {
		const struct pkg_edge *edge = &graph->edges.items[h / 2];
		for (uint32_t i = 0; i < edge->point_count; i++) {
			const int32_t *at = graph->points.items[edge->first_point + i].pos_mm;
			if (at[0] < out.x || (at[0] == out.x && at[1] < out.y)) {
				out.x = at[0];
				out.y = at[1];
			}
		}
		h = graph->halves.items[h].next;
	} while (h != graph->faces.items[face].first_half);
	return out;
}

/* From west to east: the nearest street west of a component's westernmost point belongs to one that already knows its
 * parent. */
static void nest_faces(struct graph_data *graph)
{
	ARRAY(struct outer) outers = { 0 };
	for (uint32_t f = 0; f < graph->faces.count; f++)
		if (graph->faces.items[f].flags & PKG_FACE_OUTER)
			ARRAY_PUSH(&outers, westernmost(graph, f));
	if (outers.count)
		qsort(outers.items, outers.count, sizeof(struct outer), order_outers);
	struct pkg_graph view = graph_view(graph);
	struct face_locator *locator = face_locator_new(&view);
	for (size_t i = 0; i < outers.count; i++)
		graph->faces.items[outers.items[i].face].parent =
			face_locator_find(locator, outers.items[i].x, outers.items[i].y);
	face_locator_free(locator);
	ARRAY_FINISH(&outers);
}

void faces_build(struct graph_data *graph)
{
	list_outs(graph);
	link_halves(graph);
	trace_faces(graph);
	nest_faces(graph);
	for (size_t e = 0; e < graph->edges.count; e++) {
		if (!(graph->edges.items[e].flags & PKG_EDGE_ROUNDABOUT))
			continue;
		for (uint32_t side = 0; side < 2; side++) {
			struct pkg_node *node = &graph->nodes.items[graph->halves.items[2 * e + side].origin];
			node->flags |= node->out_count > 2 ? PKG_NODE_ROUNDABOUT : 0u;
		}
	}
}

struct component {
	uint64_t length_mm;
	uint32_t root;
	int64_t source_id;
};

static int order_components(const void *left, const void *right)
{
	const struct component *a = left, *b = right;
	if (a->length_mm != b->length_mm)
		return a->length_mm > b->length_mm ? -1 : 1;
	return (a->root > b->root) - (a->root < b->root);
}

static uint32_t root_of(uint32_t *to, uint32_t node)
{
	while (to[node] != node)
		node = to[node] = to[to[node]];
	return node;
}

void faces_components(struct graph_data *graph, struct report *report)
{
	size_t capacity = 0, count = graph->nodes.count;
	uint32_t *to = array_grow(NULL, &capacity, count + 1, sizeof(uint32_t));
	for (uint32_t n = 0; n < count; n++)
		to[n] = n;
	for (size_t e = 0; e < graph->edges.count; e++) {
		uint32_t a = root_of(to, graph->halves.items[2 * e].origin),
				 b = root_of(to, graph->halves.items[2 * e + 1].origin);
		to[a > b ? a : b] = a > b ? b : a;
	}
	capacity = 0;
	struct component *parts = array_grow(NULL, &capacity, count + 1, sizeof(*parts));
	for (uint32_t n = 0; n < count; n++)
		parts[n] = (struct component){ 0, n, 0 };
	for (size_t e = 0; e < graph->edges.count; e++) {
		struct component *part = &parts[root_of(to, graph->halves.items[2 * e].origin)];
		part->source_id = part->length_mm ? part->source_id : graph->edges.items[e].source_id;
		part->length_mm += graph->edges.items[e].length_mm;
	}
	if (count)
		qsort(parts, count, sizeof(*parts), order_components);
	for (uint32_t i = 0; i < count && parts[i].length_mm; i++) {
		graph->nodes.items[parts[i].root].component = i;
		if (i)
			report_fault(report, FAULT_UNCONNECTED_STREET, FAULT_MENDED, parts[i].source_id);
	}
	for (uint32_t n = 0; n < count; n++)
		graph->nodes.items[n].component = graph->nodes.items[root_of(to, n)].component;
	for (size_t f = 0; f < graph->faces.count; f++) {
		struct pkg_face *face = &graph->faces.items[f];
		face->component = graph->nodes.items[graph->halves.items[face->first_half].origin].component;
	}
	array_free(to);
	array_free(parts);
}
