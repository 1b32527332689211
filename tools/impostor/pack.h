/* Shapes of whole blocks onto pages, first fit, largest first. Shapes may interlock: a page is full only where blocks
 * are taken. */
#ifndef BLVD_TOOLS_IMPOSTOR_PACK_H
#define BLVD_TOOLS_IMPOSTOR_PACK_H

#include <stddef.h>
#include <stdint.h>

#include "assets/pkg_format.h"

#define PACK_BLOCKS (PKG_PAGE_PX / 4) /* along each side of a page */

struct pack_shape {
	const uint64_t *rows;   /* `height` of them; bit x: block x is taken */
	uint32_t width, height; /* blocks, 1 to PACK_BLOCKS */
	uint32_t page, x, y;    /* out: blocks */
};

/* Returns the number of pages, or 0 when that would be more than pages_max (at least 1) or there are no shapes. The
 * same shapes in the same order give the same places. */
uint32_t pack_shapes(struct pack_shape *shapes, size_t count, uint32_t pages_max);

#endif
