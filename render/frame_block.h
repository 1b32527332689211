/* The uniform block `Frame` of assets/shaders/prelude.glsl, byte for byte (std140). */
#ifndef BLVD_RENDER_FRAME_BLOCK_H
#define BLVD_RENDER_FRAME_BLOCK_H

#include <assert.h>
#include <stddef.h>

struct frame_block {
	float sun_direction[4];
	float sun_color[4];
	float sky_color[4];
	float ground_color[4];
	float haze[4];
	float zenith[4];
	float eye[4];
	float screen[4];
};
static_assert(offsetof(struct frame_block, haze) == 64, "std140");
static_assert(sizeof(struct frame_block) == 128, "std140");

/* The uniform block `Materials` of city.vert. */
struct materials_block {
	float row[256][4]; /* enum pkg_material_kind, texture layer, gloss 0 to 1, 0 */
};
static_assert(sizeof(struct materials_block) == 4096, "std140");

#endif
