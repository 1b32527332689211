/*
 * Planar mode (KDFS 1.3, Format RGB ETC2): three colours, at the origin, four texels right and four down, interpolated.
 * The least-squares plane, rounded, then improved a step at a time; channels do not depend on one another.
 */
#include "tools/bake/etc2_modes.h"

/* Stored values of one channel. */
struct plane {
	int at[3]; /* origin, horizontal, vertical */
};

static uint32_t plane_error(const uint8_t texels[16][4], int channel, const struct plane *plane, int bits)
{
	int o = etc2_widen(plane->at[0], bits), h = etc2_widen(plane->at[1], bits), v = etc2_widen(plane->at[2], bits);
	uint32_t sum = 0;
	for (int i = 0; i < 16; i++) {
		int value = etc2_clamp((i % 4 * (h - o) + i / 4 * (v - o) + 4 * o + 2) >> 2);
		sum += (uint32_t)etc2_square(value - texels[i][channel]);
	}
	return sum;
}

/* In 240ths: the slopes' denominators are 40 a texel, the mean's 16. */
static int quantize(int value_240, int bits)
{
	int top = (1 << bits) - 1, most = 255 * 240;
	int value = value_240 < 0 ? 0 : value_240 > most ? most : value_240;
	return (value * top + most / 2) / most;
}

static struct plane least_squares(const uint8_t texels[16][4], int channel, int bits)
{
	int sum = 0, right = 0, down = 0;
	for (int i = 0; i < 16; i++) {
		sum += texels[i][channel];
		right += (2 * (i % 4) - 3) * texels[i][channel];
		down += (2 * (i / 4) - 3) * texels[i][channel];
	}
	int origin = 15 * sum - 9 * (right + down);
	return (struct plane){ { quantize(origin, bits), quantize(origin + 24 * right, bits),
		quantize(origin + 24 * down, bits) } };
}

static uint32_t improve(const uint8_t texels[16][4], int channel, int bits, struct plane *plane)
{
	uint32_t error = plane_error(texels, channel, plane, bits);
	for (int k = 0; k < 6 && error; k++) {
		struct plane moved = *plane;
		moved.at[k / 2] += k & 1 ? 1 : -1;
		if (moved.at[k / 2] < 0 || moved.at[k / 2] >= 1 << bits)
			continue;
		uint32_t changed = plane_error(texels, channel, &moved, bits);
		if (changed < error) {
			error = changed;
			*plane = moved;
		}
	}
	return error;
}

static uint64_t pack(const struct plane planes[3])
{
	const int *r = planes[0].at, *g = planes[1].at, *b = planes[2].at;
	uint64_t bits = (uint64_t)r[0] << 57 | (uint64_t)(g[0] >> 6) << 56 | (uint64_t)(g[0] & 63) << 49 |
					(uint64_t)(b[0] >> 5) << 48 | (uint64_t)(b[0] & 1) << 39;
	/* red and green must not overflow: their free bit follows the difference's sign */
	bits |= (uint64_t)(r[0] >> 1 & 1) << 63 | (uint64_t)(g[0] >> 1 & 1) << 55;
	bits |= etc2_overflow((unsigned)b[0] >> 3 & 3, (unsigned)b[0] >> 1 & 3, 40);
	bits |= (uint64_t)(r[1] >> 1) << 34 | 1ull << 33 | (uint64_t)(r[1] & 1) << 32;
	return bits | (uint64_t)g[1] << 25 | (uint64_t)b[1] << 19 | (uint64_t)r[2] << 13 | (uint64_t)g[2] << 6 |
		   (uint64_t)b[2];
}

void etc2_try_planar(const uint8_t texels[16][4], struct etc2_choice *best)
{
	static const int bits[3] = { 6, 7, 6 };
	struct plane planes[3];
	uint32_t error = 0;
	for (int c = 0; c < 3; c++) {
		planes[c] = least_squares(texels, c, bits[c]);
		error += plane_error(texels, c, &planes[c], bits[c]);
	}
	if (error / 2 >= best->error)
		return;
	error = 0;
	for (int c = 0; c < 3; c++)
		error += improve(texels, c, bits[c], &planes[c]);
	if (error < best->error)
		*best = (struct etc2_choice){ pack((const struct plane *)planes), error };
}
