/*
 * The light map of a package on the GPU, loaded in tiles: a software GPU decodes the blocks of a whole city in as long
 * as it draws a frame, and a street needs a few of them.
 */
#ifndef BLVD_RENDER_LIGHT_TILES_H
#define BLVD_RENDER_LIGHT_TILES_H

#include <stdbool.h>

#include "assets/pkg.h"
#include "render/gfx.h"

#define LIGHT_TILE_PX 256
#define LIGHT_TILES_A_SIDE (PKG_LIGHT_SIDE_MAX / LIGHT_TILE_PX)

/* Which tiles hold their texels already: a bit each. */
struct light_tiles {
	uint32_t columns, rows; /* none where the package has no light map that fits the GPU */
	uint32_t there[LIGHT_TILES_A_SIDE * LIGHT_TILES_A_SIDE / 32];
	uint32_t next; /* all before it are there */
};

/* Makes the texture, which holds nothing yet; without a light map, one texel of open sky. Returns 0 or -ENOMEM. */
int light_tiles_make(struct gfx *gfx, const struct pkg *pkg, struct light_tiles *tiles, gfx_texture *out);

/* Bounds of a tile, city frame. */
void light_tiles_bounds(
	const struct light_tiles *tiles, const struct pkg *pkg, uint32_t tile, int32_t min_mm[2], int32_t max_mm[2]);

/* Copies a tile that is not there yet; tiles count row by row from the south-west. */
void light_tiles_load(
	struct gfx *gfx, const struct pkg *pkg, gfx_texture texture, struct light_tiles *tiles, uint32_t tile);
/* Those that surfaces within a box of the city frame are lit by. */
void light_tiles_load_box(struct gfx *gfx, const struct pkg *pkg, gfx_texture texture, struct light_tiles *tiles,
	const int32_t min_mm[2], const int32_t max_mm[2]);
/* Copies the next tile that nobody has wanted yet; false when all are there. */
bool light_tiles_load_next(struct gfx *gfx, const struct pkg *pkg, gfx_texture texture, struct light_tiles *tiles);

#endif
