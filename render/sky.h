/* The sky, drawn after everything else that is far: one triangle at the end of the depth range. */
#ifndef BLVD_RENDER_SKY_H
#define BLVD_RENDER_SKY_H

#include "render/gfx.h"
#include "render/view.h"

struct sky {
	struct gfx *gfx;
	gfx_program program;
	gfx_pipeline pipeline;
};

int sky_init(struct sky *sky, struct gfx *gfx);
void sky_finish(struct sky *sky);
void sky_draw(const struct sky *sky, const struct view *view, gfx_buffer frame_block);

#endif
