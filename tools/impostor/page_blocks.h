/*
 * Pages to ETC2 blocks that pack well: where a block may as well be, in part or as a whole, like one of the last ones
 * of its page, it is, if that costs less error than the bytes are worth. This is rate-distortion optimization for a
 * packer that finds repeated bytes. Alpha is never changed: where a block has one level or nothing, it is written so
 * that equal outlines are equal bytes.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_PAGE_BLOCKS_H
#define BLVD_TOOLS_IMPOSTOR_PAGE_BLOCKS_H

#include <stdint.h>

#include "assets/pkg_format.h"

/* Texels RGBA, rows from v = 0; PKG_PAGE_BYTES of blocks. The same texels give the same blocks. About 60 ms a page that
 * is full. */
void page_blocks(const uint8_t *page, uint8_t blocks[PKG_PAGE_BYTES]);

#endif
