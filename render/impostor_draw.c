/*
 * Depth offsets: local triangles lie in front of an impostor's where both show the same surface, and so does an
 * impostor that dissolves of the one that takes its place, which is whole from the start: so no pixel is ever empty.
 */
#include "render/impostor_draw.h"

#include "render/surfaces.h"

/* u_draw of impostor.vert. */
struct impostor_constants {
	float origin_mm[3], first_layer;
	struct mat4 clip_from_mm;
	float light_map[4];
	float share, unused[3];
};
static_assert(sizeof(struct impostor_constants) == 7 * 4 * sizeof(float), "u_draw[7]");

static const struct gfx_attribute vertex_layout[] = {
	{ GFX_I32X3, offsetof(struct pkg_impostor_vertex, pos_mm) },
	{ GFX_U16X2, offsetof(struct pkg_impostor_vertex, uv) },
	{ GFX_U8X2, offsetof(struct pkg_impostor_vertex, page) },
	{ GFX_I8X2_SNORM, offsetof(struct pkg_impostor_vertex, normal_oct) },
};
static_assert(
	offsetof(struct pkg_impostor_vertex, view_kind) == offsetof(struct pkg_impostor_vertex, page) + 1, "one attribute");

#define LIT "#define LIT 1\n"
#define DISSOLVE "#define DISSOLVE 1\n"
#define TINT "#define TINT 1\n"
static const char *const defines[2][IMPOSTOR_STYLES] = {
	{ "", LIT, DISSOLVE, LIT DISSOLVE },
	{ TINT, TINT LIT, TINT DISSOLVE, TINT LIT DISSOLVE },
};

static int make_style(struct impostor_draw *draw, int style, bool tinted)
{
	struct gfx_program_desc program = {
		.vertex = "impostor.vert",
		.fragment = "impostor.frag",
		.defines = defines[tinted][style],
		.textures = { "u_pages", "u_light_map" },
		.blocks = { "Frame", "Impostor" },
	};
	int err = gfx_program_create(draw->gfx, &program, &draw->programs[style]);
	if (err)
		return err;
	bool dissolving = style & IMPOSTOR_DISSOLVING;
	struct gfx_pipeline_desc pipeline = {
		.program = draw->programs[style],
		.stride = sizeof(struct pkg_impostor_vertex),
		.attribute_count = sizeof(vertex_layout) / sizeof(vertex_layout[0]),
		.index = GFX_INDEX_U16,
		.depth = GFX_DEPTH_TEST_WRITE,
		.offset_factor = dissolving ? 0.5f : 1.0f,
		.offset_units = dissolving ? 4.0f : 16.0f,
	};
	for (uint32_t i = 0; i < pipeline.attribute_count; i++)
		pipeline.attributes[i] = vertex_layout[i];
	return gfx_pipeline_create(draw->gfx, &pipeline, &draw->pipelines[style]);
}

static int make_wire(struct impostor_draw *draw)
{
	struct gfx_program_desc program = {
		.vertex = "impostor.vert",
		.fragment = "impostor.frag",
		.defines = "#define WIRE 1\n",
		.blocks = { "Frame", "Impostor" },
	};
	int err = gfx_program_create(draw->gfx, &program, &draw->wire_program);
	if (err)
		return err;
	struct gfx_pipeline_desc pipeline = { .program = draw->wire_program,
		.stride = sizeof(struct pkg_impostor_vertex),
		.attribute_count = sizeof(vertex_layout) / sizeof(vertex_layout[0]),
		.primitive = GFX_LINES,
		.index = GFX_INDEX_U16,
		.depth = GFX_DEPTH_TEST };
	for (uint32_t i = 0; i < pipeline.attribute_count; i++)
		pipeline.attributes[i] = vertex_layout[i];
	return gfx_pipeline_create(draw->gfx, &pipeline, &draw->wire);
}

int impostor_draw_init(struct impostor_draw *draw, struct gfx *gfx, bool tinted, bool wire)
{
	*draw = (struct impostor_draw){ .gfx = gfx };
	int err = 0;
	for (int style = 0; style < IMPOSTOR_STYLES && !err; style++)
		err = make_style(draw, style, tinted);
	return err || !wire ? err : make_wire(draw);
}

void impostor_draw_finish(struct impostor_draw *draw)
{
	if (!draw->gfx)
		return;
	gfx_pipeline_destroy(draw->gfx, draw->wire);
	gfx_program_destroy(draw->gfx, draw->wire_program);
	for (int style = 0; style < IMPOSTOR_STYLES; style++) {
		gfx_pipeline_destroy(draw->gfx, draw->pipelines[style]);
		gfx_program_destroy(draw->gfx, draw->programs[style]);
	}
	*draw = (struct impostor_draw){ 0 };
}

static struct mat4 from_mm(const struct mat4 *from_m)
{
	struct mat4 out = *from_m;
	for (int i = 0; i < 12; i++)
		out.m[i] *= 0.001f;
	return out;
}

void impostor_draw(const struct impostor_draw *draw, const struct cell_store *store, const struct near_mesh *mesh,
	const struct view *view, const struct impostor_shown *shown, gfx_buffer frame_block)
{
	const struct stored_impostor *impostor = shown->impostor;
	if (!impostor->index_count)
		return;
	struct impostor_constants constants = { .first_layer = (float)impostor->first_layer, .share = shown->share };
	for (int axis = 0; axis < 3; axis++)
		constants.origin_mm[axis] = (float)(shown->origin_mm[axis] - view->eye_mm[axis]);
	surfaces_light_map_frame(store->pkg, view->eye_mm, constants.light_map);
	int style = (mesh->lit ? IMPOSTOR_LIT : 0) | (shown->share < 1.0f ? IMPOSTOR_DISSOLVING : 0);
	struct gfx_draw item = {
		.vertices = store->impostor_vertices,
		.vertex_offset = impostor->first_vertex * (uint32_t)sizeof(struct pkg_impostor_vertex),
		.textures = { store->pages, mesh->light_map },
		.blocks = { frame_block, impostor->block },
		.constants = (const float *)&constants,
		.constant_count = sizeof(constants) / 16,
	};
	for (int slice = shown->near_slice ? VIEW_NEAR : VIEW_FAR; slice < VIEW_SLICE_COUNT; slice++) {
		gfx_depth_range(draw->gfx, view->slice[slice].depth_near, view->slice[slice].depth_far);
		constants.clip_from_mm = from_mm(&view->slice[slice].clip_from_eye);
		item.pipeline = draw->pipelines[style];
		item.indices = store->impostor_indices;
		item.first = impostor->first_index;
		item.count = impostor->index_count;
		gfx_draw(draw->gfx, &item);
		if (!draw->wire.id)
			continue;
		item.pipeline = draw->wire;
		item.indices = store->impostor_lines;
		item.first *= 2;
		item.count *= 2;
		gfx_draw(draw->gfx, &item);
	}
}
