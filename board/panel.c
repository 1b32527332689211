#include "board/panel.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"

#define STANDING_MPS 0.3
#define BUSY_NS (3 * NS_PER_S) /* after driving or a turn of a knob: what moves on the picture has come to rest */
#define DIM_S 2.0              /* from brightest to darkest */

int panel_open(struct display *display, const struct options *options, const struct profile *profile)
{
	const char *name = options->display;
	if (!name)
		name = getenv("DISPLAY") || getenv("WAYLAND_DISPLAY") ? "window" : "headless";
	const struct display_ops *ops = display_by_name(name);
	if (!ops) {
		log_error("this program was built without display '%s'", name);
		return -ENODEV;
	}
	struct display_config config = {
		.width = options->width,
		.height = options->height,
		.title = "Boulevard",
		.vsync = true,
		.device = options->device ? options->device : profile->device,
		.connector = profile->connector,
		.mode = options->mode ? options->mode : profile->mode,
		.vt = profile->vt,
		.backlight = profile->backlight,
		.rotation_deg = profile->rotation_deg,
		.buffers = (enum display_buffers)profile->buffers,
	};
	return display_open(display, ops, &config);
}

void panel_bring_out(const struct display *display, const struct screen *screen, uint8_t *pixels)
{
	struct screen_turn turn = {
		.width = display->width, .height = display->height, .turn_deg = display->turn_deg, .dim = display->dim
	};
	if (display->surface == DISPLAY_SURFACE_WINDOW)
		screen_present(screen, &turn);
	else
		screen_read_pixels(screen, pixels);
}

int panel_show(struct display *display, const struct screen *screen, const uint8_t *pixels)
{
	switch (display->surface) {
	case DISPLAY_SURFACE_WINDOW:
		return display_present(display);
	case DISPLAY_SURFACE_PIXELS:
		return display_show_pixels(display, pixels, screen->width, screen->height);
	default:
		return 0;
	}
}

void panel_pace_init(struct panel_pace *pace, const struct options *options, const struct profile *profile)
{
	*pace = (struct panel_pace){
		.fps = options->fps,
		.fps_standstill = profile->fps_standstill,
		.brightness_day = (float)profile->brightness_day,
		.brightness_night = (float)profile->brightness_night,
		.level = -1.0f,
	};
}

uint32_t panel_fps(struct panel_pace *pace, const struct panel_scene *scene)
{
	if (scene->touched || fabs(scene->speed_mps) > STANDING_MPS)
		pace->busy_until_ns = scene->now_ns + BUSY_NS;
	bool slow = scene->now_ns >= pace->busy_until_ns && pace->fps_standstill && pace->fps_standstill < pace->fps;
	return slow ? pace->fps_standstill : pace->fps;
}

float panel_level(struct panel_pace *pace, const struct panel_scene *scene)
{
	double dark = scene->ambient >= 0.0 ? fmax(scene->night, 1.0 - fmin(1.0, scene->ambient * 4.0)) : scene->night;
	float wanted = pace->brightness_day + (pace->brightness_night - pace->brightness_day) * (float)dark;
	wanted = scene->dark ? 0.0f : wanted;
	double passed_s = (double)(scene->now_ns - pace->dimmed_ns) / (double)NS_PER_S;
	float step = (float)fmin(1.0, fmax(0.0, passed_s / DIM_S));
	pace->dimmed_ns = scene->now_ns;
	if (pace->level < 0.0f) /* the first picture */
		pace->level = wanted;
	pace->level += fminf(step, fmaxf(-step, wanted - pace->level));
	return pace->level;
}
