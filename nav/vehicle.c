/* Per frame: compare the identifier with the bound ones, decode, judge. Per picture: ages and derived values. */
#include "nav/vehicle.h"

#include <assert.h>
#include <math.h>

#include "platform/base/vec.h"

static const int64_t never = INT64_MIN;

void vehicle_init(struct vehicle *vehicle, const struct vehicle_config *config)
{
	*vehicle = (struct vehicle){ .config = config };
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++) {
		struct vehicle_track *track = &vehicle->inputs[i];
		track->good_ns = track->seen_ns = track->changed_ns = never;
		assert(!config->inputs[i].signal || config->inputs[i].timeout_ns > 0);
	}
}

static int64_t elapsed(int64_t since_ns, int64_t now_ns)
{
	if (since_ns == never)
		return INT64_MAX;
	return now_ns > since_ns ? now_ns - since_ns : 0;
}

/* After a silence the sender may have restarted: its counter is learnt anew. */
static enum vehicle_fault judge_counter(const struct vehicle_binding *binding, struct vehicle_track *track,
	const struct can_frame_rx *frame, int64_t silence_ns)
{
	int64_t raw;
	if (!binding->counter)
		return VEHICLE_FAULT_NONE;
	if (!dbc_decode_raw(binding->counter, frame, &raw))
		return VEHICLE_FAULT_COUNTER;
	uint64_t mask = ~UINT64_C(0) >> (64 - binding->counter->length), count = (uint64_t)raw & mask;
	uint64_t step = (count - track->count) & mask;
	bool known = track->counting && silence_ns <= binding->timeout_ns;
	track->count = count;
	track->counting = true;
	if (!known)
		return VEHICLE_FAULT_NONE;
	if (step == 0)
		return VEHICLE_FAULT_REPEATED;
	return step - 1 > binding->counter_skip ? VEHICLE_FAULT_COUNTER : VEHICLE_FAULT_NONE;
}

static enum vehicle_fault judge_frame(const struct vehicle_binding *binding, struct vehicle_track *track,
	const struct can_frame_rx *frame, int64_t silence_ns)
{
	int64_t raw;
	/* The checksum first: in a damaged frame the counter says nothing. */
	if (binding->checksum && !can_checksum_good(binding->checksum_kind, binding->checksum, frame))
		return VEHICLE_FAULT_CHECKSUM;
	enum vehicle_fault fault = judge_counter(binding, track, frame, silence_ns);
	if (fault)
		return fault;
	if (binding->valid && (!dbc_decode_raw(binding->valid, frame, &raw) || raw == 0))
		return VEHICLE_FAULT_INVALID;
	return VEHICLE_FAULT_NONE;
}

static bool look_up(const struct vehicle_binding *binding, int64_t raw, double *value)
{
	for (unsigned i = 0; i < binding->map_count; i++) {
		if (binding->map[i].raw != raw)
			continue;
		*value = binding->map[i].meaning;
		return true;
	}
	return false;
}

static double distance(const struct vehicle_binding *binding, double a, double b)
{
	return fabs(binding->wraps ? remainder(a - b, binding->turn) : a - b);
}

/* How much an input may change between two samples. Frames that waited somewhere, in an adapter or in a busy kernel,
 * come at once: their time stamps tell less than the time that passed for the car. */
static double largest_change(const struct vehicle_binding *binding, int64_t since_ns)
{
	int64_t passed_ns = since_ns > binding->spacing_ns ? since_ns : binding->spacing_ns;
	return binding->max_rate * (double)passed_ns * 1e-9 + binding->quantum;
}

/* One outlier is dropped; a second sample that agrees with it shows that the car did change, or that the value before
 * was the wrong one. */
static bool is_jump(const struct vehicle_binding *binding, struct vehicle_track *track, double value, int64_t now_ns)
{
	if (binding->max_rate <= 0.0 || elapsed(track->good_ns, now_ns) > binding->timeout_ns)
		return false;
	bool far = distance(binding, value, track->value) > largest_change(binding, elapsed(track->good_ns, now_ns));
	bool agrees = track->has_candidate && distance(binding, value, track->candidate) <=
											  largest_change(binding, elapsed(track->seen_ns, now_ns));
	track->candidate = value;
	track->has_candidate = far && !agrees;
	return track->has_candidate;
}

static enum vehicle_fault judge_value(
	const struct vehicle_binding *binding, struct vehicle_track *track, const struct can_frame_rx *frame, double *value)
{
	int64_t raw;
	if (!dbc_decode_raw(binding->signal, frame, &raw) || !dbc_decode(binding->signal, frame, value))
		return VEHICLE_FAULT_RANGE; /* unreachable: the caller has decoded it */
	if (track->changed_ns == never || raw != track->raw)
		track->changed_ns = frame->time_ns;
	track->raw = raw;
	if (binding->map_count)
		return look_up(binding, raw, value) ? VEHICLE_FAULT_NONE : VEHICLE_FAULT_UNKNOWN;
	*value = *value * binding->scale + binding->offset;
	if (!isfinite(*value))
		return VEHICLE_FAULT_NOT_A_NUMBER;
	if (*value < binding->min || *value > binding->max)
		return VEHICLE_FAULT_RANGE;
	if (binding->frozen_ns > 0 && elapsed(track->changed_ns, frame->time_ns) > binding->frozen_ns)
		return VEHICLE_FAULT_FROZEN;
	return is_jump(binding, track, *value, frame->time_ns) ? VEHICLE_FAULT_JUMP : VEHICLE_FAULT_NONE;
}

/* Returns whether the sample was taken. */
static bool take_sample(
	const struct vehicle_binding *binding, struct vehicle_track *track, const struct can_frame_rx *frame)
{
	double value = 0.0;
	enum vehicle_fault fault = judge_frame(binding, track, frame, elapsed(track->seen_ns, frame->time_ns));
	if (!fault)
		fault = judge_value(binding, track, frame, &value);
	if (frame->time_ns > track->seen_ns)
		track->seen_ns = frame->time_ns;
	track->fault = fault;
	track->faults[fault]++;
	if (fault)
		return false;
	track->value = value;
	if (frame->time_ns > track->good_ns)
		track->good_ns = frame->time_ns;
	track->taken++;
	return true;
}

/* A position is both coordinates, each newer than in the last one. */
static void note_fix(struct vehicle *vehicle)
{
	const struct vehicle_track *lat = &vehicle->inputs[VEHICLE_LATITUDE], *lon = &vehicle->inputs[VEHICLE_LONGITUDE];
	if (lat->taken == vehicle->latitude_used || lon->taken == vehicle->longitude_used)
		return;
	vehicle->latitude_used = lat->taken;
	vehicle->longitude_used = lon->taken;
	vehicle->fix_lat_deg = lat->value;
	vehicle->fix_lon_deg = lon->value;
	vehicle->fix_ns = lat->good_ns > lon->good_ns ? lat->good_ns : lon->good_ns;
	vehicle->fixes++;
}

void vehicle_feed(struct vehicle *vehicle, const struct can_frame_rx *frame)
{
	bool used = false, bad = false;
	vehicle->frames_in++;
	if (frame->flags & (CAN_FRAME_REMOTE | CAN_FRAME_ERROR))
		return;
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++) {
		const struct vehicle_binding *binding = &vehicle->config->inputs[i];
		int64_t raw;
		if (!binding->signal || binding->signal->message->id != frame->id ||
			(binding->bus != VEHICLE_ANY_BUS && binding->bus != frame->bus) ||
			!dbc_decode_raw(binding->signal, frame, &raw))
			continue;
		used = true;
		bad |= !take_sample(binding, &vehicle->inputs[i], frame);
	}
	vehicle->frames_used += used;
	vehicle->frames_bad += bad;
	if (used)
		note_fix(vehicle);
}

static enum nav_signal_state judge_age(
	const struct vehicle_binding *binding, const struct vehicle_track *track, int64_t now_ns)
{
	if (!binding->signal)
		return NAV_SIGNAL_ABSENT;
	if (track->seen_ns == never)
		return NAV_SIGNAL_WAITING;
	if (elapsed(track->seen_ns, now_ns) > binding->timeout_ns)
		return NAV_SIGNAL_STALE;
	return track->fault ? NAV_SIGNAL_IMPLAUSIBLE : NAV_SIGNAL_GOOD;
}

/* A single refused sample does not take the value away: the last good one holds until it is too old. */
static bool usable(const struct vehicle *vehicle, int input, int64_t now_ns)
{
	const struct vehicle_binding *binding = &vehicle->config->inputs[input];
	const struct vehicle_track *track = &vehicle->inputs[input];
	return binding->signal && track->good_ns != never && elapsed(track->good_ns, now_ns) <= binding->timeout_ns;
}

static void sample_inputs(struct vehicle *vehicle, struct vehicle_state *out)
{
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++) {
		const struct vehicle_binding *binding = &vehicle->config->inputs[i];
		const struct vehicle_track *track = &vehicle->inputs[i];
		out->state[i] = judge_age(binding, track, out->time_ns);
		out->age_ns[i] = elapsed(track->good_ns, out->time_ns);
		out->value[i] = track->value;
		if (track->good_ns != never && out->age_ns[i] > binding->timeout_ns && out->age_ns[i] > vehicle->stale_ns_max)
			vehicle->stale_ns_max = out->age_ns[i];
	}
}

static void sample_gear(const struct vehicle *vehicle, struct vehicle_state *out)
{
	if (usable(vehicle, VEHICLE_GEAR, out->time_ns))
		out->gear = (enum nav_gear)out->value[VEHICLE_GEAR];
}

/* Mean of the usable wheels, and the oldest age among them. */
static bool speed_of_wheels(
	const struct vehicle *vehicle, const struct vehicle_state *at, double *speed, int64_t *age_ns)
{
	double sum = 0.0;
	int n = 0;
	*age_ns = 0;
	for (int i = VEHICLE_WHEEL_FRONT_LEFT; i <= VEHICLE_WHEEL_REAR_RIGHT; i++) {
		if (!usable(vehicle, i, at->time_ns))
			continue;
		sum += at->value[i];
		n++;
		if (at->age_ns[i] > *age_ns)
			*age_ns = at->age_ns[i];
	}
	if (n)
		*speed = sum / n;
	return n > 0;
}

static void sample_speed(const struct vehicle *vehicle, struct vehicle_state *out)
{
	out->speed_mps = out->value[VEHICLE_SPEED];
	out->speed_age_ns = out->age_ns[VEHICLE_SPEED];
	out->speed_usable = usable(vehicle, VEHICLE_SPEED, out->time_ns);
	double wheels;
	int64_t wheels_age;
	if (!out->speed_usable && speed_of_wheels(vehicle, out, &wheels, &wheels_age)) {
		out->speed_usable = true;
		out->speed_mps = wheels;
		out->speed_age_ns = wheels_age;
	}
	if (out->gear == NAV_GEAR_REVERSE && !vehicle->config->speed_signed)
		out->speed_mps = -fabs(out->speed_mps);
}

double vehicle_bicycle_yaw(const struct vehicle_config *config, double speed_mps, double steering_rad)
{
	double angle = (steering_rad - config->steering_centre_rad) / config->steering_ratio;
	double base = config->wheelbase_m * (1.0 + config->understeer_s2pm2 * speed_mps * speed_mps);
	return speed_mps * tan(angle) / base;
}

static void sample_yaw_rate(const struct vehicle *vehicle, struct vehicle_state *out)
{
	const struct vehicle_config *config = vehicle->config;
	bool steering = config->wheelbase_m > 0.0 && config->steering_ratio > 0.0;
	bool wheels = config->track_m > 0.0 && usable(vehicle, VEHICLE_WHEEL_REAR_LEFT, out->time_ns) &&
				  usable(vehicle, VEHICLE_WHEEL_REAR_RIGHT, out->time_ns);
	if (usable(vehicle, VEHICLE_YAW_RATE, out->time_ns)) {
		out->yaw_source = VEHICLE_YAW_SENSOR;
		out->yaw_rate_rps = out->value[VEHICLE_YAW_RATE];
	} else if (steering && out->speed_usable && usable(vehicle, VEHICLE_STEERING, out->time_ns)) {
		out->yaw_source = VEHICLE_YAW_STEERING;
		out->yaw_rate_rps = vehicle_bicycle_yaw(config, out->speed_mps, out->value[VEHICLE_STEERING]);
	} else if (wheels) {
		double sign = out->gear == NAV_GEAR_REVERSE && !config->speed_signed ? -1.0 : 1.0;
		out->yaw_source = VEHICLE_YAW_WHEELS;
		out->yaw_rate_rps =
			sign * (out->value[VEHICLE_WHEEL_REAR_LEFT] - out->value[VEHICLE_WHEEL_REAR_RIGHT]) / config->track_m;
	}
}

static void sample_lamps(const struct vehicle *vehicle, struct vehicle_state *out)
{
	bool left = usable(vehicle, VEHICLE_TURN_LEFT, out->time_ns) && out->value[VEHICLE_TURN_LEFT] > 0.0;
	bool right = usable(vehicle, VEHICLE_TURN_RIGHT, out->time_ns) && out->value[VEHICLE_TURN_RIGHT] > 0.0;
	if (usable(vehicle, VEHICLE_TURN_LAMP, out->time_ns))
		out->turn_lamp = (enum nav_turn_lamp)out->value[VEHICLE_TURN_LAMP];
	else if (left || right)
		out->turn_lamp = left && right ? NAV_TURN_LAMP_HAZARD : left ? NAV_TURN_LAMP_LEFT : NAV_TURN_LAMP_RIGHT;
}

/* The driver sees one turn-lamp input: of two sides, the worse. */
static void merge_lamp_states(const struct vehicle *vehicle, struct vehicle_state *out)
{
	if (vehicle->config->inputs[VEHICLE_TURN_LAMP].signal)
		return;
	for (int i = VEHICLE_TURN_LEFT; i <= VEHICLE_TURN_RIGHT; i++) {
		if (out->state[i] < out->state[VEHICLE_TURN_LAMP] || out->state[i] == NAV_SIGNAL_ABSENT)
			continue;
		out->state[VEHICLE_TURN_LAMP] = out->state[i];
		out->age_ns[VEHICLE_TURN_LAMP] = out->age_ns[i];
	}
}

static void sample_heading(const struct vehicle *vehicle, struct vehicle_state *out)
{
	double heading = fmod(out->value[VEHICLE_HEADING], 2.0 * BLVD_PI);
	out->heading_rad = heading < 0.0 ? heading + 2.0 * BLVD_PI : heading;
	out->heading_usable = usable(vehicle, VEHICLE_HEADING, out->time_ns);
}

void vehicle_sample(struct vehicle *vehicle, int64_t now_ns, struct vehicle_state *out)
{
	*out = (struct vehicle_state){ .time_ns = now_ns, .ambient = -1.0 };
	sample_inputs(vehicle, out);
	sample_gear(vehicle, out);
	sample_speed(vehicle, out);
	sample_yaw_rate(vehicle, out);
	sample_heading(vehicle, out);
	sample_lamps(vehicle, out);
	merge_lamp_states(vehicle, out);
	if (usable(vehicle, VEHICLE_AMBIENT, now_ns))
		out->ambient = out->value[VEHICLE_AMBIENT];
	if (usable(vehicle, VEHICLE_IGNITION, now_ns))
		out->ignition = (enum vehicle_ignition)out->value[VEHICLE_IGNITION];
	out->odometer_usable = usable(vehicle, VEHICLE_ODOMETER, now_ns);
	out->odometer_m = out->value[VEHICLE_ODOMETER];
	out->has_fix = vehicle->fixes > 0;
	out->lat_deg = vehicle->fix_lat_deg;
	out->lon_deg = vehicle->fix_lon_deg;
	out->fix_time_ns = vehicle->fix_ns;
	out->fixes = vehicle->fixes;
}

const char *vehicle_fault_name(enum vehicle_fault fault)
{
	static const char *const names[VEHICLE_FAULT_COUNT] = { "none", "not a number", "range", "jump", "repeated",
		"counter", "checksum", "invalid", "unknown value", "frozen" };
	return fault < VEHICLE_FAULT_COUNT ? names[fault] : "?";
}
