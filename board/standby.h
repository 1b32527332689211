/*
 * Between drives: the ignition (power.h), the last position (position_state.h), and what both mean for the loop. The
 * one place where the main program meets them.
 */
#ifndef BLVD_BOARD_STANDBY_H
#define BLVD_BOARD_STANDBY_H

#include "board/controls.h"
#include "board/inputs.h"
#include "board/position_state.h"
#include "board/power.h"

enum standby_order {
	STANDBY_RUN,
	STANDBY_DARK, /* the ignition is off: show nothing, and seldom */
	STANDBY_END,  /* off, and the profile says that the process ends then */
};

struct standby {
	struct power power;
	struct position_state position;
	bool keeps; /* positions */
	bool begun;
	enum standby_order order;
};

/* Where the state is: --state, else $STATE_DIRECTORY unless a log is replayed (which must not depend on what was before
 * it), else nowhere. A folder that cannot be used is told and done without. */
void standby_open(struct standby *standby, const struct options *options, const struct profile *profile);

/* Once the map is there: goes on from the last position, unless the command line says where to start. */
void standby_begin(struct standby *standby, const struct options *options, struct inputs *inputs);

/* Once a frame, after the inputs. `line` is the board's ignition line. */
enum standby_order standby_advance(
	struct standby *standby, struct inputs *inputs, const struct control_switch *line, int64_t now_ns);

/* At the end, before the inputs are closed: keeps the last position. Accepts a zeroed one. */
void standby_close(struct standby *standby, struct inputs *inputs);

#endif
