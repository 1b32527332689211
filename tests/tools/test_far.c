/*
 * The far field's bake as a whole: units, resuming, what is taken over, the package. What makes the stretches is
 * replaced by stand-ins here: everything is visible, captures show one object, impostors are a triangle.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "assets/cells.h"
#include "assets/impostor_fold.h"
#include "assets/resident.h"
#include "tools/bake/bake.h"
#include "tools/commands.h"
#include "tools/far/far.h"
#include "tools/far/unit.h"
#include "tools/impostor/capture.h"

/* tools/impostor/impostor.h and tools/bake/mesh.h both know a mesh_vertex: what the stand-ins need is repeated. */
struct impostor_capture;
struct impostor_options;
struct impostor {
	ARRAY(struct pkg_impostor_vertex) vertices;
	ARRAY(uint16_t) indices;
	ARRAY(struct pkg_impostor_view) views;
	int32_t origin_mm[3];
	uint32_t page_count;
	uint8_t *pages;
	struct pkg_truth_texel *truth;
	double error_px, over_share;
};

#define STAND_IN __attribute__((weak))

/* --- stand-ins --- */

struct visibility {
	const struct pkg *pkg;
};
struct visibility *visibility_new(const struct pkg *pkg);
STAND_IN struct visibility *visibility_new(const struct pkg *pkg)
{
	struct visibility *out = calloc(1, sizeof(*out));
	out->pkg = pkg;
	return out;
}
STAND_IN void visibility_free(struct visibility *visibility)
{
	free(visibility);
}
STAND_IN void visible_sets_finish(struct visible_sets *sets)
{
	triangle_set_finish(&sets->near_set);
	triangle_set_finish(&sets->far_set);
}
STAND_IN void visible_set(const struct visibility *visibility, const struct view_cell *cell, double near_m,
	double far_m, struct visible_sets *out)
{
	const struct pkg *pkg = visibility->pkg;
	triangle_set_clear(&out->near_set);
	triangle_set_clear(&out->far_set);
	for (uint32_t i = 0; i < pkg->object_count; i++) {
		double x = pkg->objects[i].min_mm[0] * 1e-3 - cell->start.x,
			   y = pkg->objects[i].min_mm[1] * 1e-3 - cell->start.y;
		double m = hypot(x, y);
		if (m < 2 * near_m && m < far_m)
			memset(triangle_set_add(m < near_m ? &out->near_set : &out->far_set, pkg, i), 0xFF,
				triangle_set_object_size(&pkg->objects[i]) / 8);
	}
	triangle_set_tidy(&out->near_set, pkg);
	triangle_set_tidy(&out->far_set, pkg);
	out->near_candidates = out->near_set.triangles;
}

struct capturer {
	uint32_t last; /* object in use */
};
STAND_IN int capturer_open(struct capturer **out, const struct pkg *pkg)
{
	(void)pkg;
	*out = calloc(1, sizeof(**out));
	return 0;
}
STAND_IN void capturer_close(struct capturer *capturer)
{
	free(capturer);
}
STAND_IN void capturer_use(struct capturer *capturer, const struct triangle_set *set)
{
	capturer->last = set->items.items[set->items.count - 1].object;
}
STAND_IN int capturer_draw(
	struct capturer *capturer, const struct capture_view *view, bool color, struct capture_image *out)
{
	size_t pixels = (size_t)view->width * view->height;
	capture_image_finish(out);
	out->view = *view;
	out->rgba = color ? calloc(pixels, 4) : NULL;
	out->pixels = calloc(pixels, sizeof(*out->pixels));
	for (size_t i = 0; i < pixels; i++)
		out->pixels[i] = (struct capture_pixel){ .object = capturer->last + 1, .disparity = 0.004f };
	return 0;
}
int impostor_build(const struct view_cell *cell, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, struct impostor *out);
void impostor_finish(struct impostor *impostor);
void impostor_encode(const struct impostor *impostor, byte_array *out);
void impostor_encode_truth(const struct impostor *impostor, byte_array *out);
STAND_IN int impostor_build(const struct view_cell *cell, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, struct impostor *out)
{
	(void)captures;
	(void)count;
	(void)options;
	for (int i = 0; i < 3; i++) {
		ARRAY_PUSH(&out->vertices, (struct pkg_impostor_vertex){ .pos_mm = { i * 100, (int32_t)cell->start.x, 0 } });
		ARRAY_PUSH(&out->indices, (uint16_t)i);
	}
	ARRAY_PUSH(&out->views, (struct pkg_impostor_view){ { 0, 1, 0, 1 } });
	out->page_count = 1;
	return 0;
}
STAND_IN void impostor_finish(struct impostor *impostor)
{
	ARRAY_FINISH(&impostor->vertices);
	ARRAY_FINISH(&impostor->indices);
	ARRAY_FINISH(&impostor->views);
}
static void append(byte_array *out, const void *bytes, size_t size)
{
	ARRAY_RESERVE(out, out->count + size);
	memcpy(out->items + out->count, bytes, size);
	out->count += size;
}
STAND_IN void impostor_encode(const struct impostor *impostor, byte_array *out)
{
	static const uint8_t page[PKG_PAGE_BYTES];
	struct pkg_impostor_head head = { .vertex_count = 3, .index_count = 3, .page_count = 1, .view_count = 1 };
	uint8_t scratch[16];
	append(out, &head, sizeof(head));
	size_t views = out->count;
	append(out, impostor->views.items, sizeof(*impostor->views.items));
	append(out, impostor->vertices.items, 3 * sizeof(*impostor->vertices.items));
	append(out, impostor->indices.items, 3 * sizeof(*impostor->indices.items));
	impostor_fold(&head, out->items + views + sizeof(*impostor->views.items), scratch);
	append(out, page, (16 - out->count % 16) % 16);
	append(out, page, sizeof(page));
}
STAND_IN void impostor_encode_truth(const struct impostor *impostor, byte_array *out)
{
	(void)impostor;
	(void)out;
}

/* --- a city: one street of 3 km, houses of 420 triangles along it --- */

static char folder[] = "/tmp/blvd-test-far-XXXXXX";
static char base_path[64], city_path[64];

static void add_house(struct mesh_sink *sink, double x, double y, double height)
{
	mesh_begin(sink, &(struct mesh_object){ .kind = PKG_OBJECT_BUILDING, .face = 0, .source_id = (int64_t)x });
	for (uint32_t i = 0; i < 420; i++) {
		uint32_t corner[3];
		for (int k = 0; k < 3; k++)
			corner[k] = mesh_add_vertex(sink,
				&(struct mesh_vertex){ .at = { x + (k == 1), y, k == 2 ? height : i * 0.02 }, .normal = { 0, 1, 0 } });
		mesh_add_triangle(sink, PKG_PASS_OPAQUE, corner[0], corner[1], corner[2]);
	}
	mesh_end(sink);
}

static void fill_graph(struct graph_data *graph)
{
	for (uint32_t i = 0; i < 2; i++) {
		int32_t x = (int32_t)i * 3000000;
		ARRAY_PUSH(&graph->nodes, (struct pkg_node){ .pos_mm = { x, 0, 0 }, .first_out = i, .out_count = 1 });
		ARRAY_PUSH(&graph->outs, i);
		ARRAY_PUSH(&graph->points, (struct pkg_point){ { x, 0, 0 } });
		ARRAY_PUSH(&graph->halves, (struct pkg_half){ .origin = i, .next = i ^ 1, .prev = i ^ 1 });
	}
	ARRAY_PUSH(&graph->edges,
		(struct pkg_edge){ .point_count = 2, .length_mm = 3000000, .flags = PKG_EDGE_FORWARD, .width_mm = 7000 });
	ARRAY_PUSH(&graph->faces, (struct pkg_face){ .half_count = 2, .parent = PKG_NONE, .flags = PKG_FACE_OUTER });
}

static void write_city(double one_height)
{
	struct city city = { .name = "Street", .right_hand_traffic = true };
	struct graph_data graph = { 0 };
	struct mesh_sink *sink = mesh_sink_new();
	struct mesh_chunks mesh;
	struct materials materials = { 0 };
	city.frame = geo_frame_at((struct geo_point){ 46.2, 6.1 });
	fill_graph(&graph);
	for (int i = 0; i < 30; i++)
		add_house(sink, i * 100.0, 20.0, i == 4 ? one_height : 12.0);
	mesh_finish_chunks(sink, &mesh);
	ARRAY_PUSH(&materials.table, (struct pkg_material){ .kind = PKG_MATERIAL_SOLID });
	struct pkg_texture_array array = { .format = PKG_TEXTURE_R8, .width = 1, .height = 1, .layers = 1, .levels = 1 };
	ARRAY_RESERVE(&materials.texture, sizeof(array) + 1);
	memcpy(materials.texture.items, &array, sizeof(array));
	materials.texture.count = sizeof(array);
	ARRAY_PUSH(&materials.texture, 200);
	struct pkg_content content = { .city = &city, .graph = &graph, .mesh = &mesh, .materials = &materials };
	assert_int_equal(pkg_write(base_path, &content), 0);
	mesh_chunks_finish(&mesh);
	mesh_sink_free(sink);
	materials_finish(&materials);
	graph_data_finish(&graph);
	city_finish(&city);
}

static int make_folder(void **state)
{
	(void)state;
	assert_non_null(mkdtemp(folder));
	snprintf(base_path, sizeof(base_path), "%s/base.blvd", folder);
	snprintf(city_path, sizeof(city_path), "%s/city.blvd", folder);
	write_city(12.0);
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	char command[128];
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

/* --- bakes --- */

static int bake(const struct far_options *more)
{
	struct pkg pkg;
	struct pkg_fault fault;
	struct far_options options = more ? *more : (struct far_options){ 0 };
	options.quiet = true;
	options.cells.impostor = true;
	options.stretches.near_m = 150.0;
	options.cells.focal_px = 32.0;
	assert_int_equal(pkg_open(&pkg, base_path, &fault), 0);
	int status = far_bake(&pkg, city_path, &options);
	pkg_close(&pkg);
	return status;
}

struct bytes {
	uint8_t *at;
	size_t size;
};

static struct bytes read_city_file(void)
{
	struct bytes out = { 0 };
	FILE *file = fopen(city_path, "rb");
	assert_non_null(file);
	fseek(file, 0, SEEK_END);
	out.size = (size_t)ftell(file);
	rewind(file);
	out.at = malloc(out.size);
	assert_int_equal(fread(out.at, 1, out.size, file), out.size);
	fclose(file);
	return out;
}

static bool same_bytes(struct bytes a, struct bytes b)
{
	return a.size == b.size && !memcmp(a.at, b.at, a.size);
}

static unsigned count_files(const char *path)
{
	unsigned count = 0;
	DIR *dir = opendir(path);
	for (struct dirent *entry; dir && (entry = readdir(dir));)
		count += entry->d_name[0] != '.';
	if (dir)
		closedir(dir);
	return count;
}

static void the_package_has_every_stretch_and_passes_every_check(void **state)
{
	(void)state;
	struct pkg pkg;
	struct pkg_fault fault;
	assert_int_equal(bake(NULL), EXIT_DONE);
	assert_int_equal(pkg_open(&pkg, city_path, &fault), 0);
	assert_int_equal(pkg_verify(&pkg, &fault), 0);
	assert_int_equal(pkg.stretch_count, 50);
	uint32_t impostors = 0;
	for (uint32_t i = 0; i < 2 * pkg.stretch_count; i++)
		impostors += pkg.cells[i].kind == PKG_CELL_IMPOSTOR;
	assert_true(impostors > 0);
	size_t room = cells_verify_bytes(&pkg);
	struct arena arena;
	void *memory = malloc(room);
	arena_init(&arena, "verify", memory, room);
	if (cells_verify(&pkg, &arena, &fault))
		fail_msg("%s", fault.text);
	free(memory);
	pkg_close(&pkg);
	char units[96];
	snprintf(units, sizeof(units), "%s.cells", city_path);
	assert_int_equal(access(units, F_OK), -1);
}

static void any_number_of_workers_gives_the_same_bytes(void **state)
{
	(void)state;
	struct bytes first = { 0 };
	for (unsigned jobs = 1; jobs <= 4; jobs += 3) {
		unlink(city_path);
		assert_int_equal(bake(&(struct far_options){ .jobs = jobs }), EXIT_DONE);
		struct bytes made = read_city_file();
		if (first.at)
			assert_true(same_bytes(first, made));
		else
			first = made;
		if (first.at != made.at)
			free(made.at);
	}
	free(first.at);
}

/* Units that are there are used, damaged ones are made again, and the result is the same. */
static void a_bake_goes_on_where_it_stopped(void **state)
{
	(void)state;
	char units[96], command[256];
	snprintf(units, sizeof(units), "%s/units", folder);
	unlink(city_path);
	assert_int_equal(bake(&(struct far_options){ .units = units }), EXIT_DONE);
	struct bytes whole = read_city_file();
	assert_int_equal(count_files(units), 4);
	/* one gone, one cut short */
	snprintf(command, sizeof(command), "cd %s && set -- *.unit && rm $1 && truncate -s 1000 $2", units);
	assert_int_equal(system(command), 0);
	unlink(city_path);
	assert_int_equal(bake(&(struct far_options){ .units = units }), EXIT_DONE);
	assert_int_equal(count_files(units), 4);
	struct bytes again = read_city_file();
	assert_true(same_bytes(whole, again));
	free(whole.at);
	free(again.at);
}

static void only_what_sees_a_changed_house_is_made_again(void **state)
{
	(void)state;
	struct pkg before, after;
	struct pkg_fault fault;
	char copy[96], command[256];
	unlink(city_path);
	assert_int_equal(bake(NULL), EXIT_DONE);
	snprintf(copy, sizeof(copy), "%s/before.blvd", folder);
	snprintf(command, sizeof(command), "cp %s %s", city_path, copy);
	assert_int_equal(system(command), 0);
	write_city(14.0);
	assert_int_equal(bake(NULL), EXIT_DONE);
	assert_int_equal(pkg_open(&before, copy, &fault), 0);
	assert_int_equal(pkg_open(&after, city_path, &fault), 0);
	assert_int_equal(before.stretch_count, after.stretch_count);
	for (uint32_t i = 0; i < before.stretch_count; i++) {
		bool sees = abs(before.stretches[i].start_mm[0] - 400000) < 300000;
		bool same = before.stretches[i].input_hash == after.stretches[i].input_hash;
		assert_int_equal(same, !sees);
	}
	pkg_close(&before);
	pkg_close(&after);
	/* from nothing it comes out the same */
	struct bytes partial = read_city_file();
	unlink(city_path);
	assert_int_equal(bake(NULL), EXIT_DONE);
	struct bytes fresh = read_city_file();
	assert_true(same_bytes(partial, fresh));
	free(partial.at);
	free(fresh.at);
	write_city(12.0);
}

static void a_full_disk_leaves_the_old_package_whole(void **state)
{
	(void)state;
	struct rlimit all, few;
	char units[96];
	snprintf(units, sizeof(units), "%s/units", folder);
	assert_int_equal(bake(&(struct far_options){ .units = units }), EXIT_DONE);
	struct bytes before = read_city_file();
	signal(SIGXFSZ, SIG_IGN);
	getrlimit(RLIMIT_FSIZE, &all);
	few = all;
	for (rlim_t limit = 100; limit < before.size; limit = limit * 9 + 1) {
		few.rlim_cur = limit;
		setrlimit(RLIMIT_FSIZE, &few);
		int status = bake(&(struct far_options){ .units = units, .cells.tau_px = 2.0 });
		setrlimit(RLIMIT_FSIZE, &all);
		assert_int_equal(status, EXIT_FAILED);
		struct bytes after = read_city_file();
		assert_true(same_bytes(before, after));
		free(after.at);
	}
	char part[96];
	snprintf(part, sizeof(part), "%s.part", city_path);
	assert_int_equal(access(part, F_OK), -1);
	free(before.at);
}

static void the_header_says_what_must_be_resident(void **state)
{
	(void)state;
	struct pkg pkg;
	struct pkg_fault fault;
	struct arena arena;
	struct resident_need need;
	static uint8_t scratch[RESIDENT_SCRATCH_BYTES];
	unlink(city_path);
	/* no budget is too small to end; what cannot give way is told */
	assert_int_equal(bake(&(struct far_options){ .budget_bytes = 1 }), EXIT_DONE);
	assert_int_equal(pkg_open(&pkg, city_path, &fault), 0);
	arena_init(&arena, "scratch", scratch, sizeof(scratch));
	assert_int_equal(resident_need(&pkg, &arena, &need), 0);
	assert_true(need.slot > 0);
	assert_int_equal(pkg.meta->resident_bound_bytes, need.sum);
	pkg_close(&pkg);
}

static void a_choice_of_stretches_keeps_whole_edges(void **state)
{
	(void)state;
	struct pkg pkg;
	struct pkg_fault fault;
	unlink(city_path);
	assert_int_equal(bake(&(struct far_options){ .selection = "3-4" }), EXIT_DONE);
	assert_int_equal(pkg_open(&pkg, city_path, &fault), 0);
	assert_int_equal(pkg.stretch_count, 50); /* one edge is the whole city */
	pkg_close(&pkg);
	assert_int_equal(bake(&(struct far_options){ .selection = "50-60" }), EXIT_USAGE);
	assert_int_equal(bake(&(struct far_options){ .selection = "/nonexistent.candump" }), EXIT_BAD_INPUT);
}

static void a_far_field_can_be_taken_away(void **state)
{
	(void)state;
	struct pkg pkg;
	struct pkg_fault fault;
	assert_int_equal(bake(NULL), EXIT_DONE);
	assert_int_equal(pkg_open(&pkg, city_path, &fault), 0);
	assert_int_equal(far_strip(&pkg, city_path), EXIT_DONE);
	pkg_close(&pkg);
	struct bytes stripped = read_city_file();
	char kept[64];
	memcpy(kept, city_path, sizeof(kept));
	memcpy(city_path, base_path, sizeof(city_path));
	struct bytes base = read_city_file();
	memcpy(city_path, kept, sizeof(kept));
	assert_true(same_bytes(stripped, base));
	free(stripped.at);
	free(base.at);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_package_has_every_stretch_and_passes_every_check),
		cmocka_unit_test(any_number_of_workers_gives_the_same_bytes),
		cmocka_unit_test(a_bake_goes_on_where_it_stopped),
		cmocka_unit_test(only_what_sees_a_changed_house_is_made_again),
		cmocka_unit_test(a_full_disk_leaves_the_old_package_whole),
		cmocka_unit_test(the_header_says_what_must_be_resident),
		cmocka_unit_test(a_choice_of_stretches_keeps_whole_edges),
		cmocka_unit_test(a_far_field_can_be_taken_away),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
