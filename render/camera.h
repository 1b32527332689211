/*
 * The cameras that follow the car. Motion is critically damped springs advanced in closed form, so a picture depends on
 * simulated time and not on the frame rate. A camera is never in a building and never under the ground.
 */
#ifndef BLVD_RENDER_CAMERA_H
#define BLVD_RENDER_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

#include "nav/nav.h"
#include "render/obstacles.h"
#include "render/view.h"

enum camera_kind {
	CAMERA_DRIVER,     /* a driver's eye, a little raised: about 3 m high, slightly down */
	CAMERA_CHASE,      /* behind and above the car */
	CAMERA_HEADING_UP, /* overview, the street ahead is up */
	CAMERA_NORTH_UP,   /* overview, north is up */
	CAMERA_KIND_COUNT,
};
const char *camera_name(enum camera_kind kind); /* "driver", "chase", "heading-up", "north-up" */
/* Returns -1 when there is no camera of this name. */
int camera_from_name(const char *name);

/* An eye. Heading clockwise from north, pitch up positive. */
struct camera_pose {
	int64_t eye_mm[3];
	double heading_rad, pitch_rad;
	double fov_rad; /* vertical; 0: the renderer's */
};

struct spring {
	double value, velocity;
};

/* Exact motion over `dt_s` of a critically damped spring whose target moves evenly from one value to another. Cutting
 * the time into pieces changes nothing. `rate` is its natural frequency, 1/s. */
void spring_follow(struct spring *spring, double from, double to, double rate, double dt_s);

struct camera {
	enum camera_kind kind;
	double zoom;    /* 1 is the default distance; 0.25 to 4, more is closer */
	double fov_rad; /* vertical */
	bool started;
	int64_t time_ns;
	struct spring back, up, pitch, turn; /* behind and above the car, m; rad; heading, rad, unwrapped */
	struct spring climb, slope;          /* the car's height, m; the street's slope */
	double target_turn, target_climb, target_slope;
	double reach;        /* 0 to 1: how far of the way to its place the eye may go */
	int64_t car_mm[3];   /* when last seen */
	int64_t slope_mm[3]; /* where the slope was last taken */
	struct camera_pose pose;
};

void camera_init(struct camera *camera, double fov_rad);
void camera_next(struct camera *camera);                /* c: the next kind */
void camera_zoom(struct camera *camera, double factor); /* > 1 is closer */

/* Follows the car to nav->time_ns and sets camera->pose. The first call, a jump of the car by more than 60 m and a step
 * back in time cut instead of gliding. Without a known position the pose stays. `obstacles` may be NULL. */
void camera_follow(struct camera *camera, const struct nav_view *nav, const struct obstacles *obstacles);

/* The frame's view. Slices meet at `split_m`. */
void camera_view(
	const struct camera_pose *pose, uint32_t width, uint32_t height, double split_m, double far_m, struct view *out);

/* Moves the place where a view's slices meet. */
void camera_split(struct view *view, double split_m, double far_m);

/* Frustum against an eye-relative box (metres): false only when it is certainly outside. */
bool view_sees_box(const struct view *view, struct vec3 min, struct vec3 max);

/* Frustum but for its far end: true only when all of the box is certainly inside. */
bool view_holds_box(const struct view *view, struct vec3 min, struct vec3 max);

/* A city-frame box relative to the eye. */
void view_box(
	const struct view *view, const int32_t min_mm[3], const int32_t max_mm[3], struct vec3 *min, struct vec3 *max);

/* Distance along the view direction to the box's nearest and farthest corner. */
/* From the eye to an eye-relative box, metres. */
double view_box_distance_m(struct vec3 min, struct vec3 max);
void view_box_depth(const struct view *view, struct vec3 min, struct vec3 max, float *nearest, float *farthest);

#endif
