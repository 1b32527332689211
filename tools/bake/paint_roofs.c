/*
 * The roof textures: one tile is ROOF_TILE_M squared, u along the eaves, v up the slope. Painted near white; the vertex
 * colour says which clay, slate or metal it is.
 */
#include "tools/bake/bake.h"
#include "tools/bake/buildings.h"
#include "tools/bake/facade_canvas.h"

#include <math.h>
#include <stdlib.h>

#define SIDE ((float)ROOF_TILE_M)

static void paint_tiles(struct canvas *c)
{
	int rows = 12, columns = 14;
	canvas_courses(c, canvas_box(c), &(struct courses){ rows, columns, 0.02f, 0.16f, 0.09f, 41 });
	for (int i = 0; i < rows; i++) {
		float step = SIDE / (float)rows, y = step * (float)i;
		canvas_shadow(c, box_of(0.0f, y, SIDE, y + step), 0.24f);
		canvas_shade(c, box_of(0.0f, y, SIDE, y + step * 0.14f), 1.08f);
	}
	canvas_grain(c, 4, 0.05f, 42);
}

static void paint_slate(struct canvas *c)
{
	canvas_courses(c, canvas_box(c), &(struct courses){ 16, 12, 0.016f, 0.16f, 0.07f, 43 });
	for (int i = 0; i < 16; i++) {
		float step = SIDE / 16.0f, y = step * (float)i;
		canvas_shadow(c, box_of(0.0f, y, SIDE, y + step), 0.12f);
	}
	canvas_grain(c, 5, 0.03f, 44);
}

static void paint_seams(struct canvas *c, uint32_t seed, float stain)
{
	int seams = 8;
	for (int i = 0; i < seams; i++) {
		float step = SIDE / (float)seams, x = step * (float)i;
		canvas_shade(c, box_of(x, 0.0f, x + 0.05f, SIDE), 1.06f);
		canvas_shade(c, box_of(x + 0.05f, 0.0f, x + 0.09f, SIDE), 0.80f);
		canvas_shade(c, box_of(x + 0.09f, 0.0f, x + step, SIDE), i % 3 == 1 ? 0.97f : 1.0f);
	}
	canvas_grain(c, 3, stain, seed);
}
static void paint_metal(struct canvas *c)
{
	paint_seams(c, 45, 0.05f);
}
static void paint_copper(struct canvas *c)
{
	paint_seams(c, 46, 0.12f);
}

static void paint_gravel_roof(struct canvas *c)
{
	canvas_grain(c, 24, 0.16f, 47);
	canvas_grain(c, 3, 0.02f, 48);
}

static void paint_concrete_roof(struct canvas *c)
{
	canvas_grain(c, 4, 0.03f, 49);
	canvas_grain(c, 24, 0.05f, 50);
	for (int i = 0; i < 2; i++) {
		float at = SIDE * 0.5f * (float)i;
		canvas_shade(c, box_of(at, 0.0f, at + 0.03f, SIDE), 0.86f);
		canvas_shade(c, box_of(0.0f, at, SIDE, at + 0.03f), 0.86f);
	}
}

static void paint_glass_roof(struct canvas *c)
{
	for (int i = 0; i < 4; i++)
		for (int k = 0; k < 4; k++) {
			float x = SIDE * 0.25f * (float)i, y = SIDE * 0.25f * (float)k, light = (i * 3 + k) % 4 == 0 ? 0.94f : 1.0f;
			canvas_gradient(c, box_of(x + 0.04f, y + 0.04f, x + SIDE * 0.25f - 0.04f, y + SIDE * 0.25f - 0.04f),
				tone_scale(tone_of(0.60f, 0.69f, 0.73f), light), tone_scale(tone_of(0.72f, 0.80f, 0.84f), light), 0.0f);
		}
}

static void paint_grass_roof(struct canvas *c)
{
	canvas_grain(c, 16, 0.22f, 51);
	canvas_grain(c, 4, 0.14f, 52);
}

int paint_roofs(struct material_layer *layers)
{
	static const struct {
		int material;
		void (*paint)(struct canvas *canvas);
		uint8_t gloss;
	} roofs[] = { { MATERIAL_ROOF_TILES, paint_tiles, 20 }, { MATERIAL_ROOF_SLATE, paint_slate, 60 },
		{ MATERIAL_ROOF_METAL, paint_metal, 110 }, { MATERIAL_ROOF_COPPER, paint_copper, 60 },
		{ MATERIAL_ROOF_GRAVEL, paint_gravel_roof, 0 }, { MATERIAL_ROOF_CONCRETE, paint_concrete_roof, 10 },
		{ MATERIAL_ROOF_GLASS, paint_glass_roof, 200 }, { MATERIAL_ROOF_GRASS, paint_grass_roof, 0 } };
	float(*memory)[4] = malloc(sizeof(*memory) * MATERIAL_TEXTURE_PX * MATERIAL_TEXTURE_PX);
	if (!memory)
		return MATERIAL_ROOF_TILES;
	for (size_t i = 0; i < sizeof(roofs) / sizeof(roofs[0]); i++) {
		struct canvas canvas;
		canvas_start(&canvas, memory, SIDE, SIDE, tone_grey(0.90f));
		roofs[i].paint(&canvas);
		layers[roofs[i].material].kind = PKG_MATERIAL_ROOF;
		layers[roofs[i].material].gloss = roofs[i].gloss;
		canvas_store(&canvas, &layers[roofs[i].material]);
	}
	free(memory);
	return MATERIAL_ROOF_GRASS + 1;
}
