/* Runs the painters and turns their layers into the MATL and TEXA sections; a second or so, once a bake. */
#include "tools/bake/materials.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/bake/etc2.h"

#define PX MATERIAL_TEXTURE_PX
#define LAYER_TEXELS ((size_t)PX * PX)

/* sRGB transfer function, IEC 61966-2-1. */
static float linear_of(uint8_t srgb)
{
	float c = (float)srgb / 255.0f;
	return c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f);
}

static uint8_t srgb_of(float linear)
{
	float c = linear <= 0.0031308f ? linear * 12.92f : 1.055f * powf(linear, 1.0f / 2.4f) - 0.055f;
	return (uint8_t)lrintf(fminf(fmaxf(c, 0.0f), 1.0f) * 255.0f);
}

static void halve(uint8_t (*to)[4], const uint8_t (*from)[4], unsigned to_px, const float linear[256])
{
	unsigned from_px = to_px * 2;
	for (unsigned y = 0; y < to_px; y++) {
		for (unsigned x = 0; x < to_px; x++) {
			const uint8_t(*row)[4] = from + (size_t)y * 2 * from_px + (size_t)x * 2;
			const uint8_t *texels[4] = { row[0], row[1], row[from_px], row[from_px + 1] };
			float sum[3] = { 0 };
			unsigned alpha = 2;
			for (int i = 0; i < 4; i++) {
				for (int c = 0; c < 3; c++)
					sum[c] += linear[texels[i][c]];
				alpha += texels[i][3];
			}
			uint8_t *out = to[(size_t)y * to_px + x];
			for (int c = 0; c < 3; c++)
				out[c] = srgb_of(sum[c] / 4.0f);
			out[3] = (uint8_t)(alpha / 4);
		}
	}
}

static struct pkg_material describe(const struct material_layer *layer, int id, const float linear[256])
{
	double sum[3] = { 0 };
	for (size_t i = 0; i < LAYER_TEXELS; i++)
		for (int c = 0; c < 3; c++)
			sum[c] += (double)linear[layer->px[i][c]];
	struct pkg_material out = { .kind = (uint8_t)layer->kind, .layer = (uint8_t)id, .gloss = layer->gloss };
	for (int c = 0; c < 3; c++)
		out.mean_rgb[c] = (float)(sum[c] / (double)LAYER_TEXELS);
	return out;
}

static void pack(struct materials *out, const struct material_layer *layers, int count, const float linear[256])
{
	struct pkg_texture_array header = {
		.format = PKG_TEXTURE_RGBA8, .width = PX, .height = PX, .layers = (uint32_t)count
	};
	size_t bytes = sizeof(header);
	for (unsigned px = PX; px > 0; px /= 2, header.levels++)
		bytes += (size_t)px * px * 4 * (size_t)count;
	ARRAY_RESERVE(&out->texture, bytes);
	out->texture.count = bytes;
	memcpy(out->texture.items, &header, sizeof(header));
	uint8_t *at = out->texture.items + sizeof(header);
	for (int i = 0; i < count; i++)
		memcpy(at + (size_t)i * LAYER_TEXELS * 4, layers[i].px, LAYER_TEXELS * 4);
	for (unsigned px = PX / 2; px > 0; px /= 2) {
		uint8_t *next = at + (size_t)px * px * 16 * (size_t)count;
		for (size_t i = 0; i < (size_t)count; i++)
			halve((uint8_t(*)[4])(next + i * px * px * 4), (const uint8_t(*)[4])(at + i * px * px * 16), px, linear);
		at = next;
	}
}

/* The same levels and layers in blocks. */
static void compress(struct materials *materials)
{
	struct pkg_texture_array header;
	memcpy(&header, materials->texture.items, sizeof(header));
	const uint8_t *from = materials->texture.items + sizeof(header);
	header.format = PKG_TEXTURE_ETC2_RGBA;
	size_t bytes = sizeof(header);
	for (unsigned px = PX; px > 0; px /= 2)
		bytes += etc2_bytes(px, px) * header.layers;
	uint8_t *packed = array_grow(NULL, &(size_t){ 0 }, bytes, 1), *to = packed + sizeof(header);
	memcpy(packed, &header, sizeof(header));
	for (unsigned px = PX; px > 0; px /= 2) {
		for (unsigned i = 0; i < header.layers; i++) {
			etc2_encode(to, (const uint8_t(*)[4])from, px, px);
			from += (size_t)px * px * 4;
			to += etc2_bytes(px, px);
		}
	}
	ARRAY_FINISH(&materials->texture);
	materials->texture.items = packed;
	materials->texture.count = materials->texture.capacity = bytes;
}

void materials_paint(struct materials *out, enum pkg_texture_format format)
{
	*out = (struct materials){ 0 };
	float linear[256];
	for (int i = 0; i < 256; i++)
		linear[i] = linear_of((uint8_t)i);
	uint8_t(*texels)[4] = array_grow(NULL, &(size_t){ 0 }, LAYER_TEXELS * MATERIAL_LIMIT, 4);
	memset(texels, 0, LAYER_TEXELS * MATERIAL_LIMIT * 4);
	struct material_layer layers[MATERIAL_LIMIT];
	for (int i = 0; i < MATERIAL_LIMIT; i++)
		layers[i] = (struct material_layer){ .px = texels + (size_t)i * LAYER_TEXELS, .kind = PKG_MATERIAL_SOLID };
	int counts[] = { paint_ground(layers), paint_roofs(layers), paint_walls(layers) };
	int count = 1;
	for (int i = 0; i < 3; i++)
		count = counts[i] > count ? counts[i] : count;
	for (int i = 0; i < count; i++)
		ARRAY_PUSH(&out->table, describe(&layers[i], i, linear));
	pack(out, layers, count, linear);
	if (format == PKG_TEXTURE_ETC2_RGBA)
		compress(out);
	array_free(texels);
}

void materials_finish(struct materials *materials)
{
	ARRAY_FINISH(&materials->table);
	ARRAY_FINISH(&materials->texture);
}
