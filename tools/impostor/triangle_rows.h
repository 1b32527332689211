/* Which pixel centres a triangle covers, row by row. */
#ifndef BLVD_TOOLS_IMPOSTOR_TRIANGLE_ROWS_H
#define BLVD_TOOLS_IMPOSTOR_TRIANGLE_ROWS_H

#include <math.h>
#include <stdint.h>

struct pixel_run {
	int32_t from, to; /* to is not included */
};

/* Rows whose centres the triangle reaches, within 0 .. height. */
static inline struct pixel_run triangle_rows(const double y[3], int32_t height)
{
	double low = fmin(y[0], fmin(y[1], y[2])), high = fmax(y[0], fmax(y[1], y[2]));
	int32_t from = (int32_t)ceil(fmax(low, 0) - 0.5), to = (int32_t)floor(fmin(high, height) - 0.5) + 1;
	return (struct pixel_run){ from < 0 ? 0 : from, to > height ? height : to };
}

/* Pixels of a row whose centres the triangle covers, its rim included, within 0 .. width. */
static inline struct pixel_run triangle_run(const double x[3], const double y[3], int32_t row, int32_t width)
{
	double centre = row + 0.5, low = INFINITY, high = -INFINITY;
	for (int i = 0; i < 3; i++) {
		int j = i == 2 ? 0 : i + 1;
		if ((y[i] > centre && y[j] > centre) || (y[i] < centre && y[j] < centre))
			continue;
		double at = y[i] == y[j] ? x[i] : x[i] + (x[j] - x[i]) * ((centre - y[i]) / (y[j] - y[i]));
		low = fmin(low, y[i] == y[j] ? fmin(x[i], x[j]) : at);
		high = fmax(high, y[i] == y[j] ? fmax(x[i], x[j]) : at);
	}
	if (!(low <= high))
		return (struct pixel_run){ 0, 0 };
	const double slack = 1e-9;
	int32_t from = (int32_t)ceil(fmax(low, 0) - 0.5 - slack), to = (int32_t)floor(fmin(high, width) - 0.5 + slack) + 1;
	return (struct pixel_run){ from < 0 ? 0 : from, to > width ? width : to };
}

#endif
