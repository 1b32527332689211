/*
 * Borders between labels, traced along the sides of pixels: chains from junction to junction, or closed. Every side of
 * a pixel between two labels is in exactly one chain.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_CONTOURS_H
#define BLVD_TOOLS_IMPOSTOR_CONTOURS_H

#include <stdbool.h>
#include <stdint.h>

#include "tools/city/pool.h"

struct contour_point {
	float x, y; /* px */
};
/* Its first and last point are corners of pixels, those between are the middles of the sides that it follows. */
struct chain {
	uint32_t first, count; /* points */
	uint32_t left, right;  /* labels, 0 outside; left with y down: where x grows, what is above */
	bool closed;           /* the first point is the last again */
};
struct contours {
	ARRAY(struct contour_point) points;
	ARRAY(struct chain) chains;
	ARRAY(uint8_t) sides; /* scratch, by corner */
};

/* Replaces what `contours` has. Outside of the image is label 0. */
void contours_trace(struct contours *contours, const uint32_t *label, uint32_t width, uint32_t height);
void contours_finish(struct contours *contours);

#endif
