/* From a window's labels to segments: chains are traced, outer ones grow into hulls, inner ones are simplified. */
#include <math.h>

#include "tools/impostor/sheet_mesh.h"

/* Of the screen: how far a point on a border moves to the fold, and where the sheet ends and the border was spread by
 * rule of thumb. */
#define FOLD_INNER_PX 1.2
#define FOLD_OUTER_PX 2.4

/* How far triangles reach beyond a surface's pixels: spread, ring and hull. */
static uint32_t margin_of(const struct sheet_source *source)
{
	return source->options.guard_px + source->options.reach_px + source->options.ring_px + 1;
}

bool sheet_is_large(const struct sheet_source *source, const struct surface *surface)
{
	uint32_t room = MESH_PATCH_PX - 2 * margin_of(source);
	return surface->max_x - surface->min_x >= (int)room || surface->max_y - surface->min_y >= (int)room;
}

/* To the lattice, within the image and the triangulation's rectangle. */
static int32_t clamped(double value, int32_t min, int32_t max, int32_t image)
{
	min = min < 0 ? 0 : min + 1;
	max = max > image ? image : max - 1;
	return (int32_t)lround(fmin(fmax(value, min), max));
}

/* The distinct labels of up to four pixels. */
struct meeting {
	uint32_t labels[4];
	int count;
	bool outer; /* one of them is outside */
};

static void meet(struct meeting *meeting, uint32_t label)
{
	meeting->outer |= !label;
	for (int i = 0; i < meeting->count; i++)
		if (meeting->labels[i] == label)
			return;
	if (label)
		meeting->labels[meeting->count++] = label;
}

/* The pixels around a corner of the window. */
static struct meeting meeting_at(const struct sheet_mesher *mesher, struct contour_point corner)
{
	struct meeting meeting = { 0 };
	for (int64_t y = (int64_t)corner.y - 1; y <= (int64_t)corner.y; y++)
		for (int64_t x = (int64_t)corner.x - 1; x <= (int64_t)corner.x; x++)
			meet(&meeting, x < 0 || y < 0 || x >= mesher->window.width || y >= mesher->window.height
							   ? 0
							   : mesher->window.label.items[(size_t)y * mesher->window.width + (size_t)x]);
	return meeting;
}

/*
 * Moves a point to where the planes that meet there have the same disparity: along a fold the pixels know the border to
 * half a pixel only, and the planes know it exactly. Least squares over the differences to the first plane.
 */
static void move_to_fold(const struct sheet_source *source, const struct meeting *meeting, double *x, double *y)
{
	const struct plane *first = &sheet_surface(source, meeting->labels[0])->plane;
	double xx = 0, xy = 0, yy = 0, right_x = 0, right_y = 0;
	for (int i = 1; i < meeting->count; i++) {
		const struct plane *other = &sheet_surface(source, meeting->labels[i])->plane;
		double step = plane_at(other, *x, *y) - plane_at(first, *x, *y);
		double slope_x = other->w_x - first->w_x, slope_y = other->w_y - first->w_y;
		xx += slope_x * slope_x;
		xy += slope_x * slope_y;
		yy += slope_y * slope_y;
		right_x -= slope_x * step;
		right_y -= slope_y * step;
	}
	/* Little weight on staying: decides what the folds leave open, along one line. */
	double stay = 1e-4 * (xx + yy);
	xx += stay;
	yy += stay;
	double determinant = xx * yy - xy * xy;
	if (!(determinant > 0))
		return;
	double dx = (right_x * yy - right_y * xy) / determinant, dy = (right_y * xx - right_x * xy) / determinant;
	double most = (meeting->outer ? FOLD_OUTER_PX : FOLD_INNER_PX) * source->options.per_px;
	if (dx * dx + dy * dy > most * most)
		return;
	*x += dx;
	*y += dy;
}

static struct cdt_point lattice_point(const struct sheet_mesher *mesher, const struct sheet_source *source,
	struct contour_point point, const struct meeting *meeting)
{
	double x = (double)point.x + mesher->window.x, y = (double)point.y + mesher->window.y;
	if (meeting->count > 1)
		move_to_fold(source, meeting, &x, &y);
	struct cdt_point min = mesher->cdt.points.items[0], max = mesher->cdt.points.items[2];
	return (struct cdt_point){
		clamped(x * MESH_LATTICE, min.x, max.x, (int32_t)source->surfaces->width * MESH_LATTICE),
		clamped(y * MESH_LATTICE, min.y, max.y, (int32_t)source->surfaces->height * MESH_LATTICE),
	};
}

/* How far a point of the window is from where a surface's plane ends: a plane has to end before its horizon, where the
 * disparity is 0, but not before the surface's last pixel. */
static double before_end(const struct sheet_mesher *mesher, const struct surface *surface, struct contour_point point)
{
	double end = fmin(2 * MESH_LEAST_SHARE * (double)surface->least_disparity, 0.5 * (double)surface->least_fitted);
	return plane_at(&surface->plane, (double)point.x + mesher->window.x, (double)point.y + mesher->window.y) - end;
}

/* Clips the hull where its surface's plane ends, to mesher->inner. The ends of what is no loop stay. */
static void clip_hull(struct sheet_mesher *mesher, const struct surface *surface, bool loop)
{
	const struct contour_point *points = mesher->hull.kept.items;
	size_t count = mesher->hull.kept.count;
	mesher->inner.count = 0;
	for (size_t i = 0; i < count; i++) {
		struct contour_point last = points[i ? i - 1 : count - 1], here = points[i];
		double from = before_end(mesher, surface, last), to = before_end(mesher, surface, here);
		if ((i || loop) && (from < 0) != (to < 0)) {
			float t = (float)(from / (from - to));
			ARRAY_PUSH(&mesher->inner,
				(struct contour_point){ last.x + t * (here.x - last.x), last.y + t * (here.y - last.y) });
		}
		if (to >= 0 || (!loop && (i == 0 || i + 1 == count)))
			ARRAY_PUSH(&mesher->inner, here);
	}
}

/* A loop has its first point once and no ends; ends are pixels' corners, where other chains may meet. */
static void add_polyline(struct sheet_mesher *mesher, const struct sheet_source *source, const struct chain *chain,
	const struct contour_point *points, size_t count, bool loop)
{
	struct meeting sides = { 0 };
	meet(&sides, chain->left);
	meet(&sides, chain->right);
	uint32_t first = CDT_NONE, last = CDT_NONE;
	for (size_t i = 0; i < count; i++) {
		bool end = !loop && (i == 0 || i + 1 == count);
		struct meeting meeting = end ? meeting_at(mesher, points[i]) : sides;
		uint32_t point = cdt_add_point(&mesher->cdt, lattice_point(mesher, source, points[i], &meeting));
		if (last == CDT_NONE)
			first = point;
		else
			cdt_add_segment(&mesher->cdt, last, point);
		last = point;
	}
	if (loop && last != CDT_NONE)
		cdt_add_segment(&mesher->cdt, last, first);
}

/* A hole that is cheaper filled: its points and two triangles more are saved. */
static bool is_idle_hole(const struct sheet_mesher *mesher, const struct sheet_source *source)
{
	return mesher->hull.area <= source->options.price_px2 * (double)(mesher->hull.kept.count + 2);
}

/* Is what a closed chain goes around outside of the sheet? y is down: clockwise has its right inside. */
static bool is_hole(const struct chain *chain, const struct contour_point *points)
{
	double twice = 0;
	for (uint32_t i = 1; i < chain->count; i++)
		twice += (double)points[i - 1].x * (double)points[i].y - (double)points[i - 1].y * (double)points[i].x;
	return (twice > 0 ? chain->right : chain->left) == 0;
}

static void add_inner_chain(struct sheet_mesher *mesher, const struct sheet_source *source, const struct chain *chain)
{
	const struct contour_point *points = mesher->contours.points.items + chain->first;
	simplify(&mesher->simplifier, points, chain->count, chain->closed, source->options.inner_px);
	mesher->inner.count = 0;
	for (size_t i = 0; i < mesher->simplifier.kept.count; i++)
		ARRAY_PUSH(&mesher->inner, points[mesher->simplifier.kept.items[i]]);
	add_polyline(mesher, source, chain, mesher->inner.items, mesher->inner.count, false);
}

static void add_outer_chain(struct sheet_mesher *mesher, const struct sheet_source *source, const struct chain *chain)
{
	const struct contour_point *points = mesher->contours.points.items + chain->first;
	bool loop = chain->closed && meeting_at(mesher, points[0]).count == 1;
	hull_grow(
		&mesher->hull, points, chain->count, loop, !chain->left, source->options.price_px2, source->options.reach_px);
	if (loop && is_hole(chain, points) && is_idle_hole(mesher, source))
		return;
	const struct surface *surface = sheet_surface(source, chain->left ? chain->left : chain->right);
	if (surface->least_fitted > 0 && !source->options.grid_px) {
		clip_hull(mesher, surface, loop);
		add_polyline(mesher, source, chain, mesher->inner.items, mesher->inner.count, loop);
	} else {
		add_polyline(mesher, source, chain, mesher->hull.kept.items, mesher->hull.kept.count, loop);
	}
}

static void add_chains(struct sheet_mesher *mesher, const struct sheet_source *source)
{
	for (size_t i = 0; i < mesher->contours.chains.count; i++) {
		const struct chain *chain = &mesher->contours.chains.items[i];
		if (chain->left && chain->right)
			add_inner_chain(mesher, source, chain);
		else
			add_outer_chain(mesher, source, chain);
	}
}

static void add_line(struct sheet_mesher *mesher, struct cdt_point from, struct cdt_point to)
{
	uint32_t a = cdt_add_point(&mesher->cdt, from), b = cdt_add_point(&mesher->cdt, to);
	cdt_add_segment(&mesher->cdt, a, b);
}

/* Lines that cut large surfaces into cells. */
static void add_cell_lines(struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet)
{
	int32_t reach = (int32_t)margin_of(source);
	struct cdt_point low = mesher->cdt.points.items[0], high = mesher->cdt.points.items[2];
	for (uint32_t i = source->sheets->first.items[sheet]; i < source->sheets->first.items[sheet + 1]; i++) {
		const struct surface *surface = &source->surfaces->items.items[source->sheets->members.items[i]];
		if (!sheet_is_large(source, surface))
			continue;
		struct cdt_point min = { (surface->min_x - reach) * MESH_LATTICE, (surface->min_y - reach) * MESH_LATTICE };
		struct cdt_point max = { (surface->max_x + reach) * MESH_LATTICE, (surface->max_y + reach) * MESH_LATTICE };
		min = (struct cdt_point){ min.x > low.x ? min.x : low.x, min.y > low.y ? min.y : low.y };
		max = (struct cdt_point){ max.x < high.x ? max.x : high.x, max.y < high.y ? max.y : high.y };
		const int32_t cell = MESH_CELL_PX * MESH_LATTICE;
		for (int32_t x = cell; x < max.x; x += cell)
			if (x > min.x)
				add_line(mesher, (struct cdt_point){ x, min.y }, (struct cdt_point){ x, max.y });
		for (int32_t y = cell; y < max.y; y += cell)
			if (y > min.y)
				add_line(mesher, (struct cdt_point){ min.x, y }, (struct cdt_point){ max.x, y });
	}
}

/* The regular grid of [S97] 4.2, where the window has a surface. */
static void add_grid(struct sheet_mesher *mesher, uint32_t grid_px)
{
	const struct sheet_window *window = &mesher->window;
	for (uint32_t y = 0; y < window->height; y++) {
		for (uint32_t x = 0; x < window->width; x++) {
			int32_t column = window->x + (int32_t)x, row = window->y + (int32_t)y;
			if (!window->label.items[(size_t)y * window->width + x] || column < 0 || row < 0 ||
				(uint32_t)column % grid_px != grid_px / 2 || (uint32_t)row % grid_px != grid_px / 2)
				continue;
			struct cdt_point point = { column * MESH_LATTICE + MESH_LATTICE / 2,
				row * MESH_LATTICE + MESH_LATTICE / 2 };
			cdt_add_point(&mesher->cdt, point);
		}
	}
}

void sheet_add_segments(struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet)
{
	contours_trace(&mesher->contours, mesher->window.label.items, mesher->window.width, mesher->window.height);
	add_chains(mesher, source);
	add_cell_lines(mesher, source, sheet);
	if (source->options.grid_px)
		add_grid(mesher, source->options.grid_px);
}
