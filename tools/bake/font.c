/*
 * All text of a city: names are shaped here, never while driving. The runtime gets a texture of distance fields
 * (Green 2007, "Improved Alpha-Tested Magnification for Vector Textures and Special Effects"), glyph metrics, and for
 * every name a list of glyphs with their places.
 */
#include <errno.h>
#include <hb.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/bake/bake.h"
#include "tools/bake/glyph_atlas.h"
#include "tools/bake/text_shape.h"

/* What the overlay's own words and numbers may use beyond U+0020 to U+007E. */
static const struct {
	uint32_t first, last;
} ui_ranges[] = {
	{ 0xA0, 0xFF },     /* Latin-1 */
	{ 0x2013, 0x2014 }, /* dashes */
	{ 0x2018, 0x2019 }, /* quotes */
	{ 0x201C, 0x201D },
	{ 0x2026, 0x2026 }, /* ellipsis */
	{ 0x2190, 0x2193 }, /* arrows */
	{ 0x2196, 0x2199 },
};

static uint32_t first_face_with(const struct font_set *fonts, uint32_t codepoint)
{
	for (uint32_t i = 0; i < fonts->count; i++)
		if (font_glyph(fonts, i, codepoint))
			return i;
	return PKG_NONE;
}

static void add_ui_glyph(struct glyph_atlas *atlas, const struct font_set *fonts, uint32_t codepoint, bool needed)
{
	uint32_t face = first_face_with(fonts, codepoint);
	if (face != PKG_NONE)
		glyph_atlas_add(atlas, fonts, face, font_glyph(fonts, face, codepoint), codepoint);
	else if (needed)
		glyph_atlas_add(atlas, fonts, 0, TEXT_GLYPH_MISSING, codepoint);
}

static void add_ui_glyphs(struct glyph_atlas *atlas, const struct font_set *fonts)
{
	for (uint32_t codepoint = 0x20; codepoint <= 0x7E; codepoint++)
		add_ui_glyph(atlas, fonts, codepoint, true);
	for (size_t i = 0; i < sizeof(ui_ranges) / sizeof(ui_ranges[0]); i++)
		for (uint32_t codepoint = ui_ranges[i].first; codepoint <= ui_ranges[i].last; codepoint++)
			add_ui_glyph(atlas, fonts, codepoint, false);
}

struct tally {
	uint32_t missing, texts_with_missing, cut;
};

static void add_text(struct text_data *out, struct glyph_atlas *atlas, const struct font_set *fonts,
	const struct shaped_text *shaped, uint32_t string)
{
	struct pkg_text text = {
		.string = string,
		.first_glyph = (uint32_t)out->runs.count,
		.glyph_count = (uint32_t)shaped->glyphs.count,
		.width_em = shaped->width_em,
	};
	for (size_t i = 0; i < shaped->glyphs.count; i++) {
		const struct shaped_glyph *glyph = &shaped->glyphs.items[i];
		struct pkg_glyph_at at = {
			.glyph = glyph_atlas_add(atlas, fonts, glyph->face, glyph->glyph, 0),
			.x_em = glyph->x_em,
			.y_em = glyph->y_em,
		};
		ARRAY_PUSH(&out->runs, at);
	}
	ARRAY_PUSH(&out->texts, text);
}

static void shape_all(struct text_data *out, struct glyph_atlas *atlas, const struct font_set *fonts,
	const char *const *strings, size_t string_count, struct tally *tally)
{
	struct shaped_text shaped = { 0 };
	for (size_t i = 0; i < string_count; i++) {
		text_shape(fonts, strings[i], &shaped);
		add_text(out, atlas, fonts, &shaped, (uint32_t)i);
		ARRAY_PUSH(&out->strings, strings[i]);
		tally->missing += shaped.missing;
		tally->texts_with_missing += shaped.missing > 0;
		tally->cut += shaped.cut;
	}
	ARRAY_FINISH(&shaped.glyphs);
}

static float cap_height_em(const struct font_set *fonts)
{
	hb_glyph_extents_t box;
	uint32_t glyph = font_glyph(fonts, 0, 'H');
	if (!glyph || !hb_font_get_glyph_extents(fonts->faces[0].shaper, glyph, &box))
		return 0.7f;
	return (float)box.y_bearing / fonts->faces[0].em_units;
}

static struct pkg_font font_header(const struct glyph_atlas *atlas, const struct font_set *fonts)
{
	hb_font_extents_t line = { .ascender = 0 };
	const struct font_face *face = &fonts->faces[0];
	hb_font_get_h_extents(face->shaper, &line);
	uint32_t texels = atlas->width * atlas->height;
	return (struct pkg_font){
		.atlas_width = atlas->width,
		.atlas_height = atlas->height,
		.glyph_count = (uint32_t)atlas->glyphs.count,
		.glyphs_offset = (uint32_t)sizeof(struct pkg_font) + texels,
		.em_px = (float)atlas->em_px,
		.spread_px = GLYPH_SPREAD_PX,
		.ascent_em = (float)line.ascender / face->em_units,
		.descent_em = (float)line.descender / face->em_units,
		.cap_height_em = cap_height_em(fonts),
		.ascii_first = 0,
	};
}

static void write_section(struct text_data *out, const struct glyph_atlas *atlas, const struct font_set *fonts)
{
	struct pkg_font header = font_header(atlas, fonts);
	size_t bytes = header.glyphs_offset + header.glyph_count * sizeof(struct pkg_glyph);
	ARRAY_RESERVE(&out->font, bytes);
	out->font.count = bytes;
	memset(out->font.items, 0, bytes);
	memcpy(out->font.items, &header, sizeof(header));
	glyph_atlas_blit(atlas, out->font.items + sizeof(header));
	for (uint32_t i = 0; i < header.glyph_count; i++)
		memcpy(out->font.items + header.glyphs_offset + i * sizeof(struct pkg_glyph), &atlas->glyphs.items[i].out,
			sizeof(struct pkg_glyph));
}

static void log_result(const struct glyph_atlas *atlas, size_t string_count, const struct tally *tally)
{
	log_info("text: %zu names, %zu glyphs, atlas %u x %u at %u px", string_count, atlas->glyphs.count, atlas->width,
		atlas->height, atlas->em_px);
	if (tally->missing)
		log_warn("text: %u characters in %u names are in no font and are drawn as boxes", tally->missing,
			tally->texts_with_missing);
	if (tally->cut)
		log_warn("text: %u names are longer than %d characters and were cut", tally->cut, TEXT_SHAPE_MAX);
	if (atlas->dropped)
		log_warn("text: %u glyphs found no room in the atlas and are left blank", atlas->dropped);
}

int text_bake(const char *const *font_files, size_t font_file_count, const char *const *strings, size_t string_count,
	struct text_data *out)
{
	struct font_set fonts;
	struct glyph_atlas atlas = { 0 };
	struct tally tally = { 0 };
	*out = (struct text_data){ 0 };
	int status = font_set_open(&fonts, font_files, font_file_count, GLYPH_SPREAD_PX);
	if (status < 0)
		return status;
	add_ui_glyphs(&atlas, &fonts);
	shape_all(out, &atlas, &fonts, strings, string_count, &tally);
	status = glyph_atlas_pack(&atlas, &fonts);
	if (status == 0) {
		write_section(out, &atlas, &fonts);
		log_result(&atlas, string_count, &tally);
	} else {
		log_error("text: fonts cannot be drawn at any size");
		text_data_finish(out);
	}
	glyph_atlas_finish(&atlas);
	font_set_close(&fonts);
	return status;
}

void text_data_finish(struct text_data *text)
{
	ARRAY_FINISH(&text->font);
	ARRAY_FINISH(&text->texts);
	ARRAY_FINISH(&text->runs);
	ARRAY_FINISH(&text->strings);
}
