/*
 * The borders between unlike faces of a partition, drawn anew and straighter in another one. What cuts a face into
 * like parts is left out: outlines hidden under others cost no triangles.
 */
#ifndef BLVD_TOOLS_BAKE_BORDERS_H
#define BLVD_TOOLS_BAKE_BORDERS_H

#include "tools/bake/partition.h"

/* How far the border between two faces may move, in metres; negative: they are alike, no border. */
typedef double (*border_tolerance_fn)(const void *context, uint32_t face_a, uint32_t face_b);

/* Cuts the borders of `from`, whose faces are found, into `to`. Ends, forks and places on the rectangle's border stay.
 */
void borders_redraw(
	const struct partition *from, border_tolerance_fn tolerance, const void *context, struct partition *to);

#endif
