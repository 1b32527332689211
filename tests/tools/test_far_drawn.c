/*
 * A far field that was really baked, drawn next to all geometry: from poses in and between its cells, while driving,
 * turning round, backing up and leaving the street, and with damaged cells. What is compared is what each pixel shows
 * and where that is, so a hole counts whatever its colour. BLVD_PICTURES=DIR keeps frames. Skipped without GL.
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
#include "nav/nav.h"
#include "platform/base/clock.h"
#include "tests/tools/town.h"
#include "tools/measure/displacement.h"
#include "tools/measure/entrant.h"
#include "tools/measure/holes.h"
#include "tools/measure/image.h"

/* The driver keeps what it allocated when it is unloaded. */
const char *__asan_default_options(void); /* NOLINT: the sanitizer's name */
const char *__asan_default_options(void)  /* NOLINT */
{
	return "detect_leaks=0";
}

#define NEAR_M 120.0
#define UNCOVERED_SHARE 0.0005 /* of a picture's pixels, where they are as small as those of the screen baked for */
/* In a frame: slivers below a pixel, and where houses of unlike heights touch; full has those too. */
#define CRACKS 10
#define DISPLACED_SHARE 0.005
/* A quarter of the screen that the bake is for, with pixels of the same angle. */
#define SCREEN_PIXELS (1280.0 * 720.0) /* uncovered pixels are a share of these: the distance is in the middle */
#define STILL_WIDTH 640
#define STILL_HEIGHT 360
#define STILL_FOV_RAD 0.40823
/* All of the screen with larger pixels: of an outline that is off by one, it has as many times the share. */
#define DRIVE_WIDTH 320
#define DRIVE_HEIGHT 180
#define DRIVE_UNCOVERED_SHARE (UNCOVERED_SHARE * 1280 / DRIVE_WIDTH)

enum { FULL, PVS, IMPOSTOR, ENTRANTS };
static const char *const names[ENTRANTS] = { "full", "pvs", "impostor" };

static char folder[] = "/tmp/blvd-test-far-drawn-XXXXXX";
static char package[96];
static struct pkg pkg;
static const struct dvec2 pixel_middle = { 0, 0 };
static struct entrant entrants[ENTRANTS];

/* A street of 200 m with a side street in its middle and a car park beside it; the distance is houses along paths that
 * nobody drives on, so that there are few cells. */
static void write_town(const char *path)
{
	struct town town;
	town_open(&town, path, (struct geo_point){ 46.2, 6.1 });
	long long west = town_node(&town, 0, 0), middle = town_node(&town, 100, 0), east = town_node(&town, 200, 0),
			  north = town_node(&town, 100, 90), gate = town_node(&town, 60, 0), park = town_node(&town, 60, -45);
	town_street(&town, (long long[]){ west, gate, middle, east }, 4, "High Street");
	town_street(&town, (long long[]){ middle, north }, 2, "Side Street");
	town_way(&town, (long long[]){ gate, park }, 2,
		(const char *const[]){ "highway=service", "service=parking_aisle", NULL });
	town_area(&town, 35, -50, 85, -12, (const char *const[]){ "amenity=parking", NULL });
	town_row(&town, 2, 9, 6, 14, 12, true);
	town_row(&town, 114, 9, 6, 14, 12, true);
	town_row(&town, 92, -21, 8, 14, 12, true);
	town_row(&town, 80, 22, 5, 14, 10, false);
	town_row(&town, 109, 22, 5, 14, 10, false);
	/* rows across the ends of the streets, with a gap that towers close */
	for (int side = -1; side <= 1; side += 2) {
		double y = side > 0 ? 16 : -16 - 10 * 16;
		town_row(&town, 330, y, 10, 16, 12, false);
		town_row(&town, 430, y, 10, 16, 12, false);
		town_row(&town, -150, y, 10, 16, 12, false);
		town_row(&town, -260, y, 10, 16, 12, false);
		town_row(&town, 100 + (side > 0 ? 16 : -16 - 6 * 16), 240, 6, 16, 12, true);
	}
	town_house(&town, 520, -30, 24, 60, 45);
	town_house(&town, -360, -30, 24, 60, 38);
	town_house(&town, 70, 330, 60, 20, 30);
	town_close(&town);
}

static int bake_town(void **state)
{
	(void)state;
	char map[96];
	assert_non_null(mkdtemp(folder));
	snprintf(map, sizeof(map), "%s/town.osm", folder);
	snprintf(package, sizeof(package), "%s/town.blvd", folder);
	write_town(map);
	assert_int_equal(
		town_bake(map, package, (const char *const[]){ "--far", "all", "--near", "120", "--truth", NULL }), EXIT_DONE);
	struct pkg_fault fault;
	assert_int_equal(pkg_open(&pkg, package, &fault), 0);
	return 0;
}

static int remove_town(void **state)
{
	(void)state;
	char command[128];
	pkg_close(&pkg);
	snprintf(command, sizeof(command), "rm -rf %s", folder);
	return system(command);
}

static void open_entrants(const struct pkg *of, uint32_t width, uint32_t height)
{
	for (int i = 0; i < ENTRANTS; i++) {
		struct entrant_config config = {
			.name = names[i], .width = width, .height = height, .samples = 1, .truth = true
		};
		int status = entrant_open(&entrants[i], of, &config);
		if (status == -ENODEV)
			skip();
		assert_int_equal(status, 0);
	}
}

static void close_entrants(void)
{
	for (int i = 0; i < ENTRANTS; i++)
		entrant_close(&entrants[i]);
}

static void keep(const struct entrant *entrant, const char *scene, unsigned number)
{
	const char *to = getenv("BLVD_PICTURES");
	char path[512];
	if (!to)
		return;
	size_t pixels = (size_t)entrant->config.width * entrant->config.height;
	struct image image = {
		.width = entrant->config.width, .height = entrant->config.height, .rgb = malloc(pixels * 3)
	};
	for (size_t i = 0; i < pixels; i++)
		memcpy(&image.rgb[3 * i], &entrant->pixels[4 * i], 3);
	snprintf(path, sizeof(path), "%s/%s-%03u-%s.png", to, scene, number, entrant->config.name);
	image_write_png(&image, path);
	free(image.rgb);
}

static struct truth_image truth_of(const struct entrant *entrant, const struct camera_pose *pose)
{
	struct view view;
	camera_view(pose, entrant->config.width, entrant->config.height, 1.0, 2.0, &view);
	return truth_image_of(&view, pixel_middle, entrant->truth);
}

static bool stands(const struct truth_pixel *pixel)
{
	return pixel->object && pixel->object <= pkg.object_count &&
		   pkg.objects[pixel->object - 1].kind != PKG_OBJECT_GROUND;
}

/* Of what the reference shows, what is missing. Land at the horizon may be left to the backdrop. */
static struct holes find_holes(const struct truth_image *reference, const struct truth_image *shown, bool standing_only)
{
	struct holes holes;
	uint8_t *map = malloc((size_t)reference->width * reference->height);
	holes_find(reference, NULL, shown, &holes, map);
	for (size_t i = 0; standing_only && i < holes.pixels; i++)
		holes.uncovered -= map[i] && !stands(&reference->pixels[i]);
	free(map);
	return holes;
}

/* --- stills --- */

static void draw_still(struct entrant *entrant, const struct camera_pose *pose)
{
	struct renderer_time noon = { .time_ns = NS_PER_S, .ambient = -1.0 };
	display_use(&entrant->display);
	renderer_draw_pose(entrant->renderer, pose, &noon);
	renderer_read_pixels(entrant->renderer, entrant->pixels);
	assert_int_equal(entrant_read_truth(entrant, pixel_middle), 0);
}

static struct far_limit limit_of(const struct pkg_stretch *stretch, const int64_t eye_mm[3])
{
	return (struct far_limit){ .from_m = { (double)(stretch->start_mm[0] - eye_mm[0]) * 1e-3,
								   (double)(stretch->start_mm[1] - eye_mm[1]) * 1e-3 },
		.to_m = { (double)(stretch->end_mm[0] - eye_mm[0]) * 1e-3, (double)(stretch->end_mm[1] - eye_mm[1]) * 1e-3 },
		.near_m = stretch->near_mm * 1e-3 };
}

/* An eye of a stretch's view cell: shares along its axis and of its half width, looking along the axis but for a turn.
 */
static struct camera_pose pose_in(const struct pkg_stretch *stretch, double along, double aside, double turn_rad)
{
	double dx = stretch->end_mm[0] - stretch->start_mm[0], dy = stretch->end_mm[1] - stretch->start_mm[1];
	double length = hypot(dx, dy), side_mm = aside * stretch->half_width_mm;
	struct camera_pose pose = { .heading_rad = atan2(dx, dy) + turn_rad, .fov_rad = STILL_FOV_RAD };
	pose.eye_mm[0] = stretch->start_mm[0] + llrint(dx * along + dy / length * side_mm);
	pose.eye_mm[1] = stretch->start_mm[1] + llrint(dy * along - dx / length * side_mm);
	pose.eye_mm[2] = stretch->start_mm[2] + 2500;
	return pose;
}

/* At both ends a pose is in two cells. */
static const struct {
	double along, aside, turn_rad;
} looks[] = { { 0.0, 0.0, 0.0 }, { 0.5, 0.8, 0.3 }, { 1.0, -0.8, -0.3 }, { 0.5, 0.0, BLVD_PI } };

static void compare_still(const struct pkg_stretch *stretch, const struct camera_pose *pose, unsigned number,
	struct displacement_count *displaced)
{
	struct truth_image reference = truth_of(&entrants[FULL], pose);
	struct far_limit limit = limit_of(stretch, pose->eye_mm);
	size_t pixels = (size_t)reference.width * reference.height;
	float *map = malloc(pixels * sizeof(*map));
	struct displacement_depth *depths = malloc(pixels * sizeof(*depths));
	for (int i = 0; i < ENTRANTS; i++) {
		draw_still(&entrants[i], pose);
		keep(&entrants[i], "still", number);
		if (i == FULL) {
			displacement_depths(&reference, depths);
			continue;
		}
		struct truth_image shown = truth_of(&entrants[i], pose);
		struct holes holes = find_holes(&reference, &shown, true);
		if (holes.cracks > CRACKS || (double)holes.uncovered > UNCOVERED_SHARE * SCREEN_PIXELS)
			fail_msg("still %u, %s: %llu pixels uncovered, %llu of them cracks", number, names[i],
				(unsigned long long)holes.uncovered, (unsigned long long)holes.cracks);
		displacement_begin(&reference, map);
		displacement_offer(&reference, depths, &shown, map);
		/* at the horizon a pixel of land is a hundred metres deep, and is found or not by chance */
		for (size_t at = 0; at < holes.pixels; at++)
			map[at] = stands(&reference.pixels[at]) ? map[at] : DISPLACEMENT_NOTHING;
		displacement_add(&displaced[i], &reference, map, &limit);
	}
	free(depths);
	free(map);
}

static void stills_show_the_distance_where_it_is(void **state)
{
	(void)state;
	struct displacement_count displaced[ENTRANTS] = { 0 };
	open_entrants(&pkg, STILL_WIDTH, STILL_HEIGHT);
	unsigned number = 0;
	for (uint32_t i = 0; i < pkg.stretch_count; i++) {
		const size_t look = i % (sizeof(looks) / sizeof(looks[0]));
		const struct pkg_stretch *stretch = &pkg.stretches[i];
		struct camera_pose pose = pose_in(stretch, looks[look].along, looks[look].aside, looks[look].turn_rad);
		compare_still(stretch, &pose, number++, displaced);
	}
	close_entrants();
	for (int i = PVS; i < ENTRANTS; i++)
		print_message("%s: %llu far pixels, %.3f %% beyond a pixel, %.3f %% not found\n", names[i],
			(unsigned long long)displacement_total(&displaced[i]),
			100.0 * (1.0 - displacement_share(&displaced[i], 1.0)), 100.0 * displacement_share_lost(&displaced[i]));
	assert_true(displacement_total(&displaced[IMPOSTOR]) > 10000);
	assert_true(displacement_share(&displaced[PVS], 1.0) >= 1.0 - DISPLACED_SHARE);
	assert_true(displacement_share(&displaced[IMPOSTOR], 1.0) >= 1.0 - DISPLACED_SHARE);
}

/* --- drives --- */

struct leg {
	double seconds, speed_mps, yaw_rate_dps;
};

struct drive {
	struct nav nav;
	struct camera camera;
	uint8_t *memory;
	struct nav_input input;
	int64_t now_ns;
	struct replay_frame frame;
	unsigned fallbacks, off_street;
	uint64_t worst_uncovered;
};

static void drive_start(struct drive *drive, double east_m, double north_m, double heading_deg)
{
	*drive = (struct drive){ .input.motion = { .speed_valid = true, .yaw_valid = true }, .input.gear = NAV_GEAR_DRIVE };
	struct nav_config config = { .seed = 1 };
	size_t bytes = nav_bytes(&pkg.graph, &config);
	struct arena arena;
	drive->memory = malloc(bytes);
	arena_init(&arena, "nav", drive->memory, bytes);
	assert_int_equal(nav_init(&drive->nav, &arena, &pkg, &config), 0);
	struct geo_frame city = geo_frame_at((struct geo_point){ pkg.meta->origin_lat_deg, pkg.meta->origin_lon_deg });
	/* from the town's own metres to degrees, by way of its first node's place in the city */
	struct dvec2 west = geo_to_plane(&city, (struct geo_point){ 46.2, 6.1 });
	struct geo_point at = geo_from_plane(&city, (struct dvec2){ west.x + east_m, west.y + north_m });
	assert_true(nav_set_start(&drive->nav, at.lat_deg, at.lon_deg, heading_deg));
	camera_init(&drive->camera, BLVD_PI / 4.0);
}

static void check_frame(struct drive *drive, const char *scene)
{
	for (int i = 0; i < ENTRANTS; i++) {
		assert_int_equal(entrant_draw(&entrants[i], &drive->frame), 0);
		assert_int_equal(entrant_read_truth(&entrants[i], pixel_middle), 0);
	}
	struct renderer_stats stats;
	renderer_stats(entrants[IMPOSTOR].renderer, &stats);
	drive->fallbacks += stats.far_fallback;
	drive->off_street += !drive->frame.nav.on_street;
	struct truth_image reference = truth_of(&entrants[FULL], &drive->frame.pose);
	for (int i = PVS; i < ENTRANTS; i++) {
		struct truth_image shown = truth_of(&entrants[i], &drive->frame.pose);
		struct holes holes = find_holes(&reference, &shown, true);
		bool whole = holes.cracks <= CRACKS && (double)holes.uncovered <= DRIVE_UNCOVERED_SHARE * (double)holes.pixels;
		if (drive->frame.number % 10 == 0 || !whole)
			keep(&entrants[i], scene, drive->frame.number);
		if (!whole)
			fail_msg("%s, frame %u, %s: %llu pixels uncovered, %llu of them cracks", scene, drive->frame.number,
				names[i], (unsigned long long)holes.uncovered, (unsigned long long)holes.cracks);
		if (holes.uncovered > drive->worst_uncovered)
			drive->worst_uncovered = holes.uncovered;
	}
}

#define STEP_NS (20 * NS_PER_MS)
#define STEPS_A_FRAME 10

static void drive_leg(struct drive *drive, const struct leg *leg, const char *scene)
{
	struct reckon_input *motion = &drive->input.motion;
	motion->speed_mps = leg->speed_mps;
	motion->yaw_rate_rps = leg->yaw_rate_dps * (BLVD_PI / 180.0);
	drive->input.gear = leg->speed_mps < 0.0 ? NAV_GEAR_REVERSE : NAV_GEAR_DRIVE;
	int64_t end_ns = drive->now_ns + (int64_t)(leg->seconds * 1e9);
	for (int step = 1; drive->now_ns < end_ns; step++) {
		drive->now_ns += STEP_NS;
		nav_advance(&drive->nav, &drive->input, drive->now_ns);
		if (step % STEPS_A_FRAME)
			continue;
		struct replay_frame *frame = &drive->frame;
		nav_snapshot(&drive->nav, &frame->nav);
		camera_follow(&drive->camera, &frame->nav, NULL);
		frame->pose = drive->camera.pose;
		frame->time = (struct renderer_time){ .time_ns = drive->now_ns, .ambient = -1.0 };
		check_frame(drive, scene);
		frame->number++;
	}
}

static void drive_legs(struct drive *drive, const char *scene, const struct leg *legs, size_t count)
{
	open_entrants(&pkg, DRIVE_WIDTH, DRIVE_HEIGHT);
	for (size_t i = 0; i < count; i++)
		drive_leg(drive, &legs[i], scene);
	close_entrants();
	free(drive->memory);
	print_message("%s: %u frames, %u fallbacks, %u off the street, at most %llu pixels uncovered\n", scene,
		drive->frame.number, drive->fallbacks, drive->off_street, (unsigned long long)drive->worst_uncovered);
}

#define LEGS(array) array, sizeof(array) / sizeof((array)[0])

static void a_u_turn_keeps_the_picture_complete(void **state)
{
	(void)state;
	static const struct leg legs[] = { { 5.0, 8.0, 0.0 }, { 6.0, 1.6, -30.0 }, { 6.0, 8.0, 0.0 } };
	struct drive drive;
	drive_start(&drive, 20.0, -2.0, 90.0);
	drive_legs(&drive, "u-turn", LEGS(legs));
	assert_true(drive.fallbacks * 4 < drive.frame.number);
}

static void reversing_out_of_a_cell_keeps_the_picture_complete(void **state)
{
	(void)state;
	static const struct leg legs[] = { { 2.0, 6.0, 0.0 }, { 1.0, 0.0, 0.0 }, { 26.0, -3.0, 0.0 }, { 2.0, 4.0, 0.0 } };
	struct drive drive;
	drive_start(&drive, 90.0, -2.0, 90.0);
	drive_legs(&drive, "reversing", LEGS(legs));
	assert_true(drive.fallbacks * 4 < drive.frame.number);
}

static void leaving_the_street_keeps_the_picture_complete(void **state)
{
	(void)state;
	/* into the car park, round in it, and out again */
	static const struct leg legs[] = { { 4.5, 8.0, 0.0 }, { 3.0, 3.0, 30.0 }, { 7.0, 4.0, 0.0 }, { 12.0, 2.5, 30.0 },
		{ 5.0, 4.0, 20.0 }, { 8.0, 4.0, 0.0 } };
	struct drive drive;
	drive_start(&drive, 18.0, -2.0, 90.0);
	drive_legs(&drive, "car-park", LEGS(legs));
}

static void turning_at_the_junction_keeps_the_picture_complete(void **state)
{
	(void)state;
	static const struct leg legs[] = { { 5.2, 8.0, 0.0 }, { 3.0, 4.0, -30.0 }, { 7.0, 8.0, 0.0 } };
	struct drive drive;
	drive_start(&drive, 50.0, -2.0, 90.0);
	drive_legs(&drive, "junction", LEGS(legs));
	assert_true(drive.fallbacks * 4 < drive.frame.number);
}

/* --- damage --- */

/* A copy of the package with the local set of one stretch overwritten. */
static void open_damaged(uint32_t stretch, struct pkg *out)
{
	char path[128], command[320];
	struct pkg_fault fault;
	snprintf(path, sizeof(path), "%s/damaged.blvd", folder);
	snprintf(command, sizeof(command), "cp %s %s", package, path);
	assert_int_equal(system(command), 0);
	FILE *file = fopen(path, "r+b");
	long at = (long)(pkg.blobs - (const uint8_t *)pkg.map.bytes.data) + (long)pkg.stretches[stretch].local.offset;
	fseek(file, at, SEEK_SET);
	fputs("damaged", file);
	assert_int_equal(fclose(file), 0);
	assert_int_equal(pkg_open(out, path, &fault), 0);
}

static void a_damaged_cell_is_counted_and_all_geometry_stands_in(void **state)
{
	(void)state;
	struct pkg damaged;
	struct renderer_stats stats;
	struct displacement_count displaced[ENTRANTS] = { 0 };
	open_damaged(1, &damaged);
	open_entrants(&damaged, STILL_WIDTH, STILL_HEIGHT);
	struct camera_pose pose = pose_in(&pkg.stretches[1], 0.5, 0.0, 0.0);
	compare_still(&pkg.stretches[1], &pose, 900, displaced);
	renderer_stats(entrants[IMPOSTOR].renderer, &stats);
	assert_true(stats.far_fallback);
	assert_int_equal(stats.far_damaged, 1);
	assert_true(displacement_share(&displaced[IMPOSTOR], 0.01) == 1.0);
	pose = pose_in(&pkg.stretches[0], 0.2, 0.0, BLVD_PI);
	compare_still(&pkg.stretches[0], &pose, 901, displaced);
	renderer_stats(entrants[IMPOSTOR].renderer, &stats);
	assert_false(stats.far_fallback);
	close_entrants();
	pkg_close(&damaged);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(stills_show_the_distance_where_it_is),
		cmocka_unit_test(a_u_turn_keeps_the_picture_complete),
		cmocka_unit_test(reversing_out_of_a_cell_keeps_the_picture_complete),
		cmocka_unit_test(turning_at_the_junction_keeps_the_picture_complete),
		cmocka_unit_test(leaving_the_street_keeps_the_picture_complete),
		cmocka_unit_test(a_damaged_cell_is_counted_and_all_geometry_stands_in),
	};
	return cmocka_run_group_tests(tests, bake_town, remove_town);
}
