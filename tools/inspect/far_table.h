/* What a package's far field consists of, as JSON objects. */
#ifndef BLVD_TOOLS_INSPECT_FAR_TABLE_H
#define BLVD_TOOLS_INSPECT_FAR_TABLE_H

#include <cjson/cJSON.h>

#include "assets/pkg.h"

/* The whole: counts by kind and reason, sizes, accuracy. Adds nothing to a package without a far field. */
void far_describe(const struct pkg *pkg, cJSON *out);

/* The cells along one half-edge, in the order they are driven through. */
void far_describe_half(const struct pkg *pkg, uint32_t half, cJSON *out);

/* The cell that looks along `half` from stretch `stretch`. */
static inline uint32_t far_cell_of(uint32_t stretch, uint32_t half)
{
	return 2 * stretch + (half & 1);
}

#endif
