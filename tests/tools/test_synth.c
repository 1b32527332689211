/* A made-up city is the same every time, reads without faults, and its streets are one connected graph with sound
 * blocks. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "graph_check.h"
#include "platform/base/log.h"
#include "tools/synth/synth.h"

static const struct synth_options sizes[] = {
	{ 1, 400, 400, 1.0 },
	{ 2, 600, 500, 1.0 },
	{ 7, 1600, 1600, 1.0 },
	{ 3, 1000, 2500, 0.5 },
	{ 4, 3000, 1200, 2.0 },
	{ 5, 300, 300, 1.0 },
};

static char folder[] = "/tmp/blvd-synth-XXXXXX";

static int make_folder(void **state)
{
	(void)state;
	return mkdtemp(folder) ? 0 : -1;
}

static int drop_folder(void **state)
{
	(void)state;
	return rmdir(folder);
}

static void write_city(const struct synth_options *options, const char *path)
{
	struct synth synth;
	synth_make(&synth, options);
	assert_int_equal(osm_doc_write(synth.doc, path), 0);
	synth_finish(&synth);
}

static char *whole_file(const char *path, size_t *size)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	fseek(file, 0, SEEK_END);
	*size = (size_t)ftell(file);
	rewind(file);
	char *bytes = malloc(*size);
	assert_int_equal(fread(bytes, 1, *size, file), *size);
	fclose(file);
	return bytes;
}

static void same_options_give_the_same_bytes(void **state)
{
	(void)state;
	char first[64], second[64];
	snprintf(first, sizeof(first), "%s/a.osm", folder);
	snprintf(second, sizeof(second), "%s/b.osm", folder);
	struct synth_options options = { 11, 900, 900, 1.0 }, other = { 12, 900, 900, 1.0 };
	size_t a_size, b_size, c_size;
	write_city(&options, first);
	write_city(&options, second);
	char *a = whole_file(first, &a_size), *b = whole_file(second, &b_size);
	write_city(&other, second);
	char *c = whole_file(second, &c_size);
	assert_int_equal(a_size, b_size);
	assert_memory_equal(a, b, a_size);
	assert_true(a_size != c_size || memcmp(a, c, a_size) != 0);
	free(a);
	free(b);
	free(c);
	unlink(first);
	unlink(second);
}

/* From node 0 along the directions of driving, or against them. */
static uint32_t count_reached(const struct pkg_graph *g, bool against)
{
	uint8_t *seen = calloc(g->node_count, 1);
	uint32_t *stack = malloc(g->node_count * sizeof(uint32_t)), depth = 0, reached = 1;
	stack[depth++] = 0;
	seen[0] = 1;
	while (depth) {
		const struct pkg_node *node = &g->nodes[stack[--depth]];
		for (uint32_t k = 0; k < node->out_count; k++) {
			uint32_t half = g->outs[node->first_out + k], drive = half ^ (uint32_t)against;
			uint32_t to = g->halves[half ^ 1].origin;
			if (!(g->edges[half / 2].flags & (drive & 1 ? PKG_EDGE_BACKWARD : PKG_EDGE_FORWARD)) || seen[to])
				continue;
			seen[to] = 1;
			stack[depth++] = to;
			reached++;
		}
	}
	free(seen);
	free(stack);
	return reached;
}

static void check_city(const struct synth_options *options)
{
	char path[64];
	snprintf(path, sizeof(path), "%s/c.osm", folder);
	write_city(options, path);
	const char *inputs[] = { path };
	struct read_options reading = { .inputs = inputs, .input_count = 1 };
	struct report report = { 0 };
	struct city city = { .report = &report };
	assert_int_equal(read_city(&city, &reading), 0);
	heights_infer(&city);
	struct graph_data graph;
	graph_build(&city, &graph);
	struct pkg_graph view = graph_view(&graph);
	assert_int_equal(graph_check(&view), 0);
	blocks_assign(&city, &view);
	for (int kind = 0; kind < FAULT_KIND_COUNT; kind++) {
		uint64_t dropped = report.faults[kind][FAULT_DROPPED], mended = report.faults[kind][FAULT_MENDED];
		if (dropped || (mended && kind != FAULT_BRIDGE_PROFILE)) /* a flat city's bridges are always lifted */
			print_error("seed %llu: fault %d: %llu mended, %llu dropped, first %lld\n",
				(unsigned long long)options->seed, kind, (unsigned long long)mended, (unsigned long long)dropped,
				(long long)report.first_id[kind]);
		assert_true(!dropped && (!mended || kind == FAULT_BRIDGE_PROFILE));
	}
	for (uint32_t n = 0; n < view.node_count; n++)
		assert_int_equal(view.nodes[n].component, 0);
	print_message("seed %llu, %.0f x %.0f m: %zu buildings, %zu trees, %u nodes, %u edges\n",
		(unsigned long long)options->seed, options->width_m, options->height_m, city.buildings.count, city.trees.count,
		view.node_count, view.edge_count);
	assert_int_equal(count_reached(&view, false), view.node_count);
	assert_int_equal(count_reached(&view, true), view.node_count);
	assert_true(city.buildings.count > 20 && city.trees.count > 20);
	graph_data_finish(&graph);
	city_finish(&city);
	unlink(path);
}

static void cities_of_all_sizes_are_clean_and_connected(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++)
		check_city(&sizes[i]);
}

static void many_seeds_are_clean_and_connected(void **state)
{
	(void)state;
	for (uint64_t seed = 100; seed < 125; seed++)
		check_city(&(struct synth_options){ seed, 700.0 + 60.0 * (double)(seed % 20), 900.0, 1.0 });
}

static void nothing_is_left_where_it_cannot_be_written(void **state)
{
	(void)state;
	struct synth_options options = { 1, 300, 300, 1.0 };
	struct synth synth;
	synth_make(&synth, &options);
	assert_true(osm_doc_write(synth.doc, "/nonexistent/city.osm") < 0);
	assert_true(osm_doc_write(synth.doc, "/dev/full/city.osm") < 0);
	synth_finish(&synth);
}

static void names_are_escaped(void **state)
{
	(void)state;
	char path[64];
	snprintf(path, sizeof(path), "%s/e.osm", folder);
	struct osm_doc *doc = osm_doc_new(geo_frame_at((struct geo_point){ 47, 8 }));
	osm_doc_node(doc, (struct dvec2){ 0, 0 });
	osm_doc_tag(doc, "name", "\"A\" & <B>\n");
	assert_int_equal(osm_doc_write(doc, path), 0);
	osm_doc_free(doc);
	size_t size;
	char *bytes = whole_file(path, &size);
	assert_non_null(memmem(bytes, size, "v=\"&quot;A&quot; &amp; &lt;B&gt;\"", 33));
	free(bytes);
	unlink(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(same_options_give_the_same_bytes),
		cmocka_unit_test(cities_of_all_sizes_are_clean_and_connected),
		cmocka_unit_test(many_seeds_are_clean_and_connected),
		cmocka_unit_test(nothing_is_left_where_it_cannot_be_written),
		cmocka_unit_test(names_are_escaped),
	};
	log_init("test", LOG_ERROR);
	return cmocka_run_group_tests(tests, make_folder, drop_folder);
}
