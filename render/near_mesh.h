/*
 * The city's own triangles on the GPU: one vertex and one index pool, reserved at start, filled by assets/residency.
 */
#ifndef BLVD_RENDER_NEAR_MESH_H
#define BLVD_RENDER_NEAR_MESH_H

#include <stdint.h>

#include "assets/residency.h"
#include "assets/resident.h"
#include "render/draw_list.h"
#include "render/fade.h"
#include "render/gfx.h"
#include "render/light_tiles.h"
#include "render/surfaces.h"
#include "render/view.h"

/* What a run of triangles contains decides how it is shaded: the variants of city.vert and city.frag. */
enum city_look {
	LOOK_PLAIN,  /* roofs, foliage, solids */
	LOOK_WALLS,  /* and walls and shops */
	LOOK_GROUND, /* and ground, markings, lamps */
	LOOK_WATER,  /* and water */
	LOOK_ALL,
	LOOK_COUNT,
};

/* Each look comes with and without fading, and with and without the lights of the evening: what is not there by day
 * costs nothing by day. Bits. */
enum mesh_style { MESH_FADED = 1 << 0, MESH_LIT = 1 << 1, MESH_STYLES = 4 };

/* A run of objects of one chunk that are drawn alike. */
struct mesh_run {
	uint32_t first, count; /* indices, from the chunk's first */
	uint8_t look;          /* enum city_look */
	uint8_t pass;          /* enum pkg_pass */
};

struct near_mesh {
	struct gfx *gfx;
	const struct pkg *pkg;
	struct residency residency;
	double close_m; /* loaded on all sides of the eye, seen or not */
	gfx_buffer vertices, indices;
	gfx_buffer materials;
	gfx_texture textures, light_map;
	struct surface_layers layers;
	struct light_tiles light;
	uint8_t *textured;      /* of a chunk: the layers and the light that it needs are there */
	bool light_far;         /* more than chunks is lit by the light map, wherever the view sees: stays so */
	bool textures_complete; /* all layers and all light are there */
	gfx_program programs[LOOK_COUNT][MESH_STYLES];                   /* [look][enum mesh_style] */
	gfx_pipeline pipelines[LOOK_COUNT][PKG_PASS_COUNT][MESH_STYLES]; /* [look][pass][enum mesh_style] */
	bool lit;                                                        /* lamps or windows shine: the frame sets it */
	struct mesh_run *runs;                                           /* those of chunk i from first_run[i] on */
	uint32_t *first_run, *run_count;
};

/* Makes all GL objects. The pools take the whole city if that fits into what is left of `budget_bytes`; otherwise what
 * `need` says (NULL: as much as there is room for), or what is left. Returns 0, -ENOMEM or -EINVAL. */
int near_mesh_init(struct near_mesh *mesh, struct arena *arena, struct gfx *gfx, const struct pkg *pkg,
	uint64_t budget_bytes, const struct resident_need *need);
/* What it takes from the arena, but for padding. */
uint64_t near_mesh_arena_bytes(const struct pkg *pkg);
void near_mesh_finish(struct near_mesh *mesh);

/* Loads what is within `far_m` of the eye, nearest first, as far as the slice goes; when the whole city has room, what
 * nobody has seen yet, wherever it is. */
void near_mesh_load(struct near_mesh *mesh, const int64_t eye_mm[3], double far_m, uint64_t slice_bytes);
/* Whoever draws vertices of his own with these textures and this light says so before. */
void near_mesh_need(struct near_mesh *mesh, const struct pkg_mesh_vertex *vertices, uint32_t count);
/* After the first picture, once a frame: a piece of the textures that nothing has needed yet. */
void near_mesh_load_textures(struct near_mesh *mesh);
/* When the whole city has room: loads at once what the view sees up to `far_m`, and what is close on all sides. In any
 * case the textures and the light of what it sees. */
void near_mesh_load_seen(struct near_mesh *mesh, const struct view *view, double far_m);

/* A resident chunk, all passes, in one slice; what fades is cut out of its runs and drawn apart. `fade` may be NULL.
 * With a view, longer stretches of objects outside it or its slice are left out; NULL draws the chunk whole. */
void near_mesh_emit(const struct near_mesh *mesh, const struct fade *fade, struct draw_list *list,
	const struct view *view, uint32_t chunk, enum view_slice_id slice, float depth_m);

/* enum city_look of triangles whose materials are of these kinds: bits 1 << enum pkg_material_kind. */
uint8_t near_mesh_look_of(uint32_t kinds);

/* Is the chunk's geometry on the GPU? */
bool near_mesh_has(const struct near_mesh *mesh, uint32_t chunk);

#endif
