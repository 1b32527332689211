/* The two plain representations: everything in view as its own triangles, and nothing beyond the near slice. */
#include <string.h>

#include "render/repr.h"

static int plain_init(struct repr *repr, struct arena *arena)
{
	(void)repr;
	(void)arena;
	return 0;
}

static void plain_finish(struct repr *repr)
{
	(void)repr;
}

static void plain_select(struct repr *repr, const struct view *view)
{
	(void)repr;
	(void)view;
}

static uint64_t plain_bytes(const struct repr *repr)
{
	(void)repr;
	return 0; /* shares the near geometry's pools */
}

static double plain_error_px(const struct repr *repr)
{
	(void)repr;
	return 0.0;
}

static void full_emit(
	struct repr *repr, const struct view *view, const struct visible_set *visible, struct draw_list *list)
{
	for (uint32_t i = 0; i < visible->count; i++) {
		const struct visible_chunk *chunk = &visible->items[i];
		if (chunk->farthest_m > view->slice[VIEW_FAR].near_m)
			near_mesh_emit(
				repr->mesh, repr->fade, list, chunk->whole ? NULL : view, chunk->chunk, VIEW_FAR, chunk->nearest_m);
	}
}

/* Chunks that begin in the near slice are drawn to their end, so that none is cut in two. */
static void none_emit(
	struct repr *repr, const struct view *view, const struct visible_set *visible, struct draw_list *list)
{
	for (uint32_t i = 0; i < visible->count; i++) {
		const struct visible_chunk *chunk = &visible->items[i];
		bool straddles =
			chunk->nearest_m <= view->slice[VIEW_NEAR].far_m && chunk->farthest_m > view->slice[VIEW_FAR].near_m;
		if (straddles)
			near_mesh_emit(
				repr->mesh, repr->fade, list, chunk->whole ? NULL : view, chunk->chunk, VIEW_FAR, chunk->nearest_m);
	}
}

const struct repr_ops repr_full = {
	.name = "full",
	.init = plain_init,
	.finish = plain_finish,
	.select = plain_select,
	.emit = full_emit,
	.bytes = plain_bytes,
	.error_px = plain_error_px,
};

const struct repr_ops repr_none = {
	.name = "none",
	.init = plain_init,
	.finish = plain_finish,
	.select = plain_select,
	.emit = none_emit,
	.bytes = plain_bytes,
	.error_px = plain_error_px,
};

const struct repr_ops *repr_by_name(const char *name)
{
	static const struct repr_ops *const all[] = { &repr_full, &repr_none };
	for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
		if (!strcmp(all[i]->name, name))
			return all[i];
	return NULL;
}
