/* A card, its rows and where the list goes on: some thirty shapes and a few dozen glyphs, only while it is open. */
#include "render/menu.h"

#include <errno.h>
#include <math.h>

#include "render/hud.h"

/* Pixels of a 720 px screen */
#define WIDTH 452.0f
#define ROW 66.0f
#define PAD 10.0f
#define TEXT 32.0f
#define GAP 16.0f
#define TRIP_HEIGHT 108.0f
#define FEW_ROWS 4 /* fewer than these take the place of the arrival time */

int menu_words_init(struct menu_words *words, struct arena *arena, const struct text_font *font,
	const char *const *list, uint32_t count)
{
	*words = (struct menu_words){ .lines = ARENA_ARRAY(arena, struct text_line, count ? count : 1), .count = count };
	if (!words->lines)
		return -ENOMEM;
	int status = 0;
	for (uint32_t i = 0; i < count && status == 0; i++)
		status = text_line_set(font, list[i], arena, &words->lines[i]);
	return status;
}

/* Pointing left (-1) or right (1). */
static void draw_arrow(struct hud *hud, float x, float y, float way, struct rgba color)
{
	float half = 11.0f * hud->scale, reach = 12.0f * hud->scale * way;
	const struct vec2 points[3] = { { x, y - half }, { x + reach, y }, { x, y + half } };
	canvas_convex(hud->canvas, points, 3, 1.0f, color);
}

static void draw_bar(struct hud *hud, float x0, float x1, float y, int percent, struct rgba color)
{
	float half = 6.0f * hud->scale, end = x0 + (x1 - x0) * (float)percent / 100.0f;
	canvas_rounded_box(hud->canvas, (struct box){ x0, y - half, x1, y + half }, half, 1.0f, rgba_fade(color, 0.25f));
	canvas_rounded_box(
		hud->canvas, (struct box){ x0, y - half, fmaxf(end, x0 + 2.0f * half), y + half }, half, 1.0f, color);
	canvas_disc(hud->canvas, (struct vec2){ end, y }, 2.0f * half, color);
}

/* The value at the row's right end, between arrows while it is being changed. */
static void draw_value(struct hud *hud, const struct menu_words *words, const struct menu_row *row, struct box box,
	bool changing, struct rgba color)
{
	float s = hud->scale, y = (box.y0 + box.y1) / 2.0f, right = box.x1 - 36.0f * s, middle = box.x1 - 118.0f * s;
	if (row->bar != MENU_NO_BAR)
		draw_bar(hud, box.x1 - 190.0f * s, right, y, row->bar, color);
	else if (row->value != MENU_NO_WORD && changing)
		hud_text(hud, &words->lines[row->value], middle, y, TEXT * s, color, TEXT_CENTER, 0.0f);
	else if (row->value != MENU_NO_WORD)
		hud_text(hud, &words->lines[row->value], box.x1 - 20.0f * s, y, TEXT * s, color, TEXT_RIGHT, 0.0f);
	if (!changing)
		return;
	draw_arrow(hud, box.x1 - 214.0f * s, y, -1.0f, rgba_fade(color, row->at_least ? 0.25f : 1.0f));
	draw_arrow(hud, box.x1 - 22.0f * s, y, 1.0f, rgba_fade(color, row->at_most ? 0.25f : 1.0f));
}

static void draw_row(
	struct hud *hud, const struct menu_words *words, const struct menu_view *menu, unsigned index, struct box box)
{
	const struct menu_row *row = &menu->rows[index];
	const struct palette *palette = hud->palette;
	bool chosen = index == menu->chosen, changing = chosen && menu->changing;
	float s = hud->scale, y = (box.y0 + box.y1) / 2.0f;
	struct rgba label = chosen ? palette->choice_text : palette->text;
	struct rgba value = chosen ? palette->choice_text : palette->text_dim;
	if (chosen)
		canvas_rounded_box(hud->canvas, box, 10.0f * s, 1.0f, palette->choice);
	hud_text(hud, &words->lines[row->label], box.x0 + 20.0f * s, y, TEXT * s, label, TEXT_LEFT, 0.0f);
	draw_value(hud, words, row, box, changing, value);
}

/* How far down the list one is, where not all of it is seen. */
static void draw_place(struct hud *hud, struct box card, unsigned first, unsigned visible, unsigned count)
{
	float s = hud->scale, x = card.x1 - 7.0f * s, top = card.y0 + 16.0f * s, room = card.y1 - card.y0 - 32.0f * s;
	float y0 = top + room * (float)first / (float)count, y1 = top + room * (float)(first + visible) / (float)count;
	struct box track = { x - 2.0f * s, top, x + 2.0f * s, top + room }, thumb = { x - 2.0f * s, y0, x + 2.0f * s, y1 };
	canvas_rounded_box(hud->canvas, track, 2.0f * s, 1.0f, rgba_fade(hud->palette->text_dim, 0.25f));
	canvas_rounded_box(hud->canvas, thumb, 2.0f * s, 1.0f, rgba_fade(hud->palette->text_dim, 0.9f));
}

/* Below the compass and, on narrow screens, the manoeuvre; down to the arrival time, or over it where that leaves too
 * few rows. */
static unsigned choose_rows(struct hud *hud, const struct menu_view *menu, float x0, float *top)
{
	float s = hud->scale, gap = GAP * s, bottom = hud->bottom;
	unsigned few = menu->count < FEW_ROWS ? menu->count : FEW_ROWS;
	*top = hud->corner.y1 + gap;
	if (hud->next.x1 > x0 - gap)
		*top = fmaxf(*top, hud->next.y1 + gap);
	if (hud->nav->located && hud->nav->routed)
		bottom -= TRIP_HEIGHT * s + gap;
	float rows = floorf((bottom - *top - 2.0f * PAD * s) / (ROW * s));
	if (rows < (float)few) {
		hud->trip_covered = true;
		rows = fmaxf(floorf((hud->bottom - *top - 2.0f * PAD * s) / (ROW * s)), 1.0f);
	}
	return (unsigned)fminf(fminf(rows, MENU_VISIBLE_MAX), (float)menu->count);
}

/* The chosen row is in the middle of what is seen, but for the ends of the list. */
static unsigned first_row(const struct menu_view *menu, unsigned visible)
{
	unsigned above = visible / 2, last = menu->count - visible;
	unsigned first = menu->chosen > above ? menu->chosen - above : 0;
	return first < last ? first : last;
}

void hud_menu(struct hud *hud, const struct menu_words *words, const struct menu_view *menu)
{
	if (!menu || !menu->count || !words->count)
		return;
	float s = hud->scale, width = fminf(WIDTH * s, hud->width - 2.0f * hud->margin), top;
	float x0 = hud->width - hud->margin - width;
	unsigned visible = choose_rows(hud, menu, x0, &top), first = first_row(menu, visible);
	struct box card = { x0, top, x0 + width, top + (ROW * (float)visible + 2.0f * PAD) * s };
	bool cut = visible < menu->count;
	hud_card(hud, card, hud->palette->card);
	for (unsigned i = 0; i < visible; i++) {
		float y = card.y0 + (PAD + ROW * (float)i) * s;
		struct box row = { card.x0 + PAD * s, y + 2.0f * s, card.x1 - (cut ? PAD + 6.0f : PAD) * s,
			y + (ROW - 2.0f) * s };
		draw_row(hud, words, menu, first + i, row);
	}
	if (cut)
		draw_place(hud, card, first, visible, menu->count);
}
