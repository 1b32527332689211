#include "tools/bake/partition.h"

#include <math.h>

/* Lattice points count from the rectangle's south-west corner; that corner is a lattice point of the city frame. */
static struct cdt_point to_lattice(const struct partition *partition, struct dvec2 at)
{
	return (struct cdt_point){ (int32_t)(llround(at.x / PARTITION_LATTICE_M) - partition->low[0]),
		(int32_t)(llround(at.y / PARTITION_LATTICE_M) - partition->low[1]) };
}

struct dvec2 partition_vertex(const struct partition *partition, uint32_t vertex)
{
	struct cdt_point p = partition->cdt.points.items[vertex];
	return (struct dvec2){ (double)(p.x + partition->low[0]) * PARTITION_LATTICE_M,
		(double)(p.y + partition->low[1]) * PARTITION_LATTICE_M };
}

void partition_begin(struct partition *partition, struct dvec2 min, struct dvec2 max)
{
	*partition = (struct partition){ 0 };
	const double bounds[4] = { min.x, min.y, max.x, max.y };
	int64_t lattice[4];
	for (int i = 0; i < 4; i++)
		lattice[i] = (int64_t)(i < 2 ? floor(bounds[i] / PARTITION_LATTICE_M + 1e-6)
									 : ceil(bounds[i] / PARTITION_LATTICE_M - 1e-6));
	partition->low[0] = lattice[0];
	partition->low[1] = lattice[1];
	cdt_init(&partition->cdt, (struct cdt_point){ 0, 0 },
		(struct cdt_point){ (int32_t)(lattice[2] - lattice[0]), (int32_t)(lattice[3] - lattice[1]) });
	partition->min =
		(struct dvec2){ (double)lattice[0] * PARTITION_LATTICE_M, (double)lattice[1] * PARTITION_LATTICE_M };
	partition->max =
		(struct dvec2){ (double)lattice[2] * PARTITION_LATTICE_M, (double)lattice[3] * PARTITION_LATTICE_M };
}

void partition_finish(struct partition *partition)
{
	cdt_finish(&partition->cdt);
	ARRAY_FINISH(&partition->face_of);
	ARRAY_FINISH(&partition->faces);
}

/* Liang, Barsky, "A new concept and method for line clipping", 1984. */
static bool clip_side(double p, double q, double *from, double *to)
{
	if (p == 0.0)
		return q >= 0.0;
	double r = q / p;
	if (p < 0.0) {
		if (r > *to)
			return false;
		if (r > *from)
			*from = r;
		return true;
	}
	if (r < *from)
		return false;
	if (r < *to)
		*to = r;
	return true;
}

bool clip_segment(struct dvec2 min, struct dvec2 max, struct dvec2 *a, struct dvec2 *b)
{
	double from = 0.0, to = 1.0;
	struct dvec2 d = dvec2_sub(*b, *a), start = *a;
	if (!clip_side(-d.x, start.x - min.x, &from, &to) || !clip_side(d.x, max.x - start.x, &from, &to) ||
		!clip_side(-d.y, start.y - min.y, &from, &to) || !clip_side(d.y, max.y - start.y, &from, &to))
		return false;
	if (to < 1.0)
		*b = dvec2_add(start, dvec2_scale(d, to));
	if (from > 0.0)
		*a = dvec2_add(start, dvec2_scale(d, from));
	return true;
}

void partition_cut(struct partition *partition, struct dvec2 a, struct dvec2 b)
{
	if (!clip_segment(partition->min, partition->max, &a, &b))
		return;
	uint32_t from = cdt_add_point(&partition->cdt, to_lattice(partition, a)),
			 to = cdt_add_point(&partition->cdt, to_lattice(partition, b));
	if (from != to)
		cdt_add_segment(&partition->cdt, from, to);
}

void partition_cut_line(struct partition *partition, const struct dvec2 *points, size_t count, bool closed)
{
	for (size_t i = 0; i + 1 < count; i++)
		partition_cut(partition, points[i], points[i + 1]);
	if (closed && count > 2)
		partition_cut(partition, points[count - 1], points[0]);
}

static double triangle_area(const struct partition *partition, const struct cdt_triangle *t, struct dvec2 *centre)
{
	struct dvec2 a = partition_vertex(partition, t->corner[0]), b = partition_vertex(partition, t->corner[1]);
	struct dvec2 c = partition_vertex(partition, t->corner[2]);
	*centre = (struct dvec2){ (a.x + b.x + c.x) / 3.0, (a.y + b.y + c.y) / 3.0 };
	return dvec2_cross(dvec2_sub(b, a), dvec2_sub(c, a)) / 2.0;
}

static void flood(struct partition *partition, uint32_t start, uint32_t face)
{
	struct cdt *cdt = &partition->cdt;
	double largest = -1.0;
	cdt->stack.count = 0;
	ARRAY_PUSH(&cdt->stack, start);
	partition->face_of.items[start] = face;
	while (cdt->stack.count) {
		const struct cdt_triangle *t = &cdt->triangles.items[cdt->stack.items[--cdt->stack.count]];
		struct partition_face *out = &partition->faces.items[face];
		struct dvec2 centre;
		double area = triangle_area(partition, t, &centre);
		out->area_m2 += area;
		if (area > largest) {
			largest = area;
			out->inside = centre;
		}
		for (int i = 0; i < 3; i++) {
			if (t->neighbour[i] == CDT_NONE || t->fixed[i] || partition->face_of.items[t->neighbour[i]] != CDT_NONE)
				continue;
			partition->face_of.items[t->neighbour[i]] = face;
			ARRAY_PUSH(&cdt->stack, t->neighbour[i]);
		}
	}
}

void partition_faces(struct partition *partition)
{
	size_t count = partition->cdt.triangles.count;
	ARRAY_RESERVE(&partition->face_of, count);
	partition->face_of.count = count;
	for (size_t t = 0; t < count; t++)
		partition->face_of.items[t] = CDT_NONE;
	for (uint32_t t = 0; t < count; t++) {
		if (partition->face_of.items[t] != CDT_NONE)
			continue;
		ARRAY_PUSH(&partition->faces, (struct partition_face){ 0 });
		flood(partition, t, (uint32_t)partition->faces.count - 1);
	}
}

/* Walks towards the place; a constrained triangulation may let the walk circle, so the side tried first turns. */
static uint32_t walk_to(const struct partition *partition, uint32_t t, struct cdt_point at)
{
	const struct cdt *cdt = &partition->cdt;
	for (size_t step = 0; step < 64 + 4 * cdt->triangles.count; step++) {
		const struct cdt_triangle *triangle = &cdt->triangles.items[t];
		uint32_t next = CDT_NONE;
		for (size_t k = 0; k < 3 && next == CDT_NONE; k++) {
			size_t i = (k + step) % 3;
			if (cdt_orientation(cdt->points.items[triangle->corner[(i + 1) % 3]],
					cdt->points.items[triangle->corner[(i + 2) % 3]], at) < 0)
				next = triangle->neighbour[i];
		}
		if (next == CDT_NONE)
			return t;
		t = next;
	}
	return CDT_NONE;
}

uint32_t partition_triangle_at(const struct partition *partition, uint32_t start, struct dvec2 at)
{
	if (at.x < partition->min.x || at.x > partition->max.x || at.y < partition->min.y || at.y > partition->max.y)
		return CDT_NONE;
	return walk_to(partition, start, to_lattice(partition, at));
}

uint32_t partition_face_at(const struct partition *partition, struct dvec2 at)
{
	uint32_t t = partition_triangle_at(partition, 0, at);
	return t == CDT_NONE ? CDT_NONE : partition->face_of.items[t];
}
