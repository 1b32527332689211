/*
 * Captures by our own GL, without a screen. A capture is two drawings: one at the pixels' centres, which decides what
 * each pixel is, and when colour is asked for one at twice the resolution, for its mean. The GPU writes the triangle's
 * number; all that follows from it is looked up or worked out afterwards (capture_pixels.c).
 */
#include "tools/impostor/capture.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/log.h"
#include "platform/display/display.h"
#include "render/light_tiles.h"
#include "render/surfaces.h"
#include "tools/impostor/capture_batch.h"
#include "tools/impostor/capture_pixels.h"

#define ARENA_BYTES ((size_t)256 << 10) /* pools of the device */
#define SIZE_STEP 64u                   /* targets grow by */
#define FINE 2u                         /* samples of colour along a side of a pixel */

enum { SHAPE, COLOR, VARIANTS };              /* of the shaders */
enum { TARGET_PIXELS, TARGET_FINE, TARGETS }; /* one sample a pixel, and FINE * FINE */

struct draw_range {
	double nearest_m;
	uint32_t first, count, chunk; /* triangles */
};

struct capturer {
	const struct pkg *pkg;
	struct display display;
	struct arena arena;
	void *arena_memory;
	struct gfx *gfx;
	gfx_buffer materials, vertices;
	gfx_texture textures, light_map;
	gfx_program programs[VARIANTS];
	gfx_pipeline pipelines[VARIANTS][PKG_PASS_COUNT];
	gfx_target targets[TARGETS];
	uint32_t target_size[TARGETS][2];
	uint32_t *seen[TARGETS]; /* what was read back */
	uint8_t *rgba[TARGETS];
	uint32_t vertex_bytes; /* capacity */
	int error;             /* of capturer_use() */
	struct capture_batch batch;
	struct capture_planes planes;
	ARRAY(struct draw_range) ranges;
};

/* u_draw of capture.vert. */
struct capture_constants {
	float origin_mm[3], decals;
	struct mat4 clip_from_mm;
	float light_map[4];
};
static_assert(sizeof(struct capture_constants) == 6 * 4 * sizeof(float), "u_draw[6]");

static int make_pipeline(struct capturer *capturer, int variant, enum pkg_pass pass)
{
	bool decal = pass == PKG_PASS_DECAL;
	struct gfx_pipeline_desc desc = {
		.program = capturer->programs[variant],
		.stride = sizeof(struct pkg_mesh_vertex),
		.attribute_count = 5,
		.attributes = { { GFX_I32X3, offsetof(struct pkg_mesh_vertex, pos_mm) },
			{ GFX_I8X2_SNORM, offsetof(struct pkg_mesh_vertex, normal_oct) },
			{ GFX_U8X2, offsetof(struct pkg_mesh_vertex, ao) }, { GFX_U16X2, offsetof(struct pkg_mesh_vertex, uv) },
			{ GFX_U8X4_UNORM, offsetof(struct pkg_mesh_vertex, rgb) } },
		.blend = decal ? GFX_BLEND : GFX_OPAQUE,
		.depth = decal ? GFX_DEPTH_TEST : GFX_DEPTH_TEST_WRITE,
		.cull_back = true,
		.offset_factor = decal ? -1.0f : 0.0f,
		.offset_units = decal ? -16.0f : 0.0f,
	};
	return gfx_pipeline_create(capturer->gfx, &desc, &capturer->pipelines[variant][pass]);
}

static int make_programs(struct capturer *capturer)
{
	static const char *const defines[VARIANTS] = {
		[SHAPE] = "#define NO_FRAME_BLOCK 1\n", [COLOR] = "#define NO_FRAME_BLOCK 1\n#define COLOR 1\n"
	};
	int err = 0;
	for (int variant = 0; variant < VARIANTS && !err; variant++) {
		struct gfx_program_desc desc = { .vertex = "capture.vert",
			.fragment = "capture.frag",
			.defines = defines[variant],
			.textures = { "u_textures", "u_light_map" },
			.blocks = { "Materials" } };
		err = gfx_program_create(capturer->gfx, &desc, &capturer->programs[variant]);
		for (int pass = 0; pass < PKG_PASS_COUNT && !err; pass++)
			err = make_pipeline(capturer, variant, (enum pkg_pass)pass);
	}
	return err;
}

static int make_objects(struct capturer *capturer)
{
	struct gfx_config config = { .get_proc = display_get_proc };
	arena_init(&capturer->arena, "capture", capturer->arena_memory, ARENA_BYTES);
	int err = gfx_init(&capturer->gfx, &capturer->arena, &gfx_gles3, &config);
	if (!err)
		err = surfaces_make(capturer->gfx, capturer->pkg, &capturer->materials, &capturer->textures);
	struct surface_layers layers = { 0 };
	struct light_tiles light = { 0 };
	if (!err)
		err = light_tiles_make(capturer->gfx, capturer->pkg, &light, &capturer->light_map);
	while (!err && surfaces_load_next(capturer->gfx, capturer->pkg, capturer->textures, &layers))
		;
	while (!err && light_tiles_load_next(capturer->gfx, capturer->pkg, capturer->light_map, &light))
		;
	if (!err)
		err = make_programs(capturer);
	if (err)
		log_error("capture: cannot start: %s", strerror(-err));
	return err;
}

int capturer_open(struct capturer **out, const struct pkg *pkg)
{
	*out = NULL;
	struct capturer *capturer = calloc(1, sizeof(*capturer));
	void *memory = malloc(ARENA_BYTES);
	if (!capturer || !memory) {
		free(capturer);
		free(memory);
		return -ENOMEM;
	}
	capturer->pkg = pkg;
	capturer->arena_memory = memory;
	int err = display_open(&capturer->display, &display_surfaceless, &(struct display_config){ 0 });
	if (!err)
		err = make_objects(capturer);
	if (err)
		capturer_close(capturer);
	else
		*out = capturer;
	return err;
}

void capturer_close(struct capturer *capturer)
{
	if (!capturer)
		return;
	if (capturer->gfx)
		display_use(&capturer->display);
	gfx_finish(capturer->gfx);
	display_close(&capturer->display);
	for (int i = 0; i < TARGETS; i++) {
		free(capturer->seen[i]);
		free(capturer->rgba[i]);
	}
	capture_batch_finish(&capturer->batch);
	ARRAY_FINISH(&capturer->planes.items);
	ARRAY_FINISH(&capturer->ranges);
	free(capturer->arena_memory);
	free(capturer);
}

/* Makes a larger buffer when the batch does not fit into the one there is. */
static int hold_vertices(struct capturer *capturer, uint64_t bytes)
{
	if (bytes <= capturer->vertex_bytes)
		return 0;
	if (bytes > UINT32_MAX)
		return -E2BIG;
	uint64_t wanted = bytes + bytes / 2 < UINT32_MAX ? bytes + bytes / 2 : bytes;
	struct gfx_buffer_desc desc = { .kind = GFX_BUFFER_VERTEX, .bytes = (uint32_t)wanted };
	gfx_buffer_destroy(capturer->gfx, capturer->vertices);
	capturer->vertex_bytes = 0;
	int err = gfx_buffer_create(capturer->gfx, &desc, &capturer->vertices);
	if (!err)
		capturer->vertex_bytes = desc.bytes;
	return err;
}

void capturer_use(struct capturer *capturer, const struct triangle_set *set)
{
	capture_batch_fill(&capturer->batch, capturer->pkg, set);
	uint64_t bytes = (uint64_t)capturer->batch.vertices.count * sizeof(struct pkg_mesh_vertex);
	capturer->error = display_use(&capturer->display);
	if (!capturer->error)
		capturer->error = hold_vertices(capturer, bytes);
	if (!capturer->error && bytes)
		gfx_buffer_write(capturer->gfx, capturer->vertices, 0, capturer->batch.vertices.items, (uint32_t)bytes);
	/* planes of other triangles are no longer true */
	capturer->planes.drawing++;
}

static int hold_target(struct capturer *capturer, int target, uint32_t width, uint32_t height)
{
	uint32_t *size = capturer->target_size[target];
	if (width > size[0] || height > size[1]) {
		uint32_t wide = width > size[0] ? width : size[0], high = height > size[1] ? height : size[1];
		uint32_t most = gfx_caps(capturer->gfx)->max_texture_px;
		struct gfx_target_desc desc = { .width = (wide + SIZE_STEP - 1) / SIZE_STEP * SIZE_STEP,
			.height = (high + SIZE_STEP - 1) / SIZE_STEP * SIZE_STEP,
			.ids = GFX_IDS_R32UI };
		if (desc.width > most || desc.height > most)
			return -E2BIG;
		gfx_target_destroy(capturer->gfx, capturer->targets[target]);
		size[0] = size[1] = 0;
		free(capturer->seen[target]);
		free(capturer->rgba[target]);
		capturer->seen[target] = malloc((size_t)desc.width * desc.height * 4);
		capturer->rgba[target] = malloc((size_t)desc.width * desc.height * 4);
		int err = gfx_target_create(capturer->gfx, &desc, &capturer->targets[target]);
		if (err || !capturer->seen[target] || !capturer->rgba[target])
			return -ENOMEM;
		size[0] = desc.width;
		size[1] = desc.height;
	}
	gfx_target_part(capturer->gfx, capturer->targets[target], width, height);
	return 0;
}

static struct dvec3 combine(struct dvec3 a, double s, struct dvec3 b, double t)
{
	return (struct dvec3){ a.x * s + b.x * t, a.y * s + b.y * t, a.z * s + b.z * t };
}

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static void put_row(struct mat4 *m, int row, struct dvec3 direction, struct dvec3 rest_m, double constant)
{
	m->m[row] = (float)(direction.x * 1e-3);
	m->m[4 + row] = (float)(direction.y * 1e-3);
	m->m[8 + row] = (float)(direction.z * 1e-3);
	m->m[12 + row] = (float)(constant - dot(direction, rest_m));
}

/* From millimetres from `eye_mm`, which are whole, to clip space; the eye itself is `rest_m` beside that. */
static struct mat4 clip_from_mm(const struct capture_view *view, struct dvec3 rest_m)
{
	double w = view->width, h = view->height, focal = view->focal_px;
	double range = view->far_m - view->near_m;
	struct mat4 out;
	put_row(&out, 0, combine(view->right, 2.0 * focal / w, view->forward, 2.0 * view->centre_x / w - 1.0), rest_m, 0.0);
	put_row(&out, 1, combine(view->up, 2.0 * focal / h, view->forward, 1.0 - 2.0 * view->centre_y / h), rest_m, 0.0);
	put_row(&out, 2, combine(view->forward, (view->far_m + view->near_m) / range, view->forward, 0.0), rest_m,
		-2.0 * view->far_m * view->near_m / range);
	put_row(&out, 3, view->forward, rest_m, 0.0);
	return out;
}

/* Largest value of a linear function over an object's box, seen from the eye. */
static double most(const struct pkg_object *object, struct dvec3 eye, struct dvec3 direction)
{
	double x = (direction.x > 0.0 ? object->max_mm[0] : object->min_mm[0]) * 1e-3 - eye.x;
	double y = (direction.y > 0.0 ? object->max_mm[1] : object->min_mm[1]) * 1e-3 - eye.y;
	double z = (direction.z > 0.0 ? object->max_mm[2] : object->min_mm[2]) * 1e-3 - eye.z;
	return direction.x * x + direction.y * y + direction.z * z;
}

static bool in_view(const struct pkg_object *object, const struct capture_view *view, double *nearest_m)
{
	const struct dvec3 sides[4] = {
		combine(view->right, view->focal_px, view->forward, view->centre_x),
		combine(view->right, -view->focal_px, view->forward, view->width - view->centre_x),
		combine(view->up, -view->focal_px, view->forward, view->centre_y),
		combine(view->up, view->focal_px, view->forward, view->height - view->centre_y),
	};
	for (int i = 0; i < 4; i++)
		if (most(object, view->eye, sides[i]) < 0.0)
			return false;
	struct dvec3 back = { -view->forward.x, -view->forward.y, -view->forward.z };
	*nearest_m = -most(object, view->eye, back);
	return *nearest_m <= view->far_m && most(object, view->eye, view->forward) >= view->near_m;
}

static int by_depth(const void *a, const void *b)
{
	const struct draw_range *x = a, *y = b;
	if (x->nearest_m < y->nearest_m || x->nearest_m > y->nearest_m)
		return x->nearest_m < y->nearest_m ? -1 : 1;
	return (x->first > y->first) - (x->first < y->first);
}

/* What of a pass is in view, nearest first; neighbours of one chunk go together. */
static void find_ranges(struct capturer *capturer, const struct capture_view *view, int pass)
{
	const struct capture_batch *batch = &capturer->batch;
	capturer->ranges.count = 0;
	for (size_t i = batch->first_range[pass]; i < batch->first_range[pass + 1]; i++) {
		const struct capture_range *range = &batch->ranges.items[i];
		const struct pkg_object *object = &capturer->pkg->objects[range->object];
		double nearest_m;
		if (!in_view(object, view, &nearest_m))
			continue;
		struct draw_range *last = NULL;
		if (capturer->ranges.count)
			last = &capturer->ranges.items[capturer->ranges.count - 1];
		if (last && last->chunk == object->chunk && last->first + last->count == range->first) {
			last->count += range->count;
			last->nearest_m = fmin(last->nearest_m, nearest_m);
		} else {
			ARRAY_PUSH(&capturer->ranges, (struct draw_range){ nearest_m, range->first, range->count, object->chunk });
		}
	}
	ARRAY_SORT(&capturer->ranges, by_depth);
}

static void draw_ranges(
	struct capturer *capturer, int variant, int pass, const int64_t eye_mm[3], struct capture_constants *constants)
{
	struct gfx_draw draw = {
		.pipeline = capturer->pipelines[variant][pass],
		.vertices = capturer->vertices,
		.textures = { capturer->textures, capturer->light_map },
		.blocks = { capturer->materials },
		.constants = (const float *)constants,
		.constant_count = sizeof(*constants) / 16,
	};
	constants->decals = pass == PKG_PASS_DECAL ? 1.0f : 0.0f;
	for (size_t i = 0; i < capturer->ranges.count; i++) {
		const struct draw_range *range = &capturer->ranges.items[i];
		for (int axis = 0; axis < 3; axis++)
			constants->origin_mm[axis] = (float)(capturer->pkg->chunks[range->chunk].origin_mm[axis] - eye_mm[axis]);
		draw.first = range->first * 3;
		draw.count = range->count * 3;
		gfx_draw(capturer->gfx, &draw);
	}
}

static int draw_into(struct capturer *capturer, const struct capture_view *view, int target, int variant)
{
	uint32_t scale = target == TARGET_FINE ? FINE : 1;
	int err = hold_target(capturer, target, view->width * scale, view->height * scale);
	if (err)
		return err;
	int64_t eye_mm[3] = { llrint(view->eye.x * 1e3), llrint(view->eye.y * 1e3), llrint(view->eye.z * 1e3) };
	struct dvec3 rest_m = { view->eye.x - (double)eye_mm[0] * 1e-3, view->eye.y - (double)eye_mm[1] * 1e-3,
		view->eye.z - (double)eye_mm[2] * 1e-3 };
	struct capture_constants constants = { .clip_from_mm = clip_from_mm(view, rest_m) };
	surfaces_light_map_frame(capturer->pkg, eye_mm, constants.light_map);
	gfx_frame_begin(capturer->gfx);
	gfx_pass_begin(capturer->gfx, capturer->targets[target], &(struct gfx_clear){ .color = true, .depth = true });
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++) {
		find_ranges(capturer, view, pass);
		draw_ranges(capturer, variant, pass, eye_mm, &constants);
	}
	gfx_pass_end(capturer->gfx);
	gfx_read_ids(capturer->gfx, capturer->targets[target], capturer->seen[target]);
	if (variant == COLOR)
		gfx_read_rgba8(capturer->gfx, capturer->targets[target], capturer->rgba[target]);
	return 0;
}

static int hold_image(struct capture_image *image, const struct capture_view *view, bool color)
{
	size_t pixels = (size_t)view->width * view->height;
	size_t had = (size_t)image->view.width * image->view.height;
	if (pixels != had)
		capture_image_finish(image);
	if (!color) {
		free(image->rgba);
		image->rgba = NULL;
	}
	image->view = *view;
	if (!image->pixels)
		image->pixels = malloc(pixels * sizeof(*image->pixels));
	if (!image->rgba && color)
		image->rgba = malloc(pixels * 4);
	return image->pixels && (image->rgba || !color) ? 0 : -ENOMEM;
}

int capturer_draw(struct capturer *capturer, const struct capture_view *view, bool color, struct capture_image *out)
{
	int err = capturer->error;
	if (!err && (!view->width || !view->height))
		err = -EINVAL;
	if (!err)
		err = display_use(&capturer->display);
	if (!err)
		err = hold_image(out, view, color);
	if (!err)
		err = draw_into(capturer, view, TARGET_PIXELS, color ? COLOR : SHAPE);
	if (!err && color)
		err = draw_into(capturer, view, TARGET_FINE, COLOR);
	if (err) {
		log_error("capture of %u x %u: %s", view->width, view->height, strerror(-err));
		return err;
	}
	capture_pixels_fill(capturer->pkg, &capturer->batch, &capturer->planes, capturer->seen[TARGET_PIXELS],
		color ? capturer->rgba[TARGET_PIXELS] : NULL, out);
	if (color)
		capture_pixels_color(&capturer->batch, capturer->seen[TARGET_PIXELS], capturer->rgba[TARGET_PIXELS],
			capturer->seen[TARGET_FINE], capturer->rgba[TARGET_FINE], out);
	return 0;
}
