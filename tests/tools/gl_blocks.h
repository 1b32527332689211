/* Compressed blocks as this machine's GL decodes them. */
#ifndef BLVD_TESTS_TOOLS_GL_BLOCKS_H
#define BLVD_TESTS_TOOLS_GL_BLOCKS_H

#include <stddef.h>
#include <stdint.h>

#include <GLES3/gl3.h>

/* With a context: a picture of side x side texels, of blocks of a format of glCompressedTexSubImage2D(), row by row. A
 * GL error fails the test. */
void gl_draw_blocks(GLenum format, const uint8_t *blocks, size_t bytes, int side, uint8_t (*out)[4]);

#endif
