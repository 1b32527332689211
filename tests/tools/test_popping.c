/* Change of the error from frame to frame, on flat pictures and single pixels. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "tools/measure/popping.h"

#define W 20
#define H 10

static uint8_t picture[W * H * 4];
static float work[W * H];

static void flat(uint8_t level, float *lightness)
{
	memset(picture, level, sizeof(picture));
	popping_lightness(picture, W, H, lightness, work);
}

/* L* of sRGB grey: 0 is 0, 255 is 100, 119 is 50.03 (luminance 0.1845), 10 is 2.74 (on the linear part). */
static void greys_have_their_lightness(void **state)
{
	(void)state;
	static const struct {
		uint8_t level;
		double lightness;
	} cases[] = { { 0, 0.0 }, { 255, 100.0 }, { 119, 50.034 }, { 10, 2.742 } };
	float lightness[W * H];
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		flat(cases[i].level, lightness);
		for (int k = 0; k < W * H; k++)
			assert_true(fabs((double)lightness[k] - cases[i].lightness) < 0.01);
	}
}

/* A white pixel on black keeps a quarter of its luminance in the middle: L* of 0.25 is 57.08; of 1/16 at a
 * corner, 30.04. */
static void pixels_are_blurred(void **state)
{
	(void)state;
	float lightness[W * H];
	memset(picture, 0, sizeof(picture));
	memset(picture + 4 * (5 * W + 5), 255, 4);
	popping_lightness(picture, W, H, lightness, work);
	assert_true(fabs((double)lightness[5 * W + 5] - 57.075) < 0.01);
	assert_true(fabs((double)lightness[4 * W + 4] - 30.04) < 0.01);
	assert_true(lightness[5 * W + 7] == 0.0f);
}

static void only_a_change_of_the_error_pops(void **state)
{
	(void)state;
	float error[W * H], grey[W * H], white[W * H];
	struct popping popping = { .pixels = W * H, .error = error };
	struct popping_frame frame;
	flat(119, grey);
	flat(255, white);
	assert_false(popping_add(&popping, grey, white, &frame)); /* wrong by 49.97 from the start */
	assert_true(popping_add(&popping, grey, white, &frame));
	assert_true(frame.max == 0.0 && frame.rms == 0.0); /* still as wrong: nothing pops */
	assert_true(popping_add(&popping, white, white, &frame));
	assert_true(fabs(frame.mean - 49.97) < 0.01 && fabs(frame.rms - frame.mean) < 1e-3);
	assert_true(popping_add(&popping, grey, grey, &frame));
	assert_true(frame.max == 0.0); /* both changed alike */
	popping_cut(&popping);
	assert_false(popping_add(&popping, grey, white, &frame));
	assert_true(frame.max == 0.0);
}

/* Three of 200 pixels change by 10: mean 0.15, rms 10 sqrt(3 / 200), 99 % is at most 2 pixels above. */
static void few_pixels_show_in_the_percentile(void **state)
{
	(void)state;
	float error[W * H] = { 0 }, reference[W * H] = { 0 }, shown[W * H] = { 0 };
	struct popping popping = { .pixels = W * H, .error = error };
	struct popping_frame frame;
	popping_add(&popping, reference, shown, &frame);
	shown[3] = 10.0f;
	shown[77] = -10.0f;
	popping_add(&popping, reference, shown, &frame);
	assert_true(fabs(frame.mean - 0.1) < 1e-6 && frame.max == 10.0 && frame.p99 < 0.2);
	shown[3] = shown[77] = 0.0f;
	popping_add(&popping, reference, shown, &frame);
	shown[1] = shown[2] = shown[3] = 10.0f;
	popping_add(&popping, reference, shown, &frame);
	assert_true(fabs(frame.mean - 0.15) < 1e-6 && fabs(frame.rms - 10.0 * sqrt(0.015)) < 1e-6 && frame.p99 == 10.0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(greys_have_their_lightness),
		cmocka_unit_test(pixels_are_blurred),
		cmocka_unit_test(only_a_change_of_the_error_pops),
		cmocka_unit_test(few_pixels_show_in_the_percentile),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
