/* The seeds that surfaces grow from: connected pixels of one object, kind and normal on one plane. */
#ifndef BLVD_TOOLS_IMPOSTOR_SURFACE_SEEDS_H
#define BLVD_TOOLS_IMPOSTOR_SURFACE_SEEDS_H

#include "tools/impostor/surfaces.h"

/* No more than this many, whatever the image. */
#define SURFACE_SEEDS_MAX 65536u

struct surface_seeds {
	ARRAY(struct plane_fit) fits;
	ARRAY(struct capture_pixel) kinds; /* a pixel of each, the first */
};

/* Fills label (width * height): index of the seed + 1, 0 where not owned. */
void surface_seeds_find(struct surface_seeds *seeds, const struct surfaces_input *input, uint32_t *label);
/* Adds an empty seed with a pixel's kind and normal; returns its label. */
uint32_t surface_seeds_new(struct surface_seeds *seeds, const struct capture_pixel *pixel);
/* Sums the pixels whose labels are greater than `from`. */
void surface_seeds_sum(
	struct surface_seeds *seeds, const struct surfaces_input *input, const uint32_t *label, size_t from);
void surface_seeds_finish(struct surface_seeds *seeds);

#endif
