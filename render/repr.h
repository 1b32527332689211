/*
 * A representation: one way to draw the distant model (DESIGN "Words"). All answer the same operations, so that they
 * are chosen and compared by name. What is near is drawn by the scene itself, in the near slice.
 */
#ifndef BLVD_RENDER_REPR_H
#define BLVD_RENDER_REPR_H

#include <stdint.h>

#include "render/draw_list.h"
#include "render/near_mesh.h"
#include "render/view.h"

/* A chunk whose bounds are in view. */
struct visible_chunk {
	uint32_t chunk;
	float nearest_m, farthest_m; /* along the view direction */
	bool whole;                  /* all in view and in one slice: no need to look at its objects */
};
struct visible_set {
	struct visible_chunk *items;
	uint32_t count;
	uint32_t missing; /* in view, but not resident */
};

struct repr {
	const struct repr_ops *ops;
	const struct near_mesh *mesh;
	const struct fade *fade;
	void *state; /* the representation's own, from the arena */
};

/* All mandatory. */
struct repr_ops {
	const char *name;
	/* Returns 0, -ENOMEM or -ENODATA when the package lacks what it needs. */
	int (*init)(struct repr *repr, struct arena *arena);
	void (*finish)(struct repr *repr);
	/* Decides what stands for the distance from this eye; may ask for loading. */
	void (*select)(struct repr *repr, const struct view *view);
	/* Adds what is to be drawn in the far slice. */
	void (*emit)(struct repr *repr, const struct view *view, const struct visible_set *visible, struct draw_list *list);
	uint64_t (*bytes)(const struct repr *repr);  /* resident now, on the GPU */
	double (*error_px)(const struct repr *repr); /* largest displacement of a far point, bound */
};

extern const struct repr_ops repr_full; /* the geometry itself; no error */
extern const struct repr_ops repr_none; /* only what is near */

/* NULL when there is none of this name. */
const struct repr_ops *repr_by_name(const char *name);

#endif
