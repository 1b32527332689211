/*
 * How much of a city can be near: streets and chunks are entered into a grid, each chunk into all cells that it may be
 * near to. Cost: chunks times cells within the radius, a few milliseconds; the arena's memory is given back.
 */
#include <errno.h>
#include <math.h>

#include "assets/residency.h"

#define CELL_MM 32000
#define HOLES 16             /* a pool is larger than what it holds by one part in so many */
#define CELLS_MAX (1u << 16) /* larger cities have larger cells */

struct near_sum {
	uint64_t vertices, indices;
	bool street;
};
struct near_grid {
	int64_t min_mm[2], cell_mm;
	int64_t size[2]; /* cells */
	struct near_sum *sums;
};

static bool grid_init(struct near_grid *grid, struct arena *arena, const struct pkg_graph *graph)
{
	int64_t max_mm[2] = { INT32_MIN, INT32_MIN };
	grid->min_mm[0] = grid->min_mm[1] = INT32_MAX;
	for (uint32_t i = 0; i < graph->point_count; i++) {
		for (int axis = 0; axis < 2; axis++) {
			int64_t at = graph->points[i].pos_mm[axis];
			grid->min_mm[axis] = at < grid->min_mm[axis] ? at : grid->min_mm[axis];
			max_mm[axis] = at > max_mm[axis] ? at : max_mm[axis];
		}
	}
	if (!graph->point_count)
		grid->min_mm[0] = grid->min_mm[1] = max_mm[0] = max_mm[1] = 0;
	grid->cell_mm = CELL_MM / 2;
	do {
		grid->cell_mm *= 2;
		for (int axis = 0; axis < 2; axis++)
			grid->size[axis] = (max_mm[axis] - grid->min_mm[axis]) / grid->cell_mm + 1;
	} while (grid->size[0] * grid->size[1] > CELLS_MAX);
	grid->sums = ARENA_ARRAY(arena, struct near_sum, grid->size[0] * grid->size[1]);
	return grid->sums;
}

static struct near_sum *cell_at(const struct near_grid *grid, double x_mm, double y_mm)
{
	int64_t column = (int64_t)(x_mm - (double)grid->min_mm[0]) / grid->cell_mm;
	int64_t row = (int64_t)(y_mm - (double)grid->min_mm[1]) / grid->cell_mm;
	return &grid->sums[row * grid->size[0] + column];
}

/* A street lies in the cells of points at most a quarter of a cell apart; what it cuts the corner of is next to one. */
static void enter_street(struct near_grid *grid, const int32_t *from, const int32_t *to)
{
	double dx = (double)to[0] - from[0], dy = (double)to[1] - from[1];
	int64_t steps = (int64_t)(hypot(dx, dy) * 4.0 / (double)grid->cell_mm) + 1;
	for (int64_t i = 0; i <= steps; i++) {
		double share = (double)i / (double)steps;
		cell_at(grid, from[0] + share * dx, from[1] + share * dy)->street = true;
	}
}

static void enter_chunk(struct near_grid *grid, const struct pkg_chunk *chunk, double radius_mm)
{
	int64_t first[2], last[2];
	for (int axis = 0; axis < 2; axis++) {
		int64_t reach = (int64_t)radius_mm + grid->cell_mm;
		first[axis] = (chunk->min_mm[axis] - reach - grid->min_mm[axis]) / grid->cell_mm - 1;
		last[axis] = (chunk->max_mm[axis] + reach - grid->min_mm[axis]) / grid->cell_mm + 1;
		first[axis] = first[axis] < 0 ? 0 : first[axis];
		last[axis] = last[axis] >= grid->size[axis] ? grid->size[axis] - 1 : last[axis];
	}
	for (int64_t row = first[1]; row <= last[1]; row++) {
		double south = (double)(grid->min_mm[1] + row * grid->cell_mm), north = south + (double)grid->cell_mm;
		double dy = fmax(fmax(chunk->min_mm[1] - north, south - chunk->max_mm[1]), 0.0);
		for (int64_t column = first[0]; column <= last[0]; column++) {
			double west = (double)(grid->min_mm[0] + column * grid->cell_mm), east = west + (double)grid->cell_mm;
			double dx = fmax(fmax(chunk->min_mm[0] - east, west - chunk->max_mm[0]), 0.0);
			if (dx * dx + dy * dy > radius_mm * radius_mm)
				continue;
			struct near_sum *sum = &grid->sums[row * grid->size[0] + column];
			sum->vertices += chunk->vertex_count;
			for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
				sum->indices += chunk->index_count[pass];
		}
	}
}

int residency_bound(const struct pkg *pkg, struct arena *arena, double radius_m, uint64_t *vertices, uint64_t *indices)
{
	const struct pkg_graph *graph = &pkg->graph;
	const size_t mark = arena_mark(arena);
	struct near_grid grid;
	*vertices = *indices = 0;
	if (!grid_init(&grid, arena, graph))
		return -ENOMEM;
	for (uint32_t e = 0; e < graph->edge_count; e++) {
		const struct pkg_point *points = &graph->points[graph->edges[e].first_point];
		for (uint32_t i = 1; i < graph->edges[e].point_count; i++)
			enter_street(&grid, points[i - 1].pos_mm, points[i].pos_mm);
	}
	for (uint32_t i = 0; i < pkg->chunk_count; i++)
		enter_chunk(&grid, &pkg->chunks[i], radius_m * 1000.0);
	for (int64_t i = 0; i < grid.size[0] * grid.size[1]; i++) {
		const struct near_sum *sum = &grid.sums[i];
		if (sum->street && sum->vertices > *vertices)
			*vertices = sum->vertices;
		if (sum->street && sum->indices > *indices)
			*indices = sum->indices;
	}
	arena_release(arena, mark);
	return 0;
}

static uint64_t pool_size(uint64_t bound, uint64_t largest, uint64_t all)
{
	uint64_t size = bound + bound / HOLES + 2 * largest;
	return size < all ? size : all;
}

int residency_pools(const struct pkg *pkg, struct arena *arena, double radius_m, uint64_t *vertices, uint64_t *indices)
{
	uint64_t all[2], largest[2] = { 0, 0 };
	int status = residency_bound(pkg, arena, radius_m, vertices, indices);
	residency_totals(pkg, &all[0], &all[1]);
	for (uint32_t i = 0; i < pkg->chunk_count; i++) {
		const struct pkg_chunk *chunk = &pkg->chunks[i];
		uint64_t count = (uint64_t)chunk->index_count[PKG_PASS_OPAQUE] + chunk->index_count[PKG_PASS_DECAL];
		largest[0] = chunk->vertex_count > largest[0] ? chunk->vertex_count : largest[0];
		largest[1] = count > largest[1] ? count : largest[1];
	}
	*vertices = pool_size(*vertices, largest[0], all[0]);
	*indices = pool_size(*indices, largest[1], all[1]);
	return status;
}
