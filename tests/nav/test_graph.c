/* Queries over the street graph. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nav/graph.h"
#include "platform/base/rng.h"
#include "tests/nav/streets.h"

static uint8_t memory[1 << 24];

static struct graph make(const struct pkg *pkg)
{
	struct arena arena;
	struct graph graph;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(graph_init(&graph, &arena, &pkg->graph, pkg->meta->right_hand_traffic), 0);
	return graph;
}

static void both_halves_tell_the_same_place(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 0, 0), b = streets_node(s, 30, 40);
	streets_edge(s, a, b, ALPHA, 1, (const double[][2]){ { 30, 0 } });
	s->points[0].pos_mm[2] = 1000;
	s->points[1].pos_mm[2] = 4000;
	s->points[2].pos_mm[2] = 4000;
	struct graph graph = make(streets_finish(s, true));
	assert_near(graph_length_m(&graph, 0), 70.0, 1e-9);
	for (int i = 0; i <= 20; i++) {
		double m = i * 3.5;
		struct graph_pose p = graph_at(&graph, 0, m), q = graph_at(&graph, 1, 70.0 - m);
		assert_near(p.at_m.x, q.at_m.x, 1e-9);
		assert_near(p.at_m.y, q.at_m.y, 1e-9);
		assert_near(p.at_m.z, m < 30 ? 1.0 + m / 10.0 : 4.0, 1e-9);
		if (fabs(m - 30.0) > 1e-9)
			assert_near(fabs(remainder(p.heading_rad - q.heading_rad, 2.0 * BLVD_PI)), BLVD_PI, 1e-9);
	}
	assert_near(graph_at(&graph, 0, 10).heading_rad, BLVD_PI / 2.0, 1e-9); /* east */
	assert_near(graph_at(&graph, 0, -5).at_m.x, 0.0, 0.0);                 /* clamped */
	assert_near(graph_at(&graph, 0, 500).at_m.y, 40.0, 1e-9);
	free(s);
}

static void streets_without_length_are_harmless(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 5, 5), b = streets_node(s, 5, 5), c = streets_node(s, 5, 30);
	streets_edge(s, a, b, NO_NAME, 1, (const double[][2]){ { 5, 5 } });
	streets_edge(s, b, c, NO_NAME, 2, (const double[][2]){ { 5, 5 }, { 5, 30 } });
	struct graph graph = make(streets_finish(s, true));
	assert_near(graph_length_m(&graph, 0), 0.0, 0.0);
	assert_true(isfinite(graph_at(&graph, 0, 0).heading_rad));
	assert_near(graph_at(&graph, 2, 0).heading_rad, 0.0, 1e-9); /* north, though the first points repeat */
	assert_near(graph_at(&graph, 2, 25).heading_rad, 0.0, 1e-9);
	free(s);
}

static void nearest_streets_are_those_that_a_full_scan_finds(void **state)
{
	(void)state;
	struct rng rng = rng_seed(7);
	for (int round = 0; round < 20; round++) {
		struct streets *s = streets_new();
		for (int i = 0; i < 60; i++)
			streets_node(s, rng_range(&rng, -900, 900), rng_range(&rng, -900, 900));
		for (int i = 0; i < 90; i++) {
			double mid[1][2] = { { rng_range(&rng, -900, 900), rng_range(&rng, -900, 900) } };
			uint32_t from = rng_u32(&rng) % 60, to = rng_u32(&rng) % 60;
			streets_edge(s, from, to, NO_NAME, (size_t)i % 2, mid);
		}
		struct graph graph = make(streets_finish(s, true));
		for (int i = 0; i < 30; i++) {
			struct dvec2 at = { rng_range(&rng, -1000, 1000), rng_range(&rng, -1000, 1000) };
			double radius = rng_range(&rng, 1, 300);
			struct graph_hit hits[128];
			uint32_t count = graph_nearest(&graph, at, radius, hits, 128), expected = 0;
			for (uint32_t e = 0; e < s->edge_count; e++)
				expected += graph_project(&graph, e, at).distance_m <= radius;
			assert_int_equal(count, expected);
			for (uint32_t k = 1; k < count; k++)
				assert_true(hits[k - 1].distance_m <= hits[k].distance_m);
			struct graph_hit one;
			if (graph_nearest(&graph, at, radius, &one, 1))
				assert_int_equal(one.edge, hits[0].edge);
		}
		free(s);
	}
}

static void nowhere_is_near_nothing(void **state)
{
	(void)state;
	struct streets *s = streets_grid(3, 100);
	struct graph graph = make(streets_finish(s, true));
	const double bad[] = { NAN, INFINITY, -INFINITY, 1e300 };
	struct graph_hit hit;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		assert_int_equal(graph_nearest(&graph, (struct dvec2){ bad[i], 0 }, 50, &hit, 1), 0);
		assert_int_equal(graph_nearest(&graph, (struct dvec2){ 0, bad[i] }, 50, &hit, 1), 0);
	}
	assert_int_equal(graph_nearest(&graph, (struct dvec2){ 5000, 5000 }, 50, &hit, 1), 0);
	free(s);
}

static void ways_out_obey_signs(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t w = streets_node(s, -50, 0), c = streets_node(s, 0, 0), e = streets_node(s, 50, 0),
			 n = streets_node(s, 0, 50);
	streets_edge(s, w, c, NO_NAME, 0, NULL);
	streets_edge(s, c, e, NO_NAME, 0, NULL);
	streets_oneway(streets_edge(s, n, c, NO_NAME, 0, NULL));
	uint32_t to_c = streets_half(s, w, c), to_e = streets_half(s, c, e), from_n = streets_half(s, n, c);
	streets_turn(s, from_n, to_e);
	struct graph graph = make(streets_finish(s, true));
	uint32_t out[GRAPH_SUCCESSORS_MAX];
	assert_int_equal(graph_successors(&graph, to_c, GRAPH_LEGAL, out), 1); /* not into the one-way street */
	assert_int_equal(out[0], to_e);
	assert_int_equal(graph_successors(&graph, from_n, GRAPH_LEGAL, out), 1); /* left is forbidden */
	assert_int_equal(out[0], graph_twin(to_c));
	assert_int_equal(graph_successors(&graph, to_e, GRAPH_LEGAL, out), 1); /* dead end: back */
	assert_int_equal(out[0], graph_twin(to_e));
	assert_int_equal(graph_successors(&graph, to_c, GRAPH_PHYSICAL, out), 3);
	assert_true(graph_turn_forbidden(&graph, from_n, to_e));
	assert_false(graph_turn_forbidden(&graph, to_e, from_n));
	free(s);
}

static void lanes_lie_on_the_side_of_the_traffic(void **state)
{
	(void)state;
	static const struct {
		bool right_hand;
		int forward, backward, width_mm;
		uint32_t half, lane;
		double offset;
	} table[] = {
		{ true, 1, 1, 6000, 0, 0, 1.5 },
		{ true, 1, 1, 6000, 1, 0, 1.5 },
		{ false, 1, 1, 6000, 0, 0, -1.5 },
		{ true, 2, 1, 9000, 0, 0, 3.0 },
		{ true, 2, 1, 9000, 0, 1, 0.0 },
		{ true, 2, 1, 9000, 1, 0, 3.0 },
		{ true, 1, 0, 4000, 0, 0, 0.0 },
		{ true, 3, 0, 9000, 0, 0, 3.0 },
		{ true, 3, 0, 9000, 0, 2, -3.0 },
		{ true, 3, 0, 9000, 0, 9, -3.0 },
		{ false, 3, 0, 9000, 0, 0, -3.0 },
	};
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		struct streets *s = streets_new();
		uint32_t a = streets_node(s, 0, 0), b = streets_node(s, 0, 100);
		struct pkg_edge *edge = streets_edge(s, a, b, NO_NAME, 0, NULL);
		if (!table[i].backward)
			streets_oneway(edge);
		edge->lanes_forward = (uint8_t)table[i].forward;
		edge->lanes_backward = (uint8_t)table[i].backward;
		edge->width_mm = (uint16_t)table[i].width_mm;
		struct graph graph = make(streets_finish(s, table[i].right_hand));
		assert_near(graph_lane_offset_m(&graph, table[i].half, table[i].lane), table[i].offset, 1e-9);
		free(s);
	}
}

static void a_full_arena_is_an_error(void **state)
{
	(void)state;
	struct streets *s = streets_grid(10, 100);
	const struct pkg *pkg = streets_finish(s, true);
	for (size_t size = 0; size < 6000; size += 97) {
		struct arena arena;
		struct graph graph;
		arena_init(&arena, "test", memory, size);
		int err = graph_init(&graph, &arena, &pkg->graph, true);
		assert_true(err == 0 || err == -12);
	}
	free(s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(both_halves_tell_the_same_place),
		cmocka_unit_test(streets_without_length_are_harmless),
		cmocka_unit_test(nearest_streets_are_those_that_a_full_scan_finds),
		cmocka_unit_test(nowhere_is_near_nothing),
		cmocka_unit_test(ways_out_obey_signs),
		cmocka_unit_test(lanes_lie_on_the_side_of_the_traffic),
		cmocka_unit_test(a_full_arena_is_an_error),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
