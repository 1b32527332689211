/* What a frame shows and where: on whatever GL is here without a screen, next to the picture of the same pose. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include "fake_city.h"
#include "platform/display/display.h"
#include "render/frame.h"
#include "render/near_mesh.h"

/* The driver keeps what it allocated when it is unloaded. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
	return "detect_leaks=0";
}

#define W 320
#define H 180
#define ARENA_BYTES ((size_t)16 << 20)

static struct display display;
static struct fake_city city;
static uint8_t *arena_memory;
static const int32_t shift_mm[2] = { 700000000, -300000000 };
static const struct renderer_time noon = { .time_ns = 1000000000, .ambient = -1.0 };

static int open_display(void **state)
{
	(void)state;
	struct display_config config = { .width = W, .height = H };
	arena_memory = malloc(ARENA_BYTES);
	fake_city_make(&city, 30, shift_mm);
	/* without any GL here the tests are skipped */
	display_open(&display, &display_surfaceless, &config);
	return 0;
}

static int close_display(void **state)
{
	(void)state;
	display_close(&display);
	fake_city_free(&city);
	free(arena_memory);
	return 0;
}

static struct renderer *start(bool truth)
{
	struct arena arena;
	arena_init(&arena, "city", arena_memory, ARENA_BYTES);
	struct renderer_config config = {
		.width = W, .height = H, .samples = 1, .get_proc = display_get_proc, .truth = truth
	};
	struct renderer *renderer;
	assert_int_equal(renderer_init(&renderer, &arena, &config, &city.pkg), 0);
	return renderer;
}

/* A street, a roof's edge with the far end of the city, and straight across the seam of the slices. */
static const struct {
	double east_m, north_m, up_m, heading_rad, pitch_rad;
} poses[] = {
	{ 200.3, 5.0, 3.0, 0.05, 0.02 },
	{ 610.7, 590.2, 40.0, 2.4, -0.2 },
	{ 600.0, 600.0, 151.0, 0.3, -1.45 },
};

static struct camera_pose pose_of(size_t i)
{
	return (struct camera_pose){ .eye_mm = { shift_mm[0] + (int64_t)(poses[i].east_m * 1000.0),
									 shift_mm[1] + (int64_t)(poses[i].north_m * 1000.0),
									 (int64_t)(poses[i].up_m * 1000.0) },
		.heading_rad = poses[i].heading_rad,
		.pitch_rad = poses[i].pitch_rad,
		.fov_rad = BLVD_PI / 4.0 };
}

static uint32_t truth[W * H * 4];
static uint8_t picture[W * H * 4];

static struct dvec3 place_at(size_t pixel)
{
	float at[3];
	memcpy(at, &truth[pixel * 4 + 1], sizeof(at));
	return (struct dvec3){ at[0], at[1], at[2] };
}

/* Largest distance in pixels between where a place is seen and the pixel that shows it. */
static double off_ray_px(const struct view *view, size_t pixel)
{
	struct dvec3 p = place_at(pixel);
	double x = p.x * view->right.x + p.y * view->right.y + p.z * view->right.z;
	double y = p.x * view->up.x + p.y * view->up.y + p.z * view->up.z;
	double z = p.x * view->forward.x + p.y * view->forward.y + p.z * view->forward.z;
	double at_x = W / 2.0 + view->focal_px * x / z, at_y = H / 2.0 - view->focal_px * y / z;
	return hypot(at_x - ((double)(pixel % W) + 0.5), at_y - ((double)(pixel / W) + 0.5));
}

static bool in_box(const struct pkg_object *object, const int64_t eye_mm[3], struct dvec3 p)
{
	const double at[3] = { p.x, p.y, p.z };
	for (int axis = 0; axis < 3; axis++) {
		double mm = (double)eye_mm[axis] + at[axis] * 1000.0;
		if (mm < object->min_mm[axis] - 5.0 || mm > object->max_mm[axis] + 5.0)
			return false;
	}
	return true;
}

static void places_lie_on_their_pixels_rays_and_on_their_objects(void **state)
{
	(void)state;
	if (!display.ops)
		skip();
	struct renderer *renderer = start(true);
	for (size_t i = 0; i < sizeof(poses) / sizeof(poses[0]); i++) {
		struct camera_pose pose = pose_of(i);
		struct view view;
		camera_view(&pose, W, H, 150.0, 6000.0, &view);
		renderer_draw_truth(renderer, &pose, &noon, truth);
		size_t covered = 0;
		for (size_t at = 0; at < W * H; at++) {
			if (!truth[at * 4]) {
				assert_int_equal(truth[at * 4 + 1] | truth[at * 4 + 2] | truth[at * 4 + 3], 0);
				continue;
			}
			covered++;
			assert_in_range(truth[at * 4], 1, city.pkg.object_count);
			assert_true(off_ray_px(&view, at) < 0.01);
			assert_true(in_box(&city.pkg.objects[truth[at * 4] - 1], pose.eye_mm, place_at(at)));
		}
		assert_true(covered > W * H / 3);
	}
	renderer_finish(renderer);
}

/* Sky is where nothing is: its colour does not depend on the city. */
static void what_the_picture_covers_has_an_object(void **state)
{
	(void)state;
	if (!display.ops)
		skip();
	static uint8_t sky[W * H * 4];
	struct pkg empty = city.pkg;
	struct renderer *renderer = start(true);
	struct camera_pose pose = pose_of(1);
	renderer_draw_truth(renderer, &pose, &noon, truth);
	renderer_draw_pose(renderer, &pose, &noon);
	renderer_read_pixels(renderer, picture);
	renderer_finish(renderer);
	city.pkg.chunk_count = 0;
	renderer = start(false);
	renderer_draw_pose(renderer, &pose, &noon);
	renderer_read_pixels(renderer, sky);
	renderer_finish(renderer);
	city.pkg = empty;
	for (size_t at = 0; at < W * H; at++) {
		if (!truth[at * 4])
			assert_memory_equal(picture + at * 4, sky + at * 4, 4);
		else if (place_at(at).z < -2.0) /* towards the horizon haze hides the difference */
			assert_memory_not_equal(picture + at * 4, sky + at * 4, 4);
	}
}

static void the_picture_does_not_change_and_nobody_else_pays(void **state)
{
	(void)state;
	if (!display.ops)
		skip();
	static uint8_t again[W * H * 4];
	struct renderer_stats with, without;
	struct camera_pose pose = pose_of(0);
	struct renderer *renderer = start(false);
	renderer_draw_pose(renderer, &pose, &noon);
	renderer_read_pixels(renderer, picture);
	renderer_stats(renderer, &without);
	renderer_finish(renderer);
	renderer = start(true);
	renderer_draw_truth(renderer, &pose, &noon, truth);
	renderer_draw_pose(renderer, &pose, &noon);
	renderer_read_pixels(renderer, again);
	renderer_stats(renderer, &with);
	renderer_finish(renderer);
	assert_memory_equal(picture, again, sizeof(picture));
	assert_int_equal(with.gpu_bytes - without.gpu_bytes, W * H * (4 + 4 + 16));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(places_lie_on_their_pixels_rays_and_on_their_objects),
		cmocka_unit_test(what_the_picture_covers_has_an_object),
		cmocka_unit_test(the_picture_does_not_change_and_nobody_else_pays),
	};
	return cmocka_run_group_tests(tests, open_display, close_display);
}
