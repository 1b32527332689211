/* A glyph costs a quad; a name of 20 letters about a microsecond. */
#include "render/text.h"

#include <errno.h>
#include <math.h>

static const struct pkg_glyph *glyph_at(const struct text_font *font, uint32_t glyph)
{
	return &font->pkg->glyphs[glyph];
}

static void add_extra(struct text_font *font, uint32_t codepoint, uint32_t glyph)
{
	if (font->extra_count == TEXT_EXTRA_MAX)
		return;
	uint32_t at = font->extra_count++;
	for (; at > 0 && font->extra[at - 1].codepoint > codepoint; at--)
		font->extra[at] = font->extra[at - 1];
	font->extra[at].codepoint = codepoint;
	font->extra[at].glyph = glyph;
}

void text_font_init(struct text_font *font, const struct pkg *pkg)
{
	*font = (struct text_font){ .pkg = pkg, .font = pkg->font };
	for (uint32_t i = 0; i < 256; i++)
		font->latin[i] = PKG_NONE;
	for (uint32_t i = 0; pkg->font && i < pkg->font->glyph_count; i++) {
		uint32_t codepoint = pkg->glyphs[i].codepoint;
		if (codepoint == 0)
			continue;
		if (codepoint < 256)
			font->latin[codepoint] = i;
		else
			add_extra(font, codepoint, i);
	}
}

static uint32_t glyph_of(const struct text_font *font, uint32_t codepoint)
{
	if (codepoint < 256)
		return font->latin[codepoint];
	for (uint32_t i = 0; i < font->extra_count; i++)
		if (font->extra[i].codepoint == codepoint)
			return font->extra[i].glyph;
	return PKG_NONE;
}

/* Lenient: stray bytes are read as Latin-1. At most three bytes: what the overlay's words use. */
static uint32_t next_codepoint(const char **at)
{
	const unsigned char *p = (const unsigned char *)*at;
	int extra = (p[0] & 0xE0) == 0xC0 ? 1 : (p[0] & 0xF0) == 0xE0 ? 2 : 0;
	uint32_t code = extra ? p[0] & (0x3Fu >> extra) : p[0];
	for (int i = 1; i <= extra; i++) {
		if ((p[i] & 0xC0) != 0x80) {
			*at += 1;
			return p[0];
		}
		code = code << 6 | (p[i] & 0x3Fu);
	}
	*at += 1 + extra;
	return code;
}

/* Hebrew, Arabic and their neighbours begin with these bytes. */
static bool starts_right_to_left(const char *utf8)
{
	for (const unsigned char *p = (const unsigned char *)utf8; *p; p++) {
		if (*p >= 0xD6 && *p <= 0xDF)
			return true;
		if (*p >= 'A' && *p != 0xC2)
			return false;
	}
	return false;
}

struct text_line text_line_utf8(const char *utf8)
{
	return (struct text_line){ .utf8 = utf8 };
}

struct text_line text_line_string(const struct text_font *font, uint32_t string)
{
	const char *utf8 = string ? pkg_string(font->pkg, string) : "";
	return (struct text_line){
		.shaped = string && font->font ? pkg_text_find(font->pkg, string) : NULL,
		.utf8 = utf8,
		.right_to_left = starts_right_to_left(utf8),
	};
}

int text_line_set(const struct text_font *font, const char *utf8, struct arena *arena, struct text_line *line)
{
	size_t most = strlen(utf8);
	struct pkg_text *text = ARENA_ARRAY(arena, struct pkg_text, 1);
	struct pkg_glyph_at *run = ARENA_ARRAY(arena, struct pkg_glyph_at, most + 1);
	if (!text || !run)
		return -ENOMEM;
	for (const char *at = utf8; font->font && *at;) {
		uint32_t glyph = glyph_of(font, next_codepoint(&at));
		if (glyph == PKG_NONE)
			continue;
		run[text->glyph_count++] = (struct pkg_glyph_at){ .glyph = glyph, .x_em = text->width_em };
		text->width_em += glyph_at(font, glyph)->advance_em;
	}
	*line = (struct text_line){ .shaped = text, .glyphs = run, .utf8 = utf8 };
	return 0;
}

static const struct pkg_glyph_at *run_of(const struct text_font *font, const struct text_line *line)
{
	return line->glyphs ? line->glyphs : font->pkg->glyph_runs + line->shaped->first_glyph;
}

bool text_line_empty(const struct text_line *line)
{
	return line->shaped ? line->shaped->glyph_count == 0 : !line->utf8 || !*line->utf8;
}

float text_width_em(const struct text_font *font, const struct text_line *line)
{
	float width = 0.0f;
	if (!font->font)
		return 0.0f;
	if (line->shaped)
		return line->shaped->width_em;
	for (const char *at = line->utf8; *at;) {
		uint32_t glyph = glyph_of(font, next_codepoint(&at));
		width += glyph == PKG_NONE ? 0.0f : glyph_at(font, glyph)->advance_em;
	}
	return width;
}

float text_fit(
	const struct text_font *font, const struct text_line *line, float largest, float smallest, float width_px)
{
	float em = text_width_em(font, line);
	return em * largest <= width_px ? largest : fmaxf(smallest, width_px / em);
}

float text_middle(const struct text_font *font, float size_px)
{
	return font->font ? 0.5f * font->font->cap_height_em * size_px : 0.0f;
}

static float start_of(float x, float width_px, enum text_align align)
{
	return align == TEXT_LEFT ? x : align == TEXT_CENTER ? x - width_px / 2.0f : x - width_px;
}

struct box text_box(
	const struct text_font *font, const struct text_line *line, float x, float y, const struct text_style *style)
{
	if (!font->font)
		return (struct box){ x, y, x, y };
	float width = text_width_em(font, line) * style->size_px, room = style->halo_px + style->weight * style->size_px;
	if (style->max_width_px > 0.0f)
		width = fminf(width, style->max_width_px);
	float x0 = start_of(x, width, style->align);
	return (struct box){ x0 - room, y - font->font->ascent_em * style->size_px - room, x0 + width + room,
		y - font->font->descent_em * style->size_px + room };
}

/* Where glyphs go: pen origin, size, rotation, and what all of them share. */
struct pen {
	struct canvas *canvas;
	const struct text_font *font;
	struct vec2 origin;
	float size_px, cosine, sine;
	float reach_em; /* the halo and the growth beyond the outline */
	struct canvas_vertex shape;
};

static struct vec2 pen_place(const struct pen *pen, float x_em, float y_em)
{
	float x = x_em * pen->size_px, y = -y_em * pen->size_px;
	return (struct vec2){ pen->origin.x + x * pen->cosine - y * pen->sine,
		pen->origin.y + x * pen->sine + y * pen->cosine };
}

static void draw_glyph(const struct pen *pen, uint32_t number, float x_em, float y_em)
{
	const struct pkg_glyph *glyph = glyph_at(pen->font, number);
	const struct pkg_font *font = pen->font->font;
	if (!glyph->atlas_width)
		return;
	float left = x_em + glyph->left_em, top = y_em + glyph->top_em;
	float right = left + glyph->atlas_width / font->em_px, bottom = top - glyph->atlas_height / font->em_px;
	float u = 1.0f / (float)font->atlas_width, v = 1.0f / (float)font->atlas_height;
	struct box uv = { glyph->atlas_x * u, glyph->atlas_y * v, (float)(glyph->atlas_x + glyph->atlas_width) * u,
		(float)(glyph->atlas_y + glyph->atlas_height) * v };
	const struct vec2 corners[4] = { pen_place(pen, left, top), pen_place(pen, right, top),
		pen_place(pen, right, bottom), pen_place(pen, left, bottom) };
	canvas_glyph(pen->canvas, corners, &uv, &pen->shape);
}

/* Glyphs whose box lies between `from_em` and `to_em` of the line. */
static void draw_between(const struct pen *pen, const struct text_line *line, float from_em, float to_em)
{
	const float slack = 1e-4f;
	if (line->shaped) {
		const struct pkg_glyph_at *run = run_of(pen->font, line);
		for (uint32_t i = 0; i < line->shaped->glyph_count; i++)
			if (run[i].x_em >= from_em - slack &&
				run[i].x_em + glyph_at(pen->font, run[i].glyph)->advance_em <= to_em + slack)
				draw_glyph(pen, run[i].glyph, run[i].x_em, run[i].y_em);
		return;
	}
	float x = 0.0f;
	for (const char *at = line->utf8; *at;) {
		uint32_t glyph = glyph_of(pen->font, next_codepoint(&at));
		if (glyph == PKG_NONE)
			continue;
		float end = x + glyph_at(pen->font, glyph)->advance_em;
		if (x >= from_em - slack && end <= to_em + slack)
			draw_glyph(pen, glyph, x, 0.0f);
		x = end;
	}
}

/* The last place not beyond `limit_em` where a glyph ends (with `from_left` false: the first one where a glyph starts).
 */
static float glyph_edge(const struct text_font *font, const struct text_line *line, float limit_em, bool from_left)
{
	float best = from_left ? 0.0f : limit_em, x = 0.0f;
	bool found = false;
	const char *at = line->utf8;
	for (uint32_t i = 0; line->shaped ? i < line->shaped->glyph_count : *at != 0; i++) {
		uint32_t glyph;
		if (line->shaped) {
			const struct pkg_glyph_at *run = run_of(font, line) + i;
			x = run->x_em;
			glyph = run->glyph;
		} else
			glyph = glyph_of(font, next_codepoint(&at));
		float advance = glyph == PKG_NONE ? 0.0f : glyph_at(font, glyph)->advance_em;
		bool blank = glyph == PKG_NONE || !glyph_at(font, glyph)->atlas_width;
		if (from_left && !blank && x + advance <= limit_em && x + advance > best)
			best = x + advance;
		if (!from_left && !blank && x >= limit_em && (!found || x < best)) {
			best = x;
			found = true;
		}
		x += advance;
	}
	return best;
}

/* Shortened with an ellipsis at the end of reading, close to the last letter that is left. */
static void draw_cut(struct pen *pen, const struct text_line *line, float width_em, float limit_em)
{
	struct text_line dots = text_line_utf8("\xE2\x80\xA6");
	float dots_em = text_width_em(pen->font, &dots), kept = fmaxf(limit_em - dots_em, 0.0f);
	struct vec2 origin = pen->origin;
	if (!line->right_to_left) {
		kept = glyph_edge(pen->font, line, kept, true);
		draw_between(pen, line, 0.0f, kept);
		pen->origin = pen_place(pen, kept, 0.0f);
		draw_between(pen, &dots, 0.0f, dots_em);
		return;
	}
	float start = glyph_edge(pen->font, line, width_em - kept, false);
	pen->origin = pen_place(pen, limit_em - width_em + start - dots_em, 0.0f);
	draw_between(pen, &dots, 0.0f, dots_em);
	pen->origin = origin;
	pen->origin = pen_place(pen, limit_em - width_em, 0.0f);
	draw_between(pen, line, start, width_em);
}

bool text_break(const struct text_font *font, const struct text_line *line, float limit_em, float *first_end_em,
	float *second_start_em)
{
	const struct pkg_text *shaped = line->shaped;
	bool found = false;
	if (!font->font || !shaped)
		return false;
	for (uint32_t i = 1; i + 1 < shaped->glyph_count; i++) {
		const struct pkg_glyph_at *at = run_of(font, line) + i;
		const struct pkg_glyph *glyph = glyph_at(font, at->glyph);
		float end = at->x_em + glyph->advance_em;
		if (glyph->atlas_width || glyph->advance_em <= 0.0f)
			continue;
		bool fits = line->right_to_left ? shaped->width_em - end <= limit_em && !found : at->x_em <= limit_em;
		if (!fits)
			continue;
		*first_end_em = at->x_em;
		*second_start_em = end;
		found = true;
	}
	return found;
}

static struct pen start_pen(struct canvas *canvas, const struct text_font *font, float x, float y, float width_px,
	const struct text_style *style)
{
	struct pen pen = { .canvas = canvas, .font = font, .size_px = style->size_px };
	float start = start_of(0.0f, width_px, style->align);
	pen.cosine = style->angle_rad == 0.0f ? 1.0f : cosf(style->angle_rad);
	pen.sine = style->angle_rad == 0.0f ? 0.0f : sinf(style->angle_rad);
	pen.origin = (struct vec2){ x + start * pen.cosine, y + start * pen.sine };
	/* 128 steps of the field are `spread_px` texels */
	pen.shape.range_px = 255.0f / 128.0f * font->font->spread_px * style->size_px / font->font->em_px;
	pen.shape.grow_px = style->weight * style->size_px;
	canvas_color(pen.shape.fill, style->fill);
	canvas_color(pen.shape.halo, style->halo);
	pen.shape.halo_px = fminf(style->halo_px, 0.45f * pen.shape.range_px - pen.shape.grow_px);
	if (style->halo_px <= 0.0f) {
		pen.shape.halo[3] = 0;
		pen.shape.halo_px = 0.0f;
	}
	return pen;
}

float text_draw_part(struct canvas *canvas, const struct text_font *font, const struct text_line *line, float from_em,
	float to_em, float x, float y, const struct text_style *style)
{
	if (!font->font || style->fill.a <= 0.0f)
		return 0.0f;
	float width_px = (to_em - from_em) * style->size_px;
	struct pen pen = start_pen(canvas, font, x, y, width_px, style);
	pen.origin = pen_place(&pen, -from_em, 0.0f);
	draw_between(&pen, line, from_em, to_em);
	return width_px;
}

float text_draw(struct canvas *canvas, const struct text_font *font, const struct text_line *line, float x, float y,
	const struct text_style *style)
{
	if (!font->font || text_line_empty(line) || style->fill.a <= 0.0f)
		return 0.0f;
	float width_em = text_width_em(font, line), limit_em = style->max_width_px / style->size_px;
	bool cut = style->max_width_px > 0.0f && width_em > limit_em + 1e-3f;
	float width_px = (cut ? limit_em : width_em) * style->size_px;
	struct pen pen = start_pen(canvas, font, x, y, width_px, style);
	if (cut)
		draw_cut(&pen, line, width_em, limit_em);
	else
		draw_between(&pen, line, 0.0f, width_em + 1.0f);
	return width_px;
}
