/* When two pixels of one capture, or a pixel and what another capture shows, are the same surface. */
#ifndef BLVD_TOOLS_IMPOSTOR_SURFACE_MATCH_H
#define BLVD_TOOLS_IMPOSTOR_SURFACE_MATCH_H

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "tools/impostor/capture.h"
#include "tools/impostor/oct_normal.h"

#define SURFACE_COSINE_MIN 0.7 /* between normals of one surface; stored normals are coarse and walls may be round */

static inline bool surface_normals_agree(const int8_t a[2], const int8_t b[2])
{
	if (abs(a[0] - b[0]) + abs(a[1] - b[1]) < 24)
		return true;
	struct dvec3 m = oct_normal(a), n = oct_normal(b);
	double dot = m.x * n.x + m.y * n.y + m.z * n.z;
	double squares = (m.x * m.x + m.y * m.y + m.z * m.z) * (n.x * n.x + n.y * n.y + n.z * n.z);
	return dot > 0 && dot * dot > SURFACE_COSINE_MIN * SURFACE_COSINE_MIN * squares;
}

/* Neighbours in one capture: no jump between them that exceeds `tolerance` of disparity. */
static inline bool surface_continues(const struct capture_pixel *a, const struct capture_pixel *b, double tolerance)
{
	if (a->object != b->object || !a->object || a->kind != b->kind)
		return false;
	if (a->triangle == b->triangle && a->triangle != PKG_NONE)
		return true;
	return fabs((double)a->disparity - b->disparity) <= tolerance &&
		   surface_normals_agree(a->normal_oct, b->normal_oct);
}

#endif
