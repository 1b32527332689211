/* Bottom left: the speed and, beside it, the limit as the sign of the country looks. */
#include <math.h>
#include <stdio.h>

#include "render/hud.h"

/* Whole numbers that do not flip to and fro: a new one must be clearly nearer. */
static int steady_speed(struct hud_memory *memory, double speed, bool good)
{
	if (!good)
		memory->shown_speed = -1;
	else if (memory->shown_speed < 0 || fabs(speed - memory->shown_speed) > 0.7)
		memory->shown_speed = (int)fmin(floor(speed + 0.5), 999.0);
	return memory->shown_speed;
}

/* Red from 3 above the limit until it is kept again. */
static void judge_limit(struct hud_memory *memory, int speed, int limit)
{
	int slack = memory->over_limit ? 0 : 2;
	memory->over_limit = limit > 0 && speed > limit + slack;
}

static void draw_round_sign(struct hud *hud, struct vec2 center, float radius, const char *number, bool posted)
{
	const struct palette *palette = hud->palette;
	struct text_line line = text_line_utf8(number);
	float ring = radius * 0.2f, size = text_fit(hud->font, &line, radius * 0.92f, 8.0f, radius * 1.3f);
	canvas_disc(hud->canvas, center, radius, palette->sign_face);
	canvas_arc(hud->canvas, center, radius - ring / 2.0f - 1.0f, ring, 0.0f, 2.0f * (float)BLVD_PI,
		posted ? palette->sign_ring : rgba_fade(palette->text_dim, 0.6f));
	hud_text(hud, &line, center.x, center.y, size, palette->sign_text, TEXT_CENTER, 0.0f);
}

static void draw_plate_sign(struct hud *hud, struct box box, const char *number, bool posted)
{
	const struct palette *palette = hud->palette;
	float s = hud->scale, inset = 4.0f * s, middle = (box.x0 + box.x1) / 2.0f;
	struct box inner = { box.x0 + inset, box.y0 + inset, box.x1 - inset, box.y1 - inset };
	struct box face = { inner.x0 + 2.0f * s, inner.y0 + 2.0f * s, inner.x1 - 2.0f * s, inner.y1 - 2.0f * s };
	struct text_line word = text_line_utf8("LIMIT"), line = text_line_utf8(number);
	canvas_rounded_box(hud->canvas, box, 9.0f * s, 1.0f, palette->sign_face);
	canvas_rounded_box(hud->canvas, inner, 6.0f * s, 1.0f, posted ? palette->sign_text : palette->text_dim);
	canvas_rounded_box(hud->canvas, face, 5.0f * s, 1.0f, palette->sign_face);
	hud_text(hud, &word, middle, box.y0 + 25.0f * s, 24.0f * s, palette->sign_text, TEXT_CENTER, 0.0f);
	hud_text(hud, &line, middle, box.y1 - 30.0f * s, 42.0f * s, palette->sign_text, TEXT_CENTER, 0.0f);
}

static void draw_limit(struct hud *hud, struct box card, int limit)
{
	char number[16];
	float s = hud->scale, radius = 37.0f * s;
	bool posted = hud->nav->limit_posted;
	snprintf(number, sizeof(number), "%d", limit);
	if (hud->units == UNITS_MILES_FEET) {
		struct box plate = { card.x1 - 92.0f * s, card.y0 + 8.0f * s, card.x1 - 12.0f * s, card.y1 - 8.0f * s };
		draw_plate_sign(hud, plate, number, posted);
		return;
	}
	struct vec2 center = { card.x1 - radius - 14.0f * s, (card.y0 + card.y1) / 2.0f };
	draw_round_sign(hud, center, radius, number, posted);
}

void hud_speed(struct hud *hud)
{
	const struct nav_view *nav = hud->nav;
	char number[16] = "\xE2\x80\x93";
	float s = hud->scale, digits = 132.0f * s, sign = 88.0f * s;
	double factor = hud->units == UNITS_METRIC ? 3.6 : 2.2369363;
	bool good = nav->signal[NAV_SIGNAL_SPEED] == NAV_SIGNAL_GOOD ||
				(nav->signal[NAV_SIGNAL_SPEED] == NAV_SIGNAL_ABSENT && nav->located);
	int speed = steady_speed(hud->memory, fabs(nav->speed_mps) * factor, good);
	int limit = nav->located && nav->limit_kmh > 0 ? wording_limit(nav->limit_kmh, hud->units) : 0;
	judge_limit(hud->memory, speed, limit);
	if (speed >= 0)
		snprintf(number, sizeof(number), "%d", speed);
	struct box card = { hud->margin, hud->bottom - 108.0f * s, hud->margin + digits + (limit ? sign : 0.0f),
		hud->bottom };
	hud->speed = card;
	hud_card(hud, card, hud->palette->card);
	float middle = card.x0 + digits / 2.0f;
	struct rgba color = hud->memory->over_limit ? hud->palette->over_limit : hud->palette->text;
	struct text_line line = text_line_utf8(number), unit = text_line_utf8(wording_speed_unit(hud->units));
	hud_text(hud, &line, middle, card.y0 + 42.0f * s, 62.0f * s, color, TEXT_CENTER, 0.0f);
	hud_text(hud, &unit, middle, card.y1 - 24.0f * s, 24.0f * s, hud->palette->text_dim, TEXT_CENTER, 0.0f);
	if (limit)
		draw_limit(hud, card, limit);
}
