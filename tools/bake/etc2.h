/*
 * ETC2 with EAC alpha: 16 bytes for 4 x 4 texels, a quarter of RGBA8; every GLES 3.0 GPU samples it.
 * After the Khronos Data Format Specification 1.3, chapters "ETC1 Compressed Texture Image Formats" and "ETC2
 * Compressed Texture Image Formats", "Format RGBA ETC2"; the sRGB variant has the same blocks. Integers only:
 * the same texels give the same bytes on any machine.
 *
 * Texels are RGBA8, row by row; blocks lie row by row too, the rows of the picture in the order they came in.
 */
#ifndef BLVD_TOOLS_BAKE_ETC2_H
#define BLVD_TOOLS_BAKE_ETC2_H

#include <stddef.h>
#include <stdint.h>

#include "render/etc2_block.h" /* and back */

/* Bytes of a picture; sides that are no multiple of 4 are filled up with their last texels. */
size_t etc2_bytes(uint32_t width, uint32_t height);
void etc2_encode(uint8_t *blocks, const uint8_t (*texels)[4], uint32_t width, uint32_t height);

/* One block; the colour error is summed over what is stored, all three channels weighing the same. */
void etc2_encode_block(uint8_t block[ETC2_BLOCK_BYTES], const uint8_t texels[16][4]);

#endif
