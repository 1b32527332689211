/*
 * A closed row of lots around a block. The inner line of the row is the block's outline moved in by the row's depth,
 * each corner along its bisector; lots are quadrilaterals between the two, and each corner is one lot of two fronts.
 * Blocks where the inner line folds are refused.
 */
#include <math.h>
#include <stdlib.h>

#include "tools/synth/synth.h"

#define CORNERS_MAX 40
#define LEAST_SIDE_M 6.0
#define LEAST_TURN 0.15 /* radians: less is no corner */

struct outline {
	struct dvec2 at[CORNERS_MAX], inner[CORNERS_MAX], along[CORNERS_MAX], inward[CORNERS_MAX];
	double length[CORNERS_MAX];
	size_t count;
};

struct dvec2 turned(struct dvec2 v, double angle)
{
	return (struct dvec2){ v.x * cos(angle) - v.y * sin(angle), v.x * sin(angle) + v.y * cos(angle) };
}

double longest_side(const struct ring *ring)
{
	double best = -1.0, angle = 0.0;
	for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++) {
		struct dvec2 d = dvec2_sub(ring->points[i], ring->points[j]);
		if (dvec2_length(d) > best) {
			best = dvec2_length(d);
			angle = atan2(d.y, d.x);
		}
	}
	return angle;
}

/* Takes out the point whose removal changes least, until all sides are long and all corners turn. */
static bool simplify(const struct ring *ring, struct outline *out)
{
	struct dvec2 points[256];
	size_t count = ring->count;
	if (count > 256)
		return false;
	for (size_t i = 0; i < count; i++)
		points[i] = ring->points[i];
	for (bool again = true; again && count > 3;) {
		again = false;
		for (size_t i = 0; i < count && count > 3; i++) {
			struct dvec2 a = points[(i + count - 1) % count], b = points[i], c = points[(i + 1) % count];
			struct dvec2 in = dvec2_sub(b, a), on = dvec2_sub(c, b);
			double turn = fabs(atan2(dvec2_cross(in, on), dvec2_dot(in, on)));
			double off = fabs(dvec2_cross(in, dvec2_sub(c, a))) / fmax(dvec2_length(dvec2_sub(c, a)), 1e-9);
			bool is_short = dvec2_length(in) < LEAST_SIDE_M && off < 3.0;
			/* What stays inside the block may be cut off: corners that stick out; others where it hardly shows. */
			bool outward = dvec2_cross(in, on) >= 0.0;
			bool straight = turn < LEAST_TURN && off < (outward ? 1.8 : 0.7);
			bool speck = dvec2_length(in) < 2.0 && off < 0.7;
			if (!straight && !speck && !(is_short && outward))
				continue;
			for (size_t k = i; k + 1 < count; k++)
				points[k] = points[k + 1];
			count--;
			again = true;
			i--;
		}
	}
	if (count > CORNERS_MAX)
		return false;
	out->count = count;
	for (size_t i = 0; i < count; i++)
		out->at[i] = points[i];
	return true;
}

static bool cross_each_other(struct dvec2 a, struct dvec2 b, struct dvec2 c, struct dvec2 d)
{
	double s1 = dvec2_cross(dvec2_sub(b, a), dvec2_sub(c, a)), s2 = dvec2_cross(dvec2_sub(b, a), dvec2_sub(d, a));
	double s3 = dvec2_cross(dvec2_sub(d, c), dvec2_sub(a, c)), s4 = dvec2_cross(dvec2_sub(d, c), dvec2_sub(b, c));
	return s1 * s2 <= 0.0 && s3 * s4 <= 0.0;
}

static bool offset(struct outline *o, double depth)
{
	size_t n = o->count;
	for (size_t i = 0; i < n; i++) {
		struct dvec2 d = dvec2_sub(o->at[(i + 1) % n], o->at[i]);
		o->length[i] = dvec2_length(d);
		if (o->length[i] < 1.0)
			return false;
		o->along[i] = dvec2_scale(d, 1.0 / o->length[i]);
		o->inward[i] = (struct dvec2){ -o->along[i].y, o->along[i].x };
	}
	for (size_t i = 0; i < n; i++) {
		struct dvec2 a = o->inward[(i + n - 1) % n], b = o->inward[i];
		double open = 1.0 + dvec2_dot(a, b);
		if (open < 0.25)
			return false;
		o->inner[i] = dvec2_add(o->at[i], dvec2_scale(dvec2_add(a, b), depth / open));
	}
	for (size_t i = 0; i < n; i++) {
		struct dvec2 a = o->inner[i], b = o->inner[(i + 1) % n];
		if (dvec2_dot(dvec2_sub(b, a), o->along[i]) < 3.0)
			return false;
		for (size_t k = i + 2; k < n; k++)
			if (!(i == 0 && k == n - 1) && cross_each_other(a, b, o->inner[k], o->inner[(k + 1) % n]))
				return false;
		for (size_t k = 0; k < n; k++) /* walls at the back must not cut the front of another side */
			if (k != i && cross_each_other(a, b, o->at[k], o->at[(k + 1) % n]))
				return false;
	}
	return true;
}

/* Cuts along one side, from its first corner: the first and the last bound the corner lots. */
static size_t cut_side(
	const struct outline *o, size_t i, const struct lot_rule *rule, struct rng *rng, double *cuts, size_t limit)
{
	size_t next = (i + 1) % o->count;
	double from = fmax(0.0, dvec2_dot(dvec2_sub(o->inner[i], o->at[i]), o->along[i])) + 0.5;
	double to = fmin(o->length[i], dvec2_dot(dvec2_sub(o->inner[next], o->at[i]), o->along[i])) - 0.5;
	double first = fmax(from, rule->corner_m), last = fmin(to, o->length[i] - rule->corner_m);
	if (to <= from)
		return 0;
	if (last - first < rule->least_m) {
		cuts[0] = (from + to) / 2.0;
		return 1;
	}
	double wanted = rng_range(rng, rule->least_m, rule->most_m);
	size_t pieces = (size_t)fmax(1.0, round((last - first) / wanted));
	pieces = pieces + 1 < limit ? pieces : limit - 1;
	double even = (last - first) / (double)pieces;
	for (size_t k = 0; k <= pieces; k++) {
		double jitter = k && k < pieces ? rng_range(rng, -0.16, 0.16) * even : 0.0;
		cuts[k] = first + even * (double)k + jitter;
	}
	return pieces + 1;
}

static struct dvec2 front_at(const struct outline *o, size_t i, double along)
{
	return dvec2_add(o->at[i], dvec2_scale(o->along[i], along));
}

static struct dvec2 back_at(const struct outline *o, size_t i, double along, double depth)
{
	return dvec2_add(front_at(o, i, along), dvec2_scale(o->inward[i], depth));
}

static void add_middle(const struct outline *o, size_t i, double from, double to, double depth, lot_array *lots)
{
	struct lot lot = { .count = 4, .front_a = front_at(o, i, from), .front_b = front_at(o, i, to) };
	lot.points[0] = lot.front_a;
	lot.points[1] = lot.front_b;
	lot.points[2] = back_at(o, i, to, depth);
	lot.points[3] = back_at(o, i, from, depth);
	ARRAY_PUSH(lots, lot);
}

static void add_corner(const struct outline *o, size_t i, double before, double after, double depth, lot_array *lots)
{
	size_t last = (i + o->count - 1) % o->count;
	struct lot lot = { .count = 6, .corner = true, .front_a = o->at[i], .front_b = front_at(o, i, after) };
	lot.points[0] = front_at(o, last, before);
	lot.points[1] = o->at[i];
	lot.points[2] = front_at(o, i, after);
	lot.points[3] = back_at(o, i, after, depth);
	lot.points[4] = o->inner[i];
	lot.points[5] = back_at(o, last, before, depth);
	ARRAY_PUSH(lots, lot);
}

bool lots_around(struct pool *pool, const struct ring *block, const struct lot_rule *rule, struct rng *rng,
	lot_array *lots, struct ring *yard)
{
	struct outline o;
	double cuts[CORNERS_MAX][96];
	size_t counts[CORNERS_MAX];
	lots->count = 0;
	if (!simplify(block, &o) || !offset(&o, rule->depth_m))
		return false;
	for (size_t i = 0; i < o.count; i++) {
		counts[i] = cut_side(&o, i, rule, rng, cuts[i], 96);
		if (!counts[i])
			return false;
	}
	for (size_t i = 0; i < o.count; i++) {
		size_t last = (i + o.count - 1) % o.count;
		add_corner(&o, i, cuts[last][counts[last] - 1], cuts[i][0], rule->depth_m, lots);
		for (size_t k = 0; k + 1 < counts[i]; k++)
			add_middle(&o, i, cuts[i][k], cuts[i][k + 1], rule->depth_m * rng_range(rng, 0.86, 1.0), lots);
	}
	yard->points = POOL_ARRAY(pool, struct dvec2, o.count);
	yard->count = o.count;
	for (size_t i = 0; i < o.count; i++)
		yard->points[i] = o.inner[i];
	return true;
}
