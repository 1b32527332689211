/*
 * The board's lines and the camera, where they are simulated too.
 *
 * Lines, by `--gpio PATH`: a pipe that `boulevard --gpio sim:PATH` reads (platform/gpio/gpio_sim.h), or a folder with
 * a file `pin-NAME` for each line that takes pull-up and pull-down, as the kernel's gpio-sim does; there active is low.
 * The camera, by `--camera PATH`: a pipe that takes lines "WORD SECONDS".
 */
#ifndef BLVD_TOOLS_SIM_DEVICES_H
#define BLVD_TOOLS_SIM_DEVICES_H

#include <stdbool.h>

#include "tools/sim/faults.h"

struct devices {
	const char *gpio, *camera; /* borrowed; NULL none */
	bool folder;               /* gpio is one */
	bool told[2];              /* that nobody listens: gpio, camera */
	char line[FAULT_TEXT_MAX]; /* that chatters; "" none */
	bool level;
};

/* Returns 0, or -errno after logging one line when a path is not there. */
int devices_open(struct devices *devices, const char *gpio, const char *camera);

void devices_line(struct devices *devices, const char *name, bool on);
void devices_fault(struct devices *devices, const struct fault_event *event);

/* Every tick: a line in a folder chatters by being turned again and again. */
void devices_step(struct devices *devices);

#endif
