/*
 * A satellite receiver beside the bus (platform/gnss), put into the state of the car: a position of either is one, the
 * newer counts, and the driver sees one GPS.
 */
#ifndef BLVD_BOARD_RECEIVER_H
#define BLVD_BOARD_RECEIVER_H

#include "nav/vehicle.h"
#include "platform/gnss/gnss.h"

struct receiver {
	struct gnss *gnss; /* NULL: none */
	struct gnss_fix last;
	uint32_t fixes;
};

/* `spec` as gnss_open() takes it, NULL none. Returns 0 or -errno, logged. */
int receiver_open(struct receiver *receiver, const char *spec, int64_t wall_offset_ns, struct arena *arena);
void receiver_close(struct receiver *receiver); /* a zeroed one does nothing */

/* Takes what came until state->time_ns, and adds it. */
void receiver_merge(struct receiver *receiver, struct vehicle_state *state);

#endif
