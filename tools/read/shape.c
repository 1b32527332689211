#include "tools/read/shape.h"

#include <stdlib.h>
#include <string.h>

#define SAME_POINT_M 1e-3

static void ignore_message(const char *message, void *data)
{
	(void)message;
	(void)data;
}

void shaper_init(struct shaper *shaper, struct pool *pool, struct report *report)
{
	*shaper = (struct shaper){ GEOS_init_r(), pool, report };
	GEOSContext_setErrorMessageHandler_r(shaper->geos, ignore_message, NULL);
	GEOSContext_setNoticeMessageHandler_r(shaper->geos, ignore_message, NULL);
}

void shaper_finish(struct shaper *shaper)
{
	if (shaper->geos)
		GEOS_finish_r(shaper->geos);
	shaper->geos = NULL;
}

static bool same_point(struct dvec2 a, struct dvec2 b)
{
	return fabs(a.x - b.x) < SAME_POINT_M && fabs(a.y - b.y) < SAME_POINT_M;
}

bool shape_ring(struct shaper *shaper, int64_t id, const struct dvec2 *points, size_t count, struct ring *out)
{
	struct dvec2 *kept = POOL_ARRAY(shaper->pool, struct dvec2, count);
	size_t used = 0;
	if (count > 1 && same_point(points[0], points[count - 1]))
		count--;
	for (size_t i = 0; i < count; i++) {
		if (used && same_point(points[i], kept[used - 1]))
			continue;
		if (used >= 2 && same_point(points[i], kept[used - 2])) { /* there and back */
			used--;
			continue;
		}
		kept[used++] = points[i];
	}
	while (used > 1 && same_point(kept[0], kept[used - 1]))
		used--;
	*out = (struct ring){ kept, used };
	if (used < 3)
		return false;
	if (used < count)
		report_fault(shaper->report, FAULT_DUPLICATE_NODE, FAULT_MENDED, id);
	return true;
}

double polygon_area(const struct polygon *polygon)
{
	double area = fabs(ring_area(&polygon->outer));
	for (size_t i = 0; i < polygon->hole_count; i++)
		area -= fabs(ring_area(&polygon->holes[i]));
	return area;
}

static GEOSGeometry *linear_ring(const struct shaper *shaper, const struct ring *ring)
{
	GEOSCoordSequence *points = GEOSCoordSeq_create_r(shaper->geos, (unsigned)ring->count + 1, 2);
	if (!points)
		return NULL;
	for (size_t i = 0; i <= ring->count; i++) {
		struct dvec2 at = ring->points[i % ring->count];
		GEOSCoordSeq_setXY_r(shaper->geos, points, (unsigned)i, at.x, at.y);
	}
	return GEOSGeom_createLinearRing_r(shaper->geos, points);
}

GEOSGeometry *shape_to_geos(const struct shaper *shaper, const struct polygon *polygon)
{
	if (polygon->outer.count < 3)
		return NULL;
	GEOSGeometry *outer = linear_ring(shaper, &polygon->outer);
	if (!outer)
		return NULL;
	GEOSGeometry **holes = calloc(polygon->hole_count + 1, sizeof(GEOSGeometry *));
	unsigned count = 0;
	for (size_t i = 0; holes && i < polygon->hole_count; i++) {
		GEOSGeometry *hole = polygon->holes[i].count >= 3 ? linear_ring(shaper, &polygon->holes[i]) : NULL;
		if (hole)
			holes[count++] = hole;
	}
	GEOSGeometry *out = GEOSGeom_createPolygon_r(shaper->geos, outer, holes, count);
	free(holes);
	return out;
}

static bool take_ring(const struct shaper *shaper, const GEOSGeometry *from, bool counter_clockwise, struct ring *out)
{
	const GEOSCoordSequence *points = GEOSGeom_getCoordSeq_r(shaper->geos, from);
	unsigned count = 0;
	if (!points || !GEOSCoordSeq_getSize_r(shaper->geos, points, &count) || count < 4)
		return false;
	struct ring ring = { POOL_ARRAY(shaper->pool, struct dvec2, count), 0 };
	for (unsigned i = 0; i + 1 < count; i++) {
		struct dvec2 at;
		GEOSCoordSeq_getXY_r(shaper->geos, points, i, &at.x, &at.y);
		if (!ring.count || !same_point(at, ring.points[ring.count - 1]))
			ring.points[ring.count++] = at;
	}
	while (ring.count > 1 && same_point(ring.points[0], ring.points[ring.count - 1]))
		ring.count--;
	if (ring.count < 3)
		return false;
	if ((ring_area(&ring) > 0.0) != counter_clockwise)
		for (size_t i = 0, j = ring.count - 1; i < j; i++, j--) {
			struct dvec2 swap = ring.points[i];
			ring.points[i] = ring.points[j];
			ring.points[j] = swap;
		}
	*out = ring;
	return true;
}

static bool take_polygon(const struct shaper *shaper, const GEOSGeometry *from, double least_m2, struct polygon *out)
{
	*out = (struct polygon){ 0 };
	if (!take_ring(shaper, GEOSGetExteriorRing_r(shaper->geos, from), true, &out->outer))
		return false;
	int holes = GEOSGetNumInteriorRings_r(shaper->geos, from);
	if (holes > 0)
		out->holes = POOL_ARRAY(shaper->pool, struct ring, holes);
	for (int i = 0; i < holes; i++) {
		struct ring *hole = &out->holes[out->hole_count];
		if (take_ring(shaper, GEOSGetInteriorRingN_r(shaper->geos, from, i), false, hole) && ring_area(hole) < -0.01)
			out->hole_count++;
	}
	return polygon_area(out) >= least_m2;
}

size_t shape_from_geos(const struct shaper *shaper, const GEOSGeometry *geometry, double least_m2, polygon_array *out)
{
	size_t before = out->count;
	if (!geometry)
		return 0;
	int type = GEOSGeomTypeId_r(shaper->geos, geometry);
	if (type == GEOS_POLYGON) {
		struct polygon polygon;
		if (!GEOSisEmpty_r(shaper->geos, geometry) && take_polygon(shaper, geometry, least_m2, &polygon))
			ARRAY_PUSH(out, polygon);
	} else if (type == GEOS_MULTIPOLYGON || type == GEOS_GEOMETRYCOLLECTION) {
		int count = GEOSGetNumGeometries_r(shaper->geos, geometry);
		for (int i = 0; i < count; i++)
			shape_from_geos(shaper, GEOSGetGeometryN_r(shaper->geos, geometry, i), least_m2, out);
	}
	return out->count - before;
}

size_t shape_polygons(
	struct shaper *shaper, int64_t id, const struct polygon *from, double least_m2, polygon_array *out)
{
	GEOSGeometry *given = shape_to_geos(shaper, from);
	if (!given) {
		report_fault(shaper->report, FAULT_BAD_GEOMETRY, FAULT_DROPPED, id);
		return 0;
	}
	size_t count = 0;
	if (GEOSisValid_r(shaper->geos, given) == 1) {
		count = shape_from_geos(shaper, given, least_m2, out);
		if (!count)
			report_fault(shaper->report, FAULT_DEGENERATE_RING, FAULT_DROPPED, id);
	} else {
		GEOSGeometry *mended = GEOSMakeValid_r(shaper->geos, given);
		count = shape_from_geos(shaper, mended, least_m2, out);
		bool flat = !mended || polygon_area(from) < least_m2;
		report_fault(shaper->report, flat && !count ? FAULT_DEGENERATE_RING : FAULT_SELF_CROSSING,
			count ? FAULT_MENDED : FAULT_DROPPED, id);
		GEOSGeom_destroy_r(shaper->geos, mended);
	}
	GEOSGeom_destroy_r(shaper->geos, given);
	return count;
}
