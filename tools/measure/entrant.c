#include "tools/measure/entrant.h"

#include <stdlib.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "tools/city/pool.h"

#define ARENA_BYTES ((size_t)256 << 20) /* untouched pages cost nothing */

/* What only measuring takes of the GPU: the target, and the pages of what texels show. */
static uint64_t truth_bytes(const struct pkg *pkg, const struct entrant_config *config)
{
	struct gfx_target_desc target = { .width = config->width, .height = config->height, .ids = GFX_IDS_RGBA32UI };
	uint64_t pages = 0;
	for (uint32_t i = 0; pkg->stretches && i < 2 * pkg->stretch_count; i++)
		if (pkg->cells[i].truth.stored_bytes && pkg->cells[i].page_count > pages)
			pages = pkg->cells[i].page_count;
	return gfx_target_bytes(&target) + pages * PKG_PAGE_PX * PKG_PAGE_PX * sizeof(struct pkg_truth_texel);
}

/* The GPU's part of the budget: what the renderer's own arena does not need. */
static uint64_t gpu_budget(const struct pkg *pkg, const struct entrant_config *config, const struct renderer_config *of)
{
	uint64_t arena = renderer_arena_bytes(of, pkg), budget = config->budget_bytes;
	if (!budget)
		return 0;
	return (budget > arena ? budget - arena : 1) + (config->truth ? truth_bytes(pkg, config) : 0);
}

static int open_renderer(struct entrant *entrant, const struct pkg *pkg)
{
	const struct entrant_config *config = &entrant->config;
	struct display_config display = { .width = config->width, .height = config->height };
	int status = display_open(&entrant->display, &display_surfaceless, &display);
	if (status < 0)
		return status;
	struct renderer_config renderer = {
		.width = config->width,
		.height = config->height,
		.samples = config->samples,
		.far_name = config->name,
		.tau_px = config->tau_px,
		.deterministic = true,
		.get_proc = display_get_proc,
		.overlay = config->overlay,
		.truth = config->truth,
	};
	renderer.gpu_budget_bytes = gpu_budget(pkg, config, &renderer);
	return renderer_init(&entrant->renderer, &entrant->arena, &renderer, pkg);
}

int entrant_open(struct entrant *entrant, const struct pkg *pkg, const struct entrant_config *config)
{
	size_t pixels = (size_t)config->width * config->height;
	*entrant = (struct entrant){ .config = *config, .pkg = pkg };
	uint8_t *memory = malloc(ARENA_BYTES);
	if (!memory)
		abort();
	arena_init(&entrant->arena, config->name, memory, ARENA_BYTES);
	entrant->pixels = array_grow(NULL, &(size_t){ 0 }, pixels, 4);
	entrant->truth = array_grow(NULL, &(size_t){ 0 }, pixels, sizeof(*entrant->truth));
	entrant->lightness = array_grow(NULL, &(size_t){ 0 }, pixels, sizeof(float));
	entrant->popping =
		(struct popping){ .pixels = pixels, .error = array_grow(NULL, &(size_t){ 0 }, pixels, sizeof(float)) };
	int64_t began = clock_cpu_ns();
	int status = open_renderer(entrant, pkg);
	entrant->start_ms = (double)(clock_cpu_ns() - began) * 1e-6;
	if (status < 0) {
		log_error("%s: cannot be drawn from this package", config->name);
		entrant_close(entrant);
	}
	return status;
}

void entrant_close(struct entrant *entrant)
{
	if (entrant->display.ops)
		display_use(&entrant->display);
	renderer_finish(entrant->renderer);
	display_close(&entrant->display);
	array_free(entrant->pixels);
	array_free(entrant->truth);
	array_free(entrant->lightness);
	array_free(entrant->popping.error);
	free(entrant->arena.base);
	*entrant = (struct entrant){ 0 };
}

/* Reading back waits for the picture, so the time is that of the whole frame. */
int entrant_draw(struct entrant *entrant, const struct replay_frame *frame)
{
	int status = display_use(&entrant->display);
	if (status < 0)
		return status;
	int64_t wall = clock_now_ns(), cpu = clock_cpu_ns();
	renderer_draw_from(entrant->renderer, &frame->nav, &frame->pose, &frame->time);
	renderer_read_pixels(entrant->renderer, entrant->pixels);
	entrant->cpu_ms = (double)(clock_cpu_ns() - cpu) * 1e-6;
	entrant->wall_ms = (double)(clock_now_ns() - wall) * 1e-6;
	return 0;
}

/* All tiles of the ground are the ground. */
static void join_tiles(const struct pkg *pkg, struct truth_pixel *truth, size_t pixels)
{
	for (size_t i = 0; i < pixels; i++) {
		if (!truth[i].object || truth[i].object > pkg->object_count)
			continue;
		uint16_t kind = pkg->objects[truth[i].object - 1].kind;
		if (kind == PKG_OBJECT_GROUND)
			truth[i].object = TRUTH_GROUND;
		else if (kind == PKG_OBJECT_WATER)
			truth[i].object = TRUTH_WATER;
	}
}

int entrant_read_truth(struct entrant *entrant, struct dvec2 at_px)
{
	int status = display_use(&entrant->display);
	if (status < 0)
		return status;
	renderer_read_truth(entrant->renderer, at_px, (uint32_t *)(void *)entrant->truth);
	join_tiles(entrant->pkg, entrant->truth, (size_t)entrant->config.width * entrant->config.height);
	return 0;
}

void entrant_see(struct entrant *entrant, float *work)
{
	popping_lightness(entrant->pixels, entrant->config.width, entrant->config.height, entrant->lightness, work);
}
