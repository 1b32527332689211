#include "tools/city/corridor.h"

#include <math.h>
#include <stdlib.h>

#include "tools/city/line_grid.h"
#include "tools/read/shape.h"

#define REACH_MM 34000      /* half of the widest carriageway */
#define CLOSED_TUNNEL_M 5.1 /* deeper, a tunnel has a ceiling and ground above it */
#define WALL_OVER_ARCH_M 2.5
#define LEAST_PIECE_M2 3.0
#define LEAST_THICKNESS_M 0.25 /* area by perimeter: less is a sliver */
#define LEAST_SHARE 0.25       /* of the footprint that must stay */
#define TOUCH_M 0.02

struct stretch {
	struct dvec3 a, b;
	double half_width_m;
	uint32_t edge;
	bool arch;     /* may pass under a building */
	bool declared; /* and the data says that it does */
};

struct corridor {
	struct city *city;
	struct shaper shaper;
	ARRAY(struct stretch) stretches;
	struct line_grid grid;
	index_array near, hits;
};

static const struct way *find_way(const struct city *city, const uint32_t *order, int64_t id)
{
	size_t low = 0, high = city->ways.count;
	while (low < high) {
		size_t middle = (low + high) / 2;
		if (city->ways.items[order[middle]].id < id)
			low = middle + 1;
		else
			high = middle;
	}
	return low < city->ways.count && city->ways.items[order[low]].id == id ? &city->ways.items[order[low]] : NULL;
}

static int order_by_id(const void *left, const void *right, void *context)
{
	const struct city *city = context;
	uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
	int64_t id_a = city->ways.items[a].id, id_b = city->ways.items[b].id;
	return id_a != id_b ? (id_a < id_b ? -1 : 1) : (a > b) - (a < b);
}

static struct dvec3 metres(const struct pkg_point *p)
{
	return (struct dvec3){ p->pos_mm[0] / 1000.0, p->pos_mm[1] / 1000.0, p->pos_mm[2] / 1000.0 };
}

static void list_edge(struct corridor *corridor, const struct pkg_graph *graph, uint32_t e, bool passage)
{
	const struct pkg_edge *edge = &graph->edges[e];
	const struct pkg_point *p = &graph->points[edge->first_point];
	struct stretch s = {
		.half_width_m = fmax(edge->width_mm / 1000.0, CORRIDOR_LEAST_M) / 2.0,
		.edge = e,
		.declared = passage || edge->flags & PKG_EDGE_TUNNEL,
	};
	s.arch = s.declared || edge->street_class >= PKG_STREET_LIVING;
	for (uint32_t i = 0; i + 1 < edge->point_count; i++, p++) {
		s.a = metres(&p[0]);
		s.b = metres(&p[1]);
		double ground = city_ground(corridor->city, (struct dvec2){ (s.a.x + s.b.x) / 2.0, (s.a.y + s.b.y) / 2.0 });
		bool buried = edge->flags & PKG_EDGE_TUNNEL && (s.a.z + s.b.z) / 2.0 < ground - CLOSED_TUNNEL_M;
		if (!buried)
			ARRAY_PUSH(&corridor->stretches, s);
	}
}

static void list_stretches(struct corridor *corridor, const struct pkg_graph *graph)
{
	struct city *city = corridor->city;
	size_t capacity = 0, lines_capacity = 0;
	uint32_t *order = array_grow(NULL, &capacity, city->ways.count + 1, sizeof(uint32_t));
	for (uint32_t i = 0; i < city->ways.count; i++)
		order[i] = i;
	if (city->ways.count)
		qsort_r(order, city->ways.count, sizeof(uint32_t), order_by_id, city);
	for (uint32_t e = 0; e < graph->edge_count; e++) {
		const struct way *way = find_way(city, order, graph->edges[e].source_id);
		list_edge(corridor, graph, e, way && way->passage);
	}
	array_free(order);
	struct line_mm *lines = array_grow(NULL, &lines_capacity, corridor->stretches.count + 1, sizeof(*lines));
	for (size_t i = 0; i < corridor->stretches.count; i++) {
		const struct stretch *s = &corridor->stretches.items[i];
		lines[i] = (struct line_mm){ (int32_t)lround(s->a.x * 1000.0), (int32_t)lround(s->a.y * 1000.0),
			(int32_t)lround(s->b.x * 1000.0), (int32_t)lround(s->b.y * 1000.0) };
	}
	line_grid_init(&corridor->grid, lines, corridor->stretches.count);
	array_free(lines);
}

static double point_to_line(struct dvec2 at, struct dvec2 a, struct dvec2 b)
{
	struct dvec2 d = dvec2_sub(b, a), v = dvec2_sub(at, a);
	double length2 = dvec2_dot(d, d), t = length2 > 0.0 ? dvec2_dot(v, d) / length2 : 0.0;
	return dvec2_length(dvec2_sub(v, dvec2_scale(d, fmin(fmax(t, 0.0), 1.0))));
}

static bool lines_cross(struct dvec2 a, struct dvec2 b, struct dvec2 c, struct dvec2 d)
{
	double c_side = dvec2_cross(dvec2_sub(b, a), dvec2_sub(c, a)),
		   d_side = dvec2_cross(dvec2_sub(b, a), dvec2_sub(d, a));
	double a_side = dvec2_cross(dvec2_sub(d, c), dvec2_sub(a, c)),
		   b_side = dvec2_cross(dvec2_sub(d, c), dvec2_sub(b, c));
	return (c_side > 0) != (d_side > 0) && (a_side > 0) != (b_side > 0);
}

static struct dvec2 flat(struct dvec3 p)
{
	return (struct dvec2){ p.x, p.y };
}

static bool comes_near(const struct polygon *polygon, const struct stretch *s)
{
	struct dvec2 a = flat(s->a), b = flat(s->b);
	if (polygon_contains(polygon, a) || polygon_contains(polygon, b))
		return true;
	for (size_t r = 0; r <= polygon->hole_count; r++) {
		const struct ring *ring = r ? &polygon->holes[r - 1] : &polygon->outer;
		for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++) {
			struct dvec2 p = ring->points[j], q = ring->points[i];
			double reach = s->half_width_m - TOUCH_M;
			if (lines_cross(a, b, p, q) || point_to_line(p, a, b) < reach || point_to_line(a, p, q) < reach ||
				point_to_line(b, p, q) < reach)
				return true;
		}
	}
	return false;
}

/* Does any of the building stand between the surface and the headroom? */
static bool in_the_way(const struct building *building, const struct stretch *s, double ground)
{
	double low = fmin(s->a.z, s->b.z) - ground, high = fmax(s->a.z, s->b.z) - ground;
	double deck = low > CORRIDOR_HEAD_M ? GRAPH_DECK_M : 0.0;
	return building->min_height_m < high + CORRIDOR_HEAD_M - 1.0 && building->height_m > low - deck;
}

static double lowest_ground(const struct city *city, const struct polygon *polygon)
{
	double lowest = HUGE_VAL;
	for (size_t i = 0, j = polygon->outer.count - 1; i < polygon->outer.count; j = i++) {
		struct dvec2 a = polygon->outer.points[j], b = polygon->outer.points[i];
		struct dvec2 middle = { (a.x + b.x) / 2.0, (a.y + b.y) / 2.0 };
		lowest = fmin(lowest, fmin(city_ground(city, b), city_ground(city, middle)));
	}
	return lowest;
}

static void find_hits(struct corridor *corridor, const struct building *building, double ground)
{
	struct dvec2 min, max;
	ring_bounds(&building->footprint.outer, &min, &max);
	struct line_mm box = { (int32_t)lround(min.x * 1000.0), (int32_t)lround(min.y * 1000.0),
		(int32_t)lround(max.x * 1000.0), (int32_t)lround(max.y * 1000.0) };
	line_grid_near(&corridor->grid, box, REACH_MM, &corridor->near);
	corridor->hits.count = 0;
	for (size_t i = 0; i < corridor->near.count; i++) {
		const struct stretch *s = &corridor->stretches.items[corridor->near.items[i]];
		bool beside = fmax(s->a.x, s->b.x) + s->half_width_m < min.x ||
					  fmin(s->a.x, s->b.x) - s->half_width_m > max.x ||
					  fmax(s->a.y, s->b.y) + s->half_width_m < min.y || fmin(s->a.y, s->b.y) - s->half_width_m > max.y;
		if (!beside && in_the_way(building, s, ground) && comes_near(&building->footprint, s))
			ARRAY_PUSH(&corridor->hits, corridor->near.items[i]);
	}
}

static GEOSGeometry *disc(GEOSContextHandle_t geos, struct dvec3 at, double radius)
{
	GEOSGeometry *point = GEOSGeom_createPointFromXY_r(geos, at.x, at.y);
	GEOSGeometry *round = point ? GEOSBuffer_r(geos, point, radius, 4) : NULL;
	GEOSGeom_destroy_r(geos, point);
	return round;
}

static GEOSGeometry *band(const struct shaper *shaper, const struct stretch *s)
{
	struct dvec2 along = dvec2_sub(flat(s->b), flat(s->a));
	double length = dvec2_length(along);
	if (length <= 0.0)
		return NULL;
	struct dvec2 side = { -along.y / length * s->half_width_m, along.x / length * s->half_width_m };
	struct dvec2 corners[4] = { dvec2_sub(flat(s->a), side), dvec2_sub(flat(s->b), side), dvec2_add(flat(s->b), side),
		dvec2_add(flat(s->a), side) };
	return shape_to_geos(shaper, &(struct polygon){ .outer = { corners, 4 } });
}

/* Union of the stretches hit, round at their ends: a dead end keeps its distance from the wall too. */
static GEOSGeometry *corridor_shape(struct corridor *corridor)
{
	GEOSContextHandle_t geos = corridor->shaper.geos;
	ARRAY(GEOSGeometry *) parts = { 0 };
	for (size_t i = 0; i < corridor->hits.count; i++) {
		const struct stretch *s = &corridor->stretches.items[corridor->hits.items[i]];
		GEOSGeometry *pieces[3] = { band(&corridor->shaper, s), disc(geos, s->a, s->half_width_m),
			disc(geos, s->b, s->half_width_m) };
		for (int k = 0; k < 3; k++)
			if (pieces[k])
				ARRAY_PUSH(&parts, pieces[k]);
	}
	GEOSGeometry *all = GEOSGeom_createCollection_r(geos, GEOS_GEOMETRYCOLLECTION, parts.items, (unsigned)parts.count);
	GEOSGeometry *joined = all ? GEOSUnaryUnion_r(geos, all) : NULL;
	GEOSGeom_destroy_r(geos, all);
	ARRAY_FINISH(&parts);
	return joined;
}

static double length_inside(const struct corridor *corridor, const GEOSGeometry *footprint)
{
	GEOSContextHandle_t geos = corridor->shaper.geos;
	double sum = 0.0;
	for (size_t i = 0; i < corridor->hits.count; i++) {
		const struct stretch *s = &corridor->stretches.items[corridor->hits.items[i]];
		GEOSCoordSequence *ends = GEOSCoordSeq_create_r(geos, 2, 2);
		GEOSCoordSeq_setXY_r(geos, ends, 0, s->a.x, s->a.y);
		GEOSCoordSeq_setXY_r(geos, ends, 1, s->b.x, s->b.y);
		GEOSGeometry *line = GEOSGeom_createLineString_r(geos, ends);
		GEOSGeometry *inside = line ? GEOSIntersection_r(geos, line, footprint) : NULL;
		double length = 0.0;
		if (inside && GEOSLength_r(geos, inside, &length))
			sum += length;
		GEOSGeom_destroy_r(geos, inside);
		GEOSGeom_destroy_r(geos, line);
	}
	return sum;
}

static double perimeter(const struct polygon *polygon)
{
	double sum = 0.0;
	for (size_t i = 0, j = polygon->outer.count - 1; i < polygon->outer.count; j = i++)
		sum += dvec2_length(dvec2_sub(polygon->outer.points[i], polygon->outer.points[j]));
	return sum;
}

/* What stays beside the corridor, without slivers, the largest piece first. */
static void pieces_beside(
	struct corridor *corridor, const GEOSGeometry *footprint, const GEOSGeometry *shape, polygon_array *out)
{
	GEOSGeometry *rest = GEOSDifference_r(corridor->shaper.geos, footprint, shape);
	if (rest)
		shape_from_geos(&corridor->shaper, rest, LEAST_PIECE_M2, out);
	GEOSGeom_destroy_r(corridor->shaper.geos, rest);
	size_t kept = 0;
	for (size_t i = 0; i < out->count; i++)
		if (polygon_area(&out->items[i]) >= LEAST_THICKNESS_M * perimeter(&out->items[i]))
			out->items[kept++] = out->items[i];
	out->count = kept;
	for (size_t i = 1; i < kept; i++)
		if (polygon_area(&out->items[i]) > polygon_area(&out->items[0])) {
			struct polygon swap = out->items[0];
			out->items[0] = out->items[i];
			out->items[i] = swap;
		}
}

/* Height of the arch above the building's ground, or 0 when the walls are too low for one or some street is no lane. */
static double arch_height(const struct corridor *corridor, const struct building *building, double ground)
{
	double top = 0.0;
	for (size_t i = 0; i < corridor->hits.count; i++) {
		const struct stretch *s = &corridor->stretches.items[corridor->hits.items[i]];
		if (!s->arch)
			return 0.0;
		top = fmax(top, fmax(s->a.z, s->b.z) - ground + CORRIDOR_HEAD_M);
	}
	return building->height_m - building->roof_height_m >= top + WALL_OVER_ARCH_M ? top : 0.0;
}

static void add_pieces(struct city *city, const struct building *like, const polygon_array *pieces, size_t first)
{
	for (size_t i = first; i < pieces->count; i++) {
		struct building piece = *like;
		piece.footprint = pieces->items[i];
		piece.name = NULL;
		ARRAY_PUSH(&city->buildings, piece);
	}
}

/* The building goes on above the arch; below it stand its pieces, with a flat top that nobody sees. */
static void build_arch(struct city *city, uint32_t index, double top, const polygon_array *pieces)
{
	struct building below = city->buildings.items[index];
	below.height_m = top;
	below.levels = fmax(1.0, floor(top / 3.5));
	below.roof_shape = ROOF_FLAT;
	below.roof_height_m = 0.0;
	below.landmark = below.has_parts = false;
	add_pieces(city, &below, pieces, 0);
	struct building *above = &city->buildings.items[index];
	double storeys_below = fmin(floor(top / 3.5), above->levels > 1.0 ? above->levels - 1.0 : 0.0);
	above->min_height_m = top;
	above->min_level = storeys_below;
}

static enum fault_outcome mend(
	struct corridor *corridor, uint32_t index, const GEOSGeometry *footprint, const GEOSGeometry *shape, double ground)
{
	struct city *city = corridor->city;
	struct building *building = &city->buildings.items[index];
	polygon_array pieces = { 0 };
	pieces_beside(corridor, footprint, shape, &pieces);
	double left = 0.0, before = polygon_area(&building->footprint), top = arch_height(corridor, building, ground);
	for (size_t i = 0; i < pieces.count; i++)
		left += polygon_area(&pieces.items[i]);
	building->walls_3d = NULL; /* they cannot be cut; the footprint is extruded instead */
	building->wall_3d_count = 0;
	enum fault_outcome outcome = FAULT_MENDED;
	if (top > building->min_height_m && building->min_height_m < 1.0 && !building->has_parts) {
		build_arch(city, index, top, &pieces);
	} else if (!pieces.count || left < LEAST_SHARE * before) {
		building->footprint.outer.count = 0;
		outcome = FAULT_DROPPED;
	} else {
		building->footprint = pieces.items[0];
		struct building like = *building;
		add_pieces(city, &like, &pieces, 1);
	}
	ARRAY_FINISH(&pieces);
	return outcome;
}

static bool all_declared(const struct corridor *corridor)
{
	for (size_t i = 0; i < corridor->hits.count; i++)
		if (!corridor->stretches.items[corridor->hits.items[i]].declared)
			return false;
	return true;
}

static void clear_building(struct corridor *corridor, uint32_t index)
{
	struct building *building = &corridor->city->buildings.items[index];
	if (building->footprint.outer.count < 3 || building->kind == BUILDING_ROOF)
		return;
	double ground = lowest_ground(corridor->city, &building->footprint);
	find_hits(corridor, building, ground);
	if (!corridor->hits.count)
		return;
	GEOSContextHandle_t geos = corridor->shaper.geos;
	struct report *report = corridor->city->report;
	int64_t id = building->id;
	GEOSGeometry *footprint = shape_to_geos(&corridor->shaper, &building->footprint);
	GEOSGeometry *shape = corridor_shape(corridor);
	GEOSGeometry *clash = footprint && shape ? GEOSIntersection_r(geos, footprint, shape) : NULL;
	double area = 0.0;
	if (!clash || !GEOSArea_r(geos, clash, &area)) {
		building->footprint.outer.count = 0;
		report_fault(report, FAULT_BAD_GEOMETRY, FAULT_DROPPED, id);
	} else if (area > 1e-3) {
		bool through = length_inside(corridor, footprint) > 0.5, declared = all_declared(corridor);
		enum fault_outcome outcome = mend(corridor, index, footprint, shape, ground);
		if (!declared || outcome == FAULT_DROPPED)
			report_fault(report, through ? FAULT_STREET_THROUGH_BUILDING : FAULT_BUILDING_IN_STREET, outcome, id);
	}
	GEOSGeom_destroy_r(geos, clash);
	GEOSGeom_destroy_r(geos, shape);
	GEOSGeom_destroy_r(geos, footprint);
}

void corridor_clear(struct city *city, const struct pkg_graph *graph)
{
	struct corridor corridor = { .city = city };
	shaper_init(&corridor.shaper, &city->pool, city->report);
	list_stretches(&corridor, graph);
	uint32_t count = (uint32_t)city->buildings.count; /* pieces that are added are free already */
	for (uint32_t i = 0; i < count; i++)
		clear_building(&corridor, i);
	line_grid_finish(&corridor.grid);
	ARRAY_FINISH(&corridor.stretches);
	ARRAY_FINISH(&corridor.near);
	ARRAY_FINISH(&corridor.hits);
	shaper_finish(&corridor.shaper);
}
