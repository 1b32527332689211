/* A small city of rows of houses between straight streets, made up from a seed, with its geometry and its occluders as
 * a package in memory. */
#ifndef BLVD_TESTS_TOOLS_BLOCK_CITY_H
#define BLVD_TESTS_TOOLS_BLOCK_CITY_H

#include "tools/bake/bake.h"

#define BLOCK_CITY_PITCH_M 48.0 /* between streets, which run along x and y through multiples of it */
#define BLOCK_CITY_BLOCKS 6     /* to a side, from the origin on */

struct block_city {
	struct report report;
	struct city city;
	struct mesh_chunks mesh;
	struct occluders occluders;
	struct pkg_meta meta;
	struct pkg pkg; /* no graph, no textures */
};

/* A house from its south-west corner. Flat unless roof_m > 0: gabled then. Valid until the next one is added. */
struct building *block_city_house(
	struct city *city, struct dvec2 at, struct dvec2 size, double height_m, double roof_m);

void block_city_make(struct block_city *made, uint64_t seed);
/* Geometry and occluders of a city whose buildings are there already. */
void block_city_build(struct block_city *made);
void block_city_finish(struct block_city *made);

#endif
