/*
 * Collecting triangles and packing them into chunks. Vertices are quantised as they come in (24 bytes each), so a city
 * of ten million triangles stays under a gigabyte. Packing sorts the objects once and copies every vertex once.
 */
#include "tools/bake/mesh.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define CHUNK_VERTICES_WANTED 16384u /* a chunk closes here: about 0.5 MiB with its indices */
#define CHUNK_VERTICES_MAX 65536u    /* what 16-bit indices reach */
#define BLOCK_TILE_MM (256 * 1000)   /* larger blocks fall apart into squares of this size */

struct sink_object {
	struct mesh_object about;
	size_t first_vertex, vertex_count;
	size_t first_index[PKG_PASS_COUNT], index_count[PKG_PASS_COUNT];
};

struct mesh_sink {
	ARRAY(struct pkg_mesh_vertex) vertices; /* city frame, not yet relative to a chunk */
	ARRAY(uint32_t) indices[PKG_PASS_COUNT];
	ARRAY(struct sink_object) objects;
	bool open;
};

struct mesh_sink *mesh_sink_new(void)
{
	struct mesh_sink *sink = array_grow(NULL, &(size_t){ 0 }, 1, sizeof(*sink));
	memset(sink, 0, sizeof(*sink));
	return sink;
}

void mesh_sink_free(struct mesh_sink *sink)
{
	if (!sink)
		return;
	ARRAY_FINISH(&sink->vertices);
	ARRAY_FINISH(&sink->objects);
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
		ARRAY_FINISH(&sink->indices[pass]);
	array_free(sink);
}

void mesh_begin(struct mesh_sink *sink, const struct mesh_object *object)
{
	assert(!sink->open);
	struct sink_object fresh = { .about = *object, .first_vertex = sink->vertices.count };
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
		fresh.first_index[pass] = sink->indices[pass].count;
	ARRAY_PUSH(&sink->objects, fresh);
	sink->open = true;
}

static int8_t to_snorm(double value)
{
	return (int8_t)lrint(fmin(fmax(value, -1.0), 1.0) * 127.0);
}

/* Octahedral map: project on |x| + |y| + |z| = 1, fold the lower half outwards (Meyer et al. 2010, section 3). */
static void encode_normal(int8_t out[2], struct vec3 n)
{
	double sum = fabs((double)n.x) + fabs((double)n.y) + fabs((double)n.z);
	if (!(sum > 0.0)) {
		out[0] = out[1] = 0;
		return;
	}
	double x = (double)n.x / sum, y = (double)n.y / sum;
	if (n.z < 0.0f) {
		double fold_x = (1.0 - fabs(y)) * (x >= 0.0 ? 1.0 : -1.0);
		double fold_y = (1.0 - fabs(x)) * (y >= 0.0 ? 1.0 : -1.0);
		x = fold_x;
		y = fold_y;
	}
	out[0] = to_snorm(x);
	out[1] = to_snorm(y);
}

static uint16_t encode_uv(float tiles)
{
	double value = fmin(fmax((double)tiles, 0.0), 255.99) * 256.0;
	return (uint16_t)lrint(value);
}

static int32_t encode_mm(double metres)
{
	assert(isfinite(metres));
	return (int32_t)llrint(metres * 1000.0);
}

uint32_t mesh_add_vertex(struct mesh_sink *sink, const struct mesh_vertex *vertex)
{
	assert(sink->open);
	struct pkg_mesh_vertex packed = {
		.pos_mm = { encode_mm(vertex->at.x), encode_mm(vertex->at.y), encode_mm(vertex->at.z) },
		.ao = (uint8_t)lrintf(fminf(fmaxf(vertex->ao, 0.0f), 1.0f) * 255.0f),
		.material = vertex->material,
		.uv = { encode_uv(vertex->u), encode_uv(vertex->v) },
		.rgb = { vertex->rgb[0], vertex->rgb[1], vertex->rgb[2] },
		.seed = vertex->seed,
	};
	encode_normal(packed.normal_oct, vertex->normal);
	ARRAY_PUSH(&sink->vertices, packed);
	struct sink_object *object = &sink->objects.items[sink->objects.count - 1];
	return (uint32_t)object->vertex_count++;
}

void mesh_add_triangle(struct mesh_sink *sink, enum pkg_pass pass, uint32_t a, uint32_t b, uint32_t c)
{
	assert(sink->open);
	struct sink_object *object = &sink->objects.items[sink->objects.count - 1];
	assert(a < object->vertex_count && b < object->vertex_count && c < object->vertex_count);
	if (a == b || b == c || c == a)
		return;
	ARRAY_PUSH(&sink->indices[pass], a);
	ARRAY_PUSH(&sink->indices[pass], b);
	ARRAY_PUSH(&sink->indices[pass], c);
	object->index_count[pass] += 3;
}

void mesh_end(struct mesh_sink *sink)
{
	assert(sink->open);
	sink->open = false;
	struct sink_object *object = &sink->objects.items[sink->objects.count - 1];
	size_t indices = 0;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
		indices += object->index_count[pass];
	if (indices)
		return;
	sink->vertices.count = object->first_vertex;
	sink->objects.count--;
}

void mesh_append(struct mesh_sink *to, const struct mesh_sink *from)
{
	size_t vertex_shift = to->vertices.count, index_shift[PKG_PASS_COUNT];
	ARRAY_RESERVE(&to->vertices, to->vertices.count + from->vertices.count);
	if (from->vertices.count)
		memcpy(to->vertices.items + vertex_shift, from->vertices.items,
			from->vertices.count * sizeof(*from->vertices.items));
	to->vertices.count += from->vertices.count;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++) {
		size_t count = from->indices[pass].count;
		index_shift[pass] = to->indices[pass].count;
		ARRAY_RESERVE(&to->indices[pass], index_shift[pass] + count);
		if (count)
			memcpy(to->indices[pass].items + index_shift[pass], from->indices[pass].items, count * sizeof(uint32_t));
		to->indices[pass].count += count;
	}
	for (size_t i = 0; i < from->objects.count; i++) {
		struct sink_object object = from->objects.items[i];
		object.first_vertex += vertex_shift;
		for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
			object.first_index[pass] += index_shift[pass];
		ARRAY_PUSH(&to->objects, object);
	}
}

/* ---- packing ---- */

/* Sort key of an object: which chunk it may share. */
struct packing {
	uint32_t object;
	uint32_t kind, face;
	uint64_t tile; /* Morton code of the square */
	int32_t centre_mm[2];
};

static uint64_t spread_bits(uint32_t value)
{
	uint64_t x = value;
	x = (x | x << 16) & UINT64_C(0x0000FFFF0000FFFF);
	x = (x | x << 8) & UINT64_C(0x00FF00FF00FF00FF);
	x = (x | x << 4) & UINT64_C(0x0F0F0F0F0F0F0F0F);
	x = (x | x << 2) & UINT64_C(0x3333333333333333);
	return (x | x << 1) & UINT64_C(0x5555555555555555);
}

static uint64_t morton_of(int64_t east_mm, int64_t north_mm, int64_t step_mm)
{
	int64_t half = INT64_C(1) << 31;
	uint32_t x = (uint32_t)((east_mm + half) / step_mm), y = (uint32_t)((north_mm + half) / step_mm);
	return spread_bits(x) | spread_bits(y) << 1;
}

static void object_bounds(
	const struct mesh_sink *sink, const struct sink_object *object, int32_t min[3], int32_t max[3])
{
	const struct pkg_mesh_vertex *vertex = sink->vertices.items + object->first_vertex;
	memcpy(min, vertex->pos_mm, sizeof(vertex->pos_mm));
	memcpy(max, vertex->pos_mm, sizeof(vertex->pos_mm));
	for (size_t i = 1; i < object->vertex_count; i++) {
		for (int axis = 0; axis < 3; axis++) {
			int32_t at = vertex[i].pos_mm[axis];
			min[axis] = at < min[axis] ? at : min[axis];
			max[axis] = at > max[axis] ? at : max[axis];
		}
	}
}

static int compare_packing(const void *left, const void *right)
{
	const struct packing *a = left, *b = right;
	if (a->kind != b->kind)
		return a->kind < b->kind ? -1 : 1;
	if (a->tile != b->tile)
		return a->tile < b->tile ? -1 : 1;
	if (a->face != b->face)
		return a->face < b->face ? -1 : 1;
	return a->object < b->object ? -1 : a->object > b->object;
}

/* Objects of one block are to share chunks, wherever the tile grid lies: the block's tile is that of its first object,
 * unless an object lies further than BLOCK_TILE_MM from there. */
static void group_blocks(struct packing *packing, size_t count)
{
	uint32_t faces = 0;
	for (size_t i = 0; i < count; i++)
		if (packing[i].face != PKG_NONE && packing[i].face >= faces)
			faces = packing[i].face + 1;
	uint32_t *first = malloc(sizeof(uint32_t) * ((size_t)faces + 1));
	if (!first)
		abort();
	for (uint32_t i = 0; i <= faces; i++)
		first[i] = PKG_NONE;
	for (size_t i = 0; i < count; i++) {
		if (packing[i].face == PKG_NONE)
			continue;
		uint32_t *lead = &first[packing[i].face];
		if (*lead == PKG_NONE)
			*lead = (uint32_t)i;
		const int32_t *at = packing[i].centre_mm, *from = packing[*lead].centre_mm;
		if (llabs((int64_t)at[0] - from[0]) < BLOCK_TILE_MM && llabs((int64_t)at[1] - from[1]) < BLOCK_TILE_MM)
			packing[i].tile = packing[*lead].tile;
	}
	free(first);
}

static struct packing *sort_objects(const struct mesh_sink *sink)
{
	size_t count = sink->objects.count;
	struct packing *packing = array_grow(NULL, &(size_t){ 0 }, count + 1, sizeof(*packing));
	for (size_t i = 0; i < count; i++) {
		const struct sink_object *object = &sink->objects.items[i];
		bool block = object->about.kind == PKG_OBJECT_BUILDING || object->about.kind == PKG_OBJECT_TREE;
		int32_t min[3], max[3];
		object_bounds(sink, object, min, max);
		struct packing *out = &packing[i];
		*out = (struct packing){
			.object = (uint32_t)i,
			.kind = block ? PKG_CHUNK_BLOCK : PKG_CHUNK_GROUND,
			.face = block ? object->about.face : PKG_NONE,
			.centre_mm = { (int32_t)(((int64_t)min[0] + max[0]) / 2), (int32_t)(((int64_t)min[1] + max[1]) / 2) },
		};
		out->tile =
			morton_of(out->centre_mm[0], out->centre_mm[1], block ? BLOCK_TILE_MM : (int64_t)(MESH_TILE_M * 1000.0));
	}
	group_blocks(packing, count);
	qsort(packing, count, sizeof(*packing), compare_packing);
	return packing;
}

/* The chunk being filled. */
struct packer {
	const struct mesh_sink *sink;
	struct mesh_chunks *out;
	ARRAY(struct pkg_mesh_vertex) vertices;
	ARRAY(uint16_t) indices[PKG_PASS_COUNT];
	size_t first_object;
	uint32_t kind, face;
};

static void pad_geometry(struct mesh_chunks *out)
{
	while (out->geometry.count % 64)
		ARRAY_PUSH(&out->geometry, 0);
}

static uint64_t put_bytes(struct mesh_chunks *out, const void *bytes, size_t size)
{
	pad_geometry(out);
	size_t at = out->geometry.count;
	ARRAY_RESERVE(&out->geometry, at + size);
	if (size)
		memcpy(out->geometry.items + at, bytes, size);
	out->geometry.count += size;
	return at;
}

static void chunk_bounds(struct pkg_chunk *chunk, const struct pkg_mesh_vertex *vertices, size_t count)
{
	for (int axis = 0; axis < 3; axis++) {
		chunk->min_mm[axis] = chunk->max_mm[axis] = vertices[0].pos_mm[axis];
		for (size_t i = 1; i < count; i++) {
			int32_t at = vertices[i].pos_mm[axis];
			if (at < chunk->min_mm[axis])
				chunk->min_mm[axis] = at;
			if (at > chunk->max_mm[axis])
				chunk->max_mm[axis] = at;
		}
		chunk->origin_mm[axis] = (int32_t)(((int64_t)chunk->min_mm[axis] + chunk->max_mm[axis]) / 2);
	}
}

static void finish_chunk(struct packer *packer)
{
	struct mesh_chunks *out = packer->out;
	if (packer->vertices.count == 0)
		return;
	struct pkg_chunk chunk = {
		.kind = packer->kind,
		.face = packer->face,
		.first_object = (uint32_t)packer->first_object,
		.object_count = (uint32_t)(out->objects.count - packer->first_object),
		.vertex_count = (uint32_t)packer->vertices.count,
	};
	chunk_bounds(&chunk, packer->vertices.items, packer->vertices.count);
	for (size_t i = 0; i < packer->vertices.count; i++)
		for (int axis = 0; axis < 3; axis++)
			packer->vertices.items[i].pos_mm[axis] -= chunk.origin_mm[axis];
	chunk.vertex_offset =
		put_bytes(out, packer->vertices.items, packer->vertices.count * sizeof(struct pkg_mesh_vertex));
	uint32_t pass_start[PKG_PASS_COUNT];
	for (int pass = 0, start = 0; pass < PKG_PASS_COUNT; pass++) {
		pass_start[pass] = (uint32_t)start;
		chunk.index_count[pass] = (uint32_t)packer->indices[pass].count;
		start += (int)packer->indices[pass].count;
		out->triangles += packer->indices[pass].count / 3;
	}
	pad_geometry(out);
	chunk.index_offset = out->geometry.count;
	size_t index_bytes = 0;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++) {
		size_t bytes = packer->indices[pass].count * sizeof(uint16_t);
		ARRAY_RESERVE(&out->geometry, out->geometry.count + bytes);
		if (bytes)
			memcpy(out->geometry.items + out->geometry.count, packer->indices[pass].items, bytes);
		out->geometry.count += bytes;
		index_bytes += bytes;
		packer->indices[pass].count = 0;
	}
	uLong crc = crc32(
		0L, out->geometry.items + chunk.vertex_offset, (uInt)(packer->vertices.count * sizeof(struct pkg_mesh_vertex)));
	chunk.crc32 = (uint32_t)crc32(crc, out->geometry.items + chunk.index_offset, (uInt)index_bytes);
	for (size_t i = packer->first_object; i < out->objects.count; i++) {
		out->objects.items[i].chunk = (uint32_t)out->chunks.count;
		for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
			out->objects.items[i].first_index[pass] += pass_start[pass];
	}
	ARRAY_PUSH(&out->chunks, chunk);
	packer->vertices.count = 0;
	packer->first_object = out->objects.count;
}

static uint32_t name_index(struct mesh_chunks *out, const char *name)
{
	if (!name || !*name)
		return 0;
	ARRAY_PUSH(&out->names, name);
	return (uint32_t)out->names.count;
}

static void begin_object(struct packer *packer, const struct sink_object *object, uint32_t name)
{
	struct pkg_object fresh = {
		.source_id = object->about.source_id,
		.kind = (uint16_t)object->about.kind,
		.flags = object->about.flags,
		.name = name,
	};
	for (int axis = 0; axis < 3; axis++) {
		fresh.min_mm[axis] = INT32_MAX;
		fresh.max_mm[axis] = INT32_MIN;
	}
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
		fresh.first_index[pass] = (uint32_t)packer->indices[pass].count;
	ARRAY_PUSH(&packer->out->objects, fresh);
}

static void put_object_vertex(struct packer *packer, const struct pkg_mesh_vertex *vertex)
{
	struct pkg_object *object = &packer->out->objects.items[packer->out->objects.count - 1];
	for (int axis = 0; axis < 3; axis++) {
		int32_t at = vertex->pos_mm[axis];
		if (at < object->min_mm[axis])
			object->min_mm[axis] = at;
		if (at > object->max_mm[axis])
			object->max_mm[axis] = at;
	}
	ARRAY_PUSH(&packer->vertices, *vertex);
}

/* Copies an object's triangles, vertices on first use. An object that outgrows a chunk goes on in the next one under
 * the same id. */
static void put_object(struct packer *packer, const struct sink_object *object, uint32_t *remap)
{
	const struct pkg_mesh_vertex *vertices = packer->sink->vertices.items + object->first_vertex;
	uint32_t name = name_index(packer->out, object->about.name);
	memset(remap, 0xFF, object->vertex_count * sizeof(*remap));
	begin_object(packer, object, name);
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++) {
		const uint32_t *indices = packer->sink->indices[pass].items + object->first_index[pass];
		for (size_t i = 0; i < object->index_count[pass]; i += 3) {
			if (packer->vertices.count + 3 > CHUNK_VERTICES_MAX) {
				finish_chunk(packer);
				memset(remap, 0xFF, object->vertex_count * sizeof(*remap));
				begin_object(packer, object, name);
			}
			for (size_t corner = 0; corner < 3; corner++) {
				uint32_t from = indices[i + corner];
				if (remap[from] == PKG_NONE) {
					remap[from] = (uint32_t)packer->vertices.count;
					put_object_vertex(packer, &vertices[from]);
				}
				ARRAY_PUSH(&packer->indices[pass], (uint16_t)remap[from]);
			}
			packer->out->objects.items[packer->out->objects.count - 1].index_count[pass] += 3;
		}
	}
}

void mesh_finish_chunks(const struct mesh_sink *sink, struct mesh_chunks *out)
{
	assert(!sink->open);
	*out = (struct mesh_chunks){ 0 };
	struct packing *order = sort_objects(sink);
	struct packer packer = { .sink = sink, .out = out };
	size_t largest = 1;
	for (size_t i = 0; i < sink->objects.count; i++)
		if (sink->objects.items[i].vertex_count > largest)
			largest = sink->objects.items[i].vertex_count;
	uint32_t *remap = array_grow(NULL, &(size_t){ 0 }, largest, sizeof(*remap));
	for (size_t i = 0; i < sink->objects.count; i++) {
		const struct packing *at = &order[i];
		const struct sink_object *object = &sink->objects.items[at->object];
		bool other =
			i == 0 || at->kind != order[i - 1].kind || at->tile != order[i - 1].tile || at->face != order[i - 1].face;
		if (other || packer.vertices.count + object->vertex_count > CHUNK_VERTICES_WANTED)
			finish_chunk(&packer);
		packer.kind = at->kind;
		packer.face = at->face;
		put_object(&packer, object, remap);
	}
	finish_chunk(&packer);
	pad_geometry(out);
	array_free(remap);
	array_free(order);
	ARRAY_FINISH(&packer.vertices);
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
		ARRAY_FINISH(&packer.indices[pass]);
}

void mesh_chunks_finish(struct mesh_chunks *chunks)
{
	ARRAY_FINISH(&chunks->chunks);
	ARRAY_FINISH(&chunks->objects);
	ARRAY_FINISH(&chunks->names);
	ARRAY_FINISH(&chunks->geometry);
}
