/* Dijkstra's search with metres as cost, over stretches; a few dozen steps a call, no memory but the stack. */
#include "nav/likely.h"

#include "assets/cells.h"

#define FRONTIER_MAX 64
#define STEPS_MAX 256
#define BEHIND_WEIGHT 3.0       /* a metre behind the car is worth as much as this many ahead */
#define BEHIND_M 30.0           /* and first of all the car has to turn back */
#define OFF_ROUTE_M 60.0        /* a turn that the route does not take */
#define STRAIGHT_BAM 0x15555555 /* 30 degrees: not a turn */
#define SHARP_BAM 0x55555555    /* 120 degrees */
#define TURN_M 20.0
#define SHARP_M 40.0
#define LAMP_M 40.0 /* a turn that the lamps do not tell */
#define ILLEGAL_M 100.0
#define STREETS_NEAR 4 /* off the street: so many of the nearest are starts */
#define STREETS_RADIUS_M 300.0
#define STANDING_MPS 0.3

/* A stretch about to be reached: where the walk goes on from. */
struct step {
	uint32_t half;             /* in the direction of the walk */
	uint32_t stretch;          /* on its edge; PKG_NONE: the edge has none */
	double distance_m, cost_m; /* to where the walk enters it */
	double length_m;           /* from there to where it leaves it */
	double weight;
	uint32_t route_at; /* index of `half` in the view's route, PKG_NONE: not on it */
};

struct walk {
	const struct graph *graph;
	const struct pkg *pkg;
	const struct nav_view *view;
	double horizon_m;
	struct step frontier[FRONTIER_MAX];
	uint32_t frontier_count;
	uint32_t *out, count;
};

static bool is_found(const struct walk *walk, uint32_t stretch)
{
	for (uint32_t i = 0; i < walk->count; i++)
		if (walk->out[i] == stretch)
			return true;
	return false;
}

static void find(struct walk *walk, uint32_t stretch)
{
	if (stretch != PKG_NONE && walk->count < NAV_LIKELY_MAX && !is_found(walk, stretch))
		walk->out[walk->count++] = stretch;
}

static void push(struct walk *walk, const struct step *step)
{
	if (step->distance_m > walk->horizon_m || (step->stretch != PKG_NONE && is_found(walk, step->stretch)))
		return;
	if (walk->frontier_count < FRONTIER_MAX)
		walk->frontier[walk->frontier_count++] = *step;
}

/* Equal costs: the one pushed first, so that the order does not depend on the walk's own bookkeeping. */
static struct step pop(struct walk *walk)
{
	uint32_t best = 0;
	for (uint32_t i = 1; i < walk->frontier_count; i++)
		if (walk->frontier[i].cost_m < walk->frontier[best].cost_m)
			best = i;
	struct step step = walk->frontier[best];
	walk->frontier_count--;
	for (uint32_t i = best; i < walk->frontier_count; i++)
		walk->frontier[i] = walk->frontier[i + 1];
	return step;
}

static uint32_t first_stretch(const struct pkg *pkg, uint32_t half)
{
	uint32_t first = pkg->first_stretch[half >> 1], end = pkg->first_stretch[(half >> 1) + 1];
	return first == end ? PKG_NONE : half & 1 ? end - 1 : first;
}

/* Metres along a half-edge to the end of one of its stretches. */
static double stretch_end_m(const struct walk *walk, uint32_t half, uint32_t stretch)
{
	double length = graph_length_m(walk->graph, half);
	if (stretch == PKG_NONE)
		return length;
	const struct pkg_stretch *s = &walk->pkg->stretches[stretch];
	return half & 1 ? length - s->from_mm * 1e-3 : s->to_mm * 1e-3;
}

static double turn_cost_m(const struct walk *walk, const struct step *from, uint32_t to, double distance_m)
{
	const struct nav_view *view = walk->view;
	int32_t turn = graph_turn_bam(walk->graph, from->half, to);
	bool left = turn<-STRAIGHT_BAM, right = turn> STRAIGHT_BAM;
	double cost = turn < -SHARP_BAM || turn > SHARP_BAM ? SHARP_M : left || right ? TURN_M : 0.0;
	if (!graph_drivable(walk->graph, to) || graph_turn_forbidden(walk->graph, from->half, to))
		cost += ILLEGAL_M;
	bool lamp = view->turn_lamp == NAV_TURN_LAMP_LEFT || view->turn_lamp == NAV_TURN_LAMP_RIGHT;
	bool told = view->turn_lamp == NAV_TURN_LAMP_LEFT ? left : right;
	if (lamp && distance_m < LIKELY_HORIZON_M)
		cost = told ? 0.0 : cost + LAMP_M;
	return cost;
}

static uint32_t next_on_route(const struct nav_view *view, const struct step *from, uint32_t to)
{
	if (from->route_at == PKG_NONE || from->route_at + 1 >= view->route_count)
		return PKG_NONE;
	return view->route[from->route_at + 1] == to ? from->route_at + 1 : PKG_NONE;
}

/* Out of a half-edge's end. Back the way it came there is nothing new. */
static void turn_off(struct walk *walk, const struct step *from)
{
	uint32_t ways[GRAPH_SUCCESSORS_MAX];
	uint32_t count = graph_successors(walk->graph, from->half, GRAPH_PHYSICAL, ways);
	double distance_m = from->distance_m + from->length_m;
	for (uint32_t i = 0; i < count; i++) {
		if (ways[i] == graph_twin(from->half))
			continue;
		struct step next = { .half = ways[i],
			.stretch = first_stretch(walk->pkg, ways[i]),
			.distance_m = distance_m,
			.weight = from->weight,
			.route_at = next_on_route(walk->view, from, ways[i]) };
		bool leaves_route = from->route_at != PKG_NONE && next.route_at == PKG_NONE;
		bool follows_route = next.route_at != PKG_NONE;
		next.length_m = stretch_end_m(walk, next.half, next.stretch);
		next.cost_m = from->cost_m + from->weight * from->length_m + (leaves_route ? OFF_ROUTE_M : 0.0);
		if (!follows_route)
			next.cost_m += turn_cost_m(walk, from, ways[i], distance_m);
		push(walk, &next);
	}
}

static void go_on(struct walk *walk, const struct step *from)
{
	uint32_t edge = from->half >> 1, beyond = from->stretch + (from->half & 1 ? UINT32_MAX : 1u);
	bool more = from->stretch != PKG_NONE && (from->half & 1 ? from->stretch > walk->pkg->first_stretch[edge]
															 : beyond < walk->pkg->first_stretch[edge + 1]);
	if (!more) {
		turn_off(walk, from);
		return;
	}
	struct step next = *from;
	next.stretch = beyond;
	next.distance_m += from->length_m;
	next.cost_m += from->weight * from->length_m;
	next.length_m = stretch_end_m(walk, next.half, next.stretch) - stretch_end_m(walk, from->half, from->stretch);
	push(walk, &next);
}

static void run(struct walk *walk)
{
	for (int steps = 0; steps < STEPS_MAX && walk->frontier_count && walk->count < NAV_LIKELY_MAX; steps++) {
		struct step step = pop(walk);
		if (step.stretch != PKG_NONE && is_found(walk, step.stretch))
			continue;
		find(walk, step.stretch);
		go_on(walk, &step);
	}
}

/* From a place on a half-edge, one way. */
static void set_off(struct walk *walk, uint32_t half, double along_m, double cost_m, double weight)
{
	double from_start = half & 1 ? graph_length_m(walk->graph, half) - along_m : along_m;
	const struct nav_view *view = walk->view;
	bool on_route = view->routed && !view->off_route && view->route_count && view->route[0] == half;
	struct step start = { .half = half,
		.stretch = cells_stretch_at(walk->pkg, half >> 1, (int64_t)(from_start * 1e3)),
		.cost_m = cost_m,
		.weight = weight,
		.route_at = on_route ? 0 : PKG_NONE };
	start.length_m = fmax(stretch_end_m(walk, half, start.stretch) - along_m, 0.0);
	find(walk, start.stretch);
	go_on(walk, &start);
}

static void set_off_both_ways(struct walk *walk, uint32_t half, double along_m, double cost_m, double behind_weight)
{
	double behind_m = behind_weight > 1.0 ? BEHIND_M : 0.0;
	set_off(walk, half, along_m, cost_m, 1.0);
	set_off(walk, graph_twin(half), graph_length_m(walk->graph, half) - along_m, cost_m + behind_m, behind_weight);
}

/* Along the half-edge that the car is said to be on, or against it: in a turn back, and in reverse. */
static bool goes_against(const struct walk *walk)
{
	const struct nav_view *view = walk->view;
	double heading = graph_at(walk->graph, view->half, view->along_m).heading_rad;
	int32_t off = bam_diff(view->heading_bam, bam_from_rad(heading));
	bool turned = off > 0x40000000 || off < -0x40000000;
	bool reverse =
		view->speed_mps < -STANDING_MPS || (view->gear == NAV_GEAR_REVERSE && view->speed_mps < STANDING_MPS);
	return turned != reverse;
}

static void start_on_street(struct walk *walk)
{
	const struct nav_view *view = walk->view;
	uint32_t half = view->half;
	double along = view->along_m;
	if (goes_against(walk)) {
		along = graph_length_m(walk->graph, half) - along;
		half = graph_twin(half);
	}
	set_off_both_ways(walk, half, along, 0.0, BEHIND_WEIGHT);
}

static void start_off_street(struct walk *walk)
{
	struct dvec2 at = { (double)walk->view->pos_mm[0] * 1e-3, (double)walk->view->pos_mm[1] * 1e-3 };
	struct graph_hit hits[STREETS_NEAR];
	uint32_t count = 0;
	for (double radius = STREETS_RADIUS_M / 9.0; !count && radius <= STREETS_RADIUS_M; radius *= 3.0)
		count = graph_nearest(walk->graph, at, radius, hits, STREETS_NEAR);
	for (uint32_t i = 0; i < count; i++)
		set_off_both_ways(walk, hits[i].edge * 2, hits[i].along_m, hits[i].distance_m, 1.0);
}

uint32_t likely_stretches(
	const struct graph *graph, const struct pkg *pkg, const struct nav_view *view, uint32_t out[static NAV_LIKELY_MAX])
{
	if (!pkg->stretches || !view->located)
		return 0;
	struct walk walk = { .graph = graph, .pkg = pkg, .view = view, .out = out };
	walk.horizon_m = fmax(LIKELY_HORIZON_M, LIKELY_HORIZON_S * fabs(view->speed_mps));
	if (view->on_street && view->half < graph->net->half_count)
		start_on_street(&walk);
	else
		start_off_street(&walk);
	run(&walk);
	return walk.count;
}
