/*
 * Where the sun stands, and what light that makes: NOAA's solar position algorithm (after J. Meeus, "Astronomical
 * Algorithms", 2nd ed. 1998, ch. 25 and 28), good to 0.01 degree between 1901 and 2099, without refraction.
 */
#ifndef BLVD_RENDER_SUN_H
#define BLVD_RENDER_SUN_H

#include <stdbool.h>
#include <stdint.h>

#include "platform/base/vec.h"

struct sun_position {
	double azimuth_rad;   /* clockwise from north, 0 to 2 pi */
	double elevation_rad; /* above the horizon */
};

/* `wall_ns` is UTC since 1970. */
struct sun_position sun_at(int64_t wall_ns, double lat_deg, double lon_deg);

/* The light of a moment: everything linear, for the Frame block. */
struct light_state {
	struct vec3 direction; /* towards the sun, or the moon at night */
	struct vec3 sun;       /* its light */
	struct vec3 sky;       /* ambient from above */
	struct vec3 ground;    /* ambient from below */
	struct vec3 haze;      /* at the horizon */
	struct vec3 zenith;
	float night;       /* 0 day to 1 night */
	float lamps;       /* street lamps, 0 off to 1 */
	float windows_lit; /* share of windows */
	float shops_lit;   /* share of shop fronts */
	float stars;       /* 0 to 1 */
	float haze_per_m;  /* extinction */
};

/* `local_hour` is 0 to 24 of the city's clock: people's windows follow it, not the sun. `ambient` 0 to 1 darkens a day,
 * negative is unknown. */
void sun_light(
	const struct sun_position *sun, double local_hour, double ambient, bool force_night, struct light_state *out);

#endif
