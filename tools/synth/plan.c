/*
 * The plan: a lattice of lines s = const and t = const, closer together in the middle, every fourth or fifth an
 * arterial. The river runs along t = 0, the railway along s = const east of the middle, in a column of its own.
 */
#include <math.h>

#include "tools/synth/synth.h"

#define RIVER_FROM_M 800.0 /* smaller cities have none */
#define OLD_TOWN_FROM_M 450.0
#define RAILWAY_FROM_M 1500.0
#define PARK_FROM_M 1400.0
#define RAIL_COLUMN_M 280.0
#define BEND_M 32.0

static double river_bend(const struct plan *plan, double s)
{
	return plan->phase[6] * sin(s / plan->phase[7] + plan->phase[0]) +
		   0.3 * plan->phase[6] * sin(2.7 * s / plan->phase[7] + plan->phase[1]);
}

struct dvec2 plan_place(const struct plan *plan, double s, double t)
{
	double free = 1.0 - exp(-(t / 320.0) * (t / 320.0));
	double with_river = exp(-(t / 1100.0) * (t / 1100.0));
	double dx = sin(s / 210.0 + t / 330.0 + plan->phase[2]) + sin(t / 170.0 - s / 410.0 + plan->phase[3]);
	double dy = sin(t / 240.0 - s / 300.0 + plan->phase[4]) + sin(s / 180.0 + t / 420.0 + plan->phase[5]);
	return (
		struct dvec2){ s + 0.5 * BEND_M * free * dx, t + 0.5 * BEND_M * free * dy + river_bend(plan, s) * with_river };
}

struct dvec2 plan_unplace(const struct plan *plan, struct dvec2 at)
{
	struct dvec2 guess = at;
	for (int i = 0; i < 24; i++) {
		struct dvec2 there = plan_place(plan, guess.x, guess.y);
		guess.x += at.x - there.x;
		guess.y += at.y - there.y;
	}
	return guess;
}

double plan_old_town(const struct plan *plan, double s, double t)
{
	if (!plan->old_town)
		return HUGE_VAL;
	double ds = s - plan->old_middle.x, dt = t - plan->old_middle.y, angle = atan2(dt, ds);
	double radius = plan->old_radius_m *
					(1.0 + 0.06 * sin(3.0 * angle + plan->phase[2]) + 0.04 * sin(5.0 * angle + plan->phase[3]));
	return hypot(ds, dt) - radius;
}

double plan_centrality(const struct synth *synth, struct dvec2 at)
{
	double half = 0.5 * fmin(synth->options.width_m, synth->options.height_m);
	double reach = fmax(0.95 * half, 420.0);
	double wobble = 0.06 * sin(at.x / 310.0 + synth->plan.phase[4]) + 0.05 * sin(at.y / 270.0 + synth->plan.phase[5]);
	double x = at.x / (reach * synth->options.width_m / (2.0 * half)),
		   y = at.y / (reach * synth->options.height_m / (2.0 * half));
	return fmax(0.0, fmin(1.0, 1.0 - hypot(x, y) + wobble));
}

static double spacing(double distance, double reach, struct rng *rng)
{
	double far = fmin(distance / reach, 1.0);
	return (78.0 + 52.0 * far) * rng_range(rng, 0.85, 1.22);
}

static int rank_of(int index, int *next_arterial, struct rng *rng)
{
	if (index < *next_arterial)
		return index + 2 == *next_arterial && rng_unit(rng) < 0.6 ? 1 : 0;
	*next_arterial = index + 4 + (int)(rng_u32(rng) % 2);
	return 2;
}

/* Lines from `from` outwards in one direction, not beyond `limit`. */
static size_t grow(double *lines, int *ranks, double from, double limit, bool arterial_first, struct rng *rng)
{
	size_t count = 0;
	int next_arterial = arterial_first ? 0 : 3;
	double at = from;
	for (int index = 0; at <= limit && count < 4000; index++) {
		lines[count] = at;
		ranks[count++] = rank_of(index, &next_arterial, rng);
		at += spacing(at, limit, rng);
	}
	return count;
}

static void add_line(struct synth *synth, bool along_s, double at, int rank)
{
	struct lattice_line line = { at, rank, name_street(synth, rank) };
	if (along_s)
		ARRAY_PUSH(&synth->plan.s, line);
	else
		ARRAY_PUSH(&synth->plan.t, line);
}

static void make_rows(struct synth *synth, double *lines, int *ranks)
{
	struct plan *plan = &synth->plan;
	struct rng rng = synth_rng(synth, 1, 0);
	double limit = synth->options.height_m / 2.0 - 15.0, first = plan->river ? plan->quay_m : 0.0;
	size_t count =
		grow(lines, ranks, plan->river ? first + spacing(0, limit, &rng) : spacing(0, limit, &rng), limit, false, &rng);
	for (size_t i = count; i--;)
		add_line(synth, false, -lines[i], ranks[i]);
	plan->south_quay = plan->t.count;
	add_line(synth, false, -first, plan->river ? 1 : 2);
	plan->north_quay = plan->t.count;
	if (plan->river)
		add_line(synth, false, first, 1);
	else
		plan->north_quay = plan->south_quay;
	count = grow(lines, ranks, first + spacing(0, limit, &rng), limit, false, &rng);
	for (size_t i = 0; i < count; i++)
		add_line(synth, false, lines[i], ranks[i]);
}

static void make_columns(struct synth *synth, double *lines, int *ranks)
{
	struct plan *plan = &synth->plan;
	struct rng rng = synth_rng(synth, 2, 0);
	double limit = synth->options.width_m / 2.0 - 15.0;
	size_t count = grow(lines, ranks, spacing(0, limit, &rng), limit, false, &rng);
	for (size_t i = count; i--;)
		add_line(synth, true, -lines[i], ranks[i]);
	add_line(synth, true, 0.0, 2);
	double at = spacing(0, limit, &rng), rail_from = 0.3 * limit;
	int next_arterial = 3;
	bool railway_to_come = plan->railway;
	for (int index = 0; at <= limit; index++) {
		int rank = rank_of(index, &next_arterial, &rng);
		if (railway_to_come && at > rail_from && at + RAIL_COLUMN_M < limit) {
			add_line(synth, true, at, 1);
			plan->rail_column = plan->s.count - 1;
			at += RAIL_COLUMN_M;
			railway_to_come = false;
			rank = 1;
		}
		add_line(synth, true, at, rank);
		at += spacing(at, limit, &rng);
	}
	plan->railway = plan->railway && !railway_to_come;
}

static size_t line_near(const struct lattice_line *lines, size_t count, double at)
{
	size_t best = 0;
	for (size_t i = 1; i < count; i++)
		if (fabs(lines[i].at - at) < fabs(lines[best].at - at))
			best = i;
	return best;
}

/* North-west of the middle, about 330 m square, with an arterial through its middle that dives into a tunnel. */
static void place_park(struct synth *synth)
{
	struct plan *plan = &synth->plan;
	double half_w = synth->options.width_m / 2.0, half_h = synth->options.height_m / 2.0;
	double s = -fmax(0.42 * half_w, 380.0), t = -0.45 * half_h;
	size_t size = fmin(half_w, half_h) * 2.0 >= PARK_FROM_M ? 4 : 2;
	plan->park_s0 = line_near(plan->s.items, plan->s.count, s);
	plan->park_t0 = line_near(plan->t.items, plan->t.count, t);
	plan->park_s0 = plan->park_s0 > size / 2 ? plan->park_s0 - size / 2 : 0;
	plan->park_t0 = plan->park_t0 > size / 2 ? plan->park_t0 - size / 2 : 0;
	plan->park_s1 = plan->park_s0 + size;
	plan->park_t1 = plan->park_t0 + size - (size > 2);
	plan->park = plan->park_s1 < plan->s.count && plan->park_t1 < plan->south_quay && plan->park_s0 > 0;
	if (plan->park && size > 2)
		plan->t.items[plan->park_t0 + 1].rank = 2; /* dives under the park */
}

void plan_make(struct synth *synth)
{
	struct plan *plan = &synth->plan;
	double width = synth->options.width_m, height = synth->options.height_m, least = fmin(width, height);
	struct rng rng = synth_rng(synth, 0, 0);
	for (int i = 0; i < 6; i++)
		plan->phase[i] = rng_range(&rng, 0.0, 2.0 * BLVD_PI);
	plan->river = least >= RIVER_FROM_M;
	plan->railway = least >= RAILWAY_FROM_M;
	plan->river_half_m = plan->river ? fmin(24.0 + least / 90.0, 60.0) : 0.0;
	plan->quay_m = plan->river_half_m + 15.0;
	plan->phase[6] = plan->river ? fmin(0.05 * height, 170.0) : 0.0;
	plan->phase[7] = fmax(width * 0.21, 420.0);
	plan->old_town = least >= OLD_TOWN_FROM_M;
	plan->old_radius_m = fmax(fmin(0.15 * least, 310.0), fmin(105.0, 0.2 * least));
	plan->old_middle =
		(struct dvec2){ -0.06 * width, plan->river ? plan->quay_m + 0.62 * plan->old_radius_m : 0.1 * least };
	size_t capacity = 0, ranks_capacity = 0;
	double *lines = array_grow(NULL, &capacity, 4096, sizeof(double));
	int *ranks = array_grow(NULL, &ranks_capacity, 4096, sizeof(int));
	make_rows(synth, lines, ranks);
	make_columns(synth, lines, ranks);
	array_free(lines);
	array_free(ranks);
	plan->downtown = plan_place(plan, 0.10 * width, -(plan->quay_m + 0.17 * least));
	plan->downtown_radius_m = fmax(fmin(0.14 * least, 520.0), 90.0);
	place_park(synth);
}
