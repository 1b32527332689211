/* Draws impostors of cells: textured triangles at their true depths, lit like the city. */
#ifndef BLVD_RENDER_IMPOSTOR_DRAW_H
#define BLVD_RENDER_IMPOSTOR_DRAW_H

#include "render/cell_store.h"
#include "render/near_mesh.h"
#include "render/view.h"

/* Bits. */
enum impostor_style { IMPOSTOR_LIT = 1 << 0, IMPOSTOR_DISSOLVING = 1 << 1, IMPOSTOR_STYLES = 4 };

struct impostor_draw {
	struct gfx *gfx;
	gfx_program programs[IMPOSTOR_STYLES];
	gfx_pipeline pipelines[IMPOSTOR_STYLES];
	gfx_program wire_program;
	gfx_pipeline wire; /* the triangles' edges; none unless asked for */
};

/* `tinted`: the distance is easy to tell from the rest. `wire`: with its triangles' edges, for which the store must
 * keep lines. Returns 0, -ENOMEM or -EINVAL. */
int impostor_draw_init(struct impostor_draw *draw, struct gfx *gfx, bool tinted, bool wire);
void impostor_draw_finish(struct impostor_draw *draw);

/* What is drawn of one cell. */
struct impostor_shown {
	const struct stored_impostor *impostor;
	const int32_t *origin_mm; /* of its positions */
	float share;              /* of its pixels; below 1 it dissolves, and lies in front of what is whole */
	bool near_slice;          /* may reach into the near slice */
};

/* Depth slices as in `view`; leaves the depth range at one of them. */
void impostor_draw(const struct impostor_draw *draw, const struct cell_store *store, const struct near_mesh *mesh,
	const struct view *view, const struct impostor_shown *shown, gfx_buffer frame_block);

#endif
