/*
 * The visible set: what some eye of the stretch's view cell can see, local and distant, as its own triangles. Without
 * error; the measure that an impostor has to beat.
 */
#include <errno.h>

#include "platform/base/log.h"
#include "render/far_cells.h"
#include "render/repr.h"

static void sets(const struct pkg *pkg, const struct repr_config *config, struct cell_cache_config *out)
{
	(void)pkg;
	(void)config;
	*out =
		(struct cell_cache_config){ .pvs = CELL_PVS_ALWAYS, .without_impostors = true, .look_of = near_mesh_look_of };
}

static int init(struct repr *repr, struct arena *arena)
{
	bool stored = false;
	for (uint32_t i = 0; i < repr->pkg->stretch_count; i++)
		stored = stored || repr->pkg->stretches[i].pvs.stored_bytes;
	if (repr->pkg->stretches && !stored) {
		log_error("the package has no visible sets: bake it with --far all or --far pvs");
		return -ENODATA;
	}
	struct far_cells *cells = ARENA_ARRAY(arena, struct far_cells, 1);
	if (!cells)
		return -ENOMEM;
	repr->state = cells;
	return far_cells_init(cells, repr, arena);
}

static void finish(struct repr *repr)
{
	if (repr->state)
		far_cells_finish(repr->state);
}

static void choose(struct repr *repr, const struct repr_place *place)
{
	far_cells_select(repr->state, place);
}

static void emit(struct repr *repr, const struct view *view, struct draw_list *list)
{
	struct far_cells *cells = repr->state;
	far_cells_emit_near(cells, view, list);
	if (!far_cells_emit_pvs(cells, view, list))
		repr->counts.fallback = true;
}

static double split_m(const struct repr *repr)
{
	const struct far_cells *cells = repr->state;
	return cells->split_m;
}

static uint64_t bytes(const struct repr *repr)
{
	const struct far_cells *cells = repr->state;
	return cells->store.bytes;
}

static double error_px(const struct repr *repr)
{
	(void)repr;
	return 0.0;
}

const struct repr_ops repr_pvs = {
	.name = "pvs",
	.cells = sets,
	.init = init,
	.finish = finish,
	.select = choose,
	.emit = emit,
	.split_m = split_m,
	.bytes = bytes,
	.error_px = error_px,
};
