/* Surfaces of CityJSON objects: planar polygons in space, made into footprints and triangles. */
#ifndef BLVD_TOOLS_READ_CITYJSON_SHAPE_H
#define BLVD_TOOLS_READ_CITYJSON_SHAPE_H

#include "tools/read/shape.h"

struct surface_ring {
	struct dvec3 *points; /* not repeated at the end */
	size_t count;
};

struct surface {
	struct surface_ring *rings; /* the outer one first */
	size_t ring_count;
	bool ground; /* GroundSurface: never seen */
};
typedef ARRAY(struct surface) surface_array;
typedef ARRAY(struct dvec3) triangle_array; /* 3 points each */

/* Unit normal by Newell's method (Sutherland et al. 1974); false for a surface without area. */
bool surface_normal(const struct surface *surface, struct dvec3 *out);

/* The union of what lies flat enough, seen from above. Returns the number of polygons appended. */
size_t surfaces_footprint(struct shaper *shaper, const surface_array *surfaces, polygon_array *out);

/* Appends the surface's triangles, facing as it does. False when it cannot be triangulated. */
bool surface_triangles(struct shaper *shaper, const struct surface *surface, triangle_array *out);

#endif
