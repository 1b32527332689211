/* The simulated camera and its faults, what counts as a live picture, the lens, JPEG. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
/* before cmocka */
#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/camera/camera_watch.h"
#include "platform/camera/jpeg_planes.h"

#define MS NS_PER_MS
#define ARENA_BYTES ((size_t)16 << 20)

static uint8_t *memory;

static int make_memory(void **state)
{
	(void)state;
	memory = malloc(ARENA_BYTES);
	return memory ? 0 : -1;
}

static int drop_memory(void **state)
{
	(void)state;
	free(memory);
	return 0;
}

static const struct camera_config base = { .width = 320,
	.height = 180,
	.fps = 30,
	.lens = { .kind = LENS_PINHOLE, .fov_rad = 1.9 },
	.mount = { .height_m = 0.95, .back_m = 0.9, .pitch_rad = 0.56 } };

static struct camera_device open_sim(const char *script)
{
	struct arena arena;
	struct camera_device camera;
	struct camera_config config = base;
	config.source = script;
	arena_init(&arena, "camera", memory, ARENA_BYTES);
	assert_int_equal(camera_open(&camera, &camera_sim, &config, &arena), 0);
	return camera;
}

static void scripts_are_checked(void **state)
{
	(void)state;
	char overlong[300] = "frozen@1+1";
	memset(overlong + 7, '0', sizeof(overlong) - 11);
	memcpy(overlong + sizeof(overlong) - 4, "1+1", 4);
	const char *const bad[] = { "frozen", "frozen@1", "frozen@1+0", "frozen@-1+2", "frozen@1+2x", "melted@1+2",
		"4000x2000", "8x8", "fps=0", "fps=1000", "planes", "mjpeg", "auto", "320x180x", ",,x", overlong };
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		struct arena arena;
		struct camera_device camera;
		struct camera_config config = base;
		config.source = bad[i];
		arena_init(&arena, "camera", memory, ARENA_BYTES);
		assert_int_equal(camera_open(&camera, &camera_sim, &config, &arena), -22);
		assert_null(camera.ops);
	}
	struct camera_device camera = open_sim("160x90,fps=10,,nv12,late@1+2,torn@3+1");
	camera_close(&camera);
	camera_close(&camera);
}

static void every_format_shows_the_same_scene(void **state)
{
	(void)state;
	static const char *const scripts[] = { "yuyv", "uyvy", "nv12", "rgbx", "bgrx" };
	for (size_t i = 0; i < sizeof(scripts) / sizeof(scripts[0]); i++) {
		struct camera_device camera = open_sim(scripts[i]);
		struct camera_frame frame;
		assert_true(camera_latest(&camera, 0, &frame));
		assert_string_equal(camera_format_name(frame.format), scripts[i]);
		/* the white line of the bay at the lower right is brighter than the asphalt in the middle */
		static const uint32_t bytes[] = { 2, 2, 1, 4, 4 }, first[] = { 0, 1, 0, 1, 1 };
		const uint8_t *row = frame.plane[0] + (size_t)(frame.height - 30) * frame.stride[0];
		uint8_t brightest = 0, middle = row[(frame.width / 2) * bytes[i] + first[i]];
		for (uint32_t x = 0; x < frame.width; x++)
			brightest = row[x * bytes[i] + first[i]] > brightest ? row[x * bytes[i] + first[i]] : brightest;
		assert_true(brightest > middle + 60);
		camera_close(&camera);
	}
}

static void the_same_times_give_the_same_frames(void **state)
{
	(void)state;
	uint32_t digests[2][40];
	for (int run = 0; run < 2; run++) {
		struct camera_device camera = open_sim("frozen@0.5+0.3");
		struct camera_frame frame;
		for (int i = 0; i < 40; i++) {
			assert_true(camera_latest(&camera, run * 5 * NS_PER_S + i * 34 * MS, &frame));
			assert_false(camera_latest(&camera, run * 5 * NS_PER_S + i * 34 * MS, &frame));
			digests[run][i] = frame.digest;
		}
		camera_close(&camera);
	}
	assert_memory_equal(digests[0], digests[1], sizeof(digests[0]));
}

struct scene {
	const char *script;
	enum watch_state worst; /* within the fault */
	int known_within_ms;
	int back_within_ms; /* after its end */
};

/* A fault from 1 s to 3 s, looked at 60 times a second. */
static void play(const struct scene *scene, bool repeats)
{
	struct camera_device camera = open_sim(scene->script);
	struct camera_watch watch = { .look_for_repeats = repeats };
	struct camera_frame frame;
	int64_t known_ms = -1, back_ms = -1;
	for (int64_t ms = 0; ms < 5000; ms += 16) {
		struct camera_status status;
		if (camera_latest(&camera, ms * MS, &frame))
			camera_watch_frame(&watch, &frame, ms * MS);
		camera_status(&camera, &status);
		enum watch_state now = camera_watch_state(&watch, status.link, ms * MS, 0);
		if (now == WATCH_LIVE)
			assert_true(ms * MS - watch.frame_ns <= WATCH_AGE_NS);
		if (ms < 1000 && ms > 100)
			assert_int_equal(now, WATCH_LIVE);
		if (ms >= 1000 && ms < 3000 && now == scene->worst && known_ms < 0)
			known_ms = ms - 1000;
		if (known_ms >= 0 && ms < 3000)
			assert_int_not_equal(now, WATCH_LIVE);
		if (ms >= 3000 && now == WATCH_LIVE && back_ms < 0)
			back_ms = ms - 3000;
	}
	assert_in_range(known_ms, 0, scene->known_within_ms);
	assert_in_range(back_ms, 0, scene->back_within_ms);
	camera_close(&camera);
}

static void faults_are_known_within_half_a_second(void **state)
{
	(void)state;
	static const struct scene scenes[] = {
		{ "frozen@1+2", WATCH_FROZEN, 450, 60 },
		{ "stalled@1+2", WATCH_FROZEN, 210, 60 },
		{ "missing@1+2", WATCH_MISSING, 20, 200 },
		{ "late@1+2", WATCH_FROZEN, 210, 60 },
		{ "torn@1+2", WATCH_FROZEN, 210, 60 },
		{ "size@1+2", WATCH_FROZEN, 210, 60 },
	};
	for (size_t i = 0; i < sizeof(scenes) / sizeof(scenes[0]); i++)
		play(&scenes[i], true);
}

static struct camera_frame frame_at(int64_t ms, uint32_t sequence, uint32_t session, uint32_t digest)
{
	return (struct camera_frame){ .time_ns = ms * MS, .sequence = sequence, .session = session, .digest = digest };
}

static void frames_out_of_order_are_refused(void **state)
{
	(void)state;
	struct camera_watch watch = { .look_for_repeats = true };
	struct camera_frame frame = frame_at(100, 1, 1, 7);
	assert_true(camera_watch_frame(&watch, &frame, 100 * MS));
	frame = frame_at(90, 2, 1, 8); /* earlier */
	assert_false(camera_watch_frame(&watch, &frame, 110 * MS));
	frame = frame_at(120, 1, 1, 8); /* the same number */
	assert_false(camera_watch_frame(&watch, &frame, 120 * MS));
	frame = frame_at(1000, 3, 1, 8); /* of tomorrow */
	assert_false(camera_watch_frame(&watch, &frame, 130 * MS));
	assert_int_equal(watch.backwards, 3);
	frame = frame_at(50, 0, 2, 9); /* a new session begins anew */
	assert_true(camera_watch_frame(&watch, &frame, 140 * MS));
	assert_int_equal(camera_watch_state(&watch, CAMERA_STREAMING, 140 * MS, 0), WATCH_LIVE);
	assert_int_equal(camera_watch_state(&watch, CAMERA_STREAMING, 140 * MS, 150 * MS), WATCH_FROZEN);
	assert_int_equal(camera_watch_state(&watch, CAMERA_ABSENT, 141 * MS, 0), WATCH_MISSING);
}

static void a_camera_that_never_starts_is_missing(void **state)
{
	(void)state;
	struct camera_watch watch = { 0 };
	assert_int_equal(camera_watch_state(&watch, CAMERA_OPENING, 1000 * MS, 0), WATCH_STARTING);
	assert_int_equal(camera_watch_state(&watch, CAMERA_OPENING, 1499 * MS, 0), WATCH_STARTING);
	assert_int_equal(camera_watch_state(&watch, CAMERA_OPENING, 1500 * MS, 0), WATCH_MISSING);
}

static void repeats_count_only_where_they_are_looked_for(void **state)
{
	(void)state;
	struct camera_watch watch = { .look_for_repeats = false };
	for (int i = 0; i < 60; i++) {
		struct camera_frame frame = frame_at(i * 33, (uint32_t)i, 1, 5);
		assert_true(camera_watch_frame(&watch, &frame, i * 33 * MS));
		assert_int_equal(camera_watch_state(&watch, CAMERA_STREAMING, i * 33 * MS, 0), WATCH_LIVE);
	}
}

static void lenses_turn_back_what_they_project(void **state)
{
	(void)state;
	static const struct lens lenses[] = { { LENS_PINHOLE, 1.9, 0.0, 0.0 }, { LENS_PINHOLE, 2.2, -0.02, 0.001 },
		{ LENS_FISHEYE, 3.1, 0.0, 0.0 }, { LENS_FISHEYE, 3.3, -0.05, 0.004 } };
	for (size_t i = 0; i < sizeof(lenses) / sizeof(lenses[0]); i++) {
		for (double x = -0.5; x <= 0.5; x += 0.1) {
			for (double y = -0.3; y <= 0.3; y += 0.1) {
				struct dvec2 at = { x, y }, again = { 0 };
				struct dvec3 ray;
				if (hypot(x, y) > 0.5)
					continue;
				assert_true(lens_unproject(&lenses[i], at, &ray));
				assert_true(lens_project(&lenses[i], ray, &again));
				assert_true(fabs(again.x - x) < 1e-9 && fabs(again.y - y) < 1e-9);
			}
		}
		/* the edge of the picture is half the field of view */
		struct dvec3 edge = { 0 };
		assert_true(lens_unproject(&lenses[i], (struct dvec2){ 0.5, 0.0 }, &edge));
		assert_true(fabs(atan2(edge.x, edge.z) - lenses[i].fov_rad / 2.0) < 1e-9);
	}
	struct dvec2 out;
	assert_false(lens_project(&lenses[0], (struct dvec3){ 0.1, 0.2, -1.0 }, &out));
}

static void the_ground_is_where_it_was(void **state)
{
	(void)state;
	static const struct camera_mount mount = { .height_m = 0.95, .back_m = 0.9, .right_m = 0.1, .pitch_rad = 0.56 };
	for (double back = 1.0; back < 12.0; back += 0.7) {
		for (double right = -3.0; right <= 3.0; right += 0.5) {
			double back_again = 0.0, right_again = 0.0;
			struct dvec3 at = camera_from_car(&mount, back, right, 0.0);
			assert_true(ground_from_camera(&mount, at, &back_again, &right_again));
			assert_true(fabs(back_again - back) < 1e-9 && fabs(right_again - right) < 1e-9);
		}
	}
	/* the car's right is the picture's left, what is nearer is lower */
	struct dvec3 right = camera_from_car(&mount, 3.0, 1.0, 0.0), near = camera_from_car(&mount, 2.0, 1.0, 0.0);
	assert_true(right.x < 0.0);
	assert_true(near.y / near.z > right.y / right.z);
	double back, side;
	assert_false(ground_from_camera(&mount, (struct dvec3){ 0.0, -1.0, 1.0 }, &back, &side));
}

/* 32 x 16 in 4:2:2: the left half red, the right half blue. */
static const uint8_t red_and_blue[] = {
	0xFF,
	0xD8,
	0xFF,
	0xE0,
	0x00,
	0x10,
	0x4A,
	0x46,
	0x49,
	0x46,
	0x00,
	0x01,
	0x01,
	0x00,
	0x00,
	0x01,
	0x00,
	0x01,
	0x00,
	0x00,
	0xFF,
	0xDB,
	0x00,
	0x43,
	0x00,
	0x0D,
	0x09,
	0x0A,
	0x0B,
	0x0A,
	0x08,
	0x0D,
	0x0B,
	0x0A,
	0x0B,
	0x0E,
	0x0E,
	0x0D,
	0x0F,
	0x13,
	0x20,
	0x15,
	0x13,
	0x12,
	0x12,
	0x13,
	0x27,
	0x1C,
	0x1E,
	0x17,
	0x20,
	0x2E,
	0x29,
	0x31,
	0x30,
	0x2E,
	0x29,
	0x2D,
	0x2C,
	0x33,
	0x3A,
	0x4A,
	0x3E,
	0x33,
	0x36,
	0x46,
	0x37,
	0x2C,
	0x2D,
	0x40,
	0x57,
	0x41,
	0x46,
	0x4C,
	0x4E,
	0x52,
	0x53,
	0x52,
	0x32,
	0x3E,
	0x5A,
	0x61,
	0x5A,
	0x50,
	0x60,
	0x4A,
	0x51,
	0x52,
	0x4F,
	0xFF,
	0xDB,
	0x00,
	0x43,
	0x01,
	0x0E,
	0x0E,
	0x0E,
	0x13,
	0x11,
	0x13,
	0x26,
	0x15,
	0x15,
	0x26,
	0x4F,
	0x35,
	0x2D,
	0x35,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0x4F,
	0xFF,
	0xC0,
	0x00,
	0x11,
	0x08,
	0x00,
	0x10,
	0x00,
	0x20,
	0x03,
	0x01,
	0x21,
	0x00,
	0x02,
	0x11,
	0x01,
	0x03,
	0x11,
	0x01,
	0xFF,
	0xC4,
	0x00,
	0x16,
	0x00,
	0x01,
	0x01,
	0x01,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x05,
	0x06,
	0xFF,
	0xC4,
	0x00,
	0x14,
	0x10,
	0x01,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0xFF,
	0xC4,
	0x00,
	0x15,
	0x01,
	0x01,
	0x01,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x07,
	0x05,
	0xFF,
	0xC4,
	0x00,
	0x14,
	0x11,
	0x01,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0x00,
	0xFF,
	0xDA,
	0x00,
	0x0C,
	0x03,
	0x01,
	0x00,
	0x02,
	0x11,
	0x03,
	0x11,
	0x00,
	0x3F,
	0x00,
	0xCF,
	0x88,
	0xC4,
	0x94,
	0x20,
	0xC4,
	0x2A,
	0x5D,
	0x03,
	0xA5,
	0x54,
	0x20,
	0xC4,
	0x2A,
	0x7F,
	0xFF,
	0xD9,
};

static void jpeg_becomes_planes(void **state)
{
	(void)state;
	struct arena arena;
	struct jpeg_planes jpeg;
	struct camera_frame frame;
	arena_init(&arena, "jpeg", memory, ARENA_BYTES);
	if (jpeg_planes_init(&jpeg, 320, 180, &arena) == -95)
		skip();
	uint8_t *out = arena_alloc(&arena, (size_t)jpeg_planes_bytes(320, 180), 64);
	assert_int_equal(jpeg_planes_decode(&jpeg, red_and_blue, sizeof(red_and_blue), out, &frame), 0);
	assert_int_equal(frame.format, CAMERA_PLANES);
	assert_true(frame.width == 32 && frame.height == 16 && frame.chroma_width == 16 && frame.chroma_height == 16);
	assert_true(frame.full_range && frame.matrix == CAMERA_BT601);
	for (uint32_t y = 0; y < 16; y++) {
		const uint8_t *luma = frame.plane[0] + y * frame.stride[0], *pairs = frame.plane[1] + y * frame.stride[1];
		assert_in_range(luma[4], 66, 86);  /* red: 76, 85, 255 */
		assert_in_range(luma[28], 19, 39); /* blue: 29, 255, 107 */
		assert_in_range(pairs[2 * 2], 75, 95);
		assert_in_range(pairs[2 * 2 + 1], 245, 255);
		assert_in_range(pairs[2 * 14], 245, 255);
		assert_in_range(pairs[2 * 14 + 1], 97, 117);
	}
	for (size_t cut = 0; cut < sizeof(red_and_blue) - 2; cut++)
		assert_int_equal(jpeg_planes_decode(&jpeg, red_and_blue, cut, out, &frame), -74);
	jpeg_planes_finish(&jpeg);
	arena_init(&arena, "jpeg", memory, ARENA_BYTES);
	assert_int_equal(jpeg_planes_init(&jpeg, 31, 180, &arena), 0);
	assert_int_equal(jpeg_planes_decode(&jpeg, red_and_blue, sizeof(red_and_blue), out, &frame), -27);
	jpeg_planes_finish(&jpeg);
}

static void jpeg_that_is_none_is_refused(void **state)
{
	(void)state;
	struct arena arena;
	struct jpeg_planes jpeg;
	struct camera_frame frame;
	arena_init(&arena, "jpeg", memory, ARENA_BYTES);
	if (jpeg_planes_init(&jpeg, 320, 180, &arena) == -95)
		skip();
	uint8_t *out = arena_alloc(&arena, (size_t)jpeg_planes_bytes(320, 180), 64);
	static const uint8_t noise[200] = { 0xFF, 0xD8, 0xFF, 0xE0, 0, 16, 'J', 'F', 'I', 'F' };
	assert_int_equal(jpeg_planes_decode(&jpeg, noise, sizeof(noise), out, &frame), -74);
	assert_int_equal(jpeg_planes_decode(&jpeg, noise, 0, out, &frame), -74);
	jpeg_planes_finish(&jpeg);
	jpeg_planes_finish(&jpeg);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(scripts_are_checked),
		cmocka_unit_test(every_format_shows_the_same_scene),
		cmocka_unit_test(the_same_times_give_the_same_frames),
		cmocka_unit_test(faults_are_known_within_half_a_second),
		cmocka_unit_test(frames_out_of_order_are_refused),
		cmocka_unit_test(a_camera_that_never_starts_is_missing),
		cmocka_unit_test(repeats_count_only_where_they_are_looked_for),
		cmocka_unit_test(lenses_turn_back_what_they_project),
		cmocka_unit_test(the_ground_is_where_it_was),
		cmocka_unit_test(jpeg_becomes_planes),
		cmocka_unit_test(jpeg_that_is_none_is_refused),
	};
	return cmocka_run_group_tests(tests, make_memory, drop_memory);
}
