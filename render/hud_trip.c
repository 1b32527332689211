/* Bottom right: when we arrive and how far it is; bottom centre: the street being driven. */
#include <math.h>
#include <stdio.h>

#include "render/hud.h"

/* "14:05" when a clock is known, the time still to go otherwise. */
static void head_words(const struct hud *hud, char *out)
{
	const struct nav_view *nav = hud->nav;
	if (nav->wall_ns != 0 && hud->zone_known)
		wording_clock(out, nav->wall_ns + (int64_t)(nav->remaining_s * 1e9), hud->zone_minutes);
	else
		wording_duration(out, nav->remaining_s);
}

void hud_trip(struct hud *hud)
{
	const struct nav_view *nav = hud->nav;
	float s = hud->scale, width = 232.0f * s;
	struct box none = { hud->width - hud->margin, hud->bottom, hud->width - hud->margin, hud->bottom };
	hud->trip = none;
	if (!nav->located || !nav->routed || hud->trip_covered)
		return;
	char head[WORDING_MAX], distance[WORDING_MAX], duration[WORDING_MAX], tail[2 * WORDING_MAX + 8];
	head_words(hud, head);
	wording_distance(distance, fmax(nav->remaining_m, 10.0), hud->units);
	wording_duration(duration, nav->remaining_s);
	bool clock = nav->wall_ns != 0 && hud->zone_known;
	snprintf(tail, sizeof(tail), "%s%s%s", clock ? duration : "", clock ? " \xC2\xB7 " : "", distance);
	struct box card = { none.x1 - width, hud->bottom - 108.0f * s, none.x1, hud->bottom };
	hud->trip = card;
	hud_card(hud, card, hud->palette->card);
	float middle = (card.x0 + card.x1) / 2.0f, room = width - 24.0f * s;
	struct text_line first = text_line_utf8(head), second = text_line_utf8(tail);
	float size = text_fit(hud->font, &first, 50.0f * s, 32.0f * s, room);
	hud_text(hud, &first, middle, card.y0 + 39.0f * s, size, hud->palette->text, TEXT_CENTER, room);
	size = text_fit(hud->font, &second, 26.0f * s, 22.0f * s, room);
	hud_text(hud, &second, middle, card.y1 - 27.0f * s, size, hud->palette->text_dim, TEXT_CENTER, room);
}

/* In the middle between the other two when it fits there, else in a row of its own above them, else shortened. */
void hud_street(struct hud *hud)
{
	const struct nav_view *nav = hud->nav;
	struct text_line street = text_line_string(hud->font, nav->street);
	if (!nav->located || text_line_empty(&street))
		return;
	float s = hud->scale, size = 32.0f * s, pad = 24.0f * s, height = 58.0f * s, gap = 16.0f * s;
	float middle = hud->width / 2.0f, wanted = text_width_em(hud->font, &street) * size / 2.0f + pad;
	float between = fminf(middle - hud->speed.x1, hud->trip.x0 - middle) - gap;
	float half = fminf(wanted, between), y1 = hud->bottom;
	float row = fminf(hud->speed.y0, hud->trip.y0) - gap, whole = fminf(wanted, middle - hud->margin);
	if (half < wanted && hud_free(hud, (struct box){ middle - whole, row - height, middle + whole, row }, 4.0f * s)) {
		half = whole;
		y1 = row;
	}
	struct box card = { middle - half, y1 - height, middle + half, y1 };
	if (half < 2.5f * pad || !hud_free(hud, card, 2.0f * s))
		return;
	hud_card(hud, card, hud->palette->card);
	hud_text(
		hud, &street, middle, y1 - height / 2.0f, size, hud->palette->text, TEXT_CENTER, 2.0f * (half - pad) + 2.0f);
}
