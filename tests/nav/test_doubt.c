/* How well the place is known: it drifts where nothing confirms it, is found again, and outlives the program. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/nav/ride.h"

static struct nav_view view_of(struct ride *ride)
{
	struct nav_view view = { 0 };
	nav_snapshot(&ride->nav, &view);
	return view;
}

static void tell_fix(struct ride *ride, double east, double north, double sigma_m)
{
	struct geo_point geo = geo_from_plane(&ride->nav.pkg->frame, (struct dvec2){ east, north });
	ride->input.fix_valid = true;
	ride->input.fix_number++;
	ride->input.lat_deg = geo.lat_deg;
	ride->input.lon_deg = geo.lon_deg;
	ride->input.fix_sigma_m = sigma_m;
}

/* One street without a bend or a corner, as in a long tunnel. */
static struct streets *long_street(double length_m)
{
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 0.0, 0.0), b = streets_node(s, length_m, 0.0);
	streets_edge(s, a, b, ALPHA, 0, NULL);
	uint32_t c = streets_node(s, length_m, 400.0);
	streets_edge(s, b, c, BETA, 0, NULL);
	return s;
}

static void a_tunnel_spreads_the_place_along_the_street_and_a_corner_ends_it(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, long_street(3000.0), true);
	nav_set_start_half(&ride.nav, 0, 20.0);
	ride.halves[0] = 0;
	ride.halves[1] = 2;
	ride.count = 2;
	ride.at_m = 20.0;
	ride_drive(&ride, 300.0, 20.0);
	struct nav_view view = view_of(&ride);
	assert_int_equal(view.doubt.place, NAV_PLACE_SURE);
	assert_true(view.doubt.age_ns == 0);
	double before = view.doubt.major_m;
	ride_drive(&ride, 2600.0, 20.0);
	view = view_of(&ride);
	assert_int_equal(view.doubt.place, NAV_PLACE_DRIFTING);
	assert_true(view.doubt.major_m > 3.0 * before && view.doubt.minor_m < 3.0);
	assert_near(fabs(sin(bam_to_rad(view.doubt.heading_bam))), 1.0, 0.05); /* along the street: east */
	assert_true(view.doubt.age_ns > 10 * NS_PER_S && view.doubt.age_ns < 140 * NS_PER_S);
	ride_drive(&ride, 300.0, 8.0); /* round the corner */
	view = view_of(&ride);
	assert_int_equal(view.doubt.place, NAV_PLACE_SURE);
	ride_end(&ride);
}

static void a_fix_ends_a_tunnels_drift(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, long_street(4000.0), true);
	nav_set_start_half(&ride.nav, 0, 20.0);
	ride.halves[0] = 0;
	ride.count = 1;
	ride.at_m = 20.0;
	ride.speed_error = 0.02; /* the wheels say 2 % more than it goes: 60 m after 3 km */
	ride_drive(&ride, 3000.0, 20.0);
	assert_int_equal(view_of(&ride).doubt.place, NAV_PLACE_DRIFTING);
	for (int i = 0; i < 40; i++) {
		struct dvec2 at = ride_point(&ride, ride.at_m);
		tell_fix(&ride, at.x, at.y - 1.75, 3.0);
		ride_drive(&ride, 4.0, 20.0);
	}
	struct nav_view view = view_of(&ride);
	assert_int_equal(view.doubt.place, NAV_PLACE_SURE);
	assert_near((double)view.pos_mm[0] * 1e-3, ride.at_m, 12.0);
	ride_end(&ride);
}

/* Round and round between the floors of a car park, with a gyroscope that is a little off. */
static void a_car_park_spreads_it_in_all_directions_and_fixes_end_it(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, streets_grid(3, 600), true);
	nav_set_start_half(&ride.nav, streets_half(ride.streets, 0, 1), 50.0);
	ride_free(&ride, 10.0, 10.0, 0.0);
	ride_free(&ride, 3.2, 5.0, -BLVD_PI / 6.4); /* off the street, north */
	ride_free(&ride, 9.0, 10.0, 0.0);
	ride.yaw_bias = 0.015;
	for (int i = 0; i < 12; i++) {
		ride_free(&ride, 12.0, 4.0, 0.0);
		ride_free(&ride, 4.0, 4.0, BLVD_PI / 8.0);
	}
	struct nav_view view = view_of(&ride);
	assert_false(view.on_street);
	assert_int_equal(view.doubt.place, NAV_PLACE_DRIFTING);
	assert_true(view.doubt.major_m > 15.0 && view.doubt.minor_m > 5.0);
	ride.yaw_bias = 0.0;
	for (int i = 0; i < 30; i++) { /* the receiver says it is 30 m to the east of there, going where it goes */
		tell_fix(&ride, (double)view.pos_mm[0] * 1e-3 + 30.0, (double)view.pos_mm[1] * 1e-3 + 0.0, 4.0);
		ride_free(&ride, 0.2, 0.3, 0.0);
	}
	struct nav_view later = view_of(&ride);
	assert_int_equal(later.doubt.place, NAV_PLACE_SURE);
	assert_true(later.doubt.major_m < 8.0);
	assert_near((double)(later.pos_mm[0] - view.pos_mm[0]) * 1e-3, 30.0, 5.0);
	ride_end(&ride);
}

static void a_silent_bus_may_hide_a_long_way(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, long_street(4000.0), true);
	nav_set_start_half(&ride.nav, 0, 20.0);
	ride.halves[0] = 0;
	ride.count = 1;
	ride.at_m = 20.0;
	ride_drive(&ride, 200.0, 15.0);
	ride.input.motion.speed_valid = ride.input.motion.yaw_valid = false;
	ride_free(&ride, 20.0, 0.0, 0.0); /* it went 300 m, but nobody said so */
	struct nav_view view = view_of(&ride);
	assert_int_equal(view.doubt.place, NAV_PLACE_DRIFTING);
	assert_near(view.doubt.major_m, 300.0, 30.0);
	ride.input.motion.speed_valid = ride.input.motion.yaw_valid = true;
	ride.at_m += 300.0;
	ride_drive(&ride, 20.0, 15.0);
	view = view_of(&ride);
	assert_int_equal(view.doubt.place, NAV_PLACE_DRIFTING); /* and is not sure when the bus comes back */
	assert_true(view.doubt.major_m > 50.0);
	for (int i = 0; i < 30; i++) {
		struct dvec2 at = ride_point(&ride, ride.at_m);
		tell_fix(&ride, at.x, at.y - 1.75, 3.0);
		ride_drive(&ride, 4.0, 15.0);
	}
	view = view_of(&ride);
	assert_int_equal(view.doubt.place, NAV_PLACE_SURE);
	assert_near((double)view.pos_mm[0] * 1e-3, ride.at_m, 12.0);
	ride_end(&ride);
}

/* A new program, on the same streets or on others. */
static void begin_again(struct ride *next, struct streets *streets)
{
	ride_start(next, streets, true);
}

static void the_next_run_goes_on_where_the_last_one_was(void **state)
{
	(void)state;
	struct ride ride, next;
	struct nav_memory memory = { 0 };
	ride_start(&ride, streets_grid(4, 200), true);
	assert_false(nav_remember(&ride.nav, &memory)); /* nothing to keep yet */
	nav_set_start_half(&ride.nav, streets_half(ride.streets, 0, 1), 30.0);
	ride_free(&ride, 5.0, 10.0, 0.0);
	ride_stand(&ride, 5.0);
	struct nav_view was = view_of(&ride);
	assert_true(nav_remember(&ride.nav, &memory));

	begin_again(&next, streets_grid(4, 200));
	assert_true(nav_restore(&next.nav, &memory, true));
	struct nav_view now = view_of(&next);
	assert_true(now.located && now.on_street);
	assert_int_equal(now.half, was.half);
	assert_int_equal(now.doubt.place, NAV_PLACE_REMEMBERED);
	for (int axis = 0; axis < 2; axis++)
		assert_true(llabs(now.pos_mm[axis] - was.pos_mm[axis]) <= 1);
	assert_true(abs(bam_diff(now.heading_bam, was.heading_bam)) < 1000);
	assert_near(now.doubt.major_m, was.doubt.major_m, 0.5);
	assert_true(next.nav.reckon.bias_var < 0.01 * 0.01); /* what standing taught */
	ride_free(&next, 30.0, 10.0, 0.0);                   /* and a street that fits confirms it */
	assert_int_equal(view_of(&next).doubt.place, NAV_PLACE_SURE);
	ride_end(&next);

	begin_again(&next, streets_grid(5, 200)); /* the map was made anew meanwhile: half-edges have other numbers */
	memory.half = 3;
	assert_true(nav_restore(&next.nav, &memory, false));
	now = view_of(&next);
	assert_true(now.on_street);
	for (int axis = 0; axis < 2; axis++)
		assert_true(llabs(now.pos_mm[axis] - was.pos_mm[axis]) <= 1);
	ride_end(&next);
	ride_end(&ride);
}

static void a_car_left_off_the_streets_is_found_there(void **state)
{
	(void)state;
	struct ride ride, next;
	struct nav_memory memory = { 0 };
	ride_start(&ride, streets_grid(3, 600), true);
	nav_set_start_half(&ride.nav, streets_half(ride.streets, 0, 1), 50.0);
	ride_free(&ride, 10.0, 10.0, 0.0);
	ride_free(&ride, 3.2, 5.0, -BLVD_PI / 6.4);
	ride_free(&ride, 20.0, 10.0, 0.0);
	ride_free(&ride, 12.8, 5.0, BLVD_PI / 6.4);
	struct nav_view was = view_of(&ride);
	assert_false(was.on_street);
	assert_true(nav_remember(&ride.nav, &memory));
	begin_again(&next, streets_grid(3, 600));
	assert_true(nav_restore(&next.nav, &memory, true));
	struct nav_view now = view_of(&next);
	assert_true(now.located && !now.on_street);
	assert_true(llabs(now.pos_mm[0] - was.pos_mm[0]) <= 1 && llabs(now.pos_mm[1] - was.pos_mm[1]) <= 1);
	assert_near(now.doubt.major_m, was.doubt.major_m, 0.1);
	ride_end(&next);
	ride_end(&ride);
}

static void another_city_or_nonsense_is_not_restored(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, streets_grid(3, 200), true);
	const struct geo_point origin = ride.nav.pkg->frame.origin;
	const struct nav_memory good = { .lat_deg = origin.lat_deg, .lon_deg = origin.lon_deg, .speed_scale = 1.0 };
	static const struct {
		size_t field;
		double value;
	} cases[] = {
		{ offsetof(struct nav_memory, lat_deg), 47.3 },
		{ offsetof(struct nav_memory, lat_deg), NAN },
		{ offsetof(struct nav_memory, lon_deg), INFINITY },
		{ offsetof(struct nav_memory, lon_deg), 170.0 },
		{ offsetof(struct nav_memory, heading_rad), NAN },
		{ offsetof(struct nav_memory, height_m), 1e9 },
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct nav_memory memory = good;
		memcpy((char *)&memory + cases[i].field, &cases[i].value, sizeof(double));
		assert_false(nav_restore(&ride.nav, &memory, true));
		assert_false(view_of(&ride).located);
	}
	struct nav_memory memory = good;
	memory.speed_scale = NAN;
	memory.bias_var = -1.0;
	memory.position_var[2] = 1e9;
	memory.half = 77777;
	memory.along_m = NAN;
	memory.on_street = true;
	assert_true(nav_restore(&ride.nav, &memory, true)); /* the place itself is one */
	assert_true(isfinite(view_of(&ride).doubt.major_m));
	ride_end(&ride);
}

/* The last run ended there, on a street, looking east; known to 3 m. */
static void remember_eastwards(struct ride *ride, double east, double north)
{
	struct geo_point geo = geo_from_plane(&ride->nav.pkg->frame, (struct dvec2){ east, north });
	struct nav_memory memory = { .lat_deg = geo.lat_deg,
		.lon_deg = geo.lon_deg,
		.heading_rad = 0.5 * BLVD_PI,
		.on_street = true,
		.half = PKG_NONE,
		.speed_scale = 1.0,
		.position_var = { 9.0, 9.0, 0.0 } };
	assert_true(nav_restore(&ride->nav, &memory, false));
}

static void a_fix_elsewhere_refutes_a_remembered_place_even_standing(void **state)
{
	(void)state;
	struct ride ride;
	ride_start(&ride, streets_grid(4, 400), true);
	remember_eastwards(&ride, 100.0, 0.0);
	ride_stand(&ride, 1.0);
	assert_near((double)view_of(&ride).pos_mm[0] * 1e-3, 100.0, 0.1);
	tell_fix(&ride, 600.0, 402.0, 4.0); /* it was towed */
	ride_stand(&ride, 1.0);
	struct nav_view view = view_of(&ride);
	assert_near((double)view.pos_mm[0] * 1e-3, 600.0, 10.0);
	assert_near((double)view.pos_mm[1] * 1e-3, 400.0, 10.0);
	assert_int_equal(view.doubt.place, NAV_PLACE_SURE);
	ride_end(&ride);
}

/* Killed on the way, and round the corner since: nothing counted the way there. */
static void a_course_tells_where_a_car_that_is_elsewhere_looks(void **state)
{
	(void)state;
	for (int late = 0; late < 2; late++) {
		struct ride ride;
		ride_start(&ride, streets_grid(4, 400), true);
		remember_eastwards(&ride, 300.0, 398.0);
		ride.input.heading_valid = !late;
		ride.input.heading_rad = 0.0;
		tell_fix(&ride, 402.0, 420.0, 4.0);
		ride_stand(&ride, 1.0);
		ride.input.heading_valid = true;
		tell_fix(&ride, 402.0, 420.0, 4.0);
		ride_stand(&ride, 1.0);
		struct nav_view view = view_of(&ride);
		assert_near((double)view.pos_mm[0] * 1e-3, 402.0, 4.0);
		assert_near((double)view.pos_mm[1] * 1e-3, 420.0, 10.0);
		assert_near(bam_to_rad(view.heading_bam), 0.0, 0.1);
		ride_end(&ride);
	}
}

static void kilometres_driven_unseen_make_a_remembered_place_doubtful(void **state)
{
	(void)state;
	struct ride ride;
	struct nav_memory memory;
	ride_start(&ride, streets_grid(4, 400), true);
	nav_set_start_half(&ride.nav, streets_half(ride.streets, 0, 1), 30.0);
	assert_true(nav_remember(&ride.nav, &memory));
	assert_true(nav_restore(&ride.nav, &memory, true));
	nav_moved_unseen(&ride.nav, 400.0);
	struct nav_view view = view_of(&ride);
	assert_true(view.doubt.major_m > 300.0);
	nav_moved_unseen(&ride.nav, NAN);
	nav_moved_unseen(&ride.nav, 1e12);
	assert_true(view_of(&ride).doubt.major_m < 6000.0);
	ride_end(&ride);
}

/* Killed on a street, started again after a corner: a fix shows the car on the new street, looking along it. */
static void after_a_corner_driven_unseen_the_car_looks_along_its_new_street(void **state)
{
	static const struct {
		double speed_mps, driven_m; /* after the fix */
	} cases[] = { { 0.0, 0.0 }, { 2.0, 5.0 }, { 10.0, 8.0 } };
	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct ride ride, next;
		struct nav_memory memory;
		ride_start(&ride, streets_grid(4, 200), true);
		nav_set_start_half(&ride.nav, streets_half(ride.streets, 0, 1), 150.0); /* eastwards */
		assert_true(nav_remember(&ride.nav, &memory));
		begin_again(&next, streets_grid(4, 200));
		assert_true(nav_restore(&next.nav, &memory, true));
		nav_moved_unseen(&next.nav, 130.0); /* 50 m to the corner, 80 m northwards */
		next.halves[0] = streets_half(next.streets, 1, 5);
		next.count = 1;
		next.at_m = 80.0;
		ride_stand(&next, 0.5);
		tell_fix(&next, 203.0, 81.0, 4.0);
		ride_stand(&next, 0.5);
		if (cases[i].driven_m > 0.0)
			ride_drive(&next, cases[i].driven_m, cases[i].speed_mps);
		struct nav_view view = view_of(&next);
		assert_int_equal(view.half, next.halves[0]);
		assert_near(bam_to_rad(view.heading_bam), 0.0, 0.15);
		assert_near((double)view.pos_mm[0] * 1e-3, 200.0, 6.0);
		assert_near((double)view.pos_mm[1] * 1e-3, 80.0 + cases[i].driven_m, 15.0);
		ride_end(&next);
		ride_end(&ride);
	}
}

/* Nothing but a course tells that the car has turned round meanwhile, or is in the middle of a corner. */
static void a_course_after_a_way_driven_unseen_is_believed(void **state)
{
	static const struct {
		uint32_t from, to;
		double at_m, heading_rad;
	} cases[] = { { 1, 0, 90.0, -0.5 * BLVD_PI }, { 1, 5, 80.0, 0.0 }, { 1, 2, 60.0, 0.5 * BLVD_PI } };
	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct ride ride;
		struct nav_memory memory;
		ride_start(&ride, streets_grid(4, 200), true);
		nav_set_start_half(&ride.nav, streets_half(ride.streets, 0, 1), 150.0); /* eastwards */
		assert_true(nav_remember(&ride.nav, &memory));
		assert_true(nav_restore(&ride.nav, &memory, true));
		nav_moved_unseen(&ride.nav, 140.0);
		ride.halves[0] = streets_half(ride.streets, cases[i].from, cases[i].to);
		ride.count = 1;
		ride.at_m = cases[i].at_m;
		struct dvec2 at = ride_point(&ride, ride.at_m);
		ride.input.heading_valid = true;
		ride.input.heading_rad = cases[i].heading_rad;
		tell_fix(&ride, at.x + 2.0, at.y - 2.0, 4.0);
		ride_drive(&ride, 30.0, 10.0);
		struct nav_view view = view_of(&ride);
		at = ride_point(&ride, ride.at_m);
		assert_int_equal(view.half, ride.halves[0]);
		assert_near(remainder(bam_to_rad(view.heading_bam) - cases[i].heading_rad, 2.0 * BLVD_PI), 0.0, 0.1);
		assert_near(hypot((double)view.pos_mm[0] * 1e-3 - at.x, (double)view.pos_mm[1] * 1e-3 - at.y), 0.0, 8.0);
		ride_end(&ride);
	}
}

/* Without a satellite too: when the shown place jumps to where the matching says, the heading does. */
static void a_place_that_jumps_looks_along_its_street(void **state)
{
	(void)state;
	struct ride ride;
	struct nav_memory memory;
	ride_start(&ride, long_street(200.0), true);
	nav_set_start_half(&ride.nav, 0, 190.0); /* eastwards, 10 m to the only corner */
	assert_true(nav_remember(&ride.nav, &memory));
	assert_true(nav_restore(&ride.nav, &memory, true));
	nav_moved_unseen(&ride.nav, 250.0);
	ride.halves[0] = 2;
	ride.count = 1;
	ride.at_m = 130.0;
	ride_drive(&ride, 1.0, 5.0);
	struct nav_view view = view_of(&ride);
	assert_int_equal(view.half, 2);
	assert_true(view.pos_mm[1] > 50000);
	assert_near(bam_to_rad(view.heading_bam), 0.0, 0.2);
	ride_end(&ride);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_tunnel_spreads_the_place_along_the_street_and_a_corner_ends_it),
		cmocka_unit_test(a_fix_ends_a_tunnels_drift),
		cmocka_unit_test(a_car_park_spreads_it_in_all_directions_and_fixes_end_it),
		cmocka_unit_test(a_silent_bus_may_hide_a_long_way),
		cmocka_unit_test(the_next_run_goes_on_where_the_last_one_was),
		cmocka_unit_test(a_car_left_off_the_streets_is_found_there),
		cmocka_unit_test(another_city_or_nonsense_is_not_restored),
		cmocka_unit_test(a_fix_elsewhere_refutes_a_remembered_place_even_standing),
		cmocka_unit_test(a_course_tells_where_a_car_that_is_elsewhere_looks),
		cmocka_unit_test(kilometres_driven_unseen_make_a_remembered_place_doubtful),
		cmocka_unit_test(after_a_corner_driven_unseen_the_car_looks_along_its_new_street),
		cmocka_unit_test(a_course_after_a_way_driven_unseen_is_believed),
		cmocka_unit_test(a_place_that_jumps_looks_along_its_street),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
