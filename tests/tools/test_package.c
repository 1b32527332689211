/* A package written by the bake opens, says what was put in, and is refused after any damage. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tools/bake/bake.h"

static char path[] = "/tmp/blvd-test-package-XXXXXX";

static void add_square(struct mesh_sink *sink, double x, double y, uint32_t face, const char *name)
{
	mesh_begin(sink, &(struct mesh_object){ .kind = PKG_OBJECT_BUILDING, .face = face, .source_id = 7, .name = name });
	uint32_t corner[4];
	for (int i = 0; i < 4; i++) {
		struct mesh_vertex vertex = { .at = { x + (i == 1 || i == 2), y + (i > 1), 0.25 },
			.normal = { 0, 0, 1 },
			.u = 1.5f,
			.ao = 1.0f,
			.rgb = { 1, 2, 3 } };
		corner[i] = mesh_add_vertex(sink, &vertex);
	}
	mesh_add_triangle(sink, PKG_PASS_OPAQUE, corner[0], corner[1], corner[2]);
	mesh_add_triangle(sink, PKG_PASS_DECAL, corner[0], corner[2], corner[3]);
	mesh_end(sink);
}

/* One street of two nodes, out and back. */
static void fill_graph(struct graph_data *graph)
{
	for (uint32_t i = 0; i < 2; i++) {
		ARRAY_PUSH(
			&graph->nodes, (struct pkg_node){ .pos_mm = { (int32_t)i * 1000, 0, 0 }, .first_out = i, .out_count = 1 });
		ARRAY_PUSH(&graph->outs, i);
		ARRAY_PUSH(&graph->points, (struct pkg_point){ { (int32_t)i * 1000, 0, 0 } });
		ARRAY_PUSH(&graph->halves, (struct pkg_half){ .origin = i, .next = i ^ 1, .prev = i ^ 1 });
	}
	ARRAY_PUSH(&graph->names, "Rue du Test");
	ARRAY_PUSH(&graph->edges, (struct pkg_edge){ .point_count = 2, .length_mm = 1000, .name = 1, .flags = 3 });
	ARRAY_PUSH(&graph->faces, (struct pkg_face){ .half_count = 2, .parent = PKG_NONE, .flags = PKG_FACE_OUTER });
}

static int write_small_package(void **state)
{
	(void)state;
	int fd = mkstemp(path);
	assert_true(fd >= 0);
	close(fd);
	struct city city = { .name = "Teststadt", .attribution = "nobody", .right_hand_traffic = true };
	city.frame = geo_frame_at((struct geo_point){ 46.2, 6.1 });
	struct graph_data graph = { 0 };
	fill_graph(&graph);
	struct mesh_sink *sink = mesh_sink_new();
	add_square(sink, 0, 0, 0, "House");
	add_square(sink, 900, 0, PKG_NONE, NULL);
	add_square(sink, 2, 0, 0, "House");
	struct mesh_chunks mesh;
	mesh_finish_chunks(sink, &mesh);
	struct materials materials = { 0 };
	ARRAY_PUSH(&materials.table, (struct pkg_material){ .kind = PKG_MATERIAL_SOLID });
	struct pkg_texture_array array = { .format = PKG_TEXTURE_R8, .width = 1, .height = 1, .layers = 1, .levels = 1 };
	ARRAY_RESERVE(&materials.texture, sizeof(array) + 1);
	memcpy(materials.texture.items, &array, sizeof(array));
	materials.texture.count = sizeof(array);
	ARRAY_PUSH(&materials.texture, 200);
	struct pkg_content content = { .city = &city, .graph = &graph, .mesh = &mesh, .materials = &materials };
	assert_int_equal(pkg_write(path, &content), 0);
	mesh_chunks_finish(&mesh);
	mesh_sink_free(sink);
	materials_finish(&materials);
	ARRAY_FINISH(&graph.nodes);
	ARRAY_FINISH(&graph.outs);
	ARRAY_FINISH(&graph.halves);
	ARRAY_FINISH(&graph.edges);
	ARRAY_FINISH(&graph.points);
	ARRAY_FINISH(&graph.faces);
	ARRAY_FINISH(&graph.names);
	city_finish(&city);
	return 0;
}

static int remove_package(void **state)
{
	(void)state;
	unlink(path);
	return 0;
}

static void reader_returns_what_was_written(void **state)
{
	(void)state;
	struct pkg pkg;
	struct pkg_fault fault;
	assert_int_equal(pkg_open(&pkg, path, &fault), 0);
	assert_int_equal(pkg_verify(&pkg, &fault), 0);
	assert_string_equal(pkg_string(&pkg, pkg.meta->city_name), "Teststadt");
	assert_string_equal(pkg_string(&pkg, pkg.graph.edges[0].name), "Rue du Test");
	assert_int_equal(pkg.object_count, 3);
	assert_int_equal(pkg.chunk_count, 2); /* one block, one far house */
	assert_int_equal(pkg.meta->triangle_count, 6);
	assert_string_equal(pkg_string(&pkg, pkg.objects[0].name), "House");
	const struct pkg_chunk *chunk = &pkg.chunks[0];
	const struct pkg_mesh_vertex *vertex = pkg_chunk_vertices(&pkg, chunk);
	assert_int_equal(chunk->origin_mm[0] + vertex[0].pos_mm[0], 0);
	assert_int_equal(chunk->origin_mm[2] + vertex[0].pos_mm[2], 250);
	assert_int_equal(vertex[0].uv[0], 384);
	pkg_close(&pkg);
}

static uint8_t *read_file(size_t *size)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	fseek(file, 0, SEEK_END);
	*size = (size_t)ftell(file);
	rewind(file);
	uint8_t *bytes = malloc(*size);
	assert_non_null(bytes);
	assert_int_equal(fread(bytes, 1, *size, file), *size);
	fclose(file);
	return bytes;
}

static int verify_bytes(const uint8_t *bytes, size_t size)
{
	char copy[] = "/tmp/blvd-test-damaged-XXXXXX";
	int fd = mkstemp(copy);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, bytes, size), (ssize_t)size);
	close(fd);
	struct pkg pkg;
	struct pkg_fault fault;
	int status = pkg_open(&pkg, copy, &fault);
	if (status == 0) {
		status = pkg_verify(&pkg, &fault);
		pkg_close(&pkg);
	}
	unlink(copy);
	if (status < 0)
		assert_true(fault.text[0] != 0);
	return status;
}

static void every_truncation_is_refused(void **state)
{
	(void)state;
	size_t size;
	uint8_t *bytes = read_file(&size);
	for (size_t cut = 0; cut < size; cut += cut < 1024 ? 1 : 97)
		assert_true(verify_bytes(bytes, cut) < 0);
	free(bytes);
}

static void every_flipped_bit_is_refused(void **state)
{
	(void)state;
	size_t size;
	uint8_t *bytes = read_file(&size);
	for (size_t at = 0; at < size; at += at % 4096 < 1200 ? 1 : 61) {
		bytes[at] ^= (uint8_t)(1u << (at % 8));
		if (verify_bytes(bytes, size) >= 0)
			fail_msg("a flip at byte %zu went unnoticed", at);
		bytes[at] ^= (uint8_t)(1u << (at % 8));
	}
	free(bytes);
}

static void an_object_larger_than_a_chunk_is_split(void **state)
{
	(void)state;
	struct mesh_sink *sink = mesh_sink_new();
	mesh_begin(sink, &(struct mesh_object){ .kind = PKG_OBJECT_BUILDING, .face = 3, .source_id = 42 });
	const uint32_t triangles = 100000;
	for (uint32_t i = 0; i < triangles * 3; i++)
		mesh_add_vertex(sink, &(struct mesh_vertex){ .at = { i % 1000, i / 1000.0, i % 3 }, .normal = { 0, 0, 1 } });
	for (uint32_t i = 0; i < triangles; i++)
		mesh_add_triangle(sink, PKG_PASS_OPAQUE, 3 * i, 3 * i + 1, 3 * i + 2);
	mesh_end(sink);
	struct mesh_chunks mesh;
	mesh_finish_chunks(sink, &mesh);
	assert_int_equal(mesh.triangles, triangles);
	uint64_t sum = 0;
	for (size_t i = 0; i < mesh.chunks.count; i++) {
		assert_true(mesh.chunks.items[i].vertex_count <= 65536);
		sum += mesh.chunks.items[i].index_count[PKG_PASS_OPAQUE];
	}
	assert_int_equal(sum, triangles * 3);
	for (size_t i = 0; i < mesh.objects.count; i++)
		assert_int_equal(mesh.objects.items[i].source_id, 42);
	mesh_chunks_finish(&mesh);
	mesh_sink_free(sink);
}

static void missing_files_and_folders_are_errors(void **state)
{
	(void)state;
	struct pkg pkg;
	struct pkg_fault fault;
	assert_int_equal(pkg_open(&pkg, "/nonexistent/x.blvd", &fault), -ENOENT);
	assert_int_equal(pkg_open(&pkg, "/tmp", &fault), -EISDIR);
	assert_int_equal(pkg_open(&pkg, "/dev/null", &fault), -EBADMSG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reader_returns_what_was_written),
		cmocka_unit_test(every_truncation_is_refused),
		cmocka_unit_test(every_flipped_bit_is_refused),
		cmocka_unit_test(an_object_larger_than_a_chunk_is_split),
		cmocka_unit_test(missing_files_and_folders_are_errors),
	};
	return cmocka_run_group_tests(tests, write_small_package, remove_package);
}
