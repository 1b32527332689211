/* Which rectangles lie near a place: a grid of cells, each with a list. Built once, read by any number of threads. */
#ifndef BLVD_TOOLS_CITY_BOX_INDEX_H
#define BLVD_TOOLS_CITY_BOX_INDEX_H

#include <stdbool.h>
#include <stdint.h>

#include "platform/base/vec.h"
#include "tools/city/pool.h"

struct bounds {
	struct dvec2 min, max; /* city frame, m; min <= max */
};

typedef ARRAY(struct bounds) bounds_array;
typedef ARRAY(uint32_t) index_array;

struct box_index {
	const struct bounds *boxes; /* borrowed */
	struct dvec2 origin;
	double cell_m;
	uint32_t columns, rows;
	uint32_t *starts; /* columns * rows + 1 */
	uint32_t *items;
};

/* `cell_m` about as large as a box or a query; made larger when there would be too many cells. */
void box_index_build(struct box_index *index, const struct bounds *boxes, size_t count, double cell_m);
void box_index_finish(struct box_index *index);

/* The boxes that touch `area`, each once, ascending within a cell; replaces what `out` held. */
void box_index_find(const struct box_index *index, struct bounds area, index_array *out);

static inline struct bounds bounds_grown(struct bounds box, double by_m)
{
	return (struct bounds){ { box.min.x - by_m, box.min.y - by_m }, { box.max.x + by_m, box.max.y + by_m } };
}

static inline bool bounds_touch(struct bounds a, struct bounds b)
{
	return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

#endif
