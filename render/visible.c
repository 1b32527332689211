#include "render/visible.h"

#include <errno.h>
#include <math.h>

#include "render/camera.h"

int visible_init(struct visible_set *visible, struct arena *arena, const struct pkg *pkg)
{
	*visible = (struct visible_set){ .items = ARENA_ARRAY(arena, struct visible_chunk, pkg->chunk_count) };
	return visible->items ? 0 : -ENOMEM;
}

void visible_find(struct visible_set *visible, const struct near_mesh *mesh, const struct view *view, double reach_m)
{
	const struct pkg *pkg = mesh->pkg;
	visible->count = visible->missing = 0;
	for (uint32_t i = 0; i < pkg->chunk_count; i++) {
		struct vec3 min, max;
		view_box(view, pkg->chunks[i].min_mm, pkg->chunks[i].max_mm, &min, &max);
		if (!view_sees_box(view, min, max) || view_box_distance_m(min, max) > reach_m)
			continue;
		if (!near_mesh_has(mesh, i)) {
			visible->missing++;
			continue;
		}
		struct visible_chunk *chunk = &visible->items[visible->count++];
		chunk->chunk = i;
		view_box_depth(view, min, max, &chunk->nearest_m, &chunk->farthest_m);
		bool straddles =
			chunk->nearest_m <= view->slice[VIEW_NEAR].far_m && chunk->farthest_m > view->slice[VIEW_FAR].near_m;
		chunk->whole = !straddles && view_holds_box(view, min, max);
	}
}

void visible_emit(const struct visible_set *visible, const struct near_mesh *mesh, const struct fade *fade,
	const struct view *view, struct draw_list *list)
{
	for (uint32_t i = 0; i < visible->count; i++) {
		const struct visible_chunk *chunk = &visible->items[i];
		const struct view *cut = chunk->whole ? NULL : view;
		if (chunk->nearest_m <= view->slice[VIEW_NEAR].far_m)
			near_mesh_emit(mesh, fade, list, cut, chunk->chunk, VIEW_NEAR, chunk->nearest_m);
		if (chunk->farthest_m > view->slice[VIEW_FAR].near_m)
			near_mesh_emit(mesh, fade, list, cut, chunk->chunk, VIEW_FAR, chunk->nearest_m);
	}
}
