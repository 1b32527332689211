#include "tools/bake/segment_grid.h"

#include <math.h>
#include <stdlib.h>

#include "tools/city/pool.h"

#define CELL_LIMIT 4000000.0

static size_t cell_at(double offset, double cell_m, size_t count)
{
	double cell = floor(offset / cell_m);
	return cell <= 0.0 ? 0 : cell >= (double)count ? count - 1 : (size_t)cell;
}

struct cells {
	size_t x0, y0, x1, y1;
};

static struct cells cells_of(const struct segment_grid *grid, struct dvec2 min, struct dvec2 max)
{
	return (struct cells){ cell_at(min.x - grid->min.x, grid->cell_m, grid->columns),
		cell_at(min.y - grid->min.y, grid->cell_m, grid->rows),
		cell_at(max.x - grid->min.x, grid->cell_m, grid->columns),
		cell_at(max.y - grid->min.y, grid->cell_m, grid->rows) };
}

static struct cells cells_of_segment(const struct segment_grid *grid, const struct segment *segment)
{
	struct dvec2 min = { fmin(segment->a.x, segment->b.x), fmin(segment->a.y, segment->b.y) };
	struct dvec2 max = { fmax(segment->a.x, segment->b.x), fmax(segment->a.y, segment->b.y) };
	return cells_of(grid, min, max);
}

static void lay_out(struct segment_grid *grid, const struct segment *segments, size_t count, double cell_m)
{
	struct dvec2 min = { 0.0, 0.0 }, max = { 0.0, 0.0 };
	for (size_t i = 0; i < count; i++) {
		const struct segment *s = &segments[i];
		min.x = i ? fmin(min.x, fmin(s->a.x, s->b.x)) : fmin(s->a.x, s->b.x);
		min.y = i ? fmin(min.y, fmin(s->a.y, s->b.y)) : fmin(s->a.y, s->b.y);
		max.x = i ? fmax(max.x, fmax(s->a.x, s->b.x)) : fmax(s->a.x, s->b.x);
		max.y = i ? fmax(max.y, fmax(s->a.y, s->b.y)) : fmax(s->a.y, s->b.y);
	}
	while ((max.x - min.x) / cell_m * ((max.y - min.y) / cell_m) > CELL_LIMIT)
		cell_m *= 2.0;
	grid->cell_m = cell_m;
	grid->min = min;
	grid->columns = (size_t)((max.x - min.x) / cell_m) + 1;
	grid->rows = (size_t)((max.y - min.y) / cell_m) + 1;
}

void segment_grid_build(struct segment_grid *grid, const struct segment *segments, size_t count, double cell_m)
{
	lay_out(grid, segments, count, cell_m);
	grid->segments = segments;
	size_t cells = grid->columns * grid->rows, capacity = 0;
	grid->cell_first = array_grow(NULL, &capacity, cells + 2, sizeof(uint32_t));
	for (size_t i = 0; i < cells + 2; i++)
		grid->cell_first[i] = 0;
	/* Counting sort: sizes first, shifted by two so that filling leaves the starts in place. */
	size_t total = 0;
	for (size_t i = 0; i < count; i++) {
		struct cells c = cells_of_segment(grid, &segments[i]);
		for (size_t y = c.y0; y <= c.y1; y++)
			for (size_t x = c.x0; x <= c.x1; x++, total++)
				grid->cell_first[y * grid->columns + x + 2]++;
	}
	for (size_t i = 2; i < cells + 2; i++)
		grid->cell_first[i] += grid->cell_first[i - 1];
	capacity = 0;
	grid->items = array_grow(NULL, &capacity, total + 1, sizeof(uint32_t));
	for (size_t i = 0; i < count; i++) {
		struct cells c = cells_of_segment(grid, &segments[i]);
		for (size_t y = c.y0; y <= c.y1; y++)
			for (size_t x = c.x0; x <= c.x1; x++)
				grid->items[grid->cell_first[y * grid->columns + x + 1]++] = (uint32_t)i;
	}
}

void segment_grid_finish(struct segment_grid *grid)
{
	array_free(grid->cell_first);
	array_free(grid->items);
	*grid = (struct segment_grid){ 0 };
}

void segment_grid_visit(const struct segment_grid *grid, struct dvec2 min, struct dvec2 max,
	void (*visit)(void *context, const struct segment *segment), void *context)
{
	struct cells c = cells_of(grid, min, max);
	for (size_t y = c.y0; y <= c.y1; y++)
		for (size_t x = c.x0; x <= c.x1; x++) {
			size_t cell = y * grid->columns + x;
			for (uint32_t i = grid->cell_first[cell]; i < grid->cell_first[cell + 1]; i++)
				visit(context, &grid->segments[grid->items[i]]);
		}
}
