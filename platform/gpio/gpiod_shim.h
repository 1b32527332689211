/*
 * The little of libgpiod that we use, in one form for its version 1 (gpiod_shim_v1.c) and version 2 (gpiod_shim_v2.c),
 * whose interfaces have nothing in common; the build takes the one that fits the library it finds. One request a line,
 * so that one line in use elsewhere costs none of the others. All return 0 (or what is said) or -errno. libgpiod
 * allocates when a line is requested, never when events are read. One thread at a time.
 */
#ifndef BLVD_PLATFORM_GPIO_GPIOD_SHIM_H
#define BLVD_PLATFORM_GPIO_GPIOD_SHIM_H

#include "platform/gpio/gpio.h"

#define GPIOD_SHIM_BATCH 16 /* what the kernel keeps for a line of version 1 */

struct gpiod_shim { /* made at init: what all requests share */
	const char *consumer;
	void *settings, *config, *request_config, *events;
};

struct gpiod_shim_line { /* zeroed: not requested */
	void *chip;          /* version 1 only: its lines live no longer than it */
	void *request;       /* version 1: the line itself */
};

struct gpiod_shim_event {
	int64_t time_ns;
	bool level;      /* active or not, as the line is configured */
	uint32_t number; /* of the line's events, from 1; 0: the library does not tell */
};

int gpiod_shim_init(struct gpiod_shim *shim, const char *consumer);
void gpiod_shim_finish(struct gpiod_shim *shim);

/* What the chip at `path` calls itself. */
int gpiod_shim_label(const char *path, char *label, size_t size);

/* Both edges. -EBUSY: somebody has it. */
int gpiod_shim_request(
	struct gpiod_shim *shim, const char *path, const struct gpio_line_config *config, struct gpiod_shim_line *line);
void gpiod_shim_release(struct gpiod_shim_line *line);

/* To poll(). It is of the line and closed with it. */
int gpiod_shim_fd(const struct gpiod_shim_line *line);
/* 1 active, 0 not. */
int gpiod_shim_level(const struct gpiod_shim_line *line);
/* Up to GPIOD_SHIM_BATCH events; returns how many, 0 when there are none. Never waits. */
int gpiod_shim_read(struct gpiod_shim *shim, const struct gpiod_shim_line *line, struct gpiod_shim_event *events);

/* "libgpiod 1.6.3" */
const char *gpiod_shim_name(void);

#endif
