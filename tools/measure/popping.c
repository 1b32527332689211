#include "tools/measure/popping.h"

#include <math.h>
#include <string.h>

#define LIGHTNESS_STEPS 4096
#define CHANGE_STEPS 1024 /* of |change| from 0 to 100, for the percentile */

static float linear_of[256], lightness_of[LIGHTNESS_STEPS + 2];

static void fill_tables(void)
{
	if (linear_of[255] > 0.0f)
		return;
	for (int i = 0; i < 256; i++) {
		double c = i / 255.0;
		linear_of[i] = (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
	}
	/* over the square root of the luminance, so that the dark end is fine enough */
	for (int i = 0; i < LIGHTNESS_STEPS + 2; i++) {
		double root = (double)i / LIGHTNESS_STEPS, y = root * root;
		lightness_of[i] = (float)(y > 216.0 / 24389.0 ? 116.0 * cbrt(y) - 16.0 : y * 24389.0 / 27.0);
	}
}

static float to_lightness(float luminance)
{
	float at = sqrtf(fminf(1.0f, fmaxf(0.0f, luminance))) * LIGHTNESS_STEPS;
	int step = (int)at;
	return lightness_of[step] + (lightness_of[step + 1] - lightness_of[step]) * (at - (float)step);
}

/* 1 2 1 along one direction; the border repeats. */
static void blur(const float *from, float *to, uint32_t count, size_t stride)
{
	for (uint32_t i = 0; i < count; i++) {
		float before = from[(i ? i - 1 : 0) * stride], after = from[(i + 1 < count ? i + 1 : i) * stride];
		to[i * stride] = 0.25f * (before + after) + 0.5f * from[i * stride];
	}
}

void popping_lightness(const uint8_t *rgba, uint32_t width, uint32_t height, float *out, float *work)
{
	fill_tables();
	size_t pixels = (size_t)width * height;
	for (size_t i = 0; i < pixels; i++)
		out[i] = 0.2126f * linear_of[rgba[4 * i]] + 0.7152f * linear_of[rgba[4 * i + 1]] +
				 0.0722f * linear_of[rgba[4 * i + 2]];
	for (uint32_t y = 0; y < height; y++)
		blur(out + (size_t)y * width, work + (size_t)y * width, width, 1);
	for (uint32_t x = 0; x < width; x++)
		blur(work + x, out + x, height, width);
	for (size_t i = 0; i < pixels; i++)
		out[i] = to_lightness(out[i]);
}

struct tally {
	double sum, squares, max;
	uint32_t steps[CHANGE_STEPS + 1];
};

static void tally_add(struct tally *tally, double change)
{
	tally->sum += change;
	tally->squares += change * change;
	tally->max = fmax(tally->max, change);
	tally->steps[(int)fmin(CHANGE_STEPS, change * (CHANGE_STEPS / 100.0))]++;
}

/* The upper end of the step that holds the 99th percentile, or the maximum when that is less. */
static double tally_p99(const struct tally *tally, size_t pixels)
{
	double wanted = 0.99 * (double)pixels, seen = 0.0;
	for (int i = 0; i <= CHANGE_STEPS; i++) {
		seen += tally->steps[i];
		if (seen >= wanted)
			return fmin(tally->max, (i + 1) * (100.0 / CHANGE_STEPS));
	}
	return tally->max;
}

bool popping_add(struct popping *popping, const float *reference, const float *shown, struct popping_frame *out)
{
	struct tally tally = { 0 };
	bool follows = popping->started;
	*out = (struct popping_frame){ 0 };
	for (size_t i = 0; i < popping->pixels; i++) {
		float error = shown[i] - reference[i];
		if (follows)
			tally_add(&tally, (double)fabsf(error - popping->error[i]));
		popping->error[i] = error;
	}
	popping->started = true;
	if (follows && popping->pixels)
		*out = (struct popping_frame){ tally.sum / (double)popping->pixels,
			sqrt(tally.squares / (double)popping->pixels), tally_p99(&tally, popping->pixels), tally.max };
	return follows;
}

void popping_cut(struct popping *popping)
{
	popping->started = false;
}
