/*
 * The impostor of [S97]: what is near is the local model of the stretch under the eye, the distance is textured
 * triangles made for exactly this stretch. Cells whose distance is better drawn as geometry (PKG_CELL_GEOMETRY, or an
 * error above what is asked for) show the stretch's visible set instead.
 *
 * At a change of stretch the new impostor is whole at once, because its local model is; the old one lies over it and
 * dissolves. So what differs between the two changes softly and no pixel is ever empty.
 */
#include <errno.h>

#include "render/far_cells.h"
#include "render/impostor_draw.h"
#include "render/impostor_truth.h"
#include "render/repr.h"

struct far_impostor {
	struct far_cells cells;
	struct impostor_draw draw;
	struct impostor_truth truth;
	bool as_geometry; /* the distance is the visible set in this frame */
	struct impostor_shown shown[4];
	uint32_t shown_cells[4];
	uint32_t shown_count;
	double error_px;
};

static bool too_coarse(const struct pkg_cell *cell, double tau_px)
{
	return tau_px > 0.0 && cell->kind == PKG_CELL_IMPOSTOR && (double)cell->error_px > tau_px;
}

/* Visible sets are held for stretches whose cells need them; for all when one is too coarse for what is asked. */
static enum cell_pvs sets_wanted(const struct pkg *pkg, double tau_px)
{
	for (uint32_t i = 0; pkg->stretches && i < pkg->stretch_count * 2; i++)
		if (pkg->stretches[i / 2].pvs.stored_bytes && too_coarse(&pkg->cells[i], tau_px))
			return CELL_PVS_ALWAYS;
	return CELL_PVS_WHERE_NEEDED;
}

static void cells(const struct pkg *pkg, const struct repr_config *config, struct cell_cache_config *out)
{
	*out = (struct cell_cache_config){ .pvs = sets_wanted(pkg, config->tau_px), .look_of = near_mesh_look_of };
}

static int init(struct repr *repr, struct arena *arena)
{
	struct far_impostor *far = ARENA_ARRAY(arena, struct far_impostor, 1);
	if (!far)
		return -ENOMEM;
	repr->state = far;
	int err = far_cells_init(&far->cells, repr, arena);
	if (!err && repr->config.truth)
		err = impostor_truth_init(&far->truth, arena, repr->gfx, repr->pkg);
	return err ? err
			   : impostor_draw_init(
					 &far->draw, repr->gfx, repr->config.show != REPR_SHOW_PLAIN, repr->config.show == REPR_SHOW_WIRE);
}

static void finish(struct repr *repr)
{
	struct far_impostor *far = repr->state;
	if (!far)
		return;
	impostor_truth_finish(&far->truth);
	impostor_draw_finish(&far->draw);
	far_cells_finish(&far->cells);
}

/* Adds what this view sees of a stretch. */
static void show(struct far_impostor *far, const struct repr *repr, const struct view *view, uint32_t stretch,
	uint32_t slot, float share)
{
	uint32_t seen = far_cells_in_view(&repr->pkg->stretches[stretch], view);
	for (uint32_t i = 0; i < 2; i++) {
		const struct pkg_cell *cell = &repr->pkg->cells[stretch * 2 + i];
		const struct stored_impostor *impostor = &far->cells.store.slots[slot].impostor[i];
		if (!(seen >> i & 1) || !impostor->index_count)
			continue;
		far->shown_cells[far->shown_count] = stretch * 2 + i;
		far->shown[far->shown_count++] = (struct impostor_shown){ .impostor = impostor,
			.origin_mm = cell->origin_mm,
			.share = share,
			.near_slice = far->cells.rung != CELLS_INSIDE };
		far->error_px = (double)cell->error_px > far->error_px ? (double)cell->error_px : far->error_px;
	}
}

/* Does the view see a cell of the stretch whose distance should be geometry? */
static bool wants_geometry(const struct far_impostor *far, const struct repr *repr, const struct view *view)
{
	uint32_t here = far->cells.here, seen = far_cells_in_view(&repr->pkg->stretches[here], view);
	for (uint32_t i = 0; i < 2; i++) {
		const struct pkg_cell *cell = &repr->pkg->cells[here * 2 + i];
		if (seen >> i & 1 && (cell->kind == PKG_CELL_GEOMETRY || too_coarse(cell, repr->config.tau_px)))
			return true;
	}
	return false;
}

static void choose(struct repr *repr, const struct repr_place *place)
{
	struct far_impostor *far = repr->state;
	struct far_cells *cells = &far->cells;
	far_cells_select(cells, place);
	far->shown_count = 0;
	far->error_px = 0.0;
	far->as_geometry = false;
	if (cells->rung == CELLS_OUTSIDE)
		return;
	far->as_geometry = cell_cache_slot(cells->cache, cells->slot)->has_pvs && wants_geometry(far, repr, place->view);
	if (!far->as_geometry)
		show(far, repr, place->view, cells->here, cells->slot, 1.0f);
	if (cells->before != PKG_NONE)
		show(far, repr, place->view, cells->before, cells->before_slot, cells->before_share);
}

static void emit(struct repr *repr, const struct view *view, struct draw_list *list)
{
	struct far_impostor *far = repr->state;
	far_cells_emit_near(&far->cells, view, list);
	if (far->as_geometry)
		far_cells_emit_pvs(&far->cells, view, list);
	for (uint32_t i = 0; i < far->shown_count; i++)
		repr->counts.triangles += far->shown[i].impostor->index_count / 3;
}

/* What dissolves comes first: it lies in front. */
static void draw(const struct repr *repr, const struct view *view, gfx_buffer frame_block)
{
	const struct far_impostor *far = repr->state;
	for (uint32_t i = far->shown_count; i-- > 0;)
		impostor_draw(&far->draw, &far->cells.store, repr->mesh, view, &far->shown[i], frame_block);
}

static void draw_truth(const struct repr *repr, const struct view *view)
{
	struct far_impostor *far = repr->state;
	for (uint32_t i = far->shown_count; i-- > 0;)
		impostor_truth_draw(&far->truth, &far->cells.store, view, &far->shown[i], far->shown_cells[i]);
}

static double split_m(const struct repr *repr)
{
	const struct far_impostor *far = repr->state;
	return far->cells.split_m;
}

static double reach_m(const struct repr *repr)
{
	const struct far_impostor *far = repr->state;
	return far_cells_reach_m(&far->cells);
}

static uint64_t bytes(const struct repr *repr)
{
	const struct far_impostor *far = repr->state;
	return far->cells.store.bytes;
}

static double error_px(const struct repr *repr)
{
	const struct far_impostor *far = repr->state;
	return far->error_px;
}

const struct repr_ops repr_impostor = {
	.name = "impostor",
	.cells = cells,
	.init = init,
	.finish = finish,
	.select = choose,
	.emit = emit,
	.draw = draw,
	.draw_truth = draw_truth,
	.split_m = split_m,
	.reach_m = reach_m,
	.bytes = bytes,
	.error_px = error_px,
};
