/*
 * What is seen of the far set from all over a view cell: pictures of near and far together, from poses every few
 * metres, that say which pixel shows which triangle. They decide what an impostor must show, and how large its captures
 * have to be.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_CELL_LOOKS_H
#define BLVD_TOOLS_IMPOSTOR_CELL_LOOKS_H

#include "tools/impostor/capture.h"
#include "tools/impostor/cell_views.h"
#include "tools/impostor/view_cell.h"

struct cell_looks {
	ARRAY(struct capture_image) images; /* cropped to what shows the far set; the first `count` are in use */
	size_t count;
	corner_array corners;    /* scratch */
	ARRAY(uint32_t) item_of; /* by object: item of the far set + 1, or 0 */
	struct capture_image scratch;
};
void cell_looks_finish(struct cell_looks *looks);

/* Draws the looks. `occluders` is what hides things beside the far set itself. `far_m`: nothing is farther. Returns 0
 * or what capturer_draw() says. */
int cell_looks_draw(struct cell_looks *looks, struct capturer *capturer, const struct pkg *pkg,
	const struct view_cell *cell, const struct triangle_set *far_set, const struct triangle_set *occluders,
	double focal_px, double far_m);

/* Between a call with `mark` and one without, cell_looks_item() tells which item of `set` a pixel shows, plus 1; 0: it
 * shows something else. */
void cell_looks_mark(struct cell_looks *looks, const struct pkg *pkg, const struct triangle_set *set, bool mark);
uint32_t cell_looks_item(
	const struct cell_looks *looks, const struct triangle_set *set, const struct capture_pixel *pixel);

/* The objects of `set` of which some look sees something, with all their triangles of `set`. */
void cell_looks_seen(
	struct cell_looks *looks, const struct pkg *pkg, const struct triangle_set *set, struct triangle_set *out);

#endif
