/* Arenas, geographic frame, binary angles: the ground everything stands on. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <errno.h>
#include <math.h>

#include "platform/base/arena.h"
#include "platform/base/geo.h"
#include "platform/base/rng.h"

static void arena_hands_out_aligned_zeroed_memory_until_full(void **state)
{
	(void)state;
	static uint8_t memory[1024];
	for (size_t i = 0; i < sizeof(memory); i++)
		memory[i] = 0xAA;
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	for (size_t align = 1; align <= 64; align *= 2) {
		uint8_t *at = arena_alloc(&arena, 3, align);
		assert_non_null(at);
		assert_int_equal((uintptr_t)at % align, 0);
		assert_int_equal(at[0] | at[1] | at[2], 0);
	}
	size_t mark = arena_mark(&arena);
	assert_null(arena_alloc(&arena, 1024, 1));
	assert_null(arena_alloc(&arena, SIZE_MAX, 64));
	assert_int_equal(arena.failed, 2);
	assert_int_equal(arena.used, mark);
	struct arena child;
	assert_int_equal(arena_carve(&arena, &child, "child", 4096), -ENOMEM);
	assert_int_equal(arena_carve(&arena, &child, "child", 128), 0);
	arena_release(&arena, mark);
	assert_true(arena.high_water > mark);
	arena_seal(&arena);
	assert_non_null(arena_alloc(&arena, 1, 1));
	assert_int_equal(arena.late, 1);
}

/* Published case: Snyder, USGS Professional Paper 1395, has no ellipsoidal orthographic example, so the frame is held
 * against the geodesic distance of a meridian arc: one minute of latitude at 45 degrees is 1852.2 m on WGS84. */
static void one_minute_of_latitude_has_its_length(void **state)
{
	(void)state;
	struct geo_frame frame = geo_frame_at((struct geo_point){ 45.0, 7.0 });
	struct dvec2 at = geo_to_plane(&frame, (struct geo_point){ 45.0 + 1.0 / 60.0, 7.0 });
	assert_true(fabs(at.y - 1852.2) < 0.1);
	assert_true(fabs(at.x) < 1e-6);
}

static void round_trip_is_exact_everywhere(void **state)
{
	(void)state;
	static const struct geo_point origins[] = {
		{ 46.2, 6.1 },
		{ 0, 0 },
		{ 89.9, 10 },
		{ -89.9, -170 },
		{ 10, 179.999 },
		{ -33, -179.9999 },
		{ 37.8, -122.4 },
		{ 90, 0 },
	};
	struct rng rng = rng_seed(1);
	for (size_t i = 0; i < sizeof(origins) / sizeof(*origins); i++) {
		struct geo_frame frame = geo_frame_at(origins[i]);
		for (int k = 0; k < 200; k++) {
			struct dvec2 at = { rng_range(&rng, -20000, 20000), rng_range(&rng, -20000, 20000) };
			struct geo_point there = geo_from_plane(&frame, at);
			struct dvec2 back = geo_to_plane(&frame, there);
			assert_true(hypot(back.x - at.x, back.y - at.y) < 1e-6);
			assert_true(fabs(there.lat_deg) <= 90.0 && fabs(there.lon_deg) <= 180.0);
		}
	}
}

static void antimeridian_is_no_border(void **state)
{
	(void)state;
	struct geo_frame frame = geo_frame_at((struct geo_point){ -17.0, 179.999 });
	struct dvec2 east = geo_to_plane(&frame, (struct geo_point){ -17.0, -179.999 });
	assert_true(fabs(east.x - 212.98) < 0.1);
}

static void headings_wrap_without_a_seam(void **state)
{
	(void)state;
	static const double turns[] = { 0.0, 0.1, 3.14159265, -3.14159265, 6.2831853, -9.0, 1e6 };
	for (size_t i = 0; i < sizeof(turns) / sizeof(*turns); i++) {
		double back = bam_to_rad(bam_from_rad(turns[i]));
		assert_true(fabs(remainder(back - turns[i], 2.0 * BLVD_PI)) < 1e-8);
	}
	int32_t just_left = bam_from_rad(-1e-6), just_right = bam_from_rad(1e-6);
	assert_true(fabs(bam_to_rad(bam_diff(just_right, just_left)) - 2e-6) < 3e-9);
	int32_t south_east = bam_from_rad(BLVD_PI - 1e-6), south_west = bam_from_rad(-BLVD_PI + 1e-6);
	assert_true(fabs(bam_to_rad(bam_diff(south_west, south_east)) - 2e-6) < 3e-9);
	assert_true(fabs(bam_to_rad(bam_from_dir(1.0, 0.0)) - BLVD_PI / 2.0) < 3e-9);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(arena_hands_out_aligned_zeroed_memory_until_full),
		cmocka_unit_test(one_minute_of_latitude_has_its_length),
		cmocka_unit_test(round_trip_is_exact_everywhere),
		cmocka_unit_test(antimeridian_is_no_border),
		cmocka_unit_test(headings_wrap_without_a_seam),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
