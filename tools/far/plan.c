#include "tools/far/plan.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/far/unit.h"

void far_plan_finish(struct far_plan *plan)
{
	ARRAY_FINISH(&plan->stretches);
	ARRAY_FINISH(&plan->first);
	ARRAY_FINISH(&plan->unit_first);
	ARRAY_FINISH(&plan->levels);
}

static void select_range(const stretch_array *all, unsigned long from, unsigned long to, uint8_t *edges)
{
	for (size_t i = from; i <= to && i < all->count; i++)
		edges[all->items[i].edge] = 1;
}

static int select_edges(const struct pkg *pkg, const stretch_array *all, const char *selection, uint8_t *edges)
{
	unsigned long from, to;
	char extra;
	if (!selection || !strcmp(selection, "all")) {
		memset(edges, 1, pkg->graph.edge_count);
		return 0;
	}
	if (sscanf(selection, "%lu-%lu%c", &from, &to, &extra) == 2) {
		if (from > to || from >= all->count) {
			log_error("the city has the stretches 0 to %zu, not %s", all->count - 1, selection);
			return -EINVAL;
		}
		select_range(all, from, to, edges);
		return 0;
	}
	return far_select_drive(pkg, selection, edges);
}

static void keep_selected(struct far_plan *plan, const uint8_t *edges)
{
	uint32_t kept = 0, edge_count = (uint32_t)plan->first.count - 1, unit = UINT32_MAX;
	for (uint32_t edge = 0; edge < edge_count; edge++) {
		uint32_t from = plan->first.items[edge], to = plan->first.items[edge + 1];
		plan->first.items[edge] = kept;
		for (uint32_t i = from; i < to && edges[edge]; i++) {
			if (i / UNIT_STRETCHES != unit)
				ARRAY_PUSH(&plan->unit_first, kept);
			unit = i / UNIT_STRETCHES;
			plan->stretches.items[kept++] = plan->stretches.items[i];
		}
	}
	plan->first.items[edge_count] = kept;
	plan->stretches.count = kept;
	ARRAY_PUSH(&plan->unit_first, kept);
	for (uint32_t i = 0; i < kept; i++)
		ARRAY_PUSH(&plan->levels, 0);
}

int far_plan_make(struct far_plan *plan, const struct pkg *pkg, const struct far_options *options)
{
	*plan = (struct far_plan){ 0 };
	struct pool pool = { 0 };
	uint8_t *edges = POOL_ARRAY(&pool, uint8_t, pkg->graph.edge_count + 1);
	stretches_cut(&pkg->graph, &options->stretches, &plan->stretches, &plan->first);
	plan->cut_count = (uint32_t)plan->stretches.count;
	int err = select_edges(pkg, &plan->stretches, options->selection, edges);
	if (!err)
		keep_selected(plan, edges);
	pool_finish(&pool);
	return err;
}
