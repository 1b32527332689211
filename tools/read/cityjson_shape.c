#include "tools/read/cityjson_shape.h"

#include <stdlib.h>

#define FLAT_ENOUGH 0.05 /* of the normal's length, upwards or downwards */
#define SNAP_M 0.02

bool surface_normal(const struct surface *surface, struct dvec3 *out)
{
	const struct surface_ring *ring = &surface->rings[0];
	struct dvec3 n = { 0.0, 0.0, 0.0 };
	for (size_t i = 0; i < ring->count; i++) {
		struct dvec3 a = ring->points[i], b = ring->points[(i + 1) % ring->count], c = ring->points[0];
		/* From the first point: coordinates of national grids would eat the digits. */
		n.x += (a.y - b.y) * (a.z + b.z - 2.0 * c.z);
		n.y += (a.z - b.z) * (a.x + b.x - 2.0 * c.x);
		n.z += (a.x - b.x) * (a.y + b.y - 2.0 * c.y);
	}
	double length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
	if (!(length > 1e-4))
		return false;
	*out = (struct dvec3){ n.x / length, n.y / length, n.z / length };
	return true;
}

/* A surface's rings in two of its coordinates. */
struct flattening {
	struct dvec3 origin, u, v;
};

static struct dvec2 flatten(const struct flattening *to, struct dvec3 p)
{
	struct dvec3 d = { p.x - to->origin.x, p.y - to->origin.y, p.z - to->origin.z };
	return (
		struct dvec2){ d.x * to->u.x + d.y * to->u.y + d.z * to->u.z, d.x * to->v.x + d.y * to->v.y + d.z * to->v.z };
}

static struct polygon flat_polygon(struct shaper *shaper, const struct surface *surface, const struct flattening *to)
{
	struct polygon out = { .holes = POOL_ARRAY(shaper->pool, struct ring, surface->ring_count) };
	for (size_t r = 0; r < surface->ring_count; r++) {
		const struct surface_ring *from = &surface->rings[r];
		struct ring ring = { POOL_ARRAY(shaper->pool, struct dvec2, from->count), from->count };
		for (size_t i = 0; i < from->count; i++)
			ring.points[i] = flatten(to, from->points[i]);
		if (!r)
			out.outer = ring;
		else if (ring.count >= 3)
			out.holes[out.hole_count++] = ring;
	}
	return out;
}

size_t surfaces_footprint(struct shaper *shaper, const surface_array *surfaces, polygon_array *out)
{
	GEOSContextHandle_t geos = shaper->geos;
	GEOSGeometry **pieces = calloc(surfaces->count + 1, sizeof(GEOSGeometry *));
	unsigned count = 0;
	struct flattening down = { { 0.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 } };
	if (!pieces)
		abort();
	for (size_t i = 0; i < surfaces->count; i++) {
		const struct surface *surface = &surfaces->items[i];
		struct dvec3 normal;
		if (!surface_normal(surface, &normal) || fabs(normal.z) < FLAT_ENOUGH)
			continue;
		struct polygon flat = flat_polygon(shaper, surface, &down);
		GEOSGeometry *piece = shape_to_geos(shaper, &flat);
		GEOSGeometry *valid = piece ? GEOSMakeValid_r(geos, piece) : NULL;
		GEOSGeom_destroy_r(geos, piece);
		if (valid)
			pieces[count++] = valid;
	}
	GEOSGeometry *all = GEOSGeom_createCollection_r(geos, GEOS_GEOMETRYCOLLECTION, pieces, count);
	/* On a grid of a centimetre: neighbours' edges need not meet exactly. */
	GEOSGeometry *merged = all ? GEOSUnaryUnionPrec_r(geos, all, SNAP_M / 2.0) : NULL;
	GEOSGeometry *plain = merged ? GEOSSimplify_r(geos, merged, SNAP_M) : NULL;
	size_t made = shape_from_geos(shaper, plain, 1.0, out);
	GEOSGeom_destroy_r(geos, all);
	GEOSGeom_destroy_r(geos, merged);
	GEOSGeom_destroy_r(geos, plain);
	free(pieces);
	return made;
}

static struct dvec3 cross(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

/* The corner of the surface that was flattened to `at`: the closest, which it is exactly but for mended surfaces. */
static struct dvec3 raise(const struct surface *surface, const struct polygon *flat, struct dvec2 at)
{
	struct dvec3 best = surface->rings[0].points[0];
	double least = INFINITY;
	for (size_t r = 0; r <= flat->hole_count; r++) {
		const struct ring *ring = r ? &flat->holes[r - 1] : &flat->outer;
		for (size_t i = 0; i < ring->count; i++) {
			struct dvec2 d = dvec2_sub(ring->points[i], at);
			double squared = dvec2_dot(d, d);
			if (squared < least) {
				least = squared;
				best = surface->rings[r].points[i];
			}
		}
	}
	return best;
}

static void take_triangles(struct shaper *shaper, const GEOSGeometry *triangles, const struct surface *surface,
	const struct polygon *flat, triangle_array *out)
{
	polygon_array pieces = { 0 };
	shape_from_geos(shaper, triangles, 0.0, &pieces);
	for (size_t i = 0; i < pieces.count; i++)
		for (size_t k = 0; pieces.items[i].outer.count == 3 && k < 3; k++)
			ARRAY_PUSH(out, raise(surface, flat, pieces.items[i].outer.points[k]));
	ARRAY_FINISH(&pieces);
}

bool surface_triangles(struct shaper *shaper, const struct surface *surface, triangle_array *out)
{
	GEOSContextHandle_t geos = shaper->geos;
	struct flattening to = { .origin = surface->rings[0].points[0] };
	struct dvec3 n, side;
	size_t before = out->count;
	if (!surface_normal(surface, &n))
		return false;
	if (surface->ring_count == 1 && surface->rings[0].count == 3) {
		for (size_t k = 0; k < 3; k++)
			ARRAY_PUSH(out, surface->rings[0].points[k]);
		return true;
	}
	/* u, v, n right-handed: triangles that are counter-clockwise in the plane face as the surface does. */
	side = fabs(n.z) < 0.9 ? (struct dvec3){ 0.0, 0.0, 1.0 } : (struct dvec3){ 1.0, 0.0, 0.0 };
	to.u = cross(side, n);
	double length = sqrt(to.u.x * to.u.x + to.u.y * to.u.y + to.u.z * to.u.z);
	to.u = (struct dvec3){ to.u.x / length, to.u.y / length, to.u.z / length };
	to.v = cross(n, to.u);
	struct polygon flat = flat_polygon(shaper, surface, &to);
	GEOSGeometry *polygon = shape_to_geos(shaper, &flat);
	GEOSGeometry *valid = polygon && GEOSisValid_r(geos, polygon) != 1 ? GEOSMakeValid_r(geos, polygon) : NULL;
	GEOSGeometry *triangles = polygon ? GEOSConstrainedDelaunayTriangulation_r(geos, valid ? valid : polygon) : NULL;
	if (triangles)
		take_triangles(shaper, triangles, surface, &flat, out);
	GEOSGeom_destroy_r(geos, polygon);
	GEOSGeom_destroy_r(geos, valid);
	GEOSGeom_destroy_r(geos, triangles);
	return out->count > before;
}
