/*
 * Heights of all ways. On flat data every bridge is a line on the ground: what tells its height is what it crosses. So
 * each crossing of two levels asks for clearance, the upper is lifted (or a tunnel is lowered), ramps run on into the
 * streets on both sides, and since a ramp may lift the lower street too, that is repeated a few times. Bridges over
 * water bulge a little; tunnels lie under the ground away from their portals.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/city/graph_heights.h"

#define ROUNDS_MAX 6
#define STEP_M 8.0   /* between points of bridges, tunnels and ramps */
#define CAMBER_M 1.5 /* of a long bridge over water */
#define CAMBER_GRADE 0.05
#define PORTAL_M 25.0  /* a tunnel is under the ground this far behind its portal */
#define SHALLOW_M 40.0 /* unless all of it is nearer to a portal than this */
#define RAIL_CLEARANCE_M 5.5
#define FOOT_CLEARANCE_M 2.5
#define GRADE_RAIL 0.035
#define GRADE_FOOT 0.12
#define GRADE_GARAGE 0.14
#define STEEPER 1.6 /* than wanted, to end before a junction */
#define SLACK_M 0.01

static const struct way *way_of(const struct net *net, uint32_t segment)
{
	return &net->city->ways.items[net->segments.items[segment].way];
}

static double grade_of(const struct way *way)
{
	if (way->street_class < PKG_STREET_CLASS_COUNT)
		return way->street_class >= PKG_STREET_SERVICE ? GRADE_GARAGE : GRAPH_GRADE;
	return way->street_class == WAY_RAIL || way->street_class == WAY_TRAM ? GRADE_RAIL : GRADE_FOOT;
}

/* To end before a junction. */
static double steepest_of(const struct way *way)
{
	return fmin(STEEPER * grade_of(way), fmax(grade_of(way), GRADE_GARAGE));
}

static double clearance_of(const struct way *way)
{
	if (way->street_class < PKG_STREET_CLASS_COUNT)
		return GRAPH_CLEARANCE_M;
	return way->street_class == WAY_RAIL || way->street_class == WAY_TRAM ? RAIL_CLEARANCE_M : FOOT_CLEARANCE_M;
}

/* Which of the two makes room; PKG_NONE: neither. */
static uint32_t mover(const struct heights *heights, const struct net_crossing *c)
{
	const struct net_segment *upper = &heights->net->segments.items[c->upper];
	const struct net_segment *lower = &heights->net->segments.items[c->lower];
	const struct way *over = way_of(heights->net, c->upper), *under = way_of(heights->net, c->lower);
	bool streets = heights->kind == NET_DRIVABLE;
	bool foot_under = clearance_of(under) == FOOT_CLEARANCE_M;
	if (lower->shallow && lower->drivable && !upper->drivable) /* the railway is on an embankment */
		return streets || over->street_class != WAY_RAIL ? PKG_NONE : c->upper;
	bool lower_sinks = lower->level < 0 && (under->tunnel || !over->bridge) && lower->drivable == streets;
	if (lower_sinks && !(upper->level > 0 && over->bridge && !under->tunnel))
		return c->lower;
	if (upper->level > 0 && upper->drivable == streets && !(streets && foot_under))
		return c->upper;
	return PKG_NONE;
}

static double height_on(const struct heights *heights, uint32_t segment, double t)
{
	const struct net_segment *s = &heights->net->segments.items[segment];
	bool own = s->drivable == (heights->kind == NET_DRIVABLE);
	double a = own ? heights_at(heights, s->a) : heights->net->vertices.items[s->a].z;
	double b = own ? heights_at(heights, s->b) : heights->net->vertices.items[s->b].z;
	return a + t * (b - a);
}

static double missing_room(const struct heights *heights, const struct net_crossing *c)
{
	double thick = way_of(heights->net, c->lower)->tunnel ? GRAPH_COVER_M : GRAPH_DECK_M;
	double needed = clearance_of(way_of(heights->net, c->lower)) + thick;
	return needed - (height_on(heights, c->upper, c->upper_t) - height_on(heights, c->lower, c->lower_t));
}

static void make_room(struct heights *heights, const struct net_crossing *c, uint32_t moves, double missing)
{
	bool up = moves == c->upper;
	const struct net_segment *s = &heights->net->segments.items[moves];
	const double *so_far = up ? heights->up : heights->down;
	double t = up ? c->upper_t : c->lower_t;
	double now = so_far[s->a] + t * (so_far[s->b] - so_far[s->a]);
	double other_width = way_of(heights->net, up ? c->lower : c->upper)->width_m;
	ramp_add(heights, &(struct ramp){
						  .segment = moves,
						  .t = t,
						  .height_m = up ? now + missing : now - missing,
						  .flat_m = STEP_M + 1.0 + fmin(other_width, 30.0) / 2.0,
						  .grade = grade_of(way_of(heights->net, moves)),
						  .steepest = steepest_of(way_of(heights->net, moves)),
					  });
}

static void settle_crossings(struct heights *heights, const crossing_array *crossings, bool count_faults)
{
	size_t capacity = 0;
	bool *moved = array_grow(NULL, &capacity, crossings->count + 1, sizeof(bool));
	memset(moved, 0, (crossings->count + 1) * sizeof(bool));
	bool again = true;
	for (int round = 0; again && round < ROUNDS_MAX; round++) {
		again = false;
		for (size_t i = 0; i < crossings->count; i++) {
			const struct net_crossing *c = &crossings->items[i];
			uint32_t moves = mover(heights, c);
			double missing = moves == PKG_NONE ? 0.0 : missing_room(heights, c);
			if (missing <= SLACK_M)
				continue;
			make_room(heights, c, moves, missing);
			again = moved[i] = true;
		}
	}
	for (size_t i = 0; count_faults && i < crossings->count; i++) {
		if (!moved[i])
			continue;
		bool mended = missing_room(heights, &crossings->items[i]) <= 10.0 * SLACK_M;
		report_fault(heights->net->city->report, FAULT_BRIDGE_PROFILE, mended ? FAULT_MENDED : FAULT_DROPPED,
			way_of(heights->net, crossings->items[i].upper)->id);
	}
	array_free(moved);
}

/* Tunnels under the ground, decks over it. */
static void settle_structures(struct heights *heights)
{
	for (uint32_t i = 0; i < heights->net->segments.count; i++) {
		const struct net_segment *s = &heights->net->segments.items[i];
		const struct way *way = way_of(heights->net, i);
		if (s->drivable != (heights->kind == NET_DRIVABLE) || !(way->bridge || way->tunnel))
			continue;
		double surface = heights_at(heights, s->b), ground = heights->ground[s->b];
		struct ramp ramp = {
			.segment = i, .t = 1.0, .flat_m = STEP_M, .grade = grade_of(way), .steepest = steepest_of(way)
		};
		if (way->tunnel && !s->shallow && heights->portal[s->b] >= PORTAL_M) {
			double missing = surface - (ground - clearance_of(way) - GRAPH_COVER_M);
			ramp.height_m = heights->down[s->b] - fmax(missing, 0.0);
			if (missing > SLACK_M)
				ramp_add(heights, &ramp);
		} else if (way->bridge && surface < ground - SLACK_M) {
			ramp.height_m = heights->up[s->b] + ground - surface;
			ramp_add(heights, &ramp);
		}
	}
}

static bool over_water(const struct net *net, uint32_t vertex)
{
	const struct net_vertex *v = &net->vertices.items[vertex];
	struct dvec2 at = { v->x / 1000.0, v->y / 1000.0 };
	for (size_t i = 0; i < net->city->areas.count; i++) {
		const struct area *area = &net->city->areas.items[i];
		if (area->kind == AREA_WATER && polygon_contains(&area->shape, at))
			return true;
	}
	return false;
}

/* From the vertices in the queue along bridges, or along tunnels. */
static void spread_flag(const struct heights *heights, bool bridges, index_array *queue, bool *flag)
{
	for (size_t i = 0; i < queue->count; i++) {
		uint32_t vertex = queue->items[i];
		for (uint32_t k = heights->stars.first[vertex]; k < heights->stars.first[vertex + 1]; k++) {
			const struct net_segment *s = &heights->net->segments.items[heights->stars.segments[k]];
			uint32_t other = s->a == vertex ? s->b : s->a;
			const struct way *way = way_of(heights->net, heights->stars.segments[k]);
			if (!(bridges ? way->bridge : way->tunnel) || flag[other])
				continue;
			flag[other] = true;
			ARRAY_PUSH(queue, other);
		}
	}
}

static void bulge_over_water(struct heights *heights)
{
	size_t capacity = 0, count = heights->net->vertices.count;
	bool *wet = array_grow(NULL, &capacity, count + 1, sizeof(bool));
	memset(wet, 0, (count + 1) * sizeof(bool));
	index_array queue = { 0 };
	for (uint32_t i = 0; i < heights->net->segments.count; i++) {
		const struct net_segment *s = &heights->net->segments.items[i];
		if (s->drivable != (heights->kind == NET_DRIVABLE) || !way_of(heights->net, i)->bridge || wet[s->b])
			continue;
		if (heights->portal[s->b] > 0.0 && heights->portal[s->b] < HUGE_VAL && over_water(heights->net, s->b)) {
			wet[s->b] = true;
			ARRAY_PUSH(&queue, s->b);
		}
	}
	spread_flag(heights, true, &queue, wet);
	for (uint32_t v = 0; v < count; v++) {
		if (!wet[v] || !(heights->portal[v] < HUGE_VAL))
			continue;
		double bulge = CAMBER_M * ease(heights->portal[v] / (EASE_STEEPEST * CAMBER_M / CAMBER_GRADE));
		heights->up[v] = fmax(heights->up[v], bulge);
	}
	ARRAY_FINISH(&queue);
	array_free(wet);
}

static void find_shallow(struct heights *heights)
{
	size_t capacity = 0, count = heights->net->vertices.count;
	bool *deep = array_grow(NULL, &capacity, count + 1, sizeof(bool));
	memset(deep, 0, (count + 1) * sizeof(bool));
	index_array queue = { 0 };
	for (uint32_t v = 0; v < count; v++) {
		if (heights->portal[v] < SHALLOW_M)
			continue;
		deep[v] = true;
		ARRAY_PUSH(&queue, v);
	}
	spread_flag(heights, false, &queue, deep);
	for (uint32_t i = 0; i < heights->net->segments.count; i++) {
		struct net_segment *s = &heights->net->segments.items[i];
		if (s->drivable == (heights->kind == NET_DRIVABLE))
			s->shallow = way_of(heights->net, i)->tunnel && !deep[s->a] && !deep[s->b];
	}
	ARRAY_FINISH(&queue);
	array_free(deep);
}

static void solve(struct heights *heights, const crossing_array *crossings, bool count_faults)
{
	decks_lay(heights);
	find_shallow(heights);
	bulge_over_water(heights);
	settle_structures(heights);
	settle_crossings(heights, crossings, count_faults);
}

static void solve_streets(struct heights *heights, struct net *net, const crossing_array *crossings, bool count_faults)
{
	heights_init(heights, net, NET_DRIVABLE);
	for (size_t v = 0; v < net->vertices.count; v++)
		net->vertices.items[v].z = heights->ground[v];
	solve(heights, crossings, count_faults);
	for (uint32_t v = 0; v < net->vertices.count; v++)
		net->vertices.items[v].z = heights_at(heights, v);
}

/* Other ways hang on the streets where they share a node; where a street is on a ramp, they ramp up to it. */
static void solve_others(struct heights *heights, struct net *net, const crossing_array *crossings, bool count_faults)
{
	struct net_stars streets;
	heights_init(heights, net, NET_OTHER);
	net_stars_init(&streets, net, NET_DRIVABLE);
	for (uint32_t v = 0; v < net->vertices.count; v++) {
		heights->pinned[v] = streets.first[v + 1] > streets.first[v];
		if (heights->pinned[v])
			heights->base[v] = net->vertices.items[v].z;
	}
	net_stars_finish(&streets);
	solve(heights, crossings, count_faults);
	for (uint32_t v = 0; v < net->vertices.count; v++)
		net->vertices.items[v].z = heights_at(heights, v);
}

void profile_solve(struct net *net, const crossing_array *crossings, bool count_faults)
{
	struct heights heights;
	solve_streets(&heights, net, crossings, count_faults);
	heights_finish(&heights);
	solve_others(&heights, net, crossings, count_faults);
	heights_finish(&heights);
}

static double bend(const struct net *net, struct line_mm line, double from, double to, double at)
{
	double x0 = line.ax, y0 = line.ay, dx = (double)line.bx - x0, dy = (double)line.by - y0;
	double from_z = city_ground(net->city, (struct dvec2){ (x0 + from * dx) / 1000.0, (y0 + from * dy) / 1000.0 });
	double to_z = city_ground(net->city, (struct dvec2){ (x0 + to * dx) / 1000.0, (y0 + to * dy) / 1000.0 });
	double at_z = city_ground(net->city, (struct dvec2){ (x0 + at * dx) / 1000.0, (y0 + at * dy) / 1000.0 });
	return fabs(at_z - (from_z + (to_z - from_z) * (at - from) / (to - from)));
}

static void cut_at(struct net *net, uint32_t segment, double t, cut_array *cuts)
{
	struct line_mm line = net_line(net, &net->segments.items[segment]);
	uint32_t vertex = net_vertex_add(net, 0, (int32_t)lround(line.ax + t * ((double)line.bx - line.ax)),
		(int32_t)lround(line.ay + t * ((double)line.by - line.ay)));
	ARRAY_PUSH(cuts, (struct net_cut){ segment, vertex });
}

/* Halves a stretch until the ground between its ends is straight. */
static void follow_ground(struct net *net, uint32_t segment, double from, double to, double length_m, cut_array *cuts)
{
	struct line_mm line = net_line(net, &net->segments.items[segment]);
	double worst = 0.0;
	for (int i = 1; i < 4; i++)
		worst = fmax(worst, bend(net, line, from, to, from + (to - from) * i / 4.0));
	if (length_m < STEP_M / 2.0 || worst <= GRAPH_GROUND_TOLERANCE_M)
		return;
	double middle = (from + to) / 2.0;
	cut_at(net, segment, middle, cuts);
	follow_ground(net, segment, from, middle, length_m / 2.0, cuts);
	follow_ground(net, segment, middle, to, length_m / 2.0, cuts);
}

static void cut_evenly(struct net *net, uint32_t segment, double length_m, cut_array *cuts)
{
	int pieces = (int)fmin(ceil(length_m / STEP_M), 10000.0);
	for (int i = 1; i < pieces; i++)
		cut_at(net, segment, (double)i / pieces, cuts);
}

void profile_refine(struct net *net)
{
	crossing_array crossings = { 0 };
	cut_array cuts = { 0 };
	struct heights streets, others;
	planar_levels(net, &crossings);
	solve_streets(&streets, net, &crossings, false);
	solve_others(&others, net, &crossings, false);
	bool flat = net->city->terrain.grid.columns < 2;
	for (uint32_t i = 0; i < net->segments.count; i++) {
		const struct way *way = way_of(net, i);
		double length = net_length(net, &net->segments.items[i]);
		if (way->bridge || way->tunnel || streets.on_ramp[i] || others.on_ramp[i])
			cut_evenly(net, i, length, &cuts);
		else if (!flat && net->segments.items[i].drivable)
			follow_ground(net, i, 0.0, 1.0, length, &cuts);
	}
	heights_finish(&streets);
	heights_finish(&others);
	net_apply_cuts(net, &cuts);
	ARRAY_FINISH(&cuts);
	ARRAY_FINISH(&crossings);
}

static bool leaves_ground(const struct net *net, const struct net_vertex *at)
{
	return fabs(at->z - city_ground(net->city, (struct dvec2){ at->x / 1000.0, at->y / 1000.0 })) >
		   GRAPH_GROUND_TOLERANCE_M;
}

/* Replaces a way's nodes by the finer ones of its segments. */
static void rewrite_way(struct net *net, struct way *way, size_t first, size_t count)
{
	struct way_node *nodes = POOL_ARRAY(&net->city->pool, struct way_node, count + 1);
	double *z_m = POOL_ARRAY(&net->city->pool, double, count + 1);
	for (size_t i = 0; i <= count; i++) {
		const struct net_segment *s = &net->segments.items[first + (i < count ? i : count - 1)];
		uint32_t vertex = i < count ? s->a : s->b;
		const struct net_vertex *at = &net->vertices.items[vertex];
		int64_t id = at->id ? at->id : -(INT64_C(1) << 48) - (int64_t)vertex;
		nodes[i] = (struct way_node){ id, { at->x / 1000.0, at->y / 1000.0 }, at->flags };
		z_m[i] = at->z;
	}
	way->nodes = nodes;
	way->node_count = count + 1;
	way->z_m = z_m;
}

void profile_other_ways(struct net *net)
{
	for (size_t first = 0, end; first < net->segments.count; first = end) {
		const struct net_segment *s = &net->segments.items[first];
		bool off_ground = leaves_ground(net, &net->vertices.items[s->a]), whole = true;
		for (end = first; end < net->segments.count && net->segments.items[end].way == s->way; end++) {
			const struct net_segment *piece = &net->segments.items[end];
			off_ground |= leaves_ground(net, &net->vertices.items[piece->b]);
			whole &= end == first || net->segments.items[end - 1].b == piece->a;
		}
		if (!s->drivable && off_ground && whole)
			rewrite_way(net, &net->city->ways.items[s->way], first, end - first);
	}
}
