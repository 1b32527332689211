/* One block back to texels, all modes: KDFS 1.3, ETC1 (individual, differential), Format RGB ETC2 (T, H, planar),
 * Format RGBA ETC2 (alpha). */
#include "tools/bake/etc2.h"
#include "tools/bake/etc2_modes.h"

static int field(uint64_t bits, int high, int low)
{
	return (int)(bits >> low & ((1ull << (high - low + 1)) - 1));
}

static int signed3(uint64_t bits, int low)
{
	int value = field(bits, low + 2, low);
	return value > 3 ? value - 8 : value;
}

static unsigned index_of(uint64_t bits, unsigned i)
{
	return (unsigned)(bits >> (16 + etc2_place(i)) & 1) << 1 | (unsigned)(bits >> etc2_place(i) & 1);
}

static void decode_halves(uint8_t texels[16][4], uint64_t bits)
{
	int base[2][3], differential = field(bits, 33, 33), flip = field(bits, 32, 32);
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
	const int tables[2] = { field(bits, 39, 37), field(bits, 36, 34) };
	for (unsigned i = 0; i < 16; i++) {
		unsigned half = flip ? i / 8 : i % 4 / 2, index = index_of(bits, i);
		int step = etc2_steps[tables[half]][index & 1];
		for (int c = 0; c < 3; c++)
			texels[i][c] = (uint8_t)etc2_clamp(base[half][c] + (index & 2 ? -step : step));
	}
}

static void paint(uint8_t texels[16][4], uint64_t bits, const int colours[4][3])
{
	for (unsigned i = 0; i < 16; i++)
		for (int c = 0; c < 3; c++)
			texels[i][c] = (uint8_t)etc2_clamp(colours[index_of(bits, i)][c]);
}

static void decode_t(uint8_t texels[16][4], uint64_t bits)
{
	const int a[3] = { field(bits, 60, 59) << 2 | field(bits, 57, 56), field(bits, 55, 52), field(bits, 51, 48) };
	const int b[3] = { field(bits, 47, 44), field(bits, 43, 40), field(bits, 39, 36) };
	int d = etc2_distances[field(bits, 35, 34) << 1 | field(bits, 32, 32)], colours[4][3];
	for (int c = 0; c < 3; c++) {
		colours[0][c] = a[c] * 17;
		colours[1][c] = b[c] * 17 + d;
		colours[2][c] = b[c] * 17;
		colours[3][c] = b[c] * 17 - d;
	}
	paint(texels, bits, (const int(*)[3])colours);
}

static void decode_h(uint8_t texels[16][4], uint64_t bits)
{
	const int a[3] = { field(bits, 62, 59), field(bits, 58, 56) << 1 | field(bits, 52, 52),
		field(bits, 51, 51) << 3 | field(bits, 49, 47) };
	const int b[3] = { field(bits, 46, 43), field(bits, 42, 39), field(bits, 38, 35) };
	int later = (a[0] << 8 | a[1] << 4 | a[2]) >= (b[0] << 8 | b[1] << 4 | b[2]);
	int d = etc2_distances[field(bits, 34, 34) << 2 | field(bits, 32, 32) << 1 | later], colours[4][3];
	for (int c = 0; c < 3; c++) {
		colours[0][c] = a[c] * 17 + d;
		colours[1][c] = a[c] * 17 - d;
		colours[2][c] = b[c] * 17 + d;
		colours[3][c] = b[c] * 17 - d;
	}
	paint(texels, bits, (const int(*)[3])colours);
}

static void decode_planar(uint8_t texels[16][4], uint64_t bits)
{
	const int o[3] = { etc2_widen(field(bits, 62, 57), 6),
		etc2_widen(field(bits, 56, 56) << 6 | field(bits, 54, 49), 7),
		etc2_widen(field(bits, 48, 48) << 5 | field(bits, 44, 43) << 3 | field(bits, 41, 39), 6) };
	const int h[3] = { etc2_widen(field(bits, 38, 34) << 1 | field(bits, 32, 32), 6),
		etc2_widen(field(bits, 31, 25), 7), etc2_widen(field(bits, 24, 19), 6) };
	const int v[3] = { etc2_widen(field(bits, 18, 13), 6), etc2_widen(field(bits, 12, 6), 7),
		etc2_widen(field(bits, 5, 0), 6) };
	for (int i = 0; i < 16; i++)
		for (int c = 0; c < 3; c++)
			texels[i][c] = (uint8_t)etc2_clamp((i % 4 * (h[c] - o[c]) + i / 4 * (v[c] - o[c]) + 4 * o[c] + 2) >> 2);
}

static int overflows(uint64_t bits, int low)
{
	int sum = field(bits, low + 7, low + 3) + signed3(bits, low);
	return sum < 0 || sum > 31;
}

static void decode_colour(uint8_t texels[16][4], uint64_t bits)
{
	int differential = field(bits, 33, 33);
	if (differential && overflows(bits, 56))
		decode_t(texels, bits);
	else if (differential && overflows(bits, 48))
		decode_h(texels, bits);
	else if (differential && overflows(bits, 40))
		decode_planar(texels, bits);
	else
		decode_halves(texels, bits);
}

static void decode_alpha(uint8_t texels[16][4], uint64_t bits)
{
	for (unsigned i = 0; i < 16; i++) {
		int low = (int)(45 - 3 * etc2_place(i));
		int step = etc2_alpha_steps[field(bits, 51, 48)][field(bits, low + 2, low)];
		texels[i][3] = (uint8_t)etc2_clamp(field(bits, 63, 56) + field(bits, 55, 52) * step);
	}
}

void etc2_decode_block(uint8_t texels[16][4], const uint8_t block[ETC2_BLOCK_BYTES])
{
	decode_alpha(texels, etc2_get_word(block));
	decode_colour(texels, etc2_get_word(block + 8));
}
