/*
 * A position as gpsd reports it, from one line of its JSON (class TPV, protocol 3; gpsd_json(5)). Lines are hostile:
 * any bytes, any length, numbers that are none.
 */
#ifndef BLVD_PLATFORM_GNSS_FIX_H
#define BLVD_PLATFORM_GNSS_FIX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct gnss_fix {
	int64_t time_ns; /* when it was heard, on the clock of who reads */
	int64_t utc_ns;  /* since 1970, as the receiver says; 0 unknown */
	double lat_deg, lon_deg;
	double sigma_m; /* horizontal, one sigma; 0 unknown */
	bool has_course;
	double course_rad; /* clockwise from north; of a car that moves */
	double speed_mps;  /* over ground; negative unknown */
};

enum gnss_line {
	GNSS_LINE_OTHER,  /* valid or not, not ours */
	GNSS_LINE_FIX,    /* a position */
	GNSS_LINE_NO_FIX, /* the receiver says that it has none */
};

/* `text` need not end with a NUL. `out` is set with GNSS_LINE_FIX only; its time_ns is 0. */
enum gnss_line gnss_parse(const char *text, size_t size, struct gnss_fix *out);

#endif
