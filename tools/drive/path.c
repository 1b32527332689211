/* The line the car takes: each street's polyline moved to the lane, joined at junctions, corners rounded to arcs, then
 * smoothed so that heading and curvature are continuous. Linear in the route's length. */
#include <math.h>
#include <stdlib.h>

#include "tools/drive/drive.h"

#define SIMPLIFY_M 0.25
#define TURN_RAD 0.45   /* sharper than this the lanes' lines are made to meet */
#define BLEND_M 9.0     /* a change of lane offset takes this much on both sides of a node */
#define SMOOTH_M 1.4    /* sigma */
#define SMOOTH_REACH 18 /* samples to both sides */
#define LOOK_AHEAD_M 7.0
#define LOOK_STEP_M 0.1
#define LANE_TURN_M 150.0

typedef ARRAY(struct dvec2) line;

/* --- lanes --- */

static uint32_t lane_of(const struct drive *drive, uint32_t index)
{
	uint32_t lanes = graph_lanes(&drive->graph, drive->route.halves[index]);
	if (lanes < 2)
		return 0;
	double here = drive->guidance.origin_m[index] + graph_length_m(&drive->graph, drive->route.halves[index]);
	for (uint32_t i = 0; i < drive->guidance.step_count; i++) {
		const struct guidance_step *step = &drive->guidance.steps[i];
		if (step->index <= index)
			continue;
		double deg = bam_to_rad(step->angle_bam) * (180.0 / BLVD_PI);
		bool across = drive->graph.right_hand ? deg < -30.0 : deg > 30.0;
		return across && step->manoeuvre != NAV_MANOEUVRE_ROUNDABOUT && step->at_m - here < LANE_TURN_M ? lanes - 1 : 0;
	}
	return 0;
}

/* --- polylines --- */

static double to_segment(struct dvec2 p, struct dvec2 a, struct dvec2 b)
{
	struct dvec2 d = dvec2_sub(b, a);
	double l2 = dvec2_dot(d, d), t = l2 > 0.0 ? dvec2_dot(dvec2_sub(p, a), d) / l2 : 0.0;
	t = fmin(fmax(t, 0.0), 1.0);
	return dvec2_length(dvec2_sub(p, dvec2_add(a, dvec2_scale(d, t))));
}

/* Douglas and Peucker 1973; appends all kept points after `first`. */
static void simplify(const line *from, size_t first, size_t last, line *out)
{
	double most = 0.0;
	size_t at = first;
	for (size_t i = first + 1; i < last; i++) {
		double d = to_segment(from->items[i], from->items[first], from->items[last]);
		if (d > most) {
			most = d;
			at = i;
		}
	}
	if (most > SIMPLIFY_M) {
		simplify(from, first, at, out);
		simplify(from, at, last, out);
		return;
	}
	ARRAY_PUSH(out, from->items[last]);
}

/* Centre line of one half-edge of the route between two distances along it. */
static void centre_line(const struct drive *drive, uint32_t half, double from_m, double to_m, line *out)
{
	const struct graph *graph = &drive->graph;
	const struct pkg_edge *edge = graph_edge(graph, half);
	double length = graph_length_m(graph, half);
	line raw = { 0 };
	struct dvec3 a = graph_at(graph, half, from_m).at_m, b = graph_at(graph, half, to_m).at_m;
	ARRAY_PUSH(&raw, ((struct dvec2){ a.x, a.y }));
	for (uint32_t i = 1; i + 1 < edge->point_count; i++) {
		uint32_t at = edge->first_point + (half & 1 ? edge->point_count - 1 - i : i);
		double along = graph->along_mm[at] * 1e-3;
		along = half & 1 ? length - along : along;
		const int32_t *mm = graph->net->points[at].pos_mm;
		if (along > from_m + 0.3 && along < to_m - 0.3)
			ARRAY_PUSH(&raw, ((struct dvec2){ mm[0] * 1e-3, mm[1] * 1e-3 }));
	}
	ARRAY_PUSH(&raw, ((struct dvec2){ b.x, b.y }));
	out->count = 0;
	ARRAY_PUSH(out, raw.items[0]);
	simplify(&raw, 0, raw.count - 1, out);
	ARRAY_FINISH(&raw);
}

static struct dvec2 unit_of(struct dvec2 d)
{
	double l = dvec2_length(d);
	return l > 0.0 ? dvec2_scale(d, 1.0 / l) : (struct dvec2){ 0.0, 1.0 };
}

static struct dvec2 right_of(struct dvec2 d)
{
	return (struct dvec2){ d.y, -d.x };
}

/* Moves a polyline sideways, right positive; corners are mitred. */
static void offset_line(line *points, double offset)
{
	size_t n = points->count;
	struct dvec2 *old = points->items, *moved = malloc(n * sizeof(*moved));
	if (!moved)
		abort();
	for (size_t i = 0; i < n; i++) {
		struct dvec2 in = unit_of(dvec2_sub(old[i > 0 ? i : 1], old[i > 0 ? i - 1 : 0]));
		struct dvec2 out = unit_of(dvec2_sub(old[i + 1 < n ? i + 1 : n - 1], old[i + 1 < n ? i : n - 2]));
		struct dvec2 normal = unit_of(dvec2_add(right_of(in), right_of(out)));
		double stretch = fmax(dvec2_dot(normal, right_of(in)), 0.5);
		moved[i] = dvec2_add(old[i], dvec2_scale(normal, offset / stretch));
	}
	for (size_t i = 0; i < n; i++)
		old[i] = moved[i];
	free(moved);
}

static double line_length(const line *points)
{
	double sum = 0.0;
	for (size_t i = 1; i < points->count; i++)
		sum += dvec2_length(dvec2_sub(points->items[i], points->items[i - 1]));
	return sum;
}

/* Cuts `by_m` off the end. */
static void trim_end(line *points, double by_m)
{
	while (points->count > 1) {
		struct dvec2 *last = &points->items[points->count - 1];
		struct dvec2 d = dvec2_sub(*last, last[-1]);
		double l = dvec2_length(d);
		if (l > by_m) {
			*last = dvec2_sub(*last, dvec2_scale(d, l > 0.0 ? by_m / l : 0.0));
			return;
		}
		if (points->count == 2)
			return;
		by_m -= l;
		points->count--;
	}
}

static void reverse(line *points)
{
	for (size_t i = 0, j = points->count - 1; i < j; i++, j--) {
		struct dvec2 swap = points->items[i];
		points->items[i] = points->items[j];
		points->items[j] = swap;
	}
}

static void trim_start(line *points, double by_m)
{
	reverse(points);
	trim_end(points, by_m);
	reverse(points);
}

/* --- joints --- */

/* Where the lanes' lines meet; false when they are too parallel or meet in a place behind the car. */
static bool meeting(const line *a, const line *b, struct dvec2 *out)
{
	struct dvec2 a0 = a->items[a->count - 2], a1 = a->items[a->count - 1], b0 = b->items[0], b1 = b->items[1];
	struct dvec2 da = unit_of(dvec2_sub(a1, a0)), db = unit_of(dvec2_sub(b1, b0));
	double cross = dvec2_cross(da, db);
	if (fabs(cross) < 0.2)
		return false;
	struct dvec2 ab = dvec2_sub(b0, a0);
	double t = dvec2_cross(ab, db) / cross, u = dvec2_cross(ab, da) / cross;
	double room_b = dvec2_length(dvec2_sub(b1, b0));
	if (t < 0.5 || t > dvec2_length(dvec2_sub(a1, a0)) + 15.0 || u > room_b - 0.5 || u < -15.0)
		return false;
	*out = dvec2_add(a0, dvec2_scale(da, t));
	return true;
}

/* Turning round: a bulb of at least 4.5 m radius past the end of the street. */
static void turn_round(line *path, const line *next)
{
	struct dvec2 from = path->items[path->count - 1], to = next->items[0];
	struct dvec2 ahead = unit_of(dvec2_sub(from, path->items[path->count - 2]));
	struct dvec2 centre = dvec2_scale(dvec2_add(from, to), 0.5), side = right_of(ahead);
	double radius = 5.0;
	for (int i = 1; i < 8; i++) {
		double angle = BLVD_PI * i / 8.0;
		struct dvec2 at = dvec2_add(centre, dvec2_scale(side, radius * cos(angle)));
		ARRAY_PUSH(path, dvec2_add(at, dvec2_scale(ahead, radius * sin(angle))));
	}
}

static void append(line *path, const line *points, size_t first)
{
	for (size_t i = first; i < points->count; i++)
		ARRAY_PUSH(path, points->items[i]);
}

static void join(line *path, line *next, bool turns_round)
{
	if (!path->count) {
		append(path, next, 0);
		return;
	}
	if (turns_round) {
		turn_round(path, next);
		append(path, next, 0);
		return;
	}
	struct dvec2 in = unit_of(dvec2_sub(path->items[path->count - 1], path->items[path->count - 2]));
	struct dvec2 out = unit_of(dvec2_sub(next->items[1], next->items[0])), corner;
	double angle = fabs(atan2(dvec2_cross(in, out), dvec2_dot(in, out)));
	double gap = dvec2_length(dvec2_sub(next->items[0], path->items[path->count - 1]));
	if (angle > TURN_RAD && meeting(path, next, &corner)) {
		path->items[path->count - 1] = corner;
		append(path, next, 1);
		return;
	}
	if (gap < 0.2) {
		append(path, next, 1);
		return;
	}
	/* The wider the step, the longer it takes; but never more than a part of either street. */
	double blend = fmin(BLEND_M, 3.0 + 4.0 * gap);
	trim_end(path, blend);
	trim_start(next, fmin(blend, 0.4 * line_length(next)));
	append(path, next, 0);
}

/* --- rounding --- */

static void sample_to(line *out, struct dvec2 to)
{
	struct dvec2 from = out->items[out->count - 1], d = dvec2_sub(to, from);
	double l = dvec2_length(d);
	size_t n = (size_t)ceil(l / DRIVE_STEP_M);
	for (size_t i = 1; i <= n; i++)
		ARRAY_PUSH(out, dvec2_add(from, dvec2_scale(d, (double)i / (double)n)));
}

static double wanted_radius(double angle)
{
	double deg = angle * (180.0 / BLVD_PI);
	return deg > 65.0 ? 8.0 : deg > 35.0 ? 13.0 : deg > 15.0 ? 28.0 : 60.0;
}

/* Replaces a corner by an arc that touches both sides. */
static void round_corner(line *out, struct dvec2 a, struct dvec2 p, struct dvec2 b)
{
	struct dvec2 in = unit_of(dvec2_sub(p, a)), leave = unit_of(dvec2_sub(b, p));
	double angle = atan2(dvec2_cross(in, leave), dvec2_dot(in, leave)), size = fabs(angle);
	double room = 0.5 * fmin(dvec2_length(dvec2_sub(p, a)), dvec2_length(dvec2_sub(b, p)));
	if (size < 0.01 || size > 3.0 || room < 0.05) {
		sample_to(out, p);
		return;
	}
	double radius = fmin(wanted_radius(size), room / tan(0.5 * size)), tangent = radius * tan(0.5 * size);
	struct dvec2 start = dvec2_sub(p, dvec2_scale(in, tangent));
	sample_to(out, start);
	struct dvec2 side = angle > 0.0 ? dvec2_scale(right_of(in), -1.0) : right_of(in);
	struct dvec2 centre = dvec2_add(start, dvec2_scale(side, radius));
	int n = (int)ceil(radius * size / DRIVE_STEP_M);
	for (int i = 1; i <= n; i++) {
		double t = size * i / n;
		struct dvec2 at = dvec2_add(centre, dvec2_scale(side, -radius * cos(t)));
		ARRAY_PUSH(out, dvec2_add(at, dvec2_scale(in, radius * sin(t))));
	}
}

static void round_corners(const line *corners, line *out)
{
	ARRAY_PUSH(out, corners->items[0]);
	for (size_t i = 1; i + 1 < corners->count; i++)
		round_corner(out, corners->items[i - 1], corners->items[i], corners->items[i + 1]);
	sample_to(out, corners->items[corners->count - 1]);
}

/* Equal steps along the line. */
static void resample(const line *from, line *out)
{
	double want = 0.0, done = 0.0;
	for (size_t i = 1; i < from->count; i++) {
		struct dvec2 a = from->items[i - 1], d = dvec2_sub(from->items[i], a);
		double l = dvec2_length(d);
		for (; l > 0.0 && want <= done + l; want += DRIVE_STEP_M)
			ARRAY_PUSH(out, dvec2_add(a, dvec2_scale(d, (want - done) / l)));
		done += l;
	}
}

static struct dvec2 extended(const line *from, ptrdiff_t i)
{
	ptrdiff_t n = (ptrdiff_t)from->count;
	if (i < 0)
		return dvec2_sub(dvec2_scale(from->items[0], 2.0), from->items[-i < n ? -i : n - 1]);
	if (i >= n)
		return dvec2_sub(dvec2_scale(from->items[n - 1], 2.0), from->items[2 * n - 2 - i > 0 ? 2 * n - 2 - i : 0]);
	return from->items[i];
}

static void smooth(const line *from, line *out)
{
	double weight[SMOOTH_REACH + 1], total = 0.0;
	for (int k = 0; k <= SMOOTH_REACH; k++) {
		double x = k * DRIVE_STEP_M / SMOOTH_M;
		weight[k] = exp(-0.5 * x * x);
		total += k ? 2.0 * weight[k] : weight[k];
	}
	for (size_t i = 0; i < from->count; i++) {
		struct dvec2 sum = { 0.0, 0.0 };
		for (int k = -SMOOTH_REACH; k <= SMOOTH_REACH; k++)
			sum = dvec2_add(sum, dvec2_scale(extended(from, (ptrdiff_t)i + k), weight[abs(k)] / total));
		ARRAY_PUSH(out, sum);
	}
}

/* --- the points --- */

static void lay_out(const struct drive *drive, line *path)
{
	line piece = { 0 };
	for (uint32_t i = 0; i < drive->route.count; i++) {
		uint32_t half = drive->route.halves[i];
		double length = graph_length_m(&drive->graph, half);
		double from = i ? 0.0 : drive->route.start_along_m;
		double to = i + 1 < drive->route.count ? length : drive->route.end_along_m;
		if (to - from < 0.05 && drive->route.count > 1)
			continue;
		centre_line(drive, half, from, fmax(to, from + 0.1), &piece);
		offset_line(&piece, graph_lane_offset_m(&drive->graph, half, lane_of(drive, i)));
		join(path, &piece, i && half == graph_twin(drive->route.halves[i - 1]));
	}
	ARRAY_FINISH(&piece);
	if (path->count)
		return;
	/* A route without any length: the car stands where it starts. */
	struct dvec3 at = graph_at(&drive->graph, drive->route.halves[0], drive->route.start_along_m).at_m;
	ARRAY_PUSH(path, ((struct dvec2){ at.x, at.y }));
	ARRAY_PUSH(path, ((struct dvec2){ at.x, at.y + 0.1 }));
}

/* Walks along the route beside the line: for each point the nearest place of the centre lines, never backwards. */
static void tie_to_route(const struct drive *drive, struct drive_path *path)
{
	uint32_t index = 0;
	double along = drive->route.start_along_m, stuck_m = 0.0;
	for (size_t i = 0; i < path->points.count; i++) {
		struct drive_point *point = &path->points.items[i];
		double best = INFINITY, best_along = along, at = along;
		uint32_t best_index = index, k = index;
		/* On a sharp corner the nearest place can stay behind; the longer it does, the farther we look. */
		int steps = (int)((LOOK_AHEAD_M + 1.5 * stuck_m) / LOOK_STEP_M);
		for (int step = 0; step <= steps; step++, at += LOOK_STEP_M) {
			while (k + 1 < drive->route.count && at > graph_length_m(&drive->graph, drive->route.halves[k])) {
				at -= graph_length_m(&drive->graph, drive->route.halves[k]);
				k++;
			}
			struct dvec3 centre = graph_at(&drive->graph, drive->route.halves[k], at).at_m;
			double d = hypot(centre.x - point->at.x, centre.y - point->at.y);
			if (d < best - 1e-9) {
				best = d;
				best_index = k;
				best_along = at;
			}
		}
		bool moved = best_index != index || best_along > along + 0.01;
		stuck_m = moved ? 0.0 : stuck_m + DRIVE_STEP_M;
		index = best_index;
		along = best_along;
		point->index = index;
		point->along_m = fmin(along, graph_length_m(&drive->graph, drive->route.halves[index]));
		point->at.z = graph_at(&drive->graph, drive->route.halves[index], point->along_m).at_m.z;
	}
}

static void add_headings(struct drive_path *path)
{
	size_t n = path->points.count;
	struct drive_point *points = path->points.items;
	double last = 0.0;
	for (size_t i = 0; i < n; i++) {
		const struct drive_point *a = &points[i ? i - 1 : 0], *b = &points[i + 1 < n ? i + 1 : n - 1];
		double heading = atan2(b->at.x - a->at.x, b->at.y - a->at.y);
		last = i ? last + remainder(heading - last, 2.0 * BLVD_PI) : heading;
		points[i].heading_rad = last;
	}
	for (size_t i = 0; i < n; i++) {
		size_t a = i > 1 ? i - 2 : 0, b = i + 2 < n ? i + 2 : n - 1;
		double l = 0.0;
		for (size_t k = a; k < b; k++)
			l += hypot(points[k + 1].at.x - points[k].at.x, points[k + 1].at.y - points[k].at.y);
		points[i].curvature = l > 0.0 ? (points[b].heading_rad - points[a].heading_rad) / l : 0.0;
	}
}

void path_build(const struct drive *drive, struct drive_path *out)
{
	line laid = { 0 }, corners = { 0 }, rounded = { 0 }, even = { 0 }, smoothed = { 0 }, last = { 0 };
	lay_out(drive, &laid);
	/* Nodes on a straight street are no corners: without them there is more room for the arcs. */
	if (laid.count) {
		ARRAY_PUSH(&corners, laid.items[0]);
		simplify(&laid, 0, laid.count - 1, &corners);
		round_corners(&corners, &rounded);
	}
	resample(&rounded, &even);
	smooth(&even, &smoothed);
	resample(&smoothed, &last);
	for (size_t i = 0; i < last.count; i++)
		ARRAY_PUSH(&out->points, (struct drive_point){ .at = { last.items[i].x, last.items[i].y, 0.0 } });
	tie_to_route(drive, out);
	add_headings(out);
	ARRAY_FINISH(&laid);
	ARRAY_FINISH(&corners);
	ARRAY_FINISH(&rounded);
	ARRAY_FINISH(&even);
	ARRAY_FINISH(&smoothed);
	ARRAY_FINISH(&last);
}

void path_finish(struct drive_path *path)
{
	ARRAY_FINISH(&path->points);
}
