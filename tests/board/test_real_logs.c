/* The three recorded cars of the data folder through profile, definitions, replay and vehicle, against what is known
 * of the drives. Skipped without the folder. */
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
#include "platform/base/vec.h"

#define STEP_NS INT64_C(20000000)

static _Alignas(64) uint8_t memory[4 << 20];
static struct arena arena;
static struct profile profile;
static struct car car;
static struct vehicle vehicle;

struct course {
	double lat, lon, course_rad;
	double turned, turned_before; /* integral of the yaw rate here and a point earlier */
	int64_t time_ns;
	int points;
	double xx, xy, yy;
};

struct drive {
	struct can_bus_stats bus;
	double seconds;
	double speed_min, speed_max; /* of usable ones */
	double distance_m;           /* integral of the speed */
	double odometer_m;           /* last - first */
	double steering_min, steering_max;
	double turned_rad; /* integral of the yaw rate */
	double fix_path_m; /* along the fixes */
	double first_lat, first_lon, last_lat, last_lon;
	struct course course;
	uint32_t fixes;
	double usable_share;
	enum vehicle_yaw_source yaw_source;
};

static double metres_between(double lat0, double lon0, double lat1, double lon1)
{
	double north = (lat1 - lat0) * 111200.0, east = (lon1 - lon0) * 111200.0 * cos(lat0 * BLVD_PI / 180.0);
	return hypot(north, east);
}

static const char *folder(void)
{
	const char *data = getenv("BLVD_DATA");
	static char path[600];
	snprintf(path, sizeof(path), "%s/can/dbc/obd2_min.dbc", data ? data : "");
	if (data && access(path, R_OK) == 0)
		return data;
	print_message("skipped: no BLVD_DATA\n");
	return NULL;
}

/* Course of each leg of eight metres against the yaw rate: from the middle of a leg to the middle of the next the car
 * turns by about half of what it turns over both. */
static void follow_course(struct drive *drive, const struct vehicle_state *now)
{
	struct course *course = &drive->course;
	double north = (now->lat_deg - course->lat) * 111200.0;
	double east = (now->lon_deg - course->lon) * 111200.0 * cos(now->lat_deg * BLVD_PI / 180.0);
	double seconds = (double)(now->fix_time_ns - course->time_ns) * 1e-9;
	if (course->points > 0 && hypot(north, east) < 8.0)
		return;
	double fresh = atan2(east, north);
	if (course->points > 1 && seconds < 6.0) {
		double by_fixes = remainder(fresh - course->course_rad, 2.0 * BLVD_PI);
		double by_yaw = 0.5 * (drive->turned_rad - course->turned_before);
		course->xx += by_yaw * by_yaw;
		course->xy += by_yaw * by_fixes;
		course->yy += by_fixes * by_fixes;
	}
	*course = (struct course){ now->lat_deg, now->lon_deg, fresh, drive->turned_rad, course->turned, now->fix_time_ns,
		course->points + 1, course->xx, course->xy, course->yy };
}

static void follow_fix(struct drive *drive, const struct vehicle_state *now, const struct vehicle_state *before)
{
	if (now->fixes == before->fixes)
		return;
	if (drive->fixes++ == 0) {
		drive->first_lat = now->lat_deg;
		drive->first_lon = now->lon_deg;
	} else {
		drive->fix_path_m += metres_between(drive->last_lat, drive->last_lon, now->lat_deg, now->lon_deg);
	}
	drive->last_lat = now->lat_deg;
	drive->last_lon = now->lon_deg;
	follow_course(drive, now);
}

static void follow(struct drive *drive, const struct vehicle_state *now, const struct vehicle_state *before)
{
	double seconds = (double)STEP_NS * 1e-9;
	drive->seconds += seconds;
	if (now->speed_usable) {
		drive->speed_min = fmin(drive->speed_min, now->speed_mps);
		drive->speed_max = fmax(drive->speed_max, now->speed_mps);
		drive->distance_m += now->speed_mps * seconds;
		drive->usable_share += 1.0;
	}
	if (now->yaw_source) {
		drive->turned_rad += now->yaw_rate_rps * seconds;
		drive->yaw_source = now->yaw_source;
	}
	if (now->state[VEHICLE_STEERING] == NAV_SIGNAL_GOOD) {
		drive->steering_min = fmin(drive->steering_min, now->value[VEHICLE_STEERING]);
		drive->steering_max = fmax(drive->steering_max, now->value[VEHICLE_STEERING]);
	}
	if (now->odometer_usable && before->odometer_usable)
		drive->odometer_m += now->odometer_m - before->odometer_m;
	follow_fix(drive, now, before);
}

static struct drive run(
	const char *data, const char *profile_path, const char *log, int dbc_count, const char *const *dbc)
{
	char paths[2][700], log_path[700];
	const char *names[2] = { paths[0], paths[1] };
	struct can_bus *bus;
	struct drive drive = { .speed_min = 1e9, .speed_max = -1e9 };
	struct vehicle_state now, before = { 0 };
	static struct can_frame_rx frames[256];
	for (int i = 0; i < dbc_count; i++)
		snprintf(paths[i], sizeof(paths[i]), "%s/can/dbc/%s", data, dbc[i]);
	snprintf(log_path, sizeof(log_path), "%s/can/%s", data, log);
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(profile_load(&profile, profile_path, &arena), 0);
	assert_int_equal(profile.warnings, 0);
	assert_int_equal(car_init(&car, &profile, names, (unsigned)dbc_count, NULL, 0, &arena), 0);
	vehicle_init(&vehicle, &car.vehicle);
	struct can_bus_config config = {
		.path = log_path, .interfaces = car.interfaces, .interface_count = car.interface_count
	};
	assert_int_equal(can_bus_open(&bus, &can_replay_ops, &config, &arena), 0);
	size_t used = arena.used;
	double steps = 0;
	for (int64_t now_ns = 0; !bus->ended; now_ns += STEP_NS, steps++) {
		int n;
		while ((n = can_bus_read(bus, now_ns, frames, 256)) > 0)
			for (int i = 0; i < n; i++)
				vehicle_feed(&vehicle, &frames[i]);
		assert_int_equal(n, 0);
		vehicle_sample(&vehicle, now_ns, &now);
		follow(&drive, &now, &before);
		before = now;
	}
	assert_int_equal(arena.used, used);
	drive.usable_share /= steps;
	drive.bus = bus->stats;
	can_bus_close(bus);
	print_message(
		"%s: %.0f s, %llu frames, %llu used, %llu bad; speed %.1f to %.1f km/h, usable %.1f %%, %.0f m by speed, "
		"%.0f m by odometer, %.0f m along %u fixes; turned %.0f deg, steering %.0f to %.0f deg\n",
		log, drive.seconds, (unsigned long long)vehicle.frames_in, (unsigned long long)vehicle.frames_used,
		(unsigned long long)vehicle.frames_bad, drive.speed_min * 3.6, drive.speed_max * 3.6, 100 * drive.usable_share,
		drive.distance_m, drive.odometer_m, drive.fix_path_m, drive.fixes, drive.turned_rad * 180 / BLVD_PI,
		drive.steering_min * 180 / BLVD_PI, drive.steering_max * 180 / BLVD_PI);
	return drive;
}

static void print_faults(void)
{
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++)
		for (int k = 1; k < VEHICLE_FAULT_COUNT; k++)
			if (vehicle.inputs[i].faults[k])
				print_message("  %s: %s %u\n", profile_input_name((enum vehicle_input)i),
					vehicle_fault_name((enum vehicle_fault)k), vehicle.inputs[i].faults[k]);
}

static void a_logger_with_gnss_and_imu(void **state)
{
	(void)state;
	static const char *const dbc[] = { "canedge3-internal-gnss.dbc", "obd2_min.dbc" };
	static const char log[] = "css_canedge/drive_2024-09-07_aarhus-skanderborg_32min.candump.log.gz";
	const char *data = folder();
	if (!data)
		return;
	struct drive drive = run(data, "board/profiles/css_canedge.ini", log, 2, dbc);
	print_faults();
	assert_int_equal(drive.bus.bad, 0);
	assert_true(fabs(drive.seconds - 1910) < 2);
	assert_true(drive.speed_min >= 0 && drive.speed_max * 3.6 > 85 && drive.speed_max * 3.6 < 90);
	assert_true(fabs(drive.distance_m - 27600) < 300);
	assert_true(fabs(drive.fix_path_m - 27600) < 400);
	assert_true(drive.first_lat > 55.9 && drive.first_lat < 56.3 && drive.first_lon > 9.7 && drive.first_lon < 10.4);
	double correlation = drive.course.xy / sqrt(drive.course.xx * drive.course.yy);
	print_message("yaw rate against the turns of the course: %.3f\n", correlation);
	assert_true(correlation > 0.9);
	assert_int_equal(drive.yaw_source, VEHICLE_YAW_SENSOR);
}

static void the_same_drive_by_obd_speed_alone(void **state)
{
	(void)state;
	static const char *const dbc[] = { "canedge3-internal-gnss.dbc", "obd2_min.dbc" };
	static const char log[] = "css_canedge/drive_2024-09-07_aarhus-skanderborg_32min.candump.log.gz";
	const char *data = folder();
	if (!data)
		return;
	struct drive drive = run(data, "board/profiles/css_obd.ini", log, 2, dbc);
	assert_true(drive.speed_min >= 0 && drive.speed_max * 3.6 > 80 && drive.speed_max * 3.6 < 95);
	assert_true(fabs(drive.distance_m - 27600) < 1100); /* whole km/h, rounded down, and held for seven seconds */
	assert_true(drive.usable_share > 0.98);
	assert_int_equal(drive.fixes, 0);
}

static void a_toyota(void **state)
{
	(void)state;
	static const char *const dbc[] = { "toyota_new_mc_pt_generated.dbc" };
	const char *data = folder();
	if (!data)
		return;
	struct drive drive =
		run(data, "board/profiles/toyota_rav4.ini", "comma2k19_rav4/rav4_19thAve_60s.candump.log.gz", 1, dbc);
	print_faults();
	assert_int_equal(vehicle.inputs[VEHICLE_SPEED].faults[VEHICLE_FAULT_CHECKSUM], 0);
	assert_true(vehicle.inputs[VEHICLE_SPEED].taken > 2400); /* 41 a second */
	assert_true(vehicle.inputs[VEHICLE_WHEEL_REAR_LEFT].taken > 4900);
	assert_true(drive.usable_share > 0.99);
	assert_true(drive.speed_min >= 0 && drive.speed_max * 3.6 < 80);
	assert_int_equal(drive.yaw_source, VEHICLE_YAW_SENSOR);
	double wheels = 0; /* the last state: wheels and speed agree */
	for (int i = VEHICLE_WHEEL_FRONT_LEFT; i <= VEHICLE_WHEEL_REAR_RIGHT; i++)
		wheels += vehicle.inputs[i].value / 4;
	assert_true(fabs(wheels - vehicle.inputs[VEHICLE_SPEED].value) < 0.5);
}

static void a_hyundai(void **state)
{
	(void)state;
	static const char *const dbc[] = { "hyundai_can_generated.dbc" };
	const char *data = folder();
	if (!data)
		return;
	struct drive drive = run(
		data, "board/profiles/hyundai_genesis.ini", "eldominio_gpl3/hyundai_genesis_coupe_36s.candump.log.gz", 1, dbc);
	print_faults();
	assert_true(vehicle.inputs[VEHICLE_STEERING].taken > 3600);
	assert_int_equal(vehicle.inputs[VEHICLE_STEERING].faults[VEHICLE_FAULT_CHECKSUM], 0);
	assert_true(drive.speed_min >= 0 && drive.speed_max * 3.6 > 30 && drive.speed_max * 3.6 < 34);
	assert_true(fmax(-drive.steering_min, drive.steering_max) * 180 / BLVD_PI > 475);
	assert_true(fmax(-drive.steering_min, drive.steering_max) * 180 / BLVD_PI < 483);
	assert_int_equal(drive.yaw_source, VEHICLE_YAW_STEERING);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_logger_with_gnss_and_imu),
		cmocka_unit_test(the_same_drive_by_obd_speed_alone),
		cmocka_unit_test(a_toyota),
		cmocka_unit_test(a_hyundai),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
