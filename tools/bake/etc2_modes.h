/* The ways to store a block, shared by the encoder's files. Sections named are of the Khronos Data Format Specification
 * 1.3. Bits are counted as there: bit 63 is the first of the block's eight bytes. */
#ifndef BLVD_TOOLS_BAKE_ETC2_MODES_H
#define BLVD_TOOLS_BAKE_ETC2_MODES_H

#include <stdint.h>

#include "render/etc2_block.h"

/* The best block found so far. */
struct etc2_choice {
	uint64_t bits;
	uint32_t error; /* sum of squares over 16 texels and 3 channels, of what a decoder yields */
};

/* Each replaces *best if it finds a block with a smaller error. */
void etc2_try_solid(const uint8_t texels[16][4], struct etc2_choice *best);  /* all texels are as the first */
void etc2_try_halves(const uint8_t texels[16][4], struct etc2_choice *best); /* individual and differential */
void etc2_try_planar(const uint8_t texels[16][4], struct etc2_choice *best);
void etc2_try_paints(const uint8_t texels[16][4], struct etc2_choice *best); /* T and H */
uint64_t etc2_alpha_block(const uint8_t texels[16][4]);

/* The two bits of a texel's index, in their two planes of 16. */
static inline uint64_t etc2_index_bits(unsigned i, unsigned index)
{
	return (uint64_t)(index >> 1) << (16 + etc2_place(i)) | (uint64_t)(index & 1) << etc2_place(i);
}

/* The eight bytes of a block, its first one highest: the other way etc2_get_word(). */
static inline void etc2_put_word(uint8_t bytes[8], uint64_t bits)
{
	for (int i = 0; i < 8; i++)
		bytes[i] = (uint8_t)(bits >> (56 - 8 * i));
}

static inline int etc2_square(int value)
{
	return value * value;
}

/* Error of the best of four colours for each texel; adds the indices to *bits. */
uint32_t etc2_index_texels(const uint8_t texels[16][4], const int colours[4][3], uint64_t *bits);

/* The T, H and planar modes are marked by a sum that leaves 0 to 31: two bits of the base, two of the difference; the
 * bits between and above are free and make it overflow. Returns those at their place above `low`, the lowest bit of the
 * difference. */
static inline uint64_t etc2_overflow(unsigned base, unsigned difference, unsigned low)
{
	uint64_t filler = base + difference >= 4 ? 7u << 5 : 1u << 2;
	return (filler | base << 3 | difference) << low;
}

#endif
