#include "tools/impostor/page_blocks.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "tools/bake/etc2.h"
#include "tools/bake/etc2_modes.h"

#define RECENT 64 /* colour words that are looked back at */

/* What a colour word takes of the packed bytes: its own, with one half repeated, repeated as a whole. */
#define OWN_BYTES 7.5f
#define HALF_BYTES 5.5f
#define REPEATED_BYTES 2.5f

/* What a byte is worth, of squared steps summed over a block: that, and a share of the error that the block has anyway,
 * since what is rough hides more. */
#define WORTH 100.0f
#define WORTH_SHARE 0.6f

#define HIDDEN_WEIGHT 0.25f /* of a texel that is cut away: filters reach it */

/* Alpha of a block that shows one level or nothing, after KDFS 1.3, "Format RGBA ETC2": of the first table the steps
 * -15 and 14, nine times, lie 261 apart: whatever the level, nothing comes out as 0, and the outline is the same bytes.
 */
#define OUTLINE_HEAD ((uint64_t)9 << 52) /* multiplier 9, table 0 */
#define OUTLINE_NOTHING 3u               /* the index of -15 */
#define OUTLINE_LEVEL 7u                 /* of 14 */
#define OUTLINE_RISE 126                 /* 9 * 14 */

#define HIGH_HALF 0xFFFFFFFF00000000u
#define LOW_HALF 0xFFFFFFFFu

/* The eight bytes of a block that are its colour, and what comes of them. */
struct colour_word {
	uint64_t bits;
	uint8_t shown[16][4];
	uint8_t palette[4][16][4]; /* by index and texel: what its high half shows with any indices */
	uint8_t index[16];         /* of its low half */
	bool halves;               /* its low half are indices: not so in the planar mode */
};

struct page_coder {
	struct colour_word recent[RECENT];
	unsigned count;
	const uint8_t (*texels)[4]; /* of the block at hand */
	float weight[16];
};

struct choice {
	uint64_t bits;
	float loss;
};

static void show(uint64_t bits, uint8_t texels[16][4])
{
	uint8_t block[ETC2_BLOCK_BYTES] = { 0 };
	etc2_put_word(block + 8, bits);
	etc2_decode_block(texels, block);
}

static struct colour_word word_of(uint64_t bits)
{
	struct colour_word word = { .bits = bits, .halves = true };
	show(bits, word.shown);
	for (unsigned index = 0; index < 4; index++) {
		uint64_t all = 0;
		for (unsigned i = 0; i < 16; i++)
			all |= etc2_index_bits(i, index);
		show((bits & HIGH_HALF) | all, word.palette[index]);
	}
	for (unsigned i = 0; i < 16; i++) {
		for (unsigned index = 0; index < 4; index++)
			if ((bits & etc2_index_bits(i, 3)) == etc2_index_bits(i, index))
				word.index[i] = (uint8_t)index;
		word.halves &= !memcmp(word.shown[i], word.palette[word.index[i]][i], 3);
	}
	return word;
}

static float texel_error(const struct page_coder *coder, unsigned i, const uint8_t colour[4])
{
	const uint8_t *texel = coder->texels[i];
	int error =
		etc2_square(colour[0] - texel[0]) + etc2_square(colour[1] - texel[1]) + etc2_square(colour[2] - texel[2]);
	return coder->weight[i] * (float)error;
}

/* These give up, with more than `limit`, as soon as that is certain. */
static float shown_error(const struct page_coder *coder, const struct colour_word *word, float limit)
{
	float sum = 0;
	for (unsigned i = 0; i < 16 && sum <= limit; i++)
		sum += texel_error(coder, i, word->shown[i]);
	return sum;
}

/* The word's colours, with the indices that fit best. */
static float palette_error(
	const struct page_coder *coder, const struct colour_word *word, float limit, uint64_t *indices)
{
	float sum = 0;
	*indices = 0;
	for (unsigned i = 0; i < 16 && sum <= limit; i++) {
		float least = INFINITY;
		unsigned best = 0;
		for (unsigned index = 0; index < 4; index++) {
			float error = texel_error(coder, i, word->palette[index][i]);
			best = error < least ? index : best;
			least = error < least ? error : least;
		}
		*indices |= etc2_index_bits(i, best);
		sum += least;
	}
	return sum;
}

/* The colours of `word` with the indices of `other`. */
static float index_error(
	const struct page_coder *coder, const struct colour_word *word, const struct colour_word *other, float limit)
{
	float sum = 0;
	for (unsigned i = 0; i < 16 && sum <= limit; i++)
		sum += texel_error(coder, i, word->palette[other->index[i]][i]);
	return sum;
}

static void consider(struct choice *best, uint64_t bits, float loss)
{
	if (loss < best->loss)
		*best = (struct choice){ bits, loss };
}

static uint64_t choose(const struct page_coder *coder, const struct colour_word *own)
{
	float error = shown_error(coder, own, INFINITY), worth = WORTH + WORTH_SHARE * error;
	struct choice best = { own->bits, error + OWN_BYTES * worth };
	for (unsigned n = 0; n < coder->count && n < RECENT; n++) {
		const struct colour_word *recent = &coder->recent[n];
		float bytes = REPEATED_BYTES * worth;
		consider(&best, recent->bits, bytes + shown_error(coder, recent, best.loss - bytes));
		if (!recent->halves)
			continue;
		uint64_t indices;
		bytes = HALF_BYTES * worth;
		float fitted = palette_error(coder, recent, best.loss - bytes, &indices);
		consider(&best, (recent->bits & HIGH_HALF) | indices, bytes + fitted);
		if (own->halves)
			consider(&best, (own->bits & HIGH_HALF) | (recent->bits & LOW_HALF),
				bytes + index_error(coder, own, recent, best.loss - bytes));
	}
	return best.bits;
}

static void remember(struct page_coder *coder, const struct colour_word *word)
{
	for (unsigned n = 0; n < coder->count && n < RECENT; n++)
		if (coder->recent[n].bits == word->bits)
			return;
	coder->recent[coder->count++ % RECENT] = *word;
}

/* Exact, or false: of more than one level, or of a low one. */
static bool outline_word(const uint8_t texels[16][4], uint64_t *bits)
{
	unsigned level = 0;
	for (unsigned i = 0; i < 16; i++)
		level = texels[i][3] > level ? texels[i][3] : level;
	if (level < PKG_PAGE_SOLID)
		return false;
	*bits = (uint64_t)(level - OUTLINE_RISE) << 56 | OUTLINE_HEAD;
	for (unsigned i = 0; i < 16; i++) {
		if (texels[i][3] && texels[i][3] != level)
			return false;
		*bits |= (uint64_t)(texels[i][3] ? OUTLINE_LEVEL : OUTLINE_NOTHING) << (45 - 3 * etc2_place(i));
	}
	return true;
}

static void code_block(struct page_coder *coder, const uint8_t texels[16][4], uint8_t block[ETC2_BLOCK_BYTES])
{
	uint64_t outline;
	etc2_encode_block(block, texels);
	if (outline_word(texels, &outline))
		etc2_put_word(block, outline);
	uint64_t bits = etc2_get_word(block + 8);
	coder->texels = texels;
	for (unsigned i = 0; i < 16; i++)
		coder->weight[i] = texels[i][3] ? 1.0f : HIDDEN_WEIGHT;
	struct colour_word word = word_of(bits);
	uint64_t chosen = choose(coder, &word);
	if (chosen != bits)
		word = word_of(chosen);
	remember(coder, &word);
	etc2_put_word(block + 8, chosen);
}

void page_blocks(const uint8_t *page, uint8_t blocks[PKG_PAGE_BYTES])
{
	static const uint8_t nothing[16][4];
	uint8_t texels[16][4], empty[ETC2_BLOCK_BYTES];
	struct page_coder coder = { 0 };
	etc2_encode_block(empty, nothing);
	for (uint32_t top = 0; top < PKG_PAGE_PX; top += 4) {
		for (uint32_t left = 0; left < PKG_PAGE_PX; left += 4, blocks += ETC2_BLOCK_BYTES) {
			for (uint32_t row = 0; row < 4; row++)
				memcpy(texels[4 * row], page + 4 * ((size_t)(top + row) * PKG_PAGE_PX + left), 16);
			if (memcmp(texels, nothing, sizeof(texels)) == 0)
				memcpy(blocks, empty, sizeof(empty));
			else
				code_block(&coder, (const uint8_t(*)[4])texels, blocks);
		}
	}
}
