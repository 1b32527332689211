#include "tools/bake/facade_canvas.h"

#include <math.h>
#include <stdbool.h>

#include "platform/base/rng.h"

#define PX MATERIAL_TEXTURE_PX

void canvas_start(struct canvas *canvas, float (*memory)[4], float width_m, float height_m, struct tone tone)
{
	*canvas = (struct canvas){ memory, width_m, height_m };
	for (int i = 0; i < PX * PX; i++) {
		memory[i][0] = tone.r;
		memory[i][1] = tone.g;
		memory[i][2] = tone.b;
		memory[i][3] = 0.0f;
	}
}

static uint8_t byte_of(float value)
{
	return (uint8_t)lrintf(fminf(fmaxf(value, 0.0f), 1.0f) * 255.0f);
}

void canvas_store(const struct canvas *canvas, struct material_layer *layer)
{
	for (int i = 0; i < PX * PX; i++)
		for (int k = 0; k < 4; k++)
			layer->px[i][k] = byte_of(canvas->px[i][k]);
}

static float overlap(float a0, float a1, float b0, float b1)
{
	return fmaxf(0.0f, fminf(a1, b1) - fmaxf(a0, b0));
}

struct span_px {
	int from, to;
};

static struct span_px span_px(float low, float high)
{
	struct span_px out = { (int)floorf(low), (int)ceilf(high) };
	out.from = out.from < 0 ? 0 : out.from;
	out.to = out.to > PX ? PX : out.to;
	return out;
}

static struct box in_px(const struct canvas *canvas, struct box box)
{
	float sx = PX / canvas->width_m, sy = PX / canvas->height_m;
	return (struct box){ box.x0 * sx, box.y0 * sy, box.x1 * sx, box.y1 * sy };
}

static void blend(float *px, struct tone tone, float by, float glass)
{
	px[0] += (tone.r - px[0]) * by;
	px[1] += (tone.g - px[1]) * by;
	px[2] += (tone.b - px[2]) * by;
	px[3] += (glass - px[3]) * by;
}

static struct tone mix(struct tone a, struct tone b, float by)
{
	return (struct tone){ a.r + (b.r - a.r) * by, a.g + (b.g - a.g) * by, a.b + (b.b - a.b) * by };
}

/* Share of the pixel inside the rectangle. */
static float cover(struct box box, int x, int y)
{
	return overlap(box.x0, box.x1, (float)x, (float)x + 1.0f) * overlap(box.y0, box.y1, (float)y, (float)y + 1.0f);
}

void canvas_rect(struct canvas *canvas, struct box box, struct tone tone, float opacity, float glass)
{
	struct box px = in_px(canvas, box);
	struct span_px xs = span_px(px.x0, px.x1), ys = span_px(px.y0, px.y1);
	for (int y = ys.from; y < ys.to; y++)
		for (int x = xs.from; x < xs.to; x++)
			blend(canvas->px[y * PX + x], tone, opacity * cover(px, x, y), glass);
}

static float height_in(struct box px, int y)
{
	float t = ((float)y + 0.5f - px.y0) / (px.y1 - px.y0);
	return fminf(fmaxf(t, 0.0f), 1.0f);
}

void canvas_gradient(struct canvas *canvas, struct box box, struct tone low, struct tone high, float glass)
{
	struct box px = in_px(canvas, box);
	struct span_px xs = span_px(px.x0, px.x1), ys = span_px(px.y0, px.y1);
	for (int y = ys.from; y < ys.to; y++)
		for (int x = xs.from; x < xs.to; x++)
			blend(canvas->px[y * PX + x], mix(low, high, height_in(px, y)), cover(px, x, y), glass);
}

static bool in_arch(struct box px, float rise, float x, float y)
{
	if (x < px.x0 || x > px.x1 || y < px.y0 || y > px.y1)
		return false;
	float above = y - (px.y1 - rise);
	if (above <= 0.0f || rise <= 0.0f)
		return true;
	float across = (x - (px.x0 + px.x1) / 2.0f) / ((px.x1 - px.x0) / 2.0f), up = above / rise;
	return across * across + up * up <= 1.0f;
}

static bool in_gable(struct box px, float rise, float x, float y)
{
	(void)rise;
	if (y < px.y0 || y > px.y1)
		return false;
	float half = (px.x1 - px.x0) / 2.0f * (px.y1 - y) / (px.y1 - px.y0);
	return fabsf(x - (px.x0 + px.x1) / 2.0f) <= half;
}

static float sampled(bool (*inside)(struct box, float, float, float), struct box px, float rise, int x, int y)
{
	int hits = 0;
	for (int i = 0; i < 16; i++)
		hits += inside(px, rise, (float)x + ((float)(i % 4) + 0.5f) / 4.0f, (float)y + ((float)(i / 4) + 0.5f) / 4.0f);
	return (float)hits / 16.0f;
}

void canvas_arch(struct canvas *canvas, struct box box, float rise, struct tone low, struct tone high, float glass)
{
	struct box px = in_px(canvas, box);
	float rise_px = rise * PX / canvas->height_m;
	struct span_px xs = span_px(px.x0, px.x1), ys = span_px(px.y0, px.y1);
	for (int y = ys.from; y < ys.to; y++)
		for (int x = xs.from; x < xs.to; x++)
			blend(canvas->px[y * PX + x], mix(low, high, height_in(px, y)), sampled(in_arch, px, rise_px, x, y), glass);
}

void canvas_gable(struct canvas *canvas, struct box box, struct tone tone, float opacity)
{
	struct box px = in_px(canvas, box);
	struct span_px xs = span_px(px.x0, px.x1), ys = span_px(px.y0, px.y1);
	for (int y = ys.from; y < ys.to; y++)
		for (int x = xs.from; x < xs.to; x++)
			blend(canvas->px[y * PX + x], tone, opacity * sampled(in_gable, px, 0.0f, x, y), 0.0f);
}

static void shade_px(float *px, float light, float by)
{
	for (int k = 0; k < 3; k++)
		px[k] = fminf(px[k] * (1.0f + (light - 1.0f) * by), 1.0f);
}

void canvas_shade(struct canvas *canvas, struct box box, float light)
{
	struct box px = in_px(canvas, box);
	struct span_px xs = span_px(px.x0, px.x1), ys = span_px(px.y0, px.y1);
	for (int y = ys.from; y < ys.to; y++)
		for (int x = xs.from; x < xs.to; x++)
			shade_px(canvas->px[y * PX + x], light, cover(px, x, y));
}

void canvas_shadow(struct canvas *canvas, struct box box, float dark)
{
	struct box px = in_px(canvas, box);
	struct span_px xs = span_px(px.x0, px.x1), ys = span_px(px.y0, px.y1);
	for (int y = ys.from; y < ys.to; y++)
		for (int x = xs.from; x < xs.to; x++)
			shade_px(canvas->px[y * PX + x], 1.0f - dark * height_in(px, y), cover(px, x, y));
}

static float lattice(int x, int y, int cells, uint32_t seed)
{
	x = ((x % cells) + cells) % cells;
	y = ((y % cells) + cells) % cells;
	uint64_t key = (uint64_t)seed << 40 ^ (uint64_t)(uint32_t)x << 20 ^ (uint64_t)(uint32_t)y;
	return (float)(hash_u64(key + 1) & 0xFFFF) / 32767.5f - 1.0f;
}

float tile_noise(float x, float y, int cells, uint32_t seed)
{
	float fx = x * (float)cells, fy = y * (float)cells;
	int ix = (int)floorf(fx), iy = (int)floorf(fy);
	float tx = fx - (float)ix, ty = fy - (float)iy;
	tx = tx * tx * (3.0f - 2.0f * tx);
	ty = ty * ty * (3.0f - 2.0f * ty);
	float low = lattice(ix, iy, cells, seed) * (1.0f - tx) + lattice(ix + 1, iy, cells, seed) * tx;
	float high = lattice(ix, iy + 1, cells, seed) * (1.0f - tx) + lattice(ix + 1, iy + 1, cells, seed) * tx;
	return low * (1.0f - ty) + high * ty;
}

void canvas_grain(struct canvas *canvas, int cells, float amount, uint32_t seed)
{
	for (int y = 0; y < PX; y++)
		for (int x = 0; x < PX; x++) {
			float u = ((float)x + 0.5f) / PX, v = ((float)y + 0.5f) / PX;
			float n = tile_noise(u, v, cells, seed) * 0.5f + tile_noise(u, v, cells * 3, seed + 1) * 0.3f +
					  tile_noise(u, v, cells * 9, seed + 2) * 0.2f;
			shade_px(canvas->px[y * PX + x], 1.0f + n * amount, 1.0f - canvas->px[y * PX + x][3]);
		}
}

void canvas_courses(struct canvas *canvas, struct box box, const struct courses *courses)
{
	float row_m = (box.y1 - box.y0) / (float)courses->rows, block_m = (box.x1 - box.x0) / (float)courses->blocks;
	float half = courses->joint_m / 2.0f;
	for (int row = 0; row < courses->rows; row++) {
		float y = box.y0 + row_m * (float)row, shift = row % 2 ? block_m / 2.0f : 0.0f;
		for (int i = -1; i < courses->blocks; i++) {
			float x = box.x0 + shift + block_m * (float)i;
			struct box block = { fmaxf(x, box.x0), y, fminf(x + block_m, box.x1), y + row_m };
			float light =
				1.0f + courses->vary * lattice((i + courses->blocks) % courses->blocks, row, 512, courses->seed);
			canvas_shade(canvas, block, light);
			canvas_shade(
				canvas, box_of(fmaxf(x - half, box.x0), y, fminf(x + half, box.x1), y + row_m), 1.0f - courses->joint);
		}
		if (shift <= 0.0f)
			canvas_shade(canvas, box_of(box.x1 - half, y, box.x1, y + row_m), 1.0f - courses->joint);
		canvas_shade(canvas, box_of(box.x0, y - (row ? half : 0.0f), box.x1, y + half), 1.0f - courses->joint);
	}
	canvas_shade(canvas, box_of(box.x0, box.y1 - half, box.x1, box.y1), 1.0f - courses->joint);
}

void canvas_boards(struct canvas *canvas, struct box box, int count, float dark)
{
	float step = (box.y1 - box.y0) / (float)count;
	for (int i = 0; i < count; i++) {
		float y = box.y0 + step * (float)i;
		canvas_shadow(canvas, box_of(box.x0, y, box.x1, y + step), -0.05f);
		canvas_shade(canvas, box_of(box.x0, y, box.x1, y + step * 0.16f), 1.0f - dark);
	}
}

void canvas_ribs(struct canvas *canvas, struct box box, int count, float dark)
{
	float step = (box.x1 - box.x0) / (float)count;
	for (int i = 0; i < count; i++) {
		float x = box.x0 + step * (float)i;
		canvas_shade(canvas, box_of(x, box.y0, x + step * 0.22f, box.y1), 1.0f - dark);
		canvas_shade(canvas, box_of(x + step * 0.6f, box.y0, x + step * 0.8f, box.y1), 1.0f + dark * 0.4f);
	}
}
