/* Culling by bounds, one box a chunk; then near chunks to the near slice, and the representation for the rest. */
#include "render/scene.h"

#include <errno.h>

#include "render/camera.h"

int scene_init(struct scene *scene, struct arena *arena, const struct near_mesh *mesh, const struct repr_ops *far_ops)
{
	uint32_t chunks = mesh->pkg->chunk_count;
	*scene = (struct scene){ .mesh = mesh, .repr = { .ops = far_ops, .mesh = mesh } };
	scene->repr.fade = &scene->fade;
	scene->visible.items = ARENA_ARRAY(arena, struct visible_chunk, chunks);
	/* every chunk in both slices and all passes, and some to spare for dissolving objects */
	if (!scene->visible.items || draw_list_init(&scene->list, arena, chunks * VIEW_SLICE_COUNT * PKG_PASS_COUNT + 4096))
		return -ENOMEM;
	return far_ops->init(&scene->repr, arena);
}

void scene_finish(struct scene *scene)
{
	if (scene->repr.ops)
		scene->repr.ops->finish(&scene->repr);
	*scene = (struct scene){ 0 };
}

static void find_visible(struct scene *scene, const struct view *view)
{
	const struct pkg *pkg = scene->mesh->pkg;
	scene->visible.count = scene->visible.missing = 0;
	for (uint32_t i = 0; i < pkg->chunk_count; i++) {
		struct vec3 min, max;
		view_box(view, pkg->chunks[i].min_mm, pkg->chunks[i].max_mm, &min, &max);
		if (!view_sees_box(view, min, max))
			continue;
		if (!near_mesh_has(scene->mesh, i)) {
			scene->visible.missing++;
			continue;
		}
		struct visible_chunk *chunk = &scene->visible.items[scene->visible.count++];
		chunk->chunk = i;
		view_box_depth(view, min, max, &chunk->nearest_m, &chunk->farthest_m);
		bool straddles =
			chunk->nearest_m <= view->slice[VIEW_NEAR].far_m && chunk->farthest_m > view->slice[VIEW_FAR].near_m;
		chunk->whole = !straddles && view_holds_box(view, min, max);
	}
}

static uint32_t far_triangles(const struct draw_list *list)
{
	uint32_t sum = 0;
	for (uint32_t i = 0; i < list->count; i++)
		if (list->items[i].slice == VIEW_FAR)
			sum += list->items[i].count / 3;
	return sum;
}

void scene_build(struct scene *scene, const struct view *view)
{
	draw_list_clear(&scene->list);
	find_visible(scene, view);
	for (uint32_t i = 0; i < scene->visible.count; i++) {
		const struct visible_chunk *chunk = &scene->visible.items[i];
		if (chunk->nearest_m <= view->slice[VIEW_NEAR].far_m)
			near_mesh_emit(scene->mesh, &scene->fade, &scene->list, chunk->whole ? NULL : view, chunk->chunk, VIEW_NEAR,
				chunk->nearest_m);
	}
	scene->repr.ops->select(&scene->repr, view);
	scene->repr.ops->emit(&scene->repr, view, &scene->visible, &scene->list);
	scene->far_triangles = far_triangles(&scene->list);
	draw_list_sort(&scene->list);
}
