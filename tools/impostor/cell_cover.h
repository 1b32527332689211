/*
 * From where a cell has to be captured. Every look is a set of points that have to be shown; after a capture the points
 * that it shows are struck off, and the next capture is made from the pose of the look that has most left. So captures
 * are few where little comes into view, and what stays uncovered is bounded at every look.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_CELL_COVER_H
#define BLVD_TOOLS_IMPOSTOR_CELL_COVER_H

#include "tools/impostor/cell_looks.h"

struct cover_point {
	struct dvec3 at;   /* city frame, m */
	uint32_t object;   /* + 1 */
	uint16_t look;     /* image of the looks */
	uint16_t x, y;     /* of its sample there: SAMPLE_PX pixels each */
	bool shown, alone; /* alone: too few like it beside it to be worth anything */
};
typedef ARRAY(struct cover_point) cover_array;

/* The points that the looks see of triangles of `set`, in front of their own eye along `axis`, one of four pixels. */
void cover_points(struct cell_looks *looks, const struct pkg *pkg, const struct triangle_set *set, struct dvec3 axis,
	cover_array *points);

/* Strikes off what a capture shows where it is wanted. */
void cover_strike(cover_array *points, const struct capture_image *image, const uint8_t *wanted);
/* Strikes off all points of looks from an eye: they have had their chance. */
void cover_strike_eye(cover_array *points, const struct cell_looks *looks, const struct dvec3 *eye);

/* The eye of the looks that has most points left, of those that are not alone. False: none has more than `at_most`. */
bool cover_next(cover_array *points, const struct cell_looks *looks, size_t at_most, struct dvec3 *eye);

/* Crops a view to the points that are left and not alone, and `margin_px` more. `eye` not NULL: only those of looks
 * from there. False: none. */
bool cover_crop(const cover_array *points, const struct cell_looks *looks, const struct dvec3 *eye, double margin_px,
	struct capture_view *view);

/* Pixels within `radius_px` of a point that is left, of looks from the image's eye. `wanted` as of impostor_wanted().
 */
void cover_wanted(const cover_array *points, const struct cell_looks *looks, const struct capture_image *image,
	int radius_px, uint8_t *wanted);

#endif
