/* Signals to states: ages, timeouts and every reason for which a sample is not taken. Frames are made by the virtual
 * car's definitions; times are whole milliseconds. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nav/vehicle.h"
#include "platform/base/vec.h"
#include "platform/can/dbc_boulevard.h"

#define MS INT64_C(1000000)

static const char extra_text[] =
	"BO_ 1 X: 8 Y\n SG_ Float : 0|32@1- (1,0) [0|0] \"\" Y\n SG_ Page M : 32|8@1+ (1,0) [0|0] \"\" Y\n"
	" SG_ Paged m1 : 40|8@1+ (1,0) [0|0] \"\" Y\nSIG_VALTYPE_ 1 Float : 1;\n";

static _Alignas(64) uint8_t memory[1 << 18];
static struct dbc dbc, extra;
static struct vehicle_config config;
static struct vehicle vehicle;
static struct vehicle_state state;

static const struct dbc_signal *signal_of(const char *message, const char *name)
{
	const struct dbc_signal *signal = dbc_find_signal(&dbc, message, name);
	if (!signal)
		signal = dbc_find_signal(&extra, message, name);
	assert_non_null(signal);
	return signal;
}

static struct vehicle_binding *bind_input(int input, const char *message, const char *name, double scale)
{
	struct vehicle_binding *binding = &config.inputs[input];
	*binding = (struct vehicle_binding){ .signal = signal_of(message, name), .bus = VEHICLE_ANY_BUS, .scale = scale };
	binding->min = -1e9;
	binding->max = 1e9;
	binding->timeout_ns = 100 * MS;
	return binding;
}

static int set_up(void **unused)
{
	(void)unused;
	struct arena arena;
	struct dbc_note error;
	arena_init(&arena, "test", memory, sizeof(memory));
	memset(&config, 0, sizeof(config));
	assert_int_equal(dbc_parse(&dbc, dbc_boulevard_text, dbc_boulevard_size, &arena, &error), 0);
	assert_int_equal(dbc_parse(&extra, extra_text, strlen(extra_text), &arena, &error), 0);
	bind_input(VEHICLE_SPEED, "MOTION", "Speed", 1.0 / 3.6);
	vehicle_init(&vehicle, &config);
	return 0;
}

static struct can_frame_rx frame_with(const char *message, const char *name, double value, int64_t time_ms)
{
	struct can_frame_rx frame;
	const struct dbc_signal *signal = signal_of(message, name);
	dbc_frame_init(signal->message, &frame);
	frame.time_ns = time_ms * MS;
	dbc_encode(signal, value, &frame);
	return frame;
}

static void feed(const char *message, const char *name, double value, int64_t time_ms)
{
	struct can_frame_rx frame = frame_with(message, name, value, time_ms);
	vehicle_feed(&vehicle, &frame);
}

static enum nav_signal_state state_at(int input, int64_t time_ms)
{
	vehicle_sample(&vehicle, time_ms * MS, &state);
	return state.state[input];
}

static void a_signal_waits_is_good_goes_stale_and_comes_back(void **unused)
{
	(void)unused;
	assert_int_equal(state_at(VEHICLE_YAW_RATE, 0), NAV_SIGNAL_ABSENT);
	assert_int_equal(state_at(VEHICLE_SPEED, 0), NAV_SIGNAL_WAITING);
	assert_true(state.age_ns[VEHICLE_SPEED] == INT64_MAX);
	assert_false(state.speed_usable);
	feed("MOTION", "Speed", 36.0, 1000);
	assert_int_equal(state_at(VEHICLE_SPEED, 1000), NAV_SIGNAL_GOOD);
	assert_true(fabs(state.speed_mps - 10.0) < 1e-9);
	assert_int_equal(state_at(VEHICLE_SPEED, 1100), NAV_SIGNAL_GOOD);
	assert_true(state.age_ns[VEHICLE_SPEED] == 100 * MS);
	assert_int_equal(vehicle.stale_ns_max, 0);
	assert_int_equal(state_at(VEHICLE_SPEED, 1101), NAV_SIGNAL_STALE);
	assert_false(state.speed_usable);
	assert_true(fabs(state.speed_mps - 10.0) < 1e-9); /* the last good one */
	assert_true(vehicle.stale_ns_max == 101 * MS);
	feed("MOTION", "Speed", 18.0, 2000);
	assert_int_equal(state_at(VEHICLE_SPEED, 2000), NAV_SIGNAL_GOOD);
	assert_true(state.speed_usable && fabs(state.speed_mps - 5.0) < 1e-9);
}

static void time_that_steps_back_ages_nothing(void **unused)
{
	(void)unused;
	feed("MOTION", "Speed", 36.0, 1000);
	feed("MOTION", "Speed", 37.0, 900);
	assert_int_equal(state_at(VEHICLE_SPEED, 950), NAV_SIGNAL_GOOD);
	assert_true(state.age_ns[VEHICLE_SPEED] == 0);
	assert_int_equal(state_at(VEHICLE_SPEED, 1100), NAV_SIGNAL_GOOD);
}

static void out_of_range_is_a_state_while_the_last_good_value_holds(void **unused)
{
	(void)unused;
	config.inputs[VEHICLE_SPEED].max = 50.0;
	feed("MOTION", "Speed", 36.0, 1000);
	feed("MOTION", "Speed", 400.0, 1020);
	assert_int_equal(state_at(VEHICLE_SPEED, 1020), NAV_SIGNAL_IMPLAUSIBLE);
	assert_true(state.speed_usable && fabs(state.speed_mps - 10.0) < 1e-9);
	assert_int_equal(vehicle.inputs[VEHICLE_SPEED].fault, VEHICLE_FAULT_RANGE);
	for (int64_t ms = 1040; ms <= 1200; ms += 20)
		feed("MOTION", "Speed", 400.0, ms);
	assert_int_equal(state_at(VEHICLE_SPEED, 1200), NAV_SIGNAL_IMPLAUSIBLE);
	assert_false(state.speed_usable); /* good is too long ago */
	assert_true(state.age_ns[VEHICLE_SPEED] == 200 * MS);
	assert_int_equal(state_at(VEHICLE_SPEED, 1400), NAV_SIGNAL_STALE);
	assert_int_equal(vehicle.frames_bad, 10);
	assert_int_equal(vehicle.frames_in, 11);
}

static void nan_and_infinity_are_not_taken(void **unused)
{
	(void)unused;
	static const uint8_t patterns[3][4] = { { 0, 0, 0xC0, 0x7F }, { 0, 0, 0x80, 0x7F }, { 0, 0, 0x80, 0xFF } };
	bind_input(VEHICLE_YAW_RATE, "X", "Float", 1.0);
	feed("X", "Float", 0.25, 1000);
	for (int i = 0; i < 3; i++) {
		struct can_frame_rx frame = frame_with("X", "Float", 0.0, 1010 + i);
		memcpy(frame.data, patterns[i], 4);
		vehicle_feed(&vehicle, &frame);
		assert_int_equal(state_at(VEHICLE_YAW_RATE, 1010 + i), NAV_SIGNAL_IMPLAUSIBLE);
		assert_true(state.yaw_rate_rps == 0.25);
	}
	assert_int_equal(vehicle.inputs[VEHICLE_YAW_RATE].faults[VEHICLE_FAULT_NOT_A_NUMBER], 3);
}

static void a_jump_is_dropped_once_and_believed_when_it_stays(void **unused)
{
	(void)unused;
	config.inputs[VEHICLE_SPEED].max_rate = 20.0;
	feed("MOTION", "Speed", 36.0, 1000);
	feed("MOTION", "Speed", 180.0, 1020); /* 40 m/s in 20 ms */
	assert_int_equal(vehicle.inputs[VEHICLE_SPEED].fault, VEHICLE_FAULT_JUMP);
	feed("MOTION", "Speed", 36.5, 1040);
	assert_int_equal(state_at(VEHICLE_SPEED, 1040), NAV_SIGNAL_GOOD);
	feed("MOTION", "Speed", 180.0, 1060);
	feed("MOTION", "Speed", 180.5, 1080);
	assert_int_equal(state_at(VEHICLE_SPEED, 1080), NAV_SIGNAL_GOOD);
	assert_true(fabs(state.speed_mps - 180.5 / 3.6) < 1e-9);
	feed("MOTION", "Speed", 0.0, 2000); /* after a silence anything may be */
	assert_int_equal(state_at(VEHICLE_SPEED, 2000), NAV_SIGNAL_GOOD);
}

static void frames_that_waited_are_no_jumps(void **unused)
{
	(void)unused;
	struct vehicle_binding *speed = &config.inputs[VEHICLE_SPEED];
	speed->max_rate = 20.0;
	speed->quantum = 0.01;
	speed->spacing_ns = 20 * MS;
	for (int i = 0; i < 10; i++) { /* braking at 10 m/s^2, all delivered within 10 ms */
		feed("MOTION", "Speed", 72.0 - 0.72 * i, 1000 + i);
		assert_int_equal(vehicle.inputs[VEHICLE_SPEED].fault, VEHICLE_FAULT_NONE);
	}
	feed("MOTION", "Speed", 180.0, 1011);
	assert_int_equal(vehicle.inputs[VEHICLE_SPEED].fault, VEHICLE_FAULT_JUMP);
}

static struct can_frame_rx counted(double kmh, int count, int64_t time_ms)
{
	struct can_frame_rx frame = frame_with("MOTION", "Speed", kmh, time_ms);
	dbc_encode_raw(signal_of("MOTION", "Counter"), count, &frame);
	can_checksum_put(CAN_CHECKSUM_CRC8, signal_of("MOTION", "Checksum"), &frame);
	return frame;
}

static void guard_speed(void)
{
	struct vehicle_binding *binding = &config.inputs[VEHICLE_SPEED];
	binding->counter = signal_of("MOTION", "Counter");
	binding->counter_skip = 3;
	binding->checksum = signal_of("MOTION", "Checksum");
	binding->checksum_kind = CAN_CHECKSUM_CRC8;
}

static void counters_wrap_skip_a_little_and_tell_repeats(void **unused)
{
	(void)unused;
	guard_speed();
	static const struct {
		int count;
		int64_t time_ms;
		enum vehicle_fault fault;
	} steps[] = {
		{ 14, 1000, VEHICLE_FAULT_NONE },
		{ 15, 1020, VEHICLE_FAULT_NONE },
		{ 0, 1040, VEHICLE_FAULT_NONE }, /* wraps */
		{ 0, 1060, VEHICLE_FAULT_REPEATED },
		{ 1, 1080, VEHICLE_FAULT_NONE },
		{ 5, 1100, VEHICLE_FAULT_NONE },     /* three lost */
		{ 10, 1120, VEHICLE_FAULT_COUNTER }, /* four lost */
		{ 11, 1140, VEHICLE_FAULT_NONE },
		{ 10, 1160, VEHICLE_FAULT_COUNTER }, /* backwards */
		{ 11, 1180, VEHICLE_FAULT_NONE },
		{ 3, 2000, VEHICLE_FAULT_NONE }, /* learnt anew after a silence */
		{ 3, 2020, VEHICLE_FAULT_REPEATED },
	};
	for (size_t i = 0; i < sizeof(steps) / sizeof(*steps); i++) {
		struct can_frame_rx frame = counted(36.0, steps[i].count, steps[i].time_ms);
		vehicle_feed(&vehicle, &frame);
		assert_int_equal(vehicle.inputs[VEHICLE_SPEED].fault, steps[i].fault);
		assert_int_equal(
			state_at(VEHICLE_SPEED, steps[i].time_ms), steps[i].fault ? NAV_SIGNAL_IMPLAUSIBLE : NAV_SIGNAL_GOOD);
	}
}

static void a_frozen_sender_goes_from_implausible_to_unusable(void **unused)
{
	(void)unused;
	guard_speed();
	for (int64_t ms = 1000; ms <= 1200; ms += 20) {
		struct can_frame_rx frame = counted(36.0, 7, ms);
		vehicle_feed(&vehicle, &frame);
	}
	assert_int_equal(state_at(VEHICLE_SPEED, 1200), NAV_SIGNAL_IMPLAUSIBLE);
	assert_false(state.speed_usable);
	assert_true(state.age_ns[VEHICLE_SPEED] == 200 * MS);
}

static void a_damaged_frame_is_not_taken_whatever_bit_it_was(void **unused)
{
	(void)unused;
	guard_speed();
	struct can_frame_rx frame = counted(36.0, 0, 1000);
	vehicle_feed(&vehicle, &frame);
	for (int bit = 0; bit < 64; bit++) {
		frame = counted(72.0, 1, 1010);
		frame.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		vehicle_feed(&vehicle, &frame);
		assert_int_equal(vehicle.inputs[VEHICLE_SPEED].fault, VEHICLE_FAULT_CHECKSUM);
	}
	frame = counted(72.0, 1, 1020); /* and the counter was not led astray */
	vehicle_feed(&vehicle, &frame);
	assert_int_equal(state_at(VEHICLE_SPEED, 1020), NAV_SIGNAL_GOOD);
}

static void a_value_may_be_said_to_be_invalid_or_frozen(void **unused)
{
	(void)unused;
	bind_input(VEHICLE_LATITUDE, "GNSS_POSITION", "Latitude", 1.0)->valid = signal_of("GNSS_POSITION", "PositionValid");
	feed("GNSS_POSITION", "Latitude", 46.2, 1000);
	assert_int_equal(vehicle.inputs[VEHICLE_LATITUDE].fault, VEHICLE_FAULT_INVALID);
	config.inputs[VEHICLE_SPEED].frozen_ns = 50 * MS;
	for (int64_t ms = 1000; ms <= 1060; ms += 20)
		feed("MOTION", "Speed", 36.0, ms);
	assert_int_equal(vehicle.inputs[VEHICLE_SPEED].fault, VEHICLE_FAULT_FROZEN);
	feed("MOTION", "Speed", 36.1, 1080);
	assert_int_equal(vehicle.inputs[VEHICLE_SPEED].fault, VEHICLE_FAULT_NONE);
}

static void gear_and_lamps_are_looked_up_and_reverse_turns_the_sign(void **unused)
{
	(void)unused;
	struct vehicle_binding *gear = bind_input(VEHICLE_GEAR, "DRIVETRAIN", "Gear", 1.0);
	gear->map_count = 2;
	gear->map[0] = (struct vehicle_map){ 1, NAV_GEAR_REVERSE };
	gear->map[1] = (struct vehicle_map){ 3, NAV_GEAR_DRIVE };
	bind_input(VEHICLE_TURN_LEFT, "BODY", "LowBeam", 1.0);
	bind_input(VEHICLE_TURN_RIGHT, "BODY", "TurnLamp", 1.0);
	feed("DRIVETRAIN", "Gear", 1, 1000);
	feed("MOTION", "Speed", 7.2, 1000);
	assert_int_equal(state_at(VEHICLE_GEAR, 1000), NAV_SIGNAL_GOOD);
	assert_int_equal(state.gear, NAV_GEAR_REVERSE);
	assert_true(fabs(state.speed_mps + 2.0) < 1e-9);
	feed("DRIVETRAIN", "Gear", 7, 1020);
	assert_int_equal(state_at(VEHICLE_GEAR, 1020), NAV_SIGNAL_IMPLAUSIBLE);
	assert_int_equal(vehicle.inputs[VEHICLE_GEAR].fault, VEHICLE_FAULT_UNKNOWN);
	feed("DRIVETRAIN", "Gear", 3, 1040);
	assert_int_equal(state_at(VEHICLE_GEAR, 1040), NAV_SIGNAL_GOOD);
	assert_true(fabs(state.speed_mps - 2.0) < 1e-9);
	feed("BODY", "LowBeam", 1, 1040);
	assert_int_equal(state_at(VEHICLE_TURN_LAMP, 1040), NAV_SIGNAL_GOOD);
	assert_int_equal(state.turn_lamp, NAV_TURN_LAMP_LEFT);
	feed("BODY", "TurnLamp", 2, 1050);
	state_at(VEHICLE_TURN_LAMP, 1050);
	assert_int_equal(state.turn_lamp, NAV_TURN_LAMP_RIGHT);
	struct can_frame_rx both = frame_with("BODY", "TurnLamp", 2, 1060);
	dbc_encode(signal_of("BODY", "LowBeam"), 1, &both);
	vehicle_feed(&vehicle, &both);
	state_at(VEHICLE_TURN_LAMP, 1060);
	assert_int_equal(state.turn_lamp, NAV_TURN_LAMP_HAZARD);
}

static void the_yaw_rate_falls_back_to_steering_then_wheels(void **unused)
{
	(void)unused;
	const double degree = BLVD_PI / 180.0;
	bind_input(VEHICLE_YAW_RATE, "MOTION", "YawRate", -degree);
	bind_input(VEHICLE_STEERING, "STEERING", "SteeringAngle", -degree)->timeout_ns = 300 * MS;
	bind_input(VEHICLE_WHEEL_REAR_LEFT, "WHEELS", "WheelRearLeft", 1.0 / 3.6)->timeout_ns = 1000 * MS;
	bind_input(VEHICLE_WHEEL_REAR_RIGHT, "WHEELS", "WheelRearRight", 1.0 / 3.6)->timeout_ns = 1000 * MS;
	config.inputs[VEHICLE_SPEED].timeout_ns = 300 * MS;
	config.wheelbase_m = 2.7;
	config.steering_ratio = 15.0;
	config.track_m = 1.5;
	struct can_frame_rx motion = frame_with("MOTION", "Speed", 36.0, 1000);
	dbc_encode(signal_of("MOTION", "YawRate"), 10.0, &motion); /* left */
	vehicle_feed(&vehicle, &motion);
	feed("STEERING", "SteeringAngle", -90.0, 1000); /* right: 6 deg at the road wheels */
	struct can_frame_rx wheels = frame_with("WHEELS", "WheelRearLeft", 37.8, 1000);
	dbc_encode(signal_of("WHEELS", "WheelRearRight"), 36.0, &wheels);
	vehicle_feed(&vehicle, &wheels);
	state_at(0, 1000);
	assert_int_equal(state.yaw_source, VEHICLE_YAW_SENSOR);
	assert_true(fabs(state.yaw_rate_rps + 10.0 * degree) < 1e-9);
	state_at(0, 1200);
	assert_int_equal(state.yaw_source, VEHICLE_YAW_STEERING);
	assert_true(fabs(state.yaw_rate_rps - 10.0 * tan(6.0 * degree) / 2.7) < 1e-9);
	state_at(0, 1400);
	assert_int_equal(state.yaw_source, VEHICLE_YAW_WHEELS);
	assert_true(fabs(state.yaw_rate_rps - 0.5 / 1.5) < 1e-9);
	assert_true(state.speed_usable && fabs(state.speed_mps - 10.25) < 1e-9); /* the wheels' mean */
	assert_true(state.speed_age_ns == 400 * MS);
	state_at(0, 5000);
	assert_int_equal(state.yaw_source, VEHICLE_YAW_NONE);
	assert_true(state.yaw_rate_rps == 0.0);
}

static void a_fix_needs_both_coordinates_new(void **unused)
{
	(void)unused;
	bind_input(VEHICLE_LATITUDE, "GNSS_POSITION", "Latitude", 1.0);
	bind_input(VEHICLE_LONGITUDE, "GNSS_POSITION", "Longitude", 1.0)->max = 180.0;
	struct can_frame_rx frame = frame_with("GNSS_POSITION", "Latitude", 46.2, 1000);
	dbc_encode(signal_of("GNSS_POSITION", "Longitude"), 6.15, &frame);
	vehicle_feed(&vehicle, &frame);
	vehicle_sample(&vehicle, 1500 * MS, &state);
	assert_true(state.has_fix && state.fixes == 1 && state.fix_time_ns == 1000 * MS);
	assert_true(fabs(state.lat_deg - 46.2) < 1e-6 && fabs(state.lon_deg - 6.15) < 1e-6);
	frame.time_ns = 1200 * MS;
	dbc_encode(signal_of("GNSS_POSITION", "Longitude"), 200.0, &frame); /* not on earth */
	vehicle_feed(&vehicle, &frame);
	vehicle_sample(&vehicle, 1500 * MS, &state);
	assert_int_equal(state.fixes, 1);
	assert_true(fabs(state.lon_deg - 6.15) < 1e-6);
}

static void other_frames_are_passed_over(void **unused)
{
	(void)unused;
	bind_input(VEHICLE_AMBIENT, "X", "Paged", 1.0);
	config.inputs[VEHICLE_SPEED].bus = 1;
	struct can_frame_rx frame = frame_with("MOTION", "Speed", 36.0, 1000);
	vehicle_feed(&vehicle, &frame); /* bus 0 */
	frame.bus = 1;
	frame.flags = CAN_FRAME_REMOTE;
	vehicle_feed(&vehicle, &frame);
	frame.flags = CAN_FRAME_ERROR;
	vehicle_feed(&vehicle, &frame);
	frame.flags = CAN_FRAME_EXT;
	vehicle_feed(&vehicle, &frame);
	frame.flags = 0;
	frame.len = 1;
	vehicle_feed(&vehicle, &frame);
	feed("X", "Page", 2, 1000);
	assert_int_equal(state_at(VEHICLE_SPEED, 1000), NAV_SIGNAL_WAITING);
	assert_int_equal(state_at(VEHICLE_AMBIENT, 1000), NAV_SIGNAL_WAITING);
	assert_true(state.ambient < 0.0);
	assert_int_equal(vehicle.frames_used, 0);
	assert_int_equal(vehicle.frames_in, 6);
}

static void a_heading_jumps_over_north_without_fault(void **unused)
{
	(void)unused;
	struct vehicle_binding *binding = bind_input(VEHICLE_HEADING, "GNSS_MOTION", "Course", BLVD_PI / 180.0);
	binding->wraps = true;
	binding->turn = 2.0 * BLVD_PI;
	binding->max_rate = 1.0;
	feed("GNSS_MOTION", "Course", 359.0, 1000);
	feed("GNSS_MOTION", "Course", 1.0, 1050);
	assert_int_equal(state_at(VEHICLE_HEADING, 1050), NAV_SIGNAL_GOOD);
	feed("GNSS_MOTION", "Course", 181.0, 1100);
	assert_int_equal(state_at(VEHICLE_HEADING, 1100), NAV_SIGNAL_IMPLAUSIBLE);
	assert_true(fabs(state.heading_rad - BLVD_PI / 180.0) < 1e-9);
}

#define TEST(name) cmocka_unit_test_setup(name, set_up)

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_signal_waits_is_good_goes_stale_and_comes_back),
		TEST(time_that_steps_back_ages_nothing),
		TEST(out_of_range_is_a_state_while_the_last_good_value_holds),
		TEST(nan_and_infinity_are_not_taken),
		TEST(a_jump_is_dropped_once_and_believed_when_it_stays),
		TEST(frames_that_waited_are_no_jumps),
		TEST(counters_wrap_skip_a_little_and_tell_repeats),
		TEST(a_frozen_sender_goes_from_implausible_to_unusable),
		TEST(a_damaged_frame_is_not_taken_whatever_bit_it_was),
		TEST(a_value_may_be_said_to_be_invalid_or_frozen),
		TEST(gear_and_lamps_are_looked_up_and_reverse_turns_the_sign),
		TEST(the_yaw_rate_falls_back_to_steering_then_wheels),
		TEST(a_fix_needs_both_coordinates_new),
		TEST(other_frames_are_passed_over),
		TEST(a_heading_jumps_over_north_without_fault),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
