/*
 * What can be seen from a view cell: conservative, so whatever is visible from some pose of it is in the set.
 *
 * From sample points that cover the view cell's floor within PKG_OCCLUDER_SHRINK_MM, at its greatest eye height, an
 * occlusion horizon is built of shrunk occluders (Wonka, Wimmer, Schmalstieg 2000, section 3; Downs, Moeller, Sequin
 * 2001, "Occlusion Horizons for Driving through Urban Scenery"): what lies below the horizon, farther away, is hidden
 * from everywhere near the sample. Solids stand on the ground, so the greatest eye height sees what lower ones see.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_VISIBILITY_H
#define BLVD_TOOLS_IMPOSTOR_VISIBILITY_H

#include "tools/impostor/triangle_set.h"
#include "tools/impostor/view_cell.h"

/* Made once a package, shared by threads, never changed by visible_set(). The package's chunks are sound
 * (pkg_chunk_check()), and stay mapped. */
struct visibility;
struct visibility *visibility_new(const struct pkg *pkg);
void visibility_free(struct visibility *visibility);

struct visible_sets {
	struct triangle_set near_set; /* visible, and some point nearer than near_m to the axis, seen from above */
	struct triangle_set far_set;  /* visible, the others */
	uint32_t near_candidates;     /* triangles within near_m, seen or not */
};
void visible_sets_finish(struct visible_sets *sets);

/* Cleared first. `far_m`: nothing farther counts. */
void visible_set(const struct visibility *visibility, const struct view_cell *cell, double near_m, double far_m,
	struct visible_sets *out);

#endif
