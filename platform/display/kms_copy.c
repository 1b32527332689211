#include "platform/display/kms_copy.h"

#include <string.h>

/* Where the source is read as the target is written row by row: a start, a step per pixel and one per row, in 16.16
 * pixels of the source. */
struct walk {
	int64_t x, y, x_column, y_column, x_row, y_row;
};

static struct walk walk_for(const struct kms_picture *from, uint32_t width, uint32_t height, unsigned turn_deg)
{
	uint32_t across = turn_deg % 180 ? height : width, down = turn_deg % 180 ? width : height;
	int64_t dx = ((int64_t)from->width << 16) / across, dy = ((int64_t)from->height << 16) / down;
	int64_t left = dx / 2, top = dy / 2;
	int64_t right = left + dx * ((int64_t)across - 1), bottom = top + dy * ((int64_t)down - 1);
	switch (turn_deg % 360) {
	case 90: /* the target's top row is the source's left column, from below */
		return (struct walk){ left, bottom, 0, -dy, dx, 0 };
	case 180:
		return (struct walk){ right, bottom, -dx, 0, 0, -dy };
	case 270:
		return (struct walk){ right, top, 0, dy, -dx, 0 };
	default:
		return (struct walk){ left, top, dx, 0, 0, dy };
	}
}

void kms_copy(const struct kms_picture *from, uint8_t *to, uint32_t pitch, uint32_t width, uint32_t height,
	unsigned turn_deg, float dim)
{
	uint32_t shade[256];
	for (uint32_t i = 0; i < 256; i++)
		shade[i] = (uint32_t)((float)i * dim + 0.5f);
	struct walk walk = walk_for(from, width, height, turn_deg);
	for (uint32_t row = 0; row < height; row++) {
		uint8_t *out = to + (size_t)row * pitch;
		int64_t x = walk.x + walk.x_row * row, y = walk.y + walk.y_row * row;
		for (uint32_t column = 0; column < width; column++) {
			const uint8_t *px = from->rgba + ((size_t)(y >> 16) * from->width + (size_t)(x >> 16)) * 4;
			uint32_t value = 0xFF000000u | shade[px[0]] << 16 | shade[px[1]] << 8 | shade[px[2]];
			memcpy(out + (size_t)column * 4, &value, 4);
			x += walk.x_column;
			y += walk.y_column;
		}
	}
}
