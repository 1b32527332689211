/* Dead reckoning: geometry, time, standing still, learning. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nav/reckon.h"
#include "platform/base/clock.h"
#include "platform/base/geo.h"
#include "platform/base/rng.h"

#define assert_near(a, b, by) assert_true(fabs((a) - (b)) <= (by))

static struct reckon_input driving(double speed_mps, double yaw_rate_rps)
{
	return (struct reckon_input){ true, true, true, speed_mps, yaw_rate_rps };
}

static struct reckon fresh(void)
{
	struct reckon reckon;
	reckon_init(&reckon, &(struct reckon_config){ 0 });
	return reckon;
}

static void run(struct reckon *reckon, struct reckon_input input, double seconds, int64_t step_ns)
{
	int64_t until = reckon->time_ns + (int64_t)(seconds * 1e9);
	for (int64_t now = reckon->time_ns + (reckon->started ? step_ns : 0); now <= until; now += step_ns)
		reckon_update(reckon, &input, now);
}

static void circles_close(void **state)
{
	(void)state;
	static const int64_t steps[] = { 5 * NS_PER_MS, 20 * NS_PER_MS, 100 * NS_PER_MS, 500 * NS_PER_MS };
	for (size_t i = 0; i < sizeof(steps) / sizeof(steps[0]); i++) {
		struct reckon reckon = fresh();
		run(&reckon, driving(10.0, 2.0 * BLVD_PI / 40.0), 40.0, steps[i]);
		assert_true(llabs(reckon.pos_mm[0]) < 10 && llabs(reckon.pos_mm[1]) < 10);
		assert_true(abs(reckon.heading_bam) < 5000);
		assert_near(reckon.travelled_m, 400.0, 0.01);
	}
}

static void right_turns_go_right(void **state)
{
	(void)state;
	struct reckon reckon = fresh();
	run(&reckon, driving(10.0, 0.1), 5.0, 20 * NS_PER_MS);
	assert_true(reckon.pos_mm[0] > 0 && reckon.pos_mm[1] > 0 && reckon.heading_bam > 0);
	run(&reckon, driving(-10.0, -0.1), 5.0, 20 * NS_PER_MS); /* and the same way back */
	assert_true(llabs(reckon.pos_mm[0]) < 300 && llabs(reckon.pos_mm[1]) < 600);
}

static void headings_pass_south_without_a_jump(void **state)
{
	(void)state;
	struct reckon reckon = fresh();
	reckon_place(&reckon, (const int64_t[2]){ 0, 0 }, bam_from_rad(BLVD_PI - 0.01));
	run(&reckon, driving(10.0, 0.02), 1.0, 10 * NS_PER_MS);
	assert_near(remainder(bam_to_rad(reckon.heading_bam) - (BLVD_PI + 0.01), 2.0 * BLVD_PI), 0.0, 1e-6);
	assert_true(reckon.pos_mm[1] < -9990);
	assert_true(llabs(reckon.pos_mm[0]) < 60);
}

static void ten_thousand_kilometres_away_moves_the_same(void **state)
{
	(void)state;
	struct reckon here = fresh(), there = fresh();
	const int64_t far[2] = { INT64_C(10000000000), -INT64_C(10000000000) };
	reckon_place(&there, far, 0);
	run(&here, driving(13.7, 0.03), 300.0, 17 * NS_PER_MS);
	run(&there, driving(13.7, 0.03), 300.0, 17 * NS_PER_MS);
	assert_true(here.pos_mm[0] == there.pos_mm[0] - far[0] && here.pos_mm[1] == there.pos_mm[1] - far[1]);
}

static void time_that_does_not_pass_moves_nothing(void **state)
{
	(void)state;
	struct reckon reckon = fresh();
	struct reckon_input input = driving(20.0, 0.1);
	reckon_update(&reckon, &input, NS_PER_S);
	reckon_update(&reckon, &input, 2 * NS_PER_S);
	struct reckon before = reckon;
	for (int i = 0; i < 100; i++)
		assert_near(reckon_update(&reckon, &input, 2 * NS_PER_S).distance_m, 0.0, 0.0);
	assert_memory_equal(&before.pos_mm, &reckon.pos_mm, sizeof(reckon.pos_mm));
	reckon_update(&reckon, &input, NS_PER_S / 2); /* the clock steps back */
	assert_memory_equal(&before.pos_mm, &reckon.pos_mm, sizeof(reckon.pos_mm));
	assert_int_equal(reckon.steps_back, 1);
	reckon_update(&reckon, &input, NS_PER_S);
	assert_near(reckon.travelled_m, 30.0, 0.1);
}

static void gaps_are_bridged_with_the_speeds_at_their_ends(void **state)
{
	(void)state;
	struct reckon reckon = fresh();
	struct reckon_input slow = driving(10.0, 0.3), fast = driving(20.0, 0.3);
	reckon_update(&reckon, &slow, 0);
	struct reckon_step step = reckon_update(&reckon, &fast, 10 * NS_PER_S);
	assert_true(step.gap);
	assert_near(step.distance_m, 150.0, 1e-9);
	assert_true(fabs(step.turn_rad) < 0.31); /* nobody turns on for ten seconds */
	step = reckon_update(&reckon, &fast, 3600 * NS_PER_S);
	assert_true(step.distance_m <= 12.0 * 20.0 + 1e-9);
}

static void an_hour_of_standing_changes_nothing_but_the_bias(void **state)
{
	(void)state;
	struct rng rng = rng_seed(1);
	struct reckon reckon = fresh();
	double bias = 0.3 * BLVD_PI / 180.0;
	reckon_place(&reckon, (const int64_t[2]){ 123, 456 }, 789);
	for (int64_t i = 0; i <= 3600 * 20; i++) {
		struct reckon_input input = driving(0.0, bias + rng_range(&rng, -0.005, 0.005));
		reckon_update(&reckon, &input, i * 50 * NS_PER_MS);
	}
	assert_true(reckon.pos_mm[0] == 123 && reckon.pos_mm[1] == 456 && reckon.heading_bam == 789);
	assert_near(reckon.yaw_bias_rps, bias, 1e-4);
	run(&reckon, driving(10.0, bias), 60.0, 20 * NS_PER_MS);
	assert_true(fabs(bam_to_rad(reckon.heading_bam)) < 0.01); /* the learned bias is taken off */
}

static void steering_has_no_bias_to_learn(void **state)
{
	(void)state;
	struct reckon reckon = fresh();
	struct reckon_input input = driving(0.0, 0.01);
	input.yaw_biased = false;
	run(&reckon, input, 60.0, 50 * NS_PER_MS);
	assert_near(reckon.yaw_bias_rps, 0.0, 0.0);
}

static void nonsense_moves_nothing(void **state)
{
	(void)state;
	struct reckon reckon = fresh();
	const double bad[] = { NAN, INFINITY, -INFINITY };
	for (int i = 0; i < 3; i++) {
		struct reckon_input input = driving(bad[i], bad[i]);
		reckon_update(&reckon, &input, i * NS_PER_S);
	}
	struct reckon_input silent = { 0 };
	reckon_update(&reckon, &silent, 5 * NS_PER_S);
	reckon_update(&reckon, &silent, 6 * NS_PER_S);
	assert_true(reckon.pos_mm[0] == 0 && reckon.pos_mm[1] == 0 && reckon.heading_bam == 0);
	assert_true(isfinite(reckon.yaw_bias_rps));
}

static void references_teach_scale_and_bias(void **state)
{
	(void)state;
	struct reckon reckon = fresh();
	for (int i = 0; i < 50; i++)
		reckon_distance_reference(&reckon, 100.0, 100.0 / 1.03 * reckon.speed_scale, 3.0);
	assert_near(reckon.speed_scale, 1.03, 0.005);
	for (int i = 0; i < 100; i++)
		reckon_bias_reference(&reckon, -(0.01 - reckon.yaw_bias_rps) * 5.0, 5.0, 0.02);
	assert_near(reckon.yaw_bias_rps, 0.01, 0.001);
	reckon_distance_reference(&reckon, NAN, 100.0, 3.0);
	assert_true(isfinite(reckon.speed_scale));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(circles_close),
		cmocka_unit_test(right_turns_go_right),
		cmocka_unit_test(headings_pass_south_without_a_jump),
		cmocka_unit_test(ten_thousand_kilometres_away_moves_the_same),
		cmocka_unit_test(time_that_does_not_pass_moves_nothing),
		cmocka_unit_test(gaps_are_bridged_with_the_speeds_at_their_ends),
		cmocka_unit_test(an_hour_of_standing_changes_nothing_but_the_bias),
		cmocka_unit_test(steering_has_no_bias_to_learn),
		cmocka_unit_test(nonsense_moves_nothing),
		cmocka_unit_test(references_teach_scale_and_bias),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
