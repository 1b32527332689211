/*
 * What must be resident on the GPU at once to draw a package by its cells, wherever on a street the car is: DESIGN
 * "Baking" 7. The bake writes the sum into the header; the runtime sizes its pools by the parts, so that the two agree.
 */
#ifndef BLVD_ASSETS_RESIDENT_H
#define BLVD_ASSETS_RESIDENT_H

#include "assets/pkg.h"
#include "platform/base/arena.h"

/* The stretch under the car, the one that dissolves, and one at each of four ends of a crossing. More are better. */
#define RESIDENT_SLOTS 6

/* From an arena, given back. */
#define RESIDENT_SCRATCH_BYTES (2u << 20)

struct resident_need {
	uint64_t textures;          /* TEXA and LMAP */
	uint64_t geometry;          /* pools for the chunks within reach */
	uint64_t vertices, indices; /* of these pools */
	uint64_t slot;              /* one stretch: local set, impostors, visible set where it is drawn */
	uint64_t sum;               /* with RESIDENT_SLOTS slots */
	double reach_m;             /* how far from an eye in a view cell a chunk of the cell's local model may be */
};

/* With room for the whole city's geometry: an upper bound that costs nothing to find. */
void resident_need_whole(const struct pkg *pkg, struct resident_need *out);

/* Returns 0 or -ENOMEM. */
int resident_need(const struct pkg *pkg, struct arena *scratch, struct resident_need *out);

#endif
