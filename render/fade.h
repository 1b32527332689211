/*
 * Buildings that stand between the eye and the route's next part fade, so that the driver sees where it goes. Fading in
 * and out is eased over simulated time. What finds no place in the table stays solid.
 */
#ifndef BLVD_RENDER_FADE_H
#define BLVD_RENDER_FADE_H

#include <stdbool.h>
#include <stdint.h>

#include "render/obstacles.h"

#define FADE_OBJECTS_MAX 32
#define FADE_POINTS_MAX 16

struct fade_entry {
	uint32_t object; /* into the package's objects */
	float opacity;   /* 0 to 1 */
	bool wanted;     /* stands in the way now */
};
struct fade {
	struct fade_entry entries[FADE_OBJECTS_MAX];
	uint32_t count;
	float opacity; /* of what stands in the way; set by the caller */
	int64_t time_ns;
};

/* `points_mm` are the places that should be seen; at most FADE_POINTS_MAX. A step back in time, or a first call, shows
 * the final state at once. */
void fade_update(struct fade *fade, const struct obstacles *obstacles, const int64_t eye_mm[3],
	const int64_t (*points_mm)[3], uint32_t count, int64_t time_ns);

#endif
