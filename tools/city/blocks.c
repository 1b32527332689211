/* Buildings to their blocks: first the streets are cleared of them, then each one's inner point is looked up. */
#include <math.h>

#include "tools/bake/bake.h"
#include "tools/city/corridor.h"
#include "tools/city/graph.h"

/* Takes out the buildings without a footprint and keeps `outline` pointing at the right ones. */
static void drop_empty(struct city *city)
{
	size_t capacity = 0, kept = 0;
	uint32_t *moved = array_grow(NULL, &capacity, city->buildings.count + 1, sizeof(uint32_t));
	for (size_t i = 0; i < city->buildings.count; i++)
		moved[i] = city->buildings.items[i].footprint.outer.count < 3 ? PKG_NONE : (uint32_t)kept++;
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct building building = city->buildings.items[i];
		if (moved[i] == PKG_NONE)
			continue;
		if (building.outline != PKG_NONE)
			building.outline = moved[building.outline];
		city->buildings.items[moved[i]] = building;
	}
	city->buildings.count = kept;
	array_free(moved);
}

static double lowest_ground(const struct city *city, const struct polygon *footprint)
{
	double lowest = city_ground(city, polygon_inner_point(footprint));
	for (size_t i = 0, j = footprint->outer.count - 1; i < footprint->outer.count; j = i++) {
		struct dvec2 a = footprint->outer.points[j], b = footprint->outer.points[i];
		int steps = (int)fmin(ceil(dvec2_length(dvec2_sub(b, a)) / 5.0), 100.0);
		for (int k = 1; k <= steps; k++)
			lowest = fmin(lowest, city_ground(city, dvec2_add(a, dvec2_scale(dvec2_sub(b, a), (double)k / steps))));
	}
	return lowest;
}

void blocks_assign(struct city *city, const struct pkg_graph *graph)
{
	corridor_clear(city, graph);
	drop_empty(city);
	struct face_locator *locator = face_locator_new(graph);
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct building *building = &city->buildings.items[i];
		struct dvec2 inner = polygon_inner_point(&building->footprint);
		building->face = face_locator_find(locator, llround(inner.x * 1000.0), llround(inner.y * 1000.0));
		building->ground_m = lowest_ground(city, &building->footprint);
	}
	face_locator_free(locator);
	/* What belongs to one building is drawn in one block, and stands on one ground. */
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct building *part = &city->buildings.items[i];
		if (part->outline == PKG_NONE)
			continue;
		part->face = city->buildings.items[part->outline].face;
		part->ground_m = fmin(part->ground_m, city->buildings.items[part->outline].ground_m);
	}
}
