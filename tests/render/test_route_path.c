/* The ribbon's line: whole around every kind of corner, the same before and after the car passes a junction. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"
#include "render/route_path.h"

#define EDGES 64

/* A chain of edges of two points each, from corner to corner. */
struct chain {
	struct pkg pkg;
	struct pkg_meta meta;
	struct pkg_node nodes[EDGES + 1];
	struct pkg_half halves[2 * EDGES];
	struct pkg_edge edges[EDGES];
	struct pkg_point points[2 * EDGES];
	struct nav_view nav;
	uint8_t memory[4 << 20];
	struct arena arena;
};
static struct chain chain;

static void start_chain(const double (*corners)[2], uint32_t count, bool two_way)
{
	memset(&chain, 0, sizeof(chain));
	arena_init(&chain.arena, "test", chain.memory, sizeof(chain.memory));
	chain.meta.right_hand_traffic = 1;
	chain.pkg.meta = &chain.meta;
	for (uint32_t i = 0; i + 1 < count; i++) {
		for (uint32_t end = 0; end < 2; end++)
			for (int axis = 0; axis < 2; axis++)
				chain.points[2 * i + end].pos_mm[axis] = (int32_t)lrint(corners[i + end][axis] * 1e3);
		double length = hypot(corners[i + 1][0] - corners[i][0], corners[i + 1][1] - corners[i][1]);
		chain.edges[i] = (struct pkg_edge){ .first_point = 2 * i, .point_count = 2, .width_mm = 9000 };
		chain.edges[i].length_mm = (uint32_t)lrint(length * 1e3);
		chain.edges[i].flags = two_way ? PKG_EDGE_FORWARD | PKG_EDGE_BACKWARD : PKG_EDGE_FORWARD;
		chain.halves[2 * i].origin = i;
		chain.halves[2 * i + 1].origin = i + 1;
		chain.nav.route[i] = 2 * i;
	}
	chain.pkg.graph = (struct pkg_graph){ .nodes = chain.nodes,
		.halves = chain.halves,
		.edges = chain.edges,
		.points = chain.points,
		.node_count = count,
		.half_count = 2 * (count - 1),
		.edge_count = count - 1,
		.point_count = 2 * (count - 1) };
	chain.nav.located = chain.nav.routed = true;
	chain.nav.route_count = count - 1;
}

/* No gap, no jump, no going back in s, no side longer than a mitre may be. */
static void assert_continuous(const struct route_path *path, double longest_step)
{
	assert_true(path->count >= 2);
	for (uint32_t i = 0; i < path->count; i++) {
		const struct route_path_point *at = &path->points[i];
		struct dvec2 side = route_path_side(path, i);
		double length = dvec2_length(side);
		assert_true(isfinite(at->at.x) && isfinite(at->at.y) && isfinite(at->at.z) && isfinite(at->s));
		assert_true(length >= 0.99 && length <= 1.61);
		assert_true(at->half_width > 0.5 && at->half_width < 3.0);
		if (i == 0)
			continue;
		double step = hypot(at->at.x - at[-1].at.x, at->at.y - at[-1].at.y);
		assert_true(step > 0.0 && step <= longest_step);
		assert_true(at->s >= at[-1].s - 1e-6);
	}
}

static void every_turn_is_continuous(void **state)
{
	(void)state;
	for (int degrees = -179; degrees <= 179; degrees++) {
		double angle = degrees * BLVD_PI / 180.0;
		const double corners[][2] = { { 0, 0 }, { 0, 60 }, { 60 * sin(angle), 60 + 60 * cos(angle) } };
		for (int two_way = 0; two_way <= 1; two_way++) {
			struct route_path path;
			start_chain(corners, 3, two_way);
			assert_int_equal(route_path_init(&path, &chain.arena, 256), 0);
			assert_true(route_path_follow(&path, &chain.pkg, &chain.nav));
			assert_continuous(&path, 80.0); /* a lane outside the bend is longer */
			/* rounded: no single bend is sharper than 20 degrees, but where a lane must turn back */
			double sharpest = 0.0;
			for (uint32_t i = 1; i + 1 < path.count; i++) {
				const struct dvec3 *a = &path.points[i - 1].at, *b = &path.points[i].at, *c = &path.points[i + 1].at;
				double in = atan2(b->y - a->y, b->x - a->x), out = atan2(c->y - b->y, c->x - b->x);
				sharpest = fmax(sharpest, fabs(remainder(out - in, 2.0 * BLVD_PI)));
			}
			if (abs(degrees) < 140)
				assert_true(sharpest < 0.36);
		}
	}
}

static void random_dirty_streets_stay_continuous(void **state)
{
	(void)state;
	struct rng rng = rng_seed(7);
	for (int round = 0; round < 300; round++) {
		double corners[EDGES + 1][2] = { { 0 } };
		for (int i = 1; i <= EDGES; i++) {
			double angle = rng_range(&rng, -BLVD_PI, BLVD_PI), length = rng_range(&rng, 0.0, round % 2 ? 3.0 : 80.0);
			corners[i][0] = corners[i - 1][0] + length * sin(angle);
			corners[i][1] = corners[i - 1][1] + length * cos(angle);
		}
		struct route_path path;
		start_chain((const double(*)[2])corners, EDGES + 1, round % 3 != 0);
		assert_int_equal(route_path_init(&path, &chain.arena, 0), 0);
		route_path_follow(&path, &chain.pkg, &chain.nav);
		assert_continuous(&path, 100.0);
	}
}

static void the_lane_is_on_the_right_side(void **state)
{
	(void)state;
	const double corners[][2] = { { 0, 0 }, { 0, 100 } };
	for (uint32_t right = 0; right <= 1; right++) {
		struct route_path path;
		start_chain(corners, 2, true);
		chain.meta.right_hand_traffic = right;
		assert_int_equal(route_path_init(&path, &chain.arena, 0), 0);
		route_path_follow(&path, &chain.pkg, &chain.nav);
		assert_true(fabs(path.points[0].at.x - (right ? 2.25 : -2.25)) < 1e-9);
	}
}

/* When the car enters the next edge the line ahead of it must be what it was. */
static void passing_a_junction_does_not_move_the_ribbon(void **state)
{
	(void)state;
	const double corners[][2] = { { 0, 0 }, { 0, 50 }, { 40, 60 }, { 40, 120 }, { 0, 120 } };
	struct route_path path;
	start_chain(corners, 5, true);
	assert_int_equal(route_path_init(&path, &chain.arena, 0), 0);
	route_path_follow(&path, &chain.pkg, &chain.nav);
	struct dvec3 before[20], after;
	for (int i = 0; i < 20; i++)
		before[i] = route_path_at(&path, 52.0 + 4.0 * i, NULL);
	for (uint32_t i = 0; i < 3; i++)
		chain.nav.route[i] = chain.nav.route[i + 1];
	chain.nav.route_count = 3;
	chain.nav.pos_mm[0] = 1500;
	assert_true(route_path_follow(&path, &chain.pkg, &chain.nav));
	struct route_path_half half;
	assert_true(route_path_find(&path, chain.nav.route[0], &half));
	double moved = half.s_start - 50.0; /* the path's start may be elsewhere now */
	for (int i = 0; i < 20; i++) {
		after = route_path_at(&path, 52.0 + 4.0 * i + moved, NULL);
		assert_true(fabs(after.x + 1.5 - (before[i].x)) < 1e-6);
		assert_true(fabs(after.y - (before[i].y)) < 1e-6);
	}
	assert_false(route_path_follow(&path, &chain.pkg, &chain.nav));
}

static void it_ends_at_the_destination(void **state)
{
	(void)state;
	const double corners[][2] = { { 0, 0 }, { 0, 50 }, { 0, 100 } };
	struct route_path path;
	start_chain(corners, 3, false);
	chain.nav.route_complete = true;
	chain.nav.route_end_along_m = 20.0;
	assert_int_equal(route_path_init(&path, &chain.arena, 0), 0);
	route_path_follow(&path, &chain.pkg, &chain.nav);
	assert_true(path.whole);
	assert_true(fabs(path.points[path.count - 1].at.y - (70.0)) < 1e-6);
	chain.nav.along_m = 12.0;
	assert_true(fabs(route_path_car_s(&path, &chain.nav) - (12.0)) < 1e-9);
}

static void hostile_routes_end_early(void **state)
{
	(void)state;
	const double corners[][2] = { { 0, 0 }, { 0, 50 }, { 0, 100 } };
	struct route_path path;
	start_chain(corners, 3, false);
	assert_int_equal(route_path_init(&path, &chain.arena, 16), 0);
	chain.nav.route[1] = 1000000;
	chain.nav.route_count = NAV_ROUTE_AHEAD_MAX + 50;
	assert_true(route_path_follow(&path, &chain.pkg, &chain.nav));
	assert_int_equal(path.half_count, 1);
	chain.nav.route_count = 0;
	assert_true(route_path_follow(&path, &chain.pkg, &chain.nav));
	assert_int_equal(path.count, 0);
	chain.pkg.graph = (struct pkg_graph){ 0 };
	chain.nav.route_count = 2;
	route_path_follow(&path, &chain.pkg, &chain.nav);
	assert_int_equal(path.count, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_turn_is_continuous),
		cmocka_unit_test(random_dirty_streets_stay_continuous),
		cmocka_unit_test(the_lane_is_on_the_right_side),
		cmocka_unit_test(passing_a_junction_does_not_move_the_ribbon),
		cmocka_unit_test(it_ends_at_the_destination),
		cmocka_unit_test(hostile_routes_end_early),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
