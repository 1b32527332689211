#include "render/scene.h"

#include <errno.h>

/* every chunk in both slices and all passes, and some to spare for dissolving objects */
static uint32_t draws_max(const struct pkg *pkg)
{
	return pkg->chunk_count * VIEW_SLICE_COUNT * PKG_PASS_COUNT + 4096;
}

uint64_t scene_arena_bytes(const struct pkg *pkg)
{
	return pkg->chunk_count * sizeof(struct visible_chunk) + draws_max(pkg) * 2 * sizeof(struct draw_item);
}

int scene_init(struct scene *scene, struct arena *arena, struct gfx *gfx, struct near_mesh *mesh, const struct pkg *pkg,
	const struct repr_ops *far_ops, const struct repr_config *config)
{
	*scene = (struct scene){
		.repr = { .ops = far_ops, .gfx = gfx, .pkg = pkg, .mesh = mesh, .config = *config },
	};
	scene->repr.fade = &scene->fade;
	scene->repr.visible = &scene->visible;
	if (visible_init(&scene->visible, arena, pkg) || draw_list_init(&scene->list, arena, draws_max(pkg)))
		return -ENOMEM;
	return far_ops->init(&scene->repr, arena);
}

void scene_finish(struct scene *scene)
{
	if (scene->repr.ops)
		scene->repr.ops->finish(&scene->repr);
	*scene = (struct scene){ 0 };
}

void scene_build(struct scene *scene, const struct view *view)
{
	draw_list_clear(&scene->list);
	scene->repr.ops->emit(&scene->repr, view, &scene->list);
	draw_list_sort(&scene->list);
}
