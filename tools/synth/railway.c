/*
 * The railway: two tracks in the middle of their column, on the ground. Main streets pass over it (or under it), it
 * passes over the river and the quays on a bridge. It takes part in the street graph as a way that is not driven, so
 * that the heights of bridges know of it.
 */
#include <math.h>

#include "tools/synth/synth.h"

#define TRACK_M 4.4
#define STEP_M 20.0
#define BRIDGE_BEYOND_QUAY_M 18.0
#define STEPS_MAX 4000

static double rail_s(const struct plan *plan)
{
	return (plan->s.items[plan->rail_column].at + plan->s.items[plan->rail_column + 1].at) / 2.0;
}

static double bridge_half(const struct plan *plan)
{
	return plan->river ? plan->quay_m + BRIDGE_BEYOND_QUAY_M : 0.0;
}

static void add_piece(struct synth *synth, double from_t, double to_t, bool bridge, int64_t from_id, int64_t to_id)
{
	struct dvec2 points[STEPS_MAX + 1];
	size_t steps = (size_t)fmin(fmax(1.0, ceil((to_t - from_t) / STEP_M)), STEPS_MAX);
	for (size_t i = 0; i <= steps; i++) {
		points[i] =
			plan_place(&synth->plan, rail_s(&synth->plan), from_t + (to_t - from_t) * (double)i / (double)steps);
		ARRAY_PUSH(&synth->rail, points[i]);
	}
	struct street_kind kind = { WAY_RAIL, 4.0, 0, 0, .bridge = bridge };
	street_add(synth, &kind, NULL, points, steps + 1, from_id, to_id);
	synth->city.ways.items[synth->city.ways.count - 1].drivable = false;
}

void railway_plan(struct synth *synth)
{
	double reach = synth->options.height_m / 2.0 + 500.0, half = bridge_half(&synth->plan);
	int64_t id = INT64_C(1) << 43;
	if (half > 0.0) {
		add_piece(synth, -reach, -half, false, 0, id);
		add_piece(synth, -half, half, true, id, id + 1);
		add_piece(synth, half, reach, false, id + 1, 0);
	} else {
		add_piece(synth, -reach, reach, false, 0, 0);
	}
}

static void write_track(struct synth *synth, double aside, double from_t, double to_t, bool bridge, uint32_t *shared)
{
	const struct plan *plan = &synth->plan;
	node_array nodes = { 0 };
	size_t steps = (size_t)ceil((to_t - from_t) / STEP_M);
	for (size_t i = 0; i <= steps; i++) {
		double t = from_t + (to_t - from_t) * (double)i / (double)steps;
		if (!i && *shared)
			ARRAY_PUSH(&nodes, *shared);
		else
			ARRAY_PUSH(&nodes, osm_doc_node(synth->doc, plan_place(plan, rail_s(plan) + aside, t)));
	}
	*shared = nodes.items[nodes.count - 1];
	osm_doc_way(synth->doc, nodes.items, nodes.count);
	osm_doc_tag(synth->doc, "railway", "rail");
	osm_doc_tag(synth->doc, "gauge", "1435");
	osm_doc_tag(synth->doc, "electrified", "contact_line");
	if (bridge) {
		osm_doc_tag(synth->doc, "bridge", "yes");
		osm_doc_tag(synth->doc, "layer", "1");
	}
	ARRAY_FINISH(&nodes);
}

void railway_write(struct synth *synth)
{
	double reach = synth->options.height_m / 2.0 + 500.0, half = bridge_half(&synth->plan);
	if (!synth->plan.railway)
		return;
	for (int side = -1; side <= 1; side += 2) {
		uint32_t shared = 0;
		double aside = side * TRACK_M / 2.0;
		if (half > 0.0) {
			write_track(synth, aside, -reach, -half, false, &shared);
			write_track(synth, aside, -half, half, true, &shared);
			write_track(synth, aside, half, reach, false, &shared);
		} else {
			write_track(synth, aside, -reach, reach, false, &shared);
		}
	}
}
