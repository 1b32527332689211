/* Streets are cut into stretches that are short and straight enough, and nothing of a street is left out. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "tools/impostor/stretches.h"

#define POINTS_MAX 4000

/* One edge from points in metres. */
struct street {
	struct pkg_point points[POINTS_MAX];
	struct pkg_edge edge;
	struct pkg_graph net;
};

static void street_add(struct street *street, double x, double y, double z)
{
	struct pkg_point *at = &street->points[street->edge.point_count++];
	*at = (struct pkg_point){ { (int32_t)lrint(x * 1e3), (int32_t)lrint(y * 1e3), (int32_t)lrint(z * 1e3) } };
	if (street->edge.point_count > 1)
		street->edge.length_mm +=
			(uint32_t)lrint(hypot(at->pos_mm[0] - at[-1].pos_mm[0], at->pos_mm[1] - at[-1].pos_mm[1]));
	street->net = (struct pkg_graph){
		.edges = &street->edge, .points = street->points, .edge_count = 1, .point_count = street->edge.point_count
	};
}

static struct street *street_start(void)
{
	static struct street street;
	memset(&street.edge, 0, sizeof(street.edge));
	street.edge.width_mm = 7000;
	street.edge.flags = PKG_EDGE_FORWARD;
	return &street;
}

struct cut {
	stretch_array stretches;
	first_stretch_array first;
};

static void cut_finish(struct cut *cut)
{
	ARRAY_FINISH(&cut->stretches);
	ARRAY_FINISH(&cut->first);
}

static double distance_to_axis_m(const struct pkg_stretch *s, double x, double y)
{
	double ax = s->start_mm[0], ay = s->start_mm[1], bx = s->end_mm[0] - ax, by = s->end_mm[1] - ay;
	double t = fmin(fmax(((x - ax) * bx + (y - ay) * by) / (bx * bx + by * by), 0.0), 1.0);
	return hypot(x - ax - t * bx, y - ay - t * by) * 1e-3;
}

/* What holds for every street. */
static struct cut cut_and_check(struct street *street, const struct stretch_options *options)
{
	struct cut cut = { 0 };
	stretches_cut(&street->net, options, &cut.stretches, &cut.first);
	assert_int_equal(cut.first.count, 2);
	assert_int_equal(cut.first.items[1], cut.stretches.count);
	assert_true(cut.stretches.count >= 1);
	double longest = options->length_max_m > 0.0 ? options->length_max_m : 60.0;
	uint32_t at = 0;
	for (size_t i = 0; i < cut.stretches.count; i++) {
		const struct pkg_stretch *s = &cut.stretches.items[i];
		assert_int_equal(s->from_mm, at);
		assert_true(s->to_mm >= s->from_mm);
		at = s->to_mm;
		assert_true(s->to_mm - s->from_mm <= longest * 1e3 + 2.0);
		assert_true(s->near_mm >= 2.5 * (s->to_mm - s->from_mm) - 10.0);
		assert_true(s->start_mm[0] != s->end_mm[0] || s->start_mm[1] != s->end_mm[1]);
		assert_true(s->eye_min_mm < s->eye_max_mm);
		assert_true(s->half_width_mm >= 3500);
	}
	assert_int_equal(at, street->edge.length_mm);
	for (uint32_t i = 0; i < street->edge.point_count; i++) {
		double nearest = INFINITY;
		for (size_t k = 0; k < cut.stretches.count; k++) {
			double d =
				distance_to_axis_m(&cut.stretches.items[k], street->points[i].pos_mm[0], street->points[i].pos_mm[1]);
			nearest = fmin(nearest, d - (cut.stretches.items[k].half_width_mm - 3500) * 1e-3);
		}
		assert_true(nearest <= 0.0);
	}
	return cut;
}

static void a_short_street_is_one_stretch(void **state)
{
	(void)state;
	struct street *street = street_start();
	street_add(street, 100, 200, 5);
	street_add(street, 130, 240, 6);
	struct cut cut = cut_and_check(street, &(struct stretch_options){ 0 });
	assert_int_equal(cut.stretches.count, 1);
	const struct pkg_stretch *s = &cut.stretches.items[0];
	assert_int_equal(s->near_mm, 300000);
	assert_int_equal(s->half_width_mm, 4000);
	assert_int_equal(s->overrun_mm, 3500);
	assert_int_equal(s->eye_min_mm, 1200);
	assert_int_equal(s->eye_max_mm, 4000);
	assert_int_equal(s->end_mm[2], 6000);
	cut_finish(&cut);
}

static void streets_of_no_length_and_of_ten_kilometres_are_cut(void **state)
{
	(void)state;
	struct street *street = street_start();
	street_add(street, 5, 5, 0);
	street_add(street, 5, 5, 0);
	struct cut cut = cut_and_check(street, &(struct stretch_options){ 0 });
	assert_int_equal(cut.stretches.count, 1);
	cut_finish(&cut);
	street = street_start();
	street_add(street, -5000, 0, 0);
	street_add(street, 5000, 1, 0);
	cut = cut_and_check(street, &(struct stretch_options){ 0 });
	assert_int_equal(cut.stretches.count, 167);
	cut_finish(&cut);
	street = street_start();
	for (int i = 0; i < POINTS_MAX; i++)
		street_add(street, i * 2.5, 0.2 * (i % 2), 0);
	cut = cut_and_check(street, &(struct stretch_options){ 0 });
	assert_true(cut.stretches.count >= 166 && cut.stretches.count < 200);
	cut_finish(&cut);
}

static void lengths_follow_the_magnification_rule(void **state)
{
	(void)state;
	static const struct {
		double near_m, length_m, longest_m;
		uint32_t near_mm;
	} cases[] = {
		{ 0, 0, 60, 300000 },
		{ 100, 0, 50, 125000 },
		{ 250, 0, 60, 250000 },
		{ 250, 100, 100, 250000 },
		{ 60, 100, 30, 75000 },
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct street *street = street_start();
		street_add(street, 0, 0, 0);
		street_add(street, 600, 0, 0);
		struct cut cut = { 0 };
		stretches_cut(&street->net,
			&(struct stretch_options){ .near_m = cases[i].near_m, .length_max_m = cases[i].length_m }, &cut.stretches,
			&cut.first);
		assert_int_equal(cut.stretches.count, (int)(600 / cases[i].longest_m));
		assert_int_equal(cut.stretches.items[0].near_mm, cases[i].near_mm);
		cut_finish(&cut);
	}
}

static void a_corner_is_a_cut(void **state)
{
	(void)state;
	struct street *street = street_start();
	street_add(street, 0, 0, 0);
	street_add(street, 40, 0, 0);
	street_add(street, 40, 50, 0);
	struct cut cut = cut_and_check(street, &(struct stretch_options){ 0 });
	assert_int_equal(cut.stretches.count, 2);
	assert_int_equal(cut.stretches.items[0].to_mm, 40000);
	cut_finish(&cut);
}

static void a_humped_bridge_raises_the_eyes(void **state)
{
	(void)state;
	struct street *street = street_start();
	street_add(street, 0, 0, 0);
	street_add(street, 20, 0, 0.5);
	street_add(street, 40, 0, 0);
	struct cut cut = cut_and_check(street, &(struct stretch_options){ .eye_min_m = 2, .eye_max_m = 12 });
	assert_int_equal(cut.stretches.count, 1);
	assert_int_equal(cut.stretches.items[0].eye_min_mm, 2000);
	assert_int_equal(cut.stretches.items[0].eye_max_mm, 12500);
	cut_finish(&cut);
}

static void circles_of_any_size_are_cut_sanely(void **state)
{
	(void)state;
	for (double radius = 3; radius < 300; radius *= 1.7) {
		struct street *street = street_start();
		int count = (int)fmax(2 * BLVD_PI * radius / 2.0, 8);
		for (int i = 0; i <= count; i++) {
			double at = 2 * BLVD_PI * i / count;
			street_add(street, radius * cos(at), radius * sin(at), 0);
		}
		struct cut cut = cut_and_check(street, &(struct stretch_options){ 0 });
		assert_true(cut.stretches.count >= 2 && cut.stretches.count <= 10 + (size_t)(radius / 4));
		for (size_t i = 0; i < cut.stretches.count; i++)
			assert_true(cut.stretches.items[i].half_width_mm <= 4000 + 2500);
		cut_finish(&cut);
	}
}

static void streets_that_nobody_may_drive_have_none(void **state)
{
	(void)state;
	struct street *street = street_start();
	street->edge.flags = PKG_EDGE_PRIVATE;
	street_add(street, 0, 0, 0);
	street_add(street, 40, 0, 0);
	struct cut cut = { 0 };
	stretches_cut(&street->net, &(struct stretch_options){ 0 }, &cut.stretches, &cut.first);
	assert_int_equal(cut.stretches.count, 0);
	assert_int_equal(cut.first.count, 2);
	cut_finish(&cut);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_short_street_is_one_stretch),
		cmocka_unit_test(streets_of_no_length_and_of_ten_kilometres_are_cut),
		cmocka_unit_test(lengths_follow_the_magnification_rule),
		cmocka_unit_test(a_corner_is_a_cut),
		cmocka_unit_test(a_humped_bridge_raises_the_eyes),
		cmocka_unit_test(circles_of_any_size_are_cut_sanely),
		cmocka_unit_test(streets_that_nobody_may_drive_have_none),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
