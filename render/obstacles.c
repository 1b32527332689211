/*
 * Boxes first (chunks, then objects), triangles last: a ray looks into the few objects whose bounds it passes. Cost: a
 * walk over all chunks, some 10 ns each.
 */
#include "render/obstacles.h"

#include <math.h>

#include "platform/base/vec.h"

struct ray {
	struct dvec3 from, way; /* m; the ray is from + t * way, 0 <= t <= 1 */
	double hit;             /* smallest t so far */
};

static bool ray_meets_box(const struct ray *ray, const int32_t min_mm[3], const int32_t max_mm[3])
{
	const double from[3] = { ray->from.x, ray->from.y, ray->from.z }, way[3] = { ray->way.x, ray->way.y, ray->way.z };
	double enter = 0.0, leave = ray->hit;
	for (int axis = 0; axis < 3; axis++) {
		double low = min_mm[axis] * 1e-3 - from[axis], high = max_mm[axis] * 1e-3 - from[axis];
		if (fabs(way[axis]) < 1e-12) {
			if (low > 0.0 || high < 0.0)
				return false;
			continue;
		}
		double a = low / way[axis], b = high / way[axis];
		enter = fmax(enter, fmin(a, b));
		leave = fmin(leave, fmax(a, b));
	}
	return enter <= leave;
}

static struct dvec3 sub(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static struct dvec3 cross(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* T. Möller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997; both sides count. */
static void ray_meets_triangle(struct ray *ray, struct dvec3 a, struct dvec3 b, struct dvec3 c)
{
	struct dvec3 ab = sub(b, a), ac = sub(c, a), p = cross(ray->way, ac);
	double det = dot(ab, p);
	if (fabs(det) < 1e-12)
		return;
	struct dvec3 s = sub(ray->from, a);
	double u = dot(s, p) / det;
	if (u < 0.0 || u > 1.0)
		return;
	struct dvec3 q = cross(s, ab);
	double v = dot(ray->way, q) / det;
	if (v < 0.0 || u + v > 1.0)
		return;
	double t = dot(ac, q) / det;
	if (t >= 0.0 && t < ray->hit)
		ray->hit = t;
}

static struct dvec3 vertex_at(const struct pkg_chunk *chunk, const struct pkg_mesh_vertex *vertex)
{
	return (struct dvec3){ ((double)chunk->origin_mm[0] + vertex->pos_mm[0]) * 1e-3,
		((double)chunk->origin_mm[1] + vertex->pos_mm[1]) * 1e-3,
		((double)chunk->origin_mm[2] + vertex->pos_mm[2]) * 1e-3 };
}

static void ray_meets_object(struct ray *ray, const struct pkg *pkg, const struct pkg_object *object)
{
	const struct pkg_chunk *chunk = &pkg->chunks[object->chunk];
	const struct pkg_mesh_vertex *vertices = pkg_chunk_vertices(pkg, chunk);
	const uint16_t *index = pkg_chunk_indices(pkg, chunk) + object->first_index[PKG_PASS_OPAQUE];
	for (uint32_t i = 0; i + 2 < object->index_count[PKG_PASS_OPAQUE]; i += 3)
		ray_meets_triangle(ray, vertex_at(chunk, &vertices[index[i]]), vertex_at(chunk, &vertices[index[i + 1]]),
			vertex_at(chunk, &vertices[index[i + 2]]));
}

static bool solid(const struct pkg_object *object)
{
	return object->kind == PKG_OBJECT_BUILDING || object->kind == PKG_OBJECT_BRIDGE ||
		   object->kind == PKG_OBJECT_TUNNEL;
}

static void cast(const struct obstacles *obstacles, struct ray *ray)
{
	const struct pkg *pkg = obstacles->pkg;
	for (uint32_t c = 0; c < pkg->chunk_count; c++) {
		const struct pkg_chunk *chunk = &pkg->chunks[c];
		if (obstacles->residency->chunks[c].state != RESIDENCY_PRESENT ||
			!ray_meets_box(ray, chunk->min_mm, chunk->max_mm))
			continue;
		for (uint32_t i = 0; i < chunk->object_count; i++) {
			const struct pkg_object *object = &pkg->objects[chunk->first_object + i];
			if (solid(object) && ray_meets_box(ray, object->min_mm, object->max_mm))
				ray_meets_object(ray, pkg, object);
		}
	}
}

static struct dvec3 metres(const int64_t at_mm[3])
{
	return (struct dvec3){ (double)at_mm[0] * 1e-3, (double)at_mm[1] * 1e-3, (double)at_mm[2] * 1e-3 };
}

double obstacles_reach(
	const struct obstacles *obstacles, const int64_t from_mm[3], const int64_t to_mm[3], double clear_m)
{
	struct dvec3 from = metres(from_mm), way = sub(metres(to_mm), from);
	double length = sqrt(dot(way, way));
	if (length < 1e-6)
		return 1.0;
	/* a bundle of rays as wide as the near plane needs */
	double flat = fmax(hypot(way.x, way.y), 1e-9);
	struct dvec3 side = { way.y / flat * clear_m, -way.x / flat * clear_m, 0.0 };
	const struct dvec3 shifts[] = { { 0, 0, 0 }, side, { -side.x, -side.y, 0.0 }, { 0, 0, clear_m },
		{ 0, 0, -clear_m } };
	double reach = 1.0, past = (length + clear_m) / length;
	for (size_t i = 0; i < sizeof(shifts) / sizeof(shifts[0]); i++) {
		struct ray ray = { .way = { way.x * past, way.y * past, way.z * past }, .hit = 1.0 };
		ray.from = (struct dvec3){ from.x + shifts[i].x, from.y + shifts[i].y, from.z + shifts[i].z };
		cast(obstacles, &ray);
		if (ray.hit < 1.0)
			reach = fmin(reach, fmax(0.0, ray.hit * past - clear_m / length));
	}
	return reach;
}

static bool is_among(const uint32_t *objects, uint32_t count, uint32_t object)
{
	for (uint32_t i = 0; i < count; i++)
		if (objects[i] == object)
			return true;
	return false;
}

static bool object_blocks(const struct pkg *pkg, const struct pkg_object *object, const struct ray *way)
{
	struct ray ray = *way;
	if (object->kind != PKG_OBJECT_BUILDING || !ray_meets_box(&ray, object->min_mm, object->max_mm))
		return false;
	ray_meets_object(&ray, pkg, object);
	return ray.hit < way->hit;
}

uint32_t obstacles_between(const struct obstacles *obstacles, const int64_t from_mm[3], const int64_t to_mm[3],
	uint32_t *objects, uint32_t count, uint32_t room)
{
	const struct pkg *pkg = obstacles->pkg;
	const struct ray ray = { .from = metres(from_mm), .way = sub(metres(to_mm), metres(from_mm)), .hit = 1.0 };
	for (uint32_t c = 0; c < pkg->chunk_count; c++) {
		const struct pkg_chunk *chunk = &pkg->chunks[c];
		if (chunk->kind != PKG_CHUNK_BLOCK || obstacles->residency->chunks[c].state != RESIDENCY_PRESENT ||
			!ray_meets_box(&ray, chunk->min_mm, chunk->max_mm))
			continue;
		for (uint32_t i = 0; i < chunk->object_count && count < room; i++) {
			uint32_t object = chunk->first_object + i;
			if (!is_among(objects, count, object) && object_blocks(pkg, &pkg->objects[object], &ray))
				objects[count++] = object;
		}
	}
	return count;
}

bool obstacles_covered(const struct obstacles *obstacles, const int64_t at_mm[3], double up_m)
{
	struct ray ray = { .from = metres(at_mm), .way = { 1e-4, 2e-4, up_m }, .hit = 1.0 };
	cast(obstacles, &ray);
	return ray.hit < 1.0;
}

static bool holds(const int32_t min_mm[3], const int32_t max_mm[3], int64_t east_mm, int64_t north_mm)
{
	return east_mm >= min_mm[0] && east_mm <= max_mm[0] && north_mm >= min_mm[1] && north_mm <= max_mm[1];
}

int64_t obstacles_roof_mm(const struct obstacles *obstacles, int64_t east_mm, int64_t north_mm)
{
	const struct pkg *pkg = obstacles->pkg;
	int64_t roof = INT64_MIN;
	for (uint32_t c = 0; c < pkg->chunk_count; c++) {
		const struct pkg_chunk *chunk = &pkg->chunks[c];
		if (!holds(chunk->min_mm, chunk->max_mm, east_mm, north_mm))
			continue;
		for (uint32_t i = 0; i < chunk->object_count; i++) {
			const struct pkg_object *object = &pkg->objects[chunk->first_object + i];
			bool here = object->kind == PKG_OBJECT_BUILDING && holds(object->min_mm, object->max_mm, east_mm, north_mm);
			if (here && object->max_mm[2] > roof)
				roof = object->max_mm[2];
		}
	}
	return roof;
}

int64_t obstacles_ground_mm(const struct obstacles *obstacles, int64_t east_mm, int64_t north_mm)
{
	return pkg_ground_mm(obstacles->pkg, east_mm, north_mm);
}
