/*
 * Where a view cell is looked at from, and which part of each picture has something in it. A face is 90 degrees of the
 * horizon; captures look front, and to both sides as far as the cell's half-space goes.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_CELL_VIEWS_H
#define BLVD_TOOLS_IMPOSTOR_CELL_VIEWS_H

#include "tools/impostor/capture.h"
#include "tools/impostor/view_cell.h"

/* A place of the view cell: shares of its axis (0 start, 1 end; the overrun is beyond), of its half width (-1 left to
 * 1 right) and of its eye heights (0 lowest to 1 highest). */
struct cell_pose {
	double along, aside, height;
	bool behind, beyond; /* by the overrun: before the start, after the end */
};
struct dvec3 cell_eye(const struct view_cell *cell, const struct cell_pose *pose);

static inline bool same_eye(const struct dvec3 *a, const struct dvec3 *b)
{
	return a->x == b->x && a->y == b->y && a->z == b->z;
}

/* Horizontal unit vector from start to end. */
struct dvec3 cell_axis(const struct view_cell *cell);

enum cell_face { CELL_FRONT, CELL_LEFT, CELL_RIGHT, CELL_BACK };

/* The whole face at `focal_px`: 45 degrees to all sides. With `half`, of left and right only what lies in front. */
struct capture_view cell_face_view(
	const struct view_cell *cell, struct dvec3 eye, enum cell_face face, bool half, double focal_px);

/* Corners of triangles, three a triangle, metres of the city frame. */
typedef ARRAY(struct dvec3) corner_array;

/* Corners of the set's triangles. */
void set_corners(const struct pkg *pkg, const struct triangle_set *set, corner_array *out);

/* Crops a view to the pixels that some triangle may touch, and one more to each side; the pixels that are left stay
 * where they were. False: none. */
bool view_crop(struct capture_view *view, const corner_array *corners);

#endif
