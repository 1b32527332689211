/*
 * What changes between two frames though nothing in the city does: the representation's change less the reference's, on
 * the same two poses. A picture that is wrong in the same way in both frames does not pop.
 *
 * Pixels are compared by lightness: sRGB to linear luminance (ITU-R BT.709), blurred by 1 2 1 in both directions, about
 * what an eye blurs at 70 to 90 pixels a degree, so that a shimmer of single pixels counts less; then CIE L*, 0 to 100.
 */
#ifndef BLVD_TOOLS_MEASURE_POPPING_H
#define BLVD_TOOLS_MEASURE_POPPING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct popping_frame {
	double mean, rms, p99, max; /* of |change|, L* */
};

/* Lightness of an RGBA8 picture, one value a pixel. `work` has room for as many. */
void popping_lightness(const uint8_t *rgba, uint32_t width, uint32_t height, float *out, float *work);

/* One representation's error (its lightness less the reference's), kept from frame to frame. */
struct popping {
	size_t pixels;
	float *error; /* of the last frame; borrowed, `pixels` of them */
	bool started;
};
/* Takes the next frame's lightness. False, and `out` all 0, for the first frame after a start or popping_cut(). */
bool popping_add(struct popping *popping, const float *reference, const float *shown, struct popping_frame *out);
/* The next frame does not follow the last one. */
void popping_cut(struct popping *popping);

#endif
