#include "tools/bake/bins.h"

#include <assert.h>

#include <math.h>
#include <stdlib.h>

#define SPAN_MAX 4096 /* squares in one direction: a feature from the other end of the world is not binned there */

static int32_t square(double at, double step)
{
	return (int32_t)floor(fmin(fmax(at / step, -1e6), 1e6));
}

void bins_add(struct bins *bins, struct dvec2 min, struct dvec2 max, uint32_t item)
{
	int32_t col0 = square(min.x, bins->step_m), col1 = square(max.x, bins->step_m);
	int32_t row0 = square(min.y, bins->step_m), row1 = square(max.y, bins->step_m);
	if (col1 - col0 > SPAN_MAX || row1 - row0 > SPAN_MAX)
		return;
	for (int32_t row = row0; row <= row1; row++)
		for (int32_t col = col0; col <= col1; col++)
			ARRAY_PUSH(&bins->entries, (struct bin_entry){ row, col, item });
}

static int compare(const void *left, const void *right)
{
	const struct bin_entry *a = left, *b = right;
	if (a->row != b->row)
		return a->row < b->row ? -1 : 1;
	if (a->col != b->col)
		return a->col < b->col ? -1 : 1;
	return (a->item > b->item) - (a->item < b->item);
}

void bins_build(struct bins *bins)
{
	size_t count = bins->entries.count;
	if (!count)
		return;
	qsort(bins->entries.items, count, sizeof(*bins->entries.items), compare);
	int32_t col_min = INT32_MAX, col_max = INT32_MIN;
	for (size_t i = 0; i < count; i++) {
		col_min = bins->entries.items[i].col < col_min ? bins->entries.items[i].col : col_min;
		col_max = bins->entries.items[i].col > col_max ? bins->entries.items[i].col : col_max;
	}
	bins->row0 = bins->entries.items[0].row;
	bins->rows = bins->entries.items[count - 1].row - bins->row0 + 1;
	bins->col0 = col_min;
	bins->cols = col_max - col_min + 1;
	assert(bins->rows > 0 && bins->cols > 0);
	size_t squares = (size_t)bins->rows * (size_t)bins->cols;
	bins->first = array_grow(NULL, &(size_t){ 0 }, squares + 1, sizeof(uint32_t));
	size_t at = 0, k = 0;
	for (int32_t row = bins->row0; row < bins->row0 + bins->rows; row++) {
		for (int32_t col = bins->col0; col < bins->col0 + bins->cols; col++) {
			bins->first[k++] = (uint32_t)at;
			while (at < count && bins->entries.items[at].row == row && bins->entries.items[at].col == col)
				at++;
		}
	}
	bins->first[squares] = (uint32_t)at;
}

void bins_finish(struct bins *bins)
{
	ARRAY_FINISH(&bins->entries);
	array_free(bins->first);
	bins->first = NULL;
}

struct bin_items bins_at(const struct bins *bins, int32_t col, int32_t row)
{
	col -= bins->col0;
	row -= bins->row0;
	if (!bins->first || col < 0 || row < 0 || col >= bins->cols || row >= bins->rows)
		return (struct bin_items){ 0 };
	size_t k = (size_t)row * (size_t)bins->cols + (size_t)col;
	return (struct bin_items){ bins->entries.items + bins->first[k], bins->first[k + 1] - bins->first[k] };
}

struct bin_items bins_near(const struct bins *bins, struct dvec2 at)
{
	return bins_at(bins, square(at.x, bins->step_m), square(at.y, bins->step_m));
}
