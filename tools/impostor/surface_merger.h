/* The state while surfaces grow: a forest of seeds whose roots are the regions. Private to the steps of surfaces.c. */
#ifndef BLVD_TOOLS_IMPOSTOR_SURFACE_MERGER_H
#define BLVD_TOOLS_IMPOSTOR_SURFACE_MERGER_H

#include "tools/impostor/surface_seeds.h"

struct merge_candidate {
	float error;
	uint32_t a, b; /* regions when queued */
};
struct merger {
	struct surface_seeds seeds;
	ARRAY(uint32_t) parent;  /* of seeds; roots are regions */
	ARRAY(uint32_t) largest; /* pixels of the part whose kind and normal a region has */
	ARRAY(struct merge_candidate) heap;
	struct borders borders; /* labels are regions + 1 */
	double per_px2;         /* pixels of the capture in one of the screen */
};

static inline uint32_t surface_region(struct merger *merger, uint32_t seed)
{
	uint32_t *parent = merger->parent.items;
	while (parent[seed] != seed)
		seed = parent[seed] = parent[parent[seed]];
	return seed;
}

/* A region's pixels are never farther off than this, in tolerances; more than 1 for pixels that are no reason for a
 * region of their own. */
#define SURFACE_ERROR_MAX 1.1

/* surface_swallow.c: gives small regions to the neighbours that fit them best. */
void surfaces_swallow(struct merger *merger, const struct surfaces_input *input);
/* surface_eject.c: gives pixels that are farther off than SURFACE_ERROR_MAX regions of their own. */
void surfaces_eject(struct merger *merger, const struct surfaces_input *input, uint32_t *label);

#endif
