/* Low-precision solar coordinates, and a palette blended by the sun's elevation. */
#include "render/sun.h"

#include <math.h>

static double deg(double rad)
{
	return rad * (180.0 / BLVD_PI);
}

static double rad(double degrees)
{
	return degrees * (BLVD_PI / 180.0);
}

/* Declination (rad) and equation of time (minutes), `t` Julian centuries since J2000.0. */
static void solar_coordinates(double t, double *declination, double *equation_of_time)
{
	double mean_longitude = rad(fmod(280.46646 + t * (36000.76983 + t * 0.0003032), 360.0));
	double anomaly = rad(357.52911 + t * (35999.05029 - t * 0.0001537));
	double eccentricity = 0.016708634 - t * (0.000042037 + t * 0.0000001267);
	double center = sin(anomaly) * (1.914602 - t * (0.004817 + t * 0.000014)) +
					sin(2.0 * anomaly) * (0.019993 - t * 0.000101) + sin(3.0 * anomaly) * 0.000289;
	double node = rad(125.04 - 1934.136 * t);
	double apparent = mean_longitude + rad(center - 0.00569 - 0.00478 * sin(node));
	double seconds = 21.448 - t * (46.815 + t * (0.00059 - t * 0.001813));
	double obliquity = rad(23.0 + (26.0 + seconds / 60.0) / 60.0 + 0.00256 * cos(node));
	*declination = asin(sin(obliquity) * sin(apparent));
	double y = tan(obliquity / 2.0) * tan(obliquity / 2.0);
	double radians = y * sin(2.0 * mean_longitude) - 2.0 * eccentricity * sin(anomaly) +
					 4.0 * eccentricity * y * sin(anomaly) * cos(2.0 * mean_longitude) -
					 0.5 * y * y * sin(4.0 * mean_longitude) - 1.25 * eccentricity * eccentricity * sin(2.0 * anomaly);
	*equation_of_time = 4.0 * deg(radians);
}

struct sun_position sun_at(int64_t wall_ns, double lat_deg, double lon_deg)
{
	double days = (double)wall_ns / 86400e9; /* since 1970-01-01 */
	double century = (days + 2440587.5 - 2451545.0) / 36525.0;
	double declination, equation_of_time;
	solar_coordinates(century, &declination, &equation_of_time);
	double minutes = (days - floor(days)) * 1440.0 + equation_of_time + 4.0 * lon_deg;
	double hour_angle = rad(remainder(minutes / 4.0 - 180.0, 360.0));
	double lat = rad(lat_deg);
	double sin_elevation = sin(lat) * sin(declination) + cos(lat) * cos(declination) * cos(hour_angle);
	double east = -cos(declination) * sin(hour_angle);
	double north = cos(lat) * sin(declination) - sin(lat) * cos(declination) * cos(hour_angle);
	double azimuth = atan2(east, north);
	return (struct sun_position){
		.azimuth_rad = azimuth < 0.0 ? azimuth + 2.0 * BLVD_PI : azimuth,
		.elevation_rad = asin(fmax(-1.0, fmin(1.0, sin_elevation))),
	};
}

struct palette {
	struct vec3 sun, sky, ground, haze, zenith;
};

/* Linear light. Day: high sun; dusk: sun on the horizon; night: moon. Kept a little below white so that the route,
 * drawn on top, stays the brightest thing. */
static const struct palette day = {
	.sun = { 1.08f, 0.97f, 0.82f },
	.sky = { 0.50f, 0.535f, 0.585f },
	.ground = { 0.27f, 0.25f, 0.23f },
	.haze = { 0.62f, 0.70f, 0.78f },
	.zenith = { 0.17f, 0.33f, 0.60f },
};
static const struct palette dusk = {
	.sun = { 0.60f, 0.31f, 0.15f },
	.sky = { 0.225f, 0.228f, 0.285f },
	.ground = { 0.115f, 0.10f, 0.10f },
	.haze = { 0.47f, 0.35f, 0.29f },
	.zenith = { 0.070f, 0.110f, 0.205f },
};
static const struct palette night = {
	.sun = { 0.030f, 0.037f, 0.056f },
	.sky = { 0.050f, 0.062f, 0.096f },
	.ground = { 0.026f, 0.027f, 0.036f },
	.haze = { 0.020f, 0.026f, 0.044f },
	.zenith = { 0.0045f, 0.0065f, 0.0150f },
};

static double ramp(double from, double to, double x)
{
	double t = fmax(0.0, fmin(1.0, (x - from) / (to - from)));
	return t * t * (3.0 - 2.0 * t);
}

static struct vec3 mix(struct vec3 a, struct vec3 b, float t)
{
	return vec3_add(vec3_scale(a, 1.0f - t), vec3_scale(b, t));
}

static struct palette mix_palette(const struct palette *a, const struct palette *b, float t)
{
	return (struct palette){ mix(a->sun, b->sun, t), mix(a->sky, b->sky, t), mix(a->ground, b->ground, t),
		mix(a->haze, b->haze, t), mix(a->zenith, b->zenith, t) };
}

/* Share of lit windows by the clock: homes in the evening, few late, some in the early morning. */
static double windows_by_hour(double hour)
{
	double evening = ramp(16.0, 20.0, hour) * (1.0 - 0.85 * ramp(21.5, 24.0, hour));
	double after_midnight = 0.15 * (1.0 - ramp(0.0, 2.5, hour));
	double morning = 0.5 * ramp(5.0, 7.0, hour) * (1.0 - ramp(7.5, 9.5, hour));
	double share = hour < 3.0 ? after_midnight : fmax(evening, morning);
	return 0.03 + 0.42 * share;
}

static struct vec3 direction(double azimuth, double elevation)
{
	return (struct vec3){ (float)(sin(azimuth) * cos(elevation)), (float)(cos(azimuth) * cos(elevation)),
		(float)sin(elevation) };
}

void sun_light(
	const struct sun_position *sun, double local_hour, double ambient, bool force_night, struct light_state *out)
{
	double elevation = force_night ? rad(-20.0) : sun->elevation_rad;
	double hour = force_night && local_hour > 8.0 && local_hour < 20.0 ? 21.0 : local_hour;
	double up = ramp(rad(0.0), rad(16.0), elevation), dark = ramp(rad(-1.0), rad(-9.0), elevation);
	struct palette now = mix_palette(&dusk, &day, (float)up);
	now = mix_palette(&now, &night, (float)dark);
	float dim = ambient < 0.0 ? 1.0f : (float)(0.7 + 0.3 * ramp(0.0, 0.5, ambient));
	struct vec3 moon = direction(rad(150.0), rad(40.0));
	struct vec3 towards = direction(sun->azimuth_rad, fmax(elevation, rad(3.0)));
	*out = (struct light_state){
		.direction = vec3_normalize(mix(towards, moon, (float)ramp(0.6, 1.0, dark))),
		.sun = vec3_scale(now.sun, dim),
		.sky = now.sky,
		.ground = now.ground,
		.haze = now.haze,
		.zenith = now.zenith,
		.night = (float)dark,
		.lamps = (float)ramp(rad(3.0), rad(-3.0), elevation),
		.stars = (float)ramp(rad(-7.0), rad(-14.0), elevation),
		.haze_per_m = (float)(1.0 / 4200.0),
	};
	double evening_light = ramp(rad(6.0), rad(-5.0), elevation);
	out->windows_lit = (float)(evening_light * windows_by_hour(hour));
	out->shops_lit = (float)(evening_light * (hour > 6.5 && hour < 22.5 ? 0.8 : 0.25));
}
