/* One quad, two draws a slice; none at all while the place is sure. */
#include "render/place_disc.h"

#include <math.h>

#include "platform/base/geo.h"

#define SHOW_M 12.0 /* one sigma: a remembered place that is known better than this needs no disc */
#define FADE_S 1.0f
#define EASE_S 0.6f
#define MARGIN 0.06f
#define LEAST_M 5.0f /* the car itself */
#define ALPHA 0.55f
#define RAISE_MM 250

static int make_pipeline(struct place_disc *disc, enum gfx_depth depth, gfx_pipeline *out)
{
	struct gfx_pipeline_desc desc = {
		.program = disc->program,
		.stride = 2 * sizeof(float),
		.attribute_count = 1,
		.attributes = { { GFX_F32X2, 0 } },
		.primitive = GFX_TRIANGLE_STRIP,
		.blend = GFX_BLEND,
		.depth = depth,
	};
	return gfx_pipeline_create(disc->gfx, &desc, out);
}

int place_disc_init(struct place_disc *disc, struct gfx *gfx)
{
	static const float corners[] = { -1.0f, -1.0f, 1.0f, -1.0f, -1.0f, 1.0f, 1.0f, 1.0f };
	*disc = (struct place_disc){ .gfx = gfx };
	struct gfx_program_desc program = { .vertex = "place_disc.vert", .fragment = "place_disc.frag" };
	struct gfx_buffer_desc buffer = { .kind = GFX_BUFFER_VERTEX, .bytes = sizeof(corners), .data = corners };
	int err = gfx_program_create(gfx, &program, &disc->program);
	if (!err)
		err = gfx_buffer_create(gfx, &buffer, &disc->vertices);
	if (!err)
		err = make_pipeline(disc, GFX_DEPTH_TEST, &disc->front);
	if (!err)
		err = make_pipeline(disc, GFX_DEPTH_BEHIND, &disc->behind);
	return err;
}

void place_disc_finish(struct place_disc *disc)
{
	if (!disc->gfx)
		return;
	gfx_pipeline_destroy(disc->gfx, disc->front);
	gfx_pipeline_destroy(disc->gfx, disc->behind);
	gfx_buffer_destroy(disc->gfx, disc->vertices);
	gfx_program_destroy(disc->gfx, disc->program);
	*disc = (struct place_disc){ 0 };
}

static bool wanted(const struct nav_view *nav)
{
	return nav->located && (nav->doubt.place == NAV_PLACE_DRIFTING ||
							   (nav->doubt.place == NAV_PLACE_REMEMBERED && nav->doubt.major_m > SHOW_M));
}

void place_disc_update(struct place_disc *disc, const struct nav_view *nav)
{
	float dt = disc->started ? (float)((double)(nav->time_ns - disc->time_ns) * 1e-9) : 0.0f;
	float major = fmaxf((float)(PLACE_DISC_SIGMAS * nav->doubt.major_m), LEAST_M);
	float minor = fmaxf((float)(PLACE_DISC_SIGMAS * nav->doubt.minor_m), LEAST_M);
	bool shown = wanted(nav);
	dt = fminf(fmaxf(dt, 0.0f), 1.0f);
	if (disc->alpha <= 0.0f && shown) { /* it appears as large as it is */
		disc->major_m = major;
		disc->minor_m = minor;
	}
	float ease = 1.0f - expf(-dt / EASE_S);
	disc->major_m += ease * (major - disc->major_m);
	disc->minor_m += ease * (minor - disc->minor_m);
	disc->alpha = fminf(fmaxf(disc->alpha + (shown ? dt : -dt) / FADE_S, 0.0f), 1.0f);
	disc->time_ns = nav->time_ns;
	disc->started = true;
}

/* u_draw of place_disc.vert. */
struct disc_constants {
	float place[3], inverse_reach;
	float minor_m, major_m, turn[2];
	struct mat4 clip_from_eye;
	float color[4];
};

void place_disc_draw(const struct place_disc *disc, const struct view *view, enum view_slice_id slice,
	const struct nav_view *nav, float night)
{
	if (disc->alpha <= 0.0f || !nav->located)
		return;
	const int64_t at_mm[3] = { nav->pos_mm[0], nav->pos_mm[1], nav->pos_mm[2] + RAISE_MM };
	struct vec3 place = view_relative(view, at_mm);
	double heading = bam_to_rad(nav->doubt.heading_bam);
	float dim = 1.0f - 0.35f * night;
	struct disc_constants constants = {
		.place = { place.x, place.y, place.z },
		.inverse_reach = 1.0f / (1.0f + MARGIN),
		.minor_m = disc->minor_m,
		.major_m = disc->major_m,
		.turn = { (float)cos(heading), (float)sin(heading) },
		.clip_from_eye = view->slice[slice].clip_from_eye,
		.color = { 0.33f * dim, 0.46f * dim, 0.62f * dim, ALPHA * disc->alpha },
	};
	struct gfx_draw draw = {
		.pipeline = disc->front,
		.vertices = disc->vertices,
		.count = 4,
		.constants = (const float *)&constants,
		.constant_count = sizeof(constants) / 16,
	};
	gfx_draw(disc->gfx, &draw);
	constants.color[3] *= 0.4f;
	draw.pipeline = disc->behind;
	gfx_draw(disc->gfx, &draw);
}
