/* The ray caster behind ray_view.h: every ray against everything. */
#include "tests/tools/ray_view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"

struct hit {
	double t;
	uint32_t object, triangle;
	double normal[3];
	uint8_t kind;
};

struct capture_view ray_view(double x, double y, double z, double focal_px, uint32_t width, uint32_t height)
{
	return ray_view_turned(x, y, z, 0, focal_px, width, height);
}

struct capture_view ray_view_turned(
	double x, double y, double z, double heading, double focal_px, uint32_t width, uint32_t height)
{
	return (struct capture_view){ .eye = { x, y, z },
		.right = { cos(heading), -sin(heading), 0 },
		.up = { 0, 0, 1 },
		.forward = { sin(heading), cos(heading), 0 },
		.focal_px = focal_px,
		.centre_x = 0.5 * width,
		.centre_y = 0.5 * height,
		.width = width,
		.height = height,
		.near_m = 1,
		.far_m = 5000 };
}

static void meet_box(
	const struct ray_box *box, uint32_t object, const double eye[3], const double ray[3], struct hit *hit)
{
	double enter = 0, leave = INFINITY;
	int axis = -1;
	for (int i = 0; i < 3; i++) {
		double a = (box->min[i] - eye[i]) / ray[i], b = (box->max[i] - eye[i]) / ray[i];
		if (fmin(a, b) > enter) {
			enter = fmin(a, b);
			axis = i;
		}
		leave = fmin(leave, fmax(a, b));
	}
	if (axis < 0 || enter >= leave || enter >= hit->t)
		return;
	*hit = (struct hit){ .t = enter,
		.object = object,
		.triangle = (uint32_t)axis * 2 + (ray[axis] > 0),
		.kind = axis == 2 ? PKG_MATERIAL_ROOF : PKG_MATERIAL_WALL };
	hit->normal[axis] = ray[axis] > 0 ? -1 : 1;
}

static void meet_ball(
	const struct ray_ball *ball, uint32_t object, const double eye[3], const double ray[3], struct hit *hit)
{
	double a = 0, b = 0, c = -ball->radius * ball->radius;
	for (int i = 0; i < 3; i++) {
		double d = eye[i] - ball->centre[i];
		a += ray[i] * ray[i];
		b += ray[i] * d;
		c += d * d;
	}
	double root = b * b - a * c;
	if (root <= 0)
		return;
	double t = (-b - sqrt(root)) / a;
	if (t <= 0 || t >= hit->t)
		return;
	*hit = (struct hit){ .t = t, .object = object, .triangle = PKG_NONE, .kind = PKG_MATERIAL_FOLIAGE };
	for (int i = 0; i < 3; i++)
		hit->normal[i] = (eye[i] + t * ray[i] - ball->centre[i]) / ball->radius;
}

static void set_normal(struct capture_pixel *pixel, const double normal[3])
{
	double sum = fabs(normal[0]) + fabs(normal[1]) + fabs(normal[2]);
	double x = normal[0] / sum, y = normal[1] / sum;
	if (normal[2] < 0) {
		double folded = (1 - fabs(y)) * (x < 0 ? -1 : 1);
		y = (1 - fabs(x)) * (y < 0 ? -1 : 1);
		x = folded;
	}
	pixel->normal_oct[0] = (int8_t)lround(127 * x);
	pixel->normal_oct[1] = (int8_t)lround(127 * y);
}

struct capture_image ray_capture(const struct ray_scene *scene, const struct capture_view *view)
{
	struct capture_image image = { .view = *view };
	size_t count = (size_t)view->width * view->height;
	image.rgba = calloc(count, 4);
	image.pixels = calloc(count, sizeof(*image.pixels));
	const double eye[3] = { view->eye.x, view->eye.y, view->eye.z };
	for (size_t i = 0; i < count; i++) {
		double right = ((double)(i % view->width) + 0.5 - view->centre_x) / view->focal_px;
		double up = (view->centre_y - (double)(i / view->width) - 0.5) / view->focal_px;
		const double ray[3] = { view->forward.x + right * view->right.x + up * view->up.x,
			view->forward.y + right * view->right.y + up * view->up.y,
			view->forward.z + right * view->right.z + up * view->up.z };
		struct hit hit = { .t = view->far_m };
		double down = ray[2] < 0 ? -eye[2] / ray[2] : INFINITY;
		if (down < hit.t && eye[1] + down * ray[1] >= scene->ground_from)
			hit = (struct hit){ down, 1, 0, { 0, 0, 1 }, PKG_MATERIAL_GROUND };
		for (size_t k = 0; k < scene->box_count; k++)
			meet_box(&scene->boxes[k], (uint32_t)k + 2, eye, ray, &hit);
		for (size_t k = 0; k < scene->ball_count; k++)
			meet_ball(&scene->balls[k], (uint32_t)(scene->box_count + k) + 2, eye, ray, &hit);
		if (!hit.object)
			continue;
		struct capture_pixel *pixel = &image.pixels[i];
		*pixel = (struct capture_pixel){
			.object = hit.object, .disparity = (float)(1 / hit.t), .kind = hit.kind, .triangle = hit.triangle
		};
		set_normal(pixel, hit.normal);
		uint64_t color = hash_u64(hit.object * 8 + (hit.triangle & 7));
		for (int c = 0; c < 3; c++)
			image.rgba[4 * i + (size_t)c] = (uint8_t)(96 + (color >> (8 * c)) % 128);
		image.rgba[4 * i + 3] = 255;
	}
	return image;
}

void ray_capture_finish(struct capture_image *image)
{
	free(image->rgba);
	free(image->pixels);
	*image = (struct capture_image){ 0 };
}

static void add_box(struct ray_scene *scene, struct ray_box box)
{
	if (scene->box_count < sizeof(scene->boxes) / sizeof(scene->boxes[0]))
		scene->boxes[scene->box_count++] = box;
}

void ray_canyon(struct ray_scene *scene, double from)
{
	memset(scene, 0, sizeof(*scene));
	scene->ground_from = from;
	struct rng rng = rng_seed(1);
	for (int side = -1; side <= 1; side += 2) {
		for (double y = from; y < 600;) {
			double length = rng_range(&rng, 12, 30), height = rng_range(&rng, 9, 24), setback = rng_range(&rng, 0, 2);
			double near_x = 10 + setback, far_x = near_x + 14;
			add_box(scene, (struct ray_box){ { side < 0 ? -far_x : near_x, y, 0 },
							   { side < 0 ? -near_x : far_x, y + length, height } });
			if (rng_unit(&rng) < 0.5) /* a chimney */
				add_box(scene, (struct ray_box){ { side < 0 ? -near_x - 6 : near_x + 4, y + 4, height },
								   { side < 0 ? -near_x - 4 : near_x + 6, y + 6, height + 3 } });
			y += length + (rng_unit(&rng) < 0.2 ? 12 : 0);
		}
		for (double y = from + 5; y < 500; y += 25)
			scene->balls[scene->ball_count++] = (struct ray_ball){ { side * 7.5, y, 6 }, 2.5 };
	}
	add_box(scene, (struct ray_box){ { -80, 620, 0 }, { 80, 640, 30 } });
}

struct view_cell ray_cell(double length_m)
{
	return (struct view_cell){ .end = { 0, length_m, 0 }, .half_width_m = 4, .eye_min_m = 1.5, .eye_max_m = 4 };
}
