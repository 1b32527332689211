/* A whole frame without a GPU: nothing of ours allocates after the start, and every GPU byte is accounted for. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
/* before cmocka */
#include <cmocka.h>

#include "fake_city.h"
#include "platform/base/geo.h"
#include "render/draw_list.h"
#include "render/frame.h"

#define ARENA_BYTES ((size_t)32 << 20)

/* Interposes the allocator of the whole program. */
static unsigned long allocations;
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define COUNTS 0
#else
#define COUNTS 1
void *malloc(size_t size)
{
	allocations++;
	return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
	allocations++;
	return __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
	allocations++;
	return __libc_realloc(old, size);
}
#endif

struct fixture {
	struct fake_city city;
	uint8_t *memory;
	struct arena arena;
	struct renderer *renderer;
};

static void start(struct fixture *fixture, int blocks, const struct renderer_config *wanted)
{
	struct renderer_config config = *wanted;
	fake_city_make(&fixture->city, blocks, (const int32_t[2]){ 0, 0 });
	fixture->memory = malloc(ARENA_BYTES);
	arena_init(&fixture->arena, "city", fixture->memory, ARENA_BYTES);
	config.width = config.width ? config.width : 640;
	config.height = config.height ? config.height : 360;
	config.gfx = &gfx_dummy;
	assert_int_equal(renderer_init(&fixture->renderer, &fixture->arena, &config, &fixture->city.pkg), 0);
}

static void stop(struct fixture *fixture)
{
	renderer_finish(fixture->renderer);
	fake_city_free(&fixture->city);
	free(fixture->memory);
}

static void drive(struct fixture *fixture, int frames)
{
	for (int i = 0; i < frames; i++) {
		struct nav_view nav = { .located = true, .time_ns = i * INT64_C(33333333), .half = PKG_NONE, .ambient = -1.0 };
		nav.pos_mm[0] = 1000;
		nav.pos_mm[1] = 10000 + i * 700;
		nav.heading_bam = bam_from_rad(0.2 * (i % 60 < 30 ? i % 30 : 30 - i % 30) / 30.0);
		struct renderer_time time = { .time_ns = nav.time_ns, .ambient = -1.0, .force_night = i > frames / 2 };
		if (i % 100 == 99)
			camera_next(renderer_camera(fixture->renderer));
		renderer_draw(fixture->renderer, &nav, &time);
	}
}

static void nothing_allocates_after_the_start(void **state)
{
	(void)state;
	struct fixture fixture;
	struct renderer_config config = { .gpu_budget_bytes = 0 };
	start(&fixture, 30, &config);
	size_t used = fixture.arena.used;
	unsigned long before = allocations;
	drive(&fixture, 600);
	if (COUNTS)
		assert_int_equal(allocations, before);
	assert_int_equal(fixture.arena.used, used);
	struct renderer_stats stats;
	renderer_stats(fixture.renderer, &stats);
	assert_int_equal(stats.frames, 600);
	assert_true(stats.draws > 10);
	assert_int_equal(stats.gpu_bytes, stats.gpu_bytes_high_water);
	stop(&fixture);
}

static void nothing_allocates_while_streaming(void **state)
{
	(void)state;
	struct fixture fixture;
	/* 640 x 360 x (4 + 16 + 16) bytes of target, and some hundred chunks */
	struct renderer_config config = { .gpu_budget_bytes = 640 * 360 * 36 + 400 * 756, .upload_slice_bytes = 8000 };
	start(&fixture, 30, &config);
	unsigned long before = allocations;
	drive(&fixture, 1500);
	if (COUNTS)
		assert_int_equal(allocations, before);
	struct renderer_stats stats;
	renderer_stats(fixture.renderer, &stats);
	assert_true(stats.gpu_bytes_high_water <= config.gpu_budget_bytes);
	assert_true(stats.chunks_evicted > 0 && stats.chunks_resident < stats.chunks);
	stop(&fixture);
}

static void a_budget_too_small_for_anything_is_refused(void **state)
{
	(void)state;
	struct fake_city city;
	fake_city_make(&city, 4, (const int32_t[2]){ 0, 0 });
	uint8_t *memory = malloc(ARENA_BYTES);
	struct arena arena;
	arena_init(&arena, "city", memory, ARENA_BYTES);
	struct renderer_config config = { .width = 640, .height = 360, .gfx = &gfx_dummy, .gpu_budget_bytes = 1 << 20 };
	struct renderer *renderer;
	assert_int_equal(renderer_init(&renderer, &arena, &config, &city.pkg), -12);
	assert_null(renderer);
	arena_init(&arena, "city", memory, 2000);
	config.gpu_budget_bytes = 0;
	assert_int_equal(renderer_init(&renderer, &arena, &config, &city.pkg), -12);
	arena_init(&arena, "city", memory, ARENA_BYTES);
	config.far_name = "telepathy";
	assert_int_equal(renderer_init(&renderer, &arena, &config, &city.pkg), -22);
	free(memory);
	fake_city_free(&city);
}

static void an_empty_city_draws_sky_and_land(void **state)
{
	(void)state;
	struct fixture fixture;
	struct renderer_config config = { .samples = 1 };
	start(&fixture, 0, &config);
	drive(&fixture, 20);
	struct renderer_stats stats;
	renderer_stats(fixture.renderer, &stats);
	assert_int_equal(stats.draws, 2);
	stop(&fixture);
}

static void bytes_are_the_sum_of_what_was_made(void **state)
{
	(void)state;
	uint8_t *memory = malloc(ARENA_BYTES);
	struct arena arena;
	arena_init(&arena, "gfx", memory, ARENA_BYTES);
	struct gfx *gfx;
	struct gfx_config config = { .buffers = 3, .textures = 3, .targets = 1 };
	assert_int_equal(gfx_init(&gfx, &arena, &gfx_dummy, &config), 0);
	gfx_buffer buffers[4];
	struct gfx_buffer_desc fixed = { .kind = GFX_BUFFER_VERTEX, .bytes = 1000 };
	struct gfx_buffer_desc stream = { .kind = GFX_BUFFER_UNIFORM, .usage = GFX_STREAM, .bytes = 100 };
	assert_int_equal(gfx_buffer_create(gfx, &fixed, &buffers[0]), 0);
	assert_int_equal(gfx_buffer_create(gfx, &stream, &buffers[1]), 0);
	assert_int_equal(gfx_stats(gfx)->bytes, 1000 + 300);
	gfx_texture texture, compressed;
	/* 8x8, 4x4, 2x2, 1x1 RGBA8 of 5 layers; ETC2 in blocks of 4 x 4 */
	struct gfx_texture_desc desc = { .format = GFX_RGBA8, .width = 8, .height = 8, .layers = 5, .levels = 4 };
	struct gfx_texture_desc etc2 = { .format = GFX_ETC2_RGBA8, .width = 10, .height = 6, .levels = 2 };
	assert_int_equal(gfx_texture_create(gfx, &desc, &texture), 0);
	assert_int_equal(gfx_texture_create(gfx, &etc2, &compressed), 0);
	uint64_t textures = (64 + 16 + 4 + 1) * 4 * 5 + (3 * 2 + 2 * 1) * 16;
	assert_int_equal(gfx_stats(gfx)->bytes, 1300 + textures);
	gfx_target target;
	struct gfx_target_desc target_desc = { .width = 100, .height = 50, .samples = 16 }; /* the dummy has 4 samples */
	assert_int_equal(gfx_target_create(gfx, &target_desc, &target), 0);
	assert_int_equal(gfx_target_samples(gfx, target), 4);
	uint64_t target_bytes = 100 * 50 * (4 + 4 * 4 + 4 * 4);
	assert_int_equal(gfx_stats(gfx)->bytes, 1300 + textures + target_bytes);
	/* pools do not grow */
	assert_int_equal(gfx_buffer_create(gfx, &fixed, &buffers[2]), 0);
	assert_int_equal(gfx_buffer_create(gfx, &fixed, &buffers[3]), -12);
	assert_int_equal(buffers[3].id, 0);
	assert_int_equal(gfx_stats(gfx)->refused, 1);
	/* a slot used again has another handle */
	gfx_buffer_destroy(gfx, buffers[0]);
	assert_int_equal(gfx_buffer_create(gfx, &fixed, &buffers[3]), 0);
	assert_int_not_equal(buffers[0].id, buffers[3].id);
	gfx_target_destroy(gfx, target);
	gfx_texture_destroy(gfx, texture);
	assert_int_equal(gfx_stats(gfx)->bytes, 2300 + (3 * 2 + 2 * 1) * 16);
	uint64_t high_water = gfx_stats(gfx)->bytes_high_water;
	assert_true(high_water >= 1300 + textures + target_bytes);
	gfx_finish(gfx);
	assert_int_equal(gfx_stats(gfx)->bytes, 0);
	free(memory);
}

static void ids_are_counted_and_have_no_samples(void **state)
{
	(void)state;
	static const struct {
		enum gfx_ids ids;
		uint32_t words;
	} cases[] = { { GFX_IDS_R32UI, 1 }, { GFX_IDS_RGBA32UI, 4 } };
	static uint32_t read[20 * 10 * 4];
	uint8_t *memory = malloc(ARENA_BYTES);
	struct arena arena;
	arena_init(&arena, "gfx", memory, ARENA_BYTES);
	struct gfx *gfx;
	assert_int_equal(gfx_init(&gfx, &arena, &gfx_dummy, NULL), 0);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct gfx_target_desc desc = { .width = 100, .height = 50, .samples = 4, .ids = cases[i].ids };
		gfx_target target;
		assert_int_equal(gfx_target_create(gfx, &desc, &target), 0);
		assert_int_equal(gfx_target_samples(gfx, target), 1);
		assert_int_equal(gfx_stats(gfx)->bytes, 100 * 50 * (4 + 4 + cases[i].words * 4));
		/* of a part only the part is read */
		gfx_target_part(gfx, target, 20, 10);
		memset(read, 0xFF, sizeof(read));
		gfx_read_ids(gfx, target, read);
		assert_int_equal(read[20 * 10 * cases[i].words - 1], 0);
		if (cases[i].words == 1)
			assert_int_equal(read[20 * 10], UINT32_MAX);
		gfx_target_destroy(gfx, target);
		assert_int_equal(gfx_stats(gfx)->bytes, 0);
	}
	gfx_finish(gfx);
	free(memory);
}

static void draws_sort_by_slice_pass_and_depth(void **state)
{
	(void)state;
	uint8_t *memory = malloc(ARENA_BYTES);
	struct arena arena;
	arena_init(&arena, "list", memory, ARENA_BYTES);
	struct draw_list list;
	assert_int_equal(draw_list_init(&list, &arena, 500), 0);
	struct rng rng = rng_seed(9);
	for (int i = 0; i < 600; i++) {
		struct draw_item item = { .chunk = (uint32_t)i,
			.count = rng_u32(&rng) % 8 ? 3 : 0,
			.slice = rng_u32(&rng) & 1,
			.pass = rng_u32(&rng) & 1,
			.opacity = rng_u32(&rng) & 1 ? 255 : 100 };
		draw_list_add(&list, &item, (float)rng_range(&rng, -10.0, 4000.0));
	}
	assert_int_equal(list.count, 500);
	assert_true(list.dropped > 0);
	draw_list_sort(&list);
	for (uint32_t i = 1; i < list.count; i++) {
		const struct draw_item *a = &list.items[i - 1], *b = &list.items[i];
		bool solid = a->opacity == 255, faded_behind = solid || b->opacity < 255;
		assert_true(a->key <= b->key && a->count > 0 && faded_behind);
		if (solid == (b->opacity == 255))
			assert_true(a->slice <= b->slice);
		if (a->key == b->key)
			assert_true(a->chunk < b->chunk);
		if (a->slice == b->slice && solid == (b->opacity == 255))
			assert_true(a->pass <= b->pass);
	}
	free(memory);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_allocates_after_the_start),
		cmocka_unit_test(nothing_allocates_while_streaming),
		cmocka_unit_test(a_budget_too_small_for_anything_is_refused),
		cmocka_unit_test(an_empty_city_draws_sky_and_land),
		cmocka_unit_test(bytes_are_the_sum_of_what_was_made),
		cmocka_unit_test(ids_are_counted_and_have_no_samples),
		cmocka_unit_test(draws_sort_by_slice_pass_and_depth),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
