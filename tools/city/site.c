#include "tools/city/site.h"

#include <stdlib.h>
#include <string.h>

#define CELL_M 25.0
#define BLUR_CELLS 3 /* twice: some 100 m around */
#define CELLS_LIMIT 16000000.0
#define TOUCH_M 0.35
#define FRONT_M 14.0 /* from the edge of the carriageway */
#define NEIGHBOUR_LEAST_M2 40.0

/* The smallest rectangle has a side along an edge of the convex hull; trying the footprint's own edges finds it for
 * buildings, whose hulls are made of their walls. */
static void measure_rectangle(const struct ring *ring, struct site *site)
{
	double best = INFINITY;
	for (size_t i = 0; i < ring->count; i++) {
		struct dvec2 a = ring->points[i], b = ring->points[(i + 1) % ring->count], along = dvec2_sub(b, a);
		double length = dvec2_length(along), u0 = INFINITY, u1 = -INFINITY, v0 = INFINITY, v1 = -INFINITY;
		if (length < 0.5)
			continue;
		along = dvec2_scale(along, 1.0 / length);
		for (size_t j = 0; j < ring->count; j++) {
			struct dvec2 d = dvec2_sub(ring->points[j], a);
			double u = dvec2_dot(along, d), v = dvec2_cross(along, d);
			u0 = fmin(u0, u);
			u1 = fmax(u1, u);
			v0 = fmin(v0, v);
			v1 = fmax(v1, v);
		}
		if ((u1 - u0) * (v1 - v0) < best) {
			best = (u1 - u0) * (v1 - v0);
			site->narrow_m = fmin(u1 - u0, v1 - v0);
			site->long_m = fmax(u1 - u0, v1 - v0);
		}
	}
}

static double perimeter(const struct polygon *polygon)
{
	double length = 0.0;
	for (size_t r = 0; r <= polygon->hole_count; r++) {
		const struct ring *ring = r ? &polygon->holes[r - 1] : &polygon->outer;
		for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++)
			length += dvec2_length(dvec2_sub(ring->points[i], ring->points[j]));
	}
	return length;
}

static void measure(const struct building *building, struct site *site)
{
	const struct polygon *footprint = &building->footprint;
	struct bounds box;
	ring_bounds(&footprint->outer, &box.min, &box.max);
	site->centre = dvec2_scale(dvec2_add(box.min, box.max), 0.5);
	site->area_m2 = fabs(ring_area(&footprint->outer));
	for (size_t i = 0; i < footprint->hole_count; i++)
		site->area_m2 -= fabs(ring_area(&footprint->holes[i]));
	site->narrow_m = box.max.x - box.min.x;
	site->long_m = box.max.y - box.min.y;
	measure_rectangle(&footprint->outer, site);
	double around = fmax(site->narrow_m * site->long_m, 1e-6);
	site->filled = fmin(site->area_m2 / around, 1.0);
	/* 2 area / perimeter is the depth of a long strip and half that of a square. */
	site->span_m = fmin(site->narrow_m, 4.0 * site->area_m2 / fmax(perimeter(footprint), 1e-6));
	site->street_class = -1;
}

struct density_grid {
	struct dvec2 origin;
	double cell_m;
	size_t columns, rows;
	float *cells;
};

static void grid_init(struct density_grid *grid, const struct city *city)
{
	grid->cell_m = CELL_M;
	double width = city->max.x - city->min.x, height = city->max.y - city->min.y;
	while ((width / grid->cell_m + 1.0) * (height / grid->cell_m + 1.0) > CELLS_LIMIT)
		grid->cell_m *= 2.0;
	grid->origin = city->min;
	grid->columns = (size_t)(width / grid->cell_m) + 1;
	grid->rows = (size_t)(height / grid->cell_m) + 1;
	size_t capacity = 0;
	grid->cells = array_grow(NULL, &capacity, grid->columns * grid->rows, sizeof(float));
	memset(grid->cells, 0, grid->columns * grid->rows * sizeof(float));
}

static size_t cell_of(double at, double origin, double cell_m, size_t count)
{
	double cell = (at - origin) / cell_m;
	return cell <= 0.0 ? 0 : cell >= (double)count ? count - 1 : (size_t)cell;
}

/* The footprint's area, spread over its bounding box. */
static void grid_add(struct density_grid *grid, struct bounds box, double area_m2)
{
	size_t col0 = cell_of(box.min.x, grid->origin.x, grid->cell_m, grid->columns);
	size_t col1 = cell_of(box.max.x, grid->origin.x, grid->cell_m, grid->columns);
	size_t row0 = cell_of(box.min.y, grid->origin.y, grid->cell_m, grid->rows);
	size_t row1 = cell_of(box.max.y, grid->origin.y, grid->cell_m, grid->rows);
	double share = area_m2 / (double)((col1 - col0 + 1) * (row1 - row0 + 1)) / (grid->cell_m * grid->cell_m);
	for (size_t row = row0; row <= row1; row++)
		for (size_t col = col0; col <= col1; col++)
			grid->cells[row * grid->columns + col] += (float)share;
}

static void blur_line(float *line, size_t count, size_t stride, float *spare)
{
	for (size_t i = 0; i < count; i++) {
		double sum = 0.0;
		size_t low = i > BLUR_CELLS ? i - BLUR_CELLS : 0, high = i + BLUR_CELLS < count ? i + BLUR_CELLS : count - 1;
		for (size_t j = low; j <= high; j++)
			sum += (double)line[j * stride];
		spare[i] = (float)(sum / (double)(high - low + 1));
	}
	for (size_t i = 0; i < count; i++)
		line[i * stride] = spare[i];
}

static void grid_blur(struct density_grid *grid)
{
	size_t most = grid->columns > grid->rows ? grid->columns : grid->rows, capacity = 0;
	float *spare = array_grow(NULL, &capacity, most, sizeof(float));
	for (int pass = 0; pass < 2; pass++) {
		for (size_t row = 0; row < grid->rows; row++)
			blur_line(grid->cells + row * grid->columns, grid->columns, 1, spare);
		for (size_t col = 0; col < grid->columns; col++)
			blur_line(grid->cells + col, grid->rows, grid->columns, spare);
	}
	array_free(spare);
}

static double distance_to_segment(struct dvec2 at, struct dvec2 a, struct dvec2 b)
{
	struct dvec2 along = dvec2_sub(b, a), to = dvec2_sub(at, a);
	double squared = dvec2_dot(along, along);
	double t = squared > 0.0 ? fmin(fmax(dvec2_dot(along, to) / squared, 0.0), 1.0) : 0.0;
	return dvec2_length(dvec2_sub(to, dvec2_scale(along, t)));
}

static double distance_to_ring(struct dvec2 at, const struct ring *ring)
{
	double least = INFINITY;
	for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++)
		least = fmin(least, distance_to_segment(at, ring->points[j], ring->points[i]));
	return least;
}

static bool touches(const struct building *a, const struct building *b)
{
	for (size_t i = 0; i < a->footprint.outer.count; i++)
		if (distance_to_ring(a->footprint.outer.points[i], &b->footprint.outer) < TOUCH_M)
			return true;
	for (size_t i = 0; i < b->footprint.outer.count; i++)
		if (distance_to_ring(b->footprint.outer.points[i], &a->footprint.outer) < TOUCH_M)
			return true;
	return false;
}

static void find_attached(struct sites *sites, const struct city *city)
{
	index_array near = { 0 };
	for (size_t i = 0; i < city->buildings.count; i++) {
		if (city->buildings.items[i].is_part)
			continue;
		box_index_find(&sites->index, bounds_grown(sites->boxes.items[i], TOUCH_M), &near);
		for (size_t k = 0; k < near.count && !sites->items[i].attached; k++) {
			size_t j = near.items[k];
			if (j == i || city->buildings.items[j].is_part || sites->items[j].area_m2 < NEIGHBOUR_LEAST_M2)
				continue;
			sites->items[i].attached = touches(&city->buildings.items[i], &city->buildings.items[j]);
		}
	}
	ARRAY_FINISH(&near);
}

struct street_piece {
	struct dvec2 a, b;
	double half_width_m;
	int street_class;
};
typedef ARRAY(struct street_piece) piece_array;

static void gather_streets(const struct city *city, piece_array *pieces, bounds_array *boxes)
{
	for (size_t i = 0; i < city->ways.count; i++) {
		const struct way *way = &city->ways.items[i];
		bool street = way->street_class < PKG_STREET_SERVICE || way->street_class == WAY_PEDESTRIAN;
		for (size_t j = 1; street && !way->tunnel && j < way->node_count; j++) {
			struct dvec2 a = way->nodes[j - 1].at, b = way->nodes[j].at;
			ARRAY_PUSH(pieces, (struct street_piece){ a, b, way->width_m / 2.0, way->street_class });
			ARRAY_PUSH(
				boxes, (struct bounds){ { fmin(a.x, b.x), fmin(a.y, b.y) }, { fmax(a.x, b.x), fmax(a.y, b.y) } });
		}
	}
}

static void find_fronts(struct sites *sites, const struct city *city)
{
	piece_array pieces = { 0 };
	bounds_array boxes = { 0 };
	index_array near = { 0 };
	struct box_index index;
	gather_streets(city, &pieces, &boxes);
	box_index_build(&index, boxes.items, boxes.count, 50.0);
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct ring *ring = &city->buildings.items[i].footprint.outer;
		double least = FRONT_M;
		box_index_find(&index, bounds_grown(sites->boxes.items[i], FRONT_M + 12.0), &near);
		for (size_t k = 0; k < near.count; k++) {
			const struct street_piece *piece = &pieces.items[near.items[k]];
			for (size_t j = 0; j < ring->count; j++) {
				double distance = distance_to_segment(ring->points[j], piece->a, piece->b) - piece->half_width_m;
				if (distance >= least)
					continue;
				least = distance;
				sites->items[i].street_class = piece->street_class;
			}
		}
		sites->items[i].fronts_street = least < FRONT_M;
	}
	box_index_finish(&index);
	ARRAY_FINISH(&near);
	ARRAY_FINISH(&boxes);
	ARRAY_FINISH(&pieces);
}

void sites_build(struct sites *sites, const struct city *city)
{
	size_t capacity = 0, count = city->buildings.count;
	*sites = (struct sites){ .items = array_grow(NULL, &capacity, count + 1, sizeof(struct site)) };
	memset(sites->items, 0, (count + 1) * sizeof(struct site));
	struct density_grid grid;
	grid_init(&grid, city);
	for (size_t i = 0; i < count; i++) {
		struct bounds box;
		ring_bounds(&city->buildings.items[i].footprint.outer, &box.min, &box.max);
		ARRAY_PUSH(&sites->boxes, box);
		measure(&city->buildings.items[i], &sites->items[i]);
		if (!city->buildings.items[i].is_part)
			grid_add(&grid, box, sites->items[i].area_m2);
	}
	grid_blur(&grid);
	for (size_t i = 0; i < count; i++) {
		struct dvec2 at = sites->items[i].centre;
		size_t col = cell_of(at.x, grid.origin.x, grid.cell_m, grid.columns);
		size_t row = cell_of(at.y, grid.origin.y, grid.cell_m, grid.rows);
		sites->items[i].density = fmin((double)grid.cells[row * grid.columns + col], 1.0);
	}
	array_free(grid.cells);
	box_index_build(&sites->index, sites->boxes.items, count, 40.0);
	find_attached(sites, city);
	find_fronts(sites, city);
}

void sites_finish(struct sites *sites)
{
	box_index_finish(&sites->index);
	ARRAY_FINISH(&sites->boxes);
	array_free(sites->items);
	sites->items = NULL;
}
