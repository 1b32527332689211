/* The panel as a display: the state machine of kms_common.c behind display.h. There is one at a time. */
#include <errno.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/display/display.h"
#include "platform/display/kms.h"
#include "platform/display/kms_copy.h"

#include <stdio.h>

static struct kms kms;
static struct display_config kept; /* its strings are the caller's */

/* Size, surface and the rest as they are now; says so when the size has changed. */
static void refresh(struct display *display)
{
	uint32_t width = kms.output.mode.hdisplay, height = kms.output.mode.vdisplay;
	display->hidden = !kms_visible(&kms);
	display->counts = kms.counts;
	display->turn_deg = kms_turn_left(&kms);
	display->dim = kms.dim.way == KMS_DIM_DRAWN ? kms.dim.wanted : 1.0f;
	if (!width)
		return; /* no panel yet */
	if (kept.rotation_deg % 180) {
		width = kms.output.mode.vdisplay;
		height = kms.output.mode.hdisplay;
	}
	if (display->width == width && display->height == height)
		return;
	display->width = width;
	display->height = height;
	display_push(display, &(struct display_event){ .kind = DISPLAY_EVENT_RESIZE, .width = width, .height = height });
}

static void describe(struct display *display)
{
	char mode[32] = "no panel";
	if (kms.output.connected)
		kms_mode_text(&kms.output.mode, mode, sizeof(mode));
	snprintf(display->detail, sizeof(display->detail), "%.24s, %.16s, %s, %s", mode, kms.output.name, kms.commit->name,
		kms.buffers->name);
}

static int panel_open(struct display *display, const struct display_config *config)
{
	if (kms.drm) {
		log_error("there is one panel at a time");
		return -EIO;
	}
	kept = *config;
	int err = kms_open(&kms, &kms_drm_libdrm, &kept);
	if (err) {
		kms.drm = NULL;
		return err;
	}
	display->surface = kms.buffers->surface;
	refresh(display);
	describe(display);
	return 0;
}

static void panel_close(struct display *display)
{
	(void)display;
	kms_close(&kms);
}

static int panel_use(struct display *display)
{
	(void)display;
	return kms.buffers->use(&kms) ? -EIO : 0;
}

static int panel_present(struct display *display)
{
	int err = kms_show(&kms);
	refresh(display);
	return err ? -EIO : 0;
}

static int panel_show_pixels(struct display *display, const uint8_t *rgba, uint32_t width, uint32_t height)
{
	struct kms_picture picture = { .rgba = rgba, .width = width, .height = height };
	kms_wait(&kms);
	struct kms_dumb_buffer *to = kms_visible(&kms) ? kms_dumb_free(&kms) : NULL;
	if (to)
		kms_copy(&picture, to->pixels, to->pitch, to->width, to->height, display->turn_deg, display->dim);
	return to ? panel_present(display) : 0;
}

static void panel_brightness(struct display *display, float level)
{
	kms_brightness(&kms, level);
	refresh(display);
}

static void panel_pump(struct display *display)
{
	bool was_shut_out = kms.shut_out;
	kms_pump(&kms, clock_now_ns());
	if (kms.shut_out && !was_shut_out) {
		log_warn("%s: the screen is free, for a program that starts now; ending for it", kms.device);
		display_push(display, &(struct display_event){ .kind = DISPLAY_EVENT_CLOSE });
	}
	refresh(display);
	describe(display);
}

const struct display_ops display_kms = {
	.name = "kms",
	.open = panel_open,
	.close = panel_close,
	.use = panel_use,
	.present = panel_present,
	.show_pixels = panel_show_pixels,
	.set_brightness = panel_brightness,
	.pump = panel_pump,
};
