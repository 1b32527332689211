/*
 * Impostors for measuring: for each pixel what its texel shows and where that really is, from the package's truth
 * texels. Reads them while drawing; made only when asked for.
 */
#ifndef BLVD_RENDER_IMPOSTOR_TRUTH_H
#define BLVD_RENDER_IMPOSTOR_TRUTH_H

#include "assets/cells.h"
#include "render/impostor_draw.h"

struct impostor_truth {
	struct gfx *gfx;
	const struct pkg *pkg;
	struct blob_reader *reader;
	struct pkg_truth_texel *texels; /* of the cell with the most pages */
	uint64_t texel_bytes;
	gfx_texture pages; /* for one cell at a time */
	gfx_program program;
	gfx_pipeline pipeline;
	uint32_t cell; /* whose texels are in `pages`, PKG_NONE none */
};

/* Returns 0, -ENOMEM or -EINVAL. Packages without truth texels draw nothing. */
int impostor_truth_init(struct impostor_truth *truth, struct arena *arena, struct gfx *gfx, const struct pkg *pkg);
void impostor_truth_finish(struct impostor_truth *truth);

/* Into the pass of a frame_truth. `cell` is the one that `shown` is of. */
void impostor_truth_draw(struct impostor_truth *truth, const struct cell_store *store, const struct view *view,
	const struct impostor_shown *shown, uint32_t cell);

#endif
