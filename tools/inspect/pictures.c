#include "tools/inspect/pictures.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/bake/eac.h"
#include "tools/bake/etc2.h"
#include "tools/city/pool.h"
#include "tools/measure/image.h"

#define GRAPH_SIDE_PX 2048

static struct image image_new(uint32_t width, uint32_t height, uint8_t grey)
{
	size_t bytes = (size_t)width * height * 3;
	struct image out = { .width = width, .height = height, .rgb = array_grow(NULL, &(size_t){ 0 }, bytes, 1) };
	memset(out.rgb, grey, bytes);
	return out;
}

static int write_picture(struct image *image, const char *folder, const char *name)
{
	char path[PATH_MAX];
	snprintf(path, sizeof(path), "%s/%s", folder, name);
	int status = image_write_png(image, path);
	image_finish(image);
	return status;
}

static void put(struct image *image, long x, long y, const uint8_t rgb[3])
{
	if (x >= 0 && y >= 0 && x < (long)image->width && y < (long)image->height)
		memcpy(image->rgb + 3 * ((size_t)y * image->width + (size_t)x), rgb, 3);
}

static void draw_line(struct image *image, struct dvec2 a, struct dvec2 b, const uint8_t rgb[3], int thick)
{
	double steps = fmax(fmax(fabs(b.x - a.x), fabs(b.y - a.y)), 1.0);
	for (double i = 0; i <= steps; i++) {
		long x = lround(a.x + (b.x - a.x) * i / steps), y = lround(a.y + (b.y - a.y) * i / steps);
		for (int dy = 0; dy < thick; dy++)
			for (int dx = 0; dx < thick; dx++)
				put(image, x + dx, y + dy, rgb);
	}
}

/* Streets by class, off-plane ones red, nodes black. North is up. */
static int draw_graph(const struct pkg *pkg, const char *folder)
{
	const struct pkg_graph *graph = &pkg->graph;
	if (!graph->point_count)
		return 0;
	double min[2] = { INFINITY, INFINITY }, max[2] = { -INFINITY, -INFINITY };
	for (uint32_t i = 0; i < graph->point_count; i++) {
		for (int axis = 0; axis < 2; axis++) {
			min[axis] = fmin(min[axis], graph->points[i].pos_mm[axis]);
			max[axis] = fmax(max[axis], graph->points[i].pos_mm[axis]);
		}
	}
	double scale = (GRAPH_SIDE_PX - 8) / fmax(fmax(max[0] - min[0], max[1] - min[1]), 1.0);
	struct image image = image_new(GRAPH_SIDE_PX, GRAPH_SIDE_PX, 250);
	for (uint32_t i = 0; i < graph->edge_count; i++) {
		const struct pkg_edge *edge = &graph->edges[i];
		uint8_t shade = (uint8_t)(edge->street_class * 20);
		uint8_t rgb[3] = { shade, shade, (uint8_t)(120 + shade / 2) };
		if (edge->flags & PKG_EDGE_OFF_PLANE)
			memcpy(rgb, (const uint8_t[]){ 220, 40, 30 }, 3);
		struct dvec2 last = { 0 };
		for (uint32_t k = 0; k < edge->point_count; k++) {
			const int32_t *at = graph->points[edge->first_point + k].pos_mm;
			struct dvec2 here = { 4 + (at[0] - min[0]) * scale, 4 + (max[1] - at[1]) * scale };
			if (k)
				draw_line(&image, last, here, rgb, edge->street_class < PKG_STREET_TERTIARY ? 3 : 2);
			last = here;
		}
	}
	static const uint8_t black[3] = { 0, 0, 0 };
	for (uint32_t i = 0; i < graph->node_count; i++) {
		const int32_t *at = graph->nodes[i].pos_mm;
		struct dvec2 here = { 4 + (at[0] - min[0]) * scale, 4 + (max[1] - at[1]) * scale };
		draw_line(&image, here, here, black, 3);
	}
	return write_picture(&image, folder, "graph.png");
}

/* Red: occlusion, green: street lamps. */
static int draw_light(const struct pkg *pkg, const char *folder)
{
	const struct pkg_light_map *map = pkg->light_map;
	if (!map)
		return 0;
	struct image image = image_new(map->width, map->height, 0);
	const uint8_t *texels = pkg->light_map_bytes;
	uint8_t *decoded = NULL;
	if (map->format == PKG_LIGHT_EAC_RG11) {
		texels = decoded = array_grow(NULL, &(size_t){ 0 }, (size_t)map->width * map->height, 2);
		eac_rg_decode((uint8_t(*)[2])decoded, pkg->light_map_bytes, map->width, map->height);
	}
	for (uint32_t y = 0; y < map->height; y++) {
		const uint8_t *row = texels + (size_t)(map->height - 1 - y) * map->width * 2;
		for (uint32_t x = 0; x < map->width; x++)
			memcpy(image.rgb + 3 * ((size_t)y * map->width + x),
				(const uint8_t[]){ row[2 * x], row[2 * x + 1], row[2 * x] }, 3);
	}
	array_free(decoded);
	return write_picture(&image, folder, "light.png");
}

/* A layer's largest level as RGBA8, in `decoded` if the package has it in blocks. */
static const uint8_t *layer_texels(const struct pkg *pkg, uint32_t layer, uint8_t *decoded)
{
	const struct pkg_texture_array *array = pkg->textures;
	if (array->format == PKG_TEXTURE_RGBA8)
		return pkg->texture_bytes + (size_t)layer * array->width * array->height * 4;
	const uint8_t *blocks = pkg->texture_bytes + layer * etc2_bytes(array->width, array->height);
	etc2_decode((uint8_t(*)[4])decoded, blocks, array->width, array->height);
	return decoded;
}

static int draw_textures(const struct pkg *pkg, const char *folder)
{
	const struct pkg_texture_array *array = pkg->textures;
	if (!array || (array->format != PKG_TEXTURE_RGBA8 && array->format != PKG_TEXTURE_ETC2_RGBA))
		return 0;
	uint32_t columns = (uint32_t)ceil(sqrt(array->layers)), rows = (array->layers + columns - 1) / columns;
	struct image image = image_new(columns * array->width, rows * array->height, 255);
	uint8_t *decoded = array_grow(NULL, &(size_t){ 0 }, (size_t)array->width * array->height, 4);
	for (uint32_t layer = 0; layer < array->layers; layer++) {
		const uint8_t *texels = layer_texels(pkg, layer, decoded);
		for (uint32_t y = 0; y < array->height; y++) {
			/* rows run from v = 0 up */
			const uint8_t *from = texels + (size_t)(array->height - 1 - y) * array->width * 4;
			size_t to = (size_t)(layer / columns * array->height + y) * image.width + layer % columns * array->width;
			for (uint32_t x = 0; x < array->width; x++)
				memcpy(image.rgb + 3 * (to + x), from + 4 * x, 3);
		}
	}
	array_free(decoded);
	return write_picture(&image, folder, "textures.png");
}

static int draw_glyphs(const struct pkg *pkg, const char *folder)
{
	if (!pkg->font)
		return 0;
	struct image image = image_new(pkg->font->atlas_width, pkg->font->atlas_height, 0);
	for (size_t i = 0; i < (size_t)image.width * image.height; i++)
		memset(image.rgb + 3 * i, pkg->font_atlas[i], 3);
	return write_picture(&image, folder, "glyphs.png");
}

int inspect_pictures(const struct pkg *pkg, const char *folder)
{
	int status;
	if ((status = draw_graph(pkg, folder)) < 0 || (status = draw_light(pkg, folder)) < 0 ||
		(status = draw_textures(pkg, folder)) < 0)
		return status;
	return draw_glyphs(pkg, folder);
}
