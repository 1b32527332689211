/* Copies vertices: 72 bytes a triangle, of which a capture's set has tens of thousands. */
#include "tools/impostor/capture_batch.h"

#include <string.h>

#include "platform/base/log.h"
#include "tools/impostor/oct_normal.h"

enum { UNKNOWN, GOOD, DAMAGED };

void capture_batch_finish(struct capture_batch *batch)
{
	ARRAY_FINISH(&batch->vertices);
	ARRAY_FINISH(&batch->triangles);
	ARRAY_FINISH(&batch->ranges);
	array_free(batch->chunk_state);
	*batch = (struct capture_batch){ 0 };
}

static bool chunk_is_good(struct capture_batch *batch, const struct pkg *pkg, uint32_t chunk)
{
	uint8_t *state = &batch->chunk_state[chunk];
	if (*state == UNKNOWN) {
		struct pkg_fault fault = { 0 };
		*state = pkg_chunk_check(pkg, chunk, &fault) ? DAMAGED : GOOD;
		if (*state == DAMAGED)
			log_warn("capture: left out: %s", fault.text);
	}
	return *state == GOOD;
}

/* The mean of the corners' normals: on a slope that is lit smoothly they differ. */
static void mean_normal(const struct pkg_mesh_vertex corner[3], int8_t oct[2])
{
	struct dvec3 sum = { 0 };
	memcpy(oct, corner[2].normal_oct, 2);
	if (!memcmp(corner[0].normal_oct, oct, 2) && !memcmp(corner[1].normal_oct, oct, 2))
		return;
	for (int i = 0; i < 3; i++) {
		struct dvec3 normal = oct_unit_normal(corner[i].normal_oct);
		sum = (struct dvec3){ sum.x + normal.x, sum.y + normal.y, sum.z + normal.z };
	}
	if (sum.x != 0 || sum.y != 0 || sum.z != 0)
		oct_encode(sum, oct);
}

static void add_triangle(struct capture_batch *batch, const struct pkg *pkg, const struct pkg_mesh_vertex *vertices,
	const uint16_t corner[3], struct capture_triangle triangle)
{
	struct pkg_mesh_vertex *to = &batch->vertices.items[batch->vertices.count];
	for (int i = 0; i < 3; i++)
		to[i] = vertices[corner[i]];
	mean_normal(to, triangle.normal_oct);
	/* what GL takes as constant over a triangle comes from its last vertex */
	triangle.kind = pkg->materials[to[2].material].kind;
	triangle.seed = to[2].seed;
	batch->vertices.count += 3;
	batch->triangles.items[batch->triangles.count++] = triangle;
}

static void add_object(struct capture_batch *batch, const struct pkg *pkg, const struct triangle_set *set,
	const struct triangle_set_item *item, int pass)
{
	const struct pkg_object *object = &pkg->objects[item->object];
	const struct pkg_chunk *chunk = &pkg->chunks[object->chunk];
	const struct pkg_mesh_vertex *vertices = pkg_chunk_vertices(pkg, chunk);
	const uint16_t *indices = pkg_chunk_indices(pkg, chunk) + object->first_index[pass];
	const uint64_t *words = &set->words.items[item->first_word];
	uint32_t first = (uint32_t)batch->triangles.count, bit = 0;
	for (int before = 0; before < pass; before++)
		bit += object->index_count[before] / 3;
	for (uint32_t i = 0; i < object->index_count[pass] / 3; i++, bit++) {
		if (!(words[bit / 64] >> (bit % 64) & 1))
			continue;
		struct capture_triangle triangle = { .object = item->object, .bit = bit, .decal = pass == PKG_PASS_DECAL };
		add_triangle(batch, pkg, vertices, indices + (size_t)i * 3, triangle);
	}
	uint32_t count = (uint32_t)batch->triangles.count - first;
	if (count)
		ARRAY_PUSH(&batch->ranges, (struct capture_range){ item->object, first, count });
}

void capture_batch_fill(struct capture_batch *batch, const struct pkg *pkg, const struct triangle_set *set)
{
	batch->vertices.count = batch->triangles.count = batch->ranges.count = 0;
	if (!batch->chunk_state) {
		batch->chunk_state = array_grow(NULL, &(size_t){ 0 }, (size_t)pkg->chunk_count + 1, 1);
		memset(batch->chunk_state, UNKNOWN, pkg->chunk_count);
	}
	ARRAY_RESERVE(&batch->vertices, (size_t)set->triangles * 3 + 3);
	ARRAY_RESERVE(&batch->triangles, (size_t)set->triangles + 1);
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++) {
		batch->first_range[pass] = batch->ranges.count;
		for (size_t i = 0; i < set->items.count; i++)
			if (chunk_is_good(batch, pkg, pkg->objects[set->items.items[i].object].chunk))
				add_object(batch, pkg, set, &set->items.items[i], pass);
	}
	batch->first_range[PKG_PASS_COUNT] = batch->ranges.count;
}
