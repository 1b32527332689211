/* Springs, the cameras' motion, matrices and culling. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* before cmocka */
#include <cmocka.h>

#include "fake_city.h"
#include "platform/base/geo.h"
#include "platform/base/rng.h"
#include "render/camera.h"
#include "render/scene.h"

static void assert_near(double got, double wanted, double within)
{
	if (fabs(got - wanted) > within)
		fail_msg("%.9g is not within %g of %.9g", got, within, wanted);
}

static void a_spring_does_not_depend_on_the_frame_rate(void **state)
{
	(void)state;
	struct spring coarse = { 3.0, -1.0 }, fine = coarse;
	for (int i = 0; i < 10; i++)
		spring_follow(&coarse, i * 0.7, (i + 1) * 0.7, 4.0, 0.1);
	for (int i = 0; i < 1000; i++)
		spring_follow(&fine, i * 0.007, (i + 1) * 0.007, 4.0, 0.001);
	assert_near(coarse.value, fine.value, 1e-9);
	assert_near(coarse.velocity, fine.velocity, 1e-8);
}

static void a_spring_arrives_without_overshoot(void **state)
{
	(void)state;
	struct spring spring = { 0.0, 0.0 };
	for (int i = 0; i < 300; i++) {
		spring_follow(&spring, 1.0, 1.0, 3.0, 0.016);
		assert_true(spring.value <= 1.0 + 1e-12 && spring.value >= 0.0);
	}
	assert_near(spring.value, 1.0, 1e-4);
	struct spring still = spring;
	spring_follow(&still, 1.0, 2.0, 3.0, 0.0);
	assert_near(still.value, spring.value, 0.0);
	spring_follow(&still, 2.0, 2.0, 3.0, 3600.0);
	assert_near(still.value, 2.0, 1e-12);
}

static struct nav_view car_at(double east_m, double north_m, double heading_deg, double time_s)
{
	return (struct nav_view){
		.located = true,
		.time_ns = llrint(time_s * 1e9),
		.pos_mm = { llrint(east_m * 1e3), llrint(north_m * 1e3), 0 },
		.heading_bam = bam_from_rad(heading_deg * BLVD_PI / 180.0),
	};
}

static void each_kind_sees_the_car_or_the_road_ahead(void **state)
{
	(void)state;
	for (int kind = 0; kind < CAMERA_KIND_COUNT; kind++) {
		struct camera camera;
		camera_init(&camera, 0.8);
		camera.kind = (enum camera_kind)kind;
		struct nav_view nav = car_at(100.0, 200.0, 90.0, 1.0);
		camera_follow(&camera, &nav, NULL);
		struct view view;
		camera_view(&camera.pose, 1280, 720, 150.0, 6000.0, &view);
		int64_t ahead_mm[3] = { nav.pos_mm[0] + 25000, nav.pos_mm[1], 0 };
		struct vec3 ahead = view_relative(&view, ahead_mm);
		struct vec4 clip =
			mat4_apply(&view.slice[VIEW_NEAR].clip_from_eye, (struct vec4){ ahead.x, ahead.y, ahead.z, 1 });
		assert_true(clip.w > 0.0f && fabsf(clip.x) <= clip.w && fabsf(clip.y) <= clip.w);
		assert_int_equal(camera_from_name(camera_name((enum camera_kind)kind)), kind);
	}
	assert_int_equal(camera_from_name("bird"), -1);
}

static void the_picture_depends_on_time_not_on_frames(void **state)
{
	(void)state;
	struct camera slow, fast;
	camera_init(&slow, 0.8);
	slow.kind = CAMERA_CHASE;
	fast = slow;
	/* a turn at an even rate, so that both see the same motion */
	for (int i = 0; i <= 30; i++) {
		struct nav_view nav = car_at(0.0, 0.0, 170.0 + i, i / 30.0);
		camera_follow(&slow, &nav, NULL);
	}
	for (int i = 0; i <= 120; i++) {
		struct nav_view nav = car_at(0.0, 0.0, 170.0 + i / 4.0, i / 120.0);
		camera_follow(&fast, &nav, NULL);
	}
	assert_near(slow.pose.heading_rad, fast.pose.heading_rad, 1e-6);
	for (int axis = 0; axis < 3; axis++)
		assert_in_range((slow.pose.eye_mm[axis] - fast.pose.eye_mm[axis]) + 2, 0, 4);
}

static void turning_over_south_goes_the_short_way(void **state)
{
	(void)state;
	struct camera camera;
	camera_init(&camera, 0.8);
	struct nav_view nav = car_at(0.0, 0.0, 179.9, 0.0);
	camera_follow(&camera, &nav, NULL);
	double before = camera.pose.heading_rad;
	for (int i = 1; i <= 60; i++) {
		nav = car_at(0.0, 0.0, -179.9, i / 60.0);
		camera_follow(&camera, &nav, NULL);
		assert_true(fabs(camera.pose.heading_rad - before) < 0.01);
	}
}

static void jumps_and_steps_back_in_time_cut(void **state)
{
	(void)state;
	struct camera camera;
	camera_init(&camera, 0.8);
	struct nav_view nav = car_at(0.0, 0.0, 0.0, 10.0);
	camera_follow(&camera, &nav, NULL);
	nav = car_at(500.0, 0.0, 90.0, 10.1);
	camera_follow(&camera, &nav, NULL);
	assert_near(camera.pose.heading_rad, BLVD_PI / 2.0, 1e-6);
	nav = car_at(500.0, 0.0, 0.0, 5.0);
	camera_follow(&camera, &nav, NULL);
	assert_near(camera.pose.heading_rad, 0.0, 1e-6);
	struct camera_pose before = camera.pose;
	nav.located = false;
	nav.pos_mm[0] = 0;
	camera_follow(&camera, &nav, NULL);
	assert_true(camera.pose.eye_mm[0] == before.eye_mm[0]);
}

/* A city with every chunk known to be sound. */
static struct residency *all_present(const struct pkg *pkg)
{
	struct residency *residency = calloc(1, sizeof(*residency));
	residency->chunks = calloc(pkg->chunk_count, sizeof(*residency->chunks));
	for (uint32_t i = 0; i < pkg->chunk_count; i++)
		residency->chunks[i].state = RESIDENCY_PRESENT;
	return residency;
}

static bool in_a_house(const struct fake_city *city, const int64_t at_mm[3])
{
	for (uint32_t i = 0; i < city->pkg.object_count; i++) {
		const struct pkg_object *o = &city->objects[i];
		bool inside = o->kind == PKG_OBJECT_BUILDING;
		for (int axis = 0; axis < 3; axis++)
			inside = inside && at_mm[axis] >= o->min_mm[axis] && at_mm[axis] <= o->max_mm[axis];
		if (inside)
			return true;
	}
	return false;
}

static void no_camera_ends_up_in_a_wall_or_under_ground(void **state)
{
	(void)state;
	struct fake_city city;
	fake_city_make(&city, 6, (const int32_t[2]){ 0, 0 });
	struct residency *residency = all_present(&city.pkg);
	struct obstacles obstacles = { &city.pkg, residency };
	struct rng rng = rng_seed(3);
	for (int kind = 0; kind < CAMERA_KIND_COUNT; kind++) {
		for (int i = 0; i < 400; i++) {
			struct camera camera;
			camera_init(&camera, 0.8);
			camera.kind = (enum camera_kind)kind;
			camera.zoom = rng_range(&rng, 0.25, 4.0);
			/* anywhere on a street */
			double along = rng_range(&rng, 1.0, 239.0), lane = rng_range(&rng, -6.0, 6.0) + 40.0 * (rng_u32(&rng) % 6);
			bool north = rng_u32(&rng) & 1;
			struct nav_view nav =
				car_at(north ? lane : along, north ? along : lane, rng_range(&rng, -180.0, 180.0), 1.0);
			camera_follow(&camera, &nav, &obstacles);
			assert_false(in_a_house(&city, camera.pose.eye_mm));
			assert_true(camera.pose.eye_mm[2] >= 1000);
		}
	}
	free(residency->chunks);
	free(residency);
	fake_city_free(&city);
}

/* A point in the box that is in the frustum, by sampling. */
static bool sampled(const struct view *view, struct vec3 min, struct vec3 max)
{
	const int n = 24;
	for (int i = 0; i < n * n * n; i++) {
		float a = (float)(i % n) / (float)(n - 1), b = (float)(i / n % n) / (float)(n - 1),
			  c = (float)(i / n / n) / (float)(n - 1);
		struct vec3 p = { min.x + (max.x - min.x) * a, min.y + (max.y - min.y) * b, min.z + (max.z - min.z) * c };
		float z = vec3_dot(p, view->forward), x = vec3_dot(p, view->right), y = vec3_dot(p, view->up);
		if (z > 0.0f && z <= view->slice[VIEW_FAR].far_m && fabsf(x) <= z * view->tan_half_x &&
			fabsf(y) <= z * view->tan_half_y)
			return true;
	}
	return false;
}

static void culling_keeps_all_that_can_be_seen(void **state)
{
	(void)state;
	struct rng rng = rng_seed(11);
	int seen = 0, kept = 0;
	for (int i = 0; i < 4000; i++) {
		struct camera_pose pose = { .heading_rad = rng_range(&rng, -4.0, 4.0),
			.pitch_rad = rng_range(&rng, -1.57, 1.57),
			.fov_rad = rng_range(&rng, 0.18, 2.0) };
		struct view view;
		camera_view(&pose, 1280, 720, 150.0, 2000.0, &view);
		struct vec3 min = { (float)rng_range(&rng, -900.0, 900.0), (float)rng_range(&rng, -900.0, 900.0),
			(float)rng_range(&rng, -200.0, 200.0) };
		struct vec3 max = vec3_add(min, (struct vec3){ (float)rng_range(&rng, 1.0, 300.0),
											(float)rng_range(&rng, 1.0, 300.0), (float)rng_range(&rng, 1.0, 100.0) });
		bool keeps = view_sees_box(&view, min, max);
		bool sees = sampled(&view, min, max);
		if (sees)
			assert_true(keeps);
		seen += sees;
		kept += keeps;
	}
	assert_true(seen > 300);
	/* bounds against five planes keep some that are not seen, but not many */
	assert_true(kept < seen * 13 / 10 + 100);
}

static void slices_overlap_and_agree_on_the_screen(void **state)
{
	(void)state;
	struct camera_pose pose = { .heading_rad = 0.3, .pitch_rad = -0.1, .fov_rad = 0.8 };
	struct view view;
	camera_view(&pose, 1280, 720, 150.0, 6000.0, &view);
	assert_true(view.slice[VIEW_NEAR].far_m > view.slice[VIEW_FAR].near_m);
	struct vec3 p = vec3_add(vec3_scale(view.forward, 150.0f), vec3_scale(view.right, 20.0f));
	struct vec4 at = { p.x, p.y, p.z, 1.0f };
	struct vec4 a = mat4_apply(&view.slice[VIEW_NEAR].clip_from_eye, at);
	struct vec4 b = mat4_apply(&view.slice[VIEW_FAR].clip_from_eye, at);
	assert_near(a.x / a.w, b.x / b.w, 1e-6);
	assert_near(a.y / a.w, b.y / b.w, 1e-6);
	assert_true(fabsf(a.z) <= a.w && fabsf(b.z) <= b.w);
	assert_near(a.x / a.w * 640.0, 20.0 / 150.0 * view.focal_px, 1e-2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_spring_does_not_depend_on_the_frame_rate),
		cmocka_unit_test(a_spring_arrives_without_overshoot),
		cmocka_unit_test(each_kind_sees_the_car_or_the_road_ahead),
		cmocka_unit_test(the_picture_depends_on_time_not_on_frames),
		cmocka_unit_test(turning_over_south_goes_the_short_way),
		cmocka_unit_test(jumps_and_steps_back_in_time_cut),
		cmocka_unit_test(no_camera_ends_up_in_a_wall_or_under_ground),
		cmocka_unit_test(culling_keeps_all_that_can_be_seen),
		cmocka_unit_test(slices_overlap_and_agree_on_the_screen),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
