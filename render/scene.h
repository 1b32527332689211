/* The front end of a frame: which chunks are in view, and the list of draws that shows them. No GL. */
#ifndef BLVD_RENDER_SCENE_H
#define BLVD_RENDER_SCENE_H

#include "render/draw_list.h"
#include "render/near_mesh.h"
#include "render/repr.h"
#include "render/view.h"

struct scene {
	const struct near_mesh *mesh;
	struct repr repr;
	struct fade fade;
	struct visible_set visible;
	struct draw_list list;
	uint32_t far_triangles; /* of the last frame */
};

/* Returns 0, -ENOMEM, or what the representation's init returned. */
int scene_init(struct scene *scene, struct arena *arena, const struct near_mesh *mesh, const struct repr_ops *far_ops);
void scene_finish(struct scene *scene);

/* Fills scene->list, sorted. */
void scene_build(struct scene *scene, const struct view *view);

#endif
