/* Profiles: the built-in one, every kind of wrong line, and the names made into definitions. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "board/car.h"
#include "board/profile_sim.h"
#include "platform/base/log.h"
#include "platform/base/rng.h"
#include "platform/base/vec.h"

static _Alignas(64) uint8_t memory[1 << 20];
static struct arena arena;
static struct profile profile;
static struct profile_error error;
static struct car car;

static int parse(const char *path, const char *text)
{
	arena_init(&arena, "test", memory, sizeof(memory));
	return profile_parse(&profile, path, text, strlen(text), &arena, &error);
}

static void the_built_in_profile_describes_the_virtual_car(void **state)
{
	(void)state;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(profile_load(&profile, NULL, &arena), 0);
	assert_int_equal(profile.warnings, 0);
	assert_int_equal(profile.width, 1280);
	assert_int_equal(profile.budget_bytes, UINT64_C(512) << 20);
	assert_false(profile.has_start);
	assert_int_equal(car_init(&car, &profile, NULL, 0, NULL, 0, &arena), 0);
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++)
		assert_int_equal(car.vehicle.inputs[i].signal != NULL, i != VEHICLE_TURN_LEFT && i != VEHICLE_TURN_RIGHT);
	const struct vehicle_binding *yaw = &car.vehicle.inputs[VEHICLE_YAW_RATE];
	assert_true(fabs(yaw->scale + BLVD_PI / 180.0) < 1e-12);
	assert_int_equal(yaw->timeout_ns, 200000000);
	assert_string_equal(yaw->counter->name, "Counter");
	assert_int_equal(yaw->counter_skip, 7);
	assert_int_equal(yaw->checksum_kind, CAN_CHECKSUM_CRC8);
	assert_int_equal(car.vehicle.inputs[VEHICLE_LATITUDE].timeout_ns, 1000000000);
	assert_int_equal(car.vehicle.inputs[VEHICLE_GEAR].map_count, 4);
	assert_int_equal(car.vehicle.inputs[VEHICLE_TURN_LAMP].map_count, 4);
	assert_int_equal(car.vehicle.inputs[VEHICLE_IGNITION].map_count, 4);
	assert_int_equal(car.filter_count, 10); /* nine messages with inputs, and the destination */
	assert_ptr_equal(car.destination, &car.dbc[0]);
	assert_int_equal(car.interface_count, 1);
	assert_string_equal(car.interfaces[0], "vcan0");
}

static void every_key_is_taken(void **state)
{
	(void)state;
	assert_int_equal(
		parse("/etc/boulevard/my.ini",
			"# comment\n[display]\nwidth=800\n  height = 480 ; inline\nfps = 30\nmsaa = 0\nstyle = night\n"
			"units = imperial\n[memory]\nbudget_mib = 96\n[start]\nlatitude = 46.2\nlongitude = 6.15\nheading_deg = "
			"90\n"
			"[car]\nspeed_signed = yes\nsteering_centre_deg = -1.5\n[can]\ndbc = a.dbc, /b.dbc builtin:boulevard\n"
			"interfaces = can0 can1\n[power]\noff = end\noff_after_s = 1.5\n[signals]\n"
			"speed = M.S bus=can1 unit=mph scale=2 offset=-1 sign=-1 timeout=0.5 frozen=3 min=-5 max=90 max_rate=7 "
			"counter=C counter_skip=2 checksum=K:sum valid=V\n"
			"gear = G map=0:park,0x10:drive\n"),
		0);
	assert_int_equal(profile.warnings, 0);
	assert_int_equal(profile.width, 800);
	assert_int_equal(profile.height, 480);
	assert_int_equal(profile.samples, 0);
	assert_int_equal(profile.style, PROFILE_STYLE_NIGHT);
	assert_int_equal(profile.units, PROFILE_UNITS_IMPERIAL);
	assert_int_equal(profile.budget_bytes, UINT64_C(96) << 20);
	assert_true(profile.has_start && profile.has_heading && profile.start.lat_deg == 46.2);
	assert_true(profile.speed_signed && profile.steering_centre_deg == -1.5);
	assert_int_equal(profile.dbc_count, 3);
	assert_string_equal(profile.dbc[0], "/etc/boulevard/a.dbc");
	assert_string_equal(profile.dbc[1], "/b.dbc");
	assert_string_equal(profile.dbc[2], PROFILE_DBC_BUILTIN);
	assert_string_equal(profile.interfaces[1], "can1");
	const struct profile_signal *speed = &profile.signals[VEHICLE_SPEED];
	assert_int_equal(speed->line, 25);
	assert_string_equal(speed->message, "M");
	assert_string_equal(speed->name, "S");
	assert_string_equal(speed->unit, "mph");
	assert_true(speed->scale == 2 && speed->offset == -1 && speed->sign == -1 && speed->timeout_s == 0.5);
	assert_true(speed->frozen_s == 3 && speed->min == -5 && speed->max == 90 && speed->max_rate == 7);
	assert_int_equal(speed->counter_skip, 2);
	assert_string_equal(speed->checksum, "K");
	assert_true(profile.power.ends && profile.power.off_after_ns == 1500000000);
	const struct profile_signal *gear = &profile.signals[VEHICLE_GEAR];
	assert_null(gear->message);
	assert_int_equal(gear->map[1].raw, 16);
	assert_string_equal(gear->map[1].meaning, "drive");
}

static void unknown_keys_are_warnings(void **state)
{
	(void)state;
	assert_int_equal(parse(NULL, "[display]\ncolour = red\n[gpio]\nknob = 17\n[signals]\nsped = M.S\n"), 0);
	assert_int_equal(profile.warnings, 3);
}

static const struct fault_case {
	const char *text;
	unsigned line;
	const char *says;
} parse_faults[] = {
	{ "[display]\nwidth = wide\n", 2, "width is 'wide'" },
	{ "[display]\nwidth = 10\n", 2, "64 to 8192" },
	{ "[display]\nwidth = 100.5\n", 2, "whole number" },
	{ "[display]\nwidth = nan\n", 2, "whole number" },
	{ "[display]\n\n\nfps = 0\n", 4, "1 to 240" },
	{ "[display]\nstyle = dawn\n", 2, "auto, day, dusk, night" },
	{ "[display]\nunits =\n", 2, "metric, imperial" },
	{ "[memory]\nbudget_mib = 1e99\n", 2, "16 to 65536" },
	{ "[car]\nspeed_signed = maybe\n", 2, "yes or no" },
	{ "[start]\nlatitude = 91\n", 2, "-90 to 90" },
	{ "[obd]\nrate_hz = 0\n", 2, "0.1 to 20" },
	{ "[obd]\naddressing = 12bit\n", 2, "auto, 11bit, 29bit" },
	{ "[display]\nwidth\n", 2, "neither" },
	{ "[display\nwidth = 100\n", 1, "neither" },
	{ "[can]\ninterfaces = a_name_that_is_too_long\n", 2, "longer than 15" },
	{ "[can]\ndbc = 1 2 3 4 5 6 7 8 9\n", 2, "more than 8" },
	{ "[signals]\nspeed =\n", 2, "Message.Signal" },
	{ "[signals]\nspeed = M.S fast\n", 2, "option=value" },
	{ "[signals]\nspeed = M.S colour=red\n", 2, "no option 'colour'" },
	{ "[signals]\nspeed = M.S scale=0\n", 2, "scale is 0" },
	{ "[signals]\nspeed = M.S timeout=0\n", 2, "timeout is '0'" },
	{ "[signals]\nspeed = M.S min=5 max=4\n", 2, "min is greater" },
	{ "[signals]\nspeed = M.S checksum=C\n", 2, "SIGNAL:KIND" },
	{ "[signals]\nspeed = M.S checksum=C:md5\n", 2, "SIGNAL:KIND" },
	{ "[signals]\nspeed = M.S counter=C counter_skip=-1\n", 2, "counter_skip" },
	{ "[signals]\ngear = M.S map=1\n", 2, "number:meaning" },
	{ "[signals]\ngear = M.S map=a:park\n", 2, "whole number" },
	{ "[signals]\nspeed = M.S\nspeed = M.T\n", 3, "in line 2" },
};

static void wrong_lines_are_named(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(parse_faults) / sizeof(*parse_faults); i++) {
		assert_int_equal(parse("x.ini", parse_faults[i].text), -EINVAL);
		if (error.line != parse_faults[i].line || !strstr(error.text, parse_faults[i].says))
			fail_msg("case %zu: line %u: %s", i, error.line, error.text);
	}
	char text[1000] = "[can]\ndbc = ";
	memset(text + strlen(text), 'a', 300);
	assert_int_equal(parse(NULL, text), -EINVAL);
	assert_int_equal(error.line, 2);
	assert_non_null(strstr(error.text, "longer than"));
	text[0] = '#';
	text[5] = ' ';
	assert_int_equal(parse(NULL, text), 0); /* a long comment is fine */
	assert_int_equal(profile_parse(&profile, NULL, "a\0b", 3, &arena, &error), -EINVAL);
	arena_init(&arena, "small", memory, 16);
	assert_int_equal(profile_parse(&profile, NULL, profile_sim_text, profile_sim_size, &arena, &error), -ENOMEM);
}

#define CAN "[can]\ndbc = builtin:boulevard\ninterfaces = can0\n[signals]\n"

static const struct fault_case car_faults[] = {
	{ CAN "speed = MOTION.Sped\n", 5, "no signal 'MOTION.Sped'" },
	{ CAN "\nspeed = MOTON.Speed\n", 6, "no message 'MOTON'" },
	{ CAN "speed = Nowhere\n", 5, "no signal 'Nowhere'" },
	{ CAN "speed = MOTION.YawRate\n", 5, "unit 'deg/s'" },
	{ CAN "speed = MOTION.Speed unit=furlong\n", 5, "unit 'furlong'" },
	{ CAN "speed = MOTION.Speed bus=can7\n", 5, "bus 'can7'" },
	{ CAN "speed = MOTION.Speed counter=Gear\n", 5, "no signal 'Gear'" },
	{ CAN "gear = MOTION.Speed\n", 5, "no value table" },
	{ CAN "gear = DRIVETRAIN.Gear map=0:up\n", 5, "'up' is no gear" },
	{ CAN "speed = MOTION.Speed\n[obd]\ninterface = can0\n", 7, "nothing to ask for" },
	{ CAN "speed = MOTION.Speed\n[obd]\nrate_hz = 2\ninterface = can1\n", 8, "interface 'can1'" },
	{ "[can]\ndbc = /nonexistent.dbc\n", 0, "/nonexistent.dbc: No such file" },
	{ "[can]\ndbc = /tmp\n", 0, "/tmp: Is a directory" },
	{ "[can]\ndbc = /dev/null\n", 0, "/dev/null:0: no message" },
};

/* What went to stderr during a call. */
static int init_and_listen(char *said, size_t size)
{
	FILE *file = tmpfile();
	assert_non_null(file);
	fflush(stderr);
	int old = dup(STDERR_FILENO);
	assert_true(old >= 0 && dup2(fileno(file), STDERR_FILENO) >= 0);
	int status = car_init(&car, &profile, NULL, 0, NULL, 0, &arena);
	assert_true(dup2(old, STDERR_FILENO) >= 0);
	close(old);
	rewind(file);
	size_t n = fread(said, 1, size - 1, file);
	said[n] = 0;
	fclose(file);
	return status;
}

static void names_that_lead_nowhere_are_named(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(car_faults) / sizeof(*car_faults); i++) {
		char said[1000], place[40];
		assert_int_equal(parse("my.ini", car_faults[i].text), 0);
		assert_true(init_and_listen(said, sizeof(said)) < 0);
		snprintf(place, sizeof(place), "my.ini:%u: ", car_faults[i].line);
		if (!strstr(said, car_faults[i].says) || (car_faults[i].line && !strstr(said, place)))
			fail_msg("case %zu: %s", i, said);
		assert_ptr_equal(strchr(said, '\n') + 1, said + strlen(said)); /* one line */
	}
}

static void options_replace_definitions_and_interfaces(void **state)
{
	(void)state;
	static const char *const dbc[] = { PROFILE_DBC_BUILTIN };
	static const char *const interfaces[] = { "slcan0" };
	assert_int_equal(parse(NULL, "[can]\ndbc = /nonexistent.dbc\ninterfaces = can0 can1\n[signals]\n"
								 "speed = MOTION.Speed bus=can0\nyaw_rate = MOTION.YawRate bus=can1\n"),
		0);
	assert_int_equal(car_init(&car, &profile, dbc, 1, interfaces, 1, &arena), 0);
	assert_string_equal(car.interfaces[0], "slcan0");
	assert_string_equal(car.interfaces[1], "can1");
	assert_int_equal(car.vehicle.inputs[VEHICLE_SPEED].bus, 0);
	assert_int_equal(car.vehicle.inputs[VEHICLE_YAW_RATE].bus, 1);
	assert_int_equal(car.filter_count, 2); /* MOTION and DESTINATION */
}

static void a_car_is_asked_for_what_the_signals_need(void **state)
{
	(void)state;
	assert_int_equal(
		parse(NULL, "[can]\ndbc = builtin:boulevard builtin:obd2\ninterfaces = can0 car=unix:/run/car.sock\n"
					"[obd]\ninterface = car\naddressing = 29bit\n"
					"[signals]\nspeed = OBD2.VehicleSpeed bus=car\nodometer = OBD2.Odometer\ngear = "
					"DRIVETRAIN.Gear\n"),
		0);
	assert_int_equal(car_init(&car, &profile, NULL, 0, NULL, 0, &arena), 0);
	assert_int_equal(car.obd.bus, 1);
	assert_int_equal(car.obd.pid_count, 2);
	assert_int_equal(car.obd.pids[0], 0x0D);
	assert_int_equal(car.obd.pids[1], 0xA6);
	assert_true(car.obd.rate_hz == 5.0 && car.obd.addressing == OBD_ADDRESSING_29);
	assert_int_equal(car.vehicle.inputs[VEHICLE_SPEED].bus, 1);
	assert_int_equal(parse(NULL, CAN "speed = MOTION.Speed\n"), 0);
	assert_int_equal(car_init(&car, &profile, NULL, 0, NULL, 0, &arena), 0);
	assert_int_equal(car.obd.pid_count, 0); /* without the section nothing is ever asked */
}

static void limits_and_units_go_together(void **state)
{
	(void)state;
	assert_int_equal(
		parse(NULL, CAN "speed = MOTION.Speed max=180 max_rate=36 offset=3.6\nambient = BODY.AmbientLight\n"), 0);
	assert_int_equal(car_init(&car, &profile, NULL, 0, NULL, 0, &arena), 0);
	const struct vehicle_binding *speed = &car.vehicle.inputs[VEHICLE_SPEED];
	assert_true(fabs(speed->max - 50.0) < 1e-9 && fabs(speed->max_rate - 10.0) < 1e-9);
	assert_true(fabs(speed->offset - 1.0) < 1e-9 && speed->min == -30.0);
	assert_true(fabs(car.vehicle.inputs[VEHICLE_AMBIENT].scale - 0.01) < 1e-12);
}

/* Read without a warning, and no pin is two things. */
static void the_boards_profiles_have_no_fault(void **state)
{
	(void)state;
	static const char *const paths[] = { "board/profiles/raspberrypi.ini", "board/profiles/imx8m.ini",
		"board/profiles/am62x.ini", "board/profiles/emulator.ini", "board/profiles/obd.ini" };
	for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++) {
		arena_init(&arena, "test", memory, sizeof(memory));
		assert_int_equal(profile_load(&profile, paths[i], &arena), 0);
		assert_int_equal(profile.warnings, 0);
		assert_int_equal(car_init(&car, &profile, NULL, 0, NULL, 0, &arena), 0);
		const struct profile_line *lines = profile.gpio.lines;
		for (int a = 0; a < CONTROL_LINE_COUNT; a++)
			for (int b = 0; b < a; b++)
				assert_false(lines[a].at.chip && lines[b].at.chip && lines[a].at.offset == lines[b].at.offset &&
							 !strcmp(lines[a].at.chip, lines[b].at.chip));
	}
}

static void damaged_profiles_never_crash(void **state)
{
	(void)state;
	static char text[8192];
	struct rng rng = rng_seed(13);
	log_init("test", LOG_ERROR); /* every unknown key is a warning */
	assert_true(profile_sim_size < sizeof(text));
	for (int i = 0; i < 3000; i++) {
		size_t size = rng_u32(&rng) % (profile_sim_size + 1);
		memcpy(text, profile_sim_text, profile_sim_size);
		for (int k = 0; k < 2; k++)
			text[rng_u32(&rng) % profile_sim_size] = "=[];:#.,\n\t 0x-"[rng_u32(&rng) % 14];
		char *exact = malloc(size ? size : 1); /* so that reading past the end is seen */
		assert_non_null(exact);
		memcpy(exact, text, size);
		arena_init(&arena, "test", memory, sizeof(memory));
		profile_parse(&profile, NULL, exact, size, &arena, &error);
		free(exact);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_built_in_profile_describes_the_virtual_car),
		cmocka_unit_test(every_key_is_taken),
		cmocka_unit_test(unknown_keys_are_warnings),
		cmocka_unit_test(wrong_lines_are_named),
		cmocka_unit_test(names_that_lead_nowhere_are_named),
		cmocka_unit_test(options_replace_definitions_and_interfaces),
		cmocka_unit_test(a_car_is_asked_for_what_the_signals_need),
		cmocka_unit_test(limits_and_units_go_together),
		cmocka_unit_test(the_boards_profiles_have_no_fault),
		cmocka_unit_test(damaged_profiles_never_crash),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
