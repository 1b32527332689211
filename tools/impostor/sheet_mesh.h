/*
 * Triangles of one sheet of surfaces: what its window holds is outlined, the outline may grow, and holes shrink, by as
 * much area as the triangles are worth that it saves (price_px2): what is too much is cut out by the texture. Borders
 * between the sheet's surfaces are simplified by inner_px. An exact constrained Delaunay triangulation on a lattice of
 * MESH_LATTICE points a pixel has all of them as segments; its faces take the surface of most of their pixels.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_SHEET_MESH_H
#define BLVD_TOOLS_IMPOSTOR_SHEET_MESH_H

#include "tools/impostor/cdt.h"
#include "tools/impostor/contours.h"
#include "tools/impostor/hull.h"
#include "tools/impostor/sheet_window.h"
#include "tools/impostor/simplify.h"

#define MESH_LATTICE 8
#define MESH_PATCH_PX 248u /* largest side of a patch: a page with a border */
#define MESH_CELL_PX 240   /* larger surfaces are cut along multiples of this */
/* Of a surface's least disparity: what its vertices have at least. Planes are clipped at twice this. */
#define MESH_LEAST_SHARE 0.1

/* What the surfaces say that meet at a point. */
struct meeting_point {
	double sum, low, high; /* of their disparities */
	uint32_t surfaces;
};

/* Scratch, kept from sheet to sheet; zeroed to start with. */
struct sheet_mesher {
	struct sheet_window window;
	struct contours contours;
	struct simplifier simplifier;
	ARRAY(struct contour_point) inner; /* what is left of a chain between surfaces */
	struct hull hull;
	struct cdt cdt;
	ARRAY(uint32_t) face;                 /* by triangle, then the surface + 1 of its face */
	ARRAY(uint32_t) members;              /* triangles of a face */
	ARRAY(uint32_t) votes;                /* by surface */
	ARRAY(uint32_t) stamp;                /* by point */
	ARRAY(struct meeting_point) meetings; /* by point */
	ARRAY(uint64_t) order;
	uint64_t cuts; /* points made where chains crossed, of all sheets so far */
};

/* Appends the sheet's patches. */
void sheet_mesh(
	struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet, struct impostor_mesh *mesh);
void sheet_mesher_finish(struct sheet_mesher *mesher);

/* The steps, in their own files. */

/* Contours and cell lines of the window's sheet, as segments. */
void sheet_add_segments(struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet);
/* Is a surface too large for a page, so that it is cut into cells? */
bool sheet_is_large(const struct sheet_source *source, const struct surface *surface);
/* Patches of the triangles whose face has a surface. */
void sheet_add_patches(
	struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet, struct impostor_mesh *mesh);

struct triangle_corners {
	double x[3], y[3]; /* px of the image */
};
struct triangle_corners sheet_corners(const struct cdt *cdt, uint32_t triangle);

#endif
