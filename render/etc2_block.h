/*
 * ETC2 with EAC alpha, back to texels: for what draws on the CPU, where the driver does it texel by texel, and for the
 * tools, whose encoder shares the tables. After the Khronos Data Format Specification 1.3, chapters "ETC1 Compressed
 * Texture Image Formats" and "ETC2 Compressed Texture Image Formats"; bits are counted as there: bit 63 is the first of
 * the eight bytes. No GL.
 */
#ifndef BLVD_RENDER_ETC2_BLOCK_H
#define BLVD_RENDER_ETC2_BLOCK_H

#include <stddef.h>
#include <stdint.h>

#define ETC2_BLOCK_BYTES 16

/* RGBA, row by row. Takes any 16 bytes. */
void etc2_decode_block(uint8_t texels[16][4], const uint8_t block[ETC2_BLOCK_BYTES]);

/* Blocks of a picture, row by row; its rows of `width` texels follow one another. Sides may be no multiple of 4. */
void etc2_decode(uint8_t (*texels)[4], const uint8_t *blocks, uint32_t width, uint32_t height);

/* Smaller and larger step from the base colour, both ways: ETC1, "Intensity modifier sets". */
extern const uint8_t etc2_steps[8][2];
/* Distances of the T and H modes: "Format RGB ETC2". */
extern const uint8_t etc2_distances[8];
/* Alpha modifiers by table and index: "Format RGBA ETC2". */
extern const int16_t etc2_alpha_steps[16][8];

/* Indices are stored column by column; texel i counts row by row. */
static inline unsigned etc2_place(unsigned i)
{
	return i % 4 * 4 + i / 4;
}

/* The eight bytes of a block, its first one highest. */
static inline uint64_t etc2_get_word(const uint8_t bytes[8])
{
	uint64_t bits = 0;
	for (int i = 0; i < 8; i++)
		bits = bits << 8 | bytes[i];
	return bits;
}

static inline int etc2_clamp(int value)
{
	return value < 0 ? 0 : value > 255 ? 255 : value;
}

/* Widens 4 to 7 bits to 8 by repeating the high ones. */
static inline int etc2_widen(int value, int bits)
{
	return bits == 4 ? value * 17 : value << (8 - bits) | value >> (2 * bits - 8);
}

#endif
