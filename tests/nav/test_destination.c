/* Lists of stops heard from the bus. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nav/destination.h"
#include "platform/can/dbc_boulevard.h"

static uint8_t memory[1 << 18];
static struct dbc dbc;

static int set_up(void **state)
{
	(void)state;
	struct arena arena;
	struct dbc_note note;
	arena_init(&arena, "test", memory, sizeof(memory));
	return dbc_parse(&dbc, dbc_boulevard_text, dbc_boulevard_size, &arena, &note);
}

static bool say(struct destination *destination, int count, int index, double lat, double lon)
{
	const struct dbc_message *message = dbc_find_message(&dbc, "DESTINATION");
	struct can_frame_rx frame;
	dbc_frame_init(message, &frame);
	dbc_encode(dbc_find_signal(&dbc, "DESTINATION", "StopCount"), count, &frame);
	dbc_encode(dbc_find_signal(&dbc, "DESTINATION", "StopIndex"), index, &frame);
	dbc_encode(dbc_find_signal(&dbc, "DESTINATION", "Latitude"), lat, &frame);
	dbc_encode(dbc_find_signal(&dbc, "DESTINATION", "Longitude"), lon, &frame);
	return destination_feed(destination, &frame);
}

static void a_list_counts_when_it_is_whole(void **state)
{
	(void)state;
	struct destination d;
	destination_init(&d, &dbc);
	assert_false(say(&d, 3, 1, 46.2, 6.15));
	assert_false(say(&d, 3, 2, -33.5, -70.6));
	assert_false(say(&d, 3, 1, 46.2, 6.15));
	assert_int_equal(d.stop_count, 0);
	assert_true(say(&d, 3, 0, 89.9, 179.999999));
	assert_int_equal(d.stop_count, 3);
	assert_true(fabs(d.stops[2].lat_deg + 33.5) < 1e-9 && fabs(d.stops[2].lon_deg + 70.6) < 1e-9);
	assert_true(fabs(d.stops[0].lon_deg - 179.999999) < 1e-9);
	for (int i = 0; i < 9; i++)
		assert_false(say(&d, 3, i % 3, d.stops[i % 3].lat_deg, d.stops[i % 3].lon_deg)); /* nothing new */
}

static void a_changed_stop_starts_a_new_list(void **state)
{
	(void)state;
	struct destination d;
	destination_init(&d, &dbc);
	say(&d, 2, 0, 1, 1);
	assert_true(say(&d, 2, 1, 2, 2));
	assert_false(say(&d, 2, 0, 5, 5));
	assert_true(d.stops[0].lat_deg < 2); /* still the old one */
	assert_true(say(&d, 2, 1, 2, 2));
	assert_true(d.stops[0].lat_deg > 4);
	assert_true(say(&d, 1, 0, 7, 7)); /* a shorter one */
	assert_int_equal(d.stop_count, 1);
	assert_true(say(&d, 0, 0, 0, 0)); /* none */
	assert_int_equal(d.stop_count, 0);
	assert_false(say(&d, 0, 0, 0, 0));
}

static void nonsense_is_not_heard(void **state)
{
	(void)state;
	struct destination d;
	destination_init(&d, &dbc);
	assert_false(say(&d, 9, 0, 1, 1));
	assert_false(say(&d, 1, 3, 1, 1));
	assert_false(say(&d, 1, 0, 95, 1));
	assert_false(say(&d, 1, 0, 1, 200));
	struct can_frame_rx other = { .id = 784, .len = 3 };
	assert_false(destination_feed(&d, &other));
	assert_int_equal(d.stop_count, 0);
	struct destination none = { 0 }; /* a car without the message */
	assert_false(say(&none, 1, 0, 1, 1));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_list_counts_when_it_is_whole),
		cmocka_unit_test(a_changed_stop_starts_a_new_list),
		cmocka_unit_test(nonsense_is_not_heard),
	};
	return cmocka_run_group_tests(tests, set_up, NULL);
}
