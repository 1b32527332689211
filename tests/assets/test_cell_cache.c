/* Stretches in memory along simulated drives: in time, never more than the slots, damaged ones left out. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
/* before cmocka */
#include <cmocka.h>

#include "assets/cell_cache.h"
#include "tests/assets/far_city.h"

#define STRETCHES 200

static const struct far_city_config street = { .edges = 50,
	.stretches_an_edge = 4,
	.objects_a_chunk = 5,
	.triangles_an_object = 30,
	.impostor_vertices = 60,
	.impostor_pages = 1,
	.geometry_every = 10 };

static _Alignas(64) uint8_t memory[8 << 20];
static struct arena arena;
static struct pkg pkg;

static int open_street(void **state)
{
	(void)state;
	size_t size;
	struct pkg_fault fault;
	uint8_t *bytes = far_city_build(&street, &size);
	int status = far_city_open(bytes, size, &pkg, &fault);
	free(bytes);
	return status;
}

static int close_street(void **state)
{
	(void)state;
	pkg_close(&pkg);
	return 0;
}

static uint8_t look_of(uint32_t kinds)
{
	return kinds & 1 ? 1 : 2;
}

static struct cell_cache *make(const struct cell_cache_config *config)
{
	struct cell_cache *cache;
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(cell_cache_init(&cache, &arena, &pkg, config), 0);
	assert_true(arena.used <= cell_cache_bytes(&pkg, config));
	return cache;
}

static void upload_one(struct cell_cache *cache)
{
	uint32_t slot = cell_cache_next_ready(cache);
	if (slot != CELL_SLOT_NONE)
		cell_cache_uploaded(cache, slot);
}

/* Until it is there, in real time. */
static enum cell_state wait_for(struct cell_cache *cache, uint32_t stretch)
{
	for (int i = 0; i < 5000; i++) {
		cell_cache_update(cache, &stretch, 1, NULL, 0);
		enum cell_state state = cell_cache_find(cache, stretch, NULL);
		if (state != CELL_WANTED && state != CELL_LOADING)
			return state;
		nanosleep(&(struct timespec){ .tv_nsec = 1000000 }, NULL);
	}
	return CELL_EMPTY;
}

/* Every triangle that a set draws is the one in the package; in ranges and in parts. Returns how many there are. */
static uint32_t check_set(const struct cell_set *set)
{
	uint32_t indices = 0, parts = 0;
	for (uint32_t r = 0; r < set->range_count; r++) {
		const struct cell_range *range = &set->ranges[r];
		const struct pkg_chunk *chunk = &pkg.chunks[range->chunk];
		assert_int_equal(range->first, indices);
		assert_int_equal(range->first_part, parts);
		assert_true(r == 0 || range[-1].chunk <= range->chunk);
		uint32_t sum = 0;
		for (uint32_t p = parts; p < parts + range->part_count; p++) {
			const struct pkg_object *object = &pkg.objects[set->parts[p].object];
			assert_int_equal(object->chunk, range->chunk);
			assert_int_equal(set->parts[p].first, indices + sum);
			sum += set->parts[p].count;
			const uint16_t *theirs = pkg_chunk_indices(&pkg, chunk) + object->first_index[range->pass], *end;
			end = theirs + object->index_count[range->pass];
			for (uint32_t i = set->parts[p].first; i < set->parts[p].first + set->parts[p].count; i += 3) {
				/* the object's next triangle with these corners */
				const struct pkg_mesh_vertex *vertices = pkg_chunk_vertices(&pkg, chunk);
				for (;; theirs += 3) {
					assert_true(theirs < end);
					bool same = true;
					for (int corner = 0; corner < 3; corner++) {
						uint16_t index = set->indices[i + (uint32_t)corner];
						const struct pkg_mesh_vertex *vertex =
							set->vertices ? &set->vertices[range->first_vertex + index] : &vertices[index];
						same &= !memcmp(vertex, &vertices[theirs[corner]], sizeof(*vertex));
					}
					if (same)
						break;
				}
				theirs += 3;
			}
		}
		assert_int_equal(sum, range->count);
		indices += range->count;
		parts += range->part_count;
	}
	assert_int_equal(indices, set->index_count);
	assert_int_equal(parts, set->part_count);
	return indices / 3;
}

static void a_stretch_is_ready_to_be_drawn(void **state)
{
	(void)state;
	struct cell_cache *cache = make(&(struct cell_cache_config){ .look_of = look_of });
	assert_int_equal(wait_for(cache, 7), CELL_READY);
	uint32_t slot;
	cell_cache_find(cache, 7, &slot);
	const struct cell_slot *content = cell_cache_slot(cache, slot);
	assert_int_equal(content->stretch, 7);
	assert_int_not_equal(content->generation, 0);
	assert_int_equal(check_set(&content->local), pkg.stretches[7].local_triangles);
	assert_int_equal(content->local.range_count, 4); /* two chunks, two passes, one look each */
	assert_int_equal(content->local.ranges[0].look, 1);
	assert_false(content->has_pvs);
	for (int side = 0; side < 2; side++) {
		assert_int_equal(content->impostor[side].head.vertex_count, 60);
		assert_int_equal(content->impostor[side].views[1].axis[3], 1);
		assert_non_null(content->impostor[side].pages);
	}
	cell_cache_uploaded(cache, slot);
	assert_int_equal(cell_cache_find(cache, 7, NULL), CELL_UPLOADED);
	assert_null(content->local.indices);
	assert_null(content->impostor[1].pages);
	assert_int_equal(content->impostor[1].views[1].axis[3], 1);
	cell_cache_finish(cache);
}

static void visible_sets_come_as_asked_for(void **state)
{
	(void)state;
	static const struct {
		enum cell_pvs pvs;
		bool without_impostors;
		uint32_t stretch;
		bool has_pvs, own_vertices;
	} table[] = {
		{ CELL_PVS_WHERE_NEEDED, false, 11, false, false },
		{ CELL_PVS_WHERE_NEEDED, false, 20, true, true },
		{ CELL_PVS_ALWAYS, true, 11, true, false },
		{ CELL_PVS_ALWAYS, true, 20, true, false },
		{ CELL_PVS_NEVER, false, 20, false, false },
	};
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		struct cell_cache *cache =
			make(&(struct cell_cache_config){ .pvs = table[i].pvs, .without_impostors = table[i].without_impostors });
		uint32_t slot;
		assert_int_equal(cell_cache_wait(cache, table[i].stretch), CELL_READY);
		cell_cache_find(cache, table[i].stretch, &slot);
		const struct cell_slot *content = cell_cache_slot(cache, slot);
		assert_int_equal(content->has_pvs, table[i].has_pvs);
		assert_int_equal(content->pvs.vertices != NULL, table[i].own_vertices);
		if (table[i].has_pvs)
			assert_int_equal(check_set(&content->pvs), pkg.stretches[table[i].stretch].pvs_triangles);
		if (table[i].own_vertices)
			assert_true(content->pvs.vertex_count < content->pvs.index_count);
		bool impostor = !table[i].without_impostors && table[i].stretch % 10;
		assert_int_equal(content->impostor[0].head.vertex_count != 0, impostor);
		cell_cache_finish(cache);
	}
}

struct drive {
	double speed_mps;
	uint32_t latency;      /* frames that a load takes */
	uint32_t upload_every; /* frames between two uploads */
	uint32_t slots;
};

/* What a frame at a place wants: here, three ahead, one behind. */
static uint32_t wishes(uint32_t here, uint32_t out[5])
{
	uint32_t count = 0;
	for (int step = 0; step < 5; step++) {
		static const int order[] = { 0, 1, 2, -1, 3 };
		int at = (int)here + order[step];
		if (at >= 0 && at < STRETCHES)
			out[count++] = (uint32_t)at;
	}
	return count;
}

/* Drives the street; returns the frames in which the stretch under the car could not be drawn, and a sum over the
 * states of all frames. */
static uint32_t drive(struct cell_cache *cache, const struct drive *how, uint64_t *trace)
{
	uint32_t missing = 0, before = 0;
	cell_cache_wait(cache, 0);
	upload_one(cache);
	for (uint32_t frame = 0;; frame++) {
		uint32_t here = (uint32_t)(frame / 60.0 * how->speed_mps * 1000.0 / FAR_CITY_STRETCH_MM), wanted[5];
		if (here >= STRETCHES)
			return missing;
		const uint32_t pinned[] = { here, before };
		cell_cache_update(cache, wanted, wishes(here, wanted), pinned, 2);
		if (frame % how->upload_every == 0)
			upload_one(cache);
		uint32_t used = 0;
		for (uint32_t i = 0; i < cell_cache_slot_count(cache); i++) {
			const struct cell_slot *slot = cell_cache_slot(cache, i);
			used += slot->state != CELL_EMPTY;
			*trace = *trace * 31 + slot->stretch * 8 + slot->state;
		}
		assert_true(used <= how->slots);
		bool drawn = cell_cache_find(cache, here, NULL) == CELL_UPLOADED;
		missing += !drawn;
		if (drawn && before != here) /* the last one may go once this one is there */
			before = here;
	}
}

static void a_drive_is_never_late(void **state)
{
	(void)state;
	static const struct drive drives[] = {
		{ 50 / 3.6, 6, 3, 8 },
		{ 50 / 3.6, 30, 10, 8 },
		{ 130 / 3.6, 6, 3, 8 },
		{ 130 / 3.6, 20, 6, 8 },
		{ 130 / 3.6, 20, 6, 6 },
	};
	for (size_t i = 0; i < sizeof(drives) / sizeof(drives[0]); i++) {
		uint64_t trace[2] = { 0, 0 };
		for (int round = 0; round < (i < 2 ? 1 : 2); round++) {
			struct cell_cache *cache = make(&(struct cell_cache_config){
				.slot_count = drives[i].slots, .deterministic = true, .latency_updates = drives[i].latency });
			size_t used = arena.used;
			assert_int_equal(drive(cache, &drives[i], &trace[round]), 0);
			struct cell_cache_stats stats;
			cell_cache_stats(cache, &stats);
			assert_int_equal(stats.late_updates, 0);
			assert_int_equal(stats.loads, STRETCHES);
			assert_int_equal(stats.evictions, STRETCHES - drives[i].slots);
			assert_int_equal(stats.damaged + stats.too_large + stats.refused, 0);
			assert_int_equal(arena.used, used);
			cell_cache_finish(cache);
		}
		if (i >= 2)
			assert_true(trace[0] == trace[1]); /* whatever the thread's speed */
	}
}

static void what_comes_too_late_is_counted(void **state)
{
	(void)state;
	struct cell_cache *cache = make(&(struct cell_cache_config){ .deterministic = true, .latency_updates = 7 });
	struct cell_cache_stats stats;
	for (uint32_t round = 1; round <= 3; round++) {
		const uint32_t there = round * 50; /* nobody could know */
		for (int i = 0; i < 20; i++)
			cell_cache_update(cache, &there, 1, NULL, 0);
		upload_one(cache);
		cell_cache_stats(cache, &stats);
		assert_int_equal(stats.late_updates, 7 * round);
	}
	cell_cache_finish(cache);
}

static void pinned_slots_stay_and_the_longest_unwanted_goes(void **state)
{
	(void)state;
	struct cell_cache *cache = make(&(struct cell_cache_config){ .slot_count = 4 });
	for (uint32_t i = 0; i < 4; i++) {
		assert_int_equal(cell_cache_wait(cache, i), CELL_READY);
		upload_one(cache);
		cell_cache_update(cache, &i, 1, NULL, 0);
	}
	const uint32_t pinned = 0;
	for (uint32_t i = 4; i < 20; i++) {
		cell_cache_update(cache, &i, 1, &pinned, 1);
		assert_int_equal(cell_cache_wait(cache, i), CELL_READY);
		upload_one(cache);
		assert_int_equal(cell_cache_find(cache, 0, NULL), CELL_UPLOADED);
		assert_int_equal(cell_cache_find(cache, i - 1, NULL), CELL_UPLOADED);
		assert_int_equal(cell_cache_find(cache, i - 2, NULL), CELL_UPLOADED);
		assert_int_equal(cell_cache_find(cache, i - 3, NULL), CELL_EMPTY);
	}
	/* more wishes than slots: the first ones win, the rest is counted */
	const uint32_t many[] = { 50, 51, 52, 53, 54, 55 };
	struct cell_cache_stats before, after;
	cell_cache_stats(cache, &before);
	for (int i = 0; i < 3; i++)
		assert_int_equal(cell_cache_wait(cache, many[i]), CELL_READY), upload_one(cache);
	cell_cache_update(cache, many, 6, &pinned, 1);
	cell_cache_stats(cache, &after);
	assert_int_equal(after.refused - before.refused, 3);
	for (int i = 0; i < 3; i++)
		assert_int_equal(cell_cache_find(cache, many[i], NULL), CELL_UPLOADED);
	cell_cache_finish(cache);
}

static void an_urgent_wish_takes_the_memory_of_a_lesser_one(void **state)
{
	(void)state;
	struct cell_cache *cache = make(&(struct cell_cache_config){ .staging_count = 2, .deterministic = true });
	uint32_t first[] = { 10, 11, 12 }, then[] = { 90, 10, 11, 12 };
	for (int i = 0; i < 8; i++)
		cell_cache_update(cache, first, 3, NULL, 0);
	assert_int_equal(cell_cache_find(cache, 11, NULL), CELL_READY);
	assert_int_equal(cell_cache_find(cache, 12, NULL), CELL_WANTED); /* nobody uploads: both buffers are full */
	for (int i = 0; i < 8; i++)
		cell_cache_update(cache, then, 4, NULL, 0);
	assert_int_equal(cell_cache_find(cache, 90, NULL), CELL_READY);
	cell_cache_finish(cache);
}

static void neighbours_in_the_list_do_not_throw_each_other_out(void **state)
{
	(void)state;
	struct cell_cache *cache = make(&(struct cell_cache_config){ .slot_count = 4, .deterministic = true });
	uint32_t list[2][6] = { { 10, 11, 12, 13, 14, 15 }, { 10, 11, 12, 14, 13, 15 } };
	for (int i = 0; i < 100; i++) {
		cell_cache_update(cache, list[i % 2], 6, NULL, 0);
		upload_one(cache);
	}
	struct cell_cache_stats stats;
	cell_cache_stats(cache, &stats);
	assert_int_equal(stats.loads, 4);
	const uint32_t jump[] = { 15, 10, 11, 12, 13, 14 };
	for (int i = 0; i < 10; i++)
		cell_cache_update(cache, jump, 6, NULL, 0);
	assert_int_equal(cell_cache_find(cache, 15, NULL), CELL_READY);
	assert_int_equal(cell_cache_find(cache, 13, NULL), CELL_EMPTY);
	cell_cache_finish(cache);
}

static void nonsense_is_ignored(void **state)
{
	(void)state;
	struct cell_cache *cache = make(&(struct cell_cache_config){ 0 });
	const uint32_t wanted[] = { PKG_NONE, STRETCHES, 3, 3, UINT32_MAX - 1, 3 }, pinned[] = { PKG_NONE, 3, 700 };
	for (int i = 0; i < 5; i++)
		cell_cache_update(cache, wanted, 6, pinned, 3);
	assert_int_equal(cell_cache_wait(cache, 3), CELL_READY);
	assert_int_equal(cell_cache_wait(cache, STRETCHES), CELL_EMPTY);
	assert_int_equal(cell_cache_wait(cache, PKG_NONE), CELL_EMPTY);
	assert_int_equal(cell_cache_find(cache, PKG_NONE, NULL), CELL_EMPTY);
	cell_cache_finish(cache);
	cell_cache_finish(NULL);
}

static void damaged_stretches_are_left_out_once(void **state)
{
	(void)state;
	struct pkg good = pkg;
	uint8_t *blobs = malloc(pkg.blobs_bytes);
	memcpy(blobs, pkg.blobs, pkg.blobs_bytes);
	blobs[pkg.stretches[5].local.offset + 9] ^= 4;
	blobs[pkg.cells[2 * 6 + 1].impostor.offset + 9] ^= 4;
	pkg.blobs = blobs;
	struct cell_cache *cache = make(&(struct cell_cache_config){ .deterministic = true });
	struct drive how = { 130 / 3.6, 2, 1, 16 };
	uint64_t trace = 0;
	uint32_t missing = drive(cache, &how, &trace);
	assert_true(missing > 100 && missing < 200); /* two stretches */
	struct cell_cache_stats stats;
	cell_cache_stats(cache, &stats);
	assert_int_equal(stats.damaged, 2);
	assert_int_equal(stats.late_updates, 0);
	assert_int_equal(stats.loads, STRETCHES - 2);
	assert_int_equal(cell_cache_find(cache, 5, NULL), CELL_DAMAGED);
	assert_int_equal(cell_cache_wait(cache, 6), CELL_DAMAGED);
	cell_cache_finish(cache);
	free(blobs);
	pkg = good;
}

static void what_does_not_fit_is_left_out(void **state)
{
	(void)state;
	struct cell_cache *cache = make(&(struct cell_cache_config){ .staging_bytes = 40000 });
	assert_int_equal(cell_cache_wait(cache, 5), CELL_TOO_LARGE);
	assert_int_equal(cell_cache_wait(cache, 10), CELL_READY); /* no impostor */
	struct cell_cache_stats stats;
	cell_cache_stats(cache, &stats);
	assert_int_equal(stats.too_large, 1);
	cell_cache_finish(cache);
}

static void a_small_arena_or_no_far_field_is_an_error(void **state)
{
	(void)state;
	struct cell_cache *cache;
	const struct cell_cache_config config = { 0 };
	for (size_t size = 0; size < 200000; size += 4999) {
		arena_init(&arena, "test", memory, size);
		assert_int_equal(cell_cache_init(&cache, &arena, &pkg, &config), -ENOMEM);
	}
	struct pkg none = { 0 };
	arena_init(&arena, "test", memory, sizeof(memory));
	assert_int_equal(cell_cache_init(&cache, &arena, &none, &config), -ENODATA);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_stretch_is_ready_to_be_drawn),
		cmocka_unit_test(visible_sets_come_as_asked_for),
		cmocka_unit_test(a_drive_is_never_late),
		cmocka_unit_test(what_comes_too_late_is_counted),
		cmocka_unit_test(pinned_slots_stay_and_the_longest_unwanted_goes),
		cmocka_unit_test(an_urgent_wish_takes_the_memory_of_a_lesser_one),
		cmocka_unit_test(neighbours_in_the_list_do_not_throw_each_other_out),
		cmocka_unit_test(nonsense_is_ignored),
		cmocka_unit_test(damaged_stretches_are_left_out_once),
		cmocka_unit_test(what_does_not_fit_is_left_out),
		cmocka_unit_test(a_small_arena_or_no_far_field_is_an_error),
	};
	return cmocka_run_group_tests(tests, open_street, close_street);
}
