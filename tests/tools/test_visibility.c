/* Visible sets hold whatever rays from the view cell meet, and much less than everything. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "block_city.h"
#include "platform/base/rng.h"
#include "ray_cast.h"
#include "tools/impostor/eye_box.h"
#include "tools/impostor/visibility.h"

#define NEAR_M 60.0
#define FAR_M 2000.0

static double draw(uint64_t *state, double from, double to)
{
	*state = hash_u64(*state + 1);
	return from + (to - from) * (double)(*state >> 11) / 9007199254740992.0;
}

static bool has(const struct triangle_set *set, uint32_t object, uint32_t triangle)
{
	size_t low = 0, high = set->items.count;
	while (low < high) {
		size_t middle = (low + high) / 2;
		if (set->items.items[middle].object < object)
			low = middle + 1;
		else
			high = middle;
	}
	if (low == set->items.count || set->items.items[low].object != object)
		return false;
	return set->words.items[set->items.items[low].first_word + triangle / 64] >> (triangle % 64) & 1;
}

/* A piece of one of the streets. */
static struct view_cell cell_of(uint64_t *state)
{
	double street = BLOCK_CITY_PITCH_M * (double)(hash_u64(++*state) % (BLOCK_CITY_BLOCKS - 1) + 1);
	double from = draw(state, 20.0, 200.0), to = from + draw(state, 5.0, 50.0);
	struct view_cell cell = { { from, street, 0.0 }, { to, street, 0.0 }, 3.0, 3.0, 1.2, 4.0 };
	if (hash_u64(++*state) % 2) {
		cell.start = (struct dvec3){ street, from, 0.0 };
		cell.end = (struct dvec3){ street, to, 0.0 };
	}
	return cell;
}

static struct dvec3 eye_in(const struct view_cell *cell, uint64_t *state)
{
	struct dvec2 axis = { cell->end.x - cell->start.x, cell->end.y - cell->start.y };
	double length = dvec2_length(axis), along = draw(state, -cell->overrun_m, length + cell->overrun_m) / length;
	double left = draw(state, -cell->half_width_m, cell->half_width_m) / length;
	return (struct dvec3){ cell->start.x + axis.x * along - axis.y * left,
		cell->start.y + axis.y * along + axis.x * left, draw(state, cell->eye_min_m, cell->eye_max_m) };
}

/* A random triangle that the sets lack, or anywhere. */
static struct dvec3 aim(const struct pkg *pkg, const struct visible_sets *sets, struct dvec3 eye, uint64_t *state)
{
	double turn = draw(state, 0.0, 2.0 * BLVD_PI);
	struct dvec3 out = { cos(turn), sin(turn), draw(state, -0.3, 0.8) };
	for (int tries = 0; tries < 4; tries++) {
		uint32_t object = (uint32_t)(hash_u64(++*state) % pkg->object_count);
		uint32_t triangle = (uint32_t)(hash_u64(++*state) % triangle_set_object_size(&pkg->objects[object]));
		if (has(&sets->near_set, object, triangle) || has(&sets->far_set, object, triangle))
			continue;
		int64_t mm[3][3];
		triangle_set_corners(pkg, object, triangle, mm);
		double share[3] = { draw(state, 0.01, 1.0), draw(state, 0.01, 1.0), draw(state, 0.01, 1.0) };
		double at[3] = { 0.0 }, sum = (share[0] + share[1] + share[2]) * 1000.0;
		for (int i = 0; i < 9; i++)
			at[i % 3] += (double)mm[i / 3][i % 3] * share[i / 3] / sum;
		return (struct dvec3){ at[0] - eye.x, at[1] - eye.y, at[2] - eye.z };
	}
	return out;
}

static void rays_meet_nothing_that_is_missing(void **state)
{
	(void)state;
	uint32_t kept = 0, all = 0;
	for (uint64_t seed = 1; seed <= 2; seed++) {
		struct block_city made;
		block_city_make(&made, seed * 77);
		struct visibility *visibility = visibility_new(&made.pkg);
		struct ray_caster *caster = ray_caster_new(&made.pkg);
		struct visible_sets sets = { 0 };
		uint64_t random = seed;
		for (int c = 0; c < 12; c++) {
			struct view_cell cell = cell_of(&random);
			visible_set(visibility, &cell, NEAR_M, FAR_M, &sets);
			kept += sets.near_set.triangles + sets.far_set.triangles;
			all += (uint32_t)made.mesh.triangles;
			for (int ray = 0; ray < 1500; ray++) {
				struct dvec3 eye = eye_in(&cell, &random), direction = aim(&made.pkg, &sets, eye, &random);
				struct ray_hit hit;
				if (!ray_cast(caster, eye, direction, 1e6, true, &hit) || !hit.front)
					continue;
				assert_true(
					has(&sets.near_set, hit.object, hit.triangle) || has(&sets.far_set, hit.object, hit.triangle));
			}
		}
		visible_sets_finish(&sets);
		ray_caster_free(caster);
		visibility_free(visibility);
		block_city_finish(&made);
	}
	assert_true(kept < all / 2); /* low houses with gaps between them: no more can be hidden by much */
}

static void sets_are_split_by_distance_and_counted(void **state)
{
	(void)state;
	struct block_city made;
	block_city_make(&made, 3);
	struct visibility *visibility = visibility_new(&made.pkg);
	struct visible_sets sets = { 0 }, whole = { 0 };
	struct view_cell cell = { { 30, 48, 0 }, { 60, 48, 0 }, 3.0, 3.0, 1.2, 4.0 };
	struct eye_box box;
	eye_box_init(&box, &cell);
	visible_set(visibility, &cell, NEAR_M, FAR_M, &sets);
	uint32_t near = 0;
	for (uint32_t object = 0; object < made.pkg.object_count; object++)
		for (uint32_t i = 0; i < triangle_set_object_size(&made.pkg.objects[object]); i++) {
			int64_t mm[3][3];
			triangle_set_corners(&made.pkg, object, i, mm);
			struct dvec2 corner[3];
			for (int k = 0; k < 3; k++)
				corner[k] = (struct dvec2){ (double)mm[k][0] * 1e-3, (double)mm[k][1] * 1e-3 };
			bool is_near = eye_box_distance(&box, corner, 3) < NEAR_M;
			near += is_near;
			assert_false(has(is_near ? &sets.far_set : &sets.near_set, object, i));
		}
	assert_int_equal(sets.near_candidates, near);
	assert_true(sets.near_set.triangles > 100 && sets.far_set.triangles > 100);
	/* The other split has the same in sum. */
	visible_set(visibility, &cell, 1e6, FAR_M, &whole);
	assert_int_equal(whole.near_set.triangles, sets.near_set.triangles + sets.far_set.triangles);
	assert_int_equal(whole.far_set.triangles, 0);
	/* Nothing farther than far_m. */
	visible_set(visibility, &cell, NEAR_M, NEAR_M - 0.01, &whole);
	assert_true(whole.near_set.triangles <= sets.near_set.triangles && whole.near_set.triangles > 100);
	assert_int_equal(whole.far_set.triangles, 0);
	eye_box_finish(&box);
	visible_sets_finish(&sets);
	visible_sets_finish(&whole);
	visibility_free(visibility);
	block_city_finish(&made);
}

static void without_occluders_only_backs_are_left_out(void **state)
{
	(void)state;
	struct block_city made;
	block_city_make(&made, 4);
	made.pkg.occluder_count = 0;
	struct visibility *visibility = visibility_new(&made.pkg);
	struct visible_sets sets = { 0 };
	struct view_cell cell = { { 30, 48, 0 }, { 60, 48, 0 }, 3.0, 3.0, 1.2, 4.0 };
	visible_set(visibility, &cell, NEAR_M, FAR_M, &sets);
	struct eye_box box;
	eye_box_init(&box, &cell);
	uint32_t facing = 0;
	for (uint32_t object = 0; object < made.pkg.object_count; object++)
		for (uint32_t i = 0; i < triangle_set_object_size(&made.pkg.objects[object]); i++) {
			int64_t mm[3][3];
			triangle_set_corners(&made.pkg, object, i, mm);
			struct dvec3 corner[3];
			for (int k = 0; k < 3; k++)
				corner[k] = (struct dvec3){ (double)mm[k][0] * 1e-3, (double)mm[k][1] * 1e-3, (double)mm[k][2] * 1e-3 };
			facing += eye_box_faces(&box, corner);
		}
	assert_int_equal(sets.near_set.triangles + sets.far_set.triangles, facing);
	assert_true(facing < made.mesh.triangles * 9 / 10);
	eye_box_finish(&box);
	visible_sets_finish(&sets);
	visibility_free(visibility);
	block_city_finish(&made);
}

static void samples_cover_the_floor(void **state)
{
	(void)state;
	static const struct view_cell cells[] = {
		{ { 0, 0, 0 }, { 60, 0, 0 }, 3.0, 3.0, 1.2, 4.0 },
		{ { 5, 5, 2 }, { 15, 40, 6 }, 11.0, 5.0, 1.2, 4.0 },  /* wide, uphill */
		{ { 5, 5, 2 }, { 5, 5.001, 2 }, 1.5, 3.0, 1.0, 1.0 }, /* no length */
	};
	for (size_t c = 0; c < sizeof(cells) / sizeof(cells[0]); c++) {
		struct eye_box box;
		eye_box_init(&box, &cells[c]);
		uint64_t random = c;
		for (int i = 0; i < 2000; i++) {
			struct dvec3 eye = eye_in(&cells[c], &random);
			struct dvec2 axis = { cells[c].end.x - cells[c].start.x, cells[c].end.y - cells[c].start.y };
			double along = dvec2_dot((struct dvec2){ eye.x - cells[c].start.x, eye.y - cells[c].start.y }, axis) /
						   dvec2_dot(axis, axis);
			eye.z += cells[c].start.z + fmin(fmax(along, 0.0), 1.0) * (cells[c].end.z - cells[c].start.z);
			bool covered = false;
			for (size_t k = 0; k < box.samples.count && !covered; k++) {
				const struct dvec3 *at = &box.samples.items[k];
				covered = hypot(at->x - eye.x, at->y - eye.y) <= PKG_OCCLUDER_SHRINK_MM * 1e-3 && at->z >= eye.z;
			}
			assert_true(covered);
		}
		eye_box_finish(&box);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rays_meet_nothing_that_is_missing),
		cmocka_unit_test(sets_are_split_by_distance_and_counted),
		cmocka_unit_test(without_occluders_only_backs_are_left_out),
		cmocka_unit_test(samples_cover_the_floor),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
