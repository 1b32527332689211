/* Weighted least squares of planes by running sums, and the samples that stand for the pixels. */
#include "tools/impostor/plane_fit.h"

#include <math.h>

/* The spread of positions, px^2, at which the slope from the normals has as much say as the pixels. */
#define SLOPE_SPREAD 0.02

static const int8_t directions[PLANE_FIT_HULL][2] = { { 1, 0 }, { 1, 1 }, { 0, 1 }, { -1, 1 }, { -1, 0 }, { -1, -1 },
	{ 0, -1 }, { 1, -1 } };

static void add_sums(struct plane_fit *fit, const struct plane_fit *more)
{
	fit->weight += more->weight;
	fit->x += more->x;
	fit->y += more->y;
	fit->w += more->w;
	fit->xx += more->xx;
	fit->xy += more->xy;
	fit->yy += more->yy;
	fit->xw += more->xw;
	fit->yw += more->yw;
	fit->slope_x += more->slope_x;
	fit->slope_y += more->slope_y;
	fit->pixels += more->pixels;
}

static void set_sums(struct plane_fit *fit, const struct fit_sample *sample, double slope_x, double slope_y)
{
	double x = sample->x, y = sample->y, w = sample->w;
	double weight = (double)sample->inverse_tolerance * sample->inverse_tolerance;
	fit->weight = weight;
	fit->x = weight * x;
	fit->y = weight * y;
	fit->w = weight * w;
	fit->xx = weight * x * x;
	fit->xy = weight * x * y;
	fit->yy = weight * y * y;
	fit->xw = weight * x * w;
	fit->yw = weight * y * w;
	fit->slope_x = weight * slope_x;
	fit->slope_y = weight * slope_y;
	fit->pixels = 1;
}

void plane_fit_start(struct plane_fit *fit, struct fit_sample sample, double slope_x, double slope_y)
{
	set_sums(fit, &sample, slope_x, slope_y);
	for (int i = 0; i < PLANE_FIT_SAMPLES; i++)
		fit->samples[i] = sample;
}

static float support(const struct fit_sample *sample, int direction)
{
	return sample->x * (float)directions[direction][0] + sample->y * (float)directions[direction][1];
}

void plane_fit_add(struct plane_fit *fit, struct fit_sample sample, double slope_x, double slope_y)
{
	struct plane_fit one;
	set_sums(&one, &sample, slope_x, slope_y);
	add_sums(fit, &one);
	for (int i = 0; i < PLANE_FIT_HULL; i++)
		if (support(&sample, i) > support(&fit->samples[i], i))
			fit->samples[i] = sample;
}

struct plane plane_fit_solve(const struct plane_fit *fit)
{
	double scale = 1 / fit->weight;
	double x = fit->x * scale, y = fit->y * scale, w = fit->w * scale;
	double slope_x = fit->slope_x * scale, slope_y = fit->slope_y * scale;
	double xx = fit->xx * scale - x * x + SLOPE_SPREAD, yy = fit->yy * scale - y * y + SLOPE_SPREAD;
	double xy = fit->xy * scale - x * y;
	double xw = fit->xw * scale - x * w + SLOPE_SPREAD * slope_x, yw = fit->yw * scale - y * w + SLOPE_SPREAD * slope_y;
	double determinant = xx * yy - xy * xy; /* at least SLOPE_SPREAD squared but for rounding */
	if (determinant < 0.5 * SLOPE_SPREAD * SLOPE_SPREAD)
		return (struct plane){ x, y, w, slope_x, slope_y };
	return (struct plane){ x, y, w, (xw * yy - yw * xy) / determinant, (yw * xx - xw * xy) / determinant };
}

double plane_fit_residual(const struct plane *plane, const struct fit_sample *sample)
{
	return fabs(plane_at(plane, sample->x, sample->y) - sample->w) * sample->inverse_tolerance;
}

double plane_fit_error(const struct plane_fit *fit, const struct plane *plane)
{
	double largest = 0;
	for (int i = 0; i < PLANE_FIT_SAMPLES; i++) {
		double residual = plane_fit_residual(plane, &fit->samples[i]);
		largest = residual > largest ? residual : largest;
	}
	return largest;
}

void plane_fit_note(struct plane_fit *fit, const struct plane *plane, struct fit_sample sample)
{
	int least = PLANE_FIT_HULL;
	double smallest = INFINITY;
	for (int i = PLANE_FIT_HULL; i < PLANE_FIT_SAMPLES; i++) {
		double residual = plane_fit_residual(plane, &fit->samples[i]);
		if (residual < smallest) {
			smallest = residual;
			least = i;
		}
	}
	if (plane_fit_residual(plane, &sample) > smallest)
		fit->samples[least] = sample;
}

struct plane plane_fit_try(const struct plane_fit *a, const struct plane_fit *b, double *error)
{
	struct plane_fit sums;
	sums.weight = a->weight + b->weight;
	sums.x = a->x + b->x;
	sums.y = a->y + b->y;
	sums.w = a->w + b->w;
	sums.xx = a->xx + b->xx;
	sums.xy = a->xy + b->xy;
	sums.yy = a->yy + b->yy;
	sums.xw = a->xw + b->xw;
	sums.yw = a->yw + b->yw;
	sums.slope_x = a->slope_x + b->slope_x;
	sums.slope_y = a->slope_y + b->slope_y;
	struct plane plane = plane_fit_solve(&sums);
	*error = fmax(plane_fit_error(a, &plane), plane_fit_error(b, &plane));
	return plane;
}

void plane_fit_join(struct plane_fit *a, const struct plane_fit *b, const struct plane *plane)
{
	add_sums(a, b);
	for (int i = 0; i < PLANE_FIT_HULL; i++)
		if (support(&b->samples[i], i) > support(&a->samples[i], i))
			a->samples[i] = b->samples[i];
	for (int i = 0; i < PLANE_FIT_SAMPLES; i++)
		plane_fit_note(a, plane, b->samples[i]);
}
