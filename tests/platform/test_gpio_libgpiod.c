/*
 * Lines of the kernel. What any machine can do: a chip that is not there is a state. The rest wants the simulated chip
 * of the emulator's guest, whose pins are files (board/test), and is skipped elsewhere.
 */
#include <glob.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/gpio/gpio.h"
#include "platform/gpio/quadrature.h"

#ifdef BLVD_HAVE_GPIOD
#define LIVE "/sys/kernel/config/gpio-sim/car/live"
#define NAME "/sys/kernel/config/gpio-sim/car/pins/chip_name"

enum { REVERSE, A, B, LINES };
static const char *const names[LINES] = { "reverse", "rotary-a", "rotary-b" };
static const unsigned offsets[LINES] = { 0, 3, 4 };
static _Alignas(64) uint8_t memory[2][1 << 20];
static struct arena arenas[2];
static struct gpio *opened[2];
static struct gpio_event events[4096];

static bool write_word(const char *path, const char *word)
{
	FILE *file = fopen(path, "we");
	bool done = file && fputs(word, file) >= 0;
	return file && fclose(file) == 0 && done;
}

/* The switches are to ground. The chip's number may change when it comes back. */
static void set_pin(int line, bool active)
{
	char pattern[128];
	glob_t found;
	snprintf(pattern, sizeof(pattern), "/sys/devices/platform/gpio-sim.*/gpiochip*/sim_gpio%u/pull", offsets[line]);
	assert_int_equal(glob(pattern, 0, NULL, &found), 0);
	assert_true(write_word(found.gl_pathv[0], active ? "pull-down" : "pull-up"));
	globfree(&found);
}

static void open_all_pins(void)
{
	glob_t found;
	assert_int_equal(glob("/sys/devices/platform/gpio-sim.*/gpiochip*/sim_gpio*/pull", 0, NULL, &found), 0);
	for (size_t i = 0; i < found.gl_pathc; i++)
		assert_true(write_word(found.gl_pathv[i], "pull-up"));
	globfree(&found);
}

static bool no_pins(void)
{
	if (access(LIVE, W_OK) == 0)
		return false;
	print_message("skipped: no simulated chip\n");
	return true;
}

/* Its device now: a machine may have chips of its own before it. */
static const char *chip_path(void)
{
	static char path[64] = "/dev/";
	FILE *file = fopen(NAME, "re");
	assert_true(file && fgets(path + 5, (int)sizeof(path) - 5, file));
	fclose(file);
	path[strcspn(path, "\n")] = 0;
	return path;
}

static struct gpio *open_lines(int which, const char *chip, unsigned count)
{
	struct gpio_line_config lines[LINES];
	for (unsigned i = 0; i < LINES; i++)
		lines[i] = (struct gpio_line_config){ chip, offsets[i], true, GPIO_BIAS_AS_IS };
	struct gpio_config config = { .consumer = "test", .lines = lines, .line_count = count, .names = names };
	arena_init(&arenas[which], "test", memory[which], sizeof(memory[which]));
	assert_int_equal(gpio_open(&opened[which], &gpio_libgpiod_ops, &config, &arenas[which]), 0);
	return opened[which];
}

static void close_lines(int which)
{
	gpio_close(opened[which]);
	opened[which] = NULL;
}

static int close_all(void **state)
{
	(void)state;
	close_lines(0);
	close_lines(1);
	return 0;
}

/* Until the line's state is what is wanted; in ms how long that took, -1 after three seconds. */
static int wait_for_state(struct gpio *gpio, unsigned line, enum gpio_state state)
{
	int64_t began = clock_now_ns(), now = began;
	for (; now - began < 3 * NS_PER_S; now = clock_now_ns()) {
		gpio_read(gpio, now, events, 4096);
		if (gpio->lines[line].state == state)
			return (int)((now - began) / NS_PER_MS);
		clock_sleep_until(now + NS_PER_MS);
	}
	return -1;
}

/* Up to a second. */
static int wait_for_events(struct gpio *gpio, int wanted)
{
	int count = 0;
	for (int ms = 0; ms < 1000 && count < wanted; ms++) {
		clock_sleep_until(clock_now_ns() + NS_PER_MS);
		count += gpio_read(gpio, clock_now_ns(), events + count, 4096 - count);
	}
	return count;
}

static void a_chip_that_is_not_there_is_a_state(void **state)
{
	(void)state;
	struct gpio *gpio = open_lines(0, "no-such-chip", LINES);
	assert_int_equal(gpio_read(gpio, clock_now_ns(), events, 4096), LINES);
	for (unsigned i = 0; i < LINES; i++)
		assert_int_equal(gpio->lines[i].state, GPIO_GONE);
	assert_int_equal(gpio->stats.losses, 0);
}

static void levels_are_there_at_once_and_edges_carry_the_kernels_time(void **state)
{
	(void)state;
	if (no_pins())
		return;
	set_pin(REVERSE, true);
	struct gpio *gpio = open_lines(0, "car-pins", LINES); /* by its label */
	assert_int_equal(gpio_read(gpio, clock_now_ns(), events, 4096), 2 * LINES);
	assert_true(gpio->lines[REVERSE].level && !gpio->lines[A].level);
	for (int i = 0; i < 6; i++) {
		if (i == 3) /* is off already */
			continue;
		int64_t before = clock_now_ns();
		set_pin(i % LINES, i % LINES != REVERSE && i < LINES);
		assert_int_equal(wait_for_events(gpio, 1), 1);
		assert_int_equal(events[0].kind, GPIO_EDGE);
		assert_int_equal(events[0].line, i % LINES);
		assert_true(events[0].time_ns >= before && events[0].time_ns <= clock_now_ns());
	}
}

static void a_line_in_use_elsewhere_is_taken_when_it_is_free(void **state)
{
	(void)state;
	if (no_pins())
		return;
	open_lines(0, chip_path() + strlen("/dev/"), 1);
	struct gpio *second = open_lines(1, chip_path(), LINES);
	gpio_read(second, clock_now_ns(), events, 4096);
	assert_int_equal(second->lines[REVERSE].state, GPIO_BUSY);
	assert_int_equal(second->lines[A].state, GPIO_GOOD);
	close_lines(0);
	int took_ms = wait_for_state(second, REVERSE, GPIO_GOOD);
	print_message("had it %d ms after it was free\n", took_ms);
	assert_true(took_ms >= 0 && took_ms < 1500);
}

/* The simulated chip tells of edges at the guest's ticks, 100 a second; faster ones would become one. Fast knobs:
 * test_gpio_thread. */
static void a_knob_is_counted(void **state)
{
	(void)state;
	if (no_pins())
		return;
	struct gpio *gpio = open_lines(0, chip_path(), LINES);
	struct quadrature knob;
	quadrature_init(&knob, 4);
	bool level[LINES] = { false };
	int detents = 0;
	gpio_read(gpio, clock_now_ns(), events, 4096);
	quadrature_level(&knob, 0, false, 0);
	quadrature_level(&knob, 1, false, 0);
	for (int i = 0; i < 80; i++) {
		int line = i % 2 ? B : A;
		level[line] = !level[line];
		set_pin(line, level[line]);
		assert_int_equal(wait_for_events(gpio, 1), 1);
		assert_int_equal(events[0].kind, GPIO_EDGE);
		detents += quadrature_edge(&knob, events[0].line == B, events[0].level, events[0].time_ns);
	}
	assert_int_equal(detents, 20);
}

static void a_chip_that_goes_away_comes_back_with_its_levels(void **state)
{
	(void)state;
	if (no_pins())
		return;
	struct gpio *gpio = open_lines(0, "car-pins", LINES);
	gpio_read(gpio, clock_now_ns(), events, 4096);
	assert_int_equal(gpio->lines[REVERSE].state, GPIO_GOOD);
	assert_true(write_word(LIVE, "0"));
	int gone_ms = wait_for_state(gpio, REVERSE, GPIO_GONE);
	/* the chip gets its number again once nobody has a line of it */
	assert_true(wait_for_state(gpio, A, GPIO_GONE) >= 0 && wait_for_state(gpio, B, GPIO_GONE) >= 0);
	assert_true(write_word(LIVE, "1"));
	open_all_pins(); /* made anew they are closed */
	int back_ms = wait_for_state(gpio, REVERSE, GPIO_GOOD);
	print_message("gone noticed after %d ms, back after %d ms\n", gone_ms, back_ms);
	assert_true(gone_ms >= 0 && gone_ms < 1500 && back_ms >= 0 && back_ms < 1500);
	assert_int_equal(gpio->stats.losses, LINES);
	gpio_read(gpio, clock_now_ns(), events, 4096);
	set_pin(REVERSE, true);
	for (int i = 0; i < 10 && !gpio->lines[REVERSE].level; i++)
		wait_for_events(gpio, 1);
	assert_true(gpio->lines[REVERSE].level);
	set_pin(REVERSE, false);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_teardown(a_chip_that_is_not_there_is_a_state, close_all),
		cmocka_unit_test_teardown(levels_are_there_at_once_and_edges_carry_the_kernels_time, close_all),
		cmocka_unit_test_teardown(a_line_in_use_elsewhere_is_taken_when_it_is_free, close_all),
		cmocka_unit_test_teardown(a_knob_is_counted, close_all),
		cmocka_unit_test_teardown(a_chip_that_goes_away_comes_back_with_its_levels, close_all),
	};
	log_init("test", LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
#else
int main(void)
{
	puts("built without libgpiod");
	return 0;
}
#endif
