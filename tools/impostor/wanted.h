/* Which pixels of a capture of the far set are ever seen: texels that stay hidden behind the near set are not stored.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_WANTED_H
#define BLVD_TOOLS_IMPOSTOR_WANTED_H

#include <stddef.h>
#include <stdint.h>

#include "tools/impostor/capture.h"

/*
 * `poses` show near and far set together, from poses that cover the view cell (several faces of one pose are several
 * images); colour is not used. `wanted` gets one byte a pixel of `far`: 1 where its point is seen in some of `poses`,
 * within a pixel there, or lies within `margin_px` pixels of such a point, and something is there; else 0. Poses
 * between those given see a little more: the margin is for them; at least 2.
 */
void impostor_wanted(const struct capture_image *poses, size_t pose_count, const struct capture_image *far,
	unsigned margin_px, uint8_t *wanted);

#endif
