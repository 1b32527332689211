/*
 * Exact constrained Delaunay triangulation of points and segments on an integer lattice.
 *
 * Points go in one by one with Lawson's flips (Lawson 1977, "Software for C1 Surface Interpolation"); segments are then
 * forced by flipping the edges that they cross (Sloan 1993, "A fast algorithm for generating constrained Delaunay
 * triangulations"). Orientation and in-circle tests are exact in 128 bits, so collinear, cocircular and duplicate
 * points need no epsilon. Segments that cross are cut at the lattice point nearest to their crossing, which may move
 * them by up to half a lattice unit.
 *
 * The triangulation covers the rectangle spanned by `min` and `max` of struct cdt_config, whose corners are added as
 * points.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_CDT_H
#define BLVD_TOOLS_IMPOSTOR_CDT_H

#include <stdbool.h>
#include <stdint.h>

#include "tools/city/pool.h"

#define CDT_COORDINATE_MAX (1 << 20)
#define CDT_NONE UINT32_MAX

struct cdt_point {
	int32_t x, y; /* within +-CDT_COORDINATE_MAX */
};

/* Counter-clockwise. Side i lies opposite corner i. */
struct cdt_triangle {
	uint32_t corner[3];
	uint32_t neighbour[3]; /* across side i, or CDT_NONE at the rectangle's border */
	bool fixed[3];         /* side i is part of a segment */
};

struct cdt {
	ARRAY(struct cdt_point) points; /* as added, duplicates merged; the first four are the rectangle's corners */
	ARRAY(struct cdt_triangle) triangles;
	ARRAY(uint32_t) stack; /* sides still to be checked: triangle * 3 + side */
	ARRAY(uint32_t) crossed;
	ARRAY(uint32_t) triangle_of; /* one triangle at each point */
	uint32_t last;               /* where the walk starts */
	uint64_t cuts;               /* points made where segments crossed */
	uint64_t dropped;            /* segments given up after too many cuts; 0 but for adversarial input */
};

/* The rectangle must not be empty. */
void cdt_init(struct cdt *cdt, struct cdt_point min, struct cdt_point max);
void cdt_finish(struct cdt *cdt);

/* Adds a point of the rectangle and returns its index; an equal point returns the index it has. */
uint32_t cdt_add_point(struct cdt *cdt, struct cdt_point point);

/* Forces the segment between two points; through points that lie on it. Equal ends do nothing. */
void cdt_add_segment(struct cdt *cdt, uint32_t from, uint32_t to);

/* > 0 when a, b, c turn left. */
int cdt_orientation(struct cdt_point a, struct cdt_point b, struct cdt_point c);
/* > 0 when d is inside the circle through a, b, c (counter-clockwise). */
int cdt_in_circle(struct cdt_point a, struct cdt_point b, struct cdt_point c, struct cdt_point d);

/* Checks every invariant: orientation, neighbours, area, local Delaunay property but across fixed sides. For tests. */
bool cdt_is_sound(const struct cdt *cdt);

#endif
