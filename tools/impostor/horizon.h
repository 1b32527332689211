/*
 * What hides what as seen from one point: for every bin of azimuth the highest slope that is blocked, by distance
 * (Downs, Moeller, Sequin 2001, "Occlusion Horizons for Driving through Urban Scenery").
 *
 * Azimuths run along the sides of a diamond |x| + |y| = 1 around the point, and distances are |x| + |y| too. On each
 * side this is a projection onto a plane: a straight line stays straight, so slope and inverse distance are linear in
 * the azimuth along walls and edges of triangles, and their extremes over a bin are at its ends.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_HORIZON_H
#define BLVD_TOOLS_IMPOSTOR_HORIZON_H

#include <stdbool.h>
#include <stdint.h>

#include "platform/base/vec.h"

#define HORIZON_BINS 2048
#define HORIZON_STEPS 7

/* From a step on, farther away, everything below its slope is hidden. Nearest first, slopes rise. */
struct horizon_bin {
	float near_inverse[HORIZON_STEPS]; /* 1 / distance */
	float slope[HORIZON_STEPS];
	uint32_t count;
};
struct horizon {
	struct dvec3 eye;
	struct horizon_bin bins[HORIZON_BINS];
	float slope_max[HORIZON_BINS], inverse_max[HORIZON_BINS]; /* working memory of one question */
};

void horizon_reset(struct horizon *horizon, struct dvec3 eye);

/*
 * Adds a closed outline of `count` points, in the frame of the eye, interior to the left of each side: everything in it
 * below `top` is solid. The eye is outside. Only bins that the outline crosses from end to end are raised.
 */
void horizon_add_outline(struct horizon *horizon, const struct dvec2 *points, uint32_t count, double top);

/* The slope up to which everything in an upright box is hidden, whatever its height; -INFINITY: nothing is. */
double horizon_floor(const struct horizon *horizon, struct dvec2 min, struct dvec2 max);

/* Is all of it hidden? A convex polygon of 3 or 4 corners, in the frame of the eye, and everything below it. `floor`:
 * of a box that holds the polygon, or -INFINITY. */
bool horizon_hides(struct horizon *horizon, const struct dvec3 *corners, uint32_t count, double floor);

/* The same for an upright box. */
static inline bool horizon_hides_box(
	struct horizon *horizon, struct dvec2 min, struct dvec2 max, double top, double floor)
{
	const struct dvec3 lid[4] = { { min.x, min.y, top }, { max.x, min.y, top }, { max.x, max.y, top },
		{ min.x, max.y, top } };
	return horizon_hides(horizon, lid, 4, floor);
}

#endif
