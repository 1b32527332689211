/*
 * Bakes the units of a plan by several processes: each has its own GL context, and what one of them does wrong cannot
 * harm the others. They take units from a common counter; the result does not depend on who took which.
 */
#ifndef BLVD_TOOLS_FAR_WORKERS_H
#define BLVD_TOOLS_FAR_WORKERS_H

#include "tools/far/plan.h"

struct far_work {
	const struct pkg *pkg;
	const struct pkg *old; /* an earlier package of the city, to take unchanged stretches from; NULL: none */
	const struct far_plan *plan;
	const struct cell_options *cells;
	const char *folder;
	const uint8_t *skip; /* units whose hash is known already; NULL: none */
	unsigned jobs;
	bool show_progress;
};
struct far_counts {
	uint64_t stretches, reused; /* done; of these, found already made */
	uint64_t bytes;             /* of the units */
	double visible_s;           /* processor time by step, of all workers */
	struct cell_times times;
};

/* `unit_hashes` has one entry a unit; those of skipped ones stay. Returns 0 or -errno after logging one line. */
int far_work_run(const struct far_work *work, uint64_t *unit_hashes, struct far_counts *counts);

#endif
