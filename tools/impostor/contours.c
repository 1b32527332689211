/* Crack following over the lattice of pixel corners; linear in the pixels. */
#include "tools/impostor/contours.h"

#include <string.h>

/* Sides that leave a corner to the east, south, west, north; the lower bits of `sides`. */
static const int step_x[4] = { 1, 0, -1, 0 }, step_y[4] = { 0, 1, 0, -1 };

struct tracing {
	struct contours *contours;
	const uint32_t *label;
	uint32_t width, height;
};

static uint32_t label_at(const struct tracing *tracing, int64_t x, int64_t y)
{
	if (x < 0 || y < 0 || x >= tracing->width || y >= tracing->height)
		return 0;
	return tracing->label[(size_t)y * tracing->width + (size_t)x];
}

static uint8_t *sides_at(struct tracing *tracing, uint32_t x, uint32_t y)
{
	return &tracing->contours->sides.items[(size_t)y * (tracing->width + 1) + x];
}

static void mark_sides(struct tracing *tracing)
{
	uint32_t width = tracing->width, height = tracing->height;
	ARRAY_RESERVE(&tracing->contours->sides, (size_t)(width + 1) * (height + 1));
	memset(tracing->contours->sides.items, 0, (size_t)(width + 1) * (height + 1));
	for (uint32_t y = 0; y <= height; y++) {
		for (uint32_t x = 0; x <= width; x++) {
			uint32_t here = label_at(tracing, x, y);
			if (x < width && here != label_at(tracing, x, (int64_t)y - 1)) {
				*sides_at(tracing, x, y) |= 1;
				*sides_at(tracing, x + 1, y) |= 4;
			}
			if (y < height && here != label_at(tracing, (int64_t)x - 1, y)) {
				*sides_at(tracing, x, y) |= 2;
				*sides_at(tracing, x, y + 1) |= 8;
			}
		}
	}
}

static bool is_junction(uint8_t sides)
{
	return __builtin_popcount(sides & 15) > 2;
}

/* The pixel on the left of a side that leaves corner (x, y), seen along it; y is down. */
static uint32_t left_of(const struct tracing *tracing, uint32_t x, uint32_t y, int direction)
{
	static const int8_t offset[4][2] = { { 0, -1 }, { 0, 0 }, { -1, 0 }, { -1, -1 } };
	return label_at(tracing, (int64_t)x + offset[direction][0], (int64_t)y + offset[direction][1]);
}

static uint32_t right_of(const struct tracing *tracing, uint32_t x, uint32_t y, int direction)
{
	static const int8_t offset[4][2] = { { 0, 0 }, { -1, 0 }, { -1, -1 }, { 0, -1 } };
	return label_at(tracing, (int64_t)x + offset[direction][0], (int64_t)y + offset[direction][1]);
}

/* Follows sides from a corner until a junction or the start. A visited side loses its low bits, and keeps them in the
 * upper four so that junctions stay known. */
static void follow(struct tracing *tracing, uint32_t x, uint32_t y, int direction)
{
	struct contours *contours = tracing->contours;
	struct chain chain = { .first = (uint32_t)contours->points.count,
		.left = left_of(tracing, x, y, direction),
		.right = right_of(tracing, x, y, direction) };
	uint32_t start_x = x, start_y = y;
	ARRAY_PUSH(&contours->points, (struct contour_point){ (float)x, (float)y });
	for (;;) {
		uint32_t next_x = (uint32_t)((int64_t)x + step_x[direction]),
				 next_y = (uint32_t)((int64_t)y + step_y[direction]);
		ARRAY_PUSH(&contours->points,
			(struct contour_point){ 0.5f * ((float)x + (float)next_x), 0.5f * ((float)y + (float)next_y) });
		*sides_at(tracing, x, y) |= (uint8_t)(16 << direction);
		*sides_at(tracing, next_x, next_y) |= (uint8_t)(16 << (direction ^ 2));
		x = next_x;
		y = next_y;
		uint8_t sides = *sides_at(tracing, x, y);
		if (is_junction(sides) || (x == start_x && y == start_y))
			break;
		direction = __builtin_ctz((unsigned)(sides & 15) & ~((unsigned)sides >> 4));
	}
	ARRAY_PUSH(&contours->points, (struct contour_point){ (float)x, (float)y });
	chain.count = (uint32_t)contours->points.count - chain.first;
	chain.closed = x == start_x && y == start_y;
	ARRAY_PUSH(&contours->chains, chain);
}

static void follow_all(struct tracing *tracing, bool junctions)
{
	for (uint32_t y = 0; y <= tracing->height; y++) {
		for (uint32_t x = 0; x <= tracing->width; x++) {
			uint8_t *sides = sides_at(tracing, x, y);
			if (!*sides || (junctions && !is_junction(*sides)))
				continue;
			for (int direction = 0; direction < 4; direction++)
				if (*sides & (1 << direction) && !(*sides & (16 << direction)))
					follow(tracing, x, y, direction);
		}
	}
}

void contours_trace(struct contours *contours, const uint32_t *label, uint32_t width, uint32_t height)
{
	contours->points.count = contours->chains.count = 0;
	struct tracing tracing = { contours, label, width, height };
	mark_sides(&tracing);
	follow_all(&tracing, true);
	follow_all(&tracing, false);
}

void contours_finish(struct contours *contours)
{
	ARRAY_FINISH(&contours->points);
	ARRAY_FINISH(&contours->chains);
	ARRAY_FINISH(&contours->sides);
}
