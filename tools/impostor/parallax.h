/*
 * How far a wrong disparity moves a pixel when the eye moves through the view cell (Chen and Williams 1993, "View
 * Interpolation for Image Synthesis", for the forward map), and the map of one capture's pixels into another's.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_PARALLAX_H
#define BLVD_TOOLS_IMPOSTOR_PARALLAX_H

#include "tools/impostor/capture.h"
#include "tools/impostor/view_cell.h"

#define VIEW_CELL_CORNERS 8

/* The view cell's corners as eye offsets in a capture's frame, m. */
struct parallax {
	struct {
		double right, up, forward;
	} offset[VIEW_CELL_CORNERS];
	double forward_max; /* farthest that the eye comes towards what the capture sees; >= 0 */
	double focal_px;    /* of the capture */
	double centre_x, centre_y;
};

/* Corners of the box of eyes, city frame: first the four near `start`, then the four near `end`. */
void view_cell_corners(const struct view_cell *cell, struct dvec3 corners[VIEW_CELL_CORNERS]);

struct parallax parallax_of(const struct view_cell *cell, const struct capture_view *view);

/* How much larger than in the capture a thing at this disparity gets; bounded for what the eye may run into. */
double parallax_magnification(const struct parallax *parallax, double disparity);

/* The error of disparity at a pixel position that moves it by one pixel of the capture somewhere in the view cell. */
double parallax_tolerance(const struct parallax *parallax, double x, double y, double disparity);

/* Maps (x, y, disparity) of one capture to another's: homogeneous, one division. */
struct reprojection {
	double row[3][4]; /* x d, y d, d of (x, y, 1, disparity); the disparity there is disparity / d */
};
struct reprojection reprojection_of(const struct capture_view *from, const struct capture_view *to);

/* False behind the other eye. */
static inline bool reproject(const struct reprojection *map, double x, double y, double disparity, double out[3])
{
	double at[3];
	for (int i = 0; i < 3; i++)
		at[i] = map->row[i][0] * x + map->row[i][1] * y + map->row[i][2] + map->row[i][3] * disparity;
	if (!(at[2] > 1e-6))
		return false;
	double inverse = 1 / at[2];
	out[0] = at[0] * inverse;
	out[1] = at[1] * inverse;
	out[2] = disparity * inverse;
	return true;
}

#endif
