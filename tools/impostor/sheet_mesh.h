/*
 * Triangles of one sheet of surfaces.
 *
 * The sheet's pixels are taken alone. They are first spread: some pixels under whatever is nearer, and down to where
 * the near ground will be (`guard_px`), so that parallax uncovers a continuation and no hole; and by a ring of a pixel
 * on all sides, for the texture's filter. The outline may then grow, and holes shrink, by as much area as the triangles
 * are worth that it saves (`price_px2`): what is too much is cut out by the texture. Borders between the sheet's
 * surfaces are simplified by inner_px. An exact constrained Delaunay triangulation on a lattice of MESH_LATTICE points
 * a pixel has all of them as segments; its faces take the surface of most of their pixels.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_SHEET_MESH_H
#define BLVD_TOOLS_IMPOSTOR_SHEET_MESH_H

#include "tools/impostor/cdt.h"
#include "tools/impostor/contours.h"
#include "tools/impostor/displacement.h"
#include "tools/impostor/hull.h"
#include "tools/impostor/impostor.h"
#include "tools/impostor/sheets.h"
#include "tools/impostor/simplify.h"

#define MESH_LATTICE 8
#define MESH_PATCH_PX 248u /* largest side of a patch: a page with a border */
#define MESH_REACH_PX 8    /* how far an outline may grow */

struct sheet_options {
	uint32_t guard_px, close_px;
	double price_px2; /* area that a triangle is worth */
	double inner_px;
	uint8_t view;
};
/* What all sheets of a capture share. */
struct sheet_source {
	const struct capture_image *image;
	const struct surfaces *surfaces;
	const struct sheets *sheets;
	float *tolerance; /* of disparity for tau_px: at owned pixels, and 0 where not asked for yet */
	struct displacement *displacement;
	double tau_px;
	const uint8_t *open_below; /* not 0: nothing here and in all pixels below */
	struct sheet_options options;
};
/* Scratch, kept from sheet to sheet; zeroed to start with. */
struct sheet_mesher {
	int32_t x, y; /* of the window's first pixel in the image; may be negative */
	uint32_t width, height;
	ARRAY(uint32_t) label; /* of the window: surface + 1 */
	ARRAY(uint8_t) seam;   /* of the window: spread over a surface that is tied */
	ARRAY(uint32_t) front, next_front, lent;
	struct contours contours;
	struct simplifier simplifier;
	ARRAY(struct contour_point) inner; /* what is left of a chain between surfaces */
	struct hull hull;
	struct cdt cdt;
	ARRAY(uint32_t) face;    /* by triangle, then the surface + 1 of its face */
	ARRAY(uint32_t) members; /* triangles of a face */
	ARRAY(uint32_t) votes;   /* by surface */
	ARRAY(uint32_t) stamp;   /* by point */
	ARRAY(double) disparity; /* by point: sum, then mean */
	ARRAY(uint32_t) sharing; /* by point: surfaces in the sum */
	ARRAY(uint64_t) order;
	uint64_t cuts; /* points made where chains crossed, of all sheets so far */
};

/* Appends the sheet's patches. */
void sheet_mesh(
	struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet, struct impostor_mesh *mesh);
void sheet_mesher_finish(struct sheet_mesher *mesher);

#endif
