/*
 * FLIP: the difference a person sees when two pictures of a screen alternate, per pixel from 0 (none) to 1.
 * After Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem and Fairchild, "FLIP: A Difference Evaluator for
 * Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020. The LDR measure, for sRGB pictures.
 *
 * Colour: both pictures are blurred by the eye's contrast sensitivity in YCxCz, clamped to what the screen can show,
 * turned to L*a*b* with a and b scaled by lightness (Hunt), and compared by HyAB; the distance to the power 0.7 is
 * mapped so that green against blue is 1 and two fifths of that are 0.95.
 * Features: edges and points of the lightness under lines 0.082 degrees wide. They make a difference more visible:
 * colour ^ (1 - features).
 */
#ifndef BLVD_TOOLS_MEASURE_FLIP_H
#define BLVD_TOOLS_MEASURE_FLIP_H

#include "tools/measure/image.h"

#define FLIP_DEFAULT_PPD 67.0206 /* pi / 180 * 0.7 m away * 3840 pixels / 0.7 m wide: the paper's screen */
#define FLIP_MIN_PPD 1.0
#define FLIP_MAX_PPD 1000.0

/* Pictures of one size; ppd is pixels a degree of sight, FLIP_MIN_PPD to FLIP_MAX_PPD. map has one value a pixel.
 * Symmetric in a and b. About 1 s and 70 MB for 1280 x 720. */
void flip_map(const struct image *a, const struct image *b, double ppd, float *map);

/* Pools of a map. A weighted percentile is the least value v such that the pixels up to v hold that share of the sum
 * of the map; 0 for a map of zeros. */
struct flip_summary {
	double mean, max;
	double weighted_p25, weighted_p50, weighted_p75, weighted_p95;
};

void flip_summarise(const float *map, uint32_t width, uint32_t height, struct flip_summary *out);

/* The map as a picture: black for 0, through violet, red and orange to cream for 1. Returns 0 or -EIO. */
int flip_write_heat(const float *map, uint32_t width, uint32_t height, const char *path);

#endif
