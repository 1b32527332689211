/*
 * What one picture shows of another.
 *
 * Precision and recall after Zhou, Yoo, Benes and Chen, "A hybrid level-of-detail representation for large-scale urban
 * scenes rendering", 2014, section 6.4: true positives are pixels drawn the same in both, false positives pixels drawn
 * so in the tested picture only, false negatives pixels drawn so in the reference only. A pixel drawn in both,
 * differently, is therefore a false positive and a false negative; precision = same / drawn in b, recall = same / drawn
 * in a. Without a clear colour all pixels are drawn, and both are the share of equal pixels.
 */
#ifndef BLVD_TOOLS_MEASURE_COVERAGE_H
#define BLVD_TOOLS_MEASURE_COVERAGE_H

#include "tools/measure/image.h"

struct image_coverage {
	double precision, recall;                   /* same: equal; NaN where nothing is drawn */
	double precision_within_2, recall_within_2; /* same: every channel within 2 of 255 */
	double uncovered; /* share of all pixels that have the clear colour in b but not in a; NaN without one */
};

/* Pictures of one size, a the reference; clear: red, green, blue of pixels that nothing was drawn on, or NULL. */
void image_cover(const struct image *a, const struct image *b, const uint8_t *clear, struct image_coverage *out);

#endif
