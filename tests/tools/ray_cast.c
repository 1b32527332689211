#include "ray_cast.h"

#define CELL_M 16.0
#define EDGE 1e-9 /* of barycentric coordinates: no ray slips through between neighbours */

struct ray_caster {
	const struct pkg *pkg;
	int64_t min[2];
	int64_t columns, rows;
	uint32_t *first; /* of a cell's items; one more than cells */
	ARRAY(struct ray_hit) triangles;
	ARRAY(uint32_t) items;
};

static void corners_of(const struct pkg *pkg, uint32_t object, uint32_t triangle, struct dvec3 out[3])
{
	int64_t mm[3][3];
	triangle_set_corners(pkg, object, triangle, mm);
	for (int i = 0; i < 3; i++)
		out[i] = (struct dvec3){ (double)mm[i][0] * 1e-3, (double)mm[i][1] * 1e-3, (double)mm[i][2] * 1e-3 };
}

static int64_t cell_of(double at)
{
	return (int64_t)floor(at / CELL_M);
}

/* Cells that the triangle's bounds touch. */
static void bounds_of(const struct ray_caster *caster, const struct dvec3 p[3], int64_t low[2], int64_t high[2])
{
	low[0] = cell_of(fmin(p[0].x, fmin(p[1].x, p[2].x))) - caster->min[0];
	low[1] = cell_of(fmin(p[0].y, fmin(p[1].y, p[2].y))) - caster->min[1];
	high[0] = cell_of(fmax(p[0].x, fmax(p[1].x, p[2].x))) - caster->min[0];
	high[1] = cell_of(fmax(p[0].y, fmax(p[1].y, p[2].y))) - caster->min[1];
}

static void sort_in(struct ray_caster *caster)
{
	size_t cells = (size_t)(caster->columns * caster->rows);
	for (int pass = 0; pass < 2; pass++) {
		for (size_t i = 0; i < caster->triangles.count; i++) {
			struct dvec3 p[3];
			int64_t low[2], high[2];
			corners_of(caster->pkg, caster->triangles.items[i].object, caster->triangles.items[i].triangle, p);
			bounds_of(caster, p, low, high);
			for (int64_t y = low[1]; y <= high[1]; y++)
				for (int64_t x = low[0]; x <= high[0]; x++) {
					uint32_t *slot = &caster->first[y * caster->columns + x + 2 - pass];
					if (pass)
						caster->items.items[(*slot)++] = (uint32_t)i;
					else
						(*slot)++;
				}
		}
		if (pass)
			return;
		for (size_t i = 2; i < cells + 2; i++)
			caster->first[i] += caster->first[i - 1];
		caster->items.count = caster->first[cells + 1];
		ARRAY_RESERVE(&caster->items, caster->items.count + 1);
	}
}

struct ray_caster *ray_caster_new(const struct pkg *pkg)
{
	struct ray_caster *out = array_grow(NULL, &(size_t){ 0 }, 1, sizeof(*out));
	*out = (struct ray_caster){ .pkg = pkg };
	for (int axis = 0; axis < 2; axis++)
		out->min[axis] = cell_of(pkg->meta->min_mm[axis] * 1e-3) - 1;
	out->columns = cell_of(pkg->meta->max_mm[0] * 1e-3) + 2 - out->min[0];
	out->rows = cell_of(pkg->meta->max_mm[1] * 1e-3) + 2 - out->min[1];
	size_t cells = (size_t)(out->columns * out->rows);
	out->first = array_grow(NULL, &(size_t){ 0 }, cells + 2, sizeof(uint32_t));
	for (size_t i = 0; i < cells + 2; i++)
		out->first[i] = 0;
	for (uint32_t o = 0; o < pkg->object_count; o++)
		for (uint32_t t = 0; t < triangle_set_object_size(&pkg->objects[o]); t++)
			ARRAY_PUSH(&out->triangles, (struct ray_hit){ .object = o, .triangle = t });
	sort_in(out);
	return out;
}

void ray_caster_free(struct ray_caster *caster)
{
	array_free(caster->first);
	ARRAY_FINISH(&caster->triangles);
	ARRAY_FINISH(&caster->items);
	array_free(caster);
}

static struct dvec3 minus(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct dvec3 cross(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

/* Moeller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection". */
static bool meets(const struct dvec3 p[3], struct dvec3 from, struct dvec3 direction, double *t, bool *front)
{
	struct dvec3 a = minus(p[1], p[0]), b = minus(p[2], p[0]), h = cross(direction, b), s = minus(from, p[0]);
	double det = dot(a, h);
	if (fabs(det) < 1e-12)
		return false;
	double u = dot(s, h) / det;
	struct dvec3 q = cross(s, a);
	double v = dot(direction, q) / det;
	*t = dot(b, q) / det;
	*front = det > 0.0;
	return u >= -EDGE && v >= -EDGE && u + v <= 1.0 + EDGE && *t > 1e-6;
}

static void cast_in_cell(const struct ray_caster *caster, int64_t cell, struct dvec3 from, struct dvec3 direction,
	bool backs, struct ray_hit *best)
{
	for (uint32_t i = caster->first[cell]; i < caster->first[cell + 1]; i++) {
		struct ray_hit hit = caster->triangles.items[caster->items.items[i]];
		struct dvec3 p[3];
		corners_of(caster->pkg, hit.object, hit.triangle, p);
		if (meets(p, from, direction, &hit.t, &hit.front) && (backs || hit.front) && hit.t < best->t)
			*best = hit;
	}
}

bool ray_cast(const struct ray_caster *caster, struct dvec3 from, struct dvec3 direction, double t_max, bool backs,
	struct ray_hit *hit)
{
	*hit = (struct ray_hit){ .t = t_max };
	double at[2] = { from.x / CELL_M - (double)caster->min[0], from.y / CELL_M - (double)caster->min[1] };
	double step[2] = { direction.x / CELL_M, direction.y / CELL_M };
	int64_t cell[2] = { (int64_t)floor(at[0]), (int64_t)floor(at[1]) }, size[2] = { caster->columns, caster->rows };
	double next[2];
	for (int axis = 0; axis < 2; axis++) {
		double border = (double)cell[axis] + (step[axis] > 0.0);
		next[axis] = fabs(step[axis]) > 1e-15 ? (border - at[axis]) / step[axis] : INFINITY;
	}
	for (double t = 0.0; t < hit->t;) {
		if (cell[0] < 0 || cell[1] < 0 || cell[0] >= size[0] || cell[1] >= size[1])
			break;
		cast_in_cell(caster, cell[1] * caster->columns + cell[0], from, direction, backs, hit);
		int axis = next[0] < next[1] ? 0 : 1;
		t = next[axis];
		cell[axis] += step[axis] > 0.0 ? 1 : -1;
		next[axis] += 1.0 / fabs(step[axis]);
	}
	return hit->t < t_max;
}
