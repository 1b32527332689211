/*
 * Stretches of an edge: first runs of its polyline that are straight within limits, longest first come; crumbs are
 * given to a neighbour; then each run is cut into equal parts. All in doubles from integer positions, no randomness.
 * Cost: linear in the points but for long straight runs, which are looked at once more for every point they gain.
 */
#include "tools/impostor/stretches.h"

#include <math.h>

#define NEAR_M 300.0
#define LENGTH_MAX_M 60.0
#define NEAR_OF_LENGTH 2.5
#define MAGNIFICATION 2.0
#define EYE_MIN_M 1.2
#define EYE_MAX_M 4.0

#define STRAY_M 1.5   /* of the polyline from the axis */
#define TURN_DEG 20.0 /* between a segment and the axis */
#define BUMP_M 0.6    /* of the surface from the axis, up or down */
#define CRUMB_M 8.0   /* a run that is shorter joins a neighbour, if together they keep ... */
#define CRUMB_STRAY_M 2.5
#define CRUMB_TURN_DEG 40.0
#define NOISE_M 1.0    /* the heading of a segment that is shorter says nothing */
#define RUN_POINTS 400 /* at most, so that looking again stays cheap */
#define SIDE_M 0.5
#define OVERRUN_MIN_M 3.0
#define OVERRUN_MAX_M 5.0

struct limits {
	double stray_m, turn_rad, bump_m;
};

/* A polyline in metres, with the distance along it. */
struct line {
	ARRAY(struct dvec3) points;
	ARRAY(double) along;
};

/* How far a part of a line strays from its chord. */
struct stray {
	double aside_m, turn_rad, above_m, below_m;
};

static void read_line(const struct pkg_graph *net, const struct pkg_edge *edge, struct line *line)
{
	line->points.count = line->along.count = 0;
	double sum = 0.0;
	for (uint32_t i = 0; i < edge->point_count; i++) {
		const int32_t *mm = net->points[edge->first_point + i].pos_mm;
		struct dvec3 at = { mm[0] * 1e-3, mm[1] * 1e-3, mm[2] * 1e-3 };
		if (i) {
			const struct dvec3 *last = &line->points.items[i - 1];
			sum += hypot(at.x - last->x, at.y - last->y);
		}
		ARRAY_PUSH(&line->points, at);
		ARRAY_PUSH(&line->along, sum);
	}
}

/* The segment that holds a place: from this point to the next one. */
static size_t segment_at(const struct line *line, double along)
{
	size_t low = 0, high = line->points.count - 1;
	while (high - low > 1) {
		size_t middle = (low + high) / 2;
		if (line->along.items[middle] <= along)
			low = middle;
		else
			high = middle;
	}
	return low;
}

static struct dvec3 line_at(const struct line *line, double along)
{
	size_t low = segment_at(line, along), high = low + 1;
	const struct dvec3 *a = &line->points.items[low], *b = &line->points.items[high];
	double length = line->along.items[high] - line->along.items[low];
	double t = length > 0.0 ? fmin(fmax((along - line->along.items[low]) / length, 0.0), 1.0) : 0.0;
	return (struct dvec3){ a->x + t * (b->x - a->x), a->y + t * (b->y - a->y), a->z + t * (b->z - a->z) };
}

/* The chord from a to b against the points and segments of the line between them. */
static struct stray stray_between(const struct line *line, double from, double to)
{
	struct dvec3 a = line_at(line, from), b = line_at(line, to), last = a;
	double length = hypot(b.x - a.x, b.y - a.y), l = fmax(length, 1e-6);
	struct dvec2 axis = { (b.x - a.x) / l, (b.y - a.y) / l };
	struct stray out = { 0 };
	bool end = false;
	for (size_t i = segment_at(line, from); !end; i++) {
		end = i == line->points.count || line->along.items[i] >= to;
		if (!end && line->along.items[i] <= from)
			continue;
		struct dvec3 p = end ? b : line->points.items[i];
		struct dvec2 step = { p.x - last.x, p.y - last.y }, off = { p.x - a.x, p.y - a.y };
		double z = a.z + (b.z - a.z) * fmin(fmax(dvec2_dot(off, axis) / l, 0.0), 1.0);
		out.aside_m = fmax(out.aside_m, fabs(dvec2_cross(axis, off)));
		out.above_m = fmax(out.above_m, p.z - z);
		out.below_m = fmax(out.below_m, z - p.z);
		if (dvec2_length(step) >= NOISE_M || (length > 0.0 && length < NOISE_M))
			out.turn_rad = fmax(out.turn_rad, fabs(atan2(dvec2_cross(axis, step), dvec2_dot(axis, step))));
		last = p;
	}
	return out;
}

static bool keeps(const struct line *line, double from, double to, const struct limits *limits)
{
	struct stray stray = stray_between(line, from, to);
	return stray.aside_m <= limits->stray_m && stray.turn_rad <= limits->turn_rad &&
		   fmax(stray.above_m, stray.below_m) <= limits->bump_m;
}

typedef ARRAY(double) places;

/* Ends of the straight runs, the line's own included. */
static void find_runs(const struct line *line, places *cuts)
{
	static const struct limits limits = { STRAY_M, TURN_DEG * BLVD_PI / 180.0, BUMP_M };
	const double *along = line->along.items;
	size_t last = line->points.count ? line->points.count - 1 : 0;
	cuts->count = 0;
	ARRAY_PUSH(cuts, 0.0);
	for (size_t from = 0; along && from < last;) {
		size_t to = from + 1;
		while (to < last && to - from < RUN_POINTS && keeps(line, along[from], along[to + 1], &limits))
			to++;
		if (along[to] > cuts->items[cuts->count - 1])
			ARRAY_PUSH(cuts, along[to]);
		from = to;
	}
	if (cuts->count == 1)
		ARRAY_PUSH(cuts, 0.0);
}

/* Takes out cuts that leave crumbs, the shortest first. */
static void join_crumbs(const struct line *line, places *cuts)
{
	static const struct limits limits = { CRUMB_STRAY_M, CRUMB_TURN_DEG * BLVD_PI / 180.0, BUMP_M };
	for (;;) {
		size_t best = 0;
		double shortest = CRUMB_M;
		for (size_t i = 1; i + 1 < cuts->count; i++) {
			const double *at = &cuts->items[i];
			double crumb = fmin(at[0] - at[-1], at[1] - at[0]);
			if (crumb < shortest && (at[1] - at[-1] < CRUMB_M || keeps(line, at[-1], at[1], &limits))) {
				shortest = crumb;
				best = i;
			}
		}
		if (!best)
			return;
		for (size_t i = best; i + 1 < cuts->count; i++)
			cuts->items[i] = cuts->items[i + 1];
		cuts->count--;
	}
}

static int32_t to_mm(double m)
{
	return (int32_t)lrint(m * 1e3);
}

static uint16_t to_u16_mm(double m)
{
	return (uint16_t)fmin(fmax(rint(m * 1e3), 0.0), UINT16_MAX);
}

static struct pkg_stretch make_stretch(
	const struct line *line, const struct pkg_edge *edge, double from, double to, const struct stretch_options *options)
{
	struct dvec3 a = line_at(line, from), b = line_at(line, to);
	struct stray stray = stray_between(line, from, to);
	double half = edge->width_mm * 0.5e-3;
	struct pkg_stretch out = {
		.start_mm = { to_mm(a.x), to_mm(a.y), to_mm(a.z) },
		.end_mm = { to_mm(b.x), to_mm(b.y), to_mm(b.z) },
		.half_width_mm = to_u16_mm(half + stray.aside_m + SIDE_M),
		.overrun_mm = to_u16_mm(fmin(fmax(half, OVERRUN_MIN_M), OVERRUN_MAX_M)),
		.eye_min_mm = to_u16_mm(fmax(options->eye_min_m - stray.below_m, 0.1)),
		.eye_max_mm = to_u16_mm(options->eye_max_m + stray.above_m),
		.near_mm = (uint32_t)to_mm(fmax(options->near_m, NEAR_OF_LENGTH * (to - from))),
	};
	if (out.start_mm[0] == out.end_mm[0] && out.start_mm[1] == out.end_mm[1])
		out.end_mm[1]++;
	return out;
}

static void cut_edge(const struct pkg_graph *net, uint32_t edge_index, const struct stretch_options *options,
	struct line *line, places *cuts, stretch_array *out)
{
	const struct pkg_edge *edge = &net->edges[edge_index];
	if (edge->point_count < 2)
		return;
	read_line(net, edge, line);
	find_runs(line, cuts);
	join_crumbs(line, cuts);
	uint32_t at_mm = 0;
	for (size_t run = 0; run + 1 < cuts->count; run++) {
		double from = cuts->items[run], length = cuts->items[run + 1] - from;
		unsigned parts = (unsigned)fmax(ceil(length / options->length_max_m - 1e-9), 1.0);
		for (unsigned i = 0; i < parts; i++) {
			double a = from + length * i / parts, b = from + length * (i + 1) / parts;
			struct pkg_stretch stretch = make_stretch(line, edge, a, b, options);
			stretch.edge = edge_index;
			stretch.from_mm = at_mm;
			bool last = run + 2 == cuts->count && i + 1 == parts;
			stretch.to_mm = at_mm = last ? edge->length_mm : (uint32_t)lrint(b * 1e3);
			ARRAY_PUSH(out, stretch);
		}
	}
}

static struct stretch_options with_defaults(const struct stretch_options *options)
{
	struct stretch_options out = *options;
	if (!(out.near_m > 0.0))
		out.near_m = NEAR_M;
	if (!(out.length_max_m > 0.0))
		out.length_max_m = LENGTH_MAX_M;
	out.length_max_m = fmin(out.length_max_m, out.near_m * (1.0 - 1.0 / MAGNIFICATION));
	if (!(out.eye_max_m > 0.0)) {
		out.eye_min_m = EYE_MIN_M;
		out.eye_max_m = EYE_MAX_M;
	}
	return out;
}

void stretches_cut(
	const struct pkg_graph *net, const struct stretch_options *options, stretch_array *out, first_stretch_array *first)
{
	struct stretch_options settled = with_defaults(options);
	struct line line = { 0 };
	places cuts = { 0 };
	out->count = first->count = 0;
	for (uint32_t edge = 0; edge < net->edge_count; edge++) {
		ARRAY_PUSH(first, (uint32_t)out->count);
		if (net->edges[edge].flags & (PKG_EDGE_FORWARD | PKG_EDGE_BACKWARD))
			cut_edge(net, edge, &settled, &line, &cuts, out);
	}
	ARRAY_PUSH(first, (uint32_t)out->count);
	ARRAY_FINISH(&line.points);
	ARRAY_FINISH(&line.along);
	ARRAY_FINISH(&cuts);
}
