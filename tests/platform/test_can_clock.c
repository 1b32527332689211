#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/can/can_clock.h"

#define YEAR_NS (365 * 86400 * NS_PER_S)
#define WALL_NS (INT64_C(1700000000) * NS_PER_S)
#define START_NS (1000 * NS_PER_S)

/* A frame every 10 ms from START_NS on, read every 40 ms; the wall clock is set by `step_ns` between two of them. */
static void frames_keep_their_distances_when_the_clock_is_set(void **state)
{
	(void)state;
	static const int64_t steps[] = { 0, YEAR_NS, -YEAR_NS, 3600 * NS_PER_S, -3600 * NS_PER_S, 100 * NS_PER_MS,
		-100 * NS_PER_MS, 1000, -1000 };
	for (size_t s = 0; s < sizeof(steps) / sizeof(*steps); s++) {
		struct can_clock clock;
		int64_t wall_ns = WALL_NS, stamps[4], times[4];
		can_clock_init(&clock, WALL_NS, START_NS);
		for (int i = 0; i < 200; i++) {
			times[i % 4] = START_NS + i * 10 * NS_PER_MS;
			if (i == 101) /* in the middle of a batch */
				wall_ns += steps[s];
			stamps[i % 4] = wall_ns + times[i % 4] - START_NS;
			if (i % 4 < 3)
				continue;
			int64_t now_ns = times[3] + 2 * NS_PER_MS;
			can_clock_set(&clock, wall_ns + now_ns - START_NS, now_ns);
			for (int k = 0; k < 4; k++)
				assert_in_range(can_clock_time(&clock, stamps[k], now_ns), times[k] - 2000, times[k] + 2000);
		}
	}
}

static void times_never_step_back_nor_come_from_the_future(void **state)
{
	(void)state;
	struct can_clock clock;
	int64_t now_ns = START_NS, last_ns = START_NS;
	uint64_t seed = 1;
	can_clock_init(&clock, WALL_NS, now_ns);
	for (int i = 0; i < 100000; i++) {
		seed = seed * UINT64_C(6364136223846793005) + 1;
		int64_t wall_ns = (int64_t)(seed >> 2), stamp_ns = (int64_t)(seed * 31 >> 2);
		now_ns += NS_PER_MS;
		can_clock_set(&clock, wall_ns, now_ns);
		int64_t time_ns = can_clock_time(&clock, stamp_ns, now_ns);
		assert_true(time_ns >= last_ns && time_ns <= now_ns);
		last_ns = time_ns;
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(frames_keep_their_distances_when_the_clock_is_set),
		cmocka_unit_test(times_never_step_back_nor_come_from_the_future),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
