/*
 * Questions to the street graph of a package: where a half-edge runs, where a car may go from it, what is near a place.
 * Borrowed arrays plus a few of its own, taken from the arena once; nothing is allocated or changed after graph_init().
 *
 * Half-edge h belongs to edge h / 2; an even h runs along the edge's polyline, its twin h ^ 1 against it. Distances
 * along a half-edge are metres from its origin, horizontal. Headings are radians, 0 north, clockwise positive; lateral
 * offsets are metres, right positive.
 */
#ifndef BLVD_NAV_GRAPH_H
#define BLVD_NAV_GRAPH_H

#include <stdbool.h>
#include <stdint.h>

#include "assets/pkg.h"
#include "platform/base/arena.h"
#include "platform/base/geo.h"

#define GRAPH_SUCCESSORS_MAX 24

struct graph {
	const struct pkg_graph *net; /* borrowed */
	bool right_hand;             /* traffic keeps right */
	uint32_t *along_mm;          /* by index into POLY: distance from the edge's first point */
	int32_t *leave_bam;          /* by half-edge: heading of its first metres, corners smoothed */
	/* grid over the streets: cell_edge[cell_first[c]] to cell_edge[cell_first[c + 1] - 1] pass through cell c */
	int64_t min_mm[2], cell_mm;
	uint32_t columns, rows;
	uint32_t *cell_first, *cell_edge;
};

struct graph_pose {
	struct dvec3 at_m; /* city frame; on the centre line */
	double heading_rad;
};

/* A place on an edge, met by graph_nearest(). */
struct graph_hit {
	uint32_t edge;
	double along_m;    /* on half-edge 2 * edge */
	double distance_m; /* from the asked place, >= 0 */
};

/* Which ways out of a half-edge count. */
enum graph_rule {
	GRAPH_LEGAL,    /* one-ways and forbidden turns obeyed; back along the street only in a dead end */
	GRAPH_PHYSICAL, /* whatever a car can do, the street's own twin included */
};

/* `net` must outlive the graph and be checked (pkg_open). Returns 0, or -ENOMEM when the arena is full. */
int graph_init(struct graph *graph, struct arena *arena, const struct pkg_graph *net, bool right_hand_traffic);

static inline uint32_t graph_twin(uint32_t half)
{
	return half ^ 1u;
}

static inline const struct pkg_edge *graph_edge(const struct graph *graph, uint32_t half)
{
	return &graph->net->edges[half >> 1];
}

static inline uint32_t graph_origin(const struct graph *graph, uint32_t half)
{
	return graph->net->halves[half].origin;
}

static inline uint32_t graph_end(const struct graph *graph, uint32_t half)
{
	return graph->net->halves[half ^ 1u].origin;
}

/* May cars drive along it? */
static inline bool graph_drivable(const struct graph *graph, uint32_t half)
{
	return graph_edge(graph, half)->flags & (half & 1 ? PKG_EDGE_BACKWARD : PKG_EDGE_FORWARD);
}

/* Length as its polyline has it; may be 0. */
double graph_length_m(const struct graph *graph, uint32_t half);

/* Centre line at a distance, clamped to the half-edge. */
struct graph_pose graph_at(const struct graph *graph, uint32_t half, double along_m);

/* Heading at the start and at the end of a half-edge, taken over its first or last 12 m. */
static inline int32_t graph_leave_bam(const struct graph *graph, uint32_t half)
{
	return graph->leave_bam[half];
}
static inline int32_t graph_arrive_bam(const struct graph *graph, uint32_t half)
{
	return (int32_t)((uint32_t)graph->leave_bam[half ^ 1u] + 0x80000000u);
}

/* Turn from the end of one half-edge into another, clockwise positive. */
static inline int32_t graph_turn_bam(const struct graph *graph, uint32_t from, uint32_t to)
{
	return bam_diff(graph_leave_bam(graph, to), graph_arrive_bam(graph, from));
}

/* Is the move from the end of `from` into `to` forbidden by a turn restriction? Binary search. */
bool graph_turn_forbidden(const struct graph *graph, uint32_t from, uint32_t to);

/* Half-edges that a car at the end of `half` can take, in the order of the node's out-list; at most
 * GRAPH_SUCCESSORS_MAX. Private streets are included. Returns the count. */
uint32_t graph_successors(
	const struct graph *graph, uint32_t half, enum graph_rule rule, uint32_t out[static GRAPH_SUCCESSORS_MAX]);

/* Lanes in the direction of a half-edge, at least 1. */
uint32_t graph_lanes(const struct graph *graph, uint32_t half);

/* Offset of a lane's centre from the centre line; lane 0 is the one at the kerb, the last one is used when there are
 * fewer. */
double graph_lane_offset_m(const struct graph *graph, uint32_t half, uint32_t lane);

/* Point of one edge nearest to a place (city frame, m). */
struct graph_hit graph_project(const struct graph *graph, uint32_t edge, struct dvec2 at_m);

/* Edges that cars may use with a point within `radius_m` of a place, nearest first, ties by edge. Returns how many of
 * the `max` were written. Cost: the grid cells within the radius. */
uint32_t graph_nearest(
	const struct graph *graph, struct dvec2 at_m, double radius_m, struct graph_hit *out, uint32_t max);

#endif
