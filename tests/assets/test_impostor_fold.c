/* What is folded unfolds to what it was, rounded as it says; nothing else goes by what the bytes hold. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
/* before cmocka */
#include <cmocka.h>

#include "assets/impostor_fold.h"
#include "platform/base/rng.h"

#define VERTICES 500
#define INDICES 1500
#define BYTES (VERTICES * sizeof(struct pkg_impostor_vertex) + INDICES * sizeof(uint16_t))

/* Near each other and anywhere; corners as triangles use them and at random. */
static void fill(struct rng *rng, uint8_t *bytes)
{
	for (uint32_t i = 0; i < VERTICES; i++) {
		struct pkg_impostor_vertex vertex = { .page = (uint8_t)rng_u32(rng), .view_kind = (uint8_t)rng_u32(rng) };
		bool far_off = i % 50 == 0;
		for (int k = 0; k < 3; k++)
			vertex.pos_mm[k] = (int32_t)rng_u32(rng) / (far_off ? 2 : 100000);
		for (int k = 0; k < 2; k++)
			vertex.uv[k] = (uint16_t)(rng_u32(rng) % (PKG_PAGE_PX * 128 + 1));
		vertex.normal_oct[0] = (int8_t)rng_u32(rng);
		memcpy(bytes + i * sizeof(vertex), &vertex, sizeof(vertex));
	}
	for (uint32_t i = 0; i < INDICES; i++) {
		uint16_t index = (uint16_t)(i % 7 ? i / 3 : rng_u32(rng) % VERTICES);
		memcpy(bytes + VERTICES * sizeof(struct pkg_impostor_vertex) + i * sizeof(index), &index, sizeof(index));
	}
}

static void what_is_folded_comes_back_rounded(void **state)
{
	(void)state;
	static const uint16_t steps[] = { 0, 1, 5, PKG_IMPOSTOR_STEP_MAX };
	struct rng rng = rng_seed(5);
	uint8_t *had = malloc(BYTES), *got = malloc(BYTES), *scratch = malloc(impostor_fold_bytes(VERTICES, INDICES));
	for (size_t s = 0; s < sizeof(steps) / sizeof(steps[0]); s++) {
		struct pkg_impostor_head head = {
			.vertex_count = VERTICES, .index_count = INDICES, .page_count = 1, .view_count = 1, .step_log2 = steps[s]
		};
		fill(&rng, had);
		memcpy(got, had, BYTES);
		impostor_fold(&head, got, scratch);
		assert_memory_not_equal(got, had, BYTES);
		impostor_unfold(&head, got, scratch);
		for (uint32_t i = 0; i < VERTICES; i++) {
			struct pkg_impostor_vertex a, b;
			memcpy(&a, had + i * sizeof(a), sizeof(a));
			memcpy(&b, got + i * sizeof(b), sizeof(b));
			for (int k = 0; k < 3; k++)
				assert_true(llabs((int64_t)a.pos_mm[k] - b.pos_mm[k]) <= (1 << steps[s]) / 2);
			for (int k = 0; k < 2; k++)
				assert_true(abs(a.uv[k] - b.uv[k]) <= 4 && b.uv[k] <= PKG_PAGE_PX * 128);
			assert_memory_equal(&a.page, &b.page, 4);
		}
		const size_t indices = VERTICES * sizeof(struct pkg_impostor_vertex);
		assert_memory_equal(got + indices, had + indices, BYTES - indices);
	}
	free(had);
	free(got);
	free(scratch);
}

/* Rounded once, bytes stay as they are: a package that is written again does not drift. */
static void folding_again_changes_nothing(void **state)
{
	(void)state;
	struct rng rng = rng_seed(6);
	struct pkg_impostor_head head = { .vertex_count = VERTICES, .index_count = INDICES, .step_log2 = 3 };
	uint8_t *once = malloc(BYTES), *twice = malloc(BYTES), *scratch = malloc(impostor_fold_bytes(VERTICES, INDICES));
	fill(&rng, once);
	impostor_fold(&head, once, scratch);
	memcpy(twice, once, BYTES);
	impostor_unfold(&head, twice, scratch);
	impostor_fold(&head, twice, scratch);
	assert_memory_equal(once, twice, BYTES);
	free(once);
	free(twice);
	free(scratch);
}

static void any_bytes_unfold(void **state)
{
	(void)state;
	struct rng rng = rng_seed(7);
	uint8_t *bytes = malloc(BYTES), *scratch = malloc(impostor_fold_bytes(VERTICES, INDICES));
	for (uint16_t step = 0; step <= PKG_IMPOSTOR_STEP_MAX; step++) {
		struct pkg_impostor_head head = { .vertex_count = VERTICES, .index_count = INDICES, .step_log2 = step };
		for (size_t i = 0; i < BYTES; i++)
			bytes[i] = (uint8_t)rng_u32(&rng);
		impostor_unfold(&head, bytes, scratch);
	}
	impostor_unfold(&(struct pkg_impostor_head){ 0 }, bytes, scratch);
	free(bytes);
	free(scratch);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_folded_comes_back_rounded),
		cmocka_unit_test(folding_again_changes_nothing),
		cmocka_unit_test(any_bytes_unfold),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
