/* What is wrong, in words: inputs at the top right, messages above the bottom row. Nothing when all is well. */
#include <math.h>
#include <string.h>

#include "render/hud.h"

/* A triangle with an exclamation mark. */
static void draw_sign(struct hud *hud, struct vec2 center, float size_px)
{
	float half = size_px / 2.0f;
	const struct vec2 triangle[3] = { { center.x, center.y - half },
		{ center.x + 1.1f * half, center.y + 0.85f * half }, { center.x - 1.1f * half, center.y + 0.85f * half } };
	const struct vec2 bar[2] = { { center.x, center.y - 0.42f * half }, { center.x, center.y + 0.28f * half } };
	canvas_convex(hud->canvas, triangle, 3, 1.0f, hud->palette->warning_text);
	canvas_stroke(hud->canvas, bar, 2, 0.24f * half, hud->palette->warning);
	canvas_disc(hud->canvas, (struct vec2){ center.x, center.y + 0.56f * half }, 0.14f * half, hud->palette->warning);
}

static void draw_pill(struct hud *hud, struct box box, const struct text_line *line)
{
	float s = hud->scale, middle = (box.y0 + box.y1) / 2.0f;
	hud_card(hud, box, hud->palette->warning);
	draw_sign(hud, (struct vec2){ box.x0 + 32.0f * s, middle }, 30.0f * s);
	float x = box.x0 + 58.0f * s;
	hud_text(hud, line, x, middle, 26.0f * s, hud->palette->warning_text, TEXT_LEFT, box.x1 - x - 16.0f * s);
}

static float pill_width(const struct hud *hud, const struct text_line *line)
{
	return text_width_em(hud->font, line) * 26.0f * hud->scale + 82.0f * hud->scale;
}

/* What is wrong with an input, and what that does to the position; or the position alone. */
static bool words_of_car(char *out, const struct hud *hud)
{
	char words[WORDING_MAX] = "";
	bool input = wording_inputs(words, hud->nav);
	if (wording_place(out, hud->nav, hud->units, input ? words : NULL))
		return true;
	memcpy(out, words, sizeof(words));
	return input;
}

/* Beside the compass if that is free, else below it and the manoeuvre card. */
void hud_status(struct hud *hud)
{
	char words[WORDING_MAX];
	bool of_car = words_of_car(words, hud);
	if (!of_car && !hud->devices)
		return;
	struct text_line line = text_line_utf8(of_car ? words : hud->devices);
	float s = hud->scale, gap = 16.0f * s, height = 52.0f * s, width = pill_width(hud, &line);
	float right = hud->corner.x0 - gap, y = (hud->corner.y0 + hud->corner.y1 - height) / 2.0f;
	if (right - width < hud->next.x1 + gap) {
		right = hud->width - hud->margin;
		y = hud->corner.y1 + gap;
		if (right - width < hud->next.x1 + gap)
			y = fmaxf(y, hud->next.y1 + gap);
	}
	struct box box = { fmaxf(right - width, hud->margin), y, right, y + height };
	for (int i = 0; i < 8 && !hud_free(hud, box, 2.0f * s); i++) {
		box.y0 += height / 2.0f;
		box.y1 += height / 2.0f;
	}
	if (hud_free(hud, box, 2.0f * s))
		draw_pill(hud, box, &line);
}

void hud_message(struct hud *hud, const char *text)
{
	if (!text || !*text)
		return;
	struct text_line line = text_line_utf8(text);
	float s = hud->scale, height = 56.0f * s, gap = 16.0f * s, lowest = hud->bottom;
	float width = fminf(pill_width(hud, &line), hud->width - 2.0f * hud->margin), x = (hud->width - width) / 2.0f;
	for (uint32_t i = 0; i < hud->taken_count; i++) {
		const struct box *box = &hud->taken[i];
		if (box->y0 > hud->height / 2.0f && box->x0 < x + width + gap && box->x1 > x - gap)
			lowest = fminf(lowest, box->y0 - gap);
	}
	struct box box = { x, lowest - height, x + width, lowest };
	for (int i = 0; i < 12 && !hud_free(hud, box, 2.0f * s); i++) {
		box.y0 -= height / 4.0f;
		box.y1 -= height / 4.0f;
	}
	if (hud_free(hud, box, 2.0f * s))
		draw_pill(hud, box, &line);
}
