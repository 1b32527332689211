/* Sun positions against published ones, and what light is made of them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>
/* before cmocka */
#include <cmocka.h>

#include "render/sun.h"

static int64_t utc(int year, int month, int day, int hour, int minute, int second)
{
	struct tm tm = {
		.tm_year = year - 1900, .tm_mon = month - 1, .tm_mday = day, .tm_hour = hour, .tm_min = minute, .tm_sec = second
	};
	return (int64_t)timegm(&tm) * 1000000000;
}

static void assert_near(double got, double wanted, double within)
{
	if (fabs(got - wanted) > within)
		fail_msg("%f is not within %f of %f", got, within, wanted);
}

static void matches_published_positions(void **state)
{
	(void)state;
	static const struct {
		int at[6];
		double lat, lon, azimuth, elevation, within;
	} cases[] = {
		/* Reda and Andreas, NREL/TP-560-34302 (2008), table A5.1: Golden, 2003-10-17 12:30:30 UTC-7; zenith 50.11
		   with refraction of about 0.02 */
		{ { 2003, 10, 17, 19, 30, 30 }, 39.742476, -105.1786, 194.34024, 39.872, 0.03 },
		/* solstice noon in Greenwich: elevation 90 - 51.4779 + 23.4365 */
		{ { 2024, 6, 20, 12, 1, 50 }, 51.4779, 0.0, 180.0, 61.959, 0.15 },
		/* equinox on the equator, near noon (2024-03-20 03:06 UTC is the equinox): overhead within a degree */
		{ { 2024, 3, 20, 12, 7, 20 }, 0.0, 0.0, 0.0, 89.85, 0.25 },
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const int *t = cases[i].at;
		struct sun_position sun = sun_at(utc(t[0], t[1], t[2], t[3], t[4], t[5]), cases[i].lat, cases[i].lon);
		assert_near(sun.elevation_rad * 180.0 / BLVD_PI, cases[i].elevation, cases[i].within);
		if (cases[i].elevation < 80.0)
			assert_near(sun.azimuth_rad * 180.0 / BLVD_PI, cases[i].azimuth, cases[i].within * 2.0);
	}
}

static void rises_in_the_east_and_sets_in_the_west(void **state)
{
	(void)state;
	struct sun_position morning = sun_at(utc(2024, 3, 20, 7, 0, 0), 46.2, 6.15);
	struct sun_position evening = sun_at(utc(2024, 3, 20, 16, 0, 0), 46.2, 6.15);
	assert_true(morning.azimuth_rad > 0.3 * BLVD_PI && morning.azimuth_rad < 0.8 * BLVD_PI);
	assert_true(evening.azimuth_rad > 1.2 * BLVD_PI && evening.azimuth_rad < 1.7 * BLVD_PI);
	/* south of the equator noon is in the north */
	struct sun_position sydney = sun_at(utc(2024, 6, 21, 2, 0, 0), -33.87, 151.2);
	assert_true(cos(sydney.azimuth_rad) > 0.9);
}

static void longitude_wraps_at_the_antimeridian(void **state)
{
	(void)state;
	struct sun_position east = sun_at(utc(2024, 6, 21, 0, 0, 0), 10.0, 180.0);
	struct sun_position west = sun_at(utc(2024, 6, 21, 0, 0, 0), 10.0, -180.0);
	assert_near(east.azimuth_rad, west.azimuth_rad, 1e-9);
	assert_near(east.elevation_rad, west.elevation_rad, 1e-9);
	struct sun_position pole = sun_at(utc(2024, 6, 21, 0, 0, 0), 89.9, 0.0);
	assert_near(pole.elevation_rad * 180.0 / BLVD_PI, 23.4, 0.2);
}

static struct light_state light_at(double elevation_deg, double hour, double ambient, bool night)
{
	struct sun_position sun = { .azimuth_rad = 2.0, .elevation_rad = elevation_deg * BLVD_PI / 180.0 };
	struct light_state light;
	sun_light(&sun, hour, ambient, night, &light);
	return light;
}

static void light_follows_the_sun_without_steps(void **state)
{
	(void)state;
	struct light_state before = light_at(-30.0, 20.0, -1.0, false);
	for (double elevation = -30.0; elevation <= 60.0; elevation += 0.05) {
		struct light_state light = light_at(elevation, 20.0, -1.0, false);
		assert_true(light.night >= 0.0f && light.night <= 1.0f && light.lamps >= 0.0f && light.lamps <= 1.0f);
		assert_near(light.sky.z, before.sky.z, 0.01);
		assert_near(light.lamps, before.lamps, 0.03);
		assert_near(vec3_dot(light.direction, light.direction), 1.0, 1e-4);
		assert_true(light.direction.z > 0.0f);
		before = light;
	}
	assert_true(light_at(-20.0, 23.0, -1.0, false).night > 0.99f);
	assert_true(light_at(30.0, 12.0, -1.0, false).windows_lit < 0.001f);
}

static void windows_follow_the_clock(void **state)
{
	(void)state;
	float evening = light_at(-20.0, 20.5, -1.0, false).windows_lit,
		  late = light_at(-20.0, 3.0, -1.0, false).windows_lit;
	assert_true(evening > 0.3f && late > 0.0f && late < 0.1f);
	assert_true(light_at(-20.0, 19.0, -1.0, false).shops_lit > light_at(-20.0, 2.0, -1.0, false).shops_lit);
}

static void the_driver_may_ask_for_night(void **state)
{
	(void)state;
	struct light_state light = light_at(50.0, 12.0, 1.0, true);
	assert_near(light.night, 1.0, 1e-6);
	assert_true(light.windows_lit > 0.1f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(matches_published_positions),
		cmocka_unit_test(rises_in_the_east_and_sets_in_the_west),
		cmocka_unit_test(longitude_wraps_at_the_antimeridian),
		cmocka_unit_test(light_follows_the_sun_without_steps),
		cmocka_unit_test(windows_follow_the_clock),
		cmocka_unit_test(the_driver_may_ask_for_night),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
