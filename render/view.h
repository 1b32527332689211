/*
 * One frame's camera, as everything that draws sees it. World points reach the GPU relative to the eye: subtract
 * `eye_mm` in int64, turn into float metres, then multiply by a slice's matrix. x east, y north, z up.
 *
 * Depth is cut into slices by distance along the view direction; each has its own matrix and its own part of the depth
 * buffer, the near one in front. They overlap a little, so what straddles is drawn in both and cannot crack. Whatever
 * is drawn in the world (and may be at any distance) is drawn once for each slice.
 */
#ifndef BLVD_RENDER_VIEW_H
#define BLVD_RENDER_VIEW_H

#include <stdint.h>

#include "platform/base/vec.h"

enum view_slice_id { VIEW_NEAR, VIEW_FAR, VIEW_SLICE_COUNT };
struct view_slice {
	float near_m, far_m;         /* along the view direction */
	float depth_near, depth_far; /* for gfx_depth_range() */
	struct mat4 clip_from_eye;   /* eye-relative metres (world axes) to clip space */
};

struct view {
	int64_t eye_mm[3];
	struct vec3 right, up, forward; /* unit, world axes */
	float tan_half_x, tan_half_y;   /* of the field of view */
	float focal_px;                 /* screen pixels of 1 m at 1 m */
	uint32_t width, height;
	struct view_slice slice[VIEW_SLICE_COUNT];
};

/* Eye-relative metres of a world point. */
static inline struct vec3 view_relative(const struct view *view, const int64_t at_mm[3])
{
	return (struct vec3){
		(float)((double)(at_mm[0] - view->eye_mm[0]) * 1e-3),
		(float)((double)(at_mm[1] - view->eye_mm[1]) * 1e-3),
		(float)((double)(at_mm[2] - view->eye_mm[2]) * 1e-3),
	};
}

#endif
