/* The back end of a frame: walks the sorted list, nothing else. */
#ifndef BLVD_RENDER_SUBMIT_H
#define BLVD_RENDER_SUBMIT_H

#include "render/draw_list.h"
#include "render/gfx.h"
#include "render/near_mesh.h"
#include "render/view.h"

void submit(struct gfx *gfx, const struct near_mesh *mesh, const struct view *view, const struct draw_list *list,
	gfx_buffer frame_block);

#endif
