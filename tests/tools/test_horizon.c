/* Horizons: what a solid hides, what it does not, and never more than rays say. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "platform/base/rng.h"
#include "tools/impostor/horizon.h"

static struct horizon horizon; /* large */

struct block {
	struct dvec2 min, max;
	double top;
};

static void add_block(const struct block *block)
{
	const struct dvec2 outline[4] = { block->min, { block->max.x, block->min.y }, block->max,
		{ block->min.x, block->max.y } };
	horizon_add_outline(&horizon, outline, 4, block->top);
}

static bool hides(struct block box)
{
	return horizon_hides_box(&horizon, box.min, box.max, box.top, -INFINITY);
}

static void reset(void)
{
	horizon_reset(&horizon, (struct dvec3){ 0.0, 0.0, 0.0 });
}

static void nothing_hides_nothing(void **state)
{
	(void)state;
	reset();
	assert_false(hides((struct block){ { 100, -5 }, { 110, 5 }, -1.0 }));
}

/* In all four directions, and across the borders of the diamond's sides. */
static void a_wall_hides_what_is_lower_behind_it(void **state)
{
	(void)state;
	static const struct {
		struct block box;
		bool hidden;
	} cases[] = {
		{ { { 60, -5 }, { 70, 5 }, 9.0 }, true }, { { { 60, -5 }, { 70, 5 }, 40.0 }, false }, /* sticks out above it */
		{ { { 60, 40 }, { 70, 75 }, 2.0 }, false },                                           /* and beside it */
		{ { { 10, -5 }, { 15, 5 }, 2.0 }, false },                                            /* stands before it */
		{ { { 15, -5 }, { 70, 5 }, 2.0 }, false },                                            /* begins before it */
		{ { { 60, -5 }, { 70, 5 }, -3.0 }, true }, { { { -70, -5 }, { -60, 5 }, 2.0 }, false }, /* on the other side */
		{ { { -5, -5 }, { 70, 5 }, 2.0 }, false },                                              /* all around the eye */
	};
	for (int turn = 0; turn < 4; turn++) {
		static const int cosine[4] = { 1, 0, -1, 0 }, sine[4] = { 0, 1, 0, -1 };
		reset();
		const struct dvec2 wall[4] = { { 20, -20 }, { 30, -20 }, { 30, 20 }, { 20, 20 } };
		struct dvec2 turned[4];
		for (int i = 0; i < 4; i++)
			turned[i] = (struct dvec2){ wall[i].x * cosine[turn] - wall[i].y * sine[turn],
				wall[i].x * sine[turn] + wall[i].y * cosine[turn] };
		horizon_add_outline(&horizon, turned, 4, 6.0);
		for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
			struct block box = cases[i].box;
			struct dvec2 a = { box.min.x * cosine[turn] - box.min.y * sine[turn],
				box.min.x * sine[turn] + box.min.y * cosine[turn] };
			struct dvec2 b = { box.max.x * cosine[turn] - box.max.y * sine[turn],
				box.max.x * sine[turn] + box.max.y * cosine[turn] };
			box.min = (struct dvec2){ fmin(a.x, b.x), fmin(a.y, b.y) };
			box.max = (struct dvec2){ fmax(a.x, b.x), fmax(a.y, b.y) };
			assert_int_equal(hides(box), cases[i].hidden);
		}
	}
}

static void one_sees_between_two_houses(void **state)
{
	(void)state;
	reset();
	add_block(&(struct block){ { 20, 1 }, { 30, 20 }, 10.0 });
	add_block(&(struct block){ { 20, -20 }, { 30, -1 }, 10.0 });
	assert_false(hides((struct block){ { 60, -5 }, { 70, 5 }, 2.0 }));
	assert_true(hides((struct block){ { 60, 5 }, { 70, 15 }, 2.0 }));
	add_block(&(struct block){ { 40, -10 }, { 50, 10 }, 10.0 }); /* closes the gap from behind */
	assert_true(hides((struct block){ { 60, -5 }, { 70, 5 }, 2.0 }));
	assert_false(hides((struct block){ { 32, -5 }, { 38, 5 }, 2.0 })); /* in the gap's view, before it */
}

/* No seams where its sides meet. */
static void a_round_house_hides_as_a_whole(void **state)
{
	(void)state;
	reset();
	struct dvec2 round[60];
	for (int i = 0; i < 60; i++)
		round[i] = (struct dvec2){ 40.0 + 15.0 * cos(i * BLVD_PI / 30.0), 3.0 + 15.0 * sin(i * BLVD_PI / 30.0) };
	horizon_add_outline(&horizon, round, 60, 10.0);
	assert_true(hides((struct block){ { 70, -8 }, { 90, 14 }, 5.0 }));
}

static void from_above_a_roof_hides_a_strip_behind_it(void **state)
{
	(void)state;
	reset();
	add_block(&(struct block){ { 20, -20 }, { 40, 20 }, -2.0 }); /* the ground is at -10: hidden up to 200 m */
	assert_true(hides((struct block){ { 50, -5 }, { 190, 5 }, -10.0 }));
	assert_false(hides((struct block){ { 50, -5 }, { 210, 5 }, -10.0 }));
	assert_false(hides((struct block){ { 25, -5 }, { 35, 5 }, -1.0 })); /* stands on it */
}

static void in_a_courtyard_everything_outside_is_hidden(void **state)
{
	(void)state;
	reset();
	const struct dvec2 yard[4] = { { -10, -10 }, { -10, 10 }, { 10, 10 }, { 10, -10 } }; /* a hole: clockwise */
	horizon_add_outline(&horizon, yard, 4, 5.0);
	assert_true(hides((struct block){ { 20, -40 }, { 30, 40 }, 5.0 }));
	assert_true(hides((struct block){ { -40, -60 }, { 90, -50 }, 20.0 }));
	assert_false(hides((struct block){ { -40, -60 }, { 90, -50 }, 30.0 }));
}

static void a_floor_hides_what_it_says(void **state)
{
	(void)state;
	reset();
	add_block(&(struct block){ { 20, -20 }, { 30, 20 }, 6.0 });
	struct dvec2 min = { 60, -5 }, max = { 70, 5 };
	double floor = horizon_floor(&horizon, min, max);
	assert_true(floor > 0.15 && floor < 0.31);
	assert_true(horizon_hides_box(&horizon, min, max, floor * 59.0, floor));
	assert_true(horizon_floor(&horizon, (struct dvec2){ 60, -90 }, (struct dvec2){ 70, 5 }) < -1e9);
}

static double draw(uint64_t *state, double from, double to)
{
	*state = hash_u64(*state + 1);
	return from + (to - from) * (double)(*state >> 11) / 9007199254740992.0;
}

/* Does the line from the eye to a point pass through a block? */
static bool blocked(const struct block *block, struct dvec3 to)
{
	double t0 = 0.0, t1 = 1.0;
	const double low[2] = { block->min.x, block->min.y }, high[2] = { block->max.x, block->max.y },
				 step[2] = { to.x, to.y };
	for (int axis = 0; axis < 2; axis++) {
		if (fabs(step[axis]) < 1e-12) {
			if (low[axis] > 0.0 || high[axis] < 0.0)
				return false;
			continue;
		}
		double a = low[axis] / step[axis], b = high[axis] / step[axis];
		t0 = fmax(t0, fmin(a, b));
		t1 = fmin(t1, fmax(a, b));
	}
	return t0 < t1 && fmin(to.z * t0, to.z * t1) <= block->top;
}

/* Random blocks and triangles: every point of a triangle that counts as hidden is. And a fair share does count. */
static void whatever_is_hidden_is_behind_something(void **state)
{
	(void)state;
	uint64_t seed = 1;
	int hidden = 0, asked = 0;
	for (int world = 0; world < 60; world++) {
		struct block blocks[25];
		reset();
		for (int i = 0; i < 25; i++) {
			struct block *block = &blocks[i];
			do {
				block->min = (struct dvec2){ draw(&seed, -150, 150), draw(&seed, -150, 150) };
				block->max = dvec2_add(block->min, (struct dvec2){ draw(&seed, 1, 60), draw(&seed, 1, 60) });
			} while (block->min.x < 0.5 && block->max.x > -0.5 && block->min.y < 0.5 && block->max.y > -0.5);
			block->top = draw(&seed, -6, 20);
			add_block(block);
		}
		for (int k = 0; k < 400; k++) {
			struct dvec3 corner[3];
			struct dvec3 at = { draw(&seed, -300, 300), draw(&seed, -300, 300), draw(&seed, -10, 20) };
			for (int i = 0; i < 3; i++)
				corner[i] = (struct dvec3){ at.x + draw(&seed, -20, 20), at.y + draw(&seed, -20, 20),
					at.z + draw(&seed, -4, 4) };
			asked++;
			if (!horizon_hides(&horizon, corner, 3, -INFINITY))
				continue;
			hidden++;
			for (int n = 0; n < 30; n++) {
				double u = draw(&seed, 0, 1), v = draw(&seed, 0, 1);
				if (u + v > 1.0) {
					u = 1.0 - u;
					v = 1.0 - v;
				}
				struct dvec3 to = { corner[0].x + u * (corner[1].x - corner[0].x) + v * (corner[2].x - corner[0].x),
					corner[0].y + u * (corner[1].y - corner[0].y) + v * (corner[2].y - corner[0].y),
					corner[0].z + u * (corner[1].z - corner[0].z) + v * (corner[2].z - corner[0].z) };
				bool any = false;
				for (int i = 0; i < 25 && !any; i++)
					any = blocked(&blocks[i], to);
				assert_true(any);
			}
		}
	}
	assert_true(hidden > asked / 5 && hidden < asked);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_hides_nothing),
		cmocka_unit_test(a_wall_hides_what_is_lower_behind_it),
		cmocka_unit_test(one_sees_between_two_houses),
		cmocka_unit_test(a_round_house_hides_as_a_whole),
		cmocka_unit_test(from_above_a_roof_hides_a_strip_behind_it),
		cmocka_unit_test(in_a_courtyard_everything_outside_is_hidden),
		cmocka_unit_test(a_floor_hides_what_it_says),
		cmocka_unit_test(whatever_is_hidden_is_behind_something),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
