/*
 * Geometry of a view cell: its corners, the points that visibility is sampled from, distances from its axis.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_EYE_BOX_H
#define BLVD_TOOLS_IMPOSTOR_EYE_BOX_H

#include <stdbool.h>

#include "tools/city/pool.h"
#include "tools/impostor/view_cell.h"

struct eye_box {
	struct dvec2 start, end; /* of the axis */
	struct dvec3 corners[8]; /* every eye is in their hull */
	ARRAY(struct dvec3)
	samples; /* every eye is within PKG_OCCLUDER_SHRINK_MM of one, horizontally, and no higher */
};

void eye_box_init(struct eye_box *box, const struct view_cell *cell);
void eye_box_finish(struct eye_box *box);

/* Does the front of a triangle (counter-clockwise) face any eye? A triangle without area faces none. */
bool eye_box_faces(const struct eye_box *box, const struct dvec3 triangle[3]);

/* Metres from the axis to a convex polygon, seen from above; 0 where they meet. */
double eye_box_distance(const struct eye_box *box, const struct dvec2 *corners, int count);
/* The polygon's farthest point from the axis. */
double eye_box_reach(const struct eye_box *box, const struct dvec2 *corners, int count);

#endif
