/*
 * The car's last place, kept from one run to the next: when to write it, what is written, and going on from it. The
 * writing is a worker's, beside the frame loop; the loop opens no file and never waits for the medium.
 *
 * What is stored is one small record in two generations (platform/base/record.h), DIR/position.0 and .1. Wear: at most
 * one write in POSITION_REST_NS, and none while nothing changes: some 120 an hour of driving, of a block or two each.
 */
#ifndef BLVD_BOARD_POSITION_STATE_H
#define BLVD_BOARD_POSITION_STATE_H

#include "nav/nav.h"
#include "nav/vehicle.h"
#include "platform/base/record.h"
#include "platform/base/worker.h"

#define POSITION_REST_NS INT64_C(30000000000)  /* between two writes, on the way */
#define POSITION_URGENT_NS INT64_C(3000000000) /* the same when the car has stopped, or the ignition went off */
#define POSITION_RECORD "position"
#define POSITION_VERSION 1

struct position_stored; /* position_state.c */

struct position_state {
	struct record record;
	struct worker worker; /* not started: nothing is written */
	uint64_t package;     /* identity of the one in use */
	char city[48];
	struct nav_memory saved, writing; /* as last given to the worker; what it has in hand */
	double saved_odometer_m;          /* NAN: the car tells none */
	int64_t saved_ns, stopped_ns;     /* frames' clock; INT64_MIN never, not stopped */
	bool has_saved, busy, urgent, restored;
	int failed;                     /* -errno of the last write; the worker's while `busy` */
	bool failing;                   /* told */
	uint64_t writes;                /* done */
	uint64_t refused;               /* failed */
	_Alignas(8) uint8_t bytes[256]; /* the record that the worker has in hand */
	uint32_t size;
};

/* Reads what is in `folder`, which is made when its parent is there, and starts the worker. Returns 0 or -errno after
 * logging one line; a folder that cannot be used is told, and the car drives on without. `ops` is borrowed. */
int position_state_open(struct position_state *state, const struct file_ops *ops, void *context, const char *folder);

/* The package in use, for good. With `restore` the navigation goes on from what was kept, if that lies in this city;
 * logs what was done. Returns whether it was. */
bool position_state_begin(struct position_state *state, struct nav *nav, const struct pkg *pkg, bool restore);

/* Once a frame, after the navigation. `wall_ns` is for people who look at the file: nothing is decided by it. */
void position_state_follow(struct position_state *state, struct nav *nav, const struct vehicle_state *vehicle,
	int64_t now_ns, int64_t wall_ns);

/* The ignition went off: what has changed is written soon. */
void position_state_hurry(struct position_state *state);

/* Writes a last time, and waits for it. Accepts a zeroed state. */
void position_state_close(
	struct position_state *state, struct nav *nav, const struct vehicle_state *vehicle, int64_t wall_ns);

#endif
