/*
 * The font files of a bake, in order of preference: FreeType draws their outlines, HarfBuzz shapes with them. Glyph
 * metrics are in em, so nothing here depends on a pixel size until font_set_size().
 */
#ifndef BLVD_TOOLS_BAKE_FONT_FACES_H
#define BLVD_TOOLS_BAKE_FONT_FACES_H

#include <stddef.h>
#include <stdint.h>

#define FONT_FACES_MAX 64

struct font_face {
	struct FT_FaceRec_ *outline; /* FT_Face; its header is for the .c files */
	struct hb_font_t *shaper;    /* in font units */
	float em_units;
};

struct font_set {
	struct FT_LibraryRec_ *library;
	struct font_face faces[FONT_FACES_MAX];
	uint32_t count;
};

/* Opens all files; the first FONT_FACES_MAX of them. `spread_px` is the reach of the distance fields. Returns 0, or
 * -errno after logging one line that names the file. font_set_close accepts a zeroed set. */
int font_set_open(struct font_set *set, const char *const *files, size_t file_count, int spread_px);
void font_set_close(struct font_set *set);

/* Pixels of 1 em for drawing. Returns 0 or -EINVAL (a font without outlines). */
int font_set_size(struct font_set *set, unsigned em_px);

/* The glyph of a character in one face, 0 when the face has none. */
uint32_t font_glyph(const struct font_set *set, uint32_t face, uint32_t codepoint);
float font_advance_em(const struct font_set *set, uint32_t face, uint32_t glyph);

#endif
