/*
 * The profile's names made into definitions: opens the DBC files, finds every signal, works out units and maps. What
 * comes out is what nav/vehicle.h and can_bus_open need. Start time only.
 */
#ifndef BLVD_BOARD_CAR_H
#define BLVD_BOARD_CAR_H

#include "board/profile.h"

struct car {
	struct vehicle_config vehicle;
	unsigned dbc_count;
	struct dbc dbc[PROFILE_DBC_MAX];
	unsigned interface_count;
	const char *interfaces[CAN_BUS_MAX]; /* for can_bus_config; their order is that of the bindings' bus numbers */
	unsigned filter_count;
	struct can_bus_filter filters[VEHICLE_INPUT_COUNT + 4]; /* the identifiers in use */
	struct obd_config obd;                                  /* pid_count 0: nothing is asked for */
	const struct dbc *destination; /* definitions with a DESTINATION message, for nav/destination.h; NULL none */
};

/* `dbc` replaces the profile's definition files when `dbc_count` is not 0, and `interfaces` its interface names, the
 * first for the first and so on. Borrows the strings. Returns 0 or -errno, having logged one line that names the file
 * and the line of what is wrong: a file that cannot be read or parsed, a signal or interface that is not there, a unit
 * that does not fit. */
int car_init(struct car *car, const struct profile *profile, const char *const *dbc, unsigned dbc_count,
	const char *const *interfaces, unsigned interface_count, struct arena *arena);

#endif
