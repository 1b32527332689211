/* Items by where they are: a list of item numbers for every square of a grid. Boxes go into every square they touch. */
#ifndef BLVD_TOOLS_BAKE_BINS_H
#define BLVD_TOOLS_BAKE_BINS_H

#include <stdint.h>

#include "platform/base/vec.h"
#include "tools/city/pool.h"

struct bin_entry {
	int32_t row, col;
	uint32_t item;
};

struct bins {
	double step_m;
	ARRAY(struct bin_entry) entries; /* sorted by row, col, item once built */
	int32_t col0, row0, cols, rows;
	uint32_t *first; /* of cols * rows + 1 squares; owned */
};

struct bin_items {
	const struct bin_entry *entries;
	size_t count;
};

void bins_add(struct bins *bins, struct dvec2 min, struct dvec2 max, uint32_t item);
/* No adding after this. */
void bins_build(struct bins *bins);
void bins_finish(struct bins *bins);

struct bin_items bins_at(const struct bins *bins, int32_t col, int32_t row);
/* The items of the square that holds a place. */
struct bin_items bins_near(const struct bins *bins, struct dvec2 at);

#endif
