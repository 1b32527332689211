/* Writes a package: gathers the sections from what the steps of the bake left. Same content, same bytes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/bake/bake.h"
#include "tools/bake/pkg_file.h"
#include "tools/bake/strings.h"

struct writer {
	struct pkg_file_section sections[PKG_FILE_SECTIONS_MAX];
	uint32_t count;
	struct string_table strings;
	struct pkg_meta meta;
	/* copies with STRS offsets in place of indices */
	struct pkg_edge *edges;
	struct pkg_object *objects;
	struct pkg_text *texts;
};

static void add_section(struct writer *writer, uint32_t tag, size_t element_bytes, const void *bytes, size_t count)
{
	if (!count)
		return;
	writer->sections[writer->count++] = (struct pkg_file_section){
		.tag = tag, .element_bytes = (uint32_t)element_bytes, .bytes = bytes, .size = element_bytes * count
	};
}

static void add_blob(
	struct writer *writer, uint32_t tag, const void *head, size_t head_bytes, const void *bytes, size_t size)
{
	writer->sections[writer->count++] = (struct pkg_file_section){
		.tag = tag, .element_bytes = 1, .head = head, .head_bytes = head_bytes, .bytes = bytes, .size = size
	};
}

static void *copy_array(const void *from, size_t count, size_t item_bytes)
{
	void *out = array_grow(NULL, &(size_t){ 0 }, count + 1, item_bytes);
	if (count)
		memcpy(out, from, count * item_bytes);
	return out;
}

static void add_graph(struct writer *writer, const struct graph_data *graph)
{
	writer->edges = copy_array(graph->edges.items, graph->edges.count, sizeof(struct pkg_edge));
	for (size_t i = 0; i < graph->edges.count; i++) {
		struct pkg_edge *edge = &writer->edges[i];
		edge->name = edge->name ? strings_intern(&writer->strings, graph->names.items[edge->name - 1]) : 0;
		edge->ref = edge->ref ? strings_intern(&writer->strings, graph->names.items[edge->ref - 1]) : 0;
	}
	add_section(writer, PKG_NODE, sizeof(struct pkg_node), graph->nodes.items, graph->nodes.count);
	add_section(writer, PKG_OUTS, sizeof(uint32_t), graph->outs.items, graph->outs.count);
	add_section(writer, PKG_HALF, sizeof(struct pkg_half), graph->halves.items, graph->halves.count);
	add_section(writer, PKG_EDGE, sizeof(struct pkg_edge), writer->edges, graph->edges.count);
	add_section(writer, PKG_POLY, sizeof(struct pkg_point), graph->points.items, graph->points.count);
	add_section(writer, PKG_FACE, sizeof(struct pkg_face), graph->faces.items, graph->faces.count);
	add_section(writer, PKG_TURN, sizeof(struct pkg_turn), graph->turns.items, graph->turns.count);
}

static void add_mesh(struct writer *writer, const struct mesh_chunks *mesh)
{
	writer->objects = copy_array(mesh->objects.items, mesh->objects.count, sizeof(struct pkg_object));
	for (size_t i = 0; i < mesh->objects.count; i++) {
		struct pkg_object *object = &writer->objects[i];
		object->name = object->name ? strings_intern(&writer->strings, mesh->names.items[object->name - 1]) : 0;
	}
	add_section(writer, PKG_CHNK, sizeof(struct pkg_chunk), mesh->chunks.items, mesh->chunks.count);
	add_section(writer, PKG_OBJS, sizeof(struct pkg_object), writer->objects, mesh->objects.count);
	add_section(writer, PKG_GEOM, 1, mesh->geometry.items, mesh->geometry.count);
	writer->meta.triangle_count = mesh->triangles;
	for (int axis = 0; axis < 3; axis++) {
		int32_t min = INT32_MAX, max = INT32_MIN;
		for (size_t i = 0; i < mesh->chunks.count; i++) {
			const struct pkg_chunk *chunk = &mesh->chunks.items[i];
			min = chunk->min_mm[axis] < min ? chunk->min_mm[axis] : min;
			max = chunk->max_mm[axis] > max ? chunk->max_mm[axis] : max;
		}
		writer->meta.min_mm[axis] = min <= max ? min : 0;
		writer->meta.max_mm[axis] = min <= max ? max : 0;
	}
}

static int compare_texts(const void *left, const void *right)
{
	const struct pkg_text *a = left, *b = right;
	return a->string < b->string ? -1 : a->string > b->string;
}

static void add_text(struct writer *writer, const struct text_data *text)
{
	writer->texts = copy_array(text->texts.items, text->texts.count, sizeof(struct pkg_text));
	for (size_t i = 0; i < text->texts.count; i++)
		writer->texts[i].string = strings_intern(&writer->strings, text->strings.items[writer->texts[i].string]);
	qsort(writer->texts, text->texts.count, sizeof(struct pkg_text), compare_texts);
	add_section(writer, PKG_FONT, 1, text->font.items, text->font.count);
	add_section(writer, PKG_TEXT, sizeof(struct pkg_text), writer->texts, text->texts.count);
	add_section(writer, PKG_GRUN, sizeof(struct pkg_glyph_at), text->runs.items, text->runs.count);
}

static void add_meta(struct writer *writer, const struct pkg_content *content)
{
	const struct city *city = content->city;
	struct pkg_meta *meta = &writer->meta;
	meta->origin_lat_deg = city->frame.origin.lat_deg;
	meta->origin_lon_deg = city->frame.origin.lon_deg;
	meta->city_name = strings_intern(&writer->strings, city->name);
	meta->attribution = strings_intern(&writer->strings, city->attribution);
	meta->source_hash = content->source_hash;
	meta->right_hand_traffic = city->right_hand_traffic;
	/* Nobody gives us a time zone: the sun keeps local mean time to the nearest half hour. */
	meta->utc_offset_minutes = (uint32_t)(int32_t)(lrint(meta->origin_lon_deg / 7.5) * 30);
}

static void gather(struct writer *writer, const struct pkg_content *content)
{
	add_section(writer, PKG_META, sizeof(writer->meta), &writer->meta, 1);
	add_meta(writer, content);
	add_graph(writer, content->graph);
	const struct terrain *terrain = &content->city->terrain;
	if (terrain->grid.columns)
		add_blob(writer, PKG_HGRD, &terrain->grid, sizeof(terrain->grid), terrain->height_mm,
			(size_t)terrain->grid.columns * terrain->grid.rows * sizeof(int32_t));
	if (content->text)
		add_text(writer, content->text);
	if (content->materials) {
		add_section(writer, PKG_MATL, sizeof(struct pkg_material), content->materials->table.items,
			content->materials->table.count);
		add_section(writer, PKG_TEXA, 1, content->materials->texture.items, content->materials->texture.count);
	}
	if (content->light_map && content->light_map->texels) {
		const struct pkg_light_map *map = &content->light_map->header;
		add_blob(writer, PKG_LMAP, map, sizeof(*map), content->light_map->texels, content->light_map->bytes);
	}
	if (content->mesh)
		add_mesh(writer, content->mesh);
	if (content->occluders)
		add_section(writer, PKG_OCCL, sizeof(struct pkg_occluder), content->occluders->walls.items,
			content->occluders->walls.count);
	strings_intern(&writer->strings, "");
	add_section(writer, PKG_STRS, 1, writer->strings.bytes.items, writer->strings.bytes.count);
}

int pkg_write(const char *path, const struct pkg_content *content)
{
	struct writer writer = { 0 };
	gather(&writer, content);
	int status = pkg_file_write(path, writer.sections, writer.count);
	if (status)
		log_error("%s: cannot write: %s", path, strerror(-status));
	strings_finish(&writer.strings);
	array_free(writer.edges);
	array_free(writer.objects);
	array_free(writer.texts);
	return status;
}
