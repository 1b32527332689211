/*
 * A rectangle of ground cut into faces by line work. Lines may cross, touch and overlap; the faces cover the
 * rectangle once and share their vertices, so nothing overlaps and nothing gapes. The caller then says what each face
 * is from a point inside it.
 */
#ifndef BLVD_TOOLS_BAKE_PARTITION_H
#define BLVD_TOOLS_BAKE_PARTITION_H

#include "platform/base/vec.h"
#include "tools/impostor/cdt.h"

#define PARTITION_LATTICE_M 0.005 /* vertices lie on multiples of it in the city frame */

struct partition_face {
	struct dvec2 inside; /* centre of its largest triangle */
	double area_m2;
	uint32_t tag; /* the caller's */
};

struct partition {
	struct dvec2 min, max;
	int64_t low[2]; /* lattice coordinates of the south-west corner */
	struct cdt cdt;
	ARRAY(uint32_t) face_of; /* by triangle */
	ARRAY(struct partition_face) faces;
};

/* The rectangle is widened to the lattice; at most 5 km long. */
void partition_begin(struct partition *partition, struct dvec2 min, struct dvec2 max);
void partition_finish(struct partition *partition);

/* Cuts along a -> b, as far as it lies in the rectangle. */
void partition_cut(struct partition *partition, struct dvec2 a, struct dvec2 b);
void partition_cut_line(struct partition *partition, const struct dvec2 *points, size_t count, bool closed);

/* Finds the faces; no cuts after this. */
void partition_faces(struct partition *partition);

struct dvec2 partition_vertex(const struct partition *partition, uint32_t vertex);
/* The triangle at a place, or CDT_NONE outside; found fast when it is near triangle `start`. */
uint32_t partition_triangle_at(const struct partition *partition, uint32_t start, struct dvec2 at);
/* The face at a place, or CDT_NONE outside. */
uint32_t partition_face_at(const struct partition *partition, struct dvec2 at);

/* Clips a -> b to a rectangle; false when nothing is left. */
bool clip_segment(struct dvec2 min, struct dvec2 max, struct dvec2 *a, struct dvec2 *b);

#endif
