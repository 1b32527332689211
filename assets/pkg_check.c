/*
 * Range checks of a package's values, so that the rest of the runtime need not check again. Linear in the size of the
 * metadata; the geometry itself is checked chunk by chunk on first use.
 */
#include "assets/pkg_check.h"

#include <errno.h>
#include <math.h>

#define GRID_SIDE_MAX 65536u
#define TEXTURE_SIDE_MAX 16384u

int pkg_check_heights(struct pkg *pkg, const void *at, uint64_t bytes, struct pkg_fault *fault)
{
	if (!at)
		return 0;
	const struct pkg_height_grid *grid = at;
	uint64_t offset = pkg_offset_of(pkg, at);
	if (bytes < sizeof(*grid))
		return pkg_fail(fault, offset, "section HGRD: cut short");
	if (grid->columns < 2 || grid->rows < 2 || grid->columns > GRID_SIDE_MAX || grid->rows > GRID_SIDE_MAX ||
		!grid->step_mm || bytes - sizeof(*grid) != (uint64_t)grid->columns * grid->rows * sizeof(int32_t))
		return pkg_fail(fault, offset, "section HGRD: %u x %u posts do not match its size", grid->columns, grid->rows);
	pkg->heights = grid;
	pkg->height_mm = (const void *)(grid + 1);
	return 0;
}

/* Bytes of all levels of a texture array; 0 when a field is out of range. */
static uint64_t texture_bytes(const struct pkg_texture_array *array)
{
	static const uint32_t texel_bytes[] = { [PKG_TEXTURE_RGBA8] = 4, [PKG_TEXTURE_R8] = 1, [PKG_TEXTURE_RG8] = 2 };
	if (array->format > PKG_TEXTURE_RG8 || !array->width || !array->height || array->width > TEXTURE_SIDE_MAX ||
		array->height > TEXTURE_SIDE_MAX || !array->layers || array->layers > 2048 || !array->levels ||
		array->levels > 15)
		return 0;
	uint64_t sum = 0;
	uint32_t width = array->width, height = array->height;
	for (uint32_t level = 0; level < array->levels; level++) {
		uint64_t layer = array->format == PKG_TEXTURE_ETC2_RGBA ? (uint64_t)((width + 3) / 4) * ((height + 3) / 4) * 16
																: (uint64_t)width * height * texel_bytes[array->format];
		sum += layer * array->layers;
		width = width > 1 ? width / 2 : 1;
		height = height > 1 ? height / 2 : 1;
	}
	return sum;
}

int pkg_check_textures(struct pkg *pkg, const void *at, uint64_t bytes, struct pkg_fault *fault)
{
	if (!at)
		return 0;
	const struct pkg_texture_array *array = at;
	uint64_t offset = pkg_offset_of(pkg, at);
	if (bytes < sizeof(*array))
		return pkg_fail(fault, offset, "section TEXA: cut short");
	uint64_t wanted = texture_bytes(array);
	if (!wanted || bytes - sizeof(*array) != wanted)
		return pkg_fail(fault, offset, "section TEXA: %u x %u x %u texels do not match its size", array->width,
			array->height, array->layers);
	pkg->textures = array;
	pkg->texture_bytes = (const uint8_t *)(array + 1);
	return 0;
}

/* Bytes of a light map's texels; 0 when a field is out of range. */
static uint64_t light_map_bytes(const struct pkg_light_map *map)
{
	if (!map->width || !map->height || map->width > PKG_LIGHT_SIDE_MAX || map->height > PKG_LIGHT_SIDE_MAX ||
		!map->texel_mm)
		return 0;
	switch (map->format) {
	case PKG_LIGHT_RG8:
		return (uint64_t)map->width * map->height * 2;
	case PKG_LIGHT_EAC_RG11:
		return (uint64_t)((map->width + 3) / 4) * ((map->height + 3) / 4) * 16;
	default:
		return 0;
	}
}

int pkg_check_light_map(struct pkg *pkg, const void *at, uint64_t bytes, struct pkg_fault *fault)
{
	if (!at)
		return 0;
	const struct pkg_light_map *map = at;
	uint64_t offset = pkg_offset_of(pkg, at);
	if (bytes < sizeof(*map))
		return pkg_fail(fault, offset, "section LMAP: cut short");
	uint64_t wanted = light_map_bytes(map);
	if (!wanted || bytes - sizeof(*map) != wanted)
		return pkg_fail(fault, offset, "section LMAP: %u x %u texels do not match its size", map->width, map->height);
	pkg->light_map = map;
	pkg->light_map_bytes = (const uint8_t *)(map + 1);
	return 0;
}

int pkg_check_font(struct pkg *pkg, const void *at, uint64_t bytes, struct pkg_fault *fault)
{
	if (!at)
		return 0;
	const struct pkg_font *font = at;
	uint64_t offset = pkg_offset_of(pkg, at);
	if (bytes < sizeof(*font))
		return pkg_fail(fault, offset, "section FONT: cut short");
	uint64_t atlas_end = sizeof(*font) + (uint64_t)font->atlas_width * font->atlas_height;
	if (font->atlas_width > TEXTURE_SIDE_MAX || font->atlas_height > TEXTURE_SIDE_MAX || font->glyphs_offset % 4 ||
		font->glyphs_offset < atlas_end || font->glyphs_offset > bytes ||
		(bytes - font->glyphs_offset) / sizeof(struct pkg_glyph) < font->glyph_count ||
		font->ascii_first > font->glyph_count || font->glyph_count - font->ascii_first < 95 || !(font->em_px > 0.0f) ||
		!isfinite(font->em_px))
		return pkg_fail(fault, offset, "section FONT: its parts do not fit");
	const struct pkg_glyph *glyphs = (const void *)((const uint8_t *)at + font->glyphs_offset);
	for (uint32_t i = 0; i < font->glyph_count; i++)
		if (glyphs[i].atlas_x + glyphs[i].atlas_width > (int64_t)font->atlas_width ||
			glyphs[i].atlas_y + glyphs[i].atlas_height > (int64_t)font->atlas_height)
			return pkg_fail(fault, pkg_offset_of(pkg, &glyphs[i]), "section FONT, glyph %u: outside the atlas", i);
	pkg->font = font;
	pkg->font_atlas = (const uint8_t *)(font + 1);
	pkg->glyphs = glyphs;
	return 0;
}

static int check_meta(const struct pkg *pkg, struct pkg_fault *fault)
{
	const struct pkg_meta *meta = pkg->meta;
	if (!pkg->strings_bytes || pkg->strings[0] || pkg->strings[pkg->strings_bytes - 1])
		return pkg_fail(fault, 0, "section STRS: missing, or its ends are not NUL");
	PKG_CHECK(meta->city_name < pkg->strings_bytes && meta->attribution < pkg->strings_bytes, meta, "META", 0,
		"string out of range");
	PKG_CHECK(fabs(meta->origin_lat_deg) <= 90.0 && fabs(meta->origin_lon_deg) <= 180.0, meta, "META", 0,
		"origin out of range");
	return 0;
}

static int check_nodes(const struct pkg *pkg, struct pkg_fault *fault)
{
	const struct pkg_graph *graph = &pkg->graph;
	for (uint32_t i = 0; i < graph->node_count; i++) {
		const struct pkg_node *node = &graph->nodes[i];
		PKG_CHECK(
			pkg_run_fits(node->first_out, node->out_count, graph->out_count), node, "NODE", i, "out-list out of range");
		for (uint32_t k = 0; k < node->out_count; k++) {
			uint32_t half = graph->outs[node->first_out + k];
			PKG_CHECK(half < graph->half_count && graph->halves[half].origin == i, node, "NODE", i,
				"out-list names a foreign half-edge");
		}
	}
	return 0;
}

static int check_edges(const struct pkg *pkg, struct pkg_fault *fault)
{
	const struct pkg_graph *graph = &pkg->graph;
	for (uint32_t i = 0; i < graph->half_count; i++) {
		const struct pkg_half *half = &graph->halves[i];
		PKG_CHECK(half->origin < graph->node_count && half->next < graph->half_count &&
					  half->prev < graph->half_count && half->face < graph->face_count,
			half, "HALF", i, "index out of range");
	}
	PKG_CHECK(graph->half_count == 2 * (uint64_t)graph->edge_count, pkg->meta, "HALF", graph->half_count,
		"not two half-edges an edge");
	for (uint32_t i = 0; i < graph->edge_count; i++) {
		const struct pkg_edge *edge = &graph->edges[i];
		PKG_CHECK(edge->point_count >= 2 && pkg_run_fits(edge->first_point, edge->point_count, graph->point_count),
			edge, "EDGE", i, "polyline out of range");
		PKG_CHECK(
			edge->name < pkg->strings_bytes && edge->ref < pkg->strings_bytes, edge, "EDGE", i, "string out of range");
		PKG_CHECK(edge->street_class < PKG_STREET_CLASS_COUNT, edge, "EDGE", i, "unknown street class");
	}
	for (uint32_t i = 0; i < graph->face_count; i++) {
		const struct pkg_face *face = &graph->faces[i];
		PKG_CHECK(
			face->first_half < graph->half_count && (face->parent == PKG_NONE || face->parent < graph->face_count),
			face, "FACE", i, "index out of range");
	}
	for (uint32_t i = 0; i < graph->turn_count; i++)
		PKG_CHECK(graph->turns[i].from_half < graph->half_count && graph->turns[i].to_half < graph->half_count,
			&graph->turns[i], "TURN", i, "index out of range");
	return 0;
}

static int check_chunks(const struct pkg *pkg, struct pkg_fault *fault)
{
	for (uint32_t i = 0; i < pkg->chunk_count; i++) {
		const struct pkg_chunk *chunk = &pkg->chunks[i];
		uint64_t indices = 0;
		for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
			indices += chunk->index_count[pass];
		PKG_CHECK(chunk->vertex_count <= 65536, chunk, "CHNK", i, "too many vertices");
		PKG_CHECK(chunk->vertex_offset % 64 == 0 && chunk->index_offset % 64 == 0 &&
					  pkg_run_fits(chunk->vertex_offset, chunk->vertex_count * sizeof(struct pkg_mesh_vertex),
						  pkg->geometry_bytes) &&
					  pkg_run_fits(chunk->index_offset, indices * sizeof(uint16_t), pkg->geometry_bytes) &&
					  indices % 3 == 0 && indices < UINT32_MAX,
			chunk, "CHNK", i, "geometry out of range");
		PKG_CHECK(pkg_run_fits(chunk->first_object, chunk->object_count, pkg->object_count), chunk, "CHNK", i,
			"objects out of range");
		for (int axis = 0; axis < 3; axis++)
			PKG_CHECK(chunk->min_mm[axis] <= chunk->max_mm[axis], chunk, "CHNK", i, "bounds are inside out");
	}
	return 0;
}

static int check_objects(const struct pkg *pkg, struct pkg_fault *fault)
{
	for (uint32_t i = 0; i < pkg->object_count; i++) {
		const struct pkg_object *object = &pkg->objects[i];
		PKG_CHECK(object->chunk < pkg->chunk_count && object->name < pkg->strings_bytes, object, "OBJS", i,
			"index out of range");
		const struct pkg_chunk *chunk = &pkg->chunks[object->chunk];
		uint64_t indices = (uint64_t)chunk->index_count[0] + chunk->index_count[1];
		for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
			PKG_CHECK(pkg_run_fits(object->first_index[pass], object->index_count[pass], indices), object, "OBJS", i,
				"indices out of range");
	}
	return 0;
}

static int check_text(const struct pkg *pkg, struct pkg_fault *fault)
{
	uint32_t glyphs = pkg->font ? pkg->font->glyph_count : 0;
	for (uint32_t i = 0; i < pkg->text_count; i++) {
		const struct pkg_text *text = &pkg->texts[i];
		PKG_CHECK(text->string < pkg->strings_bytes &&
					  pkg_run_fits(text->first_glyph, text->glyph_count, pkg->glyph_run_count),
			text, "TEXT", i, "index out of range");
		PKG_CHECK(i == 0 || pkg->texts[i - 1].string < text->string, text, "TEXT", i, "not sorted");
	}
	for (uint32_t i = 0; i < pkg->glyph_run_count; i++)
		PKG_CHECK(pkg->glyph_runs[i].glyph < glyphs, &pkg->glyph_runs[i], "GRUN", i, "unknown glyph");
	uint32_t layers = pkg->textures ? pkg->textures->layers : 0;
	for (uint32_t i = 0; i < pkg->material_count; i++)
		PKG_CHECK(pkg->materials[i].kind < PKG_MATERIAL_KIND_COUNT && pkg->materials[i].layer < layers,
			&pkg->materials[i], "MATL", i, "unknown kind or layer");
	PKG_CHECK(pkg->material_count <= 256, pkg->meta, "MATL", pkg->material_count, "too many materials");
	return 0;
}

/* Any wall hides something; but whose it is says what a place lies inside of. */
static int check_occluders(const struct pkg *pkg, struct pkg_fault *fault)
{
	for (uint32_t i = 0; i < pkg->occluder_count; i++) {
		uint32_t solid = pkg->occluders[i].solid, before = i ? pkg->occluders[i - 1].solid : 0;
		PKG_CHECK(
			solid == before || (i && solid == before + 1), &pkg->occluders[i], "OCCL", i, "walls are not in order");
	}
	return 0;
}

int pkg_check_values(const struct pkg *pkg, struct pkg_fault *fault)
{
	int status;
	if ((status = check_meta(pkg, fault)) < 0 || (status = check_edges(pkg, fault)) < 0 ||
		(status = check_nodes(pkg, fault)) < 0 || (status = check_chunks(pkg, fault)) < 0 ||
		(status = check_objects(pkg, fault)) < 0 || (status = check_occluders(pkg, fault)) < 0 ||
		(status = pkg_check_far(pkg, fault)) < 0)
		return status;
	return check_text(pkg, fault);
}

int pkg_chunk_check(const struct pkg *pkg, uint32_t index, struct pkg_fault *fault)
{
	const struct pkg_chunk *chunk = &pkg->chunks[index];
	const struct pkg_mesh_vertex *vertices = pkg_chunk_vertices(pkg, chunk);
	const uint16_t *indices = pkg_chunk_indices(pkg, chunk);
	uint32_t index_count = chunk->index_count[PKG_PASS_OPAQUE] + chunk->index_count[PKG_PASS_DECAL];
	uint32_t crc = pkg_crc32(0, vertices, chunk->vertex_count * sizeof(*vertices));
	crc = pkg_crc32(crc, indices, index_count * sizeof(*indices));
	PKG_CHECK(crc == chunk->crc32, vertices, "GEOM", index, "chunk checksum is wrong");
	for (uint32_t i = 0; i < index_count; i++)
		PKG_CHECK(indices[i] < chunk->vertex_count, &indices[i], "GEOM", index, "index out of range");
	for (uint32_t i = 0; i < chunk->vertex_count; i++)
		PKG_CHECK(vertices[i].material < pkg->material_count, &vertices[i], "GEOM", index, "unknown material");
	return 0;
}
