/*
 * Between gfx.c (handles, pools, accounting, checks; no GL) and a back end (the GPU's own objects). A back end keeps
 * its objects' names in the slots and its own state behind `gfx->impl`.
 */
#ifndef BLVD_RENDER_GFX_BACKEND_H
#define BLVD_RENDER_GFX_BACKEND_H

#include "render/gfx.h"

struct gfx_buffer_slot {
	struct gfx_buffer_desc desc;
	uint32_t native[GFX_STREAM_COPIES];
};
struct gfx_texture_slot {
	struct gfx_texture_desc desc;
	uint32_t native;
	bool of_target; /* counted with its target */
	bool external;  /* not ours, not counted */
};
struct gfx_target_slot {
	struct gfx_target_desc desc; /* samples as granted */
	uint32_t width, height;      /* of the part in use */
	bool plain;                  /* desc.plain_first, and not refined yet */
	uint32_t framebuffer, resolve_framebuffer;
	uint32_t color, depth; /* renderbuffers; color is 0 without multisampling */
	uint32_t samples;      /* texture instead of `color`, with what averages it; or 0 */
	uint32_t resolve_program, resolve_vertices;
	uint32_t ids; /* renderbuffer, or 0 */
	gfx_texture texture;
};
struct gfx_program_slot {
	struct gfx_program_desc desc;
	uint32_t native;
	int32_t constants; /* location of u_draw, or -1 */
};
struct gfx_pipeline_slot {
	struct gfx_pipeline_desc desc;
	uint32_t native;                                      /* vertex array object */
	uint32_t bound_vertices, bound_indices, bound_offset; /* what that object points at now */
};

struct gfx_pool {
	uint32_t *generation; /* per slot; odd while alive */
	uint32_t capacity;
	uint32_t alive;
};

struct gfx {
	const struct gfx_ops *ops;
	void *impl;
	struct gfx_config config;
	struct gfx_caps caps;
	struct gfx_stats stats;
	struct gfx_pool buffer_pool, texture_pool, target_pool, program_pool, pipeline_pool;
	struct gfx_buffer_slot *buffers;
	struct gfx_texture_slot *textures;
	struct gfx_target_slot *targets;
	struct gfx_program_slot *programs;
	struct gfx_pipeline_slot *pipelines;
	gfx_target pass; /* the target being drawn into */
	uint32_t stream_copy;
	void (*between)(void *context);
	void *between_context;
};

/* All mandatory. Creations return 0, -ENOMEM or -EINVAL and leave nothing behind when they fail. */
struct gfx_ops {
	const char *name;
	int (*init)(struct gfx *gfx, struct arena *arena);
	void (*finish)(struct gfx *gfx);
	int (*buffer_create)(struct gfx *gfx, struct gfx_buffer_slot *slot);
	int (*texture_create)(struct gfx *gfx, struct gfx_texture_slot *slot);
	int (*texture_import)(struct gfx *gfx, struct gfx_texture_slot *slot, void *image);
	int (*target_create)(struct gfx *gfx, struct gfx_target_slot *slot, struct gfx_texture_slot *texture);
	int (*program_create)(struct gfx *gfx, struct gfx_program_slot *slot);
	int (*pipeline_create)(struct gfx *gfx, struct gfx_pipeline_slot *slot);
	int (*target_refine)(struct gfx *gfx, struct gfx_target_slot *slot); /* -ENOMEM: as it was */
	void (*buffer_destroy)(struct gfx *gfx, struct gfx_buffer_slot *slot);
	void (*texture_destroy)(struct gfx *gfx, struct gfx_texture_slot *slot);
	void (*target_destroy)(struct gfx *gfx, struct gfx_target_slot *slot);
	void (*program_destroy)(struct gfx *gfx, struct gfx_program_slot *slot);
	void (*pipeline_destroy)(struct gfx *gfx, struct gfx_pipeline_slot *slot);
	void (*buffer_write)(
		struct gfx *gfx, struct gfx_buffer_slot *slot, uint32_t offset, const void *data, uint32_t bytes);
	void (*texture_write)(
		struct gfx *gfx, struct gfx_texture_slot *slot, const struct gfx_region *region, const void *texels);
	void (*pass_begin)(struct gfx *gfx, struct gfx_target_slot *slot, const struct gfx_clear *clear);
	void (*depth_range)(struct gfx *gfx, float near_depth, float far_depth);
	void (*draw)(struct gfx *gfx, const struct gfx_draw *draw);
	void (*pass_end)(struct gfx *gfx, struct gfx_target_slot *slot);
	void (*present)(struct gfx *gfx, struct gfx_target_slot *slot, uint32_t width, uint32_t height);
	void (*window_begin)(struct gfx *gfx, uint32_t width, uint32_t height);
	void (*read_rgba8)(struct gfx *gfx, struct gfx_target_slot *slot, void *out);
	void (*read_ids)(struct gfx *gfx, struct gfx_target_slot *slot, uint32_t *out);
};

/* uint32_t per pixel. */
static inline uint32_t gfx_ids_words(enum gfx_ids ids)
{
	return ids == GFX_IDS_RGBA32UI ? 4 : ids == GFX_IDS_R32UI ? 1 : 0;
}

/* Slots of living handles; a stale or zero handle asserts. */
struct gfx_buffer_slot *gfx_buffer_at(const struct gfx *gfx, gfx_buffer buffer);
struct gfx_texture_slot *gfx_texture_at(const struct gfx *gfx, gfx_texture texture);
struct gfx_target_slot *gfx_target_at(const struct gfx *gfx, gfx_target target);
struct gfx_program_slot *gfx_program_at(const struct gfx *gfx, gfx_program program);
struct gfx_pipeline_slot *gfx_pipeline_at(const struct gfx *gfx, gfx_pipeline pipeline);

#endif
