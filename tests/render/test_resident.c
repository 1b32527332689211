/* A package drawn by its cells keeps within the budget, or is refused with the numbers. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
/* before cmocka */
#include <cmocka.h>

#include "assets/cell_cache.h"
#include "assets/resident.h"
#include "render/frame.h"
#include "tests/assets/far_city.h"

#define MIB (UINT64_C(1) << 20)

static _Alignas(64) uint8_t memory[32 << 20];
static struct arena arena;

static const struct far_city_config street = { .edges = 25,
	.stretches_an_edge = 4,
	.objects_a_chunk = 100,
	.triangles_an_object = 60,
	.impostor_vertices = 300,
	.impostor_pages = 3,
	.geometry_every = 10 };

static void open_street(struct pkg *pkg, uint64_t bound)
{
	size_t size;
	struct pkg_fault fault;
	uint8_t *bytes = far_city_build(&street, &size);
	struct pkg_meta *meta = (void *)(bytes + far_city_section(bytes, PKG_META).offset);
	meta->resident_bound_bytes = bound;
	far_city_sign(bytes);
	assert_int_equal(far_city_open(bytes, size, pkg, &fault), 0);
	free(bytes);
}

static void the_need_covers_what_is_near_and_some_slots(void **state)
{
	(void)state;
	struct pkg pkg;
	struct resident_need need;
	open_street(&pkg, 0);
	arena_init(&arena, "test", memory, RESIDENT_SCRATCH_BYTES);
	assert_int_equal(resident_need(&pkg, &arena, &need), 0);
	assert_int_equal(arena.used, 0);
	assert_true(need.reach_m >= 100.0 + 50.0 && need.reach_m < 250.0);
	uint64_t chunk = pkg.geometry_bytes / pkg.chunk_count;
	assert_true(need.geometry > 8 * chunk && need.geometry < 16 * chunk);
	assert_true(need.slot > 6 * PKG_PAGE_BYTES && need.slot < 6 * PKG_PAGE_BYTES + CELL_STAGING_MAX);
	assert_true(need.sum >= need.geometry + RESIDENT_SLOTS * need.slot);
	pkg_close(&pkg);
}

static void the_budget_is_kept_or_refused(void **state)
{
	(void)state;
	static const struct {
		const char *far_name;
		uint64_t budget, bound;
		int status;
	} table[] = {
		{ "impostor", 64 * MIB, 0, 0 },
		{ "impostor", 24 * MIB, 0, 0 },
		{ "impostor", 24 * MIB, 30 * MIB, -EFBIG },
		{ "impostor", 64 * MIB, 90 * MIB, -EFBIG },
		{ "impostor", 5 * MIB, 0, -EFBIG },
		{ "auto", 24 * MIB, 30 * MIB, -EFBIG },
		{ "full", 64 * MIB, 90 * MIB, 0 },
		{ "none", 24 * MIB, 90 * MIB, 0 },
	};
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		struct pkg pkg;
		struct renderer *renderer;
		open_street(&pkg, table[i].bound);
		arena_init(&arena, "test", memory, sizeof(memory));
		struct renderer_config config = { .width = 320,
			.height = 180,
			.samples = 1,
			.far_name = table[i].far_name,
			.gpu_budget_bytes = table[i].budget,
			.deterministic = true,
			.gfx = &gfx_dummy };
		int status = renderer_init(&renderer, &arena, &config, &pkg);
		if (status != table[i].status)
			fail_msg("case %zu: status %d", i, status);
		if (!status) {
			struct renderer_stats stats;
			renderer_stats(renderer, &stats);
			assert_true(stats.gpu_bytes_high_water <= table[i].budget);
			renderer_finish(renderer);
		}
		pkg_close(&pkg);
	}
}

/* One budget for arena and GPU: from the least that is accepted, in steps of less than a slot. */
static void arena_and_gpu_share_a_budget_to_the_last_slot(void **state)
{
	(void)state;
	struct pkg pkg;
	uint64_t least = 0, slots_bytes = 0;
	open_street(&pkg, 0);
	for (uint64_t budget = 4 * MIB; budget <= 24 * MIB; budget += 100000) {
		struct renderer *renderer;
		arena_init(&arena, "test", memory, sizeof(memory));
		struct renderer_config config = { .width = 320,
			.height = 180,
			.samples = 1,
			.far_name = "impostor",
			.budget_bytes = budget,
			.deterministic = true,
			.gfx = &gfx_dummy };
		int status = renderer_init(&renderer, &arena, &config, &pkg);
		if (status) {
			assert_int_equal(status, -EFBIG);
			assert_int_equal(least, 0); /* what was enough stays enough */
			continue;
		}
		struct renderer_stats stats;
		renderer_stats(renderer, &stats);
		least = least ? least : budget;
		assert_int_equal(arena.failed, 0);
		assert_true(arena.size < sizeof(memory)); /* what it does not need the GPU has */
		assert_true(arena.size - arena.used < 32 << 10);
		assert_true(arena.size + stats.gpu_bytes_high_water <= budget);
		assert_true(stats.far_bytes >= slots_bytes);
		slots_bytes = stats.far_bytes;
		if (budget == least) /* and it was not refused too early */
			assert_true(budget - arena.used - stats.gpu_bytes_high_water < 768 << 10);
		renderer_finish(renderer);
	}
	assert_true(least > 5 * MIB && least < 16 * MIB);
	pkg_close(&pkg);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_need_covers_what_is_near_and_some_slots),
		cmocka_unit_test(the_budget_is_kept_or_refused),
		cmocka_unit_test(arena_and_gpu_share_a_budget_to_the_last_slot),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
