/* Drives through made-up far fields without a GPU: what is drawn from where, what stands in for what is missing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
/* before cmocka */
#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/base/geo.h"
#include "render/cell_choice.h"
#include "render/far_cells.h"
#include "render/frame.h"
#include "tests/assets/far_city.h"

#define ARENA_BYTES ((size_t)96 << 20)
#define FRAME_NS (NS_PER_S / 30)
#define IMPOSTOR_TRIANGLES 300 /* of one cell */

static const struct far_city_config street = { .edges = 4,
	.stretches_an_edge = 5,
	.objects_a_chunk = 10,
	.triangles_an_object = 40,
	.impostor_vertices = IMPOSTOR_TRIANGLES,
	.impostor_pages = 3 };

/* Interposes the allocator of the whole program. */
static unsigned long allocations;
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);

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
#endif

struct fixture {
	struct pkg pkg;
	uint8_t *memory;
	struct arena arena;
	struct renderer *renderer;
	int64_t time_ns;
	struct renderer_stats stats;
};

static void open_city(struct fixture *fixture, const struct far_city_config *config)
{
	size_t size;
	struct pkg_fault fault = { 0 };
	uint8_t *bytes = far_city_build(config, &size);
	int status = far_city_open(bytes, size, &fixture->pkg, &fault);
	free(bytes);
	if (status)
		fail_msg("%s", fault.text);
	fixture->memory = malloc(ARENA_BYTES);
	arena_init(&fixture->arena, "city", fixture->memory, ARENA_BYTES);
}

static void start(struct fixture *fixture, const struct far_city_config *city, const struct renderer_config *wanted)
{
	*fixture = (struct fixture){ 0 };
	open_city(fixture, city);
	struct renderer_config config = *wanted;
	config.width = 640;
	config.height = 360;
	config.gfx = &gfx_dummy;
	config.deterministic = true;
	assert_int_equal(renderer_init(&fixture->renderer, &fixture->arena, &config, &fixture->pkg), 0);
}

static void stop(struct fixture *fixture)
{
	renderer_finish(fixture->renderer);
	pkg_close(&fixture->pkg);
	free(fixture->memory);
}

/* A frame from a car at x, of the street along x. */
static void frame(struct fixture *fixture, double x_m, double y_m, double heading_rad)
{
	const double edge_m = street.stretches_an_edge * FAR_CITY_STRETCH_MM * 1e-3;
	uint32_t edge = (uint32_t)(x_m / edge_m);
	struct nav_view nav = { .located = true,
		.on_street = y_m > -6.0 && y_m < 6.0,
		.time_ns = fixture->time_ns,
		.half = edge * 2,
		.along_m = x_m - edge * edge_m,
		.pos_mm = { (int64_t)(x_m * 1000.0), (int64_t)(y_m * 1000.0), 0 },
		.heading_bam = bam_from_rad(heading_rad),
		.ambient = -1.0 };
	uint32_t stretch = cell_choice_of_car(&fixture->pkg, &nav);
	for (uint32_t i = 0; i < 3 && stretch != PKG_NONE && stretch + i < fixture->pkg.stretch_count; i++)
		nav.likely[nav.likely_count++] = stretch + i;
	struct renderer_time time = { .time_ns = fixture->time_ns, .ambient = -1.0 };
	renderer_draw(fixture->renderer, &nav, &time);
	renderer_stats(fixture->renderer, &fixture->stats);
	fixture->time_ns += FRAME_NS;
}

static const double EAST = BLVD_PI / 2.0;

static void a_drive_meets_every_stretch_and_never_falls_back(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		uint32_t far_least, far_most;
	} cases[] = { { "impostor", IMPOSTOR_TRIANGLES, 2 * IMPOSTOR_TRIANGLES }, { "pvs", 0, 3 * 10 * 14 } };
	for (size_t c = 0; c < sizeof(cases) / sizeof(cases[0]); c++) {
		struct fixture f;
		start(&f, &street, &(struct renderer_config){ .far_name = cases[c].name });
		assert_string_equal(f.stats.far_name ? f.stats.far_name : cases[c].name, cases[c].name);
		frame(&f, 10.0, 0.0, EAST);
		unsigned long before = allocations;
		size_t used = f.arena.used;
		uint64_t bytes = f.stats.gpu_bytes;
		for (double x = 10.0; x < 900.0; x += 0.5) {
			frame(&f, x, 0.0, EAST);
			assert_false(f.stats.far_fallback);
			assert_in_range(f.stats.far_triangles, cases[c].far_least, cases[c].far_most);
		}
		if (COUNTS)
			assert_int_equal(allocations, before);
		assert_int_equal(f.arena.used, used);
		assert_int_equal(f.stats.gpu_bytes, bytes);
		assert_int_equal(f.stats.far_entered, 18);
		assert_true(f.stats.draws > 2 && f.stats.draws < 150);
		stop(&f);
	}
}

static void the_old_impostor_dissolves_for_a_fifth_of_a_second(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, &street, &(struct renderer_config){ .far_name = "impostor" });
	double x = 30.0;
	for (; f.stats.far_entered < 2; x += 0.3)
		frame(&f, x, 0.0, EAST);
	int both = 0;
	for (; f.stats.far_triangles == 2 * IMPOSTOR_TRIANGLES; x += 0.3, both++)
		frame(&f, x, 0.0, EAST);
	assert_in_range(both, 5, 7);
	for (int i = 0; i < 20; i++, x += 0.3) {
		frame(&f, x, 0.0, EAST);
		assert_int_equal(f.stats.far_triangles, IMPOSTOR_TRIANGLES);
	}
	stop(&f);
}

static void turning_round_shows_the_other_cell_too(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, &street, &(struct renderer_config){ .far_name = "impostor" });
	for (int i = 0; i < 40; i++)
		frame(&f, 220.0, 0.0, EAST);
	assert_int_equal(f.stats.far_triangles, IMPOSTOR_TRIANGLES);
	for (int i = 0; i < 40; i++)
		frame(&f, 220.0, 0.0, 0.0);
	assert_int_equal(f.stats.far_triangles, 2 * IMPOSTOR_TRIANGLES);
	for (int i = 0; i < 60; i++)
		frame(&f, 220.0, 0.0, -EAST);
	assert_int_equal(f.stats.far_triangles, IMPOSTOR_TRIANGLES);
	assert_false(f.stats.far_fallback);
	stop(&f);
}

static void beside_the_street_all_geometry_around_stands_in(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, &street, &(struct renderer_config){ .far_name = "impostor" });
	frame(&f, 300.0, 30.0, EAST);
	assert_true(f.stats.far_fallback && !f.stats.far_late);
	assert_in_range(f.stats.far_triangles, IMPOSTOR_TRIANGLES, 2 * IMPOSTOR_TRIANGLES);
	frame(&f, 300.0, 3000.0, EAST);
	assert_true(f.stats.far_fallback);
	assert_int_equal(f.stats.far_triangles, 0);
	renderer_camera(f.renderer)->kind = CAMERA_NORTH_UP;
	for (int i = 0; i < 90; i++)
		frame(&f, 300.0, 0.0, EAST);
	assert_true(f.stats.far_fallback && !f.stats.far_late);
	assert_int_equal(f.stats.far_triangles, 0);
	stop(&f);
}

static void without_a_place_nothing_falls_back_and_then_the_first_picture_has_its_cell(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, &street, &(struct renderer_config){ .far_name = "impostor" });
	struct nav_view nowhere = { .half = PKG_NONE, .ambient = -1.0 };
	for (int i = 0; i < 3; i++) {
		struct renderer_time time = { .time_ns = f.time_ns, .ambient = -1.0 };
		renderer_draw(f.renderer, &nowhere, &time);
		renderer_stats(f.renderer, &f.stats);
		f.time_ns += FRAME_NS;
		assert_int_equal(f.stats.far_triangles, 0);
		assert_true(f.stats.triangles > 0);
		assert_false(f.stats.far_fallback || f.stats.far_late);
	}
	frame(&f, 610.0, 0.0, EAST);
	assert_int_equal(f.stats.far_triangles, IMPOSTOR_TRIANGLES);
	assert_false(f.stats.far_fallback || f.stats.far_late);
	stop(&f);
}

static void what_is_not_loaded_in_time_is_late_until_it_is(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, &street, &(struct renderer_config){ .far_name = "impostor", .upload_slice_bytes = PKG_PAGE_BYTES });
	frame(&f, 30.0, 0.0, EAST);
	assert_false(f.stats.far_late);
	frame(&f, 180.0, 0.0, EAST); /* farther than anything asked for, less than a jump */
	assert_true(f.stats.far_late && f.stats.far_fallback);
	int late = 0;
	for (; f.stats.far_late; late++)
		frame(&f, 180.0, 0.0, EAST);
	assert_in_range(late, 3, 20);
	for (int i = 0; i < 10; i++) {
		frame(&f, 180.0, 0.0, EAST);
		assert_false(f.stats.far_fallback);
	}
	stop(&f);
}

/* Where view cells overlap, the one that is loaded does. */
static void what_is_there_and_holds_the_eye_stands_in(void **state)
{
	(void)state;
	struct fixture f;
	start(&f, &street, &(struct renderer_config){ .far_name = "impostor", .upload_slice_bytes = PKG_PAGE_BYTES });
	frame(&f, 275.0, 0.0, EAST);
	frame(&f, 95.0, 0.0, EAST);
	assert_true(f.stats.far_late);
	frame(&f, 247.0, 0.0, -EAST);
	assert_false(f.stats.far_late || f.stats.far_fallback);
	stop(&f);
}

static void geometry_cells_and_coarse_cells_show_their_visible_set(void **state)
{
	(void)state;
	struct far_city_config city = street;
	city.geometry_every = 1;
	struct fixture f;
	start(&f, &city, &(struct renderer_config){ .far_name = "auto" });
	frame(&f, 260.0, 0.0, EAST);
	assert_string_equal(f.stats.far_name, "impostor");
	assert_in_range(f.stats.far_triangles, 1, 3 * 10 * 14);
	assert_false(f.stats.far_fallback);
	stop(&f);
}

static void a_package_without_a_far_field_has_no_impostors(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	open_city(&f, &street);
	struct pkg plain = f.pkg;
	plain.stretches = NULL;
	plain.stretch_count = 0;
	struct renderer_config config = { .width = 64, .height = 64, .gfx = &gfx_dummy, .far_name = "impostor" };
	assert_int_not_equal(renderer_init(&f.renderer, &f.arena, &config, &plain), 0);
	assert_null(f.renderer);
	config.far_name = "auto";
	assert_int_equal(renderer_init(&f.renderer, &f.arena, &config, &plain), 0);
	renderer_stats(f.renderer, &f.stats);
	assert_string_equal(f.stats.far_name, "full");
	stop(&f);
}

static void a_stretch_is_kept_while_its_view_cell_holds_the_eye(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	open_city(&f, &street);
	struct cell_choice choice;
	cell_choice_init(&choice, &f.pkg);
	/* they meet at 50 m and overlap by 2 m to either side */
	static const struct {
		double x_m, y_m;
		uint32_t stretch;
	} way[] = { { 20.0, 0.0, 0 }, { 49.0, 0.0, 0 }, { 51.0, 0.0, 0 }, { 51.9, 1.0, 0 }, { 52.1, 1.0, 1 },
		{ 49.0, 0.0, 1 }, { 47.9, 0.0, 0 }, { 262.0, 300.0, 5 }, { 1200.0, 0.0, 19 } };
	for (size_t i = 0; i < sizeof(way) / sizeof(way[0]); i++) {
		const int64_t eye_mm[3] = { (int64_t)(way[i].x_m * 1000.0), (int64_t)(way[i].y_m * 1000.0), 2500 };
		assert_int_equal(cell_choice_make(&choice, NULL, eye_mm), way[i].stretch);
	}
	pkg_close(&f.pkg);
	free(f.memory);
}

/* No time between frames, ten seconds, the clock put back, standing for an hour: the distance is there in every frame,
 * and nothing dissolves for ever. */
static void strange_times_keep_the_distance(void **state)
{
	(void)state;
	static const int64_t steps_ns[] = { 0, 0, 10 * NS_PER_S, -5 * NS_PER_S, 0, -3600 * NS_PER_S, FRAME_NS,
		3600 * NS_PER_S };
	struct fixture f;
	start(&f, &street, &(struct renderer_config){ .far_name = "impostor" });
	for (double x = 10.0; x < 120.0; x += 0.3)
		frame(&f, x, 0.0, EAST);
	for (size_t i = 0; i < sizeof(steps_ns) / sizeof(steps_ns[0]); i++) {
		/* into the next stretch, so that something dissolves when the time is strange */
		double x = 120.0 + 50.0 * (double)i;
		for (int k = 0; k < 60; k++)
			frame(&f, x + k * 0.5, 0.0, EAST);
		f.time_ns += steps_ns[i] - FRAME_NS;
		frame(&f, x + 30.0, 0.0, EAST);
		assert_true(f.stats.far_triangles >= IMPOSTOR_TRIANGLES && !f.stats.far_fallback);
		for (int k = 0; k < 20; k++)
			frame(&f, x + 30.0, 0.0, EAST);
		assert_int_equal(f.stats.far_triangles, IMPOSTOR_TRIANGLES);
	}
	for (int i = 0; i < 3600; i++) { /* an hour at a frame a second */
		f.time_ns += NS_PER_S;
		frame(&f, 500.0, 0.0, EAST);
		assert_false(f.stats.far_fallback);
	}
	assert_int_equal(f.stats.far_triangles, IMPOSTOR_TRIANGLES);
	stop(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_drive_meets_every_stretch_and_never_falls_back),
		cmocka_unit_test(the_old_impostor_dissolves_for_a_fifth_of_a_second),
		cmocka_unit_test(turning_round_shows_the_other_cell_too),
		cmocka_unit_test(beside_the_street_all_geometry_around_stands_in),
		cmocka_unit_test(without_a_place_nothing_falls_back_and_then_the_first_picture_has_its_cell),
		cmocka_unit_test(what_is_not_loaded_in_time_is_late_until_it_is),
		cmocka_unit_test(what_is_there_and_holds_the_eye_stands_in),
		cmocka_unit_test(geometry_cells_and_coarse_cells_show_their_visible_set),
		cmocka_unit_test(a_package_without_a_far_field_has_no_impostors),
		cmocka_unit_test(a_stretch_is_kept_while_its_view_cell_holds_the_eye),
		cmocka_unit_test(strange_times_keep_the_distance),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
