/* Hashes of what a stretch is made of, so that a bake does again only what has changed. Linear in the bytes. */
#include <string.h>

#include "assets/pkg_check.h"
#include "platform/base/rng.h"
#include "tools/impostor/cell_bake.h"

/* Grows whenever the same input gives other bytes. */
#define BAKE_VERSION 5

static uint64_t add_bytes(uint64_t hash, const void *bytes, size_t size)
{
	const uint8_t *at = bytes;
	for (; size >= 8; at += 8, size -= 8) {
		uint64_t word;
		memcpy(&word, at, 8);
		hash = hash_u64(hash ^ word);
	}
	uint64_t rest = size;
	memcpy(&rest, at, size);
	return size ? hash_u64(hash ^ rest ^ (uint64_t)size << 56) : hash;
}

static uint64_t hash_object(const struct pkg *pkg, const struct pkg_object *object)
{
	const struct pkg_chunk *chunk = &pkg->chunks[object->chunk];
	const struct pkg_mesh_vertex *vertices = pkg_chunk_vertices(pkg, chunk);
	const uint16_t *indices = pkg_chunk_indices(pkg, chunk);
	uint64_t hash = BAKE_VERSION;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++) {
		hash = hash_u64(hash ^ object->index_count[pass]);
		for (uint32_t i = 0; i < object->index_count[pass]; i++) {
			/* Where it is in the city, not in its chunk, whose origin depends on others. */
			struct pkg_mesh_vertex vertex = vertices[indices[object->first_index[pass] + i]];
			for (int axis = 0; axis < 3; axis++)
				vertex.pos_mm[axis] += chunk->origin_mm[axis];
			hash = add_bytes(hash, &vertex, sizeof(vertex));
		}
	}
	return hash;
}

uint64_t *cell_object_hashes(const struct pkg *pkg)
{
	uint64_t *out = array_grow(NULL, &(size_t){ 0 }, pkg->object_count + 1, sizeof(*out));
	for (uint32_t i = 0; i < pkg->object_count; i++)
		out[i] = hash_object(pkg, &pkg->objects[i]);
	return out;
}

uint64_t cell_package_hash(const struct pkg *pkg)
{
	const struct pkg_section *sections;
	uint32_t count = pkg_sections(pkg, &sections);
	uint64_t hash = BAKE_VERSION;
	for (uint32_t i = 0; i < count; i++)
		if (sections[i].tag == PKG_MATL || sections[i].tag == PKG_TEXA)
			hash = hash_u64(hash ^ sections[i].tag ^ (uint64_t)sections[i].crc32 << 32);
	return hash;
}

static uint64_t add_set(uint64_t hash, const struct triangle_set *set, const uint64_t *object_hashes)
{
	hash = hash_u64(hash ^ set->items.count);
	for (size_t i = 0; i < set->items.count; i++) {
		hash = hash_u64(hash ^ set->items.items[i].object ^ (uint64_t)set->items.items[i].kept << 32);
		hash = hash_u64(hash ^ object_hashes[set->items.items[i].object]);
	}
	return add_bytes(hash, set->words.items, set->words.count * sizeof(*set->words.items));
}

uint64_t cell_input_hash(const struct pkg_stretch *stretch, const struct visible_sets *sets,
	const uint64_t *object_hashes, uint64_t package_hash, const struct cell_options *options)
{
	const double numbers[] = { options->tau_px, options->focal_px, options->texels_per_px, options->far_m,
		options->triangles_max, options->pages_max, options->pvs, options->impostor, options->grid, options->truth };
	uint64_t hash = add_bytes(package_hash, numbers, sizeof(numbers));
	/* Where it lies, but not which edge of how many it is. */
	hash = add_bytes(hash, stretch->start_mm, sizeof(stretch->start_mm));
	hash = add_bytes(hash, stretch->end_mm, sizeof(stretch->end_mm));
	hash = hash_u64(hash ^ stretch->half_width_mm ^ (uint64_t)stretch->overrun_mm << 16 ^
					(uint64_t)stretch->eye_min_mm << 32 ^ (uint64_t)stretch->eye_max_mm << 48);
	hash = hash_u64(hash ^ stretch->near_mm ^ (uint64_t)sets->near_candidates << 32);
	hash = add_set(hash, &sets->near_set, object_hashes);
	return add_set(hash, &sets->far_set, object_hashes);
}
