#include "tools/far/budget.h"

#include <string.h>

#include "platform/base/log.h"

int far_need(
	const struct pkg *pkg, const struct far_plan *plan, const struct far_sections *sections, struct resident_need *out)
{
	struct pool pool = { 0 };
	struct arena arena;
	struct pkg with_far = *pkg;
	with_far.stretches = sections->stretches.items;
	with_far.stretch_count = (uint32_t)sections->stretches.count;
	with_far.cells = sections->cells.items;
	with_far.first_stretch = plan->first.items;
	arena_init(&arena, "need", pool_alloc(&pool, RESIDENT_SCRATCH_BYTES), RESIDENT_SCRATCH_BYTES);
	int err = resident_need(&with_far, &arena, out);
	pool_finish(&pool);
	if (err)
		log_error("cannot tell what must be resident: %s", strerror(-err));
	return err;
}

static uint64_t impostor_bytes(const struct far_sections *sections, size_t stretch)
{
	const struct pkg_cell *cells = &sections->cells.items[2 * stretch];
	return (uint64_t)cells[0].impostor.raw_bytes + cells[1].impostor.raw_bytes;
}

uint32_t far_tighten(struct far_plan *plan, const struct far_sections *sections, const struct resident_need *need,
	uint64_t budget_bytes, uint8_t *skip)
{
	uint64_t most = 0, excess = need->sum > budget_bytes ? need->sum - budget_bytes : 0;
	uint32_t tightened = 0;
	for (size_t i = 0; i < sections->stretches.count; i++)
		if (impostor_bytes(sections, i) > most && plan->levels.items[i] + 1 < CELL_LEVELS)
			most = impostor_bytes(sections, i);
	uint64_t give = excess / RESIDENT_SLOTS + 1;
	uint64_t limit = most > give ? most - give : 0;
	for (uint32_t unit = 0; unit < far_plan_units(plan); unit++) {
		skip[unit] = 1;
		for (uint32_t i = plan->unit_first.items[unit]; i < plan->unit_first.items[unit + 1] && excess; i++) {
			if (impostor_bytes(sections, i) <= limit || plan->levels.items[i] + 1 >= CELL_LEVELS)
				continue;
			plan->levels.items[i]++;
			skip[unit] = 0;
			tightened++;
		}
	}
	return tightened;
}
