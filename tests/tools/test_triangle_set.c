/* Sets of triangles: what is written is read back, hostile bytes are refused, sets combine. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "platform/base/rng.h"
#include "tools/impostor/triangle_set.h"

/* Objects of 1, 8, 70, 128 and 3 + 2 triangles: nothing but their counts matters to most of the functions. */
static const struct pkg_object objects[] = {
	{ .index_count = { 3, 0 } },
	{ .index_count = { 24, 0 } },
	{ .index_count = { 210, 0 } },
	{ .index_count = { 384, 0 } },
	{ .index_count = { 9, 6 }, .first_index = { 3, 12 } },
};
#define OBJECT_COUNT (sizeof(objects) / sizeof(objects[0]))
static const struct pkg pkg = { .objects = objects, .object_count = OBJECT_COUNT };

static void set_bit(uint64_t *words, uint32_t bit)
{
	words[bit / 64] |= UINT64_C(1) << (bit % 64);
}

/* Each triangle with a chance of share / 8; 8 keeps all. */
static void fill_random(struct triangle_set *set, uint64_t seed, uint32_t share)
{
	triangle_set_clear(set);
	for (uint32_t object = 0; object < OBJECT_COUNT; object++) {
		uint64_t *words = triangle_set_add(set, &pkg, object);
		for (uint32_t i = 0; i < triangle_set_object_size(&objects[object]); i++)
			if (hash_u64(seed + object * 1000 + i) % 8 < share)
				set_bit(words, i);
	}
	triangle_set_tidy(set, &pkg);
}

static bool has(const struct triangle_set *set, uint32_t object, uint32_t triangle)
{
	for (size_t i = 0; i < set->items.count; i++)
		if (set->items.items[i].object == object)
			return set->words.items[set->items.items[i].first_word + triangle / 64] >> (triangle % 64) & 1;
	return false;
}

static void assert_equal(const struct triangle_set *a, const struct triangle_set *b)
{
	assert_int_equal(a->items.count, b->items.count);
	assert_int_equal(a->triangles, b->triangles);
	for (size_t i = 0; i < a->items.count; i++) {
		assert_int_equal(a->items.items[i].object, b->items.items[i].object);
		assert_int_equal(a->items.items[i].kept, b->items.items[i].kept);
	}
	for (uint32_t object = 0; object < OBJECT_COUNT; object++)
		for (uint32_t i = 0; i < triangle_set_object_size(&objects[object]); i++)
			assert_int_equal(has(a, object, i), has(b, object, i));
}

static void tidying_counts_and_drops_empty_objects(void **state)
{
	(void)state;
	struct triangle_set set = { 0 };
	triangle_set_add(&set, &pkg, 1);
	uint64_t *words = triangle_set_add(&set, &pkg, 2);
	set_bit(words, 0);
	set_bit(words, 69);
	triangle_set_add(&set, &pkg, 3);
	triangle_set_tidy(&set, &pkg);
	assert_int_equal(set.items.count, 1);
	assert_int_equal(set.items.items[0].object, 2);
	assert_int_equal(set.items.items[0].kept, 2);
	assert_int_equal(set.triangles, 2);
	assert_true(has(&set, 2, 0) && has(&set, 2, 69) && !has(&set, 2, 68));
	triangle_set_finish(&set);
}

static void what_is_encoded_is_decoded(void **state)
{
	(void)state;
	struct triangle_set set = { 0 }, back = { 0 };
	byte_array bytes = { 0 };
	for (uint32_t share = 0; share <= 8; share++) {
		for (uint64_t seed = 0; seed < 20; seed++) {
			fill_random(&set, seed * 7919, share);
			bytes.count = 0;
			triangle_set_encode(&set, &pkg, &bytes);
			assert_int_equal(triangle_set_decode(&pkg, bytes.items, bytes.count, &back), 0);
			assert_equal(&set, &back);
		}
	}
	triangle_set_finish(&set);
	triangle_set_finish(&back);
	ARRAY_FINISH(&bytes);
}

static void whole_objects_take_no_mask(void **state)
{
	(void)state;
	struct triangle_set set = { 0 };
	byte_array bytes = { 0 };
	fill_random(&set, 1, 8);
	triangle_set_encode(&set, &pkg, &bytes);
	assert_int_equal(bytes.count, sizeof(struct pkg_set_head) + OBJECT_COUNT * sizeof(struct pkg_set_object));
	triangle_set_finish(&set);
	ARRAY_FINISH(&bytes);
}

static void truncated_or_grown_bytes_are_refused(void **state)
{
	(void)state;
	struct triangle_set set = { 0 }, back = { 0 };
	byte_array bytes = { 0 };
	fill_random(&set, 3, 4);
	triangle_set_encode(&set, &pkg, &bytes);
	for (size_t size = 0; size < bytes.count; size++)
		assert_int_equal(triangle_set_decode(&pkg, bytes.items, size, &back), -EBADMSG);
	ARRAY_PUSH(&bytes, 0);
	assert_int_equal(triangle_set_decode(&pkg, bytes.items, bytes.count, &back), -EBADMSG);
	triangle_set_finish(&set);
	triangle_set_finish(&back);
	ARRAY_FINISH(&bytes);
}

/* Any flipped bit is refused, or gives a set that is sound: masks are not checksummed. */
static void flipped_bits_never_give_an_unsound_set(void **state)
{
	(void)state;
	struct triangle_set set = { 0 }, back = { 0 };
	byte_array bytes = { 0 };
	fill_random(&set, 5, 3);
	triangle_set_encode(&set, &pkg, &bytes);
	for (size_t bit = 0; bit < bytes.count * 8; bit++) {
		bytes.items[bit / 8] ^= (uint8_t)(1 << (bit % 8));
		if (triangle_set_decode(&pkg, bytes.items, bytes.count, &back) == 0) {
			uint32_t triangles = back.triangles;
			size_t items = back.items.count;
			triangle_set_tidy(&back, &pkg);
			assert_int_equal(back.triangles, triangles);
			assert_int_equal(back.items.count, items);
		}
		bytes.items[bit / 8] ^= (uint8_t)(1 << (bit % 8));
	}
	triangle_set_finish(&set);
	triangle_set_finish(&back);
	ARRAY_FINISH(&bytes);
}

static void hostile_bytes_are_refused(void **state)
{
	(void)state;
	static const struct {
		struct pkg_set_head head;
		struct pkg_set_object objects[2];
		uint8_t masks[4];
		size_t mask_bytes;
	} cases[] = {
		{ { UINT32_MAX, 1 }, { { 0, 1 } }, { 0 }, 0 },             /* more objects than bytes */
		{ { 2, 2 }, { { OBJECT_COUNT, 1 }, { 0, 1 } }, { 0 }, 0 }, /* no such object */
		{ { 2, 9 }, { { 1, 8 }, { 0, 1 } }, { 0 }, 0 },            /* not sorted */
		{ { 2, 2 }, { { 0, 1 }, { 0, 1 } }, { 0 }, 0 },            /* twice */
		{ { 2, 1 }, { { 0, 1 }, { 1, 0 } }, { 0 }, 1 },            /* nothing kept */
		{ { 2, 10 }, { { 0, 1 }, { 1, 9 } }, { 0 }, 0 },           /* more kept than there are */
		{ { 2, 3 }, { { 0, 1 }, { 1, 2 } }, { 1 }, 1 },            /* fewer bits than kept */
		{ { 2, 3 }, { { 0, 1 }, { 4, 2 } }, { 0x21 }, 1 },         /* a bit past the last triangle */
		{ { 2, 4 }, { { 0, 1 }, { 1, 2 } }, { 3 }, 1 },            /* sum is wrong */
	};
	struct triangle_set set = { 0 };
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		uint8_t bytes[sizeof(cases[0])];
		size_t size = sizeof(cases[i].head) + sizeof(cases[i].objects);
		memcpy(bytes, &cases[i], size);
		memcpy(bytes + size, cases[i].masks, cases[i].mask_bytes);
		assert_int_equal(triangle_set_decode(&pkg, bytes, size + cases[i].mask_bytes, &set), -EBADMSG);
	}
	triangle_set_finish(&set);
}

static bool expected(bool a, bool b, enum triangle_set_operation how)
{
	return how == TRIANGLE_SET_AND ? a && b : how == TRIANGLE_SET_OR ? a || b : a && !b;
}

static void sets_combine_triangle_by_triangle(void **state)
{
	(void)state;
	struct triangle_set a = { 0 }, b = { 0 }, out = { 0 };
	for (uint64_t seed = 0; seed < 30; seed++) {
		fill_random(&a, seed, (uint32_t)(seed % 4));
		fill_random(&b, seed + 100000, (uint32_t)(seed % 5) * 2);
		for (int how = TRIANGLE_SET_AND; how <= (int)TRIANGLE_SET_WITHOUT; how++) {
			triangle_set_combine(&a, &b, (enum triangle_set_operation)how, &pkg, &out);
			uint32_t sum = 0;
			for (uint32_t object = 0; object < OBJECT_COUNT; object++) {
				for (uint32_t i = 0; i < triangle_set_object_size(&objects[object]); i++) {
					bool want = expected(has(&a, object, i), has(&b, object, i), (enum triangle_set_operation)how);
					assert_int_equal(has(&out, object, i), want);
					sum += want;
				}
			}
			assert_int_equal(out.triangles, sum);
		}
	}
	triangle_set_finish(&a);
	triangle_set_finish(&b);
	triangle_set_finish(&out);
}

static void corners_are_found_across_passes(void **state)
{
	(void)state;
	struct {
		struct pkg_mesh_vertex vertices[20];
		uint16_t indices[20];
	} geometry = { 0 };
	for (int i = 0; i < 20; i++) {
		geometry.vertices[i].pos_mm[0] = i;
		geometry.indices[i] = (uint16_t)i;
	}
	struct pkg_chunk chunk = { .origin_mm = { 1000, INT32_MAX, 0 }, .index_offset = sizeof(geometry.vertices) };
	struct pkg with_geometry = pkg;
	with_geometry.chunks = &chunk;
	with_geometry.chunk_count = 1;
	with_geometry.geometry = (const uint8_t *)&geometry;
	int64_t corners[3][3];
	triangle_set_corners(&with_geometry, 4, 1, corners);
	assert_int_equal(corners[0][0], 1000 + 3 + 3);
	assert_int_equal(corners[2][0], 1000 + 3 + 5);
	assert_int_equal(corners[2][1], INT32_MAX);
	triangle_set_corners(&with_geometry, 4, 4, corners);
	assert_int_equal(corners[0][0], 1000 + 12 + 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tidying_counts_and_drops_empty_objects),
		cmocka_unit_test(what_is_encoded_is_decoded),
		cmocka_unit_test(whole_objects_take_no_mask),
		cmocka_unit_test(truncated_or_grown_bytes_are_refused),
		cmocka_unit_test(flipped_bits_never_give_an_unsound_set),
		cmocka_unit_test(hostile_bytes_are_refused),
		cmocka_unit_test(sets_combine_triangle_by_triangle),
		cmocka_unit_test(corners_are_found_across_passes),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
