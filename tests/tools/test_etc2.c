/* ETC2 blocks: worked by hand from the specification, against this machine's GL, and the painted layers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <GLES3/gl3.h>
#include <math.h>
#include <stdio.h>

#include "platform/base/rng.h"
#include "platform/display/display.h"
#include "tests/tools/gl_blocks.h"
#include "tools/bake/etc2.h"
#include "tools/bake/etc2_modes.h"
#include "tools/bake/materials.h"

/* The driver keeps what it allocated when it is unloaded. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
	return "detect_leaks=0";
}

/* Some texels of a block; i counts row by row. */
struct worked {
	const char *name;
	uint8_t block[16];
	struct {
		unsigned i;
		uint8_t rgba[4];
	} texels[4];
};

static const struct worked worked[] = {
	{ "individual, side by side",
		{ 100, 0x30, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xf0, 0x0f, 0x84, 0x1c, 0x00, 0x40, 0x00, 0x40 },
		{ { 0, { 255, 2, 138, 55 } }, { 9, { 247, 0, 128, 142 } }, { 13, { 255, 2, 138, 142 } },
			{ 2, { 47, 255, 115, 142 } } } },
	{ "differential, one above the other",
		{ 7, 0x1d, 0x92, 0x49, 0x24, 0x92, 0x49, 0x24, 0x87, 0xf8, 0x03, 0x2b, 0x00, 0x00, 0xff, 0xff },
		{ { 0, { 149, 255, 17, 7 } }, { 7, { 149, 255, 17, 7 } }, { 8, { 152, 255, 53, 7 } },
			{ 15, { 152, 255, 53, 7 } } } },
	{ "T", { 0, 0x1d, 0x92, 0x49, 0x24, 0x92, 0x49, 0x24, 0xfb, 0x00, 0x08, 0xf7, 0x00, 0x0c, 0x00, 0x0a },
		{ { 0, { 255, 0, 0, 0 } }, { 4, { 16, 152, 255, 0 } }, { 8, { 0, 136, 255, 0 } },
			{ 12, { 0, 120, 239, 0 } } } },
	{ "H", { 255, 0x1d, 0x92, 0x49, 0x24, 0x92, 0x49, 0x24, 0x09, 0x05, 0xa2, 0xb7, 0x00, 0x0c, 0x00, 0x0a },
		{ { 0, { 58, 75, 92, 255 } }, { 4, { 0, 0, 10, 255 } }, { 8, { 109, 126, 143, 255 } },
			{ 12, { 27, 44, 61, 255 } } } },
	{ "planar", { 9, 0x0d, 0, 0, 0, 0, 0, 0, 0x00, 0x00, 0x04, 0x7f, 0xff, 0xf8, 0x00, 0x00 },
		{ { 0, { 0, 0, 0, 9 } }, { 1, { 64, 64, 64, 9 } }, { 6, { 128, 128, 128, 9 } },
			{ 15, { 191, 191, 191, 9 } } } },
};

static void blocks_worked_by_hand_decode(void **state)
{
	(void)state;
	for (size_t k = 0; k < sizeof(worked) / sizeof(worked[0]); k++) {
		uint8_t texels[16][4];
		etc2_decode_block(texels, worked[k].block);
		for (int n = 0; n < 4; n++)
			for (int c = 0; c < 4; c++)
				if (texels[worked[k].texels[n].i][c] != worked[k].texels[n].rgba[c])
					fail_msg("%s: texel %u, channel %d is %d, not %d", worked[k].name, worked[k].texels[n].i, c,
						texels[worked[k].texels[n].i][c], worked[k].texels[n].rgba[c]);
	}
}

static uint32_t colour_error(const uint8_t (*a)[4], const uint8_t (*b)[4], size_t count)
{
	uint32_t sum = 0;
	for (size_t i = 0; i < count; i++)
		for (int c = 0; c < 3; c++)
			sum += (uint32_t)etc2_square(a[i][c] - b[i][c]);
	return sum;
}

static uint32_t alpha_error(const uint8_t (*a)[4], const uint8_t (*b)[4], size_t count)
{
	uint32_t sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += (uint32_t)etc2_square(a[i][3] - b[i][3]);
	return sum;
}

/* Each mode's own idea of its error is what the decoder yields: bits are where they belong. */
static void every_mode_decodes_to_what_it_claims(void **state)
{
	(void)state;
	static void (*const modes[])(
		const uint8_t[16][4], struct etc2_choice *) = { etc2_try_halves, etc2_try_planar, etc2_try_paints };
	struct rng rng = rng_seed(7);
	for (int round = 0; round < 6000; round++) {
		uint8_t texels[16][4], decoded[16][4], block[16] = { 0 };
		uint8_t ends[2][3];
		unsigned noise = 1u << round % 9;
		for (int c = 0; c < 3; c++) {
			ends[0][c] = (uint8_t)rng_u32(&rng);
			ends[1][c] = (uint8_t)rng_u32(&rng);
		}
		for (int i = 0; i < 16; i++)
			for (int c = 0; c < 3; c++)
				texels[i][c] = (uint8_t)etc2_clamp(ends[i % 4 / 2][c] + (int)(rng_u32(&rng) % noise));
		struct etc2_choice choice = { .error = UINT32_MAX };
		modes[round % 3]((const uint8_t(*)[4])texels, &choice);
		etc2_put_word(block + 8, choice.bits);
		etc2_decode_block(decoded, block);
		assert_int_equal(colour_error((const uint8_t(*)[4])texels, (const uint8_t(*)[4])decoded, 16), choice.error);
	}
}

static void encode_solid(const int rgb[3], int alpha, uint8_t decoded[16][4], uint8_t texels[16][4])
{
	uint8_t block[16];
	for (int i = 0; i < 16; i++) {
		for (int c = 0; c < 3; c++)
			texels[i][c] = (uint8_t)rgb[c];
		texels[i][3] = (uint8_t)alpha;
	}
	etc2_encode_block(block, (const uint8_t(*)[4])texels);
	etc2_decode_block(decoded, block);
}

static void solid_colours_that_the_format_has_are_exact(void **state)
{
	(void)state;
	uint8_t decoded[16][4], texels[16][4];
	for (int value = 0; value < 32 * 32; value++) {
		int step = etc2_steps[value / 4 % 8][value & 1] * (value & 2 ? -1 : 1), wide = value / 32;
		int rgb[3];
		for (int c = 0; c < 3; c++)
			rgb[c] = etc2_clamp(etc2_widen((wide * (c + 1) + 5 * c) % 32, 5) + step);
		encode_solid(rgb, value % 256, decoded, texels);
		assert_memory_equal(decoded, texels, sizeof(texels));
	}
	static const int named[][3] = { { 0, 0, 0 }, { 255, 255, 255 }, { 255, 0, 0 }, { 0, 255, 0 }, { 0, 0, 255 } };
	for (int k = 0; k < 5; k++) {
		encode_solid(named[k], 255, decoded, texels);
		assert_memory_equal(decoded, texels, sizeof(texels));
	}
}

/* No base and step of any table comes nearer; a plane may, over all texels. */
static void other_solid_colours_are_the_nearest_there_are(void **state)
{
	(void)state;
	struct rng rng = rng_seed(3);
	for (int round = 0; round < 300; round++) {
		uint8_t decoded[16][4], texels[16][4];
		int rgb[3], least = INT32_MAX;
		for (int c = 0; c < 3; c++)
			rgb[c] = (int)(rng_u32(&rng) % 256);
		encode_solid(rgb, 128, decoded, texels);
		for (int k = 0; k < 64; k++) {
			int bits = 4 + (k & 1), step = etc2_steps[k / 8][k >> 1 & 1] * (k & 4 ? -1 : 1), error = 0;
			for (int c = 0; c < 3; c++) {
				int best = INT32_MAX;
				for (int q = 0; q < 1 << bits; q++) {
					int e = etc2_square(etc2_clamp(etc2_widen(q, bits) + step) - rgb[c]);
					best = e < best ? e : best;
				}
				error += best;
			}
			least = error < least ? error : least;
		}
		assert_true(
			colour_error((const uint8_t(*)[4])texels, (const uint8_t(*)[4])decoded, 16) <= 16 * (uint32_t)least);
	}
}

static void an_edge_between_glass_and_wall_is_exact_in_alpha(void **state)
{
	(void)state;
	for (unsigned pattern = 0; pattern < 65536; pattern += 97) {
		uint8_t texels[16][4] = { 0 }, decoded[16][4], block[16];
		for (unsigned i = 0; i < 16; i++)
			texels[i][3] = pattern >> i & 1 ? 255 : 0;
		etc2_encode_block(block, (const uint8_t(*)[4])texels);
		etc2_decode_block(decoded, block);
		assert_int_equal(alpha_error((const uint8_t(*)[4])texels, (const uint8_t(*)[4])decoded, 16), 0);
	}
}

static void pictures_smaller_than_a_block_keep_their_texels(void **state)
{
	(void)state;
	static const uint32_t sides[][2] = { { 1, 1 }, { 2, 2 }, { 5, 3 }, { 7, 9 } };
	for (int k = 0; k < 4; k++) {
		uint32_t w = sides[k][0], h = sides[k][1];
		uint8_t texels[63][4], decoded[63][4], blocks[6 * 16];
		for (uint32_t i = 0; i < w * h; i++)
			memcpy(texels[i], (const uint8_t[]){ 90, 90, 90, (uint8_t)(i / w * 20) }, 4);
		assert_int_equal(etc2_bytes(w, h), (w + 3) / 4 * ((h + 3) / 4) * 16);
		etc2_encode(blocks, (const uint8_t(*)[4])texels, w, h);
		etc2_decode(decoded, blocks, w, h);
		assert_true(colour_error((const uint8_t(*)[4])texels, (const uint8_t(*)[4])decoded, w * h) <= 3 * w * h);
		assert_true(alpha_error((const uint8_t(*)[4])texels, (const uint8_t(*)[4])decoded, w * h) <= 4 * w * h);
	}
}

static double psnr(double squares, double count)
{
	return squares > 0.0 ? 10.0 * log10(255.0 * 255.0 * count / squares) : 99.0;
}

#define COLOUR_FLOOR_DB 38.0
#define ALPHA_FLOOR_DB 46.0

static void painted_layers_survive(void **state)
{
	(void)state;
	struct materials exact, packed;
	materials_paint(&exact, PKG_TEXTURE_RGBA8);
	materials_paint(&packed, PKG_TEXTURE_ETC2_RGBA);
	const struct pkg_texture_array *array = (const void *)exact.texture.items;
	uint32_t px = array->width;
	const uint8_t *texels = exact.texture.items + sizeof(*array), *blocks = packed.texture.items + sizeof(*array);
	uint8_t(*decoded)[4] = malloc((size_t)px * px * 4);
	double worst = 99.0, worst_alpha = 99.0, sum = 0.0;
	for (uint32_t layer = 0; layer < array->layers; layer++) {
		const uint8_t(*from)[4] = (const uint8_t(*)[4])(texels + (size_t)layer * px * px * 4);
		etc2_decode(decoded, blocks + layer * etc2_bytes(px, px), px, px);
		double colour = psnr(colour_error(from, (const uint8_t(*)[4])decoded, (size_t)px * px), 3.0 * px * px);
		double alpha = psnr(alpha_error(from, (const uint8_t(*)[4])decoded, (size_t)px * px), (double)px * px);
		if (getenv("BLVD_VERBOSE"))
			printf("layer %3u: colour %.2f dB, alpha %.2f dB\n", layer, colour, alpha);
		worst = fmin(worst, colour);
		worst_alpha = fmin(worst_alpha, alpha);
		sum += colour;
	}
	printf("%u layers: colour at least %.2f dB, mean %.2f dB; alpha at least %.2f dB\n", array->layers, worst,
		sum / array->layers, worst_alpha);
	assert_true(worst > COLOUR_FLOOR_DB);
	assert_true(worst_alpha > ALPHA_FLOOR_DB);
	free(decoded);
	materials_finish(&exact);
	materials_finish(&packed);
}

#define GL_SIDE 64

/* Any bytes are a block: random ones reach every mode. */
static void the_decoder_agrees_with_the_gl_here(void **state)
{
	(void)state;
	struct display display;
	struct display_config config = { .width = 16, .height = 16 };
	if (display_open(&display, &display_surfaceless, &config) != 0)
		skip();
	static uint8_t blocks[GL_SIDE * GL_SIDE], ours[GL_SIDE * GL_SIDE][4], theirs[GL_SIDE * GL_SIDE][4];
	struct rng rng = rng_seed(11);
	for (size_t i = 0; i < sizeof(blocks); i++)
		blocks[i] = (uint8_t)rng_u32(&rng);
	etc2_decode(ours, blocks, GL_SIDE, GL_SIDE);
	gl_draw_blocks(GL_COMPRESSED_RGBA8_ETC2_EAC, blocks, sizeof(blocks), GL_SIDE, theirs);
	for (int i = 0; i < GL_SIDE * GL_SIDE; i++)
		for (int c = 0; c < 4; c++)
			assert_in_range(ours[i][c], theirs[i][c] ? theirs[i][c] - 1 : 0, theirs[i][c] + 1);
	display_close(&display);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(blocks_worked_by_hand_decode),
		cmocka_unit_test(every_mode_decodes_to_what_it_claims),
		cmocka_unit_test(solid_colours_that_the_format_has_are_exact),
		cmocka_unit_test(other_solid_colours_are_the_nearest_there_are),
		cmocka_unit_test(an_edge_between_glass_and_wall_is_exact_in_alpha),
		cmocka_unit_test(pictures_smaller_than_a_block_keep_their_texels),
		cmocka_unit_test(painted_layers_survive),
		cmocka_unit_test(the_decoder_agrees_with_the_gl_here),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
