/* Precision, recall and uncovered share against counts made by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <math.h>

#include "tools/measure/coverage.h"

/* Ten pixels. C is clear. Drawn in a: 8, in b: 6; equal: 3, within 2: 4; drawn in a alone: 3, in b alone: 1.
 *                              same same same near far  a    a    a    b    none */
static uint8_t a[10 * 3], b[10 * 3];
static const uint8_t clear[3] = { 10, 20, 30 };
static const struct image image_a = { 5, 2, a }, image_b = { 5, 2, b };

static void put(uint8_t *rgb, size_t pixel, int red)
{
	rgb[3 * pixel] = red < 0 ? clear[0] : (uint8_t)red;
	rgb[3 * pixel + 1] = clear[1];
	rgb[3 * pixel + 2] = clear[2];
}

static int set_up(void **state)
{
	(void)state;
	static const int reds_a[10] = { 100, 101, 102, 103, 104, 105, 11, 107, -1, -1 };
	static const int reds_b[10] = { 100, 101, 102, 105, 107, -1, -1, -1, 50, -1 };
	for (size_t i = 0; i < 10; i++) {
		put(a, i, reds_a[i]);
		put(b, i, reds_b[i]);
	}
	return 0;
}

static void shares_match_counts_by_hand(void **state)
{
	(void)state;
	struct image_coverage c;
	image_cover(&image_a, &image_b, clear, &c);
	assert_true(c.precision == 3.0 / 6.0);
	assert_true(c.recall == 3.0 / 8.0);
	assert_true(c.precision_within_2 == 4.0 / 6.0);
	assert_true(c.recall_within_2 == 4.0 / 8.0);
	assert_true(c.uncovered == 3.0 / 10.0);
}

static void sides_exchange_precision_and_recall(void **state)
{
	(void)state;
	struct image_coverage c;
	image_cover(&image_b, &image_a, clear, &c);
	assert_true(c.recall == 3.0 / 6.0 && c.precision == 3.0 / 8.0 && c.uncovered == 1.0 / 10.0);
}

/* Without a clear colour pixel 9 is equal too, and pixel 6 (11 against 10) within 2. */
static void without_a_clear_colour_all_is_drawn(void **state)
{
	(void)state;
	struct image_coverage c;
	image_cover(&image_a, &image_b, NULL, &c);
	assert_true(c.precision == 0.4 && c.recall == 0.4);
	assert_true(c.precision_within_2 == 0.6 && c.recall_within_2 == 0.6);
	assert_true(isnan(c.uncovered));
}

static void equal_pictures_are_one_and_empty_ones_have_no_share(void **state)
{
	(void)state;
	struct image_coverage c;
	image_cover(&image_a, &image_a, clear, &c);
	assert_true(c.precision == 1.0 && c.recall == 1.0 && c.uncovered == 0.0);
	uint8_t nothing[10 * 3];
	for (size_t i = 0; i < 10; i++)
		put(nothing, i, -1);
	image_cover(&image_a, &(struct image){ 5, 2, nothing }, clear, &c);
	assert_true(isnan(c.precision) && c.recall == 0.0 && c.uncovered == 0.8);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shares_match_counts_by_hand),
		cmocka_unit_test(sides_exchange_precision_and_recall),
		cmocka_unit_test(without_a_clear_colour_all_is_drawn),
		cmocka_unit_test(equal_pictures_are_one_and_empty_ones_have_no_share),
	};
	return cmocka_run_group_tests(tests, set_up, NULL);
}
