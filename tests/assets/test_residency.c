/* The range pool against a plain model; chunks that come and go under a fixed budget. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
/* before cmocka */
#include <cmocka.h>
#include <zlib.h>

#include "assets/residency.h"
#include "platform/base/rng.h"

static uint8_t memory[4 << 20];

static struct arena fresh_arena(void)
{
	struct arena arena;
	arena_init(&arena, "test", memory, sizeof(memory));
	return arena;
}

#define POOL_UNITS 1000
#define RANGES 64

/* Longest run of units that nobody has. */
static uint32_t longest_hole(const uint8_t *taken)
{
	uint32_t longest = 0, run = 0;
	for (uint32_t i = 0; i < POOL_UNITS; i++) {
		run = taken[i] ? 0 : run + 1;
		longest = run > longest ? run : longest;
	}
	return longest;
}

static void ranges_never_overlap_and_holes_are_found(void **state)
{
	(void)state;
	struct arena arena = fresh_arena();
	struct range_pool pool;
	assert_int_equal(range_pool_init(&pool, &arena, POOL_UNITS, RANGES), 0);
	size_t used = arena.used;
	uint8_t taken[POOL_UNITS] = { 0 };
	struct {
		uint32_t first, count;
	} live[RANGES];
	uint32_t live_count = 0;
	struct rng rng = rng_seed(5);
	for (int step = 0; step < 200000; step++) {
		if (live_count < RANGES && (rng_u32(&rng) & 1)) {
			uint32_t count = 1 + rng_u32(&rng) % 90, first = range_pool_take(&pool, count);
			if (first == RANGE_NONE) {
				assert_true(longest_hole(taken) < count);
				continue;
			}
			for (uint32_t i = first; i < first + count; i++)
				assert_int_equal(taken[i]++, 0);
			live[live_count].first = first;
			live[live_count++].count = count;
		} else if (live_count) {
			uint32_t pick = rng_u32(&rng) % live_count;
			range_pool_give(&pool, live[pick].first, live[pick].count);
			memset(taken + live[pick].first, 0, live[pick].count);
			live[pick] = live[--live_count];
		}
	}
	while (live_count--)
		range_pool_give(&pool, live[live_count].first, live[live_count].count);
	assert_int_equal(pool.free_units, POOL_UNITS);
	assert_int_equal(range_pool_take(&pool, POOL_UNITS), 0);
	assert_int_equal(arena.used, used);
}

#define SIDE 20
#define CHUNKS (SIDE * SIDE)
#define CHUNK_VERTICES 12
#define CHUNK_INDICES 18
#define CHUNK_BYTES (CHUNK_VERTICES * sizeof(struct pkg_mesh_vertex) + CHUNK_INDICES * 2)
#define STEP_MM 50000

struct city {
	struct pkg pkg;
	struct pkg_meta meta;
	struct pkg_chunk chunks[CHUNKS];
	uint8_t geometry[CHUNKS * 512];
	uint32_t uploads;
	uint64_t uploaded_bytes;
};

static void sign_chunk(struct city *city, struct pkg_chunk *chunk)
{
	uLong crc = crc32(0, city->geometry + chunk->vertex_offset, CHUNK_VERTICES * sizeof(struct pkg_mesh_vertex));
	chunk->crc32 = (uint32_t)crc32(crc, city->geometry + chunk->index_offset, chunk->index_count[0] * 2);
}

static struct city *make_city(void)
{
	struct city *city = calloc(1, sizeof(*city));
	for (uint32_t i = 0; i < CHUNKS; i++) {
		struct pkg_chunk *chunk = &city->chunks[i];
		chunk->min_mm[0] = (int32_t)(i % SIDE) * STEP_MM;
		chunk->min_mm[1] = (int32_t)(i / SIDE) * STEP_MM;
		for (int axis = 0; axis < 2; axis++)
			chunk->max_mm[axis] = chunk->min_mm[axis] + STEP_MM;
		chunk->vertex_count = CHUNK_VERTICES;
		chunk->index_count[0] = CHUNK_INDICES;
		chunk->vertex_offset = i * 512;
		chunk->index_offset = i * 512 + 320;
		uint16_t *indices = (uint16_t *)(void *)(city->geometry + chunk->index_offset);
		for (uint16_t k = 0; k < CHUNK_INDICES; k++)
			indices[k] = k % CHUNK_VERTICES;
		sign_chunk(city, chunk);
	}
	city->meta.max_mm[0] = city->meta.max_mm[1] = SIDE * STEP_MM;
	city->pkg = (struct pkg){ .meta = &city->meta,
		.chunks = city->chunks,
		.chunk_count = CHUNKS,
		.geometry = city->geometry,
		.geometry_bytes = sizeof(city->geometry),
		.material_count = 1 };
	return city;
}

static void count_upload(void *context, uint32_t chunk, const struct residency_chunk *place)
{
	struct city *city = context;
	assert_int_equal(place->state, RESIDENCY_PRESENT);
	assert_true(chunk < CHUNKS);
	city->uploads++;
	city->uploaded_bytes += CHUNK_BYTES;
}

static void a_city_that_fits_is_loaded_at_once(void **state)
{
	(void)state;
	struct city *city = make_city();
	struct arena arena = fresh_arena();
	struct residency residency;
	assert_int_equal(
		residency_init(&residency, &arena, &city->pkg, CHUNKS * CHUNK_VERTICES, CHUNKS * CHUNK_INDICES), 0);
	assert_true(residency.whole);
	residency_update(&residency, (const int64_t[3]){ 0 }, 1000000, UINT64_MAX, count_upload, city);
	assert_int_equal(residency.present, CHUNKS);
	assert_int_equal(city->uploads, CHUNKS);
	assert_int_equal(residency.pending_bytes, 0);
	/* neighbours on the curve are neighbours in the city */
	uint64_t far = 0;
	for (uint32_t i = 1; i < CHUNKS; i++) {
		const struct pkg_chunk *a = &city->chunks[residency.order[i - 1]], *b = &city->chunks[residency.order[i]];
		int32_t dx = abs(a->min_mm[0] - b->min_mm[0]), dy = abs(a->min_mm[1] - b->min_mm[1]);
		far += dx + dy > 3 * STEP_MM;
	}
	assert_true(far < CHUNKS / 10);
	free(city);
}

static void what_is_seen_first_takes_its_place_on_the_curve(void **state)
{
	(void)state;
	struct city *city = make_city();
	struct arena arena = fresh_arena();
	struct residency residency;
	residency_init(&residency, &arena, &city->pkg, CHUNKS * CHUNK_VERTICES, CHUNKS * CHUNK_INDICES);
	const struct residency_chunk seen = residency.chunks[7];
	for (int i = 0; i < 2; i++)
		residency_load_now(&residency, 7, count_upload, city);
	assert_int_equal(residency.present, 1);
	assert_false(residency_complete(&residency));
	for (int frame = 0; frame < CHUNKS && !residency_complete(&residency); frame++)
		residency_update(&residency, (const int64_t[3]){ 0 }, 1000000, 3 * CHUNK_BYTES, count_upload, city);
	assert_true(residency_complete(&residency));
	assert_int_equal(city->uploads, CHUNKS);
	assert_int_equal(residency.pending_bytes, 0);
	assert_int_equal(residency.chunks[7].first_vertex, seen.first_vertex);
	for (uint32_t i = 1; i < CHUNKS; i++) /* nobody lies on anybody */
		assert_int_equal(residency.chunks[residency.order[i]].first_vertex, i * CHUNK_VERTICES);
	free(city);
}

static void a_damaged_chunk_is_left_out_and_counted(void **state)
{
	(void)state;
	struct city *city = make_city();
	city->geometry[7 * 512 + 3] ^= 1;
	struct arena arena = fresh_arena();
	struct residency residency;
	residency_init(&residency, &arena, &city->pkg, CHUNKS * CHUNK_VERTICES, CHUNKS * CHUNK_INDICES);
	for (int i = 0; i < 3; i++)
		residency_update(&residency, (const int64_t[3]){ 0 }, 1000000, UINT64_MAX, count_upload, city);
	assert_int_equal(residency.damaged, 1);
	assert_int_equal(residency.present, CHUNKS - 1);
	assert_int_equal(residency.chunks[7].state, RESIDENCY_DAMAGED);
	assert_int_equal(residency.pending_bytes, 0);
	free(city);
}

static void a_small_pool_holds_what_is_near_and_never_grows(void **state)
{
	(void)state;
	struct city *city = make_city();
	struct arena arena = fresh_arena();
	struct residency residency;
	const uint32_t room = 60;
	residency_init(&residency, &arena, &city->pkg, room * CHUNK_VERTICES, room * CHUNK_INDICES);
	assert_false(residency.whole);
	size_t used = arena.used;
	const uint64_t slice = 2000;
	for (int step = 0; step < 390; step++) {
		int64_t eye[3] = { step * 2500, step * 1700, 2000 };
		uint64_t before = city->uploaded_bytes;
		residency_update(&residency, eye, 400000, slice, count_upload, city);
		assert_true(city->uploaded_bytes - before <= slice);
		assert_true(residency.present <= room);
		/* the chunk the eye is over is there once loading has caught up */
		uint32_t here = (uint32_t)(eye[1] / STEP_MM) * SIDE + (uint32_t)(eye[0] / STEP_MM);
		if (step > 20)
			assert_int_equal(residency.chunks[here].state, RESIDENCY_PRESENT);
	}
	assert_true(residency.evicted > 0 && residency.dropped > 0);
	assert_int_equal(arena.used, used);
	assert_int_equal(residency.present + residency.evicted, city->uploads);
	free(city);
}

static void standing_still_loads_nothing_more(void **state)
{
	(void)state;
	struct city *city = make_city();
	struct arena arena = fresh_arena();
	struct residency residency;
	residency_init(&residency, &arena, &city->pkg, 60 * CHUNK_VERTICES, 60 * CHUNK_INDICES);
	const int64_t eye[3] = { 500000, 500000, 2000 };
	for (int i = 0; i < 50; i++)
		residency_update(&residency, eye, 400000, 4000, count_upload, city);
	uint64_t loaded = city->uploaded_bytes, evicted = residency.evicted;
	for (int i = 0; i < 50; i++)
		residency_update(&residency, eye, 400000, 4000, count_upload, city);
	assert_int_equal(city->uploaded_bytes, loaded);
	assert_int_equal(residency.evicted, evicted);
	free(city);
}

/* Streets along every other row of chunks; the chunks of one quarter are three times as large. */
static void add_streets(struct city *city, struct pkg_edge edges[SIDE / 2], struct pkg_point points[SIDE])
{
	for (uint32_t i = 0; i < SIDE / 2; i++) {
		points[2 * i] = (struct pkg_point){ { 0, (int32_t)(2 * i) * STEP_MM + 20000 } };
		points[2 * i + 1] = (struct pkg_point){ { SIDE * STEP_MM, (int32_t)(2 * i) * STEP_MM + 20000 } };
		edges[i] = (struct pkg_edge){ .first_point = 2 * i, .point_count = 2 };
	}
	city->pkg.graph =
		(struct pkg_graph){ .edges = edges, .edge_count = SIDE / 2, .points = points, .point_count = SIDE };
	for (uint32_t i = 0; i < CHUNKS; i++)
		if (i % SIDE < SIDE / 2 && i / SIDE < SIDE / 2)
			city->chunks[i].index_count[0] *= 3;
}

/* Indices of all chunks within a radius of a place. */
static uint64_t indices_near(const struct city *city, const int64_t eye_mm[2], double radius_mm)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < CHUNKS; i++) {
		double out[2];
		for (int axis = 0; axis < 2; axis++)
			out[axis] = fmax(fmax((double)(city->chunks[i].min_mm[axis] - eye_mm[axis]),
								 (double)(eye_mm[axis] - city->chunks[i].max_mm[axis])),
				0.0);
		if (out[0] * out[0] + out[1] * out[1] <= radius_mm * radius_mm)
			sum += city->chunks[i].index_count[0];
	}
	return sum;
}

static void the_bound_holds_on_every_street(void **state)
{
	(void)state;
	struct city *city = make_city();
	struct pkg_edge edges[SIDE / 2];
	struct pkg_point points[SIDE];
	add_streets(city, edges, points);
	struct arena arena = fresh_arena();
	for (double radius_m = 0.0; radius_m < 500.0; radius_m += 60.0) {
		uint64_t vertices, indices, most = 0, most_beyond = 0;
		size_t used = arena.used;
		assert_int_equal(residency_bound(&city->pkg, &arena, radius_m, &vertices, &indices), 0);
		assert_int_equal(arena.used, used);
		for (int64_t row = 0; row < SIDE; row += 2) {
			for (int64_t x = 0; x <= SIDE * STEP_MM; x += 7000) {
				const int64_t eye[2] = { x, row * STEP_MM + 20000 };
				uint64_t sum = indices_near(city, eye, radius_m * 1000.0);
				uint64_t beyond = indices_near(city, eye, radius_m * 1000.0 + 50000.0);
				most = sum > most ? sum : most;
				most_beyond = beyond > most_beyond ? beyond : most_beyond;
			}
		}
		assert_true(indices >= most);
		assert_true(indices <= most_beyond); /* and is not far above */
		assert_true(vertices < CHUNKS * CHUNK_VERTICES);
	}
	free(city);
}

static void pools_of_that_size_hold_all_that_is_near(void **state)
{
	(void)state;
	struct city *city = make_city();
	struct pkg_edge edges[SIDE / 2];
	struct pkg_point points[SIDE];
	add_streets(city, edges, points);
	for (uint32_t i = 0; i < CHUNKS; i++) { /* sizes of all kinds: holes */
		city->chunks[i].index_count[0] = 3 + 3 * (i * 7 % 5);
		sign_chunk(city, &city->chunks[i]);
	}
	struct arena arena = fresh_arena();
	uint64_t vertices, indices;
	assert_int_equal(residency_pools(&city->pkg, &arena, 200.0, &vertices, &indices), 0);
	assert_true(vertices < CHUNKS * CHUNK_VERTICES / 2);
	struct residency residency;
	residency_init(&residency, &arena, &city->pkg, (uint32_t)vertices, (uint32_t)indices);
	for (int lap = 0; lap < 3; lap++) {
		for (int64_t row = 0; row < SIDE; row += 2) {
			for (int64_t x = 0; x <= SIDE * STEP_MM; x += 5000) {
				const int64_t eye[3] = { row % 4 ? SIDE * STEP_MM - x : x, row * STEP_MM + 20000, 0 };
				residency_update(&residency, eye, 200000, UINT64_MAX, count_upload, city);
				assert_int_equal(residency.pending_bytes, 0);
			}
		}
	}
	assert_int_equal(residency.dropped, 0);
	assert_true(residency.evicted > 0);
	free(city);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ranges_never_overlap_and_holes_are_found),
		cmocka_unit_test(a_city_that_fits_is_loaded_at_once),
		cmocka_unit_test(what_is_seen_first_takes_its_place_on_the_curve),
		cmocka_unit_test(a_damaged_chunk_is_left_out_and_counted),
		cmocka_unit_test(a_small_pool_holds_what_is_near_and_never_grows),
		cmocka_unit_test(standing_still_loads_nothing_more),
		cmocka_unit_test(the_bound_holds_on_every_street),
		cmocka_unit_test(pools_of_that_size_hold_all_that_is_near),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
