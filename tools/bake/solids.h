/*
 * Buildings that fill the air above their footprint from the ground to a known height: nothing is seen through them.
 */
#ifndef BLVD_TOOLS_BAKE_SOLIDS_H
#define BLVD_TOOLS_BAKE_SOLIDS_H

#include "tools/city/city.h"

struct solid {
	const struct polygon *footprint; /* borrowed from the city */
	double ground_m, top_m;          /* of altitude; opaque in between */
	int64_t id;
	double height_m; /* of the building above its ground */
};
typedef ARRAY(struct solid) solid_array;

/* Appends them, by id. Left out: roofs on posts, what does not start at the ground (but where it goes on above an arch,
 * what is beside the arch counts up to the eaves), what stands over a tunnel or a stream. */
void solids_list(const struct city *city, solid_array *out);

#endif
