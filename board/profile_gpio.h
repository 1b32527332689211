/* The profile's sections [gpio] and [input]: which line is what, and input devices of the kernel. */
#ifndef BLVD_BOARD_PROFILE_GPIO_H
#define BLVD_BOARD_PROFILE_GPIO_H

#include "platform/base/arena.h"
#include "platform/gpio/gpio.h"

enum control_line {
	CONTROL_REVERSE,
	CONTROL_IGNITION,
	CONTROL_NIGHT, /* active: the lamps are on */
	CONTROL_ROTARY_A,
	CONTROL_ROTARY_B,
	CONTROL_PUSH,
	CONTROL_BACK,
	CONTROL_ZOOM_IN,
	CONTROL_ZOOM_OUT,
	CONTROL_VIEW,
	CONTROL_LINE_COUNT,
};

#define PROFILE_DEVICES_MAX 4

struct profile_line {
	unsigned line; /* of the file; 0: not in the profile */
	struct gpio_line_config at;
	int32_t debounce_ms; /* -1: not said */
	int32_t long_ms;     /* -1: not said */
};

struct profile_gpio {
	struct profile_line lines[CONTROL_LINE_COUNT];
	uint32_t rotary_steps; /* edges a detent */
	bool rotary_swapped;   /* turns the other way */
	unsigned device_count;
	const char *devices[PROFILE_DEVICES_MAX]; /* paths, or "name:" and what the device calls itself */
};

/* "reverse", "rotary_a"... */
const char *control_line_name(enum control_line line);

enum profile_gpio_result { PROFILE_GPIO_DONE, PROFILE_GPIO_UNKNOWN, PROFILE_GPIO_WRONG, PROFILE_GPIO_NO_MEMORY };

/* One key. `value` is cut up. With PROFILE_GPIO_WRONG the fault is in `error`. Strings go to the arena. */
enum profile_gpio_result profile_gpio_set(struct profile_gpio *out, const char *section, const char *key, char *value,
	unsigned line, struct arena *arena, char *error, size_t error_size);

#endif
