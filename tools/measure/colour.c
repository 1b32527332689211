#include "tools/measure/colour.h"

#include <math.h>

/* Linear sRGB to XYZ of D65, and back. */
static const float to_xyz[3][3] = {
	{ 0.4124564f, 0.3575761f, 0.1804375f },
	{ 0.2126729f, 0.7151522f, 0.0721750f },
	{ 0.0193339f, 0.1191920f, 0.9503041f },
};
static const float from_xyz[3][3] = {
	{ 3.2404542f, -1.5371385f, -0.4985314f },
	{ -0.9692660f, 1.8760108f, 0.0415560f },
	{ 0.0556434f, -0.2040259f, 1.0572252f },
};
static const struct colour white = { 0.4124564f + 0.3575761f + 0.1804375f, 0.2126729f + 0.7151522f + 0.0721750f,
	0.0193339f + 0.1191920f + 0.9503041f };

static struct colour times(const float m[3][3], struct colour c)
{
	return (struct colour){ m[0][0] * c.x + m[0][1] * c.y + m[0][2] * c.z,
		m[1][0] * c.x + m[1][1] * c.y + m[1][2] * c.z, m[2][0] * c.x + m[2][1] * c.y + m[2][2] * c.z };
}

static struct colour relative_xyz(struct colour rgb)
{
	struct colour xyz = times(to_xyz, rgb);
	return (struct colour){ xyz.x / white.x, xyz.y / white.y, xyz.z / white.z };
}

float colour_linear(uint8_t srgb)
{
	double c = srgb / 255.0;
	return (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
}

struct colour colour_ycxcz_of_linear(struct colour rgb)
{
	struct colour r = relative_xyz(rgb);
	return (struct colour){ 116.0f * r.y - 16.0f, 500.0f * (r.x - r.y), 200.0f * (r.y - r.z) };
}

struct colour colour_linear_of_ycxcz(struct colour c)
{
	float y = (c.x + 16.0f) / 116.0f;
	return times(from_xyz, (struct colour){ (y + c.y / 500.0f) * white.x, y * white.y, (y - c.z / 200.0f) * white.z });
}

static float lab_curve(float t)
{
	const float delta = 6.0f / 29.0f;
	return t > delta * delta * delta ? cbrtf(t) : t / (3.0f * delta * delta) + 4.0f / 29.0f;
}

struct colour colour_lab_of_linear(struct colour rgb)
{
	struct colour r = relative_xyz(rgb);
	float x = lab_curve(r.x), y = lab_curve(r.y), z = lab_curve(r.z);
	return (struct colour){ 116.0f * y - 16.0f, 500.0f * (x - y), 200.0f * (y - z) };
}
