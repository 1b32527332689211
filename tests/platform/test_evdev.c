/*
 * Input devices: events by hand on any machine; a device made by uinput where the kernel has it (the emulator's guest),
 * else that part is skipped.
 */
#include <errno.h>
#include <fcntl.h>
#include <linux/uinput.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/input/evdev.h"

#define KNOB "Boulevard test knob"

static _Alignas(64) uint8_t memory[1 << 17];
static struct arena arena;
static struct evdev *evdev;
static struct evdev_report reports[4096];
static int made = -1; /* the uinput device */

static struct input_event event_of(uint16_t type, uint16_t code, int32_t value)
{
	struct input_event event = { .type = type, .code = code, .value = value };
	event.input_event_sec = 2;
	event.input_event_usec = 500;
	return event;
}

static bool decode(struct evdev_decoder *decoder, uint16_t type, uint16_t code, int32_t value, struct evdev_report *out)
{
	struct input_event event = event_of(type, code, value);
	return evdev_decode(decoder, &event, out);
}

static void relative_axes_are_detents(void **state)
{
	(void)state;
	static const uint16_t axes[] = { REL_X, REL_DIAL, REL_WHEEL, REL_HWHEEL };
	struct evdev_decoder decoder = { 0 };
	struct evdev_report report;
	for (int i = 0; i < 4; i++) {
		assert_true(decode(&decoder, EV_REL, axes[i], -3, &report));
		assert_int_equal(report.kind, EVDEV_TURN);
		assert_int_equal(report.value, -3);
		assert_int_equal(report.time_ns, 2 * NS_PER_S + 500000);
	}
	assert_false(decode(&decoder, EV_REL, REL_Y, 5, &report));
	assert_false(decode(&decoder, EV_REL, REL_X, 0, &report));
	assert_false(decode(&decoder, EV_REL, REL_WHEEL_HI_RES, 120, &report));
	assert_true(decode(&decoder, EV_REL, REL_X, INT32_MAX, &report));
	assert_int_equal(report.value, 64);
}

static void an_absolute_knob_counts_on_and_wraps(void **state)
{
	(void)state;
	struct evdev_decoder decoder = { .has_wheel = true, .wheel_at = 22, .wheel_turn = 24 };
	struct evdev_report report;
	static const struct {
		int32_t value, by;
	} steps[] = { { 23, 1 }, { 0, 1 }, { 3, 3 }, { 23, -4 }, { 20, -3 } };
	for (int i = 0; i < 5; i++) {
		assert_true(decode(&decoder, EV_ABS, ABS_X, steps[i].value, &report));
		assert_int_equal(report.value, steps[i].by);
	}
	decoder.has_wheel = false;
	assert_false(decode(&decoder, EV_ABS, ABS_X, 1, &report));
}

static void keys_are_told_as_they_are(void **state)
{
	(void)state;
	struct evdev_decoder decoder = { 0 };
	struct evdev_report report;
	for (int value = 0; value <= 2; value++) {
		assert_true(decode(&decoder, EV_KEY, KEY_ENTER, value, &report));
		assert_int_equal(report.kind, EVDEV_KEY);
		assert_int_equal(report.key, KEY_ENTER);
		assert_int_equal(report.value, value);
	}
	assert_false(decode(&decoder, EV_SYN, SYN_REPORT, 0, &report));
	assert_false(decode(&decoder, EV_MSC, MSC_SCAN, 28, &report));
}

static void what_comes_with_lost_events_is_passed_over_and_told(void **state)
{
	(void)state;
	struct evdev_decoder decoder = { 0 };
	struct evdev_report report;
	assert_false(decode(&decoder, EV_SYN, SYN_DROPPED, 0, &report));
	assert_false(decode(&decoder, EV_KEY, KEY_ENTER, 1, &report));
	assert_false(decode(&decoder, EV_REL, REL_X, 1, &report));
	assert_true(decode(&decoder, EV_SYN, SYN_REPORT, 0, &report));
	assert_int_equal(report.kind, EVDEV_RESET);
	assert_true(decode(&decoder, EV_REL, REL_X, 1, &report));
}

static void open_devices(const char *name)
{
	static const char *names[1];
	names[0] = name;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(evdev_open(&evdev, names, 1, &arena), 0);
}

static int stop(void **state)
{
	(void)state;
	evdev_close(evdev);
	evdev = NULL;
	if (made >= 0)
		close(made);
	made = -1;
	return 0;
}

static int wait_for_state(enum evdev_state state)
{
	for (int ms = 0; ms < 2500; ms++) {
		evdev_read(evdev, reports, 4096);
		if (evdev_worst(evdev) == state)
			return ms;
		clock_sleep_until(clock_now_ns() + NS_PER_MS);
	}
	return -1;
}

static void a_device_that_is_not_there_is_a_state(void **state)
{
	(void)state;
	open_devices("/dev/input/no-such-device");
	assert_int_equal(evdev_read(evdev, reports, 4096), 1);
	assert_int_equal(reports[0].kind, EVDEV_STATE);
	assert_int_equal(evdev_worst(evdev), EVDEV_GONE);
	stop(NULL);
	open_devices("/dev/null"); /* no input device */
	evdev_read(evdev, reports, 4096);
	assert_int_equal(evdev_worst(evdev), EVDEV_REFUSED);
}

static bool no_uinput(void)
{
	if (access("/dev/uinput", W_OK) == 0)
		return false;
	print_message("skipped: no /dev/uinput\n");
	return true;
}

static void make_knob(void)
{
	struct uinput_setup setup = { .name = KNOB };
	made = open("/dev/uinput", O_WRONLY | O_CLOEXEC);
	assert_true(made >= 0);
	assert_true(ioctl(made, UI_SET_EVBIT, EV_REL) >= 0 && ioctl(made, UI_SET_RELBIT, REL_DIAL) >= 0);
	assert_true(ioctl(made, UI_SET_EVBIT, EV_KEY) >= 0 && ioctl(made, UI_SET_KEYBIT, KEY_ENTER) >= 0);
	assert_true(ioctl(made, UI_DEV_SETUP, &setup) >= 0 && ioctl(made, UI_DEV_CREATE) >= 0);
}

static void send_event(uint16_t type, uint16_t code, int32_t value)
{
	struct input_event events[2] = { event_of(type, code, value), event_of(EV_SYN, SYN_REPORT, 0) };
	assert_int_equal(write(made, events, sizeof(events)), sizeof(events));
}

/* Detents of what has come; checks the order of times. */
static int take_detents(int64_t *last)
{
	int count = evdev_read(evdev, reports, 4096), turned = 0;
	for (int i = 0; i < count; i++) {
		assert_int_not_equal(reports[i].kind, EVDEV_RESET);
		assert_true(reports[i].time_ns >= *last && reports[i].time_ns <= clock_now_ns());
		*last = reports[i].time_ns;
		turned += reports[i].kind == EVDEV_TURN ? reports[i].value : 0;
	}
	return turned;
}

/* At a thousand a second, but never more ahead of the thread than the kernel's queue of 64 events holds: a guest's one
 * processor may have other things to do. */
static void a_thousand_detents_a_second_arrive_with_the_kernels_time(void **state)
{
	(void)state;
	if (no_uinput())
		return;
	make_knob();
	open_devices("name:" KNOB);
	assert_true(wait_for_state(EVDEV_GOOD) >= 0);
	int64_t began = clock_now_ns(), last = began - 1000; /* the kernel's stamps are of microseconds */
	int turned = 0;
	for (int i = 0; i < 500; i++) {
		clock_sleep_until(began + i * NS_PER_MS);
		send_event(EV_REL, REL_DIAL, 1);
		for (int ms = 0; ms < 1000 && (turned += take_detents(&last)) < i - 15; ms++)
			clock_sleep_until(clock_now_ns() + NS_PER_MS);
	}
	double took_s = (double)(clock_now_ns() - began) * 1e-9;
	send_event(EV_KEY, KEY_ENTER, 1);
	clock_sleep_until(clock_now_ns() + 50 * NS_PER_MS);
	turned += take_detents(&last);
	print_message("%d detents, %.0f a second\n", turned, 500.0 / took_s);
	assert_int_equal(turned, 500);
}

static void a_device_unplugged_is_told_and_comes_back(void **state)
{
	(void)state;
	if (no_uinput())
		return;
	make_knob();
	open_devices("name:" KNOB);
	assert_true(wait_for_state(EVDEV_GOOD) >= 0);
	close(made);
	assert_true(wait_for_state(EVDEV_GONE) >= 0);
	make_knob();
	assert_true(wait_for_state(EVDEV_GOOD) >= 0);
	send_event(EV_REL, REL_DIAL, -1);
	clock_sleep_until(clock_now_ns() + 50 * NS_PER_MS);
	assert_int_equal(evdev_read(evdev, reports, 4096), 1);
	assert_int_equal(reports[0].value, -1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(relative_axes_are_detents),
		cmocka_unit_test(an_absolute_knob_counts_on_and_wraps),
		cmocka_unit_test(keys_are_told_as_they_are),
		cmocka_unit_test(what_comes_with_lost_events_is_passed_over_and_told),
		cmocka_unit_test_teardown(a_device_that_is_not_there_is_a_state, stop),
		cmocka_unit_test_teardown(a_thousand_detents_a_second_arrive_with_the_kernels_time, stop),
		cmocka_unit_test_teardown(a_device_unplugged_is_told_and_comes_back, stop),
	};
	log_init("test", LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
