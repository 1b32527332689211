/* What the city's surfaces are made of, on the GPU: materials, textures and the light map of a package. */
#ifndef BLVD_RENDER_SURFACES_H
#define BLVD_RENDER_SURFACES_H

#include "assets/pkg.h"
#include "render/gfx.h"

/* Where the package lacks one, something plain stands in. Returns 0 or -ENOMEM; what was made until then is the
 * caller's to destroy, as is all of it after success. */
int surfaces_make(
	struct gfx *gfx, const struct pkg *pkg, gfx_buffer *materials, gfx_texture *textures, gfx_texture *light_map);

/* u_draw[5] of city.vert: the light map's coordinate of the eye, and coordinates per metre. `out` is zeroed to start
 * with and stays so without a map, where everything samples the one texel there is. */
void surfaces_light_map_frame(const struct pkg *pkg, const int64_t eye_mm[3], float out[4]);

#endif
