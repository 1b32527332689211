/*
 * Cities at the edge of what there is, baked the way a user bakes them and drawn: other sides of the world, next to
 * nothing and far too much, budgets, sizes and angles from end to end. Skipped without GL.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include <errno.h>
#include <string.h>

#include "assets/cells.h"
#include "platform/base/clock.h"
#include "platform/display/display.h"
#include "render/frame.h"
#include "tests/tools/town.h"
#include "tools/measure/holes.h"

/* The driver keeps what it allocated when it is unloaded. */
const char *__asan_default_options(void); /* NOLINT: the sanitizer's name */
const char *__asan_default_options(void)  /* NOLINT */
{
	return "detect_leaks=0";
}

#define WIDTH 320
#define HEIGHT 180
#define ARENA_BYTES ((size_t)256 << 20) /* untouched pages cost nothing */
#define FOV_RAD (BLVD_PI / 4.0)
#define UNCOVERED_SHARE 0.002 /* pixels four times as large as those of the screen baked for */

static char folder[] = "/tmp/blvd-test-far-edges-XXXXXX";
static struct display display;

/* --- cities --- */

/* A street of 40 m with houses at it and others in the distance. */
static void write_street(struct town *town)
{
	long long west = town_node(town, 0, 0), east = town_node(town, 40, 0);
	town_street(town, (long long[]){ west, east }, 2, "High Street");
	town_row(town, -8, 9, 4, 14, 12, true);
	town_row(town, -8, -21, 4, 14, 12, true);
	for (int side = -1; side <= 1; side += 2) {
		for (int row = 0; row < 3; row++) {
			town_row(town, 180 + row * 40, side > 0 ? 16 : -96, 5, 16, 12, false);
			town_row(town, -160 - row * 40, side > 0 ? 16 : -96, 5, 16, 12, false);
		}
	}
	town_house(town, 320, -30, 20, 60, 40);
	town_house(town, -300, -30, 20, 60, 30);
}

static void write_lone_house(struct town *town)
{
	long long west = town_node(town, 0, 0), east = town_node(town, 40, 0);
	town_street(town, (long long[]){ west, east }, 2, "Lonely Lane");
	town_house(town, 250, -20, 30, 40, 30);
}

static void write_no_house(struct town *town)
{
	long long west = town_node(town, 0, 0), east = town_node(town, 40, 0);
	town_street(town, (long long[]){ west, east }, 2, "Empty Lane");
}

/* Ten kilometres straight on, and a way whose two nodes are in one place. */
static void write_long_street(struct town *town)
{
	long long west = town_node(town, -5010, 0), middle = town_node(town, 0, 0), again = town_node(town, 0, 0),
			  east = town_node(town, 5010, 0);
	town_street(town, (long long[]){ west, east }, 2, "Long Road");
	town_street(town, (long long[]){ middle, again }, 2, "Short Road");
	town_row(town, -40, 14, 6, 14, 12, true);
}

/* Round towers with onions for roofs. */
static void write_onion(struct town *town, double x, double y, double radius)
{
	enum { CORNERS = 48 };
	long long nodes[CORNERS + 1];
	for (int i = 0; i < CORNERS; i++)
		nodes[i] =
			town_node(town, x + radius * cos(i * 2 * BLVD_PI / CORNERS), y + radius * sin(i * 2 * BLVD_PI / CORNERS));
	nodes[CORNERS] = nodes[0];
	town_way(town, nodes, CORNERS + 1,
		(const char *const[]){ "building=tower", "height=14", "roof:height=6", "roof:shape=onion", NULL });
}

/* A block between four streets, full of towers: a million triangles. A street leads to it. */
#define TOWERS_A_ROW 44
static void write_crowded_block(struct town *town)
{
	const double pitch = 12.0, side = TOWERS_A_ROW * pitch + 20.0;
	long long start = town_node(town, -40, 0), corners[5] = { town_node(town, 0, 0), town_node(town, side, 0),
		town_node(town, side, side), town_node(town, 0, side) };
	corners[4] = corners[0];
	town_street(town, (long long[]){ start, corners[0] }, 2, "Spur");
	town_street(town, corners, 5, "Ring");
	for (int row = 0; row < TOWERS_A_ROW; row++)
		for (int column = 0; column < TOWERS_A_ROW; column++)
			write_onion(town, 18.0 + column * pitch, 18.0 + row * pitch, 5.0);
}

struct place {
	const char *name;
	struct geo_point at;
	void (*write)(struct town *town);
	const char *far[10]; /* options of the far field */
};

enum { OCEAN, QUARTER, ANTIMERIDIAN, POLE, LONE, EMPTY, LONG, CROWDED, FINE, COARSE, PLACES };
#define NEAR "--near", "120"
#define ALL "--far", "all", NEAR, "--truth"
static const struct place places[PLACES] = {
	[OCEAN] = { "ocean", { 0.0, -150.0 }, write_street, { ALL } },
	/* on the equator a quarter of the way round the earth is 10^7 m */
	[QUARTER] = { "quarter", { 0.0, -60.0 }, write_street, { ALL } },
	[ANTIMERIDIAN] = { "antimeridian", { 0.0, 180.0 }, write_street, { "--far", "pvs", NEAR } },
	[POLE] = { "pole", { 89.9, 20.0 }, write_street, { "--far", "pvs", NEAR } },
	[LONE] = { "lone", { 46.0, 6.0 }, write_lone_house, { ALL } },
	[EMPTY] = { "empty", { 46.0, 6.0 }, write_no_house, { ALL } },
	[LONG] = { "long", { 46.0, 6.0 }, write_long_street, { "--far", "all", "--near", "2000", "--truth" } },
	[CROWDED] = { "crowded", { 46.0, 6.0 }, write_crowded_block,
		{ "--far", "all", NEAR, "--truth", "--cells", "0-0" } },
	/* from the first one's package */
	[FINE] = { "fine", { 0.0, -150.0 }, NULL, { ALL, "--tau", "0.0625" } },
	[COARSE] = { "coarse", { 0.0, -150.0 }, NULL, { ALL, "--tau", "64" } },
};
static struct pkg cities[PLACES];
static const struct dvec2 pixel_middle = { 0, 0 };

static void bake_place(int which)
{
	char map[128], package[128];
	struct town town;
	struct pkg_fault fault = { 0 };
	snprintf(map, sizeof(map), "%s/%s.osm", folder, places[which].name);
	snprintf(package, sizeof(package), "%s/%s.blvd", folder, places[which].name);
	if (places[which].write) {
		town_open(&town, map, places[which].at);
		places[which].write(&town);
		town_close(&town);
	} else {
		snprintf(map, sizeof(map), "%s/%s.blvd", folder, places[OCEAN].name);
	}
	assert_int_equal(town_bake(map, package, places[which].far), EXIT_DONE);
	assert_int_equal(pkg_open(&cities[which], package, &fault), 0);
	assert_int_equal(pkg_verify(&cities[which], &fault), 0);
}

static int bake_places(void **state)
{
	(void)state;
	assert_non_null(mkdtemp(folder));
	for (int i = 0; i < PLACES; i++)
		bake_place(i);
	/* without any GL here the tests are skipped */
	struct display_config config = { .width = WIDTH, .height = HEIGHT };
	display_open(&display, &display_surfaceless, &config);
	return 0;
}

static int remove_places(void **state)
{
	(void)state;
	char command[128];
	display_close(&display);
	for (int i = 0; i < PLACES; i++)
		pkg_close(&cities[i]);
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

/* --- drawing --- */

struct easel {
	struct renderer *renderer;
	struct arena arena;
	uint32_t width, height;
	uint8_t *px;
	struct truth_pixel *truth;
};

/* Returns what renderer_init() does. */
static int try_easel(struct easel *easel, int city, const struct renderer_config *wanted)
{
	struct renderer_config config = *wanted;
	if (!display.ops)
		skip();
	config.width = config.width ? config.width : WIDTH;
	config.height = config.height ? config.height : HEIGHT;
	config.samples = 1;
	config.get_proc = config.get_proc ? config.get_proc : display_get_proc;
	*easel = (struct easel){ .width = config.width, .height = config.height };
	arena_init(&easel->arena, "city", malloc(ARENA_BYTES), ARENA_BYTES);
	easel->px = malloc((size_t)config.width * config.height * 4);
	if (config.truth)
		easel->truth = malloc(sizeof(*easel->truth) * config.width * config.height);
	return renderer_init(&easel->renderer, &easel->arena, &config, &cities[city]);
}

static void close_easel(struct easel *easel)
{
	renderer_finish(easel->renderer);
	free(easel->arena.base);
	free(easel->px);
	free(easel->truth);
}

static struct easel open_easel(int city, const char *far_name, bool truth)
{
	struct easel easel;
	struct renderer_config config = { .far_name = far_name, .truth = truth };
	assert_int_equal(try_easel(&easel, city, &config), 0);
	return easel;
}

static void draw(struct easel *easel, const struct camera_pose *pose)
{
	struct renderer_time noon = { .time_ns = NS_PER_S, .ambient = -1.0 };
	renderer_draw_pose(easel->renderer, pose, &noon);
	renderer_read_pixels(easel->renderer, easel->px);
	if (easel->truth)
		renderer_read_truth(easel->renderer, pixel_middle, (uint32_t *)(void *)easel->truth);
}

/* An eye above a street that runs along x: metres from where its file begins to count. */
static struct camera_pose pose_at(int city, double x_m, double y_m, double heading_rad)
{
	struct geo_frame frame =
		geo_frame_at((struct geo_point){ cities[city].meta->origin_lat_deg, cities[city].meta->origin_lon_deg });
	struct dvec2 zero = geo_to_plane(&frame, places[city].at);
	struct camera_pose pose = { .heading_rad = heading_rad, .fov_rad = FOV_RAD };
	pose.eye_mm[0] = llrint((zero.x + x_m) * 1e3);
	pose.eye_mm[1] = llrint((zero.y + y_m) * 1e3);
	pose.eye_mm[2] = pkg_ground_mm(&cities[city], pose.eye_mm[0], pose.eye_mm[1]) + 2500;
	return pose;
}

static const double EAST = BLVD_PI / 2.0, WEST = -BLVD_PI / 2.0;

static int largest_difference(const struct easel *a, const struct easel *b)
{
	int largest = 0;
	for (size_t i = 0; i < (size_t)a->width * a->height * 4; i++) {
		int d = abs(a->px[i] - b->px[i]);
		largest = d > largest ? d : largest;
	}
	return largest;
}

/* Share of the pixels that differ by more than so many levels. */
static double differing_share(const struct easel *a, const struct easel *b, int levels)
{
	size_t pixels = (size_t)a->width * a->height, count = 0;
	for (size_t i = 0; i < pixels; i++) {
		bool differs = false;
		for (int c = 0; c < 3; c++)
			differs |= abs(a->px[4 * i + (size_t)c] - b->px[4 * i + (size_t)c]) > levels;
		count += differs;
	}
	return (double)count / (double)pixels;
}

static struct truth_image truth_of(const struct easel *easel, const struct camera_pose *pose)
{
	struct view view;
	camera_view(pose, easel->width, easel->height, 1.0, 2.0, &view);
	return truth_image_of(&view, pixel_middle, easel->truth);
}

static bool is_land(int city, uint32_t object)
{
	return object && object <= cities[city].object_count && cities[city].objects[object - 1].kind == PKG_OBJECT_GROUND;
}

/* What all geometry shows, the other shows too; land at the horizon may be left to the backdrop. */
static void assert_complete(
	int city, const struct easel *full, const struct easel *shown, const struct camera_pose *pose)
{
	struct truth_image reference = truth_of(full, pose), image = truth_of(shown, pose);
	struct holes holes;
	size_t pixels = (size_t)full->width * full->height;
	uint8_t *map = malloc(pixels);
	if (!map || !full->truth || !shown->truth)
		abort();
	holes_find(&reference, NULL, &image, &holes, map);
	for (size_t i = 0; i < pixels; i++)
		holes.uncovered -= map[i] && is_land(city, reference.pixels[i].object);
	free(map);
	assert_true(holes.drawn > 0);
	assert_true((double)holes.uncovered <= UNCOVERED_SHARE * (double)pixels);
}

/* --- other sides of the world --- */

static void assert_same_pictures(int a_city, int b_city, const char *far_name)
{
	static const struct {
		double x_m, y_m, heading_rad;
	} eyes[] = { { 5.0, 0.0, 1.5 }, { 38.0, -2.0, 1.7 }, { 20.0, 2.0, -1.4 } };
	struct easel a = open_easel(a_city, far_name, false), b = open_easel(b_city, far_name, false);
	for (size_t i = 0; i < sizeof(eyes) / sizeof(eyes[0]); i++) {
		struct camera_pose at_a = pose_at(a_city, eyes[i].x_m, eyes[i].y_m, eyes[i].heading_rad),
						   at_b = pose_at(b_city, eyes[i].x_m, eyes[i].y_m, eyes[i].heading_rad);
		draw(&a, &at_a);
		draw(&b, &at_b);
		assert_in_range(largest_difference(&a, &b), 0, 1);
	}
	close_easel(&a);
	close_easel(&b);
}

static void a_world_moved_by_ten_thousand_kilometres_looks_the_same(void **state)
{
	(void)state;
	assert_int_equal(cities[OCEAN].cells[0].kind, PKG_CELL_IMPOSTOR);
	assert_same_pictures(OCEAN, QUARTER, "full");
	assert_same_pictures(OCEAN, QUARTER, "impostor");
}

static void the_antimeridian_is_no_border(void **state)
{
	(void)state;
	assert_same_pictures(OCEAN, ANTIMERIDIAN, "pvs");
}

static void near_the_pole_a_city_is_a_city(void **state)
{
	(void)state;
	assert_int_equal(cities[POLE].graph.edge_count, cities[OCEAN].graph.edge_count);
	assert_int_equal(cities[POLE].stretch_count, cities[OCEAN].stretch_count);
	struct easel pole = open_easel(POLE, "pvs", false), equator = open_easel(OCEAN, "pvs", false);
	struct camera_pose at_pole = pose_at(POLE, 10.0, 0.0, EAST), at_equator = pose_at(OCEAN, 10.0, 0.0, EAST);
	draw(&pole, &at_pole);
	draw(&equator, &at_equator);
	/* the sun stands lower and colours houses by chance of their ids: what is sky and what is not is the same */
	size_t pixels = (size_t)WIDTH * HEIGHT, unlike = 0;
	for (size_t i = 0; i < pixels; i++) {
		const uint8_t *p = pole.px + 4 * i, *e = equator.px + 4 * i;
		unlike += (p[2] > p[0] + 15) != (e[2] > e[0] + 15);
	}
	assert_true(unlike < pixels / 10);
	close_easel(&pole);
	close_easel(&equator);
}

static void headings_on_both_sides_of_south_look_the_same(void **state)
{
	(void)state;
	static const double headings[] = { BLVD_PI, BLVD_PI - 1e-9, -BLVD_PI + 1e-9, -BLVD_PI, 3.0 * BLVD_PI };
	struct easel first = open_easel(OCEAN, "impostor", false), other = open_easel(OCEAN, "impostor", false);
	for (size_t i = 0; i < sizeof(headings) / sizeof(headings[0]); i++) {
		struct camera_pose pose = pose_at(OCEAN, 20.0, 0.0, headings[i]);
		draw(i ? &other : &first, &pose);
		if (i)
			assert_in_range(largest_difference(&first, &other), 0, 1);
	}
	close_easel(&first);
	close_easel(&other);
}

/* --- next to nothing, and far too much --- */

static void assert_complete_along(int city, double from_x_m, double to_x_m)
{
	struct easel full = open_easel(city, "full", true), shown = open_easel(city, "impostor", true);
	for (int i = 0; i < 3; i++) {
		struct camera_pose pose = pose_at(city, from_x_m + (to_x_m - from_x_m) * i / 2, 0.0, i == 1 ? WEST : EAST);
		draw(&full, &pose);
		draw(&shown, &pose);
		assert_complete(city, &full, &shown, &pose);
	}
	close_easel(&full);
	close_easel(&shown);
}

static void one_building_is_seen_from_afar(void **state)
{
	(void)state;
	assert_complete_along(LONE, 2.0, 38.0);
	struct easel shown = open_easel(LONE, "impostor", true);
	struct camera_pose pose = pose_at(LONE, 20.0, 0.0, EAST);
	draw(&shown, &pose);
	unsigned house = 0;
	for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
		uint32_t object = shown.truth[i].object;
		house += object && object <= cities[LONE].object_count &&
				 cities[LONE].objects[object - 1].kind == PKG_OBJECT_BUILDING;
	}
	assert_true(house > 100);
	close_easel(&shown);
}

static void a_town_without_buildings_is_land_and_street(void **state)
{
	(void)state;
	for (uint32_t i = 0; i < cities[EMPTY].object_count; i++)
		assert_int_not_equal(cities[EMPTY].objects[i].kind, PKG_OBJECT_BUILDING);
	assert_complete_along(EMPTY, 2.0, 38.0);
}

static void a_street_of_ten_kilometres_is_one_edge(void **state)
{
	(void)state;
	uint32_t longest = 0;
	for (uint32_t i = 0; i < cities[LONG].graph.edge_count; i++)
		if (cities[LONG].graph.edges[i].length_mm > longest)
			longest = cities[LONG].graph.edges[i].length_mm;
	assert_true(longest > 5000000);
	struct easel full = open_easel(LONG, "full", true);
	for (int end = -1; end <= 1; end++) {
		struct camera_pose pose = pose_at(LONG, end * 5000.0, 0.0, end > 0 ? WEST : EAST);
		draw(&full, &pose);
		for (uint32_t x = 0; x < WIDTH; x++)
			assert_true(full.truth[(size_t)(HEIGHT - 1) * WIDTH + x].object);
	}
	close_easel(&full);
}

/* The magnification rule cuts it, and what it stores is bounded by its length. */
static void a_street_of_ten_kilometres_is_baked_in_stretches(void **state)
{
	(void)state;
	const struct pkg *pkg = &cities[LONG];
	uint32_t at_mm = 0;
	uint64_t bytes = 0;
	assert_in_range(pkg->stretch_count, 10000 / 60, 10040 / 60 + 2);
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		const struct pkg_stretch *stretch = &pkg->stretches[i];
		assert_int_equal(stretch->from_mm, at_mm);
		assert_in_range(stretch->to_mm - stretch->from_mm, 1, 60000);
		at_mm = stretch->to_mm;
		bytes += stretch->local.stored_bytes + stretch->pvs.stored_bytes;
		for (int side = 0; side < 2; side++)
			bytes += pkg->cells[2 * i + (uint32_t)side].impostor.stored_bytes;
	}
	assert_int_equal(at_mm, pkg->graph.edges[pkg->stretches[0].edge].length_mm);
	print_message("%u stretches, %llu bytes\n", pkg->stretch_count, (unsigned long long)bytes);
	assert_true(bytes < (uint64_t)pkg->stretch_count * 4096); /* there is not much to see */
	/* and no more of it has to be resident than of a lane */
	assert_true(pkg->meta->resident_bound_bytes < cities[OCEAN].meta->resident_bound_bytes);
}

static void a_street_of_ten_kilometres_is_driven_by_its_cells(void **state)
{
	(void)state;
	assert_complete_along(LONG, -4990.0, 4990.0);
	struct easel shown = open_easel(LONG, "impostor", false);
	struct renderer_stats stats = { 0 };
	for (uint32_t i = 0; i < cities[LONG].stretch_count; i += 4) {
		const struct pkg_stretch *stretch = &cities[LONG].stretches[i];
		struct camera_pose pose = { .heading_rad = i % 8 ? EAST : WEST, .fov_rad = FOV_RAD };
		for (int axis = 0; axis < 3; axis++)
			pose.eye_mm[axis] = ((int64_t)stretch->start_mm[axis] + stretch->end_mm[axis]) / 2;
		pose.eye_mm[2] += 2500;
		draw(&shown, &pose);
		renderer_stats(shown.renderer, &stats);
		assert_false(stats.far_fallback);
	}
	assert_int_equal(stats.far_entered, (cities[LONG].stretch_count + 3) / 4);
	close_easel(&shown);
}

static void a_million_triangles_in_one_block(void **state)
{
	(void)state;
	assert_true(cities[CROWDED].meta->triangle_count > 1000000);
	assert_true(cities[CROWDED].stretch_count > 0);
	assert_complete_along(CROWDED, -35.0, -5.0);
}

/* --- where the eye should not be, and how it looks --- */

static void a_wall_at_the_near_plane_hides_what_is_behind_it(void **state)
{
	(void)state;
	/* houses begin 9 m beside the street; the near plane is 0.35 m away */
	static const double away_m[] = { 0.5, 0.36, 0.351, 0.349, 0.3, 0.01, 0.0, -0.01, -3.0 };
	struct easel full = open_easel(OCEAN, "full", true), shown = open_easel(OCEAN, "impostor", true);
	for (size_t i = 0; i < sizeof(away_m) / sizeof(away_m[0]); i++) {
		for (int along = 0; along <= 1; along++) {
			struct camera_pose pose = pose_at(OCEAN, 20.0, 9.0 - away_m[i], along ? EAST : 0.0);
			draw(&full, &pose);
			draw(&shown, &pose);
			assert_complete(OCEAN, &full, &shown, &pose);
			if (away_m[i] > 0.4 && !along) /* nothing but wall */
				for (size_t at = 0; at < (size_t)WIDTH * HEIGHT; at++)
					assert_true(shown.truth[at].object);
		}
	}
	close_easel(&full);
	close_easel(&shown);
}

static void every_field_of_view_is_complete(void **state)
{
	(void)state;
	static const double fovs_deg[] = { 10.0, 25.0, 60.0, 90.0, 120.0 };
	struct easel full = open_easel(OCEAN, "full", true), shown = open_easel(OCEAN, "impostor", true);
	for (size_t i = 0; i < sizeof(fovs_deg) / sizeof(fovs_deg[0]); i++) {
		struct camera_pose pose = pose_at(OCEAN, 12.0, -2.0, EAST + 0.2);
		pose.fov_rad = fovs_deg[i] * (BLVD_PI / 180.0);
		draw(&full, &pose);
		draw(&shown, &pose);
		assert_complete(OCEAN, &full, &shown, &pose);
	}
	close_easel(&full);
	close_easel(&shown);
}

static void sixteen_bits_of_depth_are_enough(void **state)
{
	(void)state;
	static const char *const names[] = { "full", "impostor" };
	for (int i = 0; i < 2; i++) {
		struct easel fine = open_easel(OCEAN, names[i], false), coarse;
		struct renderer_config config = { .far_name = names[i], .depth_16 = true };
		assert_int_equal(try_easel(&coarse, OCEAN, &config), 0);
		struct camera_pose pose = pose_at(OCEAN, 5.0, -2.0, EAST);
		draw(&fine, &pose);
		draw(&coarse, &pose);
		print_message("%s: %.3f %% of the pixels differ\n", names[i], 100.0 * differing_share(&fine, &coarse, 8));
		/* a row or two: where tiles of ground meet, their skirts are as near as the ground */
		assert_true(differing_share(&fine, &coarse, 8) < 0.02);
		close_easel(&fine);
		close_easel(&coarse);
	}
}

static unsigned clip_control_asked;
static void (*proc_without_clip_control(const char *name))(void)
{
	if (strstr(name, "ClipControl")) {
		clip_control_asked++;
		return NULL;
	}
	return display_get_proc(name);
}

static void no_clip_control_is_needed(void **state)
{
	(void)state;
	struct easel with = open_easel(OCEAN, "impostor", false), without;
	struct renderer_config config = { .far_name = "impostor", .get_proc = proc_without_clip_control };
	assert_int_equal(try_easel(&without, OCEAN, &config), 0);
	struct camera_pose pose = pose_at(OCEAN, 5.0, -2.0, EAST);
	draw(&with, &pose);
	draw(&without, &pose);
	assert_int_equal(largest_difference(&with, &without), 0);
	assert_int_equal(clip_control_asked, 0);
	close_easel(&with);
	close_easel(&without);
}

/* --- from end to end --- */

static uint32_t most_pixels(void)
{
	static uint8_t memory[1 << 20];
	struct arena arena;
	struct screen screen;
	struct screen_config config = { .width = 64, .height = 64, .get_proc = display_get_proc };
	if (!display.ops)
		skip();
	arena_init(&arena, "screen", memory, sizeof(memory));
	assert_int_equal(screen_init(&screen, &arena, &config), 0);
	uint32_t most = gfx_caps(screen.gfx)->max_texture_px;
	screen_finish(&screen);
	return most;
}

static void pictures_from_64_by_64_to_what_the_gpu_can_draw(void **state)
{
	(void)state;
	const uint32_t most = most_pixels();
	const struct {
		uint32_t width, height;
		int status;
	} sizes[] = { { 64, 64, 0 }, { most, 64, 0 }, { 64, most, 0 }, { most + 1, 64, -ENOTSUP },
		{ 64, most + 1, -ENOTSUP } };
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		struct easel easel;
		struct renderer_config config = {
			.width = sizes[i].width, .height = sizes[i].height, .far_name = "full", .truth = sizes[i].status == 0
		};
		assert_int_equal(try_easel(&easel, OCEAN, &config), sizes[i].status);
		if (sizes[i].status == 0) {
			struct camera_pose pose = pose_at(OCEAN, 5.0, -2.0, EAST);
			draw(&easel, &pose);
			for (uint32_t x = 0; x < sizes[i].width; x++)
				assert_true(easel.truth[(size_t)(sizes[i].height - 1) * sizes[i].width + x].object);
		} else {
			assert_null(easel.renderer);
		}
		close_easel(&easel);
	}
}

static void budgets_from_4_mib_to_4_gib_are_kept_or_refused(void **state)
{
	(void)state;
	unsigned kept = 0, refused = 0;
	struct easel full = open_easel(OCEAN, "full", true);
	struct camera_pose pose = pose_at(OCEAN, 5.0, -2.0, EAST);
	draw(&full, &pose);
	for (uint64_t mib = 4; mib <= 4096; mib *= 2) {
		struct easel easel;
		struct renderer_config config = { .far_name = "impostor", .gpu_budget_bytes = mib << 20, .truth = true };
		int status = try_easel(&easel, OCEAN, &config);
		if (status == 0) {
			struct renderer_stats stats;
			draw(&easel, &pose);
			assert_complete(OCEAN, &full, &easel, &pose);
			renderer_stats(easel.renderer, &stats);
			kept++;
			assert_true(stats.chunks_wanted_missing == 0);
		} else {
			assert_true(status == -EFBIG || status == -ENOMEM);
			assert_null(easel.renderer);
			refused++;
			assert_int_equal(kept, 0); /* what was enough stays enough */
		}
		close_easel(&easel);
	}
	close_easel(&full);
	assert_true(kept >= 4 && refused >= 1);
}

static void accuracies_from_a_sixteenth_to_64_pixels(void **state)
{
	(void)state;
	static const struct {
		int city;
		double tau_px;
	} cases[] = { { FINE, 1 / 16.0 }, { OCEAN, 1.0 }, { COARSE, 64.0 } };
	uint64_t triangles[3] = { 0 };
	for (size_t c = 0; c < sizeof(cases) / sizeof(cases[0]); c++) {
		const struct pkg *pkg = &cities[cases[c].city];
		for (uint32_t i = 0; i < 2 * pkg->stretch_count; i++) {
			const struct pkg_cell *cell = &pkg->cells[i];
			assert_true((double)cell->tau_px == cases[c].tau_px);
			triangles[c] += cell->kind == PKG_CELL_IMPOSTOR ? cell->index_count / 3 : 0;
			if (cell->kind == PKG_CELL_IMPOSTOR && (double)cell->error_px > cases[c].tau_px)
				assert_int_equal(cell->reason, PKG_REASON_TAU_RELAXED);
		}
		print_message("tau %.4f: %llu triangles\n", cases[c].tau_px, (unsigned long long)triangles[c]);
	}
	/* a sixteenth of a pixel takes so much that geometry is cheaper */
	assert_true(triangles[1] > 0 && triangles[2] <= triangles[1]);
	assert_complete_along(FINE, 5.0, 35.0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_world_moved_by_ten_thousand_kilometres_looks_the_same),
		cmocka_unit_test(the_antimeridian_is_no_border),
		cmocka_unit_test(near_the_pole_a_city_is_a_city),
		cmocka_unit_test(headings_on_both_sides_of_south_look_the_same),
		cmocka_unit_test(one_building_is_seen_from_afar),
		cmocka_unit_test(a_town_without_buildings_is_land_and_street),
		cmocka_unit_test(a_street_of_ten_kilometres_is_one_edge),
		cmocka_unit_test(a_street_of_ten_kilometres_is_baked_in_stretches),
		cmocka_unit_test(a_street_of_ten_kilometres_is_driven_by_its_cells),
		cmocka_unit_test(a_million_triangles_in_one_block),
		cmocka_unit_test(a_wall_at_the_near_plane_hides_what_is_behind_it),
		cmocka_unit_test(every_field_of_view_is_complete),
		cmocka_unit_test(sixteen_bits_of_depth_are_enough),
		cmocka_unit_test(no_clip_control_is_needed),
		cmocka_unit_test(pictures_from_64_by_64_to_what_the_gpu_can_draw),
		cmocka_unit_test(budgets_from_4_mib_to_4_gib_are_kept_or_refused),
		cmocka_unit_test(accuracies_from_a_sixteenth_to_64_pixels),
	};
	return cmocka_run_group_tests(tests, bake_places, remove_places);
}
