/*
 * Regions of a capture, each of which one plane in disparity stands for.
 *
 * A plane in space is a plane in disparity over the image (FACTS, "Parallax"), so a facade is one exact fit. Seeds are
 * connected pixels of one object and normal that lie on one plane; neighbouring regions are then joined, best fit
 * first, while the plane through the union keeps the pixels within their tolerance, going by samples. Regions of a few
 * pixels go to the neighbour that fits best. In the end every pixel is looked at, and those that are off by more than a
 * tenth over their tolerance get regions of their own. The same image gives the same regions.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_SURFACES_H
#define BLVD_TOOLS_IMPOSTOR_SURFACES_H

#include <stdbool.h>

#include "tools/impostor/borders.h"
#include "tools/impostor/capture.h"
#include "tools/impostor/plane_fit.h"

struct surface {
	struct plane plane;
	uint32_t pixels;
	float least_disparity; /* of its pixels */
	float least_fitted;    /* of the plane at its pixels; not positive: a plane that does not fit */
	uint32_t object;       /* + 1; these four of the largest part */
	int8_t normal_oct[2];
	uint8_t kind;                        /* enum pkg_material_kind */
	uint16_t min_x, min_y, max_x, max_y; /* pixels, both included */
};
struct surfaces {
	uint32_t width, height;
	uint32_t *label; /* of each pixel: index of its surface + 1; 0: not to be shown */
	ARRAY(struct surface) items;
};

struct surfaces_input {
	bool continuous; /* instead of planes: what is connected without a jump, however bent ([S97] 4.2) */
	const struct capture_image *image;
	const uint8_t *owned;   /* not 0: to be shown; only pixels that have an object */
	const float *tolerance; /* of disparity, at owned pixels */
	double per_px;          /* pixels of the image in one of the screen, along a line */
	float gap_px;           /* pieces of an object may join over gaps as wide as this */
	uint32_t swallow_px;    /* regions of so many pixels or fewer may be swallowed by another */
};

void surfaces_find(struct surfaces *surfaces, const struct surfaces_input *input);
void surfaces_finish(struct surfaces *surfaces);

#endif
