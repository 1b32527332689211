/*
 * Triangles of flat polygons: GEOS' constrained Delaunay triangulation for polygons with holes, ear clipping for the
 * small simple faces of roofs. Neither adds points, so neighbouring faces fit without cracks.
 */
#ifndef BLVD_TOOLS_BAKE_TRIANGULATE_H
#define BLVD_TOOLS_BAKE_TRIANGULATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "platform/base/vec.h"
#include "tools/city/pool.h"

typedef ARRAY(uint32_t) index_array;

/* One a thread. NULL when GEOS cannot be set up. */
struct triangulator;
struct triangulator *triangulator_new(void);
void triangulator_free(struct triangulator *triangulator);

/* Rings one after the other, the first is the outer one; ring_first has ring_count + 1 entries. Appends to `out`
 * counter-clockwise triples of indices into points. False when the polygon is not valid; `out` is then unchanged. */
bool triangulate_rings(struct triangulator *triangulator, const struct dvec2 *points, const size_t *ring_first,
	size_t ring_count, index_array *out);

/* A simple counter-clockwise ring, given by its corners in order; always yields count - 2 triangles, also when corners
 * lie on a line. Indices are into `points`. */
void triangulate_face(const struct dvec2 *points, size_t count, index_array *out);

#endif
