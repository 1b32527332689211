/* Two draws a slice, one more when an arrow is near. */
#include "render/route_ribbon.h"

#include <errno.h>
#include <math.h>

#define LIFT_M 0.04      /* above the carriageway, besides the polygon offset */
#define ARROW_POINTS 40u /* along the shaft */
#define ARROW_VERTICES ((ARROW_POINTS - 1) * 18 + 24)
#define ARROW_BEFORE_M 16.0
#define ARROW_AFTER_M 15.0
#define ARROW_LONGEST_M 60.0
#define ARROW_HEIGHT_M 0.9
#define ARROW_THICK_M 0.45
#define ARROW_HALF_WIDTH_M 0.85
#define ARROW_HEAD_HALF_WIDTH_M 2.1
#define ARROW_HEAD_M 4.2
#define ARROW_SHOWN_M 160.0f
#define ARROW_FADE_M 30.0f

static int create_pipelines(struct ribbon *ribbon)
{
	struct gfx_program_desc program = { .vertex = "ribbon.vert", .fragment = "ribbon.frag" };
	program.defines = "#define NO_FRAME_BLOCK 1\n";
	int status = gfx_program_create(ribbon->gfx, &program, &ribbon->ribbon_program);
	program.defines = "#define NO_FRAME_BLOCK 1\n#define ARROW 1\n";
	if (status == 0)
		status = gfx_program_create(ribbon->gfx, &program, &ribbon->arrow_program);
	if (status < 0)
		return status;
	struct gfx_pipeline_desc desc = {
		.program = ribbon->ribbon_program,
		.stride = sizeof(struct ribbon_vertex),
		.attribute_count = 3,
		.attributes = { { GFX_F32X3, offsetof(struct ribbon_vertex, pos) },
			{ GFX_F32X1, offsetof(struct ribbon_vertex, lateral) }, { GFX_F32X1, offsetof(struct ribbon_vertex, s) } },
		.primitive = GFX_TRIANGLE_STRIP,
		.blend = GFX_PREMULTIPLIED,
		.depth = GFX_DEPTH_TEST,
		.offset_factor = -2.0f,
		.offset_units = -8.0f,
	};
	status = gfx_pipeline_create(ribbon->gfx, &desc, &ribbon->seen);
	desc.depth = GFX_DEPTH_BEHIND;
	if (status == 0)
		status = gfx_pipeline_create(ribbon->gfx, &desc, &ribbon->hidden);
	desc.program = ribbon->arrow_program;
	desc.primitive = GFX_TRIANGLES;
	desc.depth = GFX_DEPTH_TEST_WRITE;
	desc.offset_factor = desc.offset_units = 0.0f;
	if (status == 0)
		status = gfx_pipeline_create(ribbon->gfx, &desc, &ribbon->arrow);
	return status;
}

static int create_buffers(struct ribbon *ribbon)
{
	struct gfx_buffer_desc desc = { .kind = GFX_BUFFER_VERTEX, .usage = GFX_STATIC };
	desc.bytes = 2 * ribbon->path.capacity * (uint32_t)sizeof(struct ribbon_vertex);
	int status = gfx_buffer_create(ribbon->gfx, &desc, &ribbon->ribbon_buffer);
	desc.bytes = ARROW_VERTICES * (uint32_t)sizeof(struct ribbon_vertex);
	return status < 0 ? status : gfx_buffer_create(ribbon->gfx, &desc, &ribbon->arrow_buffer);
}

int ribbon_init(struct ribbon *ribbon, struct arena *arena, struct gfx *gfx, uint32_t points)
{
	*ribbon = (struct ribbon){ .gfx = gfx, .arrow_from = PKG_NONE, .arrow_to = PKG_NONE };
	int status = route_path_init(&ribbon->path, arena, points);
	if (status < 0)
		return status;
	uint32_t vertices = 2 * ribbon->path.capacity > ARROW_VERTICES ? 2 * ribbon->path.capacity : ARROW_VERTICES;
	ribbon->vertices = ARENA_ARRAY(arena, struct ribbon_vertex, vertices);
	if (!ribbon->vertices)
		return -ENOMEM;
	if (!gfx)
		return 0;
	status = create_pipelines(ribbon);
	if (status == 0)
		status = create_buffers(ribbon);
	if (status < 0)
		ribbon_finish(ribbon);
	return status;
}

void ribbon_finish(struct ribbon *ribbon)
{
	if (ribbon->gfx) {
		gfx_buffer_destroy(ribbon->gfx, ribbon->arrow_buffer);
		gfx_buffer_destroy(ribbon->gfx, ribbon->ribbon_buffer);
		gfx_pipeline_destroy(ribbon->gfx, ribbon->arrow);
		gfx_pipeline_destroy(ribbon->gfx, ribbon->hidden);
		gfx_pipeline_destroy(ribbon->gfx, ribbon->seen);
		gfx_program_destroy(ribbon->gfx, ribbon->arrow_program);
		gfx_program_destroy(ribbon->gfx, ribbon->ribbon_program);
	}
	*ribbon = (struct ribbon){ 0 };
}

static void build_ribbon(struct ribbon *ribbon)
{
	const struct route_path *path = &ribbon->path;
	ribbon->vertex_count = 0;
	for (uint32_t i = 0; i < path->count; i++) {
		const struct route_path_point *point = &path->points[i];
		struct dvec2 side = dvec2_scale(route_path_side(path, i), point->half_width);
		for (int edge = -1; edge <= 1; edge += 2)
			ribbon->vertices[ribbon->vertex_count++] = (struct ribbon_vertex){
				.pos = { (float)(point->at.x + edge * side.x), (float)(point->at.y + edge * side.y),
					(float)(point->at.z + LIFT_M) },
				.lateral = (float)edge,
				.s = (float)point->s,
			};
	}
	if (ribbon->gfx && ribbon->vertex_count)
		gfx_buffer_write(ribbon->gfx, ribbon->ribbon_buffer, 0, ribbon->vertices,
			ribbon->vertex_count * (uint32_t)sizeof(struct ribbon_vertex));
}

static void add_corner(struct ribbon *ribbon, struct dvec3 at, double up, float shade, double s)
{
	ribbon->vertices[ribbon->arrow_vertex_count++] = (struct ribbon_vertex){
		.pos = { (float)at.x, (float)at.y, (float)(at.z + up) }, .lateral = shade, .s = (float)s
	};
}

#define SHADE_TOP 1.0f
#define SHADE_SIDE 0.45f

static void add_top(struct ribbon *ribbon, struct dvec3 a, struct dvec3 b, struct dvec3 c, double s)
{
	const double up = ARROW_HEIGHT_M + ARROW_THICK_M;
	add_corner(ribbon, a, up, SHADE_TOP, s);
	add_corner(ribbon, b, up, SHADE_TOP, s);
	add_corner(ribbon, c, up, SHADE_TOP, s);
}

static void add_wall(struct ribbon *ribbon, struct dvec3 a, struct dvec3 b, double s)
{
	const double low = ARROW_HEIGHT_M, high = ARROW_HEIGHT_M + ARROW_THICK_M;
	add_corner(ribbon, a, low, SHADE_SIDE, s);
	add_corner(ribbon, b, low, SHADE_SIDE, s);
	add_corner(ribbon, b, high, SHADE_SIDE, s);
	add_corner(ribbon, a, low, SHADE_SIDE, s);
	add_corner(ribbon, b, high, SHADE_SIDE, s);
	add_corner(ribbon, a, high, SHADE_SIDE, s);
}

static struct dvec3 beside(struct dvec3 at, struct dvec2 direction, double right_m)
{
	return (struct dvec3){ at.x + direction.y * right_m, at.y - direction.x * right_m, at.z };
}

static void add_shaft(struct ribbon *ribbon, double from, double to)
{
	struct dvec3 left = { 0 }, right = { 0 };
	for (uint32_t i = 0; i < ARROW_POINTS; i++) {
		double s = from + (to - from) * i / (ARROW_POINTS - 1);
		struct dvec2 direction;
		struct dvec3 at = route_path_at(&ribbon->path, s, &direction);
		struct dvec3 next_left = beside(at, direction, -ARROW_HALF_WIDTH_M);
		struct dvec3 next_right = beside(at, direction, ARROW_HALF_WIDTH_M);
		if (i > 0) {
			add_top(ribbon, left, right, next_right, s);
			add_top(ribbon, left, next_right, next_left, s);
			add_wall(ribbon, right, next_right, s);
			add_wall(ribbon, next_left, left, s);
		} else
			add_wall(ribbon, next_left, next_right, s);
		left = next_left;
		right = next_right;
	}
}

static void add_head(struct ribbon *ribbon, double s)
{
	struct dvec2 direction;
	struct dvec3 at = route_path_at(&ribbon->path, s, &direction);
	struct dvec3 left = beside(at, direction, -ARROW_HEAD_HALF_WIDTH_M);
	struct dvec3 right = beside(at, direction, ARROW_HEAD_HALF_WIDTH_M);
	struct dvec3 tip = { at.x + direction.x * ARROW_HEAD_M, at.y + direction.y * ARROW_HEAD_M, at.z };
	add_top(ribbon, left, right, tip, s);
	add_wall(ribbon, left, right, s);
	add_wall(ribbon, right, tip, s);
	add_wall(ribbon, tip, left, s);
}

static bool wants_arrow(const struct nav_view *nav)
{
	return nav->located && nav->routed && nav->next.manoeuvre != NAV_MANOEUVRE_NONE &&
		   nav->next.manoeuvre != NAV_MANOEUVRE_ARRIVE && nav->next.manoeuvre != NAV_MANOEUVRE_STRAIGHT;
}

static void build_arrow(struct ribbon *ribbon, const struct nav_view *nav)
{
	struct route_path_half in, out;
	ribbon->arrow_vertex_count = 0;
	ribbon->arrow_from = nav->next.from_half;
	ribbon->arrow_to = nav->next.to_half;
	if (!wants_arrow(nav) || ribbon->path.count < 2 || !route_path_find(&ribbon->path, nav->next.from_half, &in) ||
		!route_path_find(&ribbon->path, nav->next.to_half, &out) || out.s_start < in.s_end - 0.5)
		return;
	double from = fmax(in.s_end - ARROW_BEFORE_M, 0.0);
	double to = fmin(out.s_start + ARROW_AFTER_M, ribbon->path.points[ribbon->path.count - 1].s) - ARROW_HEAD_M;
	ribbon->arrow_s = in.s_end;
	from = fmax(from, to - ARROW_LONGEST_M);
	if (to - from < 3.0)
		return;
	add_shaft(ribbon, from, to);
	add_head(ribbon, to);
	if (ribbon->gfx)
		gfx_buffer_write(ribbon->gfx, ribbon->arrow_buffer, 0, ribbon->vertices,
			ribbon->arrow_vertex_count * (uint32_t)sizeof(struct ribbon_vertex));
}

void ribbon_update(
	struct ribbon *ribbon, const struct pkg *pkg, const struct nav_view *nav, const struct palette *palette)
{
	ribbon->palette = *palette;
	bool rebuilt = route_path_follow(&ribbon->path, pkg, nav);
	if (rebuilt) {
		build_ribbon(ribbon);
		ribbon->rebuilds++;
	}
	if (rebuilt || nav->next.from_half != ribbon->arrow_from || nav->next.to_half != ribbon->arrow_to)
		build_arrow(ribbon, nav);
	if (ribbon->path.count)
		ribbon->car_s = route_path_car_s(&ribbon->path, nav);
	float ahead = (float)(ribbon->arrow_s - ribbon->car_s);
	float near = fminf(fmaxf((ARROW_SHOWN_M - ahead) / ARROW_FADE_M, 0.0f), 1.0f);
	float left = fminf(fmaxf((ahead + 6.0f) / 8.0f, 0.0f), 1.0f);
	ribbon->arrow_alpha = ribbon->arrow_vertex_count ? near * left : 0.0f;
}

static void put_color(float out[4], struct rgba color)
{
	out[0] = color.r;
	out[1] = color.g;
	out[2] = color.b;
	out[3] = color.a;
}

/* u_draw of ribbon.vert and ribbon.frag */
struct ribbon_constants {
	float clip_from_eye[16];
	float origin_eye[4]; /* w: the car's s */
	float color[4];
	float edge[4];
	float fade[4];      /* start, start fade, end, end fade */
	float manoeuvre[4]; /* x: s; y: chevrons reach this far around it, 0 none; z: alpha of everything */
	float chevron[4];
};
static_assert(sizeof(struct ribbon_constants) <= GFX_CONSTANTS_MAX * 16, "fits the draw's constants");

static void fill_constants(const struct ribbon *ribbon, const struct view *view, enum view_slice_id slice,
	const struct ribbon_look *look, float alpha, struct ribbon_constants *out)
{
	struct vec3 origin = view_relative(view, ribbon->path.origin_mm);
	memcpy(out->clip_from_eye, view->slice[slice].clip_from_eye.m, sizeof(out->clip_from_eye));
	memcpy(out->origin_eye, (float[4]){ origin.x, origin.y, origin.z, (float)ribbon->car_s }, 16);
	put_color(out->color, ribbon->palette.route);
	put_color(out->edge, ribbon->palette.route_edge);
	put_color(out->chevron, ribbon->palette.route_arrow);
	float path_end = (float)(ribbon->path.points[ribbon->path.count - 1].s - ribbon->car_s);
	float end = fminf(look->end_m, path_end);
	float end_fade = ribbon->path.whole && end == path_end ? 0.5f : look->end_fade_m;
	memcpy(out->fade, (float[4]){ look->start_m, look->start_fade_m, end, end_fade }, 16);
	bool chevrons = ribbon->arrow_vertex_count > 0;
	memcpy(out->manoeuvre, (float[4]){ (float)ribbon->arrow_s, chevrons ? 45.0f : 0.0f, alpha, 0.0f }, 16);
}

static void draw_strip(const struct ribbon *ribbon, gfx_pipeline pipeline, const struct ribbon_constants *constants)
{
	struct gfx_draw draw = {
		.pipeline = pipeline,
		.vertices = ribbon->ribbon_buffer,
		.count = ribbon->vertex_count,
		.constants = (const float *)constants,
		.constant_count = sizeof(*constants) / 16,
	};
	gfx_draw(ribbon->gfx, &draw);
}

void ribbon_draw(
	const struct ribbon *ribbon, const struct view *view, enum view_slice_id slice, const struct ribbon_look *look)
{
	struct ribbon_constants constants;
	if (!ribbon->gfx || ribbon->path.count < 2)
		return;
	fill_constants(ribbon, view, slice, look, 1.0f, &constants);
	draw_strip(ribbon, ribbon->seen, &constants);
	if (!look->arrow || ribbon->arrow_alpha <= 0.0f)
		return;
	constants.manoeuvre[2] = ribbon->arrow_alpha;
	put_color(constants.color, ribbon->palette.route_arrow);
	put_color(constants.edge, ribbon->palette.route);
	struct gfx_draw draw = {
		.pipeline = ribbon->arrow,
		.vertices = ribbon->arrow_buffer,
		.count = ribbon->arrow_vertex_count,
		.constants = (const float *)&constants,
		.constant_count = sizeof(constants) / 16,
	};
	gfx_draw(ribbon->gfx, &draw);
}

void ribbon_draw_hidden(
	const struct ribbon *ribbon, const struct view *view, enum view_slice_id slice, const struct ribbon_look *look)
{
	struct ribbon_constants constants;
	if (!ribbon->gfx || ribbon->path.count < 2)
		return;
	fill_constants(ribbon, view, slice, look, 0.22f, &constants);
	draw_strip(ribbon, ribbon->hidden, &constants);
}
