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

#define TEXT_LEFT_PX 130.0f /* of a card: the icon and its margins */
#define TEXT_RIGHT_PX 20.0f
#define STREET_PX 34.0f
#define STREET_SMALL_PX 28.0f

/* Wide enough for the street, within limits: the same as long as the manoeuvre is the same. */
static float card_width(const struct hud *hud, const struct text_line *street)
{
	float s = hud->scale, room = hud->width - 2.0f * hud->margin - 80.0f * s;
	float wanted = text_width_em(hud->font, street) * STREET_PX * s + (TEXT_LEFT_PX + TEXT_RIGHT_PX) * s + 2.0f;
	float most = hud->width > hud->height ? fmaxf(560.0f * s, 0.42f * hud->width) : room;
	return fminf(fminf(fmaxf(wanted, 430.0f * s), most), room);
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

struct street_text {
	struct text_line line;
	char words[WORDING_MAX]; /* what to do, when the street has no name */
	float size_px;
	float break_em, resume_em; /* two lines: the first ends and the second starts here; 0: one line */
};

static void set_street(const struct hud *hud, const struct nav_step *step, struct street_text *out)
{
	out->line = text_line_string(hud->font, step->street);
	if (text_line_empty(&out->line)) {
		wording_manoeuvre(out->words, step->manoeuvre, step->exit);
		out->line = text_line_utf8(out->words);
	}
}

static void fit_street(const struct hud *hud, struct street_text *text, float room)
{
	float width = text_width_em(hud->font, &text->line);
	text->size_px = text_fit(hud->font, &text->line, STREET_PX * hud->scale, STREET_SMALL_PX * hud->scale, room);
	text->break_em = text->resume_em = 0.0f;
	if (width * text->size_px > room + 0.5f && hud->height > 560.0f * hud->scale)
		text_break(hud->font, &text->line, room / text->size_px, &text->break_em, &text->resume_em);
}

static void draw_street(struct hud *hud, const struct street_text *text, float x, float y, float room)
{
	float step = 36.0f * hud->scale, width = text_width_em(hud->font, &text->line);
	if (text->break_em == 0.0f) {
		hud_text(hud, &text->line, x, y, text->size_px, hud->palette->accent_text, TEXT_LEFT, room);
		return;
	}
	struct text_style style = { .size_px = text->size_px, .fill = hud->palette->accent_text, .weight = 0.012f };
	float down = text_middle(hud->font, text->size_px);
	float last = fminf(width, text->resume_em + room / text->size_px);
	bool turned = text->line.right_to_left;
	text_draw_part(
		hud->canvas, hud->font, &text->line, 0.0f, text->break_em, x, y + down + (turned ? step : 0.0f), &style);
	text_draw_part(hud->canvas, hud->font, &text->line, text->resume_em, turned ? width : last, x,
		y + down + (turned ? 0.0f : step), &style);
}

static void draw_step(struct hud *hud, struct box card, const struct nav_step *step, const struct street_text *street)
{
	char distance[WORDING_MAX];
	float s = hud->scale, icon_px = 92.0f * s, text_x = card.x0 + TEXT_LEFT_PX * s;
	float room = card.x1 - text_x - TEXT_RIGHT_PX * s;
	struct manoeuvre_icon icon = icon_of(hud, step);
	struct vec2 center = { card.x0 + 18.0f * s + icon_px / 2.0f, (card.y0 + card.y1) / 2.0f };
	hud_card(hud, card, hud->palette->accent);
	manoeuvre_icon_draw(hud->canvas, hud->font, &icon, center, icon_px);
	wording_distance(distance, step->distance_m, hud->units);
	struct text_line line = text_line_utf8(distance);
	hud_text(hud, &line, text_x, card.y0 + 46.0f * s, 52.0f * s, hud->palette->accent_text, TEXT_LEFT, room);
	draw_street(hud, street, text_x, card.y0 + 97.0f * s, room);
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
	struct street_text street;
	set_street(hud, &nav->next, &street);
	float s = hud->scale, x = hud->margin, y = hud->margin, width = card_width(hud, &street.line);
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
	fit_street(hud, &street, width - (TEXT_LEFT_PX + TEXT_RIGHT_PX) * s);
	float height = (street.break_em > 0.0f ? 168.0f : 132.0f) * s;
	hud->next = (struct box){ x, y, x + width, y + height };
	draw_step(hud, hud->next, &nav->next, &street);
	const struct nav_step *soon = &nav->after_next;
	if (hud->compact || soon->manoeuvre == NAV_MANOEUVRE_NONE || nav->next.manoeuvre == NAV_MANOEUVRE_ARRIVE ||
		soon->distance_m - nav->next.distance_m > SOON_M)
		return;
	struct box below = { x, hud->next.y1 + 8.0f * s, x + width, hud->next.y1 + 64.0f * s };
	draw_soon(hud, below, soon);
	hud->next.y1 = below.y1;
}
