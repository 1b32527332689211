#include "tools/read/osm_cut.h"

#include <stdlib.h>

/* How far the frame lies outside the built-up area, and how far inside it an end may lie and still count as leaving. */
#define FRAME_MARGIN_M 400.0
#define END_TOLERANCE_M 60.0

struct bounds cut_frame(const struct osm_reader *reader)
{
	struct bounds frame = reader->built;
	double margin = reader->clip ? 0.0 : FRAME_MARGIN_M;
	frame.min = dvec2_sub(frame.min, (struct dvec2){ margin, margin });
	frame.max = dvec2_add(frame.max, (struct dvec2){ margin, margin });
	return frame;
}

static struct dvec2 place(const struct osm_reader *reader, int64_t ref)
{
	return osm_store_node(reader->store, ref)->at;
}

static bool leaves(const struct bounds *built, struct dvec2 at)
{
	double inside =
		fmin(fmin(at.x - built->min.x, built->max.x - at.x), fmin(at.y - built->min.y, built->max.y - at.y));
	return inside < END_TOLERANCE_M;
}

bool cut_reaches_out(const struct osm_reader *reader, const chain_array *open)
{
	for (size_t i = 0; i < open->count; i++) {
		const struct chain *chain = &open->items[i];
		if (!leaves(&reader->built, place(reader, chain->refs[0])) ||
			!leaves(&reader->built, place(reader, chain->refs[chain->count - 1])))
			return false;
	}
	return true;
}

/* Lengthens a chain that ends inside the frame straight outwards until it is beyond it. */
static struct dvec2 beyond(const struct bounds *frame, struct dvec2 end)
{
	double west = end.x - frame->min.x, east = frame->max.x - end.x, south = end.y - frame->min.y,
		   north = frame->max.y - end.y;
	double least = fmin(fmin(west, east), fmin(south, north));
	if (least <= 0.0)
		return end;
	if (least == west)
		return (struct dvec2){ frame->min.x - 10.0, end.y };
	if (least == east)
		return (struct dvec2){ frame->max.x + 10.0, end.y };
	if (least == south)
		return (struct dvec2){ end.x, frame->min.y - 10.0 };
	return (struct dvec2){ end.x, frame->max.y + 10.0 };
}

struct path {
	struct dvec2 *points; /* malloc */
	size_t count;
};
typedef ARRAY(struct path) path_array;

static void add_path(
	const struct osm_reader *reader, const struct bounds *frame, const struct chain *chain, bool open, path_array *out)
{
	struct path path = { malloc((chain->count + 2) * sizeof(struct dvec2)), 0 };
	if (!path.points)
		abort();
	if (open)
		path.points[path.count++] = beyond(frame, place(reader, chain->refs[0]));
	for (size_t i = 0; i < chain->count; i++)
		path.points[path.count++] = place(reader, chain->refs[i]);
	if (open)
		path.points[path.count++] = beyond(frame, place(reader, chain->refs[chain->count - 1]));
	ARRAY_PUSH(out, path);
}

/* Parity of the crossings of the paths with the way from `at` east to the frame's edge and then north to its corner:
 * equal for places on the same side. Half-open tests count a vertex on the way once. */
static bool side_of(const path_array *paths, const struct bounds *frame, struct dvec2 at)
{
	bool odd = false;
	for (size_t i = 0; i < paths->count; i++) {
		const struct path *path = &paths->items[i];
		for (size_t j = 1; j < path->count; j++) {
			struct dvec2 a = path->points[j - 1], b = path->points[j];
			if ((a.y > at.y) != (b.y > at.y)) {
				double x = a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x);
				odd ^= x > at.x && x <= frame->max.x;
			}
			if ((a.x > frame->max.x) != (b.x > frame->max.x)) {
				double y = a.y + (frame->max.x - a.x) / (b.x - a.x) * (b.y - a.y);
				odd ^= y > at.y && y <= frame->max.y;
			}
		}
	}
	return odd;
}

/* The side with fewer junctions and houses: samples are the nodes of buildings and drivable ways. */
static bool emptier_side(const struct osm_reader *reader, const path_array *paths, const struct bounds *frame)
{
	size_t count[2] = { 0, 0 };
	size_t step = reader->store->ways.count / 4000 + 1;
	for (size_t i = 0; i < reader->store->ways.count; i += step) {
		const struct osm_way *way = &reader->store->ways.items[i];
		if (!way->ref_count || (!osm_is_building(&way->tags) && !osm_is_drivable(&way->tags)))
			continue;
		const struct osm_node *node = osm_store_node(reader->store, way->refs[0]);
		if (node && node->at.x > frame->min.x && node->at.x < frame->max.x && node->at.y > frame->min.y &&
			node->at.y < frame->max.y)
			count[side_of(paths, frame, node->at)]++;
	}
	return count[1] < count[0];
}

static GEOSGeometry *line_of(const struct shaper *shaper, const struct dvec2 *points, size_t count)
{
	GEOSCoordSequence *sequence = GEOSCoordSeq_create_r(shaper->geos, (unsigned)count, 2);
	for (size_t i = 0; sequence && i < count; i++)
		GEOSCoordSeq_setXY_r(shaper->geos, sequence, (unsigned)i, points[i].x, points[i].y);
	return sequence ? GEOSGeom_createLineString_r(shaper->geos, sequence) : NULL;
}

/* All faces that the paths and the frame's border make. */
static GEOSGeometry *faces_of(const struct shaper *shaper, const path_array *paths, const struct bounds *frame)
{
	GEOSContextHandle_t geos = shaper->geos;
	struct dvec2 a = frame->min, b = frame->max;
	struct dvec2 corners[5] = { a, { b.x, a.y }, b, { a.x, b.y }, a };
	GEOSGeometry **lines = calloc(paths->count + 1, sizeof(GEOSGeometry *));
	if (!lines)
		return NULL;
	unsigned count = 0;
	GEOSGeometry *border = line_of(shaper, corners, 5);
	if (border)
		lines[count++] = border;
	for (size_t i = 0; i < paths->count; i++) {
		GEOSGeometry *line = line_of(shaper, paths->items[i].points, paths->items[i].count);
		if (line)
			lines[count++] = line;
	}
	GEOSGeometry *all = GEOSGeom_createCollection_r(geos, GEOS_MULTILINESTRING, lines, count);
	free(lines);
	GEOSGeometry *noded = all ? GEOSUnaryUnion_r(geos, all) : NULL;
	const GEOSGeometry *list[1] = { noded };
	GEOSGeometry *faces = noded ? GEOSPolygonize_r(geos, list, 1) : NULL;
	GEOSGeom_destroy_r(geos, all);
	GEOSGeom_destroy_r(geos, noded);
	return faces;
}

static bool within(const struct bounds *frame, struct dvec2 at)
{
	return at.x > frame->min.x && at.x < frame->max.x && at.y > frame->min.y && at.y < frame->max.y;
}

static size_t keep_faces(const struct osm_reader *reader, const GEOSGeometry *faces, const path_array *paths,
	const struct bounds *frame, bool inside, polygon_array *out)
{
	GEOSContextHandle_t geos = reader->shaper.geos;
	size_t made = 0;
	int count = faces ? GEOSGetNumGeometries_r(geos, faces) : 0;
	GEOSGeometry **kept = calloc((size_t)count + 1, sizeof(GEOSGeometry *));
	unsigned kept_count = 0;
	for (int i = 0; kept && i < count; i++) {
		const GEOSGeometry *face = GEOSGetGeometryN_r(geos, faces, i);
		GEOSGeometry *point = GEOSPointOnSurface_r(geos, face);
		struct dvec2 at = { 0, 0 };
		if (point && GEOSGeomGetX_r(geos, point, &at.x) && GEOSGeomGetY_r(geos, point, &at.y) && within(frame, at) &&
			side_of(paths, frame, at) == inside)
			kept[kept_count++] = GEOSGeom_clone_r(geos, face);
		GEOSGeom_destroy_r(geos, point);
	}
	GEOSGeometry *several = kept ? GEOSGeom_createCollection_r(geos, GEOS_MULTIPOLYGON, kept, kept_count) : NULL;
	GEOSGeometry *merged = several ? GEOSUnaryUnion_r(geos, several) : NULL;
	made = shape_from_geos(&reader->shaper, merged, 1.0, out);
	GEOSGeom_destroy_r(geos, several);
	GEOSGeom_destroy_r(geos, merged);
	free(kept);
	return made;
}

size_t cut_polygons(struct osm_reader *reader, const chain_array *closed, const chain_array *open,
	const struct dvec2 *inside_hint, polygon_array *out)
{
	struct bounds frame = cut_frame(reader);
	path_array paths = { 0 };
	for (size_t i = 0; i < closed->count; i++)
		add_path(reader, &frame, &closed->items[i], false, &paths);
	for (size_t i = 0; i < open->count; i++)
		add_path(reader, &frame, &open->items[i], true, &paths);
	bool inside = inside_hint ? side_of(&paths, &frame, *inside_hint) : emptier_side(reader, &paths, &frame);
	GEOSGeometry *faces = faces_of(&reader->shaper, &paths, &frame);
	size_t made = keep_faces(reader, faces, &paths, &frame, inside, out);
	GEOSGeom_destroy_r(reader->shaper.geos, faces);
	for (size_t i = 0; i < paths.count; i++)
		free(paths.items[i].points);
	ARRAY_FINISH(&paths);
	return made;
}
