/* Uncovered pixels and cracks, counted by hand on small pictures. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include <string.h>

#include "tools/measure/holes.h"

#define W 12
#define H 8

static struct truth_pixel reference_pixels[W * H], shown_pixels[W * H];
static uint8_t map[W * H];

/* '#': something is there. */
static void fill(struct truth_pixel *pixels, const char *const rows[H])
{
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++)
			pixels[y * W + x] = (struct truth_pixel){ .object = rows[y][x] == '#' };
}

static struct holes find(const char *const reference[H], const char *const shown[H])
{
	fill(reference_pixels, reference);
	fill(shown_pixels, shown);
	struct holes out;
	holes_find(&(struct truth_image){ .width = W, .height = H, .pixels = reference_pixels }, NULL,
		&(struct truth_image){ .width = W, .height = H, .pixels = shown_pixels }, &out, map);
	return out;
}

static const char *const full[H] = { "############", "############", "############", "############", "############",
	"############", "############", "############" };

static void what_is_covered_has_no_holes(void **state)
{
	(void)state;
	struct holes holes = find(full, full);
	assert_int_equal(holes.pixels, 96);
	assert_int_equal(holes.drawn, 96);
	assert_int_equal(holes.uncovered + holes.cracks, 0);
}

static void slits_are_cracks_in_any_direction(void **state)
{
	(void)state;
	static const char *const slits[H] = { "####.#######", "####.###.###", "####.##.####", "####.#.#####",
		"####.#######", "####.#######", "........####", "####.#######" };
	struct holes holes = find(full, slits);
	assert_int_equal(holes.uncovered, 7 + 8 + 3);
	assert_int_equal(holes.cracks, 7 + 7 + 3); /* where two cross nothing is near */
	assert_int_equal(map[0 * W + 4], 2);
}

/* 4 wide and 4 high: two steps reach one side of it only. */
static void a_wide_hole_is_no_crack(void **state)
{
	(void)state;
	static const char *const hole[H] = { "############", "############", "####....####", "####....####", "####....####",
		"####....####", "############", "############" };
	struct holes holes = find(full, hole);
	assert_int_equal(holes.uncovered, 16);
	assert_int_equal(holes.cracks, 0);
	assert_int_equal(map[3 * W + 5], 1);
}

static void a_moved_outline_is_uncovered_but_no_crack(void **state)
{
	(void)state;
	static const char *const roof[H] = { "............", "............", "..########..", "..########..", "############",
		"############", "############", "############" };
	static const char *const lower[H] = { "............", "............", "............", "..###.####..",
		"############", "############", "############", "############" };
	struct holes holes = find(roof, lower);
	assert_int_equal(holes.drawn, 16 + 48);
	assert_int_equal(holes.uncovered, 9);
	assert_int_equal(holes.cracks, 0);
	holes = find(lower, roof); /* more than there is: no hole */
	assert_int_equal(holes.uncovered, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_covered_has_no_holes),
		cmocka_unit_test(slits_are_cracks_in_any_direction),
		cmocka_unit_test(a_wide_hole_is_no_crack),
		cmocka_unit_test(a_moved_outline_is_uncovered_but_no_crack),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
