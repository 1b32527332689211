/* What the city's surfaces are made of, on the GPU: materials and textures of a package. */
#ifndef BLVD_RENDER_SURFACES_H
#define BLVD_RENDER_SURFACES_H

#include "assets/pkg.h"
#include "render/gfx.h"

/* Where the package lacks one, something plain stands in. The textures hold
 * nothing yet: a software GPU takes a tenth of a second for all layers of a city, and a street has a few. Returns 0 or
 * -ENOMEM; what was made until then is the caller's to destroy, as is all of it after success. */
int surfaces_make(struct gfx *gfx, const struct pkg *pkg, gfx_buffer *materials, gfx_texture *textures);

#define SURFACE_LAYERS_MAX 2048
/* Which layers of the textures hold their texels already. Zeroed: none. */
struct surface_layers {
	uint32_t there[SURFACE_LAYERS_MAX / 32];
	uint32_t next; /* all before it are there */
};
/* Copies the layers of the materials in `wanted` (a bit each) that are not there yet. */
void surfaces_load(struct gfx *gfx, const struct pkg *pkg, gfx_texture textures, struct surface_layers *layers,
	const uint32_t wanted[256 / 32]);
/* Copies the next layer that nobody has wanted yet, a few hundred KiB; false when all are there. */
bool surfaces_load_next(struct gfx *gfx, const struct pkg *pkg, gfx_texture textures, struct surface_layers *layers);

/* u_draw[5] of city.vert: the light map's coordinate of the eye, and coordinates per metre. `out` is zeroed to start
 * with and stays so without a map, where everything samples the one texel there is. */
void surfaces_light_map_frame(const struct pkg *pkg, const int64_t eye_mm[3], float out[4]);

#endif
