/*
 * The route on the street: a ribbon on the carriageway, chevrons before the next manoeuvre and an arrow standing over
 * its junction. Geometry is rebuilt into fixed buffers only when the route's window changes.
 *
 * Per frame: ribbon_update() outside of passes; ribbon_draw() in every depth slice, after its opaque geometry;
 * ribbon_draw_hidden() in every slice again when all geometry is drawn: what buildings hide shows faintly.
 */
#ifndef BLVD_RENDER_ROUTE_RIBBON_H
#define BLVD_RENDER_ROUTE_RIBBON_H

#include "render/gfx.h"
#include "render/palette.h"
#include "render/route_path.h"
#include "render/view.h"

struct ribbon_vertex {
	float pos[3];  /* m from the path's origin; of the ribbon's middle */
	float side[2]; /* from there to the right edge; 0 for the arrow */
	float lateral; /* ribbon: -1 left edge to 1 right edge; arrow: shade 0 to 1 */
	float s;       /* m along the path */
};

struct ribbon {
	struct route_path path;
	struct gfx *gfx; /* NULL: nothing is drawn (tests) */
	gfx_program ribbon_program, arrow_program;
	gfx_pipeline seen, hidden, arrow;
	gfx_buffer ribbon_buffer, arrow_buffer;
	struct ribbon_vertex *vertices;
	uint32_t vertex_count;         /* of the ribbon: a triangle strip */
	uint32_t arrow_vertex_count;   /* triangles */
	uint32_t arrow_from, arrow_to; /* half-edges that the arrow was built for */
	double arrow_s;                /* where the manoeuvre is; meaningful when arrow_vertex_count > 0 */
	double car_s;
	float arrow_alpha;
	uint32_t rebuilds; /* since start */
	struct palette palette;
};

/* Where the ribbon starts and ends, from the car, m; both fade over the second number. */
struct ribbon_look {
	float start_m, start_fade_m;
	float end_m, end_fade_m;
	float hidden_alpha; /* of what buildings hide */
	float least_px;     /* wide at least, on the screen; for overviews */
	bool arrow;         /* the arrow over the junction and the chevrons before it are wanted */
};

/* `points` 0 takes 4,096. Returns 0, -ENOMEM, -EINVAL (shader). */
int ribbon_init(struct ribbon *ribbon, struct arena *arena, struct gfx *gfx, uint32_t points);
void ribbon_finish(struct ribbon *ribbon);

void ribbon_update(
	struct ribbon *ribbon, const struct pkg *pkg, const struct nav_view *nav, const struct palette *palette);
void ribbon_draw(
	const struct ribbon *ribbon, const struct view *view, enum view_slice_id slice, const struct ribbon_look *look);
void ribbon_draw_hidden(
	const struct ribbon *ribbon, const struct view *view, enum view_slice_id slice, const struct ribbon_look *look);

#endif
