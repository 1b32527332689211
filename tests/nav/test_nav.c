/* The navigator as a whole, on streets made by hand: staying on the right street without satellites, strange times,
 * reversing, turning round, leaving the streets, routes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/nav/ride.h"

/* A grid with shaken nodes, one-way streets and curved edges: no two blocks alike. */
static struct streets *town(uint64_t seed)
{
	struct rng rng = rng_seed(seed);
	struct streets *s = streets_new();
	const uint32_t n = 9;
	for (uint32_t i = 0; i < n * n; i++)
		streets_node(
			s, (i % n) * 110.0 + rng_range(&rng, -25, 25), (i - i % n) * (90.0 / n) + rng_range(&rng, -20, 20));
	for (uint32_t i = 0; i < n * n; i++) {
		for (uint32_t k = 0; k < 2; k++) {
			if (k ? i / n + 1 == n : i % n + 1 == n)
				continue;
			uint32_t to = k ? i + n : i + 1;
			double bend[1][2];
			for (int c = 0; c < 2; c++)
				bend[0][c] = (s->nodes[i].pos_mm[c] + s->nodes[to].pos_mm[c]) * 0.5e-3 + rng_range(&rng, -9, 9);
			struct pkg_edge *edge = streets_edge(s, i, to, NO_NAME, rng_u32(&rng) % 2, bend);
			if (rng_u32(&rng) % 5 == 0)
				streets_oneway(edge);
		}
	}
	return s;
}

static void the_car_stays_on_its_streets_without_satellites(void **state)
{
	(void)state;
	static const struct {
		double speed_error, yaw_bias, yaw_noise, wrong_share;
	} table[] = {
		{ 0.0, 0.0, 0.0, 0.01 },
		{ 0.01, 0.003, 0.005, 0.025 },
		{ -0.015, -0.006, 0.01, 0.025 },
	};
	for (uint64_t seed = 1; seed <= 6; seed++) {
		for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
			struct ride ride;
			ride_start(&ride, town(seed), seed % 3 != 0);
			ride.speed_error = table[i].speed_error;
			ride.yaw_bias = table[i].yaw_bias;
			ride.yaw_noise = table[i].yaw_noise;
			ride_wander(&ride, 2 * (uint32_t)seed, 60);
			ride.at_m = 20.0;
			assert_true(nav_set_start_half(&ride.nav, ride.halves[0], 20.0));
			ride_stand(&ride, 5.0);
			ride_drive(&ride, 2000.0, 10.0);
			assert_true(ride.wrong_m <= table[i].wrong_share * ride.driven_m + 5.0);
			assert_true(ride.wrong_run_m < 25.0); /* at a junction, until the turn has told which way */
			assert_true(ride_right(&ride));

			assert_true(ride.nav.match.on_street);
			ride_end(&ride);
		}
	}
}

static void the_same_ride_gives_the_same_views(void **state)
{
	(void)state;
	struct nav_view views[2];
	for (int k = 0; k < 2; k++) {
		struct ride ride;
		ride_start(&ride, town(3), true);
		ride.yaw_noise = 0.01;
		ride_wander(&ride, 10, 40);
		nav_set_start_half(&ride.nav, ride.halves[0], 20.0);
		ride_drive(&ride, 1500.0, 12.0);
		memset(&views[k], 0, sizeof(views[k]));
		nav_snapshot(&ride.nav, &views[k]);
		ride_end(&ride);
	}
	assert_memory_equal(&views[0], &views[1], sizeof(views[0]));
}

static void an_hour_at_the_kerb_moves_nothing(void **state)
{
	(void)state;
	struct ride ride;
	struct nav_view before = { 0 }, after = { 0 };
	ride_start(&ride, town(2), true);
	ride.yaw_bias = 0.004;
	ride.yaw_noise = 0.01;
	ride_wander(&ride, 8, 30);
	nav_set_start_half(&ride.nav, ride.halves[0], 10.0);
	ride.at_m = 10.0;
	ride_drive(&ride, 400.0, 9.0);
	ride_stand(&ride, 1.0);
	nav_snapshot(&ride.nav, &before);
	ride_stand(&ride, 3600.0);
	nav_snapshot(&ride.nav, &after);
	assert_memory_equal(before.pos_mm, after.pos_mm, sizeof(before.pos_mm));
	assert_int_equal(before.heading_bam, after.heading_bam);
	assert_int_equal(before.half, after.half);
	assert_near(before.along_m, after.along_m, 0.0);
	ride_drive(&ride, 800.0, 9.0);
	assert_true(ride_right(&ride));
	ride_end(&ride);
}

static void strange_times_do_no_harm(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, town(4), true);
	ride_wander(&ride, 14, 60);
	nav_set_start_half(&ride.nav, ride.halves[0], 10.0);
	ride.at_m = 10.0;
	ride_drive(&ride, 300.0, 8.0);
	for (int i = 0; i < 50; i++)
		nav_advance(&ride.nav, &ride.input, ride.now_ns); /* time stands */
	ride.now_ns -= 5 * NS_PER_S;                          /* the clock steps back */
	ride_drive(&ride, 300.0, 8.0);
	assert_true(ride_right(&ride));
	assert_int_equal(ride.nav.reckon.steps_back, 1);
	/* ten seconds without a word while the car goes straight on within one street or two */
	ride.at_m += 80.0;
	ride.now_ns += 10 * NS_PER_S - RIDE_STEP_NS;
	ride_drive(&ride, 900.0, 8.0);
	assert_true(ride_right(&ride));
	/* a gap of a day is no drive of a day */
	ride.now_ns += 86400 * NS_PER_S;
	ride_stand(&ride, 1.0);
	assert_true(ride.nav.reckon.travelled_m < 2500.0);
	ride_end(&ride);
}

static void backing_up_goes_back_along_the_street(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, streets_grid(5, 100), true);
	ride.halves[0] = streets_half(ride.streets, 6, 7);
	ride.halves[1] = streets_half(ride.streets, 7, 12);
	ride.count = 2;
	ride.at_m = 20.0;
	nav_set_start_half(&ride.nav, ride.halves[0], 20.0);
	ride_drive(&ride, 110.0, 5.0);
	assert_int_equal(ride.nav.match.half, ride.halves[1]);
	ride_drive(&ride, -20.0, -2.0);
	assert_int_equal(ride.nav.match.half, ride.halves[1]);
	assert_near(ride.nav.match.along_m, 10.0, 5.0);
	ride_drive(&ride, -60.0, -2.0); /* backwards round the corner */
	assert_int_equal(ride.nav.match.half, ride.halves[0]);
	assert_near(ride.nav.match.along_m, 50.0, 6.0);
	ride_drive(&ride, 100.0, 5.0);
	assert_true(ride_right(&ride));
	ride_end(&ride);
}

static void turning_round_in_the_street_changes_direction(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, streets_grid(4, 200), true);
	uint32_t half = streets_half(ride.streets, 5, 6);
	nav_set_start_half(&ride.nav, half, 50.0);
	ride_free(&ride, 5.0, 10.0, 0.0);
	ride_free(&ride, 4.0, 4.0, BLVD_PI / 4.0); /* half a circle of 5 m radius */
	ride_free(&ride, 4.0, 10.0, 0.0);
	assert_int_equal(ride.nav.match.half, graph_twin(half));
	assert_near(ride.nav.match.along_m, 200.0 - 100.0 + 40.0, 12.0);
	assert_true(ride.nav.match.on_street);
	ride_end(&ride);
}

static void car_parks_are_off_the_street_and_one_comes_back(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, streets_grid(3, 400), true);
	uint32_t half = streets_half(ride.streets, 0, 1);
	nav_set_start_half(&ride.nav, half, 50.0);
	ride_free(&ride, 10.0, 10.0, 0.0);          /* east to 150 */
	ride_free(&ride, 3.2, 5.0, -BLVD_PI / 6.4); /* left, off the street */
	ride_free(&ride, 9.0, 10.0, 0.0);           /* north across the block */
	ride_free(&ride, 12.8, 5.0, BLVD_PI / 6.4); /* a circle */
	struct nav_view view = { 0 };
	nav_snapshot(&ride.nav, &view);
	assert_true(view.located);
	assert_false(view.on_street);
	assert_int_equal(view.limit_kmh, 0);
	assert_near((double)view.pos_mm[0] * 1e-3, 160.0, 25.0);
	assert_near((double)view.pos_mm[1] * 1e-3, 105.0, 25.0);
	ride_free(&ride, 6.4, 5.0, -BLVD_PI / 6.4); /* west, south */
	ride_free(&ride, 7.0, 10.0, 0.0);
	ride_free(&ride, 3.2, 5.0, -BLVD_PI / 6.4); /* east, on the street again */
	ride_free(&ride, 15.0, 10.0, 0.0);
	nav_snapshot(&ride.nav, &view);
	assert_true(view.on_street);
	assert_int_equal(view.half, half);
	ride_end(&ride);
}

static struct geo_point geo_at(const struct ride *ride, double east, double north)
{
	return geo_from_plane(&ride->nav.pkg->frame, (struct dvec2){ east, north });
}

static void a_fix_finds_the_start(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, streets_grid(4, 150), true);
	struct nav_view view = { 0 };
	ride_stand(&ride, 1.0);
	nav_snapshot(&ride.nav, &view);
	assert_false(view.located);
	struct geo_point at = geo_at(&ride, 70.0, 148.0);
	ride.input.fix_valid = true;
	ride.input.lat_deg = NAN;
	ride_stand(&ride, 1.0);
	assert_false(ride.nav.match.located);
	ride.input.fix_number = 1;
	ride.input.lat_deg = at.lat_deg;
	ride.input.lon_deg = at.lon_deg;
	ride.input.heading_valid = true;
	ride.input.heading_rad = BLVD_PI / 2.0;
	ride_stand(&ride, 1.0);
	nav_snapshot(&ride.nav, &view);
	assert_true(view.located && view.on_street);
	assert_int_equal(view.half, streets_half(ride.streets, 4, 5));
	assert_near(view.along_m, 70.0, 4.0);
	assert_near(bam_to_rad(view.heading_bam), BLVD_PI / 2.0, 0.05);
	ride_end(&ride);
}

static void without_a_heading_the_first_corner_tells_the_direction(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, town(5), true);
	ride_wander(&ride, 30, 20);
	ride.at_m = 30.0;
	struct dvec2 at = ride_point(&ride, 30.0);
	struct geo_point geo = geo_at(&ride, at.x, at.y);
	ride.input.fix_valid = true;
	ride.input.lat_deg = geo.lat_deg;
	ride.input.lon_deg = geo.lon_deg;
	ride_stand(&ride, 1.0);
	ride_drive(&ride, 900.0, 8.0);
	assert_true(ride_right(&ride));
	ride_end(&ride);
}

static void fixes_correct_a_bad_speedometer(void **state)
{
	(void)state;
	for (int with = 0; with < 2; with++) {
		struct ride ride;
		ride_start(&ride, streets_grid(3, 3000), true);
		ride.speed_error = 0.04;
		ride.halves[0] = streets_half(ride.streets, 0, 1);
		ride.count = 1;
		ride.at_m = 20.0;
		nav_set_start_half(&ride.nav, ride.halves[0], 20.0);
		for (int i = 0; i < 100; i++) {
			ride_drive(&ride, 25.0, 15.0);
			struct dvec2 at = ride_point(&ride, ride.at_m);
			struct geo_point geo =
				geo_at(&ride, at.x + rng_range(&ride.rng, -4, 4), at.y + rng_range(&ride.rng, -4, 4));
			ride.input.fix_valid = with;
			ride.input.fix_number++;
			ride.input.lat_deg = geo.lat_deg;
			ride.input.lon_deg = geo.lon_deg;
		}
		double error = fabs(ride.nav.match.along_m - ride.at_m);
		assert_true(with ? error < 12.0 : error > 20.0);
		ride_end(&ride);
	}
}

/* --- routes --- */

static void routes_are_followed_and_end(void **state)
{
	(void)state;
	struct ride ride;
	struct nav_view view = { 0 };
	ride_start(&ride, town(6), true);
	nav_set_start_half(&ride.nav, 4, 20.0);
	struct geo_point stops[2] = { geo_at(&ride, 400, 300), geo_at(&ride, 700, 600) };
	assert_true(nav_set_stops(&ride.nav, stops, 2));
	ride_stand(&ride, 1.0);
	nav_snapshot(&ride.nav, &view);
	assert_true(view.routed && !view.off_route && view.route_complete);
	assert_int_equal(view.route[0], 4);
	assert_true(view.remaining_m > 500.0 && view.remaining_s > 50.0);
	memcpy(ride.halves, ride.nav.route.halves, ride.nav.route.count * sizeof(uint32_t));
	ride.count = ride.nav.route.count;
	ride.at_m = 20.0;
	double total = view.remaining_m, last = total;
	while (last > 30.0) {
		ride_drive(&ride, 20.0, 9.0);
		nav_snapshot(&ride.nav, &view);
		assert_true(view.routed && !view.off_route);
		assert_int_equal(view.route[0], view.half);
		assert_true(view.remaining_m < last + 6.0); /* it may be corrected a little */
		assert_true(view.next.manoeuvre != NAV_MANOEUVRE_NONE);
		last = view.remaining_m;
	}
	assert_int_equal(view.next.manoeuvre, NAV_MANOEUVRE_ARRIVE);
	ride_drive(&ride, last, 5.0);
	ride_stand(&ride, 2.0);
	nav_snapshot(&ride.nav, &view);
	assert_false(view.routed);
	assert_int_equal(view.reroutes, 0);
	ride_end(&ride);
}

static void leaving_the_route_finds_another(void **state)
{
	(void)state;
	struct ride ride;
	struct nav_view view = { 0 };
	ride_start(&ride, streets_grid(8, 120), true);
	nav_set_start_half(&ride.nav, streets_half(ride.streets, 0, 1), 20.0);
	nav_set_destination_half(&ride.nav, streets_half(ride.streets, 6, 7), 60.0); /* straight on, in the same street */
	ride_stand(&ride, 1.0);
	assert_true(ride.nav.routed);
	uint32_t way[] = { 0, 1, 9, 17, 18, 19, 20 };
	for (uint32_t i = 0; i + 1 < 7; i++)
		ride.halves[ride.count++] = streets_half(ride.streets, way[i], way[i + 1]);
	ride.at_m = 20.0;
	for (int i = 0; i < 60; i++) {
		ride_drive(&ride, 9.0, 9.0);
		nav_snapshot(&ride.nav, &view);
		assert_true(view.routed);
	}
	assert_true(view.reroutes >= 1 && view.reroutes <= 3);
	assert_false(view.off_route);
	assert_int_equal(view.route[0], view.half);
	ride_end(&ride);
}

static void places_without_streets_and_without_a_way_are_refused(void **state)
{
	(void)state;
	struct streets *s = streets_grid(3, 100);
	uint32_t a = streets_node(s, 5000, 0), b = streets_node(s, 5100, 0);
	streets_edge(s, a, b, NO_NAME, 0, NULL);
	struct ride ride;
	struct nav_view view = { 0 };
	ride_start(&ride, s, true);
	struct geo_point far = geo_at(&ride, -9000, 0);
	assert_false(nav_set_start(&ride.nav, far.lat_deg, far.lon_deg, NAN));
	assert_false(nav_set_destination(&ride.nav, far.lat_deg, far.lon_deg));
	assert_false(nav_set_start_half(&ride.nav, 100000, 0));
	assert_false(nav_set_destination_half(&ride.nav, 0, NAN));
	nav_set_start_half(&ride.nav, 0, 10);
	struct geo_point island = geo_at(&ride, 5050, 0);
	assert_true(nav_set_destination(&ride.nav, island.lat_deg, island.lon_deg));
	ride_free(&ride, 5.0, 5.0, 0.0);
	nav_snapshot(&ride.nav, &view);
	assert_false(view.routed);
	assert_int_equal(view.route_count, 0);
	nav_clear_destination(&ride.nav);
	nav_snapshot(&ride.nav, &view);
	assert_false(view.off_route);
	ride_end(&ride);
}

static void streets_above_one_another_are_told_apart(void **state)
{
	(void)state;
	struct streets *s = streets_grid(5, 100);
	/* a viaduct along the second row, two metres beside it, reached from the west */
	uint32_t up = streets_node(s, -200, 102), down = streets_node(s, 700, 102);
	struct pkg_edge *deck = streets_edge(s, up, down, ALPHA, 0, NULL);
	deck->flags |= PKG_EDGE_BRIDGE | PKG_EDGE_OFF_PLANE;
	deck->street_class = PKG_STREET_TRUNK;
	struct ride ride;
	ride_start(&ride, s, true);
	for (uint32_t i = 5; i < 9; i++)
		ride.halves[ride.count++] = streets_half(s, i, i + 1);
	ride.halves[ride.count++] = streets_half(s, 9, 14);
	ride.at_m = 10.0;
	struct geo_point at = geo_at(&ride, 10, 98.5);
	assert_true(nav_set_start(&ride.nav, at.lat_deg, at.lon_deg, 90.0));
	ride_drive(&ride, 450.0, 10.0);
	assert_near(ride.wrong_m, 0.0, 0.0);
	assert_int_equal(ride.nav.match.half, ride.halves[4]);
	ride_end(&ride);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_car_stays_on_its_streets_without_satellites),
		cmocka_unit_test(the_same_ride_gives_the_same_views),
		cmocka_unit_test(an_hour_at_the_kerb_moves_nothing),
		cmocka_unit_test(strange_times_do_no_harm),
		cmocka_unit_test(backing_up_goes_back_along_the_street),
		cmocka_unit_test(turning_round_in_the_street_changes_direction),
		cmocka_unit_test(car_parks_are_off_the_street_and_one_comes_back),
		cmocka_unit_test(a_fix_finds_the_start),
		cmocka_unit_test(without_a_heading_the_first_corner_tells_the_direction),
		cmocka_unit_test(fixes_correct_a_bad_speedometer),
		cmocka_unit_test(routes_are_followed_and_end),
		cmocka_unit_test(leaving_the_route_finds_another),
		cmocka_unit_test(places_without_streets_and_without_a_way_are_refused),
		cmocka_unit_test(streets_above_one_another_are_told_apart),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
