#include "tools/read/osm_cut.h"

#include <stdlib.h>

/* How far inside the hull an end may lie and still count as leaving. */
#define END_TOLERANCE_M 120.0

typedef ARRAY(struct dvec2) point_array;

static int by_place(const void *a, const void *b)
{
	const struct dvec2 *p = a, *q = b;
	return p->x != q->x ? (p->x < q->x ? -1 : 1) : p->y != q->y ? (p->y < q->y ? -1 : 1) : 0;
}

/* Monotone chain (Andrew 1979, "Another Efficient Algorithm for Convex Hulls in Two Dimensions"). */
static struct ring convex_hull(struct pool *pool, point_array *points)
{
	struct dvec2 *p = points->items;
	size_t n = points->count, count = 0;
	struct ring hull = { POOL_ARRAY(pool, struct dvec2, 2 * n + 1), 0 };
	qsort(p, n, sizeof(*p), by_place);
	for (size_t pass = 0; pass < 2; pass++) {
		size_t start = count;
		for (size_t k = 0; k < n; k++) {
			struct dvec2 at = p[pass ? n - 1 - k : k];
			while (count >= start + 2 && dvec2_cross(dvec2_sub(hull.points[count - 1], hull.points[count - 2]),
											 dvec2_sub(at, hull.points[count - 1])) <= 0.0)
				count--;
			hull.points[count++] = at;
		}
		count--; /* the last point starts the other half */
	}
	hull.count = count;
	return hull;
}

struct ring cut_hull(struct osm_reader *reader)
{
	point_array points = { 0 };
	struct dvec2 a = reader->built.min, b = reader->built.max;
	for (size_t i = 0; !reader->clip && i < reader->store->ways.count; i++) {
		const struct osm_way *way = &reader->store->ways.items[i];
		for (size_t j = 0; way->built && j < way->ref_count; j++) {
			const struct osm_node *node = osm_store_node(reader->store, way->refs[j]);
			if (node)
				ARRAY_PUSH(&points, node->at);
		}
	}
	if (points.count < 3) {
		ARRAY_PUSH(&points, a);
		ARRAY_PUSH(&points, b);
		ARRAY_PUSH(&points, (struct dvec2){ a.x, b.y });
		ARRAY_PUSH(&points, (struct dvec2){ b.x, a.y });
	}
	struct ring hull = convex_hull(&reader->city->pool, &points);
	ARRAY_FINISH(&points);
	return hull;
}

static struct dvec2 place(const struct osm_reader *reader, int64_t ref)
{
	return osm_store_node(reader->store, ref)->at;
}

/* How deep inside a convex ring a place lies; negative outside. `outward`: the normal of the closest side. */
static double depth_in(const struct ring *ring, struct dvec2 at, struct dvec2 *outward)
{
	double depth = INFINITY;
	for (size_t i = 0; i < ring->count; i++) {
		struct dvec2 a = ring->points[i], along = dvec2_sub(ring->points[(i + 1) % ring->count], a);
		double length = dvec2_length(along);
		double inside = length > 1e-9 ? dvec2_cross(along, dvec2_sub(at, a)) / length : INFINITY;
		if (inside < depth) {
			depth = inside;
			*outward = (struct dvec2){ along.y / length, -along.x / length };
		}
	}
	return depth;
}

bool cut_reaches_out(const struct osm_reader *reader, const chain_array *open)
{
	struct dvec2 outward;
	for (size_t i = 0; i < open->count; i++) {
		const struct chain *chain = &open->items[i];
		if (depth_in(&reader->hull, place(reader, chain->refs[0]), &outward) > END_TOLERANCE_M ||
			depth_in(&reader->hull, place(reader, chain->refs[chain->count - 1]), &outward) > END_TOLERANCE_M)
			return false;
	}
	return true;
}

struct path {
	struct dvec2 *points; /* malloc */
	size_t count;
};
typedef ARRAY(struct path) path_array;

struct cut {
	const struct osm_reader *reader;
	struct ring frame; /* convex */
	path_array paths;
	struct dvec2 origin; /* somewhere in the frame, on neither side in particular */
};

static bool frame_init(struct cut *cut, double margin_m)
{
	GEOSContextHandle_t geos = cut->reader->shaper.geos;
	struct polygon hull = { .outer = cut->reader->hull };
	polygon_array grown = { 0 };
	GEOSGeometry *shape = shape_to_geos(&cut->reader->shaper, &hull);
	GEOSGeometry *around = shape ? GEOSBuffer_r(geos, shape, margin_m, 4) : NULL;
	bool made = shape_from_geos(&cut->reader->shaper, around, 1.0, &grown) > 0;
	if (made) {
		cut->frame = grown.items[0].outer;
		struct dvec2 min, max;
		ring_bounds(&cut->frame, &min, &max);
		/* Off the middle by an odd bit, so that no corner of the data lies on the way to it. */
		cut->origin = (struct dvec2){ (min.x + max.x) / 2.0 + 0.01234567, (min.y + max.y) / 2.0 + 0.0234567 };
	}
	ARRAY_FINISH(&grown);
	GEOSGeom_destroy_r(geos, shape);
	GEOSGeom_destroy_r(geos, around);
	return made;
}

/* Straight outwards until beyond the frame. */
static struct dvec2 beyond(const struct cut *cut, struct dvec2 end)
{
	struct dvec2 outward = { 0.0, 0.0 };
	double depth = depth_in(&cut->frame, end, &outward);
	return depth <= 0.0 ? end : dvec2_add(end, dvec2_scale(outward, depth + 10.0));
}

static void add_path(struct cut *cut, const struct chain *chain, bool open)
{
	struct path path = { malloc((chain->count + 2) * sizeof(struct dvec2)), 0 };
	if (!path.points)
		abort();
	if (open)
		path.points[path.count++] = beyond(cut, place(cut->reader, chain->refs[0]));
	for (size_t i = 0; i < chain->count; i++)
		path.points[path.count++] = place(cut->reader, chain->refs[i]);
	if (open)
		path.points[path.count++] = beyond(cut, place(cut->reader, chain->refs[chain->count - 1]));
	ARRAY_PUSH(&cut->paths, path);
}

static bool left_of(struct dvec2 a, struct dvec2 b, struct dvec2 at)
{
	return dvec2_cross(dvec2_sub(b, a), dvec2_sub(at, a)) > 0.0;
}

/* Parity of the crossings on the way from `at` to the origin, which never leaves the frame since that is convex. */
static bool side_of(const struct cut *cut, struct dvec2 at)
{
	bool odd = false;
	for (size_t i = 0; i < cut->paths.count; i++) {
		const struct path *path = &cut->paths.items[i];
		for (size_t j = 1; j < path->count; j++) {
			struct dvec2 a = path->points[j - 1], b = path->points[j];
			odd ^= left_of(at, cut->origin, a) != left_of(at, cut->origin, b) &&
				   left_of(a, b, at) != left_of(a, b, cut->origin);
		}
	}
	return odd;
}

/* The side with less of the built: samples are first nodes of buildings and drivable ways that are no bridges. */
static bool emptier_side(const struct cut *cut)
{
	const struct osm_store *store = cut->reader->store;
	size_t count[2] = { 0, 0 }, step = store->ways.count / 4000 + 1;
	struct dvec2 outward;
	for (size_t i = 0; i < store->ways.count; i += step) {
		const struct osm_way *way = &store->ways.items[i];
		if (!way->built || !way->ref_count || osm_tag(&way->tags, "bridge"))
			continue;
		const struct osm_node *node = osm_store_node(store, way->refs[0]);
		if (node && depth_in(&cut->frame, node->at, &outward) > 0.0)
			count[side_of(cut, node->at)]++;
	}
	return count[1] < count[0];
}

/* The side that lies right of the chains, by length: single pieces may be drawn the wrong way round. */
static bool right_side(const struct cut *cut)
{
	double votes[2] = { 0.0, 0.0 };
	size_t segments = 0, step, next = 0;
	struct dvec2 outward;
	for (size_t i = 0; i < cut->paths.count; i++)
		segments += cut->paths.items[i].count;
	step = segments / 2000 + 1;
	for (size_t i = 0; i < cut->paths.count; i++) {
		const struct path *path = &cut->paths.items[i];
		for (size_t j = 1; j < path->count; j++) {
			struct dvec2 a = path->points[j - 1], b = path->points[j], along = dvec2_sub(b, a);
			double length = dvec2_length(along);
			if (next++ % step || length < 0.1)
				continue;
			struct dvec2 at = { (a.x + b.x) / 2.0 + along.y / length * 0.01,
				(a.y + b.y) / 2.0 - along.x / length * 0.01 };
			if (depth_in(&cut->frame, at, &outward) > 0.0)
				votes[side_of(cut, at)] += length;
		}
	}
	return votes[1] > votes[0];
}

static GEOSGeometry *line_of(const struct shaper *shaper, const struct dvec2 *points, size_t count, bool closed)
{
	GEOSCoordSequence *sequence = GEOSCoordSeq_create_r(shaper->geos, (unsigned)(count + closed), 2);
	for (size_t i = 0; sequence && i < count + closed; i++)
		GEOSCoordSeq_setXY_r(shaper->geos, sequence, (unsigned)i, points[i % count].x, points[i % count].y);
	return sequence ? GEOSGeom_createLineString_r(shaper->geos, sequence) : NULL;
}

/* All faces that the paths and the frame's border make. */
static GEOSGeometry *faces_of(const struct cut *cut)
{
	const struct shaper *shaper = &cut->reader->shaper;
	GEOSGeometry **lines = calloc(cut->paths.count + 1, sizeof(GEOSGeometry *));
	if (!lines)
		abort();
	unsigned count = 0;
	lines[count] = line_of(shaper, cut->frame.points, cut->frame.count, true);
	count += lines[count] != NULL;
	for (size_t i = 0; i < cut->paths.count; i++) {
		lines[count] = line_of(shaper, cut->paths.items[i].points, cut->paths.items[i].count, false);
		count += lines[count] != NULL;
	}
	GEOSGeometry *all = GEOSGeom_createCollection_r(shaper->geos, GEOS_MULTILINESTRING, lines, count);
	GEOSGeometry *noded = all ? GEOSUnaryUnion_r(shaper->geos, all) : NULL;
	const GEOSGeometry *list[1] = { noded };
	GEOSGeometry *faces = noded ? GEOSPolygonize_r(shaper->geos, list, 1) : NULL;
	GEOSGeom_destroy_r(shaper->geos, all);
	GEOSGeom_destroy_r(shaper->geos, noded);
	free(lines);
	return faces;
}

static bool is_inner(const struct cut *cut, const GEOSGeometry *face, bool inside)
{
	GEOSContextHandle_t geos = cut->reader->shaper.geos;
	GEOSGeometry *point = GEOSPointOnSurface_r(geos, face);
	struct dvec2 at = { 0.0, 0.0 }, outward;
	bool found = point && GEOSGeomGetX_r(geos, point, &at.x) && GEOSGeomGetY_r(geos, point, &at.y);
	GEOSGeom_destroy_r(geos, point);
	return found && depth_in(&cut->frame, at, &outward) > 0.0 && side_of(cut, at) == inside;
}

static size_t keep_faces(const struct cut *cut, const GEOSGeometry *faces, bool inside, polygon_array *out)
{
	GEOSContextHandle_t geos = cut->reader->shaper.geos;
	int count = faces ? GEOSGetNumGeometries_r(geos, faces) : 0;
	GEOSGeometry **kept = calloc((size_t)count + 1, sizeof(GEOSGeometry *));
	unsigned kept_count = 0;
	if (!kept)
		abort();
	for (int i = 0; i < count; i++) {
		const GEOSGeometry *face = GEOSGetGeometryN_r(geos, faces, i);
		if (is_inner(cut, face, inside))
			kept[kept_count++] = GEOSGeom_clone_r(geos, face);
	}
	GEOSGeometry *several = GEOSGeom_createCollection_r(geos, GEOS_MULTIPOLYGON, kept, kept_count);
	GEOSGeometry *merged = several ? GEOSUnaryUnion_r(geos, several) : NULL;
	size_t made = shape_from_geos(&cut->reader->shaper, merged, 1.0, out);
	GEOSGeom_destroy_r(geos, several);
	GEOSGeom_destroy_r(geos, merged);
	free(kept);
	return made;
}

size_t cut_polygons(struct osm_reader *reader, const chain_array *closed, const chain_array *open, double margin_m,
	bool coast, polygon_array *out)
{
	struct cut cut = { .reader = reader };
	if (!frame_init(&cut, reader->clip ? 0.01 : margin_m))
		return 0;
	for (size_t i = 0; i < closed->count; i++)
		add_path(&cut, &closed->items[i], false);
	for (size_t i = 0; i < open->count; i++)
		add_path(&cut, &open->items[i], true);
	bool inside = coast ? right_side(&cut) : emptier_side(&cut);
	GEOSGeometry *faces = faces_of(&cut);
	size_t made = keep_faces(&cut, faces, inside, out);
	GEOSGeom_destroy_r(reader->shaper.geos, faces);
	for (size_t i = 0; i < cut.paths.count; i++)
		free(cut.paths.items[i].points);
	ARRAY_FINISH(&cut.paths);
	return made;
}
