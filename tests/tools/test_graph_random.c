/* The graph's invariants on thousands of small random street sets: crossings, collinear overlaps, duplicates, shared
 * points, streets without length, bridges and tunnels. Coordinates from a coarse lattice make coincidences common, from
 * a millimetre lattice they make rounding hard. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "graph_check.h"
#include "make_city.h"
#include "platform/base/rng.h"

struct recipe {
	const char *name;
	int cases, ways, points;
	double extent_m, lattice_m;
	bool levels;
};

static void add_random_way(struct city *city, struct rng *rng, const struct recipe *recipe, int64_t id)
{
	double nodes[8][3];
	size_t count = 2 + rng_u32(rng) % (uint32_t)(recipe->points - 1);
	for (size_t i = 0; i < count; i++) {
		nodes[i][0] = 0;
		for (int axis = 1; axis < 3; axis++)
			nodes[i][axis] = floor(rng_range(rng, 0, recipe->extent_m) / recipe->lattice_m) * recipe->lattice_m;
		if (i && rng_u32(rng) % 8 == 0)
			memcpy(nodes[i], nodes[i - 1], sizeof(nodes[i]));
		if (rng_u32(rng) % 4 == 0) /* nodes shared by id, always at the place that the id stands for */
			nodes[i][0] = 1.0 + nodes[i][1] / recipe->lattice_m + 1e5 * (nodes[i][2] / recipe->lattice_m);
	}
	struct way *way = city_street(city, id, count, (const double(*)[3])nodes);
	way->oneway = (int)(rng_u32(rng) % 3) - 1;
	way->name = rng_u32(rng) % 2 ? "a" : "b";
	if (!recipe->levels)
		return;
	way->bridge = rng_u32(rng) % 5 == 0;
	way->tunnel = !way->bridge && rng_u32(rng) % 6 == 0;
	way->layer = (int)(rng_u32(rng) % 4) - 1;
	way->drivable = rng_u32(rng) % 8 != 0;
	if (!way->drivable)
		way->street_class = rng_u32(rng) % 2 ? WAY_RAIL : WAY_FOOT;
}

static void run_recipe(const struct recipe *recipe)
{
	for (int i = 0; i < recipe->cases; i++) {
		struct rng rng = rng_seed((uint64_t)i * 31 + (uint64_t)recipe->ways);
		struct city city;
		struct report report;
		struct graph_data graph;
		city_start(&city, &report);
		int ways = 1 + (int)(rng_u32(&rng) % (uint32_t)recipe->ways);
		for (int w = 0; w < ways; w++)
			add_random_way(&city, &rng, recipe, w + 1);
		for (int r = 0; r < 6 && city.ways.count; r++) {
			const struct way *from = &city.ways.items[rng_u32(&rng) % city.ways.count];
			struct restriction rule = { from->id, from->nodes[from->node_count - 1].id, 0, rng_u32(&rng) % 2 };
			rule.to_way = city.ways.items[rng_u32(&rng) % city.ways.count].id;
			ARRAY_PUSH(&city.restrictions, rule);
		}
		graph_build(&city, &graph);
		struct pkg_graph view = graph_view(&graph);
		int failures = graph_check(&view);
		if (failures)
			print_error("%s, case %d: %d failures\n", recipe->name, i, failures);
		assert_int_equal(failures, 0);
		graph_data_finish(&graph);
		city_finish(&city);
	}
}

static const struct recipe recipes[] = {
	{ "few streets on a coarse lattice", 2000, 5, 4, 50.0, 10.0, false },
	{ "many streets on a coarse lattice", 300, 40, 6, 60.0, 10.0, false },
	{ "streets on a millimetre lattice", 600, 12, 5, 0.02, 0.001, false },
	{ "thick bundles on a millimetre lattice", 60, 60, 4, 0.2, 0.001, false },
	{ "free streets", 600, 20, 6, 300.0, 0.001, false },
	{ "levels on a coarse lattice", 1500, 12, 4, 60.0, 10.0, true },
	{ "levels, free", 400, 30, 5, 400.0, 0.001, true },
	{ "levels on a millimetre lattice", 300, 14, 4, 0.03, 0.001, true },
};

static void invariants_hold_on_random_streets(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(recipes) / sizeof(recipes[0]); i++)
		run_recipe(&recipes[i]);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(invariants_hold_on_random_streets) };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
