/* One narrower view through all that fades; only what it sees is drawn. */
#include "render/see_through.h"

#include <math.h>

#include "render/camera.h"

/* Of a rectangle on the plane one metre in front of the eye. */
struct window {
	float min_x, max_x, min_y, max_y;
	bool any;
};

static void widen(struct window *window, float x, float y)
{
	window->min_x = window->any ? fminf(window->min_x, x) : x;
	window->max_x = window->any ? fmaxf(window->max_x, x) : x;
	window->min_y = window->any ? fminf(window->min_y, y) : y;
	window->max_y = window->any ? fmaxf(window->max_y, y) : y;
	window->any = true;
}

/* What reaches behind the eye covers everything. */
static void add_box(struct window *window, const struct view *view, struct vec3 min, struct vec3 max)
{
	for (int i = 0; i < 8; i++) {
		struct vec3 corner = { i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z };
		float depth = vec3_dot(corner, view->forward);
		if (depth < 0.5f) {
			widen(window, -view->tan_half_x, -view->tan_half_y);
			widen(window, view->tan_half_x, view->tan_half_y);
			return;
		}
		widen(window, vec3_dot(corner, view->right) / depth, vec3_dot(corner, view->up) / depth);
	}
}

static void clip(struct window *window, const struct view *view)
{
	window->min_x = fmaxf(window->min_x, -view->tan_half_x);
	window->max_x = fminf(window->max_x, view->tan_half_x);
	window->min_y = fmaxf(window->min_y, -view->tan_half_y);
	window->max_y = fminf(window->max_y, view->tan_half_y);
	window->any = window->any && window->min_x < window->max_x && window->min_y < window->max_y;
}

static struct vec3 through(const struct view *view, float x, float y)
{
	return vec3_add(view->forward, vec3_add(vec3_scale(view->right, x), vec3_scale(view->up, y)));
}

/* A view along the window's middle that holds the window. */
static struct view narrowed(const struct view *view, const struct window *window)
{
	struct view out = *view;
	out.forward =
		vec3_normalize(through(view, (window->min_x + window->max_x) * 0.5f, (window->min_y + window->max_y) * 0.5f));
	out.right = vec3_normalize(vec3_cross(out.forward, view->up));
	out.up = vec3_cross(out.right, out.forward);
	out.tan_half_x = out.tan_half_y = 0.0f;
	for (int i = 0; i < 4; i++) {
		struct vec3 corner =
			through(view, i & 1 ? window->max_x : window->min_x, i & 2 ? window->max_y : window->min_y);
		float depth = vec3_dot(corner, out.forward);
		out.tan_half_x = fmaxf(out.tan_half_x, fabsf(vec3_dot(corner, out.right)) / depth);
		out.tan_half_y = fmaxf(out.tan_half_y, fabsf(vec3_dot(corner, out.up)) / depth);
	}
	return out;
}

/* What fades is drawn already, and decals would blend twice. */
static void keep_solid(struct draw_list *list, uint32_t from)
{
	uint32_t kept = from;
	for (uint32_t i = from; i < list->count; i++)
		if (list->items[i].opacity == 255 && list->items[i].pass == PKG_PASS_OPAQUE)
			list->items[kept++] = list->items[i];
	list->count = kept;
}

void see_through_emit(const struct fade *fade, const struct near_mesh *mesh, const struct view *view, double reach_m,
	struct visible_set *visible, struct draw_list *list)
{
	struct window window = { 0 };
	for (uint32_t i = 0; i < fade->count; i++) {
		const struct pkg_object *object = &mesh->pkg->objects[fade->entries[i].object];
		struct vec3 min, max;
		view_box(view, object->min_mm, object->max_mm, &min, &max);
		if (view_sees_box(view, min, max))
			add_box(&window, view, min, max);
	}
	clip(&window, view);
	if (!window.any)
		return;
	struct view part = narrowed(view, &window);
	uint32_t before = list->count;
	visible_find(visible, mesh, &part, reach_m);
	visible_emit(visible, mesh, fade, &part, list);
	keep_solid(list, before);
}
