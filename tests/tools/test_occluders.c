/* Occluders stay well inside of what is solid, join what touches, and leave out what one can see through. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "block_city.h"

/* Is there a building from the ground up to this height here? `building->height_m - roof_height_m` are the eaves. */
static bool solid_at(const struct city *city, struct dvec2 at, double top)
{
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct building *building = &city->buildings.items[i];
		if (building->kind != BUILDING_ROOF && building->min_height_m <= 0.0 &&
			building->height_m - building->roof_height_m >= top && polygon_contains(&building->footprint, at))
			return true;
	}
	return false;
}

static struct dvec2 wall_at(const struct pkg_occluder *wall, double t)
{
	return (struct dvec2){ (wall->from_mm[0] + t * (wall->to_mm[0] - wall->from_mm[0])) * 1e-3,
		(wall->from_mm[1] + t * (wall->to_mm[1] - wall->from_mm[1])) * 1e-3 };
}

static void walls_are_deep_inside_of_solids(void **state)
{
	(void)state;
	for (uint64_t seed = 1; seed <= 3; seed++) {
		struct block_city made;
		block_city_make(&made, seed * 1000);
		assert_true(made.occluders.walls.count > 100);
		for (size_t i = 0; i < made.occluders.walls.count; i++) {
			const struct pkg_occluder *wall = &made.occluders.walls.items[i];
			for (int k = 0; k <= 4; k++)
				for (int turn = 0; turn < 16; turn++) {
					double r = PKG_OCCLUDER_SHRINK_MM * 1e-3 - 0.001, angle = turn * BLVD_PI / 8.0;
					struct dvec2 at = wall_at(wall, k / 4.0);
					/* Beside the millimetres where two houses touch. */
					at = dvec2_add(at, (struct dvec2){ r * cos(angle) + 1e-5, r * sin(angle) + 1e-5 });
					assert_true(solid_at(&made.city, at, wall->top_mm * 1e-3));
				}
		}
		block_city_finish(&made);
	}
}

static void outlines_close_and_are_numbered(void **state)
{
	(void)state;
	struct block_city made;
	block_city_make(&made, 5);
	uint32_t solid = 0;
	const struct pkg_occluder *walls = made.occluders.walls.items;
	for (size_t i = 0, first = 0; i < made.occluders.walls.count; i++) {
		assert_true(walls[i].solid == solid || (i && walls[i].solid == solid + 1));
		if (walls[i].solid != solid)
			assert_int_equal(i, first);
		solid = walls[i].solid;
		if (memcmp(walls[i].to_mm, walls[first].from_mm, sizeof(walls[i].to_mm)) == 0)
			first = i + 1;
		else
			assert_memory_equal(walls[i].to_mm, walls[i + 1].from_mm, sizeof(walls[i].to_mm));
	}
	assert_int_equal(made.occluders.solid_count, solid + 1);
	block_city_finish(&made);
}

static void same_city_same_walls(void **state)
{
	(void)state;
	struct block_city a, b;
	block_city_make(&a, 9);
	block_city_make(&b, 9);
	assert_int_equal(a.occluders.walls.count, b.occluders.walls.count);
	assert_memory_equal(
		a.occluders.walls.items, b.occluders.walls.items, a.occluders.walls.count * sizeof(*a.occluders.walls.items));
	block_city_finish(&a);
	block_city_finish(&b);
}

/* The area of a solid's outlines, m^2. */
static double area_of(const struct occluders *occluders, uint32_t solid)
{
	double twice = 0.0;
	for (size_t i = 0; i < occluders->walls.count; i++) {
		const struct pkg_occluder *wall = &occluders->walls.items[i];
		if (wall->solid == solid)
			twice += dvec2_cross(wall_at(wall, 0.0), wall_at(wall, 1.0));
	}
	return twice / 2.0;
}

static void houses_that_touch_hide_as_one(void **state)
{
	(void)state;
	struct block_city made = { 0 };
	block_city_house(&made.city, (struct dvec2){ 0, 0 }, (struct dvec2){ 10, 12 }, 12.0, 0.0);
	block_city_house(&made.city, (struct dvec2){ 10, 0 }, (struct dvec2){ 10, 12 }, 12.4, 0.0);
	block_city_build(&made);
	assert_int_equal(made.occluders.solid_count, 1);
	double area = area_of(&made.occluders, 0);
	assert_true(area > 14.5 * 6.5 && area <= 16.0 * 8.0);
	assert_true(made.occluders.walls.items[0].top_mm <= 12000 && made.occluders.walls.items[0].top_mm > 11000);
	block_city_finish(&made);
}

static void a_taller_neighbour_hides_more_by_itself(void **state)
{
	(void)state;
	struct block_city made = { 0 };
	block_city_house(&made.city, (struct dvec2){ 0, 0 }, (struct dvec2){ 10, 12 }, 8.0, 0.0);
	block_city_house(&made.city, (struct dvec2){ 10, 0 }, (struct dvec2){ 10, 12 }, 20.0, 0.0);
	block_city_build(&made);
	assert_int_equal(made.occluders.solid_count, 2);
	assert_true(area_of(&made.occluders, 0) < 6.0 * 8.0);
	assert_true(area_of(&made.occluders, 1) > 14.5 * 6.5);
	block_city_finish(&made);
}

static void what_is_open_below_hides_nothing(void **state)
{
	(void)state;
	struct block_city made = { 0 };
	block_city_house(&made.city, (struct dvec2){ 0, 0 }, (struct dvec2){ 12, 12 }, 8.0, 0.0)->kind = BUILDING_ROOF;
	block_city_house(&made.city, (struct dvec2){ 30, 0 }, (struct dvec2){ 12, 12 }, 12.0, 0.0)->min_height_m = 5.0;
	block_city_house(&made.city, (struct dvec2){ 60, 0 }, (struct dvec2){ 12, 12 }, 12.0, 0.0); /* over a tunnel */
	struct way_node nodes[2] = { { .at = { 66, -50 } }, { .at = { 66, 50 } } };
	ARRAY_PUSH(&made.city.ways, (struct way){ .nodes = nodes, .node_count = 2, .tunnel = true, .width_m = 6.0 });
	block_city_house(&made.city, (struct dvec2){ 90, 0 }, (struct dvec2){ 12, 12 }, 12.0, 0.0); /* over water */
	struct dvec2 shore[4] = { { 80, -10 }, { 120, -10 }, { 120, 30 }, { 80, 30 } };
	ARRAY_PUSH(&made.city.areas, (struct area){ .kind = AREA_WATER, .shape = { .outer = { shore, 4 } } });
	block_city_house(&made.city, (struct dvec2){ 150, 0 }, (struct dvec2){ 12, 12 }, 12.0, 0.0); /* over a stream */
	struct dvec2 stream[2] = { { 149, 30 }, { 149, -30 } };
	ARRAY_PUSH(&made.city.lines, (struct line){ .kind = LINE_STREAM, .points = stream, .count = 2, .width_m = 2.0 });
	block_city_build(&made);
	assert_int_equal(made.occluders.walls.count, 0);
	block_city_finish(&made);
}

static void a_house_at_the_shore_hides_as_far_as_it_stands_on_land(void **state)
{
	(void)state;
	struct block_city made = { 0 };
	block_city_house(&made.city, (struct dvec2){ 0, 0 }, (struct dvec2){ 20, 12 }, 12.0, 0.0);
	struct dvec2 shore[4] = { { 10, -10 }, { 40, -10 }, { 40, 30 }, { 10, 30 } };
	ARRAY_PUSH(&made.city.areas, (struct area){ .kind = AREA_WATER, .shape = { .outer = { shore, 4 } } });
	block_city_build(&made);
	assert_int_equal(made.occluders.solid_count, 1);
	double area = area_of(&made.occluders, 0);
	assert_true(area > 5.0 * 7.0 && area <= 6.0 * 8.0);
	block_city_finish(&made);
}

/* A house over an arch is two buildings of one id: what stands beside the arch, and the rest above. */
static void an_arch_leaves_the_house_beside_it_solid(void **state)
{
	(void)state;
	struct block_city made = { 0 };
	block_city_house(&made.city, (struct dvec2){ 0, 0 }, (struct dvec2){ 12, 12 }, 4.5, 0.0)->id = 7;
	struct building *above = block_city_house(&made.city, (struct dvec2){ 0, 0 }, (struct dvec2){ 16, 12 }, 15.0, 0.0);
	above->id = 7;
	above->min_height_m = 4.5;
	block_city_build(&made);
	assert_int_equal(made.occluders.solid_count, 1);
	assert_true(made.occluders.walls.items[0].top_mm > 14000);
	assert_true(area_of(&made.occluders, 0) <= 8.0 * 8.0);
	block_city_finish(&made);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(walls_are_deep_inside_of_solids),
		cmocka_unit_test(outlines_close_and_are_numbered),
		cmocka_unit_test(same_city_same_walls),
		cmocka_unit_test(houses_that_touch_hide_as_one),
		cmocka_unit_test(a_taller_neighbour_hides_more_by_itself),
		cmocka_unit_test(what_is_open_below_hides_nothing),
		cmocka_unit_test(a_house_at_the_shore_hides_as_far_as_it_stands_on_land),
		cmocka_unit_test(an_arch_leaves_the_house_beside_it_solid),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
