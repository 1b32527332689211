/* The overlay's words and numbers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "render/wording.h"

#define COUNT(rows) (sizeof(rows) / sizeof((rows)[0]))

static void distances_are_rounded_as_drivers_expect(void **state)
{
	(void)state;
	static const struct {
		double distance_m;
		enum wording_units units;
		const char *words;
	} rows[] = {
		{ -3.0, UNITS_METRIC, "Now" },
		{ 0.0, UNITS_METRIC, "Now" },
		{ 9.9, UNITS_METRIC, "Now" },
		{ NAN, UNITS_METRIC, "Now" },
		{ 10.0, UNITS_METRIC, "10 m" },
		{ 24.0, UNITS_METRIC, "20 m" },
		{ 94.0, UNITS_METRIC, "90 m" },
		{ 96.0, UNITS_METRIC, "100 m" },
		{ 130.0, UNITS_METRIC, "150 m" },
		{ 420.0, UNITS_METRIC, "400 m" },
		{ 970.0, UNITS_METRIC, "950 m" },
		{ 980.0, UNITS_METRIC, "1.0 km" },
		{ 1240.0, UNITS_METRIC, "1.2 km" },
		{ 9960.0, UNITS_METRIC, "10 km" },
		{ 15400.0, UNITS_METRIC, "15 km" },
		{ 1e12, UNITS_METRIC, "99999 km" },
		{ 30.0, UNITS_MILES_FEET, "100 ft" },
		{ 200.0, UNITS_MILES_FEET, "650 ft" },
		{ 330.0, UNITS_MILES_FEET, "0.2 mi" },
		{ 3000.0, UNITS_MILES_FEET, "1.9 mi" },
		{ 30.0, UNITS_MILES_YARDS, "30 yd" },
		{ 150.0, UNITS_MILES_YARDS, "150 yd" },
		{ 32187.0, UNITS_MILES_YARDS, "20 mi" },
	};
	for (size_t i = 0; i < COUNT(rows); i++) {
		char words[WORDING_MAX];
		wording_distance(words, rows[i].distance_m, rows[i].units);
		assert_string_equal(words, rows[i].words);
	}
}

static void times_read_as_clocks(void **state)
{
	(void)state;
	static const struct {
		double seconds;
		const char *words;
	} durations[] = { { 0.0, "1 min" }, { 89.0, "1 min" }, { 91.0, "2 min" }, { 3570.0, "1 h 00 min" },
		{ 7500.0, "2 h 05 min" }, { 1e9, "99 h 00 min" } };
	for (size_t i = 0; i < COUNT(durations); i++) {
		char words[WORDING_MAX];
		wording_duration(words, durations[i].seconds);
		assert_string_equal(words, durations[i].words);
	}
	char words[WORDING_MAX];
	wording_clock(words, INT64_C(1750000000000000000), 0); /* 2025-06-15 15:06:40 UTC */
	assert_string_equal(words, "15:06");
	wording_clock(words, INT64_C(1750000000000000000), 600);
	assert_string_equal(words, "01:06");
	wording_clock(words, INT64_C(60000000000), -120);
	assert_string_equal(words, "22:01");
}

static void units_follow_the_country(void **state)
{
	(void)state;
	static const struct {
		double lat, lon;
		uint32_t right;
		enum wording_units units;
	} rows[] = {
		{ 46.2, 6.1, 1, UNITS_METRIC },         /* Geneva */
		{ 37.79, -122.4, 1, UNITS_MILES_FEET }, /* San Francisco */
		{ 51.5, -0.1, 0, UNITS_MILES_YARDS },   /* London */
		{ 48.86, 2.35, 1, UNITS_METRIC },       /* Paris */
		{ -33.9, 151.2, 0, UNITS_METRIC },      /* Sydney */
		{ 21.3, -157.8, 1, UNITS_MILES_FEET },  /* Honolulu */
		{ 53.5, -113.5, 1, UNITS_METRIC },      /* Edmonton */
	};
	for (size_t i = 0; i < COUNT(rows); i++) {
		struct pkg_meta meta = { .origin_lat_deg = rows[i].lat, .origin_lon_deg = rows[i].lon };
		meta.right_hand_traffic = rows[i].right;
		assert_int_equal(wording_units_of(&meta), rows[i].units);
	}
}

static void limits_are_those_on_the_signs(void **state)
{
	(void)state;
	assert_int_equal(wording_limit(50, UNITS_METRIC), 50);
	assert_int_equal(wording_limit(48, UNITS_MILES_YARDS), 30);
	assert_int_equal(wording_limit(105, UNITS_MILES_FEET), 65);
	assert_int_equal(wording_speed(-5.0, UNITS_METRIC), 18);
	assert_int_equal(wording_speed(13.4, UNITS_MILES_FEET), 30);
}

static struct nav_view good_view(void)
{
	struct nav_view nav = { .located = true };
	for (int i = 0; i < NAV_SIGNAL_COUNT; i++)
		nav.signal[i] = NAV_SIGNAL_GOOD;
	return nav;
}

static void the_gravest_input_state_is_named(void **state)
{
	(void)state;
	char words[WORDING_MAX];
	struct nav_view nav = good_view();
	assert_false(wording_inputs(words, &nav));
	nav.signal[NAV_SIGNAL_GEAR] = NAV_SIGNAL_WAITING; /* not worth a line */
	assert_false(wording_inputs(words, &nav));
	nav.signal[NAV_SIGNAL_LATITUDE] = NAV_SIGNAL_WAITING;
	assert_true(wording_inputs(words, &nav));
	assert_string_equal(words, "GPS: none yet");
	nav.on_street = true; /* dead reckoning knows the place well enough */
	nav.uncertainty_m = 3.0;
	assert_false(wording_inputs(words, &nav));
	nav.uncertainty_m = 30.0;
	assert_true(wording_inputs(words, &nav));
	nav.signal[NAV_SIGNAL_SPEED] = NAV_SIGNAL_STALE;
	nav.signal_age_ns[NAV_SIGNAL_SPEED] = INT64_C(3200000000);
	assert_true(wording_inputs(words, &nav));
	assert_string_equal(words, "Speed signal lost 3 s");
	nav.signal_age_ns[NAV_SIGNAL_SPEED] = INT64_MAX;
	assert_true(wording_inputs(words, &nav));
	assert_string_equal(words, "Speed signal lost");
	nav.signal[NAV_SIGNAL_SPEED] = NAV_SIGNAL_IMPLAUSIBLE;
	assert_true(wording_inputs(words, &nav));
	assert_string_equal(words, "Speed signal implausible");
	nav.located = false;
	assert_true(wording_inputs(words, &nav));
	assert_string_equal(words, "No position");
	nav.bus = NAV_BUS_OFF; /* why there is nothing else */
	nav.bus_age_ns = INT64_C(12900000000);
	snprintf(nav.bus_name, sizeof(nav.bus_name), "can0");
	assert_true(wording_inputs(words, &nav));
	assert_string_equal(words, "Bus can0 off 12 s");
	nav.bus = NAV_BUS_DOWN;
	nav.bus_age_ns = INT64_MAX;
	assert_true(wording_inputs(words, &nav));
	assert_string_equal(words, "Bus can0 down");
}

static void a_drifting_place_is_told_with_its_age(void **state)
{
	(void)state;
	char words[WORDING_MAX];
	struct nav_view nav = good_view();
	nav.doubt = (struct nav_doubt){ .place = NAV_PLACE_SURE, .major_m = 3.0 };
	assert_false(wording_place(words, &nav, UNITS_METRIC, NULL));
	nav.doubt = (struct nav_doubt){ .place = NAV_PLACE_DRIFTING, .major_m = 30.0, .age_ns = INT64_C(25300000000) };
	assert_true(wording_place(words, &nav, UNITS_METRIC, NULL));
	assert_string_equal(words, "Position within 60 m, for 25 s");
	assert_true(wording_place(words, &nav, UNITS_METRIC, "GPS lost 12 s"));
	assert_string_equal(words, "GPS lost 12 s, position within 60 m");
	nav.doubt.age_ns = INT64_MAX;
	assert_true(wording_place(words, &nav, UNITS_MILES_FEET, NULL));
	assert_string_equal(words, "Position within 200 ft");
	nav.doubt = (struct nav_doubt){ .place = NAV_PLACE_REMEMBERED, .major_m = 3.0 };
	assert_false(wording_place(words, &nav, UNITS_METRIC, NULL));
	nav.doubt.major_m = 40.0;
	assert_true(wording_place(words, &nav, UNITS_METRIC, NULL));
	assert_string_equal(words, "Last position, within 80 m");
	nav.located = false;
	assert_false(wording_place(words, &nav, UNITS_METRIC, NULL));
}

static void every_manoeuvre_has_words(void **state)
{
	(void)state;
	char words[WORDING_MAX];
	for (int i = NAV_MANOEUVRE_NONE; i <= NAV_MANOEUVRE_ARRIVE; i++) {
		wording_manoeuvre(words, (enum nav_manoeuvre)i, 0);
		assert_true(strlen(words) > 3);
	}
	wording_manoeuvre(words, NAV_MANOEUVRE_ROUNDABOUT, 2);
	assert_string_equal(words, "Take exit 2");
	wording_manoeuvre(words, (enum nav_manoeuvre)99, 0);
	assert_true(strlen(words) > 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(distances_are_rounded_as_drivers_expect),
		cmocka_unit_test(times_read_as_clocks),
		cmocka_unit_test(units_follow_the_country),
		cmocka_unit_test(limits_are_those_on_the_signs),
		cmocka_unit_test(the_gravest_input_state_is_named),
		cmocka_unit_test(a_drifting_place_is_told_with_its_age),
		cmocka_unit_test(every_manoeuvre_has_words),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
