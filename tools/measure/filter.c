#include "tools/measure/filter.h"

#include <string.h>

#include "tools/city/pool.h"

static void add_scaled(float *restrict sum, const float *restrict add, float weight, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		sum[i] += weight * add[i];
}

static void filter_row(const float *in, float *out, float *padded, uint32_t width, const struct filter *filter)
{
	size_t radius = (size_t)filter->radius;
	for (size_t i = 0; i < radius; i++) {
		padded[i] = in[0];
		padded[radius + width + i] = in[width - 1];
	}
	memcpy(padded + radius, in, width * sizeof(float));
	memset(out, 0, width * sizeof(float));
	for (size_t k = 0; k <= 2 * radius; k++)
		add_scaled(out, padded + k, filter->weights[k], width);
}

static void filter_column(
	const float *in, float *out, uint32_t y, uint32_t width, uint32_t height, const struct filter *filter)
{
	memset(out, 0, width * sizeof(float));
	for (int k = -filter->radius; k <= filter->radius; k++) {
		int64_t row = (int64_t)y + k;
		row = row < 0 ? 0 : row >= height ? height - 1 : row;
		add_scaled(out, in + (size_t)row * width, filter->weights[k + filter->radius], width);
	}
}

void filter_apply(const float *in, float *out, float *between, uint32_t width, uint32_t height,
	const struct filter *across, const struct filter *down)
{
	float *padded = array_grow(NULL, &(size_t){ 0 }, width + 2 * FILTER_MAX_RADIUS, sizeof(float));
	for (uint32_t y = 0; y < height; y++)
		filter_row(in + (size_t)y * width, between + (size_t)y * width, padded, width, across);
	for (uint32_t y = 0; y < height; y++)
		filter_column(between, out + (size_t)y * width, y, width, height, down);
	array_free(padded);
}
