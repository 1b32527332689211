/*
 * Where the car may be while its place is not sure: a calm ellipse on the ground around it, two sigma wide, in every
 * camera. It comes and goes within a second and its size never jumps. Nothing while the place is sure.
 */
#ifndef BLVD_RENDER_PLACE_DISC_H
#define BLVD_RENDER_PLACE_DISC_H

#include "nav/nav_view.h"
#include "render/gfx.h"
#include "render/view.h"

#define PLACE_DISC_SIGMAS 2.0

struct place_disc {
	struct gfx *gfx;
	gfx_program program;
	gfx_pipeline front, behind; /* what walls hide shows through faintly */
	gfx_buffer vertices;
	/* eased */
	bool started;
	int64_t time_ns;
	float alpha, major_m, minor_m; /* half axes as drawn */
};

int place_disc_init(struct place_disc *disc, struct gfx *gfx);
void place_disc_finish(struct place_disc *disc);

/* Once a frame. */
void place_disc_update(struct place_disc *disc, const struct nav_view *nav);
/* In one slice, with its gfx_depth_range set. `night` 0 to 1. */
void place_disc_draw(const struct place_disc *disc, const struct view *view, enum view_slice_id slice,
	const struct nav_view *nav, float night);

#endif
