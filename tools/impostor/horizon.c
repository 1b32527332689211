#include "tools/impostor/horizon.h"

#include <string.h>

#define SIDE_BINS (HORIZON_BINS / 4)
#define MARGIN 1e-6     /* of slopes and distances, against rounding */
#define TOO_NEAR_M 0.05 /* what comes so near to the eye is not asked about */

/* A place in the frame of a side of the diamond. */
struct place {
	double bin; /* 0 to SIDE_BINS, along the side */
	double slope, inverse;
};

void horizon_reset(struct horizon *horizon, struct dvec3 eye)
{
	horizon->eye = eye;
	for (int i = 0; i < HORIZON_BINS; i++)
		horizon->bins[i].count = 0;
}

static double diamond(struct dvec2 p)
{
	return fabs(p.x) + fabs(p.y);
}

/* Counter-clockwise from the x axis, 0 to HORIZON_BINS. */
static double azimuth(struct dvec2 p)
{
	double s = diamond(p), turn;
	if (p.y >= 0.0)
		turn = p.x > 0.0 ? p.y / s : 1.0 - p.x / s;
	else
		turn = p.x < 0.0 ? 2.0 - p.y / s : 3.0 + p.x / s;
	return turn * SIDE_BINS;
}

/* The side that begins at this azimuth or holds it. */
static int side_of(struct dvec2 p)
{
	if (p.y >= 0.0)
		return p.x > 0.0 ? 0 : p.y > 0.0 ? 1 : 2;
	return p.x < 0.0 ? 2 : 3;
}

/* How far along a side, 0 to 1, a point of it or of its end is; times its distance. */
static double along_side(struct dvec2 p, int side)
{
	switch (side) {
	case 0:
		return p.y;
	case 1:
		return -p.x;
	case 2:
		return -p.y;
	default:
		return p.x;
	}
}

/* The other coordinate: 0 where the side ends. */
static double to_side_end(struct dvec2 p, int side)
{
	return along_side(p, (side + 3) % 4);
}

static struct place place_on(struct dvec3 p, int side)
{
	double inverse = 1.0 / (fabs(p.x) + fabs(p.y));
	double share = along_side((struct dvec2){ p.x, p.y }, side) * inverse;
	return (struct place){ fmin(fmax(share, 0.0), 1.0) * SIDE_BINS, p.z * inverse, inverse };
}

/*
 * Cuts a -> b, which turns counter-clockwise around the eye by less than half a turn, where it passes from side to
 * side.
 */
typedef void (*piece_visit)(void *context, int side, const struct place *from, const struct place *to);

static void cut_by_sides(struct dvec3 a, struct dvec3 b, piece_visit visit, void *context)
{
	int side = side_of((struct dvec2){ a.x, a.y });
	for (int i = 0; i < 4; i++, side = (side + 1) % 4) {
		double ta = to_side_end((struct dvec2){ a.x, a.y }, side), tb = to_side_end((struct dvec2){ b.x, b.y }, side);
		bool last = tb >= 0.0 && along_side((struct dvec2){ b.x, b.y }, side) >= 0.0;
		struct dvec3 end = b;
		if (!last) {
			double t = ta > tb ? fmin(fmax(ta / (ta - tb), 0.0), 1.0) : 0.0;
			end = (struct dvec3){ a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z) };
		}
		struct place from = place_on(a, side), to = place_on(end, side);
		if (!last)
			to.bin = SIDE_BINS;
		visit(context, side, &from, &to);
		if (last)
			return;
		a = end;
	}
}

/* ---- occluders ---- */

/* One step too many: the one that adds least to the step before it goes. Hiding less is always right. */
static void drop_step(struct horizon_bin *bin, float inverse, float slope, uint32_t at)
{
	float inverses[HORIZON_STEPS + 1], slopes[HORIZON_STEPS + 1];
	for (uint32_t i = 0; i <= HORIZON_STEPS; i++) {
		inverses[i] = i == at ? inverse : bin->near_inverse[i < at ? i : i - 1];
		slopes[i] = i == at ? slope : bin->slope[i < at ? i : i - 1];
	}
	uint32_t least = 1;
	for (uint32_t i = 2; i <= HORIZON_STEPS; i++)
		if (slopes[i] - slopes[i - 1] < slopes[least] - slopes[least - 1])
			least = i;
	for (uint32_t i = 0; i < HORIZON_STEPS; i++) {
		bin->near_inverse[i] = inverses[i < least ? i : i + 1];
		bin->slope[i] = slopes[i < least ? i : i + 1];
	}
}

static void raise_bin(struct horizon_bin *bin, float inverse, float slope)
{
	uint32_t at = 0, end;
	while (at < bin->count && bin->near_inverse[at] >= inverse)
		at++;
	if (at && bin->slope[at - 1] >= slope)
		return;
	for (end = at; end < bin->count && bin->slope[end] <= slope; end++)
		;
	if (end == at && bin->count == HORIZON_STEPS) {
		drop_step(bin, inverse, slope, at);
		return;
	}
	size_t tail = bin->count - end;
	memmove(&bin->near_inverse[at + 1], &bin->near_inverse[end], tail * sizeof(float));
	memmove(&bin->slope[at + 1], &bin->slope[end], tail * sizeof(float));
	bin->near_inverse[at] = inverse;
	bin->slope[at] = slope;
	bin->count = at + 1 + (uint32_t)tail;
}

/* Walls in a row, counter-clockwise around the eye. A bin counts once they have crossed it from its start to its end.
 */
struct chain {
	struct horizon *horizon;
	bool covered; /* from the start of the bin that the last wall ended in */
	double slope, inverse;
};

static double between(double from, double to, double t)
{
	return from + (to - from) * t;
}

static void add_piece(void *context, int side, const struct place *from, const struct place *to)
{
	struct chain *chain = context;
	double length = to->bin - from->bin;
	if (!(length > 0.0)) {
		chain->slope = fmin(chain->slope, fmin(from->slope, to->slope));
		chain->inverse = fmin(chain->inverse, fmin(from->inverse, to->inverse));
		return;
	}
	for (int bin = (int)from->bin; bin < to->bin; bin++) {
		double t0 = (fmax(bin, from->bin) - from->bin) / length, t1 = (fmin(bin + 1, to->bin) - from->bin) / length;
		double slope = fmin(between(from->slope, to->slope, t0), between(from->slope, to->slope, t1));
		double inverse = fmin(between(from->inverse, to->inverse, t0), between(from->inverse, to->inverse, t1));
		bool starts = from->bin <= bin;
		chain->covered |= starts;
		chain->slope = starts ? slope : fmin(chain->slope, slope);
		chain->inverse = starts ? inverse : fmin(chain->inverse, inverse);
		if (to->bin < bin + 1)
			return;
		if (chain->covered)
			raise_bin(&chain->horizon->bins[side * SIDE_BINS + bin], (float)chain->inverse, (float)chain->slope);
		chain->covered = false;
	}
}

/* Sides in the order of growing azimuth: backwards along the outline those that face the eye, forwards the others. */
struct outline_walk {
	const struct dvec2 *points;
	uint32_t count;
	bool backwards;
};

static void walk_side(const struct outline_walk *walk, uint32_t i, struct dvec2 *a, struct dvec2 *b)
{
	uint32_t next = i + 1 < walk->count ? i + 1 : 0;
	if (!walk->backwards) {
		*a = walk->points[i];
		*b = walk->points[next];
		return;
	}
	*a = walk->points[walk->count - 1 - i];
	*b = walk->points[walk->count - 1 - next];
}

static bool turns_left(const struct outline_walk *walk, uint32_t i)
{
	struct dvec2 a, b;
	walk_side(walk, i, &a, &b);
	return dvec2_cross(a, b) > 0.0;
}

void horizon_add_outline(struct horizon *horizon, const struct dvec2 *points, uint32_t count, double top)
{
	/* From above one looks over the wall in front: the one behind hides more. */
	struct outline_walk walk = { points, count, top >= 0.0 };
	uint32_t start = 0;
	while (start < count && (turns_left(&walk, start) || !turns_left(&walk, start + 1 < count ? start + 1 : 0)))
		start++;
	bool around = start == count; /* all sides turn one way: the eye is in a courtyard, or nothing is to be seen */
	struct chain chain = { .horizon = horizon };
	for (uint32_t k = 0; k < count + around; k++) {
		uint32_t i = (start + 1 + k) % count;
		struct dvec2 a, b;
		walk_side(&walk, i, &a, &b);
		if (dvec2_cross(a, b) > 0.0 && fmin(diamond(a), diamond(b)) > TOO_NEAR_M)
			cut_by_sides((struct dvec3){ a.x, a.y, top }, (struct dvec3){ b.x, b.y, top }, add_piece, &chain);
		else
			chain.covered = false;
	}
}

/* ---- questions ---- */

static bool bin_hides(const struct horizon_bin *bin, double inverse, double slope)
{
	inverse += inverse * MARGIN;
	slope += (1.0 + fabs(slope)) * MARGIN;
	for (uint32_t i = bin->count; i-- > 0;)
		if ((double)bin->near_inverse[i] >= inverse)
			return (double)bin->slope[i] >= slope;
	return false;
}

/* The bins that a polygon touches: `count` of them from `first` on, round the circle. */
struct bin_range {
	uint32_t first, count;
};

/* False when the eye is in the polygon, or so near to it that no direction is sure. */
static bool find_range(const struct dvec3 *corners, uint32_t count, struct bin_range *out)
{
	double at[4] = { 0.0 };
	for (uint32_t i = 0; i < count; i++) {
		struct dvec2 p = { corners[i].x, corners[i].y };
		if (diamond(p) < TOO_NEAR_M)
			return false;
		double azimuth_i = azimuth(p);
		uint32_t k = i;
		for (; k > 0 && at[k - 1] > azimuth_i; k--)
			at[k] = at[k - 1];
		at[k] = azimuth_i;
	}
	uint32_t widest = 0;
	double gap = at[0] + HORIZON_BINS - at[count - 1];
	for (uint32_t i = 1; i < count; i++)
		if (at[i] - at[i - 1] > gap) {
			gap = at[i] - at[i - 1];
			widest = i;
		}
	/* Opposite points are half the circle apart on the diamond as well. */
	if (gap < HORIZON_BINS / 2 + 1e-6)
		return false;
	double end = at[widest ? widest - 1 : count - 1] + (widest ? HORIZON_BINS : 0);
	out->first = (uint32_t)at[widest] % HORIZON_BINS;
	out->count = (uint32_t)end - (uint32_t)at[widest] + 1;
	return true;
}

static double outside(double low, double high)
{
	return fmax(0.0, fmax(low, -high));
}

/* By bounds of the whole polygon. */
static bool hides_at_once(
	const struct horizon *horizon, const struct dvec3 *corners, uint32_t count, const struct bin_range *range)
{
	struct dvec3 low = corners[0], high = corners[0];
	double far = 0.0;
	for (uint32_t i = 0; i < count; i++) {
		low.x = fmin(low.x, corners[i].x);
		low.y = fmin(low.y, corners[i].y);
		high.x = fmax(high.x, corners[i].x);
		high.y = fmax(high.y, corners[i].y);
		high.z = fmax(high.z, corners[i].z);
		far = fmax(far, fabs(corners[i].x) + fabs(corners[i].y));
	}
	double near = outside(low.x, high.x) + outside(low.y, high.y);
	if (near < TOO_NEAR_M)
		return false;
	double slope = high.z / (high.z > 0.0 ? near : far), inverse = 1.0 / near;
	for (uint32_t i = 0; i < range->count; i++)
		if (!bin_hides(&horizon->bins[(range->first + i) % HORIZON_BINS], inverse, slope))
			return false;
	return true;
}

static void note_piece(void *context, int side, const struct place *from, const struct place *to)
{
	struct horizon *horizon = context;
	double length = to->bin - from->bin;
	double scale = length > 0.0 ? 1.0 / length : 0.0;
	int last = to->bin >= SIDE_BINS ? SIDE_BINS - 1 : (int)to->bin;
	for (int bin = from->bin >= SIDE_BINS ? SIDE_BINS - 1 : (int)from->bin; bin <= last; bin++) {
		double t0 = fmax(bin - from->bin, 0.0) * scale, t1 = fmin(bin + 1 - from->bin, length) * scale;
		double slope = fmax(between(from->slope, to->slope, t0), between(from->slope, to->slope, t1));
		double inverse = fmax(between(from->inverse, to->inverse, t0), between(from->inverse, to->inverse, t1));
		if (scale <= 0.0) {
			slope = fmax(from->slope, to->slope);
			inverse = fmax(from->inverse, to->inverse);
		}
		float *slope_max = &horizon->slope_max[side * SIDE_BINS + bin];
		float *inverse_max = &horizon->inverse_max[side * SIDE_BINS + bin];
		*slope_max = fmaxf(*slope_max, (float)slope);
		*inverse_max = fmaxf(*inverse_max, (float)inverse);
	}
}

static void note_edge(struct horizon *horizon, struct dvec3 a, struct dvec3 b)
{
	double cross = a.x * b.y - a.y * b.x;
	if (cross > 0.0)
		cut_by_sides(a, b, note_piece, horizon);
	else if (cross < 0.0)
		cut_by_sides(b, a, note_piece, horizon);
	else {
		int side = side_of((struct dvec2){ a.x, a.y });
		struct place from = place_on(a, side), to = place_on(b, side);
		to.bin = from.bin;
		note_piece(horizon, side, &from, &to);
	}
}

bool horizon_hides(struct horizon *horizon, const struct dvec3 *corners, uint32_t count)
{
	struct bin_range range;
	if (!find_range(corners, count, &range))
		return false;
	if (hides_at_once(horizon, corners, count, &range))
		return true;
	for (uint32_t i = 0; i < range.count; i++) {
		uint32_t bin = (range.first + i) % HORIZON_BINS;
		if (!horizon->bins[bin].count)
			return false;
		horizon->slope_max[bin] = -INFINITY;
		horizon->inverse_max[bin] = 0.0F;
	}
	for (uint32_t i = 0; i < count; i++)
		note_edge(horizon, corners[i], corners[i + 1 < count ? i + 1 : 0]);
	for (uint32_t i = 0; i < range.count; i++) {
		uint32_t bin = (range.first + i) % HORIZON_BINS;
		bool touched = horizon->inverse_max[bin] > 0.0F;
		if (touched &&
			!bin_hides(&horizon->bins[bin], (double)horizon->inverse_max[bin], (double)horizon->slope_max[bin]))
			return false;
	}
	return true;
}
