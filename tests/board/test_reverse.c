/* Reverse gear to picture, without a GPU and with the simulated camera: when it comes, when it goes, what it says. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
/* before cmocka */
#include <cmocka.h>

#include "board/reverse.h"
#include "platform/base/clock.h"

#define ARENA_BYTES ((size_t)32 << 20)
#define STEP_NS (NS_PER_S / 60)

/* Counts the allocations of the whole program. */
static unsigned long allocations;
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
void *malloc(size_t size)
{
	allocations++;
	return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
	allocations++;
	return __libc_calloc(count, size);
}
#endif

struct fixture {
	uint8_t *memory;
	struct arena arena;
	struct screen screen;
	struct profile profile;
	struct options options;
	struct reverse reverse;
	struct vehicle vehicle;
	struct vehicle_state state;
	struct control_switch line;
	struct reverse_input input;
	int64_t now_ns;
};

static void start(struct fixture *f, const char *camera)
{
	*f = (struct fixture){ .options = { .camera = camera },
		.profile = { .wheelbase_m = 2.7,
			.width_m = 1.8,
			.rear_overhang_m = 1.0,
			.steering_ratio = 15.0,
			.camera = { .width = 320,
				.height = 180,
				.fps = 30,
				.mirror = true,
				.repeats = true,
				.fov_deg = 110.0,
				.height_m = 0.95,
				.pitch_deg = 32.0,
				.behind_axle_m = 0.9 } } };
	f->memory = malloc(ARENA_BYTES);
	arena_init(&f->arena, "test", f->memory, ARENA_BYTES);
	struct screen_config screen = { .width = 640, .height = 360, .gfx = &gfx_dummy };
	assert_int_equal(screen_init(&f->screen, &f->arena, &screen), 0);
	assert_int_equal(reverse_open(&f->reverse, &f->options, &f->profile, &f->screen, true, &f->arena), 0);
	f->input = (struct reverse_input){ .vehicle = &f->vehicle, .state = &f->state, .line = &f->line };
	f->state.state[VEHICLE_STEERING] = NAV_SIGNAL_GOOD;
}

static void stop(struct fixture *f)
{
	reverse_close(&f->reverse);
	assert_true(gfx_stats(f->screen.gfx)->bytes ==
				gfx_target_bytes(&(struct gfx_target_desc){ .width = 640, .height = 360, .samples = 1 }));
	screen_finish(&f->screen);
	free(f->memory);
}

static void gear(struct fixture *f, enum nav_gear gear)
{
	if (f->state.gear != gear)
		f->vehicle.inputs[VEHICLE_GEAR].changed_ns = f->now_ns;
	f->state.state[VEHICLE_GEAR] = gear == NAV_GEAR_UNKNOWN ? NAV_SIGNAL_STALE : NAV_SIGNAL_GOOD;
	f->state.gear = gear;
}

/* One picture at the present; whether it was the camera's path that drew it. */
static bool frame(struct fixture *f)
{
	f->input.now_ns = f->now_ns;
	bool mine = reverse_update(&f->reverse, &f->input);
	if (mine)
		reverse_draw(&f->reverse, &f->input);
	reverse_shown(&f->reverse, f->now_ns);
	f->now_ns += STEP_NS;
	return mine;
}

static void frames(struct fixture *f, int ms)
{
	for (int64_t end = f->now_ns + ms * NS_PER_MS; f->now_ns < end;)
		frame(f);
}

static void the_gear_brings_it_and_takes_it_away(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, "sim");
	gear(&f, NAV_GEAR_DRIVE);
	frames(&f, 500);
	assert_false(f.reverse.engaged);
	gear(&f, NAV_GEAR_REVERSE);
	assert_true(frame(&f));
	assert_true(f.reverse.live);
	assert_int_equal(f.reverse.stats.edge_ns.count, 1);
	assert_true(f.reverse.stats.edge_ns.max <= 200 * (uint64_t)NS_PER_MS);
	frames(&f, 300);
	gear(&f, NAV_GEAR_DRIVE);
	int64_t left_ns = f.now_ns;
	while (frame(&f))
		assert_true(f.now_ns - left_ns < NS_PER_S);
	assert_in_range((f.now_ns - left_ns) / NS_PER_MS, 280, 340);
	stop(&f);
}

static void the_contact_does_too_and_its_edge_counts(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, "sim");
	f.line = (struct control_switch){ .known = true };
	frames(&f, 400);
	assert_false(f.reverse.engaged);
	f.line = (struct control_switch){ .known = true, .on = true, .since_ns = f.now_ns - 30 * NS_PER_MS };
	assert_true(frame(&f));
	assert_int_equal(f.reverse.stats.edge_ns.max, 30 * NS_PER_MS);
	/* the gear says drive, the contact reverse: the safe one counts */
	gear(&f, NAV_GEAR_DRIVE);
	frames(&f, 1000);
	assert_true(f.reverse.engaged);
	f.line.on = false;
	frames(&f, 400);
	assert_false(f.reverse.engaged);
	stop(&f);
}

static void a_lever_that_passes_through_neutral_does_not_make_it_flicker(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, "sim");
	gear(&f, NAV_GEAR_REVERSE);
	frames(&f, 300);
	for (int i = 0; i < 5; i++) {
		gear(&f, NAV_GEAR_NEUTRAL);
		for (int k = 0; k < 12; k++)
			assert_true(frame(&f));
		gear(&f, NAV_GEAR_REVERSE);
		for (int k = 0; k < 12; k++)
			assert_true(frame(&f));
	}
	assert_int_equal(f.reverse.stats.reversed, 1);
	stop(&f);
}

static void a_gear_that_is_lost_keeps_it_until_the_car_goes_forward(void **state)
{
	(void)state;
	struct fixture f;
	for (int forward = 0; forward < 2; forward++) {
		start(&f, "sim");
		gear(&f, NAV_GEAR_REVERSE);
		frames(&f, 300);
		gear(&f, NAV_GEAR_UNKNOWN);
		f.state.speed_usable = true;
		f.state.speed_mps = 1.0;
		frames(&f, 3000);
		assert_true(f.reverse.engaged);
		f.state.speed_mps = forward ? 4.0 : 1.0;
		frames(&f, 100);
		assert_int_equal(f.reverse.engaged, !forward);
		frames(&f, 8000);
		assert_false(f.reverse.engaged);
		stop(&f);
	}
}

static void what_is_wrong_is_said_and_nothing_old_is_shown(void **state)
{
	(void)state;
	static const struct {
		const char *script;
		enum watch_state state;
	} faults[] = { { "sim:frozen@1+2", WATCH_FROZEN }, { "sim:stalled@1+2", WATCH_FROZEN },
		{ "sim:missing@1+2", WATCH_MISSING }, { "sim:late@1+2", WATCH_FROZEN }, { "sim:torn@1+2", WATCH_FROZEN },
		{ "sim:size@1+2", WATCH_FROZEN }, { "sim:missing@0+3", WATCH_MISSING } };
	for (size_t i = 0; i < sizeof(faults) / sizeof(faults[0]); i++) {
		struct fixture f;
		start(&f, faults[i].script);
		gear(&f, NAV_GEAR_REVERSE);
		frames(&f, 1500);
		for (int k = 0; k < 80; k++) {
			frame(&f);
			assert_int_equal(f.reverse.state, faults[i].state);
			assert_false(f.reverse.live);
		}
		frames(&f, 700);
		assert_true(f.reverse.live);
		assert_int_equal(f.reverse.stats.too_old, 0);
		assert_true(f.reverse.stats.age_ns.max <= (uint64_t)WATCH_AGE_NS);
		stop(&f);
	}
}

static void a_picture_that_gets_old_while_it_is_drawn_is_withdrawn(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, "sim");
	gear(&f, NAV_GEAR_REVERSE);
	frames(&f, 300);
	uint64_t shown = f.reverse.stats.shown;
	f.input.now_ns = f.now_ns;
	assert_true(reverse_update(&f.reverse, &f.input));
	reverse_draw(&f.reverse, &f.input);
	assert_true(f.reverse.live);
	assert_false(reverse_outdated(&f.reverse, f.now_ns));
	assert_true(reverse_outdated(&f.reverse, f.now_ns + 250 * NS_PER_MS));
	reverse_shown(&f.reverse, f.now_ns + 260 * NS_PER_MS);
	assert_int_equal(f.reverse.stats.shown, shown);
	assert_int_equal(f.reverse.stats.withdrawn, 1);
	stop(&f);
}

/* Half a second of pictures that all get too old while they are drawn. */
static void be_late(struct fixture *f)
{
	for (int i = 0; i < 30; i++, f->now_ns += STEP_NS) {
		f->input.now_ns = f->now_ns;
		assert_true(reverse_update(&f->reverse, &f->input));
		reverse_draw(&f->reverse, &f->input);
		assert_true(reverse_outdated(&f->reverse, f->now_ns + 250 * NS_PER_MS));
		reverse_shown(&f->reverse, f->now_ns + 260 * NS_PER_MS);
	}
}

static void a_machine_that_is_always_late_says_so_once(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, "sim");
	gear(&f, NAV_GEAR_REVERSE);
	frames(&f, 300);
	FILE *file = tmpfile();
	assert_non_null(file);
	fflush(stderr);
	int old = dup(STDERR_FILENO);
	assert_true(old >= 0 && dup2(fileno(file), STDERR_FILENO) >= 0);
	be_late(&f);
	assert_true(dup2(old, STDERR_FILENO) >= 0);
	close(old);
	char said[1000];
	rewind(file);
	said[fread(said, 1, sizeof(said) - 1, file)] = 0;
	fclose(file);
	assert_non_null(strstr(said, "too old when it was drawn"));
	assert_ptr_equal(strchr(said, '\n') + 1, strchr(said, 0));
	assert_int_equal(f.reverse.stats.frozen, 0);
	stop(&f);
}

static int open_files(void)
{
	int count = 0;
	DIR *dir = opendir("/proc/self/fd");
	while (dir && readdir(dir))
		count++;
	if (dir)
		closedir(dir);
	return count;
}

static void a_thousand_times_reverse_and_drive_leak_nothing(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, "sim:160x90,missing@30+0.3,frozen@60+1");
	gear(&f, NAV_GEAR_DRIVE);
	frames(&f, 200);
	int files = open_files();
	unsigned long before = allocations;
	size_t used = f.arena.used;
	uint64_t bytes = gfx_stats(f.screen.gfx)->bytes;
	for (int i = 0; i < 1000; i++) {
		gear(&f, NAV_GEAR_REVERSE);
		frame(&f);
		frame(&f);
		frame(&f);
		gear(&f, NAV_GEAR_DRIVE);
		while (frame(&f))
			;
	}
	assert_int_equal(f.reverse.stats.reversed, 1000);
	assert_in_range(f.reverse.stats.edge_ns.count, 990, 1000);
	assert_int_equal(allocations, before);
	assert_int_equal(f.arena.used, used);
	assert_true(gfx_stats(f.screen.gfx)->bytes == bytes && gfx_stats(f.screen.gfx)->refused == 0);
	assert_int_equal(open_files(), files);
	stop(&f);
}

static void without_a_camera_there_is_no_picture(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, NULL);
	gear(&f, NAV_GEAR_REVERSE);
	assert_false(reverse_has_camera(&f.reverse));
	assert_false(frame(&f));
	stop(&f);
	start(&f, "none");
	assert_false(frame(&f));
	stop(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_gear_brings_it_and_takes_it_away),
		cmocka_unit_test(the_contact_does_too_and_its_edge_counts),
		cmocka_unit_test(a_lever_that_passes_through_neutral_does_not_make_it_flicker),
		cmocka_unit_test(a_gear_that_is_lost_keeps_it_until_the_car_goes_forward),
		cmocka_unit_test(what_is_wrong_is_said_and_nothing_old_is_shown),
		cmocka_unit_test(a_picture_that_gets_old_while_it_is_drawn_is_withdrawn),
		cmocka_unit_test(a_machine_that_is_always_late_says_so_once),
		cmocka_unit_test(a_thousand_times_reverse_and_drive_leak_nothing),
		cmocka_unit_test(without_a_camera_there_is_no_picture),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
