/* Uploads of a package's materials and texture array; where the light map lies. */
#include "render/surfaces.h"

#include "render/frame_block.h"

static int make_materials(struct gfx *gfx, const struct pkg *pkg, gfx_buffer *out)
{
	struct materials_block block = { 0 };
	for (uint32_t i = 0; i < pkg->material_count && i < 256; i++) {
		const struct pkg_material *material = &pkg->materials[i];
		block.row[i][0] = material->kind;
		block.row[i][1] = material->layer;
		block.row[i][2] = material->gloss / 255.0f;
	}
	struct gfx_buffer_desc desc = { .kind = GFX_BUFFER_UNIFORM, .bytes = sizeof(block), .data = &block };
	return gfx_buffer_create(gfx, &desc, out);
}

static const enum gfx_format texture_formats[] = { [PKG_TEXTURE_RGBA8] = GFX_RGBA8,
	[PKG_TEXTURE_ETC2_RGBA] = GFX_ETC2_RGBA8,
	[PKG_TEXTURE_R8] = GFX_R8,
	[PKG_TEXTURE_RG8] = GFX_RG8 };
static const uint8_t white[4] = { 255, 255, 255, 0 };

/* Stands in for what the package does not have. */
static int make_white(struct gfx *gfx, gfx_texture *out)
{
	struct gfx_texture_desc desc = { .format = GFX_RGBA8, .width = 1, .height = 1, .layers = 1, .filter = GFX_NEAREST };
	int err = gfx_texture_create(gfx, &desc, out);
	if (err)
		return err;
	struct gfx_region region = { .width = 1, .height = 1, .layers = 1 };
	gfx_texture_write(gfx, *out, &region, white);
	return 0;
}

static int make_textures(struct gfx *gfx, const struct pkg *pkg, gfx_texture *out)
{
	const struct pkg_texture_array *array = pkg->textures;
	if (!array)
		return make_white(gfx, out);
	/* decoded to linear light by the shader: filtering costs less so */
	struct gfx_texture_desc desc = { .format = texture_formats[array->format],
		.width = array->width,
		.height = array->height,
		.layers = array->layers,
		.levels = array->levels,
		.filter = GFX_ANISOTROPIC,
		.wrap = GFX_REPEAT };
	return gfx_texture_create(gfx, &desc, out);
}

static void load_layer(struct gfx *gfx, const struct pkg *pkg, gfx_texture textures, uint32_t layer)
{
	const struct pkg_texture_array *array = pkg->textures;
	const uint8_t *texels = pkg->texture_bytes;
	for (uint32_t level = 0; level < array->levels; level++) {
		uint32_t w = array->width >> level, h = array->height >> level;
		struct gfx_region region = {
			.level = level, .layer = layer, .width = w ? w : 1, .height = h ? h : 1, .layers = 1
		};
		uint64_t bytes = gfx_format_bytes(texture_formats[array->format], region.width, region.height, 1);
		gfx_texture_write(gfx, textures, &region, texels + bytes * layer);
		texels += bytes * array->layers;
	}
}

static void need_layer(
	struct gfx *gfx, const struct pkg *pkg, gfx_texture textures, struct surface_layers *layers, uint32_t layer)
{
	uint32_t *word = &layers->there[layer / 32], bit = 1u << layer % 32;
	if (*word & bit)
		return;
	*word |= bit;
	load_layer(gfx, pkg, textures, layer);
}

void surfaces_load(struct gfx *gfx, const struct pkg *pkg, gfx_texture textures, struct surface_layers *layers,
	const uint32_t wanted[256 / 32])
{
	for (uint32_t i = 0; pkg->textures && i < pkg->material_count && i < 256; i++)
		if (wanted[i / 32] >> i % 32 & 1)
			need_layer(gfx, pkg, textures, layers, pkg->materials[i].layer);
}

bool surfaces_load_next(struct gfx *gfx, const struct pkg *pkg, gfx_texture textures, struct surface_layers *layers)
{
	uint32_t count = pkg->textures ? pkg->textures->layers : 0;
	while (layers->next < count && layers->there[layers->next / 32] >> layers->next % 32 & 1)
		layers->next++;
	if (layers->next < count)
		need_layer(gfx, pkg, textures, layers, layers->next);
	return layers->next < count;
}

int surfaces_make(struct gfx *gfx, const struct pkg *pkg, gfx_buffer *materials, gfx_texture *textures)
{
	int err = make_materials(gfx, pkg, materials);
	if (!err)
		err = make_textures(gfx, pkg, textures);
	return err;
}

void surfaces_light_map_frame(const struct pkg *pkg, const int64_t eye_mm[3], float out[4])
{
	const struct pkg_light_map *map = pkg->light_map;
	if (!map)
		return;
	double size_mm[2] = { (double)map->width * map->texel_mm, (double)map->height * map->texel_mm };
	for (int axis = 0; axis < 2; axis++) {
		out[axis] = (float)((double)(eye_mm[axis] - map->origin_mm[axis]) / size_mm[axis]);
		out[axis + 2] = (float)(1000.0 / size_mm[axis]);
	}
}
