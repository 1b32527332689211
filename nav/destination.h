/*
 * The route that the car itself asks for, from CAN: message DESTINATION of board/profiles/boulevard.dbc (signals
 * StopCount, StopIndex, Latitude, Longitude), one stop a frame in turn, so that a recorded drive replays with its
 * route. A list counts when every stop of it has come; StopCount 0 clears it.
 */
#ifndef BLVD_NAV_DESTINATION_H
#define BLVD_NAV_DESTINATION_H

#include <stdbool.h>

#include "platform/base/geo.h"
#include "platform/can/dbc.h"

#define DESTINATION_STOPS_MAX 8

struct destination {
	const struct dbc_signal *count_signal, *index_signal, *lat_signal,
		*lon_signal;                               /* NULL: the car has no such message */
	struct geo_point stops[DESTINATION_STOPS_MAX]; /* the list in force */
	uint32_t stop_count;
	struct geo_point heard[DESTINATION_STOPS_MAX]; /* the list being heard */
	uint32_t heard_count, heard_mask;
};

/* `dbc` NULL: no stop is ever heard. */
void destination_init(struct destination *destination, const struct dbc *dbc);

/* Takes a frame. Returns true when the list in force has changed. */
bool destination_feed(struct destination *destination, const struct can_frame_rx *frame);

#endif
