/*
 * T and H mode (KDFS 1.3, Format RGB ETC2): two colours of 4 bits a channel that need not differ along grey, and a
 * distance. T: one colour alone, the other also lighter and darker by the distance. H: both lighter and darker. For
 * blocks on the edge between two things. The colours are the means of two clusters, moved once by the steps taken.
 */
#include <string.h>

#include "tools/bake/etc2_modes.h"

#define CLUSTER_ROUNDS 3

static int distance_between(const int a[3], const uint8_t b[4])
{
	return etc2_square(a[0] - b[0]) + etc2_square(a[1] - b[1]) + etc2_square(a[2] - b[2]);
}

/* The texel farthest from a colour. */
static void farthest(const uint8_t texels[16][4], const int from[3], int out[3])
{
	int most = -1, found = 0;
	for (int i = 0; i < 16; i++) {
		int distance = distance_between(from, texels[i]);
		if (distance > most) {
			most = distance;
			found = i;
		}
	}
	for (int c = 0; c < 3; c++)
		out[c] = texels[found][c];
}

/* k-means of two; starts from texels at opposite ends. */
static void find_clusters(const uint8_t texels[16][4], int means[2][3])
{
	int middle[3] = { 8, 8, 8 };
	for (int i = 0; i < 16; i++)
		for (int c = 0; c < 3; c++)
			middle[c] += texels[i][c];
	for (int c = 0; c < 3; c++)
		middle[c] /= 16;
	farthest(texels, middle, means[0]);
	farthest(texels, means[0], means[1]);
	for (int round = 0; round < CLUSTER_ROUNDS; round++) {
		int sum[2][3] = { 0 }, count[2] = { 0 };
		for (int i = 0; i < 16; i++) {
			int k = distance_between(means[1], texels[i]) < distance_between(means[0], texels[i]);
			count[k]++;
			for (int c = 0; c < 3; c++)
				sum[k][c] += texels[i][c];
		}
		for (int k = 0; k < 2; k++)
			for (int c = 0; c < 3 && count[k]; c++)
				means[k][c] = (sum[k][c] + count[k] / 2) / count[k];
	}
}

static uint64_t pack_t(const int (*q)[3], unsigned distance)
{
	return etc2_overflow((unsigned)q[0][0] >> 2, (unsigned)q[0][0] & 3, 56) | (uint64_t)q[0][1] << 52 |
		   (uint64_t)q[0][2] << 48 | (uint64_t)q[1][0] << 44 | (uint64_t)q[1][1] << 40 | (uint64_t)q[1][2] << 36 |
		   (uint64_t)(distance >> 1) << 34 | 1ull << 33 | (uint64_t)(distance & 1) << 32;
}

/* The distance's lowest bit is the order of the two colours, which pick_h() has seen to. */
static uint64_t pack_h(const int (*q)[3], unsigned distance)
{
	unsigned g = (unsigned)q[0][1], b = (unsigned)q[0][2];
	return (uint64_t)(g >> 3) << 63 | (uint64_t)q[0][0] << 59 | (uint64_t)(g >> 1) << 56 |
		   etc2_overflow((g & 1) << 1 | b >> 3, b >> 1 & 3, 48) | (uint64_t)(b & 1) << 47 | (uint64_t)q[1][0] << 43 |
		   (uint64_t)q[1][1] << 39 | (uint64_t)q[1][2] << 35 | (uint64_t)(distance >> 2) << 34 | 1ull << 33 |
		   (uint64_t)(distance >> 1 & 1) << 32;
}

/* Colour and step of each index, by mode: T, H. */
static const struct {
	int colour, step;
} paints[2][4] = { { { 0, 0 }, { 1, 1 }, { 1, 0 }, { 1, -1 } }, { { 0, 1 }, { 0, -1 }, { 1, 1 }, { 1, -1 } } };

static void mix(const int (*q)[3], int mode, int distance, int out[4][3])
{
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++)
			out[k][c] = etc2_clamp(q[paints[mode][k].colour][c] * 17 + paints[mode][k].step * distance);
}

static int order_of(const int q[3])
{
	return q[0] << 8 | q[1] << 4 | q[2];
}

/* Returns the error, UINT32_MAX for what cannot be stored. */
static uint32_t offer(
	const uint8_t texels[16][4], const int (*q)[3], int mode, unsigned distance, struct etc2_choice *best)
{
	int ordered[2][3], colours[4][3];
	memcpy(ordered, q, sizeof(ordered));
	if (mode == 1 && (order_of(q[0]) >= order_of(q[1])) != (distance & 1)) {
		if (order_of(q[0]) == order_of(q[1]))
			return UINT32_MAX;
		memcpy(ordered[0], q[1], sizeof(ordered[0]));
		memcpy(ordered[1], q[0], sizeof(ordered[1]));
	}
	const int(*stored)[3] = (const int(*)[3])ordered;
	struct etc2_choice made = { .bits = mode ? pack_h(stored, distance) : pack_t(stored, distance) };
	mix(stored, mode, etc2_distances[distance], colours);
	made.error = etc2_index_texels(texels, (const int(*)[3])colours, &made.bits);
	if (made.error < best->error)
		*best = made;
	return made.error;
}

/* Where the colours should lie, given what each texel took. */
static void move_colours(const uint8_t texels[16][4], int mode, int distance, int q[2][3])
{
	int colours[4][3], sum[2][3] = { 0 }, count[2] = { 0 };
	mix((const int(*)[3])q, mode, distance, colours);
	for (int i = 0; i < 16; i++) {
		int k = 0;
		for (int other = 1; other < 4; other++)
			if (distance_between(colours[other], texels[i]) < distance_between(colours[k], texels[i]))
				k = other;
		count[paints[mode][k].colour]++;
		for (int c = 0; c < 3; c++)
			sum[paints[mode][k].colour][c] += texels[i][c] - paints[mode][k].step * distance;
	}
	for (int k = 0; k < 2; k++)
		for (int c = 0; c < 3 && count[k]; c++)
			q[k][c] = (etc2_clamp(sum[k][c] / count[k]) * 15 + 127) / 255;
}

void etc2_try_paints(const uint8_t texels[16][4], struct etc2_choice *best)
{
	int means[2][3];
	find_clusters(texels, means);
	/* T with either colour alone, H; the distance that serves best is tried again with the colours moved */
	for (int try = 0; try < 3; try++) {
		int mode = try == 2, q[2][3];
		for (int k = 0; k < 2; k++)
			for (int c = 0; c < 3; c++)
				q[k][c] = (means[try == 1 ? 1 - k : k][c] * 15 + 127) / 255;
		uint32_t least = UINT32_MAX;
		unsigned chosen = 0;
		for (unsigned distance = 0; distance < 8; distance++) {
			uint32_t error = offer(texels, (const int(*)[3])q, mode, distance, best);
			chosen = error < least ? distance : chosen;
			least = error < least ? error : least;
		}
		move_colours(texels, mode, etc2_distances[chosen], q);
		offer(texels, (const int(*)[3])q, mode, chosen, best);
	}
}
