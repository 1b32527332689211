/*
 * Sets of triangles as one mask an object. The on-disk form leaves out the masks of objects that are kept whole, which
 * are most of what is near.
 */
#include "tools/impostor/triangle_set.h"

#include <assert.h>
#include <errno.h>
#include <string.h>

static uint32_t word_count(const struct pkg *pkg, uint32_t object)
{
	return (triangle_set_object_size(&pkg->objects[object]) + 63) / 64;
}

void triangle_set_finish(struct triangle_set *set)
{
	ARRAY_FINISH(&set->items);
	ARRAY_FINISH(&set->words);
	set->triangles = 0;
}

void triangle_set_clear(struct triangle_set *set)
{
	set->items.count = 0;
	set->words.count = 0;
	set->triangles = 0;
}

uint64_t *triangle_set_add(struct triangle_set *set, const struct pkg *pkg, uint32_t object)
{
	assert(!set->items.count || set->items.items[set->items.count - 1].object < object);
	uint32_t words = word_count(pkg, object);
	ARRAY_PUSH(&set->items, (struct triangle_set_item){ .object = object, .first_word = (uint32_t)set->words.count });
	ARRAY_RESERVE(&set->words, set->words.count + words + 1); /* never NULL, even for an object of nothing */
	uint64_t *out = &set->words.items[set->words.count];
	memset(out, 0, words * sizeof(*out));
	set->words.count += words;
	return out;
}

static uint32_t count_bits(const uint64_t *words, uint32_t count)
{
	uint32_t sum = 0;
	for (uint32_t i = 0; i < count; i++)
		sum += (uint32_t)__builtin_popcountll(words[i]);
	return sum;
}

void triangle_set_tidy(struct triangle_set *set, const struct pkg *pkg)
{
	size_t items = 0, words = 0;
	set->triangles = 0;
	for (size_t i = 0; i < set->items.count; i++) {
		struct triangle_set_item item = set->items.items[i];
		uint32_t count = word_count(pkg, item.object);
		const uint64_t *from = &set->words.items[item.first_word];
		item.kept = count_bits(from, count);
		if (!item.kept)
			continue;
		memmove(&set->words.items[words], from, count * sizeof(*from));
		item.first_word = (uint32_t)words;
		words += count;
		set->items.items[items++] = item;
		set->triangles += item.kept;
	}
	set->items.count = items;
	set->words.count = words;
}

static uint64_t combine_words(uint64_t a, uint64_t b, enum triangle_set_operation how)
{
	switch (how) {
	case TRIANGLE_SET_AND:
		return a & b;
	case TRIANGLE_SET_OR:
		return a | b;
	case TRIANGLE_SET_WITHOUT:
		return a & ~b;
	}
	return 0;
}

void triangle_set_combine(const struct triangle_set *a, const struct triangle_set *b, enum triangle_set_operation how,
	const struct pkg *pkg, struct triangle_set *out)
{
	assert(out != a && out != b);
	triangle_set_clear(out);
	for (size_t i = 0, j = 0; i < a->items.count || j < b->items.count;) {
		uint32_t next_a = i < a->items.count ? a->items.items[i].object : PKG_NONE;
		uint32_t next_b = j < b->items.count ? b->items.items[j].object : PKG_NONE;
		uint32_t object = next_a < next_b ? next_a : next_b;
		const struct triangle_set_item *left = next_a == object ? &a->items.items[i++] : NULL;
		const struct triangle_set_item *right = next_b == object ? &b->items.items[j++] : NULL;
		uint64_t *words = triangle_set_add(out, pkg, object);
		for (uint32_t k = 0; k < word_count(pkg, object); k++)
			words[k] = combine_words(left ? a->words.items[left->first_word + k] : 0,
				right ? b->words.items[right->first_word + k] : 0, how);
	}
	triangle_set_tidy(out, pkg);
}

void triangle_set_corners(const struct pkg *pkg, uint32_t object, uint32_t triangle, int64_t out[3][3])
{
	const struct pkg_object *from = &pkg->objects[object];
	const struct pkg_chunk *chunk = &pkg->chunks[from->chunk];
	int pass = PKG_PASS_OPAQUE;
	while (triangle >= from->index_count[pass] / 3)
		triangle -= from->index_count[pass++] / 3;
	const struct pkg_mesh_vertex *vertices = pkg_chunk_vertices(pkg, chunk);
	const uint16_t *indices = pkg_chunk_indices(pkg, chunk) + from->first_index[pass] + (size_t)triangle * 3;
	for (int corner = 0; corner < 3; corner++)
		for (int axis = 0; axis < 3; axis++)
			out[corner][axis] = (int64_t)chunk->origin_mm[axis] + vertices[indices[corner]].pos_mm[axis];
}

static void append(byte_array *out, const void *bytes, size_t size)
{
	ARRAY_RESERVE(out, out->count + size);
	memcpy(out->items + out->count, bytes, size);
	out->count += size;
}

/* Least significant byte first, whatever the machine. */
static void append_mask(byte_array *out, const uint64_t *words, uint32_t bits)
{
	for (uint32_t byte = 0; byte < (bits + 7) / 8; byte++)
		ARRAY_PUSH(out, (uint8_t)(words[byte / 8] >> (8 * (byte % 8))));
}

void triangle_set_encode(const struct triangle_set *set, const struct pkg *pkg, byte_array *out)
{
	struct pkg_set_head head = { .object_count = (uint32_t)set->items.count, .triangle_count = set->triangles };
	append(out, &head, sizeof(head));
	for (size_t i = 0; i < set->items.count; i++) {
		const struct triangle_set_item *item = &set->items.items[i];
		append(
			out, &(struct pkg_set_object){ .object = item->object, .kept = item->kept }, sizeof(struct pkg_set_object));
	}
	for (size_t i = 0; i < set->items.count; i++) {
		const struct triangle_set_item *item = &set->items.items[i];
		uint32_t size = triangle_set_object_size(&pkg->objects[item->object]);
		if (item->kept < size)
			append_mask(out, &set->words.items[item->first_word], size);
	}
}

struct mask_bytes {
	const uint8_t *at;
	size_t left;
};

/* False when the bytes run out, or a bit is set that stands for no triangle. */
static bool take_mask(struct mask_bytes *from, uint64_t *words, uint32_t bits)
{
	uint32_t bytes = (bits + 7) / 8;
	if (from->left < bytes || (bits % 8 && from->at[bytes - 1] >> (bits % 8)))
		return false;
	for (uint32_t byte = 0; byte < bytes; byte++)
		words[byte / 8] |= (uint64_t)from->at[byte] << (8 * (byte % 8));
	from->at += bytes;
	from->left -= bytes;
	return true;
}

static void fill_mask(uint64_t *words, uint32_t bits)
{
	memset(words, 0xFF, bits / 64 * sizeof(*words));
	if (bits % 64)
		words[bits / 64] = (UINT64_C(1) << (bits % 64)) - 1;
}

static bool decode_object(
	const struct pkg *pkg, const struct pkg_set_object *from, struct mask_bytes *masks, struct triangle_set *out)
{
	size_t count = out->items.count;
	if (from->object >= pkg->object_count || (count && from->object <= out->items.items[count - 1].object))
		return false;
	uint32_t size = triangle_set_object_size(&pkg->objects[from->object]);
	if (!from->kept || from->kept > size)
		return false;
	uint64_t *words = triangle_set_add(out, pkg, from->object);
	if (from->kept == size)
		fill_mask(words, size);
	else if (!take_mask(masks, words, size) || count_bits(words, word_count(pkg, from->object)) != from->kept)
		return false;
	out->items.items[count].kept = from->kept;
	out->triangles += from->kept;
	return true;
}

int triangle_set_decode(const struct pkg *pkg, const uint8_t *bytes, size_t size, struct triangle_set *out)
{
	triangle_set_clear(out);
	struct pkg_set_head head;
	if (size < sizeof(head))
		return -EBADMSG;
	memcpy(&head, bytes, sizeof(head));
	const uint8_t *objects = bytes + sizeof(head);
	if (head.object_count > (size - sizeof(head)) / sizeof(struct pkg_set_object))
		return -EBADMSG;
	struct mask_bytes masks = { .at = objects + (size_t)head.object_count * sizeof(struct pkg_set_object) };
	masks.left = size - (size_t)(masks.at - bytes);
	for (uint32_t i = 0; i < head.object_count; i++) {
		struct pkg_set_object object;
		memcpy(&object, objects + (size_t)i * sizeof(object), sizeof(object));
		if (!decode_object(pkg, &object, &masks, out))
			return -EBADMSG;
	}
	return masks.left || out->triangles != head.triangle_count ? -EBADMSG : 0;
}
