/* A set's triangles ready for drawing: every triangle with three vertices of its own, so that the vertex's number names
 * the triangle; object after object, opaque ones before decals. */
#ifndef BLVD_TOOLS_IMPOSTOR_CAPTURE_BATCH_H
#define BLVD_TOOLS_IMPOSTOR_CAPTURE_BATCH_H

#include "tools/impostor/triangle_set.h"

struct capture_triangle {
	uint32_t object;
	uint32_t bit; /* of the object's */
	int8_t normal_oct[2];
	uint8_t kind; /* enum pkg_material_kind */
	uint8_t seed;
	bool decal;
};
/* Triangles of one object and pass. */
struct capture_range {
	uint32_t object;
	uint32_t first, count;
};
struct capture_batch {
	ARRAY(struct pkg_mesh_vertex) vertices; /* 3 a triangle */
	ARRAY(struct capture_triangle) triangles;
	ARRAY(struct capture_range) ranges;
	size_t first_range[PKG_PASS_COUNT + 1]; /* into ranges, of each pass */
	uint8_t *chunk_state;                   /* not looked at yet, good, damaged */
};

void capture_batch_finish(struct capture_batch *batch);
/* Replaces what it held. Chunks that fail pkg_chunk_check() are left out, with a line in the log the first time. The
 * package is the same in all calls. */
void capture_batch_fill(struct capture_batch *batch, const struct pkg *pkg, const struct triangle_set *set);

#endif
