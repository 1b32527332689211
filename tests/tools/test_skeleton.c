/* Straight skeletons whose ridges are known, and the triangulations that roofs are made of. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tools/bake/buildings.h"

#define POINTS(...)                                                                                                    \
	(const struct dvec2[])                                                                                             \
	{                                                                                                                  \
		__VA_ARGS__                                                                                                    \
	}

static bool build(
	const struct dvec2 *points, size_t count, const double *speed, const double *delay, struct skeleton *out)
{
	size_t first[2] = { 0, count };
	double ones[32];
	for (size_t i = 0; i < count && i < 32; i++)
		ones[i] = 1.0;
	struct skeleton_outline outline = { points, first, 1, speed ? speed : ones, delay };
	return skeleton_build(&outline, out);
}

static bool has_node(const struct skeleton *skeleton, double x, double y, double t)
{
	for (size_t i = 0; i < skeleton->nodes.count; i++) {
		struct skeleton_node node = skeleton->nodes.items[i];
		if (hypot(node.at.x - x, node.at.y - y) < 0.02 && fabs(node.t - t) < 0.02)
			return true;
	}
	return false;
}

static void an_oblong_has_a_ridge_between_its_hips(void **state)
{
	(void)state;
	struct skeleton s = { 0 };
	assert_true(build(POINTS({ 0, 0 }, { 20, 0 }, { 20, 8 }, { 0, 8 }), 4, NULL, NULL, &s));
	assert_true(fabs(s.t_max - 4.0) < 0.01);
	assert_true(has_node(&s, 4, 4, 4) && has_node(&s, 16, 4, 4));
	assert_int_equal(s.faces.count, 4);
	skeleton_finish(&s);
}

static void a_square_comes_to_a_point(void **state)
{
	(void)state;
	struct skeleton s = { 0 };
	assert_true(build(POINTS({ 0, 0 }, { 10, 0 }, { 10, 10 }, { 0, 10 }), 4, NULL, NULL, &s));
	assert_true(has_node(&s, 5, 5, 5));
	for (size_t i = 0; i < s.faces.count; i++)
		assert_int_equal(s.faces.items[i].count, 3);
	skeleton_finish(&s);
}

static void edges_that_stand_become_gables(void **state)
{
	(void)state;
	struct skeleton s = { 0 };
	assert_true(build(POINTS({ 0, 0 }, { 20, 0 }, { 20, 8 }, { 0, 8 }), 4, (const double[]){ 1, 0, 1, 0 }, NULL, &s));
	assert_true(has_node(&s, 0, 4, 4) && has_node(&s, 20, 4, 4));
	size_t upright = 0;
	for (size_t i = 0; i < s.faces.count; i++)
		upright += s.faces.items[i].upright;
	assert_int_equal(upright, 2);
	skeleton_finish(&s);
}

static void a_half_hip_starts_to_lean_when_told(void **state)
{
	(void)state;
	struct skeleton s = { 0 };
	assert_true(build(POINTS({ 0, 0 }, { 20, 0 }, { 20, 8 }, { 0, 8 }), 4, (const double[]){ 1, 0, 1, 0 },
		(const double[]){ 0, 2, 0, 2 }, &s));
	assert_true(has_node(&s, 20, 2, 2) && has_node(&s, 20, 6, 2) && has_node(&s, 18, 4, 4) && has_node(&s, 2, 4, 4));
	assert_int_equal(s.faces.count, 6);
	skeleton_finish(&s);
}

static void an_inner_corner_makes_a_valley(void **state)
{
	(void)state;
	struct skeleton s = { 0 };
	assert_true(build(POINTS({ 0, 0 }, { 20, 0 }, { 20, 8 }, { 8, 8 }, { 8, 20 }, { 0, 20 }), 6, NULL, NULL, &s));
	assert_true(has_node(&s, 4, 4, 4) && has_node(&s, 16, 4, 4) && has_node(&s, 4, 16, 4));
	skeleton_finish(&s);
}

static void a_court_is_gone_round(void **state)
{
	(void)state;
	struct dvec2 points[8] = { { 0, 0 }, { 30, 0 }, { 30, 30 }, { 0, 30 }, { 10, 10 }, { 10, 20 }, { 20, 20 },
		{ 20, 10 } };
	size_t first[3] = { 0, 4, 8 };
	double speed[8] = { 1, 1, 1, 1, 1, 1, 1, 1 };
	struct skeleton s = { 0 };
	assert_true(skeleton_build(&(struct skeleton_outline){ points, first, 2, speed, NULL }, &s));
	assert_true(fabs(s.t_max - 5.0) < 0.05);
	assert_true(has_node(&s, 5, 5, 5) && has_node(&s, 25, 25, 5));
	skeleton_finish(&s);
}

static void what_is_no_outline_is_refused(void **state)
{
	(void)state;
	struct skeleton s = { 0 };
	assert_false(build(POINTS({ 0, 0 }, { 10, 10 }, { 10, 0 }, { 0, 10 }), 4, NULL, NULL, &s));
	assert_false(build(POINTS({ 0, 0 }, { 10, 0 }), 2, NULL, NULL, &s));
	assert_false(
		build(POINTS({ 0, 0 }, { 10, 0 }, { 10, 10 }, { 0, 10 }), 4, (const double[]){ 0, 0, 0, 0 }, NULL, &s));
	skeleton_finish(&s);
}

static double area_of(const struct dvec2 *points, const index_array *triangles)
{
	double sum = 0.0;
	for (size_t i = 0; i + 2 < triangles->count; i += 3) {
		struct dvec2 a = points[triangles->items[i]], b = points[triangles->items[i + 1]],
					 c = points[triangles->items[i + 2]];
		double area = dvec2_cross(dvec2_sub(b, a), dvec2_sub(c, a)) / 2.0;
		assert_true(area > -1e-9);
		sum += area;
	}
	return sum;
}

static void triangles_cover_what_they_should(void **state)
{
	(void)state;
	struct dvec2 ring[] = { { 0, 0 }, { 5, 0 }, { 10, 0 }, { 10, 10 }, { 5, 10 }, { 5, 4 }, { 4, 4 }, { 4, 10 },
		{ 0, 10 } };
	index_array triangles = { 0 };
	triangulate_face(ring, 9, &triangles);
	assert_int_equal(triangles.count, 21);
	assert_true(fabs(area_of(ring, &triangles) - 94.0) < 1e-6);
	struct dvec2 holed[] = { { 0, 0 }, { 10, 0 }, { 10, 10 }, { 0, 10 }, { 2, 2 }, { 2, 4 }, { 4, 4 }, { 4, 2 } };
	size_t first[] = { 0, 4, 8 };
	struct triangulator *triangulator = triangulator_new();
	triangles.count = 0;
	assert_true(triangulate_rings(triangulator, holed, first, 2, &triangles));
	assert_true(fabs(area_of(holed, &triangles) - 96.0) < 1e-6);
	struct dvec2 bow[] = { { 0, 0 }, { 10, 10 }, { 10, 0 }, { 0, 10 } };
	assert_false(triangulate_rings(triangulator, bow, (const size_t[]){ 0, 4 }, 1, &triangles));
	triangulator_free(triangulator);
	ARRAY_FINISH(&triangles);
}

static void rings_lose_what_says_nothing(void **state)
{
	(void)state;
	struct dvec2 ring[] = { { 0, 0 }, { 0.005, 0 }, { 5, 0 }, { 10, 0 }, { 10, 10 }, { 5, 10 }, { 5, 13 },
		{ 5, 10.001 }, { 0, 10 } };
	assert_int_equal(ring_clean(ring, 9), 4);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_oblong_has_a_ridge_between_its_hips),
		cmocka_unit_test(a_square_comes_to_a_point),
		cmocka_unit_test(edges_that_stand_become_gables),
		cmocka_unit_test(a_half_hip_starts_to_lean_when_told),
		cmocka_unit_test(an_inner_corner_makes_a_valley),
		cmocka_unit_test(a_court_is_gone_round),
		cmocka_unit_test(what_is_no_outline_is_refused),
		cmocka_unit_test(triangles_cover_what_they_should),
		cmocka_unit_test(rings_lose_what_says_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
