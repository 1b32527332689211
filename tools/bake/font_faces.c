/* Opening fonts, once a bake. */
#include "tools/bake/font_faces.h"

#include <errno.h>
#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_MODULE_H
#include <hb.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/log.h"
#include "tools/bake/bake.h"

/* Sans faces of Debian's fonts-noto-core, fonts-noto-cjk, fonts-wqy-zenhei and fonts-dejavu-core. One plain, open
 * family first; the widest single font last, for whatever the others lack. */
static const char *const usual_fonts[] = {
	"/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansArabic-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansHebrew-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansArmenian-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansGeorgian-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansThai-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansLao-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansKhmer-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansMyanmar-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansDevanagari-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansBengali-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansGurmukhi-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansGujarati-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansTamil-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansTelugu-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansKannada-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansMalayalam-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansSinhala-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansEthiopic-Regular.ttf",
	"/usr/share/fonts/truetype/noto/NotoSansTifinagh-Regular.ttf",
	"/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc",
	"/usr/share/fonts/truetype/wqy/wqy-zenhei.ttc",
	"/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf",
	"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
};

size_t text_default_fonts(const char **files, size_t capacity)
{
	size_t count = 0;
	for (size_t i = 0; i < sizeof(usual_fonts) / sizeof(usual_fonts[0]); i++)
		if (count < capacity && access(usual_fonts[i], R_OK) == 0)
			files[count++] = usual_fonts[i];
	return count;
}

static int open_shaper(struct font_face *face, const char *path)
{
	hb_blob_t *blob = hb_blob_create_from_file_or_fail(path);
	if (!blob)
		return -EIO;
	hb_face_t *shared = hb_face_create(blob, 0);
	face->em_units = (float)hb_face_get_upem(shared);
	face->shaper = hb_font_create(shared);
	hb_face_destroy(shared);
	hb_blob_destroy(blob);
	return 0;
}

static int open_face(struct font_set *set, const char *path)
{
	if (access(path, R_OK) < 0)
		return -errno;
	struct font_face *face = &set->faces[set->count];
	FT_Error fault = FT_New_Face(set->library, path, 0, &face->outline);
	if (fault || !FT_IS_SCALABLE(face->outline)) {
		if (!fault)
			FT_Done_Face(face->outline);
		return -EILSEQ;
	}
	int status = open_shaper(face, path);
	if (status < 0) {
		FT_Done_Face(face->outline);
		return status;
	}
	set->count++;
	return 0;
}

static int log_face_error(const char *path, int status)
{
	if (status == -EILSEQ)
		log_error("%s: not a font with outlines", path);
	else
		log_error("%s: cannot open font: %s", path, strerror(-status));
	return status;
}

int font_set_open(struct font_set *set, const char *const *files, size_t file_count, int spread_px)
{
	*set = (struct font_set){ 0 };
	if (!file_count) {
		log_error("no font file given and none found in the usual places (package fonts-noto-core)");
		return -ENOENT;
	}
	if (FT_Init_FreeType(&set->library)) {
		log_error("FreeType does not start");
		return -ENOMEM;
	}
	FT_Int spread = spread_px;
	FT_Property_Set(set->library, "sdf", "spread", &spread);
	for (size_t i = 0; i < file_count && set->count < FONT_FACES_MAX; i++) {
		int status = open_face(set, files[i]);
		if (status < 0) {
			font_set_close(set);
			return log_face_error(files[i], status);
		}
	}
	return 0;
}

void font_set_close(struct font_set *set)
{
	for (uint32_t i = 0; i < set->count; i++) {
		hb_font_destroy(set->faces[i].shaper);
		FT_Done_Face(set->faces[i].outline);
	}
	if (set->library)
		FT_Done_FreeType(set->library);
	*set = (struct font_set){ 0 };
}

int font_set_size(struct font_set *set, unsigned em_px)
{
	for (uint32_t i = 0; i < set->count; i++)
		if (FT_Set_Pixel_Sizes(set->faces[i].outline, 0, em_px))
			return -EINVAL;
	return 0;
}

uint32_t font_glyph(const struct font_set *set, uint32_t face, uint32_t codepoint)
{
	hb_codepoint_t glyph = 0;
	return hb_font_get_nominal_glyph(set->faces[face].shaper, codepoint, &glyph) ? glyph : 0;
}

float font_advance_em(const struct font_set *set, uint32_t face, uint32_t glyph)
{
	const struct font_face *font = &set->faces[face];
	return (float)hb_font_get_glyph_h_advance(font->shaper, glyph) / font->em_units;
}
