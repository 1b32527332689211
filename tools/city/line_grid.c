#include "tools/city/line_grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CELL_MIN_MM 4000
#define CELL_MAX_MM 256000

struct span_columns {
	int64_t from, to;
};

/* The columns that a line passes within one row, grown by a millimetre so that rounding loses none. */
static struct span_columns columns_in_row(const struct line_grid *grid, const struct line_mm *line, int64_t row)
{
	double low = (double)(grid->south + row * grid->cell_mm) - 1.0, high = low + (double)grid->cell_mm + 2.0;
	double ax = line->ax, ay = line->ay, bx = line->bx, by = line->by;
	double x0 = ax, x1 = bx;
	if (ay != by) {
		double slope = (bx - ax) / (by - ay);
		double at_low = ax + (low - ay) * slope, at_high = ax + (high - ay) * slope;
		x0 = fmax(fmin(ax, bx), fmin(at_low, at_high));
		x1 = fmin(fmax(ax, bx), fmax(at_low, at_high));
	}
	return (struct span_columns){
		line_grid_column(grid, (int64_t)floor(fmin(x0, x1)) - 1),
		line_grid_column(grid, (int64_t)ceil(fmax(x0, x1)) + 1),
	};
}

static int64_t low_of(int32_t a, int32_t b)
{
	return a < b ? a : b;
}

static int64_t high_of(int32_t a, int32_t b)
{
	return a > b ? a : b;
}

static void size_cells(struct line_grid *grid, const struct line_mm *lines, size_t count)
{
	int64_t east = INT64_MIN, north = INT64_MIN;
	grid->west = grid->south = INT64_MAX;
	for (size_t i = 0; i < count; i++) {
		grid->west = grid->west < low_of(lines[i].ax, lines[i].bx) ? grid->west : low_of(lines[i].ax, lines[i].bx);
		grid->south = grid->south < low_of(lines[i].ay, lines[i].by) ? grid->south : low_of(lines[i].ay, lines[i].by);
		east = east > high_of(lines[i].ax, lines[i].bx) ? east : high_of(lines[i].ax, lines[i].bx);
		north = north > high_of(lines[i].ay, lines[i].by) ? north : high_of(lines[i].ay, lines[i].by);
	}
	if (!count)
		grid->west = grid->south = east = north = 0;
	double area = (double)(east - grid->west + 1) * (double)(north - grid->south + 1);
	grid->cell_mm = (int64_t)fmin(fmax(sqrt(area / ((double)count + 1.0)), CELL_MIN_MM), CELL_MAX_MM);
	do {
		grid->columns = (east - grid->west) / grid->cell_mm + 1;
		grid->rows = (north - grid->south) / grid->cell_mm + 1;
		grid->cell_mm *= 2;
	} while (grid->columns * grid->rows > 8 * (int64_t)count + 65536);
	grid->cell_mm /= 2;
}

/* Counts (items NULL) or fills: the usual two passes of a counting sort by cell. */
static void list_line(struct line_grid *grid, const struct line_mm *line, uint32_t id, uint32_t *fill)
{
	int64_t top = line_grid_row(grid, high_of(line->ay, line->by));
	for (int64_t row = line_grid_row(grid, low_of(line->ay, line->by)); row <= top; row++) {
		struct span_columns span = columns_in_row(grid, line, row);
		for (int64_t column = span.from; column <= span.to; column++) {
			int64_t cell = row * grid->columns + column;
			if (fill)
				grid->items[fill[cell]++] = id;
			else
				grid->first[cell + 1]++;
		}
	}
}

void line_grid_init(struct line_grid *grid, const struct line_mm *lines, size_t count)
{
	*grid = (struct line_grid){ 0 };
	size_cells(grid, lines, count);
	size_t cells = (size_t)(grid->columns * grid->rows), capacity = 0;
	grid->first = array_grow(NULL, &capacity, cells + 1, sizeof(uint32_t));
	memset(grid->first, 0, (cells + 1) * sizeof(uint32_t));
	for (size_t i = 0; i < count; i++)
		list_line(grid, &lines[i], (uint32_t)i, NULL);
	for (size_t i = 0; i < cells; i++)
		grid->first[i + 1] += grid->first[i];
	capacity = 0;
	uint32_t *fill = array_grow(NULL, &capacity, cells + 1, sizeof(uint32_t));
	memcpy(fill, grid->first, cells * sizeof(uint32_t));
	capacity = 0;
	grid->items = array_grow(NULL, &capacity, (size_t)grid->first[cells] + 1, sizeof(uint32_t));
	for (size_t i = 0; i < count; i++)
		list_line(grid, &lines[i], (uint32_t)i, fill);
	array_free(fill);
	capacity = 0;
	grid->stamp = array_grow(NULL, &capacity, count + 1, sizeof(uint32_t));
	memset(grid->stamp, 0, (count + 1) * sizeof(uint32_t));
}

void line_grid_finish(struct line_grid *grid)
{
	array_free(grid->first);
	array_free(grid->items);
	array_free(grid->stamp);
	*grid = (struct line_grid){ 0 };
}

static void take_cell(struct line_grid *grid, int64_t cell, index_array *out)
{
	for (uint32_t i = grid->first[cell]; i < grid->first[cell + 1]; i++) {
		uint32_t line = grid->items[i];
		if (grid->stamp[line] == grid->stamp_now)
			continue;
		grid->stamp[line] = grid->stamp_now;
		ARRAY_PUSH(out, line);
	}
}

void line_grid_near(struct line_grid *grid, struct line_mm line, int64_t margin_mm, index_array *out)
{
	out->count = 0;
	grid->stamp_now++;
	int64_t bottom = line_grid_row(grid, low_of(line.ay, line.by) - margin_mm);
	int64_t top = line_grid_row(grid, high_of(line.ay, line.by) + margin_mm);
	for (int64_t row = bottom; row <= top; row++) {
		struct span_columns span = columns_in_row(grid, &line, row);
		if (margin_mm) {
			span.from = line_grid_column(grid, low_of(line.ax, line.bx) - margin_mm);
			span.to = line_grid_column(grid, high_of(line.ax, line.bx) + margin_mm);
		}
		for (int64_t column = span.from; column <= span.to; column++)
			take_cell(grid, row * grid->columns + column, out);
	}
}
