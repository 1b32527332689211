/*
 * The ignition: what the car says of it, by a line (board/controls.h) or on the bus, and what the program does then.
 * Off for long enough means: the last position is written, the display goes dark, frames become rare; the process stays
 * or ends as the profile says. A decision only: the caller does what it says. No clock is read.
 *
 * A bus that falls silent does not switch anything: off stays off, and on stays on. A car that never tells is on.
 */
#ifndef BLVD_BOARD_POWER_H
#define BLVD_BOARD_POWER_H

#include <stdbool.h>
#include <stdint.h>

enum power_word { POWER_SAYS_NOTHING, POWER_SAYS_OFF, POWER_SAYS_ON };

struct power_config {
	int64_t off_after_ns; /* off for so long, for good: engines are started twice, and lines chatter; 0: 2 s */
	uint32_t off_fps;     /* while dark; 0: 2 */
	bool ends;            /* the process ends when off */
};

enum power_change { POWER_STAYS, POWER_GOES_OFF, POWER_GOES_ON };

struct power {
	struct power_config config;
	bool off;                  /* dark */
	enum power_word line, can; /* last heard */
	int64_t off_ns;            /* since when off is said; INT64_MIN it is not */
};

void power_init(struct power *power, const struct power_config *config);

/* Once a frame. Each word is what is known now; the line goes before the bus. Tells a change once. */
enum power_change power_advance(struct power *power, enum power_word line, enum power_word can, int64_t now_ns);

/* Frames a second, where `fps` are wanted with the ignition on. */
uint32_t power_fps(const struct power *power, uint32_t fps);

#endif
