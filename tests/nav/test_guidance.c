/* What is said about a route: kinds of junctions, words, distances. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nav/guidance.h"
#include "tests/nav/streets.h"

static uint8_t memory[1 << 22];
static struct graph graph;
static struct route_search search;
static struct guidance guidance;

static void make(const struct pkg *pkg)
{
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(graph_init(&graph, &arena, &pkg->graph, pkg->meta->right_hand_traffic), 0);
	assert_int_equal(route_init(&search, &arena, &graph, 0), 0);
	assert_int_equal(guidance_init(&guidance, &arena, &search), 0);
}

static void guide(uint32_t start, uint32_t stop)
{
	struct route_request request = {
		.start = { start, 10 }, .stops = { { stop, graph_length_m(&graph, stop) - 10 } }, .stop_count = 1
	};
	assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
	guidance_build(&guidance, &search.route);
}

static void turns_are_told_by_their_angle(void **state)
{
	(void)state;
	static const struct {
		double deg;
		enum nav_manoeuvre expected;
	} table[] = {
		{ 0, NAV_MANOEUVRE_NONE },
		{ 10, NAV_MANOEUVRE_NONE },
		{ -12, NAV_MANOEUVRE_NONE },
		{ 90, NAV_MANOEUVRE_RIGHT },
		{ -90, NAV_MANOEUVRE_LEFT },
		{ 60, NAV_MANOEUVRE_RIGHT },
		{ -120, NAV_MANOEUVRE_LEFT },
		{ 145, NAV_MANOEUVRE_SHARP_RIGHT },
		{ -150, NAV_MANOEUVRE_SHARP_LEFT },
	};
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		struct streets *s = streets_new();
		double rad = table[i].deg * BLVD_PI / 180.0;
		uint32_t from = streets_node(s, 0, -200), at = streets_node(s, 0, 0);
		uint32_t to = streets_node(s, 200 * sin(rad), 200 * cos(rad));
		/* A crossing street, so that there is a choice, square to the turn or straight on. */
		double other = fabs(table[i].deg) < 30 ? 1.5 : 0.0;
		uint32_t side = streets_node(s, 200 * sin(other), 200 * cos(other));
		streets_edge(s, from, at, ALPHA, 0, NULL);
		streets_edge(s, at, to, BETA, 0, NULL);
		streets_edge(s, at, side, GAMMA, 0, NULL);
		make(streets_finish(s, true));
		guide(0, 2);
		struct nav_step step = guidance_step_ahead(&guidance, 0, 10, 0);
		if (table[i].expected == NAV_MANOEUVRE_NONE) {
			assert_int_equal(step.manoeuvre, NAV_MANOEUVRE_ARRIVE);
		} else {
			assert_int_equal(step.manoeuvre, table[i].expected);
			assert_near(step.distance_m, 190.0, 0.01);
			assert_int_equal(step.street, BETA);
			assert_int_equal(step.from_half, 0);
			assert_int_equal(step.to_half, 2);
			assert_int_equal(guidance_step_ahead(&guidance, 0, 10, 1).manoeuvre, NAV_MANOEUVRE_ARRIVE);
			assert_int_equal(guidance_step_ahead(&guidance, 1, 0, 0).manoeuvre, NAV_MANOEUVRE_ARRIVE);
		}
		free(s);
	}
}

static void a_bend_or_another_name_is_nothing_to_do(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 0, 0), b = streets_node(s, 0, 100), c = streets_node(s, 100, 100),
			 d = streets_node(s, 200, 100), e = streets_node(s, 300, 140), yard = streets_node(s, 200, 0);
	streets_edge(s, a, b, ALPHA, 0, NULL);
	streets_edge(s, b, c, ALPHA, 0, NULL); /* a square bend without a choice */
	streets_edge(s, c, d, BETA, 0, NULL);  /* another name */
	streets_edge(s, d, e, BETA, 0, NULL);  /* bends away from a yard */
	streets_edge(s, d, yard, NO_NAME, 0, NULL)->street_class = PKG_STREET_SERVICE;
	make(streets_finish(s, true));
	guide(0, 6);
	assert_int_equal(guidance.step_count, 1);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_ARRIVE);
	double m, sec;
	guidance_remaining(&guidance, 0, 10, &m, &sec);
	assert_near(m, 90 + 100 + 100 + hypot(100, 40) - 10, 0.1);
	assert_true(sec > 20 && sec < 90);
	guidance_remaining(&guidance, 3, 20, &m, &sec);
	assert_near(m, hypot(100, 40) - 30, 0.1);
	free(s);
}

static void the_main_street_bending_is_no_turn_but_leaving_it_is(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 0, 0), b = streets_node(s, 0, 100), on = streets_node(s, 60, 180),
			 off = streets_node(s, -80, 160);
	streets_edge(s, a, b, ALPHA, 0, NULL);
	streets_edge(s, b, on, ALPHA, 0, NULL); /* 37 degrees to the right */
	streets_edge(s, b, off, BETA, 0, NULL); /* 53 to the left */
	make(streets_finish(s, true));
	guide(0, 2);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_ARRIVE);
	guide(0, 4);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_LEFT);
	free(s);
}

static void forks_are_kept_left_or_right(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 0, 0), b = streets_node(s, 0, 200), l = streets_node(s, -50, 400),
			 r = streets_node(s, 50, 400);
	streets_oneway(streets_edge(s, a, b, ALPHA, 0, NULL));
	streets_oneway(streets_edge(s, b, l, BETA, 0, NULL));
	streets_oneway(streets_edge(s, b, r, GAMMA, 0, NULL));
	make(streets_finish(s, true));
	guide(0, 2);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_KEEP_LEFT);
	guide(0, 4);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_KEEP_RIGHT);
	free(s);
}

static void slip_roads_merge(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 0, 0), b = streets_node(s, 0, 300), c = streets_node(s, 0, 900),
			 ramp = streets_node(s, 60, 100);
	struct pkg_edge *edges[3] = { streets_edge(s, a, b, ALPHA, 0, NULL), streets_edge(s, b, c, ALPHA, 0, NULL),
		streets_edge(s, ramp, b, NO_NAME, 0, NULL) };
	for (int i = 0; i < 3; i++) {
		streets_oneway(edges[i]);
		edges[i]->street_class = PKG_STREET_MOTORWAY;
	}
	edges[2]->flags |= PKG_EDGE_LINK;
	make(streets_finish(s, true));
	guide(4, 2);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_MERGE);
	assert_int_equal(guidance.steps[0].street, ALPHA);
	guide(0, 2);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_ARRIVE);
	free(s);
}

/* A ring with four arms; counter-clockwise. Arms 0 to 3 are south, east, north, west. */
static struct streets *roundabout(void)
{
	struct streets *s = streets_new();
	for (int i = 0; i < 4; i++)
		streets_node(s, 20 * sin(BLVD_PI - i * BLVD_PI / 2), 20 * cos(BLVD_PI - i * BLVD_PI / 2));
	for (int i = 0; i < 4; i++)
		streets_node(s, 200 * sin(BLVD_PI - i * BLVD_PI / 2), 200 * cos(BLVD_PI - i * BLVD_PI / 2));
	static const uint32_t names[4] = { ALPHA, BETA, GAMMA, DELTA };
	for (uint32_t i = 0; i < 4; i++) {
		double rad = BLVD_PI - (i + 0.5) * BLVD_PI / 2;
		struct pkg_edge *ring =
			streets_edge(s, i, (i + 1) % 4, NO_NAME, 1, (const double[][2]){ { 20 * sin(rad), 20 * cos(rad) } });
		ring->flags |= PKG_EDGE_ROUNDABOUT;
		streets_oneway(ring);
	}
	for (uint32_t i = 0; i < 4; i++)
		streets_edge(s, 4 + i, i, names[i], 0, NULL);
	return s;
}

static void roundabouts_count_their_exits(void **state)
{
	(void)state;
	struct streets *s = roundabout();
	make(streets_finish(s, true));
	static const uint32_t names[4] = { ALPHA, BETA, GAMMA, DELTA };
	for (uint32_t from = 0; from < 4; from++) {
		for (uint32_t exit = 1; exit < 4; exit++) {
			uint32_t to = (from + exit) % 4;
			guide(streets_half(s, 4 + from, from), streets_half(s, to, 4 + to));
			assert_int_equal(guidance.step_count, 2);
			struct nav_step step = guidance_step_ahead(&guidance, 0, 10, 0);
			assert_int_equal(step.manoeuvre, NAV_MANOEUVRE_ROUNDABOUT);
			assert_int_equal(step.exit, exit);
			assert_int_equal(step.street, names[to]);
			assert_near(step.distance_m, 170.0, 0.1);
			assert_near(bam_to_rad(step.angle_bam) * 180.0 / BLVD_PI, exit == 2 ? 0 : exit == 1 ? 90 : -90, 0.5);
		}
	}
	free(s);
}

static void turning_back_in_a_dead_end_is_a_u_turn(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t a = streets_node(s, 0, 0), b = streets_node(s, 0, 100);
	streets_edge(s, a, b, ALPHA, 0, NULL);
	make(streets_finish(s, true));
	struct route_request request = { .start = { 0, 60 }, .stops = { { 0, 30 } }, .stop_count = 1 };
	assert_int_equal(route_find(&search, &request), ROUTE_FOUND);
	guidance_build(&guidance, &search.route);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_U_TURN);
	assert_near(guidance.steps[0].at_m, 40.0, 1e-9);
	free(s);
}

static void crossing_a_divided_street_is_one_turn(void **state)
{
	(void)state;
	struct streets *s = streets_new();
	uint32_t from = streets_node(s, 0, -200), near = streets_node(s, 0, 0), far = streets_node(s, 0, 12);
	uint32_t east = streets_node(s, 200, 0), west = streets_node(s, -200, 12), nw = streets_node(s, -200, 0),
			 ne = streets_node(s, 200, 12);
	streets_edge(s, from, near, ALPHA, 0, NULL);
	streets_edge(s, near, far, ALPHA, 0, NULL);
	streets_oneway(streets_edge(s, nw, near, BETA, 0, NULL));
	streets_oneway(streets_edge(s, near, east, BETA, 0, NULL));
	streets_oneway(streets_edge(s, ne, far, BETA, 0, NULL));
	streets_oneway(streets_edge(s, far, west, BETA, 0, NULL));
	make(streets_finish(s, true));
	guide(streets_half(s, from, near), streets_half(s, far, west));
	assert_int_equal(guidance.step_count, 2);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_LEFT);
	guide(streets_half(s, nw, near), streets_half(s, far, west)); /* round and back on the other side */
	assert_int_equal(guidance.step_count, 2);
	assert_int_equal(guidance.steps[0].manoeuvre, NAV_MANOEUVRE_U_TURN);
	free(s);
}

static void words(void **state)
{
	(void)state;
	static const struct {
		enum nav_manoeuvre manoeuvre;
		unsigned exit;
		const char *street, *expected;
	} table[] = {
		{ NAV_MANOEUVRE_LEFT, 0, "Rue du Rhône", "Turn left into Rue du Rhône" },
		{ NAV_MANOEUVRE_RIGHT, 0, "", "Turn right" },
		{ NAV_MANOEUVRE_RIGHT, 0, NULL, "Turn right" },
		{ NAV_MANOEUVRE_SLIGHT_LEFT, 0, "A", "Bear left into A" },
		{ NAV_MANOEUVRE_SLIGHT_RIGHT, 0, "A", "Bear right into A" },
		{ NAV_MANOEUVRE_SHARP_LEFT, 0, "A", "Turn sharp left into A" },
		{ NAV_MANOEUVRE_SHARP_RIGHT, 0, "A", "Turn sharp right into A" },
		{ NAV_MANOEUVRE_STRAIGHT, 0, "A", "Go straight on into A" },
		{ NAV_MANOEUVRE_U_TURN, 0, "", "Turn round" },
		{ NAV_MANOEUVRE_ROUNDABOUT, 1, "A", "At the roundabout take the 1st exit into A" },
		{ NAV_MANOEUVRE_ROUNDABOUT, 2, "", "At the roundabout take the 2nd exit" },
		{ NAV_MANOEUVRE_ROUNDABOUT, 3, "", "At the roundabout take the 3rd exit" },
		{ NAV_MANOEUVRE_ROUNDABOUT, 11, "", "At the roundabout take the 11th exit" },
		{ NAV_MANOEUVRE_KEEP_LEFT, 0, "A1", "Keep left onto A1" },
		{ NAV_MANOEUVRE_KEEP_RIGHT, 0, "", "Keep right" },
		{ NAV_MANOEUVRE_MERGE, 0, "A1", "Merge onto A1" },
		{ NAV_MANOEUVRE_ARRIVE, 0, "A", "Destination: A" },
		{ NAV_MANOEUVRE_NONE, 0, "A", "Follow A" },
		{ NAV_MANOEUVRE_NONE, 0, "", "Follow the road" },
		{ (enum nav_manoeuvre)99, 0, "", "Follow the road" },
	};
	char text[96];
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		assert_int_equal(guidance_text(table[i].manoeuvre, table[i].exit, table[i].street, text, sizeof(text)),
			strlen(table[i].expected));
		assert_string_equal(text, table[i].expected);
	}
	/* cut, but never within a character */
	for (size_t size = 1; size < 40; size++) {
		size_t length = guidance_text(NAV_MANOEUVRE_LEFT, 0, "ÄÖÜ日本通り", text, size);
		assert_true(length < size && strlen(text) == length);
		for (size_t i = 0; i < length;) {
			unsigned char c = (unsigned char)text[i];
			size_t n = c < 0x80 ? 1 : c < 0xE0 ? 2 : c < 0xF0 ? 3 : 4;
			assert_true(i + n <= length);
			i += n;
		}
	}
}

static void distances(void **state)
{
	(void)state;
	static const struct {
		double m;
		const char *expected;
	} table[] = {
		{ 0, "now" },
		{ 9.9, "now" },
		{ -5, "now" },
		{ NAN, "now" },
		{ 10, "10 m" },
		{ 47, "50 m" },
		{ 294, "290 m" },
		{ 320, "300 m" },
		{ 960, "950 m" },
		{ 980, "1.0 km" },
		{ 1240, "1.2 km" },
		{ 9940, "9.9 km" },
		{ 9960, "10 km" },
		{ 123456, "123 km" },
	};
	char text[32];
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		guidance_distance_text(table[i].m, text, sizeof(text));
		assert_string_equal(text, table[i].expected);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(turns_are_told_by_their_angle),
		cmocka_unit_test(a_bend_or_another_name_is_nothing_to_do),
		cmocka_unit_test(the_main_street_bending_is_no_turn_but_leaving_it_is),
		cmocka_unit_test(forks_are_kept_left_or_right),
		cmocka_unit_test(slip_roads_merge),
		cmocka_unit_test(roundabouts_count_their_exits),
		cmocka_unit_test(turning_back_in_a_dead_end_is_a_u_turn),
		cmocka_unit_test(crossing_a_divided_street_is_one_turn),
		cmocka_unit_test(words),
		cmocka_unit_test(distances),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
