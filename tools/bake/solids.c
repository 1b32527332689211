/* Which buildings are solid, from what their generator makes of them: see plots.c and roof.c for the heights. */
#include "tools/bake/solids.h"

#include <math.h>
#include <stdlib.h>

#include "tools/bake/buildings.h"

#define PARAPET_M 0.75    /* a flat roof may lie so much lower than the walls around it */
#define TUNNEL_SIDE_M 2.0 /* of a tube beside its carriageway; of a stream's bed beside it */

typedef ARRAY(struct segment) segment_array;

/* Surveyed surfaces: the lowest place of the roof. */
static double surfaces_top(const struct building *building)
{
	double top = INFINITY;
	for (size_t i = 0; i + 2 < building->wall_3d_count; i += 3) {
		const struct dvec3 *p = &building->walls_3d[i];
		double cross = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
		double low = fmin(p[0].z, fmin(p[1].z, p[2].z));
		if (cross > 1e-3)
			top = fmin(top, low);
	}
	return isfinite(top) ? top : -INFINITY;
}

static bool near_line(struct dvec2 at, struct dvec2 a, struct dvec2 b, double reach)
{
	struct dvec2 d = dvec2_sub(b, a), v = dvec2_sub(at, a);
	double length2 = dvec2_dot(d, d), t = length2 > 0.0 ? dvec2_dot(v, d) / length2 : 0.0;
	return dvec2_length(dvec2_sub(v, dvec2_scale(d, fmin(fmax(t, 0.0), 1.0)))) < reach;
}

static bool crosses(struct dvec2 a, struct dvec2 b, struct dvec2 p, struct dvec2 q)
{
	struct dvec2 ab = dvec2_sub(b, a), pq = dvec2_sub(q, p);
	return (dvec2_cross(ab, dvec2_sub(p, a)) > 0.0) != (dvec2_cross(ab, dvec2_sub(q, a)) > 0.0) &&
		   (dvec2_cross(pq, dvec2_sub(a, p)) > 0.0) != (dvec2_cross(pq, dvec2_sub(b, p)) > 0.0);
}

/* Tunnels, and watercourses that are drawn from their lines: owners are ways, then lines. */
static double tube_width(const struct city *city, uint32_t owner)
{
	size_t ways = city->ways.count;
	return owner < ways ? city->ways.items[owner].width_m : city->lines.items[owner - ways].width_m;
}

struct tube_search {
	const struct city *city;
	const struct polygon *footprint;
	bool found;
};

static void visit_tube(void *context, const struct segment *tube)
{
	struct tube_search *search = context;
	const struct ring *ring = &search->footprint->outer;
	double reach = tube_width(search->city, tube->owner) / 2.0 + TUNNEL_SIDE_M;
	search->found |= polygon_contains(search->footprint, tube->a);
	for (size_t i = 0, j = ring->count - 1; i < ring->count && !search->found; j = i++) {
		struct dvec2 p = ring->points[j], q = ring->points[i];
		search->found = crosses(tube->a, tube->b, p, q) || near_line(p, tube->a, tube->b, reach) ||
						near_line(tube->a, p, q, reach) || near_line(tube->b, p, q, reach);
	}
}

/* What stands over a tunnel is no column down to the ground: one sees along the tunnel under it. Nor is what stands
 * over a stream. */
static bool over_tunnel(const struct city *city, const struct segment_grid *tubes, const struct polygon *footprint)
{
	struct tube_search search = { city, footprint, false };
	struct dvec2 min, max;
	ring_bounds(&footprint->outer, &min, &max);
	const double margin = 20.0; /* the widest carriageway's half */
	segment_grid_visit(tubes, (struct dvec2){ min.x - margin, min.y - margin },
		(struct dvec2){ max.x + margin, max.y + margin }, visit_tube, &search);
	return search.found;
}

/* What a building's walls and roof enclose up to; -INFINITY: it is not solid from the ground. */
static double solid_top(const struct building *building, const struct plot *plot)
{
	if (building->has_parts || building->footprint.outer.count < 3 || building->kind == BUILDING_ROOF)
		return -INFINITY;
	if (building->walls_3d)
		return surfaces_top(building);
	if (!plot->building || plot->base > plot->ground)
		return -INFINITY;
	return fmin(plot->eaves, plot->top - PARAPET_M);
}

static int order_by_id(const void *left, const void *right)
{
	const struct solid *a = left, *b = right;
	if (a->id != b->id)
		return a->id < b->id ? -1 : 1;
	return a->footprint < b->footprint ? -1 : a->footprint > b->footprint; /* one array: the order of the city */
}

/* Where a building goes on above an arch, what stands beside the arch is solid up to its eaves: both have one id. */
static void stack_on_pieces(const struct city *city, const struct plots *plots, solid_array *solids)
{
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct building *upper = &city->buildings.items[i];
		const struct plot *plot = &plots->plots.items[i];
		if (!plot->building || plot->base <= plot->ground || upper->kind == BUILDING_ROOF)
			continue;
		size_t low = 0, high = solids->count;
		while (low < high) {
			size_t middle = (low + high) / 2;
			if (solids->items[middle].id < upper->id)
				low = middle + 1;
			else
				high = middle;
		}
		for (; low < solids->count && solids->items[low].id == upper->id; low++) {
			struct solid *piece = &solids->items[low];
			if (fabs(piece->height_m - upper->min_height_m) < 1e-6 && fabs(piece->ground_m - plot->ground) < 1e-6)
				piece->top_m = fmin(plot->eaves, plot->top - PARAPET_M);
		}
	}
}

static void list_tubes(const struct city *city, struct segment_grid *grid, segment_array *tubes)
{
	for (size_t i = 0; i < city->ways.count; i++) {
		const struct way *way = &city->ways.items[i];
		for (size_t k = 0; (way->tunnel || way->layer < 0) && k + 1 < way->node_count; k++)
			ARRAY_PUSH(tubes, (struct segment){ way->nodes[k].at, way->nodes[k + 1].at, (uint32_t)i });
	}
	for (size_t i = 0; i < city->lines.count; i++) {
		const struct line *line = &city->lines.items[i];
		bool open = (line->kind == LINE_RIVER || line->kind == LINE_STREAM) && !line->tunnel;
		for (size_t k = 0; open && k + 1 < line->count; k++)
			ARRAY_PUSH(
				tubes, (struct segment){ line->points[k], line->points[k + 1], (uint32_t)(city->ways.count + i) });
	}
	segment_grid_build(grid, tubes->items, tubes->count, 32.0);
}

void solids_list(const struct city *city, solid_array *out)
{
	struct report ignored = { 0 }; /* the buildings' generator counts the same faults */
	struct city unreported = *city;
	unreported.report = &ignored;
	struct plots plots;
	plots_build(&unreported, &plots);
	segment_array tubes = { 0 };
	struct segment_grid grid = { 0 };
	list_tubes(city, &grid, &tubes);
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct building *building = &city->buildings.items[i];
		struct solid solid = {
			.footprint = &building->footprint,
			.ground_m = building->ground_m,
			.top_m = solid_top(building, &plots.plots.items[i]),
			.id = building->id,
			.height_m = building->height_m,
		};
		if (solid.top_m > solid.ground_m && !over_tunnel(city, &grid, solid.footprint))
			ARRAY_PUSH(out, solid);
	}
	ARRAY_SORT(out, order_by_id);
	stack_on_pieces(city, &plots, out);
	plots_finish(&plots);
	segment_grid_finish(&grid);
	ARRAY_FINISH(&tubes);
}
