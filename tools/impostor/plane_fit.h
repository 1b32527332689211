/*
 * The plane in disparity, affine in the image, that fits a set of pixels best: least squares over residuals in units of
 * each pixel's tolerance, from sums, so that the union of two sets costs no look at the pixels. A bounded number of
 * samples stands for the pixels when the largest residual is asked for: extreme positions in eight directions (an
 * affine change of plane is largest there) and the largest residuals seen.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_PLANE_FIT_H
#define BLVD_TOOLS_IMPOSTOR_PLANE_FIT_H

#include <stdint.h>

struct plane {
	double x, y, w;  /* through this: pixel position, disparity */
	double w_x, w_y; /* slopes, 1/m a pixel */
};

static inline double plane_at(const struct plane *plane, double x, double y)
{
	return plane->w + plane->w_x * (x - plane->x) + plane->w_y * (y - plane->y);
}

#define PLANE_FIT_HULL 8
#define PLANE_FIT_SAMPLES 16

struct fit_sample {
	float x, y, w;
	float inverse_tolerance;
};
struct plane_fit {
	double weight, x, y, w, xx, xy, yy, xw, yw;   /* sums, each pixel weighed by its inverse tolerance squared */
	double slope_x, slope_y;                      /* the same, of the slopes that the pixels' normals ask for */
	struct fit_sample samples[PLANE_FIT_SAMPLES]; /* the first PLANE_FIT_HULL are extreme in position */
	uint32_t pixels;
};

/* Of one pixel. `slope_x`, `slope_y` decide what the positions leave open. */
void plane_fit_start(struct plane_fit *fit, struct fit_sample sample, double slope_x, double slope_y);
/* Adds one pixel, as plane_fit_join() would. */
void plane_fit_add(struct plane_fit *fit, struct fit_sample sample, double slope_x, double slope_y);
struct plane plane_fit_solve(const struct plane_fit *fit);
/* Residual of a pixel, in tolerances. */
double plane_fit_residual(const struct plane *plane, const struct fit_sample *sample);
/* The largest over the samples. */
double plane_fit_error(const struct plane_fit *fit, const struct plane *plane);
/* Remembers a pixel with a large residual. */
void plane_fit_note(struct plane_fit *fit, const struct plane *plane, struct fit_sample sample);

/* The plane of the union of two sets, and its largest residual over both sets' samples. */
struct plane plane_fit_try(const struct plane_fit *a, const struct plane_fit *b, double *error);
/* a becomes the union, of which `plane` is the fit. */
void plane_fit_join(struct plane_fit *a, const struct plane_fit *b, const struct plane *plane);

#endif
