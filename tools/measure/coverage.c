#include "tools/measure/coverage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int largest_difference(const uint8_t *a, const uint8_t *b)
{
	int worst = 0;
	for (int c = 0; c < 3; c++)
		worst = abs(a[c] - b[c]) > worst ? abs(a[c] - b[c]) : worst;
	return worst;
}

static double share(size_t part, size_t whole)
{
	return whole ? (double)part / (double)whole : NAN;
}

void image_cover(const struct image *a, const struct image *b, const uint8_t *clear, struct image_coverage *out)
{
	size_t pixels = (size_t)a->width * a->height;
	size_t drawn_a = 0, drawn_b = 0, same = 0, near = 0, uncovered = 0;
	for (size_t i = 0; i < pixels; i++) {
		const uint8_t *pa = a->rgb + 3 * i, *pb = b->rgb + 3 * i;
		int in_a = !clear || memcmp(pa, clear, 3) != 0, in_b = !clear || memcmp(pb, clear, 3) != 0;
		int difference = largest_difference(pa, pb);
		drawn_a += (size_t)in_a;
		drawn_b += (size_t)in_b;
		same += in_a && in_b && difference == 0;
		near += in_a && in_b && difference <= 2;
		uncovered += in_a && !in_b;
	}
	out->precision = share(same, drawn_b);
	out->recall = share(same, drawn_a);
	out->precision_within_2 = share(near, drawn_b);
	out->recall_within_2 = share(near, drawn_a);
	out->uncovered = clear ? share(uncovered, pixels) : NAN;
}
