/* What all widgets share, the compass and the data credit. */
#include "render/hud.h"

#include <math.h>

void hud_take(struct hud *hud, struct box box)
{
	if (hud->taken_count < HUD_BOXES_MAX)
		hud->taken[hud->taken_count++] = box;
}

bool hud_free(const struct hud *hud, struct box box, float gap)
{
	if (box.x0 < 0.0f || box.y0 < 0.0f || box.x1 > hud->width || box.y1 > hud->height)
		return false;
	for (uint32_t i = 0; i < hud->taken_count; i++) {
		const struct box *other = &hud->taken[i];
		if (box.x0 - gap < other->x1 && box.x1 + gap > other->x0 && box.y0 - gap < other->y1 &&
			box.y1 + gap > other->y0)
			return false;
	}
	return true;
}

static void draw_card(struct hud *hud, struct box box, float radius, struct rgba color)
{
	float s = hud->scale;
	struct box shadow = { box.x0 - 1.0f * s, box.y0 + 2.0f * s, box.x1 + 1.0f * s, box.y1 + 4.0f * s };
	canvas_rounded_box(hud->canvas, shadow, radius, 12.0f * s, hud->palette->shadow);
	if (hud->palette->card_edge.a > 0.01f) {
		struct box edge = { box.x0 - 1.0f, box.y0 - 1.0f, box.x1 + 1.0f, box.y1 + 1.0f };
		canvas_rounded_box(hud->canvas, edge, radius + 1.0f, 1.0f, hud->palette->card_edge);
	}
	canvas_rounded_box(hud->canvas, box, radius, 1.0f, color);
	hud_take(hud, box);
}

void hud_card(struct hud *hud, struct box box, struct rgba color)
{
	draw_card(hud, box, 14.0f * hud->scale, color);
}

float hud_text(struct hud *hud, const struct text_line *line, float x, float y, float size_px, struct rgba color,
	enum text_align align, float max_width)
{
	struct text_style style = { .size_px = size_px, .fill = color, .weight = 0.012f, .align = align };
	style.max_width_px = max_width;
	return text_draw(hud->canvas, hud->font, line, x, y + text_middle(hud->font, size_px), &style);
}

void hud_compass(struct hud *hud, float heading_rad)
{
	float s = hud->scale, radius = 32.0f * s;
	struct vec2 center = { hud->width - hud->margin - radius, hud->margin + radius };
	hud->corner = (struct box){ center.x - radius, center.y - radius, center.x + radius, center.y + radius };
	draw_card(hud, hud->corner, radius, hud->palette->card);
	/* north is to the left of up by the heading */
	float dx = -sinf(heading_rad), dy = -cosf(heading_rad);
	const struct vec2 needle[3] = {
		{ center.x + dx * 27.0f * s, center.y + dy * 27.0f * s },
		{ center.x + dx * 15.0f * s - dy * 8.0f * s, center.y + dy * 15.0f * s + dx * 8.0f * s },
		{ center.x + dx * 15.0f * s + dy * 8.0f * s, center.y + dy * 15.0f * s - dx * 8.0f * s },
	};
	canvas_convex(hud->canvas, needle, 3, 1.0f, hud->palette->north);
	struct text_line letter = text_line_utf8("N");
	hud_text(hud, &letter, center.x - dx * 3.0f * s, center.y - dy * 3.0f * s, 25.0f * s, hud->palette->text,
		TEXT_CENTER, 0.0f);
}

/* Where a line of at most `width_px` may end: after the last space or comma that fits; the whole length if it fits. */
static size_t break_at(const struct hud *hud, const char *text, float size_px, float width_px)
{
	char part[256];
	size_t best = 0, length = strlen(text);
	for (size_t i = 1; i <= length && i < sizeof(part); i++) {
		if (i < length && text[i] != ' ')
			continue;
		memcpy(part, text, i);
		part[i] = 0;
		struct text_line line = text_line_utf8(part);
		if (text_width_em(hud->font, &line) * size_px > width_px)
			break;
		best = i;
	}
	return best ? best : (length < sizeof(part) ? length : sizeof(part) - 1);
}

/* Always there, at the bottom right, in one line if it can be, in two otherwise. */
void hud_credit(struct hud *hud)
{
	const char *text = pkg_string(hud->pkg, hud->pkg->meta->attribution);
	float s = hud->scale, size = 24.0f * s, width = hud->width - 2.0f * hud->margin;
	hud->bottom = hud->height - hud->margin;
	if (!*text || !hud->font->font)
		return;
	char lines[2][256] = { { 0 } };
	size_t first = break_at(hud, text, size, width);
	memcpy(lines[0], text, first);
	while (text[first] == ' ')
		first++;
	strncpy(lines[1], text + first, sizeof(lines[1]) - 1);
	int count = lines[1][0] ? 2 : 1;
	float line_height = 30.0f * s, top = hud->height - 10.0f * s - line_height * (float)count, widest = 0.0f;
	for (int i = 0; i < count; i++) {
		struct text_line line = text_line_utf8(lines[i]);
		struct text_style style = {
			.size_px = size,
			.fill = rgba_fade(hud->palette->label, 0.85f),
			.halo = rgba_fade(hud->palette->label_halo, 0.75f),
			.halo_px = 2.5f * s,
			.align = TEXT_RIGHT,
			.max_width_px = width,
		};
		float y = top + line_height * ((float)i + 0.5f) + text_middle(hud->font, size);
		widest = fmaxf(widest, text_draw(hud->canvas, hud->font, &line, hud->width - hud->margin, y, &style));
	}
	hud_take(hud, (struct box){ hud->width - hud->margin - widest, top, hud->width - hud->margin, hud->height });
	hud->bottom = top - 8.0f * s;
}
