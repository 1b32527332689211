/* Image measures against cases worked by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "tools/measure/metrics.h"

#define SIDE 16

static void fill(uint8_t *rgb, uint8_t value)
{
	memset(rgb, value, SIDE * SIDE * 3);
}

static void equal_pictures_have_no_difference(void **state)
{
	(void)state;
	uint8_t a[SIDE * SIDE * 3];
	for (size_t i = 0; i < sizeof(a); i++)
		a[i] = (uint8_t)(i * 37);
	struct image image = { SIDE, SIDE, a };
	struct image_difference d;
	image_compare(&image, &image, &d);
	assert_int_equal(d.max, 0);
	assert_true(isinf(d.psnr_db));
	assert_true(fabs(d.ssim - 1.0) < 1e-12);
	assert_true(d.within_2 == 1.0 && d.differing == 0.0);
}

/* Two flat pictures: variances vanish, SSIM is (2 ma mb + c1) / (ma^2 + mb^2 + c1); the error is the same everywhere.
 */
static void flat_pictures_match_the_formula(void **state)
{
	(void)state;
	uint8_t a[SIDE * SIDE * 3], b[SIDE * SIDE * 3];
	fill(a, 100);
	fill(b, 110);
	struct image_difference d;
	image_compare(&(struct image){ SIDE, SIDE, a }, &(struct image){ SIDE, SIDE, b }, &d);
	double c1 = 6.5025;
	assert_true(fabs(d.ssim - (2 * 100.0 * 110.0 + c1) / (100.0 * 100.0 + 110.0 * 110.0 + c1)) < 1e-9);
	assert_true(fabs(d.psnr_db - 28.1308036086791) < 1e-9); /* 20 log10(25.5) */
	assert_int_equal(d.max, 10);
	assert_true(d.mean == 10.0 && d.differing == 1.0 && d.within_2 == 0.0);
}

static void one_pixel_is_counted_once(void **state)
{
	(void)state;
	uint8_t a[SIDE * SIDE * 3], b[SIDE * SIDE * 3];
	fill(a, 50);
	fill(b, 50);
	b[3 * 40 + 1] = 53;
	b[3 * 41] = 52;
	struct image_difference d;
	image_compare(&(struct image){ SIDE, SIDE, a }, &(struct image){ SIDE, SIDE, b }, &d);
	assert_int_equal(d.max, 3);
	assert_true(d.differing == 2.0 / (SIDE * SIDE));
	assert_true(d.within_2 == 1.0 - 1.0 / (SIDE * SIDE));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(equal_pictures_have_no_difference),
		cmocka_unit_test(flat_pictures_match_the_formula),
		cmocka_unit_test(one_pixel_is_counted_once),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
