/*
 * EAC alpha (KDFS 1.3, Format RGBA ETC2): a base, a multiplier and one of sixteen tables of eight steps. Each table is
 * stretched over the block's range of values, anchored at its lower end, its upper end and between.
 */
#include "tools/bake/etc2_modes.h"

/* Table and index with a step of 0: one alpha for all texels, exact. */
#define TABLE_OF_ZERO 13u
#define INDEX_OF_ZERO 4u

static uint64_t head(int base, int multiplier, unsigned table)
{
	return (uint64_t)base << 56 | (uint64_t)multiplier << 52 | (uint64_t)table << 48;
}

static void offer(const uint8_t texels[16][4], int base, int multiplier, unsigned table, struct etc2_choice *best)
{
	struct etc2_choice made = { .bits = head(base, multiplier, table) };
	int values[8];
	for (int k = 0; k < 8; k++)
		values[k] = etc2_clamp(base + multiplier * etc2_alpha_steps[table][k]);
	for (unsigned i = 0; i < 16 && made.error < best->error; i++) {
		uint32_t least = UINT32_MAX;
		unsigned index = 0;
		for (unsigned k = 0; k < 8; k++) {
			uint32_t error = (uint32_t)etc2_square(values[k] - texels[i][3]);
			index = error < least ? k : index;
			least = error < least ? error : least;
		}
		made.bits |= (uint64_t)index << (45 - 3 * etc2_place(i));
		made.error += least;
	}
	if (made.error < best->error)
		*best = made;
}

static uint64_t uniform(int alpha)
{
	uint64_t bits = head(alpha, 1, TABLE_OF_ZERO);
	for (int i = 0; i < 16; i++)
		bits |= (uint64_t)INDEX_OF_ZERO << (3 * i);
	return bits;
}

uint64_t etc2_alpha_block(const uint8_t texels[16][4])
{
	int low = 255, high = 0;
	for (int i = 0; i < 16; i++) {
		low = texels[i][3] < low ? texels[i][3] : low;
		high = texels[i][3] > high ? texels[i][3] : high;
	}
	if (low == high)
		return uniform(low);
	struct etc2_choice best = { .error = UINT32_MAX };
	for (unsigned table = 0; table < 16 && best.error; table++) {
		int down = etc2_alpha_steps[table][3], up = etc2_alpha_steps[table][7];
		int stretch = (high - low + up - down - 1) / (up - down);
		for (int multiplier = stretch > 1 ? stretch - 1 : 1; multiplier <= stretch + 1 && multiplier < 16;
			 multiplier++) {
			int first = etc2_clamp(low - multiplier * down), last = etc2_clamp(high - multiplier * up);
			offer(texels, first, multiplier, table, &best);
			offer(texels, last, multiplier, table, &best);
			offer(texels, (first + last) / 2, multiplier, table, &best);
		}
	}
	return best.bits;
}
