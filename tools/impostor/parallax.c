/* Disparity error against displacement over a view cell. A displacement grows with the eye's offset across the line of
 * sight and with the closeness, and both are largest at corners of the box. */
#include "tools/impostor/parallax.h"

/* Nothing is drawn from nearer than this share of its distance from the capture. */
#define REMAINING_MIN 0.1

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct dvec3 difference(struct dvec3 a, struct dvec3 b)
{
	return (struct dvec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

void view_cell_corners(const struct view_cell *cell, struct dvec3 corners[VIEW_CELL_CORNERS])
{
	struct dvec2 along = { cell->end.x - cell->start.x, cell->end.y - cell->start.y };
	double length = dvec2_length(along);
	along = length > 0 ? dvec2_scale(along, 1 / length) : (struct dvec2){ 1, 0 };
	for (int i = 0; i < VIEW_CELL_CORNERS; i++) {
		struct dvec3 base = i < 4 ? cell->start : cell->end;
		double ahead = i < 4 ? -cell->overrun_m : cell->overrun_m;
		double left = i & 1 ? cell->half_width_m : -cell->half_width_m;
		corners[i] = (struct dvec3){ base.x + ahead * along.x - left * along.y,
			base.y + ahead * along.y + left * along.x, base.z + (i & 2 ? cell->eye_max_m : cell->eye_min_m) };
	}
}

struct parallax parallax_of(const struct view_cell *cell, const struct capture_view *view)
{
	struct parallax parallax = { .focal_px = view->focal_px, .centre_x = view->centre_x, .centre_y = view->centre_y };
	struct dvec3 corners[VIEW_CELL_CORNERS];
	view_cell_corners(cell, corners);
	for (int i = 0; i < VIEW_CELL_CORNERS; i++) {
		struct dvec3 from_eye = difference(corners[i], view->eye);
		parallax.offset[i].right = dot(from_eye, view->right);
		parallax.offset[i].up = dot(from_eye, view->up);
		parallax.offset[i].forward = dot(from_eye, view->forward);
		parallax.forward_max = fmax(parallax.forward_max, parallax.offset[i].forward);
	}
	return parallax;
}

double parallax_magnification(const struct parallax *parallax, double disparity)
{
	return 1 / fmax(1 - parallax->forward_max * disparity, REMAINING_MIN);
}

double parallax_tolerance(const struct parallax *parallax, double x, double y, double disparity)
{
	double across = x - parallax->centre_x, above = parallax->centre_y - y, largest = 1e-12;
	for (int i = 0; i < VIEW_CELL_CORNERS; i++) {
		double forward = parallax->offset[i].forward;
		double moved_x = forward * across - parallax->focal_px * parallax->offset[i].right;
		double moved_y = forward * above - parallax->focal_px * parallax->offset[i].up;
		double remaining = fmax(1 - forward * disparity, REMAINING_MIN);
		double scale = 1 / (remaining * remaining);
		largest = fmax(largest, (moved_x * moved_x + moved_y * moved_y) * scale * scale);
	}
	return 1 / sqrt(largest);
}

struct reprojection reprojection_of(const struct capture_view *from, const struct capture_view *to)
{
	struct reprojection map;
	struct dvec3 moved = difference(from->eye, to->eye);
	const struct dvec3 *axes[3] = { &to->right, &to->up, &to->forward };
	for (int i = 0; i < 3; i++) {
		double across = dot(*axes[i], from->right) / from->focal_px;
		double above = dot(*axes[i], from->up) / from->focal_px;
		map.row[i][0] = across;
		map.row[i][1] = -above;
		map.row[i][2] = dot(*axes[i], from->forward) - across * from->centre_x + above * from->centre_y;
		map.row[i][3] = dot(*axes[i], moved);
	}
	for (int k = 0; k < 4; k++) {
		map.row[0][k] = to->focal_px * map.row[0][k] + to->centre_x * map.row[2][k];
		map.row[1][k] = -to->focal_px * map.row[1][k] + to->centre_y * map.row[2][k];
	}
	return map;
}
