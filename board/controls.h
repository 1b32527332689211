/*
 * What the driver's hands do: lines of the board (platform/gpio), input devices of the kernel (platform/input) and the
 * window's keyboard become actions of the product, whichever of them they came from. Also the lines that are no
 * controls: reverse, ignition, lamps.
 *
 * Times are those of clock_now_ns(), or of the frames where the clock is simulated. One instance; all memory from the
 * arena at controls_open(); nothing is allocated later. One thread.
 */
#ifndef BLVD_BOARD_CONTROLS_H
#define BLVD_BOARD_CONTROLS_H

#include "board/options.h"
#include "board/profile.h"
#include "board/stats.h"
#include "platform/display/display.h"
#include "platform/gpio/debounce.h"
#include "platform/gpio/gpio.h"
#include "platform/gpio/press.h"
#include "platform/gpio/quadrature.h"
#include "platform/input/evdev.h"

enum action {
	ACTION_NONE,
	ACTION_TURN_RIGHT, /* the knob, by a detent: closer, or down in a menu */
	ACTION_TURN_LEFT,
	ACTION_UP, /* arrow keys: closer, or up in a menu */
	ACTION_DOWN,
	ACTION_PUSH,   /* opens the menu, selects */
	ACTION_BACK,   /* a button of its own, or a long push of the knob */
	ACTION_ESCAPE, /* a keyboard's: closes the menu, else ends the program */
	ACTION_ZOOM_IN,
	ACTION_ZOOM_OUT,
	ACTION_VIEW,  /* the next camera */
	ACTION_LIGHT, /* day or night look */
	ACTION_PAUSE,
	ACTION_QUIT,
	ACTION_COUNT,
};

#define CONTROLS_QUEUE 128 /* actions that wait; turns beyond are dropped */

/* A line that says something of the car. */
struct control_switch {
	bool known;       /* heard, and not lost since; the level stays the last one when the line is lost */
	bool on;          /* debounced */
	int64_t since_ns; /* time stamp of the edge that made it so */
};

struct controls_state {
	struct control_switch reverse, ignition, night;
};

struct controls {
	struct controls_state state;
	struct gpio *gpio;            /* NULL: no lines in the profile, or they cannot be had */
	uint8_t role[GPIO_LINES_MAX]; /* enum control_line of each line */
	struct debounce contact[CONTROL_LINE_COUNT];
	struct press press[CONTROL_LINE_COUNT];
	struct quadrature knob;
	bool knob_swapped;
	struct evdev *devices; /* NULL: none in the profile */
	struct press key_press[CONTROL_LINE_COUNT];
	enum action queue[CONTROLS_QUEUE]; /* ring */
	uint32_t queue_first, queue_count;
	uint64_t actions, actions_dropped;
	int64_t now_ns;
};

/* `now_ns` is the present on the clock that controls_advance() will be given; `simulated` says that this is not the
 * clock of clock_now_ns(), and then only scripted lines are read. Returns 0; -EINVAL for a bad script
 * (logged); -ENOMEM. Lines that are not there are states, not errors. Strings of `profile` and `options` are borrowed.
 */
int controls_open(struct controls *controls, const struct options *options, const struct profile *profile,
	bool simulated, int64_t now_ns, struct arena *arena);
void controls_close(struct controls *controls); /* a zeroed struct does nothing */

/* Takes what has come until `now_ns`. Never waits. */
void controls_advance(struct controls *controls, int64_t now_ns);

/* The next action, oldest first; ACTION_NONE when there is none. */
enum action controls_next(struct controls *controls);

/* What a key of the window's keyboard means. */
enum action controls_action_of_key(enum display_key key);

/* Counts and states for the statistics; the settings' part is not ours. */
void controls_stats(const struct controls *controls, struct control_stats *out);

/* What is wrong with the lines, in words for the driver; NULL when nothing is. */
const char *controls_fault(const struct controls *controls);

#endif
