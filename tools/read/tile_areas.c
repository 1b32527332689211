#include "tools/read/tile_grid.h"

#include <stdlib.h>
#include <string.h>

#include "tools/city/box_index.h"

#define COMMON_UNITS 2.0 /* of wall, for two pieces to be one building */

static uint32_t root_of(uint32_t *parents, uint32_t i)
{
	while (parents[i] != i)
		i = parents[i] = parents[parents[i]];
	return i;
}

static bool same_tags(const struct osm_tags *a, const struct osm_tags *b)
{
	if (a->count != b->count)
		return false;
	for (size_t i = 0; i < a->count; i++) /* interned: equal texts are the same text */
		if (a->items[i].key != b->items[i].key || a->items[i].value != b->items[i].value)
			return false;
	return true;
}

static bool share_wall(const struct shaper *shaper, const struct polygon *a, const struct polygon *b)
{
	GEOSGeometry *first = shape_to_geos(shaper, a), *second = shape_to_geos(shaper, b);
	GEOSGeometry *common = first && second ? GEOSIntersection_r(shaper->geos, first, second) : NULL;
	double length = 0.0;
	if (common)
		GEOSLength_r(shaper->geos, common, &length);
	GEOSGeom_destroy_r(shaper->geos, first);
	GEOSGeom_destroy_r(shaper->geos, second);
	GEOSGeom_destroy_r(shaper->geos, common);
	return length > COMMON_UNITS;
}

static void find_groups(const tile_area_array *areas, const struct shaper *shaper, uint32_t *parents)
{
	bounds_array boxes = { 0 };
	index_array which = { 0 }, near = { 0 };
	struct box_index index;
	for (uint32_t i = 0; i < areas->count; i++) {
		struct bounds box;
		parents[i] = i;
		if (!areas->items[i].building || !areas->items[i].on_border)
			continue;
		ring_bounds(&areas->items[i].shape.outer, &box.min, &box.max);
		ARRAY_PUSH(&boxes, box);
		ARRAY_PUSH(&which, i);
	}
	box_index_build(&index, boxes.items, boxes.count, 200.0);
	for (size_t k = 0; k < which.count; k++) {
		uint32_t i = which.items[k];
		box_index_find(&index, boxes.items[k], &near);
		for (size_t n = 0; n < near.count; n++) {
			uint32_t j = which.items[near.items[n]];
			if (j > i && root_of(parents, i) != root_of(parents, j) &&
				same_tags(&areas->items[i].tags, &areas->items[j].tags) &&
				share_wall(shaper, &areas->items[i].shape, &areas->items[j].shape))
				parents[root_of(parents, j)] = root_of(parents, i);
		}
	}
	box_index_finish(&index);
	ARRAY_FINISH(&boxes);
	ARRAY_FINISH(&which);
	ARRAY_FINISH(&near);
}

/* `into` becomes the union of both; false when that is not one polygon. */
static bool join(const struct shaper *shaper, struct tile_area *into, const struct tile_area *other)
{
	polygon_array pieces = { 0 };
	GEOSGeometry *first = shape_to_geos(shaper, &into->shape), *second = shape_to_geos(shaper, &other->shape);
	GEOSGeometry *both = first && second ? GEOSUnion_r(shaper->geos, first, second) : NULL;
	bool joined = shape_from_geos(shaper, both, 1.0, &pieces) == 1;
	if (joined)
		into->shape = pieces.items[0];
	ARRAY_FINISH(&pieces);
	GEOSGeom_destroy_r(shaper->geos, first);
	GEOSGeom_destroy_r(shaper->geos, second);
	GEOSGeom_destroy_r(shaper->geos, both);
	return joined;
}

void tile_areas_join(tile_area_array *areas, struct pool *pool, struct report *report)
{
	struct shaper shaper;
	uint32_t *parents = malloc((areas->count + 1) * sizeof(*parents));
	bool *gone = calloc(areas->count + 1, sizeof(bool));
	if (!parents || !gone)
		abort();
	shaper_init(&shaper, pool, report);
	find_groups(areas, &shaper, parents);
	for (uint32_t i = 0; i < areas->count; i++) {
		uint32_t root = root_of(parents, i);
		if (root != i)
			gone[i] = join(&shaper, &areas->items[root], &areas->items[i]);
	}
	size_t kept = 0;
	for (size_t i = 0; i < areas->count; i++)
		if (!gone[i])
			areas->items[kept++] = areas->items[i];
	areas->count = kept;
	shaper_finish(&shaper);
	free(parents);
	free(gone);
}
