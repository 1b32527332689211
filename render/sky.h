/*
 * The sky, drawn after everything else that is far, at the end of the depth range. By day it is a gradient worked out
 * at the corners of a grid, and every pixel is worked out around the sun only; under stars, every pixel is.
 */
#ifndef BLVD_RENDER_SKY_H
#define BLVD_RENDER_SKY_H

#include "render/gfx.h"
#include "render/sun.h"
#include "render/view.h"

enum sky_kind { SKY_EVERY_PIXEL, SKY_GRID, SKY_SUN, SKY_KIND_COUNT };
struct sky {
	struct gfx *gfx;
	gfx_program programs[SKY_KIND_COUNT];
	gfx_pipeline pipelines[SKY_KIND_COUNT];
};

int sky_init(struct sky *sky, struct gfx *gfx);
void sky_finish(struct sky *sky);
void sky_draw(const struct sky *sky, const struct view *view, const struct light_state *light, gfx_buffer frame_block);

#endif
