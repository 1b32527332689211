/* Where in a view a set's triangles can be: the corners' positions, and those where edges pass the near plane. */
#include "tools/impostor/capture.h"

struct reach {
	double min_x, min_y, max_x, max_y; /* px; empty when min > max */
};

static void add_point(struct reach *reach, const struct capture_view *view, struct dvec3 point)
{
	double x, y, z;
	if (!capture_project(view, point, &x, &y, &z))
		return;
	reach->min_x = fmin(reach->min_x, x);
	reach->min_y = fmin(reach->min_y, y);
	reach->max_x = fmax(reach->max_x, x);
	reach->max_y = fmax(reach->max_y, y);
}

static double depth_of(const struct capture_view *view, struct dvec3 p)
{
	return (p.x - view->eye.x) * view->forward.x + (p.y - view->eye.y) * view->forward.y +
		   (p.z - view->eye.z) * view->forward.z;
}

/* The part of an edge in front of the near plane: its ends, or where it passes. */
static void add_edge(struct reach *reach, const struct capture_view *view, struct dvec3 a, struct dvec3 b)
{
	double za = depth_of(view, a) - view->near_m, zb = depth_of(view, b) - view->near_m;
	if (za >= 0.0)
		add_point(reach, view, a);
	if ((za < 0.0) == (zb < 0.0))
		return;
	double t = za / (za - zb);
	add_point(reach, view, (struct dvec3){ a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t });
}

static struct dvec3 metres(const int64_t at_mm[3])
{
	return (struct dvec3){ (double)at_mm[0] * 1e-3, (double)at_mm[1] * 1e-3, (double)at_mm[2] * 1e-3 };
}

static void add_triangle(
	struct reach *reach, const struct pkg *pkg, const struct capture_view *view, uint32_t object, uint32_t triangle)
{
	int64_t corner_mm[3][3];
	triangle_set_corners(pkg, object, triangle, corner_mm);
	struct dvec3 corner[3] = { metres(corner_mm[0]), metres(corner_mm[1]), metres(corner_mm[2]) };
	for (int i = 0; i < 3; i++)
		add_edge(reach, view, corner[i], corner[(i + 1) % 3]);
}

/* Of an object's box: every edge, from a corner to the one that differs along one axis. */
static struct reach reach_of_box(const struct pkg_object *object, const struct capture_view *view)
{
	struct reach reach = { INFINITY, INFINITY, -INFINITY, -INFINITY };
	for (int corner = 0; corner < 8; corner++) {
		int64_t from[3], to[3];
		for (int axis = 0; axis < 3; axis++)
			from[axis] = corner >> axis & 1 ? object->max_mm[axis] : object->min_mm[axis];
		for (int axis = 0; axis < 3; axis++) {
			memcpy(to, from, sizeof(to));
			to[axis] = corner >> axis & 1 ? object->min_mm[axis] : object->max_mm[axis];
			add_edge(&reach, view, metres(from), metres(to));
		}
	}
	return reach;
}

/* Could the object reach a pixel of the view that `reach` does not have yet? */
static bool adds(const struct reach *reach, const struct reach *box, const struct capture_view *view)
{
	bool seen = box->max_x > 0.0 && box->min_x < view->width && box->max_y > 0.0 && box->min_y < view->height;
	return seen && (fmax(box->min_x, 0.0) < reach->min_x || fmin(box->max_x, view->width) > reach->max_x ||
					   fmax(box->min_y, 0.0) < reach->min_y || fmin(box->max_y, view->height) > reach->max_y);
}

static uint32_t clamped(double value, uint32_t most)
{
	return value <= 0.0 ? 0 : value >= most ? most : (uint32_t)value;
}

bool capture_bounds(
	const struct pkg *pkg, const struct triangle_set *set, const struct capture_view *view, struct capture_rect *out)
{
	struct reach reach = { INFINITY, INFINITY, -INFINITY, -INFINITY };
	for (size_t i = 0; i < set->items.count; i++) {
		const struct triangle_set_item *item = &set->items.items[i];
		const struct pkg_object *object = &pkg->objects[item->object];
		struct reach box = reach_of_box(object, view);
		if (!adds(&reach, &box, view))
			continue;
		for (uint32_t bit = 0; bit < triangle_set_object_size(object); bit++)
			if (set->words.items[item->first_word + bit / 64] >> (bit % 64) & 1)
				add_triangle(&reach, pkg, view, item->object, bit);
	}
	uint32_t left = clamped(floor(reach.min_x), view->width), right = clamped(ceil(reach.max_x), view->width);
	uint32_t top = clamped(floor(reach.min_y), view->height), bottom = clamped(ceil(reach.max_y), view->height);
	*out = (struct capture_rect){ left, top, right - left, bottom - top };
	return reach.min_x < reach.max_x && out->width && out->height;
}

struct capture_view capture_cut(const struct capture_view *view, const struct capture_rect *rect)
{
	struct capture_view out = *view;
	out.centre_x -= rect->x;
	out.centre_y -= rect->y;
	out.width = rect->width;
	out.height = rect->height;
	return out;
}
