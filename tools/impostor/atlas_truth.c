/* Places of texels that no capture has seen: where a surface goes on, it does so on its plane. */
#include "tools/impostor/atlas_part.h"

void atlas_place(const struct atlas_canvas *canvas, double x, double y, double disparity, struct pkg_truth_texel *truth)
{
	struct dvec3 point = capture_point(&canvas->image->view, x, y, disparity);
	truth->pos_m[0] = (float)(point.x - canvas->origin.x);
	truth->pos_m[1] = (float)(point.y - canvas->origin.y);
	truth->pos_m[2] = (float)(point.z - canvas->origin.z);
}

static void place_on_triangle(
	const struct atlas_canvas *canvas, struct atlas_part *part, const struct mesh_vertex corners[3])
{
	const struct atlas_cluster *cluster = part->cluster;
	double x[3], y[3], w[3];
	for (int i = 0; i < 3; i++) {
		x[i] = ((double)corners[i].x - cluster->left) * cluster->scale + ATLAS_GUTTER;
		y[i] = ((double)corners[i].y - cluster->top) * cluster->scale + ATLAS_GUTTER;
		w[i] = (double)corners[i].disparity;
	}
	double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
	double right = fmin(fmax(fmax(x[0], x[1]), x[2]), part->columns);
	double bottom = fmin(fmax(fmax(y[0], y[1]), y[2]), part->rows);
	for (uint32_t row = (uint32_t)fmax(fmin(fmin(y[0], y[1]), y[2]), 0); row < bottom; row++) {
		for (uint32_t column = (uint32_t)fmax(fmin(fmin(x[0], x[1]), x[2]), 0); column < right; column++) {
			struct pkg_truth_texel *truth = &part->truth[(size_t)row * part->columns + column];
			double dx = column + 0.5 - x[0], dy = row + 0.5 - y[0];
			double b = (dx * (y[2] - y[0]) - (x[2] - x[0]) * dy) / area;
			double c = ((x[1] - x[0]) * dy - dx * (y[1] - y[0])) / area;
			if (!(truth->object & PKG_TRUTH_MADE_UP) || !(b >= 0 && c >= 0 && b + c <= 1))
				continue;
			double at_x = cluster->left + (column + 0.5 - ATLAS_GUTTER) / cluster->scale;
			double at_y = cluster->top + (row + 0.5 - ATLAS_GUTTER) / cluster->scale;
			atlas_place(canvas, at_x, at_y, w[0] + b * (w[1] - w[0]) + c * (w[2] - w[0]), truth);
		}
	}
}

void atlas_place_made_up(const struct atlas_canvas *canvas, struct atlas_part *part)
{
	for (uint32_t p = 0; p < part->cluster->piece_count; p++) {
		const struct atlas_piece *piece = &canvas->layout->pieces.items[part->cluster->first_piece + p];
		for (uint32_t i = 0; i < piece->corner_count; i += 3)
			place_on_triangle(canvas, part, &canvas->layout->corners.items[piece->first_corner + i]);
	}
}
