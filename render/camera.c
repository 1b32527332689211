/* Where the eye wants to be, by kind; springs towards it; then clear of walls and ground; then matrices and culling. */
#include "render/camera.h"

#include <math.h>
#include <string.h>

#include "platform/base/clock.h"
#include "platform/base/geo.h"

#define CUT_MM 60000         /* a longer jump of the car is a cut */
#define PIVOT_MM 1700        /* the car's roof: what the eye must be able to see */
#define GROUND_CLEAR_MM 1200 /* eye above ground, at least */
#define WALL_CLEAR_M 0.6
#define SLOPE_STEP_MM 4000
#define SLICE_OVERLAP 0.02

static const char *const names[CAMERA_KIND_COUNT] = { "driver", "chase", "heading-up", "north-up" };

const char *camera_name(enum camera_kind kind)
{
	return names[kind];
}

int camera_from_name(const char *name)
{
	for (int i = 0; i < CAMERA_KIND_COUNT; i++)
		if (!strcmp(names[i], name))
			return i;
	return -1;
}

void camera_init(struct camera *camera, double fov_rad)
{
	*camera = (struct camera){ .zoom = 1.0, .fov_rad = fov_rad, .reach = 1.0 };
}

void camera_next(struct camera *camera)
{
	camera->kind = (enum camera_kind)((camera->kind + 1) % CAMERA_KIND_COUNT);
}

void camera_zoom(struct camera *camera, double factor)
{
	camera->zoom = fmin(4.0, fmax(0.25, camera->zoom * factor));
}

/*
 * x'' = rate^2 (g - x) - 2 rate x' with g = from + b t: y = x - g + 2 b / rate obeys the same equation with target 0,
 * whose solution is (y0 + (y0' + rate y0) t) exp(-rate t).
 */
void spring_follow(struct spring *spring, double from, double to, double rate, double dt_s)
{
	if (dt_s <= 0.0)
		return;
	double b = (to - from) / dt_s, lag = 2.0 * b / rate;
	double y0 = spring->value - from + lag, dy0 = spring->velocity - b;
	double c = dy0 + rate * y0, decay = exp(-rate * dt_s);
	double y = (y0 + c * dt_s) * decay;
	spring->value = y + to - lag;
	spring->velocity = (c - rate * (y0 + c * dt_s)) * decay + b;
}

struct wish {
	double back, up, pitch;
	bool north;
};

/* Distances in metres, chosen by eye on European streets. */
static struct wish wish_of(const struct camera *camera)
{
	double z = 1.0 / camera->zoom, far = 320.0 * z;
	switch (camera->kind) {
	case CAMERA_CHASE:
		return (struct wish){ 15.0 * z, 6.5 * z, -0.26, false };
	case CAMERA_HEADING_UP:
		/* the car in the lower third */
		return (struct wish){ far * 0.50, far * 0.95, -1.00, false };
	case CAMERA_NORTH_UP:
		return (struct wish){ far * 0.0, far * 1.15, -BLVD_PI / 2.0 + 0.001, true };
	case CAMERA_DRIVER:
	default:
		return (struct wish){ 2.5 * z, 3.0 * sqrt(z), -0.07, false };
	}
}

static bool overview(enum camera_kind kind)
{
	return kind == CAMERA_HEADING_UP || kind == CAMERA_NORTH_UP;
}

static bool must_cut(const struct camera *camera, const struct nav_view *nav)
{
	if (!camera->started || nav->time_ns < camera->time_ns)
		return true;
	double jump = 0.0;
	for (int axis = 0; axis < 3; axis++) {
		double d = (double)(nav->pos_mm[axis] - camera->car_mm[axis]);
		jump += d * d;
	}
	return jump > (double)CUT_MM * CUT_MM;
}

/* The street's slope under the car, taken anew every few metres. Signed along the car's nose. */
static double slope_of(struct camera *camera, const struct nav_view *nav)
{
	double east = (double)(nav->pos_mm[0] - camera->slope_mm[0]),
		   north = (double)(nav->pos_mm[1] - camera->slope_mm[1]);
	double run = hypot(east, north);
	if (run < SLOPE_STEP_MM)
		return camera->target_slope;
	double heading = bam_to_rad(nav->heading_bam);
	double ahead = east * sin(heading) + north * cos(heading);
	double slope = (double)(nav->pos_mm[2] - camera->slope_mm[2]) / run * (ahead < 0.0 ? -1.0 : 1.0);
	memcpy(camera->slope_mm, nav->pos_mm, sizeof(camera->slope_mm));
	return fmin(0.2, fmax(-0.2, slope));
}

static void cut_to(struct camera *camera, const struct nav_view *nav, const struct wish *wish)
{
	camera->started = true;
	camera->target_turn = wish->north ? 0.0 : bam_to_rad(nav->heading_bam);
	camera->target_climb = (double)nav->pos_mm[2] * 1e-3;
	camera->target_slope = 0.0;
	camera->turn = (struct spring){ .value = camera->target_turn };
	camera->climb = (struct spring){ .value = camera->target_climb };
	camera->slope = (struct spring){ 0 };
	camera->back = (struct spring){ .value = wish->back };
	camera->up = (struct spring){ .value = wish->up };
	camera->pitch = (struct spring){ .value = wish->pitch };
	camera->reach = 1.0;
	memcpy(camera->slope_mm, nav->pos_mm, sizeof(camera->slope_mm));
}

static void glide_to(struct camera *camera, const struct nav_view *nav, const struct wish *wish, double dt_s)
{
	double turn = wish->north ? 0.0 : bam_to_rad(nav->heading_bam);
	double new_turn = camera->target_turn + remainder(turn - camera->target_turn, 2.0 * BLVD_PI);
	double new_climb = (double)nav->pos_mm[2] * 1e-3, new_slope = slope_of(camera, nav);
	spring_follow(&camera->turn, camera->target_turn, new_turn, 4.5, dt_s);
	spring_follow(&camera->climb, camera->target_climb, new_climb, 8.0, dt_s);
	spring_follow(&camera->slope, new_slope, new_slope, 1.5, dt_s);
	spring_follow(&camera->back, wish->back, wish->back, 3.5, dt_s);
	spring_follow(&camera->up, wish->up, wish->up, 3.5, dt_s);
	spring_follow(&camera->pitch, wish->pitch, wish->pitch, 3.5, dt_s);
	camera->target_turn = new_turn;
	camera->target_climb = new_climb;
	camera->target_slope = new_slope;
}

static int64_t mm(double metres)
{
	return llrint(metres * 1000.0);
}

/* Pulls the eye towards the car at once when something is in the way, and lets it back slowly. */
static void keep_clear(
	struct camera *camera, const struct nav_view *nav, const struct obstacles *obstacles, double dt_s)
{
	int64_t *eye = camera->pose.eye_mm;
	if (overview(camera->kind)) {
		int64_t roof = obstacles_roof_mm(obstacles, eye[0], eye[1]);
		if (roof != INT64_MIN && eye[2] < roof + 20000)
			eye[2] = roof + 20000;
	} else {
		const int64_t pivot[3] = { nav->pos_mm[0], nav->pos_mm[1], nav->pos_mm[2] + PIVOT_MM };
		double reach = obstacles_reach(obstacles, pivot, eye, WALL_CLEAR_M);
		double back = 1.0 - (1.0 - camera->reach) * exp(-1.5 * dt_s);
		camera->reach = fmin(reach, back);
		for (int axis = 0; axis < 3; axis++)
			eye[axis] = pivot[axis] + llrint((double)(eye[axis] - pivot[axis]) * camera->reach);
	}
	/* in a tunnel the ground is above; then the carriageway counts */
	int64_t at_car = obstacles_ground_mm(obstacles, nav->pos_mm[0], nav->pos_mm[1]);
	int64_t ground = obstacles_ground_mm(obstacles, eye[0], eye[1]);
	int64_t floor_mm = nav->pos_mm[2] < at_car - 2000 ? nav->pos_mm[2] : ground;
	if (eye[2] < floor_mm + GROUND_CLEAR_MM)
		eye[2] = floor_mm + GROUND_CLEAR_MM;
}

void camera_follow(struct camera *camera, const struct nav_view *nav, const struct obstacles *obstacles)
{
	if (!nav->located)
		return;
	struct wish wish = wish_of(camera);
	double dt_s = camera->started ? (double)(nav->time_ns - camera->time_ns) / (double)NS_PER_S : 0.0;
	if (must_cut(camera, nav))
		cut_to(camera, nav, &wish);
	else
		glide_to(camera, nav, &wish, dt_s);
	camera->time_ns = nav->time_ns;
	memcpy(camera->car_mm, nav->pos_mm, sizeof(camera->car_mm));

	double heading = camera->turn.value, tilt = overview(camera->kind) ? 0.0 : atan(camera->slope.value);
	struct camera_pose *pose = &camera->pose;
	pose->heading_rad = heading;
	pose->pitch_rad = fmax(-BLVD_PI / 2.0 + 1e-4, camera->pitch.value + tilt);
	pose->fov_rad = camera->fov_rad;
	pose->eye_mm[0] = nav->pos_mm[0] - mm(camera->back.value * sin(heading));
	pose->eye_mm[1] = nav->pos_mm[1] - mm(camera->back.value * cos(heading));
	pose->eye_mm[2] = mm(camera->climb.value + camera->up.value - camera->back.value * tan(tilt));
	if (obstacles && obstacles->pkg)
		keep_clear(camera, nav, obstacles, fmax(0.0, dt_s));
}

/* OpenGL's perspective, from view axes (right, up, forward) to clip space. */
static struct mat4 projection(const struct view *view, double near_m, double far_m)
{
	double a = (far_m + near_m) / (far_m - near_m), b = -2.0 * far_m * near_m / (far_m - near_m);
	struct mat4 axes = { { view->right.x, view->up.x, view->forward.x, 0, view->right.y, view->up.y, view->forward.y, 0,
		view->right.z, view->up.z, view->forward.z, 0, 0, 0, 0, 1 } };
	struct mat4 clip = { { 1.0f / view->tan_half_x, 0, 0, 0, 0, 1.0f / view->tan_half_y, 0, 0, 0, 0, (float)a, 1, 0, 0,
		(float)b, 0 } };
	return mat4_mul(&clip, &axes);
}

void camera_split(struct view *view, double split_m, double far_m)
{
	double near_m = 0.35;
	view->slice[VIEW_NEAR] = (struct view_slice){ .near_m = (float)near_m,
		.far_m = (float)(split_m * (1.0 + SLICE_OVERLAP)),
		.depth_near = 0.0f,
		.depth_far = 0.5f };
	view->slice[VIEW_FAR] = (struct view_slice){
		.near_m = (float)(split_m * (1.0 - SLICE_OVERLAP)), .far_m = (float)far_m, .depth_near = 0.5f, .depth_far = 1.0f
	};
	for (int i = 0; i < VIEW_SLICE_COUNT; i++)
		view->slice[i].clip_from_eye = projection(view, view->slice[i].near_m, view->slice[i].far_m);
}

void camera_view(
	const struct camera_pose *pose, uint32_t width, uint32_t height, double split_m, double far_m, struct view *out)
{
	double ch = cos(pose->heading_rad), sh = sin(pose->heading_rad), cp = cos(pose->pitch_rad),
		   sp = sin(pose->pitch_rad);
	*out = (struct view){
		.eye_mm = { pose->eye_mm[0], pose->eye_mm[1], pose->eye_mm[2] },
		.right = { (float)ch, (float)-sh, 0.0f },
		.forward = { (float)(sh * cp), (float)(ch * cp), (float)sp },
		.up = { (float)(-sh * sp), (float)(-ch * sp), (float)cp },
		.width = width,
		.height = height,
	};
	double tan_y = tan(pose->fov_rad / 2.0);
	out->tan_half_y = (float)tan_y;
	out->tan_half_x = (float)(tan_y * width / height);
	out->focal_px = (float)(height / 2.0 / tan_y);
	camera_split(out, split_m, far_m);
}

/* Is the box's corner farthest along `normal` still behind the plane through the eye? */
static bool behind(struct vec3 normal, struct vec3 min, struct vec3 max)
{
	struct vec3 corner = { normal.x > 0 ? max.x : min.x, normal.y > 0 ? max.y : min.y, normal.z > 0 ? max.z : min.z };
	return vec3_dot(normal, corner) < 0.0f;
}

#define SIDES 5

static void side_planes(const struct view *view, struct vec3 out[SIDES])
{
	struct vec3 f = view->forward;
	out[0] = f;
	out[1] = vec3_add(vec3_scale(f, view->tan_half_x), view->right);
	out[2] = vec3_sub(vec3_scale(f, view->tan_half_x), view->right);
	out[3] = vec3_add(vec3_scale(f, view->tan_half_y), view->up);
	out[4] = vec3_sub(vec3_scale(f, view->tan_half_y), view->up);
}

bool view_sees_box(const struct view *view, struct vec3 min, struct vec3 max)
{
	struct vec3 planes[SIDES];
	side_planes(view, planes);
	for (int i = 0; i < SIDES; i++)
		if (behind(planes[i], min, max))
			return false;
	float nearest, farthest;
	view_box_depth(view, min, max, &nearest, &farthest);
	return nearest <= view->slice[VIEW_FAR].far_m;
}

bool view_holds_box(const struct view *view, struct vec3 min, struct vec3 max)
{
	struct vec3 planes[SIDES];
	side_planes(view, planes);
	for (int i = 0; i < SIDES; i++)
		if (!behind(vec3_scale(planes[i], -1.0f), min, max))
			return false;
	return true;
}

void view_box(
	const struct view *view, const int32_t min_mm[3], const int32_t max_mm[3], struct vec3 *min, struct vec3 *max)
{
	int64_t low[3] = { min_mm[0], min_mm[1], min_mm[2] }, high[3] = { max_mm[0], max_mm[1], max_mm[2] };
	*min = view_relative(view, low);
	*max = view_relative(view, high);
}

double view_box_distance_m(struct vec3 min, struct vec3 max)
{
	double x = fmax(fmax(min.x, -max.x), 0.0), y = fmax(fmax(min.y, -max.y), 0.0), z = fmax(fmax(min.z, -max.z), 0.0);
	return sqrt(x * x + y * y + z * z);
}

void view_box_depth(const struct view *view, struct vec3 min, struct vec3 max, float *nearest, float *farthest)
{
	struct vec3 f = view->forward;
	struct vec3 low = { f.x > 0 ? min.x : max.x, f.y > 0 ? min.y : max.y, f.z > 0 ? min.z : max.z };
	struct vec3 high = { f.x > 0 ? max.x : min.x, f.y > 0 ? max.y : min.y, f.z > 0 ? max.z : min.z };
	*nearest = vec3_dot(f, low);
	*farthest = vec3_dot(f, high);
}
