/*
 * Expanding goes chunk by chunk, in each by pass, in each by look: objects of one look are put together, whatever lies
 * between them, because fewer draws are worth more than the order of indices. About 10 ns a triangle, and the chunk's
 * checksum the first time.
 */
#include "assets/set_expand.h"

#include <errno.h>
#include <string.h>

#include "platform/base/log.h"

#define VERTICES_MAX 65536u /* of a chunk */
#define UNMOVED UINT16_MAX

enum { CHUNK_UNCHECKED, CHUNK_GOOD, CHUNK_DAMAGED };

uint64_t set_expander_bytes(const struct pkg *pkg, uint32_t objects)
{
	return (uint64_t)pkg->chunk_count + objects + VERTICES_MAX * sizeof(uint16_t) + 64;
}

int set_expander_init(struct set_expander *expander, struct arena *arena, const struct pkg *pkg,
	uint8_t (*look_of)(uint32_t kinds), uint32_t objects)
{
	*expander = (struct set_expander){
		.pkg = pkg,
		.look_of = look_of,
		.moved = ARENA_ARRAY(arena, uint16_t, VERTICES_MAX),
		.chunk_checked = ARENA_ARRAY(arena, uint8_t, pkg->chunk_count + 1),
		.looks = ARENA_ARRAY(arena, uint8_t, objects + 1),
		.looks_capacity = objects,
	};
	if (!expander->moved || !expander->chunk_checked || !expander->looks)
		return -ENOMEM;
	memset(expander->moved, 0xFF, VERTICES_MAX * sizeof(uint16_t));
	return 0;
}

static bool chunk_is_good(struct set_expander *expander, uint32_t chunk)
{
	uint8_t *checked = &expander->chunk_checked[chunk];
	if (*checked == CHUNK_UNCHECKED) {
		struct pkg_fault fault;
		bool good = pkg_chunk_check(expander->pkg, chunk, &fault) == 0;
		*checked = good ? CHUNK_GOOD : CHUNK_DAMAGED;
		if (!good)
			log_warn("byte %llu: %s: left out of what is drawn", (unsigned long long)fault.offset, fault.text);
	}
	return *checked == CHUNK_GOOD;
}

/* Objects [first, end) of a set, all of one chunk, and where their masks are. */
struct group {
	const struct pkg_chunk *chunk;
	const struct pkg_mesh_vertex *vertices;
	const uint16_t *indices;
	uint32_t chunk_id, first, end;
	const uint8_t *masks; /* of the first of them that has one */
	uint32_t own_first;   /* of the set's own vertices */
};

/* Where a set's next object, index, and so on goes. */
struct writer {
	struct set_expander *expander;
	const struct set_view *set;
	const struct set_room *room;
	struct cell_set *out;
};

static uint32_t triangles_of(const struct pkg_object *object, int pass)
{
	return object->index_count[pass] / 3;
}

/* The mask of an object of a set, NULL when it is kept whole; moves on to the next one's. */
static const uint8_t *next_mask(
	const struct pkg_set_object *kept, const struct pkg_object *object, const uint8_t **masks)
{
	uint32_t triangles = triangles_of(object, PKG_PASS_OPAQUE) + triangles_of(object, PKG_PASS_DECAL);
	if (kept->kept == triangles)
		return NULL;
	const uint8_t *mask = *masks;
	*masks += (triangles + 7) / 8;
	return mask;
}

static bool is_kept(const uint8_t *mask, uint32_t bit)
{
	return !mask || mask[bit / 8] >> (bit % 8) & 1;
}

static uint8_t look_of_object(const struct writer *writer, const struct group *group, const struct pkg_object *object,
	const uint8_t *mask, int pass)
{
	const struct pkg_material *materials = writer->expander->pkg->materials;
	const uint16_t *indices = group->indices + object->first_index[pass];
	uint32_t first_bit = pass == PKG_PASS_DECAL ? triangles_of(object, PKG_PASS_OPAQUE) : 0, kinds = 0;
	for (uint32_t t = 0; t < triangles_of(object, pass); t++) {
		if (!is_kept(mask, first_bit + t))
			continue;
		for (uint32_t corner = 0; corner < 3; corner++)
			kinds |= 1u << materials[group->vertices[indices[3 * t + corner]].material].kind;
	}
	uint8_t look = kinds && writer->expander->look_of ? writer->expander->look_of(kinds) : 0;
	return kinds ? look % SET_LOOKS : SET_LOOKS; /* SET_LOOKS: nothing of it in this pass */
}

/* Numbers the vertex among the set's own; copies it the first time. Returns false when there is no room. */
static bool move_vertex(struct writer *writer, const struct group *group, uint16_t *index)
{
	uint16_t *moved = &writer->expander->moved[*index];
	if (*moved == UNMOVED) {
		uint32_t number = writer->out->vertex_count - group->own_first;
		if (number >= UNMOVED || writer->out->vertex_count == writer->room->vertex_capacity)
			return false;
		writer->room->vertices[writer->out->vertex_count++] = group->vertices[*index];
		*moved = (uint16_t)number;
	}
	*index = *moved;
	return true;
}

static int put_triangle(struct writer *writer, const struct group *group, const uint16_t corners[3])
{
	struct cell_set *out = writer->out;
	if (out->index_count + 3 > writer->room->index_capacity)
		return -E2BIG;
	for (int corner = 0; corner < 3; corner++) {
		uint16_t index = corners[corner];
		if (writer->room->vertices && !move_vertex(writer, group, &index))
			return -E2BIG;
		writer->room->indices[out->index_count++] = index;
	}
	return 0;
}

static int put_part(struct writer *writer, const struct group *group, uint32_t id, const uint8_t *mask, int pass)
{
	const struct pkg_object *object = &writer->expander->pkg->objects[id];
	const uint16_t *indices = group->indices + object->first_index[pass];
	uint32_t first_bit = pass == PKG_PASS_DECAL ? triangles_of(object, PKG_PASS_OPAQUE) : 0;
	struct cell_set *out = writer->out;
	if (out->part_count == writer->room->part_capacity)
		return -E2BIG;
	struct cell_part *part = &writer->room->parts[out->part_count++];
	*part = (struct cell_part){ .object = id, .first = out->index_count };
	for (uint32_t t = 0; t < triangles_of(object, pass); t++)
		if (is_kept(mask, first_bit + t) && put_triangle(writer, group, indices + 3 * (size_t)t) < 0)
			return -E2BIG;
	part->count = out->index_count - part->first;
	return 0;
}

static int put_range(struct writer *writer, const struct group *group, int pass, uint8_t look)
{
	struct cell_set *out = writer->out;
	if (out->range_count == writer->room->range_capacity)
		return -E2BIG;
	struct cell_range *range = &writer->room->ranges[out->range_count++];
	*range = (struct cell_range){ .chunk = group->chunk_id,
		.first = out->index_count,
		.first_part = out->part_count,
		.first_vertex = group->own_first,
		.pass = (uint8_t)pass,
		.look = look };
	const uint8_t *masks = group->masks;
	for (uint32_t i = group->first; i < group->end; i++) {
		const struct pkg_set_object *kept = &writer->set->objects[i];
		const uint8_t *mask = next_mask(kept, &writer->expander->pkg->objects[kept->object], &masks);
		if (writer->expander->looks[i - group->first] == look && put_part(writer, group, kept->object, mask, pass) < 0)
			return -E2BIG;
	}
	range->count = out->index_count - range->first;
	range->part_count = out->part_count - range->first_part;
	return 0;
}

static int put_pass(struct writer *writer, const struct group *group, int pass)
{
	const uint8_t *masks = group->masks;
	uint32_t looks = 0;
	for (uint32_t i = group->first; i < group->end; i++) {
		const struct pkg_set_object *kept = &writer->set->objects[i];
		const struct pkg_object *object = &writer->expander->pkg->objects[kept->object];
		const uint8_t *mask = next_mask(kept, object, &masks);
		uint8_t look = look_of_object(writer, group, object, mask, pass);
		writer->expander->looks[i - group->first] = look;
		looks |= 1u << look;
	}
	int status = 0;
	for (uint8_t look = 0; look < SET_LOOKS && !status; look++)
		if (looks >> look & 1)
			status = put_range(writer, group, pass, look);
	return status;
}

static void forget_moves(struct writer *writer, const struct group *group)
{
	if (writer->room->vertices)
		memset(writer->expander->moved, 0xFF, group->chunk->vertex_count * sizeof(uint16_t));
}

/* The objects from `first` on that are of its chunk; moves on the masks. */
static struct group next_group(const struct writer *writer, uint32_t first, const uint8_t **masks)
{
	const struct pkg *pkg = writer->expander->pkg;
	const struct pkg_set_object *kept = writer->set->objects;
	struct group group = { .chunk_id = pkg->objects[kept[first].object].chunk,
		.first = first,
		.end = first,
		.masks = *masks,
		.own_first = writer->out->vertex_count };
	group.chunk = &pkg->chunks[group.chunk_id];
	group.vertices = pkg_chunk_vertices(pkg, group.chunk);
	group.indices = pkg_chunk_indices(pkg, group.chunk);
	while (group.end < writer->set->object_count && group.end - first < writer->expander->looks_capacity) {
		const struct pkg_object *object = &pkg->objects[kept[group.end].object];
		if (object->chunk != group.chunk_id)
			break;
		next_mask(&kept[group.end++], object, masks);
	}
	return group;
}

int set_expand(
	struct set_expander *expander, const struct set_view *set, const struct set_room *room, struct cell_set *out)
{
	*out = (struct cell_set){
		.ranges = room->ranges, .parts = room->parts, .indices = room->indices, .vertices = room->vertices
	};
	struct writer writer = { .expander = expander, .set = set, .room = room, .out = out };
	const uint8_t *masks = set->masks;
	int status = 0;
	for (uint32_t i = 0; i < set->object_count && !status;) {
		struct group group = next_group(&writer, i, &masks);
		i = group.end;
		if (!chunk_is_good(expander, group.chunk_id))
			continue;
		for (int pass = 0; pass < PKG_PASS_COUNT && !status; pass++)
			status = put_pass(&writer, &group, pass);
		forget_moves(&writer, &group);
	}
	return status;
}
