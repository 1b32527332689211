/*
 * The proof of the memory budget (DESIGN "Baking" 7): what must be resident at once, wherever the car is.
 *
 * On stretch s these are needed: s itself with both of its cells, for a car may turn round, and every stretch that it
 * can reach within RESIDENT_AHEAD_M of driving from either end of s, whatever the turn, legal or not. They are more
 * than the loader asks for. The bound is the largest sum over all s.
 */
#ifndef BLVD_TOOLS_FAR_RESIDENT_H
#define BLVD_TOOLS_FAR_RESIDENT_H

#include "tools/far/assemble.h"

#define RESIDENT_AHEAD_M 150.0

/* What a stretch takes once it is loaded: indices of its local set, both impostors inflated, and where a cell is drawn
 * as geometry, its visible set with vertices of its own. */
uint64_t resident_stretch_bytes(const struct pkg_stretch *stretch, const struct pkg_cell cells[2]);

struct resident {
	uint64_t bound_bytes;
	uint32_t worst; /* stretch; PKG_NONE without any */
	/* Over a limit: the stretches that are needed anywhere where the limit is broken. One byte a stretch; NULL: not
	 * asked for. */
	uint8_t *over;
	uint32_t over_count; /* places where it is broken */
};

/* `first` as in CIDX. `limit_bytes` 0: no limit. out->over is filled in if it is not NULL. */
void resident_bound(const struct pkg_graph *net, const uint32_t *first, const struct far_sections *sections,
	uint64_t limit_bytes, struct resident *out);

#endif
