/* The ground between the posts of a height grid: linear on two triangles a square, split from south-west to north-east,
 * header only. */
#ifndef BLVD_ASSETS_HEIGHT_GRID_H
#define BLVD_ASSETS_HEIGHT_GRID_H

#include <math.h>

#include "assets/pkg_format.h"

/* Height in mm at a place of the city frame (mm), clamped to the grid's edge outside it; 0 for an empty grid. */
static inline double height_grid_at(
	const struct pkg_height_grid *grid, const int32_t *height_mm, double east_mm, double north_mm)
{
	if (grid->columns < 2 || grid->rows < 2)
		return 0.0;
	double x = (east_mm - grid->origin_mm[0]) / grid->step_mm, y = (north_mm - grid->origin_mm[1]) / grid->step_mm;
	x = fmin(fmax(x, 0.0), grid->columns - 1.0);
	y = fmin(fmax(y, 0.0), grid->rows - 1.0);
	uint32_t col = (uint32_t)fmin(floor(x), grid->columns - 2.0), row = (uint32_t)fmin(floor(y), grid->rows - 2.0);
	const int32_t *south = height_mm + (size_t)row * grid->columns + col;
	const int32_t *north = south + grid->columns;
	double fx = x - col, fy = y - row;
	double sw = south[0], se = south[1], nw = north[0], ne = north[1];
	if (fx >= fy)
		return sw + (se - sw) * fx + (ne - se) * fy;
	return sw + (ne - nw) * fx + (nw - sw) * fy;
}

#endif
