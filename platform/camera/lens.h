/*
 * How a camera at the back of a car sees the ground: a lens (pinhole or fisheye, each with a radial polynomial) and
 * where it is mounted. Header-only maths, used by what draws on the picture and by the simulated camera.
 *
 * Frames: the picture, in units of its width, (0, 0) in the middle, u right, v down, as the sensor sees it (not
 * mirrored). The camera: x right, y down, z forward. The ground around the car, metres: `back` behind the rear axle,
 * `right` of the car's middle line as its driver has it, so the picture's right is the car's left.
 */
#ifndef BLVD_PLATFORM_CAMERA_LENS_H
#define BLVD_PLATFORM_CAMERA_LENS_H

#include <math.h>
#include <stdbool.h>

#include "platform/base/vec.h"

enum lens_kind {
	LENS_PINHOLE, /* radius = f t (1 + k1 t^2 + k2 t^4), t the tangent of the angle from the axis */
	LENS_FISHEYE, /* the same with the angle itself for t */
};

struct lens {
	enum lens_kind kind;
	double fov_rad; /* seen across the width; below pi for a pinhole */
	double k1, k2;
};

struct camera_mount {
	double height_m; /* above the ground */
	double back_m;   /* behind the rear axle */
	double right_m;
	double pitch_rad; /* down from level */
};

/* Polynomial and its slope. */
static inline double lens_radius(const struct lens *lens, double t, double *slope)
{
	double square = t * t;
	*slope = 1.0 + square * (3.0 * lens->k1 + square * 5.0 * lens->k2);
	return t * (1.0 + square * (lens->k1 + square * lens->k2));
}

/* The focal length in picture widths that makes the picture's width see `fov_rad`. */
static inline double lens_focal(const struct lens *lens)
{
	double slope, half = lens->fov_rad / 2.0;
	double edge = lens_radius(lens, lens->kind == LENS_PINHOLE ? tan(half) : half, &slope);
	return edge > 1e-9 ? 0.5 / edge : 1.0;
}

/* False for directions that the lens does not see or where its polynomial has turned round. */
static inline bool lens_project(const struct lens *lens, struct dvec3 at, struct dvec2 *out)
{
	double side = hypot(at.x, at.y), slope;
	if (lens->kind == LENS_PINHOLE && at.z <= 1e-6 * (1.0 + side))
		return false;
	double t = lens->kind == LENS_PINHOLE ? side / at.z : atan2(side, at.z);
	double radius = lens_focal(lens) * lens_radius(lens, t, &slope);
	if (!(slope > 0.0))
		return false;
	double scale = side > 1e-12 ? radius / side : 0.0;
	*out = (struct dvec2){ at.x * scale, at.y * scale };
	return true;
}

/* The direction (not of unit length) of a place in the picture; Newton's method, a few rounds. */
static inline bool lens_unproject(const struct lens *lens, struct dvec2 at, struct dvec3 *out)
{
	double radius = hypot(at.x, at.y), wanted = radius / lens_focal(lens), t = wanted, slope;
	for (int i = 0; i < 12; i++) {
		double miss = lens_radius(lens, t, &slope) - wanted;
		if (!(slope > 1e-6))
			return false;
		t -= miss / slope;
		if (fabs(miss) < 1e-12)
			break;
	}
	double angle = lens->kind == LENS_PINHOLE ? atan(t) : t, side = radius > 1e-12 ? sin(angle) / radius : 0.0;
	*out = (struct dvec3){ at.x * side, at.y * side, cos(angle) };
	return t >= 0.0 && angle < BLVD_PI;
}

/* A point at `up_m` above the ground as the camera has it. */
static inline struct dvec3 camera_from_car(const struct camera_mount *mount, double back_m, double right_m, double up_m)
{
	double away = back_m - mount->back_m, below = mount->height_m - up_m;
	double sine = sin(mount->pitch_rad), cosine = cos(mount->pitch_rad);
	return (struct dvec3){ mount->right_m - right_m, below * cosine - away * sine, away * cosine + below * sine };
}

/* Where a direction of the camera meets the ground; false above the horizon. */
static inline bool ground_from_camera(
	const struct camera_mount *mount, struct dvec3 direction, double *back_m, double *right_m)
{
	double sine = sin(mount->pitch_rad), cosine = cos(mount->pitch_rad);
	double down = direction.y * cosine + direction.z * sine, away = direction.z * cosine - direction.y * sine;
	if (down <= 1e-9)
		return false;
	double reach = mount->height_m / down;
	*back_m = mount->back_m + away * reach;
	*right_m = mount->right_m - direction.x * reach;
	return true;
}

#endif
