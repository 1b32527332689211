/* A GPU that is not there: accepts everything, draws nothing. Its pictures are black. */
#include <string.h>

#include "render/gfx_backend.h"

static int dummy_init(struct gfx *gfx, struct arena *arena)
{
	(void)arena;
	gfx->caps = (struct gfx_caps){
		.base_vertex = true, .max_samples = 4, .max_texture_px = 4096, .max_array_layers = 256, .renderer = "none"
	};
	return 0;
}

static void dummy_finish(struct gfx *gfx)
{
	(void)gfx;
}

static int dummy_buffer_create(struct gfx *gfx, struct gfx_buffer_slot *slot)
{
	(void)gfx;
	(void)slot;
	return 0;
}

static int dummy_texture_create(struct gfx *gfx, struct gfx_texture_slot *slot)
{
	(void)gfx;
	(void)slot;
	return 0;
}

static int dummy_texture_import(struct gfx *gfx, struct gfx_texture_slot *slot, void *image)
{
	(void)gfx;
	(void)slot;
	(void)image;
	return 0;
}

static int dummy_target_create(struct gfx *gfx, struct gfx_target_slot *slot, struct gfx_texture_slot *texture)
{
	(void)gfx;
	(void)slot;
	(void)texture;
	return 0;
}

static int dummy_target_refine(struct gfx *gfx, struct gfx_target_slot *slot)
{
	(void)gfx;
	(void)slot;
	return 0;
}

static int dummy_program_create(struct gfx *gfx, struct gfx_program_slot *slot)
{
	(void)gfx;
	slot->constants = 0;
	return 0;
}

static int dummy_pipeline_create(struct gfx *gfx, struct gfx_pipeline_slot *slot)
{
	(void)gfx;
	(void)slot;
	return 0;
}

static void dummy_buffer_destroy(struct gfx *gfx, struct gfx_buffer_slot *slot)
{
	(void)gfx;
	(void)slot;
}

static void dummy_texture_destroy(struct gfx *gfx, struct gfx_texture_slot *slot)
{
	(void)gfx;
	(void)slot;
}

static void dummy_target_destroy(struct gfx *gfx, struct gfx_target_slot *slot)
{
	(void)gfx;
	(void)slot;
}

static void dummy_program_destroy(struct gfx *gfx, struct gfx_program_slot *slot)
{
	(void)gfx;
	(void)slot;
}

static void dummy_pipeline_destroy(struct gfx *gfx, struct gfx_pipeline_slot *slot)
{
	(void)gfx;
	(void)slot;
}

static void dummy_buffer_write(
	struct gfx *gfx, struct gfx_buffer_slot *slot, uint32_t offset, const void *data, uint32_t bytes)
{
	(void)gfx;
	(void)slot;
	(void)offset;
	(void)data;
	(void)bytes;
}

static void dummy_texture_write(
	struct gfx *gfx, struct gfx_texture_slot *slot, const struct gfx_region *region, const void *texels)
{
	(void)gfx;
	(void)slot;
	(void)region;
	(void)texels;
}

static void dummy_pass_begin(struct gfx *gfx, struct gfx_target_slot *slot, const struct gfx_clear *clear)
{
	(void)gfx;
	(void)slot;
	(void)clear;
}

static void dummy_depth_range(struct gfx *gfx, float near_depth, float far_depth)
{
	(void)gfx;
	(void)near_depth;
	(void)far_depth;
}

/* Looks every handle up, so that a stale one is caught as it would be with GL. */
static void dummy_draw(struct gfx *gfx, const struct gfx_draw *draw)
{
	const struct gfx_pipeline_slot *pipeline = gfx_pipeline_at(gfx, draw->pipeline);
	gfx_program_at(gfx, pipeline->desc.program);
	if (draw->vertices.id)
		gfx_buffer_at(gfx, draw->vertices);
	if (pipeline->desc.index != GFX_INDEX_NONE)
		gfx_buffer_at(gfx, draw->indices);
	for (int i = 0; i < GFX_TEXTURES_MAX; i++)
		if (draw->textures[i].id)
			gfx_texture_at(gfx, draw->textures[i]);
	for (int i = 0; i < GFX_BLOCKS_MAX; i++)
		if (draw->blocks[i].id)
			gfx_buffer_at(gfx, draw->blocks[i]);
}

static void dummy_pass_end(struct gfx *gfx, struct gfx_target_slot *slot)
{
	(void)gfx;
	(void)slot;
}

static void dummy_present(struct gfx *gfx, struct gfx_target_slot *slot, uint32_t width, uint32_t height)
{
	(void)gfx;
	(void)slot;
	(void)width;
	(void)height;
}

static void dummy_window_begin(struct gfx *gfx, uint32_t width, uint32_t height)
{
	(void)gfx;
	(void)width;
	(void)height;
}

static void dummy_read_rgba8(struct gfx *gfx, struct gfx_target_slot *slot, void *out)
{
	(void)gfx;
	memset(out, 0, (size_t)slot->width * slot->height * 4);
}

static void dummy_read_ids(struct gfx *gfx, struct gfx_target_slot *slot, uint32_t *out)
{
	(void)gfx;
	memset(out, 0, (size_t)slot->width * slot->height * gfx_ids_words(slot->desc.ids) * sizeof(*out));
}

const struct gfx_ops gfx_dummy = {
	.name = "dummy",
	.init = dummy_init,
	.finish = dummy_finish,
	.buffer_create = dummy_buffer_create,
	.texture_create = dummy_texture_create,
	.texture_import = dummy_texture_import,
	.target_create = dummy_target_create,
	.program_create = dummy_program_create,
	.pipeline_create = dummy_pipeline_create,
	.buffer_destroy = dummy_buffer_destroy,
	.texture_destroy = dummy_texture_destroy,
	.target_refine = dummy_target_refine,
	.target_destroy = dummy_target_destroy,
	.program_destroy = dummy_program_destroy,
	.pipeline_destroy = dummy_pipeline_destroy,
	.buffer_write = dummy_buffer_write,
	.texture_write = dummy_texture_write,
	.pass_begin = dummy_pass_begin,
	.depth_range = dummy_depth_range,
	.draw = dummy_draw,
	.pass_end = dummy_pass_end,
	.present = dummy_present,
	.window_begin = dummy_window_begin,
	.read_rgba8 = dummy_read_rgba8,
	.read_ids = dummy_read_ids,
};
