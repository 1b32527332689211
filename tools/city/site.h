/*
 * What a building's surroundings tell about it: how densely the place is built, whether it stands in a row, how far
 * from the street. Used by heights.c and roofs.c; one pass over the city.
 */
#ifndef BLVD_TOOLS_CITY_SITE_H
#define BLVD_TOOLS_CITY_SITE_H

#include "tools/city/box_index.h"
#include "tools/city/city.h"

struct site {
	struct dvec2 centre;
	double area_m2;
	double narrow_m, long_m; /* of the smallest rectangle around the footprint */
	double span_m;           /* typical depth of the building: of a wing, for footprints with wings */
	double filled;           /* share of that rectangle that the footprint fills */
	double density;          /* share of the ground that is built on, within some 100 m; 0 to 1 */
	bool attached;           /* touches another building of some size */
	bool fronts_street;      /* close to a street */
	int street_class;        /* of the closest street, or -1 */
};

struct sites {
	struct site *items; /* one a building; owned */
	bounds_array boxes; /* of the footprints */
	struct box_index index;
};

void sites_build(struct sites *sites, const struct city *city);
void sites_finish(struct sites *sites);

#endif
