/* Captures of a small city whose every pixel can be worked out by hand, on whatever GL is here without a screen. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include "platform/display/display.h"
#include "render/frame.h"
#include "render/sun.h"
#include "tests/render/fake_city.h"
#include "tools/impostor/capture.h"
#include "tools/impostor/capture_pixels.h"

/* The driver keeps what it allocated when it is unloaded. */
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
	return "detect_leaks=0";
}

#define BLOCKS 12
#define W 256
#define H 192
#define PITCH_M (FAKE_PITCH_MM * 1e-3)

static struct fake_city city;
static struct capturer *capturer;
static struct triangle_set whole;
static struct capture_image image;
static const int32_t shift_mm[2] = { 1200000000, -800000000 };

static void add_object(struct triangle_set *set, uint32_t object)
{
	uint64_t *words = triangle_set_add(set, &city.pkg, object);
	for (uint32_t bit = 0; bit < triangle_set_object_size(&city.pkg.objects[object]); bit++)
		words[bit / 64] |= UINT64_C(1) << (bit % 64);
}

static int open_capturer(void **state)
{
	(void)state;
	fake_city_make(&city, BLOCKS, shift_mm);
	for (uint32_t i = 0; i < city.pkg.object_count; i++)
		add_object(&whole, i);
	triangle_set_tidy(&whole, &city.pkg);
	/* without any GL here the tests are skipped */
	if (capturer_open(&capturer, &city.pkg))
		capturer = NULL;
	return 0;
}

static int close_capturer(void **state)
{
	(void)state;
	capturer_close(capturer);
	capture_image_finish(&image);
	triangle_set_finish(&whole);
	fake_city_free(&city);
	return 0;
}

/* Metres from the city's corner. */
struct place {
	double east_m, north_m, up_m, heading_rad, pitch_rad;
};
static const struct place places[] = {
	{ 200.123456, 4.7, 3.0, 0.05, 0.02 },
	{ 0.5, -60.0, 2.0, 0.6, 0.0 },
	{ 241.0, 243.3, 70.0, 2.4, -0.3 },
	{ 100.7777, 300.0, 160.0, -1.2, -1.1 },
};
#define PLACES (sizeof(places) / sizeof(places[0]))

static struct capture_view view_of(const struct place *place)
{
	double ch = cos(place->heading_rad), sh = sin(place->heading_rad), cp = cos(place->pitch_rad),
		   sp = sin(place->pitch_rad);
	return (struct capture_view){
		.eye = { shift_mm[0] * 1e-3 + place->east_m, shift_mm[1] * 1e-3 + place->north_m, place->up_m },
		.right = { ch, -sh, 0.0 },
		.up = { -sh * sp, -ch * sp, cp },
		.forward = { sh * cp, ch * cp, sp },
		.focal_px = 150.0,
		.centre_x = W / 2.0,
		.centre_y = H / 2.0,
		.width = W,
		.height = H,
		.near_m = 0.5,
		.far_m = 2000.0,
	};
}

/* What a ray from the eye meets first: by hand, house by house. */
struct hit {
	double disparity; /* 0: nothing */
	uint32_t object;
	int8_t normal_oct[2];
};

static double component(struct dvec3 v, int axis)
{
	return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* Where the ray enters the box, in units of depth, and through which side; false when it misses. */
static bool enters(const double min[3], const double max[3], struct dvec3 eye, struct dvec3 ray, double *at, int *side)
{
	double enter = 0.0, leave = INFINITY;
	for (int axis = 0; axis < 3; axis++) {
		double e = component(eye, axis), r = component(ray, axis);
		double a = (min[axis] - e) / r, b = (max[axis] - e) / r;
		if (fmin(a, b) > enter) {
			enter = fmin(a, b);
			*side = axis;
		}
		leave = fmin(leave, fmax(a, b));
	}
	*at = enter;
	return enter > 0.0 && enter < leave;
}

static void meet_house(uint32_t id, struct dvec3 eye, struct dvec3 ray, struct hit *hit)
{
	const struct pkg_object *house = &city.pkg.objects[id];
	double min[3], max[3], at;
	int side = 0;
	for (int axis = 0; axis < 3; axis++) {
		min[axis] = house->min_mm[axis] * 1e-3;
		max[axis] = house->max_mm[axis] * 1e-3;
	}
	if (!enters(min, max, eye, ray, &at, &side) || 1.0 / at <= hit->disparity)
		return;
	*hit = (struct hit){ .disparity = 1.0 / at, .object = id };
	if (side < 2)
		hit->normal_oct[side] = component(ray, side) > 0.0 ? -127 : 127;
}

static struct hit hit_by_hand(const struct capture_view *view, double px, double py)
{
	struct dvec3 to = capture_point(view, px, py, 1.0), eye = view->eye;
	struct dvec3 ray = { to.x - eye.x, to.y - eye.y, to.z - eye.z };
	struct hit hit = { 0 };
	double at = -eye.z / ray.z;
	double x = (eye.x + ray.x * at - shift_mm[0] * 1e-3) / PITCH_M;
	double y = (eye.y + ray.y * at - shift_mm[1] * 1e-3) / PITCH_M;
	if (at > 0.0 && x > 0.0 && y > 0.0 && x < BLOCKS && y < BLOCKS)
		hit = (struct hit){ 1.0 / at, ((uint32_t)y * BLOCKS + (uint32_t)x) * 2 + 1, { 0, 0 } };
	for (uint32_t id = 0; id < city.pkg.object_count; id += 2)
		meet_house(id, eye, ray, &hit);
	return hit;
}

/* The same thing a tenth of a pixel around, so that rounding cannot decide? */
static bool far_from_edges(const struct capture_view *view, double px, double py, const struct hit *hit)
{
	for (int i = 0; i < 4; i++) {
		struct hit other = hit_by_hand(view, px + (i & 1 ? 0.1 : -0.1), py + (i & 2 ? 0.1 : -0.1));
		if (other.object != hit->object || (other.disparity > 0.0) != (hit->disparity > 0.0) ||
			memcmp(other.normal_oct, hit->normal_oct, 2) != 0)
			return false;
	}
	return true;
}

static void check_pixel(const struct capture_pixel *pixel, const struct hit *hit)
{
	assert_int_equal(pixel->object, hit->disparity > 0.0 ? hit->object + 1 : 0);
	if (!pixel->object) {
		assert_true(pixel->disparity == 0.0f && !pixel->triangle && !pixel->kind && !pixel->seed);
		return;
	}
	assert_true(fabs(pixel->disparity / hit->disparity - 1.0) < 1e-6);
	assert_memory_equal(pixel->normal_oct, hit->normal_oct, 2);
	assert_true(pixel->triangle < triangle_set_object_size(&city.pkg.objects[pixel->object - 1]));
	if (!(hit->object & 1)) /* houses; the ground has markings on it */
		assert_int_equal(pixel->kind, pixel->triangle < 8 ? PKG_MATERIAL_WALL : PKG_MATERIAL_ROOF);
	else
		assert_int_equal(pixel->kind, pixel->triangle < 2 ? PKG_MATERIAL_GROUND : PKG_MATERIAL_MARKING);
	if (!(hit->object & 1))
		assert_int_equal(pixel->seed, (uint8_t)(hit->object / 2 * 37));
}

static void every_pixel_is_what_a_ray_meets(void **state)
{
	(void)state;
	if (!capturer)
		skip();
	capturer_use(capturer, &whole);
	for (size_t i = 0; i < PLACES; i++) {
		struct capture_view view = view_of(&places[i]);
		assert_int_equal(capturer_draw(capturer, &view, false, &image), 0);
		assert_null(image.rgba);
		size_t checked = 0;
		for (uint32_t at = 0; at < W * H; at += 7) {
			double px = at % W + 0.5, py = at / W + 0.5;
			struct hit hit = hit_by_hand(&view, px, py);
			/* markings reach over their block's edge */
			bool marking = image.pixels[at].kind == PKG_MATERIAL_MARKING && image.pixels[at].object;
			if (marking || !far_from_edges(&view, px, py, &hit))
				continue;
			checked++;
			check_pixel(&image.pixels[at], &hit);
		}
		assert_true(checked > W * H / 7 / 2);
	}
}

static void a_part_is_cut_out_of_the_whole(void **state)
{
	(void)state;
	if (!capturer)
		skip();
	static struct capture_pixel all[W * H];
	static uint8_t rgba[W * H * 4];
	static const struct capture_rect parts[] = { { 0, 0, 64, 64 }, { 131, 57, 100, 90 }, { 255, 191, 1, 1 },
		{ 3, 80, 253, 7 } };
	struct capture_view view = view_of(&places[0]);
	capturer_use(capturer, &whole);
	assert_int_equal(capturer_draw(capturer, &view, true, &image), 0);
	memcpy(all, image.pixels, sizeof(all));
	memcpy(rgba, image.rgba, sizeof(rgba));
	for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
		const struct capture_rect *part = &parts[i];
		struct capture_view cut = capture_cut(&view, part);
		assert_int_equal(capturer_draw(capturer, &cut, true, &image), 0);
		uint32_t other = 0;
		for (uint32_t y = 0; y < part->height; y++) {
			for (uint32_t x = 0; x < part->width; x++) {
				size_t here = (size_t)y * part->width + x, there = (size_t)(y + part->y) * W + x + part->x;
				const struct capture_pixel *a = &image.pixels[here], *b = &all[there];
				bool same = a->object == b->object && a->triangle == b->triangle &&
							fabsf(a->disparity - b->disparity) <= 1e-6f * b->disparity;
				for (int c = 0; c < 4; c++)
					same = same && abs(image.rgba[here * 4 + (size_t)c] - rgba[there * 4 + (size_t)c]) <= 3;
				other += !same;
			}
		}
		/* rounding decides a pixel on an edge now and then */
		assert_true(other <= part->width * part->height / 200);
	}
}

static void only_what_is_in_the_set_is_seen(void **state)
{
	(void)state;
	if (!capturer)
		skip();
	const uint32_t house = 5 * 2, bits[] = { 1, 4, 9 };
	struct triangle_set set = { 0 };
	uint64_t *words = triangle_set_add(&set, &city.pkg, house);
	for (size_t i = 0; i < 3; i++)
		words[0] |= UINT64_C(1) << bits[i];
	triangle_set_tidy(&set, &city.pkg);
	bool seen[16] = { false };
	capturer_use(capturer, &set);
	for (int turn = 0; turn < 8; turn++) {
		struct place place = { 5 * PITCH_M + 20.0 - 45.0 * sin(turn * BLVD_PI / 4.0),
			20.0 - 45.0 * cos(turn * BLVD_PI / 4.0), 40.0, turn * BLVD_PI / 4.0, -0.6 };
		struct capture_view view = view_of(&place);
		assert_int_equal(capturer_draw(capturer, &view, false, &image), 0);
		for (size_t i = 0; i < W * H; i++) {
			const struct capture_pixel *pixel = &image.pixels[i];
			if (!pixel->object)
				continue;
			assert_int_equal(pixel->object, house + 1);
			assert_true(pixel->triangle == bits[0] || pixel->triangle == bits[1] || pixel->triangle == bits[2]);
			seen[pixel->triangle] = true;
		}
	}
	assert_true(seen[1] && seen[4] && seen[9]);
	triangle_set_clear(&set);
	capturer_use(capturer, &set);
	struct capture_view view = view_of(&places[0]);
	assert_int_equal(capturer_draw(capturer, &view, true, &image), 0);
	for (size_t i = 0; i < W * H; i++)
		assert_int_equal(image.pixels[i].object, 0);
	triangle_set_finish(&set);
}

static void bounds_hold_what_is_drawn_and_little_more(void **state)
{
	(void)state;
	if (!capturer)
		skip();
	struct triangle_set set = { 0 };
	add_object(&set, (3 * BLOCKS + 5) * 2);
	add_object(&set, (4 * BLOCKS + 4) * 2);
	triangle_set_tidy(&set, &city.pkg);
	capturer_use(capturer, &set);
	uint32_t empty = 0;
	for (int turn = 0; turn < 16; turn++) {
		struct place place = { 201.0, 101.0, 3.0, turn * BLVD_PI / 8.0, 0.1 };
		struct capture_view view = view_of(&place);
		struct capture_rect rect;
		assert_int_equal(capturer_draw(capturer, &view, false, &image), 0);
		uint32_t left = W, right = 0, top = H, bottom = 0;
		for (uint32_t i = 0; i < W * H; i++) {
			if (!image.pixels[i].object)
				continue;
			left = i % W < left ? i % W : left;
			right = i % W >= right ? i % W + 1 : right;
			top = i / W < top ? i / W : top;
			bottom = i / W >= bottom ? i / W + 1 : bottom;
		}
		if (!capture_bounds(&city.pkg, &set, &view, &rect)) {
			assert_true(left == W);
			empty++;
		} else if (left > 0 && right < W) { /* none of it reaches out of the view */
			assert_true(
				rect.x <= left && rect.y <= top && rect.x + rect.width >= right && rect.y + rect.height >= bottom);
			assert_true(rect.x + 2 >= left && rect.y + 2 >= top && rect.x + rect.width <= right + 2 &&
						rect.y + rect.height <= bottom + 2);
		}
	}
	assert_in_range(empty, 4, 12);
	triangle_set_finish(&set);
}

static void colour_does_not_reach_over_an_objects_edge(void **state)
{
	(void)state;
	if (!capturer)
		skip();
	/* roofs seen from above, without the ground: nothing but their colour, up to the edge */
	struct triangle_set set = { 0 };
	for (uint32_t id = 0; id < city.pkg.object_count; id += 2) {
		uint64_t *words = triangle_set_add(&set, &city.pkg, id);
		words[0] = 3u << 8;
	}
	triangle_set_tidy(&set, &city.pkg);
	struct capture_view view = view_of(&places[3]);
	capturer_use(capturer, &set);
	assert_int_equal(capturer_draw(capturer, &view, true, &image), 0);
	size_t covered = 0;
	for (size_t i = 0; i < W * H; i++) {
		const uint8_t *px = image.rgba + i * 4;
		if (!image.pixels[i].object) {
			assert_int_equal(px[0] | px[1] | px[2] | px[3], 0);
			continue;
		}
		covered++;
		/* texel 150 to 157, 92 to 99, 74 to 81, darker by tint 235 and occlusion 235 of 255 each */
		assert_in_range(px[0], 130, 140);
		assert_in_range(px[1], 77, 87);
		assert_in_range(px[2], 60, 70);
	}
	assert_true(covered > W * H / 20);
	triangle_set_finish(&set);
}

static uint32_t first_of_kind(const struct capture_batch *batch, uint8_t kind)
{
	uint32_t at = 0;
	while (at < batch->triangles.count && batch->triangles.items[at].kind != kind)
		at++;
	assert_true(at < batch->triangles.count);
	return at + 1;
}

/* From above, all of it one sheet of water, with holes and with a roof that stands out of it. */
static void pinholes_in_water_are_closed(void **state)
{
	(void)state;
	static uint32_t seen[W * H];
	static uint8_t rgba[W * H * 4];
	static struct capture_pixel pixels[W * H];
	const size_t hole = 100 * W + 100, longer = 60 * W + 50, wide = 140 * W + 50, roof = 30 * W + 30;
	struct capture_batch batch = { 0 };
	struct capture_planes planes = { 0 };
	struct capture_image out = { .view = view_of(&places[3]), .pixels = pixels };
	city.materials[FAKE_ROAD].kind = PKG_MATERIAL_WATER;
	capture_batch_fill(&batch, &city.pkg, &whole);
	city.materials[FAKE_ROAD].kind = PKG_MATERIAL_GROUND;
	uint32_t water = first_of_kind(&batch, PKG_MATERIAL_WATER);
	for (size_t i = 0; i < (size_t)W * H; i++)
		seen[i] = water;
	seen[hole] = seen[longer] = seen[longer + 1] = 0;
	for (size_t i = 0; i < 9; i++)
		seen[wide + i % 3 + i / 3 * W] = 0;
	seen[roof] = first_of_kind(&batch, PKG_MATERIAL_ROOF);
	memset(rgba, 9, sizeof(rgba));
	memset(rgba + 4 * hole, 0, 4);
	capture_pixels_fill(&city.pkg, &batch, &planes, seen, rgba, &out);
	assert_int_equal(pixels[hole].kind, PKG_MATERIAL_WATER);
	assert_true(fabsf(2 * pixels[hole].disparity - pixels[hole - 1].disparity - pixels[hole + 1].disparity) < 1e-6f);
	assert_int_equal(rgba[4 * hole], 9);
	assert_int_equal(pixels[longer].kind, PKG_MATERIAL_WATER);
	assert_int_equal(pixels[longer + 1].kind, PKG_MATERIAL_WATER);
	assert_int_equal(pixels[wide + 1 + W].object, 0);
	assert_int_equal(pixels[roof].kind, PKG_MATERIAL_ROOF);
	ARRAY_FINISH(&planes.items);
	capture_batch_finish(&batch);
}

static void what_is_damaged_is_left_out(void **state)
{
	(void)state;
	if (!capturer)
		skip();
	struct capturer *other;
	struct capture_view view = view_of(&places[2]);
	city.geometry[7 * 1024 + 5] ^= 1;
	assert_int_equal(capturer_open(&other, &city.pkg), 0);
	capturer_use(other, &whole);
	capturer_use(capturer, &whole);
	for (int turn = 0; turn < 2; turn++) { /* contexts change places */
		assert_int_equal(capturer_draw(other, &view, turn, &image), 0);
		for (size_t i = 0; i < W * H; i++)
			assert_true(image.pixels[i].object != 7 * 2 + 1 && image.pixels[i].object != 7 * 2 + 2);
		assert_int_equal(capturer_draw(capturer, &view, turn, &image), 0);
	}
	capturer_close(other);
	city.geometry[7 * 1024 + 5] ^= 1;
	view.width = 0;
	assert_int_equal(capturer_draw(capturer, &view, false, &image), -22);
}

/* What a frame makes of a capture's colour, by the formula of capture.h. */
static struct vec3 scaled(struct vec3 a, struct vec3 b)
{
	return (struct vec3){ a.x * b.x, a.y * b.y, a.z * b.z };
}
static struct vec3 mixed(struct vec3 a, struct vec3 b, float t)
{
	return vec3_add(vec3_scale(a, 1.0f - t), vec3_scale(b, t));
}
static float encoded(float c)
{
	return c <= 0.0031308f ? c * 12.92f : 1.055f * powf(c, 1.0f / 2.4f) - 0.055f;
}
static float smooth(float low, float high, float x)
{
	float t = fminf(fmaxf((x - low) / (high - low), 0.0f), 1.0f);
	return t * t * (3.0f - 2.0f * t);
}

static struct vec3 encoded_of(struct vec3 a)
{
	return (struct vec3){ encoded(a.x), encoded(a.y), encoded(a.z) };
}

static struct vec3 shown(
	const struct light_state *light, const struct capture_pixel *pixel, const uint8_t *rgba, struct vec3 from_eye)
{
	const float ao = 235.0f / 255.0f;
	struct vec3 c = { rgba[0] / 255.0f, rgba[1] / 255.0f, rgba[2] / 255.0f };
	struct vec3 normal = { pixel->normal_oct[0] / 127.0f, pixel->normal_oct[1] / 127.0f, 0.0f };
	normal.z = 1.0f - fabsf(normal.x) - fabsf(normal.y);
	float facing = fmaxf(vec3_dot(normal, light->direction), 0.0f);
	struct vec3 ambient = mixed(light->ground, light->sky, normal.z * 0.5f + 0.5f);
	struct vec3 on = vec3_add(ambient, vec3_scale(light->sun, facing * (0.5f + 0.5f * ao)));
	float distance = sqrtf(vec3_dot(from_eye, from_eye));
	struct vec3 to_eye = vec3_scale(from_eye, -1.0f / distance);
	float up = 2.0f * vec3_dot(to_eye, normal) * normal.z - to_eye.z;
	struct vec3 sky = mixed(light->haze, light->zenith, fminf(fmaxf(up * 1.4f, 0.0f), 1.0f));
	struct vec3 mirrored = encoded_of(mixed(vec3_scale(light->ground, 0.35f), sky, smooth(-0.02f, 0.22f, up)));
	float grazing = 1.0f - fmaxf(vec3_dot(to_eye, normal), 0.0f);
	float share = 0.16f + 0.5f * grazing * grazing * grazing;
	struct vec3 color = vec3_add(scaled(c, encoded_of(on)), vec3_scale(mirrored, rgba[3] / 255.0f * share));
	float clear = expf(-1.3f * light->haze_per_m * distance / (1.0f + fmaxf(from_eye.z, 0.0f) * 0.002f));
	float to_sun = (from_eye.x * light->direction.x + from_eye.y * light->direction.y) / distance;
	struct vec3 haze = vec3_scale(light->haze, 1.0f + 0.35f * fmaxf(to_sun, 0.0f) * (1.0f - light->night));
	return mixed(encoded_of(haze), color, clear);
}

/* Nothing else shows within the pixel or beside it, nor does glass end there; and it is not so near that reflections,
 * which the frame works out at corners, are no longer true between them. */
static bool even_around(size_t at)
{
	size_t x = at % W, y = at / W;
	if (image.pixels[at].disparity > 1.0f / (image.rgba[at * 4 + 3] ? 60.0f : 24.0f) ||
		(uint8_t)(image.rgba[at * 4 + 3] + 8) > 16)
		return false;
	if (x == 0 || y == 0 || x == W - 1 || y == H - 1)
		return false;
	for (int i = 0; i < 9; i++) {
		size_t other = (y + (size_t)(i / 3) - 1) * W + x + (size_t)(i % 3) - 1;
		if (image.pixels[other].object != image.pixels[at].object ||
			image.pixels[other].kind != image.pixels[at].kind ||
			abs(image.rgba[other * 4 + 3] - image.rgba[at * 4 + 3]) > 8 ||
			abs(image.rgba[other * 4] - image.rgba[at * 4]) > 12)
			return false;
	}
	return true;
}

static void lit_it_looks_like_a_frame(void **state)
{
	(void)state;
	if (!capturer)
		skip();
	static uint8_t frame[W * H * 4];
	struct arena arena;
	const size_t arena_bytes = (size_t)16 << 20;
	void *memory = malloc(arena_bytes);
	arena_init(&arena, "city", memory, arena_bytes);
	struct display display;
	struct display_config display_config = { .width = W, .height = H };
	assert_int_equal(display_open(&display, &display_surfaceless, &display_config), 0);
	struct renderer_config config = { .width = W, .height = H, .samples = 1, .get_proc = display_get_proc };
	struct renderer *renderer;
	assert_int_equal(renderer_init(&renderer, &arena, &config, &city.pkg), 0);
	/* 21 June 2024, 09:30 UTC, under clouds: light that no surface is too bright for */
	struct renderer_time time = { .time_ns = 1, .wall_ns = INT64_C(1718962200000000000), .ambient = 0.3 };
	struct sun_position sun = sun_at(time.wall_ns, city.meta.origin_lat_deg, city.meta.origin_lon_deg);
	struct light_state light;
	sun_light(&sun, 10.0, time.ambient, false, &light);
	uint32_t checked[3] = { 0 }; /* wall, glass, other */
	uint32_t different = 0;
	capturer_use(capturer, &whole);
	for (size_t i = 0; i < PLACES; i++) {
		struct capture_view view = view_of(&places[i]);
		view.focal_px = 400.0;
		struct camera_pose pose = { .heading_rad = places[i].heading_rad,
			.pitch_rad = places[i].pitch_rad,
			.fov_rad = 2.0 * atan(H / 2.0 / view.focal_px) };
		pose.eye_mm[0] = llrint(view.eye.x * 1e3);
		pose.eye_mm[1] = llrint(view.eye.y * 1e3);
		pose.eye_mm[2] = llrint(view.eye.z * 1e3);
		assert_int_equal(display_use(&display), 0);
		renderer_draw_pose(renderer, &pose, &time);
		renderer_read_pixels(renderer, frame);
		assert_int_equal(capturer_draw(capturer, &view, true, &image), 0);
		for (size_t at = 0; at < W * H; at++) {
			const struct capture_pixel *pixel = &image.pixels[at];
			if (!pixel->object || pixel->kind == PKG_MATERIAL_MARKING || !even_around(at))
				continue;
			struct dvec3 p = capture_point(&view, (double)(at % W) + 0.5, (double)(at / W) + 0.5, pixel->disparity);
			struct vec3 from_eye = { (float)(p.x - view.eye.x), (float)(p.y - view.eye.y), (float)(p.z - view.eye.z) };
			struct vec3 lit = shown(&light, pixel, image.rgba + at * 4, from_eye);
			const float want[3] = { lit.x, lit.y, lit.z };
			bool same = true;
			for (int c = 0; c < 3; c++)
				same = same && fabsf(want[c] * 255.0f - frame[at * 4 + (size_t)c]) < 6.0f;
			different += !same;
			checked[pixel->kind != PKG_MATERIAL_WALL ? 2 : image.rgba[at * 4 + 3] > 128]++;
		}
	}

	/* markings, drawn a little nearer than they are, look through the foot of a wall now and then */
	assert_in_range(different, 0, 3);
	assert_true(checked[0] > 500 && checked[1] > 50 && checked[2] > 500);
	assert_int_equal(display_use(&display), 0);
	renderer_finish(renderer);
	display_close(&display);
	free(memory);
}

static void points_come_back_from_the_image(void **state)
{
	(void)state;
	struct rng rng = rng_seed(3);
	for (int i = 0; i < 10000; i++) {
		struct capture_view view = view_of(&places[i % (int)PLACES]);
		view.centre_x = rng_range(&rng, -500.0, 500.0);
		view.focal_px = rng_range(&rng, 10.0, 4000.0);
		struct dvec3 at = { view.eye.x + rng_range(&rng, -900.0, 900.0), view.eye.y + rng_range(&rng, -900.0, 900.0),
			rng_range(&rng, -20.0, 200.0) };
		double x, y, z;
		bool before = (at.x - view.eye.x) * view.forward.x + (at.y - view.eye.y) * view.forward.y +
						  (at.z - view.eye.z) * view.forward.z >
					  0.0;
		assert_int_equal(capture_project(&view, at, &x, &y, &z), before);
		if (!before || z < 0.1)
			continue;
		struct dvec3 back = capture_point(&view, x, y, 1.0 / z);
		assert_true(fabs(back.x - at.x) < 1e-6 && fabs(back.y - at.y) < 1e-6 && fabs(back.z - at.z) < 1e-6);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_come_back_from_the_image),
		cmocka_unit_test(every_pixel_is_what_a_ray_meets),
		cmocka_unit_test(a_part_is_cut_out_of_the_whole),
		cmocka_unit_test(only_what_is_in_the_set_is_seen),
		cmocka_unit_test(bounds_hold_what_is_drawn_and_little_more),
		cmocka_unit_test(colour_does_not_reach_over_an_objects_edge),
		cmocka_unit_test(pinholes_in_water_are_closed),
		cmocka_unit_test(what_is_damaged_is_left_out),
		cmocka_unit_test(lit_it_looks_like_a_frame),
	};
	return cmocka_run_group_tests(tests, open_capturer, close_capturer);
}
