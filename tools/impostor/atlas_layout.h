/* Where the texels of an impostor's patches lie: pieces (patches cut to what a page holds), clusters of touching pieces
 * that are copied as one, and their places on pages. Between impostor_atlas()'s own files. */
#ifndef BLVD_TOOLS_IMPOSTOR_ATLAS_LAYOUT_H
#define BLVD_TOOLS_IMPOSTOR_ATLAS_LAYOUT_H

#include "tools/impostor/impostor.h"
#include "tools/impostor/pack.h"

#define ATLAS_GUTTER 1 /* texels around a cluster: what bilinear filtering reaches, and a little more */

/* A patch, or a part of one. */
struct atlas_piece {
	uint32_t patch;
	uint32_t first_corner, corner_count; /* three a triangle */
	float min_x, min_y, max_x, max_y;    /* px */
	double area;                         /* px^2 */
	double scale;                        /* texels per px of the capture, at most 1 */
	uint32_t cluster;
};

/* Pixel position (x, y) of the capture is at texel ((x - left) scale + ATLAS_GUTTER, ...) of the cluster. */
struct atlas_cluster {
	uint8_t view;
	int32_t left, top;
	double scale;
	uint32_t first_piece, piece_count; /* pieces are sorted by cluster */
};

struct atlas_layout {
	ARRAY(struct mesh_vertex) corners;
	ARRAY(struct atlas_piece) pieces;
	ARRAY(struct atlas_cluster) clusters;
	ARRAY(struct pack_shape) shapes; /* of the clusters: the blocks that their triangles are drawn from */
	ARRAY(uint64_t) rows;
	uint32_t page_count;
};
void atlas_layout_finish(struct atlas_layout *layout);

/* `factor` scales all texels. page_count is 0 when pages_max are not enough. */
void atlas_layout_make(struct atlas_layout *layout, const struct impostor_mesh *mesh, const struct view_cell *cell,
	const struct impostor_capture *captures, const struct impostor_options *options, double factor);

/* tools/impostor/atlas_pieces.c: the first step. */
void atlas_pieces_make(struct atlas_layout *layout, const struct impostor_mesh *mesh, const struct view_cell *cell,
	const struct impostor_capture *captures, const struct impostor_options *options, double factor);

/* tools/impostor/atlas_join.c: names each piece's cluster by one of the pieces. */
void atlas_join(struct atlas_layout *layout, const struct impostor_mesh *mesh, const struct impostor_capture *captures);

/* The rows, and in a row the columns, of the pixels whose centres are in a triangle: first and last; none when first >
 * last. Triangles side by side do not overlap. May lie outside the capture. */
void atlas_rows(const struct mesh_vertex corners[3], int32_t rows[2]);
void atlas_columns(const struct mesh_vertex corners[3], int32_t y, int32_t columns[2]);

/* tools/impostor/atlas_paint.c: colours (and truth) of all clusters into out's pages, which are zeroed. */
void atlas_paint(const struct atlas_layout *layout, const struct impostor_mesh *mesh,
	const struct impostor_capture *captures, struct impostor *out);

#endif
