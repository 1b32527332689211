/* Shaping in several scripts, the atlas and its section. Uses Debian's Noto fonts; skipped without them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <stdio.h>
#include <unistd.h>

#include "platform/base/log.h"
#include "tools/bake/bake.h"
#include "tools/bake/text_shape.h"

static const char *files[FONT_FACES_MAX];
static size_t file_count;

static int find_fonts(void **state)
{
	(void)state;
	log_init("test", LOG_ERROR);
	file_count = text_default_fonts(files, FONT_FACES_MAX);
	return 0;
}

static void need_fonts(void)
{
	if (file_count < 3) {
		printf("skipped: no fonts\n");
		skip();
	}
}

static void scripts_shape_to_the_expected_glyphs(void **state)
{
	(void)state;
	need_fonts();
	static const struct {
		const char *text;
		size_t glyphs;
		uint32_t missing;
	} rows[] = {
		{ "", 0, 0 }, { "Rue du Rh\xC3\xB4ne", 12, 0 }, { "\xCE\x9F\xCE\xB4\xCF\x8C\xCF\x82", 4, 0 }, /* Greek */
		{ "\xD0\xA3\xD0\xBB\xD0\xB8\xD1\x86\xD0\xB0", 5, 0 },                                         /* Cyrillic */
		{ "\xD7\xA8\xD7\x97\xD7\x95\xD7\x91", 4, 0 },                                                 /* Hebrew */
		{ "\xD8\xB4\xD8\xA7\xD8\xB1\xD8\xB9", 4, 0 }, /* Arabic, four letters */
		{ "e\xCC\x81", 1, 0 },                        /* e and a combining acute compose */
		{ "\xF3\xB0\x80\x80", 1, 1 },                 /* private use: the box */
		{ "a\x01\tb", 4, 0 },                         /* controls are spaces */
		{ "\xFF\xC3", 2, 0 },                         /* broken UTF-8: two U+FFFD */
	};
	struct font_set fonts;
	assert_int_equal(font_set_open(&fonts, files, file_count, 8), 0);
	struct shaped_text shaped = { 0 };
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		text_shape(&fonts, rows[i].text, &shaped);
		assert_int_equal(shaped.glyphs.count, rows[i].glyphs);
		assert_int_equal(shaped.missing, rows[i].missing);
		assert_true(shaped.width_em >= 0.0f && (shaped.width_em > 0.0f) == (rows[i].glyphs > 0));
		for (size_t k = 1; k < shaped.glyphs.count; k++)
			assert_true(shaped.glyphs.items[k].x_em >= shaped.glyphs.items[k - 1].x_em - 0.3f);
	}
	ARRAY_FINISH(&shaped.glyphs);
	font_set_close(&fonts);
}

static uint32_t face_of(const struct font_set *fonts, uint32_t codepoint)
{
	for (uint32_t i = 0; i < fonts->count; i++)
		if (font_glyph(fonts, i, codepoint))
			return i;
	return UINT32_MAX;
}

static void right_to_left_text_is_in_visual_order(void **state)
{
	(void)state;
	need_fonts();
	struct font_set fonts;
	assert_int_equal(font_set_open(&fonts, files, file_count, 8), 0);
	struct shaped_text shaped = { 0 };
	/* alef bet 12: read from the right, so the number comes first from the left, its digits in order */
	text_shape(&fonts, "\xD7\x90\xD7\x91 12", &shaped);
	assert_int_equal(shaped.glyphs.count, 5);
	const struct shaped_glyph *g = shaped.glyphs.items;
	uint32_t hebrew = face_of(&fonts, 0x5D0);
	assert_int_equal(g[0].glyph, font_glyph(&fonts, g[0].face, '1'));
	assert_int_equal(g[1].glyph, font_glyph(&fonts, g[1].face, '2'));
	assert_int_equal(g[3].glyph, font_glyph(&fonts, hebrew, 0x5D1));
	assert_int_equal(g[4].glyph, font_glyph(&fonts, hebrew, 0x5D0));
	/* Latin line with a Hebrew word inside: only the word turns */
	text_shape(&fonts, "a \xD7\x90\xD7\x91 b", &shaped);
	g = shaped.glyphs.items;
	assert_int_equal(shaped.glyphs.count, 6);
	assert_int_equal(g[0].glyph, font_glyph(&fonts, g[0].face, 'a'));
	assert_int_equal(g[2].glyph, font_glyph(&fonts, hebrew, 0x5D1));
	assert_int_equal(g[3].glyph, font_glyph(&fonts, hebrew, 0x5D0));
	assert_int_equal(g[5].glyph, font_glyph(&fonts, g[5].face, 'b'));
	ARRAY_FINISH(&shaped.glyphs);
	font_set_close(&fonts);
}

static void arabic_letters_join(void **state)
{
	(void)state;
	need_fonts();
	struct font_set fonts;
	assert_int_equal(font_set_open(&fonts, files, file_count, 8), 0);
	struct shaped_text one = { 0 }, three = { 0 };
	text_shape(&fonts, "\xD8\xA8", &one);                   /* beh alone */
	text_shape(&fonts, "\xD8\xA8\xD8\xA8\xD8\xA8", &three); /* initial, medial, final */
	assert_int_not_equal(three.glyphs.items[0].glyph, three.glyphs.items[three.glyphs.count - 1].glyph);
	assert_true(three.width_em < 3.0f * one.width_em);
	ARRAY_FINISH(&one.glyphs);
	ARRAY_FINISH(&three.glyphs);
	font_set_close(&fonts);
}

static void too_long_a_name_is_cut(void **state)
{
	(void)state;
	need_fonts();
	char text[1001];
	memset(text, 'x', 1000);
	text[1000] = 0;
	struct font_set fonts;
	struct shaped_text shaped = { 0 };
	assert_int_equal(font_set_open(&fonts, files, file_count, 8), 0);
	text_shape(&fonts, text, &shaped);
	assert_true(shaped.cut);
	assert_int_equal(shaped.glyphs.count, TEXT_SHAPE_MAX);
	ARRAY_FINISH(&shaped.glyphs);
	font_set_close(&fonts);
}

static const char *const names[] = { "Rue de Lausanne", "\xD0\x9D\xD0\xB5\xD0\xB2\xD0\xB0", "\xF3\xB0\x80\x80?" };

static void section_is_whole_and_repeatable(void **state)
{
	(void)state;
	need_fonts();
	struct text_data a, b;
	assert_int_equal(text_bake(files, file_count, names, 3, &a), 0);
	assert_int_equal(text_bake(files, file_count, names, 3, &b), 0);
	assert_int_equal(a.font.count, b.font.count);
	assert_memory_equal(a.font.items, b.font.items, a.font.count);
	struct pkg_font font;
	memcpy(&font, a.font.items, sizeof(font));
	assert_int_equal(font.glyphs_offset % 4, 0);
	assert_int_equal(a.font.count, font.glyphs_offset + font.glyph_count * sizeof(struct pkg_glyph));
	assert_true(font.cap_height_em > 0.5f && font.cap_height_em < 0.9f && font.descent_em < 0.0f);
	for (uint32_t i = 0; i < font.glyph_count; i++) {
		struct pkg_glyph glyph;
		memcpy(&glyph, a.font.items + font.glyphs_offset + i * sizeof(glyph), sizeof(glyph));
		assert_true(glyph.atlas_x + glyph.atlas_width <= font.atlas_width);
		assert_true(glyph.atlas_y + glyph.atlas_height <= font.atlas_height);
		if (i < 0x7F - 0x20)
			assert_int_equal(glyph.codepoint, 0x20 + i);
	}
	for (size_t i = 0; i < a.runs.count; i++)
		assert_true(a.runs.items[i].glyph < font.glyph_count);
	assert_int_equal(a.texts.count, 3);
	text_data_finish(&a);
	text_data_finish(&b);
}

/* The distance at the middle of the stem of an "l" is inside, at the corners of every field far outside. */
static void fields_hold_distances(void **state)
{
	(void)state;
	need_fonts();
	struct text_data data;
	assert_int_equal(text_bake(files, file_count, NULL, 0, &data), 0);
	struct pkg_font font;
	struct pkg_glyph glyph;
	memcpy(&font, data.font.items, sizeof(font));
	memcpy(&glyph, data.font.items + font.glyphs_offset + ('l' - 0x20) * sizeof(glyph), sizeof(glyph));
	const uint8_t *atlas = data.font.items + sizeof(font);
	uint32_t middle_x = glyph.atlas_x + glyph.atlas_width / 2u, middle_y = glyph.atlas_y + glyph.atlas_height / 2u;
	assert_true(atlas[middle_y * font.atlas_width + middle_x] > 140);
	assert_true(atlas[glyph.atlas_y * font.atlas_width + glyph.atlas_x] < 30);
	text_data_finish(&data);
}

static void a_missing_font_is_an_error(void **state)
{
	(void)state;
	const char *absent[] = { "/nonexistent/font.ttf" }, *folder[] = { "/" };
	struct text_data data;
	assert_int_equal(text_bake(absent, 1, names, 3, &data), -ENOENT);
	assert_true(text_bake(folder, 1, names, 3, &data) < 0);
	assert_true(text_bake(NULL, 0, names, 3, &data) < 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(scripts_shape_to_the_expected_glyphs),
		cmocka_unit_test(right_to_left_text_is_in_visual_order),
		cmocka_unit_test(arabic_letters_join),
		cmocka_unit_test(too_long_a_name_is_cut),
		cmocka_unit_test(section_is_whole_and_repeatable),
		cmocka_unit_test(fields_hold_distances),
		cmocka_unit_test(a_missing_font_is_an_error),
	};
	return cmocka_run_group_tests(tests, find_fonts, NULL);
}
