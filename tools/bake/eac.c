/*
 * A block has a base, a multiplier and one of sixteen tables of eight steps; multiplier 0 makes the steps eight times
 * as fine as multiplier 1. Each table is stretched over the block's range of values, a little more and a little less,
 * anchored at its lower end, its upper end and between; the first that is good enough, or the smallest error, wins.
 */
#include "tools/bake/eac.h"

#include "tools/bake/etc2_modes.h"

/* Mean error of 2 of 2047: a quarter of an 8-bit step. */
#define GOOD_ERROR (16u * 2u * 2u)
/* With multiplier 0: steps from -3 to 2, but for those of -4 and 3. */
#define TABLE_OF_SMALL 13u
#define TABLE_OF_ODD 14u

struct choice {
	uint32_t error;
	int base, multiplier;
	unsigned table;
	int16_t nearest[16]; /* distance * 8 + index */
};

static int clamp_to(int value, int most)
{
	return value < 0 ? 0 : value > most ? most : value;
}

static int value_of(int base, int multiplier, int step)
{
	return clamp_to(base * 8 + 4 + step * (multiplier ? multiplier * 8 : 1), EAC_MAX);
}

static void put_block(uint8_t out[8], const struct choice *made)
{
	uint64_t bits = (uint64_t)made->base << 56 | (uint64_t)made->multiplier << 52 | (uint64_t)made->table << 48;
	for (unsigned i = 0; i < 16; i++)
		bits |= (uint64_t)(made->nearest[i] & 7) << (45 - 3 * etc2_place(i));
	etc2_put_word(out, bits);
}

/* All texels at once, index by index: this is where the time goes, and so it is eight lanes wide. */
static void offer(const int16_t wanted[16], int base, int multiplier, unsigned table, struct choice *best)
{
	struct choice made = { .base = base, .multiplier = multiplier, .table = table };
	for (int i = 0; i < 16; i++)
		made.nearest[i] = INT16_MAX;
	for (int k = 0; k < 8; k++) {
		int16_t value = (int16_t)value_of(base, multiplier, etc2_alpha_steps[table][k]);
		for (int i = 0; i < 16; i++) {
			int16_t away = (int16_t)(value - wanted[i]);
			away = (int16_t)((away < 0 ? -away : away) * 8 + k);
			made.nearest[i] = away < made.nearest[i] ? away : made.nearest[i];
		}
	}
	for (int i = 0; i < 16; i++)
		made.error += (uint32_t)((made.nearest[i] >> 3) * (made.nearest[i] >> 3));
	if (made.error < best->error)
		*best = made;
}

/* Any value is the sum of a base and of one step of -4 to 3. */
static void offer_uniform(const int16_t wanted[16], struct choice *best)
{
	int step = (wanted[0] & 7) - 4;
	offer(wanted, wanted[0] >> 3, 0, step == -4 || step == 3 ? TABLE_OF_ODD : TABLE_OF_SMALL, best);
}

static void offer_table(const int16_t wanted[16], int low, int high, unsigned table, struct choice *best)
{
	int down = etc2_alpha_steps[table][3], up = etc2_alpha_steps[table][7];
	int stretch = (high - low) / (8 * (up - down));
	for (int multiplier = stretch; multiplier <= stretch + 1 && multiplier < 16; multiplier++) {
		int unit = multiplier ? multiplier * 8 : 1;
		int first = clamp_to((low - unit * down) / 8, 255), last = clamp_to((high - unit * up) / 8, 255);
		int middle = (first + last) / 2;
		offer(wanted, middle, multiplier, table, best);
		if (first != middle)
			offer(wanted, first, multiplier, table, best);
		if (last != middle && last != first)
			offer(wanted, last, multiplier, table, best);
	}
}

void eac_encode_block(uint8_t block[8], const uint8_t texels[16])
{
	int16_t wanted[16];
	int low = EAC_MAX, high = 0;
	for (int i = 0; i < 16; i++) {
		wanted[i] = (int16_t)((texels[i] * EAC_MAX + 127) / 255);
		low = wanted[i] < low ? wanted[i] : low;
		high = wanted[i] > high ? wanted[i] : high;
	}
	struct choice best = { .error = UINT32_MAX };
	if (low == high)
		offer_uniform(wanted, &best);
	for (unsigned table = 0; table < 16 && best.error > GOOD_ERROR; table++)
		offer_table(wanted, low, high, table, &best);
	put_block(block, &best);
}

void eac_decode_block(uint16_t texels[16], const uint8_t block[8])
{
	uint64_t bits = etc2_get_word(block);
	int base = (int)(bits >> 56), multiplier = (int)(bits >> 52 & 15);
	for (unsigned i = 0; i < 16; i++) {
		unsigned index = (unsigned)(bits >> (45 - 3 * etc2_place(i)) & 7);
		texels[i] = (uint16_t)value_of(base, multiplier, etc2_alpha_steps[bits >> 48 & 15][index]);
	}
}

size_t eac_rg_bytes(uint32_t width, uint32_t height)
{
	return ((size_t)width + 3) / 4 * (((size_t)height + 3) / 4) * EAC_RG_BLOCK_BYTES;
}

void eac_rg_encode(
	uint8_t *blocks, const uint8_t (*texels)[2], uint32_t width, uint32_t height, uint32_t first, uint32_t end)
{
	blocks += (size_t)first * ((width + 3) / 4) * EAC_RG_BLOCK_BYTES;
	for (uint32_t top = first * 4; top < end * 4; top += 4) {
		for (uint32_t left = 0; left < width; left += 4, blocks += EAC_RG_BLOCK_BYTES) {
			uint8_t channels[2][16];
			for (uint32_t i = 0; i < 16; i++) {
				uint32_t x = left + i % 4 < width ? left + i % 4 : width - 1;
				uint32_t y = top + i / 4 < height ? top + i / 4 : height - 1;
				for (int c = 0; c < 2; c++)
					channels[c][i] = texels[(size_t)y * width + x][c];
			}
			for (int c = 0; c < 2; c++)
				eac_encode_block(blocks + 8 * c, channels[c]);
		}
	}
}

void eac_rg_decode(uint8_t (*texels)[2], const uint8_t *blocks, uint32_t width, uint32_t height)
{
	for (uint32_t top = 0; top < height; top += 4) {
		for (uint32_t left = 0; left < width; left += 4, blocks += EAC_RG_BLOCK_BYTES) {
			uint16_t channels[2][16];
			for (int c = 0; c < 2; c++)
				eac_decode_block(channels[c], blocks + 8 * c);
			for (uint32_t i = 0; i < 16; i++)
				for (int c = 0; c < 2 && left + i % 4 < width && top + i / 4 < height; c++)
					texels[(size_t)(top + i / 4) * width + left + i % 4][c] =
						(uint8_t)((channels[c][i] * 255 + EAC_MAX / 2) / EAC_MAX);
		}
	}
}
