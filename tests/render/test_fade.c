/* Buildings in the way: found exactly, eased in and out, cut out of their chunk's draws. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include "fake_city.h"
#include "render/fade.h"
#include "render/near_mesh.h"

struct fixture {
	struct fake_city city;
	struct residency residency;
	struct obstacles obstacles;
};

static struct fixture *make(void)
{
	struct fixture *fixture = calloc(1, sizeof(*fixture));
	fake_city_make(&fixture->city, 4, (const int32_t[2]){ 0, 0 });
	fixture->residency.chunks = calloc(16, sizeof(*fixture->residency.chunks));
	for (int i = 0; i < 16; i++)
		fixture->residency.chunks[i].state = RESIDENCY_PRESENT;
	fixture->obstacles = (struct obstacles){ &fixture->city.pkg, &fixture->residency };
	return fixture;
}

static void drop(struct fixture *fixture)
{
	free(fixture->residency.chunks);
	fake_city_free(&fixture->city);
	free(fixture);
}

/* West of the first row's second house, and east of it. */
static const int64_t west[3] = { 41000, 20000, 1500 }, east[3] = { 79000, 20000, 1500 };
/* Along the street south of it. */
static const int64_t south_west[3] = { 41000, 2000, 1500 }, south_east[3] = { 79000, 2000, 1500 };

static void only_what_stands_between_is_found(void **state)
{
	(void)state;
	struct fixture *fixture = make();
	uint32_t objects[8];
	assert_int_equal(obstacles_between(&fixture->obstacles, west, east, objects, 0, 8), 1);
	assert_int_equal(objects[0], 2); /* chunk 1's house */
	assert_int_equal(obstacles_between(&fixture->obstacles, west, east, objects, 1, 8), 1);
	assert_int_equal(obstacles_between(&fixture->obstacles, south_west, south_east, objects, 0, 8), 0);
	fixture->residency.chunks[1].state = RESIDENCY_DAMAGED;
	assert_int_equal(obstacles_between(&fixture->obstacles, west, east, objects, 0, 8), 0);
	drop(fixture);
}

static void fading_is_eased_and_does_not_depend_on_the_frame_rate(void **state)
{
	(void)state;
	struct fixture *fixture = make();
	struct fade slow = { .opacity = 0.25f }, fast = slow;
	fade_update(&slow, &fixture->obstacles, south_west, &south_east, 1, 1);
	fade_update(&fast, &fixture->obstacles, south_west, &south_east, 1, 1);
	assert_int_equal(slow.count, 0);
	for (int i = 1; i <= 3; i++)
		fade_update(&slow, &fixture->obstacles, west, &east, 1, 1 + i * INT64_C(100000000));
	for (int i = 1; i <= 30; i++)
		fade_update(&fast, &fixture->obstacles, west, &east, 1, 1 + i * INT64_C(10000000));
	assert_int_equal(slow.count, 1);
	assert_true(slow.entries[0].opacity < 0.5f && slow.entries[0].opacity > 0.25f);
	float difference = slow.entries[0].opacity - fast.entries[0].opacity;
	assert_true(difference < 1e-4f && difference > -1e-4f);
	/* back to solid, and out of the table */
	fade_update(&slow, &fixture->obstacles, south_west, &south_east, 1, INT64_C(350000000));
	assert_int_equal(slow.count, 1);
	fade_update(&slow, &fixture->obstacles, south_west, &south_east, 1, INT64_C(3000000000));
	assert_int_equal(slow.count, 0);
	/* a step back in time cuts */
	fade_update(&slow, &fixture->obstacles, west, &east, 1, 1);
	assert_true(slow.entries[0].opacity < 0.2501f);
	drop(fixture);
}

static void a_fading_building_is_drawn_once_and_apart(void **state)
{
	(void)state;
	struct fixture *fixture = make();
	uint8_t *memory = malloc(1 << 20);
	struct arena arena;
	arena_init(&arena, "test", memory, 1 << 20);
	struct gfx *gfx;
	struct near_mesh mesh;
	assert_int_equal(gfx_init(&gfx, &arena, &gfx_dummy, NULL), 0);
	assert_int_equal(near_mesh_init(&mesh, &arena, gfx, &fixture->city.pkg, 16 << 20, NULL), 0);
	near_mesh_load(&mesh, west, 6000.0, UINT64_MAX);
	struct fade fade = { .entries = { { .object = 2, .opacity = 0.5f } }, .count = 1 };
	struct draw_list list;
	draw_list_init(&list, &arena, 64);
	near_mesh_emit(&mesh, &fade, &list, NULL, 1, VIEW_NEAR, 10.0f);
	draw_list_sort(&list);
	uint32_t sum = 0, faded = 0;
	uint8_t covered[64] = { 0 };
	for (uint32_t i = 0; i < list.count; i++) {
		sum += list.items[i].count;
		faded += list.items[i].opacity < 255 ? list.items[i].count : 0;
		for (uint32_t k = 0; k < list.items[i].count; k++)
			assert_int_equal(covered[list.items[i].first + k]++, 0);
	}
	assert_int_equal(sum, 7 * 6);
	assert_int_equal(faded, 5 * 6);
	assert_int_equal(list.solid_count, list.count - 1);
	gfx_finish(gfx);
	free(memory);
	drop(fixture);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(only_what_stands_between_is_found),
		cmocka_unit_test(fading_is_eased_and_does_not_depend_on_the_frame_rate),
		cmocka_unit_test(a_fading_building_is_drawn_once_and_apart),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
