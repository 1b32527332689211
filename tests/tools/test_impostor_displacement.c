/* The bound on displacement against eyes drawn at random in the view cell. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <math.h>

#include "platform/base/rng.h"
#include "tests/tools/ray_view.h"
#include "tools/impostor/displacement.h"

#define FOCAL_PX 869.0

static struct dvec3 less(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static double angle_px(struct dvec3 a, struct dvec3 b)
{
	struct dvec3 cross = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
	return FOCAL_PX * atan2(sqrt(dot(cross, cross)), dot(a, b));
}

static struct dvec3 eye_in(const struct view_cell *cell, double along, double aside, double height)
{
	double length = cell->end.y - cell->start.y + 2 * cell->overrun_m;
	return (struct dvec3){ cell->start.x + aside * cell->half_width_m, cell->start.y - cell->overrun_m + along * length,
		cell->start.z + along * (cell->end.z - cell->start.z) + cell->eye_min_m +
			height * (cell->eye_max_m - cell->eye_min_m) };
}

/* The largest of many eyes: corners, edges, inside. */
static double brute_force(const struct view_cell *cell, const struct capture_view *view, double x, double y, double w,
	double drawn, struct rng *rng)
{
	struct dvec3 point = capture_point(view, x, y, w), shown = capture_point(view, x, y, drawn);
	double largest = 0;
	for (int i = 0; i < 400; i++) {
		double at[3] = { rng_unit(rng), rng_range(rng, -1, 1), rng_unit(rng) };
		if (i < 8 || i % 3 == 0) {
			at[0] = i < 8 ? i & 1 : at[0];
			at[1] = i & 2 ? 1 : -1;
			at[2] = i & 4 ? 1 : 0;
		}
		struct dvec3 eye = eye_in(cell, at[0], at[1], at[2]);
		largest = fmax(largest, angle_px(less(point, eye), less(shown, eye)));
	}
	return largest;
}

static void the_bound_holds_and_is_near(void **state)
{
	(void)state;
	struct rng rng = rng_seed(7);
	double sum = 0;
	int close = 0, count = 0;
	for (int round = 0; round < 40; round++) {
		struct view_cell cell = ray_cell(rng_range(&rng, 0.001, 60));
		cell.end.z = rng_range(&rng, -3, 3);
		cell.half_width_m = rng_range(&rng, 2, 9);
		cell.overrun_m = rng_range(&rng, 0, 3);
		struct dvec3 eye = eye_in(&cell, rng_unit(&rng), rng_range(&rng, -1, 1), rng_unit(&rng));
		struct capture_view view =
			ray_view_turned(eye.x, eye.y, eye.z, rng_range(&rng, -1.5, 1.5), rng_range(&rng, 100, 1100), 1024, 512);
		double near_m = rng_range(&rng, 130, 300);
		struct displacement displacement;
		displacement_init(&displacement, &cell, &view, FOCAL_PX, 1 / near_m);
		for (int i = 0; i < 50; i++) {
			double x = rng_range(&rng, 0, view.width), y = rng_range(&rng, 0, view.height);
			double w = rng_range(&rng, 1e-4, 1 / near_m), drawn = w * rng_range(&rng, 0.9, 1.1);
			double truth = brute_force(&cell, &view, x, y, w, drawn, &rng);
			double bound = displacement_px(&displacement, x, y, w, drawn);
			assert_true(bound >= truth - 1e-6);
			sum += truth > 0 ? bound / truth : 1;
			close += bound <= 1.3 * truth;
			count++;
		}
		displacement_finish(&displacement);
	}
	print_message("bound over truth: %.3f in the mean, within 1.3 for %.1f %%\n", sum / count, 100.0 * close / count);
	assert_true(sum / count < 1.3);
	assert_true(close > count * 8 / 10);
}

static void the_tolerance_keeps_the_displacement(void **state)
{
	(void)state;
	struct rng rng = rng_seed(8);
	for (int round = 0; round < 30; round++) {
		struct view_cell cell = ray_cell(rng_range(&rng, 0.001, 60));
		struct capture_view view = ray_view(0, rng_range(&rng, 0, cell.end.y), 2, 869, 1024, 512);
		struct displacement displacement;
		displacement_init(&displacement, &cell, &view, FOCAL_PX, 1.0 / 130);
		for (int i = 0; i < 100; i++) {
			double x = rng_range(&rng, 0, 1024), y = rng_range(&rng, 0, 512), w = rng_range(&rng, 1e-4, 1.0 / 130);
			double px = exp(rng_range(&rng, log(1.0 / 16), log(64)));
			double tolerance = displacement_tolerance(&displacement, x, y, w, px);
			assert_true(tolerance > 0);
			for (int side = -1; side <= 1; side += 2)
				assert_true(displacement_px(&displacement, x, y, w, w + side * tolerance) <= px * (1 + 1e-9) + 1e-9);
		}
		displacement_finish(&displacement);
	}
}

static void an_eye_that_never_moves_sees_no_displacement(void **state)
{
	(void)state;
	struct view_cell cell = { .eye_min_m = 2, .eye_max_m = 2 };
	struct capture_view view = ray_view(0, 0, 2, 869, 1024, 512);
	struct displacement displacement;
	displacement_init(&displacement, &cell, &view, FOCAL_PX, 0.01);
	assert_true(displacement_px(&displacement, 900, 30, 0.01, 0.005) < 1e-9);
	assert_true(displacement_tolerance(&displacement, 900, 30, 0.01, 1) >= 0.01);
	displacement_finish(&displacement);
}

static void a_pixel_grows_by_how_much_nearer_the_eye_comes(void **state)
{
	(void)state;
	struct view_cell cell = { .end = { 0, 50, 0 }, .eye_min_m = 2, .eye_max_m = 2 };
	struct capture_view view = ray_view(0, 0, 2, 1738, 1024, 512);
	struct displacement displacement;
	displacement_init(&displacement, &cell, &view, FOCAL_PX, 0.01);
	assert_float_equal(displacement_scale(&displacement, 512, 256, 0.01), 0.5 / (1 - 0.5), 1e-9);
	displacement_finish(&displacement);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_bound_holds_and_is_near),
		cmocka_unit_test(the_tolerance_keeps_the_displacement),
		cmocka_unit_test(an_eye_that_never_moves_sees_no_displacement),
		cmocka_unit_test(a_pixel_grows_by_how_much_nearer_the_eye_comes),
	};
	return cmocka_run_group_tests_name("tools/impostor_displacement", tests, NULL, NULL);
}
