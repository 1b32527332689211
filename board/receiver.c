#include "board/receiver.h"

#include "platform/base/clock.h"

#define COURSE_NS (2 * NS_PER_S)

int receiver_open(struct receiver *receiver, const char *spec, int64_t wall_offset_ns, struct arena *arena)
{
	*receiver = (struct receiver){ 0 };
	return spec ? gnss_open(&receiver->gnss, spec, wall_offset_ns, arena) : 0;
}

void receiver_close(struct receiver *receiver)
{
	gnss_close(receiver->gnss);
	receiver->gnss = NULL;
}

static enum nav_signal_state state_of(const struct receiver *receiver)
{
	if (receiver->gnss->state == GNSS_GOOD)
		return NAV_SIGNAL_GOOD;
	return receiver->fixes ? NAV_SIGNAL_STALE : NAV_SIGNAL_WAITING;
}

static void tell_state(const struct receiver *receiver, struct vehicle_state *state, int input, int64_t age_ns)
{
	enum nav_signal_state own = state_of(receiver);
	/* the better of the two: bus and receiver */
	if (state->state[input] == NAV_SIGNAL_GOOD || (state->state[input] != NAV_SIGNAL_ABSENT && own != NAV_SIGNAL_GOOD))
		return;
	state->state[input] = own;
	state->age_ns[input] = age_ns;
}

void receiver_merge(struct receiver *receiver, struct vehicle_state *state)
{
	if (!receiver->gnss)
		return;
	receiver->fixes += gnss_read(receiver->gnss, state->time_ns, &receiver->last);
	const struct gnss_fix *last = &receiver->last;
	int64_t age_ns = receiver->fixes ? state->time_ns - last->time_ns : INT64_MAX;
	tell_state(receiver, state, VEHICLE_LATITUDE, age_ns);
	tell_state(receiver, state, VEHICLE_LONGITUDE, age_ns);
	state->fixes += receiver->fixes;
	if (!receiver->fixes || (state->has_fix && state->fix_time_ns > last->time_ns))
		return;
	state->has_fix = true;
	state->lat_deg = last->lat_deg;
	state->lon_deg = last->lon_deg;
	state->fix_time_ns = last->time_ns;
	state->fix_sigma_m = last->sigma_m;
	if (!state->heading_usable && last->has_course && age_ns < COURSE_NS) {
		state->heading_usable = true;
		state->heading_rad = last->course_rad;
	}
}
