/* Chains with fewer points, none farther than a bound from the chain that they stand for (Douglas and Peucker 1973,
 * "Algorithms for the reduction of the number of points required to represent a digitized line"). */
#ifndef BLVD_TOOLS_IMPOSTOR_SIMPLIFY_H
#define BLVD_TOOLS_IMPOSTOR_SIMPLIFY_H

#include "tools/impostor/contours.h"

struct simplifier {
	ARRAY(uint32_t) kept;   /* result: indices into the points, ascending */
	ARRAY(uint32_t) ranges; /* scratch */
};

/* The first and the last point stay; of a closed chain two more at least, so that it keeps an inside. */
void simplify(
	struct simplifier *simplifier, const struct contour_point *points, uint32_t count, bool closed, double bound_px);
void simplifier_finish(struct simplifier *simplifier);

#endif
