/*
 * The street graph in the making (graph_*.c), and what later steps ask of a finished one. graph_build() of
 * tools/bake/bake.h runs the steps in the order in which they are declared here.
 *
 * Plane and heights. Streets live in integer millimetres of the city frame. A street's level is its layer: 0 on the
 * ground, 1 for a bridge and -1 for a tunnel without one. Streets of one level that meet or cross share a node; streets
 * of different levels pass each other. An edge that is a tunnel, or that crosses one of another level and is the
 * farther of the two from the ground, is off-plane; all others together are a planar subdivision, exactly (orientation
 * tests in integers, no tolerance).
 *
 * A bridge's surface keeps GRAPH_CLEARANCE_M + GRAPH_DECK_M over the surface of the street that it crosses, a tunnel's
 * GRAPH_CLEARANCE_M + GRAPH_COVER_M under it; ramps run on into the streets on both sides, no steeper than GRAPH_GRADE
 * unless the ground itself is. A street's points lie on the ground within GRAPH_GROUND_TOLERANCE_M, or on its ramp.
 */
#ifndef BLVD_TOOLS_CITY_GRAPH_H
#define BLVD_TOOLS_CITY_GRAPH_H

#include <stdbool.h>

#include "assets/pkg.h"
#include "tools/city/city.h"

#define GRAPH_NEAR_MISS_M 0.5
#define GRAPH_CLEARANCE_M 4.7
#define GRAPH_DECK_M 0.9  /* from a bridge's carriageway to the underside of its deck */
#define GRAPH_COVER_M 1.0 /* from the crown of a tunnel to the carriageway above it */
#define GRAPH_GRADE 0.08
#define GRAPH_GROUND_TOLERANCE_M 0.05

/*
 * Finds the face that a point lies in, exactly, by the nearest in-plane edge to the west (grid of rows and columns over
 * the edges). Reads a finished graph; outer faces answer with their parent.
 */
struct face_locator;
struct face_locator *face_locator_new(const struct pkg_graph *graph);
void face_locator_free(struct face_locator *locator);
/* The bounded face around a point (mm), or PKG_NONE. A point on an edge belongs to its east side. */
uint32_t face_locator_find(const struct face_locator *locator, int64_t east_mm, int64_t north_mm);

/* An inner point of a polygon: the middle of the longest stretch of the horizontal line halfway up that is inside. */
struct dvec2 polygon_inner_point(const struct polygon *polygon);

#endif
