/*
 * The read-outs along the screen's edges, one function a widget. Each draws itself on the canvas, keeps its size from
 * frame to frame where its text changes, and takes its box so that nothing else is written there. Lengths are those of
 * a 720 px screen times `scale`.
 */
#ifndef BLVD_RENDER_HUD_H
#define BLVD_RENDER_HUD_H

#include "render/menu.h"
#include "render/palette.h"
#include "render/text.h"
#include "render/wording.h"

#define HUD_BOXES_MAX 16

/* What must not flicker between frames. */
struct hud_memory {
	int shown_speed; /* -1: none */
	bool over_limit;
};

struct hud {
	struct canvas *canvas;
	const struct text_font *font;
	const struct palette *palette;
	const struct pkg *pkg;
	const struct nav_view *nav;
	struct hud_memory *memory;
	enum wording_units units; /* not UNITS_AUTO */
	int32_t zone_minutes;     /* local time minus UTC */
	bool zone_known;
	float scale, width, height, margin;
	bool compact;      /* so low a screen that a message takes the place of lesser things */
	float bottom;      /* lowest y that cards may reach: above the credit */
	struct box next;   /* the manoeuvre card, or empty at the margin */
	struct box corner; /* the compass */
	struct box speed, trip;
	bool trip_covered;   /* by the menu, where the screen has no room for both */
	const char *devices; /* what is wrong with controls and lines, NULL nothing; nav tells of the car's signals */
	struct box taken[HUD_BOXES_MAX];
	uint32_t taken_count;
};

/* hud.c */
void hud_take(struct hud *hud, struct box box);
/* Nothing is written there yet, with `gap` around it, and it is on the screen. */
bool hud_free(const struct hud *hud, struct box box, float gap);
void hud_card(struct hud *hud, struct box box, struct rgba color);
/* Left, centred or right of x, its capitals centred on y; cut to max_width when that is > 0. */
float hud_text(struct hud *hud, const struct text_line *line, float x, float y, float size_px, struct rgba color,
	enum text_align align, float max_width);

/* In this order: later ones ask where earlier ones are. */
void hud_credit(struct hud *hud);
void hud_next(struct hud *hud);                       /* hud_next.c: next manoeuvre and the one after it */
void hud_compass(struct hud *hud, float heading_rad); /* of the picture's upward direction */
void hud_speed(struct hud *hud);                      /* hud_speed.c: speed and limit */
void hud_menu(struct hud *hud, const struct menu_words *words, const struct menu_view *menu); /* menu.c */
void hud_trip(struct hud *hud);                      /* hud_trip.c: arrival, remaining way */
void hud_street(struct hud *hud);                    /* hud_trip.c: the street being driven */
void hud_status(struct hud *hud);                    /* hud_status.c: inputs */
void hud_message(struct hud *hud, const char *text); /* NULL or "": none */

#endif
