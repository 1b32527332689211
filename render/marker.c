/* A faceted arrowhead, built once, scaled by the distance so that it keeps its size on the screen when far. */
#include "render/marker.h"

#include <math.h>

#include "platform/base/geo.h"

struct marker_vertex {
	float position[3], normal[3];
};

#define LENGTH_M 4.6f
#define WIDTH_M 3.4f
#define RISE_M 1.1f

static struct vec3 corner(float x, float y, float z)
{
	return (struct vec3){ x * WIDTH_M * 0.5f, y * LENGTH_M * 0.5f, z * RISE_M };
}

/* Tip, two tails, a notch; each on the ground, and a ridge above. */
static int build(struct marker_vertex *out)
{
	const struct vec3 tip = corner(0, 1, 0.25f), left = corner(-1, -1, 0.25f), right = corner(1, -1, 0.25f);
	const struct vec3 notch = corner(0, -0.55f, 0.25f), ridge = corner(0, -0.35f, 1.0f);
	const struct vec3 low = { 0, 0, -RISE_M * 0.25f };
	const struct vec3 rim[] = { tip, left, notch, right };
	int count = 0;
	for (int i = 0; i < 4; i++) {
		struct vec3 a = rim[i], b = rim[(i + 1) % 4];
		const struct vec3 faces[3][3] = { { a, b, ridge }, { vec3_add(b, low), b, a },
			{ a, vec3_add(a, low), vec3_add(b, low) } };
		for (int f = 0; f < 3; f++) {
			struct vec3 n =
				vec3_normalize(vec3_cross(vec3_sub(faces[f][1], faces[f][0]), vec3_sub(faces[f][2], faces[f][0])));
			for (int k = 0; k < 3; k++)
				out[count++] =
					(struct marker_vertex){ { faces[f][k].x, faces[f][k].y, faces[f][k].z }, { n.x, n.y, n.z } };
		}
	}
	return count;
}
#define VERTICES 36

static int make_pipeline(struct marker *marker, enum gfx_depth depth, gfx_pipeline *out)
{
	struct gfx_pipeline_desc desc = {
		.program = marker->program,
		.stride = sizeof(struct marker_vertex),
		.attribute_count = 2,
		.attributes = { { GFX_F32X3, offsetof(struct marker_vertex, position) },
			{ GFX_F32X3, offsetof(struct marker_vertex, normal) } },
		.blend = GFX_BLEND,
		.depth = depth,
		.cull_back = true,
	};
	return gfx_pipeline_create(marker->gfx, &desc, out);
}

int marker_init(struct marker *marker, struct gfx *gfx)
{
	*marker = (struct marker){ .gfx = gfx };
	struct marker_vertex vertices[VERTICES];
	build(vertices);
	struct gfx_program_desc program = { .vertex = "marker.vert", .fragment = "marker.frag", .blocks = { "Frame" } };
	struct gfx_buffer_desc buffer = { .kind = GFX_BUFFER_VERTEX, .bytes = sizeof(vertices), .data = vertices };
	int err = gfx_program_create(gfx, &program, &marker->program);
	if (!err)
		err = gfx_buffer_create(gfx, &buffer, &marker->vertices);
	if (!err)
		err = make_pipeline(marker, GFX_DEPTH_TEST_WRITE, &marker->front);
	if (!err)
		err = make_pipeline(marker, GFX_DEPTH_BEHIND, &marker->behind);
	return err;
}

void marker_finish(struct marker *marker)
{
	if (!marker->gfx)
		return;
	gfx_pipeline_destroy(marker->gfx, marker->front);
	gfx_pipeline_destroy(marker->gfx, marker->behind);
	gfx_buffer_destroy(marker->gfx, marker->vertices);
	gfx_program_destroy(marker->gfx, marker->program);
	*marker = (struct marker){ 0 };
}

/* u_draw of marker.vert. */
struct marker_constants {
	float place[3], scale;
	float turn[4];
	struct mat4 clip_from_eye;
	float color[4];
};

void marker_draw(const struct marker *marker, const struct view *view, const struct nav_view *nav,
	enum camera_kind kind, float night)
{
	if (kind == CAMERA_DRIVER || !nav->located)
		return;
	int64_t at_mm[3] = { nav->pos_mm[0], nav->pos_mm[1], nav->pos_mm[2] + 300 };
	struct vec3 place = view_relative(view, at_mm);
	float away = vec3_dot(place, view->forward);
	enum view_slice_id slice = away < view->slice[VIEW_NEAR].far_m * 0.95f ? VIEW_NEAR : VIEW_FAR;
	double heading = bam_to_rad(nav->heading_bam);
	float dim = 1.0f - 0.25f * night;
	struct marker_constants constants = {
		.place = { place.x, place.y, place.z },
		.scale = fmaxf(1.0f, away * 46.0f / (view->focal_px * LENGTH_M)), /* >= 46 px */
		.turn = { (float)cos(heading), (float)sin(heading) },
		.clip_from_eye = view->slice[slice].clip_from_eye,
		.color = { 0.84f * dim, 0.38f * dim, 0.25f * dim, 1.0f },
	};
	struct gfx_draw draw = {
		.pipeline = marker->front,
		.vertices = marker->vertices,
		.count = VERTICES,
		.constants = (const float *)&constants,
		.constant_count = sizeof(constants) / 16,
	};
	gfx_depth_range(marker->gfx, view->slice[slice].depth_near, view->slice[slice].depth_far);
	gfx_draw(marker->gfx, &draw);
	constants.color[3] = 0.35f;
	draw.pipeline = marker->behind;
	gfx_draw(marker->gfx, &draw);
}
