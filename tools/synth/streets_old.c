/* The old town: an irregular wheel. A square in the middle, crooked rings and radials, the former wall as a boulevard.
 */
#include <math.h>

#include "tools/synth/synth.h"

#define RINGS_MAX 8
#define SPOKES_MAX 40
#define SHORT_OF_M 0.25

struct wheel {
	struct synth *synth;
	const struct plan *plan;
	int rings, spokes;
	double radius[RINGS_MAX];
	struct dvec2 at[RINGS_MAX][SPOKES_MAX]; /* plan coordinates */
	double floor_t;                         /* nothing nearer to the river than this */
};

static int64_t id_of(int ring, int spoke)
{
	return (INT64_C(1) << 42) + ring * 1000 + spoke;
}

static double ring_radius(const struct plan *plan, double angle)
{
	double low = 0.0, high = 2.0 * plan->old_radius_m;
	for (int i = 0; i < 50; i++) {
		double r = (low + high) / 2.0;
		double side = plan_old_town(plan, plan->old_middle.x + r * cos(angle), plan->old_middle.y + r * sin(angle));
		if (side < 0.0)
			low = r;
		else
			high = r;
	}
	return low;
}

static void place_wheel(struct wheel *wheel)
{
	struct rng rng = synth_rng(wheel->synth, 10, 0);
	const struct plan *plan = wheel->plan;
	double outer = plan->old_radius_m;
	wheel->radius[0] = fmin(fmax(outer * 0.16, 24.0), 42.0);
	wheel->rings = outer < 150.0 ? 3 : outer < 230.0 ? 4 : 5;
	wheel->spokes = outer < 150.0 ? 8 : outer < 230.0 ? 12 : 16;
	for (int r = 1; r < wheel->rings; r++)
		wheel->radius[r] = wheel->radius[0] + (outer - wheel->radius[0]) * r / (wheel->rings - 1.0);
	for (int k = 0; k < wheel->spokes; k++) {
		double angle = 2.0 * BLVD_PI * (k + rng_range(&rng, -0.16, 0.16)) / wheel->spokes;
		for (int r = 0; r < wheel->rings; r++) {
			double gap = (outer - wheel->radius[0]) / (wheel->rings - 1.0);
			double wander = r == 0 || r + 1 == wheel->rings ? 0.0 : rng_range(&rng, -0.17, 0.17);
			double turn = r == 0 || r + 1 == wheel->rings ? 0.0 : rng_range(&rng, -0.12, 0.12);
			double at_angle = angle + turn * 2.0 * BLVD_PI / wheel->spokes;
			double radius = r + 1 == wheel->rings ? ring_radius(plan, angle) : wheel->radius[r] + wander * gap;
			wheel->at[r][k] = (struct dvec2){ plan->old_middle.x + radius * cos(at_angle),
				plan->old_middle.y + radius * sin(at_angle) };
		}
	}
}

/* One street between two places of the wheel, cut short where it meets the quay. Steps along the ring follow it. */
static void add_line(struct wheel *wheel, struct dvec2 from, struct dvec2 to, int64_t from_id, int64_t to_id,
	const struct street_kind *kind, const char *name, bool along_ring)
{
	struct dvec2 points[20];
	double floor_t = wheel->floor_t;
	if (from.y < floor_t && to.y < floor_t)
		return;
	size_t count = 0;
	const struct plan *plan = wheel->plan;
	double from_angle = atan2(from.y - plan->old_middle.y, from.x - plan->old_middle.x);
	double sweep = remainder(atan2(to.y - plan->old_middle.y, to.x - plan->old_middle.x) - from_angle, 2.0 * BLVD_PI);
	struct dvec2 last = from;
	int steps = along_ring ? 12 : 3;
	for (int i = 0; i <= steps; i++) {
		double f = (double)i / steps, angle = from_angle + f * sweep;
		struct dvec2 p = { from.x + f * (to.x - from.x), from.y + f * (to.y - from.y) };
		if (along_ring && i > 0 && i < steps) {
			double r = ring_radius(plan, angle);
			p = (struct dvec2){ plan->old_middle.x + r * cos(angle), plan->old_middle.y + r * sin(angle) };
		}
		if (i && (p.y < floor_t) != (last.y < floor_t)) {
			double cut = (floor_t + SHORT_OF_M - last.y) / (p.y - last.y);
			double s = last.x + cut * (p.x - last.x);
			points[count++] = plan_place(plan, s, floor_t + SHORT_OF_M);
		}
		if (p.y >= floor_t)
			points[count++] = plan_place(plan, p.x, p.y);
		last = p;
	}
	double length = 0.0;
	for (size_t i = 1; i < count; i++)
		length += dvec2_length(dvec2_sub(points[i], points[i - 1]));
	if (count >= 2 && length > 12.0)
		street_add(
			wheel->synth, kind, name, points, count, from.y >= floor_t ? from_id : 0, to.y >= floor_t ? to_id : 0);
}

static struct street_kind kind_of(const struct wheel *wheel, int ring, bool radial, int spoke)
{
	if (ring + 1 == wheel->rings)
		return (struct street_kind){ PKG_STREET_SECONDARY, 13.0, 4, 50, .street = { .trees = true } };
	int quarter = wheel->spokes >= 4 ? wheel->spokes / 4 : 1;
	if (radial && spoke % quarter == 0)
		return (struct street_kind){ PKG_STREET_TERTIARY, 7.0, 2, 30, .street = { .surface = "sett" } };
	return (struct street_kind){ PKG_STREET_LIVING, 4.8, 2, 20, .street = { .surface = "sett" } };
}

void streets_old_town(struct synth *synth)
{
	struct wheel wheel = {
		.synth = synth, .plan = &synth->plan, .floor_t = synth->plan.river ? synth->plan.quay_m : -1e9
	};
	struct rng rng = synth_rng(synth, 11, 0);
	place_wheel(&wheel);
	const char *boulevard = name_street(synth, 2), *square = "Cathedral Square";
	for (int r = 0; r < wheel.rings; r++) {
		const char *name = r == 0 ? square : r + 1 == wheel.rings ? boulevard : name_street(synth, 3);
		for (int k = 0; k < wheel.spokes; k++) {
			int next = (k + 1) % wheel.spokes;
			bool skip = r > 0 && r + 1 < wheel.rings && rng_unit(&rng) < 0.05;
			struct street_kind kind = kind_of(&wheel, r, false, k);
			if (!skip)
				add_line(&wheel, wheel.at[r][k], wheel.at[r][next], id_of(r, k), id_of(r, next), &kind, name,
					r + 1 == wheel.rings);
			if (r && r + 1 < wheel.rings && k % 5 == 4)
				name = name_street(synth, 3);
		}
	}
	int quarter = wheel.spokes >= 4 ? wheel.spokes / 4 : 1;
	for (int k = 0; k < wheel.spokes; k++) {
		const char *name = name_street(synth, k % quarter ? 3 : 1);
		for (int r = 0; r + 1 < wheel.rings; r++) {
			bool inner_skip = r == 0 && k % 2; /* the square has half as many ways in */
			bool skip = k % quarter && inner_skip;
			struct street_kind kind = kind_of(&wheel, r, true, k);
			if (!skip)
				add_line(&wheel, wheel.at[r][k], wheel.at[r + 1][k], id_of(r, k), id_of(r + 1, k), &kind, name, false);
		}
	}
}
