/* The last position: when it is written, that it is found again, and what disks and clocks may do meanwhile. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <unistd.h>

#include <cmocka.h>

#include "board/position_state.h"
#include "tests/nav/ride.h"

/* A disk that can be full, counts what it is asked, and otherwise is the real one. */
struct medium {
	bool full;
	unsigned created, synced;
};

static int medium_create(void *context, const char *path)
{
	((struct medium *)context)->created++;
	return file_ops_system.create(NULL, path);
}

static int64_t medium_write(void *context, int fd, const void *bytes, size_t size)
{
	if (((struct medium *)context)->full)
		return -ENOSPC;
	return file_ops_system.write(NULL, fd, bytes, size);
}

static int medium_sync(void *context, int fd)
{
	((struct medium *)context)->synced++;
	return file_ops_system.sync(NULL, fd);
}

static int medium_close(void *context, int fd)
{
	(void)context;
	return file_ops_system.close(NULL, fd);
}

static int medium_rename(void *context, const char *from, const char *to)
{
	(void)context;
	return file_ops_system.rename(NULL, from, to);
}

static int medium_remove(void *context, const char *path)
{
	(void)context;
	return file_ops_system.remove(NULL, path);
}

static int medium_sync_folder(void *context, const char *path)
{
	(void)context;
	return file_ops_system.sync_folder(NULL, path);
}

static int64_t medium_read(void *context, const char *path, void *bytes, size_t size)
{
	(void)context;
	return file_ops_system.read(NULL, path, bytes, size);
}

static const struct file_ops medium_ops = {
	.create = medium_create,
	.write = medium_write,
	.sync = medium_sync,
	.close = medium_close,
	.rename = medium_rename,
	.remove = medium_remove,
	.sync_folder = medium_sync_folder,
	.read = medium_read,
};

struct run {
	struct ride ride;
	struct medium medium;
	struct position_state state;
	struct vehicle_state vehicle;
	int64_t wall_ns;
	bool restored;
};

#define WALL_NS (INT64_C(1718958600) * NS_PER_S)
#define YEAR_NS (INT64_C(365) * 86400 * NS_PER_S)

static void begin(struct run *run, const char *folder, struct streets *streets, uint64_t package)
{
	memset(run, 0, sizeof(*run));
	streets->meta.source_hash = package;
	ride_start(&run->ride, streets, true);
	run->wall_ns = WALL_NS;
	run->vehicle = (struct vehicle_state){ .speed_usable = true, .odometer_usable = true, .odometer_m = 5e6 };
	assert_int_equal(position_state_open(&run->state, &medium_ops, &run->medium, folder), 0);
	run->restored = position_state_begin(&run->state, &run->ride.nav, run->ride.nav.pkg, true);
}

/* Drives or stands, with a frame every 20 ms. */
static void go(struct run *run, double seconds, double speed)
{
	int64_t until = run->ride.now_ns + (int64_t)(seconds * 1e9);
	while (run->ride.now_ns < until) {
		ride_free(&run->ride, 0.019, speed, 0.0);
		run->vehicle.speed_mps = speed;
		run->vehicle.odometer_m += speed * 0.02;
		run->wall_ns += RIDE_STEP_NS;
		position_state_follow(&run->state, &run->ride.nav, &run->vehicle, run->ride.now_ns, run->wall_ns);
	}
}

/* The frames here take no time: gives the worker some. */
static void let_it_write(struct run *run)
{
	for (int i = 0; i < 2000 && run->state.busy; i++) {
		usleep(200);
		go(run, 0.02, run->vehicle.speed_mps);
	}
	assert_false(run->state.busy);
}

static void end(struct run *run)
{
	position_state_close(&run->state, &run->ride.nav, &run->vehicle, run->wall_ns);
	ride_end(&run->ride);
}

/* kill -9: nothing more is written. */
static void drop(struct run *run)
{
	worker_finish(&run->state.worker);
	ride_end(&run->ride);
}

static void make_folder(char folder[64])
{
	snprintf(folder, 64, "/tmp/blvd_position_XXXXXX");
	assert_non_null(mkdtemp(folder));
}

static void remove_folder(const char *folder)
{
	static const char *const names[] = { "position.0", "position.1", "position.new" };
	char path[256];
	for (size_t i = 0; i < 3; i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, names[i]);
		unlink(path);
	}
	assert_int_equal(rmdir(folder), 0);
}

static void place(struct run *run)
{
	assert_true(nav_set_start_half(&run->ride.nav, streets_half(run->ride.streets, 0, 1), 30.0));
}

static double east_m(const struct run *run)
{
	return (double)run->ride.nav.reckon.pos_mm[0] * 1e-3;
}

static void the_next_run_goes_on_there(void **state)
{
	(void)state;
	char folder[64];
	make_folder(folder);
	struct run run;
	begin(&run, folder, streets_grid(4, 400), 1);
	assert_false(run.restored);
	place(&run);
	go(&run, 10.0, 15.0);
	double was = east_m(&run), heading = bam_to_rad(run.ride.nav.reckon.heading_bam);
	end(&run);
	begin(&run, folder, streets_grid(4, 400), 1);
	assert_true(run.restored);
	assert_near(east_m(&run), was, 0.01);
	assert_near(bam_to_rad(run.ride.nav.reckon.heading_bam), heading, 1e-6);
	assert_int_equal(run.ride.nav.place, NAV_PLACE_REMEMBERED);
	end(&run);
	remove_folder(folder);
}

static void an_hour_is_written_at_most_120_times_and_standing_never(void **state)
{
	(void)state;
	char folder[64];
	make_folder(folder);
	struct run run;
	begin(&run, folder, streets_grid(3, 30000), 1);
	place(&run);
	for (int i = 0; i < 30; i++) {
		go(&run, 10.0, 15.0);
		let_it_write(&run);
	}
	assert_in_range(run.medium.created, 9, 11); /* five minutes: every 30 s */
	go(&run, 5.0, 0.0);
	let_it_write(&run);
	unsigned before = run.medium.created;
	go(&run, 300.0, 0.0); /* at the kerb */
	assert_int_equal(run.medium.created, before);
	assert_int_equal(run.state.refused, 0);
	end(&run);
	remove_folder(folder);
}

static void a_stop_is_kept_within_seconds_so_that_a_cut_of_power_loses_nothing(void **state)
{
	(void)state;
	char folder[64];
	make_folder(folder);
	struct run run;
	begin(&run, folder, streets_grid(3, 3000), 1);
	place(&run);
	go(&run, 21.0, 15.0);
	let_it_write(&run);
	go(&run, 0.5, 0.0);
	double was = east_m(&run);
	go(&run, 4.0, 0.0);
	let_it_write(&run);
	drop(&run);
	begin(&run, folder, streets_grid(3, 3000), 1);
	assert_true(run.restored);
	assert_near(east_m(&run), was, 0.01);
	drop(&run);
	remove_folder(folder);
}

static void killed_on_the_way_loses_no_more_than_the_last_half_minute(void **state)
{
	(void)state;
	char folder[64];
	make_folder(folder);
	struct run run;
	begin(&run, folder, streets_grid(3, 6000), 1);
	place(&run);
	for (int i = 0; i < 10; i++) {
		go(&run, 10.0, 15.0);
		let_it_write(&run);
	}
	double was = east_m(&run);
	drop(&run);
	begin(&run, folder, streets_grid(3, 6000), 1);
	assert_true(run.restored);
	assert_true(was - east_m(&run) >= 0.0 && was - east_m(&run) < 15.0 * 31.0);
	run.vehicle.odometer_m = 5e6 + 1500.0 + 100.0;
	go(&run, 0.1, 0.0); /* the odometer tells that it went on: the place is known as badly as that */
	struct nav_view view = { 0 };
	nav_snapshot(&run.ride.nav, &view);
	assert_true(view.doubt.major_m > 80.0);
	drop(&run);
	remove_folder(folder);
}

static void a_full_disk_keeps_what_was_is_told_once_and_recovers(void **state)
{
	(void)state;
	char folder[64];
	make_folder(folder);
	struct run run, next;
	begin(&run, folder, streets_grid(3, 30000), 1);
	place(&run);
	go(&run, 35.0, 15.0);
	let_it_write(&run);
	run.medium.full = true;
	for (int i = 0; i < 15; i++) {
		go(&run, 10.0, 15.0);
		let_it_write(&run);
	}
	assert_in_range(run.state.refused, 4, 6); /* asked every half minute, no more */
	begin(&next, folder, streets_grid(3, 30000), 1);
	assert_true(next.restored); /* the one before is whole */
	drop(&next);
	run.medium.full = false;
	double was = east_m(&run);
	go(&run, 31.0, 15.0);
	let_it_write(&run);
	assert_false(run.state.failing);
	drop(&run);
	begin(&next, folder, streets_grid(3, 30000), 1);
	assert_true(east_m(&next) > was);
	drop(&next);
	remove_folder(folder);
}

static void a_clock_set_back_a_year_loses_nothing(void **state)
{
	(void)state;
	char folder[64];
	make_folder(folder);
	struct run run;
	begin(&run, folder, streets_grid(3, 30000), 1);
	place(&run);
	go(&run, 40.0, 15.0);
	let_it_write(&run);
	run.wall_ns -= YEAR_NS;
	go(&run, 40.0, 15.0);
	let_it_write(&run);
	double was = east_m(&run);
	end(&run);
	begin(&run, folder, streets_grid(3, 30000), 1);
	run.wall_ns -= 2 * YEAR_NS;
	assert_true(run.restored);
	assert_near(east_m(&run), was, 1.0);
	go(&run, 40.0, 15.0);
	let_it_write(&run);
	was = east_m(&run);
	end(&run);
	begin(&run, folder, streets_grid(3, 30000), 1);
	assert_near(east_m(&run), was, 1.0);
	end(&run);
	remove_folder(folder);
}

static void another_map_of_the_place_goes_on_and_another_city_waits(void **state)
{
	(void)state;
	char folder[64];
	make_folder(folder);
	struct run run;
	begin(&run, folder, streets_grid(4, 400), 1);
	place(&run);
	go(&run, 10.0, 15.0);
	double was = east_m(&run);
	end(&run);
	begin(&run, folder, streets_grid(6, 200), 2); /* baked anew: more streets, other numbers */
	assert_true(run.restored);
	assert_near(east_m(&run), was, 0.01);
	end(&run);
	struct streets *far = streets_grid(4, 400);
	far->meta.origin_lat_deg = 41.9;
	far->meta.origin_lon_deg = 12.5;
	begin(&run, folder, far, 3);
	assert_false(run.restored);
	assert_false(run.ride.nav.match.located);
	go(&run, 60.0, 0.0);
	assert_int_equal(run.medium.created, 0); /* and does not overwrite it with nothing */
	end(&run);
	begin(&run, folder, streets_grid(4, 400), 1);
	assert_true(run.restored);
	end(&run);
	remove_folder(folder);
}

static void a_folder_that_is_no_folder_is_done_without(void **state)
{
	(void)state;
	struct run run;
	begin(&run, "/dev/null", streets_grid(3, 3000), 1);
	place(&run);
	for (int i = 0; i < 10; i++) {
		go(&run, 10.0, 15.0);
		let_it_write(&run);
	}
	assert_in_range(run.state.refused, 3, 4);
	end(&run);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_next_run_goes_on_there),
		cmocka_unit_test(an_hour_is_written_at_most_120_times_and_standing_never),
		cmocka_unit_test(a_stop_is_kept_within_seconds_so_that_a_cut_of_power_loses_nothing),
		cmocka_unit_test(killed_on_the_way_loses_no_more_than_the_last_half_minute),
		cmocka_unit_test(a_full_disk_keeps_what_was_is_told_once_and_recovers),
		cmocka_unit_test(a_clock_set_back_a_year_loses_nothing),
		cmocka_unit_test(another_map_of_the_place_goes_on_and_another_city_waits),
		cmocka_unit_test(a_folder_that_is_no_folder_is_done_without),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
