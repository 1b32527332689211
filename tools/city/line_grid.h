/*
 * A uniform grid over straight lines in integer millimetres: which lines may touch this one? Every line is listed in
 * every cell that it passes through, so a query misses none and returns some that do not touch. Cost: linear in lines
 * for evenly spread ones.
 */
#ifndef BLVD_TOOLS_CITY_LINE_GRID_H
#define BLVD_TOOLS_CITY_LINE_GRID_H

#include <stddef.h>
#include <stdint.h>

#include "tools/city/pool.h"

/* Coordinates stay within +-LINE_LIMIT_MM, so that products of differences fit into int64. */
#define LINE_LIMIT_MM 500000000

struct line_mm {
	int32_t ax, ay, bx, by;
};

struct line_grid {
	int64_t west, south, cell_mm;
	int64_t columns, rows;
	uint32_t *first; /* columns * rows + 1, into items */
	uint32_t *items;
	uint32_t *stamp, stamp_now; /* by line: met in the current query */
};

typedef ARRAY(uint32_t) index_array;

void line_grid_init(struct line_grid *grid, const struct line_mm *lines, size_t count);
void line_grid_finish(struct line_grid *grid);

/* Lines listed in the cells that a line, or a box around it grown by `margin_mm`, passes; each once. Replaces `out`. */
void line_grid_near(struct line_grid *grid, struct line_mm line, int64_t margin_mm, index_array *out);

/* Cell of a coordinate, clamped to the grid. */
static inline int64_t line_grid_column(const struct line_grid *grid, int64_t x)
{
	int64_t column = x < grid->west ? 0 : (x - grid->west) / grid->cell_mm;
	return column < grid->columns ? column : grid->columns - 1;
}
static inline int64_t line_grid_row(const struct line_grid *grid, int64_t y)
{
	int64_t row = y < grid->south ? 0 : (y - grid->south) / grid->cell_mm;
	return row < grid->rows ? row : grid->rows - 1;
}

/* > 0 when c lies to the left of a to b, 0 on the line. Exact. */
static inline int64_t line_side(int64_t ax, int64_t ay, int64_t bx, int64_t by, int64_t cx, int64_t cy)
{
	return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
}

#endif
