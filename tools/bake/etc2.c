/* Pictures to blocks, and which mode a block takes: all are tried and the smallest error wins. About 3 us a block. */
#include "tools/bake/etc2.h"

#include <string.h>

#include "tools/bake/etc2_modes.h"

/* Mean error of 2 steps a channel: below it the T and H modes are not worth their time. */
#define GOOD_ERROR (16u * 3u * 4u)

uint32_t etc2_index_texels(const uint8_t texels[16][4], const int colours[4][3], uint64_t *bits)
{
	uint32_t sum = 0;
	for (unsigned i = 0; i < 16; i++) {
		uint32_t best = UINT32_MAX;
		unsigned index = 0;
		for (unsigned k = 0; k < 4; k++) {
			uint32_t error =
				(uint32_t)(etc2_square(colours[k][0] - texels[i][0]) + etc2_square(colours[k][1] - texels[i][1]) +
						   etc2_square(colours[k][2] - texels[i][2]));
			index = error < best ? k : index;
			best = error < best ? error : best;
		}
		*bits |= etc2_index_bits(i, index);
		sum += best;
	}
	return sum;
}

static uint64_t colour_block(const uint8_t texels[16][4])
{
	struct etc2_choice best = { .error = UINT32_MAX };
	unsigned same = 1;
	while (same < 16 && !memcmp(texels[same], texels[0], 3))
		same++;
	if (same == 16) {
		etc2_try_solid(texels, &best);
		return best.bits;
	}
	etc2_try_halves(texels, &best);
	etc2_try_planar(texels, &best);
	if (best.error > GOOD_ERROR)
		etc2_try_paints(texels, &best);
	return best.bits;
}

void etc2_encode_block(uint8_t block[ETC2_BLOCK_BYTES], const uint8_t texels[16][4])
{
	etc2_put_word(block, etc2_alpha_block(texels));
	etc2_put_word(block + 8, colour_block(texels));
}

size_t etc2_bytes(uint32_t width, uint32_t height)
{
	return ((size_t)width + 3) / 4 * (((size_t)height + 3) / 4) * ETC2_BLOCK_BYTES;
}

void etc2_encode(uint8_t *blocks, const uint8_t (*texels)[4], uint32_t width, uint32_t height)
{
	for (uint32_t top = 0; top < height; top += 4) {
		for (uint32_t left = 0; left < width; left += 4, blocks += ETC2_BLOCK_BYTES) {
			uint8_t block[16][4];
			for (uint32_t i = 0; i < 16; i++) {
				uint32_t x = left + i % 4 < width ? left + i % 4 : width - 1;
				uint32_t y = top + i / 4 < height ? top + i / 4 : height - 1;
				memcpy(block[i], texels[(size_t)y * width + x], 4);
			}
			etc2_encode_block(blocks, (const uint8_t(*)[4])block);
		}
	}
}
