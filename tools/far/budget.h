/*
 * The proof of the memory budget (DESIGN "Baking" 7). The runtime keeps a fixed number of slots, each large enough for
 * any stretch (assets/resident.h), so what must be resident at once follows from the largest stretches, wherever they
 * lie; when that is too much, they give way.
 */
#ifndef BLVD_TOOLS_FAR_BUDGET_H
#define BLVD_TOOLS_FAR_BUDGET_H

#include "assets/resident.h"
#include "tools/far/assemble.h"

/* What `pkg` with this far field needs. Returns 0 or -ENOMEM after logging one line. */
int far_need(
	const struct pkg *pkg, const struct far_plan *plan, const struct far_sections *sections, struct resident_need *out);

/* Raises the levels of the stretches whose impostors are so large that a need of `budget_bytes` cannot be kept; writes
 * 0 to `skip` for their units, 1 for the others. Returns how many stretches; 0: no impostor can give way any more. */
uint32_t far_tighten(struct far_plan *plan, const struct far_sections *sections, const struct resident_need *need,
	uint64_t budget_bytes, uint8_t *skip);

#endif
