/*
 * Polygons of the data made sound by GEOS: no self-crossing, outer rings counter-clockwise, holes clockwise, no
 * repeated points. Whatever cannot be saved is counted and dropped.
 */
#ifndef BLVD_TOOLS_READ_SHAPE_H
#define BLVD_TOOLS_READ_SHAPE_H

#include <geos_c.h>
#include <stdbool.h>

#include "tools/city/city.h"

typedef ARRAY(struct polygon) polygon_array;

struct shaper {
	GEOSContextHandle_t geos;
	struct pool *pool;     /* results go there; borrowed */
	struct report *report; /* borrowed */
};

void shaper_init(struct shaper *shaper, struct pool *pool, struct report *report);
void shaper_finish(struct shaper *shaper);

/* A ring from points in order, with or without the repeated first point. Repeated points and points on the way back
 * (spikes of no width) are taken out and counted once. False when fewer than three remain: nothing is counted then. */
bool shape_ring(struct shaper *shaper, int64_t id, const struct dvec2 *points, size_t count, struct ring *out);

/* Appends the sound polygons of one outer ring and its holes; usually one, none when it is degenerate (counted as
 * dropped). Pieces smaller than `least_m2` are not kept. Returns the number appended. */
size_t shape_polygons(
	struct shaper *shaper, int64_t id, const struct polygon *from, double least_m2, polygon_array *out);

/* GEOS geometry of a polygon (owned by the caller, NULL when GEOS fails) and back (appended, oriented, cleaned). */
GEOSGeometry *shape_to_geos(const struct shaper *shaper, const struct polygon *polygon);
size_t shape_from_geos(const struct shaper *shaper, const GEOSGeometry *geometry, double least_m2, polygon_array *out);

/* Without the holes' area; > 0. */
double polygon_area(const struct polygon *polygon);

#endif
