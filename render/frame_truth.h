/*
 * A frame for measuring: of the same draws as the picture, but what is seen in each pixel and where it is. Its cost is
 * a draw per object. Made only when asked for.
 */
#ifndef BLVD_RENDER_FRAME_TRUTH_H
#define BLVD_RENDER_FRAME_TRUTH_H

#include "render/draw_list.h"
#include "render/gfx.h"
#include "render/near_mesh.h"
#include "render/view.h"

#define TRUTH_PIXEL_WORDS 4
#define TRUTH_UNKNOWN UINT32_MAX /* number of triangles that belong to no object */

struct frame_truth {
	struct gfx *gfx;
	gfx_target target; /* GFX_IDS_RGBA32UI: object + 1, then the position from the eye in m as float bits */
	gfx_program program;
	gfx_pipeline pipelines[PKG_PASS_COUNT];
};

/* Returns 0, -ENOMEM or -EINVAL. */
int frame_truth_init(struct frame_truth *truth, struct gfx *gfx, uint32_t width, uint32_t height);
void frame_truth_finish(struct frame_truth *truth);

/* Between these, everything that the picture shows is drawn, in the picture's order. */
void frame_truth_begin(const struct frame_truth *truth);
void frame_truth_draw_list(const struct frame_truth *truth, const struct near_mesh *mesh, const struct view *view,
	const struct draw_list *list);
void frame_truth_end(const struct frame_truth *truth);

/* Rows from the top, TRUTH_PIXEL_WORDS a pixel; all 0 where nothing is. */
void frame_truth_read(const struct frame_truth *truth, uint32_t *out);

#endif
