/*
 * What the representations by cells share: which stretch of the street the frame is seen from, its loading, and what is
 * drawn while it is not there or does not fit ([S97] section 3).
 *
 * The ladder, from the top; everything below the first rung is counted as a fallback:
 *   CELLS_INSIDE   the eye is in the view cell: its local model, and what stands for the distance
 *   CELLS_BESIDE   outside, but near: all geometry around the eye, and what stands for the distance seen from the cell
 *   CELLS_OUTSIDE  far from any view cell, high above, or nothing has been loaded yet: all geometry that is resident
 * Until the car's place is known no stretch belongs to the picture, so nothing stands in for one: all geometry that
 * is resident is what there is to see, and no fallback.
 */
#ifndef BLVD_RENDER_FAR_CELLS_H
#define BLVD_RENDER_FAR_CELLS_H

#include "render/cell_choice.h"
#include "render/cell_store.h"
#include "render/repr.h"

enum cells_rung { CELLS_INSIDE, CELLS_BESIDE, CELLS_OUTSIDE };

struct far_cells {
	struct repr *repr;
	struct cell_cache *cache;
	struct cell_store store;
	struct cell_choice choice;
	uint32_t here;   /* the stretch that is drawn, PKG_NONE before the first */
	uint32_t before; /* the one that dissolves, PKG_NONE when none does */
	uint32_t slot, before_slot;
	int64_t entered_ns;
	float before_share; /* of its pixels that are left */
	enum cells_rung rung;
	bool distant_chunks;       /* visible sets have no vertices of their own */
	bool late;                 /* a better one is wanted than the one that is drawn */
	int64_t eye_mm[3], eye_ns; /* of the last frame */
	bool placed;               /* it is known where the car is, or the eye was chosen */
	double split_m;
};

/* By what the representation's cells() says. Returns 0, -ENODATA, -ENOMEM or -errno. */
int far_cells_init(struct far_cells *cells, struct repr *repr, struct arena *arena);
void far_cells_finish(struct far_cells *cells);

void far_cells_select(struct far_cells *cells, const struct repr_place *place);

/* The near geometry of the rung; counts what was missing. */
void far_cells_emit_near(struct far_cells *cells, const struct view *view, struct draw_list *list);

/* The stretch's distant triangles; false when they are not stored. Adds to counts.triangles. */
bool far_cells_emit_pvs(struct far_cells *cells, const struct view *view, struct draw_list *list);

/* How far from the eye geometry is wanted: what the rungs draw, and as much again for the stretches to come. */
double far_cells_reach_m(const struct far_cells *cells);

/* Which of a stretch's two cells show something of this view: bit 0 the one along its edge, bit 1 the other. */
uint32_t far_cells_in_view(const struct pkg_stretch *stretch, const struct view *view);

#endif
