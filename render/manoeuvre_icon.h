/* The arrow of a manoeuvre as geometry: readable in a glance, drawn from strokes, for every kind. */
#ifndef BLVD_RENDER_MANOEUVRE_ICON_H
#define BLVD_RENDER_MANOEUVRE_ICON_H

#include "nav/nav.h"
#include "platform/base/geo.h"
#include "render/text.h"

struct manoeuvre_icon {
	enum nav_manoeuvre manoeuvre;
	unsigned exit;     /* roundabout, 0 unknown */
	int32_t angle_bam; /* roundabout: of the exit, against the way in */
	bool right_hand;
	struct rgba color; /* the way to take */
	struct rgba rest;  /* what else is there */
};

/* Fills the square of side `size_px` around `center`. `font` writes the exit's number; may be NULL. */
void manoeuvre_icon_draw(struct canvas *canvas, const struct text_font *font, const struct manoeuvre_icon *icon,
	struct vec2 center, float size_px);

#endif
