/*
 * How far a representation displaces what it shows, in pixels, against the geometry itself seen from the same eye.
 *
 * A pixel q of the representation shows a place Y, whose own position in the picture is project(Y). What is seen at q
 * is therefore displaced by |project(Y) - q|, whatever was drawn to show it. For a pixel p of the reference, which
 * shows a place X of an object, the displacement is that of the pixel q that shows the same place: of the same object,
 * projected to within 1.5 px of p in either direction, and as deep as the object is around p in the reference (samples
 * of 3 x 3 pixels, and a margin of three pixels' footprint). The distance is measured in the picture and not along the
 * surface, so that facades seen at a grazing angle, where neighbouring pixels are metres apart, need no special care.
 * Ground and water do: far away a pixel is hundreds of metres deep, and where only a gap shows them the samples around
 * may all lie at one end of that. They are also as deep as a level plane through X is within 1.5 px above and below p.
 * How far project(Y) is from the pixel p beyond half a pixel's diagonal is added: at an outline that is off by one
 * pixel the nearest thing shown lies next to p. Of all such q the one with the smallest sum counts.
 *
 * So equal pictures give 0, a picture moved by k pixels gives k, and a place that is not shown within 16 px is not
 * found. Positions must be those of the true surface, not of the triangles that stand for it.
 *
 * What is thinner than a pixel is seen at a pixel's middle or not, as it happens: the geometry itself, moved by a
 * quarter of a pixel, would not show 5 % of the far pixels of a street with railings. So both pictures are looked at in
 * displacement_samples besides, which what is an eighth of a pixel thin cannot slip through.
 */
#ifndef BLVD_TOOLS_MEASURE_DISPLACEMENT_H
#define BLVD_TOOLS_MEASURE_DISPLACEMENT_H

#include <stddef.h>

#include "tools/measure/truth_image.h"

#define DISPLACEMENT_REACH_PX 16.0
#define DISPLACEMENT_NOTHING (-1.0f) /* the reference shows nothing here */

/* Where in a pixel: from its middle, px. No two in one row or column. */
#define DISPLACEMENT_SAMPLES 8
extern const struct dvec2 displacement_samples[DISPLACEMENT_SAMPLES];

/* How deep a pixel's object is in it, m. */
struct displacement_depth {
	float min_m, max_m;
};

/* One value a pixel of the reference: px up to DISPLACEMENT_REACH_PX, DISPLACEMENT_NOTHING, or infinity where the place
 * is not found: all of them to begin with, until what is shown is offered, once for every sample. Depths are those of
 * the pixels' middles to begin with; each sample of the reference widens them. All images are of one size and eye.
 * Linear in the number of pixels. */
void displacement_begin(const struct truth_image *reference, float *map);
void displacement_depths(const struct truth_image *reference, struct displacement_depth *depths);
void displacement_widen(
	const struct truth_image *reference, const struct truth_image *sample, struct displacement_depth *depths);
void displacement_offer(const struct truth_image *reference, const struct displacement_depth *depths,
	const struct truth_image *shown, float *map);

/* What is far from a street: farther than near_m, seen from above, from the axis between two places given from the
 * eye. */
struct far_limit {
	struct dvec2 from_m, to_m;
	double near_m;
};
bool far_limit_beyond(const struct far_limit *limit, const struct truth_pixel *pixel);

/* Pixels by displacement. Classes end at these; the last holds what was not found. Sums over frames are exact. */
#define DISPLACEMENT_CLASSES 10
extern const double displacement_class_px[DISPLACEMENT_CLASSES]; /* 0.01, 1/8, 1/4, ... 16, infinity */
struct displacement_count {
	uint64_t pixels[DISPLACEMENT_CLASSES];
	double max_px; /* of those found */
};

/* Adds the far pixels of a map. `limit` NULL: all of the reference's. */
void displacement_add(struct displacement_count *count, const struct truth_image *reference, const float *map,
	const struct far_limit *limit);
void displacement_join(struct displacement_count *count, const struct displacement_count *add);

uint64_t displacement_total(const struct displacement_count *count);
/* Share of the pixels displaced by at most `px`, which must be a class's end; 1 without pixels. */
double displacement_share(const struct displacement_count *count, double px);
double displacement_share_lost(const struct displacement_count *count);
/* The value that a share `quantile` of the pixels does not exceed: linear within its class, infinity when it was not
 * found; 0 without pixels. */
double displacement_quantile(const struct displacement_count *count, double quantile);

#endif
