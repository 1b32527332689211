/* Plane shapes by GEOS: buffers and unions of a tile's lines, kept as plain rings. */
#include <math.h>
#include <stdlib.h>

#include "tools/bake/ground.h"

#define QUADRANT_SEGMENTS 4

void outline_finish(struct outline *outline)
{
	ARRAY_FINISH(&outline->points);
	ARRAY_FINISH(&outline->starts);
}

static size_t ring_end(const struct outline *outline, size_t ring)
{
	return ring + 1 < outline->starts.count ? outline->starts.items[ring + 1] : outline->points.count;
}

/* Winding number: parts that failed to unite may overlap. */
bool outline_contains(const struct outline *outline, struct dvec2 at)
{
	if (!outline->starts.count || at.x < outline->min.x || at.x > outline->max.x || at.y < outline->min.y ||
		at.y > outline->max.y)
		return false;
	int winding = 0;
	for (size_t ring = 0; ring < outline->starts.count; ring++) {
		size_t first = outline->starts.items[ring], end = ring_end(outline, ring);
		struct dvec2 a = outline->points.items[end - 1];
		for (size_t i = first; i < end; i++) {
			struct dvec2 b = outline->points.items[i];
			if ((a.y <= at.y) != (b.y <= at.y)) {
				double side = dvec2_cross(dvec2_sub(b, a), dvec2_sub(at, a));
				if (b.y > a.y ? side > 0.0 : side < 0.0)
					winding += b.y > a.y ? 1 : -1;
			}
			a = b;
		}
	}
	return winding != 0;
}

static void add_ring(struct outline *outline, GEOSContextHandle_t geos, const GEOSGeometry *ring, bool hole)
{
	const GEOSCoordSequence *sequence = GEOSGeom_getCoordSeq_r(geos, ring);
	unsigned int count = 0;
	if (!sequence || !GEOSCoordSeq_getSize_r(geos, sequence, &count) || count < 4)
		return;
	size_t first = outline->points.count;
	ARRAY_RESERVE(&outline->points, first + count);
	struct dvec2 *to = outline->points.items + first;
	if (!GEOSCoordSeq_copyToBuffer_r(geos, sequence, (double *)to, 0, 0))
		return;
	struct ring plain = { to, count - 1 };
	if ((ring_area(&plain) < 0.0) != hole)
		for (size_t i = 0, j = plain.count - 1; i < j; i++, j--) {
			struct dvec2 swap = to[i];
			to[i] = to[j];
			to[j] = swap;
		}
	struct dvec2 min, max;
	ring_bounds(&plain, &min, &max);
	if (!outline->starts.count) {
		outline->min = min;
		outline->max = max;
	}
	outline->min = (struct dvec2){ fmin(min.x, outline->min.x), fmin(min.y, outline->min.y) };
	outline->max = (struct dvec2){ fmax(max.x, outline->max.x), fmax(max.y, outline->max.y) };
	outline->points.count += plain.count;
	ARRAY_PUSH(&outline->starts, first);
}

void outline_add(struct outline *outline, GEOSContextHandle_t geos, const GEOSGeometry *geometry)
{
	int type = GEOSGeomTypeId_r(geos, geometry);
	if (type == GEOS_POLYGON) {
		if (GEOSisEmpty_r(geos, geometry))
			return;
		add_ring(outline, geos, GEOSGetExteriorRing_r(geos, geometry), false);
		int holes = GEOSGetNumInteriorRings_r(geos, geometry);
		for (int i = 0; i < holes; i++)
			add_ring(outline, geos, GEOSGetInteriorRingN_r(geos, geometry, i), true);
	} else if (type == GEOS_MULTIPOLYGON || type == GEOS_GEOMETRYCOLLECTION) {
		int parts = GEOSGetNumGeometries_r(geos, geometry);
		for (int i = 0; i < parts; i++)
			outline_add(outline, geos, GEOSGetGeometryN_r(geos, geometry, i));
	}
}

static GEOSCoordSequence *make_sequence(GEOSContextHandle_t geos, const struct dvec2 *points, size_t count, bool close)
{
	GEOSCoordSequence *sequence = GEOSCoordSeq_create_r(geos, (unsigned int)(count + close), 2);
	for (size_t i = 0; sequence && i < count + close; i++)
		GEOSCoordSeq_setXY_r(geos, sequence, (unsigned int)i, points[i % count].x, points[i % count].y);
	return sequence;
}

void shape_add_line(struct shape_set *set, const struct dvec2 *points, size_t count, double radius_m, bool flat)
{
	GEOSCoordSequence *sequence = count >= 2 && radius_m > 0.0 ? make_sequence(set->geos, points, count, false) : NULL;
	GEOSGeometry *line = sequence ? GEOSGeom_createLineString_r(set->geos, sequence) : NULL;
	if (line)
		ARRAY_PUSH(&set->lines, (struct shape_line){ line, radius_m, flat });
}

void shape_add_polygon(struct shape_set *set, const struct dvec2 *points, size_t count)
{
	GEOSCoordSequence *sequence = count >= 3 ? make_sequence(set->geos, points, count, true) : NULL;
	GEOSGeometry *ring = sequence ? GEOSGeom_createLinearRing_r(set->geos, sequence) : NULL;
	GEOSGeometry *polygon = ring ? GEOSGeom_createPolygon_r(set->geos, ring, NULL, 0) : NULL;
	if (!polygon)
		return;
	/* A strip around a tight bend may cross itself; a buffer of nothing mends it. */
	if (GEOSisValid_r(set->geos, polygon) != 1) {
		GEOSGeometry *mended = GEOSMakeValid_r(set->geos, polygon);
		GEOSGeom_destroy_r(set->geos, polygon);
		(*set->faults)++;
		if (!mended)
			return;
		polygon = mended;
	}
	ARRAY_PUSH(&set->polygons, polygon);
}

static int compare_lines(const void *left, const void *right)
{
	const struct shape_line *a = left, *b = right;
	if (a->flat != b->flat)
		return a->flat - b->flat;
	return (a->radius_m > b->radius_m) - (a->radius_m < b->radius_m);
}

/* One buffer for all lines of a width: GEOS unites them on the way. */
static void buffer_lines(struct shape_set *set, size_t from, size_t to)
{
	GEOSGeometry **parts = array_grow(NULL, &(size_t){ 0 }, to - from, sizeof(*parts));
	for (size_t i = from; i < to; i++)
		parts[i - from] = set->lines.items[i].line;
	GEOSGeometry *lines =
		GEOSGeom_createCollection_r(set->geos, GEOS_MULTILINESTRING, parts, (unsigned int)(to - from));
	array_free(parts);
	GEOSGeometry *area =
		lines ? GEOSBufferWithStyle_r(set->geos, lines, set->lines.items[from].radius_m, QUADRANT_SEGMENTS,
					set->lines.items[from].flat ? GEOSBUF_CAP_FLAT : GEOSBUF_CAP_ROUND, GEOSBUF_JOIN_ROUND, 5.0)
			  : NULL;
	GEOSGeom_destroy_r(set->geos, lines);
	if (area)
		ARRAY_PUSH(&set->polygons, area);
	else
		(*set->faults)++;
}

void shape_unite(struct shape_set *set, struct outline *out)
{
	if (set->lines.count)
		qsort(set->lines.items, set->lines.count, sizeof(*set->lines.items), compare_lines);
	for (size_t from = 0, to; from < set->lines.count; from = to) {
		for (to = from + 1; to < set->lines.count; to++)
			if (compare_lines(&set->lines.items[from], &set->lines.items[to]) != 0)
				break;
		buffer_lines(set, from, to);
	}
	GEOSGeometry *all = NULL;
	if (set->polygons.count == 1)
		all = set->polygons.items[0];
	else if (set->polygons.count)
		all = GEOSGeom_createCollection_r(
			set->geos, GEOS_GEOMETRYCOLLECTION, set->polygons.items, (unsigned int)set->polygons.count);
	GEOSGeometry *united = all && set->polygons.count > 1 ? GEOSUnaryUnion_r(set->geos, all) : NULL;
	if (all && !united && set->polygons.count > 1)
		(*set->faults)++;
	if (united || all)
		outline_add(out, set->geos, united ? united : all);
	if (united)
		GEOSGeom_destroy_r(set->geos, united);
	if (all)
		GEOSGeom_destroy_r(set->geos, all);
	ARRAY_FINISH(&set->lines);
	ARRAY_FINISH(&set->polygons);
}
