/* Two draws a slice, one more when an arrow is near. */
#include "render/route_ribbon.h"

#include <errno.h>
#include <math.h>

#define LIFT_M 0.04                                       /* above the carriageway, besides the polygon offset */
#define ARROW_POINTS 40u                                  /* along the shaft */
#define ARROW_VERTICES ((ARROW_POINTS - 1) * 24 + 6 + 18) /* shaft, its end, head */
#define ARROW_BEFORE_M 15.0
#define ARROW_AFTER_M 17.0
#define ARROW_LONGEST_M 60.0
#define ARROW_HEIGHT_M 1.9 /* of its middle line above the carriageway */
#define ARROW_HALF_WIDTH_M 0.75
#define ARROW_HALF_THICK_M 0.45
#define ARROW_HEAD_HALF_WIDTH_M 1.9
#define ARROW_HEAD_HALF_THICK_M 1.5
#define ARROW_HEAD_M 5.0
#define ARROW_SHOWN_M 160.0f
#define ARROW_FADE_M 30.0f
#define ARROW_GONE_M 20.0f /* nearer than this it would stand in the driver's way */
#define ARROW_LEAVE_M 14.0f

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
		.attribute_count = 4,
		.attributes = { { GFX_F32X3, offsetof(struct ribbon_vertex, pos) },
			{ GFX_F32X2, offsetof(struct ribbon_vertex, side) }, { GFX_F32X1, offsetof(struct ribbon_vertex, lateral) },
			{ GFX_F32X1, offsetof(struct ribbon_vertex, s) } },
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
				.pos = { (float)point->at.x, (float)point->at.y, (float)(point->at.z + LIFT_M) },
				.side = { (float)side.x, (float)side.y },
				.lateral = (float)edge,
				.s = (float)point->s,
			};
	}
	if (ribbon->gfx && ribbon->vertex_count)
		gfx_buffer_write(ribbon->gfx, ribbon->ribbon_buffer, 0, ribbon->vertices,
			ribbon->vertex_count * (uint32_t)sizeof(struct ribbon_vertex));
}

static void add_corner(struct ribbon *ribbon, struct dvec3 at, float shade, double s)
{
	ribbon->vertices[ribbon->arrow_vertex_count++] =
		(struct ribbon_vertex){ .pos = { (float)at.x, (float)at.y, (float)at.z }, .lateral = shade, .s = (float)s };
}

/* How much of the light colour each side shows. */
#define SHADE_TOP 1.0f
#define SHADE_SIDE 0.62f
#define SHADE_END 0.45f
#define SHADE_BELOW 0.25f

static void add_triangle(struct ribbon *ribbon, struct dvec3 a, struct dvec3 b, struct dvec3 c, float shade, double s)
{
	add_corner(ribbon, a, shade, s);
	add_corner(ribbon, b, shade, s);
	add_corner(ribbon, c, shade, s);
}

static void add_quad(
	struct ribbon *ribbon, struct dvec3 a, struct dvec3 b, struct dvec3 c, struct dvec3 d, float shade, double s)
{
	add_triangle(ribbon, a, b, c, shade, s);
	add_triangle(ribbon, a, c, d, shade, s);
}

/* Corners of the box section across the arrow: left low, right low, right high, left high. */
static void section_at(
	const struct ribbon *ribbon, double s, double half_width, double half_thick, struct dvec3 out[4], struct dvec3 *tip)
{
	struct dvec2 direction;
	struct dvec3 at = route_path_at(&ribbon->path, s, &direction);
	at.z += ARROW_HEIGHT_M;
	for (int i = 0; i < 4; i++) {
		double right = i == 1 || i == 2 ? half_width : -half_width, up = i >= 2 ? half_thick : -half_thick;
		out[i] = (struct dvec3){ at.x + direction.y * right, at.y - direction.x * right, at.z + up };
	}
	if (tip)
		*tip = (struct dvec3){ at.x + direction.x * ARROW_HEAD_M, at.y + direction.y * ARROW_HEAD_M, at.z };
}

static const float side_shades[4] = { SHADE_BELOW, SHADE_SIDE, SHADE_TOP, SHADE_SIDE };

static void add_shaft(struct ribbon *ribbon, double from, double to)
{
	struct dvec3 last[4] = { { 0 } }, next[4];
	for (uint32_t i = 0; i < ARROW_POINTS; i++) {
		double s = from + (to - from) * i / (ARROW_POINTS - 1);
		section_at(ribbon, s, ARROW_HALF_WIDTH_M, ARROW_HALF_THICK_M, next, NULL);
		if (i == 0)
			add_quad(ribbon, next[0], next[1], next[2], next[3], SHADE_END, s);
		for (uint32_t side = 0; i > 0 && side < 4; side++) {
			uint32_t end = (side + 1) % 4;
			add_quad(ribbon, last[side], last[end], next[end], next[side], side_shades[side], s);
		}
		memcpy(last, next, sizeof(last));
	}
}

/* A pyramid, so that it points the same way from wherever it is seen. */
static void add_head(struct ribbon *ribbon, double s)
{
	struct dvec3 base[4], tip;
	section_at(ribbon, s, ARROW_HEAD_HALF_WIDTH_M, ARROW_HEAD_HALF_THICK_M, base, &tip);
	add_quad(ribbon, base[0], base[1], base[2], base[3], SHADE_END, s);
	for (uint32_t side = 0; side < 4; side++)
		add_triangle(ribbon, base[side], base[(side + 1) % 4], tip, side_shades[side], s);
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
	float left = fminf(fmaxf((ahead - ARROW_GONE_M) / ARROW_LEAVE_M, 0.0f), 1.0f);
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
	bool chevrons = look->arrow && ribbon->arrow_vertex_count > 0;
	memcpy(out->manoeuvre,
		(float[4]){ (float)ribbon->arrow_s, chevrons ? 45.0f : 0.0f, alpha, look->least_px / 2.0f / view->focal_px },
		16);
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
	put_color(constants.edge, ribbon->palette.route_shade);
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
	fill_constants(ribbon, view, slice, look, look->hidden_alpha, &constants);
	draw_strip(ribbon, ribbon->hidden, &constants);
}
