/* What may soon be driven on, on a grid of streets cut into stretches. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nav/likely.h"
#include "platform/base/rng.h"
#include "tests/nav/streets.h"

static uint8_t memory[1 << 24];
static struct graph graph;
static struct streets *streets;
static struct pkg pkg;
static struct pkg_stretch stretches[2 * STREETS_EDGES];
static uint32_t first_stretch[STREETS_EDGES + 1];

/* Every edge in pieces of 50 m; those longer than a kilometre have none. */
static void cut(struct streets *s)
{
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	streets = s;
	pkg = *streets_finish(s, true);
	assert_int_equal(graph_init(&graph, &arena, &pkg.graph, true), 0);
	pkg.stretches = stretches;
	pkg.first_stretch = first_stretch;
	for (uint32_t e = 0; e < pkg.graph.edge_count; e++) {
		first_stretch[e] = pkg.stretch_count;
		double length = graph_length_m(&graph, 2 * e);
		uint32_t pieces = length > 1000.0 ? 0 : (uint32_t)ceil(length / 50.0);
		for (uint32_t i = 0; i < pieces; i++)
			stretches[pkg.stretch_count++] = (struct pkg_stretch){ .edge = e,
				.from_mm = (uint32_t)lrint(length * 1e3 * i / pieces),
				.to_mm = (uint32_t)lrint(length * 1e3 * (i + 1) / pieces) };
	}
	first_stretch[pkg.graph.edge_count] = pkg.stretch_count;
}

static struct nav_view on(uint32_t half, double along_m, double speed_mps)
{
	struct graph_pose pose = graph_at(&graph, half, along_m);
	return (struct nav_view){ .located = true,
		.on_street = true,
		.pos_mm = { llrint(pose.at_m.x * 1e3), llrint(pose.at_m.y * 1e3) },
		.heading_bam = bam_from_rad(pose.heading_rad),
		.speed_mps = speed_mps,
		.half = half,
		.along_m = along_m };
}

/* Place in the list of the stretch at a distance along the half-edge between two nodes; NAV_LIKELY_MAX: not in it. */
static uint32_t place(const struct nav_view *view, uint32_t from, uint32_t to, double along_m)
{
	uint32_t list[NAV_LIKELY_MAX], count = likely_stretches(&graph, &pkg, view, list);
	uint32_t half = streets_half(streets, from, to);
	assert_int_not_equal(half, PKG_NONE);
	double start = half & 1 ? graph_length_m(&graph, half) - along_m : along_m;
	for (uint32_t i = 0; i < count; i++) {
		const struct pkg_stretch *stretch = &stretches[list[i]];
		if (stretch->edge == half / 2 && stretch->from_mm <= start * 1e3 && stretch->to_mm > start * 1e3)
			return i;
	}
	return NAV_LIKELY_MAX;
}

static void check_list(const struct nav_view *view)
{
	uint32_t list[NAV_LIKELY_MAX], count = likely_stretches(&graph, &pkg, view, list);
	assert_true(count <= NAV_LIKELY_MAX);
	for (uint32_t i = 0; i < count; i++) {
		assert_true(list[i] < pkg.stretch_count);
		for (uint32_t k = 0; k < i; k++)
			assert_int_not_equal(list[i], list[k]);
	}
}

/* Crossings are 100 m apart; the car comes from node 11 (east 100, north 200) towards node 12, crossing streets north
 * to 17 and south to 7, straight on to 13. */
static void the_street_ahead_comes_first(void **state)
{
	(void)state;
	cut(streets_grid(5, 100));
	struct nav_view view = on(streets_half(streets, 11, 12), 10, 10);
	assert_int_equal(place(&view, 11, 12, 10), 0);
	assert_int_equal(place(&view, 11, 12, 60), 1);
	uint32_t ahead = place(&view, 12, 13, 10), left = place(&view, 12, 17, 10), right = place(&view, 12, 7, 10);
	uint32_t behind = place(&view, 11, 10, 10);
	assert_true(ahead < left && ahead < right);
	assert_true(left < NAV_LIKELY_MAX && right < NAV_LIKELY_MAX && behind < NAV_LIKELY_MAX);
	check_list(&view);
	free(streets);
}

static void what_changes_the_order(void **state)
{
	(void)state;
	cut(streets_grid(5, 100));
	enum { AHEAD = 13, LEFT = 17, RIGHT = 7 };
	const struct {
		enum nav_turn_lamp lamp;
		uint32_t route_to; /* the route turns there; 0: none */
		bool off_route;
		uint32_t first, later;
	} table[] = {
		{ NAV_TURN_LAMP_OFF, 0, false, AHEAD, LEFT },
		{ NAV_TURN_LAMP_LEFT, 0, false, LEFT, AHEAD },
		{ NAV_TURN_LAMP_LEFT, 0, false, AHEAD, RIGHT },
		{ NAV_TURN_LAMP_RIGHT, 0, false, RIGHT, AHEAD },
		{ NAV_TURN_LAMP_HAZARD, 0, false, AHEAD, RIGHT },
		{ NAV_TURN_LAMP_OFF, RIGHT, false, RIGHT, AHEAD },
		{ NAV_TURN_LAMP_OFF, RIGHT, true, AHEAD, RIGHT },
		{ NAV_TURN_LAMP_OFF, LEFT, false, LEFT, AHEAD },
		{ NAV_TURN_LAMP_LEFT, RIGHT, false, RIGHT, LEFT },
	};
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		struct nav_view view = on(streets_half(streets, 11, 12), 70, 10);
		view.turn_lamp = table[i].lamp;
		view.off_route = table[i].off_route;
		if (table[i].route_to) {
			view.routed = true;
			view.route_count = 2;
			view.route[0] = view.half;
			view.route[1] = streets_half(streets, 12, table[i].route_to);
		}
		uint32_t first = place(&view, 12, table[i].first, 10), later = place(&view, 12, table[i].later, 10);
		if (first >= later)
			fail_msg("case %zu: %u before %u", i, later, first);
		check_list(&view);
	}
	free(streets);
}

static void the_horizon_grows_with_speed(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	for (uint32_t i = 0; i < 10; i++)
		streets_node(s, i * 100.0, 0);
	for (uint32_t i = 0; i < 9; i++)
		streets_edge(s, i, i + 1, NO_NAME, 0, NULL);
	cut(s);
	const struct {
		double speed_mps, ahead_m;
	} table[] = { { 0, 150 }, { 14, 150 }, { 36, 288 }, { -36, 150 } };
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		struct nav_view view = on(streets_half(s, 3, 4), 0, table[i].speed_mps);
		for (double ahead = 1; ahead < table[i].ahead_m; ahead += 50) {
			uint32_t node = 3 + (uint32_t)(ahead / 100);
			assert_true(place(&view, node, node + 1, fmod(ahead, 100)) < NAV_LIKELY_MAX);
		}
		assert_int_equal(place(&view, 7, 8, 10), NAV_LIKELY_MAX);
	}
	free(s);
}

static void a_car_that_goes_back_is_expected_behind(void **state)
{
	(void)state;
	cut(streets_grid(5, 100));
	uint32_t half = streets_half(streets, 11, 12);
	const struct {
		double speed_mps;
		enum nav_gear gear;
		bool turned;
		bool against;
	} table[] = {
		{ 5, NAV_GEAR_DRIVE, false, false },
		{ -2, NAV_GEAR_REVERSE, false, true },
		{ 0, NAV_GEAR_REVERSE, false, true },
		{ -2, NAV_GEAR_UNKNOWN, false, true },
		{ 5, NAV_GEAR_DRIVE, true, true },
		{ -2, NAV_GEAR_REVERSE, true, false },
	};
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		struct nav_view view = on(half, 55, table[i].speed_mps);
		view.gear = table[i].gear;
		if (table[i].turned)
			view.heading_bam = (int32_t)((uint32_t)view.heading_bam + 0x80000000u);
		uint32_t ahead = place(&view, 12, 13, 10), behind = place(&view, 11, 10, 10);
		assert_int_equal(place(&view, 11, 12, 55), 0);
		assert_true((behind < ahead) == table[i].against);
	}
	free(streets);
}

static void one_way_streets_come_late(void **state)
{
	(void)state;
	struct streets *s = streets_grid(5, 100);
	s->edges[streets_half(s, 12, 13) / 2].flags = PKG_EDGE_BACKWARD;
	cut(s);
	struct nav_view view = on(streets_half(s, 11, 12), 80, 10);
	assert_true(place(&view, 12, 17, 10) < place(&view, 12, 13, 10));
	free(s);
}

static void off_the_street_the_nearest_ones_count(void **state)
{
	(void)state;
	cut(streets_grid(5, 100));
	struct nav_view view = { .located = true, .pos_mm = { 120000, 230000 }, .half = PKG_NONE };
	assert_int_equal(place(&view, 11, 16, 30), 0);
	assert_true(place(&view, 11, 12, 10) < NAV_LIKELY_MAX);
	check_list(&view);
	view.pos_mm[0] = 90000000; /* far away from any street */
	uint32_t list[NAV_LIKELY_MAX];
	assert_int_equal(likely_stretches(&graph, &pkg, &view, list), 0);
	view.located = false;
	assert_int_equal(likely_stretches(&graph, &pkg, &view, list), 0);
	free(streets);
}

static void without_a_far_field_nothing_is_likely(void **state)
{
	(void)state;
	cut(streets_grid(3, 100));
	struct pkg bare = pkg;
	bare.stretches = NULL;
	struct nav_view view = on(0, 10, 10);
	uint32_t list[NAV_LIKELY_MAX];
	assert_int_equal(likely_stretches(&graph, &bare, &view, list), 0);
	free(streets);
}

static void streets_without_stretches_are_walked_through(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	for (uint32_t i = 0; i < 3; i++)
		streets_node(s, i * 1100.0, 0);
	streets_node(s, 2250, 0);
	for (uint32_t i = 0; i < 3; i++)
		streets_edge(s, i, i + 1, NO_NAME, 0, NULL);
	cut(s);
	struct nav_view view = on(streets_half(s, 1, 2), 1050, 10);
	assert_int_equal(place(&view, 2, 3, 10), 0);
	free(s);
}

static void any_graph_gives_a_list_without_repeats(void **state)
{
	(void)state;
	struct rng rng = rng_seed(4);
	for (int round = 0; round < 100; round++) {
		struct streets *s = streets_new();
		uint32_t n = 2 + rng_u32(&rng) % 20;
		for (uint32_t i = 0; i < n; i++)
			streets_node(s, rng_range(&rng, -150, 150), rng_range(&rng, -150, 150));
		for (uint32_t i = 0; i < 3 * n; i++)
			streets_edge(s, rng_u32(&rng) % n, rng_u32(&rng) % n, NO_NAME, 0, NULL);
		cut(s);
		for (int k = 0; k < 20; k++) {
			uint32_t half = rng_u32(&rng) % (6 * n);
			struct nav_view view = on(half, rng_range(&rng, -10, 300), rng_range(&rng, -10, 60));
			view.turn_lamp = rng_u32(&rng) % 4;
			check_list(&view);
			uint32_t list[NAV_LIKELY_MAX], count = likely_stretches(&graph, &pkg, &view, list);
			if (count && graph_length_m(&graph, half) > 0.0)
				assert_int_equal(stretches[list[0]].edge, half / 2);
		}
		free(s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_street_ahead_comes_first),
		cmocka_unit_test(what_changes_the_order),
		cmocka_unit_test(the_horizon_grows_with_speed),
		cmocka_unit_test(a_car_that_goes_back_is_expected_behind),
		cmocka_unit_test(one_way_streets_come_late),
		cmocka_unit_test(off_the_street_the_nearest_ones_count),
		cmocka_unit_test(without_a_far_field_nothing_is_likely),
		cmocka_unit_test(streets_without_stretches_are_walked_through),
		cmocka_unit_test(any_graph_gives_a_list_without_repeats),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
