/* The light map in tiles: what has been loaded after all, and which tiles a place needs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "platform/base/rng.h"
#include "render/gfx_backend.h"
#include "render/light_tiles.h"

#define WIDTH 701u
#define HEIGHT 530u
#define BLOCK_COLUMNS ((WIDTH + 3) / 4)
#define BLOCK_ROWS ((HEIGHT + 3) / 4)

static uint8_t texels[WIDTH * HEIGHT * 2], on_gpu[WIDTH * HEIGHT * 2];
static uint8_t memory[1 << 16];
static struct pkg_light_map map;
static struct pkg pkg;

/* Keeps what is written where a GPU would. */
static void keep(struct gfx *gfx, struct gfx_texture_slot *slot, const struct gfx_region *region, const void *from)
{
	(void)gfx;
	bool blocks = slot->desc.format == GFX_EAC_RG11;
	uint32_t unit = blocks ? 4 : 1, bytes = blocks ? 16 : 2;
	assert_int_equal(region->x % unit, 0);
	assert_int_equal(region->y % unit, 0);
	assert_true(region->x + region->width <= WIDTH && region->y + region->height <= HEIGHT);
	size_t run = (size_t)(region->width + unit - 1) / unit * bytes, rows = (region->height + unit - 1) / unit;
	size_t stride = region->row_texels ? (size_t)region->row_texels * bytes : run;
	size_t pitch = (size_t)(blocks ? BLOCK_COLUMNS : WIDTH) * bytes;
	assert_true(!blocks || !region->row_texels);
	for (size_t row = 0; row < rows; row++)
		memcpy(on_gpu + (region->y / unit + row) * pitch + region->x / unit * bytes,
			(const uint8_t *)from + row * stride, run);
}

static struct gfx *start(enum pkg_light_format format, struct light_tiles *tiles, gfx_texture *texture)
{
	static struct gfx_ops ops;
	struct arena arena;
	struct gfx *gfx;
	struct rng rng = rng_seed(4);
	for (size_t i = 0; i < sizeof(texels); i++)
		texels[i] = (uint8_t)rng_u32(&rng);
	memset(on_gpu, 0, sizeof(on_gpu));
	map = (struct pkg_light_map){
		.origin_mm = { -3000, 5000 }, .texel_mm = 2000, .width = WIDTH, .height = HEIGHT, .format = format
	};
	pkg = (struct pkg){ .light_map = &map, .light_map_bytes = texels };
	ops = gfx_dummy;
	ops.texture_write = keep;
	arena_init(&arena, "gfx", memory, sizeof(memory));
	assert_int_equal(gfx_init(&gfx, &arena, &ops, &(struct gfx_config){ 0 }), 0);
	assert_int_equal(light_tiles_make(gfx, &pkg, tiles, texture), 0);
	return gfx;
}

static void all_tiles_make_the_map(void **state)
{
	(void)state;
	static const size_t bytes[] = {
		[PKG_LIGHT_RG8] = sizeof(texels), [PKG_LIGHT_EAC_RG11] = (size_t)BLOCK_COLUMNS * BLOCK_ROWS * 16
	};
	for (int format = PKG_LIGHT_RG8; format <= PKG_LIGHT_EAC_RG11; format++) {
		struct light_tiles tiles;
		gfx_texture texture;
		struct gfx *gfx = start((enum pkg_light_format)format, &tiles, &texture);
		int loaded = 0;
		assert_int_equal(gfx_stats(gfx)->bytes, bytes[format]);
		while (light_tiles_load_next(gfx, &pkg, texture, &tiles))
			loaded++;
		assert_int_equal(loaded, 3 * 3);
		assert_memory_equal(on_gpu, texels, bytes[format]);
		gfx_finish(gfx);
	}
}

static uint32_t tiles_there(const struct light_tiles *tiles)
{
	uint32_t bits = 0;
	for (uint32_t tile = 0; tile < tiles->columns * tiles->rows; tile++)
		bits |= (tiles->there[tile / 32] >> tile % 32 & 1) << tile;
	return bits;
}

static void a_place_loads_the_tiles_that_light_it(void **state)
{
	(void)state;
	/* metres from the map's corner; tiles of 512 m */
	static const struct {
		int32_t min_m[2], max_m[2];
		uint32_t tiles;
	} places[] = {
		{ { 100, 100 }, { 400, 400 }, 1u << 0 },
		{ { 100, 100 }, { 508, 400 }, 1u << 0 | 1u << 1 }, /* 3 m beside and a texel */
		{ { 100, 100 }, { 506, 400 }, 1u << 0 },
		{ { 518, 518 }, { 1400, 1000 }, 1u << 4 | 1u << 5 },
		{ { 518, 518 }, { 1010, 1010 }, 1u << 4 },
		{ { 518, 516 }, { 1010, 1021 }, 1u << 1 | 1u << 4 | 1u << 7 },
		{ { -9000, -9000 }, { -8000, -8000 }, 1u << 0 }, /* clamped like the sampler */
		{ { 9000, 600 }, { 9100, 700 }, 1u << 5 },
	};
	for (size_t k = 0; k < sizeof(places) / sizeof(places[0]); k++) {
		struct light_tiles tiles;
		gfx_texture texture;
		struct gfx *gfx = start(PKG_LIGHT_EAC_RG11, &tiles, &texture);
		int32_t min_mm[2], max_mm[2];
		for (int axis = 0; axis < 2; axis++) {
			min_mm[axis] = map.origin_mm[axis] + places[k].min_m[axis] * 1000;
			max_mm[axis] = map.origin_mm[axis] + places[k].max_m[axis] * 1000;
		}
		light_tiles_load_box(gfx, &pkg, texture, &tiles, min_mm, max_mm);
		assert_int_equal(tiles_there(&tiles), places[k].tiles);
		gfx_finish(gfx);
	}
}

static void a_tile_knows_its_bounds(void **state)
{
	(void)state;
	struct light_tiles tiles;
	gfx_texture texture;
	struct gfx *gfx = start(PKG_LIGHT_RG8, &tiles, &texture);
	int32_t min_mm[2], max_mm[2];
	light_tiles_bounds(&tiles, &pkg, 5, min_mm, max_mm);
	assert_int_equal(min_mm[0], -3000 + 512 * 2000);
	assert_int_equal(max_mm[0], -3000 + (int)WIDTH * 2000);
	assert_int_equal(min_mm[1], 5000 + 256 * 2000);
	assert_int_equal(max_mm[1], 5000 + 512 * 2000);
	gfx_finish(gfx);
}

static void without_a_light_map_there_is_nothing_to_load(void **state)
{
	(void)state;
	struct light_tiles tiles;
	gfx_texture texture;
	gfx_finish(start(PKG_LIGHT_RG8, &tiles, &texture));
	struct arena arena;
	struct gfx *gfx;
	arena_init(&arena, "gfx", memory, sizeof(memory));
	assert_int_equal(gfx_init(&gfx, &arena, &gfx_dummy, &(struct gfx_config){ 0 }), 0);
	pkg = (struct pkg){ 0 };
	assert_int_equal(light_tiles_make(gfx, &pkg, &tiles, &texture), 0);
	assert_int_equal(gfx_stats(gfx)->bytes, 2);
	light_tiles_load_box(gfx, &pkg, texture, &tiles, (const int32_t[2]){ 0, 0 }, (const int32_t[2]){ 1, 1 });
	assert_false(light_tiles_load_next(gfx, &pkg, texture, &tiles));
	gfx_finish(gfx);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_tiles_make_the_map),
		cmocka_unit_test(a_place_loads_the_tiles_that_light_it),
		cmocka_unit_test(a_tile_knows_its_bounds),
		cmocka_unit_test(without_a_light_map_there_is_nothing_to_load),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
