/* The river as a polygon between its banks and as a line, and the trees along the water. */
#include <math.h>

#include "tools/synth/synth.h"

#define STEP_M 30.0

void river_write(struct synth *synth)
{
	const struct plan *plan = &synth->plan;
	double reach = synth->options.width_m / 2.0 + 900.0;
	size_t steps = (size_t)ceil(2.0 * reach / STEP_M);
	struct polygon water = { 0 };
	if (!plan->river)
		return;
	water.outer.count = 2 * (steps + 1);
	water.outer.points = POOL_ARRAY(&synth->city.pool, struct dvec2, water.outer.count);
	node_array middle = { 0 };
	for (size_t i = 0; i <= steps; i++) {
		double s = -reach + 2.0 * reach * (double)i / (double)steps;
		double half = plan->river_half_m - 2.0 - 2.0 * sin(s / 170.0 + plan->phase[1]);
		water.outer.points[i] = plan_place(plan, s, -half);
		water.outer.points[2 * steps + 1 - i] = plan_place(plan, s, half);
		ARRAY_PUSH(&middle, osm_doc_node(synth->doc, plan_place(plan, s, 0.0)));
	}
	osm_doc_way(synth->doc, middle.items, middle.count);
	osm_doc_tag(synth->doc, "waterway", "river");
	osm_doc_tag(synth->doc, "name", "Aurel");
	osm_doc_tag_number(synth->doc, "width", 2.0 * plan->river_half_m - 4.0, 0);
	area_write(synth, &water, "natural", "water", "Aurel");
	osm_doc_tag(synth->doc, "water", "river");
	ARRAY_FINISH(&middle);
}
