/*
 * What is seen through faded buildings. A local model leaves out what they hide, so while one is faded the geometry
 * behind it is drawn as it is.
 */
#ifndef BLVD_RENDER_SEE_THROUGH_H
#define BLVD_RENDER_SEE_THROUGH_H

#include "render/draw_list.h"
#include "render/fade.h"
#include "render/near_mesh.h"
#include "render/visible.h"

/* Adds the solid triangles of resident chunks up to `reach_m` that lie behind what fades, as far as the view sees it;
 * nothing when nothing fades. Triangles that are drawn anyway are drawn twice, alike. `visible` is overwritten. */
void see_through_emit(const struct fade *fade, const struct near_mesh *mesh, const struct view *view, double reach_m,
	struct visible_set *visible, struct draw_list *list);

#endif
