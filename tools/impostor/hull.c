/* The steps in a heap; a step whose surroundings changed is stale and skipped. O(n log n). */
#include "tools/impostor/hull.h"

#include <math.h>

#define NONE UINT32_MAX
#define POINTS_MIN 3 /* of a closed outline */

struct growing {
	struct hull *hull;
	double side; /* sign of the cross product of what lies outside */
	double price_px2, reach_px;
	uint32_t left; /* points */
	bool closed;
};

struct at {
	double x, y;
};

static struct at at(const struct growing *growing, uint32_t point)
{
	const struct hull_point *p = &growing->hull->points.items[point];
	return (struct at){ (double)p->x, (double)p->y };
}

/* Positive where c lies outwards of the line from a to b. */
static double outwards(const struct growing *growing, struct at a, struct at b, struct at c)
{
	return growing->side * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

static double distance(struct at a, struct at b)
{
	double x = b.x - a.x, y = b.y - a.y;
	return sqrt(x * x + y * y);
}

static bool before(const struct hull_step *a, const struct hull_step *b)
{
	if (a->cost != b->cost)
		return a->cost < b->cost;
	return a->point != b->point ? a->point < b->point : a->merges < b->merges;
}

static void push(struct hull *hull, struct hull_step step)
{
	ARRAY_PUSH(&hull->heap, step);
	struct hull_step *heap = hull->heap.items;
	size_t i = hull->heap.count - 1;
	for (; i && before(&step, &heap[(i - 1) / 2]); i = (i - 1) / 2)
		heap[i] = heap[(i - 1) / 2];
	heap[i] = step;
}

static struct hull_step pop(struct hull *hull)
{
	struct hull_step *heap = hull->heap.items, top = heap[0], last = heap[--hull->heap.count];
	size_t i = 0, count = hull->heap.count;
	for (size_t child; (child = 2 * i + 1) < count; i = child) {
		if (child + 1 < count && before(&heap[child + 1], &heap[child]))
			child++;
		if (!before(&heap[child], &last))
			break;
		heap[i] = heap[child];
	}
	if (count)
		heap[i] = last;
	return top;
}

/* Area counts, but what is thin counts less: half a pixel along a whole facade is nothing to keep a point for. */
static double cost_of(const struct growing *growing, double area, double height)
{
	return fmin(area, growing->price_px2 * height);
}

/* A point that lies inwards, or on the line between its neighbours, may go. */
static void offer_removal(struct growing *growing, uint32_t point)
{
	const struct hull_point *p = &growing->hull->points.items[point];
	if (p->last == NONE || p->next == NONE)
		return;
	struct at a = at(growing, p->last), b = at(growing, p->next);
	double twice = -outwards(growing, a, b, at(growing, point)), length = distance(a, b);
	if (twice < 0 || twice > length * growing->reach_px)
		return;
	double cost = cost_of(growing, 0.5 * twice, length > 0 ? twice / length : 0);
	if (cost <= growing->price_px2)
		push(growing->hull, (struct hull_step){ cost, point, p->changes, false });
}

/* Where the sides before a and after b meet, if that is outwards of a-b and near. */
static bool meeting_point(const struct growing *growing, uint32_t first, struct at *out, double *cost)
{
	const struct hull_point *points = growing->hull->points.items;
	uint32_t second = points[first].next;
	if (second == NONE || points[first].last == NONE || points[second].next == NONE)
		return false;
	struct at before_a = at(growing, points[first].last), a = at(growing, first);
	struct at b = at(growing, second), after_b = at(growing, points[second].next);
	struct at along_a = { a.x - before_a.x, a.y - before_a.y }, along_b = { b.x - after_b.x, b.y - after_b.y };
	double cross = along_a.x * along_b.y - along_a.y * along_b.x;
	if (cross == 0)
		return false;
	struct at between = { b.x - a.x, b.y - a.y };
	double t = (between.x * along_b.y - between.y * along_b.x) / cross;
	double u = (between.x * along_a.y - between.y * along_a.x) / cross;
	if (!(t > 0 && u > 0))
		return false;
	*out = (struct at){ a.x + t * along_a.x, a.y + t * along_a.y };
	double twice = outwards(growing, a, b, *out);
	*cost = cost_of(growing, 0.5 * twice, twice / fmax(distance(a, b), 1e-9));
	return twice > 0 && distance(a, *out) <= growing->reach_px && distance(b, *out) <= growing->reach_px;
}

static void offer_merge(struct growing *growing, uint32_t first)
{
	struct at meeting;
	double cost;
	if (first == NONE || !meeting_point(growing, first, &meeting, &cost) || cost > growing->price_px2)
		return;
	push(growing->hull, (struct hull_step){ cost, first, growing->hull->points.items[first].changes, true });
}

/* Everything that the place of a point has a say in. */
static void offer_around(struct growing *growing, uint32_t point)
{
	struct hull_point *points = growing->hull->points.items;
	uint32_t around[5], count = 0;
	around[count++] = point;
	for (uint32_t i = 0, at_point = point; i < 2 && (at_point = points[at_point].last) != NONE; i++)
		around[count++] = at_point;
	if (points[point].next != NONE)
		around[count++] = points[point].next;
	for (uint32_t i = 0; i < count; i++)
		points[around[i]].changes++;
	for (uint32_t i = 0; i < count; i++) {
		offer_removal(growing, around[i]);
		offer_merge(growing, around[i]);
	}
}

static void take_out(struct growing *growing, uint32_t point)
{
	struct hull_point *points = growing->hull->points.items;
	points[points[point].last].next = points[point].next;
	points[points[point].next].last = points[point].last;
	points[point].gone = true;
	growing->left--;
}

static void make_step(struct growing *growing, const struct hull_step *step)
{
	struct hull_point *points = growing->hull->points.items;
	uint32_t around = points[step->point].last;
	if (step->merges) {
		struct at meeting;
		double cost;
		if (!meeting_point(growing, step->point, &meeting, &cost))
			return;
		around = step->point;
		points[around].x = (float)meeting.x;
		points[around].y = (float)meeting.y;
		take_out(growing, points[around].next);
	} else {
		take_out(growing, step->point);
	}
	offer_around(growing, around);
	if (points[around].next != NONE)
		offer_around(growing, points[around].next);
}

static bool goes_straight_on(struct contour_point a, struct contour_point b, struct contour_point c)
{
	return (b.x - a.x) * (c.y - a.y) == (b.y - a.y) * (c.x - a.x);
}

static void load(struct growing *growing, const struct contour_point *points, uint32_t count)
{
	struct hull *hull = growing->hull;
	hull->points.count = hull->heap.count = hull->kept.count = 0;
	uint32_t last = growing->closed ? count - 1 : count; /* a closed one comes back to its first point */
	for (uint32_t i = 0; i < last; i++) {
		uint32_t known = (uint32_t)hull->points.count;
		if (i && i + 1 < count && goes_straight_on(points[i - 1], points[i], points[i + 1]))
			continue;
		ARRAY_PUSH(&hull->points,
			(struct hull_point){ points[i].x, points[i].y, known ? known - 1 : NONE, known + 1, 0, false });
	}
	uint32_t known = (uint32_t)hull->points.count;
	hull->points.items[known - 1].next = growing->closed ? 0 : NONE;
	if (growing->closed)
		hull->points.items[0].last = known - 1;
	growing->left = known;
}

static void write_out(struct hull *hull)
{
	uint32_t first = 0;
	while (hull->points.items[first].gone)
		first++;
	struct contour_point origin = { hull->points.items[first].x, hull->points.items[first].y }, last = origin;
	double twice = 0;
	for (uint32_t point = first; point != NONE;) {
		const struct hull_point *p = &hull->points.items[point];
		struct contour_point here = { p->x, p->y };
		twice += (double)(last.x - origin.x) * (double)(here.y - origin.y) -
				 (double)(last.y - origin.y) * (double)(here.x - origin.x);
		ARRAY_PUSH(&hull->kept, here);
		last = here;
		point = p->next == first ? NONE : p->next;
	}
	hull->area = 0.5 * fabs(twice);
}

void hull_grow(struct hull *hull, const struct contour_point *points, uint32_t count, bool closed, bool outside_left,
	double price_px2, double reach_px)
{
	struct growing growing = { hull, outside_left ? -1 : 1, price_px2, reach_px, 0, closed };
	load(&growing, points, count);
	for (uint32_t i = 0; i < hull->points.count; i++) {
		offer_removal(&growing, i);
		offer_merge(&growing, i);
	}
	while (hull->heap.count && (!closed || growing.left > POINTS_MIN)) {
		struct hull_step step = pop(hull);
		const struct hull_point *point = &hull->points.items[step.point];
		if (!point->gone && point->changes == step.changes)
			make_step(&growing, &step);
	}
	write_out(hull);
}

void hull_finish(struct hull *hull)
{
	ARRAY_FINISH(&hull->points);
	ARRAY_FINISH(&hull->heap);
	ARRAY_FINISH(&hull->kept);
}
