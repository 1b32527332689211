/* Draws of a cell's set of triangles: what is in view, object by object, in the slices that it reaches into. */
#ifndef BLVD_RENDER_CELL_EMIT_H
#define BLVD_RENDER_CELL_EMIT_H

#include "render/draw_list.h"
#include "render/near_mesh.h"

struct cell_emitted {
	uint32_t triangles; /* counted once, however many slices they are drawn in */
	uint32_t missing;   /* chunks in view that are not resident; always 0 for sets with vertices of their own */
};

/* What fades is drawn apart; `fade` may be NULL. `set` is borrowed until the list has been drawn. */
struct cell_emitted cell_emit(const struct draw_set *set, const struct near_mesh *mesh, const struct fade *fade,
	const struct view *view, struct draw_list *list);

#endif
