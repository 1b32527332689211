/* The live car on a local bus: what it says and when, what a listener makes of every fault, and that it can be driven.
 * The bus is real; time is not: frames are stamped with the simulation's. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <unistd.h>

#include <cmocka.h>

#include "board/car.h"
#include "nav/destination.h"
#include "platform/base/clock.h"
#include "tests/nav/streets.h"
#include "tools/sim/sim.h"

#define WALL_NS (INT64_C(1718958600) * NS_PER_S)
#define MEMORY ((size_t)24 << 20)

struct road {
	struct streets *streets;
	struct sim_options options;
	struct sim sim;
	struct sim_world world;
	struct fault_event last_event;
	char last_line[32];
	bool last_level;
	/* the listener */
	struct can_bus *sender, *listener;
	struct profile profile;
	struct car car;
	struct vehicle vehicle;
	struct vehicle_state state;
	struct destination destination;
	struct nav nav;
	uint64_t heard[0x800];
	uint8_t *memory;
	int64_t now_ns;
	uint64_t right, samples;
};

static void on_fault(void *context, const struct fault_event *event)
{
	((struct road *)context)->last_event = *event;
}

static void on_line(void *context, const char *name, bool on)
{
	struct road *road = context;
	snprintf(road->last_line, sizeof(road->last_line), "%s", name);
	road->last_level = on;
}

static void open_buses(struct road *road, struct arena *arena)
{
	char address[64];
	snprintf(address, sizeof(address), "vcan0=unix:@blvd-test-sim-%d", (int)getpid());
	const char *names[] = { address };
	const struct can_bus_config config = { .interfaces = names, .interface_count = 1 };
	assert_int_equal(can_bus_open(&road->listener, &can_socket_ops, &config, arena), 0);
	assert_int_equal(can_bus_open(&road->sender, &can_socket_ops, &config, arena), 0);
}

static void begin(struct road *road, bool by_hand)
{
	struct arena arena;
	memset(road, 0, sizeof(*road));
	road->streets = streets_grid(5, 150);
	const struct pkg *pkg = streets_finish(road->streets, true);
	road->memory = malloc(MEMORY);
	assert_non_null(road->memory);
	arena_init(&arena, "road", road->memory, MEMORY);
	road->options = (struct sim_options){ .drive = { .seed = 4,
											  .gnss = true,
											  .minutes = 3.0,
											  .wall_ns = WALL_NS,
											  .speed_error = NAN,
											  .yaw_bias_rps = NAN },
		.by_hand = by_hand,
		.factor = 1.0 };
	assert_int_equal(sim_init(&road->sim, &arena, pkg, &road->options), 0);
	road->world = (struct sim_world){ .line = on_line, .fault = on_fault, .context = road };
	assert_int_equal(profile_load(&road->profile, NULL, &arena), 0);
	assert_int_equal(car_init(&road->car, &road->profile, NULL, 0, NULL, 0, &arena), 0);
	vehicle_init(&road->vehicle, &road->car.vehicle);
	destination_init(&road->destination, road->car.destination);
	assert_int_equal(nav_init(&road->nav, &arena, pkg, &(struct nav_config){ .seed = 1 }), 0);
	open_buses(road, &arena);
}

static void end(struct road *road)
{
	can_bus_close(road->sender);
	can_bus_close(road->listener);
	sim_finish(&road->sim);
	free(road->memory);
	free(road->streets);
}

static void listen(struct road *road)
{
	struct can_frame_rx frames[32];
	int count = can_bus_read(road->listener, INT64_MAX, frames, 32);
	for (int i = 0; i < count; i++) {
		frames[i].time_ns = road->now_ns;
		if (!(frames[i].flags & CAN_FRAME_ERROR))
			road->heard[frames[i].id & 0x7FF]++;
		vehicle_feed(&road->vehicle, &frames[i]);
		if (destination_feed(&road->destination, &frames[i]) && road->destination.stop_count)
			assert_true(nav_set_stops(&road->nav, road->destination.stops, road->destination.stop_count));
	}
}

static void go(struct road *road, double seconds)
{
	for (int64_t until = road->now_ns + (int64_t)(seconds * 1e9); road->now_ns < until;) {
		sim_tick(&road->sim, WALL_NS + road->now_ns, &road->world);
		for (unsigned i = 0; i < road->sim.frame_count; i++) {
			assert_true(road->sim.frames[i].time_ns >= WALL_NS + road->now_ns &&
						road->sim.frames[i].time_ns < WALL_NS + road->now_ns + BUS_TICK_NS);
			road->sim.frames[i].bus = 0;
			assert_int_equal(can_bus_write(road->sender, &road->sim.frames[i]), 0);
		}
		listen(road);
		road->now_ns += BUS_TICK_NS;
		vehicle_sample(&road->vehicle, road->now_ns, &road->state);
		nav_update(&road->nav, &road->state, road->now_ns, WALL_NS + road->now_ns, NULL);
		road->right += road->nav.match.half >> 1 == road->sim.state.half >> 1;
		road->samples++;
	}
}

static void messages_come_at_their_cycle_times(void **state)
{
	(void)state;
	struct road road;
	begin(&road, false);
	go(&road, 20.0);
	const struct dbc *dbc = bus_dbc(road.sim.bus);
	unsigned checked = 0;
	for (const struct dbc_message *message = dbc->messages; message; message = message->next) {
		uint64_t wanted = message->cycle_ms ? 20000 / message->cycle_ms : 0;
		if (!strcmp(message->name, "DESTINATION"))
			wanted += 12; /* quicker in the first seconds */
		assert_in_range(road.heard[message->id], wanted - (wanted > 0), wanted + 1);
		checked += wanted > 0;
	}
	assert_int_equal(checked, 11);
	end(&road);
}

static void the_car_is_followed_along_its_route(void **state)
{
	(void)state;
	struct road road;
	begin(&road, false);
	while (!road.sim.ended)
		go(&road, 1.0);
	assert_true(road.nav.match.located);
	assert_true(road.right * 100 > road.samples * 95);
	assert_true(road.sim.state.odometer_m > 300.0);
	end(&road);
}

static void twice_as_fast_is_twice_the_speed(void **state)
{
	(void)state;
	double fastest[2] = { 0 }, way[2] = { 0 };
	for (int twice = 0; twice < 2; twice++) {
		struct road road;
		begin(&road, false);
		road.sim.factor = 1.0 + twice;
		for (int i = 0; i < 300 / (1 + twice); i++) {
			go(&road, 0.1);
			fastest[twice] = fmax(fastest[twice], road.state.speed_mps);
		}
		way[twice] = road.sim.state.odometer_m;
		end(&road);
	}
	assert_near(fastest[1], 2.0 * fastest[0], 0.2);
	assert_near(way[1], way[0], 2.0);
}

/* --- faults --- */

#define HOLDS (-1) /* the value goes on */

static const struct fault_case {
	const char *text;
	int input; /* that is looked at */
	enum nav_signal_state state;
	int fault;      /* enum vehicle_fault, or HOLDS */
	double after_s; /* until it shows */
	bool ages;      /* its age grows from the beginning of the fault on */
} fault_cases[] = {
	{ "lost:speed/4", VEHICLE_SPEED, NAV_SIGNAL_STALE, HOLDS, 0.25, true },
	{ "lost:MOTION/4", VEHICLE_YAW_RATE, NAV_SIGNAL_STALE, HOLDS, 0.25, true },
	{ "lost:steering/4", VEHICLE_STEERING, NAV_SIGNAL_STALE, HOLDS, 0.25, true },
	{ "lost:gear/4", VEHICLE_GEAR, NAV_SIGNAL_STALE, HOLDS, 0.6, true },
	{ "lost:gnss/4", VEHICLE_LATITUDE, NAV_SIGNAL_STALE, HOLDS, 1.3, true },
	{ "lost:wheels/4", VEHICLE_WHEEL_REAR_LEFT, NAV_SIGNAL_STALE, HOLDS, 0.25, true },
	{ "lost:odometer/4", VEHICLE_ODOMETER, NAV_SIGNAL_STALE, HOLDS, 1.3, true },
	{ "stuck:yaw_rate/8", VEHICLE_YAW_RATE, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_FROZEN, 3.5, false },
	{ "noisy:speed/4", VEHICLE_SPEED, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_JUMP, 3.0, false },
	{ "range:speed/4", VEHICLE_SPEED, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_RANGE, 0.1, true },
	{ "range:yaw_rate/4", VEHICLE_YAW_RATE, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_RANGE, 0.1, true },
	{ "range:steering/4", VEHICLE_STEERING, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_RANGE, 0.1, true },
	{ "range:gear/4", VEHICLE_GEAR, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_UNKNOWN, 0.3, true },
	{ "range:ambient/4", VEHICLE_AMBIENT, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_RANGE, 0.3, true },
	{ "counter:speed/4", VEHICLE_SPEED, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_REPEATED, 0.1, true },
	{ "counter:gear/4", VEHICLE_GEAR, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_REPEATED, 0.3, true },
	{ "checksum:speed/4", VEHICLE_SPEED, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_CHECKSUM, 0.1, true },
	{ "checksum:steering/4", VEHICLE_STEERING, NAV_SIGNAL_IMPLAUSIBLE, VEHICLE_FAULT_CHECKSUM, 0.1, true },
	{ "busoff/4", VEHICLE_SPEED, NAV_SIGNAL_STALE, HOLDS, 0.25, true },
	{ "lost:all/4", VEHICLE_SPEED, NAV_SIGNAL_STALE, HOLDS, 0.25, true },
};

static bool shows(struct road *road, const struct fault_case *c, double within_s)
{
	for (double s = 0.0; s < within_s; s += 0.01) {
		go(road, 0.01);
		if (road->state.state[c->input] == c->state &&
			(c->fault == HOLDS || road->vehicle.inputs[c->input].fault == (enum vehicle_fault)c->fault))
			return true;
	}
	return false;
}

static void every_fault_shows_as_a_state_with_an_age_and_passes(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(fault_cases) / sizeof(fault_cases[0]); i++) {
		const struct fault_case *c = &fault_cases[i];
		struct road road;
		begin(&road, false);
		go(&road, 14.0); /* on its way */
		assert_int_equal(road.state.state[c->input], NAV_SIGNAL_GOOD);
		assert_null(sim_say(&road.sim, &road.world, c->text));
		double began = road.sim.time_s;
		if (!shows(&road, c, c->after_s + 0.02))
			fail_msg("%s does not show within %g s: state %d, fault %s", c->text, c->after_s,
				road.state.state[c->input], vehicle_fault_name(road.vehicle.inputs[c->input].fault));
		go(&road, began + 3.9 - road.sim.time_s);
		double age = (double)road.state.age_ns[c->input] * 1e-9;
		if (c->ages && !(age > 3.5 && age < 4.5))
			fail_msg("%s: its age is %g s after 3.9 s", c->text, age);
		assert_true(isfinite(road.state.speed_mps) && fabs(road.state.speed_mps) < 60.0);
		go(&road, 6.0);
		if (road.state.state[c->input] != NAV_SIGNAL_GOOD)
			fail_msg("%s does not pass", c->text);
		end(&road);
	}
}

static void a_bus_that_is_off_says_so_and_comes_back(void **state)
{
	(void)state;
	struct road road;
	begin(&road, false);
	go(&road, 1.0);
	uint64_t before = road.vehicle.frames_in;
	assert_null(faults_script(&road.sim.faults, "2.5:busoff/2"));
	go(&road, 2.0);
	assert_int_equal(road.listener->interfaces[0].health, CAN_HEALTH_OFF);
	assert_int_equal(road.listener->interfaces[0].error_frames, 2);
	assert_true(road.vehicle.frames_in > before);
	before = road.vehicle.frames_in;
	go(&road, 1.0);
	assert_int_equal(road.vehicle.frames_in, before); /* silence */
	go(&road, 1.0);
	assert_int_not_equal(road.listener->interfaces[0].health, CAN_HEALTH_OFF);
	assert_int_equal(road.state.state[VEHICLE_SPEED], NAV_SIGNAL_GOOD);
	end(&road);
}

static void clock_camera_and_lines_are_told_to_the_world(void **state)
{
	(void)state;
	struct road road;
	begin(&road, true);
	go(&road, 0.5);
	assert_null(sim_say(&road.sim, &road.world, "clock -31536000"));
	go(&road, 0.5);
	assert_true(road.sim.clock_s == -31536000.0);
	assert_int_equal(road.last_event.kind, FAULT_CLOCK);
	assert_int_equal(road.state.state[VEHICLE_SPEED], NAV_SIGNAL_GOOD); /* and the car does not care */
	assert_null(sim_say(&road.sim, &road.world, "camera frozen 2"));
	go(&road, 0.1);
	assert_int_equal(road.last_event.kind, FAULT_CAMERA);
	assert_string_equal(road.last_event.target, "frozen");
	assert_true(road.last_event.begins && road.last_event.seconds == 2.0);
	assert_null(sim_say(&road.sim, &road.world, "chatter:reverse/1"));
	go(&road, 2.5);
	assert_int_equal(road.last_event.kind, FAULT_CAMERA); /* the last to end */
	assert_false(road.last_event.begins);
	assert_null(sim_say(&road.sim, &road.world, "line push 1"));
	assert_string_equal(road.last_line, "push");
	assert_null(sim_say(&road.sim, &road.world, "gear R"));
	go(&road, 0.1);
	assert_string_equal(road.last_line, "reverse");
	assert_true(road.last_level);
	end(&road);
}

static void two_faults_at_once_and_clearing_one(void **state)
{
	(void)state;
	struct road road;
	char words[120];
	begin(&road, false);
	go(&road, 5.0);
	assert_null(sim_say(&road.sim, &road.world, "lost gear"));
	assert_null(sim_say(&road.sim, &road.world, "checksum speed"));
	go(&road, 2.0);
	faults_describe(&road.sim.faults, road.sim.time_s, words, sizeof(words));
	assert_string_equal(words, "lost gear 2 s, checksum speed 2 s");
	assert_int_equal(road.state.state[VEHICLE_GEAR], NAV_SIGNAL_STALE);
	assert_null(sim_say(&road.sim, &road.world, "clear gear"));
	go(&road, 1.0);
	assert_int_equal(road.state.state[VEHICLE_GEAR], NAV_SIGNAL_GOOD);
	assert_int_equal(road.state.state[VEHICLE_SPEED], NAV_SIGNAL_IMPLAUSIBLE);
	assert_null(sim_say(&road.sim, &road.world, "clear"));
	go(&road, 1.0);
	assert_int_equal(road.state.state[VEHICLE_SPEED], NAV_SIGNAL_GOOD);
	assert_int_equal(road.sim.faults.count, 0);
	end(&road);
}

/* --- by hand --- */

static void a_driver_drives(void **state)
{
	(void)state;
	struct road road;
	begin(&road, true);
	go(&road, 1.0);
	assert_int_equal(road.state.gear, NAV_GEAR_PARK);
	assert_true(road.state.has_fix && road.nav.match.located);
	assert_null(sim_say(&road.sim, &road.world, "speed 36"));
	go(&road, 8.0);
	assert_int_equal(road.state.gear, NAV_GEAR_DRIVE);
	assert_near(road.state.speed_mps, 10.0, 0.2);
	double heading = road.sim.state.heading_rad;
	assert_null(sim_say(&road.sim, &road.world, "steer 60"));
	go(&road, 2.0);
	assert_true(road.sim.state.heading_rad > heading + 0.2); /* clockwise */
	assert_true(road.state.yaw_rate_rps > 0.1);
	assert_null(sim_say(&road.sim, &road.world, "steer 0"));
	assert_null(sim_say(&road.sim, &road.world, "lamp hazard"));
	assert_null(sim_say(&road.sim, &road.world, "gear R")); /* brakes first */
	go(&road, 0.5);
	assert_true(road.state.speed_mps > 5.0);
	go(&road, 4.0);
	assert_int_equal(road.state.gear, NAV_GEAR_REVERSE);
	assert_int_equal(road.state.turn_lamp, NAV_TURN_LAMP_HAZARD);
	assert_null(sim_say(&road.sim, &road.world, "faster"));
	go(&road, 3.0);
	assert_near(road.state.speed_mps, -5.0 / 3.6, 0.1);
	assert_null(sim_say(&road.sim, &road.world, "gear P"));
	go(&road, 3.0);
	assert_int_equal(road.state.gear, NAV_GEAR_PARK);
	assert_near(road.state.speed_mps, 0.0, 0.01);
	end(&road);
}

static void the_wheel_can_be_taken_on_the_route(void **state)
{
	(void)state;
	struct road road;
	begin(&road, false);
	go(&road, 12.0);
	struct dvec3 at = road.sim.state.at;
	double speed = road.sim.state.speed_mps;
	assert_true(speed > 3.0);
	assert_null(sim_say(&road.sim, &road.world, "right"));
	go(&road, 0.05);
	assert_true(road.sim.by_hand);
	assert_near(hypot(road.sim.state.at.x - at.x, road.sim.state.at.y - at.y), speed * 0.05, 0.3);
	assert_near(road.state.speed_mps, speed, 0.5);
	end(&road);
}

static void the_ignition_is_said_and_then_the_bus_sleeps(void **state)
{
	(void)state;
	struct road road;
	begin(&road, true);
	go(&road, 1.0);
	assert_int_equal(road.state.ignition, VEHICLE_IGNITION_ON);
	assert_null(sim_say(&road.sim, &road.world, "ignition off"));
	go(&road, 1.0);
	assert_int_equal(road.state.ignition, VEHICLE_IGNITION_OFF);
	go(&road, 4.0);
	uint64_t heard = road.vehicle.frames_in;
	go(&road, 5.0);
	assert_int_equal(road.vehicle.frames_in, heard);
	assert_null(sim_say(&road.sim, &road.world, "ignition"));
	go(&road, 0.5);
	assert_int_equal(road.state.ignition, VEHICLE_IGNITION_ON);
	end(&road);
}

static void wrong_commands_are_told_and_change_nothing(void **state)
{
	(void)state;
	static const char endless[] =
		"a line that is longer than any command has ever been or will ever be, and that goes on and on and on, as if "
		"somebody had leant on the keyboard for a while, and then some more";
	static const char *const wrong[] = { "fly", "gear", "gear X", "gear PD", "speed", "speed fast", "speed -3",
		"speed 1e9", "steer nan", "lamp up", "lamp", "ignition maybe", "light 101", "light", "factor 9", "line",
		"line push", "line push 2", "lost", "lost:nothing", "lost:MOTION.Nothing", "lost:speed/0", "lost:speed/-1",
		"lost:speed/x", "stuck:wheels", "stuck:MOTION", "noisy:gnss", "range:all", "counter:wheels", "checksum:body",
		"clock", "clock:soon", "camera", "chatter", "busoff/x",
		"lost:a_name_that_is_longer_than_any_name_of_a_target_can_be_in_any_file", endless };
	struct road road;
	begin(&road, true);
	go(&road, 0.1);
	struct hand before = road.sim.hand;
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		if (!sim_say(&road.sim, &road.world, wrong[i]))
			fail_msg("'%s' was taken", wrong[i]);
	assert_memory_equal(&before, &road.sim.hand, sizeof(before));
	assert_int_equal(road.sim.faults.count, 0);
	assert_null(sim_say(&road.sim, &road.world, ""));
	assert_null(sim_say(&road.sim, &road.world, "# a comment"));
	for (int i = 0; i < FAULTS_MAX; i++)
		assert_null(sim_say(&road.sim, &road.world, "lost gear"));
	assert_non_null(sim_say(&road.sim, &road.world, "lost gear"));
	assert_non_null(faults_script(&road.sim.faults, "soon:lost:speed"));
	assert_non_null(faults_script(&road.sim.faults, "-1:lost:speed"));
	assert_null(sim_say(&road.sim, &road.world, "quit"));
	assert_true(road.sim.quit);
	end(&road);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(messages_come_at_their_cycle_times),
		cmocka_unit_test(the_car_is_followed_along_its_route),
		cmocka_unit_test(twice_as_fast_is_twice_the_speed),
		cmocka_unit_test(every_fault_shows_as_a_state_with_an_age_and_passes),
		cmocka_unit_test(a_bus_that_is_off_says_so_and_comes_back),
		cmocka_unit_test(clock_camera_and_lines_are_told_to_the_world),
		cmocka_unit_test(two_faults_at_once_and_clearing_one),
		cmocka_unit_test(a_driver_drives),
		cmocka_unit_test(the_wheel_can_be_taken_on_the_route),
		cmocka_unit_test(the_ignition_is_said_and_then_the_bus_sleeps),
		cmocka_unit_test(wrong_commands_are_told_and_change_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
