/* The view cell of a stretch (assets/pkg_format.h, PKG_STRC) in metres of the city frame: a box of eye positions. */
#ifndef BLVD_TOOLS_IMPOSTOR_VIEW_CELL_H
#define BLVD_TOOLS_IMPOSTOR_VIEW_CELL_H

#include "assets/pkg.h"
#include "platform/base/vec.h"

struct view_cell {
	struct dvec3 start, end; /* the axis, on the carriageway's surface */
	double half_width_m;     /* to either side */
	double overrun_m;        /* beyond either end */
	double eye_min_m, eye_max_m;
};

static inline struct view_cell view_cell_of(const struct pkg_stretch *stretch)
{
	return (struct view_cell){
		.start = { stretch->start_mm[0] * 1e-3, stretch->start_mm[1] * 1e-3, stretch->start_mm[2] * 1e-3 },
		.end = { stretch->end_mm[0] * 1e-3, stretch->end_mm[1] * 1e-3, stretch->end_mm[2] * 1e-3 },
		.half_width_m = stretch->half_width_mm * 1e-3,
		.overrun_m = stretch->overrun_mm * 1e-3,
		.eye_min_m = stretch->eye_min_mm * 1e-3,
		.eye_max_m = stretch->eye_max_mm * 1e-3,
	};
}

/* The other way round: what the cell along the twin half-edge sees. */
static inline struct view_cell view_cell_turned(const struct view_cell *cell)
{
	struct view_cell out = *cell;
	out.start = cell->end;
	out.end = cell->start;
	return out;
}

#endif
