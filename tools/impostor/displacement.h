/*
 * How far a wrong disparity moves a point on the screen, at worst, while the eye moves through the view cell.
 *
 * A pixel's ray has the direction d (forward part 1); the point on it at disparity w is d / w from the capture's eye,
 * an eye of the cell is at o from there. Drawn at disparity w_m, the point is seen off by the angle whose sine is |o x
 * d| |w - w_m| / (|d - o w| |d - o w_m|) (FACTS, "Parallax", for any direction). Headings are free, so the angle times
 * the screen's focal length is the displacement. Here it is bounded by |w - w_m| (gain(w) + gain(w_m)) / 2 with gain(w)
 * = max over o of (|l| / |d|) / (1 - s w / |d|)^2,    l across the ray, s along it, by the means' inequality; the
 * maximum is on an edge of the box, since for equal s the convex |l| is largest at the rim. gain is tabulated by blocks
 * of pixels and knots of disparity and never too small; a few ns a question.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_DISPLACEMENT_H
#define BLVD_TOOLS_IMPOSTOR_DISPLACEMENT_H

#include "tools/impostor/capture.h"
#include "tools/impostor/view_cell.h"

#define DISPLACEMENT_KNOTS 9

struct displacement {
	struct dvec3 corners[8]; /* of the box of eyes, right, up, forward of the capture's eye, m */
	double focal_px;         /* of the screen */
	double capture_focal_px, centre_x, centre_y;
	double disparity_max; /* of the table; beyond it questions are slower */
	uint32_t block_px, blocks_x, blocks_y;
	float *gains; /* DISPLACEMENT_KNOTS a block; the first is negative while the block is not made */
};

/* `disparity_max`: the largest that the capture has. Owns its table. */
void displacement_init(struct displacement *displacement, const struct view_cell *cell, const struct capture_view *view,
	double focal_px, double disparity_max);
void displacement_finish(struct displacement *displacement);

/* Screen px; points that some eye comes nearer to than a twentieth of their distance count as if it did not. */
double displacement_px(struct displacement *displacement, double x, double y, double w, double drawn);
/* The disparity error that keeps the displacement within `px`. */
double displacement_tolerance(struct displacement *displacement, double x, double y, double w, double px);
/* Screen px that a pixel of the capture spans at most, seen from the cell. */
double displacement_scale(const struct displacement *displacement, double x, double y, double w);

#endif
