/* Separable filters on one channel; the border repeats. Cost: pixels times taps, row by row so that it vectorises. */
#ifndef BLVD_TOOLS_MEASURE_FILTER_H
#define BLVD_TOOLS_MEASURE_FILTER_H

#include <stdint.h>

#define FILTER_MAX_RADIUS 160

struct filter {
	int radius;                               /* in pixels */
	float weights[2 * FILTER_MAX_RADIUS + 1]; /* 2 radius + 1, from -radius on; correlated, not convolved */
};

/* out may be in; between holds width x height as well and must be neither. */
void filter_apply(const float *in, float *out, float *between, uint32_t width, uint32_t height,
	const struct filter *across, const struct filter *down);

#endif
