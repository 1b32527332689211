/* Wall and roof textures: every layer painted, glass only where windows are, seams that close. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tools/bake/materials.h"

#define PX MATERIAL_TEXTURE_PX
#define LAYER_BYTES ((size_t)PX * PX * 4)

static struct material_layer layers[MATERIAL_LIMIT];
static uint8_t *memory;

static int paint(void **state)
{
	(void)state;
	memory = calloc(MATERIAL_LIMIT, LAYER_BYTES);
	for (int i = 0; memory && i < MATERIAL_LIMIT; i++)
		layers[i] = (struct material_layer){ .px = (uint8_t(*)[4])(memory + (size_t)i * LAYER_BYTES),
			.kind = PKG_MATERIAL_KIND_COUNT };
	return memory && paint_roofs(layers) == MATERIAL_ROOF_GRASS + 1 && paint_walls(layers) == MATERIAL_WALL_END ? 0
																												: -1;
}

static int finish(void **state)
{
	(void)state;
	free(memory);
	return 0;
}

static double glass_share(int material, int from_row, int to_row)
{
	double sum = 0.0;
	for (int i = from_row * PX; i < to_row * PX; i++)
		sum += layers[material].px[i][3];
	return sum / (255.0 * PX * (to_row - from_row));
}

static void every_layer_is_painted(void **state)
{
	(void)state;
	for (int m = MATERIAL_ROOF_TILES; m < MATERIAL_WALL_END; m++) {
		assert_true(layers[m].kind < PKG_MATERIAL_KIND_COUNT);
		bool roof = m <= MATERIAL_ROOF_GRASS, shop = m >= MATERIAL_SHOP_CLASSIC && m <= MATERIAL_SHOP_STONE;
		assert_int_equal(layers[m].kind, roof ? PKG_MATERIAL_ROOF : shop ? PKG_MATERIAL_SHOP : PKG_MATERIAL_WALL);
		for (int i = 0; i < PX * PX; i++)
			assert_true(layers[m].px[i][0] + layers[m].px[i][1] + layers[m].px[i][2] > 60);
	}
}

static void windows_have_glass_and_blank_walls_none(void **state)
{
	(void)state;
	for (int m = MATERIAL_WALL_FIRST; m < MATERIAL_BLANK_PLASTER; m++)
		if (m != MATERIAL_WALL_BELFRY)
			assert_true(glass_share(m, 0, PX) > 0.04);
	for (int m = MATERIAL_BLANK_PLASTER; m <= MATERIAL_BLANK_METAL; m++)
		assert_true(glass_share(m, 0, PX) < 1e-6);
	for (int m = MATERIAL_ROOF_TILES; m <= MATERIAL_ROOF_GRASS; m++)
		assert_true(glass_share(m, 0, PX) < 1e-6);
}

/* What lies below a door's level shows the top of the tile: nothing may open there. */
static void ground_floors_are_plain_on_top(void **state)
{
	(void)state;
	for (int m = MATERIAL_GROUND_PLASTER; m <= MATERIAL_SHOP_STONE; m++)
		assert_true(glass_share(m, PX * 84 / 100, PX) < 1e-6);
}

static void bays_join_without_a_seam(void **state)
{
	(void)state;
	for (int m = MATERIAL_WALL_FIRST; m < MATERIAL_SHOP_CLASSIC; m++) {
		double step = 0.0, inner = 0.0;
		for (int y = 0; y < PX; y++)
			for (int c = 0; c < 3; c++) {
				const uint8_t(*row)[4] = layers[m].px + y * PX;
				step += abs(row[0][c] - row[PX - 1][c]);
				inner += abs(row[4][c] - row[5][c]);
			}
		/* Frames, ribs and joints may lie on the seam; a different wall may not. */
		assert_true(step / (PX * 3) < 45.0 + inner / (PX * 3));
	}
}

static void painting_again_paints_the_same(void **state)
{
	(void)state;
	uint8_t *before = malloc(LAYER_BYTES * MATERIAL_WALL_END);
	assert_non_null(before);
	memcpy(before, memory, LAYER_BYTES * MATERIAL_WALL_END);
	paint_roofs(layers);
	paint_walls(layers);
	assert_memory_equal(before, memory, LAYER_BYTES * MATERIAL_WALL_END);
	free(before);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_layer_is_painted),
		cmocka_unit_test(windows_have_glass_and_blank_walls_none),
		cmocka_unit_test(ground_floors_are_plain_on_top),
		cmocka_unit_test(bays_join_without_a_seam),
		cmocka_unit_test(painting_again_paints_the_same),
	};
	return cmocka_run_group_tests(tests, paint, finish);
}
