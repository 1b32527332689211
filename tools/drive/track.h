/*
 * Follows a recorded log the way the runtime does, without pictures, and says how well: against the truth that
 * `blvd drive --truth` wrote, and against the log's own satellite fixes.
 */
#ifndef BLVD_TOOLS_DRIVE_TRACK_H
#define BLVD_TOOLS_DRIVE_TRACK_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "board/car.h"
#include "nav/destination.h"
#include "nav/nav.h"

struct truth_row {
	double time_s; /* from the first row, which is the log's first frame */
	double east_m, north_m, up_m, heading_deg, speed_mps;
	uint32_t half;
	double along_m;
};
struct truth {
	struct truth_row *rows;
	size_t count;
};

/* Returns 0, or -errno after logging one line that names file and line. */
int truth_read(struct truth *out, const char *path, const struct pkg_graph *net);
void truth_finish(struct truth *truth);

/* Tells whether a matched place is the true one: the same half-edge, or, since nobody can say when exactly a car in a
 * junction changes streets, one before or after it on a way of at most 24 m, no farther than 12 m as the crow flies. */
bool track_same_place(const struct graph *graph, uint32_t half, double along_m, const struct truth_row *truth);

struct track_options {
	const char *log;
	const struct pkg *pkg;     /* NULL: dead reckoning alone */
	const struct truth *truth; /* NULL: none */
	bool use_gnss;
	bool free;                                                   /* no route: what the bus asks for is not heard */
	double step_s;                                               /* between updates; 0: 0.02 */
	FILE *trace;                                                 /* CSV of what the navigator said; NULL none */
	void (*on_view)(void *context, const struct nav_view *view); /* called at every update with a city; or NULL */
	void *context;
};

/* One summary, errors in metres and degrees. Shares are of the time the car was on its way and its place was known. */
struct track_result {
	double seconds, km;
	/* with truth */
	uint64_t samples, right, exact, on_street;
	double wrong_run_m; /* longest stretch on a wrong street */
	double pos_p50_m, pos_p95_m, pos_max_m, heading_p95_deg, along_p95_m;
	/* route */
	bool routed;
	uint32_t reroutes;
	double off_route_s;
	bool arrived;
	/* dead reckoning against fixes, per stretch of a kilometre: starts on the fixes' place and heading */
	uint32_t stretches;
	double drift_p50_m_per_km, drift_p95_m_per_km, drift_max_m_per_km, cross_p50_m_per_km, along_p50_m_per_km;
	double yaw_bias_deg_s, speed_scale;
	uint64_t frames, frames_bad;
};

/* Returns 0 or -errno after logging one line. */
int track_log(const struct car *car, const struct track_options *options, struct track_result *out);

#endif
