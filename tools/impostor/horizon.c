#include "tools/impostor/horizon.h"

#include <string.h>

#include "tools/impostor/extremes.h"

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
	return (struct place){ smaller(larger(share, 0.0), 1.0) * SIDE_BINS, p.z * inverse, inverse };
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
			double t = ta > tb ? smaller(larger(ta / (ta - tb), 0.0), 1.0) : 0.0;
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
		chain->slope = smaller(chain->slope, smaller(from->slope, to->slope));
		chain->inverse = smaller(chain->inverse, smaller(from->inverse, to->inverse));
		return;
	}
	for (int bin = (int)from->bin; bin < to->bin; bin++) {
		double t0 = (larger(bin, from->bin) - from->bin) / length,
			   t1 = (smaller(bin + 1, to->bin) - from->bin) / length;
		double slope = smaller(between(from->slope, to->slope, t0), between(from->slope, to->slope, t1));
		double inverse = smaller(between(from->inverse, to->inverse, t0), between(from->inverse, to->inverse, t1));
		bool starts = from->bin <= bin;
		chain->covered |= starts;
		chain->slope = starts ? slope : smaller(chain->slope, slope);
		chain->inverse = starts ? inverse : smaller(chain->inverse, inverse);
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
	if (count < 3)
		return;
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
		if (dvec2_cross(a, b) > 0.0 && smaller(diamond(a), diamond(b)) > TOO_NEAR_M)
			cut_by_sides((struct dvec3){ a.x, a.y, top }, (struct dvec3){ b.x, b.y, top }, add_piece, &chain);
		else
			chain.covered = false;
	}
}

/* ---- questions ---- */

/* The slope below which a bin is hidden at this distance; distances from far to near. */
static double blocked_slope(const struct horizon_bin *bin, double inverse)
{
	inverse += inverse * MARGIN;
	for (uint32_t i = bin->count; i-- > 0;)
		if ((double)bin->near_inverse[i] >= inverse)
			return (double)bin->slope[i];
	return -INFINITY;
}

static double with_margin(double slope)
{
	return slope + (1.0 + fabs(slope)) * MARGIN;
}

/* The bins that a polygon touches: `count` of them from `first` on, round the circle. */
struct bin_range {
	uint32_t first, count;
};

/* Bounds of what is asked about. */
struct extent {
	struct dvec2 min, max;
	double top;
	double near, far; /* bounds of the distance */
};

static void measure(struct extent *extent)
{
	const struct dvec2 *min = &extent->min, *max = &extent->max;
	extent->near = larger(0.0, larger(min->x, -max->x)) + larger(0.0, larger(min->y, -max->y));
	extent->far = larger(fabs(min->x), fabs(max->x)) + larger(fabs(min->y), fabs(max->y));
}

static struct extent extent_of(const struct dvec3 *corners, uint32_t count)
{
	struct extent out = { { corners[0].x, corners[0].y }, { corners[0].x, corners[0].y }, corners[0].z, 0.0, 0.0 };
	for (uint32_t i = 1; i < count; i++) {
		out.min = (struct dvec2){ smaller(out.min.x, corners[i].x), smaller(out.min.y, corners[i].y) };
		out.max = (struct dvec2){ larger(out.max.x, corners[i].x), larger(out.max.y, corners[i].y) };
		out.top = larger(out.top, corners[i].z);
	}
	measure(&out);
	return out;
}

/* The side that holds all of it, or -1. */
static int single_side(const struct extent *extent)
{
	if (extent->min.x > 0.0)
		return extent->min.y > 0.0 ? 0 : extent->max.y < 0.0 ? 3 : -1;
	if (extent->max.x < 0.0)
		return extent->min.y > 0.0 ? 1 : extent->max.y < 0.0 ? 2 : -1;
	return -1;
}

static void range_on_side(const struct dvec3 *corners, uint32_t count, int side, struct bin_range *out)
{
	double low = 1.0, high = 0.0;
	for (uint32_t i = 0; i < count; i++) {
		struct dvec2 p = { corners[i].x, corners[i].y };
		double share = fabs(side % 2 ? p.x : p.y) / diamond(p);
		low = smaller(low, share);
		high = larger(high, share);
	}
	uint32_t first = (uint32_t)(low * SIDE_BINS), last = (uint32_t)(high * SIDE_BINS);
	last = last < SIDE_BINS ? last : SIDE_BINS - 1;
	*out = (struct bin_range){ (uint32_t)side * SIDE_BINS + first, last - first + 1 };
}

/* Around the widest gap between the corners. False when the eye is in the polygon or at its edge. */
static bool range_around(const struct dvec3 *corners, uint32_t count, struct bin_range *out)
{
	double at[4] = { 0.0 };
	for (uint32_t i = 0; i < count; i++) {
		double azimuth_i = azimuth((struct dvec2){ corners[i].x, corners[i].y });
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

/* False when the eye is in the polygon, or so near to it that no direction is sure. */
static bool find_range(const struct dvec3 *corners, uint32_t count, const struct extent *extent, struct bin_range *out)
{
	int side = single_side(extent);
	if (side >= 0 && extent->near > TOO_NEAR_M) {
		range_on_side(corners, count, side, out);
		return true;
	}
	for (uint32_t i = 0; i < count; i++)
		if (diamond((struct dvec2){ corners[i].x, corners[i].y }) < TOO_NEAR_M)
			return false;
	return range_around(corners, count, out);
}

/* The lowest slope that is blocked in all of these bins, at this distance. */
static double floor_over(const struct horizon *horizon, const struct bin_range *range, double near)
{
	double inverse = 1.0 / near, lowest = INFINITY;
	for (uint32_t i = 0; i < range->count && lowest > -INFINITY; i++)
		lowest = smaller(lowest, blocked_slope(&horizon->bins[(range->first + i) % HORIZON_BINS], inverse));
	return lowest;
}

double horizon_floor(const struct horizon *horizon, struct dvec2 min, struct dvec2 max)
{
	const struct dvec3 corners[4] = { { min.x, min.y, 0.0 }, { max.x, min.y, 0.0 }, { max.x, max.y, 0.0 },
		{ min.x, max.y, 0.0 } };
	struct extent extent = extent_of(corners, 4);
	struct bin_range range;
	if (extent.near <= TOO_NEAR_M || !find_range(corners, 4, &extent, &range))
		return -INFINITY;
	return floor_over(horizon, &range, extent.near);
}

static void note_piece(void *context, int side, const struct place *from, const struct place *to)
{
	struct horizon *horizon = context;
	double length = to->bin - from->bin;
	double scale = length > 0.0 ? 1.0 / length : 0.0;
	int last = to->bin >= SIDE_BINS ? SIDE_BINS - 1 : (int)to->bin;
	for (int bin = from->bin >= SIDE_BINS ? SIDE_BINS - 1 : (int)from->bin; bin <= last; bin++) {
		double t0 = larger(bin - from->bin, 0.0) * scale, t1 = smaller(bin + 1 - from->bin, length) * scale;
		double slope = larger(between(from->slope, to->slope, t0), between(from->slope, to->slope, t1));
		double inverse = larger(between(from->inverse, to->inverse, t0), between(from->inverse, to->inverse, t1));
		if (scale <= 0.0) {
			slope = larger(from->slope, to->slope);
			inverse = larger(from->inverse, to->inverse);
		}
		float *slope_max = &horizon->slope_max[side * SIDE_BINS + bin];
		float *inverse_max = &horizon->inverse_max[side * SIDE_BINS + bin];
		*slope_max = (float)larger((double)*slope_max, slope);
		*inverse_max = (float)larger((double)*inverse_max, inverse);
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

/* Most of what is seen is told by a corner. */
static bool shows_corner(const struct horizon *horizon, const struct dvec3 *corners, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		int side = side_of((struct dvec2){ corners[i].x, corners[i].y });
		struct place place = place_on(corners[i], side);
		int bin = place.bin < SIDE_BINS ? (int)place.bin : SIDE_BINS - 1;
		if (blocked_slope(&horizon->bins[side * SIDE_BINS + bin], place.inverse) < with_margin(place.slope))
			return true;
	}
	return false;
}

/* Bin by bin, by the highest and the nearest that the polygon has there. */
static bool hides_in_detail(
	struct horizon *horizon, const struct dvec3 *corners, uint32_t count, const struct bin_range *range)
{
	for (uint32_t i = 0; i < range->count; i++) {
		uint32_t bin = (range->first + i) % HORIZON_BINS;
		if (!horizon->bins[bin].count)
			return false;
		horizon->slope_max[bin] = -INFINITY;
		horizon->inverse_max[bin] = 0.0F;
	}
	for (uint32_t i = 0; i < count; i++)
		note_edge(horizon, corners[i], corners[i + 1 < count ? i + 1 : 0]);
	for (uint32_t i = 0; i < range->count; i++) {
		uint32_t bin = (range->first + i) % HORIZON_BINS;
		double slope = (double)horizon->slope_max[bin], inverse = (double)horizon->inverse_max[bin];
		if (inverse > 0.0 && blocked_slope(&horizon->bins[bin], inverse) < with_margin(slope))
			return false;
	}
	return true;
}

bool horizon_hides(struct horizon *horizon, const struct dvec3 *corners, uint32_t count, double floor)
{
	struct extent extent = extent_of(corners, count);
	bool apart = extent.near > TOO_NEAR_M;
	double slope = INFINITY;
	if (apart || (extent.top <= 0.0 && extent.far > TOO_NEAR_M))
		slope = with_margin(extent.top / (extent.top > 0.0 ? extent.near : extent.far));
	if (slope <= floor)
		return true;
	struct bin_range range;
	if (!find_range(corners, count, &extent, &range))
		return false;
	if (apart && slope <= floor_over(horizon, &range, extent.near))
		return true;
	if ((range.count == 1 && apart) || shows_corner(horizon, corners, count))
		return false;
	return hides_in_detail(horizon, corners, count, &range);
}
