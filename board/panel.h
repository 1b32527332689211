/*
 * The panel in front of the driver: which display, how bright, how many pictures a second. Between main.c and
 * platform/display.
 */
#ifndef BLVD_BOARD_PANEL_H
#define BLVD_BOARD_PANEL_H

#include "board/options.h"
#include "board/profile.h"
#include "platform/display/display.h"
#include "render/screen.h"

/* Opens what options and profile ask for, or what there is. Strings are borrowed until display_close(). Returns 0 or
 * -errno, logged. */
int panel_open(struct display *display, const struct options *options, const struct profile *profile);

/* Brings the finished picture to the display's window, or to `pixels` (RGBA8, top row first, of the screen's size), and
 * waits for it there. */
void panel_bring_out(const struct display *display, const struct screen *screen, uint8_t *pixels);
/* Shows it, where there is somewhere to show it. Returns 0 or -errno. */
int panel_show(struct display *display, const struct screen *screen, const uint8_t *pixels);

/* What the frame rate and the brightness depend on. */
struct panel_scene {
	int64_t now_ns;
	double speed_mps;
	bool touched;   /* a knob was turned or a key pressed since the last call */
	bool dark;      /* the ignition is off: nothing is to be seen */
	double night;   /* 0 day to 1 night */
	double ambient; /* 0 dark to 1; negative unknown */
};

struct panel_pace {
	uint32_t fps, fps_standstill;           /* 0: as fps */
	float brightness_day, brightness_night; /* 0 to 1 */
	int64_t busy_until_ns;                  /* at full rate so long, whatever the car does */
	int64_t dimmed_ns;                      /* when `level` was last changed */
	float level;
};

void panel_pace_init(struct panel_pace *pace, const struct options *options, const struct profile *profile);
/* Pictures a second with the ignition on: fewer while the car stands and nobody turns anything. */
uint32_t panel_fps(struct panel_pace *pace, const struct panel_scene *scene);
/* Brightness, 0 to 1, that follows the light within two seconds. */
float panel_level(struct panel_pace *pace, const struct panel_scene *scene);

#endif
