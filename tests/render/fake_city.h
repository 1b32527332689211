/*
 * A small city in memory, in the shape of an opened package: BLOCKS x BLOCKS blocks of one box each, a ground tile
 * under every block with a marking on it, painted textures and a light map. Enough to draw, cull and load.
 */
#ifndef BLVD_TESTS_RENDER_FAKE_CITY_H
#define BLVD_TESTS_RENDER_FAKE_CITY_H

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "assets/pkg.h"
#include "platform/base/rng.h"

#define FAKE_PITCH_MM 40000 /* block and street */
#define FAKE_HOUSE_MM 24000
#define FAKE_TEXTURE_PX 64

enum { FAKE_WALL, FAKE_ROOF, FAKE_ROAD, FAKE_PAINT, FAKE_MATERIALS };

struct fake_city {
	struct pkg pkg;
	struct pkg_meta meta;
	struct pkg_material materials[FAKE_MATERIALS];
	struct pkg_texture_array texture_array;
	struct pkg_light_map light_map;
	struct pkg_chunk *chunks;
	struct pkg_object *objects;
	uint8_t *geometry, *texels, *light;
	uint64_t geometry_bytes;
};

struct fake_builder {
	struct pkg_mesh_vertex *vertices;
	uint16_t *indices;
	uint32_t vertex_count, index_count;
};

static void fake_quad(struct fake_builder *b, const int32_t corner[4][3], const int8_t oct[2], int material,
	int tiles_u, int tiles_v, uint8_t seed)
{
	static const int uv[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
	uint16_t first = (uint16_t)b->vertex_count;
	for (int i = 0; i < 4; i++) {
		struct pkg_mesh_vertex *v = &b->vertices[b->vertex_count++];
		memcpy(v->pos_mm, corner[i], sizeof(v->pos_mm));
		memcpy(v->normal_oct, oct, 2);
		v->ao = 235;
		v->material = (uint8_t)material;
		v->uv[0] = (uint16_t)(uv[i][0] * tiles_u * 256);
		v->uv[1] = (uint16_t)(uv[i][1] * tiles_v * 256);
		memset(v->rgb, 235, 3);
		v->seed = seed;
	}
	const uint16_t order[6] = { 0, 1, 2, 0, 2, 3 };
	for (int i = 0; i < 6; i++)
		b->indices[b->index_count++] = (uint16_t)(first + order[i]);
}

static void fake_house(struct fake_builder *b, int32_t height_mm, uint8_t seed)
{
	const int32_t l = (FAKE_PITCH_MM - FAKE_HOUSE_MM) / 2, h = FAKE_PITCH_MM - l, t = height_mm;
	const int32_t ring[4][2] = { { l, l }, { h, l }, { h, h }, { l, h } };
	const int8_t normals[4][2] = { { 0, -127 }, { 127, 0 }, { 0, 127 }, { -127, 0 } };
	for (int i = 0; i < 4; i++) {
		const int32_t *p = ring[i], *q = ring[(i + 1) % 4];
		const int32_t wall[4][3] = { { p[0], p[1], 0 }, { q[0], q[1], 0 }, { q[0], q[1], t }, { p[0], p[1], t } };
		fake_quad(b, wall, normals[i], FAKE_WALL, FAKE_HOUSE_MM / 3000, height_mm / 3000, seed);
	}
	const int32_t roof[4][3] = { { l, l, t }, { h, l, t }, { h, h, t }, { l, h, t } };
	fake_quad(b, roof, (const int8_t[2]){ 0, 0 }, FAKE_ROOF, 6, 6, seed);
}

static void fake_ground(struct fake_builder *b)
{
	const int32_t s = FAKE_PITCH_MM, up[2] = { 0, 0 };
	const int32_t tile[4][3] = { { 0, 0, 0 }, { s, 0, 0 }, { s, s, 0 }, { 0, s, 0 } };
	(void)up;
	fake_quad(b, tile, (const int8_t[2]){ 0, 0 }, FAKE_ROAD, 10, 10, 0);
}

static void fake_marking(struct fake_builder *b)
{
	const int32_t s = FAKE_PITCH_MM;
	const int32_t line[4][3] = { { -100, 4000, 0 }, { 100, 4000, 0 }, { 100, s - 4000, 0 }, { -100, s - 4000, 0 } };
	fake_quad(b, line, (const int8_t[2]){ 0, 0 }, FAKE_PAINT, 1, 1, 0);
}

static void fake_texels(struct fake_city *city)
{
	const uint32_t px = FAKE_TEXTURE_PX;
	city->texture_array = (struct pkg_texture_array){
		.format = PKG_TEXTURE_RGBA8, .width = px, .height = px, .layers = FAKE_MATERIALS, .levels = 1
	};
	city->texels = malloc((size_t)px * px * FAKE_MATERIALS * 4);
	static const uint8_t tone[FAKE_MATERIALS][4] = { { 226, 215, 196, 0 }, { 150, 92, 74, 0 }, { 86, 87, 90, 0 },
		{ 235, 235, 230, 255 } };
	struct rng rng = rng_seed(1);
	for (uint32_t layer = 0; layer < FAKE_MATERIALS; layer++) {
		for (uint32_t i = 0; i < px * px; i++) {
			uint8_t *out = city->texels + ((size_t)layer * px * px + i) * 4;
			uint32_t x = i % px, y = i / px;
			bool glass = layer == FAKE_WALL && x > 22 && x < 42 && y > 16 && y < 52;
			for (int c = 0; c < 3; c++)
				out[c] = (uint8_t)((glass ? 60 : tone[layer][c]) + (rng_u32(&rng) & 7));
			out[3] = glass ? 255 : tone[layer][3];
		}
	}
}

static void fake_light_map(struct fake_city *city, int blocks)
{
	const uint32_t side = (uint32_t)blocks * 10;
	city->light_map = (struct pkg_light_map){ .texel_mm = FAKE_PITCH_MM / 10, .width = side, .height = side };
	city->light = malloc((size_t)side * side * 2 + 1);
	for (uint32_t i = 0; i < side * side; i++) {
		uint32_t x = i % side % 10, y = i / side % 10;
		bool street = x < 2 || x > 7 || y < 2 || y > 7;
		city->light[i * 2] = street ? 240 : 120;
		city->light[i * 2 + 1] = street && (x == 0 && y % 5 == 0) ? 220 : street ? 90 : 0;
	}
}

static void fake_chunk(struct fake_city *city, int id, int at_x, int at_y, const int32_t shift_mm[2], int32_t height_mm)
{
	struct pkg_chunk *chunk = &city->chunks[id];
	const uint32_t vertices = 7 * 4, indices = 7 * 6;
	*chunk = (struct pkg_chunk){ .kind = PKG_CHUNK_BLOCK,
		.face = PKG_NONE,
		.first_object = (uint32_t)id * 2,
		.object_count = 2,
		.vertex_count = vertices };
	chunk->origin_mm[0] = shift_mm[0] + at_x * FAKE_PITCH_MM;
	chunk->origin_mm[1] = shift_mm[1] + at_y * FAKE_PITCH_MM;
	chunk->vertex_offset = (uint64_t)id * 1024;
	chunk->index_offset = chunk->vertex_offset + 768;
	struct fake_builder b = { (void *)(city->geometry + chunk->vertex_offset),
		(void *)(city->geometry + chunk->index_offset), 0, 0 };
	fake_house(&b, height_mm, (uint8_t)(id * 37));
	uint32_t house_indices = b.index_count;
	fake_ground(&b);
	chunk->index_count[PKG_PASS_OPAQUE] = b.index_count;
	fake_marking(&b);
	chunk->index_count[PKG_PASS_DECAL] = indices - chunk->index_count[PKG_PASS_OPAQUE];
	for (int axis = 0; axis < 2; axis++) {
		chunk->min_mm[axis] = chunk->origin_mm[axis] - 100;
		chunk->max_mm[axis] = chunk->origin_mm[axis] + FAKE_PITCH_MM;
	}
	chunk->max_mm[2] = height_mm;
	uLong crc = crc32(0, (const Bytef *)b.vertices, vertices * (uInt)sizeof(struct pkg_mesh_vertex));
	chunk->crc32 = (uint32_t)crc32(crc, (const Bytef *)b.indices, indices * 2);
	struct pkg_object *house = &city->objects[id * 2], *ground = house + 1;
	*house = (struct pkg_object){ .chunk = (uint32_t)id, .kind = PKG_OBJECT_BUILDING };
	const int32_t margin = (FAKE_PITCH_MM - FAKE_HOUSE_MM) / 2;
	for (int axis = 0; axis < 2; axis++) {
		house->min_mm[axis] = chunk->origin_mm[axis] + margin;
		house->max_mm[axis] = chunk->origin_mm[axis] + FAKE_PITCH_MM - margin;
	}
	house->max_mm[2] = height_mm;
	house->index_count[PKG_PASS_OPAQUE] = house_indices;
	*ground = (struct pkg_object){ .chunk = (uint32_t)id, .kind = PKG_OBJECT_GROUND };
	memcpy(ground->min_mm, chunk->min_mm, sizeof(ground->min_mm));
	memcpy(ground->max_mm, chunk->max_mm, sizeof(ground->max_mm));
	ground->max_mm[2] = 0;
	ground->first_index[PKG_PASS_OPAQUE] = house_indices;
	ground->first_index[PKG_PASS_DECAL] = chunk->index_count[PKG_PASS_OPAQUE];
	ground->index_count[PKG_PASS_OPAQUE] = 6;
	ground->index_count[PKG_PASS_DECAL] = 6;
}

/* South-west corner at `shift_mm`. */
static void fake_city_make(struct fake_city *city, int blocks, const int32_t shift_mm[2])
{
	static const char strings[1] = "";
	uint32_t count = (uint32_t)(blocks * blocks);
	memset(city, 0, sizeof(*city));
	city->chunks = calloc(count + 1, sizeof(*city->chunks));
	city->objects = calloc((size_t)count * 2 + 1, sizeof(*city->objects));
	city->geometry_bytes = (uint64_t)count * 1024;
	city->geometry = calloc(count + 1, 1024);
	struct rng rng = rng_seed(7);
	for (int i = 0; i < blocks * blocks; i++)
		fake_chunk(city, i, i % blocks, i / blocks, shift_mm, 6000 + 3000 * (int32_t)(rng_u32(&rng) % 6));
	city->materials[FAKE_WALL] = (struct pkg_material){ PKG_MATERIAL_WALL, FAKE_WALL, 20, 0, { 0.5f, 0.46f, 0.4f } };
	city->materials[FAKE_ROOF] = (struct pkg_material){ PKG_MATERIAL_ROOF, FAKE_ROOF, 10, 0, { 0.3f, 0.13f, 0.09f } };
	city->materials[FAKE_ROAD] = (struct pkg_material){ PKG_MATERIAL_GROUND, FAKE_ROAD, 10, 0, { 0.1f, 0.1f, 0.1f } };
	city->materials[FAKE_PAINT] = (struct pkg_material){ PKG_MATERIAL_MARKING, FAKE_PAINT, 0, 0, { 0.8f, 0.8f, 0.8f } };
	fake_texels(city);
	fake_light_map(city, blocks);
	memcpy(city->light_map.origin_mm, shift_mm, sizeof(city->light_map.origin_mm));
	city->meta = (struct pkg_meta){ .origin_lat_deg = 46.2, .origin_lon_deg = 6.15 };
	for (int axis = 0; axis < 2; axis++) {
		city->meta.min_mm[axis] = shift_mm[axis];
		city->meta.max_mm[axis] = shift_mm[axis] + blocks * FAKE_PITCH_MM;
	}
	city->pkg = (struct pkg){ .meta = &city->meta,
		.strings = strings,
		.strings_bytes = 1,
		.materials = city->materials,
		.material_count = FAKE_MATERIALS,
		.textures = &city->texture_array,
		.texture_bytes = city->texels,
		.light_map = &city->light_map,
		.light_map_bytes = city->light,
		.chunks = city->chunks,
		.chunk_count = count,
		.objects = city->objects,
		.object_count = count * 2,
		.geometry = city->geometry,
		.geometry_bytes = city->geometry_bytes };
}

static void fake_city_free(struct fake_city *city)
{
	free(city->chunks);
	free(city->objects);
	free(city->geometry);
	free(city->texels);
	free(city->light);
}

#endif
