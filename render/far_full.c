/* The two plain representations: everything in view as its own triangles, and nothing beyond the near slice. */
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

static void plain_select(struct repr *repr, const struct repr_place *place)
{
	(void)repr;
	(void)place;
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

static void find(struct repr *repr, const struct view *view)
{
	visible_find(repr->visible, repr->mesh, view, repr->config.far_m * 2.0);
}

static void count(struct repr *repr, const struct draw_list *list)
{
	repr->counts.triangles = 0;
	for (uint32_t i = 0; i < list->count; i++)
		if (list->items[i].slice == VIEW_FAR)
			repr->counts.triangles += list->items[i].count / 3;
	repr->counts.missing = repr->visible->missing;
	repr->counts.fallback = repr->visible->missing > 0;
	repr->counts.late = repr->counts.fallback;
}

static void full_emit(struct repr *repr, const struct view *view, struct draw_list *list)
{
	find(repr, view);
	visible_emit(repr->visible, repr->mesh, repr->fade, view, list);
	count(repr, list);
}

/* Chunks that begin in the near slice are drawn to their end, so that none is cut in two. */
static void none_emit(struct repr *repr, const struct view *view, struct draw_list *list)
{
	struct visible_set *visible = repr->visible;
	uint32_t kept = 0;
	find(repr, view);
	for (uint32_t i = 0; i < visible->count; i++)
		if (visible->items[i].nearest_m <= view->slice[VIEW_NEAR].far_m)
			visible->items[kept++] = visible->items[i];
	visible->count = kept;
	visible_emit(visible, repr->mesh, repr->fade, view, list);
	count(repr, list);
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
