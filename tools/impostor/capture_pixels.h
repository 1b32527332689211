/* From what the GPU wrote, triangle numbers and colours, to a capture's pixels. */
#ifndef BLVD_TOOLS_IMPOSTOR_CAPTURE_PIXELS_H
#define BLVD_TOOLS_IMPOSTOR_CAPTURE_PIXELS_H

#include "tools/impostor/capture.h"
#include "tools/impostor/capture_batch.h"

/* Disparity over the image: exact on a triangle's plane, where it is affine. */
struct capture_plane {
	double at_origin, per_x, per_y; /* at position (0, 0), per pixel */
	float low, high;                /* of the triangle's corners */
	uint32_t drawing;               /* the plane is of this one */
};
struct capture_planes {
	ARRAY(struct capture_plane) items; /* as many as triangles; worked out for those that are seen */
	uint32_t drawing;
};

/* `seen`: the triangle + 1 at each pixel's centre; `rgba` NULL or the colours there. Single pixels between pieces of
 * one surface, through which something behind it shows, are closed in both. Fills in out->pixels. */
void capture_pixels_fill(const struct pkg *pkg, const struct capture_batch *batch, struct capture_planes *planes,
	uint32_t *seen, uint8_t *rgba, struct capture_image *out);

/* `rgba` at the pixels' centres; `fine_seen` and `fine_rgba` of the same view at twice the resolution. A pixel's colour
 * is the mean of the five samples in it that show the same object, shaded alike, as its centre: nothing of what is in
 * front or behind gets in. Fills in out->rgba. */
void capture_pixels_color(const struct capture_batch *batch, const uint32_t *seen, const uint8_t *rgba,
	const uint32_t *fine_seen, const uint8_t *fine_rgba, struct capture_image *out);

#endif
