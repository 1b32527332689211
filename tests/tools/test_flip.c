/*
 * FLIP against cases worked by hand.
 *
 * Flat pictures: every blur sums to one and features vanish, so the map is the remapped HyAB distance everywhere.
 *   cmax: green is L* 87.7347, a* -86.1827, b* 83.1793; Hunt scales a and b by L / 100 to -75.612 and 72.977.
 *   Blue is 32.2970, 79.1875, -107.8602, so 25.575 and -34.836. HyAB = 55.438 + sqrt(101.187^2 + 107.813^2) = 203.297;
 *   cmax = 203.297^0.7 = 41.276, the knee 0.4 cmax = 16.510. Green against blue is 1 by construction.
 *   Black against white: 100^0.7 = 25.119, beyond the knee: 0.95 + 0.05 (25.119 - 16.510) / (41.276 - 16.510) =
 * 0.96738. Black against grey 119: light 0.184475, L* = 116 cbrt(0.184475) - 16 = 50.034; 50.034^0.7 = 15.470, below
 * the knee: 0.95 * 15.470 / 16.510 = 0.89013.
 *
 * One pixel a degree: every Gaussian is narrower than a twentieth of a pixel. Blurs do nothing, the edge filter is
 * [-1 0 1] and the point filter [0.5 -1 0.5]. See a_step_makes_the_difference_stand_out.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/measure/flip.h"

#define SIDE 24
#define PIXELS (SIDE * SIDE)

struct square {
	uint8_t rgb[PIXELS * 3];
};

static struct square flat(uint8_t r, uint8_t g, uint8_t b)
{
	struct square s;
	for (size_t i = 0; i < PIXELS; i++) {
		s.rgb[3 * i] = r;
		s.rgb[3 * i + 1] = g;
		s.rgb[3 * i + 2] = b;
	}
	return s;
}

static void set(struct square *s, int x, int y, uint8_t value)
{
	memset(s->rgb + 3 * (y * SIDE + x), value, 3);
}

static void map_of(struct square *a, struct square *b, double ppd, float *map)
{
	struct image ia = { SIDE, SIDE, a->rgb }, ib = { SIDE, SIDE, b->rgb };
	flip_map(&ia, &ib, ppd, map);
}

static double mean_of(struct square *a, struct square *b, double ppd)
{
	float map[PIXELS];
	struct flip_summary summary;
	map_of(a, b, ppd, map);
	flip_summarise(map, SIDE, SIDE, &summary);
	return summary.mean;
}

static void assert_near(double value, double expected, double tolerance)
{
	if (fabs(value - expected) > tolerance)
		fail_msg("%.6f instead of %.6f", value, expected);
}

static void flat_pictures_match_the_distance_worked_by_hand(void **state)
{
	(void)state;
	const struct {
		uint8_t a[3], b[3];
		double expected;
	} cases[] = {
		{ { 0, 0, 0 }, { 255, 255, 255 }, 0.96738 },
		{ { 0, 0, 0 }, { 119, 119, 119 }, 0.89013 },
		{ { 0, 255, 0 }, { 0, 0, 255 }, 1.0 },
		{ { 17, 170, 99 }, { 17, 170, 99 }, 0.0 },
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct square a = flat(cases[i].a[0], cases[i].a[1], cases[i].a[2]);
		struct square b = flat(cases[i].b[0], cases[i].b[1], cases[i].b[2]);
		float map[PIXELS];
		map_of(&a, &b, FLIP_DEFAULT_PPD, map);
		for (size_t p = 0; p < PIXELS; p++)
			assert_near(map[p], cases[i].expected, 2e-4);
	}
}

/* A: black left, white right of a step; B: white. Left of the step colour is 0.96738. At its last black pixel the edge
 * response is 1 - 0 and the point response 0.5 (0 + 1) = 0.5: features (1 / sqrt 2)^0.5 = 0.84090, together
 * 0.96738 ^ 0.15910 = 0.99474. White pixels are equal, whatever their features. */
static void a_step_makes_the_difference_stand_out(void **state)
{
	(void)state;
	struct square a = flat(255, 255, 255), b = a;
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE / 2; x++)
			set(&a, x, y, 0);
	float map[PIXELS];
	map_of(&a, &b, 1.0, map);
	assert_near(map[3], 0.96738, 2e-4);
	assert_near(map[SIDE / 2 - 1], 0.99474, 2e-4);
	assert_near(map[SIDE / 2], 0.0, 2e-3);
	assert_near(map[SIDE - 1], 0.0, 2e-3);
}

/* A white dot on black against black: points answer -1 across and -1 down, sqrt 2 together, so features are 1 and the
 * difference is complete. Its neighbours are equal. */
static void a_dot_is_a_complete_difference(void **state)
{
	(void)state;
	struct square a = flat(0, 0, 0), b = a;
	set(&a, 9, 7, 255);
	float map[PIXELS];
	map_of(&a, &b, 1.0, map);
	assert_near(map[7 * SIDE + 9], 1.0, 1e-4);
	assert_near(map[7 * SIDE + 10], 0.0, 1e-6);
}

static void noise(struct square *s, unsigned seed)
{
	for (size_t i = 0; i < sizeof(s->rgb); i++) {
		seed = seed * 1664525u + 1013904223u;
		s->rgb[i] = (uint8_t)(seed >> 24);
	}
}

static void equal_pictures_are_zero_and_sides_do_not_matter(void **state)
{
	(void)state;
	struct square a, b;
	noise(&a, 1);
	noise(&b, 2);
	assert_true(mean_of(&a, &a, FLIP_DEFAULT_PPD) == 0.0);
	float one[PIXELS], other[PIXELS];
	map_of(&a, &b, FLIP_DEFAULT_PPD, one);
	map_of(&b, &a, FLIP_DEFAULT_PPD, other);
	assert_memory_equal(one, other, sizeof(one));
	for (size_t p = 0; p < PIXELS; p++)
		assert_true(one[p] >= 0.0f && one[p] <= 1.0f);
}

static void a_greater_difference_is_greater(void **state)
{
	(void)state;
	struct square base = flat(100, 100, 100);
	double before = 0.0;
	for (int step = 1; step <= 150; step += 10) {
		struct square b = base;
		for (int y = 6; y < 18; y++)
			for (int x = 6; x < 18; x++)
				set(&b, x, y, (uint8_t)(100 + step));
		double mean = mean_of(&base, &b, FLIP_DEFAULT_PPD);
		assert_true(mean > before);
		before = mean;
	}
}

/* A checker of single pixels is the grey of half its light, 188, when seen from far away. In the middle: the repeated
 * border is no checker. */
static void distance_hides_fine_detail(void **state)
{
	(void)state;
	struct square a = flat(0, 0, 0), b = flat(188, 188, 188);
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++)
			set(&a, x, y, (x + y) % 2 ? 255 : 0);
	const double ppds[] = { 10.0, 20.0, 40.0, 67.0 };
	float middle[4];
	for (size_t i = 0; i < 4; i++) {
		float map[PIXELS];
		map_of(&a, &b, ppds[i], map);
		middle[i] = map[SIDE / 2 * SIDE + SIDE / 2];
		assert_true(i == 0 || middle[i] < middle[i - 1]);
	}
	assert_true(middle[0] > 0.9f && middle[3] < 0.05f);
}

/* Sum 10: the parts up to 1, 3, 6 and 10. */
static void percentiles_are_weighted_by_the_error(void **state)
{
	(void)state;
	const float map[] = { 0.4f, 0.0f, 0.1f, 0.3f, 0.0f, 0.2f };
	struct flip_summary s;
	flip_summarise(map, 3, 2, &s);
	assert_near(s.mean, 1.0 / 6.0, 1e-7);
	assert_near(s.weighted_p25, 0.2, 1e-7);
	assert_near(s.weighted_p50, 0.3, 1e-7);
	assert_near(s.weighted_p75, 0.4, 1e-7);
	assert_near(s.weighted_p95, 0.4, 1e-7);
	assert_near(s.max, 0.4, 1e-7);
}

static void odd_shapes_and_distances_stay_in_range(void **state)
{
	(void)state;
	const struct {
		uint32_t width, height;
		double ppd;
	} cases[] = { { 1, 1, 67 }, { 1, 50, 67 }, { 50, 1, 67 }, { 3, 2, FLIP_MAX_PPD }, { 3, 2, FLIP_MIN_PPD } };
	struct square a, b;
	noise(&a, 3);
	noise(&b, 4);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct image ia = { cases[i].width, cases[i].height, a.rgb }, ib = { cases[i].width, cases[i].height, b.rgb };
		float map[50];
		flip_map(&ia, &ib, cases[i].ppd, map);
		for (size_t p = 0; p < cases[i].width * cases[i].height; p++)
			assert_true(map[p] > 0.0f && map[p] <= 1.0f);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(flat_pictures_match_the_distance_worked_by_hand),
		cmocka_unit_test(a_step_makes_the_difference_stand_out),
		cmocka_unit_test(a_dot_is_a_complete_difference),
		cmocka_unit_test(equal_pictures_are_zero_and_sides_do_not_matter),
		cmocka_unit_test(a_greater_difference_is_greater),
		cmocka_unit_test(distance_hides_fine_detail),
		cmocka_unit_test(percentiles_are_weighted_by_the_error),
		cmocka_unit_test(odd_shapes_and_distances_stay_in_range),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
