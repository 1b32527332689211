/*
 * Lines of text on a canvas, from the package's glyph atlas. Names were shaped by the bake and are drawn as stored;
 * the overlay's own words and numbers are set glyph by glyph (Latin, no shaping). Sizes are screen pixels of 1 em; the
 * origin is the base line. Nothing here allocates.
 */
#ifndef BLVD_RENDER_TEXT_H
#define BLVD_RENDER_TEXT_H

#include <stdbool.h>

#include "render/canvas.h"

#define TEXT_EXTRA_MAX 64

/* Finds glyphs. `font` NULL (a package without one): every text is empty. */
struct text_font {
	const struct pkg *pkg;
	const struct pkg_font *font;
	uint32_t latin[256]; /* glyph of U+0000 to U+00FF, or PKG_NONE */
	struct {
		uint32_t codepoint, glyph;
	} extra[TEXT_EXTRA_MAX]; /* ascending */
	uint32_t extra_count;
};
void text_font_init(struct text_font *font, const struct pkg *pkg);

/* A line: shaped, or UTF-8 of the overlay's own. Borrowed. */
struct text_line {
	const struct pkg_text *shaped;     /* NULL: use utf8 */
	const struct pkg_glyph_at *glyphs; /* of `shaped`; NULL: the package's */
	const char *utf8;
	bool right_to_left; /* a line that must be cut keeps its right end */
};
struct text_line text_line_utf8(const char *utf8);
/* A string of the package; without a shaped form (or with offset 0) its UTF-8. */
struct text_line text_line_string(const struct text_font *font, uint32_t string);
/* Set once, at start, for words that are drawn often: `line` is then shaped. Memory from the arena; `utf8` is borrowed.
 * Returns 0 or -ENOMEM. */
int text_line_set(const struct text_font *font, const char *utf8, struct arena *arena, struct text_line *line);
bool text_line_empty(const struct text_line *line);

float text_width_em(const struct text_font *font, const struct text_line *line);

enum text_align { TEXT_LEFT, TEXT_CENTER, TEXT_RIGHT };
struct text_style {
	float size_px;
	struct rgba fill, halo;
	float halo_px;      /* 0: none */
	float weight;       /* stroke growth, em; 0 regular, about 0.02 semi-bold */
	float max_width_px; /* 0: no limit; a longer line is cut and ends in an ellipsis */
	enum text_align align;
	float angle_rad; /* clockwise about the origin */
};

/* Returns the drawn width in px. */
float text_draw(struct canvas *canvas, const struct text_font *font, const struct text_line *line, float x, float y,
	const struct text_style *style);

/* The size, from `largest` down to `smallest`, at which the line is no wider than `width_px`. */
float text_fit(
	const struct text_font *font, const struct text_line *line, float largest, float smallest, float width_px);

/* Cuts a line in two at a blank so that the part read first is at most `limit_em` wide: the parts are [0,
 * *first_end_em] and [*second_start_em, width]; read from the right, the second of these comes first. False when there
 * is no such blank. */
bool text_break(const struct text_font *font, const struct text_line *line, float limit_em, float *first_end_em,
	float *second_start_em);
/* As text_draw, only what lies between two places of the line. */
float text_draw_part(struct canvas *canvas, const struct text_font *font, const struct text_line *line, float from_em,
	float to_em, float x, float y, const struct text_style *style);

/* What the line covers at most when drawn at x, y (unrotated), halo included. */
struct box text_box(
	const struct text_font *font, const struct text_line *line, float x, float y, const struct text_style *style);

/* Centre line of capitals above the base line, px: y + this is where text looks centred. */
float text_middle(const struct text_font *font, float size_px);

#endif
