/* Buildings get the block around them, and no street runs into a wall. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "graph_check.h"
#include "make_city.h"
#include "tools/city/graph.h"

struct fixture {
	struct report report;
	struct city city;
	struct graph_data graph;
};

static void start(struct fixture *f)
{
	city_start(&f->city, &f->report);
}

static void finish(struct fixture *f)
{
	graph_data_finish(&f->graph);
	city_finish(&f->city);
}

static struct building *box(struct fixture *f, double x0, double y0, double x1, double y1, double height_m)
{
	struct building building = {
		.id = (int64_t)f->city.buildings.count + 1000, .outline = PKG_NONE, .height_m = height_m
	};
	struct ring *ring = &building.footprint.outer;
	ring->points = POOL_ARRAY(&f->city.pool, struct dvec2, 4);
	ring->count = 4;
	ring->points[0] = (struct dvec2){ x0, y0 };
	ring->points[1] = (struct dvec2){ x1, y0 };
	ring->points[2] = (struct dvec2){ x1, y1 };
	ring->points[3] = (struct dvec2){ x0, y1 };
	ARRAY_PUSH(&f->city.buildings, building);
	return &f->city.buildings.items[f->city.buildings.count - 1];
}

static void build(struct fixture *f)
{
	graph_build(&f->city, &f->graph);
	struct pkg_graph view = graph_view(&f->graph);
	assert_int_equal(graph_check(&view), 0);
	blocks_assign(&f->city, &view);
}

static double area_of(const struct fixture *f, size_t building)
{
	return ring_area(&f->city.buildings.items[building].footprint.outer);
}

static void square_of_streets(struct fixture *f, double x0, double y0, double size)
{
	const double ring[][3] = { { 0, x0, y0 }, { 0, x0 + size, y0 }, { 0, x0 + size, y0 + size }, { 0, x0, y0 + size } };
	for (int i = 0; i < 4; i++) {
		const double side[][3] = { { 0, ring[i][1], ring[i][2] }, { 0, ring[(i + 1) % 4][1], ring[(i + 1) % 4][2] } };
		city_street(&f->city, (int64_t)f->city.ways.count + 1, 2, side);
	}
}

static void buildings_lie_in_the_face_around_them(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	square_of_streets(&f, 0, 0, 200);
	square_of_streets(&f, 50, 50, 100); /* an island in the first block */
	box(&f, 20, 20, 30, 30, 10);        /* between both rings */
	box(&f, 90, 90, 110, 110, 10);      /* in the island */
	box(&f, 300, 300, 310, 310, 10);    /* outside */
	build(&f);
	uint32_t outer = f.city.buildings.items[0].face, inner = f.city.buildings.items[1].face;
	assert_int_not_equal(outer, PKG_NONE);
	assert_int_not_equal(inner, PKG_NONE);
	assert_int_not_equal(outer, inner);
	assert_int_equal(f.city.buildings.items[2].face, PKG_NONE);
	assert_true(f.graph.faces.items[inner].area_m2 > 9999.0 && f.graph.faces.items[inner].area_m2 < 10001.0);
	int nested = 0;
	for (size_t i = 0; i < f.graph.faces.count; i++)
		nested += f.graph.faces.items[i].parent == outer;
	assert_int_equal(nested, 1);
	finish(&f);
}

static const double straight[][3] = { { 1, -50, 0 }, { 2, 50, 0 } };

static void a_footprint_in_the_carriageway_is_cut_back(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	city_street(&f.city, 1, 2, straight); /* 6 m wide */
	box(&f, -10, 2, 10, 12, 8);
	build(&f);
	assert_int_equal(f.city.buildings.count, 1);
	assert_true(fabs(area_of(&f, 0) - 180.0) < 0.1);
	assert_int_equal(f.report.faults[FAULT_BUILDING_IN_STREET][FAULT_MENDED], 1);
	finish(&f);
}

static void a_street_through_a_building_leaves_both_sides(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	city_street(&f.city, 1, 2, straight);
	box(&f, -10, -10, 10, 13, 20);
	build(&f);
	assert_int_equal(f.city.buildings.count, 2);
	assert_true(fabs(area_of(&f, 0) + area_of(&f, 1) - (20.0 * 23.0 - 20.0 * 6.0)) < 0.1);
	assert_int_equal(f.report.faults[FAULT_STREET_THROUGH_BUILDING][FAULT_MENDED], 1);
	finish(&f);
}

static void a_passage_becomes_an_arch(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	struct way *lane = city_street(&f.city, 1, 2, straight);
	lane->passage = true;
	lane->width_m = 4.0;
	struct building *house = box(&f, -10, -10, 10, 13, 20);
	house->roof_shape = ROOF_GABLED;
	house->roof_height_m = 4.0;
	house->levels = 5;
	build(&f);
	assert_int_equal(f.city.buildings.count, 3);
	const struct building *above = &f.city.buildings.items[0];
	assert_true(above->min_height_m >= 4.4 && above->min_height_m < 5.0 && above->height_m == 20.0);
	assert_true(above->roof_shape == ROOF_GABLED && fabs(area_of(&f, 0) - 460.0) < 0.1);
	for (size_t i = 1; i < 3; i++) {
		assert_true(f.city.buildings.items[i].height_m == above->min_height_m);
		assert_int_equal(f.city.buildings.items[i].roof_shape, ROOF_FLAT);
	}
	assert_true(fabs(area_of(&f, 1) + area_of(&f, 2) - (460.0 - 80.0)) < 0.1);
	assert_int_equal(f.report.faults[FAULT_STREET_THROUGH_BUILDING][FAULT_MENDED], 0);
	finish(&f);
}

static void a_hut_on_the_street_goes_and_outlines_keep_their_parts(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	city_street(&f.city, 1, 2, straight);
	box(&f, -2, -2, 2, 2, 3);
	box(&f, 20, 20, 40, 40, 10)->has_parts = true;
	struct building *part = box(&f, 20, 20, 30, 40, 15);
	part->is_part = true;
	part->outline = 1;
	build(&f);
	assert_int_equal(f.city.buildings.count, 2);
	assert_true(f.city.buildings.items[0].has_parts);
	assert_int_equal(f.city.buildings.items[1].outline, 0);
	assert_int_equal(f.report.faults[FAULT_STREET_THROUGH_BUILDING][FAULT_DROPPED], 1);
	finish(&f);
}

static void bridges_and_tunnels_pass_buildings(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	const double over[][3] = { { 11, -400, 0 }, { 12, 400, 0 } }, under[][3] = { { 21, -400, 100 }, { 22, 400, 100 } };
	const double below[][3] = { { 31, 0, -300 }, { 32, 0, 300 } };
	city_street(&f.city, 1, 2, over)->bridge = true;
	city_street(&f.city, 2, 2, under)->tunnel = true;
	city_street(&f.city, 3, 2, below);
	box(&f, 20, -5, 40, 5, 3);    /* a kiosk under the bridge, which is 5.6 m up at the crossing street */
	box(&f, 20, 95, 40, 105, 20); /* a house over the tunnel */
	build(&f);
	assert_int_equal(f.city.buildings.count, 2);
	assert_true(area_of(&f, 0) == 200.0 && area_of(&f, 1) == 200.0);
	finish(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(buildings_lie_in_the_face_around_them),
		cmocka_unit_test(a_footprint_in_the_carriageway_is_cut_back),
		cmocka_unit_test(a_street_through_a_building_leaves_both_sides),
		cmocka_unit_test(a_passage_becomes_an_arch),
		cmocka_unit_test(a_hut_on_the_street_goes_and_outlines_keep_their_parts),
		cmocka_unit_test(bridges_and_tunnels_pass_buildings),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
