/*
 * Line segments in square cells, for questions about what is near: walls of neighbours, streets in front of a door.
 * Read-only once built, so threads may share it.
 */
#ifndef BLVD_TOOLS_BAKE_SEGMENT_GRID_H
#define BLVD_TOOLS_BAKE_SEGMENT_GRID_H

#include <stddef.h>
#include <stdint.h>

#include "platform/base/vec.h"

struct segment {
	struct dvec2 a, b;
	uint32_t owner; /* what the caller likes */
};

struct segment_grid {
	const struct segment *segments; /* borrowed */
	double cell_m;
	struct dvec2 min;
	size_t columns, rows;
	uint32_t *cell_first; /* columns * rows + 1 */
	uint32_t *items;      /* segment indices, ascending within a cell */
};

void segment_grid_build(struct segment_grid *grid, const struct segment *segments, size_t count, double cell_m);
void segment_grid_finish(struct segment_grid *grid);

/* Calls `visit` for every segment whose cells touch the box, some more than once. */
void segment_grid_visit(const struct segment_grid *grid, struct dvec2 min, struct dvec2 max,
	void (*visit)(void *context, const struct segment *segment), void *context);

#endif
