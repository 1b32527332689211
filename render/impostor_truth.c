#include "render/impostor_truth.h"

#include <errno.h>
#include <stddef.h>

#include "platform/base/log.h"

/* u_draw of impostor_truth.vert. */
struct truth_constants {
	float origin_mm[3], first_layer;
	struct mat4 clip_from_mm;
	float first_truth, unused[3];
};
static_assert(sizeof(struct truth_constants) == 6 * 4 * sizeof(float), "u_draw[6]");

#define PAGE_TEXELS (PKG_PAGE_PX * PKG_PAGE_PX)

static uint32_t most_pages(const struct pkg *pkg)
{
	uint32_t most = 0;
	for (uint32_t i = 0; i < pkg->stretch_count * 2; i++)
		if (pkg->cells[i].truth.stored_bytes && pkg->cells[i].page_count > most)
			most = pkg->cells[i].page_count;
	return most;
}

static int make_pipeline(struct impostor_truth *truth)
{
	struct gfx_program_desc program = {
		.vertex = "impostor_truth.vert",
		.fragment = "impostor_truth.frag",
		.defines = "#define NO_FRAME_BLOCK 1\n",
		.textures = { "u_pages", "u_truth" },
		.blocks = { "Impostor" },
	};
	int err = gfx_program_create(truth->gfx, &program, &truth->program);
	if (err)
		return err;
	struct gfx_pipeline_desc pipeline = { .program = truth->program,
		.stride = sizeof(struct pkg_impostor_vertex),
		.attribute_count = 3,
		.attributes = { { GFX_I32X3, offsetof(struct pkg_impostor_vertex, pos_mm) },
			{ GFX_U16X2, offsetof(struct pkg_impostor_vertex, uv) },
			{ GFX_U8X2, offsetof(struct pkg_impostor_vertex, page) } },
		.index = GFX_INDEX_U16,
		.depth = GFX_DEPTH_TEST_WRITE,
		.offset_factor = 1.0f,
		.offset_units = 16.0f };
	return gfx_pipeline_create(truth->gfx, &pipeline, &truth->pipeline);
}

int impostor_truth_init(struct impostor_truth *truth, struct arena *arena, struct gfx *gfx, const struct pkg *pkg)
{
	*truth = (struct impostor_truth){ .gfx = gfx, .pkg = pkg, .cell = PKG_NONE };
	uint32_t pages = most_pages(pkg);
	if (!pages)
		return 0;
	truth->texel_bytes = (uint64_t)pages * PAGE_TEXELS * sizeof(struct pkg_truth_texel);
	truth->texels = arena_alloc(arena, truth->texel_bytes, 64);
	if (!truth->texels || blob_reader_init(&truth->reader, arena))
		return -ENOMEM;
	struct gfx_texture_desc desc = {
		.format = GFX_RGBA32UI, .width = PKG_PAGE_PX, .height = PKG_PAGE_PX, .layers = pages, .filter = GFX_NEAREST
	};
	int err = gfx_texture_create(gfx, &desc, &truth->pages);
	return err ? err : make_pipeline(truth);
}

void impostor_truth_finish(struct impostor_truth *truth)
{
	if (!truth->gfx)
		return;
	gfx_pipeline_destroy(truth->gfx, truth->pipeline);
	gfx_program_destroy(truth->gfx, truth->program);
	gfx_texture_destroy(truth->gfx, truth->pages);
	*truth = (struct impostor_truth){ 0 };
}

/* Makes `pages` those of the cell. */
static bool load(struct impostor_truth *truth, uint32_t id)
{
	const struct pkg_cell *cell = &truth->pkg->cells[id];
	uint64_t bytes = (uint64_t)cell->page_count * PAGE_TEXELS * sizeof(struct pkg_truth_texel);
	if (truth->cell == id)
		return true;
	if (!cell->truth.stored_bytes || cell->truth.raw_bytes != bytes || bytes > truth->texel_bytes)
		return false;
	if (blob_read(truth->reader, truth->pkg, &cell->truth, truth->texels)) {
		log_error("cell %u: its truth texels are damaged", id);
		return false;
	}
	struct gfx_region region = { .width = PKG_PAGE_PX, .height = PKG_PAGE_PX, .layers = cell->page_count };
	gfx_texture_write(truth->gfx, truth->pages, &region, truth->texels);
	truth->cell = id;
	return true;
}

void impostor_truth_draw(struct impostor_truth *truth, const struct cell_store *store, const struct view *view,
	const struct impostor_shown *shown, uint32_t cell)
{
	const struct stored_impostor *impostor = shown->impostor;
	if (!impostor->index_count || !load(truth, cell))
		return;
	struct truth_constants constants = { .first_layer = (float)impostor->first_layer };
	for (int axis = 0; axis < 3; axis++)
		constants.origin_mm[axis] = (float)(shown->origin_mm[axis] - view->eye_mm[axis]);
	struct gfx_draw item = {
		.pipeline = truth->pipeline,
		.vertices = store->impostor_vertices,
		.vertex_offset = impostor->first_vertex * (uint32_t)sizeof(struct pkg_impostor_vertex),
		.indices = store->impostor_indices,
		.first = impostor->first_index,
		.count = impostor->index_count,
		.textures = { store->pages, truth->pages },
		.blocks = { impostor->block },
		.constants = (const float *)&constants,
		.constant_count = sizeof(constants) / 16,
	};
	for (int slice = shown->near_slice ? VIEW_NEAR : VIEW_FAR; slice < VIEW_SLICE_COUNT; slice++) {
		gfx_depth_range(truth->gfx, view->slice[slice].depth_near, view->slice[slice].depth_far);
		constants.clip_from_mm = view->slice[slice].clip_from_eye;
		for (int i = 0; i < 12; i++)
			constants.clip_from_mm.m[i] *= 0.001f;
		gfx_draw(truth->gfx, &item);
	}
}
