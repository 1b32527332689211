/*
 * The GPU and the one picture that everything is drawn into: the map's renderer, and what must be there before it or
 * without it. Made once at start, before any of them.
 */
#ifndef BLVD_RENDER_SCREEN_H
#define BLVD_RENDER_SCREEN_H

#include "render/gfx.h"

struct screen_config {
	uint32_t width, height;
	uint32_t samples;                            /* per pixel; 0 or 1 is none */
	bool depth_16;                               /* see struct gfx_target_desc */
	bool plain_first;                            /* one sample until gfx_target_refine() */
	const struct gfx_ops *gfx;                   /* NULL: gfx_gles3 */
	void (*(*get_proc)(const char *name))(void); /* display_get_proc, or NULL */
	bool turns;                                  /* screen_present() may have to turn or to dim */
};

struct screen {
	struct gfx *gfx;
	gfx_target target;
	uint32_t width, height;
	gfx_program turn_program; /* of config.turns, else none */
	gfx_pipeline turn_pipeline;
};

/* Needs a current GL context (or the dummy back end). Returns 0, -ENOMEM, or -ENOTSUP when the
 * context is too old or the picture larger than the GPU can draw; a screen that failed is finished. */
int screen_init(struct screen *screen, struct arena *arena, const struct screen_config *config);
/* Ends the GPU's objects of everybody who drew here. Accepts a zeroed screen. */
void screen_finish(struct screen *screen);

/* How the picture stands on the window. */
struct screen_turn {
	uint32_t width, height; /* as the viewer sees it; the window lies across when it is turned by 90 or 270 */
	unsigned turn_deg;      /* clockwise: 0, 90, 180, 270 */
	float dim;              /* colours are multiplied with it; 1 as they are */
};

/* Copies the picture to the context's window, stretched to fit; turned and dimmed when config.turns was set. */
void screen_present(const struct screen *screen, const struct screen_turn *turn);
/* A black picture. */
void screen_draw_dark(struct screen *screen);
/* RGBA8, top row first, width * height * 4 bytes; waits for the picture. */
void screen_read_pixels(const struct screen *screen, uint8_t *out);

#endif
