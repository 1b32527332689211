/* PNG files: written under a temporary name, then renamed, so that no half picture is ever found. */
#ifndef BLVD_BOARD_PNG_WRITE_H
#define BLVD_BOARD_PNG_WRITE_H

#include <stdint.h>

/* `rgba`: top row first, 4 bytes a pixel; alpha is left out. Same pixels, same bytes. Returns 0 or -errno after logging
 * one line. libpng allocates while it writes. */
int png_write(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height);

#endif
