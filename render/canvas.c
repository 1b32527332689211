/* Shapes become triangles on the CPU: some thousand vertices a frame, tens of microseconds. */
#include "render/canvas.h"

#include <assert.h>
#include <errno.h>
#include <math.h>

#define DEFAULT_VERTICES 8192u
#define INDICES_PER_VERTEX 3u /* fringes take most: six indices for two vertices */

void canvas_color(uint8_t out[4], struct rgba color)
{
	const float values[4] = { color.r, color.g, color.b, color.a };
	for (int i = 0; i < 4; i++)
		out[i] = (uint8_t)(fminf(fmaxf(values[i], 0.0f), 1.0f) * 255.0f + 0.5f);
}

static void enter_run(struct canvas *canvas, enum canvas_kind kind)
{
	uint32_t count = canvas->run_count;
	if (count && (canvas->runs[count - 1].kind == kind || count == CANVAS_RUNS_MAX))
		return;
	if (count == CANVAS_RUNS_MAX - 1)
		kind = CANVAS_GLYPHS;
	canvas->runs[canvas->run_count++] = (struct canvas_run){ canvas->index_count, kind };
}

/* Room for a shape, all or nothing. */
static struct canvas_vertex *take(
	struct canvas *canvas, enum canvas_kind kind, uint32_t vertices, uint32_t indices, uint32_t *first)
{
	if (canvas->vertex_count + vertices > canvas->vertex_capacity ||
		canvas->index_count + indices > canvas->index_capacity) {
		canvas->dropped++;
		return NULL;
	}
	enter_run(canvas, kind);
	*first = canvas->vertex_count;
	canvas->vertex_count += vertices;
	return canvas->vertices + *first;
}

static void add_triangle(struct canvas *canvas, uint32_t a, uint32_t b, uint32_t c)
{
	uint16_t *at = canvas->indices + canvas->index_count;
	at[0] = (uint16_t)a;
	at[1] = (uint16_t)b;
	at[2] = (uint16_t)c;
	canvas->index_count += 3;
}

static void add_quad(struct canvas *canvas, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
	add_triangle(canvas, a, b, c);
	add_triangle(canvas, a, c, d);
}

static void put(struct canvas_vertex *vertex, float x, float y, const uint8_t color[4], bool solid)
{
	*vertex = (struct canvas_vertex){ .x = x, .y = y };
	memcpy(vertex->fill, color, 4);
	if (!solid)
		vertex->fill[3] = 0;
}

static struct vec2 unit(float x, float y)
{
	float length = hypotf(x, y);
	return length > 1e-6f ? (struct vec2){ x / length, y / length } : (struct vec2){ 0.0f, 0.0f };
}

/* Mitre at `at` between its neighbours: moving the point by it moves both edges by 1 (at most 2 in all). */
static struct vec2 mitre(struct vec2 before, struct vec2 at, struct vec2 after)
{
	struct vec2 in = unit(at.x - before.x, at.y - before.y), out = unit(after.x - at.x, after.y - at.y);
	struct vec2 sum = { in.y + out.y, -in.x - out.x };
	float square = sum.x * sum.x + sum.y * sum.y;
	if (square < 1e-6f)
		return (struct vec2){ in.y, -in.x };
	float scale = fminf(2.0f / square, 2.0f / sqrtf(square));
	return (struct vec2){ sum.x * scale, sum.y * scale };
}

static float turn_of(const struct vec2 *points, uint32_t count)
{
	float area = 0.0f;
	for (uint32_t i = 0; i < count; i++) {
		const struct vec2 *a = &points[i], *b = &points[(i + 1) % count];
		area += a->x * b->y - b->x * a->y;
	}
	return area;
}

void canvas_convex(
	struct canvas *canvas, const struct vec2 *points, uint32_t count, float feather_px, struct rgba color)
{
	uint32_t first;
	assert(count >= 3 && count <= CANVAS_POINTS_MAX);
	struct canvas_vertex *out = take(canvas, CANVAS_SHAPES, 2 * count, 3 * (count - 2) + 6 * count, &first);
	if (!out)
		return;
	uint8_t rgba[4];
	canvas_color(rgba, color);
	float outward = (turn_of(points, count) > 0.0f ? 0.5f : -0.5f) * feather_px;
	for (uint32_t i = 0; i < count; i++) {
		struct vec2 at = points[i], side = mitre(points[(i + count - 1) % count], at, points[(i + 1) % count]);
		put(&out[2 * i], at.x - side.x * outward, at.y - side.y * outward, rgba, true);
		put(&out[2 * i + 1], at.x + side.x * outward, at.y + side.y * outward, rgba, false);
	}
	for (uint32_t i = 2; i < count; i++)
		add_triangle(canvas, first, first + 2 * (i - 1), first + 2 * i);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % count);
		add_quad(canvas, a, a + 1, b + 1, b);
	}
}

/* Segments of a circle so that its chords stay within a tenth of a pixel. */
static uint32_t segments(float radius, float sweep_rad)
{
	float step = 2.0f * acosf(1.0f - fminf(0.1f / fmaxf(radius, 0.1f), 0.5f));
	return (uint32_t)fminf(fmaxf(ceilf(fabsf(sweep_rad) / step), 4.0f), CANVAS_POINTS_MAX / 1.0f);
}

void canvas_rounded_box(struct canvas *canvas, struct box box, float radius, float feather_px, struct rgba color)
{
	struct vec2 points[CANVAS_POINTS_MAX];
	float limit = fminf(box.x1 - box.x0, box.y1 - box.y0) / 2.0f;
	radius = fmaxf(fminf(radius, limit), 0.0f);
	uint32_t arcs = segments(radius, (float)BLVD_PI / 2.0f), count = 0;
	arcs = arcs > CANVAS_POINTS_MAX / 4 - 1 ? CANVAS_POINTS_MAX / 4 - 1 : arcs;
	for (uint32_t corner = 0; corner < 4; corner++) {
		float cx = corner == 1 || corner == 2 ? box.x1 - radius : box.x0 + radius;
		float cy = corner >= 2 ? box.y1 - radius : box.y0 + radius;
		for (uint32_t i = 0; i <= arcs; i++) {
			float angle = (float)BLVD_PI / 2.0f * ((float)corner + (float)i / (float)arcs);
			points[count++] = (struct vec2){ cx - cosf(angle) * radius, cy - sinf(angle) * radius };
		}
	}
	canvas_convex(canvas, points, count, feather_px, color);
}

void canvas_disc(struct canvas *canvas, struct vec2 center, float radius, struct rgba color)
{
	struct vec2 points[CANVAS_POINTS_MAX];
	uint32_t count = segments(radius, 2.0f * (float)BLVD_PI);
	for (uint32_t i = 0; i < count; i++) {
		float angle = 2.0f * (float)BLVD_PI * (float)i / (float)count;
		points[i] = (struct vec2){ center.x + radius * sinf(angle), center.y - radius * cosf(angle) };
	}
	canvas_convex(canvas, points, count, 1.0f, color);
}

/* Four vertices across a line: nothing, full, full, nothing. */
static void put_across(
	struct canvas_vertex *out, struct vec2 at, struct vec2 side, float half, const uint8_t color[4], bool solid)
{
	const float reach[4] = { -half - 0.5f, -half + 0.5f, half - 0.5f, half + 0.5f };
	for (int i = 0; i < 4; i++)
		put(&out[i], at.x + side.x * reach[i], at.y + side.y * reach[i], color, solid && (i == 1 || i == 2));
}

static void join_across(struct canvas *canvas, uint32_t a, uint32_t b)
{
	for (uint32_t i = 0; i < 3; i++)
		add_quad(canvas, a + i, b + i, b + i + 1, a + i + 1);
}

void canvas_arc(struct canvas *canvas, struct vec2 center, float radius, float width, float start_rad, float sweep_rad,
	struct rgba color)
{
	uint32_t first, count = segments(radius + width, sweep_rad);
	struct canvas_vertex *out = take(canvas, CANVAS_SHAPES, 4 * (count + 1), 18 * count, &first);
	if (!out)
		return;
	uint8_t rgba[4];
	canvas_color(rgba, color);
	for (uint32_t i = 0; i <= count; i++) {
		float angle = start_rad + sweep_rad * (float)i / (float)count;
		struct vec2 side = { sinf(angle), -cosf(angle) };
		struct vec2 at = { center.x + side.x * radius, center.y + side.y * radius };
		put_across(out + 4 * i, at, side, width / 2.0f, rgba, true);
	}
	for (uint32_t i = 0; i < count; i++)
		join_across(canvas, first + 4 * i, first + 4 * (i + 1));
}

/* One fringe pixel beyond each flat end. */
void canvas_stroke(struct canvas *canvas, const struct vec2 *points, uint32_t count, float width, struct rgba color)
{
	uint32_t first;
	assert(count >= 2);
	struct canvas_vertex *out = take(canvas, CANVAS_SHAPES, 4 * (count + 2), 18 * (count + 1), &first);
	if (!out)
		return;
	uint8_t rgba[4];
	canvas_color(rgba, color);
	struct vec2 head = unit(points[1].x - points[0].x, points[1].y - points[0].y);
	struct vec2 tail = unit(points[count - 1].x - points[count - 2].x, points[count - 1].y - points[count - 2].y);
	struct vec2 start = { points[0].x - head.x, points[0].y - head.y };
	struct vec2 end = { points[count - 1].x + tail.x, points[count - 1].y + tail.y };
	for (uint32_t i = 0; i < count + 2; i++) {
		bool solid = i > 0 && i <= count;
		struct vec2 at = i == 0 ? start : i > count ? end : points[i - 1];
		struct vec2 side = i <= 1       ? (struct vec2){ head.y, -head.x }
						   : i >= count ? (struct vec2){ tail.y, -tail.x }
										: mitre(points[i - 2], at, points[i]);
		put_across(out + 4 * i, at, side, width / 2.0f, rgba, solid);
	}
	for (uint32_t i = 0; i <= count; i++)
		join_across(canvas, first + 4 * i, first + 4 * (i + 1));
}

void canvas_glyph(
	struct canvas *canvas, const struct vec2 corners[4], const struct box *uv, const struct canvas_vertex *shape)
{
	uint32_t first;
	struct canvas_vertex *out = take(canvas, CANVAS_GLYPHS, 4, 6, &first);
	if (!out)
		return;
	const float u[4] = { uv->x0, uv->x1, uv->x1, uv->x0 }, v[4] = { uv->y0, uv->y0, uv->y1, uv->y1 };
	for (int i = 0; i < 4; i++) {
		out[i] = *shape;
		out[i].x = corners[i].x;
		out[i].y = corners[i].y;
		out[i].u = u[i];
		out[i].v = v[i];
	}
	add_quad(canvas, first, first + 1, first + 2, first + 3);
}

/* Half the size, by means of four. */
static void halve(const uint8_t *from, uint32_t width, uint32_t height, uint8_t *to)
{
	uint32_t w = width > 1 ? width / 2 : 1, h = height > 1 ? height / 2 : 1;
	for (uint32_t y = 0; y < h; y++) {
		for (uint32_t x = 0; x < w; x++) {
			uint32_t x1 = 2 * x + 1 < width ? 2 * x + 1 : 2 * x, y1 = 2 * y + 1 < height ? 2 * y + 1 : 2 * y;
			uint32_t sum = (uint32_t)from[2 * y * width + 2 * x] + from[2 * y * width + x1] + from[y1 * width + 2 * x] +
						   from[y1 * width + x1];
			to[y * w + x] = (uint8_t)((sum + 2) / 4);
		}
	}
}

/* Small screens draw text at a third of the atlas' size: two smaller levels keep thin strokes whole. */
#define ATLAS_LEVELS 3u

static int upload_atlas(struct canvas *canvas, struct arena *arena, const struct pkg *pkg)
{
	uint32_t width = pkg->font->atlas_width, height = pkg->font->atlas_height;
	struct gfx_texture_desc desc = {
		.format = GFX_R8,
		.width = width,
		.height = height,
		.levels = width >= 4 && height >= 4 ? ATLAS_LEVELS : 1,
		.filter = GFX_TRILINEAR,
		.wrap = GFX_CLAMP,
	};
	int status = gfx_texture_create(canvas->gfx, &desc, &canvas->atlas);
	if (status < 0)
		return status;
	size_t mark = arena_mark(arena);
	uint8_t *levels = ARENA_ARRAY(arena, uint8_t, (size_t)width * height / 2 + 16);
	if (!levels)
		return -ENOMEM;
	const uint8_t *from = pkg->font_atlas;
	for (uint32_t level = 0; level < desc.levels; level++) {
		struct gfx_region region = { .level = level, .width = width, .height = height, .layers = 1 };
		gfx_texture_write(canvas->gfx, canvas->atlas, &region, from);
		halve(from, width, height, levels);
		from = levels;
		width /= 2;
		height /= 2;
		levels += (size_t)width * height;
	}
	arena_release(arena, mark);
	return 0;
}

static int create_pipeline(struct canvas *canvas, enum canvas_kind kind)
{
	struct gfx_program_desc program = {
		.vertex = "text.vert",
		.fragment = "text.frag",
		.textures = { kind == CANVAS_GLYPHS ? "u_atlas" : NULL },
		.defines = kind == CANVAS_GLYPHS ? "#define NO_FRAME_BLOCK 1\n" : "#define NO_FRAME_BLOCK 1\n#define SHAPE 1\n",
	};
	int status = gfx_program_create(canvas->gfx, &program, &canvas->programs[kind]);
	if (status < 0)
		return status;
	struct gfx_pipeline_desc pipeline = {
		.program = canvas->programs[kind],
		.stride = sizeof(struct canvas_vertex),
		.attribute_count = 5,
		.attributes = { { GFX_F32X2, offsetof(struct canvas_vertex, x) },
			{ GFX_F32X2, offsetof(struct canvas_vertex, u) }, { GFX_U8X4_UNORM, offsetof(struct canvas_vertex, fill) },
			{ GFX_U8X4_UNORM, offsetof(struct canvas_vertex, halo) },
			{ GFX_F32X3, offsetof(struct canvas_vertex, range_px) } },
		.primitive = GFX_TRIANGLES,
		.index = GFX_INDEX_U16,
		.blend = GFX_PREMULTIPLIED,
		.depth = GFX_DEPTH_OFF,
	};
	return gfx_pipeline_create(canvas->gfx, &pipeline, &canvas->pipelines[kind]);
}

static int create_buffers(struct canvas *canvas)
{
	struct gfx_buffer_desc vertices = {
		.kind = GFX_BUFFER_VERTEX,
		.usage = GFX_STREAM,
		.bytes = canvas->vertex_capacity * (uint32_t)sizeof(struct canvas_vertex),
	};
	struct gfx_buffer_desc indices = {
		.kind = GFX_BUFFER_INDEX,
		.usage = GFX_STREAM,
		.bytes = canvas->index_capacity * (uint32_t)sizeof(uint16_t),
	};
	int status = gfx_buffer_create(canvas->gfx, &vertices, &canvas->vertex_buffer);
	return status < 0 ? status : gfx_buffer_create(canvas->gfx, &indices, &canvas->index_buffer);
}

/* Without a font the one texel says "outside". */
static int create_blank_atlas(struct canvas *canvas)
{
	struct gfx_texture_desc desc = { .format = GFX_R8, .width = 1, .height = 1, .filter = GFX_NEAREST };
	int status = gfx_texture_create(canvas->gfx, &desc, &canvas->atlas);
	if (status == 0)
		gfx_texture_write(canvas->gfx, canvas->atlas, &(struct gfx_region){ .width = 1, .height = 1, .layers = 1 },
			(uint8_t[4]){ 0 });
	return status;
}

int canvas_init(struct canvas *canvas, struct arena *arena, struct gfx *gfx, const struct pkg *pkg, uint32_t vertices)
{
	*canvas = (struct canvas){ .gfx = gfx, .vertex_capacity = vertices ? vertices : DEFAULT_VERTICES };
	assert(canvas->vertex_capacity <= 65536);
	canvas->index_capacity = canvas->vertex_capacity * INDICES_PER_VERTEX;
	canvas->vertices = ARENA_ARRAY(arena, struct canvas_vertex, canvas->vertex_capacity);
	canvas->indices = ARENA_ARRAY(arena, uint16_t, canvas->index_capacity);
	if (!canvas->vertices || !canvas->indices)
		return -ENOMEM;
	if (!gfx)
		return 0;
	int status = create_pipeline(canvas, CANVAS_SHAPES);
	if (status == 0)
		status = create_pipeline(canvas, CANVAS_GLYPHS);
	if (status == 0)
		status = create_buffers(canvas);
	if (status == 0)
		status = pkg->font ? upload_atlas(canvas, arena, pkg) : create_blank_atlas(canvas);
	if (status < 0)
		canvas_finish(canvas);
	return status;
}

void canvas_finish(struct canvas *canvas)
{
	if (canvas->gfx) {
		gfx_texture_destroy(canvas->gfx, canvas->atlas);
		gfx_buffer_destroy(canvas->gfx, canvas->index_buffer);
		gfx_buffer_destroy(canvas->gfx, canvas->vertex_buffer);
		for (int kind = 0; kind < CANVAS_KIND_COUNT; kind++) {
			gfx_pipeline_destroy(canvas->gfx, canvas->pipelines[kind]);
			gfx_program_destroy(canvas->gfx, canvas->programs[kind]);
		}
	}
	*canvas = (struct canvas){ 0 };
}

void canvas_begin(struct canvas *canvas, uint32_t width, uint32_t height)
{
	canvas->vertex_count = canvas->index_count = canvas->run_count = 0;
	canvas->width = (float)width;
	canvas->height = (float)height;
}

void canvas_upload(struct canvas *canvas)
{
	if (!canvas->gfx || !canvas->index_count)
		return;
	gfx_buffer_write(canvas->gfx, canvas->vertex_buffer, 0, canvas->vertices,
		canvas->vertex_count * (uint32_t)sizeof(struct canvas_vertex));
	gfx_buffer_write(
		canvas->gfx, canvas->index_buffer, 0, canvas->indices, canvas->index_count * (uint32_t)sizeof(uint16_t));
}

void canvas_draw(const struct canvas *canvas)
{
	if (!canvas->gfx || !canvas->index_count)
		return;
	const float to_clip[4] = { 2.0f / canvas->width, -2.0f / canvas->height, -1.0f, 1.0f };
	struct gfx_draw draw = {
		.vertices = canvas->vertex_buffer,
		.indices = canvas->index_buffer,
		.constants = to_clip,
		.constant_count = 1,
	};
	for (uint32_t i = 0; i < canvas->run_count; i++) {
		const struct canvas_run *run = &canvas->runs[i];
		draw.pipeline = canvas->pipelines[run->kind];
		draw.textures[0] = run->kind == CANVAS_GLYPHS ? canvas->atlas : (gfx_texture){ 0 };
		draw.first = run->first_index;
		draw.count = (i + 1 < canvas->run_count ? run[1].first_index : canvas->index_count) - run->first_index;
		gfx_draw(canvas->gfx, &draw);
	}
}
