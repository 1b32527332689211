/*
 * Input devices of the kernel (evdev): a rotary encoder of its rotary-encoder driver, buttons of gpio-keys, a remote
 * control, a keyboard. A thread of its own takes the events as they come, because the kernel keeps few. A device that
 * is not there, goes away or belongs to another process alone is a state, told by an event; it is tried again twice
 * a second. Times are the kernel's, on the clock of clock_now_ns(). One thread at a time but for the one inside.
 */
#ifndef BLVD_PLATFORM_INPUT_EVDEV_H
#define BLVD_PLATFORM_INPUT_EVDEV_H

#include <linux/input.h>
#include <stdbool.h>
#include <stdint.h>

#include "platform/base/arena.h"

#define EVDEV_MAX 8 /* devices */

enum evdev_state {
	EVDEV_WAITING, /* not tried yet */
	EVDEV_GOOD,
	EVDEV_BUSY,    /* another process has it for itself */
	EVDEV_GONE,    /* no such device, or it went away */
	EVDEV_REFUSED, /* no permission, or not an input device */
};

enum evdev_kind {
	EVDEV_TURN,  /* `value` detents, clockwise positive */
	EVDEV_KEY,   /* `key` (KEY_..., BTN_...); `value` 1 down, 0 up, 2 repeated by the kernel */
	EVDEV_RESET, /* events were lost: no key is known to be down, and turns are missing */
	EVDEV_STATE, /* `value` is the enum evdev_state */
};

struct evdev_report {
	int64_t time_ns;
	uint8_t device; /* place in the list that was opened */
	uint8_t kind;   /* enum evdev_kind */
	uint16_t key;
	int32_t value;
};

/* One device's events to reports; apart from the rest so that it can be tested without one. */
struct evdev_decoder {
	bool dropped;                 /* until the next SYN_REPORT */
	bool has_wheel;               /* an absolute one, which counts on and wraps */
	int32_t wheel_at, wheel_turn; /* last value; values a round, 0: does not wrap */
};
/* Returns whether there is a report: `out`, without its device. */
bool evdev_decode(struct evdev_decoder *decoder, const struct input_event *event, struct evdev_report *out);

struct evdev;

/* `names`: paths, or "name:" and what the device calls itself; borrowed. Returns 0 or -errno; a missing device is no
 * error. */
int evdev_open(struct evdev **out, const char *const *names, unsigned count, struct arena *arena);
void evdev_close(struct evdev *evdev); /* NULL is fine */

/* Up to `capacity` reports, oldest first. Never waits, never allocates. */
int evdev_read(struct evdev *evdev, struct evdev_report *reports, int capacity);

/* Of the devices, as of the reports read so far: the worst. */
enum evdev_state evdev_worst(const struct evdev *evdev);

#endif
