/* What a bake of the far field has to do: the chosen stretches, cut into units. */
#ifndef BLVD_TOOLS_FAR_PLAN_H
#define BLVD_TOOLS_FAR_PLAN_H

#include "tools/far/far.h"

struct far_plan {
	stretch_array stretches;    /* chosen, in order; whole edges */
	first_stretch_array first;  /* of edges, into them */
	ARRAY(uint32_t) unit_first; /* unit u is stretches unit_first[u] to unit_first[u + 1] - 1 */
	ARRAY(uint8_t) levels;      /* of stretches: cell_options_at_level() */
	uint32_t cut_count;         /* stretches of the whole city */
};

static inline uint32_t far_plan_units(const struct far_plan *plan)
{
	return (uint32_t)plan->unit_first.count - 1;
}

/* Cuts the streets and chooses. Units are the same whatever the choice, but for what is left out of them. Returns 0,
 * -EINVAL or -errno after logging one line. */
int far_plan_make(struct far_plan *plan, const struct pkg *pkg, const struct far_options *options);
void far_plan_finish(struct far_plan *plan);

/* tools/far/select_drive.c: marks edges that a recorded drive may need: those it runs along, and those within
 * SELECT_AHEAD_M of driving ahead. `edges` has one byte an edge. Returns 0 or -errno after logging one line. */
#define SELECT_AHEAD_M 250.0
int far_select_drive(const struct pkg *pkg, const char *log, uint8_t *edges);

#endif
