/*
 * Weighted straight skeleton of a polygon with holes: what a roof is made of. Every edge of the outline moves inwards
 * with its own speed; where the moving edges meet are the roof's ridges, hips and valleys, and what one edge sweeps is
 * one roof face. An edge of speed 0 stays: its face is a vertical gable.
 *
 * After Aichholzer, Aurenhammer, Alberts, Gaertner, "A Novel Type of Skeleton for Polygons", 1995; the wavefront with
 * linked vertices follows Felkel and Obdrzalek, "Straight Skeleton Implementation", 1998. Quadratic per event: meant
 * for outlines of at most a few hundred edges. Points are moved by up to 0.4 mm inside, so that no two events fall
 * together; the result names the points as given.
 */
#ifndef BLVD_TOOLS_BAKE_SKELETON_H
#define BLVD_TOOLS_BAKE_SKELETON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "platform/base/vec.h"
#include "tools/city/pool.h"

struct skeleton_node {
	struct dvec2 at;
	double t; /* when the wavefront was here: distance from an edge of speed 1 */
};

/* The face of one edge: nodes counter-clockwise, the first two are the ends of the edge. A gable's face has no area in
 * the plan: its nodes lie on one line. */
struct skeleton_face {
	uint32_t first, count; /* into face_nodes; count 0: nothing left of it */
	uint32_t edge;         /* of the outline */
	bool upright;
};

struct skeleton {
	ARRAY(struct skeleton_node) nodes; /* the outline's points come first, in order, t 0 */
	ARRAY(uint32_t) face_nodes;
	ARRAY(struct skeleton_face) faces; /* at least one an edge; a half hip has two */
	double t_max;
};

struct skeleton_outline {
	const struct dvec2 *points; /* all rings one after the other, the interior to the left */
	const size_t *ring_first;   /* ring_count + 1 indices into points */
	size_t ring_count;
	const double *speed; /* of the edge that starts at each point: 1 eaves, 0 gable */
	const double *delay; /* NULL, or by edge: the time until which it stands, and moves with speed 1 from then */
};

/* False when no valid skeleton was found (crossing outline, numeric trouble, nothing moves): the areas of the faces are
 * checked against the outline's. `out` must be zeroed or from an earlier call. */
bool skeleton_build(const struct skeleton_outline *outline, struct skeleton *out);
void skeleton_finish(struct skeleton *skeleton);

#endif
