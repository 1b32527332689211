/* What values of tags mean: units, speeds, colours, directions. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tools/read/tag_value.h"
#include "tools/read/text.h"

static void lengths_have_units(void **state)
{
	static const struct {
		const char *value;
		enum tag_verdict verdict;
		double metres;
	} cases[] = {
		{ "12", TAG_GOOD, 12.0 },
		{ "12.5", TAG_GOOD, 12.5 },
		{ "12 m", TAG_GOOD, 12.0 },
		{ "12m", TAG_GOOD, 12.0 },
		{ "-3", TAG_GOOD, -3.0 },
		{ "12,5", TAG_MENDED, 12.5 },
		{ "~15", TAG_MENDED, 15.0 },
		{ "10;12", TAG_MENDED, 10.0 },
		{ "10-12 m", TAG_MENDED, 10.0 },
		{ "40 ft", TAG_GOOD, 12.192 },
		{ "40'", TAG_GOOD, 12.192 },
		{ "12'6\"", TAG_GOOD, 3.81 },
		{ "12 ft 6 in", TAG_GOOD, 3.81 },
		{ "6\"", TAG_GOOD, 0.1524 },
		{ "0.5 km", TAG_GOOD, 500.0 },
		{ "0.1 mi", TAG_GOOD, 160.9344 },
		{ "", TAG_BAD, 0.0 },
		{ "tall", TAG_BAD, 0.0 },
		{ "nan", TAG_BAD, 0.0 },
		{ "inf", TAG_BAD, 0.0 },
		{ "0x10", TAG_BAD, 0.0 },
		{ "12 parsecs", TAG_BAD, 0.0 },
	};
	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		double metres = 0.0;
		assert_int_equal(tag_length_m(cases[i].value, &metres), cases[i].verdict);
		if (fabs(metres - cases[i].metres) > 1e-9)
			fail_msg("'%s' is %g m, not %g", cases[i].value, metres, cases[i].metres);
	}
}

static void speeds_have_units_and_countries(void **state)
{
	static const struct {
		const char *value;
		enum tag_verdict verdict;
		int kmh;
	} cases[] = {
		{ "50", TAG_GOOD, 50 },
		{ "30 mph", TAG_GOOD, 48 },
		{ "30mph", TAG_GOOD, 48 },
		{ "50 km/h", TAG_GOOD, 50 },
		{ "10 knots", TAG_GOOD, 19 },
		{ "walk", TAG_GOOD, 7 },
		{ "none", TAG_GOOD, 130 },
		{ "CH:urban", TAG_GOOD, 50 },
		{ "DE:rural", TAG_GOOD, 100 },
		{ "CH:rural", TAG_GOOD, 80 },
		{ "FR:zone30", TAG_GOOD, 30 },
		{ "GB:nsl_single", TAG_GOOD, 97 },
		{ "signals", TAG_GOOD, 0 },
		{ "50;30", TAG_MENDED, 50 },
		{ "0", TAG_BAD, 0 },
		{ "999", TAG_BAD, 0 },
		{ "XX:nonsense", TAG_BAD, 0 },
		{ "fast", TAG_BAD, 0 },
	};
	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		int kmh = 0;
		assert_int_equal(tag_speed_kmh(cases[i].value, &kmh), cases[i].verdict);
		if (kmh != cases[i].kmh)
			fail_msg("'%s' is %d km/h, not %d", cases[i].value, kmh, cases[i].kmh);
	}
}

static void colours_are_names_or_hex(void **state)
{
	static const struct {
		const char *value;
		enum tag_verdict verdict;
		uint32_t rgb;
	} cases[] = {
		{ "#a1b2c3", TAG_GOOD, 0xa1b2c3 },
		{ "#ABC", TAG_GOOD, 0xaabbcc },
		{ "red", TAG_GOOD, 0xff0000 },
		{ "LightGrey", TAG_GOOD, 0xd3d3d3 },
		{ "light_gray", TAG_GOOD, 0xd3d3d3 },
		{ "white;grey", TAG_MENDED, 0xffffff },
		{ "#12", TAG_BAD, 0 },
		{ "#gggggg", TAG_BAD, 0 },
		{ "sort of blue", TAG_BAD, 0 },
		{ "", TAG_BAD, 0 },
	};
	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct colour colour = { 0 };
		assert_int_equal(tag_colour(cases[i].value, &colour), cases[i].verdict);
		assert_int_equal(colour.given, cases[i].verdict != TAG_BAD);
		assert_int_equal((uint32_t)colour.rgb[0] << 16 | (uint32_t)colour.rgb[1] << 8 | colour.rgb[2], cases[i].rgb);
	}
}

static void directions_are_degrees_or_compass_points(void **state)
{
	static const struct {
		const char *value;
		enum tag_verdict verdict;
		double degrees;
	} cases[] = {
		{ "135", TAG_GOOD, 135.0 },
		{ "N", TAG_GOOD, 0.0 },
		{ "sse", TAG_GOOD, 157.5 },
		{ "-90", TAG_GOOD, 270.0 },
		{ "370", TAG_GOOD, 10.0 },
		{ "up", TAG_BAD, 0.0 },
	};
	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		double degrees = 0.0;
		assert_int_equal(tag_direction_deg(cases[i].value, &degrees), cases[i].verdict);
		assert_true(fabs(degrees - cases[i].degrees) < 1e-9);
	}
}

static void text_is_mended_to_utf8(void **state)
{
	static const struct {
		const char *given, *mended;
	} cases[] = {
		{ "Rue de Gen\xE8ve", "Rue de Gen\xC3\xA8ve" },
		{ "a\tb\x7F", "a b " },
		{ "\xC0\x80", "\xC3\x80 " },
		{ "ok \xE2\x82\xAC", "ok \xE2\x82\xAC" },
		{ "cut \xE2\x82", "cut \xC3\xA2 " },
	};
	(void)state;
	struct pool pool = { 0 };
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		assert_int_equal(text_is_clean(cases[i].given), !strcmp(cases[i].given, cases[i].mended));
		assert_string_equal(text_mend(&pool, cases[i].given), cases[i].mended);
		assert_true(text_is_clean(cases[i].mended));
	}
	pool_finish(&pool);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lengths_have_units),
		cmocka_unit_test(speeds_have_units_and_countries),
		cmocka_unit_test(colours_are_names_or_hex),
		cmocka_unit_test(directions_are_degrees_or_compass_points),
		cmocka_unit_test(text_is_mended_to_utf8),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
