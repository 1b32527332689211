/*
 * Where a representation shows nothing though the geometry itself is there; by truth, not by colour, so that a wall in
 * the sky's colour counts.
 */
#ifndef BLVD_TOOLS_MEASURE_HOLES_H
#define BLVD_TOOLS_MEASURE_HOLES_H

#include "tools/measure/truth_image.h"

struct holes {
	uint64_t pixels;    /* of the picture */
	uint64_t drawn;     /* something is in the reference */
	uint64_t uncovered; /* ... but nothing in the representation */
	/* ... of these, such as are a slit in a surface: to the left and right of it, or above and below, something is
	 * within 2 px, and the reference is open nowhere within 2 px. An outline that has moved makes no crack. */
	uint64_t cracks;
};

/* Sets a byte a pixel where an image shows nothing; the others stay. A gap that is thinner than a pixel is open in some
 * samples of it only (displacement.h): to be called for each. */
void holes_mark_open(const struct truth_image *reference, uint8_t *open);

/* Images of one size and eye, looked at in the pixels' centres. `open` NULL: the reference is open where it shows
 * nothing. `map`, unless NULL, gets one byte a pixel: 0, 1 uncovered, 2 crack. */
void holes_find(const struct truth_image *reference, const uint8_t *open, const struct truth_image *shown,
	struct holes *out, uint8_t *map);

#endif
