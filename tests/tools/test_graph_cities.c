/* The graph's invariants on every city of the data folder, and that bridges, ramps and tunnels keep their grade and
 * room. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#include "graph_check.h"
#include "platform/base/log.h"
#include "tools/bake/bake.h"
#include "tools/city/graph.h"

struct place {
	const char *streets, *terrain;
	size_t least_edges;
	double least_connected; /* share of the streets' length */
};

static const struct place places[] = {
	{ "city/tiny/rome-piazza-vittorio.osm.pbf", NULL, 100, 0.9 },
	{ "city/tiny/london-soho.osm.gz", NULL, 20, 0.9 },
	{ "city/geneva/geneva.osm.pbf", NULL, 5000, 0.95 },
	{ "city/sf-downtown/sf-downtown.osm.pbf", NULL, 3000, 0.9 },
	{ "city/monaco/monaco-2023-tilemaker.osm.pbf", "city/monaco/N43E007.hgt.zip", 800, 0.9 },
	{ "city/paris11/paris-roads-valhalla-paris_bss.osm.pbf", NULL, 500, 0.9 },
};

static double connected_share(const struct pkg_graph *graph)
{
	double all = 0.0, largest = 0.0;
	for (uint32_t e = 0; e < graph->edge_count; e++) {
		all += graph->edges[e].length_mm;
		if (!graph->nodes[graph->halves[2 * e].origin].component)
			largest += graph->edges[e].length_mm;
	}
	return largest / all;
}

/* No steps: on flat ground nothing is steeper than the grade that ramps may have at their middle, and a little. */
static double steepest(const struct pkg_graph *graph)
{
	double worst = 0.0;
	for (uint32_t e = 0; e < graph->edge_count; e++) {
		const struct pkg_point *p = &graph->points[graph->edges[e].first_point];
		for (uint32_t i = 1; i < graph->edges[e].point_count; i++, p++) {
			double run = hypot((double)p[1].pos_mm[0] - p[0].pos_mm[0], (double)p[1].pos_mm[1] - p[0].pos_mm[1]);
			double rise = fabs((double)p[1].pos_mm[2] - p[0].pos_mm[2]);
			if (run > 500.0)
				worst = fmax(worst, rise / run);
		}
	}
	return worst;
}

/* Places along all streets that are on the ground, where a wall stands in the carriageway. On a steep slope a roof may
 * lie below the street. */
static size_t walls_met(const struct city *city, const struct pkg_graph *graph)
{
	size_t met = 0;
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct building *b = &city->buildings.items[i];
		if (b->min_height_m > 3.0 || b->kind == BUILDING_ROOF)
			continue;
		struct dvec2 min, max;
		ring_bounds(&b->footprint.outer, &min, &max);
		for (uint32_t p = 0; p < graph->point_count; p++) {
			const int32_t *mm = graph->points[p].pos_mm;
			struct dvec2 at = { mm[0] / 1000.0, mm[1] / 1000.0 };
			bool on_ground = fabs(mm[2] / 1000.0 - city_ground(city, at)) < 0.1;
			met += at.x > min.x && at.x < max.x && at.y > min.y && at.y < max.y && on_ground &&
				   mm[2] / 1000.0 < b->ground_m + b->height_m - 0.5 && polygon_contains(&b->footprint, at);
		}
	}
	return met;
}

static void check_place(const char *data, const struct place *place)
{
	char streets[512], terrain[512];
	snprintf(streets, sizeof(streets), "%s/%s", data, place->streets);
	snprintf(terrain, sizeof(terrain), "%s/%s", data, place->terrain ? place->terrain : "");
	const char *inputs[] = { streets }, *terrains[] = { terrain };
	struct read_options options = {
		.inputs = inputs, .input_count = 1, .terrain_files = terrains, .terrain_file_count = place->terrain ? 1 : 0
	};
	struct report report = { 0 };
	struct city city = { .report = &report };
	assert_int_equal(read_city(&city, &options), 0);
	struct graph_data graph;
	graph_build(&city, &graph);
	struct pkg_graph view = graph_view(&graph);
	assert_int_equal(graph_check(&view), 0);
	assert_true(graph.edges.count >= place->least_edges);
	double connected = connected_share(&view), grade = steepest(&view);
	print_message("%s: %zu nodes, %zu edges, %zu faces, %zu turns, %.1f %% connected, steepest %.0f %%\n",
		place->streets, graph.nodes.count, graph.edges.count, graph.faces.count, graph.turns.count, 100.0 * connected,
		100.0 * grade);
	assert_true(connected >= place->least_connected);
	if (!place->terrain)
		assert_true(grade < 2.5 * GRAPH_GRADE);
	heights_infer(&city);
	blocks_assign(&city, &view);
	print_message("  %zu buildings, in street %llu + %llu, street through %llu + %llu, over faults %llu + %llu\n",
		city.buildings.count, (unsigned long long)report.faults[FAULT_BUILDING_IN_STREET][FAULT_MENDED],
		(unsigned long long)report.faults[FAULT_BUILDING_IN_STREET][FAULT_DROPPED],
		(unsigned long long)report.faults[FAULT_STREET_THROUGH_BUILDING][FAULT_MENDED],
		(unsigned long long)report.faults[FAULT_STREET_THROUGH_BUILDING][FAULT_DROPPED],
		(unsigned long long)report.faults[FAULT_BRIDGE_PROFILE][FAULT_MENDED],
		(unsigned long long)report.faults[FAULT_BRIDGE_PROFILE][FAULT_DROPPED]);
	assert_int_equal(walls_met(&city, &view), 0);
	graph_data_finish(&graph);
	city_finish(&city);
}

static void invariants_hold_in_real_cities(void **state)
{
	(void)state;
	const char *data = getenv("BLVD_DATA");
	if (!data || access(data, R_OK)) {
		print_message("skipped: no BLVD_DATA\n");
		skip();
	}
	for (size_t i = 0; i < sizeof(places) / sizeof(places[0]); i++)
		check_place(data, &places[i]);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(invariants_hold_in_real_cities) };
	log_init("test", LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
