/* How fast dead reckoning becomes wrong, against figures worked by hand and against many drives with random errors. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nav/drift.h"
#include "platform/base/clock.h"
#include "platform/base/geo.h"
#include "platform/base/rng.h"

#define assert_near(a, b, by) assert_true(fabs((a) - (b)) <= (by))
#define STEP_NS (20 * NS_PER_MS)

struct car {
	struct reckon reckon;
	struct drift drift;
	int64_t now_ns;
};

static void start(struct car *car, double scale_sigma, double bias_sigma, double heading_sigma)
{
	*car = (struct car){ 0 };
	reckon_init(&car->reckon, &(struct reckon_config){ 0 });
	car->reckon.scale_var = scale_sigma * scale_sigma;
	car->reckon.bias_var = bias_sigma * bias_sigma;
	drift_hold(&car->drift, &car->reckon, 0.0, 0.0, 0.0, heading_sigma);
}

static void go(struct car *car, double seconds, struct reckon_input input)
{
	for (int64_t until = car->now_ns + (int64_t)(seconds * 1e9); car->now_ns < until;) {
		car->now_ns += STEP_NS;
		struct reckon_step step = reckon_update(&car->reckon, &input, car->now_ns);
		drift_step(&car->drift, &car->reckon, &step, &input);
	}
}

static struct reckon_input driving(double speed, double yaw)
{
	return (struct reckon_input){ true, true, true, speed, yaw };
}

static void a_scale_of_1_percent_is_10_m_a_km_along(void **state)
{
	(void)state;
	struct car car;
	start(&car, 0.01, 0.0, 0.0);
	go(&car, 50.0, driving(20.0, 0.0));
	struct drift_ellipse ellipse = drift_ellipse(&car.drift);
	assert_near(ellipse.major_m, 10.0, 0.2);
	assert_true(ellipse.minor_m < 2.0);
	assert_near(fabs(remainder(ellipse.heading_rad, BLVD_PI)), 0.0, 0.05); /* north, the way it went */
}

static void a_bias_of_a_tenth_of_a_degree_is_44_m_sideways_after_a_minute(void **state)
{
	(void)state;
	struct car car;
	start(&car, 0.0, 0.1 * BLVD_PI / 180.0, 0.0);
	go(&car, 60.0, driving(14.0, 0.0));
	struct drift_ellipse ellipse = drift_ellipse(&car.drift);
	assert_near(ellipse.major_m, 44.0, 1.5);
	assert_near(fabs(remainder(ellipse.heading_rad - 0.5 * BLVD_PI, BLVD_PI)), 0.0, 0.05);
}

static void standing_still_drifts_nowhere(void **state)
{
	(void)state;
	struct car car;
	start(&car, 0.02, 0.02, 0.05);
	go(&car, 5.0, driving(10.0, 0.0));
	go(&car, 0.1, driving(0.0, 0.0));
	struct drift before = car.drift;
	go(&car, 3600.0, driving(0.0, 0.0));
	assert_memory_equal(before.cov, car.drift.cov, sizeof(before.cov));
}

/* Drives in a car park with sensors that are wrong by random amounts: the ellipse must hold the share of true places
 * that one and two sigma hold of a plane (39 % and 86 %), neither boasting nor moaning. */
static void the_ellipse_holds_as_many_true_places_as_it_says(void **state)
{
	(void)state;
	struct rng rng = rng_seed(5);
	int one = 0, two = 0, count = 400;
	for (int i = 0; i < count; i++) {
		const double scale_sigma = 0.01, bias_sigma = 0.004, heading_sigma = 0.05;
		double error[3];
		for (int k = 0; k < 3; k++)
			error[k] = (rng_unit(&rng) + rng_unit(&rng) + rng_unit(&rng) + rng_unit(&rng) - 2.0) * 1.7320508;
		struct car told, truth;
		start(&told, scale_sigma, bias_sigma, heading_sigma);
		start(&truth, 0.0, 0.0, 0.0);
		const int64_t origin[2] = { 0, 0 };
		reckon_place(&truth.reckon, origin, bam_from_rad(heading_sigma * error[0]));
		for (int leg = 0; leg < 8; leg++) {
			double speed = rng_range(&rng, 2.0, 8.0), yaw = rng_range(&rng, -0.4, 0.4), s = rng_range(&rng, 1.0, 5.0);
			go(&told, s, driving(speed, yaw));
			go(&truth, s, driving(speed * (1.0 + scale_sigma * error[1]), yaw - bias_sigma * error[2]));
		}
		double e = (double)(truth.reckon.pos_mm[0] - told.reckon.pos_mm[0]) * 1e-3;
		double n = (double)(truth.reckon.pos_mm[1] - told.reckon.pos_mm[1]) * 1e-3;
		double a = told.drift.cov[0][0], d = told.drift.cov[1][1], b = told.drift.cov[0][1], det = a * d - b * b;
		double far = (d * e * e - 2.0 * b * e * n + a * n * n) / det;
		one += far < 1.0;
		two += far < 4.0;
	}
	assert_in_range(one * 100 / count, 32, 50);
	assert_in_range(two * 100 / count, 80, 95);
}

static void a_fix_shrinks_the_ellipse_and_moves_the_place(void **state)
{
	(void)state;
	struct car car;
	struct dvec2 shift;
	double turn;
	start(&car, 0.0, 0.1 * BLVD_PI / 180.0, 0.02);
	go(&car, 60.0, driving(14.0, 0.0));
	assert_true(drift_fix(&car.drift, 40.0, 0.0, 3.0, &shift, &turn));
	assert_near(shift.x, 40.0, 0.5); /* the place was hardly known: the fix is believed */
	assert_true(turn > 0.02);        /* and the car heads farther to the right than was thought */
	assert_true(drift_ellipse(&car.drift).major_m < 3.5);
	assert_false(drift_fix(&car.drift, 100.0, 0.0, 3.0, &shift, &turn)); /* a wild one now */
}

static void without_a_speed_the_car_may_have_gone_on(void **state)
{
	(void)state;
	struct car car;
	start(&car, 0.0, 0.0, 0.0);
	go(&car, 1.0, driving(15.0, 0.0));
	go(&car, 10.0, (struct reckon_input){ .yaw_valid = true });
	assert_near(drift_ellipse(&car.drift).major_m, 150.0, 5.0);
	start(&car, 0.0, 0.0, 0.0); /* it stood when the bus fell silent: it still does */
	go(&car, 1.0, driving(0.0, 0.0));
	go(&car, 600.0, (struct reckon_input){ 0 });
	assert_true(drift_ellipse(&car.drift).major_m < 1.0);
}

static void strange_numbers_are_not_restored(void **state)
{
	(void)state;
	static const double bad[][4] = { { NAN, 1, 0, 0.1 }, { -1, 1, 0, 0.1 }, { 1, 1, 2, 0.1 }, { 1, 1, 0, -1 },
		{ 1, INFINITY, 0, 0.1 }, { 1, 1, NAN, 0.1 }, { 1, 1, 0, NAN } };
	struct car car;
	start(&car, 0.01, 0.01, 0.1);
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		assert_false(drift_restore(&car.drift, &car.reckon, bad[i], bad[i][3]));
	assert_true(drift_restore(&car.drift, &car.reckon, (const double[3]){ 100.0, 25.0, 30.0 }, 0.04));
	assert_near(drift_ellipse(&car.drift).major_m, 10.5, 0.2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_scale_of_1_percent_is_10_m_a_km_along),
		cmocka_unit_test(a_bias_of_a_tenth_of_a_degree_is_44_m_sideways_after_a_minute),
		cmocka_unit_test(standing_still_drifts_nowhere),
		cmocka_unit_test(the_ellipse_holds_as_many_true_places_as_it_says),
		cmocka_unit_test(a_fix_shrinks_the_ellipse_and_moves_the_place),
		cmocka_unit_test(without_a_speed_the_car_may_have_gone_on),
		cmocka_unit_test(strange_numbers_are_not_restored),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
