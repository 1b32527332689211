/* About half a millisecond a glyph, nearly all of it FreeType's distance field. */
#include "tools/bake/glyph_atlas.h"

#include <errno.h>
#include <ft2build.h>
#include FT_FREETYPE_H
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/bake/text_shape.h"

/* GLES 3 promises 2048 texels a side. */
#define ATLAS_SIDE_MAX 2048

void glyph_atlas_finish(struct glyph_atlas *atlas)
{
	for (size_t i = 0; i < atlas->glyphs.count; i++)
		free(atlas->glyphs.items[i].field);
	ARRAY_FINISH(&atlas->glyphs);
	free(atlas->slots);
	*atlas = (struct glyph_atlas){ 0 };
}

static uint32_t *find_slot(const struct glyph_atlas *atlas, uint32_t face, uint32_t glyph)
{
	uint32_t mask = atlas->slot_count - 1;
	uint32_t at = (uint32_t)hash_u64((uint64_t)face << 32 | glyph) & mask;
	for (;; at = (at + 1) & mask) {
		uint32_t number = atlas->slots[at];
		if (!number)
			return &atlas->slots[at];
		const struct atlas_glyph *held = &atlas->glyphs.items[number - 1];
		if (held->face == face && held->glyph == glyph)
			return &atlas->slots[at];
	}
}

static void grow_slots(struct glyph_atlas *atlas)
{
	size_t capacity = 0;
	free(atlas->slots);
	atlas->slot_count = atlas->slot_count ? atlas->slot_count * 2 : 1024;
	atlas->slots = array_grow(NULL, &capacity, atlas->slot_count, sizeof(uint32_t));
	memset(atlas->slots, 0, atlas->slot_count * sizeof(uint32_t));
	for (size_t i = 0; i < atlas->glyphs.count; i++)
		*find_slot(atlas, atlas->glyphs.items[i].face, atlas->glyphs.items[i].glyph) = (uint32_t)i + 1;
}

uint32_t glyph_atlas_add(
	struct glyph_atlas *atlas, const struct font_set *fonts, uint32_t face, uint32_t glyph, uint32_t codepoint)
{
	if (2 * (atlas->glyphs.count + 1) > atlas->slot_count)
		grow_slots(atlas);
	uint32_t *slot = find_slot(atlas, face, glyph);
	if (*slot && !codepoint)
		return *slot - 1;
	bool box = glyph == TEXT_GLYPH_MISSING;
	struct atlas_glyph added = { .face = face, .glyph = glyph };
	added.out.codepoint = codepoint;
	added.out.advance_em = box ? TEXT_MISSING_ADVANCE_EM : font_advance_em(fonts, face, glyph);
	ARRAY_PUSH(&atlas->glyphs, added);
	if (!*slot)
		*slot = (uint32_t)atlas->glyphs.count;
	return (uint32_t)atlas->glyphs.count - 1;
}

static uint8_t *new_field(struct atlas_glyph *glyph, unsigned width, unsigned height)
{
	size_t capacity = 0;
	free(glyph->field);
	glyph->field = array_grow(NULL, &capacity, (size_t)width * height, 1);
	glyph->out.atlas_width = (uint16_t)width;
	glyph->out.atlas_height = (uint16_t)height;
	return glyph->field;
}

/* An upright frame, 0.5 by 0.7 em, standing on the base line. */
static void draw_box(struct atlas_glyph *glyph, unsigned em_px)
{
	float em = (float)em_px, half_x = 0.22f * em, half_y = 0.34f * em, stroke = 0.035f * em;
	unsigned width = (unsigned)ceilf(2.0f * half_x) + 2 * GLYPH_SPREAD_PX;
	unsigned height = (unsigned)ceilf(2.0f * half_y) + 2 * GLYPH_SPREAD_PX;
	uint8_t *field = new_field(glyph, width, height);
	for (unsigned y = 0; y < height; y++) {
		for (unsigned x = 0; x < width; x++) {
			float dx = fabsf((float)x + 0.5f - (float)width / 2.0f) - half_x;
			float dy = fabsf((float)y + 0.5f - (float)height / 2.0f) - half_y;
			float outside = hypotf(fmaxf(dx, 0.0f), fmaxf(dy, 0.0f)) + fminf(fmaxf(dx, dy), 0.0f);
			float inside = stroke - fabsf(outside);
			float value = 128.0f + inside * (128.0f / GLYPH_SPREAD_PX);
			field[y * width + x] = (uint8_t)fminf(fmaxf(value, 0.0f), 255.0f);
		}
	}
	glyph->out.left_em = TEXT_MISSING_ADVANCE_EM / 2.0f - (float)width / 2.0f / em;
	glyph->out.top_em = 0.35f + (float)height / 2.0f / em;
}

static void draw_outline(struct atlas_glyph *glyph, const struct font_set *fonts, unsigned em_px)
{
	FT_Face face = fonts->faces[glyph->face].outline;
	free(glyph->field);
	glyph->field = NULL;
	glyph->out.atlas_width = glyph->out.atlas_height = 0;
	if (FT_Load_Glyph(face, glyph->glyph, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP))
		return;
	if (face->glyph->format != FT_GLYPH_FORMAT_OUTLINE || !face->glyph->outline.n_points ||
		FT_Render_Glyph(face->glyph, FT_RENDER_MODE_SDF))
		return;
	const FT_Bitmap *bitmap = &face->glyph->bitmap;
	if (!bitmap->width || !bitmap->rows || bitmap->width > 512 || bitmap->rows > 512)
		return;
	uint8_t *field = new_field(glyph, bitmap->width, bitmap->rows);
	for (unsigned row = 0; row < bitmap->rows; row++)
		memcpy(field + (size_t)row * bitmap->width, bitmap->buffer + (ptrdiff_t)row * bitmap->pitch, bitmap->width);
	glyph->out.left_em = (float)face->glyph->bitmap_left / (float)em_px;
	glyph->out.top_em = (float)face->glyph->bitmap_top / (float)em_px;
}

/* Tallest first, then by number: shelves waste little and the order is total. */
static int by_height(const void *a, const void *b)
{
	const struct atlas_glyph *x = *(const struct atlas_glyph *const *)a, *y = *(const struct atlas_glyph *const *)b;
	if (x->out.atlas_height != y->out.atlas_height)
		return x->out.atlas_height < y->out.atlas_height ? 1 : -1;
	return x < y ? -1 : x > y;
}

/* Shelf packing with one texel between. Returns how many found no room; these get an empty rectangle. */
static uint32_t place(struct glyph_atlas *atlas, struct atlas_glyph **order, uint32_t width, bool drop)
{
	uint32_t x = 1, y = 1, shelf = 0, left_out = 0;
	for (size_t i = 0; i < atlas->glyphs.count; i++) {
		struct pkg_glyph *glyph = &order[i]->out;
		if (!glyph->atlas_width)
			continue;
		if (x + glyph->atlas_width + 1 > width) {
			x = 1;
			y += shelf + 1;
			shelf = 0;
		}
		if (y + glyph->atlas_height + 1 > ATLAS_SIDE_MAX) {
			left_out++;
			if (drop)
				glyph->atlas_width = glyph->atlas_height = 0;
			continue;
		}
		glyph->atlas_x = (uint16_t)x;
		glyph->atlas_y = (uint16_t)y;
		shelf = glyph->atlas_height > shelf ? glyph->atlas_height : shelf;
		x += glyph->atlas_width + 1u;
	}
	atlas->width = width;
	atlas->height = (y + shelf + 1 + 3) & ~3u;
	return left_out;
}

static uint32_t draw_and_place(struct glyph_atlas *atlas, const struct font_set *fonts, bool last)
{
	size_t capacity = 0, count = atlas->glyphs.count;
	struct atlas_glyph **order = array_grow(NULL, &capacity, count + 1, sizeof(*order));
	for (size_t i = 0; i < count; i++) {
		order[i] = &atlas->glyphs.items[i];
		if (order[i]->glyph == TEXT_GLYPH_MISSING)
			draw_box(order[i], atlas->em_px);
		else
			draw_outline(order[i], fonts, atlas->em_px);
	}
	qsort(order, count, sizeof(*order), by_height);
	uint32_t left_out = place(atlas, order, 1024, false);
	if (left_out || atlas->height > 1024)
		left_out = place(atlas, order, ATLAS_SIDE_MAX, last);
	free(order);
	return left_out;
}

int glyph_atlas_pack(struct glyph_atlas *atlas, struct font_set *fonts)
{
	static const unsigned sizes[] = { 48, 40, 32, 26, 20 };
	const size_t size_count = sizeof(sizes) / sizeof(sizes[0]);
	for (size_t i = 0; i < size_count; i++) {
		int status = font_set_size(fonts, sizes[i]);
		if (status < 0)
			return status;
		atlas->em_px = sizes[i];
		atlas->dropped = draw_and_place(atlas, fonts, i + 1 == size_count);
		if (!atlas->dropped)
			break;
	}
	return 0;
}

void glyph_atlas_blit(const struct glyph_atlas *atlas, uint8_t *texels)
{
	for (size_t i = 0; i < atlas->glyphs.count; i++) {
		const struct pkg_glyph *glyph = &atlas->glyphs.items[i].out;
		for (uint32_t row = 0; row < glyph->atlas_height; row++)
			memcpy(texels + (size_t)(glyph->atlas_y + row) * atlas->width + glyph->atlas_x,
				atlas->glyphs.items[i].field + (size_t)row * glyph->atlas_width, glyph->atlas_width);
	}
}
