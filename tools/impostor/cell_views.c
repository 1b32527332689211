#include "tools/impostor/cell_views.h"

#include <math.h>

static struct dvec3 add(struct dvec3 a, struct dvec3 b, double scale)
{
	return (struct dvec3){ a.x + b.x * scale, a.y + b.y * scale, a.z + b.z * scale };
}

static double dot(struct dvec3 a, struct dvec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

struct dvec3 cell_axis(const struct view_cell *cell)
{
	double x = cell->end.x - cell->start.x, y = cell->end.y - cell->start.y, length = hypot(x, y);
	return length > 0.0 ? (struct dvec3){ x / length, y / length, 0.0 } : (struct dvec3){ 0.0, 1.0, 0.0 };
}

struct dvec3 cell_eye(const struct view_cell *cell, const struct cell_pose *pose)
{
	struct dvec3 axis = cell_axis(cell), right = { axis.y, -axis.x, 0.0 };
	double t = pose->along, over = pose->beyond ? cell->overrun_m : pose->behind ? -cell->overrun_m : 0.0;
	struct dvec3 at = { cell->start.x + t * (cell->end.x - cell->start.x),
		cell->start.y + t * (cell->end.y - cell->start.y), cell->start.z + t * (cell->end.z - cell->start.z) };
	at = add(add(at, axis, over), right, pose->aside * cell->half_width_m);
	at.z += cell->eye_min_m + pose->height * (cell->eye_max_m - cell->eye_min_m);
	return at;
}

struct capture_view cell_face_view(
	const struct view_cell *cell, struct dvec3 eye, enum cell_face face, bool half, double focal_px)
{
	struct dvec3 axis = cell_axis(cell), right = { axis.y, -axis.x, 0.0 };
	struct dvec3 forward = axis;
	if (face == CELL_LEFT)
		forward = (struct dvec3){ -right.x, -right.y, 0.0 };
	else if (face == CELL_RIGHT)
		forward = right;
	else if (face == CELL_BACK)
		forward = (struct dvec3){ -axis.x, -axis.y, 0.0 };
	uint32_t side = (uint32_t)ceil(focal_px);
	struct capture_view view = {
		.eye = eye,
		.right = { forward.y, -forward.x, 0.0 },
		.up = { 0.0, 0.0, 1.0 },
		.forward = forward,
		.focal_px = focal_px,
		.centre_x = side,
		.centre_y = side,
		.width = 2 * side,
		.height = 2 * side,
	};
	if (half && (face == CELL_LEFT || face == CELL_RIGHT)) {
		view.width = side;
		view.centre_x = face == CELL_LEFT ? 0.0 : side;
	}
	return view;
}

void set_corners(const struct pkg *pkg, const struct triangle_set *set, corner_array *out)
{
	out->count = 0;
	ARRAY_RESERVE(out, 3 * (size_t)set->triangles + 1);
	for (size_t i = 0; i < set->items.count; i++) {
		const struct triangle_set_item *item = &set->items.items[i];
		uint32_t size = triangle_set_object_size(&pkg->objects[item->object]);
		for (uint32_t triangle = 0; triangle < size; triangle++) {
			int64_t mm[3][3];
			if (!(set->words.items[item->first_word + triangle / 64] >> (triangle % 64) & 1))
				continue;
			triangle_set_corners(pkg, item->object, triangle, mm);
			for (int k = 0; k < 3; k++)
				ARRAY_PUSH(
					out, (struct dvec3){ (double)mm[k][0] * 1e-3, (double)mm[k][1] * 1e-3, (double)mm[k][2] * 1e-3 });
		}
	}
}

/* A polygon in the view's frame: x right, y down, z forward. */
struct polygon {
	struct dvec3 at[9];
	int count;
};

/* The view's sides as planes through the eye: what is inside has a positive distance. */
static void side_planes(const struct capture_view *view, struct dvec3 planes[4])
{
	double f = view->focal_px;
	planes[0] = (struct dvec3){ f, 0.0, view->centre_x };
	planes[1] = (struct dvec3){ -f, 0.0, view->width - view->centre_x };
	planes[2] = (struct dvec3){ 0.0, f, view->centre_y };
	planes[3] = (struct dvec3){ 0.0, -f, view->height - view->centre_y };
}

static void clip(struct polygon *polygon, struct dvec3 plane)
{
	struct polygon out = { .count = 0 };
	for (int i = 0; i < polygon->count; i++) {
		struct dvec3 a = polygon->at[i], b = polygon->at[(i + 1) % polygon->count];
		double da = dot(a, plane), db = dot(b, plane);
		if (da >= 0.0)
			out.at[out.count++] = a;
		if ((da >= 0.0) == (db >= 0.0))
			continue;
		double t = da / (da - db);
		out.at[out.count++] = (struct dvec3){ a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z) };
	}
	*polygon = out;
}

struct rectangle {
	double min_x, min_y, max_x, max_y;
};

static void cover(
	struct rectangle *box, const struct capture_view *view, const struct dvec3 planes[4], const struct dvec3 corner[3])
{
	struct polygon polygon = { .count = 3 };
	unsigned outside_all = 15, outside_any = 0;
	for (int k = 0; k < 3; k++) {
		struct dvec3 from_eye = add(corner[k], view->eye, -1.0);
		struct dvec3 at = { dot(from_eye, view->right), -dot(from_eye, view->up), dot(from_eye, view->forward) };
		unsigned outside = 0;
		for (unsigned side = 0; side < 4; side++)
			outside |= (unsigned)(dot(at, planes[side]) < 0.0) << side;
		outside_all &= outside;
		outside_any |= outside;
		polygon.at[k] = at;
	}
	if (outside_all)
		return;
	for (int side = 0; side < 4 && outside_any; side++)
		clip(&polygon, planes[side]);
	for (int k = 0; k < polygon.count; k++) {
		struct dvec3 at = polygon.at[k];
		if (!(at.z > 1e-9)) /* the eye itself: the whole view */
			at = (struct dvec3){ 0.0, 0.0, 1.0 };
		double x = view->centre_x + view->focal_px * at.x / at.z, y = view->centre_y + view->focal_px * at.y / at.z;
		box->min_x = fmin(box->min_x, x);
		box->min_y = fmin(box->min_y, y);
		box->max_x = fmax(box->max_x, x);
		box->max_y = fmax(box->max_y, y);
	}
}

bool view_crop(struct capture_view *view, const corner_array *corners)
{
	struct dvec3 planes[4];
	struct rectangle box = { INFINITY, INFINITY, -INFINITY, -INFINITY };
	side_planes(view, planes);
	for (size_t i = 0; i + 2 < corners->count; i += 3)
		cover(&box, view, planes, &corners->items[i]);
	if (!(box.max_x >= box.min_x) || !(box.max_y >= box.min_y))
		return false;
	double left = fmax(floor(box.min_x) - 1.0, 0.0), top = fmax(floor(box.min_y) - 1.0, 0.0);
	double right = fmin(floor(box.max_x) + 2.0, view->width), bottom = fmin(floor(box.max_y) + 2.0, view->height);
	view->centre_x -= left;
	view->centre_y -= top;
	view->width = (uint32_t)(right - left);
	view->height = (uint32_t)(bottom - top);
	return view->width && view->height;
}
