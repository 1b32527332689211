#include "tools/city/box_index.h"

#include <string.h>

#define CELLS_LIMIT 4000000.0

struct cell_range {
	uint32_t col0, row0, col1, row1;
};

static uint32_t clamp_cell(double at, uint32_t count)
{
	return at <= 0.0 ? 0 : at >= count ? count - 1 : (uint32_t)at;
}

static struct cell_range range_of(const struct box_index *index, struct bounds box)
{
	return (struct cell_range){
		clamp_cell((box.min.x - index->origin.x) / index->cell_m, index->columns),
		clamp_cell((box.min.y - index->origin.y) / index->cell_m, index->rows),
		clamp_cell((box.max.x - index->origin.x) / index->cell_m, index->columns),
		clamp_cell((box.max.y - index->origin.y) / index->cell_m, index->rows),
	};
}

static void lay_out(struct box_index *index, size_t count, double cell_m)
{
	struct bounds all = count ? index->boxes[0] : (struct bounds){ { 0.0, 0.0 }, { 0.0, 0.0 } };
	for (size_t i = 1; i < count; i++) {
		all.min.x = fmin(all.min.x, index->boxes[i].min.x);
		all.min.y = fmin(all.min.y, index->boxes[i].min.y);
		all.max.x = fmax(all.max.x, index->boxes[i].max.x);
		all.max.y = fmax(all.max.y, index->boxes[i].max.y);
	}
	double width = all.max.x - all.min.x, height = all.max.y - all.min.y;
	while ((width / cell_m + 1.0) * (height / cell_m + 1.0) > CELLS_LIMIT)
		cell_m *= 2.0;
	index->origin = all.min;
	index->cell_m = cell_m;
	index->columns = (uint32_t)(width / cell_m) + 1;
	index->rows = (uint32_t)(height / cell_m) + 1;
}

void box_index_build(struct box_index *index, const struct bounds *boxes, size_t count, double cell_m)
{
	*index = (struct box_index){ .boxes = boxes };
	lay_out(index, count, cell_m);
	size_t cells = (size_t)index->columns * index->rows, capacity = 0;
	index->starts = array_grow(NULL, &capacity, cells + 2, sizeof(uint32_t));
	memset(index->starts, 0, (cells + 2) * sizeof(uint32_t));
	/* Counted one slot ahead, so that filling moves every start to its place. */
	for (size_t i = 0; i < count; i++) {
		struct cell_range range = range_of(index, boxes[i]);
		for (uint32_t row = range.row0; row <= range.row1; row++)
			for (uint32_t col = range.col0; col <= range.col1; col++)
				index->starts[(size_t)row * index->columns + col + 2]++;
	}
	for (size_t i = 2; i < cells + 2; i++)
		index->starts[i] += index->starts[i - 1];
	capacity = 0;
	index->items = array_grow(NULL, &capacity, index->starts[cells + 1] + 1, sizeof(uint32_t));
	for (size_t i = 0; i < count; i++) {
		struct cell_range range = range_of(index, boxes[i]);
		for (uint32_t row = range.row0; row <= range.row1; row++)
			for (uint32_t col = range.col0; col <= range.col1; col++)
				index->items[index->starts[(size_t)row * index->columns + col + 1]++] = (uint32_t)i;
	}
}

void box_index_finish(struct box_index *index)
{
	array_free(index->starts);
	array_free(index->items);
	*index = (struct box_index){ 0 };
}

void box_index_find(const struct box_index *index, struct bounds area, index_array *out)
{
	out->count = 0;
	struct cell_range range = range_of(index, area);
	for (uint32_t row = range.row0; row <= range.row1; row++) {
		for (uint32_t col = range.col0; col <= range.col1; col++) {
			size_t cell = (size_t)row * index->columns + col;
			for (uint32_t i = index->starts[cell]; i < index->starts[cell + 1]; i++) {
				uint32_t item = index->items[i];
				struct cell_range own = range_of(index, index->boxes[item]);
				/* A box in several of the cells counts in the first of them. */
				bool first = col == (own.col0 > range.col0 ? own.col0 : range.col0) &&
							 row == (own.row0 > range.row0 ? own.row0 : range.row0);
				if (first && bounds_touch(index->boxes[item], area))
					ARRAY_PUSH(out, item);
			}
		}
	}
}
