/*
 * Painting of wall and roof textures: a square canvas in metres, x to the right, y up, with exact coverage for
 * rectangles and 4 x 4 samples for curves, so that the result is free of steps at MATERIAL_TEXTURE_PX and below.
 * Colours are sRGB, 0 to 1. `glass` is what ends up in alpha: 1 glass, 0 wall.
 */
#ifndef BLVD_TOOLS_BAKE_FACADE_CANVAS_H
#define BLVD_TOOLS_BAKE_FACADE_CANVAS_H

#include "tools/bake/materials.h"

struct tone {
	float r, g, b;
};

struct box {
	float x0, y0, x1, y1;
};

struct canvas {
	float (*px)[4]; /* rgb, glass; row 0 is the bottom */
	float width_m, height_m;
};

/* `memory` holds MATERIAL_TEXTURE_PX squared pixels. */
void canvas_start(struct canvas *canvas, float (*memory)[4], float width_m, float height_m, struct tone tone);
void canvas_store(const struct canvas *canvas, struct material_layer *layer);

void canvas_rect(struct canvas *canvas, struct box box, struct tone tone, float opacity, float glass);
/* From `low` at the bottom to `high` at the top. */
void canvas_gradient(struct canvas *canvas, struct box box, struct tone low, struct tone high, float glass);
/* A rectangle whose top is half an ellipse of height `rise`, all within the box. */
void canvas_arch(struct canvas *canvas, struct box box, float rise, struct tone low, struct tone high, float glass);
/* A triangle, its base the lower side of the box. */
void canvas_gable(struct canvas *canvas, struct box box, struct tone tone, float opacity);
/* Multiplies: light > 1 lightens. Leaves glass as it is. */
void canvas_shade(struct canvas *canvas, struct box box, float light);
/* A cast shadow below the box's top edge (or any edge): fades linearly from `dark` at the top to nothing. */
void canvas_shadow(struct canvas *canvas, struct box box, float dark);

/* Seamless noise over the whole wall: `cells` lattice cells across the tile, three octaves. */
void canvas_grain(struct canvas *canvas, int cells, float amount, uint32_t seed);
float tile_noise(float x, float y, int cells, uint32_t seed);
/* Courses of blocks in running bond; each block's tone varies by `vary`, joints are `joint` darker. Counts are whole
 * numbers, so that the tile repeats. */
struct courses {
	int rows, blocks;
	float joint_m, joint, vary;
	uint32_t seed;
};
void canvas_courses(struct canvas *canvas, struct box box, const struct courses *courses);
/* Horizontal boards, or upright ribs. */
void canvas_boards(struct canvas *canvas, struct box box, int count, float dark);
void canvas_ribs(struct canvas *canvas, struct box box, int count, float dark);

static inline struct tone tone_of(float r, float g, float b)
{
	return (struct tone){ r, g, b };
}
static inline struct tone tone_grey(float value)
{
	return (struct tone){ value, value, value };
}
static inline struct tone tone_scale(struct tone tone, float by)
{
	return (struct tone){ tone.r * by, tone.g * by, tone.b * by };
}
static inline struct box box_of(float x0, float y0, float x1, float y1)
{
	return (struct box){ x0, y0, x1, y1 };
}
static inline struct box box_grow(struct box box, float by)
{
	return (struct box){ box.x0 - by, box.y0 - by, box.x1 + by, box.y1 + by };
}
static inline struct box canvas_box(const struct canvas *canvas)
{
	return (struct box){ 0.0f, 0.0f, canvas->width_m, canvas->height_m };
}

#endif
