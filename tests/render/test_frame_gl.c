/* Frames on whatever GL is here without a screen (llvmpipe). BLVD_PICTURES=DIR keeps what was drawn. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
/* before cmocka */
#include <cmocka.h>

#include "fake_city.h"
#include "platform/base/geo.h"
#include "platform/display/display.h"
#include "render/frame.h"

/* The driver keeps what it allocated when it is unloaded; leaks of ours are looked for in test_frame_dummy. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
	return "detect_leaks=0";
}

#define W 320
#define H 180

static struct display display;
static uint8_t *arena_memory;
#define ARENA_BYTES ((size_t)16 << 20)

static int open_display(void **state)
{
	(void)state;
	struct display_config config = { .width = W, .height = H };
	arena_memory = malloc(ARENA_BYTES);
	/* without any GL here the tests are skipped */
	display_open(&display, &display_surfaceless, &config);
	return 0;
}

static int close_display(void **state)
{
	(void)state;
	display_close(&display);
	free(arena_memory);
	return 0;
}

static void keep(const char *name, const uint8_t *px)
{
	const char *dir = getenv("BLVD_PICTURES");
	char path[512];
	if (!dir)
		return;
	snprintf(path, sizeof(path), "%s/%s.ppm", dir, name);
	FILE *file = fopen(path, "wb");
	if (!file)
		return;
	fprintf(file, "P6\n%d %d\n255\n", W, H);
	for (int i = 0; i < W * H; i++)
		fwrite(px + (size_t)i * 4, 1, 3, file);
	fclose(file);
}

struct look {
	int32_t shift_mm[2];
	int blocks;
	double east_m, north_m, up_m, heading_rad, pitch_rad;
	bool night;
	uint32_t samples;
	uint64_t budget;
	const char *far_name;
};

struct easel {
	struct fake_city city;
	struct renderer *renderer;
};

/* With `screen`, or NULL: one of its own. */
static void easel_open(struct easel *easel, const struct look *look, const struct screen *screen)
{
	fake_city_make(&easel->city, look->blocks ? look->blocks : 12, look->shift_mm);
	struct arena arena;
	arena_init(&arena, "city", arena_memory, ARENA_BYTES);
	struct renderer_config config = { .width = W,
		.height = H,
		.samples = look->samples,
		.get_proc = display_get_proc,
		.gpu_budget_bytes = look->budget,
		.far_name = look->far_name,
		.screen = screen };
	assert_int_equal(renderer_init(&easel->renderer, &arena, &config, &easel->city.pkg), 0);
}

static void easel_draw(struct easel *easel, const struct look *look, uint8_t *px)
{
	struct camera_pose pose = { .heading_rad = look->heading_rad, .pitch_rad = look->pitch_rad };
	pose.eye_mm[0] = look->shift_mm[0] + (int64_t)(look->east_m * 1000.0);
	pose.eye_mm[1] = look->shift_mm[1] + (int64_t)(look->north_m * 1000.0);
	pose.eye_mm[2] = (int64_t)(look->up_m * 1000.0);
	struct renderer_time time = { .time_ns = 1000000000, .ambient = -1.0, .force_night = look->night };
	renderer_draw_pose(easel->renderer, &pose, &time);
	renderer_read_pixels(easel->renderer, px);
}

static void easel_close(struct easel *easel)
{
	renderer_finish(easel->renderer);
	fake_city_free(&easel->city);
}

static void picture(const struct look *look, uint8_t *px, struct renderer_stats *stats)
{
	struct easel easel;
	easel_open(&easel, look, NULL);
	easel_draw(&easel, look, px);
	if (stats)
		renderer_stats(easel.renderer, stats);
	easel_close(&easel);
}

static const struct look street = {
	.east_m = 200.0, .north_m = 5.0, .up_m = 3.0, .heading_rad = 0.05, .pitch_rad = 0.02, .samples = 4
};

static int largest_difference(const uint8_t *a, const uint8_t *b)
{
	int largest = 0;
	for (int i = 0; i < W * H * 4; i++) {
		int d = abs(a[i] - b[i]);
		largest = d > largest ? d : largest;
	}
	return largest;
}

static uint8_t px_a[W * H * 4], px_b[W * H * 4];

static void a_street_has_sky_above_and_road_below(void **state)
{
	(void)state;
	struct renderer_stats stats;
	if (!display.ops)
		skip();
	picture(&street, px_a, &stats);
	keep("street", px_a);
	const uint8_t *sky = px_a + (size_t)(5 * W + W / 2) * 4, *road = px_a + (size_t)((H - 5) * W + W / 2 - 40) * 4;
	assert_true(sky[2] > sky[0] && sky[2] > 120);
	assert_true(abs(road[0] - road[2]) < 40 && road[0] < 150);
	assert_int_equal(stats.chunks_wanted_missing, 0); /* what is behind the eye may come later */
	assert_in_range(stats.chunks_resident, 100, 144);
	assert_true(stats.triangles > 300 && stats.draws > 40);
}

static void the_same_frame_twice_is_the_same_bytes(void **state)
{
	(void)state;
	if (!display.ops)
		skip();
	picture(&street, px_a, NULL);
	picture(&street, px_b, NULL);
	assert_memory_equal(px_a, px_b, sizeof(px_a));
}

static void a_world_far_from_its_origin_looks_the_same(void **state)
{
	(void)state;
	if (!display.ops)
		skip();
	struct look far_away = street;
	/* 2,097 km, as far as int32 mm go: a multiple of 1,024 m, so that water's waves fall together too */
	far_away.shift_mm[0] = 2000 * 1048576;
	far_away.shift_mm[1] = -2000 * 1048576;
	picture(&street, px_a, NULL);
	picture(&far_away, px_b, NULL);
	keep("far_away", px_b);
	assert_in_range(largest_difference(px_a, px_b), 0, 1);
}

static void night_is_dark_but_not_black(void **state)
{
	(void)state;
	if (!display.ops)
		skip();
	struct look look = street;
	look.night = true;
	picture(&look, px_a, NULL);
	keep("night", px_a);
	uint64_t sum = 0;
	int brightest = 0;
	for (int i = 0; i < W * H; i++) {
		for (int c = 0; c < 3; c++) {
			sum += px_a[i * 4 + c];
			brightest = px_a[i * 4 + c] > brightest ? px_a[i * 4 + c] : brightest;
		}
	}
	assert_in_range(sum / (W * H * 3), 8, 90);
	assert_true(brightest < 250);
}

static void no_hole_where_the_slices_meet(void **state)
{
	(void)state;
	if (!display.ops)
		skip();
	/* straight down from where the ground is exactly at the seam: nothing but ground may be seen */
	struct look look = {
		.blocks = 40, .east_m = 800.0, .north_m = 800.0, .up_m = 151.0, .pitch_rad = -1.45, .samples = 1
	};
	for (int step = 0; step < 8; step++) {
		look.up_m = 147.0 + step;
		picture(&look, px_a, NULL);
		if (step == 4)
			keep("seam", px_a);
		for (int i = 0; i < W * H; i++) {
			const uint8_t *p = px_a + (size_t)i * 4;
			bool sky = p[2] > p[0] + 60 && p[2] > 150;
			assert_false(sky);
		}
	}
}

static void a_small_budget_draws_what_is_near(void **state)
{
	(void)state;
	if (!display.ops)
		skip();
	struct renderer_stats stats;
	struct look look = street;
	look.blocks = 40;
	/* target and textures, and half of the city */
	picture(&look, px_a, &stats);
	look.budget = stats.gpu_bytes - (uint64_t)40 * 40 * 756 / 2;
	picture(&look, px_b, &stats);
	keep("half", px_b);
	assert_true(stats.gpu_bytes <= look.budget);
	assert_in_range(stats.chunks_resident, 700, 801);
	const uint8_t *a = px_a + (size_t)(H - 20) * W * 4, *b = px_b + (size_t)(H - 20) * W * 4;
	assert_memory_equal(a, b, 20 * W * 4);
}

static void drawing_nothing_far_leaves_the_near_as_it_is(void **state)
{
	(void)state;
	if (!display.ops)
		skip();
	struct renderer_stats full, none;
	struct look look = street;
	look.blocks = 40;
	picture(&look, px_a, &full);
	look.far_name = "none";
	picture(&look, px_b, &none);
	assert_true(none.triangles < full.triangles);
	assert_memory_equal(px_a + (size_t)(H - 20) * W * 4, px_b + (size_t)(H - 20) * W * 4, 20 * W * 4);
}

static void a_plain_first_picture_gets_its_samples_later(void **state)
{
	(void)state;
	static uint8_t drawn[W * H * 4], screen_memory[2 << 20];
	if (!display.ops)
		skip();
	struct look plain = street;
	plain.samples = 1;
	picture(&plain, px_a, NULL);
	picture(&street, px_b, NULL);
	struct arena arena;
	arena_init(&arena, "screen", screen_memory, sizeof(screen_memory));
	struct screen_config config = {
		.width = W, .height = H, .samples = 4, .get_proc = display_get_proc, .plain_first = true
	};
	struct screen screen;
	assert_int_equal(screen_init(&screen, &arena, &config), 0);
	assert_int_equal(gfx_target_samples(screen.gfx, screen.target), 4);
	struct easel easel;
	easel_open(&easel, &street, &screen);
	easel_draw(&easel, &street, drawn);
	assert_int_equal(largest_difference(drawn, px_a), 0);
	uint64_t counted = gfx_stats(screen.gfx)->bytes; /* with all samples */
	gfx_target_refine(screen.gfx, screen.target);
	screen_read_pixels(&screen, drawn);
	assert_int_equal(largest_difference(drawn, px_a), 0); /* the picture stays */
	easel_draw(&easel, &street, drawn);
	assert_int_equal(largest_difference(drawn, px_b), 0);
	gfx_target_refine(screen.gfx, screen.target); /* again: nothing */
	assert_int_equal(gfx_stats(screen.gfx)->bytes, counted);
	easel_close(&easel);
	screen_finish(&screen);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_street_has_sky_above_and_road_below),
		cmocka_unit_test(the_same_frame_twice_is_the_same_bytes),
		cmocka_unit_test(a_world_far_from_its_origin_looks_the_same),
		cmocka_unit_test(night_is_dark_but_not_black),
		cmocka_unit_test(no_hole_where_the_slices_meet),
		cmocka_unit_test(a_small_budget_draws_what_is_near),
		cmocka_unit_test(drawing_nothing_far_leaves_the_near_as_it_is),
		cmocka_unit_test(a_plain_first_picture_gets_its_samples_later),
	};
	return cmocka_run_group_tests(tests, open_display, close_display);
}
