/* The ray caster behind ray_view.h: everything against the rays that may meet it. */
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

/* Pixels whose rays may meet a box of the city frame. */
struct reach {
	uint32_t from_x, from_y, to_x, to_y;
};

static uint32_t pixel_in(double at, uint32_t size)
{
	return (uint32_t)fmin(fmax(floor(at), 0), size);
}

static struct reach reach_of(const struct capture_view *view, const double min[3], const double max[3])
{
	double low_x = INFINITY, low_y = INFINITY, high_x = -INFINITY, high_y = -INFINITY;
	for (int i = 0; i < 8; i++) {
		double x, y, z;
		struct dvec3 corner = { i & 1 ? max[0] : min[0], i & 2 ? max[1] : min[1], i & 4 ? max[2] : min[2] };
		if (!capture_project(view, corner, &x, &y, &z))
			return (struct reach){ 0, 0, view->width, view->height };
		low_x = fmin(low_x, x);
		low_y = fmin(low_y, y);
		high_x = fmax(high_x, x);
		high_y = fmax(high_y, y);
	}
	return (struct reach){ pixel_in(low_x - 1, view->width), pixel_in(low_y - 1, view->height),
		pixel_in(high_x + 2, view->width), pixel_in(high_y + 2, view->height) };
}

/* The ray of pixel (x, y), forward part 1. */
static void ray_of(const struct capture_view *view, uint32_t x, uint32_t y, double ray[3])
{
	double right = (x + 0.5 - view->centre_x) / view->focal_px, up = (view->centre_y - y - 0.5) / view->focal_px;
	ray[0] = view->forward.x + right * view->right.x + up * view->up.x;
	ray[1] = view->forward.y + right * view->right.y + up * view->up.y;
	ray[2] = view->forward.z + right * view->right.z + up * view->up.z;
}

/* Meets one box (or ball, when `box` is NULL) with the rays of the pixels that it may be in. */
static void meet_one(const struct capture_view *view, const struct ray_box *box, const struct ray_ball *ball,
	uint32_t object, struct hit *hits)
{
	double min[3], max[3];
	for (int i = 0; i < 3; i++) {
		min[i] = box ? box->min[i] : ball->centre[i] - ball->radius;
		max[i] = box ? box->max[i] : ball->centre[i] + ball->radius;
	}
	const double eye[3] = { view->eye.x, view->eye.y, view->eye.z };
	struct reach reach = reach_of(view, min, max);
	for (uint32_t y = reach.from_y; y < reach.to_y; y++) {
		for (uint32_t x = reach.from_x; x < reach.to_x; x++) {
			double ray[3];
			ray_of(view, x, y, ray);
			struct hit *hit = &hits[(size_t)y * view->width + x];
			if (box)
				meet_box(box, object, eye, ray, hit);
			else
				meet_ball(ball, object, eye, ray, hit);
		}
	}
}

static void meet_ground(const struct capture_view *view, double from, struct hit *hits)
{
	for (uint32_t y = 0; y < view->height; y++) {
		for (uint32_t x = 0; x < view->width; x++) {
			double ray[3];
			ray_of(view, x, y, ray);
			double down = ray[2] < 0 ? -view->eye.z / ray[2] : INFINITY;
			struct hit *hit = &hits[(size_t)y * view->width + x];
			hit->t = view->far_m;
			if (down < hit->t && view->eye.y + down * ray[1] >= from)
				*hit = (struct hit){ down, 1, 0, { 0, 0, 1 }, PKG_MATERIAL_GROUND };
		}
	}
}

static void paint(struct capture_image *image, size_t pixel, const struct hit *hit)
{
	image->pixels[pixel] = (struct capture_pixel){
		.object = hit->object, .disparity = (float)(1 / hit->t), .kind = hit->kind, .triangle = hit->triangle
	};
	set_normal(&image->pixels[pixel], hit->normal);
	uint64_t color = hash_u64(hit->object * 8 + (hit->triangle & 7));
	for (size_t c = 0; c < 3; c++)
		image->rgba[4 * pixel + c] = (uint8_t)(96 + (color >> (8 * c)) % 128);
	image->rgba[4 * pixel + 3] = 255;
}

struct capture_image ray_capture(const struct ray_scene *scene, const struct capture_view *view)
{
	struct capture_image image = { .view = *view };
	size_t count = (size_t)view->width * view->height;
	image.rgba = calloc(count, 4);
	image.pixels = calloc(count, sizeof(*image.pixels));
	struct hit *hits = calloc(count, sizeof(*hits));
	meet_ground(view, scene->ground_from, hits);
	for (size_t i = 0; i < scene->box_count; i++)
		meet_one(view, &scene->boxes[i], NULL, (uint32_t)i + 2, hits);
	for (size_t i = 0; i < scene->ball_count; i++)
		meet_one(view, NULL, &scene->balls[i], (uint32_t)(scene->box_count + i) + 2, hits);
	for (size_t i = 0; i < count; i++)
		if (hits[i].object)
			paint(&image, i, &hits[i]);
	free(hits);
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
