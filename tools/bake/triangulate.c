#include "tools/bake/triangulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <geos_c.h>

#include "platform/base/rng.h"

struct triangulator {
	GEOSContextHandle_t geos;
	uint32_t *table; /* open addressing: index of a point by its coordinates */
	size_t table_size;
};

struct triangulator *triangulator_new(void)
{
	struct triangulator *out = calloc(1, sizeof(*out));
	if (out)
		out->geos = GEOS_init_r();
	if (out && !out->geos) {
		free(out);
		return NULL;
	}
	return out;
}

void triangulator_free(struct triangulator *triangulator)
{
	if (!triangulator)
		return;
	GEOS_finish_r(triangulator->geos);
	free(triangulator->table);
	free(triangulator);
}

static size_t slot_of(const struct triangulator *self, struct dvec2 at)
{
	uint64_t bits[2];
	memcpy(&bits[0], &at.x, 8);
	memcpy(&bits[1], &at.y, 8);
	return (size_t)hash_u64(bits[0] ^ hash_u64(bits[1])) & (self->table_size - 1);
}

static bool same_point(struct dvec2 a, struct dvec2 b)
{
	return !(a.x < b.x) && !(a.x > b.x) && !(a.y < b.y) && !(a.y > b.y);
}

static uint32_t *find_point(struct triangulator *self, const struct dvec2 *points, struct dvec2 at)
{
	size_t slot = slot_of(self, at);
	while (self->table[slot] != UINT32_MAX && !same_point(points[self->table[slot]], at))
		slot = (slot + 1) & (self->table_size - 1);
	return &self->table[slot];
}

static bool index_points(struct triangulator *self, const struct dvec2 *points, size_t count)
{
	size_t size = 16;
	while (size < count * 2)
		size *= 2;
	if (size > self->table_size) {
		free(self->table);
		self->table = malloc(size * sizeof(*self->table));
		self->table_size = self->table ? size : 0;
	}
	if (!self->table)
		return false;
	memset(self->table, 0xFF, self->table_size * sizeof(*self->table));
	for (size_t i = 0; i < count; i++) {
		uint32_t *slot = find_point(self, points, points[i]);
		if (*slot == UINT32_MAX)
			*slot = (uint32_t)i;
	}
	return true;
}

static GEOSGeometry *make_ring(GEOSContextHandle_t geos, const struct dvec2 *points, size_t count)
{
	GEOSCoordSequence *sequence = GEOSCoordSeq_create_r(geos, (unsigned)count + 1, 2);
	if (!sequence)
		return NULL;
	for (size_t i = 0; i <= count; i++)
		GEOSCoordSeq_setXY_r(geos, sequence, (unsigned)i, points[i % count].x, points[i % count].y);
	return GEOSGeom_createLinearRing_r(geos, sequence);
}

static GEOSGeometry *make_polygon(
	GEOSContextHandle_t geos, const struct dvec2 *points, const size_t *first, size_t rings)
{
	GEOSGeometry *outer = make_ring(geos, points, first[1]);
	GEOSGeometry **holes = calloc(rings, sizeof(GEOSGeometry *));
	bool good = outer && holes;
	unsigned made = 0;
	for (size_t i = 1; good && i < rings; i++) {
		holes[made] = make_ring(geos, points + first[i], first[i + 1] - first[i]);
		good = holes[made] != NULL;
		made += good;
	}
	GEOSGeometry *polygon = good ? GEOSGeom_createPolygon_r(geos, outer, holes, made) : NULL;
	if (!good) {
		for (unsigned i = 0; i < made; i++)
			GEOSGeom_destroy_r(geos, holes[i]);
		if (outer)
			GEOSGeom_destroy_r(geos, outer);
	}
	free(holes);
	return polygon;
}

static bool take_triangle(
	struct triangulator *self, const GEOSGeometry *triangle, const struct dvec2 *points, index_array *out)
{
	const GEOSGeometry *ring = GEOSGetExteriorRing_r(self->geos, triangle);
	const GEOSCoordSequence *sequence = ring ? GEOSGeom_getCoordSeq_r(self->geos, ring) : NULL;
	uint32_t corner[3];
	for (unsigned i = 0; i < 3; i++) {
		struct dvec2 at;
		if (!sequence || !GEOSCoordSeq_getXY_r(self->geos, sequence, i, &at.x, &at.y))
			return false;
		corner[i] = *find_point(self, points, at);
		if (corner[i] == UINT32_MAX)
			return false;
	}
	struct dvec2 a = points[corner[0]];
	bool left = dvec2_cross(dvec2_sub(points[corner[1]], a), dvec2_sub(points[corner[2]], a)) > 0.0;
	ARRAY_PUSH(out, corner[0]);
	ARRAY_PUSH(out, corner[left ? 1 : 2]);
	ARRAY_PUSH(out, corner[left ? 2 : 1]);
	return true;
}

static bool take_all(
	struct triangulator *self, const GEOSGeometry *result, const struct dvec2 *points, index_array *out)
{
	int count = GEOSGetNumGeometries_r(self->geos, result);
	for (int i = 0; i < count; i++)
		if (!take_triangle(self, GEOSGetGeometryN_r(self->geos, result, i), points, out))
			return false;
	return count > 0;
}

bool triangulate_rings(struct triangulator *self, const struct dvec2 *points, const size_t *ring_first,
	size_t ring_count, index_array *out)
{
	size_t before = out->count;
	if (!index_points(self, points, ring_first[ring_count]))
		return false;
	GEOSGeometry *polygon = make_polygon(self->geos, points, ring_first, ring_count);
	bool good = polygon && GEOSisValid_r(self->geos, polygon) == 1;
	GEOSGeometry *result = good ? GEOSConstrainedDelaunayTriangulation_r(self->geos, polygon) : NULL;
	good = result && take_all(self, result, points, out);
	if (!good)
		out->count = before;
	if (result)
		GEOSGeom_destroy_r(self->geos, result);
	if (polygon)
		GEOSGeom_destroy_r(self->geos, polygon);
	return good;
}

static double corner_area(const struct dvec2 *points, uint32_t a, uint32_t b, uint32_t c)
{
	return dvec2_cross(dvec2_sub(points[b], points[a]), dvec2_sub(points[c], points[a]));
}

static bool holds_a_point(const struct dvec2 *points, const uint32_t *ring, size_t count, const uint32_t ear[3])
{
	for (size_t i = 0; i < count; i++) {
		uint32_t at = ring[i];
		if (at == ear[0] || at == ear[1] || at == ear[2])
			continue;
		if (corner_area(points, ear[0], ear[1], at) >= 0.0 && corner_area(points, ear[1], ear[2], at) >= 0.0 &&
			corner_area(points, ear[2], ear[0], at) >= 0.0)
			return true;
	}
	return false;
}

/* How good an ear is: its area over its longest side squared; negative when it is none. */
static double ear_quality(const struct dvec2 *points, const uint32_t *ring, size_t count, size_t i)
{
	uint32_t ear[3] = { ring[(i + count - 1) % count], ring[i], ring[(i + 1) % count] };
	double area = corner_area(points, ear[0], ear[1], ear[2]), longest = 1e-12;
	for (int k = 0; k < 3; k++)
		longest = fmax(longest, dvec2_length(dvec2_sub(points[ear[k]], points[ear[(k + 1) % 3]])));
	double quality = area / (longest * longest);
	if (quality > 1e-9 && holds_a_point(points, ring, count, ear))
		return -1.0 + quality * 1e-3;
	return quality;
}

void triangulate_face(const struct dvec2 *points, size_t count, index_array *out)
{
	uint32_t small[64], *ring = count <= 64 ? small : malloc(count * sizeof(*ring));
	if (!ring)
		return;
	for (size_t i = 0; i < count; i++)
		ring[i] = (uint32_t)i;
	while (count >= 3) {
		size_t best = 0;
		double best_quality = -INFINITY;
		for (size_t i = 0; i < count && count > 3; i++) {
			double quality = ear_quality(points, ring, count, i);
			if (quality > best_quality) {
				best_quality = quality;
				best = i;
			}
		}
		ARRAY_PUSH(out, ring[(best + count - 1) % count]);
		ARRAY_PUSH(out, ring[best]);
		ARRAY_PUSH(out, ring[(best + 1) % count]);
		memmove(ring + best, ring + best + 1, (count - best - 1) * sizeof(*ring));
		count--;
	}
	if (ring != small)
		free(ring);
}
