/* Routes against a plain relaxation over all half-edges, and the cases that have no route. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nav/route.h"
#include "platform/base/rng.h"
#include "tests/nav/streets.h"

static uint8_t memory[1 << 24];
static struct graph graph;
static struct route_search search;

static void make(const struct pkg *pkg, uint32_t capacity)
{
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(graph_init(&graph, &arena, &pkg->graph, true), 0);
	assert_int_equal(route_init(&search, &arena, &graph, capacity), 0);
}

static struct streets *random_streets(struct rng *rng)
{
	struct streets *s = streets_new();
	uint32_t n = 3 + rng_u32(rng) % 30;
	for (uint32_t i = 0; i < n; i++) {
		streets_node(s, rng_range(rng, -800, 800), rng_range(rng, -800, 800));
		s->nodes[i].flags = rng_u32(rng) % 4 ? 0 : 1u << rng_u32(rng) % 3;
	}
	uint32_t edges = n + rng_u32(rng) % (2 * n);
	for (uint32_t i = 0; i < edges; i++) {
		struct pkg_edge *edge = streets_edge(s, rng_u32(rng) % n, rng_u32(rng) % n, NO_NAME, 0, NULL);
		edge->street_class = (uint8_t)(rng_u32(rng) % PKG_STREET_CLASS_COUNT);
		edge->speed_kmh = (uint8_t)(rng_u32(rng) % 3 * 40);
		if (rng_u32(rng) % 3 == 0)
			streets_oneway(edge);
		if (rng_u32(rng) % 8 == 0)
			edge->flags |= PKG_EDGE_PRIVATE;
	}
	for (int i = 0; i < 40; i++) {
		uint32_t a = rng_u32(rng) % (2 * edges), b = rng_u32(rng) % (2 * edges);
		if (s->halves[a ^ 1].origin == s->halves[b].origin)
			streets_turn(s, a, b);
	}
	return s;
}

/* Least cost from a start to a stop without a heap, a bound or a direction: relaxing until nothing changes. */
static uint64_t plain_cost(struct route_place start, struct route_place stop)
{
	uint32_t halves = graph.net->half_count;
	uint64_t *cost = calloc(halves, sizeof(*cost)), best = UINT64_MAX;
	double start_length = graph_length_m(&graph, start.half);
	for (uint32_t h = 0; h < halves; h++) {
		uint32_t turn = route_turn_ms(&graph, start.half, h);
		cost[h] = turn == ROUTE_FORBIDDEN
					  ? UINT64_MAX
					  : (uint64_t)route_part_ms(&search, start.half, start_length - start.along_m) + turn;
	}
	for (bool changed = true; changed;) {
		changed = false;
		for (uint32_t a = 0; a < halves; a++) {
			for (uint32_t b = 0; cost[a] != UINT64_MAX && b < halves; b++) {
				uint32_t turn = route_turn_ms(&graph, a, b);
				if (turn == ROUTE_FORBIDDEN || cost[a] + route_edge_ms(&search, a) + turn >= cost[b])
					continue;
				cost[b] = cost[a] + route_edge_ms(&search, a) + turn;
				changed = true;
			}
		}
	}
	for (uint32_t side = 0; side < 2; side++) {
		uint32_t half = stop.half ^ side;
		double along = side ? graph_length_m(&graph, half) - stop.along_m : stop.along_m;
		if (!graph_drivable(&graph, half))
			continue;
		if (half == start.half && along >= start.along_m && route_part_ms(&search, half, along - start.along_m) < best)
			best = route_part_ms(&search, half, along - start.along_m);
		if (cost[half] != UINT64_MAX && cost[half] + route_part_ms(&search, half, along) < best)
			best = cost[half] + route_part_ms(&search, half, along);
	}
	free(cost);
	return best;
}

static void check_route_is_drivable(const struct route *route)
{
	assert_true(route->count > 0);
	for (uint32_t i = 1; i < route->count; i++)
		assert_int_not_equal(route_turn_ms(&graph, route->halves[i - 1], route->halves[i]), ROUTE_FORBIDDEN);
}

static struct route_place random_place(struct rng *rng)
{
	for (;;) {
		uint32_t half = rng_u32(rng) % graph.net->half_count;
		if (graph_drivable(&graph, half))
			return (struct route_place){ half, graph_length_m(&graph, half) * rng_unit(rng) };
	}
}

static void routes_cost_what_a_plain_search_says(void **state)
{
	(void)state;
	struct rng rng = rng_seed(11);
	int found = 0, none = 0;
	for (int round = 0; round < 120; round++) {
		struct streets *s = random_streets(&rng);
		make(streets_finish(s, true), 0);
		for (int i = 0; i < 6; i++) {
			struct route_request request = {
				.start = random_place(&rng), .stops = { random_place(&rng) }, .stop_count = 1
			};
			uint64_t expected = plain_cost(request.start, request.stops[0]);
			if (route_find(&search, &request) == ROUTE_FOUND) {
				assert_int_equal(search.route.cost_ms, expected);
				check_route_is_drivable(&search.route);
				found++;
			} else {
				assert_true(expected == UINT64_MAX);
				none++;
			}
		}
		free(s);
	}
	assert_true(found > 200 && none > 20);
}

static void a_search_in_pieces_finds_the_same(void **state)
{
	(void)state;
	struct rng rng = rng_seed(3);
	struct streets *s = streets_grid(20, 90);
	make(streets_finish(s, true), 0);
	for (int i = 0; i < 20; i++) {
		struct route_request request = { .start = random_place(&rng),
			.stops = { random_place(&rng), random_place(&rng), random_place(&rng) },
			.stop_count = 3 };
		assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
		uint32_t whole[4096], count = search.route.count;
		memcpy(whole, search.route.halves, count * sizeof(*whole));
		route_begin(&search, &request);
		int steps = 0;
		while (route_step(&search, 7) == ROUTE_WORKING)
			steps++;
		assert_true(steps > 1);
		assert_int_equal(search.route.count, count);
		assert_memory_equal(whole, search.route.halves, count * sizeof(*whole));
	}
	free(s);
}

static void legs_join_at_the_stops(void **state)
{
	(void)state;
	struct rng rng = rng_seed(5);
	struct streets *s = streets_grid(8, 120);
	make(streets_finish(s, true), 0);
	for (int i = 0; i < 50; i++) {
		struct route_request request = { .start = random_place(&rng), .stop_count = 4 };
		for (int k = 0; k < 4; k++)
			request.stops[k] = random_place(&rng);
		assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
		check_route_is_drivable(&search.route);
		assert_int_equal(search.route.leg_count, 4);
		for (int k = 0; k < 4; k++)
			assert_int_equal(search.route.halves[search.route.leg_last[k]] >> 1, request.stops[k].half >> 1);
		assert_int_equal(search.route.leg_last[3], search.route.count - 1);
	}
	free(s);
}

static void a_stop_just_behind_means_going_round(void **state)
{
	(void)state;
	struct streets *s = streets_grid(3, 100);
	for (uint32_t e = 0; e < s->edge_count; e++)
		if (e < 2)
			streets_oneway(&s->edges[e]);
	make(streets_finish(s, true), 0);
	uint32_t half = streets_half(s, 0, 1);
	struct route_request request = { .start = { half, 60 }, .stops = { { half, 40 } }, .stop_count = 1 };
	assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
	assert_true(search.route.count > 4);
	assert_int_equal(search.route.halves[search.route.count - 1], half);
	request.stops[0].along_m = 80;
	assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
	assert_int_equal(search.route.count, 1);
	assert_near(search.route.end_along_m, 80, 1e-9);
	free(s);
}

static void setting_off_either_way_takes_the_shorter(void **state)
{
	(void)state;
	struct streets *s = streets_grid(4, 200);
	make(streets_finish(s, true), 0);
	uint32_t east = streets_half(s, 1, 2), west = streets_half(s, 1, 0);
	struct route_request request = { .start = { east, 10 }, .stops = { { west, 50 } }, .stop_count = 1 };
	assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
	assert_int_equal(search.route.halves[0], east);
	uint64_t ahead = search.route.cost_ms;
	request.start_either = true;
	assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
	assert_int_equal(search.route.halves[0], graph_twin(east));
	assert_near(search.route.start_along_m, 190, 1e-9);
	assert_true(search.route.cost_ms < ahead);
	free(s);
}

static void private_streets_are_no_short_cut(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 0, 0), b = streets_node(s, 100, 0), c = streets_node(s, 200, 0),
			 d = streets_node(s, 300, 0);
	streets_edge(s, a, b, NO_NAME, 0, NULL);
	streets_edge(s, b, c, NO_NAME, 0, NULL)->flags |= PKG_EDGE_PRIVATE;
	streets_edge(s, c, d, NO_NAME, 0, NULL);
	streets_edge(s, b, c, NO_NAME, 2, (const double[][2]){ { 100, 400 }, { 200, 400 } });
	make(streets_finish(s, true), 0);
	struct route_request request = { .start = { 0, 50 }, .stops = { { 4, 50 } }, .stop_count = 1 };
	assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
	for (uint32_t i = 0; i < search.route.count; i++)
		assert_int_not_equal(search.route.halves[i] >> 1, 1);
	request.stops[0] = (struct route_place){ 2, 50 }; /* but one may go there */
	assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
	assert_int_equal(search.route.count, 2);
	free(s);
}

static void no_way_is_said_so(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 0, 0), b = streets_node(s, 100, 0), c = streets_node(s, 500, 0),
			 d = streets_node(s, 600, 0);
	streets_edge(s, a, b, NO_NAME, 0, NULL);
	streets_edge(s, c, d, NO_NAME, 0, NULL);
	make(streets_finish(s, true), 0);
	struct route_request request = { .start = { 0, 50 }, .stops = { { 2, 50 } }, .stop_count = 1 };
	assert_int_equal(route_find(&search, &request), ROUTE_NONE);
	request.stop_count = 0;
	assert_int_equal(route_find(&search, &request), ROUTE_NONE);
	request.stop_count = 1;
	request.stops[0].half = 400;
	assert_int_equal(route_find(&search, &request), ROUTE_NONE);
	request.stops[0] = (struct route_place){ 0, NAN };
	assert_int_equal(route_find(&search, &request), ROUTE_NONE);
	struct route_place place;
	assert_true(route_snap(&graph, (struct dvec2){ 300, 40 }, 1000, &place));
	assert_false(route_snap(&graph, (struct dvec2){ 9000, 40 }, 1000, &place));
	free(s);
}

static void a_route_longer_than_its_room_is_refused(void **state)
{
	(void)state;
	struct streets *s = streets_grid(12, 100);
	make(streets_finish(s, true), 8);
	struct route_request request = {
		.start = { 0, 50 }, .stops = { { 2 * (s->edge_count - 1), 50 } }, .stop_count = 1
	};
	assert_int_equal(route_find(&search, &request), ROUTE_TOO_LONG);
	free(s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(routes_cost_what_a_plain_search_says),
		cmocka_unit_test(a_search_in_pieces_finds_the_same),
		cmocka_unit_test(legs_join_at_the_stops),
		cmocka_unit_test(a_stop_just_behind_means_going_round),
		cmocka_unit_test(setting_off_either_way_takes_the_shorter),
		cmocka_unit_test(private_streets_are_no_short_cut),
		cmocka_unit_test(no_way_is_said_so),
		cmocka_unit_test(a_route_longer_than_its_room_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
