#include "tools/city/city.h"

#include <math.h>
#include <stdlib.h>

#include "assets/height_grid.h"

void city_finish(struct city *city)
{
	ARRAY_FINISH(&city->ways);
	ARRAY_FINISH(&city->restrictions);
	ARRAY_FINISH(&city->buildings);
	ARRAY_FINISH(&city->areas);
	ARRAY_FINISH(&city->lines);
	ARRAY_FINISH(&city->trees);
	free(city->terrain.height_mm);
	city->terrain = (struct terrain){ 0 };
	pool_finish(&city->pool);
}

double ring_area(const struct ring *ring)
{
	double twice = 0.0;
	for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++)
		twice += dvec2_cross(dvec2_sub(ring->points[j], ring->points[0]), dvec2_sub(ring->points[i], ring->points[0]));
	return twice / 2.0;
}

bool ring_contains(const struct ring *ring, struct dvec2 at)
{
	bool inside = false;
	for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++) {
		struct dvec2 a = ring->points[i], b = ring->points[j];
		if ((a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x))
			inside = !inside;
	}
	return inside;
}

bool polygon_contains(const struct polygon *polygon, struct dvec2 at)
{
	if (!ring_contains(&polygon->outer, at))
		return false;
	for (size_t i = 0; i < polygon->hole_count; i++)
		if (ring_contains(&polygon->holes[i], at))
			return false;
	return true;
}

void ring_bounds(const struct ring *ring, struct dvec2 *min, struct dvec2 *max)
{
	*min = *max = ring->points[0];
	for (size_t i = 1; i < ring->count; i++) {
		min->x = fmin(min->x, ring->points[i].x);
		min->y = fmin(min->y, ring->points[i].y);
		max->x = fmax(max->x, ring->points[i].x);
		max->y = fmax(max->y, ring->points[i].y);
	}
}

double city_ground(const struct city *city, struct dvec2 at)
{
	return height_grid_at(&city->terrain.grid, city->terrain.height_mm, at.x * 1000.0, at.y * 1000.0) / 1000.0;
}
