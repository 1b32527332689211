/*
 * What of the city stands in a camera's way: rays against the triangles of buildings, bridges and tunnels, read from
 * the mapped package, and the ground below. Only chunks that have passed their check are looked into.
 */
#ifndef BLVD_RENDER_OBSTACLES_H
#define BLVD_RENDER_OBSTACLES_H

#include <stdbool.h>
#include <stdint.h>

#include "assets/pkg.h"
#include "assets/residency.h"

struct obstacles {
	const struct pkg *pkg;
	const struct residency *residency;
};

/* How far of the way `from` -> `to` (city frame, mm) is free of walls by `clear_m` metres: 0 to 1. */
double obstacles_reach(
	const struct obstacles *obstacles, const int64_t from_mm[3], const int64_t to_mm[3], double clear_m);

/* Adds the buildings that stand between two points to `objects` (indices into the package's, each once); returns how
 * many there are then, at most `room`. */
uint32_t obstacles_between(const struct obstacles *obstacles, const int64_t from_mm[3], const int64_t to_mm[3],
	uint32_t *objects, uint32_t count, uint32_t room);

/* Is there something solid straight above the point, within `up_m` metres? The eye is then inside a building (or under
 * a bridge, which is no fault). */
bool obstacles_covered(const struct obstacles *obstacles, const int64_t at_mm[3], double up_m);

/* Top of the highest building whose bounds hold the place, mm; INT64_MIN when there is none. */
int64_t obstacles_roof_mm(const struct obstacles *obstacles, int64_t east_mm, int64_t north_mm);

int64_t obstacles_ground_mm(const struct obstacles *obstacles, int64_t east_mm, int64_t north_mm);

#endif
