/*
 * The far field of a package, made from the package itself: streets into stretches, stretches into units that are baked
 * one by one by all cores, units into sections (DESIGN "Baking", last paragraph).
 */
#ifndef BLVD_TOOLS_FAR_FAR_H
#define BLVD_TOOLS_FAR_FAR_H

#include "assets/pkg.h"
#include "tools/impostor/cell_bake.h"
#include "tools/impostor/stretches.h"

/* Zero takes the default. */
struct far_options {
	struct stretch_options stretches;
	struct cell_options cells;
	const char *selection; /* which stretches: NULL or "all", "A-B", or a recorded drive */
	const char *units;     /* folder of finished units; default OUTPUT.cells, which goes when all is done */
	uint64_t budget_bytes; /* of what is resident at once; 0: none. Where it does not do, accuracy gives way */
	unsigned jobs;         /* workers; default: cores */
	bool quiet;
};

/* Makes the far field of `pkg`, which may have one already, and writes `output`, which may be the file it came from.
 * Returns an exit status (tools/commands.h) after logging one line. */
int far_bake(const struct pkg *pkg, const char *output, const struct far_options *options);

/* Writes `output` as `pkg` without a far field. Returns an exit status after logging one line. */
int far_strip(const struct pkg *pkg, const char *output);

/* The folder of units that options name, into `out` of PATH_MAX bytes, made if it is not there. Returns 0 or -errno
 * after logging one line. */
int far_units_folder(const struct far_options *options, const char *output, char *out);

#endif
