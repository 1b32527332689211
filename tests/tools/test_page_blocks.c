#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <math.h>
#include <zlib.h>

#include "platform/base/rng.h"
#include "tools/bake/etc2.h"
#include "tools/impostor/page_blocks.h"

#define TEXELS (PKG_PAGE_PX * PKG_PAGE_PX)

static uint8_t page[TEXELS][4], shown[TEXELS][4];
static uint8_t plain[PKG_PAGE_BYTES], blocks[PKG_PAGE_BYTES], again[PKG_PAGE_BYTES];

/* Rows of windows on a wall that gets darker towards one side, with some noise; the right half of the page is empty. */
static void paint_wall(int noise)
{
	struct rng rng = rng_seed(5);
	memset(page, 0, sizeof(page));
	for (uint32_t y = 0; y < PKG_PAGE_PX; y++) {
		for (uint32_t x = 0; x < PKG_PAGE_PX / 2; x++) {
			bool window = x % 11 < 5 && y % 13 < 7;
			for (int c = 0; c < 3; c++) {
				int level = (window ? 60 + 10 * c : 170 - 15 * c) - (int)x / 8;
				level += noise ? (int)(rng_unit(&rng) * noise) : 0;
				page[y * PKG_PAGE_PX + x][c] = (uint8_t)level;
			}
			page[y * PKG_PAGE_PX + x][3] = 128;
		}
	}
}

static void encode(void)
{
	etc2_encode(plain, (const uint8_t(*)[4])page, PKG_PAGE_PX, PKG_PAGE_PX);
	page_blocks(page[0], blocks);
}

static double rms_of(const uint8_t *coded)
{
	double sum = 0;
	size_t count = 0;
	etc2_decode(shown, coded, PKG_PAGE_PX, PKG_PAGE_PX);
	for (size_t i = 0; i < TEXELS; i++) {
		for (int c = 0; c < 3 && page[i][3]; c++, count++)
			sum += ((double)shown[i][c] - page[i][c]) * ((double)shown[i][c] - page[i][c]);
	}
	return count ? sqrt(sum / (double)count) : 0;
}

static uLong packed_bytes(const uint8_t *coded)
{
	static uint8_t out[2 * PKG_PAGE_BYTES];
	uLongf size = sizeof(out);
	assert_int_equal(compress2(out, &size, coded, PKG_PAGE_BYTES, 9), Z_OK);
	return size;
}

static void pages_pack_better_for_little_error(void **state)
{
	(void)state;
	static const int noises[] = { 3, 12, 40 };
	for (size_t i = 0; i < sizeof(noises) / sizeof(noises[0]); i++) {
		paint_wall(noises[i]);
		encode();
		assert_true(packed_bytes(blocks) * 10 < packed_bytes(plain) * 9);
		double least = rms_of(plain), error = rms_of(blocks);
		assert_true(error < 1.35 * least + 2.0);
	}
}

static void what_is_exact_and_repeated_stays_exact(void **state)
{
	(void)state;
	memset(page, 0, sizeof(page));
	for (size_t i = 0; i < TEXELS; i++)
		memcpy(page[i], (const uint8_t[4]){ 132, 66, 198, 255 }, 4);
	encode();
	etc2_decode(shown, blocks, PKG_PAGE_PX, PKG_PAGE_PX);
	assert_memory_equal(shown, page, sizeof(shown));
}

/* What is cut away decides outlines. */
static void alpha_stays_exact(void **state)
{
	(void)state;
	struct rng rng = rng_seed(9);
	paint_wall(20);
	for (size_t i = 0; i < TEXELS; i++) {
		unsigned level = PKG_PAGE_SOLID + (unsigned)(i / 4 / PKG_PAGE_PX) * 2 % 128;
		page[i][3] = page[i][3] && rng_unit(&rng) > 0.3 ? (uint8_t)level : 0;
	}
	encode();
	etc2_decode(shown, blocks, PKG_PAGE_PX, PKG_PAGE_PX);
	for (size_t i = 0; i < TEXELS; i++)
		assert_int_equal(shown[i][3], page[i][3]);
}

static void alpha_of_several_levels_is_left_alone(void **state)
{
	(void)state;
	struct rng rng = rng_seed(9);
	paint_wall(20);
	for (size_t i = 0; i < TEXELS; i++)
		page[i][3] = (uint8_t)(rng_unit(&rng) * 255.0);
	encode();
	for (size_t i = 0; i < PKG_PAGE_BYTES; i += ETC2_BLOCK_BYTES)
		assert_memory_equal(blocks + i, plain + i, 8);
}

static void equal_outlines_are_equal_bytes_whatever_mirrors(void **state)
{
	(void)state;
	static const uint8_t levels[] = { PKG_PAGE_SOLID, 136, 199, 255 };
	memset(page, 0, sizeof(page));
	for (size_t k = 0; k < sizeof(levels); k++)
		for (uint32_t i = 0; i < 10; i++)
			page[i / 4 * PKG_PAGE_PX + 4 * k + i % 4][3] = levels[k];
	encode();
	for (size_t k = 1; k < sizeof(levels); k++)
		assert_memory_equal(blocks + k * ETC2_BLOCK_BYTES + 1, blocks + 1, 7);
}

static void empty_blocks_are_all_the_same(void **state)
{
	(void)state;
	paint_wall(20);
	encode();
	const uint8_t *empty = blocks + PKG_PAGE_BYTES - ETC2_BLOCK_BYTES;
	size_t count = 0;
	for (size_t i = 0; i < PKG_PAGE_BYTES; i += ETC2_BLOCK_BYTES)
		count += !memcmp(blocks + i, empty, ETC2_BLOCK_BYTES);
	assert_int_equal(count, TEXELS / 16 / 2);
}

static void the_same_page_gives_the_same_blocks(void **state)
{
	(void)state;
	paint_wall(30);
	encode();
	page_blocks(page[0], again);
	assert_memory_equal(blocks, again, sizeof(blocks));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pages_pack_better_for_little_error),
		cmocka_unit_test(what_is_exact_and_repeated_stays_exact),
		cmocka_unit_test(alpha_stays_exact),
		cmocka_unit_test(alpha_of_several_levels_is_left_alone),
		cmocka_unit_test(equal_outlines_are_equal_bytes_whatever_mirrors),
		cmocka_unit_test(empty_blocks_are_all_the_same),
		cmocka_unit_test(the_same_page_gives_the_same_blocks),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
