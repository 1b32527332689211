/*
 * The colour spaces image measures need, for one pixel. Spaces relative to the white of sRGB (D65, the row sums of the
 * matrix below), so greys have no chroma. Sources: IEC 61966-2-1 (sRGB), CIE 15 (L*a*b*); YCxCz is L*a*b* without its
 * cube root, linear in light, as used by FLIP (see flip.h).
 */
#ifndef BLVD_TOOLS_MEASURE_COLOUR_H
#define BLVD_TOOLS_MEASURE_COLOUR_H

#include <stdint.h>

struct colour {
	float x, y, z; /* red green blue of 0 to 1, or Y Cx Cz, or L* a* b* */
};

/* One channel to linear light, 0 to 1. */
float colour_linear(uint8_t srgb);

struct colour colour_ycxcz_of_linear(struct colour rgb);
struct colour colour_linear_of_ycxcz(struct colour ycxcz); /* not clamped */
struct colour colour_lab_of_linear(struct colour rgb);

#endif
