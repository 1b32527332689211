/* Which labels of an image are side by side. */
#ifndef BLVD_TOOLS_IMPOSTOR_BORDERS_H
#define BLVD_TOOLS_IMPOSTOR_BORDERS_H

#include <stdint.h>

#include "tools/city/pool.h"

struct border {
	uint32_t a, b;  /* labels, a < b, neither 0 */
	uint32_t sides; /* pixel sides that they share */
};
struct borders {
	ARRAY(struct border) items; /* sorted by a, then b */
	ARRAY(uint64_t) pairs;      /* scratch */
};

/* Replaces what `borders` has. Label 0 has no borders. */
void borders_find(struct borders *borders, const uint32_t *label, uint32_t width, uint32_t height);
void borders_finish(struct borders *borders);

#endif
