/* Itemising and shaping; a few microseconds a character. */
#include "tools/bake/text_shape.h"

#include <fribidi.h>
#include <hb.h>
#include <string.h>

struct line {
	FriBidiChar text[TEXT_SHAPE_MAX];
	FriBidiLevel level[TEXT_SHAPE_MAX];
	hb_script_t script[TEXT_SHAPE_MAX];
	uint32_t face[TEXT_SHAPE_MAX];
	int count;
	bool cut;
};

struct run {
	int start, count;
	FriBidiLevel level;
};

/* Next character of a UTF-8 string, by the table of well-formed sequences (Unicode, table 3-7). */
static uint32_t utf8_next(const unsigned char **at)
{
	const unsigned char *p = *at;
	static const struct {
		unsigned char mask, lead;
		uint32_t least;
	} forms[] = { { 0x80, 0x00, 0 }, { 0xE0, 0xC0, 0x80 }, { 0xF0, 0xE0, 0x800 }, { 0xF8, 0xF0, 0x10000 } };
	for (int extra = 0; extra < 4; extra++) {
		if ((p[0] & forms[extra].mask) != forms[extra].lead)
			continue;
		uint32_t code = p[0] & (unsigned char)~forms[extra].mask;
		int i = 1;
		for (; i <= extra && (p[i] & 0xC0) == 0x80; i++)
			code = code << 6 | (p[i] & 0x3Fu);
		*at = p + i;
		bool whole = i == extra + 1 && code >= forms[extra].least && code <= 0x10FFFF;
		return whole && (code & 0xFFFFF800) != 0xD800 ? code : 0xFFFD;
	}
	*at = p + 1;
	return 0xFFFD;
}

static void decode(struct line *line, const char *utf8)
{
	const unsigned char *at = (const unsigned char *)utf8;
	line->count = 0;
	while (*at && line->count < TEXT_SHAPE_MAX) {
		uint32_t code = utf8_next(&at);
		line->text[line->count++] = code < 0x20 || (code >= 0x7F && code < 0xA0) ? ' ' : code;
	}
	line->cut = *at != 0;
}

static void resolve_levels(struct line *line)
{
	FriBidiCharType types[TEXT_SHAPE_MAX];
	FriBidiBracketType brackets[TEXT_SHAPE_MAX];
	FriBidiParType base = FRIBIDI_PAR_ON;
	fribidi_get_bidi_types(line->text, line->count, types);
	fribidi_get_bracket_types(line->text, line->count, types, brackets);
	if (!fribidi_get_par_embedding_levels_ex(types, brackets, line->count, &base, line->level))
		memset(line->level, 0, sizeof(line->level));
}

static bool is_shared(hb_script_t script)
{
	return script == HB_SCRIPT_COMMON || script == HB_SCRIPT_INHERITED || script == HB_SCRIPT_UNKNOWN;
}

/* Punctuation and marks take the script of what stands before them; at the start, of what follows. */
static void resolve_scripts(struct line *line)
{
	hb_unicode_funcs_t *unicode = hb_unicode_funcs_get_default();
	hb_script_t last = HB_SCRIPT_LATIN;
	for (int i = line->count - 1; i >= 0; i--) {
		line->script[i] = hb_unicode_script(unicode, line->text[i]);
		if (!is_shared(line->script[i]))
			last = line->script[i];
	}
	for (int i = 0; i < line->count; i++) {
		if (is_shared(line->script[i]))
			line->script[i] = last;
		last = line->script[i];
	}
}

static uint32_t choose_face(const struct font_set *fonts, const struct line *line, int at)
{
	hb_script_t own = hb_unicode_script(hb_unicode_funcs_get_default(), line->text[at]);
	/* cppcheck-suppress arrayIndexOutOfBoundsCond */
	if (at > 0 && is_shared(own) && font_glyph(fonts, line->face[at - 1], line->text[at]))
		return line->face[at - 1];
	for (uint32_t i = 0; i < fonts->count; i++)
		if (font_glyph(fonts, i, line->text[at]))
			return i;
	return at > 0 && own == HB_SCRIPT_INHERITED ? line->face[at - 1] : 0;
}

static bool same_run(const struct line *line, int a, int b)
{
	return line->level[a] == line->level[b] && line->script[a] == line->script[b] && line->face[a] == line->face[b];
}

static int cut_runs(const struct line *line, struct run *runs)
{
	int count = 0;
	for (int i = 0; i < line->count; i++) {
		if (i == 0 || !same_run(line, i - 1, i))
			runs[count++] = (struct run){ .start = i, .level = line->level[i] };
		runs[count - 1].count++;
	}
	return count;
}

static void reverse_runs(struct run *runs, int first, int end)
{
	for (; first < end - 1; first++, end--) {
		struct run swap = runs[first];
		runs[first] = runs[end - 1];
		runs[end - 1] = swap;
	}
}

/* Rule L2 of UAX #9, on whole runs. */
static void order_runs(struct run *runs, int count)
{
	int highest = 0;
	for (int i = 0; i < count; i++)
		highest = runs[i].level > highest ? runs[i].level : highest;
	for (int level = highest; level >= 1; level--) {
		for (int i = 0; i < count; i++) {
			int end = i;
			while (end < count && runs[end].level >= level)
				end++;
			reverse_runs(runs, i, end);
			i = end > i ? end - 1 : i;
		}
	}
}

static void shape_run(const struct font_set *fonts, const struct line *line, const struct run *run, hb_buffer_t *buffer)
{
	hb_buffer_clear_contents(buffer);
	hb_buffer_add_utf32(buffer, line->text, line->count, (unsigned)run->start, run->count);
	hb_buffer_set_direction(buffer, run->level & 1 ? HB_DIRECTION_RTL : HB_DIRECTION_LTR);
	hb_buffer_set_script(buffer, line->script[run->start]);
	hb_buffer_set_language(buffer, hb_language_from_string("und", -1));
	hb_shape(fonts->faces[line->face[run->start]].shaper, buffer, NULL, 0);
}

static void append_run(const struct font_set *fonts, uint32_t face, hb_buffer_t *buffer, struct shaped_text *out)
{
	unsigned count = 0;
	const hb_glyph_info_t *info = hb_buffer_get_glyph_infos(buffer, &count);
	const hb_glyph_position_t *at = hb_buffer_get_glyph_positions(buffer, NULL);
	float unit = 1.0f / fonts->faces[face].em_units;
	for (unsigned i = 0; i < count; i++) {
		bool missing = info[i].codepoint == 0;
		struct shaped_glyph glyph = {
			.face = missing ? 0 : face,
			.glyph = missing ? TEXT_GLYPH_MISSING : info[i].codepoint,
			.x_em = out->width_em + (float)at[i].x_offset * unit,
			.y_em = (float)at[i].y_offset * unit,
		};
		ARRAY_PUSH(&out->glyphs, glyph);
		out->missing += missing;
		out->width_em += missing ? TEXT_MISSING_ADVANCE_EM : (float)at[i].x_advance * unit;
	}
}

void text_shape(const struct font_set *fonts, const char *utf8, struct shaped_text *out)
{
	struct line line;
	struct run runs[TEXT_SHAPE_MAX];
	out->glyphs.count = 0;
	out->width_em = 0.0f;
	out->missing = 0;
	decode(&line, utf8);
	out->cut = line.cut;
	if (!line.count)
		return;
	resolve_levels(&line);
	resolve_scripts(&line);
	for (int i = 0; i < line.count; i++)
		line.face[i] = choose_face(fonts, &line, i);
	int run_count = cut_runs(&line, runs);
	order_runs(runs, run_count);
	hb_buffer_t *buffer = hb_buffer_create();
	for (int i = 0; i < run_count; i++) {
		shape_run(fonts, &line, &runs[i], buffer);
		append_run(fonts, line.face[runs[i].start], buffer, out);
	}
	hb_buffer_destroy(buffer);
}
