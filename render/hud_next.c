/* Top left: what to do next, where, and onto which street; below it what follows soon after. */
#include <math.h>
#include <stdio.h>

#include "render/hud.h"
#include "render/manoeuvre_icon.h"

#define SOON_M 300.0 /* the manoeuvre after the next is shown when it follows within this */

static struct manoeuvre_icon icon_of(const struct hud *hud, const struct nav_step *step)
{
	return (struct manoeuvre_icon){
		.manoeuvre = step->manoeuvre,
		.exit = step->exit,
		.angle_bam = step->angle_bam,
		.right_hand = hud->pkg->meta->right_hand_traffic,
		.color = hud->palette->accent_text,
		.rest = rgba_fade(hud->palette->accent_dim, 0.45f),
	};
}

static float card_width(const struct hud *hud)
{
	float s = hud->scale, room = hud->width - 2.0f * hud->margin - 76.0f * s;
	float wanted = hud->width > hud->height ? fmaxf(430.0f * s, 0.30f * hud->width) : room;
	return fminf(wanted, room);
}

static void draw_soon(struct hud *hud, struct box card, const struct nav_step *step)
{
	float s = hud->scale, middle = (card.y0 + card.y1) / 2.0f, x = card.x0 + 20.0f * s;
	struct text_line then = text_line_utf8("Then");
	hud_card(hud, card, hud->palette->accent);
	x += hud_text(hud, &then, x, middle, 26.0f * s, hud->palette->accent_dim, TEXT_LEFT, 0.0f) + 30.0f * s;
	struct manoeuvre_icon icon = icon_of(hud, step);
	manoeuvre_icon_draw(hud->canvas, NULL, &icon, (struct vec2){ x, middle }, 38.0f * s);
	struct text_line street = text_line_string(hud->font, step->street);
	x += 30.0f * s;
	hud_text(hud, &street, x, middle, 26.0f * s, hud->palette->accent_dim, TEXT_LEFT, card.x1 - x - 16.0f * s);
}

static void draw_step(struct hud *hud, struct box card, const struct nav_step *step)
{
	char distance[WORDING_MAX], words[WORDING_MAX];
	float s = hud->scale, icon_px = 92.0f * s, text_x = card.x0 + icon_px + 38.0f * s;
	float room = card.x1 - text_x - 18.0f * s;
	struct manoeuvre_icon icon = icon_of(hud, step);
	struct vec2 center = { card.x0 + 18.0f * s + icon_px / 2.0f, (card.y0 + card.y1) / 2.0f };
	hud_card(hud, card, hud->palette->accent);
	manoeuvre_icon_draw(hud->canvas, hud->font, &icon, center, icon_px);
	wording_distance(distance, step->distance_m, hud->units);
	wording_manoeuvre(words, step->manoeuvre, step->exit);
	struct text_line line = text_line_utf8(distance);
	hud_text(hud, &line, text_x, card.y0 + 46.0f * s, 52.0f * s, hud->palette->accent_text, TEXT_LEFT, room);
	struct text_line street = text_line_string(hud->font, step->street);
	if (text_line_empty(&street))
		street = text_line_utf8(words);
	float size = text_fit(hud->font, &street, 34.0f * s, 28.0f * s, room);
	hud_text(hud, &street, text_x, card.y1 - 36.0f * s, size, hud->palette->accent_text, TEXT_LEFT, room);
}

static void draw_searching(struct hud *hud, struct box card)
{
	float s = hud->scale;
	struct text_line words = text_line_utf8("Finding a new route");
	hud_card(hud, card, hud->palette->accent);
	hud_text(hud, &words, card.x0 + 24.0f * s, (card.y0 + card.y1) / 2.0f, 32.0f * s, hud->palette->accent_text,
		TEXT_LEFT, card.x1 - card.x0 - 48.0f * s);
}

void hud_next(struct hud *hud)
{
	const struct nav_view *nav = hud->nav;
	float s = hud->scale, x = hud->margin, y = hud->margin, width = card_width(hud);
	hud->next = (struct box){ x, y, x, y };
	if (!nav->located)
		return;
	if (nav->off_route) {
		hud->next = (struct box){ x, y, x + width, y + 76.0f * s };
		draw_searching(hud, hud->next);
		return;
	}
	if (!nav->routed || nav->next.manoeuvre == NAV_MANOEUVRE_NONE)
		return;
	hud->next = (struct box){ x, y, x + width, y + 132.0f * s };
	draw_step(hud, hud->next, &nav->next);
	const struct nav_step *soon = &nav->after_next;
	if (soon->manoeuvre == NAV_MANOEUVRE_NONE || nav->next.manoeuvre == NAV_MANOEUVRE_ARRIVE ||
		soon->distance_m - nav->next.distance_m > SOON_M)
		return;
	struct box below = { x, hud->next.y1 + 8.0f * s, x + width, hud->next.y1 + 64.0f * s };
	draw_soon(hud, below, soon);
	hud->next.y1 = below.y1;
}
