/*
 * The 3D impostor of one cell ([S97] sections 3.2 and 4.2): captures in, textured triangles out. In steps, a file each:
 * surfaces (regions of pixels on one plane in disparity), contours (crack-traced chains between them, simplified with a
 * bound), mesh (constrained Delaunay triangulation, vertices duplicated along jumps), fuse (only what earlier captures
 * did not see), atlas (only covered texels, by distance), error (largest displacement over the view cell).
 */
#ifndef BLVD_TOOLS_IMPOSTOR_IMPOSTOR_H
#define BLVD_TOOLS_IMPOSTOR_IMPOSTOR_H

#include "tools/impostor/capture.h"
#include "tools/impostor/view_cell.h"

enum impostor_interior {
	IMPOSTOR_PLANES, /* planes fitted to disparity */
	IMPOSTOR_GRID,   /* [S97] 4.2: points of a regular grid, disparity from the capture */
};
struct impostor_options {
	double tau_px;          /* default 1 */
	double focal_px;        /* of the screen that tau is measured on: pixels of 1 m at 1 m */
	double texels_per_px;   /* at the start of the view cell; default 1 */
	uint32_t triangles_max; /* 0: no bound. What does not fit is simplified further, where it costs least */
	uint32_t pages_max;     /* 0: no bound. What does not fit gets fewer texels */
	enum impostor_interior interior;
	uint32_t grid_px; /* of IMPOSTOR_GRID; default 16 */
	bool truth;       /* keep truth texels */
};

/* A capture and which of its pixels are wanted: seen from some pose of the view cell. */
struct impostor_capture {
	struct capture_image image;
	uint8_t *wanted; /* one byte a pixel, not 0: wanted. NULL: all */
};

/*
 * Triangles of one capture, in its own pixels, before they get their texels. Vertices of different patches are never
 * shared by index, but their positions agree along borders that are no jumps.
 *
 * Contours against what lies behind are loose: a patch covers all of its pixels and, to save triangles, some that are
 * not its own; and it reaches some pixels below what hides it, so that parallax shows its continuation and no hole.
 * Hence `texels`: what the patch has at each pixel of its rectangle.
 */
enum mesh_texel {
	MESH_CUT,  /* nothing: what is seen there lies behind the patch, or is sky */
	MESH_SHOW, /* what the capture shows there */
	MESH_FILL, /* hidden in the capture: the colour of the nearest pixel that is shown */
};
struct mesh_vertex {
	float x, y;           /* px, y down */
	float disparity;      /* 1 / z in the capture's view */
	int8_t normal_oct[2]; /* of a smooth patch */
};
struct mesh_patch {
	uint32_t first_vertex, vertex_count;
	uint32_t first_index, index_count; /* relative to first_vertex */
	int8_t normal_oct[2];
	bool smooth;                         /* the vertices have normals of their own */
	uint8_t kind;                        /* enum pkg_material_kind, of most of its pixels */
	uint8_t view;                        /* capture */
	uint16_t min_x, min_y, max_x, max_y; /* pixels, both included: what its triangles cover */
	float disparity_max;
	uint32_t first_texel; /* of (max_x - min_x + 1) * (max_y - min_y + 1), row by row */
};
struct impostor_mesh {
	ARRAY(struct mesh_vertex) vertices;
	ARRAY(uint32_t) indices;
	ARRAY(struct mesh_patch) patches;
	ARRAY(uint8_t) texels;      /* enum mesh_texel */
	double error_px;            /* largest displacement over the view cell of a pixel that is shown */
	double over_share;          /* of the pixels to be shown: missing, or displaced by more than tau somewhere in it */
	uint64_t shown_px, over_px; /* what over_share is made of */
};
void impostor_mesh_finish(struct impostor_mesh *mesh);

/*
 * tools/impostor/mesh.c: adds the patches of one capture to `mesh`. `owner` has one entry a pixel of the capture: not 0
 * where this capture has to show the pixel, 0 where it is empty or an earlier capture shows it. error_px is
 * raised to what this capture adds, over_share is of all so far. options->triangles_max bounds the mesh as a whole,
 * earlier captures included.
 */
void impostor_mesh_add(struct impostor_mesh *mesh, const struct view_cell *cell, const struct impostor_capture *capture,
	const uint8_t *owner, uint8_t view, const struct impostor_options *options);

/* tools/impostor/fuse.c: which pixels of capture `which` no earlier capture shows (object, position and normal agree
 * within tau over the view cell), a pixel or two of overlap included. */
void impostor_fuse(const struct view_cell *cell, const struct impostor_capture *captures, size_t which,
	const struct impostor_options *options, uint8_t *owner);

/* What the package stores of a cell. Owned. */
struct impostor {
	ARRAY(struct pkg_impostor_vertex) vertices;
	ARRAY(uint16_t) indices;
	ARRAY(struct pkg_impostor_view) views;
	int32_t origin_mm[3];
	uint32_t page_count;
	uint8_t *pages;                /* RGBA8, PKG_PAGE_PX square each, alpha as PKG_PAGE_CUT says */
	struct pkg_truth_texel *truth; /* or NULL */
	double error_px, over_share;
};
void impostor_finish(struct impostor *impostor);

/* tools/impostor/atlas.c: texels for the patches. Returns 0, or -E2BIG when pages_max or 65,535 vertices do not do. */
int impostor_atlas(const struct impostor_mesh *mesh, const struct view_cell *cell,
	const struct impostor_capture *captures, size_t count, const struct impostor_options *options,
	struct impostor *out);

/* All steps. Captures in the order of importance: what an earlier one shows, later ones leave out. */
int impostor_build(const struct view_cell *cell, const struct impostor_capture *captures, size_t count,
	const struct impostor_options *options, struct impostor *out);

/* Raw bytes of the blobs, appended. */
void impostor_encode(const struct impostor *impostor, byte_array *out);
void impostor_encode_truth(const struct impostor *impostor, byte_array *out);

#endif
