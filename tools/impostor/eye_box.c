#include "tools/impostor/eye_box.h"

#include <math.h>

#include "tools/impostor/extremes.h"

/* Axis and side of the box; an axis of no length points north. */
struct frame {
	struct dvec2 along, left;
	double length;
	double z0, z1; /* of the axis at its ends */
};

static struct frame frame_of(const struct view_cell *cell)
{
	struct dvec2 axis = { cell->end.x - cell->start.x, cell->end.y - cell->start.y };
	double length = dvec2_length(axis);
	struct frame out = { .along = { 0.0, 1.0 }, .length = length, .z0 = cell->start.z, .z1 = cell->end.z };
	if (length > 1e-6)
		out.along = dvec2_scale(axis, 1.0 / length);
	out.left = (struct dvec2){ -out.along.y, out.along.x };
	return out;
}

/* Beyond its ends, the axis may go on as it does or level: the highest and the lowest of both. */
static void surface_at(const struct frame *frame, double along, double *low, double *high)
{
	double slope = frame->length > 0.1 ? (frame->z1 - frame->z0) / frame->length : 0.0;
	double straight = frame->z0 + slope * along, level = along < 0.0 ? frame->z0 : frame->z1;
	if (along >= 0.0 && along <= frame->length)
		level = straight;
	*low = smaller(straight, level);
	*high = larger(straight, level);
}

static struct dvec2 place(const struct view_cell *cell, const struct frame *frame, double along, double left)
{
	return (struct dvec2){ cell->start.x + frame->along.x * along + frame->left.x * left,
		cell->start.y + frame->along.y * along + frame->left.y * left };
}

static void find_corners(struct eye_box *box, const struct view_cell *cell, const struct frame *frame)
{
	for (int i = 0; i < 8; i++) {
		double along = i & 1 ? frame->length + cell->overrun_m : -cell->overrun_m, low, high;
		struct dvec2 at = place(cell, frame, along, i & 2 ? cell->half_width_m : -cell->half_width_m);
		surface_at(frame, along, &low, &high);
		box->corners[i] = (struct dvec3){ at.x, at.y, i & 4 ? high + cell->eye_max_m : low + cell->eye_min_m };
	}
}

/* The rectangle in equal cells whose corners are within reach of their centres: as few as possible. */
static void find_grid(double length, double width, double reach, int *columns, int *rows)
{
	double best = INFINITY;
	int least = (int)larger(1.0, ceil(width / (2.0 * reach) * 1.0001));
	for (int r = least; r <= least * 2 + 2; r++) {
		double half = width / r / 2.0, left = reach * reach - half * half;
		if (left < 0.01)
			continue;
		double count = larger(1.0, ceil(length / (2.0 * sqrt(left))));
		if (count * r < best) {
			best = count * r;
			*rows = r;
			*columns = (int)count;
		}
	}
}

static void find_samples(struct eye_box *box, const struct view_cell *cell, const struct frame *frame)
{
	double length = frame->length + 2.0 * cell->overrun_m, width = 2.0 * cell->half_width_m;
	int columns = 1, rows = 1;
	find_grid(length, width, PKG_OCCLUDER_SHRINK_MM * 1e-3 - 0.001, &columns, &rows);
	/* The ends first, then the middles: most of what is seen is seen soon. */
	for (int step = 1 << 12, done = 0; step >= 1; done = step, step /= 2)
		for (int c = 0; c < columns; c += step) {
			if (done && c % done == 0)
				continue;
			double from = length * c / columns - cell->overrun_m, to = from + length / columns, low, high, other;
			surface_at(frame, from, &low, &high);
			surface_at(frame, to, &low, &other);
			high = larger(high, other);
			surface_at(frame, smaller(larger(0.0, from), to), &low, &other);
			high = larger(high, other);
			surface_at(frame, smaller(larger(frame->length, from), to), &low, &other);
			high = larger(high, other);
			for (int r = 0; r < rows; r++) {
				struct dvec2 at = place(cell, frame, (from + to) / 2.0, width * ((r + 0.5) / rows - 0.5));
				ARRAY_PUSH(&box->samples, (struct dvec3){ at.x, at.y, high + cell->eye_max_m });
			}
		}
}

void eye_box_init(struct eye_box *box, const struct view_cell *cell)
{
	*box = (struct eye_box){ .start = { cell->start.x, cell->start.y }, .end = { cell->end.x, cell->end.y } };
	struct frame frame = frame_of(cell);
	find_corners(box, cell, &frame);
	find_samples(box, cell, &frame);
}

void eye_box_finish(struct eye_box *box)
{
	ARRAY_FINISH(&box->samples);
}

bool eye_box_faces(const struct eye_box *box, const struct dvec3 triangle[3])
{
	struct dvec3 o = triangle[0];
	struct dvec3 a = { triangle[1].x - o.x, triangle[1].y - o.y, triangle[1].z - o.z };
	struct dvec3 b = { triangle[2].x - o.x, triangle[2].y - o.y, triangle[2].z - o.z };
	struct dvec3 n = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
	for (int i = 0; i < 8; i++) {
		const struct dvec3 *eye = &box->corners[i];
		if (n.x * (eye->x - o.x) + n.y * (eye->y - o.y) + n.z * (eye->z - o.z) > 0.0)
			return true;
	}
	return false;
}

static double point_distance(struct dvec2 at, struct dvec2 a, struct dvec2 b)
{
	struct dvec2 d = dvec2_sub(b, a), v = dvec2_sub(at, a);
	double length2 = dvec2_dot(d, d), t = length2 > 0.0 ? smaller(larger(dvec2_dot(v, d) / length2, 0.0), 1.0) : 0.0;
	struct dvec2 off = dvec2_sub(v, dvec2_scale(d, t));
	return sqrt(dvec2_dot(off, off));
}

static bool segments_cross(struct dvec2 a, struct dvec2 b, struct dvec2 p, struct dvec2 q)
{
	struct dvec2 ab = dvec2_sub(b, a), pq = dvec2_sub(q, p);
	return (dvec2_cross(ab, dvec2_sub(p, a)) > 0.0) != (dvec2_cross(ab, dvec2_sub(q, a)) > 0.0) &&
		   (dvec2_cross(pq, dvec2_sub(a, p)) > 0.0) != (dvec2_cross(pq, dvec2_sub(b, p)) > 0.0);
}

double eye_box_distance(const struct eye_box *box, const struct dvec2 *corners, int count)
{
	double best = INFINITY;
	int left = 0, right = 0;
	for (int i = 0; i < count; i++) {
		struct dvec2 p = corners[i], q = corners[i + 1 < count ? i + 1 : 0];
		double side = dvec2_cross(dvec2_sub(q, p), dvec2_sub(box->start, p));
		left += side > 0.0;
		right += side < 0.0;
		if (segments_cross(box->start, box->end, p, q))
			return 0.0;
		best = smaller(best, smaller(point_distance(p, box->start, box->end),
								 smaller(point_distance(box->start, p, q), point_distance(box->end, p, q))));
	}
	return (left == 0) != (right == 0) && left + right == count ? 0.0 : best;
}

double eye_box_reach(const struct eye_box *box, const struct dvec2 *corners, int count)
{
	double most = 0.0;
	for (int i = 0; i < count; i++)
		most = larger(most, point_distance(corners[i], box->start, box->end));
	return most;
}
