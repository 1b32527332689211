/* Displacement of what a picture shows, on walls whose positions are worked out by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "tools/measure/displacement.h"

#define W 64
#define H 24
#define FOCAL 100.0

static struct truth_pixel reference_pixels[W * H], shown_pixels[W * H];
static float map[W * H];
static struct displacement_depth depths[W * H];

/* Looking north, level. */
static struct truth_image image_of(const struct truth_pixel *pixels)
{
	return (struct truth_image){ W, H, FOCAL, { 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 }, pixels };
}

/* The place that is seen at a position of the picture, at a depth. */
static struct truth_pixel place(uint32_t object, double x, double y, double depth_m)
{
	return (struct truth_pixel){ object + 1,
		{ (float)((x - W / 2.0) / FOCAL * depth_m), (float)depth_m, (float)((H / 2.0 - y) / FOCAL * depth_m) } };
}

/* A wall across the view. Every pixel shows what belongs `shift_px` to the left of it. */
static void fill_wall(struct truth_pixel *pixels, double depth_m, double shift_px)
{
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++)
			pixels[y * W + x] = place(7, x + 0.5 - shift_px, y + 0.5, depth_m);
}

/* A wall along the view, 5 m to the right; sky to the left. Depth is 5 f / (x - middle). */
static void fill_facade(struct truth_pixel *pixels, double shift_px)
{
	for (int y = 0; y < H; y++) {
		for (int x = 0; x < W; x++) {
			double at = x + 0.5 - shift_px;
			bool on_wall = at > W / 2.0 + 0.25;
			pixels[y * W + x] =
				on_wall ? place(3, at, y + 0.5, 5.0 * FOCAL / (at - W / 2.0)) : (struct truth_pixel){ 0 };
		}
	}
}

static void compare(void)
{
	struct truth_image reference = image_of(reference_pixels), shown = image_of(shown_pixels);
	displacement_begin(&reference, map);
	displacement_depths(&reference, depths);
	displacement_offer(&reference, depths, &shown, map);
}

static float at(int x, int y)
{
	return map[y * W + x];
}

static void places_project_where_they_are_seen(void **state)
{
	(void)state;
	struct truth_image image = image_of(reference_pixels);
	struct truth_pixel pixel = place(0, 10.25, 20.5, 300.0);
	double x = 0.0, y = 0.0;
	assert_true(truth_project(&image, &pixel, &x, &y));
	assert_true(fabs(x - 10.25) < 1e-4 && fabs(y - 20.5) < 1e-4);
	pixel.from_eye_m[1] = -1.0f;
	assert_false(truth_project(&image, &pixel, &x, &y));
}

static void equal_pictures_are_not_displaced(void **state)
{
	(void)state;
	fill_facade(reference_pixels, 0.0);
	memcpy(shown_pixels, reference_pixels, sizeof(shown_pixels));
	compare();
	for (int i = 0; i < W * H; i++)
		assert_true(map[i] == (reference_pixels[i].object ? 0.0f : DISPLACEMENT_NOTHING));
}

static void a_moved_picture_is_displaced_by_its_motion(void **state)
{
	(void)state;
	static const double shifts[] = { 0.5, 1.0, 3.0, 12.0, -2.0 };
	for (size_t i = 0; i < sizeof(shifts) / sizeof(shifts[0]); i++) {
		fill_wall(reference_pixels, 200.0, 0.0);
		fill_wall(shown_pixels, 200.0, shifts[i]);
		compare();
		for (int y = 0; y < H; y++)
			for (int x = 14; x < W - 14; x++)
				assert_true(fabs((double)at(x, y) - fabs(shifts[i])) < 1e-3);
	}
}

static void motion_beyond_the_reach_is_not_found(void **state)
{
	(void)state;
	fill_wall(reference_pixels, 200.0, 0.0);
	fill_wall(shown_pixels, 200.0, 17.0);
	compare();
	for (int i = 0; i < W * H; i++)
		assert_true(isinf(map[i]));
}

/* Columns 20 to 29 are missing. Beside them the neighbour is one pixel off: 1 - 0.7071. */
static void missing_surface_is_not_found(void **state)
{
	(void)state;
	fill_wall(reference_pixels, 200.0, 0.0);
	fill_wall(shown_pixels, 200.0, 0.0);
	for (int y = 0; y < H; y++)
		memset(&shown_pixels[y * W + 20], 0, 10 * sizeof(shown_pixels[0]));
	compare();
	for (int x = 0; x < W; x++) {
		if (x == 20 || x == 29)
			assert_true(fabs((double)at(x, 5) - 0.29289) < 1e-3);
		else
			assert_true(x > 20 && x < 29 ? isinf(at(x, 5)) : at(x, 5) == 0.0f);
	}
}

/* Neighbouring pixels are up to 667 m apart along it: (x - middle) 0.5 is at 1,000 m, 1.5 at 333 m. */
static void a_grazing_facade_is_measured_in_the_picture(void **state)
{
	(void)state;
	fill_facade(reference_pixels, 0.0);
	fill_facade(shown_pixels, 0.5);
	compare();
	for (int x = W / 2 + 1; x < W - 2; x++)
		assert_true(fabs((double)at(x, 11) - 0.5) < 1e-3);
}

/* An object before a wall reaches one pixel too far to the right. */
static void an_outline_one_pixel_off_is_less_than_a_pixel(void **state)
{
	(void)state;
	fill_wall(reference_pixels, 300.0, 0.0);
	fill_wall(shown_pixels, 300.0, 0.0);
	for (int y = 0; y < H; y++) {
		for (int x = 10; x < 20; x++)
			reference_pixels[y * W + x] = shown_pixels[y * W + x] = place(1, x + 0.5, y + 0.5, 150.0);
		shown_pixels[y * W + 20] = place(1, 19.9, y + 0.5, 150.0);
	}
	compare();
	assert_true(at(19, 8) == 0.0f && at(21, 8) == 0.0f);
	assert_true(fabs((double)at(20, 8) - 0.29289) < 1e-3);
}

/* A rail of a third of a pixel before a wall: in the middles of a row of pixels or of none. */
static void fill_rail(struct truth_pixel *pixels, struct dvec2 sample_px, double moved_px)
{
	for (int y = 0; y < H; y++) {
		for (int x = 0; x < W; x++) {
			double at_x = x + 0.5 + sample_px.x, at_y = y + 0.5 + sample_px.y - moved_px;
			bool rail = fabs(at_y - 10.5) < 1.0 / 6.0;
			pixels[y * W + x] = rail ? place(1, at_x, at_y, 150.0) : place(7, at_x, at_y, 200.0);
		}
	}
}

static void what_is_thinner_than_a_pixel_is_found_where_it_moved_to(void **state)
{
	(void)state;
	fill_rail(reference_pixels, (struct dvec2){ 0, 0 }, 0.0);
	fill_rail(shown_pixels, (struct dvec2){ 0, 0 }, 0.5);
	compare();
	assert_true(isinf(at(30, 10))); /* it lies between the middles of two rows */
	struct truth_image reference = image_of(reference_pixels);
	for (int i = 0; i < DISPLACEMENT_SAMPLES; i++) {
		struct truth_image shown = image_of(shown_pixels);
		shown.sample_px = displacement_samples[i];
		fill_rail(shown_pixels, shown.sample_px, 0.5);
		displacement_offer(&reference, depths, &shown, map);
	}
	for (int x = 2; x < W - 2; x++)
		assert_true(fabs((double)at(x, 10) - 0.5) < 0.05);
}

/* Land from 2 m above it, seen in one row of pixels only: a wall hides it nearer by, another ends it. */
static void fill_strip(struct truth_pixel *pixels, struct dvec2 sample_px, double moved_px)
{
	for (int y = 0; y < H; y++) {
		for (int x = 0; x < W; x++) {
			double at_x = x + 0.5 + sample_px.x, at_y = y + 0.5 + sample_px.y - moved_px;
			double below = at_y - H / 2.0;
			bool land = below > 1.1 && below < 1.9;
			pixels[y * W + x] = land ? place(4, at_x, at_y, 2.0 * FOCAL / below) : place(7, at_x, at_y, 50.0);
		}
	}
}

static void land_that_a_pixel_shows_hundreds_of_metres_of_is_found(void **state)
{
	(void)state;
	struct truth_image reference = image_of(reference_pixels), sample = image_of(shown_pixels);
	fill_strip(reference_pixels, (struct dvec2){ 0, 0 }, 0.0);
	displacement_begin(&reference, map);
	displacement_depths(&reference, depths);
	for (int i = 0; i < DISPLACEMENT_SAMPLES; i++) {
		sample.sample_px = displacement_samples[i];
		fill_strip(shown_pixels, sample.sample_px, 0.0);
		displacement_widen(&reference, &sample, depths);
	}
	for (int i = 0; i < DISPLACEMENT_SAMPLES; i++) {
		sample.sample_px = displacement_samples[i];
		fill_strip(shown_pixels, sample.sample_px, 0.6);
		displacement_offer(&reference, depths, &sample, map);
	}
	for (int x = 2; x < W - 2; x++)
		assert_true(fabs((double)at(x, H / 2 + 1) - 0.6) < 0.05);
}

/* The same land, all that is seen of it one pixel between two posts: no sample around tells how deep it is. */
static void the_ground_is_as_deep_as_a_level_plane_in_the_pixel(void **state)
{
	(void)state;
	static const struct {
		uint32_t object;
		double moved_px, found_px;
	} cases[] = { { 4, 0.6, INFINITY }, { TRUTH_GROUND - 1, 0.6, 0.6 }, { TRUTH_WATER - 1, -0.5, 0.5 },
		{ TRUTH_GROUND - 1, 1.7, INFINITY } };
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const double x = 30.5, y = H / 2 + 2.5, depth_m = 2.0 * FOCAL / 2.5;
		double moved_m = 2.0 * FOCAL / (2.5 - cases[i].moved_px);
		fill_wall(reference_pixels, 50.0, 0.0);
		fill_wall(shown_pixels, 50.0, 0.0);
		reference_pixels[(H / 2 + 2) * W + 30] = place(cases[i].object, x, y, depth_m);
		shown_pixels[(H / 2 + 2) * W + 30] = place(cases[i].object, x, y - cases[i].moved_px, moved_m);
		compare();
		double found_px = (double)at(30, H / 2 + 2);
		assert_true(isinf(cases[i].found_px) ? isinf(found_px) : fabs(found_px - cases[i].found_px) < 0.05);
	}
}

static void samples_differ_in_both_coordinates(void **state)
{
	(void)state;
	unsigned columns = 0, rows = 0;
	for (int i = 0; i < DISPLACEMENT_SAMPLES; i++) {
		columns |= 1u << (int)floor((displacement_samples[i].x + 0.5) * DISPLACEMENT_SAMPLES);
		rows |= 1u << (int)floor((displacement_samples[i].y + 0.5) * DISPLACEMENT_SAMPLES);
	}
	assert_int_equal(columns, (1u << DISPLACEMENT_SAMPLES) - 1);
	assert_int_equal(rows, (1u << DISPLACEMENT_SAMPLES) - 1);
}

static void other_surfaces_in_the_same_place_do_not_count(void **state)
{
	(void)state;
	fill_wall(reference_pixels, 200.0, 0.0);
	fill_wall(shown_pixels, 200.0, 0.0);
	for (int i = 0; i < W * H; i++)
		shown_pixels[i].object = 9;
	compare();
	assert_true(isinf(at(30, 10))); /* another object */
	fill_wall(shown_pixels, 220.0, 0.0);
	compare();
	assert_true(isinf(at(30, 10))); /* its back wall; a pixel is 2 m wide there, three of them are the margin */
	fill_wall(shown_pixels, 205.0, 0.0);
	compare();
	assert_true(at(30, 10) == 0.0f);
}

/* Texels twice as wide as pixels: each place is shown half a pixel off. */
static void coarse_positions_cost_half_their_width(void **state)
{
	(void)state;
	fill_wall(reference_pixels, 200.0, 0.0);
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++)
			shown_pixels[y * W + x] = place(7, x / 2 * 2 + 1.0, y + 0.5, 200.0);
	compare();
	for (int x = 1; x < W - 1; x++)
		assert_true(fabs((double)at(x, 10) - 0.5) < 1e-3);
}

static void far_is_beside_the_axis_and_beyond_its_ends(void **state)
{
	(void)state;
	struct far_limit limit = { { 0, -10 }, { 0, 40 }, 100.0 };
	static const struct {
		float x, y;
		bool far;
	} cases[] = { { 99, 0, false }, { 101, 20, true }, { 0, 139, false }, { 0, 141, true }, { 60, 121, true },
		{ 60, 119, false }, { -70, -82, true } };
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct truth_pixel pixel = { 1, { cases[i].x, cases[i].y, 50.0f } };
		assert_int_equal(far_limit_beyond(&limit, &pixel), cases[i].far);
	}
	struct far_limit point = { { 3, 4 }, { 3, 4 }, 5.0 };
	struct truth_pixel pixel = { 1, { 0.0f, -0.1f, 0.0f } };
	assert_true(far_limit_beyond(&point, &pixel));
}

/* Eight values: 0 (three times), 0.1, 0.3, 0.9, 3 and one not found. */
static void counts_add_up(void **state)
{
	(void)state;
	static const float values[] = { 0.0f, 0.0f, 0.0f, 0.1f, 0.3f, 0.9f, 3.0f, INFINITY };
	fill_wall(reference_pixels, 200.0, 0.0);
	for (int i = 0; i < W * H; i++)
		map[i] = i < 8 ? values[i] : DISPLACEMENT_NOTHING;
	struct truth_image reference = image_of(reference_pixels);
	struct displacement_count count = { 0 }, sum = { 0 };
	displacement_add(&count, &reference, map, NULL);
	assert_int_equal(displacement_total(&count), 8);
	assert_true(displacement_share(&count, 1.0) == 6.0 / 8.0);
	assert_true(displacement_share(&count, 0.25) == 4.0 / 8.0);
	assert_true(displacement_share_lost(&count) == 1.0 / 8.0);
	assert_true(count.max_px == 3.0);
	assert_true(displacement_quantile(&count, 0.25) == 0.0);
	assert_true(displacement_quantile(&count, 0.75) == 1.0);      /* end of the class of 0.9 */
	assert_true(displacement_quantile(&count, 7.0 / 8.0) == 3.0); /* no class goes beyond the maximum */
	assert_true(isinf(displacement_quantile(&count, 0.99)));
	displacement_join(&sum, &count);
	displacement_join(&sum, &count);
	assert_int_equal(displacement_total(&sum), 16);
	assert_true(displacement_share(&(struct displacement_count){ 0 }, 1.0) == 1.0);
	struct far_limit limit = { { 0, 0 }, { 0, 0 }, 1000.0 };
	count = (struct displacement_count){ 0 };
	displacement_add(&count, &reference, map, &limit);
	assert_int_equal(displacement_total(&count), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(places_project_where_they_are_seen),
		cmocka_unit_test(equal_pictures_are_not_displaced),
		cmocka_unit_test(a_moved_picture_is_displaced_by_its_motion),
		cmocka_unit_test(motion_beyond_the_reach_is_not_found),
		cmocka_unit_test(missing_surface_is_not_found),
		cmocka_unit_test(a_grazing_facade_is_measured_in_the_picture),
		cmocka_unit_test(an_outline_one_pixel_off_is_less_than_a_pixel),
		cmocka_unit_test(what_is_thinner_than_a_pixel_is_found_where_it_moved_to),
		cmocka_unit_test(land_that_a_pixel_shows_hundreds_of_metres_of_is_found),
		cmocka_unit_test(the_ground_is_as_deep_as_a_level_plane_in_the_pixel),
		cmocka_unit_test(samples_differ_in_both_coordinates),
		cmocka_unit_test(other_surfaces_in_the_same_place_do_not_count),
		cmocka_unit_test(coarse_positions_cost_half_their_width),
		cmocka_unit_test(far_is_beside_the_axis_and_beyond_its_ends),
		cmocka_unit_test(counts_add_up),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
