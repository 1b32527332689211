/*
 * `blvd drive`: a car that drives a route over a city's streets, as a CAN log. The steps, each a file:
 * choose.c  stops for a seed, or those asked for, and the route between them
 * path.c    the line the car takes: lane centres, rounded corners
 * motion.c  when it is where: limits, curves, signals, stops
 * bus.c     what its bus says: frames by board/profiles/boulevard.dbc
 * plan.c    all of these, and cut to the time that is there
 * All is deterministic by the options. `blvd sim` drives the same car live.
 */
#ifndef BLVD_TOOLS_DRIVE_DRIVE_H
#define BLVD_TOOLS_DRIVE_DRIVE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "nav/destination.h"
#include "nav/guidance.h"
#include "nav/route.h"
#include "platform/can/dbc.h"
#include "tools/city/pool.h"

struct drive_options {
	uint64_t seed;
	double minutes; /* 0: as long as the route takes */
	bool has_start;
	struct geo_point start;
	struct geo_point via[DESTINATION_STOPS_MAX];
	uint32_t via_count;  /* 0: the seed chooses */
	bool gnss;           /* all along, not in the first seconds alone */
	int64_t wall_ns;     /* since 1970 UTC at the start */
	double speed_error;  /* said speed = true speed * (1 + speed_error); NAN: up to 0.5 % by the seed */
	double yaw_bias_rps; /* NAN: up to 0.1 deg/s by the seed */
};

/* Everything that the steps share; the streets are borrowed from the package. */
struct drive {
	const struct pkg *pkg;
	const struct drive_options *options;
	struct graph graph;
	struct route_search search;
	struct guidance guidance;
	struct route route;
	struct route_place start;
	struct route_place stops[DESTINATION_STOPS_MAX];
	struct geo_point stop_at[DESTINATION_STOPS_MAX]; /* as the bus says them */
	uint32_t stop_count;
};

/* Memory that drive_init() takes from the arena. */
size_t drive_bytes(const struct pkg_graph *net);

/* Returns 0 or -ENOMEM. */
int drive_init(struct drive *drive, struct arena *arena, const struct pkg *pkg, const struct drive_options *options);

/* Fills start, stops and route. Returns 0, or -1 after logging one line: no street near a place, no route. */
int drive_choose(struct drive *drive);

/* Ends the route at a place of it: the new last stop. Stops behind it are dropped. Returns 0 or -1 as above. */
int drive_cut(struct drive *drive, uint32_t route_index, double along_m);

/* The line, sampled every DRIVE_STEP_M of its own length. */
#define DRIVE_STEP_M 0.25
struct drive_point {
	struct dvec3 at;    /* rear axle, city frame, m */
	double heading_rad; /* not wrapped: grows through full turns */
	double curvature;   /* 1/m, clockwise positive */
	uint32_t index;     /* of the route */
	double along_m;
};
struct drive_path {
	ARRAY(struct drive_point) points;
};
void path_build(const struct drive *drive, struct drive_path *out);
void path_finish(struct drive_path *path);

/* The car at a time. */
struct drive_state {
	double time_s; /* from the start of the log */
	struct dvec3 at;
	double heading_rad, speed_mps, accel_mps2, yaw_rate_rps, curvature, odometer_m;
	uint32_t half;
	double along_m;
	int lamp;           /* -1 left, 1 right, 2 both */
	bool parked;        /* gear P */
	enum nav_gear gear; /* for a car that is driven by hand; UNKNOWN: P when parked, else D */
	bool driving;       /* after the first standing, before the last */
};

struct drive_motion {
	const struct drive *drive;
	const struct drive_path *path;
	ARRAY(double) speed; /* by point, m/s */
	ARRAY(double) time;  /* by point, s; arrival */
	ARRAY(double) dwell; /* by point, s; standing there */
	ARRAY(int) lamp;     /* by point */
	double end_s;        /* the last point plus standing */
	size_t cursor;
};
void motion_build(const struct drive *drive, const struct drive_path *path, struct drive_motion *out);
void motion_finish(struct drive_motion *motion);

/* State at a time; times must not go back. */
struct drive_state motion_at(struct drive_motion *motion, double time_s);

/* What the car's bus says, tick by tick: for whoever takes its frames. */
#define BUS_TICK_NS INT64_C(10000000)

struct bus_sink {
	void (*frame)(void *context, const struct can_frame_rx *frame); /* time_ns: since 1970, within its tick */
	void *context;
};
struct bus;

/* `drive` is borrowed; of one without stops no destination is said. NULL, logged, when the definitions are damaged. */
struct bus *bus_new(const struct drive *drive, const struct bus_sink *sink);
void bus_free(struct bus *bus); /* NULL is fine */

/* The frames that are due at this tick, counted from the first one. `wall_ns` is now. */
void bus_tick(struct bus *bus, const struct drive_state *state, int64_t tick, int64_t wall_ns);

/* From now on it says the ignition too: 0 off to 3 start, as POWER.Ignition counts. A log does not. */
void bus_say_ignition(struct bus *bus, int ignition);
/* Light instead of the sun's, 0 dark to 1; negative: the sun's. */
void bus_set_light(struct bus *bus, double light);

/* The definitions by which it speaks. */
const struct dbc *bus_dbc(const struct bus *bus);

/* Chooses, builds path and motion, and cuts the drive to options->minutes when that is given. Returns 0, or -1 after
 * logging one line; path and motion may be finished in either case. */
int drive_plan(struct drive *drive, struct drive_path *path, struct drive_motion *motion);

/* Writes the whole log; `truth` may be NULL. Returns 0 or -errno. */
int bus_write(const struct drive *drive, struct drive_motion *motion, int log_fd, FILE *truth);

/* 0 night to 1 day, at a place and time (sun's height; Meeus, Astronomical Algorithms, ch. 25, low accuracy). */
double ambient_light(struct geo_point at, int64_t wall_ns);

#endif
