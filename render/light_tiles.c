/* Uploads of the light map. A tile is about 0.3 ms where the CPU decodes its blocks. */
#include "render/light_tiles.h"

#include <math.h>
#include <string.h>

#include "platform/base/log.h"

#define BLOCK_BYTES 16
#define STRIP_PX 64       /* rows of a tile that are copied at a time */
#define BESIDE_MM 3000    /* walls are lit by the pavement in front of them: city.vert */
#define FILTER_TEXELS 1.0 /* the neighbours that a filtered sample reads */

static const uint8_t open_sky[2] = { 255, 0 };

static enum gfx_format format_of(const struct pkg_light_map *map)
{
	return map->format == PKG_LIGHT_EAC_RG11 ? GFX_EAC_RG11 : GFX_RG8;
}

static int make_open_sky(struct gfx *gfx, gfx_texture *out)
{
	struct gfx_texture_desc desc = { .format = GFX_RG8, .width = 1, .height = 1, .filter = GFX_NEAREST };
	struct gfx_region region = { .width = 1, .height = 1, .layers = 1 };
	int err = gfx_texture_create(gfx, &desc, out);
	if (!err)
		gfx_texture_write(gfx, *out, &region, open_sky);
	return err;
}

int light_tiles_make(struct gfx *gfx, const struct pkg *pkg, struct light_tiles *tiles, gfx_texture *out)
{
	const struct pkg_light_map *map = pkg->light_map;
	uint32_t limit = gfx_caps(gfx)->max_texture_px;
	*tiles = (struct light_tiles){ 0 };
	if (map && (map->width > limit || map->height > limit)) {
		log_warn("light map of %u x %u is larger than this GPU's %u: left out", map->width, map->height, limit);
		map = NULL;
	}
	if (!map)
		return make_open_sky(gfx, out);
	struct gfx_texture_desc desc = {
		.format = format_of(map), .width = map->width, .height = map->height, .filter = GFX_LINEAR
	};
	int err = gfx_texture_create(gfx, &desc, out);
	if (err)
		return err;
	tiles->columns = (map->width + LIGHT_TILE_PX - 1) / LIGHT_TILE_PX;
	tiles->rows = (map->height + LIGHT_TILE_PX - 1) / LIGHT_TILE_PX;
	return 0;
}

static struct gfx_region region_of(const struct light_tiles *tiles, const struct pkg_light_map *map, uint32_t tile)
{
	struct gfx_region region = {
		.x = tile % tiles->columns * LIGHT_TILE_PX, .y = tile / tiles->columns * LIGHT_TILE_PX, .layers = 1
	};
	region.width = map->width - region.x < LIGHT_TILE_PX ? map->width - region.x : LIGHT_TILE_PX;
	region.height = map->height - region.y < LIGHT_TILE_PX ? map->height - region.y : LIGHT_TILE_PX;
	return region;
}

void light_tiles_bounds(
	const struct light_tiles *tiles, const struct pkg *pkg, uint32_t tile, int32_t min_mm[2], int32_t max_mm[2])
{
	const struct pkg_light_map *map = pkg->light_map;
	struct gfx_region region = region_of(tiles, map, tile);
	const uint32_t from[2] = { region.x, region.y }, size[2] = { region.width, region.height };
	for (int axis = 0; axis < 2; axis++) {
		double at = map->origin_mm[axis] + (double)from[axis] * map->texel_mm;
		min_mm[axis] = (int32_t)fmin(fmax(at, INT32_MIN), INT32_MAX);
		max_mm[axis] = (int32_t)fmin(fmax(at + (double)size[axis] * map->texel_mm, INT32_MIN), INT32_MAX);
	}
}

/* GLES takes blocks only tightly packed. */
static void write_blocks(
	struct gfx *gfx, const struct pkg *pkg, gfx_texture texture, const struct gfx_region *tile, uint32_t row_blocks)
{
	uint8_t strip[STRIP_PX / 4 * (LIGHT_TILE_PX / 4) * BLOCK_BYTES];
	const size_t stride = (size_t)row_blocks * BLOCK_BYTES, run = (size_t)((tile->width + 3) / 4) * BLOCK_BYTES;
	for (uint32_t row = 0; row < tile->height; row += STRIP_PX) {
		struct gfx_region region = *tile;
		region.y = tile->y + row;
		region.height = tile->height - row < STRIP_PX ? tile->height - row : STRIP_PX;
		const uint8_t *from = pkg->light_map_bytes + region.y / 4 * stride + (size_t)(tile->x / 4) * BLOCK_BYTES;
		for (uint32_t i = 0; i < (region.height + 3) / 4; i++)
			memcpy(strip + i * run, from + i * stride, run);
		gfx_texture_write(gfx, texture, &region, strip);
	}
}

void light_tiles_load(
	struct gfx *gfx, const struct pkg *pkg, gfx_texture texture, struct light_tiles *tiles, uint32_t tile)
{
	const struct pkg_light_map *map = pkg->light_map;
	uint32_t *word = &tiles->there[tile / 32], bit = 1u << tile % 32;
	if (*word & bit)
		return;
	*word |= bit;
	struct gfx_region region = region_of(tiles, map, tile);
	if (map->format == PKG_LIGHT_EAC_RG11) {
		write_blocks(gfx, pkg, texture, &region, (map->width + 3) / 4);
		return;
	}
	region.row_texels = map->width;
	gfx_texture_write(gfx, texture, &region, pkg->light_map_bytes + ((size_t)region.y * map->width + region.x) * 2);
}

/* The tile's column or row that a place on the map lies in, or the nearest. */
static uint32_t tile_at(double texel, uint32_t count)
{
	return (uint32_t)fmin(fmax(floor(texel / LIGHT_TILE_PX), 0.0), count - 1.0);
}

void light_tiles_load_box(struct gfx *gfx, const struct pkg *pkg, gfx_texture texture, struct light_tiles *tiles,
	const int32_t min_mm[2], const int32_t max_mm[2])
{
	const struct pkg_light_map *map = pkg->light_map;
	uint32_t first[2], last[2];
	if (!tiles->columns)
		return;
	for (int axis = 0; axis < 2; axis++) {
		double low_mm = (double)min_mm[axis] - map->origin_mm[axis] - BESIDE_MM;
		double high_mm = (double)max_mm[axis] - map->origin_mm[axis] + BESIDE_MM;
		uint32_t count = axis ? tiles->rows : tiles->columns;
		first[axis] = tile_at(low_mm / map->texel_mm - FILTER_TEXELS, count);
		last[axis] = tile_at(high_mm / map->texel_mm + FILTER_TEXELS, count);
	}
	for (uint32_t y = first[1]; y <= last[1]; y++)
		for (uint32_t x = first[0]; x <= last[0]; x++)
			light_tiles_load(gfx, pkg, texture, tiles, y * tiles->columns + x);
}

bool light_tiles_load_next(struct gfx *gfx, const struct pkg *pkg, gfx_texture texture, struct light_tiles *tiles)
{
	uint32_t count = tiles->columns * tiles->rows;
	while (tiles->next < count && tiles->there[tiles->next / 32] >> tiles->next % 32 & 1)
		tiles->next++;
	if (tiles->next < count)
		light_tiles_load(gfx, pkg, texture, tiles, tiles->next);
	return tiles->next < count;
}
