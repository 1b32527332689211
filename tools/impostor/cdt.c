/* Expected cost: O(n sqrt n) by walking from the last triangle; nearly linear when neighbours are added in turn, as
 * contours are. */
#include "tools/impostor/cdt.h"

#include <assert.h>
#include <string.h>

typedef __int128 wide;

static int sign_of(wide value)
{
	return (value > 0) - (value < 0);
}

int cdt_orientation(struct cdt_point a, struct cdt_point b, struct cdt_point c)
{
	int64_t cross = ((int64_t)b.x - a.x) * ((int64_t)c.y - a.y) - ((int64_t)b.y - a.y) * ((int64_t)c.x - a.x);
	return (cross > 0) - (cross < 0);
}

int cdt_in_circle(struct cdt_point a, struct cdt_point b, struct cdt_point c, struct cdt_point d)
{
	int64_t ax = (int64_t)a.x - d.x, ay = (int64_t)a.y - d.y;
	int64_t bx = (int64_t)b.x - d.x, by = (int64_t)b.y - d.y;
	int64_t cx = (int64_t)c.x - d.x, cy = (int64_t)c.y - d.y;
	wide sum = (wide)(ax * ax + ay * ay) * (bx * cy - by * cx) + (wide)(bx * bx + by * by) * (cx * ay - cy * ax) +
			   (wide)(cx * cx + cy * cy) * (ax * by - ay * bx);
	return sign_of(sum);
}

static struct cdt_point at(const struct cdt *cdt, uint32_t point)
{
	return cdt->points.items[point];
}

static struct cdt_triangle *tri(struct cdt *cdt, uint32_t triangle)
{
	return &cdt->triangles.items[triangle];
}

static unsigned next3(unsigned side)
{
	return side == 2 ? 0 : side + 1;
}

static unsigned prev3(unsigned side)
{
	return side == 0 ? 2 : side - 1;
}

static unsigned side_towards(const struct cdt_triangle *triangle, uint32_t neighbour)
{
	for (unsigned side = 0; side < 2; side++)
		if (triangle->neighbour[side] == neighbour)
			return side;
	assert(triangle->neighbour[2] == neighbour);
	return 2;
}

static unsigned corner_of(const struct cdt_triangle *triangle, uint32_t point)
{
	for (unsigned corner = 0; corner < 2; corner++)
		if (triangle->corner[corner] == point)
			return corner;
	assert(triangle->corner[2] == point);
	return 2;
}

/* Two triangles may share two sides only at the border of the rectangle, which has no neighbours: so a neighbour's
 * index names one side. */
static void relink(struct cdt *cdt, uint32_t triangle, uint32_t old, uint32_t fresh)
{
	if (triangle != CDT_NONE) {
		struct cdt_triangle *t = tri(cdt, triangle);
		t->neighbour[side_towards(t, old)] = fresh;
	}
}

void cdt_init(struct cdt *cdt, struct cdt_point min, struct cdt_point max)
{
	assert(min.x < max.x && min.y < max.y);
	*cdt = (struct cdt){ 0 };
	struct cdt_point corners[4] = { min, { max.x, min.y }, max, { min.x, max.y } };
	for (uint32_t i = 0; i < 4; i++) {
		ARRAY_PUSH(&cdt->points, corners[i]);
		ARRAY_PUSH(&cdt->triangle_of, i == 3 ? 1 : 0);
	}
	ARRAY_PUSH(&cdt->triangles, (struct cdt_triangle){ .corner = { 0, 1, 2 }, .neighbour = { CDT_NONE, 1, CDT_NONE } });
	ARRAY_PUSH(&cdt->triangles, (struct cdt_triangle){ .corner = { 0, 2, 3 }, .neighbour = { CDT_NONE, CDT_NONE, 0 } });
}

void cdt_finish(struct cdt *cdt)
{
	ARRAY_FINISH(&cdt->points);
	ARRAY_FINISH(&cdt->triangles);
	ARRAY_FINISH(&cdt->stack);
	ARRAY_FINISH(&cdt->crossed);
	ARRAY_FINISH(&cdt->triangle_of);
}

static void note_corners(struct cdt *cdt, uint32_t triangle)
{
	for (unsigned i = 0; i < 3; i++)
		cdt->triangle_of.items[tri(cdt, triangle)->corner[i]] = triangle;
}

/*
 * Turns the diagonal of the quadrilateral on both sides of `side`. With a = corner[side], the shared side b-c and d
 * beyond it, (a, b, c) and (d, c, b) become (a, b, d) and (a, d, c). Triangle keeps a-b, the other keeps a-c.
 */
static void flip(struct cdt *cdt, uint32_t triangle, unsigned side)
{
	uint32_t other = tri(cdt, triangle)->neighbour[side];
	struct cdt_triangle *t = tri(cdt, triangle), *o = tri(cdt, other);
	unsigned opposite = side_towards(o, triangle);
	struct cdt_triangle was = *t, far = *o;
	unsigned b_side = next3(side), c_side = prev3(side); /* side b_side lies opposite b: it is c-a */
	unsigned c_far = next3(opposite), b_far = prev3(opposite);
	uint32_t a = was.corner[side], b = was.corner[b_side], c = was.corner[c_side], d = far.corner[opposite];
	assert(far.corner[c_far] == c && far.corner[b_far] == b);
	*t = (struct cdt_triangle){ .corner = { a, b, d },
		.neighbour = { far.neighbour[c_far], other, was.neighbour[c_side] },
		.fixed = { far.fixed[c_far], false, was.fixed[c_side] } };
	*o = (struct cdt_triangle){ .corner = { a, d, c },
		.neighbour = { far.neighbour[b_far], was.neighbour[b_side], triangle },
		.fixed = { far.fixed[b_far], was.fixed[b_side], false } };
	relink(cdt, far.neighbour[c_far], other, triangle);
	relink(cdt, was.neighbour[b_side], triangle, other);
	note_corners(cdt, triangle);
	note_corners(cdt, other);
}

static void push_side(struct cdt *cdt, uint32_t triangle, unsigned side)
{
	ARRAY_PUSH(&cdt->stack, triangle * 3 + side);
}

/* Flips until every side on the stack is locally Delaunay. A stale entry (its triangle was flipped since) is checked
 * all the same. */
static void legalise(struct cdt *cdt)
{
	while (cdt->stack.count) {
		uint32_t entry = cdt->stack.items[--cdt->stack.count];
		uint32_t triangle = entry / 3;
		unsigned side = entry % 3;
		const struct cdt_triangle *t = tri(cdt, triangle);
		uint32_t other = t->neighbour[side];
		if (other == CDT_NONE || t->fixed[side])
			continue;
		const struct cdt_triangle *o = tri(cdt, other);
		uint32_t d = o->corner[side_towards(o, triangle)];
		if (cdt_in_circle(at(cdt, t->corner[0]), at(cdt, t->corner[1]), at(cdt, t->corner[2]), at(cdt, d)) <= 0)
			continue;
		flip(cdt, triangle, side);
		push_side(cdt, triangle, 0);
		push_side(cdt, triangle, 2);
		push_side(cdt, other, 0);
		push_side(cdt, other, 1);
	}
}

/* Walks to the triangle that holds the point, turning at the first side that has it on its outside. In a Delaunay
 * triangulation this ends; across fixed sides it could go in circles, so the first side tried changes with every step.
 */
static uint32_t locate(const struct cdt *cdt, struct cdt_point point)
{
	uint32_t here = cdt->last;
	for (unsigned step = 0;; step++) {
		const struct cdt_triangle *t = &cdt->triangles.items[here];
		unsigned turned = 3;
		for (unsigned k = 0; k < 3 && turned == 3; k++) {
			unsigned side = (k + step) % 3;
			if (cdt_orientation(at(cdt, t->corner[next3(side)]), at(cdt, t->corner[prev3(side)]), point) < 0)
				turned = side;
		}
		if (turned == 3)
			return here;
		here = t->neighbour[turned];
		assert(here != CDT_NONE);
	}
}

static uint32_t new_triangle(struct cdt *cdt)
{
	ARRAY_PUSH(&cdt->triangles, (struct cdt_triangle){ 0 });
	return (uint32_t)cdt->triangles.count - 1;
}

static void split_triangle(struct cdt *cdt, uint32_t triangle, uint32_t point)
{
	uint32_t second = new_triangle(cdt), third = new_triangle(cdt);
	struct cdt_triangle was = *tri(cdt, triangle);
	uint32_t parts[3] = { triangle, second, third };
	for (unsigned i = 0; i < 3; i++) {
		/* part i keeps side i */
		*tri(cdt, parts[i]) = (struct cdt_triangle){ .corner = { point, was.corner[next3(i)], was.corner[prev3(i)] },
			.neighbour = { was.neighbour[i], parts[next3(i)], parts[prev3(i)] },
			.fixed = { was.fixed[i], false, false } };
		relink(cdt, was.neighbour[i], triangle, parts[i]);
		note_corners(cdt, parts[i]);
		push_side(cdt, parts[i], 0);
	}
}

/* Splits a triangle in two by a point on its side: (a, b, c) with the point on b-c becomes (a, b, p) and (a, p, c).
 * Returns the second. */
static uint32_t split_half(struct cdt *cdt, uint32_t triangle, unsigned side, uint32_t point)
{
	uint32_t second = new_triangle(cdt);
	struct cdt_triangle was = *tri(cdt, triangle);
	uint32_t a = was.corner[side], b = was.corner[next3(side)], c = was.corner[prev3(side)];
	*tri(cdt, triangle) = (struct cdt_triangle){ .corner = { a, b, point },
		.neighbour = { CDT_NONE, second, was.neighbour[prev3(side)] },
		.fixed = { was.fixed[side], false, was.fixed[prev3(side)] } };
	*tri(cdt, second) = (struct cdt_triangle){ .corner = { a, point, c },
		.neighbour = { CDT_NONE, was.neighbour[next3(side)], triangle },
		.fixed = { was.fixed[side], was.fixed[next3(side)], false } };
	relink(cdt, was.neighbour[next3(side)], triangle, second);
	note_corners(cdt, triangle);
	note_corners(cdt, second);
	push_side(cdt, triangle, 2);
	push_side(cdt, second, 1);
	return second;
}

static void split_side(struct cdt *cdt, uint32_t triangle, unsigned side, uint32_t point)
{
	uint32_t other = tri(cdt, triangle)->neighbour[side];
	unsigned opposite = other == CDT_NONE ? 0 : side_towards(tri(cdt, other), triangle);
	uint32_t upper = split_half(cdt, triangle, side, point);
	if (other == CDT_NONE)
		return;
	/* Seen from the other side the shared side runs c-b: its first half is p-c's, its second b-p's. */
	uint32_t lower = split_half(cdt, other, opposite, point);
	tri(cdt, triangle)->neighbour[0] = lower;
	tri(cdt, lower)->neighbour[0] = triangle;
	tri(cdt, upper)->neighbour[0] = other;
	tri(cdt, other)->neighbour[0] = upper;
}

uint32_t cdt_add_point(struct cdt *cdt, struct cdt_point point)
{
	uint32_t triangle = locate(cdt, point);
	const struct cdt_triangle *t = tri(cdt, triangle);
	unsigned on_side = 3;
	for (unsigned i = 0; i < 3; i++) {
		struct cdt_point corner = at(cdt, t->corner[i]);
		if (corner.x == point.x && corner.y == point.y)
			return t->corner[i];
		if (cdt_orientation(at(cdt, t->corner[next3(i)]), at(cdt, t->corner[prev3(i)]), point) == 0)
			on_side = i;
	}
	ARRAY_PUSH(&cdt->points, point);
	ARRAY_PUSH(&cdt->triangle_of, triangle);
	uint32_t index = (uint32_t)cdt->points.count - 1;
	if (on_side < 3)
		split_side(cdt, triangle, on_side, index);
	else
		split_triangle(cdt, triangle, index);
	legalise(cdt);
	cdt->last = cdt->triangle_of.items[index];
	return index;
}

/* ---- segments ---- */

enum step { STEP_SIDE, STEP_CORNER };

/* How the segment leaves point `from`: along a side to a corner on it (STEP_CORNER, *point), or through the side
 * opposite `from` of a triangle (STEP_SIDE, *triangle). */
static enum step leave_point(
	const struct cdt *cdt, uint32_t from, struct cdt_point target, uint32_t *triangle, uint32_t *point)
{
	uint32_t start = cdt->triangle_of.items[from], here = start;
	bool clockwise = false;
	for (;;) {
		const struct cdt_triangle *t = &cdt->triangles.items[here];
		unsigned corner = corner_of(t, from);
		uint32_t right = t->corner[next3(corner)], left = t->corner[prev3(corner)];
		int of_right = cdt_orientation(at(cdt, from), at(cdt, right), target);
		int of_left = cdt_orientation(at(cdt, from), at(cdt, left), target);
		struct cdt_point f = at(cdt, from);
		for (int k = 0; k < 2; k++) {
			struct cdt_point end = at(cdt, k ? left : right);
			int64_t ahead =
				((int64_t)end.x - f.x) * ((int64_t)target.x - f.x) + ((int64_t)end.y - f.y) * ((int64_t)target.y - f.y);
			if ((k ? of_left : of_right) == 0 && ahead > 0) {
				*point = k ? left : right;
				*triangle = here;
				return STEP_CORNER;
			}
		}
		if (of_right > 0 && of_left < 0) {
			*triangle = here;
			return STEP_SIDE;
		}
		/* Round the point, counter-clockwise; from the border of the rectangle on clockwise. */
		uint32_t on = t->neighbour[clockwise ? prev3(corner) : next3(corner)];
		if (on == CDT_NONE) {
			assert(!clockwise);
			clockwise = true;
			on = cdt->triangles.items[start].neighbour[prev3(corner_of(&cdt->triangles.items[start], from))];
		}
		here = on;
	}
}

/* The triangle that has a-b as a side with its third corner to the left, and that side; CDT_NONE when there is no such
 * side. */
static uint32_t find_side(const struct cdt *cdt, uint32_t a, uint32_t b, unsigned *side)
{
	uint32_t start = cdt->triangle_of.items[a];
	for (int direction = 0; direction < 2; direction++) {
		uint32_t here = start;
		do {
			const struct cdt_triangle *t = &cdt->triangles.items[here];
			unsigned corner = corner_of(t, a);
			if (t->corner[next3(corner)] == b) {
				*side = prev3(corner);
				return here;
			}
			here = t->neighbour[direction ? prev3(corner) : next3(corner)];
		} while (here != CDT_NONE && here != start);
		if (here == start)
			break;
	}
	return CDT_NONE;
}

static void set_fixed(struct cdt *cdt, uint32_t a, uint32_t b, bool fixed)
{
	for (int turn = 0; turn < 2; turn++) {
		unsigned side;
		uint32_t triangle = find_side(cdt, turn ? b : a, turn ? a : b, &side);
		if (triangle != CDT_NONE)
			tri(cdt, triangle)->fixed[side] = fixed;
	}
}

/* Lattice point nearest to where a-b and c-d cross. */
static struct cdt_point crossing_of(struct cdt_point a, struct cdt_point b, struct cdt_point c, struct cdt_point d)
{
	int64_t abx = (int64_t)b.x - a.x, aby = (int64_t)b.y - a.y, cdx = (int64_t)d.x - c.x, cdy = (int64_t)d.y - c.y;
	int64_t bottom = abx * cdy - aby * cdx;
	int64_t top = ((int64_t)c.x - a.x) * cdy - ((int64_t)c.y - a.y) * cdx;
	if (bottom < 0) {
		bottom = -bottom;
		top = -top;
	}
	assert(bottom > 0);                                                      /* they cross, so they are not parallel */
	wide x = (wide)abx * top * 2 + bottom, y = (wide)aby * top * 2 + bottom; /* round half up: floor((2 n + d) / 2 d) */
	wide divisor = (wide)bottom * 2;
	wide qx = x / divisor - (x % divisor < 0), qy = y / divisor - (y % divisor < 0);
	return (struct cdt_point){ a.x + (int32_t)qx, a.y + (int32_t)qy };
}

/* Collects the sides that from-to crosses, as pairs of points, up to the next point on the segment, which is returned.
 * A fixed side in the way stops the walk: its ends come back in `blocked`. */
static uint32_t walk_segment(struct cdt *cdt, uint32_t from, uint32_t to, uint32_t triangle, uint32_t blocked[2])
{
	cdt->crossed.count = 0;
	unsigned side = corner_of(tri(cdt, triangle), from);
	for (;;) {
		const struct cdt_triangle *t = tri(cdt, triangle);
		uint32_t right = t->corner[next3(side)], left = t->corner[prev3(side)];
		if (t->fixed[side]) {
			blocked[0] = right;
			blocked[1] = left;
			return CDT_NONE;
		}
		ARRAY_PUSH(&cdt->crossed, right);
		ARRAY_PUSH(&cdt->crossed, left);
		uint32_t other = t->neighbour[side];
		const struct cdt_triangle *o = tri(cdt, other);
		unsigned opposite = side_towards(o, triangle);
		uint32_t apex = o->corner[opposite];
		int turn = cdt_orientation(at(cdt, from), at(cdt, to), at(cdt, apex));
		if (apex == to || turn == 0)
			return apex;
		/* The apex lies left of the segment: it leaves through the side between `right` and the apex, which is opposite
		 * `left`. */
		side = corner_of(o, turn > 0 ? left : right);
		triangle = other;
	}
}

/* Sloan's step: flips crossed sides whose quadrilateral is convex until none crosses from-to; then makes the new sides
 * Delaunay. */
static void flip_crossed(struct cdt *cdt, uint32_t from, uint32_t to)
{
	ARRAY(uint32_t) fresh = { 0 };
	size_t head = 0;
	while (head < cdt->crossed.count) {
		uint32_t p = cdt->crossed.items[head], q = cdt->crossed.items[head + 1];
		head += 2;
		unsigned side;
		uint32_t triangle = find_side(cdt, p, q, &side);
		assert(triangle != CDT_NONE);
		const struct cdt_triangle *t = tri(cdt, triangle);
		const struct cdt_triangle *o = tri(cdt, t->neighbour[side]);
		uint32_t apex = t->corner[side], far = o->corner[side_towards(o, triangle)];
		bool convex = cdt_orientation(at(cdt, apex), at(cdt, far), at(cdt, p)) *
						  cdt_orientation(at(cdt, apex), at(cdt, far), at(cdt, q)) <
					  0;
		if (!convex) {
			ARRAY_PUSH(&cdt->crossed, p);
			ARRAY_PUSH(&cdt->crossed, q);
			continue;
		}
		flip(cdt, triangle, side);
		int a = cdt_orientation(at(cdt, from), at(cdt, to), at(cdt, apex)),
			b = cdt_orientation(at(cdt, from), at(cdt, to), at(cdt, far));
		bool crosses = a * b < 0 && apex != from && apex != to && far != from && far != to;
		if (crosses) {
			ARRAY_PUSH(&cdt->crossed, apex);
			ARRAY_PUSH(&cdt->crossed, far);
		} else {
			ARRAY_PUSH(&fresh, apex);
			ARRAY_PUSH(&fresh, far);
		}
	}
	set_fixed(cdt, from, to, true);
	for (size_t i = 0; i < fresh.count; i += 2) {
		unsigned side;
		uint32_t triangle = find_side(cdt, fresh.items[i], fresh.items[i + 1], &side);
		if (triangle != CDT_NONE)
			push_side(cdt, triangle, side);
	}
	ARRAY_FINISH(&fresh);
	legalise(cdt);
}

#define CUTS_MAX 64 /* a segment that had to be cut more often within itself is given up */

static void add_segment(struct cdt *cdt, uint32_t from, uint32_t to, unsigned depth);

/* A fixed side is in the way: both get a common point. */
static void cut_segment(struct cdt *cdt, uint32_t from, uint32_t to, const uint32_t blocked[2], unsigned depth)
{
	struct cdt_point point = crossing_of(at(cdt, from), at(cdt, to), at(cdt, blocked[0]), at(cdt, blocked[1]));
	set_fixed(cdt, blocked[0], blocked[1], false);
	unsigned side;
	uint32_t freed = find_side(cdt, blocked[0], blocked[1], &side);
	push_side(cdt, freed, side);
	legalise(cdt);
	uint32_t cut = cdt_add_point(cdt, point);
	cdt->cuts++;
	add_segment(cdt, blocked[0], cut, depth + 1);
	add_segment(cdt, cut, blocked[1], depth + 1);
	add_segment(cdt, from, cut, depth + 1);
	add_segment(cdt, cut, to, depth + 1);
}

static void add_segment(struct cdt *cdt, uint32_t from, uint32_t to, unsigned depth)
{
	if (depth > CUTS_MAX) {
		cdt->dropped++;
		return;
	}
	while (from != to) {
		uint32_t triangle, reached, blocked[2] = { CDT_NONE, CDT_NONE };
		if (leave_point(cdt, from, at(cdt, to), &triangle, &reached) == STEP_CORNER) {
			set_fixed(cdt, from, reached, true);
		} else {
			reached = walk_segment(cdt, from, to, triangle, blocked);
			if (reached == CDT_NONE) {
				cut_segment(cdt, from, to, blocked, depth);
				return;
			}
			flip_crossed(cdt, from, reached);
		}
		from = reached;
	}
}

void cdt_add_segment(struct cdt *cdt, uint32_t from, uint32_t to)
{
	add_segment(cdt, from, to, 0);
}

static bool side_is_sound(const struct cdt *cdt, uint32_t triangle, unsigned side)
{
	const struct cdt_triangle *t = &cdt->triangles.items[triangle];
	uint32_t other = t->neighbour[side];
	if (other == CDT_NONE)
		return true;
	const struct cdt_triangle *o = &cdt->triangles.items[other];
	unsigned opposite = side_towards(o, triangle);
	if (o->corner[next3(opposite)] != t->corner[prev3(side)] || o->corner[prev3(opposite)] != t->corner[next3(side)] ||
		o->fixed[opposite] != t->fixed[side])
		return false;
	return t->fixed[side] || cdt_in_circle(at(cdt, t->corner[0]), at(cdt, t->corner[1]), at(cdt, t->corner[2]),
								 at(cdt, o->corner[opposite])) <= 0;
}

bool cdt_is_sound(const struct cdt *cdt)
{
	int64_t twice_area = 0;
	for (uint32_t i = 0; i < cdt->triangles.count; i++) {
		const struct cdt_triangle *t = &cdt->triangles.items[i];
		struct cdt_point a = at(cdt, t->corner[0]), b = at(cdt, t->corner[1]), c = at(cdt, t->corner[2]);
		if (cdt_orientation(a, b, c) <= 0)
			return false;
		twice_area += ((int64_t)b.x - a.x) * ((int64_t)c.y - a.y) - ((int64_t)b.y - a.y) * ((int64_t)c.x - a.x);
		for (unsigned side = 0; side < 3; side++)
			if (!side_is_sound(cdt, i, side))
				return false;
	}
	struct cdt_point min = at(cdt, 0), max = at(cdt, 2);
	return twice_area == 2 * ((int64_t)max.x - min.x) * ((int64_t)max.y - min.y);
}
