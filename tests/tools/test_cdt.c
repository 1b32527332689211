/* The triangulation under collinear, cocircular, duplicate and crossing input: a million random cases; with the
 * sanitizers, which take ten times as long, a tenth of them, unless BLVD_LONG=1. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/impostor/cdt.h"

static const struct cdt_point origin = { 0, 0 };

static void predicates_are_exact_at_the_limits(void **state)
{
	(void)state;
	const int32_t m = CDT_COORDINATE_MAX;
	struct cdt_point a = { -m, -m }, b = { m, -m }, c = { m, m }, d = { -m, m };
	assert_int_equal(cdt_in_circle(a, b, c, d), 0);
	assert_int_equal(cdt_in_circle(a, b, c, (struct cdt_point){ -m + 1, m }), 1);
	assert_int_equal(cdt_in_circle(a, b, (struct cdt_point){ m - 1, m }, d), -1);
	assert_int_equal(cdt_orientation(a, c, (struct cdt_point){ m - 1, m }), 1);
	assert_int_equal(cdt_orientation(a, c, (struct cdt_point){ m, m - 1 }), -1);
}

static bool has_fixed_side(const struct cdt *cdt, uint32_t a, uint32_t b)
{
	for (size_t i = 0; i < cdt->triangles.count; i++)
		for (int side = 0; side < 3; side++)
			if (cdt->triangles.items[i].fixed[side] && cdt->triangles.items[i].corner[(side + 1) % 3] == a &&
				cdt->triangles.items[i].corner[(side + 2) % 3] == b)
				return true;
	return false;
}

static void a_segment_through_points_is_cut_there(void **state)
{
	(void)state;
	struct cdt cdt;
	cdt_init(&cdt, origin, (struct cdt_point){ 100, 100 });
	uint32_t a = cdt_add_point(&cdt, (struct cdt_point){ 10, 50 }),
			 b = cdt_add_point(&cdt, (struct cdt_point){ 90, 50 });
	uint32_t middle = cdt_add_point(&cdt, (struct cdt_point){ 40, 50 });
	cdt_add_point(&cdt, (struct cdt_point){ 41, 51 });
	cdt_add_point(&cdt, (struct cdt_point){ 60, 49 });
	cdt_add_segment(&cdt, a, b);
	assert_true(has_fixed_side(&cdt, a, middle) && has_fixed_side(&cdt, middle, b));
	assert_true(cdt_is_sound(&cdt));
	cdt_finish(&cdt);
}

static void crossing_segments_share_a_point(void **state)
{
	(void)state;
	struct cdt cdt;
	cdt_init(&cdt, origin, (struct cdt_point){ 100, 100 });
	uint32_t a = cdt_add_point(&cdt, (struct cdt_point){ 10, 10 }),
			 b = cdt_add_point(&cdt, (struct cdt_point){ 90, 90 });
	uint32_t c = cdt_add_point(&cdt, (struct cdt_point){ 10, 90 }),
			 d = cdt_add_point(&cdt, (struct cdt_point){ 90, 10 });
	cdt_add_segment(&cdt, a, b);
	cdt_add_segment(&cdt, c, d);
	uint32_t cross = cdt_add_point(&cdt, (struct cdt_point){ 50, 50 });
	assert_int_equal(cdt.cuts, 1);
	assert_true(has_fixed_side(&cdt, a, cross) && has_fixed_side(&cdt, cross, b));
	assert_true(has_fixed_side(&cdt, c, cross) && has_fixed_side(&cdt, cross, d));
	assert_true(cdt_is_sound(&cdt));
	cdt_finish(&cdt);
}

/* A few points and segments on a lattice so small that every degenerate case comes up. */
static void run_random_case(uint64_t seed)
{
	struct rng rng = rng_seed(seed);
	int32_t side = 2 + (int32_t)(rng_u32(&rng) % (seed % 4 == 0 ? 200 : 9));
	struct cdt cdt;
	cdt_init(&cdt, origin, (struct cdt_point){ side, side });
	uint32_t points[24], count = 3 + rng_u32(&rng) % 20;
	for (uint32_t i = 0; i < count; i++) {
		struct cdt_point at = { (int32_t)(rng_u32(&rng) % (uint32_t)(side + 1)),
			(int32_t)(rng_u32(&rng) % (uint32_t)(side + 1)) };
		points[i] = cdt_add_point(&cdt, at);
	}
	uint32_t segments = rng_u32(&rng) % 12;
	for (uint32_t i = 0; i < segments; i++)
		cdt_add_segment(&cdt, points[rng_u32(&rng) % count], points[rng_u32(&rng) % count]);
	if (!cdt_is_sound(&cdt) || cdt.dropped)
		fail_msg("case %llu is not sound", (unsigned long long)seed);
	cdt_finish(&cdt);
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CASES 100000
#else
#define CASES 1000000
#endif

static void a_million_random_degenerate_cases_are_sound(void **state)
{
	(void)state;
	uint64_t cases = CASES;
	if (getenv("BLVD_LONG"))
		cases = 1000000;
	for (uint64_t seed = 0; seed < cases; seed++)
		run_random_case(seed);
}

static void cocircular_points_terminate(void **state)
{
	(void)state;
	/* All lattice points of radius 65 (36 of them), then a full grid: every unit square is cocircular. */
	struct cdt cdt;
	cdt_init(&cdt, (struct cdt_point){ -70, -70 }, (struct cdt_point){ 70, 70 });
	for (int32_t x = -65; x <= 65; x++)
		for (int32_t y = -65; y <= 65; y++)
			if (x * x + y * y == 65 * 65)
				cdt_add_point(&cdt, (struct cdt_point){ x, y });
	assert_int_equal(cdt.points.count, 4 + 36);
	for (int32_t x = -20; x <= 20; x++)
		for (int32_t y = -20; y <= 20; y++)
			cdt_add_point(&cdt, (struct cdt_point){ x, y });
	assert_true(cdt_is_sound(&cdt));
	cdt_finish(&cdt);
}

static void a_contour_of_ten_thousand_points_is_quick(void **state)
{
	(void)state;
	struct cdt cdt;
	cdt_init(&cdt, origin, (struct cdt_point){ 16383, 16383 });
	uint32_t first = CDT_NONE, last = CDT_NONE;
	struct rng rng = rng_seed(5);
	for (int32_t i = 0; i < 10000; i++) {
		uint32_t point = cdt_add_point(&cdt, (struct cdt_point){ 100 + i, 8000 + (int32_t)(rng_u32(&rng) % 200) });
		if (last != CDT_NONE)
			cdt_add_segment(&cdt, last, point);
		else
			first = point;
		last = point;
	}
	cdt_add_segment(&cdt, first, last);
	assert_true(cdt_is_sound(&cdt));
	cdt_finish(&cdt);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(predicates_are_exact_at_the_limits),
		cmocka_unit_test(a_segment_through_points_is_cut_there),
		cmocka_unit_test(crossing_segments_share_a_point),
		cmocka_unit_test(a_million_random_degenerate_cases_are_sound),
		cmocka_unit_test(cocircular_points_terminate),
		cmocka_unit_test(a_contour_of_ten_thousand_points_is_quick),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
