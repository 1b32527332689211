/* Handles, pools and accounting, the same for every back end; no GL here. */
#include "render/gfx.h"

#include <assert.h>
#include <errno.h>

#include "platform/base/log.h"
#include "render/gfx_backend.h"

#define WINDOW_PASS UINT32_MAX /* no target, but the window */
#define SLOT_BITS 12
#define SLOT_MASK ((1u << SLOT_BITS) - 1)

uint64_t gfx_format_bytes(enum gfx_format format, uint32_t width, uint32_t height, uint32_t layers)
{
	static const uint8_t texel_bytes[GFX_FORMAT_COUNT] = {
		[GFX_RGBA8] = 4, [GFX_SRGBA8] = 4, [GFX_R8] = 1, [GFX_RG8] = 2, [GFX_RGBA32UI] = 16
	};
	if (format == GFX_ETC2_RGBA8 || format == GFX_ETC2_SRGBA8 || format == GFX_EAC_RG11)
		return (uint64_t)((width + 3) / 4) * ((height + 3) / 4) * 16 * layers;
	return (uint64_t)width * height * layers * texel_bytes[format];
}

uint64_t gfx_buffer_bytes(const struct gfx_buffer_desc *desc)
{
	return (uint64_t)desc->bytes * (desc->usage == GFX_STREAM ? GFX_STREAM_COPIES : 1);
}

uint64_t gfx_texture_bytes(const struct gfx_texture_desc *desc)
{
	uint64_t sum = 0;
	uint32_t levels = desc->levels ? desc->levels : 1, layers = desc->layers ? desc->layers : 1;
	for (uint32_t level = 0; level < levels; level++) {
		uint32_t w = desc->width >> level, h = desc->height >> level;
		sum += gfx_format_bytes(desc->format, w ? w : 1, h ? h : 1, layers);
	}
	return sum;
}

uint64_t gfx_target_bytes(const struct gfx_target_desc *desc)
{
	uint64_t px = (uint64_t)desc->width * desc->height;
	uint64_t samples = desc->samples > 1 ? desc->samples : 1;
	uint64_t resolved = px * 4, color = desc->samples > 1 ? px * 4 * samples : 0,
			 depth = px * (desc->depth_16 ? 2 : 4) * samples;
	return resolved + color + depth + px * gfx_ids_words(desc->ids) * 4;
}

static int pool_init(struct gfx_pool *pool, struct arena *arena, uint32_t capacity)
{
	assert(capacity <= SLOT_MASK);
	*pool = (struct gfx_pool){ .generation = ARENA_ARRAY(arena, uint32_t, capacity), .capacity = capacity };
	return pool->generation ? 0 : -ENOMEM;
}

/* Returns the new handle's id and its slot, or 0 when the pool is full. */
static uint32_t pool_take(struct gfx *gfx, struct gfx_pool *pool, uint32_t *slot)
{
	for (uint32_t i = 0; i < pool->capacity; i++) {
		if (pool->generation[i] & 1)
			continue;
		pool->generation[i]++;
		pool->alive++;
		*slot = i;
		return pool->generation[i] << SLOT_BITS | (i + 1);
	}
	gfx->stats.refused++;
	return 0;
}

static uint32_t pool_slot(const struct gfx_pool *pool, uint32_t id)
{
	uint32_t slot = (id & SLOT_MASK) - 1;
	assert(id != 0 && slot < pool->capacity && "not a handle");
	assert(pool->generation[slot] << SLOT_BITS == (id & ~SLOT_MASK) && "stale handle");
	return slot;
}

static void pool_drop(struct gfx_pool *pool, uint32_t slot)
{
	pool->generation[slot]++;
	pool->alive--;
}

static void account(struct gfx *gfx, uint64_t bytes)
{
	gfx->stats.bytes += bytes;
	if (gfx->stats.bytes > gfx->stats.bytes_high_water)
		gfx->stats.bytes_high_water = gfx->stats.bytes;
}

struct gfx_buffer_slot *gfx_buffer_at(const struct gfx *gfx, gfx_buffer buffer)
{
	return &gfx->buffers[pool_slot(&gfx->buffer_pool, buffer.id)];
}

struct gfx_texture_slot *gfx_texture_at(const struct gfx *gfx, gfx_texture texture)
{
	return &gfx->textures[pool_slot(&gfx->texture_pool, texture.id)];
}

struct gfx_target_slot *gfx_target_at(const struct gfx *gfx, gfx_target target)
{
	return &gfx->targets[pool_slot(&gfx->target_pool, target.id)];
}

struct gfx_program_slot *gfx_program_at(const struct gfx *gfx, gfx_program program)
{
	return &gfx->programs[pool_slot(&gfx->program_pool, program.id)];
}

struct gfx_pipeline_slot *gfx_pipeline_at(const struct gfx *gfx, gfx_pipeline pipeline)
{
	return &gfx->pipelines[pool_slot(&gfx->pipeline_pool, pipeline.id)];
}

static struct gfx_config config_with_defaults(const struct gfx_config *given)
{
	struct gfx_config config = given ? *given : (struct gfx_config){ 0 };
	config.buffers = config.buffers ? config.buffers : 64;
	config.textures = config.textures ? config.textures : 32;
	config.targets = config.targets ? config.targets : 8;
	config.programs = config.programs ? config.programs : 48;
	config.pipelines = config.pipelines ? config.pipelines : 96;
	return config;
}

static int pools_init(struct gfx *gfx, struct arena *arena)
{
	const struct gfx_config *config = &gfx->config;
	if (pool_init(&gfx->buffer_pool, arena, config->buffers) ||
		pool_init(&gfx->texture_pool, arena, config->textures) ||
		pool_init(&gfx->target_pool, arena, config->targets) ||
		pool_init(&gfx->program_pool, arena, config->programs) ||
		pool_init(&gfx->pipeline_pool, arena, config->pipelines))
		return -ENOMEM;
	gfx->buffers = ARENA_ARRAY(arena, struct gfx_buffer_slot, config->buffers);
	gfx->textures = ARENA_ARRAY(arena, struct gfx_texture_slot, config->textures);
	gfx->targets = ARENA_ARRAY(arena, struct gfx_target_slot, config->targets);
	gfx->programs = ARENA_ARRAY(arena, struct gfx_program_slot, config->programs);
	gfx->pipelines = ARENA_ARRAY(arena, struct gfx_pipeline_slot, config->pipelines);
	bool all = gfx->buffers && gfx->textures && gfx->targets && gfx->programs && gfx->pipelines;
	return all ? 0 : -ENOMEM;
}

int gfx_init(struct gfx **out, struct arena *arena, const struct gfx_ops *ops, const struct gfx_config *config)
{
	*out = NULL;
	struct gfx *gfx = ARENA_ARRAY(arena, struct gfx, 1);
	if (!gfx)
		return -ENOMEM;
	gfx->ops = ops;
	gfx->config = config_with_defaults(config);
	int err = pools_init(gfx, arena);
	if (!err)
		err = ops->init(gfx, arena);
	if (!err)
		*out = gfx;
	return err;
}

static uint32_t handle_of(const struct gfx_pool *pool, uint32_t slot)
{
	return pool->generation[slot] & 1 ? pool->generation[slot] << SLOT_BITS | (slot + 1) : 0;
}

void gfx_finish(struct gfx *gfx)
{
	if (!gfx)
		return;
	for (uint32_t i = 0; i < gfx->pipeline_pool.capacity; i++)
		gfx_pipeline_destroy(gfx, (gfx_pipeline){ handle_of(&gfx->pipeline_pool, i) });
	for (uint32_t i = 0; i < gfx->program_pool.capacity; i++)
		gfx_program_destroy(gfx, (gfx_program){ handle_of(&gfx->program_pool, i) });
	for (uint32_t i = 0; i < gfx->target_pool.capacity; i++)
		gfx_target_destroy(gfx, (gfx_target){ handle_of(&gfx->target_pool, i) });
	for (uint32_t i = 0; i < gfx->texture_pool.capacity; i++)
		gfx_texture_destroy(gfx, (gfx_texture){ handle_of(&gfx->texture_pool, i) });
	for (uint32_t i = 0; i < gfx->buffer_pool.capacity; i++)
		gfx_buffer_destroy(gfx, (gfx_buffer){ handle_of(&gfx->buffer_pool, i) });
	gfx->ops->finish(gfx);
}

const struct gfx_caps *gfx_caps(const struct gfx *gfx)
{
	return &gfx->caps;
}

const struct gfx_stats *gfx_stats(const struct gfx *gfx)
{
	return &gfx->stats;
}

void gfx_set_between(struct gfx *gfx, void (*between)(void *context), void *context)
{
	gfx->between = between;
	gfx->between_context = context;
}

static void leave_time(struct gfx *gfx)
{
	void (*between)(void *context) = gfx->between;
	if (!between || gfx->pass.id)
		return;
	struct gfx_stats around = gfx->stats;
	uint32_t stream_copy = gfx->stream_copy;
	gfx->between = NULL;
	between(gfx->between_context);
	gfx->between = between;
	gfx->stream_copy = stream_copy;
	gfx->stats.draws = around.draws;
	gfx->stats.triangles = around.triangles;
	gfx->stats.bytes_uploaded = around.bytes_uploaded;
}

int gfx_buffer_create(struct gfx *gfx, const struct gfx_buffer_desc *desc, gfx_buffer *out)
{
	uint32_t slot;
	out->id = pool_take(gfx, &gfx->buffer_pool, &slot);
	if (!out->id)
		return -ENOMEM;
	gfx->buffers[slot] = (struct gfx_buffer_slot){ .desc = *desc };
	int err = gfx->ops->buffer_create(gfx, &gfx->buffers[slot]);
	gfx->buffers[slot].desc.data = NULL;
	if (err) {
		pool_drop(&gfx->buffer_pool, slot);
		out->id = 0;
		return err;
	}
	account(gfx, gfx_buffer_bytes(desc));
	if (desc->data)
		gfx->stats.bytes_uploaded += desc->bytes;
	leave_time(gfx);
	return 0;
}

int gfx_texture_create(struct gfx *gfx, const struct gfx_texture_desc *desc, gfx_texture *out)
{
	uint32_t slot;
	out->id = pool_take(gfx, &gfx->texture_pool, &slot);
	if (!out->id)
		return -ENOMEM;
	gfx->textures[slot] = (struct gfx_texture_slot){ .desc = *desc };
	if (!gfx->textures[slot].desc.levels)
		gfx->textures[slot].desc.levels = 1;
	int err = gfx->ops->texture_create(gfx, &gfx->textures[slot]);
	if (err) {
		pool_drop(&gfx->texture_pool, slot);
		out->id = 0;
		return err;
	}
	account(gfx, gfx_texture_bytes(desc));
	leave_time(gfx);
	return 0;
}

int gfx_texture_import(struct gfx *gfx, void *image, uint32_t width, uint32_t height, gfx_texture *out)
{
	uint32_t slot;
	out->id = 0;
	if (!gfx->caps.external)
		return -ENOTSUP;
	out->id = pool_take(gfx, &gfx->texture_pool, &slot);
	if (!out->id)
		return -ENOMEM;
	gfx->textures[slot] = (struct gfx_texture_slot){
		.desc = { .format = GFX_RGBA8, .width = width, .height = height, .levels = 1, .filter = GFX_LINEAR },
		.external = true,
	};
	int err = gfx->ops->texture_import(gfx, &gfx->textures[slot], image);
	if (err) {
		pool_drop(&gfx->texture_pool, slot);
		out->id = 0;
	}
	return err;
}

int gfx_target_create(struct gfx *gfx, const struct gfx_target_desc *desc, gfx_target *out)
{
	uint32_t slot, texture_slot;
	out->id = pool_take(gfx, &gfx->target_pool, &slot);
	if (!out->id)
		return -ENOMEM;
	gfx_texture texture = { pool_take(gfx, &gfx->texture_pool, &texture_slot) };
	if (!texture.id) {
		pool_drop(&gfx->target_pool, slot);
		out->id = 0;
		return -ENOMEM;
	}
	struct gfx_target_desc granted = *desc;
	if (granted.samples > gfx->caps.max_samples)
		granted.samples = gfx->caps.max_samples;
	if (granted.samples < 2 || granted.ids)
		granted.samples = 1;
	gfx->targets[slot] = (struct gfx_target_slot){ .desc = granted,
		.width = desc->width,
		.height = desc->height,
		.texture = texture,
		.plain = granted.plain_first && granted.samples > 1 };
	gfx->textures[texture_slot] = (struct gfx_texture_slot){
		.desc = { .format = GFX_RGBA8,
			.width = desc->width,
			.height = desc->height,
			.levels = 1,
			.filter = GFX_LINEAR },
		.of_target = true,
	};
	int err = gfx->ops->target_create(gfx, &gfx->targets[slot], &gfx->textures[texture_slot]);
	if (err) {
		pool_drop(&gfx->texture_pool, texture_slot);
		pool_drop(&gfx->target_pool, slot);
		out->id = 0;
		return err;
	}
	account(gfx, gfx_target_bytes(&gfx->targets[slot].desc));
	return 0;
}

int gfx_program_create(struct gfx *gfx, const struct gfx_program_desc *desc, gfx_program *out)
{
	uint32_t slot;
	out->id = pool_take(gfx, &gfx->program_pool, &slot);
	if (!out->id)
		return -ENOMEM;
	gfx->programs[slot] = (struct gfx_program_slot){ .desc = *desc };
	int err = gfx->ops->program_create(gfx, &gfx->programs[slot]);
	if (err) {
		pool_drop(&gfx->program_pool, slot);
		out->id = 0;
	}
	leave_time(gfx);
	return err;
}

int gfx_pipeline_create(struct gfx *gfx, const struct gfx_pipeline_desc *desc, gfx_pipeline *out)
{
	uint32_t slot;
	out->id = pool_take(gfx, &gfx->pipeline_pool, &slot);
	if (!out->id)
		return -ENOMEM;
	assert(desc->attribute_count <= GFX_ATTRIBUTES_MAX);
	gfx->pipelines[slot] = (struct gfx_pipeline_slot){ .desc = *desc };
	int err = gfx->ops->pipeline_create(gfx, &gfx->pipelines[slot]);
	if (err) {
		pool_drop(&gfx->pipeline_pool, slot);
		out->id = 0;
	}
	return err;
}

void gfx_buffer_destroy(struct gfx *gfx, gfx_buffer buffer)
{
	if (!buffer.id)
		return;
	struct gfx_buffer_slot *slot = gfx_buffer_at(gfx, buffer);
	gfx->ops->buffer_destroy(gfx, slot);
	gfx->stats.bytes -= gfx_buffer_bytes(&slot->desc);
	pool_drop(&gfx->buffer_pool, pool_slot(&gfx->buffer_pool, buffer.id));
}

void gfx_texture_destroy(struct gfx *gfx, gfx_texture texture)
{
	if (!texture.id)
		return;
	struct gfx_texture_slot *slot = gfx_texture_at(gfx, texture);
	gfx->ops->texture_destroy(gfx, slot);
	if (!slot->of_target && !slot->external)
		gfx->stats.bytes -= gfx_texture_bytes(&slot->desc);
	pool_drop(&gfx->texture_pool, pool_slot(&gfx->texture_pool, texture.id));
}

void gfx_target_destroy(struct gfx *gfx, gfx_target target)
{
	if (!target.id)
		return;
	struct gfx_target_slot *slot = gfx_target_at(gfx, target);
	gfx->ops->target_destroy(gfx, slot);
	gfx_texture_destroy(gfx, slot->texture);
	gfx->stats.bytes -= gfx_target_bytes(&slot->desc);
	pool_drop(&gfx->target_pool, pool_slot(&gfx->target_pool, target.id));
}

void gfx_program_destroy(struct gfx *gfx, gfx_program program)
{
	if (!program.id)
		return;
	gfx->ops->program_destroy(gfx, gfx_program_at(gfx, program));
	pool_drop(&gfx->program_pool, pool_slot(&gfx->program_pool, program.id));
}

void gfx_pipeline_destroy(struct gfx *gfx, gfx_pipeline pipeline)
{
	if (!pipeline.id)
		return;
	gfx->ops->pipeline_destroy(gfx, gfx_pipeline_at(gfx, pipeline));
	pool_drop(&gfx->pipeline_pool, pool_slot(&gfx->pipeline_pool, pipeline.id));
}

void gfx_buffer_write(struct gfx *gfx, gfx_buffer buffer, uint32_t offset, const void *data, uint32_t bytes)
{
	struct gfx_buffer_slot *slot = gfx_buffer_at(gfx, buffer);
	assert(offset <= slot->desc.bytes && bytes <= slot->desc.bytes - offset);
	if (!bytes)
		return;
	gfx->stats.bytes_uploaded += bytes;
	gfx->ops->buffer_write(gfx, slot, offset, data, bytes);
	leave_time(gfx);
}

void gfx_texture_write(struct gfx *gfx, gfx_texture texture, const struct gfx_region *region, const void *texels)
{
	struct gfx_texture_slot *slot = gfx_texture_at(gfx, texture);
	assert(region->level < slot->desc.levels);
	gfx->stats.bytes_uploaded += gfx_format_bytes(slot->desc.format, region->width, region->height, region->layers);
	gfx->ops->texture_write(gfx, slot, region, texels);
	leave_time(gfx);
}

gfx_texture gfx_target_texture(const struct gfx *gfx, gfx_target target)
{
	return gfx_target_at(gfx, target)->texture;
}

uint32_t gfx_target_samples(const struct gfx *gfx, gfx_target target)
{
	return gfx_target_at(gfx, target)->desc.samples;
}

void gfx_target_refine(struct gfx *gfx, gfx_target target)
{
	struct gfx_target_slot *slot = gfx_target_at(gfx, target);
	assert(!gfx->pass.id);
	if (!slot->plain)
		return;
	slot->plain = false;
	if (gfx->ops->target_refine(gfx, slot) == 0)
		return;
	log_warn("the GPU has no room for %u samples a pixel: one it is", slot->desc.samples);
	gfx->stats.bytes -= gfx_target_bytes(&slot->desc);
	slot->desc.samples = 1;
	gfx->stats.bytes += gfx_target_bytes(&slot->desc);
}

void gfx_target_part(struct gfx *gfx, gfx_target target, uint32_t width, uint32_t height)
{
	struct gfx_target_slot *slot = gfx_target_at(gfx, target);
	assert(!gfx->pass.id && width && height && width <= slot->desc.width && height <= slot->desc.height);
	slot->width = width;
	slot->height = height;
}

void gfx_frame_begin(struct gfx *gfx)
{
	gfx->stats.frames++;
	gfx->stats.draws = 0;
	gfx->stats.triangles = 0;
	gfx->stats.bytes_uploaded = 0;
	gfx->stream_copy = (gfx->stream_copy + 1) % GFX_STREAM_COPIES;
}

void gfx_pass_begin(struct gfx *gfx, gfx_target target, const struct gfx_clear *clear)
{
	assert(!gfx->pass.id && "passes do not nest");
	gfx->pass = target;
	gfx->ops->pass_begin(gfx, gfx_target_at(gfx, target), clear);
}

void gfx_depth_range(struct gfx *gfx, float near_depth, float far_depth)
{
	gfx->ops->depth_range(gfx, near_depth, far_depth);
}

void gfx_draw(struct gfx *gfx, const struct gfx_draw *draw)
{
	assert(gfx->pass.id && draw->constant_count <= GFX_CONSTANTS_MAX);
	if (!draw->count)
		return;
	const struct gfx_pipeline_slot *pipeline = gfx_pipeline_at(gfx, draw->pipeline);
	enum gfx_primitive primitive = pipeline->desc.primitive;
	gfx->stats.draws++;
	if (primitive != GFX_LINES)
		gfx->stats.triangles += primitive == GFX_TRIANGLE_STRIP ? draw->count - 2 : draw->count / 3;
	gfx->ops->draw(gfx, draw);
}

void gfx_pass_end(struct gfx *gfx)
{
	gfx->ops->pass_end(gfx, gfx_target_at(gfx, gfx->pass));
	gfx->pass.id = 0;
}

void gfx_present(struct gfx *gfx, gfx_target target, uint32_t width, uint32_t height)
{
	assert(!gfx->pass.id);
	gfx->ops->present(gfx, gfx_target_at(gfx, target), width, height);
}

void gfx_window_begin(struct gfx *gfx, uint32_t width, uint32_t height)
{
	assert(!gfx->pass.id);
	gfx->pass.id = WINDOW_PASS;
	gfx->ops->window_begin(gfx, width, height);
}

void gfx_window_end(struct gfx *gfx)
{
	assert(gfx->pass.id == WINDOW_PASS);
	gfx->pass.id = 0;
}

void gfx_read_rgba8(struct gfx *gfx, gfx_target target, void *out)
{
	assert(!gfx->pass.id);
	gfx->ops->read_rgba8(gfx, gfx_target_at(gfx, target), out);
}

void gfx_read_ids(struct gfx *gfx, gfx_target target, uint32_t *out)
{
	struct gfx_target_slot *slot = gfx_target_at(gfx, target);
	assert(!gfx->pass.id && slot->desc.ids != GFX_IDS_NONE);
	gfx->ops->read_ids(gfx, slot, out);
}
