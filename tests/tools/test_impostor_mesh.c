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
	assert_true(made.mesh.over_share <= 0.005);
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
		assert_true(made.mesh.over_share < 0.01);
		unmake(&made);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_facade_is_two_triangles),
		cmocka_unit_test(a_canyon_takes_some_hundred_triangles),
	};
	return cmocka_run_group_tests_name("tools/impostor_mesh", tests, NULL, NULL);
}
