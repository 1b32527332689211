/*
 * The quickest route over the street graph: A* over half-edges (Hart, Nilsson, Raphael 1968; half-edges as states so
 * that turn restrictions and turn costs are exact, Winter 2002 "Modeling costs of turns in route planning"). Costs are
 * whole milliseconds, so that the same graph gives the same route on every machine; ties are broken by half-edge
 * number.
 *
 * Memory: graph-sized arrays from the arena at route_init(), nothing later. Work: route_begin() starts a search,
 * route_step() does a bounded part of it, so that a frame is never held up.
 *
 * The cost of a route: travel time by class and limit, plus turns, signals, stops. Private streets may be entered only
 * where the route starts or ends: entering one costs ten minutes.
 */
#ifndef BLVD_NAV_ROUTE_H
#define BLVD_NAV_ROUTE_H

#include "nav/graph.h"

#define ROUTE_STOPS_MAX 16
#define ROUTE_FORBIDDEN UINT32_MAX

struct route_place {
	uint32_t half;
	double along_m;
};

struct route_request {
	struct route_place start;
	bool start_either; /* the car may set off against start.half as well, where that is allowed */
	struct route_place stops[ROUTE_STOPS_MAX]; /* visited in order, the last is the destination; reached in either
												  direction of the edge that cars may drive */
	uint32_t stop_count;                       /* 1 to ROUTE_STOPS_MAX */
};

/* Half-edges in driving order. The car starts on halves[0] at start_along_m and arrives on the last at end_along_m. */
struct route {
	uint32_t *halves;
	uint32_t count, capacity;
	double start_along_m, end_along_m;
	uint32_t leg_last[ROUTE_STOPS_MAX]; /* index of the half-edge that stop k lies on */
	double leg_along_m[ROUTE_STOPS_MAX];
	uint32_t leg_count;
	uint64_t cost_ms;
};

enum route_state {
	ROUTE_IDLE,
	ROUTE_WORKING,
	ROUTE_FOUND,
	ROUTE_NONE,     /* stop number `leg` cannot be reached */
	ROUTE_TOO_LONG, /* more half-edges than the capacity */
};

struct route_label {
	uint32_t cost_ms; /* from the leg's start to the origin of the half-edge */
	uint32_t parent;  /* half-edge before it, or a start mark */
	uint32_t heap_at; /* place in the heap, or none */
	uint32_t stamp;   /* search this label belongs to */
};

struct route_search {
	const struct graph *graph;
	uint32_t *edge_ms;     /* travel time of an edge */
	uint32_t *edge_mm_s;   /* speed taken for it, mm/s */
	uint32_t fastest_mm_s; /* over the graph */
	struct route_label *labels;
	uint32_t *heap, *heap_key; /* half-edges by cost and bound */
	uint32_t heap_count, stamp;
	struct route_request request;
	uint32_t leg;
	struct route_place leg_start;
	bool leg_either;
	enum route_state state;
	uint64_t settled;   /* half-edges settled since route_begin(), for stats */
	struct route route; /* valid in ROUTE_FOUND */
};

/* `capacity`: half-edges of the longest route, 0 for a default. Returns 0 or -ENOMEM. */
int route_init(struct route_search *search, struct arena *arena, const struct graph *graph, uint32_t capacity);

/* Starts a search, dropping one under way. The request is copied. A request with no stops or with a half-edge out of
 * range ends in ROUTE_NONE. */
void route_begin(struct route_search *search, const struct route_request *request);

/* Settles up to `max_settled` half-edges and says where the search stands. */
enum route_state route_step(struct route_search *search, uint32_t max_settled);

/* The whole search at once, for tools. */
enum route_state route_find(struct route_search *search, const struct route_request *request);

/* The place on a street cars may use that is meant by a place in the plane: the nearest one, but one of the largest
 * connected part is preferred if it is at most 40 m farther. Returns false when none is within `radius_m`. */
bool route_snap(const struct graph *graph, struct dvec2 at_m, double radius_m, struct route_place *out);

/* Time in ms to drive the whole of a half-edge. */
static inline uint32_t route_edge_ms(const struct route_search *search, uint32_t half)
{
	return search->edge_ms[half >> 1];
}

/* Time to drive `length_m` on it. */
uint32_t route_part_ms(const struct route_search *search, uint32_t half, double length_m);

/* Extra time at the node between two half-edges, ROUTE_FORBIDDEN when the move is not allowed. */
uint32_t route_turn_ms(const struct graph *graph, uint32_t from, uint32_t to);

#endif
