/* Captures without GL: boxes, balls and ground, a ray a pixel. */
#ifndef BLVD_TESTS_RAY_VIEW_H
#define BLVD_TESTS_RAY_VIEW_H

#include "tools/impostor/capture.h"
#include "tools/impostor/view_cell.h"

struct ray_box {
	double min[3], max[3];
};
struct ray_ball {
	double centre[3], radius;
};
struct ray_scene {
	struct ray_box boxes[512];
	struct ray_ball balls[128];
	size_t box_count, ball_count;
	double ground_from; /* the ground z = 0 is there for y >= this; INFINITY: none */
};

/* Looks along +y from (x, y, z); the horizon is in the middle of the image. */
struct capture_view ray_view(double x, double y, double z, double focal_px, uint32_t width, uint32_t height);
/* Looks along a heading, clockwise from +y. */
struct capture_view ray_view_turned(
	double x, double y, double z, double heading, double focal_px, uint32_t width, uint32_t height);
/* Owned by the caller: capture_image_finish(). */
struct capture_image ray_capture(const struct ray_scene *scene, const struct capture_view *view);
void ray_capture_finish(struct capture_image *image);

/* A street canyon along +y: houses of different heights on both sides from y = `from` to 600 m, trees in front of them,
 * a block across its end. */
void ray_canyon(struct ray_scene *scene, double from);

/* length_m along +y from the origin, 4 m to either side, eyes 1.5 to 4 m high. */
struct view_cell ray_cell(double length_m);

#endif
