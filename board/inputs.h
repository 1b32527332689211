/*
 * From the bus to the navigation's view: reads CAN frames, keeps the vehicle state, steps the navigation, records. One
 * instance; all memory from the arena at inputs_open().
 */
#ifndef BLVD_BOARD_INPUTS_H
#define BLVD_BOARD_INPUTS_H

#include "board/car.h"
#include "board/options.h"
#include "board/receiver.h"
#include "board/stats.h"
#include "nav/destination.h"
#include "nav/nav.h"
#include "nav/vehicle.h"
#include "platform/can/can_bus.h"
#include "platform/can/can_record.h"

#define INPUTS_BATCH 64

struct inputs {
	struct car car;
	struct vehicle vehicle;
	struct vehicle_state state; /* at now_ns */
	struct receiver receiver;
	struct destination destination;
	uint32_t destinations;  /* that the car has asked for, or taken back */
	bool destination_waits; /* heard before there was a map */
	struct nav nav;         /* nav.pkg NULL: no map yet */
	struct obd obd;
	struct can_bus *bus;         /* NULL: no car, the view stands still */
	bool bus_missing;            /* there should be a car, but this kernel has no CAN */
	int64_t bus_missing_ns;      /* since then */
	struct can_record *recorder; /* NULL: not recording */
	int64_t now_ns;              /* how far the navigation has got */
	bool machine_fault;          /* what failed to open is no file that was to be read: bus, recording */
	int read_error;              /* first -errno of the bus; it is not read again after that */
	struct can_frame_rx batch[INPUTS_BATCH];
};

/* Returns 0 or -errno after logging one line. `pkg`, `profile` and `options` are borrowed. `pkg` NULL: the map comes
 * later, with inputs_map(); until then the view tells the inputs alone. */
int inputs_open(struct inputs *inputs, const struct options *options, const struct profile *profile,
	const struct pkg *pkg, struct arena *arena);
int inputs_map(struct inputs *inputs, const struct options *options, const struct profile *profile,
	const struct pkg *pkg, struct arena *arena);

/* Reads what has come until `now_ns`, steps the navigation there in steps of at most 10 ms, and tells the view. Never
 * waits. */
void inputs_advance(struct inputs *inputs, int64_t now_ns, struct nav_view *out);

/* Whether nothing more will come: the end of a log. */
bool inputs_ended(const struct inputs *inputs);

/* Time since 1970 of a time on the frames' clock; 0 when it is not known. */
int64_t inputs_wall_ns(const struct inputs *inputs, int64_t now_ns);

/* Fills in what is told of the bus, the vehicle, the recording and the route. */
void inputs_stats(const struct inputs *inputs, struct stats *out);

/* Flushes the recording. A zeroed struct does nothing. Returns 0 or the first -errno of the recording. */
int inputs_close(struct inputs *inputs);

#endif
