/*
 * Capitals, digits and a few signs as strokes: text for the times when there is no package and so no font of glyphs.
 * Letters are drawn as canvas shapes. Lower case is drawn as capitals; what is not known as a blank.
 */
#ifndef BLVD_RENDER_STROKE_FONT_H
#define BLVD_RENDER_STROKE_FONT_H

#include "render/canvas.h"
#include "render/text.h"

struct stroke_style {
	float cap_px; /* height of a capital: three quarters of what other fonts call their size */
	struct rgba color, halo;
	float halo_px; /* 0 none */
	enum text_align align;
};

float stroke_font_width(const char *text, float cap_px);
/* `y` is the middle of the capitals. Returns the width. */
float stroke_font_draw(struct canvas *canvas, const char *text, float x, float y, const struct stroke_style *style);

#endif
