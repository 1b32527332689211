/* Quantiles of the fixed-size histogram against sorted samples. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "board/stats.h"
#include "platform/base/rng.h"

static int compare(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return x < y ? -1 : x > y;
}

static void quantiles_are_within_one_part_in_64(void **state)
{
	(void)state;
	enum { COUNT = 20000 };
	static uint64_t samples[COUNT];
	static struct histogram histogram;
	struct rng rng = rng_seed(3);
	for (int i = 0; i < COUNT; i++) {
		samples[i] = (uint64_t)exp(rng_range(&rng, 0.0, 25.0));
		histogram_add(&histogram, samples[i]);
	}
	qsort(samples, COUNT, sizeof(*samples), compare);
	static const double quantiles[] = { 0.001, 0.25, 0.5, 0.95, 0.99, 0.999, 1.0 };
	for (size_t i = 0; i < sizeof(quantiles) / sizeof(*quantiles); i++) {
		uint64_t exact = samples[(size_t)ceil(quantiles[i] * COUNT) - 1];
		uint64_t got = histogram_quantile(&histogram, quantiles[i]);
		assert_true(got >= exact && (double)got <= (double)exact * (1.0 + 1.0 / 64.0) + 1.0);
	}
	assert_int_equal(histogram_quantile(&histogram, 1.0), samples[COUNT - 1]);
}

static void an_empty_histogram_has_no_quantiles(void **state)
{
	(void)state;
	static struct histogram histogram;
	assert_int_equal(histogram_quantile(&histogram, 0.5), 0);
}

static void extreme_samples_stay_in_range(void **state)
{
	(void)state;
	static struct histogram histogram;
	histogram_add(&histogram, 0);
	histogram_add(&histogram, UINT64_MAX);
	assert_int_equal(histogram_quantile(&histogram, 0.5), 0);
	assert_true(histogram.max == UINT64_MAX);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(quantiles_are_within_one_part_in_64),
		cmocka_unit_test(an_empty_histogram_has_no_quantiles),
		cmocka_unit_test(extreme_samples_stay_in_range),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
