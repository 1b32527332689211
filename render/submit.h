/* The back end of a frame: walks the sorted list, nothing else. */
#ifndef BLVD_RENDER_SUBMIT_H
#define BLVD_RENDER_SUBMIT_H

#include "render/draw_list.h"
#include "render/gfx.h"
#include "render/near_mesh.h"
#include "render/view.h"

/* The solid part of the list. */
void submit_solid(struct gfx *gfx, const struct near_mesh *mesh, const struct view *view, const struct draw_list *list,
	gfx_buffer frame_block);

/* The rest, after everything that should be seen through it: its depth first, so that only its nearest surface is
 * blended. */
void submit_faded(struct gfx *gfx, const struct near_mesh *mesh, const struct view *view, const struct draw_list *list,
	gfx_buffer frame_block);

/* Where an item's vertices and indices are: fills in that part of a draw. */
void submit_geometry(struct gfx_draw *draw, const struct near_mesh *mesh, const struct draw_item *item);

#endif
