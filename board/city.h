/*
 * The map as this machine has it: package, street graph and renderer, brought up beside a loop that already runs. The
 * package is opened on a thread of its own; what the GPU needs follows in pieces, between which the loop may draw
 * something short (a reversing picture). A map that is missing or damaged is a state, not an end: the owner decides.
 */
#ifndef BLVD_BOARD_CITY_H
#define BLVD_BOARD_CITY_H

#include "board/inputs.h"
#include "platform/base/worker.h"
#include "render/frame.h"

enum city_state {
	CITY_OPENING, /* the package is being opened */
	CITY_LOADING, /* city_step() is at work; seen from `between` only */
	CITY_READY,
	CITY_FAILED, /* `exit_code` says how bad; logged */
};

struct city_config { /* all borrowed, and outlive the city */
	const struct options *options;
	const struct profile *profile;
	const struct screen *screen;
	struct inputs *inputs;
	struct arena *arena; /* cut down to what is needed once that is known; the GPU has the rest of the budget */
	bool simulated;      /* loading takes the same number of frames on every machine, and no thread */
	void (*between)(void *context); /* NULL none; see gfx_set_between() */
	void *context;
};

struct city {
	struct city_config config;
	enum city_state state;
	int exit_code; /* enum exit_code, once FAILED */
	struct pkg pkg;
	struct renderer *renderer; /* READY only */
	struct worker worker;
	struct pkg_fault fault;
	int open_status;
	bool drawn; /* the first map picture, which loads what is in view, is done */
};

/* Starts to open the package. */
void city_begin(struct city *city, const struct city_config *config);
/* Goes on with what is ready to go on; never waits for the package. Call once a frame until READY or FAILED. Takes as
 * long as loading takes, with calls of `between` in it. */
void city_step(struct city *city);
/* After each picture of the map: ends the calls of `between` once the first one is there. */
void city_drawn(struct city *city);
/* A zeroed city does nothing. The screen must still be there. */
void city_finish(struct city *city);

#endif
