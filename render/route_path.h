/*
 * The line that the route ribbon follows: the route's polylines moved into the lane, with rounded corners. Pure
 * geometry, no GL. `s` is the distance along the street's own centre lines, so a car's place on the route is known
 * without projecting it.
 */
#ifndef BLVD_RENDER_ROUTE_PATH_H
#define BLVD_RENDER_ROUTE_PATH_H

#include <stdbool.h>

#include "assets/pkg.h"
#include "nav/nav.h"
#include "platform/base/arena.h"
#include "platform/base/vec.h"

struct route_path_point {
	struct dvec3 at; /* from the path's origin, m */
	double s;        /* m from the path's start along the centre lines */
	double half_width;
};

/* One half-edge of the path and where it begins and ends. */
struct route_path_half {
	uint32_t half;
	double s_start, s_end;
};

struct route_path {
	int64_t origin_mm[3];
	struct route_path_point *points;
	uint32_t count, capacity;
	struct route_path_point *raw; /* the centre line; scratch of route_path_build */
	double *raw_offset;           /* of the segment after each raw point, m to the right */
	uint32_t raw_count;
	struct route_path_half halves[NAV_ROUTE_AHEAD_MAX + 1];
	uint32_t half_count;
	bool whole;        /* ends at the destination, not at the window's end */
	uint32_t previous; /* half-edge driven before route[0], kept behind the car; PKG_NONE */
	uint64_t shape;    /* hash of what it was built from */
};

/* `points` 0 takes 4,096. Returns 0 or -ENOMEM. */
int route_path_init(struct route_path *path, struct arena *arena, uint32_t points);

/* Builds again when the route in `nav` is another than last time; true when it did. Hostile half-edges end the path.
 * Without a route the path is empty. */
bool route_path_follow(struct route_path *path, const struct pkg *pkg, const struct nav_view *nav);

/* The car's place on the path. */
double route_path_car_s(const struct route_path *path, const struct nav_view *nav);

/* Where a half-edge of the path begins and ends, the first one at or after the car; false when it is not on it. */
bool route_path_find(const struct route_path *path, uint32_t half, struct route_path_half *out);

/* The point at `s`, clamped to the ends, and the unit direction there (horizontal). count must be >= 2. */
struct dvec3 route_path_at(const struct route_path *path, double s, struct dvec2 *direction);

/* Unit normal to the right at point i, scaled so that a ribbon keeps its width in the bend (at most 1.6). */
struct dvec2 route_path_side(const struct route_path *path, uint32_t i);

#endif
