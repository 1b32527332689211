/*
 * Individual and differential mode (KDFS 1.3, ETC1): two halves of 2 x 4 or 4 x 2 texels, each a base colour and a
 * table of four steps along grey. For each table the base starts at the mean and is moved by the mean of the steps
 * taken, as in Lloyd's k-means (1957). Clamping to 0..255 is left out of the search: it only ever makes errors smaller,
 * and the result is measured with it.
 */
#include "tools/bake/etc2_modes.h"

#define REFINEMENTS 1

struct half {
	int sums[8]; /* r + g + b of each texel */
	int sum[3];  /* of each channel */
	int squares; /* of all */
};

struct range {
	int low[3], high[3]; /* of the stored base */
};

struct fit {
	int base[3]; /* as stored */
	int table;
	int error; /* an upper bound */
};

static void gather(const uint8_t texels[16][4], int flip, int second, struct half *half)
{
	*half = (struct half){ 0 };
	int n = 0;
	for (int i = 0; i < 16; i++) {
		if ((flip ? i / 8 : i % 4 / 2) != second)
			continue;
		for (int c = 0; c < 3; c++) {
			half->sums[n] += texels[i][c];
			half->sum[c] += texels[i][c];
			half->squares += etc2_square(texels[i][c]);
		}
		n++;
	}
}

/* Error of a base and table; the sum of the steps taken in *shift. */
static int half_error(const struct half *half, const int base[3], int table, int *shift)
{
	int small = etc2_steps[table][0], large = etc2_steps[table][1], base_sum = base[0] + base[1] + base[2];
	int error = half->squares, moved = 0;
	for (int c = 0; c < 3; c++)
		error += 8 * base[c] * base[c] - 2 * base[c] * half->sum[c];
	for (int i = 0; i < 8; i++) {
		int off = half->sums[i] - base_sum, size = off < 0 ? -off : off;
		int step = 2 * size > 3 * (small + large) ? large : small;
		error += 3 * step * step - 2 * step * size;
		moved += off < 0 ? -step : step;
	}
	*shift = moved;
	return error;
}

/* The stored base nearest to eighths / 8. */
static int quantize(int eighths, int bits, int low, int high)
{
	int top = (1 << bits) - 1, value = (eighths < 0 ? 0 : eighths > 2040 ? 2040 : eighths) * top;
	int stored = (value + 1020) / 2040;
	return stored < low ? low : stored > high ? high : stored;
}

static void search_table(const struct half *half, int bits, const struct range *range, int table, struct fit *best)
{
	int shift = 0;
	for (int round = 0; round <= REFINEMENTS; round++) {
		int stored[3], base[3], last = shift;
		for (int c = 0; c < 3; c++) {
			stored[c] = quantize(half->sum[c] - shift, bits, range->low[c], range->high[c]);
			base[c] = etc2_widen(stored[c], bits);
		}
		int error = half_error(half, base, table, &shift);
		if (error < best->error)
			*best = (struct fit){ { stored[0], stored[1], stored[2] }, table, error };
		if (shift == last)
			break;
	}
}

static struct fit search(const struct half *half, int bits, const struct range *range)
{
	struct fit best = { .error = INT32_MAX };
	/* steps grow with the table: once two in a row are no better, all that follow are too long */
	for (int table = 0; table < 8 && (best.error == INT32_MAX || table - best.table <= 2); table++)
		search_table(half, bits, range, table, &best);
	return best;
}

/* Indices 0 to 3 are small, large, -small, -large. */
static void shades(const struct fit *fit, int bits, int out[4][3])
{
	for (int k = 0; k < 4; k++) {
		int step = etc2_steps[fit->table][k & 1];
		for (int c = 0; c < 3; c++)
			out[k][c] = etc2_clamp(etc2_widen(fit->base[c], bits) + (k & 2 ? -step : step));
	}
}

static uint64_t base_bits(const struct fit fits[2], int differential)
{
	uint64_t bits = 0;
	for (int c = 0; c < 3; c++) {
		int a = fits[0].base[c], b = fits[1].base[c];
		bits = bits << 8 | (unsigned)(differential ? a << 3 | ((b - a) & 7) : a << 4 | b);
	}
	return bits << 40 | (uint64_t)fits[0].table << 37 | (uint64_t)fits[1].table << 34 | (uint64_t)differential << 33;
}

static void offer(
	const uint8_t texels[16][4], int flip, int differential, const struct fit fits[2], struct etc2_choice *best)
{
	struct etc2_choice made = { .bits = base_bits(fits, differential) | (uint64_t)flip << 32 };
	int colours[2][4][3];
	for (int k = 0; k < 2; k++)
		shades(&fits[k], differential ? 5 : 4, colours[k]);
	for (unsigned i = 0; i < 16 && made.error < best->error; i++) {
		const int(*shade)[3] = (const int(*)[3])colours[flip ? i / 8 : i % 4 / 2];
		uint32_t least = UINT32_MAX;
		unsigned index = 0;
		for (unsigned k = 0; k < 4; k++) {
			uint32_t error =
				(uint32_t)(etc2_square(shade[k][0] - texels[i][0]) + etc2_square(shade[k][1] - texels[i][1]) +
						   etc2_square(shade[k][2] - texels[i][2]));
			index = error < least ? k : index;
			least = error < least ? error : least;
		}
		made.bits |= etc2_index_bits(i, index);
		made.error += least;
	}
	if (made.error < best->error)
		*best = made;
}

/* A half next to one that is settled: within -4 to 3 of it, or the other way round. */
static struct range near(const struct fit *settled, int below, int above)
{
	struct range range;
	for (int c = 0; c < 3; c++) {
		range.low[c] = settled->base[c] - below < 0 ? 0 : settled->base[c] - below;
		range.high[c] = settled->base[c] + above > 31 ? 31 : settled->base[c] + above;
	}
	return range;
}

static int is_within(const struct fit *fit, const struct range *range)
{
	for (int c = 0; c < 3; c++)
		if (fit->base[c] < range->low[c] || fit->base[c] > range->high[c])
			return 0;
	return 1;
}

/* Returns whether the halves were as free as they would be alone. */
static int try_differential(
	const uint8_t texels[16][4], int flip, const struct half halves[2], struct etc2_choice *best)
{
	const struct range any = { { 0 }, { 31, 31, 31 } };
	struct fit free[2] = { search(&halves[0], 5, &any), search(&halves[1], 5, &any) };
	struct range second = near(&free[0], 4, 3);
	if (is_within(&free[1], &second)) {
		offer(texels, flip, 1, free, best);
		return 1;
	}
	struct range first = near(&free[1], 3, 4);
	struct fit from_first[2] = { free[0], search(&halves[1], 5, &second) };
	struct fit from_second[2] = { search(&halves[0], 5, &first), free[1] };
	offer(texels, flip, 1, from_first, best);
	offer(texels, flip, 1, from_second, best);
	return 0;
}

void etc2_try_halves(const uint8_t texels[16][4], struct etc2_choice *best)
{
	const struct range any = { { 0 }, { 15, 15, 15 } };
	for (int flip = 0; flip < 2; flip++) {
		struct half halves[2];
		gather(texels, flip, 0, &halves[0]);
		gather(texels, flip, 1, &halves[1]);
		if (try_differential(texels, flip, halves, best))
			continue;
		struct fit alone[2] = { search(&halves[0], 4, &any), search(&halves[1], 4, &any) };
		offer(texels, flip, 0, alone, best);
	}
}

/* The stored value whose clamped sum with the step comes nearest: the last below the wish or the one after. */
static int nearest(int wanted, int step, int bits)
{
	int top = (1 << bits) - 1, below = etc2_clamp(wanted - step) * top / 255;
	int first = below > 0 ? below - 1 : 0, best = first;
	for (int stored = first; stored <= below + 1 && stored <= top; stored++) {
		int error = etc2_square(etc2_clamp(etc2_widen(stored, bits) + step) - wanted);
		if (error < etc2_square(etc2_clamp(etc2_widen(best, bits) + step) - wanted))
			best = stored;
	}
	return best;
}

void etc2_try_solid(const uint8_t texels[16][4], struct etc2_choice *best)
{
	for (int try = 0; try < 64 && best->error; try++) {
		int differential = !(try & 1), bits = differential ? 5 : 4, size = etc2_steps[try / 8][try >> 1 & 1];
		struct fit fit = { .table = try / 8 };
		for (int c = 0; c < 3; c++)
			fit.base[c] = nearest(texels[0][c], try & 4 ? -size : size, bits);
		offer(texels, 0, differential, (struct fit[2]){ fit, fit }, best);
	}
	etc2_try_planar(texels, best);
}
