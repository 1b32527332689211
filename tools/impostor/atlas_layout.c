/*
 * Blocks and places. A block is taken when the filter's reach of a texel in it touches a triangle.
 */
#include "tools/impostor/atlas_layout.h"

#include <string.h>

#define REACH (0.5 + 1.0 / 64)

void atlas_layout_finish(struct atlas_layout *layout)
{
	ARRAY_FINISH(&layout->corners);
	ARRAY_FINISH(&layout->pieces);
	ARRAY_FINISH(&layout->clusters);
	ARRAY_FINISH(&layout->shapes);
	ARRAY_FINISH(&layout->rows);
	layout->page_count = 0;
}

static int by_cluster(const void *left, const void *right)
{
	const struct atlas_piece *a = left, *b = right;
	if (a->cluster != b->cluster)
		return a->cluster < b->cluster ? -1 : 1;
	return (a->first_corner > b->first_corner) - (a->first_corner < b->first_corner);
}

/* Clusters are named by their first piece and pieces come by patch, patches by view: so do clusters. */
static void make_clusters(struct atlas_layout *layout, const struct impostor_mesh *mesh)
{
	ARRAY_SORT(&layout->pieces, by_cluster);
	for (uint32_t first = 0, end; first < layout->pieces.count; first = end) {
		const struct atlas_piece *pieces = layout->pieces.items;
		struct atlas_cluster cluster = { .first_piece = first, .view = mesh->patches.items[pieces[first].patch].view };
		double min_x = INFINITY, min_y = INFINITY;
		for (end = first; end < layout->pieces.count && pieces[end].cluster == pieces[first].cluster; end++) {
			min_x = fmin(min_x, pieces[end].min_x);
			min_y = fmin(min_y, pieces[end].min_y);
			cluster.scale = fmax(cluster.scale, pieces[end].scale);
		}
		cluster.piece_count = end - first;
		cluster.left = (int32_t)floor(min_x);
		cluster.top = (int32_t)floor(min_y);
		ARRAY_PUSH(&layout->clusters, cluster);
	}
	for (uint32_t c = 0; c < layout->clusters.count; c++)
		for (uint32_t i = 0; i < layout->clusters.items[c].piece_count; i++)
			layout->pieces.items[layout->clusters.items[c].first_piece + i].cluster = c;
}

/* Is some point of the square block on the inner side of all three edges, as seen from each alone? */
static bool touches_block(const double x[3], const double y[3], double left, double top)
{
	double turn = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]) < 0 ? -1 : 1;
	double right = left + 4 + REACH, bottom = top + 4 + REACH;
	left -= REACH;
	top -= REACH;
	for (int i = 0; i < 3; i++) {
		int next = (i + 1) % 3;
		double across = -(y[next] - y[i]) * turn, down = (x[next] - x[i]) * turn;
		double most = across * ((across > 0 ? right : left) - x[i]) + down * ((down > 0 ? bottom : top) - y[i]);
		if (most < 0)
			return false;
	}
	return true;
}

static void take_blocks(
	const struct atlas_cluster *cluster, const struct mesh_vertex corners[3], uint64_t rows[PACK_BLOCKS])
{
	double x[3], y[3], low[2] = { INFINITY, INFINITY }, high[2] = { 0 };
	for (int i = 0; i < 3; i++) {
		x[i] = (corners[i].x - (double)cluster->left) * cluster->scale + ATLAS_GUTTER;
		y[i] = (corners[i].y - (double)cluster->top) * cluster->scale + ATLAS_GUTTER;
		low[0] = fmin(low[0], x[i]);
		low[1] = fmin(low[1], y[i]);
		high[0] = fmax(high[0], x[i]);
		high[1] = fmax(high[1], y[i]);
	}
	int first[2], last[2];
	for (int k = 0; k < 2; k++) {
		first[k] = (int)fmax(floor((low[k] - REACH) / 4), 0);
		last[k] = (int)fmin(floor((high[k] + REACH) / 4), PACK_BLOCKS - 1);
	}
	for (int row = first[1]; row <= last[1]; row++)
		for (int column = first[0]; column <= last[0]; column++)
			if (touches_block(x, y, 4.0 * column, 4.0 * row))
				rows[row] |= 1ull << column;
}

static void make_shape(struct atlas_layout *layout, const struct atlas_cluster *cluster)
{
	uint64_t rows[PACK_BLOCKS] = { 0 }, any = 0;
	for (uint32_t p = 0; p < cluster->piece_count; p++) {
		const struct atlas_piece *piece = &layout->pieces.items[cluster->first_piece + p];
		for (uint32_t i = 0; i < piece->corner_count; i += 3)
			take_blocks(cluster, &layout->corners.items[piece->first_corner + i], rows);
	}
	struct pack_shape shape = { .height = PACK_BLOCKS };
	while (shape.height > 1 && !rows[shape.height - 1])
		shape.height--;
	for (uint32_t row = 0; row < shape.height; row++) {
		any |= rows[row];
		ARRAY_PUSH(&layout->rows, rows[row]);
	}
	while (any >> shape.width) {
		if (++shape.width == PACK_BLOCKS)
			break;
	}
	ARRAY_PUSH(&layout->shapes, shape);
}

void atlas_layout_make(struct atlas_layout *layout, const struct impostor_mesh *mesh, const struct view_cell *cell,
	const struct impostor_capture *captures, const struct impostor_options *options, double factor)
{
	atlas_layout_finish(layout);
	atlas_pieces_make(layout, mesh, cell, captures, options, factor);
	atlas_join(layout, mesh, captures);
	make_clusters(layout, mesh);
	for (size_t i = 0; i < layout->clusters.count; i++)
		make_shape(layout, &layout->clusters.items[i]);
	const uint64_t *rows = layout->rows.items;
	for (size_t i = 0; i < layout->shapes.count; i++) {
		layout->shapes.items[i].rows = rows;
		rows += layout->shapes.items[i].height;
	}
	uint32_t most = options->pages_max && options->pages_max < UINT8_MAX ? options->pages_max : UINT8_MAX;
	layout->page_count = pack_shapes(layout->shapes.items, layout->shapes.count, most);
}
