/* Letters on a grid of 4 x 6, corners cut: some dozen vertices a stroke. */
#include "render/stroke_font.h"

#define GRID_HEIGHT 6.0f
#define GAP 2.2f /* between letters, grid units */
#define BLANK 1.0f
#define WIDTH 0.95f /* of a stroke */
#define POINTS_MAX 20

/* Strokes separated by blanks, each a list of places "xy"; a place alone is a dot. */
static const char *const letters['Z' - ' ' + 1] = {
	['!' - ' '] = "0602 00",
	['%' - ' '] = "0046 06 40",
	['+' - ' '] = "2125 0343",
	[',' - ' '] = "10",
	['-' - ' '] = "0333",
	['.' - ' '] = "00",
	['/' - ' '] = "0046",
	['0' - ' '] = "1001051636454130 3010",
	['1' - ' '] = "042620",
	['2' - ' '] = "05163645440040",
	['3' - ' '] = "0516364544334241301001 1333",
	['4' - ' '] = "303602 0242",
	['5' - ' '] = "460603334241301001",
	['6' - ' '] = "4536160501103041423303",
	['7' - ' '] = "064610",
	['8' - ' '] = "13040516364544331302011030414233",
	['9' - ' '] = "0110304145361605041343",
	[':' - ' '] = "01 04",
	['?' - ' '] = "05163645442322 20",
	['A' - ' '] = "000516364540 0343",
	['B' - ' '] = "000636454433424130 3000 0333",
	['C' - ' '] = "4536160501103041",
	['D' - ' '] = "00063645413000",
	['E' - ' '] = "46060040 0333",
	['F' - ' '] = "460600 0333",
	['G' - ' '] = "45361605011030414323",
	['H' - ' '] = "0006 4046 0343",
	['I' - ' '] = "0006",
	['J' - ' '] = "4641301001",
	['K' - ' '] = "0006 46 4603 0340",
	['L' - ' '] = "060040",
	['M' - ' '] = "0006234640",
	['N' - ' '] = "00064046",
	['O' - ' '] = "1001051636454130 3010",
	['P' - ' '] = "00063645443303",
	['Q' - ' '] = "1001051636454130 3010 2240",
	['R' - ' '] = "00063645443303 2340",
	['S' - ' '] = "453616050413334241301001",
	['T' - ' '] = "0646 2620",
	['U' - ' '] = "060110304146",
	['V' - ' '] = "062046",
	['W' - ' '] = "0610233046",
	['X' - ' '] = "0046 0640",
	['Y' - ' '] = "062346 2320",
	['Z' - ' '] = "06460040",
};

static const char *letter(char c)
{
	if (c >= 'a' && c <= 'z')
		c = (char)(c - 'a' + 'A');
	return c >= ' ' && c <= 'Z' ? letters[c - ' '] : NULL;
}

static float letter_width(const char *strokes)
{
	float widest = 0.0f;
	for (const char *at = strokes; *at; at += at[0] == ' ' ? 1 : 2)
		if (*at != ' ' && (float)(*at - '0') > widest)
			widest = (float)(*at - '0');
	return widest;
}

float stroke_font_width(const char *text, float cap_px)
{
	float width = 0.0f;
	for (const char *at = text; *at; at++) {
		const char *strokes = letter(*at);
		width += (at > text ? GAP : 0.0f) + (strokes ? letter_width(strokes) : BLANK);
	}
	return width * cap_px / GRID_HEIGHT;
}

static void draw_letter(
	struct canvas *canvas, const char *strokes, float x, float base, float unit, float width_px, struct rgba color)
{
	while (*strokes) {
		struct vec2 points[POINTS_MAX];
		uint32_t count = 0;
		for (; *strokes && *strokes != ' '; strokes += 2)
			if (count < POINTS_MAX)
				points[count++] =
					(struct vec2){ x + (float)(strokes[0] - '0') * unit, base - (float)(strokes[1] - '0') * unit };
		strokes += *strokes == ' ';
		if (count > 1)
			canvas_stroke(canvas, points, count, width_px, color);
		else if (count)
			canvas_disc(canvas, points[0], width_px * 0.6f, color);
	}
}

static void draw_all(
	struct canvas *canvas, const char *text, float x, float base, float unit, float width_px, struct rgba color)
{
	for (const char *at = text; *at; at++) {
		const char *strokes = letter(*at);
		if (strokes)
			draw_letter(canvas, strokes, x, base, unit, width_px, color);
		x += ((strokes ? letter_width(strokes) : BLANK) + GAP) * unit;
	}
}

float stroke_font_draw(struct canvas *canvas, const char *text, float x, float y, const struct stroke_style *style)
{
	float width = stroke_font_width(text, style->cap_px), unit = style->cap_px / GRID_HEIGHT;
	float left = style->align == TEXT_LEFT ? x : style->align == TEXT_CENTER ? x - width / 2.0f : x - width;
	float base = y + style->cap_px / 2.0f, stroke_px = WIDTH * unit;
	if (style->halo_px > 0.0f)
		draw_all(canvas, text, left, base, unit, stroke_px + 2.0f * style->halo_px, style->halo);
	draw_all(canvas, text, left, base, unit, stroke_px, style->color);
	return width;
}
