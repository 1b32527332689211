/* The event ring, the choice by name, and a display that needs no screen. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include "platform/display/display.h"

/* The driver keeps what it allocated when it is unloaded; leaks of ours are looked for in other programs. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
	return "detect_leaks=0";
}

static void pump_nothing(struct display *display)
{
	(void)display;
}

static void events_come_in_order_and_the_oldest_are_dropped(void **state)
{
	(void)state;
	static const struct display_ops ops = { .name = "test", .pump = pump_nothing };
	struct display display = { .ops = &ops };
	struct display_event event;
	assert_false(display_poll(&display, &event));
	for (uint32_t i = 0; i < DISPLAY_EVENTS_MAX + 5; i++)
		display_push(&display, &(struct display_event){ .kind = DISPLAY_EVENT_RESIZE, .width = i });
	for (uint32_t i = 5; i < DISPLAY_EVENTS_MAX + 5; i++) {
		assert_true(display_poll(&display, &event));
		assert_int_equal(event.width, i);
	}
	assert_false(display_poll(&display, &event));
}

static void displays_have_names(void **state)
{
	(void)state;
	assert_ptr_equal(display_by_name("headless"), &display_surfaceless);
	assert_null(display_by_name("hologram"));
}

static void headless_opens_closes_and_opens_again(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		struct display display;
		struct display_config config = { .width = 64, .height = 32 };
		if (display_open(&display, &display_surfaceless, &config))
			skip();
		assert_int_equal(display.width, 64);
		assert_non_null(display_get_proc("glDrawElements"));
		assert_int_equal(display_present(&display), 0);
		display_close(&display);
		assert_null(display.ops);
		display_close(&display);
	}
}

static void headless_displays_take_turns(void **state)
{
	(void)state;
	struct display a, b;
	struct display_config config = { .width = 64, .height = 32 };
	if (display_open(&a, &display_surfaceless, &config))
		skip();
	assert_int_equal(display_open(&b, &display_surfaceless, &config), 0);
	assert_int_equal(display_use(&a), 0);
	assert_int_equal(display_use(&b), 0);
	display_close(&b);
	assert_int_equal(display_use(&a), 0); /* outlives the other's end */
	display_close(&a);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(events_come_in_order_and_the_oldest_are_dropped),
		cmocka_unit_test(displays_have_names),
		cmocka_unit_test(headless_opens_closes_and_opens_again),
		cmocka_unit_test(headless_displays_take_turns),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
