#include "render/far_cells.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "assets/cells.h"
#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "render/cell_emit.h"
#include "render/see_through.h"

#define DISSOLVE_NS (200 * NS_PER_MS)
#define SLACK_M 8.0     /* so far outside its view cell a local model still does, while a better one is loaded */
#define BESIDE_M 120.0  /* so far outside the distance still looks right enough */
#define ABOVE_MM 30000  /* above the view cell: roofs and yards are seen, which no cell has */
#define AROUND_M 400.0  /* geometry drawn around an eye beside the view cell */
#define THROUGH_M 120.0 /* seen through faded buildings: half as much again costs a third of the frame */
#define UPLOAD_BYTES (4 * PKG_PAGE_BYTES) /* a frame: copying a page costs a software GPU 0.7 ms */
#define NEAR_SHARE 0.97                   /* of near_mm, where the impostor may begin */
#define SPLIT_MIN_M 1.0 /* very wide pictures see the distance at their sides, little in front of the eye */
#define WANTED_MAX (NAV_LIKELY_MAX + 1 + CELL_CHOICE_AHEAD)
#define AHEAD_NS NS_PER_S /* of the eye's own way, for which its stretch is loaded */
#define BRIM_M 0.3        /* so far outside its view cell a stretch is as good as inside */

int far_cells_init(struct far_cells *cells, struct repr *repr, struct arena *arena)
{
	*cells = (struct far_cells){ .repr = repr, .here = PKG_NONE, .before = PKG_NONE, .rung = CELLS_OUTSIDE };
	if (!repr->pkg->stretches) {
		log_error("the package has no far field: bake it with --far all");
		return -ENODATA;
	}
	struct cell_cache_config config;
	struct cell_limits limits;
	repr->ops->cells(repr->pkg, &repr->config, &config);
	config.slot_count = repr->config.slot_count;
	config.deterministic = repr->config.deterministic;
	cell_cache_limits(repr->pkg, &config, &limits);
	cells->distant_chunks = config.pvs == CELL_PVS_ALWAYS;
	cell_choice_init(&cells->choice, repr->pkg);
	int err = cell_cache_init(&cells->cache, arena, repr->pkg, &config);
	if (err)
		return err;
	return cell_store_init(
		&cells->store, arena, repr->gfx, repr->pkg, &limits, config.slot_count, repr->config.show == REPR_SHOW_WIRE);
}

void far_cells_finish(struct far_cells *cells)
{
	cell_store_finish(&cells->store);
	cell_cache_finish(cells->cache);
	cells->cache = NULL;
}

/* Uploads what is ready, the most urgent first. */
static void upload(struct far_cells *cells, uint64_t left_bytes)
{
	for (;;) {
		uint32_t slot = cell_cache_next_ready(cells->cache);
		const struct cell_set *own = slot != CELL_SLOT_NONE ? &cell_cache_slot(cells->cache, slot)->pvs : NULL;
		if (own && cells->store.slots[slot].step == STORED_NOTHING)
			near_mesh_need(cells->repr->mesh, own->vertices, own->vertex_count);
		if (slot == CELL_SLOT_NONE ||
			!cell_store_upload(&cells->store, slot, cell_cache_slot(cells->cache, slot), &left_bytes))
			return;
		cell_cache_uploaded(cells->cache, slot);
		if (!left_bytes)
			return;
	}
}

/* Adds the stretches of the places where the eye is going to be if it moves on as it did since the last frame. */
static uint32_t add_ahead(struct far_cells *cells, const struct repr_place *place, uint32_t *list, uint32_t count)
{
	const int64_t *eye_mm = place->view->eye_mm, passed_ns = place->time_ns - cells->eye_ns;
	for (uint32_t i = 0; i < CELL_CHOICE_AHEAD && place->nav && !place->jumped && passed_ns > 0; i++) {
		const int64_t ahead_ns = AHEAD_NS * (i + 1) / CELL_CHOICE_AHEAD;
		int64_t ahead_mm[3];
		for (int axis = 0; axis < 3; axis++)
			ahead_mm[axis] = eye_mm[axis] + (eye_mm[axis] - cells->eye_mm[axis]) * ahead_ns / passed_ns;
		uint32_t ahead = cell_choice_ahead(&cells->choice, i, place->nav, ahead_mm);
		if (ahead != PKG_NONE && (!count || ahead != list[count - 1]))
			list[count++] = ahead;
	}
	memcpy(cells->eye_mm, eye_mm, sizeof(cells->eye_mm));
	cells->eye_ns = place->time_ns;
	return count;
}

/* Asks for what is wanted now and soon. What is drawn must stay. */
static void ask(struct far_cells *cells, uint32_t wanted, const struct repr_place *place)
{
	uint32_t list[WANTED_MAX] = { wanted }, count = wanted != PKG_NONE;
	count = add_ahead(cells, place, list, count);
	for (uint32_t i = 0; place->nav && i < place->nav->likely_count && i < NAV_LIKELY_MAX; i++)
		list[count++] = place->nav->likely[i];
	const uint32_t pinned[2] = { cells->here, cells->before };
	cell_cache_update(cells->cache, list, count, pinned, 2);
	cell_store_follow(&cells->store, cells->cache);
	uint64_t slice = cells->repr->config.upload_slice_bytes;
	upload(cells, slice < UPLOAD_BYTES ? slice : UPLOAD_BYTES);
	if (!place->jumped || wanted == PKG_NONE)
		return;
	cell_cache_wait(cells->cache, wanted);
	cell_store_follow(&cells->store, cells->cache);
	upload(cells, UINT64_MAX);
}

static bool drawable(const struct far_cells *cells, uint32_t stretch, uint32_t *slot)
{
	return stretch != PKG_NONE && cell_cache_find(cells->cache, stretch, slot) == CELL_UPLOADED;
}

/* Of the stretches that are there, one whose view cell holds the eye, or the one that is drawn while the eye is on its
 * brim: where streets meet, that is as good. */
static uint32_t stand_in(const struct far_cells *cells, const int64_t eye_mm[3])
{
	for (uint32_t i = 0; i < cell_cache_slot_count(cells->cache); i++) {
		const struct cell_slot *slot = cell_cache_slot(cells->cache, i);
		if (slot->state == CELL_UPLOADED && cells_holds_eye(&cells->repr->pkg->stretches[slot->stretch], eye_mm))
			return slot->stretch;
	}
	bool on_brim =
		cells->here != PKG_NONE && cells_distance_m(&cells->repr->pkg->stretches[cells->here], eye_mm) <= BRIM_M;
	return on_brim ? cells->here : PKG_NONE;
}

static void enter(struct far_cells *cells, uint32_t wanted, uint32_t slot, const struct repr_place *place)
{
	bool dissolves = cells->here != PKG_NONE && !place->jumped && cells->rung != CELLS_OUTSIDE;
	cells->before = dissolves ? cells->here : PKG_NONE;
	cells->before_slot = cells->slot;
	cells->here = wanted;
	cells->slot = slot;
	cells->entered_ns = place->time_ns;
	cells->repr->counts.entered++;
}

static void dissolve(struct far_cells *cells, int64_t time_ns)
{
	int64_t since_ns = time_ns - cells->entered_ns;
	if (since_ns < 0 || since_ns >= DISSOLVE_NS)
		cells->before = PKG_NONE;
	cells->before_share = 1.0f - (float)since_ns / (float)DISSOLVE_NS;
}

static enum cells_rung rung_of(const struct far_cells *cells, const int64_t eye_mm[3])
{
	if (cells->here == PKG_NONE)
		return CELLS_OUTSIDE;
	const struct pkg_stretch *stretch = &cells->repr->pkg->stretches[cells->here];
	double away_m = cells_distance_m(stretch, eye_mm);
	if (away_m <= (cells->late ? SLACK_M : BRIM_M))
		return CELLS_INSIDE;
	int32_t low_mm = stretch->start_mm[2] < stretch->end_mm[2] ? stretch->start_mm[2] : stretch->end_mm[2];
	bool above = eye_mm[2] - low_mm > stretch->eye_max_mm + ABOVE_MM;
	return above || away_m > BESIDE_M ? CELLS_OUTSIDE : CELLS_BESIDE;
}

/* The nearest depth that the distance of a stretch can have: at the corner of the picture. */
static double nearest_depth_m(const struct pkg_stretch *stretch, const struct view *view)
{
	double tan_x = view->tan_half_x, tan_y = view->tan_half_y;
	double nearest_m = stretch->near_mm * 1e-3 * NEAR_SHARE - stretch->half_width_mm * 1e-3;
	return nearest_m / sqrt(1.0 + tan_x * tan_x + tan_y * tan_y);
}

/* Slices meet where the distance begins, so that it is drawn in one only, and little of the rest in both. */
static double choose_split(const struct far_cells *cells, const struct view *view)
{
	if (cells->rung != CELLS_INSIDE)
		return 0.0;
	const struct pkg_stretch *stretches = cells->repr->pkg->stretches;
	double split_m = nearest_depth_m(&stretches[cells->here], view);
	if (cells->before != PKG_NONE)
		split_m = fmin(split_m, nearest_depth_m(&stretches[cells->before], view));
	return fmax(split_m * 0.97, SPLIT_MIN_M);
}

void far_cells_select(struct far_cells *cells, const struct repr_place *place)
{
	const int64_t *eye_mm = place->view->eye_mm;
	uint32_t wanted = cell_choice_make(&cells->choice, place->nav, eye_mm), slot = CELL_SLOT_NONE;
	ask(cells, wanted, place);
	if (!drawable(cells, wanted, &slot)) {
		uint32_t other = stand_in(cells, eye_mm);
		wanted = other == PKG_NONE ? wanted : cell_choice_take(&cells->choice, other);
	}
	if (drawable(cells, wanted, &slot)) {
		if (wanted != cells->here)
			enter(cells, wanted, slot, place);
		cells->slot = slot;
	}
	cells->late = wanted != cells->here;
	if (!drawable(cells, cells->here, &cells->slot))
		cells->here = PKG_NONE;
	if (!drawable(cells, cells->before, &cells->before_slot))
		cells->before = PKG_NONE;
	dissolve(cells, place->time_ns);
	cells->rung = rung_of(cells, eye_mm);
	cells->split_m = choose_split(cells, place->view);
	struct repr_counts *counts = &cells->repr->counts;
	counts->triangles = counts->missing = 0;
	cells->placed = !place->nav || place->nav->located;
	counts->late = cells->late && cells->placed;
	counts->fallback = counts->late || (cells->rung != CELLS_INSIDE && cells->placed);
	struct cell_cache_stats loading;
	cell_cache_stats(cells->cache, &loading);
	counts->damaged = loading.damaged;
}

static void emit_around(struct far_cells *cells, const struct view *view, double reach_m, struct draw_list *list)
{
	struct repr *repr = cells->repr;
	visible_find(repr->visible, repr->mesh, view, reach_m);
	visible_emit(repr->visible, repr->mesh, repr->fade, view, list);
	repr->counts.missing += repr->visible->missing;
}

void far_cells_emit_near(struct far_cells *cells, const struct view *view, struct draw_list *list)
{
	struct repr *repr = cells->repr;
	if (cells->rung == CELLS_INSIDE) {
		struct cell_emitted out = cell_emit(&cells->store.slots[cells->slot].local, repr->mesh, repr->fade, view, list);
		repr->counts.missing += out.missing;
		see_through_emit(repr->fade, repr->mesh, view, THROUGH_M, repr->visible, list);
	} else {
		emit_around(cells, view, cells->rung == CELLS_BESIDE ? AROUND_M : repr->config.far_m * 2.0, list);
	}
	if (repr->counts.missing && cells->placed)
		repr->counts.fallback = repr->counts.late = true;
}

bool far_cells_emit_pvs(struct far_cells *cells, const struct view *view, struct draw_list *list)
{
	if (cells->rung == CELLS_OUTSIDE)
		return true; /* all geometry is drawn */
	if (!cell_cache_slot(cells->cache, cells->slot)->has_pvs)
		return cells->repr->pkg->stretches[cells->here].pvs_triangles == 0;
	struct repr *repr = cells->repr;
	struct cell_emitted out = cell_emit(&cells->store.slots[cells->slot].pvs, repr->mesh, repr->fade, view, list);
	repr->counts.triangles += out.triangles;
	repr->counts.missing += out.missing;
	return true;
}

double far_cells_reach_m(const struct far_cells *cells)
{
	if (cells->rung == CELLS_OUTSIDE || cells->distant_chunks)
		return cells->repr->config.far_m;
	return cells->repr->config.reach_m > 0.0 ? cells->repr->config.reach_m : AROUND_M * 2.0;
}

uint32_t far_cells_in_view(const struct pkg_stretch *stretch, const struct view *view)
{
	struct vec3 axis = { (float)(stretch->end_mm[0] - stretch->start_mm[0]),
		(float)(stretch->end_mm[1] - stretch->start_mm[1]), 0.0f };
	struct vec3 f = view->forward, r = vec3_scale(view->right, view->tan_half_x),
				u = vec3_scale(view->up, view->tan_half_y);
	uint32_t seen = 0;
	for (int corner = 0; corner < 4; corner++) {
		struct vec3 ray =
			vec3_add(f, vec3_add(vec3_scale(r, corner & 1 ? 1.0f : -1.0f), vec3_scale(u, corner & 2 ? 1.0f : -1.0f)));
		seen |= vec3_dot(ray, axis) >= 0.0f ? 1u : 2u;
	}
	return seen;
}
