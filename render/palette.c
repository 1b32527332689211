/* Two tables. By night nothing is brighter than a light grey: white dazzles. */
#include "render/palette.h"

static const struct {
	size_t offset;
	uint32_t day, night;
	float day_alpha, night_alpha;
} rows[] = {
#define ROW(member, day, day_alpha, night, night_alpha)                                                                \
	{                                                                                                                  \
		offsetof(struct palette, member), day, night, day_alpha, night_alpha                                           \
	}
	ROW(card, 0xFBFCFD, 0.95f, 0x131A23, 0.93f),
	ROW(card_edge, 0xFFFFFF, 0.0f, 0x2A3542, 0.9f),
	ROW(shadow, 0x0A1420, 0.30f, 0x000000, 0.45f),
	ROW(text, 0x16202B, 1.0f, 0xC6CFDA, 1.0f),
	ROW(text_dim, 0x51606E, 1.0f, 0x8896A5, 1.0f),
	ROW(accent, 0x0F3D63, 0.97f, 0x12283C, 0.96f),
	ROW(accent_text, 0xFFFFFF, 1.0f, 0xD2DAE3, 1.0f),
	ROW(accent_dim, 0xB9D2E8, 1.0f, 0x8FA6BB, 1.0f),
	ROW(route, 0x1677FF, 1.0f, 0x2F6FD0, 1.0f),
	ROW(route_edge, 0xBFE0FF, 1.0f, 0x7FAAE0, 1.0f),
	ROW(route_arrow, 0xFFFFFF, 1.0f, 0xCBDDF2, 1.0f),
	ROW(route_shade, 0x2C6FC4, 1.0f, 0x1F4677, 1.0f),
	ROW(label, 0x1B2733, 1.0f, 0xB9C4D0, 1.0f),
	ROW(label_halo, 0xFFFFFF, 0.92f, 0x0A1017, 0.9f),
	ROW(label_strong, 0x0B4FB8, 1.0f, 0x8DBBF5, 1.0f),
	ROW(warning, 0xFFE3A8, 0.97f, 0x4A3914, 0.95f),
	ROW(warning_text, 0x4A3200, 1.0f, 0xE3C27A, 1.0f),
	ROW(choice, 0x0F3D63, 1.0f, 0x2A4560, 1.0f),
	ROW(choice_text, 0xFFFFFF, 1.0f, 0xDCE4EC, 1.0f),
	ROW(over_limit, 0xC21F1F, 1.0f, 0xE08A80, 1.0f),
	ROW(sign_face, 0xFFFFFF, 1.0f, 0xBFC5CB, 1.0f),
	ROW(sign_ring, 0xD3202A, 1.0f, 0xA3242B, 1.0f),
	ROW(sign_text, 0x111111, 1.0f, 0x14181C, 1.0f),
	ROW(north, 0xD3202A, 1.0f, 0xC4565A, 1.0f),
#undef ROW
};
static_assert(sizeof(rows) / sizeof(rows[0]) == sizeof(struct palette) / sizeof(struct rgba), "every colour has a row");

static float mix(float a, float b, float t)
{
	return a + (b - a) * t;
}

void palette_mix(struct palette *out, float day)
{
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct rgba light = rgba_hex(rows[i].day, rows[i].day_alpha);
		struct rgba dark = rgba_hex(rows[i].night, rows[i].night_alpha);
		struct rgba color = { mix(dark.r, light.r, day), mix(dark.g, light.g, day), mix(dark.b, light.b, day),
			mix(dark.a, light.a, day) };
		memcpy((char *)out + rows[i].offset, &color, sizeof(color));
	}
}
