/* The checker's rasteriser draws an impostor's texels where perspective says, whatever the eye. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "tools/bake/etc2.h"
#include "tools/inspect/far_raster.h"

#define DEPTH_M 100.0

/* A wall 100 m north of the origin, 40 m wide and high, captured from the origin: one page covers it. */
static struct pkg_impostor_vertex vertices[4];
static const uint16_t indices[6] = { 0, 1, 2, 0, 2, 3 };
static const struct pkg_impostor_view view = { { 0, 1, 0, 0 } };
static uint8_t pages[PKG_PAGE_BYTES];
static struct pkg_truth_texel truth[PKG_PAGE_PX * PKG_PAGE_PX];
static struct impostor_view impostor;

static int build_wall(void **state)
{
	(void)state;
	static uint8_t texels[PKG_PAGE_PX * PKG_PAGE_PX][4];
	for (int i = 0; i < 4; i++) {
		bool right = i == 1 || i == 2, down = i > 1;
		vertices[i] = (struct pkg_impostor_vertex){ .pos_mm = { right ? 20000 : -20000, 100000, down ? -20000 : 20000 },
			.uv = { right ? 32768 : 0, down ? 32768 : 0 } };
	}
	for (uint32_t y = 0; y < PKG_PAGE_PX; y++)
		for (uint32_t x = 0; x < PKG_PAGE_PX; x++) {
			uint32_t i = y * PKG_PAGE_PX + x;
			/* the lower quarter is cut away */
			memset(texels[i], y < 192 ? 255 : 0, 4);
			truth[i] = (struct pkg_truth_texel){ 7, { (float)(-20.0 + (x + 0.5) * 40.0 / PKG_PAGE_PX), DEPTH_M,
														(float)(20.0 - (y + 0.5) * 40.0 / PKG_PAGE_PX) } };
		}
	etc2_encode(pages, (const uint8_t(*)[4])texels, PKG_PAGE_PX, PKG_PAGE_PX);
	impostor = (struct impostor_view){
		.head = { .vertex_count = 4, .index_count = 6, .page_count = 1, .view_count = 1 },
		.views = &view,
		.vertices = vertices,
		.indices = indices,
		.pages = pages,
	};
	return 0;
}

static const struct raster_pixel *pixel_at(const struct far_raster *raster, struct dvec3 point)
{
	double v[3];
	far_raster_view(raster, point, v);
	int x = (int)floor(RASTER_WIDTH * 0.5 + RASTER_FOCAL_PX * v[0] / v[2]);
	int y = (int)floor(RASTER_HEIGHT * 0.5 - RASTER_FOCAL_PX * v[1] / v[2]);
	assert_in_range(x, 0, RASTER_WIDTH - 1);
	assert_in_range(y, 0, RASTER_HEIGHT - 1);
	return &raster->pixels[y * RASTER_WIDTH + x];
}

static void texels_are_drawn_where_they_are(void **state)
{
	(void)state;
	static const struct {
		struct dvec3 eye;
		double heading_rad;
	} cases[] = { { { 0, 0, 0 }, 0.0 }, { { 30, 0, 5 }, -0.2 }, { { -10, 60, 3 }, 0.1 }, { { 0, -80, 0 }, 0.3 } };
	struct far_raster raster = { 0 };
	far_raster_use(&raster, &impostor, truth);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		far_raster_draw(&raster, cases[i].eye, cases[i].heading_rad);
		unsigned drawn = 0;
		for (size_t k = 0; k < (size_t)RASTER_WIDTH * RASTER_HEIGHT; k++) {
			const struct raster_pixel *pixel = &raster.pixels[k];
			if (!pixel->truth)
				continue;
			drawn++;
			/* half a texel is 0.08 m */
			assert_true(fabs(pixel->at.x - (double)pixel->truth->pos_m[0]) < 0.085);
			assert_true(fabs(pixel->at.z - (double)pixel->truth->pos_m[2]) < 0.085);
			assert_true(pixel->at.z > -10.7);
		}
		assert_true(drawn > 5000);
		const struct raster_pixel *pixel = pixel_at(&raster, (struct dvec3){ 5.0, DEPTH_M, 4.0 });
		assert_non_null(pixel->truth);
		assert_true(fabs(pixel->at.x - 5.0) < 0.5 && fabs(pixel->at.z - 4.0) < 0.5);
	}
	far_raster_finish(&raster);
}

static void nothing_behind_the_eye_is_drawn(void **state)
{
	(void)state;
	struct far_raster raster = { 0 };
	far_raster_use(&raster, &impostor, truth);
	far_raster_draw(&raster, (struct dvec3){ 0, 0, 0 }, BLVD_PI);
	for (size_t k = 0; k < (size_t)RASTER_WIDTH * RASTER_HEIGHT; k++)
		assert_null(raster.pixels[k].truth);
	far_raster_finish(&raster);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(texels_are_drawn_where_they_are),
		cmocka_unit_test(nothing_behind_the_eye_is_drawn),
	};
	return cmocka_run_group_tests(tests, build_wall, NULL);
}
