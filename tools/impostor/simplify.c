/* Douglas-Peucker with a stack of its own; the farthest of equals is the first, so results do not depend on order. */
#include "tools/impostor/simplify.h"

#include <math.h>

struct farthest {
	uint32_t index;
	double distance;
};

static double distance_to_segment(struct contour_point p, struct contour_point a, struct contour_point b)
{
	double dx = (double)b.x - (double)a.x, dy = (double)b.y - (double)a.y;
	double px = (double)p.x - (double)a.x, py = (double)p.y - (double)a.y;
	double length = dx * dx + dy * dy;
	double t = length > 0 ? fmin(fmax((px * dx + py * dy) / length, 0), 1) : 0;
	return hypot(px - t * dx, py - t * dy);
}

static struct farthest farthest_from(const struct contour_point *points, uint32_t from, uint32_t to)
{
	struct farthest farthest = { from, -1 };
	for (uint32_t i = from + 1; i < to; i++) {
		double distance = distance_to_segment(points[i], points[from], points[to]);
		if (distance > farthest.distance)
			farthest = (struct farthest){ i, distance };
	}
	return farthest;
}

static int ascending(const void *left, const void *right)
{
	uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
	return (a > b) - (a < b);
}

static void push_range(struct simplifier *simplifier, uint32_t from, uint32_t to)
{
	ARRAY_PUSH(&simplifier->ranges, from);
	ARRAY_PUSH(&simplifier->ranges, to);
}

/* A loop is cut where it is farthest from its first point, and that half again where it is widest. */
static void start_loop(struct simplifier *simplifier, const struct contour_point *points, uint32_t last)
{
	uint32_t far = farthest_from(points, 0, last).index;
	struct farthest before = farthest_from(points, 0, far), after = farthest_from(points, far, last);
	uint32_t third = before.distance >= after.distance ? before.index : after.index;
	uint32_t low = third < far ? third : far, high = third < far ? far : third;
	ARRAY_PUSH(&simplifier->kept, low);
	ARRAY_PUSH(&simplifier->kept, high);
	push_range(simplifier, 0, low);
	push_range(simplifier, low, high);
	push_range(simplifier, high, last);
}

void simplify(
	struct simplifier *simplifier, const struct contour_point *points, uint32_t count, bool closed, double bound_px)
{
	simplifier->kept.count = simplifier->ranges.count = 0;
	ARRAY_PUSH(&simplifier->kept, 0);
	ARRAY_PUSH(&simplifier->kept, count - 1);
	if (closed)
		start_loop(simplifier, points, count - 1);
	else
		push_range(simplifier, 0, count - 1);
	while (simplifier->ranges.count) {
		uint32_t to = simplifier->ranges.items[--simplifier->ranges.count];
		uint32_t from = simplifier->ranges.items[--simplifier->ranges.count];
		struct farthest farthest = farthest_from(points, from, to);
		if (farthest.distance <= bound_px)
			continue;
		ARRAY_PUSH(&simplifier->kept, farthest.index);
		push_range(simplifier, from, farthest.index);
		push_range(simplifier, farthest.index, to);
	}
	ARRAY_SORT(&simplifier->kept, ascending);
}

void simplifier_finish(struct simplifier *simplifier)
{
	ARRAY_FINISH(&simplifier->kept);
	ARRAY_FINISH(&simplifier->ranges);
}
