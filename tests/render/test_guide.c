/* Guide lines: where the car will go, and where that is in the picture. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
/* before cmocka */
#include <cmocka.h>

#include "render/guide.h"
#include "render/stroke_font.h"

static const struct guide_config config = { .lens = { .kind = LENS_PINHOLE, .fov_rad = 1.92 },
	.mount = { .height_m = 0.95, .back_m = 0.9, .pitch_rad = 0.56 },
	.wheelbase_m = 2.7,
	.width_m = 1.8,
	.overhang_m = 1.0,
	.mirror = true };
static const struct box picture = { 0.0f, 0.0f, 1280.0f, 720.0f };

static void straight_wheels_go_straight_back(void **state)
{
	(void)state;
	struct dvec2 at = guide_moved(&config, 0.0, 2.5, 1.0, -0.9);
	assert_true(fabs(at.x + 0.9) < 1e-12 && fabs(at.y - 3.5) < 1e-12);
	/* as the angle goes to none, so does the difference */
	struct dvec2 nearly = guide_moved(&config, 1e-3, 2.5, 1.0, -0.9);
	assert_true(fabs(nearly.x - at.x) < 3e-3 && fabs(nearly.y - at.y) < 3e-3);
}

static void every_corner_keeps_its_distance_from_the_turning_point(void **state)
{
	(void)state;
	for (double angle = -0.6; angle <= 0.6; angle += 0.15) {
		double radius = 2.7 / tan(angle);
		for (double right = -0.9; right <= 0.9; right += 1.8) {
			double before = hypot(right - radius, 1.0);
			for (double travel = 0.0; travel < 4.0; travel += 0.5) {
				struct dvec2 at = guide_moved(&config, angle, travel, 1.0, right);
				assert_true(fabs(angle) < 1e-6 || fabs(hypot(at.x - radius, at.y) - before) < 1e-9);
			}
		}
		/* the rear axle's middle travels what was said */
		struct dvec2 middle = guide_moved(&config, angle, 1e-3, 0.0, 0.0);
		assert_true(fabs(hypot(middle.x, middle.y) - 1e-3) < 1e-8);
	}
}

static void wheels_to_the_right_take_the_back_to_the_right(void **state)
{
	(void)state;
	struct dvec2 right = guide_moved(&config, 0.4, 3.0, 1.0, 0.0), left = guide_moved(&config, -0.4, 3.0, 1.0, 0.0);
	assert_true(right.x > 0.5 && left.x < -0.5);
	assert_true(fabs(right.x + left.x) < 1e-9 && fabs(right.y - left.y) < 1e-9);
	/* and in a mirror the car's right is on the right */
	struct vec2 place, other;
	assert_true(guide_place(&config, &picture, 3.0, 0.5, 0.0, &place));
	assert_true(place.x > 640.0f);
	struct guide_config plain = config;
	plain.mirror = false;
	assert_true(guide_place(&plain, &picture, 3.0, 0.5, 0.0, &other));
	assert_true(fabsf(other.x + place.x - 1280.0f) < 1e-3f && fabsf(other.y - place.y) < 1e-3f);
}

static void what_is_farther_is_higher_and_narrower(void **state)
{
	(void)state;
	struct vec2 last = { 1280.0f, 720.0f };
	for (double away = 0.5; away <= 3.0; away += 0.25) {
		struct vec2 at;
		assert_true(guide_place(&config, &picture, 1.0 + away, 0.9, 0.0, &at));
		assert_true(at.y < last.y && at.x < last.x && at.x > 640.0f);
		last = at;
	}
	struct vec2 at;
	assert_false(guide_place(&config, &picture, -3.0, 0.0, 0.0, &at)); /* under the car */
}

static uint32_t drawn(bool known, double angle)
{
	static uint8_t memory[2 << 20];
	struct arena arena;
	struct canvas canvas;
	arena_init(&arena, "canvas", memory, sizeof(memory));
	assert_int_equal(canvas_init(&canvas, &arena, NULL, NULL, 16384), 0);
	canvas_begin(&canvas, 1280, 720);
	guide_draw(&canvas, &config, &picture, known, angle, 1.0f, 1.0f);
	assert_int_equal(canvas.dropped, 0);
	for (uint32_t i = 0; i < canvas.vertex_count; i++)
		assert_true(isfinite(canvas.vertices[i].x) && isfinite(canvas.vertices[i].y));
	return canvas.vertex_count;
}

static void a_path_is_drawn_only_for_a_known_angle(void **state)
{
	(void)state;
	assert_true(drawn(false, 0.0) < drawn(true, 0.0));
	static const double angles[] = { 0.0, 1e-9, -0.3, 0.6, 3.0, -100.0, 1e300 };
	for (size_t i = 0; i < sizeof(angles) / sizeof(angles[0]); i++)
		assert_true(drawn(true, angles[i]) > 500);
}

static void letters_fill_their_width(void **state)
{
	(void)state;
	assert_true(stroke_font_width("", 20.0f) <= 0.0f);
	assert_true(stroke_font_width("I", 20.0f) < stroke_font_width("M", 20.0f));
	assert_true(fabsf(stroke_font_width("NO MAP", 40.0f) - 2.0f * stroke_font_width("NO MAP", 20.0f)) < 1e-3f);
	assert_true(fabsf(stroke_font_width("no map", 20.0f) - stroke_font_width("NO MAP", 20.0f)) < 1e-3f);
	static uint8_t memory[2 << 20];
	struct arena arena;
	struct canvas canvas;
	arena_init(&arena, "canvas", memory, sizeof(memory));
	assert_int_equal(canvas_init(&canvas, &arena, NULL, NULL, 16384), 0);
	canvas_begin(&canvas, 1280, 720);
	const struct stroke_style style = { .cap_px = 30.0f, .color = { 1, 1, 1, 1 } };
	float width = stroke_font_draw(&canvas, "THE QUICK BROWN FOX 0123456789 !%+,-./:?", 0.0f, 100.0f, &style);
	for (uint32_t i = 0; i < canvas.vertex_count; i++) {
		assert_true(canvas.vertices[i].x > -10.0f && canvas.vertices[i].x < width + 10.0f);
		assert_true(canvas.vertices[i].y > 70.0f && canvas.vertices[i].y < 130.0f);
	}
	stroke_font_draw(&canvas, "\xC3\xA9\x01\x7F{}~", 0.0f, 100.0f, &style);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(straight_wheels_go_straight_back),
		cmocka_unit_test(every_corner_keeps_its_distance_from_the_turning_point),
		cmocka_unit_test(wheels_to_the_right_take_the_back_to_the_right),
		cmocka_unit_test(what_is_farther_is_higher_and_narrower),
		cmocka_unit_test(a_path_is_drawn_only_for_a_known_angle),
		cmocka_unit_test(letters_fill_their_width),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
