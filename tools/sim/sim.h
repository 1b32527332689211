/*
 * `blvd sim`: the virtual car of `blvd drive`, live. The parts, each a file:
 * hand.c     a car driven by hand
 * faults.c   what goes wrong on the bus
 * sim.c      the car and its bus, tick by tick, without any clock of its own
 * say.c      commands in words, from the keyboard, a pipe or a script
 * keys.c     the terminal
 * devices.c  the board's lines and the camera, where they are simulated too
 * child.c    boulevard as a child
 * cmd_sim.c  arguments and the loop in real time
 */
#ifndef BLVD_TOOLS_SIM_SIM_H
#define BLVD_TOOLS_SIM_SIM_H

#include "tools/sim/faults.h"
#include "tools/sim/hand.h"

#define SIM_TICK_S 0.01
#define SIM_FRAMES_MAX 16 /* of one tick, error frames included */

struct sim_options {
	struct drive_options drive;
	bool by_hand;  /* else along a route */
	double factor; /* of the speed along the route */
	double wait_s; /* before it sets off along the route: so that a listener may start after it */
};

struct sim {
	const struct sim_options *options;
	struct drive drive;
	struct drive_path path;
	struct drive_motion motion;
	struct bus *bus;
	struct hand hand;
	struct faults faults;
	bool by_hand;
	double factor;
	double time_s;  /* since start */
	double route_s; /* on the route's own clock */
	int64_t tick;
	bool ignition;
	double ignition_s; /* since when; a bus goes to sleep after the ignition */
	double light;      /* 0 to 1, negative: the sun's */
	double clock_s;    /* what the bus's clock is wrong by */
	bool ended;        /* the route is */
	bool quit;
	struct drive_state state; /* of the last tick */
	struct can_frame_rx frames[SIM_FRAMES_MAX];
	unsigned frame_count;
	uint64_t withheld; /* frames that faults kept back */
};

/* What the world beside the bus is told; any may be NULL. */
struct sim_world {
	void (*line)(void *context, const char *name, bool on); /* a line of the board */
	void (*fault)(void *context, const struct fault_event *event);
	void *context;
};

/* `options` and `pkg` are borrowed, all else is the simulation's until sim_finish(). Returns 0, or -1 logged. */
int sim_init(struct sim *sim, struct arena *arena, const struct pkg *pkg, const struct sim_options *options);
void sim_finish(struct sim *sim);

/* One tick. The frames that are due are in `frames`; their times are since 1970. */
void sim_tick(struct sim *sim, int64_t wall_ns, const struct sim_world *world);

/* From the route to the wheel; nothing when it is there already. */
void sim_take_wheel(struct sim *sim);
void sim_set_ignition(struct sim *sim, bool on);

/* say.c: one command. Returns NULL, or what is wrong with it. */
const char *sim_say(struct sim *sim, const struct sim_world *world, const char *text);
extern const char *const sim_help;

#endif
