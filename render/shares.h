/*
 * How the memory is shared between the CPU's arena, the GPU, and the cells' slots: first what is there already, then
 * what must be resident wherever the car is (assets/resident.h), then as many more slots as there is room for. A slot
 * takes its part of both.
 */
#ifndef BLVD_RENDER_SHARES_H
#define BLVD_RENDER_SHARES_H

#include <stdbool.h>

#include "assets/resident.h"
#include "platform/base/arena.h"
#include "render/gfx.h"
#include "render/repr.h"

struct shares_config {
	const struct pkg *pkg;
	const struct repr_ops *far_ops;
	const struct repr_config *far_config; /* all but slot_count and reach_m */
	const struct gfx *gfx;                /* what it holds counts */
	uint64_t budget_bytes;                /* for the arena and the GPU together; 0: the arena does not count */
	uint64_t gpu_bytes;                   /* for the GPU, when budget_bytes is 0 */
	uint32_t width, height, samples;      /* of the picture, to be named when there is too little */
};

struct shares {
	uint64_t gpu_bytes;        /* for everything on the GPU */
	uint32_t slot_count;       /* of stretches; 0 when the representation loads none */
	bool around;               /* geometry is loaded around a place, as `need` says */
	struct resident_need need; /* all zero when it is not */
};

/* Once all but the scene and the city's geometry has been made. With a budget the arena's size becomes what they will
 * take of it, to a few KiB. Returns 0; -ENOMEM; -EFBIG, after saying so with both numbers, when the package's own
 * bound of what must be resident is more than the budget leaves. */
int shares_settle(struct shares *shares, struct arena *arena, const struct shares_config *config);

/* Most slots that there will ever be, for upper bounds. */
#define SHARES_SLOTS_MAX 16

#endif
