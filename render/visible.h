/* Which resident chunks are in view: one box each. */
#ifndef BLVD_RENDER_VISIBLE_H
#define BLVD_RENDER_VISIBLE_H

#include "render/near_mesh.h"

/* A chunk whose bounds are in view. */
struct visible_chunk {
	uint32_t chunk;
	float nearest_m, farthest_m; /* along the view direction */
	bool whole;                  /* all in view and in one slice: no need to look at its objects */
};
struct visible_set {
	struct visible_chunk *items; /* room for every chunk of the package */
	uint32_t count;
	uint32_t missing; /* in view, but not resident */
};

/* Returns 0 or -ENOMEM. */
int visible_init(struct visible_set *visible, struct arena *arena, const struct pkg *pkg);

/* Chunks that some point of the view's frustum up to `reach_m` (from the eye, as the crow flies) sees. */
void visible_find(struct visible_set *visible, const struct near_mesh *mesh, const struct view *view, double reach_m);

/* Adds what is found, in each slice that it reaches into; what fades is drawn apart. */
void visible_emit(const struct visible_set *visible, const struct near_mesh *mesh, const struct fade *fade,
	const struct view *view, struct draw_list *list);

#endif
