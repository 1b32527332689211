/* Rebuilt when the car reaches the next edge: some hundred points, tens of microseconds. */
#include "render/route_path.h"

#include <errno.h>
#include <math.h>

#include "platform/base/rng.h"

#define DEFAULT_POINTS 4096u
#define STEP_MIN_M 0.05
#define CORNER_CUT_M 7.0 /* the ribbon leaves the corner's legs this far from it */
#define LANE_MITRE_MAX_M 14.0
#define RIBBON_HALF_WIDTH_M 1.6

static double flat_distance(struct dvec3 a, struct dvec3 b)
{
	return hypot(b.x - a.x, b.y - a.y);
}

static struct dvec2 flat_direction(struct dvec3 a, struct dvec3 b)
{
	double length = flat_distance(a, b);
	if (length < 1e-9)
		return (struct dvec2){ 0.0, 1.0 };
	return (struct dvec2){ (b.x - a.x) / length, (b.y - a.y) / length };
}

int route_path_init(struct route_path *path, struct arena *arena, uint32_t points)
{
	*path = (struct route_path){ .capacity = points ? points : DEFAULT_POINTS, .previous = PKG_NONE };
	path->points = ARENA_ARRAY(arena, struct route_path_point, path->capacity);
	path->raw = ARENA_ARRAY(arena, struct route_path_point, path->capacity);
	path->raw_offset = ARENA_ARRAY(arena, double, path->capacity);
	return path->points && path->raw && path->raw_offset ? 0 : -ENOMEM;
}

/* How far right of the centre line the car drives, and how much room its lane leaves. */
static double lane_offset(const struct pkg *pkg, const struct pkg_edge *edge, double *half_width)
{
	const uint16_t both = PKG_EDGE_FORWARD | PKG_EDGE_BACKWARD;
	double width = edge->width_mm * 1e-3;
	bool two_way = (edge->flags & both) == both;
	double own = two_way ? width / 2.0 : width;
	*half_width = fmin(RIBBON_HALF_WIDTH_M, fmax(0.45 * own, 0.8));
	double offset = two_way ? width / 4.0 : 0.0;
	return pkg->meta->right_hand_traffic ? offset : -offset;
}

static bool push_raw(struct route_path *path, const struct pkg_point *point, double half_width)
{
	struct route_path_point next = { .half_width = half_width };
	next.at.x = (double)(point->pos_mm[0] - path->origin_mm[0]) * 1e-3;
	next.at.y = (double)(point->pos_mm[1] - path->origin_mm[1]) * 1e-3;
	next.at.z = (double)(point->pos_mm[2] - path->origin_mm[2]) * 1e-3;
	if (path->raw_count) {
		const struct route_path_point *last = &path->raw[path->raw_count - 1];
		double step = flat_distance(last->at, next.at);
		if (step < STEP_MIN_M)
			return true;
		next.s = last->s + step;
	}
	/* Corners become up to ten points: leave them room. */
	if (path->raw_count >= path->capacity / 4)
		return false;
	path->raw[path->raw_count++] = next;
	return true;
}

static bool add_half(struct route_path *path, const struct pkg *pkg, uint32_t half)
{
	const struct pkg_graph *graph = &pkg->graph;
	if (half >= graph->half_count || path->half_count > NAV_ROUTE_AHEAD_MAX)
		return false;
	const struct pkg_edge *edge = &graph->edges[half / 2];
	const struct pkg_point *points = graph->points + edge->first_point;
	double half_width, offset = lane_offset(pkg, edge, &half_width);
	uint32_t before = path->raw_count ? path->raw_count - 1 : 0;
	double s_start = path->raw_count ? path->raw[before].s : 0.0;
	bool room = true;
	for (uint32_t i = 0; i < edge->point_count && room; i++)
		room = push_raw(path, &points[half & 1 ? edge->point_count - 1 - i : i], half_width);
	for (uint32_t i = before; i < path->raw_count; i++)
		path->raw_offset[i] = offset;
	path->halves[path->half_count++] = (struct route_path_half){ half, s_start, path->raw[path->raw_count - 1].s };
	return room;
}

static void cut_raw_at(struct route_path *path, double s)
{
	while (path->raw_count > 2 && path->raw[path->raw_count - 2].s >= s)
		path->raw_count--;
	if (path->raw_count < 2)
		return;
	struct route_path_point *a = &path->raw[path->raw_count - 2], *b = a + 1;
	double t = (s - a->s) / (b->s - a->s);
	if (t <= 0.01 || t >= 1.0)
		return;
	b->at = (struct dvec3){ a->at.x + (b->at.x - a->at.x) * t, a->at.y + (b->at.y - a->at.y) * t,
		a->at.z + (b->at.z - a->at.z) * t };
	b->s = s;
}

static void push_point(struct route_path *path, struct route_path_point point)
{
	if (path->count == path->capacity)
		return;
	if (path->count && flat_distance(path->points[path->count - 1].at, point.at) < STEP_MIN_M)
		return;
	path->points[path->count++] = point;
}

static struct route_path_point moved(struct route_path_point point, struct dvec2 direction, double right_m)
{
	point.at.x += direction.y * right_m;
	point.at.y -= direction.x * right_m;
	return point;
}

/* A turn back: half a circle in front of the point, at least a car's turning width. */
static void push_turn_back(
	struct route_path *path, const struct route_path_point *at, struct dvec2 ahead, double offset)
{
	double radius = fabs(offset), reach = fmax(radius, 2.0);
	double side = offset < 0.0 ? -1.0 : 1.0;
	for (int i = 0; i <= 12; i++) {
		double angle = BLVD_PI * i / 12.0;
		struct route_path_point point = moved(*at, ahead, side * radius * cos(angle));
		point.at.x += ahead.x * reach * sin(angle);
		point.at.y += ahead.y * reach * sin(angle);
		push_point(path, point);
	}
}

/* The raw line moved into the lane: at a bend, the meeting point of the moved legs. */
static void push_moved(struct route_path *path, uint32_t i)
{
	const struct route_path_point *at = &path->raw[i];
	bool first = i == 0, last = i + 1 == path->raw_count;
	struct dvec2 in = first ? flat_direction(at->at, at[1].at) : flat_direction(at[-1].at, at->at);
	struct dvec2 out = last ? in : flat_direction(at->at, at[1].at);
	double in_offset = path->raw_offset[first ? i : i - 1], out_offset = last ? in_offset : path->raw_offset[i];
	struct route_path_point a = moved(*at, in, in_offset), b = moved(*at, out, out_offset);
	double cross = dvec2_cross(in, out), dot = dvec2_dot(in, out);
	if (dot < -0.87) {
		push_turn_back(path, at, in, in_offset);
		return;
	}
	if (fabs(cross) < 0.17) {
		a.at.x = (a.at.x + b.at.x) / 2.0;
		a.at.y = (a.at.y + b.at.y) / 2.0;
		push_point(path, a);
		return;
	}
	double t = dvec2_cross((struct dvec2){ b.at.x - a.at.x, b.at.y - a.at.y }, out) / cross;
	double in_room = first ? 0.0 : at->s - at[-1].s, out_room = last ? 0.0 : at[1].s - at->s;
	double limit = fmin(LANE_MITRE_MAX_M, 0.7 * fmin(in_room, out_room) + 0.5);
	if (fabs(t) > limit) {
		/* legs too short to reach their meeting point: cut straight across */
		push_point(path, a);
		push_point(path, b);
		return;
	}
	a.at.x += in.x * t;
	a.at.y += in.y * t;
	push_point(path, a);
}

static struct route_path_point between(struct route_path_point a, struct route_path_point b, double t)
{
	return (struct route_path_point){
		.at = { a.at.x + (b.at.x - a.at.x) * t, a.at.y + (b.at.y - a.at.y) * t, a.at.z + (b.at.z - a.at.z) * t },
		.s = a.s + (b.s - a.s) * t,
		.half_width = a.half_width + (b.half_width - a.half_width) * t,
	};
}

/* A corner between two legs becomes a circular arc that touches both. */
static void push_corner(struct route_path *path, const struct route_path_point *at)
{
	struct dvec2 in = flat_direction(at[-1].at, at->at), out = flat_direction(at->at, at[1].at);
	double cross = dvec2_cross(in, out), turn = fabs(atan2(cross, dvec2_dot(in, out)));
	if (turn < 0.07) {
		push_point(path, *at);
		return;
	}
	double before = flat_distance(at[-1].at, at->at), after = flat_distance(at->at, at[1].at);
	double cut = fmin(CORNER_CUT_M, 0.48 * fmin(before, after)), radius = cut / tan(fmin(turn, 3.1) / 2.0);
	double inward = cross > 0.0 ? 1.0 : -1.0;
	struct route_path_point start = between(*at, at[-1], cut / before), end = between(*at, at[1], cut / after);
	int steps = (int)ceil(turn / 0.16);
	for (int i = 0; i <= steps; i++) {
		double t = (double)i / steps, ahead = radius * sin(turn * t), aside = inward * radius * (1.0 - cos(turn * t));
		struct route_path_point point = between(start, end, t);
		point.at.x = start.at.x + in.x * ahead - in.y * aside;
		point.at.y = start.at.y + in.y * ahead + in.x * aside;
		push_point(path, point);
	}
}

/* Moved points lie in points[]; raw[] is free and takes a copy. */
static void round_corners(struct route_path *path)
{
	uint32_t count = path->count;
	memcpy(path->raw, path->points, count * sizeof(*path->raw));
	path->count = 0;
	for (uint32_t i = 0; i < count; i++) {
		if (i == 0 || i + 1 == count)
			push_point(path, path->raw[i]);
		else
			push_corner(path, &path->raw[i]);
	}
}

static uint64_t shape_of(const struct nav_view *nav)
{
	uint64_t hash = hash_u64(nav->route_count + ((uint64_t)nav->route_complete << 32) + 1);
	for (uint32_t i = 0; i < nav->route_count && i < NAV_ROUTE_AHEAD_MAX; i++)
		hash = hash_u64(hash ^ nav->route[i]) + i;
	return hash ^ hash_u64(nav->route_complete ? (uint64_t)llrint(fmax(nav->route_end_along_m, 0.0) * 100.0) : 0);
}

static bool joins(const struct pkg_graph *graph, uint32_t from, uint32_t to)
{
	return from < graph->half_count && to < graph->half_count &&
		   graph->halves[from ^ 1].origin == graph->halves[to].origin;
}

static void build(struct route_path *path, const struct pkg *pkg, const struct nav_view *nav)
{
	uint32_t count = nav->route_count < NAV_ROUTE_AHEAD_MAX ? nav->route_count : NAV_ROUTE_AHEAD_MAX;
	path->raw_count = path->half_count = path->count = 0;
	for (int axis = 0; axis < 3; axis++)
		path->origin_mm[axis] = nav->pos_mm[axis];
	if (joins(&pkg->graph, path->previous, nav->route[0]))
		add_half(path, pkg, path->previous);
	bool room = true;
	for (uint32_t i = 0; i < count && room; i++)
		room = add_half(path, pkg, nav->route[i]);
	if (nav->route_complete && room && path->half_count)
		cut_raw_at(path, path->halves[path->half_count - 1].s_start + nav->route_end_along_m);
	path->whole = nav->route_complete && room;
	if (path->raw_count < 2)
		return;
	for (uint32_t i = 0; i < path->raw_count; i++)
		push_moved(path, i);
	round_corners(path);
	if (path->count < 2)
		path->count = 0;
}

/* The half-edge just left stays behind the car, so that the ribbon under it does not change shape. */
static void remember_previous(struct route_path *path, const struct nav_view *nav)
{
	for (uint32_t i = 0; i + 1 < path->half_count; i++)
		if (path->halves[i + 1].half == nav->route[0]) {
			path->previous = path->halves[i].half;
			return;
		}
	path->previous = PKG_NONE;
}

bool route_path_follow(struct route_path *path, const struct pkg *pkg, const struct nav_view *nav)
{
	bool any = nav->located && nav->routed && nav->route_count > 0 && pkg->graph.edge_count > 0;
	uint64_t shape = any ? shape_of(nav) : 0;
	if (shape == path->shape)
		return false;
	path->shape = shape;
	if (!any) {
		path->count = path->half_count = 0;
		return true;
	}
	if (path->half_count == 0 || path->halves[path->half_count > 1 && path->previous != PKG_NONE].half != nav->route[0])
		remember_previous(path, nav);
	build(path, pkg, nav);
	return true;
}

double route_path_car_s(const struct route_path *path, const struct nav_view *nav)
{
	struct route_path_half at;
	if (!nav->route_count || !route_path_find(path, nav->route[0], &at))
		return 0.0;
	return at.s_start + fmin(fmax(nav->along_m, 0.0), at.s_end - at.s_start);
}

bool route_path_find(const struct route_path *path, uint32_t half, struct route_path_half *out)
{
	uint32_t first = path->previous != PKG_NONE && path->half_count > 1 && path->halves[0].half == path->previous;
	for (uint32_t i = first; i < path->half_count; i++) {
		if (path->halves[i].half != half)
			continue;
		*out = path->halves[i];
		return true;
	}
	return false;
}

struct dvec3 route_path_at(const struct route_path *path, double s, struct dvec2 *direction)
{
	uint32_t low = 0, high = path->count - 1;
	while (high - low > 1) {
		uint32_t middle = (low + high) / 2;
		if (path->points[middle].s <= s)
			low = middle;
		else
			high = middle;
	}
	const struct route_path_point *a = &path->points[low], *b = &path->points[high];
	double span = b->s - a->s;
	double t = span > 1e-9 ? fmin(fmax((s - a->s) / span, 0.0), 1.0) : 0.0;
	if (direction)
		*direction = flat_direction(a->at, b->at);
	return between(*a, *b, t).at;
}

struct dvec2 route_path_side(const struct route_path *path, uint32_t i)
{
	const struct route_path_point *at = &path->points[i];
	struct dvec2 in = i ? flat_direction(at[-1].at, at->at) : flat_direction(at->at, at[1].at);
	struct dvec2 out = i + 1 < path->count ? flat_direction(at->at, at[1].at) : in;
	struct dvec2 sum = { in.y + out.y, -in.x - out.x };
	double square = dvec2_dot(sum, sum);
	if (square < 0.2)
		return (struct dvec2){ in.y, -in.x };
	double scale = fmin(2.0 / square, 1.6 / sqrt(square));
	return dvec2_scale(sum, scale);
}
