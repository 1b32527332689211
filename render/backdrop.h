/*
 * The lie of the land around the eye, as rings of the terrain in one tone under the haze: what is seen below the
 * horizon where the city's geometry, or what stands for it, has nothing. Drawn after the sky.
 */
#ifndef BLVD_RENDER_BACKDROP_H
#define BLVD_RENDER_BACKDROP_H

#include "assets/pkg.h"
#include "render/gfx.h"
#include "render/view.h"

struct backdrop {
	struct gfx *gfx;
	const struct pkg *pkg;
	gfx_program program;
	gfx_pipeline pipeline;
	gfx_buffer vertices, indices;
};

/* Returns 0, -ENOMEM or -EINVAL. */
int backdrop_init(struct backdrop *backdrop, struct gfx *gfx, const struct pkg *pkg);
void backdrop_finish(struct backdrop *backdrop);

/* Before the pass. Cost: a few hundred looks at the terrain. */
void backdrop_update(const struct backdrop *backdrop, const struct view *view);
void backdrop_draw(const struct backdrop *backdrop, const struct view *view, gfx_buffer frame_block);

#endif
