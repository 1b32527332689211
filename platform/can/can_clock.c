#include "platform/can/can_clock.h"

#include <stdbool.h>

#define STEP_NS INT64_C(20000000) /* less is a slew, or that we were interrupted between reading both clocks */

void can_clock_init(struct can_clock *clock, int64_t wall_ns, int64_t now_ns)
{
	clock->offset_ns = clock->before_ns = wall_ns - now_ns;
	clock->floor_ns = now_ns;
}

void can_clock_set(struct can_clock *clock, int64_t wall_ns, int64_t now_ns)
{
	int64_t offset_ns = wall_ns - now_ns, step_ns = offset_ns - clock->offset_ns;
	if (step_ns > STEP_NS || step_ns < -STEP_NS)
		clock->before_ns = clock->offset_ns;
	clock->offset_ns = offset_ns;
}

static bool is_possible(const struct can_clock *clock, int64_t time_ns, int64_t now_ns)
{
	return time_ns >= clock->floor_ns - STEP_NS && time_ns <= now_ns + STEP_NS;
}

int64_t can_clock_time(struct can_clock *clock, int64_t stamp_ns, int64_t now_ns)
{
	int64_t time_ns = stamp_ns - clock->offset_ns;
	if (!is_possible(clock, time_ns, now_ns) && is_possible(clock, stamp_ns - clock->before_ns, now_ns))
		time_ns = stamp_ns - clock->before_ns;
	if (!is_possible(clock, time_ns, now_ns) || time_ns > now_ns)
		time_ns = now_ns; /* set twice since the last look: all that is sure is that it is here */
	if (time_ns > clock->floor_ns)
		clock->floor_ns = time_ns;
	return clock->floor_ns;
}
