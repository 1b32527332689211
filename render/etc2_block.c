/*
 * One block back to texels, all modes: KDFS 1.3, ETC1 (individual, differential), Format RGB ETC2 (T, H, planar),
 * Format RGBA ETC2 (alpha). A block has few colours and eight alphas: they are made first, then looked up. 2 ns a
 * texel.
 */
#include "render/etc2_block.h"

#include <stdbool.h>
#include <string.h>

const uint8_t etc2_steps[8][2] = { { 2, 8 }, { 5, 17 }, { 9, 29 }, { 13, 42 }, { 18, 60 }, { 24, 80 }, { 33, 106 },
	{ 47, 183 } };
const uint8_t etc2_distances[8] = { 3, 6, 11, 16, 23, 32, 41, 64 };
const int16_t etc2_alpha_steps[16][8] = { { -3, -6, -9, -15, 2, 5, 8, 14 }, { -3, -7, -10, -13, 2, 6, 9, 12 },
	{ -2, -5, -8, -13, 1, 4, 7, 12 }, { -2, -4, -6, -13, 1, 3, 5, 12 }, { -3, -6, -8, -12, 2, 5, 7, 11 },
	{ -3, -7, -9, -11, 2, 6, 8, 10 }, { -4, -7, -8, -11, 3, 6, 7, 10 }, { -3, -5, -8, -11, 2, 4, 7, 10 },
	{ -2, -6, -8, -10, 1, 5, 7, 9 }, { -2, -5, -8, -10, 1, 4, 7, 9 }, { -2, -4, -8, -10, 1, 3, 7, 9 },
	{ -2, -5, -7, -10, 1, 4, 6, 9 }, { -3, -4, -7, -10, 2, 3, 6, 9 }, { -1, -2, -3, -10, 0, 1, 2, 9 },
	{ -4, -6, -8, -9, 3, 5, 7, 8 }, { -3, -5, -7, -9, 2, 4, 6, 8 } };

static int field(uint64_t bits, int high, int low)
{
	return (int)(bits >> low & ((1ull << (high - low + 1)) - 1));
}

static int signed3(uint64_t bits, int low)
{
	int value = field(bits, low + 2, low);
	return value > 3 ? value - 8 : value;
}

/* The colours and alphas of a block, as texels whose other bytes are 0. */
struct palette {
	uint32_t colours[2][4]; /* of the first and the second half of the texels */
	uint32_t alphas[8];
};

/* Four bytes as they lie in memory. */
static uint32_t pack(uint32_t red, uint32_t green, uint32_t blue, uint32_t alpha)
{
	bool little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
	return little ? red | green << 8 | blue << 16 | alpha << 24 : red << 24 | green << 16 | blue << 8 | alpha;
}

static uint32_t clamp(int value)
{
	return (uint32_t)etc2_clamp(value);
}

static void make_alphas(struct palette *palette, uint64_t bits)
{
	const int16_t *steps = etc2_alpha_steps[field(bits, 51, 48)];
	for (int k = 0; k < 8; k++)
		palette->alphas[k] = pack(0, 0, 0, clamp(field(bits, 63, 56) + field(bits, 55, 52) * steps[k]));
}

/* Indices lie column by column: the next ones are the lowest bits of the two planes, and the highest of alpha. The
 * halves are left and right, or, flipped, upper and lower. */
static void look_up(uint32_t texels[16], const struct palette *palette, uint32_t planes, uint64_t alphas, int flip)
{
	for (unsigned i = 0; i < 16; i++, planes >>= 1, alphas <<= 3) {
		unsigned x = i / 4, y = i % 4;
		texels[4 * y + x] =
			palette->colours[(flip ? y : x) / 2][(planes >> 15 & 2) | (planes & 1)] | palette->alphas[alphas >> 45 & 7];
	}
}

static int halves(struct palette *palette, uint64_t bits)
{
	int base[2][3], differential = field(bits, 33, 33);
	for (int c = 0; c < 3; c++) {
		int low = 56 - 8 * c;
		if (differential) {
			base[0][c] = etc2_widen(field(bits, low + 7, low + 3), 5);
			base[1][c] = etc2_widen(field(bits, low + 7, low + 3) + signed3(bits, low), 5);
		} else {
			base[0][c] = etc2_widen(field(bits, low + 7, low + 4), 4);
			base[1][c] = etc2_widen(field(bits, low + 3, low), 4);
		}
	}
	for (int half = 0; half < 2; half++) {
		const uint8_t *sizes = etc2_steps[half ? field(bits, 36, 34) : field(bits, 39, 37)];
		for (int k = 0; k < 4; k++) {
			int step = k & 2 ? -sizes[k & 1] : sizes[k & 1];
			palette->colours[half][k] =
				pack(clamp(base[half][0] + step), clamp(base[half][1] + step), clamp(base[half][2] + step), 0);
		}
	}
	return field(bits, 32, 32);
}

/* Colour a or b and a distance times steps[k] for each of the four. */
static void paints(struct palette *palette, const int *const from[4], int distance, const int8_t steps[4])
{
	for (int k = 0; k < 4; k++) {
		int add = distance * steps[k];
		palette->colours[0][k] = palette->colours[1][k] =
			pack(clamp(from[k][0] * 17 + add), clamp(from[k][1] * 17 + add), clamp(from[k][2] * 17 + add), 0);
	}
}

static void mode_t(struct palette *palette, uint64_t bits)
{
	const int a[3] = { field(bits, 60, 59) << 2 | field(bits, 57, 56), field(bits, 55, 52), field(bits, 51, 48) };
	const int b[3] = { field(bits, 47, 44), field(bits, 43, 40), field(bits, 39, 36) };
	int distance = etc2_distances[field(bits, 35, 34) << 1 | field(bits, 32, 32)];
	paints(palette, (const int *const[4]){ a, b, b, b }, distance, (const int8_t[4]){ 0, 1, 0, -1 });
}

static void mode_h(struct palette *palette, uint64_t bits)
{
	const int a[3] = { field(bits, 62, 59), field(bits, 58, 56) << 1 | field(bits, 52, 52),
		field(bits, 51, 51) << 3 | field(bits, 49, 47) };
	const int b[3] = { field(bits, 46, 43), field(bits, 42, 39), field(bits, 38, 35) };
	int later = (a[0] << 8 | a[1] << 4 | a[2]) >= (b[0] << 8 | b[1] << 4 | b[2]);
	int distance = etc2_distances[field(bits, 34, 34) << 2 | field(bits, 32, 32) << 1 | later];
	paints(palette, (const int *const[4]){ a, a, b, b }, distance, (const int8_t[4]){ 1, -1, 1, -1 });
}

static void planar(uint32_t texels[16], const struct palette *palette, uint64_t bits, uint64_t alphas)
{
	const int o[3] = { etc2_widen(field(bits, 62, 57), 6),
		etc2_widen(field(bits, 56, 56) << 6 | field(bits, 54, 49), 7),
		etc2_widen(field(bits, 48, 48) << 5 | field(bits, 44, 43) << 3 | field(bits, 41, 39), 6) };
	const int h[3] = { etc2_widen(field(bits, 38, 34) << 1 | field(bits, 32, 32), 6),
		etc2_widen(field(bits, 31, 25), 7), etc2_widen(field(bits, 24, 19), 6) };
	const int v[3] = { etc2_widen(field(bits, 18, 13), 6), etc2_widen(field(bits, 12, 6), 7),
		etc2_widen(field(bits, 5, 0), 6) };
	/* without a branch, so that a compiler does eight texels at a time */
	static const int16_t across[16] = { 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3 };
	static const int16_t down[16] = { 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3 };
	int16_t at[3][16];
	for (int c = 0; c < 3; c++) {
		const int16_t dx = (int16_t)(h[c] - o[c]), dy = (int16_t)(v[c] - o[c]), first = (int16_t)(4 * o[c] + 2);
		for (int i = 0; i < 16; i++) {
			int16_t value = (int16_t)((int16_t)(across[i] * dx + down[i] * dy + first) >> 2);
			value = value > 0 ? value : 0;
			at[c][i] = value < 255 ? value : 255;
		}
	}
	for (unsigned i = 0; i < 16; i++)
		texels[i] = pack((uint32_t)at[0][i], (uint32_t)at[1][i], (uint32_t)at[2][i], 0);
	for (unsigned i = 0; i < 16; i++, alphas <<= 3)
		texels[4 * (i % 4) + i / 4] |= palette->alphas[alphas >> 45 & 7];
}

static int overflows(uint64_t bits, int low)
{
	int sum = field(bits, low + 7, low + 3) + signed3(bits, low);
	return sum < 0 || sum > 31;
}

static void decode(uint32_t texels[16], uint64_t bits, uint64_t alphas)
{
	struct palette palette;
	int differential = field(bits, 33, 33), flip = 0;
	make_alphas(&palette, alphas);
	if (differential && overflows(bits, 56)) {
		mode_t(&palette, bits);
	} else if (differential && overflows(bits, 48)) {
		mode_h(&palette, bits);
	} else if (differential && overflows(bits, 40)) {
		planar(texels, &palette, bits, alphas);
		return;
	} else {
		flip = halves(&palette, bits);
	}
	look_up(texels, &palette, (uint32_t)bits, alphas, flip);
}

void etc2_decode_block(uint8_t texels[16][4], const uint8_t block[ETC2_BLOCK_BYTES])
{
	uint32_t words[16];
	decode(words, etc2_get_word(block + 8), etc2_get_word(block));
	memcpy(texels, words, sizeof(words));
}

void etc2_decode(uint8_t (*texels)[4], const uint8_t *blocks, uint32_t width, uint32_t height)
{
	for (uint32_t top = 0; top < height; top += 4) {
		uint32_t rows = height - top < 4 ? height - top : 4;
		for (uint32_t left = 0; left < width; left += 4, blocks += ETC2_BLOCK_BYTES) {
			uint32_t columns = width - left < 4 ? width - left : 4, block[16];
			decode(block, etc2_get_word(blocks + 8), etc2_get_word(blocks));
			for (uint32_t y = 0; y < rows; y++) {
				uint8_t *out = texels[(size_t)(top + y) * width + left];
				if (columns == 4) /* a length that the compiler knows: one store */
					memcpy(out, block + (size_t)4 * y, 16);
				else
					memcpy(out, block + (size_t)4 * y, (size_t)4 * columns);
			}
		}
	}
}
