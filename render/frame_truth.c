/* The city's triangles with their object's number. Runs of the draw list are taken apart into their objects again. */
#include "render/frame_truth.h"

#include <stddef.h>

#include "render/submit.h"

/* u_draw of truth.vert. */
struct truth_constants {
	float origin_mm[4];
	struct mat4 clip_from_mm;
	float number[4];
};
static_assert(sizeof(struct truth_constants) == 6 * 4 * sizeof(float), "u_draw[6]");

static int make_pipeline(struct frame_truth *truth, enum pkg_pass pass)
{
	bool decal = pass == PKG_PASS_DECAL;
	struct gfx_pipeline_desc desc = {
		.program = truth->program,
		.stride = sizeof(struct pkg_mesh_vertex),
		.attribute_count = 1,
		.attributes = { { GFX_I32X3, offsetof(struct pkg_mesh_vertex, pos_mm) } },
		.index = GFX_INDEX_U16,
		.depth = decal ? GFX_DEPTH_TEST : GFX_DEPTH_TEST_WRITE,
		.cull_back = true,
		.offset_factor = decal ? -1.0f : 0.0f,
		.offset_units = decal ? -16.0f : 0.0f,
	};
	return gfx_pipeline_create(truth->gfx, &desc, &truth->pipelines[pass]);
}

int frame_truth_init(struct frame_truth *truth, struct gfx *gfx, uint32_t width, uint32_t height)
{
	*truth = (struct frame_truth){ .gfx = gfx };
	struct gfx_target_desc target = { .width = width, .height = height, .ids = GFX_IDS_RGBA32UI };
	struct gfx_program_desc program = {
		.vertex = "truth.vert", .fragment = "truth.frag", .defines = "#define NO_FRAME_BLOCK 1\n"
	};
	int err = gfx_target_create(gfx, &target, &truth->target);
	if (!err)
		err = gfx_program_create(gfx, &program, &truth->program);
	for (int pass = 0; pass < PKG_PASS_COUNT && !err; pass++)
		err = make_pipeline(truth, (enum pkg_pass)pass);
	return err;
}

void frame_truth_finish(struct frame_truth *truth)
{
	if (!truth->gfx)
		return;
	for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
		gfx_pipeline_destroy(truth->gfx, truth->pipelines[pass]);
	gfx_program_destroy(truth->gfx, truth->program);
	gfx_target_destroy(truth->gfx, truth->target);
	*truth = (struct frame_truth){ 0 };
}

void frame_truth_begin(const struct frame_truth *truth)
{
	struct gfx_clear clear = { .color = true, .depth = true };
	gfx_pass_begin(truth->gfx, truth->target, &clear);
}

void frame_truth_end(const struct frame_truth *truth)
{
	gfx_pass_end(truth->gfx);
}

void frame_truth_read(const struct frame_truth *truth, uint32_t *out)
{
	gfx_read_ids(truth->gfx, truth->target, out);
}

static void draw_range(const struct frame_truth *truth, struct gfx_draw *draw, struct truth_constants *constants,
	uint32_t number, uint32_t first, uint32_t end)
{
	if (end <= first)
		return;
	/* whole numbers up to 65,535 are floats that no GPU changes */
	constants->number[0] = (float)(number & 0xFFFF);
	constants->number[1] = (float)(number >> 16);
	draw->first = first;
	draw->count = end - first;
	gfx_draw(truth->gfx, draw);
}

/* `base` is the index that the item's ranges count from. */
static void draw_set_item(const struct frame_truth *truth, const struct draw_item *item, struct gfx_draw *draw,
	struct truth_constants *constants, uint32_t base)
{
	const struct cell_range *range = &item->set->cells->ranges[item->range];
	uint32_t end = item->first + item->count;
	for (uint32_t i = 0; i < range->part_count; i++) {
		const struct cell_part *part = &item->set->cells->parts[range->first_part + i];
		uint32_t first = part->first > item->first ? part->first : item->first;
		uint32_t stop = part->first + part->count < end ? part->first + part->count : end;
		if (first < stop)
			draw_range(truth, draw, constants, part->object + 1, base + first, base + stop);
	}
}

/* Objects follow one another in each pass of a chunk. What lies between them is of none. */
static void draw_chunk_item(const struct frame_truth *truth, const struct near_mesh *mesh, const struct draw_item *item,
	struct gfx_draw *draw, struct truth_constants *constants, uint32_t base)
{
	const struct pkg_chunk *chunk = &mesh->pkg->chunks[item->chunk];
	uint32_t at = item->first, end = item->first + item->count;
	for (uint32_t i = 0; i < chunk->object_count && at < end; i++) {
		uint32_t id = chunk->first_object + i;
		const struct pkg_object *object = &mesh->pkg->objects[id];
		uint32_t first = object->first_index[item->pass], stop = first + object->index_count[item->pass];
		if (stop <= at || first >= end)
			continue;
		draw_range(truth, draw, constants, TRUTH_UNKNOWN, base + at, base + first);
		at = first > at ? first : at;
		stop = stop < end ? stop : end;
		draw_range(truth, draw, constants, id + 1, base + at, base + stop);
		at = stop;
	}
	draw_range(truth, draw, constants, TRUTH_UNKNOWN, base + at, base + end);
}

static struct mat4 from_mm(const struct mat4 *from_m)
{
	struct mat4 out = *from_m;
	for (int i = 0; i < 12; i++)
		out.m[i] *= 0.001f;
	return out;
}

void frame_truth_draw_list(const struct frame_truth *truth, const struct near_mesh *mesh, const struct view *view,
	const struct draw_list *list)
{
	struct truth_constants constants = { 0 };
	struct gfx_draw draw = {
		.constants = (const float *)&constants,
		.constant_count = sizeof(constants) / 16,
	};
	for (uint32_t i = 0; i < list->count; i++) {
		const struct draw_item *item = &list->items[i];
		const struct view_slice *slice = &view->slice[item->slice];
		gfx_depth_range(truth->gfx, slice->depth_near, slice->depth_far);
		constants.clip_from_mm = from_mm(&slice->clip_from_eye);
		for (int axis = 0; axis < 3; axis++)
			constants.origin_mm[axis] = (float)(mesh->pkg->chunks[item->chunk].origin_mm[axis] - view->eye_mm[axis]);
		draw.pipeline = truth->pipelines[item->pass];
		submit_geometry(&draw, mesh, item);
		uint32_t base = draw.first - item->first;
		if (item->set)
			draw_set_item(truth, item, &draw, &constants, base);
		else
			draw_chunk_item(truth, mesh, item, &draw, &constants, base);
	}
}
