#include "tools/measure/holes.h"

#include <stddef.h>

#define REACH 2

static bool has(const struct truth_image *image, long x, long y)
{
	return x >= 0 && y >= 0 && x < (long)image->width && y < (long)image->height &&
		   image->pixels[(size_t)y * image->width + (size_t)x].object;
}

static bool has_within(const struct truth_image *image, long x, long y, long dx, long dy)
{
	for (long i = 1; i <= REACH; i++)
		if (has(image, x + i * dx, y + i * dy))
			return true;
	return false;
}

static bool open_near(const struct truth_image *reference, const uint8_t *open, long x, long y)
{
	for (long v = y - REACH; v <= y + REACH; v++)
		for (long u = x - REACH; u <= x + REACH; u++)
			if (u >= 0 && v >= 0 && u < (long)reference->width && v < (long)reference->height &&
				(open ? open[(size_t)v * reference->width + (size_t)u] : !has(reference, u, v)))
				return true;
	return false;
}

void holes_mark_open(const struct truth_image *reference, uint8_t *open)
{
	for (size_t i = 0; i < (size_t)reference->width * reference->height; i++)
		open[i] |= !reference->pixels[i].object;
}

static bool is_crack(
	const struct truth_image *reference, const uint8_t *open, const struct truth_image *shown, long x, long y)
{
	bool between = (has_within(shown, x, y, 1, 0) && has_within(shown, x, y, -1, 0)) ||
				   (has_within(shown, x, y, 0, 1) && has_within(shown, x, y, 0, -1));
	return between && !open_near(reference, open, x, y);
}

void holes_find(const struct truth_image *reference, const uint8_t *open, const struct truth_image *shown,
	struct holes *out, uint8_t *map)
{
	*out = (struct holes){ .pixels = (uint64_t)reference->width * reference->height };
	for (uint32_t y = 0; y < reference->height; y++) {
		for (uint32_t x = 0; x < reference->width; x++) {
			size_t index = (size_t)y * reference->width + x;
			bool drawn = reference->pixels[index].object, uncovered = drawn && !shown->pixels[index].object;
			bool crack = uncovered && is_crack(reference, open, shown, x, y);
			out->drawn += drawn;
			out->uncovered += uncovered;
			out->cracks += crack;
			if (map)
				map[index] = (uint8_t)(uncovered + crack);
		}
	}
}
