/* Street graphs written by hand or by random numbers in a test, and a package around them. Header only, fixed sizes. */
#ifndef BLVD_TESTS_NAV_STREETS_H
#define BLVD_TESTS_NAV_STREETS_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "assets/pkg.h"

#define assert_near(a, b, by) assert_true(fabs((a) - (b)) <= (by))

#define STREETS_NODES 1024
#define STREETS_EDGES 4096
#define STREETS_POINTS 32768

struct streets {
	struct pkg_node nodes[STREETS_NODES];
	uint32_t outs[2 * STREETS_EDGES];
	struct pkg_half halves[2 * STREETS_EDGES];
	struct pkg_edge edges[STREETS_EDGES];
	struct pkg_point points[STREETS_POINTS];
	struct pkg_turn turns[256];
	uint32_t node_count, edge_count, point_count, turn_count;
	struct pkg_meta meta;
	struct pkg pkg;
};

/* Names are offsets into this; 0 is none. */
static const char streets_names[] = "\0Alpha\0Beta\0Gamma\0Delta";
enum { NO_NAME = 0, ALPHA = 1, BETA = 7, GAMMA = 12, DELTA = 18 };

static inline struct streets *streets_new(void)
{
	struct streets *streets = calloc(1, sizeof(*streets));
	if (!streets)
		abort();
	return streets;
}

static inline uint32_t streets_node(struct streets *s, double east, double north)
{
	s->nodes[s->node_count] =
		(struct pkg_node){ .pos_mm = { (int32_t)lrint(east * 1e3), (int32_t)lrint(north * 1e3) } };
	return s->node_count++;
}

/* A two-way residential street between two nodes over `count` points in between (east, north). The returned edge may be
 * changed until streets_finish(). */
static inline struct pkg_edge *streets_edge(
	struct streets *s, uint32_t from, uint32_t to, uint32_t name, size_t count, const double (*between)[2])
{
	uint32_t e = s->edge_count++;
	s->edges[e] = (struct pkg_edge){
		.first_point = s->point_count,
		.point_count = (uint32_t)count + 2,
		.name = name,
		.flags = PKG_EDGE_FORWARD | PKG_EDGE_BACKWARD,
		.width_mm = 6000,
		.street_class = PKG_STREET_RESIDENTIAL,
		.lanes_forward = 1,
		.lanes_backward = 1,
		.speed_kmh = 50,
	};
	s->halves[2 * e].origin = from;
	s->halves[2 * e + 1].origin = to;
	struct pkg_point *points = &s->points[s->point_count];
	memcpy(points[0].pos_mm, s->nodes[from].pos_mm, sizeof(points[0].pos_mm));
	for (size_t i = 0; i < count; i++)
		points[i + 1] =
			(struct pkg_point){ { (int32_t)lrint(between[i][0] * 1e3), (int32_t)lrint(between[i][1] * 1e3) } };
	memcpy(points[count + 1].pos_mm, s->nodes[to].pos_mm, sizeof(points[0].pos_mm));
	s->point_count += (uint32_t)count + 2;
	return &s->edges[e];
}

static inline void streets_oneway(struct pkg_edge *edge)
{
	edge->flags = (uint16_t)(edge->flags & ~PKG_EDGE_BACKWARD);
	edge->lanes_backward = 0;
}

static inline void streets_turn(struct streets *s, uint32_t from, uint32_t to)
{
	s->turns[s->turn_count++] = (struct pkg_turn){ from, to };
}

static inline double streets_leaving(const struct streets *s, uint32_t half)
{
	const struct pkg_edge *edge = &s->edges[half >> 1];
	const struct pkg_point *p = &s->points[edge->first_point];
	uint32_t last = edge->point_count - 1;
	const int32_t *a = p[half & 1 ? last : 0].pos_mm, *b = p[half & 1 ? last - 1 : 1].pos_mm;
	return atan2((double)b[1] - a[1], (double)b[0] - a[0]);
}

static inline int streets_compare_turns(const void *a, const void *b)
{
	const struct pkg_turn *x = a, *y = b;
	if (x->from_half != y->from_half)
		return x->from_half < y->from_half ? -1 : 1;
	return (x->to_half > y->to_half) - (x->to_half < y->to_half);
}

static inline void streets_flood(struct streets *s, uint32_t node, uint32_t component)
{
	s->nodes[node].component = component;
	for (uint32_t i = 0; i < s->nodes[node].out_count; i++) {
		uint32_t to = s->halves[s->outs[s->nodes[node].first_out + i] ^ 1u].origin;
		if (s->nodes[to].component == PKG_NONE)
			streets_flood(s, to, component);
	}
}

/* Out-lists, components, views. The component of node 0 is number 0. */
static inline const struct pkg *streets_finish(struct streets *s, bool right_hand)
{
	uint32_t at = 0, component = 0;
	for (uint32_t n = 0; n < s->node_count; n++) {
		struct pkg_node *node = &s->nodes[n];
		node->first_out = at;
		node->component = PKG_NONE;
		for (uint32_t h = 0; h < 2 * s->edge_count; h++) {
			if (s->halves[h].origin != n)
				continue;
			uint32_t i = at++;
			for (; i > node->first_out && streets_leaving(s, s->outs[i - 1]) > streets_leaving(s, h); i--)
				s->outs[i] = s->outs[i - 1];
			s->outs[i] = h;
		}
		node->out_count = at - node->first_out;
	}
	for (uint32_t n = 0; n < s->node_count; n++)
		if (s->nodes[n].component == PKG_NONE)
			streets_flood(s, n, component++);
	qsort(s->turns, s->turn_count, sizeof(s->turns[0]), streets_compare_turns);
	s->meta.right_hand_traffic = right_hand;
	struct geo_point origin = { 46.2, 6.15 }; /* unless the test says where */
	if (s->meta.origin_lat_deg != 0.0)
		origin = (struct geo_point){ s->meta.origin_lat_deg, s->meta.origin_lon_deg };
	s->pkg = (struct pkg){
		.meta = &s->meta,
		.frame = geo_frame_at(origin),
		.strings = streets_names,
		.strings_bytes = sizeof(streets_names),
		.graph = { .nodes = s->nodes,
			.outs = s->outs,
			.halves = s->halves,
			.edges = s->edges,
			.points = s->points,
			.turns = s->turns,
			.node_count = s->node_count,
			.out_count = at,
			.half_count = 2 * s->edge_count,
			.edge_count = s->edge_count,
			.point_count = s->point_count,
			.turn_count = s->turn_count },
	};
	return &s->pkg;
}

/* Half-edge between two nodes, the first one found. */
static inline uint32_t streets_half(const struct streets *s, uint32_t from, uint32_t to)
{
	for (uint32_t h = 0; h < 2 * s->edge_count; h++)
		if (s->halves[h].origin == from && s->halves[h ^ 1u].origin == to)
			return h;
	return PKG_NONE;
}

/* n x n crossings, `step` metres apart, node i * n + j at east j * step, north i * step. */
static inline struct streets *streets_grid(uint32_t n, double step)
{
	struct streets *s = streets_new();
	for (uint32_t i = 0; i < n; i++)
		for (uint32_t j = 0; j < n; j++)
			streets_node(s, j * step, i * step);
	for (uint32_t i = 0; i < n; i++)
		for (uint32_t j = 0; j + 1 < n; j++)
			streets_edge(s, i * n + j, i * n + j + 1, NO_NAME, 0, NULL);
	for (uint32_t i = 0; i + 1 < n; i++)
		for (uint32_t j = 0; j < n; j++)
			streets_edge(s, i * n + j, (i + 1) * n + j, NO_NAME, 0, NULL);
	return s;
}

#endif
