/*
 * Outlines with fewer points that leave nothing out: an outline only ever grows. Either a point that lies inwards of
 * its neighbours goes, or two neighbours that lie outwards become one, where the sides next to them meet; what adds the
 * least area first, as long as it is cheaper than the point that it saves (progressive hulls in the plane, after
 * Sander, Gu, Gortler, Hoppe, Snyder 2000, "Silhouette Clipping").
 */
#ifndef BLVD_TOOLS_IMPOSTOR_HULL_H
#define BLVD_TOOLS_IMPOSTOR_HULL_H

#include <stdbool.h>

#include "tools/impostor/contours.h"

struct hull_point {
	float x, y;
	uint32_t last, next; /* in the outline that is left, or UINT32_MAX beyond its ends */
	uint32_t changes;    /* of the point or of what is next to it */
	bool gone;
};
struct hull_step {
	double cost; /* px^2 */
	uint32_t point, changes;
	bool merges; /* with the next point */
};
struct hull {
	ARRAY(struct hull_point) points;
	ARRAY(struct hull_step) heap;
	ARRAY(struct contour_point) kept; /* result, in order; closed outlines have their first point once */
	double area;                      /* of a closed outline */
};

/* `points`: as of a chain. `outside_left`: which side may be taken. Each point saved is worth `price_px2`; no step
 * reaches farther than `reach_px`. The ends of an open chain stay. */
void hull_grow(struct hull *hull, const struct contour_point *points, uint32_t count, bool closed, bool outside_left,
	double price_px2, double reach_px);
void hull_finish(struct hull *hull);

#endif
