/* Ignition on and off, by a line and on the bus, chatter and silence. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "board/power.h"
#include "platform/base/clock.h"

#define N POWER_SAYS_NOTHING
#define OFF POWER_SAYS_OFF
#define ON POWER_SAYS_ON

struct moment {
	double at_s;
	enum power_word line, can;
	enum power_change change;
};

static const struct drive {
	const char *name;
	struct power_config config;
	struct moment moments[12]; /* at_s 0 after the first ends */
} drives[] = {
	{ "a car that never tells is on", { 0 }, { { 0, N, N, POWER_STAYS }, { 100, N, N, POWER_STAYS } } },
	{ "off counts when it lasts", { 0 },
		{ { 0, N, ON, POWER_STAYS }, { 1, N, OFF, POWER_STAYS }, { 2.9, N, OFF, POWER_STAYS },
			{ 3.1, N, OFF, POWER_GOES_OFF }, { 4, N, OFF, POWER_STAYS }, { 5, N, ON, POWER_GOES_ON } } },
	{ "cranking is not off", { .off_after_ns = 5 * NS_PER_S },
		{ { 0, N, ON, POWER_STAYS }, { 1, N, OFF, POWER_STAYS }, { 5.5, N, OFF, POWER_STAYS },
			{ 5.6, N, ON, POWER_STAYS }, { 5.7, N, OFF, POWER_STAYS }, { 10, N, OFF, POWER_STAYS },
			{ 10.8, N, OFF, POWER_GOES_OFF } } },
	{ "a bus that sleeps after off leaves it off", { 0 },
		{ { 0, N, OFF, POWER_STAYS }, { 1, N, N, POWER_STAYS }, { 2.1, N, N, POWER_GOES_OFF },
			{ 600, N, N, POWER_STAYS }, { 601, N, ON, POWER_GOES_ON } } },
	{ "a bus that falls silent on the way does not switch off", { 0 },
		{ { 0, N, ON, POWER_STAYS }, { 1, N, N, POWER_STAYS }, { 3600, N, N, POWER_STAYS } } },
	{ "the line goes before the bus", { 0 },
		{ { 0, ON, OFF, POWER_STAYS }, { 9, ON, OFF, POWER_STAYS }, { 10, OFF, ON, POWER_STAYS },
			{ 13, OFF, ON, POWER_GOES_OFF }, { 14, N, ON, POWER_STAYS }, { 15, ON, OFF, POWER_GOES_ON } } },
	{ "a clock that steps back only waits longer", { 0 },
		{ { 50, N, OFF, POWER_STAYS }, { 20, N, OFF, POWER_STAYS }, { 21, N, OFF, POWER_STAYS },
			{ 22.1, N, OFF, POWER_GOES_OFF } } },
};

static void ignition_goes_off_and_on(void **state)
{
	(void)state;
	for (size_t d = 0; d < sizeof(drives) / sizeof(drives[0]); d++) {
		struct power power;
		power_init(&power, &drives[d].config);
		for (size_t i = 0; i < 12 && (i == 0 || drives[d].moments[i].at_s > 0.0); i++) {
			const struct moment *moment = &drives[d].moments[i];
			enum power_change change = power_advance(&power, moment->line, moment->can, (int64_t)(moment->at_s * 1e9));
			if (change != moment->change)
				fail_msg("%s: at %g s", drives[d].name, moment->at_s);
		}
	}
}

static void frames_are_rare_while_dark(void **state)
{
	(void)state;
	struct power power;
	power_init(&power, &(struct power_config){ 0 });
	assert_int_equal(power_fps(&power, 60), 60);
	power_advance(&power, OFF, N, 0);
	power_advance(&power, OFF, N, 3 * NS_PER_S);
	assert_int_equal(power_fps(&power, 60), 2);
	assert_int_equal(power_fps(&power, 1), 1);
	power_advance(&power, ON, N, 4 * NS_PER_S);
	assert_int_equal(power_fps(&power, 60), 60);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ignition_goes_off_and_on),
		cmocka_unit_test(frames_are_rare_while_dark),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
