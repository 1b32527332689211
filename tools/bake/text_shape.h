/*
 * One line of text in any script: bidirectional order (FriBidi, UAX #9), cut into runs of one script, direction and
 * font, each run shaped by HarfBuzz. The result is in visual order, left to right, in em.
 */
#ifndef BLVD_TOOLS_BAKE_TEXT_SHAPE_H
#define BLVD_TOOLS_BAKE_TEXT_SHAPE_H

#include <stdbool.h>

#include "tools/bake/font_faces.h"
#include "tools/city/pool.h"

#define TEXT_SHAPE_MAX 255 /* characters; the rest of a longer string is left out */
#define TEXT_GLYPH_MISSING UINT32_MAX
#define TEXT_MISSING_ADVANCE_EM 0.6f

struct shaped_glyph {
	uint32_t face;    /* of the font set */
	uint32_t glyph;   /* in the face, or TEXT_GLYPH_MISSING: no font has the character */
	float x_em, y_em; /* pen position from the start of the line, y up */
};

struct shaped_text {
	ARRAY(struct shaped_glyph) glyphs;
	float width_em;
	uint32_t missing; /* characters without a glyph */
	bool cut;         /* was longer than TEXT_SHAPE_MAX */
};

/* Replaces what `out` held; free it with ARRAY_FINISH(&out->glyphs). Invalid UTF-8 becomes U+FFFD, control characters
 * become spaces. */
void text_shape(const struct font_set *fonts, const char *utf8, struct shaped_text *out);

#endif
