/* The far field's sections and blobs: right ones are read, every kind of wrong one is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
/* before cmocka */
#include <cmocka.h>
#include <zlib.h>

#include "assets/cells.h"
#include "assets/impostor_fold.h"
#include "platform/base/rng.h"
#include "tests/assets/far_city.h"

static const struct far_city_config small = { .edges = 3,
	.stretches_an_edge = 2,
	.objects_a_chunk = 3,
	.triangles_an_object = 20,
	.impostor_vertices = 40,
	.impostor_pages = 2,
	.geometry_every = 3 };

static _Alignas(64) uint8_t memory[4 << 20], scratch[1 << 10];
static uint8_t *bytes;
static size_t size;
static struct pkg pkg;
static struct pkg_fault fault;

static int build(void **state)
{
	(void)state;
	bytes = far_city_build(&small, &size);
	return 0;
}

static int drop(void **state)
{
	(void)state;
	free(bytes);
	return 0;
}

/* pkg_open() and all further checks. */
static int check_all(const uint8_t *file, size_t file_size)
{
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	int status = far_city_open(file, file_size, &pkg, &fault);
	if (!status)
		status = pkg_verify(&pkg, &fault);
	if (!status)
		status = cells_verify(&pkg, &arena, &fault);
	pkg_close(&pkg);
	return status;
}

static void a_whole_package_is_read(void **state)
{
	(void)state;
	assert_int_equal(check_all(bytes, size), 0);
	assert_int_equal(far_city_open(bytes, size, &pkg, &fault), 0);
	assert_int_equal(pkg.stretch_count, 6);
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	struct blob_reader *reader;
	assert_int_equal(blob_reader_init(&reader, &arena), 0);
	size_t used = arena.used;
	uint8_t *raw = malloc(pkg.stretches[2].local.raw_bytes);
	struct set_view set;
	assert_int_equal(blob_read(reader, &pkg, &pkg.stretches[2].local, raw), 0);
	assert_int_equal(set_view_open(&set, &pkg, raw, pkg.stretches[2].local.raw_bytes), 0);
	assert_int_equal(set.object_count, 6);
	assert_int_equal(set.triangle_count, 3 * 21 + 3 * 11);
	assert_int_equal(set.objects[0].object, 6);
	assert_int_equal(set.masks[0], 0x55);
	free(raw);
	assert_int_equal(arena.used, used);
	pkg_close(&pkg);
}

static void a_package_without_a_far_field_has_no_stretches(void **state)
{
	(void)state;
	struct pkg none = { .graph.edge_count = 3 };
	assert_int_equal(cells_stretch_at(&none, 1, 0), PKG_NONE);
}

static void places_belong_to_their_stretch(void **state)
{
	(void)state;
	assert_int_equal(far_city_open(bytes, size, &pkg, &fault), 0);
	static const struct {
		uint32_t edge;
		int64_t along_mm;
		uint32_t stretch;
	} table[] = { { 0, 0, 0 }, { 0, -5, 0 }, { 0, 49999, 0 }, { 0, 50000, 1 }, { 0, 1000000000000, 1 }, { 2, 1, 4 },
		{ 2, 99999, 5 }, { 3, 0, PKG_NONE }, { PKG_NONE, 0, PKG_NONE } };
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++)
		assert_int_equal(cells_stretch_at(&pkg, table[i].edge, table[i].along_mm), table[i].stretch);
	pkg_close(&pkg);
}

static void the_view_cell_is_a_box_along_the_axis(void **state)
{
	(void)state;
	const struct pkg_stretch stretch = { .start_mm = { 1000, 1000, 5000 },
		.end_mm = { 1000, 41000, 7000 },
		.half_width_mm = 4000,
		.overrun_mm = 2000,
		.eye_min_mm = 1000,
		.eye_max_mm = 4000 };
	static const struct {
		int64_t eye_mm[3];
		double distance_m;
	} table[] = {
		{ { 1000, 1000, 7000 }, 0.0 },
		{ { 5000, 43000, 8500 }, 0.0 },
		{ { -3000, -1000, 6000 }, 0.0 },
		{ { 9000, 20000, 8000 }, 4.0 },
		{ { 1000, 48000, 9000 }, 5.0 },
		{ { 1000, -4000, 7000 }, 3.0 },
		{ { 1000, 1000, 19000 }, 10.0 },
		{ { 1000, 21000, 5000 }, 2.0 },
	};
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		assert_true(fabs(cells_distance_m(&stretch, table[i].eye_mm) - table[i].distance_m) < 1e-9);
		assert_int_equal(cells_holds_eye(&stretch, table[i].eye_mm), table[i].distance_m == 0.0);
	}
	struct pkg_stretch point = stretch;
	memcpy(point.end_mm, point.start_mm, sizeof(point.end_mm));
	assert_true(cells_holds_eye(&point, table[0].eye_mm));
}

/* A value that must not be there, in an array of the package. */
struct bad_value {
	const char *name;
	uint32_t tag;
	size_t offset, width;
	uint64_t value;
};
#define BAD(section, type, index, field, number)                                                                       \
	{                                                                                                                  \
#field " " #number, section, (index) * sizeof(type) + offsetof(type, field), sizeof(((type *)0)->field),       \
			(uint64_t)(number)                                                                                         \
	}

static void wrong_values_are_refused(void **state)
{
	(void)state;
	static const struct bad_value table[] = {
		BAD(PKG_STRC, struct pkg_stretch, 1, edge, 1),
		BAD(PKG_STRC, struct pkg_stretch, 1, edge, PKG_NONE),
		BAD(PKG_STRC, struct pkg_stretch, 1, from_mm, 50001),
		BAD(PKG_STRC, struct pkg_stretch, 1, to_mm, 49999),
		BAD(PKG_STRC, struct pkg_stretch, 1, eye_max_mm, 0),
		BAD(PKG_STRC, struct pkg_stretch, 1, local_triangles, 1000000),
		BAD(PKG_STRC, struct pkg_stretch, 1, pvs_triangles, UINT32_MAX),
		BAD(PKG_STRC, struct pkg_stretch, 1, local.offset, 1),
		BAD(PKG_STRC, struct pkg_stretch, 1, local.offset, UINT64_MAX - 63),
		BAD(PKG_STRC, struct pkg_stretch, 1, local.stored_bytes, UINT32_MAX),
		BAD(PKG_STRC, struct pkg_stretch, 1, local.stored_bytes, 0),
		BAD(PKG_STRC, struct pkg_stretch, 1, local.raw_bytes, UINT32_MAX),
		BAD(PKG_STRC, struct pkg_stretch, 1, local.raw_bytes, 3),
		BAD(PKG_STRC, struct pkg_stretch, 1, pvs.raw_bytes, 0x7FFFFFFF),
		BAD(PKG_CELL, struct pkg_cell, 2, kind, PKG_CELL_KIND_COUNT),
		BAD(PKG_CELL, struct pkg_cell, 2, kind, PKG_CELL_NOTHING),
		BAD(PKG_CELL, struct pkg_cell, 0, kind, PKG_CELL_IMPOSTOR),
		BAD(PKG_CELL, struct pkg_cell, 2, reason, 200),
		BAD(PKG_CELL, struct pkg_cell, 2, page_count, 257),
		BAD(PKG_CELL, struct pkg_cell, 2, page_count, 3),
		BAD(PKG_CELL, struct pkg_cell, 2, vertex_count, 70000),
		BAD(PKG_CELL, struct pkg_cell, 2, index_count, UINT32_MAX),
		BAD(PKG_CELL, struct pkg_cell, 2, index_count, 4),
		BAD(PKG_CELL, struct pkg_cell, 2, error_px, 0xFF800000),
		BAD(PKG_CELL, struct pkg_cell, 2, tau_px, 0x7FC00000),
		BAD(PKG_CELL, struct pkg_cell, 2, impostor.raw_bytes, 16),
		BAD(PKG_CELL, struct pkg_cell, 2, impostor.stored_bytes, UINT32_MAX),
		BAD(PKG_CELL, struct pkg_cell, 2, truth.stored_bytes, 64),
		{ "first index", PKG_CIDX, 0, 4, 1 },
		{ "index beyond", PKG_CIDX, 4, 4, 7 },
		{ "index falls", PKG_CIDX, 8, 4, 1 },
		{ "last index", PKG_CIDX, 12, 4, 5 },
	};
	uint8_t *copy = malloc(size);
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		memcpy(copy, bytes, size);
		memcpy(copy + far_city_section(copy, table[i].tag).offset + table[i].offset, &table[i].value, table[i].width);
		far_city_sign(copy);
		int status = far_city_open(copy, size, &pkg, &fault);
		pkg_close(&pkg);
		if (status >= 0)
			fail_msg("%s was taken", table[i].name);
	}
	free(copy);
}

static void some_of_the_sections_are_not_enough(void **state)
{
	(void)state;
	static const uint32_t tags[] = { PKG_STRC, PKG_CIDX, PKG_CELL, PKG_CELD };
	uint8_t *copy = malloc(size);
	for (int i = 0; i < 15; i++) {
		memcpy(copy, bytes, size);
		struct pkg_section *table = (void *)(copy + sizeof(struct pkg_header));
		for (int k = 0; k < 4; k++)
			for (int s = 0; s < 17 && i >> k & 1; s++)
				if (table[s].tag == tags[k])
					table[s].tag = PKG_TAG('z', 'z', 'z', (uint32_t)('a' + k));
		far_city_sign(copy);
		assert_int_equal(far_city_open(copy, size, &pkg, &fault) < 0, i != 0);
		pkg_close(&pkg);
	}
	free(copy);
}

static void every_flip_in_the_far_field_is_noticed(void **state)
{
	(void)state;
	static const uint32_t tags[] = { PKG_STRC, PKG_CIDX, PKG_CELL, PKG_CELD };
	uint8_t *copy = malloc(size);
	memcpy(copy, bytes, size);
	for (int i = 0; i < 4; i++) {
		struct far_city_part part = far_city_section(copy, tags[i]);
		for (size_t at = part.offset; at < part.offset + part.size; at += part.size / 97 + 1) {
			copy[at] ^= (uint8_t)(1u << at % 8);
			if (check_all(copy, size) >= 0)
				fail_msg("a flip at byte %zu went unnoticed", at);
			copy[at] ^= (uint8_t)(1u << at % 8);
		}
	}
	free(copy);
}

/* Damage that the checksum does not show: the stream and what is in it must be checked as well. */
static void blobs_with_right_checksums_and_wrong_bytes_do_no_harm(void **state)
{
	(void)state;
	assert_int_equal(far_city_open(bytes, size, &pkg, &fault), 0);
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	struct blob_reader *reader;
	assert_int_equal(blob_reader_init(&reader, &arena), 0);
	uint8_t *blobs = malloc(pkg.blobs_bytes), *raw = malloc(1 << 20);
	memcpy(blobs, pkg.blobs, pkg.blobs_bytes);
	pkg.blobs = blobs;
	struct rng rng = rng_seed(9);
	for (int round = 0; round < 3000; round++) {
		struct pkg_blob blob = round & 1 ? pkg.stretches[1].local : pkg.cells[2].impostor;
		uint8_t *at = blobs + blob.offset + rng_u32(&rng) % blob.stored_bytes, before = *at;
		*at = (uint8_t)rng_u32(&rng);
		if (round % 7 == 0)
			blob.stored_bytes = 1 + rng_u32(&rng) % blob.stored_bytes;
		blob.crc32 = (uint32_t)crc32(0, blobs + blob.offset, blob.stored_bytes);
		if (blob_read(reader, &pkg, &blob, raw) == 0) {
			struct set_view set;
			struct impostor_view impostor;
			if (round & 1)
				set_view_open(&set, &pkg, raw, blob.raw_bytes);
			else
				impostor_view_open(&impostor, &pkg.cells[2], raw, blob.raw_bytes, scratch);
		}
		*at = before;
	}
	free(blobs);
	free(raw);
	pkg_close(&pkg);
}

/* One change to a good set or impostor. */
static void wrong_insides_are_refused(void **state)
{
	(void)state;
	assert_int_equal(far_city_open(bytes, size, &pkg, &fault), 0);
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	struct blob_reader *reader;
	assert_int_equal(blob_reader_init(&reader, &arena), 0);
	const struct pkg_blob *set_blob = &pkg.stretches[1].local, *impostor_blob = &pkg.cells[2].impostor;
	uint8_t *raw = malloc(1 << 20);
	assert_true(impostor_fold_bytes(pkg.cells[2].vertex_count, pkg.cells[2].index_count) <= sizeof(scratch));
	const size_t views = sizeof(struct pkg_impostor_head), vertices = views + 2 * sizeof(struct pkg_impostor_view);
	const size_t pages = vertices + 40 * 16, kinds = pages + 40; /* as they are folded */
	const size_t indices = vertices + 40 * sizeof(struct pkg_impostor_vertex), objects = sizeof(struct pkg_set_head);
	const struct {
		bool set;
		size_t offset, width;
		uint32_t value;
	} table[] = {
		{ true, 0, 4, 5 },
		{ true, 0, 4, UINT32_MAX },
		{ true, 4, 4, 1 },
		{ true, objects, 4, 18 },
		{ true, objects + 8, 4, 0 },
		{ true, objects + 4, 4, 0 },
		{ true, objects + 4, 4, 22 },
		{ true, objects + 4, 4, 20 },
		{ true, objects + 6 * 8, 1, 0xFF },
		{ true, objects + 6 * 8 + 2, 1, 0x35 },
		{ false, 0, 4, 41 },
		{ false, 4, 4, 3 },
		{ false, 8, 4, 1 },
		{ false, 12, 2, 33 },
		{ false, 12, 2, 1 },
		{ false, 14, 2, PKG_IMPOSTOR_STEP_MAX + 1 },
		{ false, views, 4, 0x7F800000 },
		{ false, pages, 1, 2 },
		{ false, kinds, 1, 2 },
		{ false, vertices + 12, 2, 2 * 4097 },
		{ false, indices, 1, 2 * 40 - 1 },
	};
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		const struct pkg_blob *blob = table[i].set ? set_blob : impostor_blob;
		struct set_view set;
		struct impostor_view impostor;
		for (int wrong = 0; wrong < 2; wrong++) {
			assert_int_equal(blob_read(reader, &pkg, blob, raw), 0);
			if (wrong)
				memcpy(raw + table[i].offset, &table[i].value, table[i].width);
			int status = table[i].set ? set_view_open(&set, &pkg, raw, blob->raw_bytes)
									  : impostor_view_open(&impostor, &pkg.cells[2], raw, blob->raw_bytes, scratch);
			if ((status < 0) != wrong)
				fail_msg("case %zu: status %d", i, status);
		}
	}
	free(raw);
	pkg_close(&pkg);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_whole_package_is_read),
		cmocka_unit_test(a_package_without_a_far_field_has_no_stretches),
		cmocka_unit_test(places_belong_to_their_stretch),
		cmocka_unit_test(the_view_cell_is_a_box_along_the_axis),
		cmocka_unit_test(wrong_values_are_refused),
		cmocka_unit_test(some_of_the_sections_are_not_enough),
		cmocka_unit_test(every_flip_in_the_far_field_is_noticed),
		cmocka_unit_test(blobs_with_right_checksums_and_wrong_bytes_do_no_harm),
		cmocka_unit_test(wrong_insides_are_refused),
	};
	return cmocka_run_group_tests(tests, build, drop);
}
