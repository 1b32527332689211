/*
 * The glyphs of a bake: a dictionary from (face, glyph) to a number, their distance fields, and the packing of these
 * into one texture. Numbers follow the order of first use, so the same strings give the same bytes.
 */
#ifndef BLVD_TOOLS_BAKE_GLYPH_ATLAS_H
#define BLVD_TOOLS_BAKE_GLYPH_ATLAS_H

#include "assets/pkg_format.h"
#include "tools/bake/font_faces.h"
#include "tools/city/pool.h"

#define GLYPH_SPREAD_PX 8

struct atlas_glyph {
	uint32_t face, glyph; /* glyph TEXT_GLYPH_MISSING: the box */
	struct pkg_glyph out;
	uint8_t *field; /* out.atlas_width * out.atlas_height, owned */
};

struct glyph_atlas {
	ARRAY(struct atlas_glyph) glyphs;
	uint32_t *slots; /* hash table of glyph numbers + 1; owned */
	uint32_t slot_count;
	uint32_t width, height;
	unsigned em_px;
	uint32_t dropped; /* fields that found no room even at the smallest size */
};

void glyph_atlas_finish(struct glyph_atlas *atlas);

/* The number of a glyph, added when new. `codepoint` 0: only shaping reaches it. */
uint32_t glyph_atlas_add(
	struct glyph_atlas *atlas, const struct font_set *fonts, uint32_t face, uint32_t glyph, uint32_t codepoint);

/* Draws and packs everything that was added, at the largest em for which it fits. Returns 0 or -errno. */
int glyph_atlas_pack(struct glyph_atlas *atlas, struct font_set *fonts);

/* width * height texels; `texels` must be zeroed. */
void glyph_atlas_blit(const struct glyph_atlas *atlas, uint8_t *texels);

#endif
