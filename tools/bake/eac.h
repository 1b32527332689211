/*
 * EAC RG11: two channels of 11 bits, 16 bytes for 4 x 4 texels, half of RG8; every GLES 3.0 GPU samples it. After the
 * Khronos Data Format Specification 1.3, "Format R11 EAC" and "Format RG11 EAC". Integers only: the same texels give
 * the same bytes on any machine. About 2 us a block of texels that vary.
 *
 * Texels are RG8, row by row; blocks lie row by row too, the rows of the picture in the order they came in.
 */
#ifndef BLVD_TOOLS_BAKE_EAC_H
#define BLVD_TOOLS_BAKE_EAC_H

#include <stddef.h>
#include <stdint.h>

#define EAC_RG_BLOCK_BYTES 16
#define EAC_MAX 2047 /* stands for 1 */

/* Bytes of a picture; sides that are no multiple of 4 are filled up with their last texels. */
size_t eac_rg_bytes(uint32_t width, uint32_t height);
/* The rows of blocks from `first` to before `end`, of (height + 3) / 4; `blocks` is that of the whole picture. */
void eac_rg_encode(
	uint8_t *blocks, const uint8_t (*texels)[2], uint32_t width, uint32_t height, uint32_t first, uint32_t end);
/* To the nearest 8 bits. */
void eac_rg_decode(uint8_t (*texels)[2], const uint8_t *blocks, uint32_t width, uint32_t height);

/* One channel of a block, 8 bytes. The texels count row by row. One value in all 16 is exact to the 11 bits. */
void eac_encode_block(uint8_t block[8], const uint8_t texels[16]);
/* Takes any 8 bytes; 0 to EAC_MAX. */
void eac_decode_block(uint16_t texels[16], const uint8_t block[8]);

#endif
