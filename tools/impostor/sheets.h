/*
 * Sheets: surfaces that are joined along their common borders, with no jump between any two of them. A sheet is meshed
 * as one, so its triangles share vertices and cannot crack; two sheets are meshed apart, so along a jump the vertices
 * are there twice and nothing is stretched over it. Short borders are not worth the vertices that both sides would need
 * along them, nor are those where the planes miss each other by much: there each overlaps the other by a few pixels, as
 * far as they agree, and goes on under it where it lies behind.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_SHEETS_H
#define BLVD_TOOLS_IMPOSTOR_SHEETS_H

#include <stdbool.h>

#include "tools/impostor/surfaces.h"

struct tie {
	uint32_t a, b;         /* surfaces */
	uint32_t sides, steps; /* of pixels; of these with what is too much to be joined */
};
struct sheets {
	ARRAY(struct tie) ties;   /* sorted by a, then b */
	ARRAY(uint32_t) sheet_of; /* by surface */
	ARRAY(uint32_t) first;    /* by sheet, and one more: where its surfaces begin in ... */
	ARRAY(uint32_t) members;  /* ... surfaces, ascending */
};

/* `tolerance` of disparity by pixel: where two planes are nearer to each other than `join_share` of it, they can be
 * joined. */
void sheets_find(struct sheets *sheets, const struct surfaces *surfaces, const float *tolerance, double join_share);
void sheets_finish(struct sheets *sheets);

#endif
