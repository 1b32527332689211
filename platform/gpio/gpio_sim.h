/*
 * A laptop's lines: nothing happens but what a script or a test says. One line of a script is
 *     SECONDS LINE WHAT      # the rest is a comment
 * with LINE as the configuration names it and WHAT one of: 1 active, 0 not active, busy, gone, good (states),
 * `overrun` (edges were lost; the level is read again), `bounce N` (N more edges, 0.3 ms apart). With SECONDS LINE
 * `knob` WHAT is detents, clockwise positive, of the lines rotary_a and rotary_b with four edges each, and after them
 * the edges a second (default 400). Times count from the configuration's start, and lines are in
 * their order; levels at 0 are those of the start, and not active is the default.
 *
 * When the script is a pipe (mkfifo), lines are taken as they come, their times count from then.
 */
#ifndef BLVD_PLATFORM_GPIO_GPIO_SIM_H
#define BLVD_PLATFORM_GPIO_GPIO_SIM_H

#include "platform/gpio/gpio.h"

#define GPIO_SIM_QUEUE_MIN 4096 /* events that wait, at least; what does not fit is dropped and counted */

/* For tests, and for whoever plays the car. Times may lie ahead. Return false when the queue is full. */
bool gpio_sim_set(struct gpio *gpio, unsigned line, bool level, int64_t time_ns);
bool gpio_sim_state(struct gpio *gpio, unsigned line, enum gpio_state state, int64_t time_ns);
/* One line of a script, its times counting from `from_ns`. Returns NULL or what is wrong with it. */
const char *gpio_sim_say(struct gpio *gpio, const char *line, int64_t from_ns);

/* Events that found the queue full, since start. */
uint64_t gpio_sim_dropped(const struct gpio *gpio);

#endif
