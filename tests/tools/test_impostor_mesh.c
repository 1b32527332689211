/* One capture into triangles: counts, errors, no pixel without one. With BLVD_PICTURES=DIR the meshes are drawn. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "platform/base/rng.h"
#include "tests/tools/mesh_picture.h"
#include "tests/tools/ray_view.h"
#include "tools/impostor/impostor.h"
#include "tools/impostor/triangle_rows.h"

static struct ray_scene scene;

static struct impostor_options options_of(double tau_px)
{
	return (struct impostor_options){ .tau_px = tau_px, .focal_px = 869, .texels_per_px = 1 };
}

struct made {
	struct capture_image image;
	struct impostor_mesh mesh;
	uint32_t triangles;
};

static struct made make(
	const char *name, struct capture_image image, const struct view_cell *cell, const struct impostor_options *options)
{
	struct made made = { .image = image };
	uint8_t *owner = malloc((size_t)image.view.width * image.view.height);
	memset(owner, 1, (size_t)image.view.width * image.view.height);
	struct impostor_capture capture = { .image = image };
	struct timespec from, to;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
	impostor_mesh_add(&made.mesh, cell, &capture, owner, 0, options);
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
	free(owner);
	made.triangles = (uint32_t)(made.mesh.indices.count / 3);
	size_t owned = 0;
	for (size_t i = 0; i < (size_t)image.view.width * image.view.height; i++)
		owned += image.pixels[i].object != 0;
	print_message("%s: %zu px, %u triangles, %zu patches, %zu texels, error %.2f px, over %.4f %%, %.1f ms\n", name,
		owned, made.triangles, made.mesh.patches.count, made.mesh.texels.count, made.mesh.error_px,
		100 * made.mesh.over_share,
		1e3 * (double)(to.tv_sec - from.tv_sec) + 1e-6 * (double)(to.tv_nsec - from.tv_nsec));
	const char *pictures = getenv("BLVD_PICTURES");
	if (pictures) {
		char path[512];
		snprintf(path, sizeof(path), "%s/%s.png", pictures, name);
		mesh_picture(path, &made.mesh, &image, image.view.width <= 512 ? 3 : 1);
	}
	return made;
}

/* Pixels to be shown that no triangle shows. */
static size_t bare_pixels(const struct made *made)
{
	const struct capture_image *image = &made->image;
	size_t count = (size_t)image->view.width * image->view.height, bare = 0;
	uint8_t *shown = calloc(count, 1);
	for (size_t i = 0; i < made->mesh.patches.count; i++) {
		const struct mesh_patch *patch = &made->mesh.patches.items[i];
		for (uint32_t k = 0; k < patch->index_count; k += 3) {
			double x[3], y[3];
			for (uint32_t c = 0; c < 3; c++) {
				uint32_t index = made->mesh.indices.items[patch->first_index + k + c];
				assert_in_range(index, 0, patch->vertex_count - 1);
				x[c] = made->mesh.vertices.items[patch->first_vertex + index].x;
				y[c] = made->mesh.vertices.items[patch->first_vertex + index].y;
				assert_true(made->mesh.vertices.items[patch->first_vertex + index].disparity > 0);
			}
			struct pixel_run rows = triangle_rows(y, (int32_t)image->view.height);
			for (int32_t row = rows.from; row < rows.to; row++) {
				struct pixel_run run = triangle_run(x, y, row, (int32_t)image->view.width);
				for (int32_t column = run.from; column < run.to; column++) {
					assert_in_range(column, patch->min_x, patch->max_x);
					assert_in_range(row, patch->min_y, patch->max_y);
					size_t texel = patch->first_texel +
								   ((size_t)row - patch->min_y) * (patch->max_x - patch->min_x + 1u) +
								   ((size_t)column - patch->min_x);
					if (made->mesh.texels.items[texel] == MESH_SHOW)
						shown[(size_t)row * image->view.width + (size_t)column] = 1;
				}
			}
		}
		assert_true(patch->max_x - patch->min_x < 256 && patch->max_y - patch->min_y < 256);
	}
	for (size_t i = 0; i < count; i++)
		bare += image->pixels[i].object && !shown[i];
	free(shown);
	return bare;
}

static void unmake(struct made *made)
{
	ray_capture_finish(&made->image);
	impostor_mesh_finish(&made->mesh);
}

static void a_facade_is_two_triangles(void **state)
{
	(void)state;
	memset(&scene, 0, sizeof(scene));
	scene.ground_from = INFINITY;
	scene.boxes[scene.box_count++] = (struct ray_box){ { 10, 110, 0 }, { 60, 400, 20 } };
	struct view_cell cell = ray_cell(50);
	struct capture_view view = ray_view(0, 0, 2.5, 869, 512, 512);
	struct impostor_options options = options_of(1);
	struct made made = make("facade", ray_capture(&scene, &view), &cell, &options);
	assert_true(made.triangles <= 10);
	assert_true(made.mesh.error_px <= 1 && made.mesh.over_share == 0);
	unmake(&made);
}

static void a_canyon_takes_some_hundred_triangles(void **state)
{
	(void)state;
	static const struct {
		double from, length;
		uint32_t least, most;
	} cases[] = { { 100, 50, 50, 600 }, { 150, 50, 50, 1500 }, { 200, 50, 50, 1500 }, { 200, 30, 50, 1500 } };
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		ray_canyon(&scene, cases[i].from);
		struct view_cell cell = ray_cell(cases[i].length);
		struct capture_view view = ray_view(0, 0, 2.5, 869, 512, 512);
		struct impostor_options options = options_of(1);
		char name[64];
		snprintf(name, sizeof(name), "canyon_%.0f_%.0f", cases[i].from, cases[i].length);
		struct made made = make(name, ray_capture(&scene, &view), &cell, &options);
		assert_in_range(made.triangles, cases[i].least, cases[i].most);
		assert_true(made.mesh.over_share < 0.001);
		assert_int_equal(bare_pixels(&made), 0);
		unmake(&made);
	}
}

/* An image of made-up pixels: a wall that faces the eye. */
static struct capture_image blank(uint32_t width, uint32_t height)
{
	struct capture_image image = { .view = ray_view(0, 0, 2.5, 869, width, height) };
	image.rgba = calloc((size_t)width * height, 4);
	image.pixels = calloc((size_t)width * height, sizeof(*image.pixels));
	return image;
}

static const struct capture_pixel wall = {
	.object = 1, .disparity = 1 / 200.0f, .normal_oct = { 0, -127 }, .kind = PKG_MATERIAL_WALL, .triangle = 3
};

static void extremes(void **state)
{
	(void)state;
	struct view_cell cell = ray_cell(50);
	struct impostor_options options = options_of(1);

	struct made made = make("empty", blank(64, 64), &cell, &options);
	assert_int_equal(made.triangles, 0);
	unmake(&made);

	struct capture_image image = blank(64, 64);
	image.pixels[64 * 20 + 30] = wall;
	made = make("one_pixel", image, &cell, &options);
	assert_in_range(made.triangles, 1, 2);
	assert_int_equal(bare_pixels(&made), 0);
	unmake(&made);

	image = blank(300, 200);
	for (size_t i = 0; i < 300 * 200; i++)
		image.pixels[i] = wall;
	made = make("full", image, &cell, &options);
	assert_in_range(made.triangles, 4, 4); /* two cells */
	assert_int_equal(bare_pixels(&made), 0);
	assert_true(made.mesh.error_px < 1e-3);
	unmake(&made);

	image = blank(64, 64); /* every other pixel far behind */
	for (size_t i = 0; i < 64 * 64; i++) {
		image.pixels[i] = wall;
		if ((i % 64 + i / 64) % 2)
			image.pixels[i].disparity = 1 / 900.0f;
	}
	made = make("checkers", image, &cell, &options);
	assert_int_equal(bare_pixels(&made), 0);
	unmake(&made);
}

static void noise_ends(void **state)
{
	(void)state;
	struct view_cell cell = ray_cell(50);
	struct impostor_options options = options_of(1);
	options.triangles_max = 200;
	struct rng rng = rng_seed(3);
	struct capture_image image = blank(256, 128);
	for (size_t i = 0; i < 256 * 128; i++) {
		image.pixels[i] = wall;
		image.pixels[i].object = 1 + rng_u32(&rng) % 3;
		image.pixels[i].disparity = (float)rng_range(&rng, 1e-4, 1 / 120.0);
		image.pixels[i].normal_oct[0] = (int8_t)(rng_u32(&rng) % 255 - 127);
		image.pixels[i].triangle = rng_u32(&rng);
	}
	struct made made = make("noise", image, &cell, &options);
	assert_in_range(made.triangles, 1, 200);
	assert_int_equal(bare_pixels(&made), 0);
	assert_true(made.mesh.over_share > 0.5);
	unmake(&made);
}

static void tau_is_kept_and_decides_how_many_triangles(void **state)
{
	(void)state;
	static const double taus[] = { 1 / 16.0, 0.25, 1, 4, 16, 64 };
	uint32_t last = UINT32_MAX;
	ray_canyon(&scene, 150);
	struct view_cell cell = ray_cell(40);
	struct capture_view view = ray_view(0, 0, 2.5, 434, 256, 256);
	for (size_t i = 0; i < sizeof(taus) / sizeof(taus[0]); i++) {
		struct impostor_options options = options_of(taus[i]);
		char name[64];
		snprintf(name, sizeof(name), "tau_%.3f", taus[i]);
		struct made made = make(name, ray_capture(&scene, &view), &cell, &options);
		assert_int_equal(bare_pixels(&made), 0);
		assert_true(made.mesh.error_px <= taus[i] && made.mesh.over_share == 0);
		assert_true(made.triangles <= last + last / 10);
		last = made.triangles;
		unmake(&made);
	}
}

static void a_bound_on_triangles_is_kept(void **state)
{
	(void)state;
	ray_canyon(&scene, 100);
	struct view_cell cell = ray_cell(50);
	struct capture_view view = ray_view(0, 0, 2.5, 869, 512, 512);
	for (uint32_t most = 200; most >= 50; most /= 2) {
		struct impostor_options options = options_of(1);
		options.triangles_max = most;
		char name[64];
		snprintf(name, sizeof(name), "bound_%u", most);
		struct made made = make(name, ray_capture(&scene, &view), &cell, &options);
		assert_in_range(made.triangles, 1, most);
		assert_int_equal(bare_pixels(&made), 0);
		unmake(&made);
	}
}

static void a_regular_grid_takes_more_for_less(void **state)
{
	(void)state;
	ray_canyon(&scene, 150);
	struct view_cell cell = ray_cell(40);
	struct capture_view view = ray_view(0, 0, 2.5, 869, 512, 256);
	struct impostor_options options = options_of(1);
	struct made planes = make("planes", ray_capture(&scene, &view), &cell, &options);
	options.interior = IMPOSTOR_GRID;
	struct made grid = make("grid", ray_capture(&scene, &view), &cell, &options);
	assert_int_equal(bare_pixels(&grid), 0);
	assert_true(grid.triangles > planes.triangles);
	assert_true(grid.mesh.over_share > planes.mesh.over_share);
	unmake(&planes);
	unmake(&grid);
}

static void sizes_from_64_to_2048(void **state)
{
	(void)state;
	ray_canyon(&scene, 200);
	scene.ball_count = 0;
	struct view_cell cell = ray_cell(30);
	struct impostor_options options = options_of(1);
	for (uint32_t size = 64; size <= 2048; size *= size < 256 ? 2 : 8) {
		struct capture_view view = ray_view(0, 0, 2.5, size, size, size / 4);
		char name[64];
		snprintf(name, sizeof(name), "size_%u", size);
		struct made made = make(name, ray_capture(&scene, &view), &cell, &options);
		assert_int_equal(bare_pixels(&made), 0);
		unmake(&made);
	}
}

static void the_same_image_gives_the_same_mesh(void **state)
{
	(void)state;
	ray_canyon(&scene, 150);
	struct view_cell cell = ray_cell(40);
	struct capture_view view = ray_view(1, 3, 2.5, 434, 256, 256);
	struct impostor_options options = options_of(1);
	struct made a = make("once", ray_capture(&scene, &view), &cell, &options);
	struct made b = make("again", ray_capture(&scene, &view), &cell, &options);
	assert_int_equal(a.mesh.vertices.count, b.mesh.vertices.count);
	assert_int_equal(a.mesh.indices.count, b.mesh.indices.count);
	assert_memory_equal(
		a.mesh.vertices.items, b.mesh.vertices.items, a.mesh.vertices.count * sizeof(struct mesh_vertex));
	assert_memory_equal(a.mesh.indices.items, b.mesh.indices.items, a.mesh.indices.count * sizeof(uint32_t));
	assert_memory_equal(a.mesh.texels.items, b.mesh.texels.items, a.mesh.texels.count);
	unmake(&a);
	unmake(&b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_facade_is_two_triangles),
		cmocka_unit_test(a_canyon_takes_some_hundred_triangles),
		cmocka_unit_test(extremes),
		cmocka_unit_test(noise_ends),
		cmocka_unit_test(tau_is_kept_and_decides_how_many_triangles),
		cmocka_unit_test(a_bound_on_triangles_is_kept),
		cmocka_unit_test(a_regular_grid_takes_more_for_less),
		cmocka_unit_test(sizes_from_64_to_2048),
		cmocka_unit_test(the_same_image_gives_the_same_mesh),
	};
	return cmocka_run_group_tests_name("tools/impostor_mesh", tests, NULL, NULL);
}
