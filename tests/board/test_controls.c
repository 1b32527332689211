/* From the lines of a scripted board to actions, and on to the menu: with the knob alone everything is reached. */
#include <errno.h>
#include <linux/input-event-codes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "board/control_keys.h"
#include "board/menu.h"
#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/base/rng.h"
#include "platform/gpio/gpio_sim.h"

#define MS NS_PER_MS

static _Alignas(64) uint8_t memory[2 << 20];
static struct arena arena;
static struct profile profile;
static struct options options;
static struct controls controls;
static struct settings settings;
static struct menu menu;

static void start(const char *ini)
{
	struct profile_error error;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(profile_parse(&profile, NULL, ini, strlen(ini), &arena, &error), 0);
	options = (struct options){ .gpio = "sim" };
	assert_int_equal(controls_open(&controls, &options, &profile, true, 0, &arena), 0);
	settings_init(&settings, &profile, &options);
	menu_init(&menu, &settings);
}

static int stop(void **state)
{
	(void)state;
	controls_close(&controls);
	return 0;
}

/* What the script does, looked at every `step_ns` until `end_ns`, as words. */
static const char *play(const char *const *script, int64_t end_ns, int64_t step_ns)
{
	static const char letters[ACTION_COUNT + 1] = ".><udPBEioVLpq";
	static char out[8192];
	size_t length = 0;
	for (int i = 0; script[i]; i++)
		assert_null(gpio_sim_say(controls.gpio, script[i], 0));
	for (int64_t now = 0; now <= end_ns; now += step_ns) {
		controls_advance(&controls, now);
		for (enum action action; (action = controls_next(&controls)) != ACTION_NONE;)
			if (length < sizeof(out) - 1)
				out[length++] = letters[action];
	}
	out[length] = 0;
	return out;
}

static void lines_become_actions_whatever_the_frame_rate(void **state)
{
	(void)state;
	static const char *const script[] = {
		"0.100 knob +3 1000",
		"0.200 knob -2 1000",
		"0.300 push 1",
		"0.400 push 0", /* short */
		"0.500 push 1",
		"1.300 push 0", /* long */
		"1.400 back 1",
		"1.450 back 0",
		"1.500 view 1",
		"1.550 view 0",
		"1.600 zoom_in 1",
		"1.650 zoom_in 0",
		"1.700 zoom_out 1",
		"1.750 zoom_out 0",
		NULL,
	};
	static const int64_t steps[] = { 1 * MS, 16 * MS, 100 * MS };
	for (int i = 0; i < 3; i++) {
		start("");
		assert_string_equal(play(script, 2000 * MS, steps[i]), ">>><<PBBVio");
		stop(NULL);
	}
}

static void a_held_zoom_button_goes_on(void **state)
{
	(void)state;
	static const char *const script[] = { "0.1 zoom_in 1", "1.5 zoom_in 0", NULL };
	start("");
	assert_string_equal(play(script, 3000 * MS, 10 * MS), "iiiiii");
}

static void bounces_and_spikes_are_no_presses(void **state)
{
	(void)state;
	static const char *const script[] = {
		"0.100 push bounce 9", /* 2.7 ms of bounces, then down */
		"0.300 push bounce 9", /* and up */
		"0.500 back bounce 2", /* a spike */
		NULL,
	};
	start("");
	assert_string_equal(play(script, 1000 * MS, 5 * MS), "P");
}

static void a_reverse_line_carries_the_time_of_its_edge(void **state)
{
	(void)state;
	static const char *const script[] = { "0.5 reverse bounce 5", "2.0 reverse 0", NULL };
	start("");
	controls_advance(&controls, 0);
	assert_true(controls.state.reverse.known && !controls.state.reverse.on);
	play(script, 600 * MS, 10 * MS);
	assert_true(controls.state.reverse.on);
	assert_int_equal(controls.state.reverse.since_ns, 500 * MS + 4 * 300000); /* the last of the bounces */
	play((const char *const[]){ NULL }, 2100 * MS, 10 * MS);
	assert_false(controls.state.reverse.on);
	assert_int_equal(controls.state.reverse.since_ns, 2000 * MS);
}

static void a_car_that_starts_in_reverse_is_in_reverse(void **state)
{
	(void)state;
	char path[] = "/tmp/blvd-script-XXXXXX";
	int fd = mkstemp(path);
	static const char text[] = "# levels at the start\n0 reverse 1\n0 push 1\n0.5 push 0\n";
	assert_int_equal(write(fd, text, sizeof(text) - 1), sizeof(text) - 1);
	close(fd);
	arena_init(&arena, "test", memory, sizeof(memory));
	struct profile_error error;
	char chip[64];
	snprintf(chip, sizeof(chip), "sim:%s", path);
	options = (struct options){ .gpio = chip };
	assert_int_equal(profile_parse(&profile, NULL, "", 0, &arena, &error), 0);
	assert_int_equal(controls_open(&controls, &options, &profile, true, 0, &arena), 0);
	unlink(path);
	controls_advance(&controls, 0);
	assert_true(controls.state.reverse.on);
	assert_false(controls.state.ignition.known);                                      /* no such line: the car is on */
	assert_string_equal(play((const char *const[]){ NULL }, 2000 * MS, 10 * MS), ""); /* nobody pressed it since */
}

static void a_bad_script_is_refused_with_its_line(void **state)
{
	(void)state;
	start("");
	assert_string_equal(gpio_sim_say(controls.gpio, "1.0 brake 1", 0), "no line of this name is configured");
	assert_string_equal(gpio_sim_say(controls.gpio, "soon push 1", 0), "not SECONDS LINE WHAT");
	assert_string_equal(gpio_sim_say(controls.gpio, "-1 push 1", 0), "not SECONDS LINE WHAT");
	assert_non_null(gpio_sim_say(controls.gpio, "1 push down", 0));
	assert_non_null(gpio_sim_say(controls.gpio, "1 knob fast", 0));
	assert_null(gpio_sim_say(controls.gpio, "  # nothing", 0));
	stop(NULL);
	options.gpio = "sim:/no/such/script";
	assert_int_equal(controls_open(&controls, &options, &profile, true, 0, &arena), -ENOENT);
}

static void lines_that_are_lost_are_told_the_gravest_first(void **state)
{
	(void)state;
	static const char *const lose[] = { "0.1 view busy", "0.2 push gone", "0.3 reverse gone", NULL };
	static const char *const back[] = { "0.5 reverse good", "0.6 push good", "0.7 view good", NULL };
	start("");
	controls_advance(&controls, 0);
	assert_null(controls_fault(&controls));
	play(lose, 150 * MS, 50 * MS);
	assert_string_equal(controls_fault(&controls), "Controls in use elsewhere");
	controls_advance(&controls, 250 * MS);
	assert_string_equal(controls_fault(&controls), "Controls lost");
	controls_advance(&controls, 350 * MS);
	assert_string_equal(controls_fault(&controls), "Reverse line lost");
	assert_false(controls.state.reverse.known);
	play(back, 800 * MS, 50 * MS);
	assert_null(controls_fault(&controls));
	assert_true(controls.state.reverse.known);
}

static void a_chattering_contact_is_told_and_presses_nothing(void **state)
{
	(void)state;
	static const char *const script[] = { "0.1 reverse bounce 4000", NULL };
	start("");
	assert_string_equal(play(script, 1250 * MS, 10 * MS), "");
	assert_non_null(controls_fault(&controls));
	assert_string_equal(controls_fault(&controls), "Reverse line chatters");
	assert_false(controls.state.reverse.on);
	play((const char *const[]){ NULL }, 2500 * MS, 10 * MS);
	assert_null(controls_fault(&controls));
}

static void a_push_that_the_line_did_not_survive_is_none(void **state)
{
	(void)state;
	static const char *const script[] = { "0.1 push 1", "0.2 push gone", "0.3 push good", "0.4 push 0", "1.5 push 1",
		"1.6 push 0", NULL };
	start("");
	assert_string_equal(play(script, 2000 * MS, 10 * MS), "P");
}

static void an_overrun_costs_a_detent_at_most(void **state)
{
	(void)state;
	static const char *const script[] = { "0.1 knob +5 1000", "0.11 rotary_a overrun", "0.2 knob +5 1000", NULL };
	start("");
	const char *actions = play(script, 1000 * MS, 10 * MS);
	assert_true(strlen(actions) >= 8 && strlen(actions) <= 10 && !strchr(actions, '<'));
}

static void a_thousand_edges_a_second_all_count(void **state)
{
	(void)state;
	static const char *const script[] = { "0.1 knob +500 1000", "2.5 knob -250 1000", NULL };
	start("[gpio]\nrotary_swapped = yes\n");
	const char *actions = play(script, 5000 * MS, 33 * MS);
	assert_int_equal(strlen(actions), 750);
	assert_int_equal(strspn(actions, "<"), 500);
	assert_int_equal(controls.actions_dropped, 0);
}

static void keys_of_devices_and_windows_mean_the_same(void **state)
{
	(void)state;
	assert_int_equal(controls_action_of_key(DISPLAY_KEY_UP), ACTION_UP);
	assert_int_equal(action_of_key(KEY_UP), ACTION_UP);
	assert_int_equal(controls_action_of_key(DISPLAY_KEY_PUSH), ACTION_PUSH);
	assert_int_equal(control_of_key(KEY_ENTER), CONTROL_PUSH);
	assert_int_equal(control_of_key(KEY_A), CONTROL_LINE_COUNT);
	assert_int_equal(action_of_key(KEY_A), ACTION_NONE);
	assert_int_equal(controls_action_of_key(DISPLAY_KEY_NONE), ACTION_NONE);
}

/* Turns the knob until the row of this label is the chosen one. */
static void go_to(const char *label, int64_t now)
{
	uint32_t count;
	const char *const *words = menu_words(&count);
	for (int i = 0; i < MENU_ROWS_MAX; i++)
		menu_act(&menu, ACTION_TURN_LEFT, now);
	for (int i = 0; i < MENU_ROWS_MAX; i++) {
		const struct menu_view *view = menu_step(&menu, false, now);
		if (!strcmp(words[view->rows[view->chosen].label], label))
			return;
		menu_act(&menu, ACTION_TURN_RIGHT, now);
	}
	fail_msg("no row %s", label);
}

static void turn(int detents)
{
	for (; detents > 0; detents--)
		assert_true(menu_act(&menu, ACTION_TURN_RIGHT, 0));
	for (; detents < 0; detents++)
		assert_true(menu_act(&menu, ACTION_TURN_LEFT, 0));
}

static void choose(const char *label, int detents)
{
	go_to(label, 0);
	assert_true(menu_act(&menu, ACTION_PUSH, 0));
	turn(detents);
	if (menu.changing)
		assert_true(menu_act(&menu, ACTION_PUSH, 0));
}

static void everything_is_reached_with_the_knob_alone(void **state)
{
	(void)state;
	start("");
	menu.has_route = menu.has_brightness = true;
	assert_false(menu_act(&menu, ACTION_TURN_RIGHT, 0)); /* closed: the knob zooms */
	assert_true(menu_act(&menu, ACTION_PUSH, 0));
	for (int i = 0; i < CAMERA_KIND_COUNT; i++) {
		choose("View", i == 0 ? -9 : 1);
		assert_int_equal(settings.view, i);
	}
	for (int i = 0; i < LIGHT_COUNT; i++) {
		choose("Light", i == 0 ? -9 : 1);
		assert_int_equal(settings.light, i);
	}
	choose("Zoom", 100);
	assert_true(settings.zoom == 4.0);
	choose("Zoom", -100);
	assert_true(settings.zoom == 0.25);
	choose("Brightness", -100);
	assert_int_equal(settings.brightness, SETTINGS_BRIGHTNESS_MIN);
	choose("Brightness", 2);
	assert_int_equal(settings.brightness, SETTINGS_BRIGHTNESS_MIN + 2 * SETTINGS_BRIGHTNESS_STEP);
	choose("Street names", 0);
	assert_false(settings.names);
	choose("Guidance", 0);
	assert_false(settings.route);
	choose("Guidance", 0);
	assert_true(settings.route);
	choose("Units", 9);
	assert_int_equal(settings.units, UNITS_MILES_FEET);
	choose("Close", 0);
	assert_false(menu.open);
}

static void a_long_push_goes_back_and_undoes_what_was_being_changed(void **state)
{
	(void)state;
	start("");
	menu_act(&menu, ACTION_PUSH, 0);
	go_to("Light", 0);
	menu_act(&menu, ACTION_PUSH, 0);
	turn(2);
	assert_int_equal(settings.light, LIGHT_NIGHT); /* seen at once */
	assert_true(menu_act(&menu, ACTION_BACK, 0));
	assert_int_equal(settings.light, LIGHT_AUTO);
	assert_true(menu.open);
	assert_true(menu_act(&menu, ACTION_BACK, 0));
	assert_false(menu.open);
	assert_false(menu_act(&menu, ACTION_BACK, 0));
	assert_false(menu_act(&menu, ACTION_ESCAPE, 0)); /* then it ends the program */
}

static void time_closes_the_menu_sooner_while_moving(void **state)
{
	(void)state;
	start("");
	menu_act(&menu, ACTION_PUSH, NS_PER_S);
	assert_non_null(menu_step(&menu, true, NS_PER_S + MENU_MOVING_NS));
	assert_null(menu_step(&menu, true, NS_PER_S + MENU_MOVING_NS + 1));
	assert_false(menu.open);
	menu_act(&menu, ACTION_PUSH, 0);
	menu_act(&menu, ACTION_TURN_RIGHT, 3 * NS_PER_S); /* a touch */
	assert_non_null(menu_step(&menu, false, MENU_STANDING_NS + 3 * NS_PER_S));
	assert_null(menu_step(&menu, false, MENU_STANDING_NS + 3 * NS_PER_S + 1));
}

static void rows_without_a_meaning_are_not_there(void **state)
{
	(void)state;
	start("");
	menu.has_route = menu.has_brightness = true;
	menu_act(&menu, ACTION_PUSH, 0);
	int all = menu_step(&menu, false, 0)->count;
	choose("Guidance", 0);
	menu.has_route = false; /* arrived */
	const struct menu_view *view = menu_step(&menu, false, 0);
	assert_int_equal(view->count, all - 1);
	assert_true(view->chosen < view->count);
	menu.has_brightness = false;
	assert_int_equal(menu_step(&menu, false, 0)->count, all - 2);
}

/* Whatever is done: values stay in their ranges, and the picture has a chosen row. */
static void random_hands_break_nothing(void **state)
{
	(void)state;
	struct rng rng = rng_seed(3);
	start("");
	uint32_t words;
	menu_words(&words);
	for (int i = 0; i < 100000; i++) {
		enum action action = (enum action)(rng_u32(&rng) % ACTION_COUNT);
		menu.has_route = rng_u32(&rng) % 8 != 0;
		menu.has_brightness = rng_u32(&rng) % 8 != 0;
		if (!menu_act(&menu, action, i * MS))
			settings_act(&settings, action);
		const struct menu_view *view = menu_step(&menu, rng_u32(&rng) % 2, i * MS);
		assert_true(settings.view >= 0 && settings.view < CAMERA_KIND_COUNT);
		assert_true(settings.light >= 0 && settings.light < LIGHT_COUNT);
		assert_true(settings.zoom >= 0.25 && settings.zoom <= 4.0);
		assert_true(settings.brightness >= SETTINGS_BRIGHTNESS_MIN && settings.brightness <= 100);
		assert_true(
			settings.units == UNITS_AUTO || settings.units == UNITS_METRIC || settings.units == UNITS_MILES_FEET);
		if (!view)
			continue;
		assert_true(view->count <= MENU_ROWS_MAX && view->chosen < view->count);
		for (int row = 0; row < view->count; row++) {
			assert_true(view->rows[row].label < words);
			assert_true(view->rows[row].value < words || view->rows[row].value == MENU_NO_WORD);
			assert_true(view->rows[row].bar >= MENU_NO_BAR && view->rows[row].bar <= 100);
		}
	}
}

static void lines_of_the_profile_are_read_and_bad_ones_are_refused(void **state)
{
	(void)state;
	static const struct {
		const char *text, *error;
	} bad[] = {
		{ "reverse = 17", "'17' is not CHIP:LINE with LINE a number up to 1023" },
		{ "reverse = gpiochip0:x", "'gpiochip0:x' is not CHIP:LINE with LINE a number up to 1023" },
		{ "reverse = gpiochip0:1024", "'gpiochip0:1024' is not CHIP:LINE with LINE a number up to 1023" },
		{ "reverse =", "CHIP:LINE expected" },
		{ "push = a:1 debounce_ms=-1", "debounce_ms is '-1', not a whole number from 0 to 1000" },
		{ "push = a:1 long_ms=9e9", "long_ms is '9e9', not a whole number from 0 to 10000" },
		{ "push = a:1\npush = a:2", "the same line again; it was in line 2" },
		{ "rotary_steps = 3", "rotary_steps is '3', not one of: 1, 2, 4" },
		{ "rotary_swapped = si", "rotary_swapped is 'si', not yes or no" },
		{ "push = a:1 low",
			"'low' is none of: active_low, active_high, pull_up, pull_down, no_pull, as_is, debounce_ms=N, long_ms=N" },
		{ "[input]\ndevices = event0", "'event0' is neither a path nor name:NAME" },
	};
	struct profile_error error;
	char text[200];
	for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
		arena_init(&arena, "test", memory, sizeof(memory));
		snprintf(text, sizeof(text), "[gpio]\n%s\n", bad[i].text);
		assert_int_equal(profile_parse(&profile, NULL, text, strlen(text), &arena, &error), -EINVAL);
		assert_string_equal(error.text, bad[i].error);
	}
	start("[gpio]\nreverse = pinctrl-rp1:17 active_low pull_up debounce_ms=5\npush = /dev/gpiochip4:3 no_pull "
		  "long_ms=900\nrotary_steps = 2\n[input]\ndevices = name:My knob, /dev/input/event3\n");
	const struct profile_line *reverse = &profile.gpio.lines[CONTROL_REVERSE];
	assert_string_equal(reverse->at.chip, "pinctrl-rp1");
	assert_true(reverse->at.offset == 17 && reverse->at.active_low && reverse->at.bias == GPIO_BIAS_PULL_UP);
	assert_int_equal(controls.contact[CONTROL_REVERSE].hold_ns, 5 * MS);
	assert_int_equal(controls.press[CONTROL_PUSH].long_ns, 900 * MS);
	assert_int_equal(profile.gpio.rotary_steps, 2);
	assert_string_equal(profile.gpio.devices[0], "name:My knob");
	assert_string_equal(profile.gpio.devices[1], "/dev/input/event3");
	assert_int_equal(profile.warnings, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_teardown(lines_become_actions_whatever_the_frame_rate, stop),
		cmocka_unit_test_teardown(a_held_zoom_button_goes_on, stop),
		cmocka_unit_test_teardown(bounces_and_spikes_are_no_presses, stop),
		cmocka_unit_test_teardown(a_reverse_line_carries_the_time_of_its_edge, stop),
		cmocka_unit_test_teardown(a_car_that_starts_in_reverse_is_in_reverse, stop),
		cmocka_unit_test_teardown(a_bad_script_is_refused_with_its_line, stop),
		cmocka_unit_test_teardown(lines_that_are_lost_are_told_the_gravest_first, stop),
		cmocka_unit_test_teardown(a_chattering_contact_is_told_and_presses_nothing, stop),
		cmocka_unit_test_teardown(a_push_that_the_line_did_not_survive_is_none, stop),
		cmocka_unit_test_teardown(an_overrun_costs_a_detent_at_most, stop),
		cmocka_unit_test_teardown(a_thousand_edges_a_second_all_count, stop),
		cmocka_unit_test_teardown(keys_of_devices_and_windows_mean_the_same, stop),
		cmocka_unit_test_teardown(everything_is_reached_with_the_knob_alone, stop),
		cmocka_unit_test_teardown(a_long_push_goes_back_and_undoes_what_was_being_changed, stop),
		cmocka_unit_test_teardown(time_closes_the_menu_sooner_while_moving, stop),
		cmocka_unit_test_teardown(rows_without_a_meaning_are_not_there, stop),
		cmocka_unit_test_teardown(random_hands_break_nothing, stop),
		cmocka_unit_test_teardown(lines_of_the_profile_are_read_and_bad_ones_are_refused, stop),
	};
	log_init("test", LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
