/*
 * The overlay's words and numbers: distances rounded as drivers expect them, times, states of inputs. All write a
 * NUL-terminated UTF-8 string into the caller's buffer of WORDING_MAX bytes.
 */
#ifndef BLVD_RENDER_WORDING_H
#define BLVD_RENDER_WORDING_H

#include <stdbool.h>
#include <stdint.h>

#include "assets/pkg.h"
#include "nav/nav.h"

#define WORDING_MAX 96

enum wording_units {
	UNITS_AUTO, /* by the city's place: wording_units_of() */
	UNITS_METRIC,
	UNITS_MILES_FEET,  /* United States */
	UNITS_MILES_YARDS, /* United Kingdom */
};

/* From the city's origin and the side of the road; borders are rough boxes. Never UNITS_AUTO. */
enum wording_units wording_units_of(const struct pkg_meta *meta);

/* "Now" under 10 m; then 20 m, 150 m, 1.2 km, 15 km. Negative counts as 0. */
void wording_distance(char *out, double distance_m, enum wording_units units);
/* "5 min", "1 h 05 min"; at least 1 min. */
void wording_duration(char *out, double seconds);
/* "14:05" of a UTC time and the zone's offset. */
void wording_clock(char *out, int64_t wall_ns, int32_t offset_minutes);
/* Whole km/h or mph of a speed, never negative. */
int wording_speed(double speed_mps, enum wording_units units);
const char *wording_speed_unit(enum wording_units units);
/* A limit in km/h on the sign of this country. */
int wording_limit(int32_t limit_kmh, enum wording_units units);
/* "Turn left", "Take exit 2"; used where the next street has no name. */
void wording_manoeuvre(char *out, enum nav_manoeuvre manoeuvre, unsigned exit);
/* What the driver should know of the inputs, the gravest first; false when nothing is wrong. */
bool wording_inputs(char *out, const struct nav_view *nav);
/* How well the place is known, when that is not well: "Position within 60 m, for 25 s"; two sigma. With `after`, words
 * that it goes on from, only the distance. False when the place is sure. */
bool wording_place(char *out, const struct nav_view *nav, enum wording_units units, const char *after);

#endif
