/*
 * What a picture shows and where, pixel by pixel: the words of renderer_draw_truth() with the view that they were drawn
 * from. Header only.
 */
#ifndef BLVD_TOOLS_MEASURE_TRUTH_IMAGE_H
#define BLVD_TOOLS_MEASURE_TRUTH_IMAGE_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>

#include "platform/base/vec.h"
#include "render/view.h"

/* What stands for an object where the ground or water is seen: a package cuts both into tiles, which cannot be seen. */
#define TRUTH_GROUND UINT32_C(0x7ffffff0)
#define TRUTH_WATER UINT32_C(0x7ffffff1)

struct truth_pixel {
	uint32_t object;     /* + 1, or one of the above; 0: nothing is there, the rest is 0 then */
	float from_eye_m[3]; /* world axes */
};
static_assert(sizeof(struct truth_pixel) == 16, "as the GPU writes it");

/* Rows from the top; the centre of pixel (x, y) is at (x + 0.5, y + 0.5). `pixels` is borrowed. */
struct truth_image {
	uint32_t width, height;
	double focal_px;                /* pixels of 1 m at 1 m */
	struct dvec2 sample_px;         /* where in a pixel it was looked at, from the centre; x right, y down */
	struct vec3 right, up, forward; /* unit, world axes; the view's axis meets the picture's middle */
	const struct truth_pixel *pixels;
};

static inline struct truth_image truth_image_of(
	const struct view *view, struct dvec2 sample_px, const struct truth_pixel *pixels)
{
	return (struct truth_image){ .width = view->width,
		.height = view->height,
		.focal_px = (double)view->focal_px,
		.sample_px = sample_px,
		.right = view->right,
		.up = view->up,
		.forward = view->forward,
		.pixels = pixels };
}

/* Depth along the view's axis, m. */
static inline double truth_depth_m(const struct truth_image *image, const struct truth_pixel *pixel)
{
	const float *p = pixel->from_eye_m;
	return (double)p[0] * (double)image->forward.x + (double)p[1] * (double)image->forward.y +
		   (double)p[2] * (double)image->forward.z;
}

/* Where the place that a pixel shows belongs in the picture, px; false when it is not in front of the eye. */
static inline bool truth_project(const struct truth_image *image, const struct truth_pixel *pixel, double *x, double *y)
{
	const float *p = pixel->from_eye_m;
	double depth = truth_depth_m(image, pixel);
	if (!(depth > 1e-3))
		return false;
	double right = (double)p[0] * (double)image->right.x + (double)p[1] * (double)image->right.y +
				   (double)p[2] * (double)image->right.z;
	double up =
		(double)p[0] * (double)image->up.x + (double)p[1] * (double)image->up.y + (double)p[2] * (double)image->up.z;
	*x = image->width * 0.5 + image->focal_px * right / depth;
	*y = image->height * 0.5 - image->focal_px * up / depth;
	return true;
}

#endif
