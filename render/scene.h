/* The front end of a frame: the representation of the distance, and the list of draws that shows the city. No GL but
 * what the representation uploads. */
#ifndef BLVD_RENDER_SCENE_H
#define BLVD_RENDER_SCENE_H

#include "render/draw_list.h"
#include "render/near_mesh.h"
#include "render/repr.h"
#include "render/view.h"

struct scene {
	struct repr repr;
	struct fade fade;
	struct visible_set visible;
	struct draw_list list;
};

/* Before near_mesh_init(), which takes what the representation leaves of the budget; `mesh` is only remembered. Returns
 * 0, -ENOMEM, or what the representation's init returned. */
int scene_init(struct scene *scene, struct arena *arena, struct gfx *gfx, struct near_mesh *mesh, const struct pkg *pkg,
	const struct repr_ops *far_ops, const struct repr_config *config);
/* What it takes from the arena for itself, but for padding. */
uint64_t scene_arena_bytes(const struct pkg *pkg);
void scene_finish(struct scene *scene);

/* Fills scene->list, sorted. After the representation's select(). */
void scene_build(struct scene *scene, const struct view *view);

#endif
