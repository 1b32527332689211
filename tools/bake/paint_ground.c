/*
 * Textures of the ground and of what stands on it, painted from periodic noise: quiet colours, low contrast, nothing
 * that shows as a pattern from afar. Colours are sRGB.
 */
#include <math.h>
#include <string.h>

#include "platform/base/rng.h"
#include "platform/base/vec.h"
#include "tools/bake/materials.h"

#define PX MATERIAL_TEXTURE_PX

struct brush {
	uint8_t (*px)[4];
	uint64_t seed;
};

struct rgb {
	double r, g, b;
};

/* ---- periodic noise ---- */

static double lattice_value(uint64_t seed, int x, int y, int period)
{
	uint64_t wrapped_x = (uint64_t)((x % period + period) % period),
			 wrapped_y = (uint64_t)((y % period + period) % period);
	return (double)(hash_u64(seed ^ (wrapped_x << 20 | wrapped_y)) >> 40) / 16777216.0;
}

static double smooth(double t)
{
	return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

/* Value noise in [0, 1] with `cells` cells over the tile. */
static double noise(uint64_t seed, double x, double y, int cells)
{
	double u = x * cells / PX, v = y * cells / PX;
	int i = (int)floor(u), j = (int)floor(v);
	double fu = smooth(u - i), fv = smooth(v - j);
	double low = lattice_value(seed, i, j, cells) * (1.0 - fu) + lattice_value(seed, i + 1, j, cells) * fu;
	double high = lattice_value(seed, i, j + 1, cells) * (1.0 - fu) + lattice_value(seed, i + 1, j + 1, cells) * fu;
	return low * (1.0 - fv) + high * fv;
}

/* Octaves from `cells` on, in about [-1, 1]. */
static double cloud(uint64_t seed, double x, double y, int cells, int octaves)
{
	double sum = 0.0, weight = 1.0, total = 0.0;
	for (int i = 0; i < octaves; i++, weight *= 0.55) {
		sum += (noise(seed + (uint64_t)i * 77, x, y, cells << i) * 2.0 - 1.0) * weight;
		total += weight;
	}
	return sum / total * 1.6;
}

/* Distances to the nearest and second nearest of one point per cell, in cells (Worley, "A cellular texture basis
 * function", 1996). `which` tells the nearest cell's own value. */
static void cells_at(uint64_t seed, double x, double y, int cells, double *nearest, double *second, double *which)
{
	double u = x * cells / PX, v = y * cells / PX;
	int ci = (int)floor(u), cj = (int)floor(v);
	*nearest = *second = 9.0;
	for (int j = cj - 1; j <= cj + 1; j++)
		for (int i = ci - 1; i <= ci + 1; i++) {
			double px = i + 0.15 + 0.7 * lattice_value(seed, i, j, cells);
			double py = j + 0.15 + 0.7 * lattice_value(seed + 1, i, j, cells);
			double d = hypot(px - u, py - v);
			if (d < *nearest) {
				*second = *nearest;
				*nearest = d;
				*which = lattice_value(seed + 2, i, j, cells);
			} else if (d < *second) {
				*second = d;
			}
		}
}

static double grain(uint64_t seed, int x, int y)
{
	return lattice_value(seed, x, y, PX) * 2.0 - 1.0;
}

static uint8_t clamp_byte(double value)
{
	return (uint8_t)lrint(fmin(fmax(value, 0.0), 255.0));
}

static void put(const struct brush *brush, int x, int y, struct rgb colour, double offset)
{
	uint8_t *px = brush->px[y * PX + x];
	px[0] = clamp_byte(colour.r + offset);
	px[1] = clamp_byte(colour.g + offset);
	px[2] = clamp_byte(colour.b + offset);
	px[3] = 255;
}

/* ---- patterns ---- */

/* Fine grain over soft clouds: asphalt, concrete, sand, water-bound surfaces. */
static void paint_grainy(const struct brush *brush, struct rgb colour, double grain_size, double cloud_size, int cells)
{
	for (int y = 0; y < PX; y++)
		for (int x = 0; x < PX; x++) {
			double offset = grain(brush->seed, x, y) * grain_size * 0.6 +
							cloud(brush->seed + 3, x, y, 64, 2) * grain_size * 0.7 +
							cloud(brush->seed + 9, x, y, cells, 3) * cloud_size;
			put(brush, x, y, colour, offset);
		}
}

/* Slabs in running bond; each slab a little different, joints darker. */
static void paint_slabs(const struct brush *brush, struct rgb colour, int columns, int rows, double joint, double vary)
{
	double width = (double)PX / columns, height = (double)PX / rows;
	for (int y = 0; y < PX; y++)
		for (int x = 0; x < PX; x++) {
			int row = (int)(y / height);
			double shifted = fmod(x + (row & 1 ? width / 2.0 : 0.0), PX);
			int column = (int)(shifted / width);
			double dx = fmin(shifted - column * width, (column + 1) * width - shifted);
			double dy = fmin(y + 0.5 - row * height, (row + 1) * height - y - 0.5);
			double edge = fmin(dx, dy);
			double offset = (lattice_value(brush->seed, column, row, 64) * 2.0 - 1.0) * vary +
							grain(brush->seed + 1, x, y) * 2.0 + cloud(brush->seed + 2, x, y, 4, 3) * 3.0;
			if (edge < 1.6)
				offset -= joint * (1.0 - edge / 1.6);
			put(brush, x, y, colour, offset);
		}
}

static void paint_cobbles(const struct brush *brush, struct rgb colour, int cells, double joint, double vary)
{
	for (int y = 0; y < PX; y++)
		for (int x = 0; x < PX; x++) {
			double nearest, second, which = 0.0;
			cells_at(brush->seed, x, y, cells, &nearest, &second, &which);
			double gap = fmin((second - nearest) / 0.22, 1.0);
			double offset = (which * 2.0 - 1.0) * vary - joint * (1.0 - smooth(gap)) +
							grain(brush->seed + 5, x, y) * 2.0 + cloud(brush->seed + 6, x, y, 3, 2) * 3.0;
			put(brush, x, y, colour, offset);
		}
}

/* Two colours mixed by clouds, with blades' grain: lawns, woods, soil. */
static void paint_growth(
	const struct brush *brush, struct rgb low, struct rgb high, int cells, double grain_size, double contrast)
{
	for (int y = 0; y < PX; y++)
		for (int x = 0; x < PX; x++) {
			double mix =
				0.5 + contrast * (0.6 * cloud(brush->seed, x, y, cells, 4) + 0.4 * cloud(brush->seed + 8, x, y, 32, 2));
			mix = fmin(fmax(mix, 0.0), 1.0);
			struct rgb colour = { low.r + (high.r - low.r) * mix, low.g + (high.g - low.g) * mix,
				low.b + (high.b - low.b) * mix };
			put(brush, x, y, colour, grain(brush->seed + 4, x, y) * grain_size);
		}
}

/* Long low waves crossing each other, periodic because their wave numbers are whole. */
static void paint_water(const struct brush *brush, struct rgb colour)
{
	static const int waves[6][2] = { { 3, 1 }, { -2, 4 }, { 5, -3 }, { 1, 7 }, { 8, 4 }, { -6, 9 } };
	for (int y = 0; y < PX; y++)
		for (int x = 0; x < PX; x++) {
			double height = 0.0;
			for (int i = 0; i < 6; i++) {
				double phase = 2.0 * BLVD_PI * (waves[i][0] * x + waves[i][1] * y) / PX;
				height += sin(phase + 1.7 * i + 1.2 * cloud(brush->seed + (uint64_t)i, x, y, 4, 2)) / (1.5 + i * 0.5);
			}
			put(brush, x, y, colour, height * 4.0 + cloud(brush->seed + 9, x, y, 3, 2) * 3.0);
		}
}

/* Clumps of leaves: light tops, dark gaps. */
static void paint_leaves(const struct brush *brush, struct rgb colour, int cells, double depth)
{
	for (int y = 0; y < PX; y++)
		for (int x = 0; x < PX; x++) {
			double nearest, second, which = 0.0;
			cells_at(brush->seed, x, y, cells, &nearest, &second, &which);
			double offset = (0.45 - nearest) * depth + (which - 0.5) * 14.0 + cloud(brush->seed + 5, x, y, 4, 3) * 8.0 +
							grain(brush->seed + 6, x, y) * 4.0;
			put(brush, x, y, colour, offset);
			uint8_t *px = brush->px[y * PX + x];
			px[0] = clamp_byte(px[0] + (which - 0.5) * 10.0);
		}
}

static void paint_bark(const struct brush *brush, struct rgb colour)
{
	for (int y = 0; y < PX; y++)
		for (int x = 0; x < PX; x++) {
			double ridges = noise(brush->seed, x, y * 0.25, 32) + 0.5 * noise(brush->seed + 1, x, y * 0.5, 64);
			put(brush, x, y, colour, (ridges - 0.75) * 26.0 + grain(brush->seed + 2, x, y) * 3.0);
		}
}

/* Paint: uniform colour, wear in the alpha. */
static void paint_marking(const struct brush *brush, struct rgb colour)
{
	for (int y = 0; y < PX; y++)
		for (int x = 0; x < PX; x++) {
			put(brush, x, y, colour, grain(brush->seed, x, y) * 2.0);
			double wear = fmax(cloud(brush->seed + 1, x, y, 16, 3) - 0.45, 0.0) * 0.5 +
						  fmax(grain(brush->seed + 3, x, y) - 0.7, 0.0) * 0.4;
			brush->px[y * PX + x][3] = clamp_byte(245.0 * (1.0 - fmin(wear, 0.5)));
		}
}

/* ---- the materials ---- */

static void begin(
	struct material_layer *layers, enum material_id id, enum pkg_material_kind kind, uint8_t gloss, struct brush *brush)
{
	layers[id].kind = kind;
	layers[id].gloss = gloss;
	*brush = (struct brush){ layers[id].px, hash_u64((uint64_t)id + 1000) };
}

static void paint_streets(struct material_layer *layers)
{
	struct brush brush;
	begin(layers, MATERIAL_ASPHALT, PKG_MATERIAL_GROUND, 40, &brush);
	paint_grainy(&brush, (struct rgb){ 96, 99, 104 }, 5.0, 2.5, 4);
	begin(layers, MATERIAL_ASPHALT_OLD, PKG_MATERIAL_GROUND, 28, &brush);
	paint_grainy(&brush, (struct rgb){ 110, 112, 115 }, 6.0, 4.0, 3);
	begin(layers, MATERIAL_COBBLE, PKG_MATERIAL_GROUND, 40, &brush);
	paint_cobbles(&brush, (struct rgb){ 128, 125, 120 }, 20, 20.0, 7.0);
	begin(layers, MATERIAL_PAVING, PKG_MATERIAL_GROUND, 24, &brush);
	paint_slabs(&brush, (struct rgb){ 172, 169, 163 }, 8, 8, 12.0, 3.0);
	begin(layers, MATERIAL_KERB, PKG_MATERIAL_GROUND, 24, &brush);
	paint_grainy(&brush, (struct rgb){ 200, 198, 193 }, 4.0, 3.0, 4);
	begin(layers, MATERIAL_SQUARE, PKG_MATERIAL_GROUND, 30, &brush);
	paint_slabs(&brush, (struct rgb){ 184, 177, 166 }, 6, 6, 10.0, 4.0);
	begin(layers, MATERIAL_GRAVEL, PKG_MATERIAL_GROUND, 8, &brush);
	paint_grainy(&brush, (struct rgb){ 184, 174, 154 }, 9.0, 4.0, 4);
	begin(layers, MATERIAL_SAND, PKG_MATERIAL_GROUND, 8, &brush);
	paint_grainy(&brush, (struct rgb){ 212, 199, 166 }, 5.0, 5.0, 3);
	begin(layers, MATERIAL_BALLAST, PKG_MATERIAL_GROUND, 8, &brush);
	paint_cobbles(&brush, (struct rgb){ 124, 117, 109 }, 40, 26.0, 12.0);
	begin(layers, MATERIAL_MARKING, PKG_MATERIAL_MARKING, 60, &brush);
	paint_marking(&brush, (struct rgb){ 234, 234, 230 });
	begin(layers, MATERIAL_MARKING_YELLOW, PKG_MATERIAL_MARKING, 60, &brush);
	paint_marking(&brush, (struct rgb){ 226, 184, 66 });
}

static void paint_land(struct material_layer *layers)
{
	struct brush brush;
	begin(layers, MATERIAL_GRASS, PKG_MATERIAL_GROUND, 4, &brush);
	paint_growth(&brush, (struct rgb){ 122, 144, 92 }, (struct rgb){ 146, 164, 108 }, 4, 5.0, 0.45);
	begin(layers, MATERIAL_PARK, PKG_MATERIAL_GROUND, 4, &brush);
	paint_growth(&brush, (struct rgb){ 110, 138, 84 }, (struct rgb){ 130, 156, 98 }, 4, 4.0, 0.4);
	begin(layers, MATERIAL_FOREST, PKG_MATERIAL_GROUND, 4, &brush);
	paint_growth(&brush, (struct rgb){ 92, 108, 72 }, (struct rgb){ 116, 124, 88 }, 5, 6.0, 0.6);
	begin(layers, MATERIAL_PITCH, PKG_MATERIAL_GROUND, 6, &brush);
	paint_growth(&brush, (struct rgb){ 112, 146, 92 }, (struct rgb){ 122, 154, 98 }, 3, 4.0, 0.4);
	begin(layers, MATERIAL_SOIL, PKG_MATERIAL_GROUND, 4, &brush);
	paint_growth(&brush, (struct rgb){ 140, 128, 106 }, (struct rgb){ 160, 147, 124 }, 4, 6.0, 0.5);
	begin(layers, MATERIAL_YARD, PKG_MATERIAL_GROUND, 12, &brush);
	paint_grainy(&brush, (struct rgb){ 164, 160, 151 }, 5.0, 4.0, 3);
	begin(layers, MATERIAL_ROCK, PKG_MATERIAL_GROUND, 10, &brush);
	paint_growth(&brush, (struct rgb){ 134, 129, 120 }, (struct rgb){ 168, 161, 150 }, 6, 6.0, 0.7);
	begin(layers, MATERIAL_WATER, PKG_MATERIAL_WATER, 230, &brush);
	paint_water(&brush, (struct rgb){ 96, 130, 148 });
}

static void paint_things(struct material_layer *layers)
{
	struct brush brush;
	begin(layers, MATERIAL_CONCRETE, PKG_MATERIAL_SOLID, 16, &brush);
	paint_grainy(&brush, (struct rgb){ 188, 184, 176 }, 4.0, 5.0, 3);
	begin(layers, MATERIAL_METAL, PKG_MATERIAL_SOLID, 120, &brush);
	paint_grainy(&brush, (struct rgb){ 232, 232, 232 }, 3.0, 3.0, 4);
	begin(layers, MATERIAL_LAMP, PKG_MATERIAL_LAMP, 60, &brush);
	paint_grainy(&brush, (struct rgb){ 250, 246, 234 }, 1.0, 1.0, 4);
	begin(layers, MATERIAL_BARK, PKG_MATERIAL_SOLID, 6, &brush);
	paint_bark(&brush, (struct rgb){ 108, 94, 78 });
	begin(layers, MATERIAL_LEAF, PKG_MATERIAL_FOLIAGE, 10, &brush);
	paint_leaves(&brush, (struct rgb){ 104, 130, 76 }, 18, 42.0);
	begin(layers, MATERIAL_NEEDLE, PKG_MATERIAL_FOLIAGE, 10, &brush);
	paint_leaves(&brush, (struct rgb){ 74, 102, 74 }, 26, 40.0);
}

int paint_ground(struct material_layer *layers)
{
	paint_streets(layers);
	paint_land(layers);
	paint_things(layers);
	return MATERIAL_ROCK + 1;
}
