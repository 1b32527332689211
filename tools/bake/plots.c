#include "tools/bake/buildings.h"

#include <math.h>

/* Distance of p from the line a b, and whether it lies between the ends. */
static bool on_line(struct dvec2 a, struct dvec2 p, struct dvec2 b)
{
	struct dvec2 ab = dvec2_sub(b, a), ap = dvec2_sub(p, a);
	double length = dvec2_length(ab);
	if (length < 1e-6)
		return true;
	double along = dvec2_dot(ap, ab) / length;
	return fabs(dvec2_cross(ab, ap)) / length < 0.015 && along > 0.0 && along < length;
}

static bool is_spike(struct dvec2 a, struct dvec2 p, struct dvec2 b)
{
	struct dvec2 in = dvec2_sub(p, a), out = dvec2_sub(b, p);
	double cross = dvec2_cross(in, out), dot = dvec2_dot(in, out);
	return dot < 0.0 && fabs(cross) < 0.01 * -dot;
}

size_t ring_clean(struct dvec2 *points, size_t count)
{
	size_t kept = count + 1;
	while (count >= 3 && count < kept) {
		kept = count;
		size_t out = 0;
		for (size_t i = 0; i < kept; i++) {
			struct dvec2 before = out ? points[out - 1] : points[kept - 1], at = points[i];
			struct dvec2 after = points[i + 1 < kept ? i + 1 : 0];
			bool drop =
				dvec2_length(dvec2_sub(at, before)) < 0.02 || on_line(before, at, after) || is_spike(before, at, after);
			if (!drop || kept - (i - out) <= 3)
				points[out++] = at;
		}
		count = out;
		if (count == 3)
			break;
	}
	return count;
}

static bool take_ring(struct plots *plots, const struct ring *ring)
{
	size_t first = plots->points.count;
	for (size_t i = 0; i < ring->count; i++)
		if (isfinite(ring->points[i].x) && isfinite(ring->points[i].y))
			ARRAY_PUSH(&plots->points, ring->points[i]);
	size_t count = ring_clean(plots->points.items + first, plots->points.count - first);
	struct ring clean = { plots->points.items + first, count };
	if (count < 3 || fabs(ring_area(&clean)) < 0.5) {
		plots->points.count = first;
		return false;
	}
	plots->points.count = first + count;
	ARRAY_PUSH(&plots->ring_first, first);
	return true;
}

/* The smallest rectangle around the outer ring has a side along one of its edges, or nearly so. */
static void measure(struct plot *plot, const struct dvec2 *points, size_t count, double area)
{
	double best = INFINITY, width = 1.0;
	for (size_t i = 0; i < count; i++) {
		struct dvec2 along = dvec2_sub(points[i + 1 < count ? i + 1 : 0], points[i]);
		double length = dvec2_length(along);
		if (length < 0.5 && best < INFINITY)
			continue;
		along = dvec2_scale(along, 1.0 / length);
		double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
		for (size_t k = 0; k < count; k++) {
			double at[2] = { dvec2_dot(points[k], along), dvec2_cross(along, points[k]) };
			for (int axis = 0; axis < 2; axis++) {
				low[axis] = fmin(low[axis], at[axis]);
				high[axis] = fmax(high[axis], at[axis]);
			}
		}
		double l = high[0] - low[0], w = high[1] - low[1];
		if (l * w < best - 1e-6) {
			best = l * w;
			width = fmin(l, w);
			plot->axis = l >= w ? along : (struct dvec2){ -along.y, along.x };
		}
	}
	plot->half_width = width / 2.0;
	plot->fill = best > 0.0 ? area / best : 1.0;
}

static double usual_rise(const struct plot *plot, const struct building *building, double height)
{
	double w = plot->half_width;
	bool spire = building->kind == BUILDING_CHURCH || building->kind == BUILDING_TOWER;
	switch (plot->roof) {
	case ROOF_GABLED:
	case ROOF_HIPPED:
	case ROOF_HALF_HIPPED:
		return fmin(fmin(w * 0.7, 0.45 * height), building->kind == BUILDING_CHURCH ? 12.0 : 5.0);
	case ROOF_PYRAMIDAL:
	case ROOF_CONE:
		return fmin(w * (spire ? 3.0 : 0.9), 0.5 * height);
	case ROOF_DOME:
		return fmin(w, 0.6 * height);
	case ROOF_ONION:
		return fmin(w * 2.2, 0.6 * height);
	case ROOF_MANSARD:
		return fmin(fmin(3.6, w), 0.4 * height);
	case ROOF_GAMBREL:
		return fmin(w * 0.9, 0.45 * height);
	case ROOF_ROUND:
		return fmin(w * 0.6, 0.5 * height);
	case ROOF_SKILLION:
		return fmin(w * 0.4, 0.4 * height);
	case ROOF_FLAT:
	case ROOF_UNKNOWN:
		break;
	}
	return 0.0;
}

static void set_heights(struct plot *plot, const struct building *building)
{
	double height = building->height_m > 0.5 ? building->height_m : 3.0;
	double low = building->min_height_m > 0.0 && building->min_height_m < height - 0.2 ? building->min_height_m : 0.0;
	plot->ground = isfinite(building->ground_m) ? building->ground_m : 0.0;
	plot->top = plot->ground + height;
	plot->base = low > 0.0 ? plot->ground + low : plot->ground - FOOT_M;
	plot->roof = building->roof_shape;
	double rise = building->roof_height_m > 0.0 ? building->roof_height_m : usual_rise(plot, building, height - low);
	if (plot->roof == ROOF_FLAT || plot->roof == ROOF_UNKNOWN)
		rise = 0.0;
	rise = fmin(rise, height - low);
	plot->eaves = plot->top - (rise > 0.3 ? rise : 0.0);
	if (rise <= 0.3)
		plot->roof = ROOF_FLAT;
}

static void add_site(struct plots *plots, const struct building *building)
{
	struct plot plot = { .first_point = plots->points.count, .first_ring = plots->ring_first.count };
	bool drawn = !building->has_parts && !building->walls_3d && building->footprint.outer.count >= 3;
	if (drawn && !take_ring(plots, &building->footprint.outer)) {
		report_fault(plots->city->report, FAULT_DEGENERATE_RING, FAULT_DROPPED, building->id);
		drawn = false;
	}
	if (drawn) {
		plot.building = building;
		size_t outer = plots->points.count - plot.first_point;
		double area = ring_area(&(struct ring){ plots->points.items + plot.first_point, outer });
		plot.ring_count = 1;
		for (size_t i = 0; i < building->footprint.hole_count; i++)
			plot.ring_count += take_ring(plots, &building->footprint.holes[i]);
		ARRAY_PUSH(&plots->ring_first, plots->points.count);
		measure(&plot, plots->points.items + plot.first_point, outer, area);
		set_heights(&plot, building);
	}
	ARRAY_PUSH(&plots->plots, plot);
}

static void add_walls(struct plots *plots, uint32_t index)
{
	const struct plot *plot = &plots->plots.items[index];
	/* A canopy has no walls that could hide a neighbour's. */
	if (!plot->building || plot->building->kind == BUILDING_ROOF)
		return;
	for (size_t r = 0; r < plot->ring_count; r++) {
		size_t first = plots->ring_first.items[plot->first_ring + r],
			   end = plots->ring_first.items[plot->first_ring + r + 1];
		for (size_t i = first; i < end; i++)
			ARRAY_PUSH(&plots->walls,
				(struct segment){ plots->points.items[i], plots->points.items[i + 1 < end ? i + 1 : first], index });
	}
}

static void add_way(struct plots *plots, uint32_t index)
{
	const struct way *way = &plots->city->ways.items[index];
	if (way->tunnel || way->street_class == WAY_RAIL || way->street_class == WAY_TRAM ||
		way->street_class == WAY_TRACK || way->street_class == WAY_STEPS)
		return;
	for (size_t i = 0; i + 1 < way->node_count; i++)
		ARRAY_PUSH(&plots->ways, (struct segment){ way->nodes[i].at, way->nodes[i + 1].at, index });
}

void plots_build(const struct city *city, struct plots *out)
{
	*out = (struct plots){ .city = city };
	for (size_t i = 0; i < city->buildings.count; i++)
		add_site(out, &city->buildings.items[i]);
	for (size_t i = 0; i < city->buildings.count; i++)
		add_walls(out, (uint32_t)i);
	for (size_t i = 0; i < city->ways.count; i++)
		add_way(out, (uint32_t)i);
	segment_grid_build(&out->wall_grid, out->walls.items, out->walls.count, 16.0);
	segment_grid_build(&out->way_grid, out->ways.items, out->ways.count, 32.0);
}

void plots_finish(struct plots *plots)
{
	segment_grid_finish(&plots->wall_grid);
	segment_grid_finish(&plots->way_grid);
	ARRAY_FINISH(&plots->plots);
	ARRAY_FINISH(&plots->points);
	ARRAY_FINISH(&plots->ring_first);
	ARRAY_FINISH(&plots->walls);
	ARRAY_FINISH(&plots->ways);
}
