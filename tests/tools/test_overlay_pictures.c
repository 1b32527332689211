/*
 * Draws the overlay over a plain ground for many states and screen sizes, by the headless display. Checks that it draws
 * and that the same state gives the same bytes. With BLVD_PICTURES=DIR the pictures are kept there to look at.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>

#include "overlay_city.h"
#include "platform/display/display.h"
#include "render/overlay.h"
#include "tools/measure/image.h"

static struct overlay_city city;
static struct display display;
static struct gfx *gfx;
static bool ready;
static uint8_t *memory;
static struct arena arena;
#define MEMORY_BYTES ((size_t)64 << 20)

static int open_all(void **state)
{
	(void)state;
	memory = malloc(MEMORY_BYTES);
	arena_init(&arena, "test", memory, MEMORY_BYTES);
	struct display_config config = { .width = 64, .height = 64, .title = "test" };
	ready = overlay_city_make(&city) && display_open(&display, &display_surfaceless, &config) == 0 &&
			gfx_init(&gfx, &arena, &gfx_gles3, NULL) == 0;
	return 0;
}

static int close_all(void **state)
{
	(void)state;
	gfx_finish(gfx);
	display_close(&display);
	overlay_city_finish(&city);
	free(memory);
	return 0;
}

struct scene {
	const char *name;
	uint32_t width, height;
	enum camera_kind kind;
	double driven_m, ambient;
	void (*change)(struct nav_view *nav);
	const char *message;
	struct overlay_config config;
};

static void speeding(struct nav_view *nav)
{
	nav->speed_mps = 17.0;
	nav->next.manoeuvre = NAV_MANOEUVRE_ROUNDABOUT;
	nav->next.exit = 3;
	nav->next.angle_bam = bam_from_rad(-1.4);
	nav->next.distance_m = 1240.0;
	nav->signal[NAV_SIGNAL_LATITUDE] = NAV_SIGNAL_STALE;
	nav->signal_age_ns[NAV_SIGNAL_LATITUDE] = INT64_C(14000000000);
}
static void lost(struct nav_view *nav)
{
	*nav = (struct nav_view){
		.pos_mm = { nav->pos_mm[0], nav->pos_mm[1], nav->pos_mm[2] }, .half = PKG_NONE, .ambient = 1.0
	};
}
static void searching(struct nav_view *nav)
{
	nav->off_route = true;
	nav->routed = false;
	nav->route_count = 0;
	nav->limit_posted = false;
}
static void long_names(struct nav_view *nav)
{
	nav->next.street = city.name[6];
	nav->street = city.name[6];
	nav->after_next = nav->next;
	nav->after_next.distance_m += 80.0;
	nav->after_next.street = city.name[14];
	nav->signal[NAV_SIGNAL_YAW_RATE] = NAV_SIGNAL_IMPLAUSIBLE;
}
static void free_drive(struct nav_view *nav)
{
	nav->routed = false;
	nav->route_count = 0;
	nav->next.manoeuvre = nav->after_next.manoeuvre = NAV_MANOEUVRE_NONE;
}

static const struct scene scenes[] = {
	{ "day", 1280, 720, CAMERA_DRIVER, 200.0, 1.0, NULL, NULL, { .zone_given = true, .utc_offset_minutes = 120 } },
	{ "turn", 1280, 720, CAMERA_DRIVER, 305.0, 1.0, NULL, NULL, { 0 } },
	{ "night", 1280, 720, CAMERA_DRIVER, 200.0, 0.0, NULL, NULL, { .zone_given = true } },
	{ "speeding", 1280, 720, CAMERA_CHASE, 150.0, 1.0, speeding, NULL, { 0 } },
	{ "lost", 1280, 720, CAMERA_DRIVER, 150.0, 1.0, lost, NULL, { 0 } },
	{ "searching", 1280, 720, CAMERA_CHASE, 150.0, 0.0, searching, "Map damaged: parts are missing", { 0 } },
	{ "long", 1280, 720, CAMERA_CHASE, 250.0, 1.0, long_names, "Map damaged: parts are missing", { 0 } },
	{ "miles", 1280, 720, CAMERA_CHASE, 100.0, 1.0, NULL, NULL, { .units = UNITS_MILES_FEET } },
	{ "north", 1280, 720, CAMERA_NORTH_UP, 250.0, 1.0, NULL, NULL, { 0 } },
	{ "heading", 1280, 720, CAMERA_HEADING_UP, 250.0, 0.0, NULL, NULL, { 0 } },
	{ "free", 1920, 720, CAMERA_DRIVER, 250.0, 1.0, free_drive, NULL, { 0 } },
	{ "wide", 1920, 720, CAMERA_CHASE, 290.0, 1.0, NULL, NULL, { .zone_given = true } },
	{ "small", 480, 272, CAMERA_DRIVER, 200.0, 1.0, long_names, NULL, { 0 } },
	{ "small-night", 480, 272, CAMERA_CHASE, 200.0, 0.0, speeding, "Map damaged: parts are missing",
		{ .zone_given = true } },
	{ "portrait", 720, 1280, CAMERA_CHASE, 270.0, 1.0, long_names, NULL, { .zone_given = true } },
	{ "800x480", 800, 480, CAMERA_DRIVER, 240.0, 1.0, NULL, NULL, { .zone_given = true } },
};

static const int corners[][2] = { { 2, 1 }, { 2, 5 }, { 4, 5 }, { 4, 9 }, { 8, 9 }, { 8, 4 } };
#define FRAMES 90
#define FRAME_NS INT64_C(16666667)

static void draw_frame(
	struct overlay *overlay, gfx_target target, const struct scene *scene, double driven_m, int64_t time_ns)
{
	uint32_t route[128];
	struct nav_view nav;
	struct view view;
	uint32_t count = overlay_city_route(&city, corners, sizeof(corners) / sizeof(corners[0]), route, 128);
	overlay_city_drive(&city, route, count, driven_m, 12.0, &nav);
	nav.ambient = scene->ambient;
	nav.wall_ns = INT64_C(1750000000000000000);
	if (scene->change)
		scene->change(&nav);
	overlay_city_view(&nav, scene->kind, scene->width, scene->height, &view);
	struct overlay_input input = { .view = &view, .nav = &nav, .kind = scene->kind, .time_ns = time_ns };
	input.message = scene->message;
	gfx_frame_begin(gfx);
	overlay_update(overlay, &input);
	struct gfx_clear clear = { .color = true, .depth = true, .rgba = { 0.62f, 0.66f, 0.68f, 1.0f } };
	if (scene->ambient < 0.5)
		memcpy(clear.rgba, (float[4]){ 0.09f, 0.11f, 0.15f, 1.0f }, sizeof(clear.rgba));
	gfx_pass_begin(gfx, target, &clear);
	for (int slice = VIEW_SLICE_COUNT - 1; slice >= 0; slice--) {
		gfx_depth_range(gfx, view.slice[slice].depth_near, view.slice[slice].depth_far);
		overlay_draw_world(overlay, (enum view_slice_id)slice);
	}
	for (int slice = VIEW_SLICE_COUNT - 1; slice >= 0; slice--) {
		gfx_depth_range(gfx, view.slice[slice].depth_near, view.slice[slice].depth_far);
		overlay_draw_hidden(overlay, (enum view_slice_id)slice);
	}
	gfx_depth_range(gfx, 0.0f, 1.0f);
	overlay_draw_screen(overlay);
	gfx_pass_end(gfx);
}

static void draw_scene(const struct scene *scene, uint8_t *pixels)
{
	struct overlay overlay;
	gfx_target target;
	size_t mark = arena_mark(&arena);
	struct gfx_target_desc desc = { .width = scene->width, .height = scene->height, .samples = 4 };
	assert_int_equal(gfx_target_create(gfx, &desc, &target), 0);
	assert_int_equal(overlay_init(&overlay, &arena, gfx, &city.pkg, &scene->config), 0);
	for (int i = 0; i < FRAMES; i++)
		if (i % 10 == 9)
			draw_frame(&overlay, target, scene, scene->driven_m - 12.0 * (FRAMES - i) / 60.0, FRAME_NS * i);
	gfx_read_rgba8(gfx, target, pixels);
	assert_int_equal(overlay.canvas.dropped, 0);
	overlay_finish(&overlay);
	gfx_target_destroy(gfx, target);
	arena_release(&arena, mark);
}

static void keep(const struct scene *scene, const uint8_t *pixels)
{
	char path[512];
	const char *folder = getenv("BLVD_PICTURES");
	if (!folder)
		return;
	snprintf(path, sizeof(path), "%s/overlay-%s.png", folder, scene->name);
	size_t count = (size_t)scene->width * scene->height;
	struct image image = { .width = scene->width, .height = scene->height, .rgb = malloc(count * 3) };
	for (size_t i = 0; i < count; i++)
		memcpy(image.rgb + 3 * i, pixels + 4 * i, 3);
	assert_int_equal(image_write_png(&image, path), 0);
	free(image.rgb);
}

static void every_state_draws_and_repeats(void **state)
{
	(void)state;
	if (!ready) {
		printf("skipped: no fonts or no headless display\n");
		skip();
	}
	for (size_t i = 0; i < sizeof(scenes) / sizeof(scenes[0]); i++) {
		size_t bytes = (size_t)scenes[i].width * scenes[i].height * 4;
		uint8_t *first = malloc(bytes), *second = malloc(bytes);
		draw_scene(&scenes[i], first);
		keep(&scenes[i], first);
		if (i % 4 == 0) {
			draw_scene(&scenes[i], second);
			assert_memory_equal(first, second, bytes);
		}
		size_t touched = 0;
		for (size_t k = 0; k < bytes; k += 4)
			touched += memcmp(first + k, first + bytes - 4 * (size_t)scenes[i].width, 3) != 0;
		assert_true(touched > bytes / 400);
		free(first);
		free(second);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(every_state_draws_and_repeats) };
	return cmocka_run_group_tests(tests, open_all, close_all);
}
