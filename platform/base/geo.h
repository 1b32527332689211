/*
 * Geographic coordinates and the city's metric frame, header only.
 *
 * The frame is the ellipsoidal orthographic projection of WGS84 onto the tangent plane at the city's
 * origin: x east, y north, metres. It needs no special case at the antimeridian or the poles; its scale
 * error is d^2 / 2R^2 (1.2e-6 at 10 km). Heights are kept apart, as metres above the ellipsoid or sea level
 * as the data has them, so the plane does not drop with d^2 / 2R.
 *
 * Headings are binary angles: int32, a full turn is 2^32, 0 is north, clockwise is positive.
 */
#ifndef BLVD_PLATFORM_BASE_GEO_H
#define BLVD_PLATFORM_BASE_GEO_H

#include <math.h>
#include <stdint.h>

#include "platform/base/vec.h"

#define GEO_WGS84_A 6378137.0
#define GEO_WGS84_E2 6.69437999014131699614e-3 /* f (2 - f), f = 1 / 298.257223563 */

struct geo_point {
	double lat_deg; /* -90 to 90 */
	double lon_deg; /* any; taken modulo 360 */
};

struct geo_frame {
	struct geo_point origin;
	double sin_lat, cos_lat;
	double normal_radius; /* prime vertical radius at the origin, m */
};

static inline struct geo_frame geo_frame_at(struct geo_point origin)
{
	double lat = origin.lat_deg * (BLVD_PI / 180.0);
	double s = sin(lat);
	return (struct geo_frame){
		.origin = origin,
		.sin_lat = s,
		.cos_lat = cos(lat),
		.normal_radius = GEO_WGS84_A / sqrt(1.0 - GEO_WGS84_E2 * s * s),
	};
}

/* Longitude difference a - b in degrees, in [-180, 180]. */
static inline double geo_lon_diff(double a_deg, double b_deg)
{
	return remainder(a_deg - b_deg, 360.0);
}

/* Position in the frame's plane, m. Exact for the ellipsoid (Snyder, USGS PP 1395, orthographic; ellipsoidal form by
 * rotating geocentric coordinates). */
static inline struct dvec2 geo_to_plane(const struct geo_frame *frame, struct geo_point point)
{
	double lat = point.lat_deg * (BLVD_PI / 180.0);
	double lon = geo_lon_diff(point.lon_deg, frame->origin.lon_deg) * (BLVD_PI / 180.0);
	double s = sin(lat), c = cos(lat);
	double n = GEO_WGS84_A / sqrt(1.0 - GEO_WGS84_E2 * s * s);
	double n0 = frame->normal_radius;
	double dz = (1.0 - GEO_WGS84_E2) * (n * s - n0 * frame->sin_lat);
	double dx = n * c * cos(lon) - n0 * frame->cos_lat;
	return (struct dvec2){ n * c * sin(lon), frame->cos_lat * dz - frame->sin_lat * dx };
}

/* Inverse of geo_to_plane within 1,000 km of the origin; accurate to better than 1e-6 m there. */
static inline struct geo_point geo_from_plane(const struct geo_frame *frame, struct dvec2 at)
{
	/* Newton on the up coordinate u: the point origin + (e, n, u) must lie on the ellipsoid. */
	double n0 = frame->normal_radius;
	double sl = frame->sin_lat, cl = frame->cos_lat;
	double b2_ratio = 1.0 / (1.0 - GEO_WGS84_E2); /* a^2 / b^2 */
	double x0 = n0 * cl - sl * at.y, z0 = n0 * (1.0 - GEO_WGS84_E2) * sl + cl * at.y;
	double u = 0.0;
	for (int i = 0; i < 8; i++) {
		double x = x0 + cl * u, z = z0 + sl * u;
		double g = x * x + at.x * at.x + z * z * b2_ratio - GEO_WGS84_A * GEO_WGS84_A;
		double slope = 2.0 * (x * cl + z * sl * b2_ratio);
		u -= g / slope;
	}
	double x = x0 + cl * u, z = z0 + sl * u;
	struct geo_point out;
	out.lat_deg = atan2(z * b2_ratio, hypot(x, at.x)) * (180.0 / BLVD_PI);
	out.lon_deg = remainder(frame->origin.lon_deg + atan2(at.x, x) * (180.0 / BLVD_PI), 360.0);
	return out;
}

/* Binary angle of a heading in radians (clockwise from north); any finite value. */
static inline int32_t bam_from_rad(double rad)
{
	double turns = rad / (2.0 * BLVD_PI);
	turns -= floor(turns + 0.5);
	return (int32_t)(uint32_t)(int64_t)llrint(turns * 4294967296.0);
}

/* In [-pi, pi). */
static inline double bam_to_rad(int32_t bam)
{
	return bam * (BLVD_PI / 2147483648.0);
}

/* a - b by the shorter way round. */
static inline int32_t bam_diff(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a - (uint32_t)b);
}

/* Heading of a direction in the plane (x east, y north). */
static inline int32_t bam_from_dir(double east, double north)
{
	return bam_from_rad(atan2(east, north));
}

#endif
