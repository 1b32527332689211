/*
 * Sheets: surfaces that are joined along their common borders, with no jump between any two of them. A sheet is meshed
 * as one, so its triangles share vertices and cannot crack; two sheets are meshed apart, so along a jump the vertices
 * are there twice and nothing is stretched over it.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_SHEETS_H
#define BLVD_TOOLS_IMPOSTOR_SHEETS_H

#include "tools/impostor/surfaces.h"

struct sheets {
	ARRAY(uint32_t) sheet_of; /* by surface */
	ARRAY(uint32_t) first;    /* by sheet, and one more: where its surfaces begin in ... */
	ARRAY(uint32_t) members;  /* ... surfaces, ascending */
};

/* `tolerance` of disparity by pixel, as for surfaces; two planes join where they are nearer than `share` of it. */
void sheets_find(struct sheets *sheets, const struct surfaces *surfaces, const float *tolerance, double share);
void sheets_finish(struct sheets *sheets);

#endif
