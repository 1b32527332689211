/* The car's own marker: a solid arrow on the road, drawn in the cameras that see the car from outside. */
#ifndef BLVD_RENDER_MARKER_H
#define BLVD_RENDER_MARKER_H

#include "nav/nav.h"
#include "render/camera.h"
#include "render/gfx.h"
#include "render/view.h"

struct marker {
	struct gfx *gfx;
	gfx_program program;
	gfx_pipeline behind, front; /* what walls hide shows through faintly */
	gfx_buffer vertices;
};

int marker_init(struct marker *marker, struct gfx *gfx);
void marker_finish(struct marker *marker);
/* Nothing in the driver's eye, or without a position. `night` 0 to 1. */
void marker_draw(const struct marker *marker, const struct view *view, const struct nav_view *nav,
	enum camera_kind kind, float night);

#endif
