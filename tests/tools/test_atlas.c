/* Fusing captures, packing, texels and bytes of impostors, on a few rectangles whose right picture is known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <errno.h>
#include <math.h>

#include "assets/cells.h"
#include "assets/impostor_fold.h"
#include "impostor_scene.h"
#include "platform/base/rng.h"
#include "tools/bake/etc2.h"
#include "tools/impostor/pack.h"
#include "tools/impostor/wanted.h"

#define WIDTH 320
#define HEIGHT 200
#define PAGE_TEXELS ((size_t)PKG_PAGE_PX * PKG_PAGE_PX)

static const struct view_cell cell = {
	.start = { 0, 0, 0 }, .end = { 50, 0, 0 }, .half_width_m = 5, .overrun_m = 2, .eye_min_m = 1.2, .eye_max_m = 4
};
static const struct dvec3 at_start = { 0, 0, 3 };
static const struct impostor_options plain = { .tau_px = 1, .focal_px = WIDTH / 2.0, .texels_per_px = 1 };

/* A long wall across the street, two towers before it, a side wall that is seen at a slant. */
static const struct scene city = {
	.quads = { { { 400, 150, -20 }, { 0, -300, 0 }, { 0, 0, 70 }, { 60, 160, 60 }, 30, 0 },
		{ { 200, 30, -10 }, { 0, -25, 0 }, { 0, 0, 60 }, { 200, 60, 60 }, 12, 0 },
		{ { 260, -30, -10 }, { 0, -40, 0 }, { 0, 0, 50 }, { 70, 80, 200 }, 15, 0 },
		{ { 150, 60, 0 }, { 200, 10, 0 }, { 0, 0, 30 }, { 160, 150, 90 }, 40, 0 } },
	.count = 4
};

static struct impostor_capture capture(const struct scene *scene, struct dvec3 eye, double heading_rad)
{
	struct impostor_capture made = { 0 };
	struct capture_view view = scene_view(eye, heading_rad, WIDTH, HEIGHT);
	scene_capture(scene, &view, &made.image);
	return made;
}

/* Fused, meshed, with texels. */
static int build(const struct scene *scene, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, struct impostor *out)
{
	static uint8_t owner[WIDTH * HEIGHT];
	struct impostor_mesh mesh = { 0 };
	for (size_t i = 0; i < count; i++) {
		impostor_fuse(&cell, captures, i, options, owner);
		scene_mesh(scene, &captures[i], owner, (uint8_t)i, &mesh);
	}
	int status = impostor_atlas(&mesh, &cell, captures, count, options, out);
	impostor_mesh_finish(&mesh);
	return status;
}

static double psnr(double squares, size_t count)
{
	return squares > 0 ? 10 * log10(255.0 * 255 * (double)count / squares) : 99;
}

/* Of the three channels, where both show something `margin` pixels away from any change of object. */
static double compare(const struct capture_image *truth, const uint8_t *rgba, int margin)
{
	double squares = 0;
	size_t count = 0;
	for (int y = margin; y < HEIGHT - margin; y++) {
		for (int x = margin; x < WIDTH - margin; x++) {
			size_t i = (size_t)y * WIDTH + (size_t)x;
			bool is_alone = truth->pixels[i].object;
			for (int n = 0; n < (2 * margin + 1) * (2 * margin + 1); n++) {
				int column = x + n % (2 * margin + 1) - margin, row = y + n / (2 * margin + 1) - margin;
				is_alone &= truth->pixels[row * WIDTH + column].object == truth->pixels[i].object;
			}
			if (!is_alone)
				continue;
			for (int k = 0; k < 3; k++) {
				double off = truth->rgba[4 * i + (size_t)k] - (double)rgba[4 * i + (size_t)k];
				squares += off * off;
			}
			count += 3;
		}
	}
	assert_true(count > 3000);
	return psnr(squares, count);
}

static void first_capture_owns_what_is_wanted(void **state)
{
	(void)state;
	static uint8_t owner[WIDTH * HEIGHT], wanted[WIDTH * HEIGHT];
	struct impostor_capture first = capture(&city, at_start, 0);
	for (size_t i = 0; i < sizeof(wanted); i++)
		wanted[i] = i % WIDTH < WIDTH / 2;
	first.wanted = wanted;
	impostor_fuse(&cell, &first, 0, &plain, owner);
	for (size_t i = 0; i < sizeof(owner); i++)
		assert_int_equal(owner[i], wanted[i] && first.image.pixels[i].object);
	capture_image_finish(&first.image);
}

static void later_capture_owns_what_was_hidden(void **state)
{
	(void)state;
	static uint8_t owner[WIDTH * HEIGHT];
	static const struct view_cell square = {
		.end = { 50, 0, 0 }, .half_width_m = 45, .eye_min_m = 1.2, .eye_max_m = 4
	};
	struct impostor_capture captures[2] = { capture(&city, at_start, 0),
		capture(&city, (struct dvec3){ 48, 40, 3 }, 0) };
	impostor_fuse(&square, captures, 1, &plain, owner);
	size_t hidden = 0, missed = 0, extra = 0;
	for (int y = 4; y < HEIGHT - 4; y++) {
		for (int x = 4; x < WIDTH - 4; x++) {
			/* hidden all around, or shown all around: the border is anybody's */
			int hidden_around = 0, around = 0;
			for (int n = 0; n < 81; n++) {
				int column = x + n % 9 - 4, row = y + n / 9 - 4;
				const struct capture_pixel *pixel = &captures[1].image.pixels[row * WIDTH + column];
				if (!pixel->object)
					continue;
				struct dvec3 point = capture_point(&captures[1].image.view, column + 0.5, row + 0.5, pixel->disparity);
				hidden_around += scene_first_hit(&city, at_start, point) != pixel->object - 1;
				around++;
			}
			if (!captures[1].image.pixels[y * WIDTH + x].object || (hidden_around && hidden_around < around))
				continue;
			hidden += hidden_around > 0;
			missed += hidden_around && !owner[y * WIDTH + x];
			extra += !hidden_around && owner[y * WIDTH + x];
		}
	}
	assert_true(hidden > 200);
	assert_int_equal(missed, 0);
	assert_int_equal(extra, 0);
	for (int i = 0; i < 2; i++)
		capture_image_finish(&captures[i].image);
}

static void same_capture_again_owns_nothing(void **state)
{
	(void)state;
	static uint8_t owner[WIDTH * HEIGHT];
	struct impostor_capture captures[2] = { capture(&city, at_start, 0), capture(&city, at_start, 0.05) };
	impostor_fuse(&cell, captures, 1, &plain, owner);
	for (int y = 2; y < HEIGHT - 2; y++)
		for (int x = WIDTH / 8; x < WIDTH - WIDTH / 8; x++)
			assert_int_equal(owner[y * WIDTH + x], 0);
	for (int i = 0; i < 2; i++)
		capture_image_finish(&captures[i].image);
}

static void a_grazed_wall_is_captured_again(void **state)
{
	(void)state;
	static uint8_t owner[WIDTH * HEIGHT];
	/* the first eye sees the wall almost edge on, the second one from its front */
	static const struct scene slanted = {
		.quads = { { { 150, 9, 0 }, { 100, 12, 0 }, { 0, 0, 30 }, { 99, 99, 99 }, 0, 0 } }, .count = 1
	};
	static const struct view_cell wide = { .end = { 50, 0, 0 }, .half_width_m = 60, .eye_min_m = 1.2, .eye_max_m = 4 };
	struct impostor_capture captures[2] = { capture(&slanted, at_start, 0),
		capture(&slanted, (struct dvec3){ 40, -58, 3 }, 0.4) };
	impostor_fuse(&wide, captures, 1, &plain, owner);
	size_t owned = 0, shown = 0;
	for (size_t i = 0; i < sizeof(owner); i++) {
		owned += owner[i];
		shown += captures[1].image.pixels[i].object != 0;
	}
	assert_true(shown > 500);
	assert_true(owned > shown * 9 / 10);
	for (int i = 0; i < 2; i++)
		capture_image_finish(&captures[i].image);
}

static void packed_shapes_do_not_overlap(void **state)
{
	(void)state;
	static uint64_t rows[300][PACK_BLOCKS];
	static struct pack_shape shapes[300];
	static uint8_t taken[64][PACK_BLOCKS][PACK_BLOCKS];
	struct rng rng = rng_seed(7);
	size_t blocks = 0;
	for (int i = 0; i < 300; i++) {
		uint32_t width = i ? 1 + (rng_u32(&rng) % 20) : PACK_BLOCKS,
				 height = i ? 1 + (rng_u32(&rng) % 20) : PACK_BLOCKS;
		uint64_t mask = width == PACK_BLOCKS ? UINT64_MAX : (1ull << width) - 1;
		for (uint32_t y = 0; y < height; y++) {
			rows[i][y] = ((uint64_t)rng_u32(&rng) << 32 | rng_u32(&rng) | rng_u32(&rng) >> 7) & mask;
			rows[i][y] |= y ? 0 : mask;
			blocks += (size_t)__builtin_popcountll(rows[i][y]);
		}
		shapes[i] = (struct pack_shape){ .rows = rows[i], .width = width, .height = height };
	}
	uint32_t pages = pack_shapes(shapes, 300, 64);
	assert_true(pages > 0 && pages <= 1 + (blocks * 3 / 2) / (PACK_BLOCKS * PACK_BLOCKS));
	for (int i = 0; i < 300; i++) {
		assert_true(shapes[i].page < pages && shapes[i].x + shapes[i].width <= PACK_BLOCKS &&
					shapes[i].y + shapes[i].height <= PACK_BLOCKS);
		for (uint32_t y = 0; y < shapes[i].height; y++) {
			for (uint32_t x = 0; x < shapes[i].width; x++) {
				if (!(rows[i][y] >> x & 1))
					continue;
				assert_int_equal(taken[shapes[i].page][shapes[i].y + y][shapes[i].x + x], 0);
				taken[shapes[i].page][shapes[i].y + y][shapes[i].x + x] = 1;
			}
		}
	}
	assert_int_equal(pack_shapes(shapes, 300, pages - 1), 0);
	assert_int_equal(pack_shapes(NULL, 0, 1), 0);
}

static void texels_show_the_capture_again(void **state)
{
	(void)state;
	static uint8_t drawn[4 * WIDTH * HEIGHT];
	struct impostor_capture first = capture(&city, at_start, 0);
	struct impostor made;
	assert_int_equal(build(&city, &first, 1, &plain, &made), 0);
	scene_draw_impostor(&made, made.pages, &first.image.view, drawn);
	assert_true(compare(&first.image, drawn, 0) > 40);
	for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
		assert_int_equal(drawn[4 * i + 3] != 0, first.image.pixels[i].object != 0);
	impostor_finish(&made);
	capture_image_finish(&first.image);
}

static void other_eyes_see_the_scene(void **state)
{
	(void)state;
	static uint8_t drawn[4 * WIDTH * HEIGHT];
	struct impostor_capture captures[3] = { capture(&city, at_start, 0), capture(&city, (struct dvec3){ 50, 4, 3 }, 0),
		capture(&city, (struct dvec3){ 50, -4, 3 }, 0) };
	struct impostor made;
	assert_int_equal(build(&city, captures, 3, &plain, &made), 0);
	static const struct dvec3 eyes[] = { { 0, 4, 2 }, { 25, 0, 3 }, { 50, -4, 1.5 }, { 50, 3, 4 } };
	for (size_t e = 0; e < sizeof(eyes) / sizeof(eyes[0]); e++) {
		struct impostor_capture truth = capture(&city, eyes[e], 0);
		scene_draw_impostor(&made, made.pages, &truth.image.view, drawn);
		assert_true(compare(&truth.image, drawn, 2) > 30);
		size_t holes = 0;
		for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
			holes += truth.image.pixels[i].object && !drawn[4 * i + 3];
		assert_true(holes < WIDTH * HEIGHT / 2000);
		capture_image_finish(&truth.image);
	}
	impostor_finish(&made);
	for (int i = 0; i < 3; i++)
		capture_image_finish(&captures[i].image);
}

static void surfaces_do_not_bleed(void **state)
{
	(void)state;
	static const struct scene two = {
		.quads = { { { 400, 150, -20 }, { 0, -300, 0 }, { 0, 0, 70 }, { 0, 200, 0 }, 0, 0 },
			{ { 200, 13, -15 }, { 0, -26.3, 0 }, { 0, 0, 55 }, { 200, 0, 0 }, 0, 0 } },
		.count = 2
	};
	struct impostor_capture captures[2] = { capture(&two, at_start, 0), capture(&two, (struct dvec3){ 40, 5, 3 }, 0) };
	struct impostor made;
	assert_int_equal(build(&two, captures, 2, &plain, &made), 0);
	size_t counts[2] = { 0 };
	for (size_t i = 0; i < made.page_count * PAGE_TEXELS; i++) {
		const uint8_t *texel = made.pages + 4 * i;
		assert_true(!texel[3] || texel[3] >= PKG_PAGE_SOLID);
		if (!texel[3])
			continue;
		bool is_red = texel[0] > 100;
		assert_int_equal(texel[0], is_red ? 200 : 0);
		assert_int_equal(texel[1], is_red ? 0 : 200);
		counts[is_red]++;
	}
	assert_true(counts[0] > 3000 && counts[1] > 300);
	impostor_finish(&made);
	for (int i = 0; i < 2; i++)
		capture_image_finish(&captures[i].image);
}

static void far_things_get_fewer_texels(void **state)
{
	(void)state;
	/* a capture of twice the screen's resolution: the wall far away needs every second pixel, the near one more */
	struct impostor_options coarse = plain;
	coarse.focal_px = WIDTH / 4.0;
	struct impostor_capture first = capture(&city, at_start, 0);
	struct impostor fine_made, coarse_made;
	assert_int_equal(build(&city, &first, 1, &plain, &fine_made), 0);
	assert_int_equal(build(&city, &first, 1, &coarse, &coarse_made), 0);
	size_t fine_texels = 0, coarse_texels = 0;
	for (size_t i = 0; i < fine_made.page_count * PAGE_TEXELS; i++)
		fine_texels += fine_made.pages[4 * i + 3] != 0;
	for (size_t i = 0; i < coarse_made.page_count * PAGE_TEXELS; i++)
		coarse_texels += coarse_made.pages[4 * i + 3] != 0;
	assert_true(2 * coarse_texels < fine_texels);
	static uint8_t drawn[4 * WIDTH * HEIGHT];
	scene_draw_impostor(&coarse_made, coarse_made.pages, &first.image.view, drawn);
	assert_true(compare(&first.image, drawn, 2) > 30);
	impostor_finish(&fine_made);
	impostor_finish(&coarse_made);
	capture_image_finish(&first.image);
}

/* Patches that meet no other. */
static void add_apart(
	const struct scene *scene, const struct impostor_capture *from, uint8_t view, int apart, struct impostor_mesh *mesh)
{
	static uint8_t owner[WIDTH * HEIGHT];
	size_t first = mesh->vertices.count;
	memset(owner, 1, sizeof(owner));
	scene_mesh(scene, from, owner, view, mesh);
	for (size_t i = first; i < mesh->vertices.count; i++)
		mesh->vertices.items[i].disparity *= 1 + 0.01f * (float)apart;
}

static void pages_are_bounded(void **state)
{
	(void)state;
	struct impostor_capture first = capture(&city, at_start, 0);
	struct impostor_mesh mesh = { 0 };
	for (int i = 0; i < 40; i++)
		add_apart(&city, &first, 0, i, &mesh);
	uint32_t counts[4];
	for (uint32_t most = 0; most < 4; most++) {
		struct impostor_options options = plain;
		struct impostor made;
		options.pages_max = most;
		assert_int_equal(impostor_atlas(&mesh, &cell, &first, 1, &options, &made), 0);
		counts[most] = made.page_count;
		impostor_finish(&made);
	}
	assert_true(counts[0] > 3);
	assert_true(counts[1] == 1 && counts[2] <= 2 && counts[3] <= 3);
	impostor_mesh_finish(&mesh);
	capture_image_finish(&first.image);
}

static void too_many_patches_are_refused(void **state)
{
	(void)state;
	struct impostor_capture first = capture(&city, at_start, 0);
	struct impostor_mesh mesh = { 0 };
	for (int i = 0; i < 500; i++)
		add_apart(&city, &first, 0, i, &mesh);
	struct impostor_options options = plain;
	options.pages_max = 1;
	struct impostor made;
	assert_int_equal(impostor_atlas(&mesh, &cell, &first, 1, &options, &made), -E2BIG);
	assert_null(made.pages);
	impostor_mesh_finish(&mesh);
	capture_image_finish(&first.image);
}

static void nothing_makes_an_empty_impostor(void **state)
{
	(void)state;
	struct impostor_capture first = capture(&city, at_start, BLVD_PI);
	struct impostor made;
	assert_int_equal(build(&city, &first, 1, &plain, &made), 0);
	assert_int_equal(made.page_count, 0);
	assert_int_equal(made.indices.count, 0);
	impostor_finish(&made);
	capture_image_finish(&first.image);
}

static void bytes_can_be_read_back(void **state)
{
	(void)state;
	static uint8_t texels[PAGE_TEXELS][4];
	struct impostor_capture captures[2] = { capture(&city, at_start, 0),
		capture(&city, (struct dvec3){ 48, 4, 3 }, 0) };
	byte_array bytes[2] = { 0 };
	struct impostor made;
	for (int i = 0; i < 2; i++) {
		assert_int_equal(build(&city, captures, 2, &plain, &made), 0);
		impostor_encode(&made, &bytes[i]);
		if (!i)
			impostor_finish(&made);
	}
	assert_int_equal(bytes[0].count, bytes[1].count);
	assert_memory_equal(bytes[0].items, bytes[1].items, bytes[0].count);
	struct pkg_cell header = { .page_count = (uint16_t)made.page_count,
		.vertex_count = (uint32_t)made.vertices.count,
		.index_count = (uint32_t)made.indices.count };
	struct impostor_view view;
	void *scratch = malloc(impostor_fold_bytes(header.vertex_count, header.index_count));
	assert_int_equal(impostor_view_open(&view, &header, bytes[0].items, (uint32_t)bytes[0].count, scratch), 0);
	free(scratch);
	for (uint32_t i = 0; i < header.vertex_count; i++) {
		const struct pkg_impostor_vertex *had = &made.vertices.items[i], *got = &view.vertices[i];
		for (int k = 0; k < 3; k++)
			assert_true(abs(got->pos_mm[k] - had->pos_mm[k]) <= (1 << view.head.step_log2) / 2);
		for (int k = 0; k < 2; k++)
			assert_true(abs(got->uv[k] - had->uv[k]) <= 4);
		assert_memory_equal(&got->page, &had->page, 4);
	}
	assert_memory_equal(view.indices, made.indices.items, made.indices.count * sizeof(*view.indices));
	double squares = 0;
	size_t count = 0;
	for (uint32_t page = 0; page < made.page_count; page++) {
		etc2_decode(texels, view.pages + (size_t)page * PKG_PAGE_BYTES, PKG_PAGE_PX, PKG_PAGE_PX);
		for (size_t i = 0; i < PAGE_TEXELS; i++) {
			const uint8_t *texel = made.pages + 4 * (page * PAGE_TEXELS + i);
			assert_int_equal(texel[3] >= PKG_PAGE_CUT, texels[i][3] >= PKG_PAGE_CUT);
			for (int k = 0; k < 3 && texel[3]; k++, count++)
				squares += (texel[k] - texels[i][k]) * (texel[k] - texels[i][k]);
		}
	}
	assert_true(psnr(squares, count) > 34);
	impostor_finish(&made);
	for (int i = 0; i < 2; i++) {
		ARRAY_FINISH(&bytes[i]);
		capture_image_finish(&captures[i].image);
	}
}

static void truth_is_where_things_are(void **state)
{
	(void)state;
	struct impostor_options options = plain;
	options.truth = true;
	struct impostor_capture first = capture(&city, at_start, 0);
	struct impostor made;
	assert_int_equal(build(&city, &first, 1, &options, &made), 0);
	size_t known = 0;
	for (size_t i = 0; i < made.page_count * PAGE_TEXELS; i++) {
		const struct pkg_truth_texel *texel = &made.truth[i];
		if (!texel->object || texel->object & PKG_TRUTH_MADE_UP)
			continue;
		struct dvec3 point = { texel->pos_m[0], texel->pos_m[1], texel->pos_m[2] };
		const struct scene_quad *quad = &city.quads[texel->object - 1];
		struct dvec3 normal = { quad->along.y * quad->up.z, -quad->along.x * quad->up.z, 0 };
		double off = (point.x - quad->corner.x) * normal.x + (point.y - quad->corner.y) * normal.y;
		assert_true(fabs(off) < 0.01 * hypot(normal.x, normal.y));
		known++;
	}
	assert_true(known > 3000);
	byte_array bytes = { 0 };
	impostor_encode_truth(&made, &bytes);
	assert_int_equal(bytes.count, made.page_count * PAGE_TEXELS * sizeof(struct pkg_truth_texel));
	ARRAY_FINISH(&bytes);
	impostor_finish(&made);
	capture_image_finish(&first.image);
}

static void only_what_is_ever_seen_is_wanted(void **state)
{
	(void)state;
	static uint8_t wanted[WIDTH * HEIGHT];
	/* everything but the first quad, a wall near the street, is far */
	struct scene with_near = { .quads = { [0] = { { 80, 40, -20 }, { 0, -60, 0 }, { 0, 0, 60 }, { 9, 9, 9 }, 0, 0 },
								   [1] = { { 400, 150, -20 }, { 0, -300, 0 }, { 0, 0, 70 }, { 60, 160, 60 }, 0, 0 } },
		.count = 2 };
	struct scene far_only = with_near;
	far_only.quads[0].corner.x = -1000;
	struct capture_image poses[2], far;
	static const struct dvec3 eyes[2] = { { 0, 0, 3 }, { 30, 3, 3 } };
	for (int i = 0; i < 2; i++) {
		struct capture_view view = scene_view(eyes[i], 0, WIDTH, HEIGHT);
		scene_capture(&with_near, &view, &poses[i]);
	}
	struct capture_view view = scene_view(eyes[0], 0, WIDTH, HEIGHT);
	scene_capture(&far_only, &view, &far);
	impostor_wanted(poses, 2, &far, 3, wanted);
	size_t seen = 0, hidden = 0;
	for (uint32_t y = 0, i = 0; y < HEIGHT; y++) {
		for (uint32_t x = 0; x < WIDTH; x++, i++) {
			if (!far.pixels[i].object) {
				assert_int_equal(wanted[i], 0);
				continue;
			}
			bool is_seen = false, is_near_seen = false;
			for (int n = 0; n < 9; n++) {
				double px = x + 0.5 + 6 * (n % 3 - 1), py = y + 0.5 + 6 * (n / 3 - 1);
				struct dvec3 point = capture_point(&far.view, px, py, far.pixels[i].disparity);
				for (int e = 0; e < 2; e++) {
					is_near_seen |= scene_first_hit(&with_near, eyes[e], point) != 0;
					is_seen |= n == 4 && scene_first_hit(&with_near, eyes[e], point) == 1;
				}
			}
			if (is_seen)
				assert_int_equal(wanted[i], 1);
			if (!is_near_seen)
				assert_int_equal(wanted[i], 0);
			seen += is_seen;
			hidden += !is_near_seen;
		}
	}
	assert_true(seen > 300 && hidden > 300);
	for (int i = 0; i < 2; i++)
		capture_image_finish(&poses[i]);
	capture_image_finish(&far);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(first_capture_owns_what_is_wanted),
		cmocka_unit_test(later_capture_owns_what_was_hidden),
		cmocka_unit_test(same_capture_again_owns_nothing),
		cmocka_unit_test(a_grazed_wall_is_captured_again),
		cmocka_unit_test(packed_shapes_do_not_overlap),
		cmocka_unit_test(texels_show_the_capture_again),
		cmocka_unit_test(other_eyes_see_the_scene),
		cmocka_unit_test(surfaces_do_not_bleed),
		cmocka_unit_test(far_things_get_fewer_texels),
		cmocka_unit_test(pages_are_bounded),
		cmocka_unit_test(too_many_patches_are_refused),
		cmocka_unit_test(nothing_makes_an_empty_impostor),
		cmocka_unit_test(bytes_can_be_read_back),
		cmocka_unit_test(truth_is_where_things_are),
		cmocka_unit_test(only_what_is_ever_seen_is_wanted),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
