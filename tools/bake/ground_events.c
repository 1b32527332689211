/* What the data says at points of a street, found again on the roads, and where drivers stop for it. */
#include <math.h>
#include <stdlib.h>

#include "tools/bake/ground.h"

#define SNAP_M 1.5
#define SAME_M 4.0           /* two crossings this near are one */
#define SAME_STOP_M 18.0     /* two signals or signs for the same drivers */
#define JUNCTION_NEAR_M 35.0 /* a signal this near to a junction is the junction's */
#define STOP_BEFORE_M 1.0
#define END_M 0.6 /* this near to an end is on it */

static int compare_events(const void *left, const void *right)
{
	const struct road_event *a = left, *b = right;
	if (a->road != b->road)
		return a->road < b->road ? -1 : 1;
	if (a->flags != b->flags)
		return a->flags < b->flags ? -1 : 1;
	return (a->along_m > b->along_m) - (a->along_m < b->along_m);
}

/* Where a road passes a place. */
struct pass {
	uint32_t road;
	double along_m, distance_m;
};
enum { PASSES_MAX = 16 };

/* Streets within SNAP_M of a place, each once. */
static size_t passes_at(const struct ground_plan *plan, struct dvec2 at, struct pass out[PASSES_MAX])
{
	struct bin_items near = bins_near(&plan->segment_bins, at);
	size_t count = 0;
	for (size_t i = 0; i < near.count; i++) {
		struct road_segment segment = plan->segments.items[near.entries[i].item];
		const struct road *road = &plan->roads.items[segment.road];
		struct dvec3 a = road->points[segment.point], b = road->points[segment.point + 1];
		struct dvec2 d = { b.x - a.x, b.y - a.y }, p = { at.x - a.x, at.y - a.y };
		double t = fmin(fmax(dvec2_dot(p, d) / fmax(dvec2_dot(d, d), 1e-9), 0.0), 1.0);
		struct pass pass = { segment.road, road->along[segment.point] + t * dvec2_length(d),
			dvec2_length(dvec2_sub(p, dvec2_scale(d, t))) };
		if (road->edge == PKG_NONE || road->course == ROAD_CUT || pass.distance_m > SNAP_M)
			continue;
		size_t k = 0;
		while (k < count && out[k].road != pass.road)
			k++;
		if (k == PASSES_MAX || (k < count && out[k].distance_m <= pass.distance_m))
			continue;
		out[k] = pass;
		count += k == count;
	}
	return count;
}

static bool starts_at_junction(const struct ground_plan *plan, const struct road *road)
{
	uint32_t node = plan->graph->halves[2 * road->edge].origin;
	return road->edge_start_m < 0.01 && plan->graph->nodes[node].out_count > 2;
}

static bool ends_at_junction(const struct ground_plan *plan, const struct road *road)
{
	uint32_t node = plan->graph->halves[2 * road->edge + 1].origin;
	double edge_m = plan->graph->edges[road->edge].length_mm / 1000.0;
	return road->edge_start_m + road_length(road) > edge_m - 0.05 && plan->graph->nodes[node].out_count > 2;
}

/* For whom a sign along the road stands: towards the junction next to it; at a crossing of its own for both. */
static void face_drivers(const struct ground_plan *plan, struct road_event *event)
{
	const struct road *road = &plan->roads.items[event->road];
	uint16_t flags = plan->graph->edges[road->edge].flags;
	double behind = event->along_m, ahead = road_length(road) - event->along_m;
	bool near_end = ends_at_junction(plan, road) && ahead < JUNCTION_NEAR_M;
	bool near_start = starts_at_junction(plan, road) && behind < JUNCTION_NEAR_M;
	if (near_end && near_start)
		*(ahead < behind ? &near_start : &near_end) = false;
	event->forward = flags & PKG_EDGE_FORWARD && !near_start;
	event->backward = flags & PKG_EDGE_BACKWARD && !near_end;
}

static void add_pass(struct ground_plan *plan, const struct pass *pass, uint32_t flag)
{
	const struct road *road = &plan->roads.items[pass->road];
	struct road_event event = { .road = pass->road, .along_m = pass->along_m, .flags = flag };
	bool at_start = pass->along_m<END_M, at_end = pass->along_m> road_length(road) - END_M;
	/* On the junction itself: the junction's arms are looked at one by one. */
	if ((at_start && starts_at_junction(plan, road)) || (at_end && ends_at_junction(plan, road)))
		return;
	face_drivers(plan, &event);
	/* At a joint of two edges each has the drivers that arrive on it. */
	event.forward = event.forward && !at_start;
	event.backward = event.backward && !at_end;
	ARRAY_PUSH(&plan->events, event);
}

/* Of the street nearest to a place, and of all that end there. */
static void add_event(struct ground_plan *plan, struct dvec2 at, uint32_t flag)
{
	struct pass passes[PASSES_MAX];
	size_t count = passes_at(plan, at, passes), nearest = 0;
	for (size_t i = 1; i < count; i++)
		if (passes[i].distance_m < passes[nearest].distance_m)
			nearest = i;
	for (size_t i = 0; i < count; i++) {
		double length = road_length(&plan->roads.items[passes[i].road]);
		bool ends = passes[i].distance_m < 0.3 && (passes[i].along_m < END_M || passes[i].along_m > length - END_M);
		if (i == nearest || ends)
			add_pass(plan, &passes[i], flag);
	}
}

static void add_way_events(struct ground_plan *plan, const struct way *way)
{
	static const uint32_t kinds[] = { PKG_NODE_CROSSING, PKG_NODE_SIGNALS, PKG_NODE_STOP, PKG_NODE_GIVE_WAY };
	for (size_t i = 0; way->drivable && i < way->node_count; i++)
		for (size_t k = 0; k < sizeof(kinds) / sizeof(*kinds); k++)
			if (way->nodes[i].flags & kinds[k])
				add_event(plan, way->nodes[i].at, kinds[k]);
}

/* A junction's own signals and signs hold for every street that arrives. */
static void add_junction_events(struct ground_plan *plan, uint32_t index)
{
	const struct road *road = &plan->roads.items[index];
	if (road->edge == PKG_NONE)
		return;
	const uint32_t kinds = PKG_NODE_SIGNALS | PKG_NODE_STOP | PKG_NODE_GIVE_WAY;
	uint16_t flags = plan->graph->edges[road->edge].flags;
	for (int end = 0; end < 2; end++) {
		bool here = end ? ends_at_junction(plan, road) : starts_at_junction(plan, road);
		uint32_t node = plan->graph->halves[2 * road->edge + (uint32_t)end].origin;
		uint32_t found = plan->graph->nodes[node].flags & kinds;
		if (!here || !found || !(flags & (end ? PKG_EDGE_FORWARD : PKG_EDGE_BACKWARD)))
			continue;
		if (found & PKG_NODE_SIGNALS)
			found = PKG_NODE_SIGNALS;
		else if (found & PKG_NODE_STOP)
			found = PKG_NODE_STOP;
		struct road_event event = { .road = index, .flags = found, .forward = end, .backward = !end };
		double from, to;
		ground_own_stretch(plan, road, &from, &to);
		event.along_m = end ? to : from;
		ARRAY_PUSH(&plan->events, event);
	}
}

static void drop_doubles(struct ground_plan *plan)
{
	size_t kept = 0;
	for (size_t i = 0; i < plan->events.count; i++) {
		struct road_event *event = &plan->events.items[i], *last = kept ? &plan->events.items[kept - 1] : NULL;
		if (last && last->road == event->road && last->flags == event->flags &&
			event->along_m - last->along_m < (event->flags == PKG_NODE_CROSSING ? SAME_M : SAME_STOP_M)) {
			/* who comes later in their direction stops at the first of both */
			if (event->forward && !event->backward && !last->forward)
				last->along_m = event->along_m;
			last->forward |= event->forward;
			last->backward |= event->backward;
			continue;
		}
		plan->events.items[kept++] = *event;
	}
	plan->events.count = kept;
}

void ground_events_build(struct ground_plan *plan)
{
	for (size_t i = 0; i < plan->city->ways.count; i++)
		add_way_events(plan, &plan->city->ways.items[i]);
	for (uint32_t i = 0; i < plan->roads.count; i++)
		add_junction_events(plan, i);
	if (plan->events.count)
		qsort(plan->events.items, plan->events.count, sizeof(*plan->events.items), compare_events);
	drop_doubles(plan);
}

struct road_events ground_events_of(const struct ground_plan *plan, uint32_t road)
{
	size_t low = 0, high = plan->events.count;
	while (low < high) {
		size_t mid = (low + high) / 2;
		if (plan->events.items[mid].road < road)
			low = mid + 1;
		else
			high = mid;
	}
	size_t end = low;
	while (end < plan->events.count && plan->events.items[end].road == road)
		end++;
	return (struct road_events){ plan->events.items + low, end - low };
}

void ground_own_stretch(const struct ground_plan *plan, const struct road *road, double *from, double *to)
{
	*from = 0.0;
	*to = road_length(road);
	if (road->edge == PKG_NONE)
		return;
	if (road->edge_start_m < 0.01)
		*from = plan->half_trim_m[2 * road->edge];
	if (road->edge_start_m + *to > plan->graph->edges[road->edge].length_mm / 1000.0 - 0.05)
		*to -= plan->half_trim_m[2 * road->edge + 1];
}

double ground_stop_place(const struct ground_plan *plan, uint32_t road, double along_m, bool forward)
{
	double sign = forward ? -1.0 : 1.0, place = along_m + sign * STOP_BEFORE_M, from, to;
	ground_own_stretch(plan, &plan->roads.items[road], &from, &to);
	place = forward ? fmin(place, to - 0.4) : fmax(place, from + 0.4);
	struct road_events events = ground_events_of(plan, road);
	for (size_t i = 0; i < events.count; i++) {
		if (events.items[i].flags != PKG_NODE_CROSSING || fabs(events.items[i].along_m - along_m) > 12.0)
			continue;
		double before = events.items[i].along_m + sign * (CROSSING_HALF_M + 1.2);
		place = forward ? fmin(place, before) : fmax(place, before);
	}
	return place;
}
