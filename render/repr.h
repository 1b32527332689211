/*
 * A representation: one way to draw the distant model (DESIGN "Words"). All answer the same operations, so that they
 * are chosen and compared by name. A representation also decides how the near geometry is drawn, because what stands
 * for the distance decides where it begins: most add the chunks in view, or a local model, to the draw list.
 *
 * A frame: select() from this eye, then emit() into the draw list, then, once the list has been drawn, draw() with
 * pipelines of its own. Everything is made by init(); nothing is allocated later.
 */
#ifndef BLVD_RENDER_REPR_H
#define BLVD_RENDER_REPR_H

#include <stdint.h>

#include "assets/cell_cache.h"
#include "nav/nav_view.h"
#include "render/draw_list.h"
#include "render/near_mesh.h"
#include "render/view.h"
#include "render/visible.h"

/* Makes the distance's pictures easy to tell from the rest, to look at. */
enum repr_show {
	REPR_SHOW_PLAIN,
	REPR_SHOW_FAR,  /* the distant model is tinted, as in [S97] figure 5 */
	REPR_SHOW_WIRE, /* and its triangles' edges are drawn */
};

struct repr_config {
	double tau_px; /* what is stored with a larger error is drawn as geometry where it can be; 0: as it is */
	uint64_t upload_slice_bytes;
	uint32_t slot_count; /* of stretches that it may keep */
	double reach_m;      /* how far from an eye on a street the near geometry has room to be resident */
	double far_m;        /* nothing is drawn beyond */
	bool deterministic;  /* loading takes the same number of frames, whatever the machine's speed */
	bool truth;          /* draw_truth() will be called */
	enum repr_show show;
};

/* Where a frame is seen from. */
struct repr_place {
	const struct view *view;
	const struct nav_view *nav; /* NULL: a still, nothing is known but the eye */
	int64_t time_ns;            /* of the frames' clock */
	bool jumped;                /* no way leads from the last frame to this one: wait for all that is wanted */
};

/* Of the last frame, but for sums. */
struct repr_counts {
	uint32_t triangles; /* that stand for the distance */
	bool fallback;      /* something else stood in for what belongs here */
	bool late;          /* because it was not loaded in time */
	uint32_t missing;   /* chunks in view that were not resident */
	uint64_t entered;   /* stretches, since start */
	uint64_t damaged;   /* stretches that cannot be read, since start */
	uint64_t refused;   /* uploads that found no room, since start */
};

struct repr {
	const struct repr_ops *ops;
	struct gfx *gfx;
	const struct pkg *pkg;
	struct near_mesh *mesh; /* initialised after the representation */
	const struct fade *fade;
	struct visible_set *visible; /* room to find chunks in */
	struct repr_config config;
	struct repr_counts counts;
	void *state; /* the representation's own, from the arena */
};

struct repr_ops {
	const char *name;
	/* What it keeps of the stretches, but for how many. NULL: it loads none. */
	void (*cells)(const struct pkg *pkg, const struct repr_config *config, struct cell_cache_config *out);
	/* Mandatory. Makes GL objects of fixed size; the city's geometry gets what is left of the budget. Returns 0,
	 * -ENOMEM, -EINVAL or -ENODATA when the package lacks what it needs. */
	int (*init)(struct repr *repr, struct arena *arena);
	/* Mandatory. */
	void (*finish)(struct repr *repr);
	/* Mandatory. Decides what stands for the distance from this eye; asks for loading, uploads a slice. */
	void (*select)(struct repr *repr, const struct repr_place *place);
	/* Mandatory. Adds near and distant geometry; sets counts. */
	void (*emit)(struct repr *repr, const struct view *view, struct draw_list *list);
	/* Draws what is not in the list, after its solid part and before the sky. NULL: nothing. */
	void (*draw)(const struct repr *repr, const struct view *view, gfx_buffer frame_block);
	/* The same into the pass of a frame_truth.h, for measuring. */
	void (*draw_truth)(const struct repr *repr, const struct view *view);
	/* Where the depth slices should meet after select(), m; 0 or NULL: anywhere. */
	double (*split_m)(const struct repr *repr);
	/* How far from the eye the city's geometry should be resident, m. NULL: all that is drawn. */
	double (*reach_m)(const struct repr *repr);
	/* Mandatory. Of its own, resident now, on the GPU. */
	uint64_t (*bytes)(const struct repr *repr);
	/* Mandatory. Bound of the displacement of a far point of the last frame. */
	double (*error_px)(const struct repr *repr);
};

extern const struct repr_ops repr_full;     /* the geometry itself; no error */
extern const struct repr_ops repr_none;     /* only what is near */
extern const struct repr_ops repr_impostor; /* local model and textured triangles of the cell, [S97] */
extern const struct repr_ops repr_pvs;      /* local model and the visible set of the stretch: no error */

/* "auto" chooses by what the package has. NULL when there is none of this name. */
const struct repr_ops *repr_by_name(const char *name, const struct pkg *pkg);

#endif
