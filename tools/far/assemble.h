/* The package with its far field, from a package and the units' files. */
#ifndef BLVD_TOOLS_FAR_ASSEMBLE_H
#define BLVD_TOOLS_FAR_ASSEMBLE_H

#include "tools/bake/pkg_file.h"
#include "tools/far/plan.h"

struct far_sections {
	stretch_array stretches; /* offsets as in CELD */
	ARRAY(struct pkg_cell) cells;
	uint64_t blob_bytes;
};
void far_sections_finish(struct far_sections *sections);

/* Gathers what the units hold; `folder` and `unit_hashes` as far_work_run() left them. Returns 0 or -errno after
 * logging one line. */
int far_sections_gather(
	struct far_sections *out, const struct far_plan *plan, const char *folder, const uint64_t *unit_hashes);

/* Writes `path`: all of `pkg` but its far field, and, if `sections` is not NULL, that one. Returns 0 or -errno after
 * logging one line; then `path` is as it was. */
int far_assemble(const char *path, const struct pkg *pkg, const struct far_plan *plan,
	const struct far_sections *sections, const char *folder, const uint64_t *unit_hashes, uint64_t resident_bound);

#endif
