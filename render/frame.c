/* One frame from front to back: camera, light, loading, scene, passes. Owns all that the renderer has. */
#include "render/frame.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "assets/cell_cache.h"
#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "render/backdrop.h"
#include "render/cell_store.h"
#include "render/frame_block.h"
#include "render/frame_truth.h"
#include "render/marker.h"
#include "render/near_mesh.h"
#include "render/overlay.h"
#include "render/place_disc.h"
#include "render/scene.h"
#include "render/shares.h"
#include "render/sky.h"
#include "render/submit.h"
#include "render/sun.h"

#define DEFAULT_SAMPLES 4
#define DEFAULT_GPU_BYTES (UINT64_C(512) << 20)
#define DEFAULT_SLICE_BYTES (UINT64_C(4) << 20)
#define DEFAULT_FAR_M 6000.0
#define DEFAULT_FOV_DEG 45.0
#define FIXED_ARENA_BYTES (UINT64_C(3) << 19)
#define ARENA_BYTES_AN_EDGE 64 /* labels */
#define SPLIT_M 150.0
#define LEAST_DAY_RAD 0.35 /* the sun's height in the look of the day */
#define JUMP_MM 200000
#define OPENING_MM 120000.0
#define SEEN_MIN_M 500.0  /* what stands in for a cell is geometry up to here */
#define SEE_AHEAD_M 180.0 /* of the route, past buildings */
#define SEE_BEHIND_M 30.0 /* the next manoeuvre */
/* 21 June 2024, 08:30 UTC less the longitude: late morning, long light from the south-east */
#define DEFAULT_WALL_S INT64_C(1718958600)

struct renderer {
	struct renderer_config config;
	const struct pkg *pkg;
	struct screen own_screen;
	struct gfx *gfx; /* of the screen */
	gfx_target target;
	gfx_buffer frame_block;
	struct near_mesh mesh;
	struct scene scene;
	struct sky sky;
	struct backdrop backdrop;
	struct marker marker;
	struct place_disc place_disc;
	struct overlay overlay;
	struct frame_truth truth;
	struct camera camera;
	struct obstacles obstacles;
	struct view view;
	struct light_state light;
	bool primed;          /* the first frame has loaded all that it wanted */
	bool placed;          /* it was known where the car is */
	int64_t loaded_mm[3]; /* the eye when last loaded for */
};

static struct renderer_config with_defaults(const struct renderer_config *given)
{
	struct renderer_config config = *given;
	config.samples = config.samples ? config.samples : DEFAULT_SAMPLES;
	config.gpu_budget_bytes = config.gpu_budget_bytes ? config.gpu_budget_bytes : DEFAULT_GPU_BYTES;
	config.upload_slice_bytes = config.upload_slice_bytes ? config.upload_slice_bytes : DEFAULT_SLICE_BYTES;
	config.far_name = config.far_name ? config.far_name : "full";
	config.gfx = config.gfx ? config.gfx : &gfx_gles3;
	config.fov_deg = config.fov_deg > 0.0 ? fmin(120.0, fmax(10.0, config.fov_deg)) : DEFAULT_FOV_DEG;
	config.far_m = config.far_m > 0.0 ? fmax(config.far_m, SPLIT_M * 2.0) : DEFAULT_FAR_M;
	return config;
}

/* All but the city, which gets what these leave of the budget. */
static int make_objects(struct renderer *renderer, struct arena *arena)
{
	const struct renderer_config *config = &renderer->config;
	const struct screen *screen = config->screen;
	int err = 0;
	if (!screen) {
		struct screen_config own = { .width = config->width,
			.height = config->height,
			.samples = config->samples,
			.depth_16 = config->depth_16,
			.gfx = config->gfx,
			.get_proc = config->get_proc };
		err = screen_init(&renderer->own_screen, arena, &own);
		screen = &renderer->own_screen;
	}
	renderer->gfx = screen->gfx;
	renderer->target = screen->target;
	if (err)
		return err;
	struct gfx_buffer_desc block = {
		.kind = GFX_BUFFER_UNIFORM, .usage = GFX_STREAM, .bytes = sizeof(struct frame_block)
	};
	err = gfx_buffer_create(renderer->gfx, &block, &renderer->frame_block);
	if (!err)
		err = sky_init(&renderer->sky, renderer->gfx);
	if (!err)
		err = backdrop_init(&renderer->backdrop, renderer->gfx, renderer->pkg);
	if (!err)
		err = marker_init(&renderer->marker, renderer->gfx);
	if (!err)
		err = place_disc_init(&renderer->place_disc, renderer->gfx);
	if (!err && config->overlay)
		err = overlay_init(&renderer->overlay, arena, renderer->gfx, renderer->pkg, &config->overlay_config);
	if (!err && config->truth)
		err = frame_truth_init(&renderer->truth, renderer->gfx, config->width, config->height);
	return err;
}

/* Until the car is known: over the middle of the streets (their mean and spread), looking north and down. Low enough
 * over a large city that the first picture is a quarter, not two million triangles. */
static struct camera_pose opening_pose(const struct pkg *pkg)
{
	const struct pkg_graph *graph = &pkg->graph;
	double sum[3] = { 0 }, spread = 0.0, count = fmax(1.0, graph->node_count);
	for (uint32_t i = 0; i < graph->node_count; i++)
		for (int axis = 0; axis < 3; axis++)
			sum[axis] += graph->nodes[i].pos_mm[axis];
	for (uint32_t i = 0; i < graph->node_count; i++)
		spread += fabs(graph->nodes[i].pos_mm[1] - sum[1] / count) / count;
	struct camera_pose pose = { .pitch_rad = -0.75 };
	spread = fmin(spread, OPENING_MM);
	pose.eye_mm[0] = llrint(sum[0] / count);
	pose.eye_mm[1] = llrint(sum[1] / count - spread * 2.2);
	pose.eye_mm[2] = llrint(sum[2] / count + spread * 1.5 + 40000.0);
	return pose;
}

static int make_scene(struct renderer *renderer, struct arena *arena, const struct repr_ops *far_ops)
{
	const struct renderer_config *config = &renderer->config;
	struct repr_config repr_config = {
		.tau_px = config->tau_px,
		.upload_slice_bytes = config->upload_slice_bytes,
		.far_m = config->far_m,
		.deterministic = config->deterministic,
		.truth = config->truth,
		.show = config->show,
	};
	struct shares_config shares_config = { .pkg = renderer->pkg,
		.far_ops = far_ops,
		.far_config = &repr_config,
		.gfx = renderer->gfx,
		.budget_bytes = config->budget_bytes,
		.gpu_bytes = config->gpu_budget_bytes,
		.width = config->width,
		.height = config->height,
		.samples = config->samples };
	struct shares shares;
	int err = shares_settle(&shares, arena, &shares_config);
	if (err)
		return err;
	repr_config.slot_count = shares.slot_count;
	repr_config.reach_m = shares.need.reach_m;
	err = scene_init(&renderer->scene, arena, renderer->gfx, &renderer->mesh, renderer->pkg, far_ops, &repr_config);
	if (!err)
		err = near_mesh_init(&renderer->mesh, arena, renderer->gfx, renderer->pkg, shares.gpu_bytes,
			shares.around ? &shares.need : NULL);
	if (err)
		return err;
	renderer->obstacles = (struct obstacles){ .pkg = renderer->pkg, .residency = &renderer->mesh.residency };
	camera_init(&renderer->camera, renderer->config.fov_deg * (BLVD_PI / 180.0));
	renderer->camera.pose = opening_pose(renderer->pkg);
	return 0;
}

/* Everything that grows with the city, and room for all that does not. */
uint64_t renderer_arena_bytes(const struct renderer_config *config, const struct pkg *pkg)
{
	uint64_t sum = FIXED_ARENA_BYTES + (uint64_t)pkg->graph.edge_count * ARENA_BYTES_AN_EDGE;
	sum += scene_arena_bytes(pkg) + near_mesh_arena_bytes(pkg);
	const struct repr_ops *far_ops = repr_by_name(config->far_name ? config->far_name : "full", pkg);
	if (pkg->stretches && far_ops && far_ops->cells) {
		struct cell_cache_config cells;
		far_ops->cells(pkg, &(struct repr_config){ .tau_px = config->tau_px }, &cells);
		cells.slot_count = SHARES_SLOTS_MAX;
		sum += cell_cache_bytes(pkg, &cells) + SHARES_SLOTS_MAX * sizeof(struct stored_slot);
	}
	return sum;
}

int renderer_init(
	struct renderer **out, struct arena *city_arena, const struct renderer_config *config, const struct pkg *pkg)
{
	*out = NULL;
	struct renderer *renderer = ARENA_ARRAY(city_arena, struct renderer, 1);
	if (!renderer)
		return -ENOMEM;
	renderer->config = with_defaults(config);
	renderer->pkg = pkg;
	const struct repr_ops *far_ops = repr_by_name(renderer->config.far_name, pkg);
	if (!far_ops) {
		log_error("no representation '%s'", renderer->config.far_name);
		return -EINVAL;
	}
	int err = make_objects(renderer, city_arena);
	if (!err)
		err = make_scene(renderer, city_arena, far_ops);
	if (err) {
		if (err != -EFBIG) /* which has been told */
			log_error("renderer: cannot start: %s", strerror(-err));
		renderer_finish(renderer);
		return err;
	}
	*out = renderer;
	return 0;
}

void renderer_finish(struct renderer *renderer)
{
	if (!renderer || !renderer->gfx)
		return;
	scene_finish(&renderer->scene);
	if (renderer->config.overlay)
		overlay_finish(&renderer->overlay);
	screen_finish(&renderer->own_screen);
	renderer->gfx = NULL;
}

/* The city's clock: the log's zone when the package knows it, else the sun's. */
static double local_hour(const struct pkg *pkg, int64_t wall_ns)
{
	double zone_minutes = (double)(int32_t)pkg->meta->utc_offset_minutes;
	if (pkg->meta->utc_offset_minutes == 0)
		zone_minutes = pkg->meta->origin_lon_deg * 4.0;
	double hours = (double)(wall_ns / NS_PER_S) / 3600.0 + zone_minutes / 60.0;
	return hours - floor(hours / 24.0) * 24.0;
}

static void update_light(struct renderer *renderer, const struct renderer_time *time)
{
	const struct pkg_meta *meta = renderer->pkg->meta;
	int64_t wall_ns = time->wall_ns;
	if (!wall_ns)
		wall_ns = (DEFAULT_WALL_S - llrint(meta->origin_lon_deg * 240.0)) * NS_PER_S;
	struct sun_position sun = sun_at(wall_ns, meta->origin_lat_deg, meta->origin_lon_deg);
	if (time->force_day)
		sun.elevation_rad = fmax(sun.elevation_rad, LEAST_DAY_RAD);
	struct light_state *light = &renderer->light;
	sun_light(&sun, local_hour(renderer->pkg, wall_ns), time->ambient, time->force_night, light);
	renderer->mesh.lit = light->lamps > 0.0f || light->windows_lit > 0.0f || light->shops_lit > 0.0f;
}

static void put(float out[4], struct vec3 v, float w)
{
	out[0] = v.x;
	out[1] = v.y;
	out[2] = v.z;
	out[3] = w;
}

static void write_frame_block(struct renderer *renderer, const struct renderer_time *time)
{
	const struct light_state *light = &renderer->light;
	const struct view *view = &renderer->view;
	struct frame_block block;
	put(block.sun_direction, light->direction, light->night);
	put(block.sun_color, light->sun, light->lamps);
	put(block.sky_color, light->sky, light->windows_lit);
	put(block.ground_color, light->ground, light->shops_lit);
	put(block.haze, light->haze, light->haze_per_m * 1.442695f); /* for exp2 */
	put(block.zenith, light->zenith, light->stars);
	struct vec3 eye = { (float)((double)(view->eye_mm[0] & 0xFFFFF) * 1e-3),
		(float)((double)(view->eye_mm[1] & 0xFFFFF) * 1e-3), (float)((double)view->eye_mm[2] * 1e-3) };
	put(block.eye, eye, (float)((double)(time->time_ns % (1024 * NS_PER_S)) / (double)NS_PER_S));
	block.screen[0] = (float)view->width;
	block.screen[1] = (float)view->height;
	block.screen[2] = 1.0f / (float)view->width;
	block.screen[3] = 1.0f / (float)view->height;
	gfx_buffer_write(renderer->gfx, renderer->frame_block, 0, &block, sizeof(block));
}

/* What stands for the distance, and the geometry that it leaves to be drawn. After a jump of the eye, and when the
 * car has been found, the frame waits for what it wants; otherwise loading keeps to its slice. */
static void load(struct renderer *renderer, const struct nav_view *nav, int64_t time_ns)
{
	const int64_t *eye_mm = renderer->view.eye_mm;
	bool placed = nav && nav->located;
	bool jumped = !renderer->primed || (placed && !renderer->placed);
	for (int axis = 0; axis < 3; axis++)
		jumped = jumped || llabs(eye_mm[axis] - renderer->loaded_mm[axis]) > JUMP_MM;
	struct repr *repr = &renderer->scene.repr;
	struct repr_place place = { .view = &renderer->view, .nav = nav, .time_ns = time_ns, .jumped = jumped };
	repr->ops->select(repr, &place);
	double far_m = renderer->config.far_m;
	double split_m = repr->ops->split_m ? repr->ops->split_m(repr) : 0.0;
	if (split_m > 0.0)
		camera_split(&renderer->view, split_m, far_m);
	double reach_m = repr->ops->reach_m ? repr->ops->reach_m(repr) : far_m;
	/* the rest of a city that has room for all of it can wait; what belongs around a place cannot */
	struct near_mesh *mesh = &renderer->mesh;
	bool all = jumped && !mesh->residency.whole, first = !renderer->primed;
	if (!first || all)
		near_mesh_load(mesh, eye_mm, reach_m, all ? UINT64_MAX : renderer->config.upload_slice_bytes);
	mesh->light_far = mesh->light_far || (mesh->lit && repr->ops->reach_m); /* impostors are lit by it */
	near_mesh_load_seen(mesh, &renderer->view, fmax(reach_m * 2.0, SEEN_MIN_M));
	if (!first)
		near_mesh_load_textures(mesh);
	memcpy(renderer->loaded_mm, eye_mm, sizeof(renderer->loaded_mm));
	renderer->primed = true;
	renderer->placed = placed;
}

static void update_overlay(struct renderer *renderer, const struct nav_view *nav, const struct renderer_time *time)
{
	struct overlay_input input = {
		.view = &renderer->view,
		.nav = nav,
		.kind = renderer->camera.kind,
		.time_ns = time->time_ns,
		.daylight = 1.0f - renderer->light.night,
		.map_damaged = renderer->mesh.residency.damaged > 0,
		.message = time->message,
		.driver = time->driver,
	};
	overlay_update(&renderer->overlay, &input);
}

/* What should be seen: the route up to a little behind the next manoeuvre, and the car from outside. */
static uint32_t points_to_see(const struct renderer *renderer, const struct nav_view *nav, int64_t (*out)[3])
{
	const struct ribbon *ribbon = &renderer->overlay.ribbon;
	uint32_t count = 0;
	if (renderer->camera.kind != CAMERA_DRIVER && nav->located) {
		for (int axis = 0; axis < 3; axis++)
			out[count][axis] = nav->pos_mm[axis] + (axis == 2 ? 1200 : 0);
		count++;
	}
	if (!renderer->config.overlay || !nav->routed || ribbon->path.count < 2)
		return count;
	double ahead_m = nav->next.manoeuvre != NAV_MANOEUVRE_NONE ? nav->next.distance_m + SEE_BEHIND_M : SEE_AHEAD_M;
	double step_m = fmin(ahead_m, SEE_AHEAD_M) / (FADE_POINTS_MAX - 1);
	for (double s = step_m; count < FADE_POINTS_MAX; s += step_m) {
		struct dvec2 direction;
		struct dvec3 at = route_path_at(&ribbon->path, ribbon->car_s + s, &direction);
		out[count][0] = ribbon->path.origin_mm[0] + llrint(at.x * 1000.0);
		out[count][1] = ribbon->path.origin_mm[1] + llrint(at.y * 1000.0);
		out[count][2] = ribbon->path.origin_mm[2] + llrint(at.z * 1000.0) + 1000;
		count++;
	}
	return count;
}

static void update_fading(struct renderer *renderer, const struct nav_view *nav, int64_t time_ns)
{
	renderer->scene.fade.opacity = renderer->camera.kind == CAMERA_DRIVER ? 0.5f : 0.25f;
	int64_t points[FADE_POINTS_MAX][3];
	uint32_t count = nav ? points_to_see(renderer, nav, points) : 0;
	fade_update(&renderer->scene.fade, &renderer->obstacles, renderer->view.eye_mm, (const int64_t(*)[3])points, count,
		time_ns);
}

/* What lies on the street is drawn in both slices, each with its own depths. */
static void draw_in_slices(
	struct renderer *renderer, void (*draw)(const struct overlay *overlay, enum view_slice_id slice))
{
	for (int slice = VIEW_SLICE_COUNT - 1; slice >= 0; slice--) {
		const struct view_slice *depth = &renderer->view.slice[slice];
		gfx_depth_range(renderer->gfx, depth->depth_near, depth->depth_far);
		draw(&renderer->overlay, (enum view_slice_id)slice);
	}
}

static void draw_place_disc(struct renderer *renderer, const struct nav_view *nav)
{
	place_disc_update(&renderer->place_disc, nav);
	for (int slice = VIEW_SLICE_COUNT - 1; slice >= 0; slice--) {
		const struct view_slice *depth = &renderer->view.slice[slice];
		gfx_depth_range(renderer->gfx, depth->depth_near, depth->depth_far);
		place_disc_draw(&renderer->place_disc, &renderer->view, (enum view_slice_id)slice, nav, renderer->light.night);
	}
}

static void draw_pass(struct renderer *renderer, const struct nav_view *nav)
{
	struct gfx *gfx = renderer->gfx;
	bool overlay = nav && renderer->config.overlay;
	struct gfx_clear clear = { .color = true, .depth = true };
	gfx_pass_begin(gfx, renderer->target, &clear);
	submit_solid(gfx, &renderer->mesh, &renderer->view, &renderer->scene.list, renderer->frame_block);
	const struct repr *repr = &renderer->scene.repr;
	if (repr->ops->draw)
		repr->ops->draw(repr, &renderer->view, renderer->frame_block);
	sky_draw(&renderer->sky, &renderer->view, &renderer->light, renderer->frame_block);
	backdrop_draw(&renderer->backdrop, &renderer->view, renderer->frame_block);
	if (nav)
		draw_place_disc(renderer, nav);
	if (overlay)
		draw_in_slices(renderer, overlay_draw_world);
	if (nav)
		marker_draw(&renderer->marker, &renderer->view, nav, renderer->camera.kind, renderer->light.night);
	submit_faded(gfx, &renderer->mesh, &renderer->view, &renderer->scene.list, renderer->frame_block);
	if (overlay)
		draw_in_slices(renderer, overlay_draw_hidden);
	gfx_depth_range(gfx, 0.0f, 1.0f);
	if (overlay)
		overlay_draw_screen(&renderer->overlay);
	gfx_pass_end(gfx);
}

/* Everything up to the draw list. */
static void prepare_frame(struct renderer *renderer, const struct camera_pose *pose, const struct nav_view *nav,
	const struct renderer_time *time)
{
	struct camera_pose eye = *pose;
	eye.fov_rad = eye.fov_rad > 0.0 ? eye.fov_rad : renderer->camera.fov_rad;
	camera_view(
		&eye, renderer->config.width, renderer->config.height, SPLIT_M, renderer->config.far_m, &renderer->view);
	update_light(renderer, time);
	gfx_frame_begin(renderer->gfx);
	write_frame_block(renderer, time);
	load(renderer, nav, time->time_ns);
	if (nav && renderer->config.overlay)
		update_overlay(renderer, nav, time);
	update_fading(renderer, nav, time->time_ns);
	scene_build(&renderer->scene, &renderer->view);
	backdrop_update(&renderer->backdrop, &renderer->view);
}

void renderer_draw(struct renderer *renderer, const struct nav_view *nav, const struct renderer_time *time)
{
	camera_follow(&renderer->camera, nav, &renderer->obstacles);
	renderer_draw_from(renderer, nav, &renderer->camera.pose, time);
}

void renderer_draw_from(struct renderer *renderer, const struct nav_view *nav, const struct camera_pose *pose,
	const struct renderer_time *time)
{
	prepare_frame(renderer, pose, nav, time);
	draw_pass(renderer, nav);
}

void renderer_draw_pose(struct renderer *renderer, const struct camera_pose *pose, const struct renderer_time *time)
{
	renderer->primed = false; /* a still: everything it wants, at once */
	prepare_frame(renderer, pose, NULL, time);
	draw_pass(renderer, NULL);
}

void renderer_draw_truth(
	struct renderer *renderer, const struct camera_pose *pose, const struct renderer_time *time, uint32_t *out)
{
	renderer->primed = false;
	prepare_frame(renderer, pose, NULL, time);
	renderer_read_truth(renderer, (struct dvec2){ 0, 0 }, out);
}

/* The same view whose picture has been moved so that what was at `at_px` from a pixel's middle is in it. */
static struct view look_beside(const struct view *view, struct dvec2 at_px)
{
	struct view out = *view;
	float right = (float)(-2.0 * at_px.x / view->width), up = (float)(2.0 * at_px.y / view->height);
	for (int slice = 0; slice < VIEW_SLICE_COUNT; slice++) {
		float *m = out.slice[slice].clip_from_eye.m;
		for (int column = 0; column < 4; column++) {
			m[4 * column] += right * m[4 * column + 3];
			m[4 * column + 1] += up * m[4 * column + 3];
		}
	}
	return out;
}

void renderer_read_truth(struct renderer *renderer, struct dvec2 at_px, uint32_t *out)
{
	assert(renderer->config.truth);
	struct view view = look_beside(&renderer->view, at_px);
	frame_truth_begin(&renderer->truth);
	frame_truth_draw_list(&renderer->truth, &renderer->mesh, &view, &renderer->scene.list);
	const struct repr *repr = &renderer->scene.repr;
	if (repr->ops->draw_truth)
		repr->ops->draw_truth(repr, &view);
	frame_truth_end(&renderer->truth);
	frame_truth_read(&renderer->truth, out);
}

struct camera *renderer_camera(struct renderer *renderer)
{
	return &renderer->camera;
}

void renderer_present(struct renderer *renderer, uint32_t width, uint32_t height)
{
	gfx_present(renderer->gfx, renderer->target, width, height);
}

void renderer_read_pixels(struct renderer *renderer, uint8_t *out)
{
	gfx_read_rgba8(renderer->gfx, renderer->target, out);
}

void renderer_stats(const struct renderer *renderer, struct renderer_stats *out)
{
	const struct gfx_stats *gfx = gfx_stats(renderer->gfx);
	const struct residency *residency = &renderer->mesh.residency;
	const struct repr_counts *counts = &renderer->scene.repr.counts;
	*out = (struct renderer_stats){
		.frames = gfx->frames,
		.draws = gfx->draws,
		.triangles = gfx->triangles,
		.far_name = renderer->scene.repr.ops->name,
		.far_triangles = counts->triangles,
		.far_fallback = counts->fallback,
		.far_late = counts->late,
		.far_entered = counts->entered,
		.far_damaged = counts->damaged,
		.far_error_px = renderer->scene.repr.ops->error_px(&renderer->scene.repr),
		.far_bytes = renderer->scene.repr.ops->bytes(&renderer->scene.repr),
		.gpu_bytes = gfx->bytes,
		.gpu_bytes_high_water = gfx->bytes_high_water,
		.chunks = renderer->pkg->chunk_count,
		.chunks_resident = residency->present,
		.chunks_wanted_missing = counts->missing,
		.chunks_damaged = residency->damaged,
		.chunks_dropped = residency->dropped,
		.chunks_evicted = residency->evicted,
		.upload_pending_bytes = residency->pending_bytes,
		.night = renderer->light.night,
		.gl_renderer = gfx_caps(renderer->gfx)->renderer,
		.samples = gfx_target_samples(renderer->gfx, renderer->target),
	};
}
