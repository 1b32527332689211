/* EAC RG11 blocks: worked by hand from the specification, against this machine's GL, and how near they come. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <GLES3/gl3.h>

#include "platform/base/rng.h"
#include "platform/display/display.h"
#include "tests/tools/gl_blocks.h"
#include "tools/bake/eac.h"

/* The driver keeps what it allocated when it is unloaded. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
	return "detect_leaks=0";
}

#define REPEAT_INDEX(b0, b1, b2) b0, b1, b2, b0, b1, b2 /* eight indices are three bytes */

/* A base, a multiplier and a table, and one index everywhere. */
static const struct {
	const char *name;
	uint8_t block[8];
	uint16_t value;
} worked[] = {
	{ "base, multiplier and step", { 100, 0x3d, REPEAT_INDEX(0x00, 0x00, 0x00) }, 100 * 8 + 4 - 3 * 8 },
	{ "multiplier 0 is an eighth of 1", { 100, 0x0d, REPEAT_INDEX(0x00, 0x00, 0x00) }, 100 * 8 + 4 - 1 },
	{ "step of 0", { 100, 0x5d, REPEAT_INDEX(0x92, 0x49, 0x24) }, 100 * 8 + 4 },
	{ "clamped below", { 0, 0xf0, REPEAT_INDEX(0x6d, 0xb6, 0xdb) }, 0 },
	{ "clamped above", { 255, 0x10, REPEAT_INDEX(0xff, 0xff, 0xff) }, 2047 },
};

static void blocks_worked_by_hand_decode(void **state)
{
	(void)state;
	for (size_t k = 0; k < sizeof(worked) / sizeof(worked[0]); k++) {
		uint16_t texels[16];
		eac_decode_block(texels, worked[k].block);
		for (int i = 0; i < 16; i++)
			if (texels[i] != worked[k].value)
				fail_msg("%s: texel %d is %u, not %u", worked[k].name, i, texels[i], worked[k].value);
	}
}

/* The first three bits after the head are the texel in the corner, the next the one below it. */
static void indices_run_down_the_columns(void **state)
{
	(void)state;
	const uint8_t block[8] = { 100, 0x1d, 0xe4, 0x92, 0x49, 0x24, 0x92, 0x4f };
	uint16_t texels[16];
	eac_decode_block(texels, block);
	assert_int_equal(texels[0], 100 * 8 + 4 + 9 * 8);
	assert_int_equal(texels[4], 100 * 8 + 4 - 2 * 8);
	assert_int_equal(texels[15], 100 * 8 + 4 + 9 * 8);
}

static uint32_t wanted_of(uint8_t texel)
{
	return (texel * 2u * EAC_MAX + 255) / (2 * 255);
}

static void one_value_everywhere_is_exact(void **state)
{
	(void)state;
	for (unsigned value = 0; value < 256; value++) {
		uint8_t texels[16], block[8];
		uint16_t decoded[16];
		memset(texels, (int)value, sizeof(texels));
		eac_encode_block(block, texels);
		eac_decode_block(decoded, block);
		for (int i = 0; i < 16; i++)
			assert_in_range(decoded[i] + 1, wanted_of((uint8_t)value), wanted_of((uint8_t)value) + 2);
		uint8_t back[1][2], blocks[16];
		eac_rg_encode(blocks, (const uint8_t[1][2]){ { (uint8_t)value, (uint8_t)(255 - value) } }, 1, 1, 0, 1);
		eac_rg_decode(back, blocks, 1, 1);
		assert_int_equal(back[0][0], value);
		assert_int_equal(back[0][1], 255 - value);
	}
}

#define TWO_VALUES_WORST 44 /* of 2047: 5.5 of 255, where the pair is of no table and multiplier */

/* All pairs: every table and multiplier is stretched over them. */
static void two_values_come_near(void **state)
{
	(void)state;
	for (unsigned pair = 0; pair < 65536; pair++) {
		uint8_t texels[16], block[8];
		uint16_t decoded[16];
		for (unsigned i = 0; i < 16; i++)
			texels[i] = (uint8_t)((pair * 40503u >> i & 1) ? pair >> 8 : pair & 255);
		eac_encode_block(block, texels);
		eac_decode_block(decoded, block);
		for (int i = 0; i < 16; i++)
			assert_in_range(
				decoded[i] + TWO_VALUES_WORST, wanted_of(texels[i]), wanted_of(texels[i]) + 2 * TWO_VALUES_WORST);
	}
}

/* Light falls off smoothly: of a slope, the error is a share of its height. */
static void slopes_are_near(void **state)
{
	(void)state;
	struct rng rng = rng_seed(9);
	for (int round = 0; round < 4000; round++) {
		int right = (int)(rng_u32(&rng) % 41) - 20, down = (int)(rng_u32(&rng) % 41) - 20;
		int height = 3 * (abs(right) + abs(down)), least = (right < 0 ? -3 * right : 0) + (down < 0 ? -3 * down : 0);
		int base = least + (int)(rng_u32(&rng) % (unsigned)(256 - height));
		uint8_t texels[16], block[8];
		uint16_t decoded[16];
		for (int i = 0; i < 16; i++)
			texels[i] = (uint8_t)(base + i % 4 * right + i / 4 * down);
		eac_encode_block(block, texels);
		eac_decode_block(decoded, block);
		uint32_t most = (uint32_t)(16 + height * EAC_MAX / 255 / 10);
		for (int i = 0; i < 16; i++)
			assert_in_range(decoded[i] + most, wanted_of(texels[i]), wanted_of(texels[i]) + 2 * most);
	}
}

static void pictures_of_any_size_keep_their_texels(void **state)
{
	(void)state;
	static const uint32_t sides[][2] = { { 1, 1 }, { 2, 2 }, { 5, 3 }, { 7, 9 }, { 8, 8 } };
	for (int k = 0; k < 5; k++) {
		uint32_t w = sides[k][0], h = sides[k][1], rows = (h + 3) / 4;
		uint8_t texels[64][2], decoded[64][2], blocks[6 * 16], again[6 * 16];
		for (uint32_t i = 0; i < w * h; i++) {
			texels[i][0] = (uint8_t)(i / w * 20);
			texels[i][1] = (uint8_t)(250 - i % w * 20);
		}
		assert_int_equal(eac_rg_bytes(w, h), (w + 3) / 4 * rows * 16);
		eac_rg_encode(blocks, (const uint8_t(*)[2])texels, w, h, 0, rows);
		for (uint32_t row = rows; row-- > 0;) /* in any order, a part at a time */
			eac_rg_encode(again, (const uint8_t(*)[2])texels, w, h, row, row + 1);
		assert_memory_equal(blocks, again, eac_rg_bytes(w, h));
		eac_rg_decode(decoded, blocks, w, h);
		for (uint32_t i = 0; i < w * h; i++)
			for (int c = 0; c < 2; c++)
				assert_in_range(decoded[i][c] + 5, texels[i][c], texels[i][c] + 10);
	}
}

#define GL_SIDE 64

/* Any bytes are a block: random ones reach every table and multiplier. */
static void the_decoder_agrees_with_the_gl_here(void **state)
{
	(void)state;
	struct display display;
	struct display_config config = { .width = 16, .height = 16 };
	if (display_open(&display, &display_surfaceless, &config) != 0)
		skip();
	static uint8_t blocks[GL_SIDE * GL_SIDE], ours[GL_SIDE * GL_SIDE][2], theirs[GL_SIDE * GL_SIDE][4];
	struct rng rng = rng_seed(11);
	for (size_t i = 0; i < sizeof(blocks); i++)
		blocks[i] = (uint8_t)rng_u32(&rng);
	eac_rg_decode(ours, blocks, GL_SIDE, GL_SIDE);
	gl_draw_blocks(GL_COMPRESSED_RG11_EAC, blocks, sizeof(blocks), GL_SIDE, theirs);
	for (int i = 0; i < GL_SIDE * GL_SIDE; i++)
		for (int c = 0; c < 2; c++)
			assert_in_range(ours[i][c], theirs[i][c] ? theirs[i][c] - 1 : 0, theirs[i][c] + 1);
	display_close(&display);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(blocks_worked_by_hand_decode),
		cmocka_unit_test(indices_run_down_the_columns),
		cmocka_unit_test(one_value_everywhere_is_exact),
		cmocka_unit_test(two_values_come_near),
		cmocka_unit_test(slopes_are_near),
		cmocka_unit_test(pictures_of_any_size_keep_their_texels),
		cmocka_unit_test(the_decoder_agrees_with_the_gl_here),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
