#include "render/shares.h"

#include <errno.h>
#include <math.h>

#include "platform/base/log.h"
#include "render/cell_store.h"
#include "render/near_mesh.h"
#include "render/scene.h"

#define SMALL_GPU_BYTES (UINT64_C(256) << 10)  /* materials and other uniform blocks that come later */
#define SMALL_ARENA_BYTES (UINT64_C(16) << 10) /* padding, and the representation's own */
#define SLOTS_ROOM_BYTES (UINT64_C(32) << 20)  /* more than this for slots is of no use */
#define SLOTS_MAX_SOFTWARE 10 /* a CPU keeps pages decoded: four times the bytes, all written at start */
#define SLOTS_MIN 4

/* What one slot takes, and the cache without any. */
struct slot_cost {
	uint64_t gpu, arena;
	uint64_t cache_arena;
	uint32_t layers;
};

static struct slot_cost slot_cost(const struct shares_config *config)
{
	struct cell_cache_config cells;
	struct cell_limits limits;
	config->far_ops->cells(config->pkg, config->far_config, &cells);
	cell_cache_limits(config->pkg, &cells, &limits);
	cells.slot_count = 1;
	uint64_t one = cell_cache_bytes(config->pkg, &cells);
	cells.slot_count = 2;
	uint64_t two = cell_cache_bytes(config->pkg, &cells);
	struct slot_cost cost = { .gpu = cell_store_slot_bytes(&limits), .layers = limits.impostor_pages };
	cost.arena = two - one + sizeof(struct stored_slot);
	cost.cache_arena = one - (two - one);
	return cost;
}

static uint32_t slots_that_fit(const struct gfx *gfx, const struct slot_cost *cost, uint64_t room_bytes)
{
	const struct gfx_caps *caps = gfx_caps(gfx);
	const uint64_t most = caps->software ? SLOTS_MAX_SOFTWARE : SHARES_SLOTS_MAX;
	const uint64_t one = cost->gpu + cost->arena;
	uint64_t count = one ? room_bytes / one : most; /* stretches with nothing in them */
	count = count * cost->gpu > SLOTS_ROOM_BYTES ? SLOTS_ROOM_BYTES / cost->gpu : count;
	if (cost->layers && count > caps->max_array_layers / cost->layers)
		count = caps->max_array_layers / cost->layers;
	return (uint32_t)(count > most ? most : count < SLOTS_MIN ? SLOTS_MIN : count);
}

static double mib(uint64_t bytes)
{
	return (double)bytes / 1048576.0;
}

/* Geometry around a place, and slots: what fits into `left_bytes`. */
static int share_around(struct shares *shares, struct arena *arena, const struct shares_config *config,
	const struct slot_cost *cost, uint64_t left_bytes)
{
	struct resident_need *need = &shares->need;
	const uint64_t kept = RESIDENT_SLOTS * cost->arena, left = left_bytes > kept ? left_bytes - kept : 0;
	resident_need_whole(config->pkg, need);
	int status = need->sum + SLOTS_ROOM_BYTES <= left ? 0 : resident_need(config->pkg, arena, need);
	if (status < 0)
		return status;
	uint64_t bound = config->pkg->meta->resident_bound_bytes;
	bound = bound > need->sum ? bound : need->sum;
	if (bound > left) {
		double left_mib = floor(10.0 * mib(left)) / 10.0; /* rounded up it may look like enough */
		log_error(
			"the package needs %.1f MiB resident for its cells, a budget of %.1f MiB leaves %.1f MiB at %u x %u and %u "
			"samples",
			mib(bound), mib(config->budget_bytes ? config->budget_bytes : config->gpu_bytes), left_mib, config->width,
			config->height, config->samples);
		return -EFBIG;
	}
	shares->around = true;
	shares->slot_count = slots_that_fit(config->gfx, cost, left_bytes - need->textures - need->geometry);
	return 0;
}

int shares_settle(struct shares *shares, struct arena *arena, const struct shares_config *config)
{
	const bool cells = config->pkg->stretches && config->far_ops->cells;
	struct slot_cost cost = { 0 };
	uint64_t fixed =
		arena->used + scene_arena_bytes(config->pkg) + near_mesh_arena_bytes(config->pkg) + SMALL_ARENA_BYTES;
	uint64_t there = gfx_stats(config->gfx)->bytes + SMALL_GPU_BYTES;
	*shares = (struct shares){ .gpu_bytes = config->gpu_bytes };
	if (cells)
		cost = slot_cost(config);
	fixed += cost.cache_arena;
	if (!config->budget_bytes)
		fixed = cost.arena = 0;
	uint64_t budget = config->budget_bytes ? config->budget_bytes : config->gpu_bytes;
	if (cells && config->far_ops->reach_m) {
		int status = share_around(shares, arena, config, &cost, budget > fixed + there ? budget - fixed - there : 0);
		if (status < 0)
			return status;
	} else if (cells) {
		shares->slot_count = slots_that_fit(config->gfx, &cost, SLOTS_ROOM_BYTES);
	}
	if (!config->budget_bytes)
		return 0;
	uint64_t taken = fixed + shares->slot_count * cost.arena;
	if (taken < arena->size)
		arena->size = (size_t)taken;
	shares->gpu_bytes = budget > arena->size ? budget - arena->size : 1;
	return 0;
}
