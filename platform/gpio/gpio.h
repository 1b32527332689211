/*
 * Digital inputs of the board: lines of GPIO chips by libgpiod (gpio_libgpiod.c), or a laptop's, set by a script or by
 * a test (gpio_sim.c), behind one table of functions. A line's index is its place in the configuration. Events carry
 * the kernel's time stamp of the edge on the clock of clock_now_ns(), and come in the order of these times, for all
 * lines together, but where the kernel itself is late with one.
 *
 * A line that another process holds, a chip that is not there or goes away are states, never errors: the
 * implementation tries again twice a second until the line is there, and says so by an event of its own. After an
 * event of kind GPIO_LEVEL nothing is known of the edges before it: at the start, after a recovery, or when edges came
 * faster than they were taken. One thread at a time.
 */
#ifndef BLVD_PLATFORM_GPIO_GPIO_H
#define BLVD_PLATFORM_GPIO_GPIO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "platform/base/arena.h"

#define GPIO_LINES_MAX 16

enum gpio_bias { GPIO_BIAS_AS_IS, GPIO_BIAS_PULL_UP, GPIO_BIAS_PULL_DOWN, GPIO_BIAS_NONE };

enum gpio_state {
	GPIO_WAITING, /* not asked for yet */
	GPIO_GOOD,
	GPIO_BUSY,    /* another process or driver holds it */
	GPIO_GONE,    /* no such chip, or it went away */
	GPIO_REFUSED, /* no such line on the chip, no permission, bias or edges not possible */
};

struct gpio_line_config {
	const char *chip; /* "gpiochip0", a path, or the label of a chip ("pinctrl-bcm2711"): numbers may change */
	unsigned offset;
	bool active_low; /* levels below are after this: true is active */
	enum gpio_bias bias;
};

struct gpio_config {
	const char *consumer; /* what others see as the holder */
	const struct gpio_line_config *lines;
	unsigned line_count;      /* up to GPIO_LINES_MAX */
	const char *script;       /* sim: a file, or NULL; gpio_sim.h has its form */
	const char *const *names; /* sim: what the script calls the lines; an entry may be NULL */
	int64_t start_ns;         /* sim: time 0 of the script */
};

enum gpio_event_kind {
	GPIO_EDGE,  /* the line became `level` at `time_ns` */
	GPIO_LEVEL, /* the line was read: edges before may be missing */
	GPIO_STATE, /* the line's state became `state` */
};

struct gpio_event {
	int64_t time_ns;
	uint8_t line;
	uint8_t kind; /* enum gpio_event_kind */
	bool level;
	uint8_t state; /* enum gpio_state, of GPIO_STATE */
};

struct gpio_stats {
	uint64_t edges;
	uint64_t resyncs; /* levels read because edges were or may have been lost */
	uint64_t losses;  /* times that a line went from good to anything else */
};

struct gpio_line {
	enum gpio_state state;
	int64_t state_ns; /* since when */
	bool level;       /* of the last event */
};

struct gpio;

/* All mandatory. */
struct gpio_ops {
	const char *name;
	/* Returns 0 or -errno; a missing chip or a busy line is no error. Strings are borrowed. */
	int (*open)(const struct gpio_config *config, struct arena *arena, struct gpio **out);
	/* Up to `capacity` events not later than `until_ns`, oldest first. Never waits, never allocates. */
	int (*read)(struct gpio *gpio, int64_t until_ns, struct gpio_event *events, int capacity);
	void (*close)(struct gpio *gpio);
};

struct gpio {
	const struct gpio_ops *ops;
	struct gpio_line lines[GPIO_LINES_MAX]; /* as of the events read so far */
	unsigned line_count;
	struct gpio_stats stats;
};

extern const struct gpio_ops gpio_sim_ops;
#ifdef BLVD_HAVE_GPIOD
extern const struct gpio_ops gpio_libgpiod_ops;
#endif

static inline int gpio_open(
	struct gpio **out, const struct gpio_ops *ops, const struct gpio_config *config, struct arena *arena)
{
	return ops->open(config, arena, out);
}
int gpio_read(struct gpio *gpio, int64_t until_ns, struct gpio_event *events, int capacity);
void gpio_close(struct gpio *gpio); /* NULL is fine */

/* "good", "in use elsewhere"... */
const char *gpio_state_name(enum gpio_state state);

#endif
