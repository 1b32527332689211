/* One sheet from pixels to patches; cost follows the sheet's bounding box. */
#include "tools/impostor/sheet_mesh.h"

#include <math.h>
#include <string.h>

#include "tools/impostor/triangle_rows.h"

#define RING_PX 1
#define SEAM_PX 2         /* spread over what another sheet shows at the same disparity */
#define CELL_PX 240       /* large surfaces are cut along multiples of this */
#define FOLD_INNER_PX 1.5 /* how far a point on a border moves to the fold; where the sheet ends, ... */
#define FOLD_OUTER_PX 3.0 /* ... and the border was spread by rule of thumb */
#define LEAST_SHARE 0.1   /* of a surface's least disparity: what vertices beyond its pixels keep */

/* What a surface has at a pixel that is not the sheet's own. */
static enum mesh_texel texel_of(
	const struct sheet_source *source, const struct surface *surface, uint32_t x, uint32_t y)
{
	uint32_t pixel = y * source->surfaces->width + x;
	const struct capture_pixel *seen = &source->image->pixels[pixel];
	if (!seen->object)
		return MESH_CUT;
	double expected = plane_at(&surface->plane, x + 0.5, y + 0.5), step = (double)seen->disparity - expected;
	/* Only owned pixels have theirs from the start. */
	float *allowed = &source->tolerance[pixel];
	if (*allowed <= 0 && seen->disparity > 0)
		*allowed =
			(float)displacement_tolerance(source->displacement, x + 0.5, y + 0.5, seen->disparity, source->tau_px);
	return fabs(step) <= (double)*allowed ? MESH_SHOW : step > 0 ? MESH_FILL : MESH_CUT;
}

static const struct surface *surface_of(const struct sheet_source *source, uint32_t label)
{
	return &source->surfaces->items.items[label - 1];
}

static void open_window(struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet)
{
	int32_t margin = (int32_t)(source->options.guard_px + source->options.close_px) + RING_PX + MESH_REACH_PX + 2;
	int32_t min_x = INT32_MAX, min_y = INT32_MAX, max_x = 0, max_y = 0;
	const struct sheets *sheets = source->sheets;
	for (uint32_t i = sheets->first.items[sheet]; i < sheets->first.items[sheet + 1]; i++) {
		const struct surface *surface = &source->surfaces->items.items[sheets->members.items[i]];
		min_x = surface->min_x < min_x ? surface->min_x : min_x;
		min_y = surface->min_y < min_y ? surface->min_y : min_y;
		max_x = surface->max_x > max_x ? surface->max_x : max_x;
		max_y = surface->max_y > max_y ? surface->max_y : max_y;
	}
	mesher->x = min_x - margin;
	mesher->y = min_y - margin;
	mesher->width = (uint32_t)(max_x - min_x + 1 + 2 * margin);
	mesher->height = (uint32_t)(max_y - min_y + 1 + 2 * margin);
	size_t count = (size_t)mesher->width * mesher->height;
	ARRAY_RESERVE(&mesher->label, count);
	memset(mesher->label.items, 0, count * sizeof(uint32_t));
	ARRAY_RESERVE(&mesher->seam, count);
	memset(mesher->seam.items, 0, count);
	mesher->front.count = 0;
	for (int32_t y = min_y; y <= max_y; y++) {
		const uint32_t *row = source->surfaces->label + (size_t)y * source->surfaces->width;
		size_t to = (size_t)(y - mesher->y) * mesher->width + (size_t)(min_x - mesher->x);
		for (int32_t x = min_x; x <= max_x; x++, to++) {
			if (!row[x] || sheets->sheet_of.items[row[x] - 1] != sheet)
				continue;
			mesher->label.items[to] = row[x];
			ARRAY_PUSH(&mesher->front, (uint32_t)to);
		}
	}
}

#define LENT (UINT32_C(1) << 31) /* of a label: taken back where it closes no gap */

enum spread { SPREAD_GUARD, SPREAD_RING, SPREAD_LENT };

/* Under what is nearer; over what is tied to it, which is to be overlapped; down to the near ground. */
static bool may_guard(
	struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t step, uint32_t from, uint32_t to)
{
	int64_t x = mesher->x + (int64_t)(to % mesher->width), y = mesher->y + (int64_t)(to / mesher->width);
	if (x < 0 || y < 0 || x >= source->surfaces->width || y >= source->surfaces->height)
		return false;
	size_t pixel = (size_t)y * source->surfaces->width + (size_t)x;
	if (source->open_below[pixel])
		return to == from + mesher->width;
	uint32_t label = mesher->label.items[from], other = source->surfaces->label[pixel];
	enum mesh_texel texel = texel_of(source, surface_of(source, label), (uint32_t)x, (uint32_t)y);
	bool tied = texel == MESH_SHOW || (other && sheets_tied(source->sheets, label - 1, other - 1));
	if (step < SEAM_PX && tied)
		mesher->seam.items[to] = 1;
	return texel == MESH_FILL || (step < SEAM_PX && tied);
}

/* By one pixel a step; every other step diagonally too, which makes octagons of points. */
static void spread(struct sheet_mesher *mesher, const struct sheet_source *source, enum spread how, uint32_t steps)
{
	int64_t width = mesher->width;
	const int64_t offsets[8] = { 1, -1, width, -width, width + 1, width - 1, -width + 1, -width - 1 };
	for (uint32_t step = 0; step < steps; step++) {
		mesher->next_front.count = 0;
		int neighbours = how != SPREAD_GUARD && step % 2 == 0 ? 8 : 4;
		for (size_t i = 0; i < mesher->front.count; i++) {
			uint32_t from = mesher->front.items[i];
			for (int k = 0; k < neighbours; k++) {
				uint32_t to = (uint32_t)(from + offsets[k]);
				if (mesher->label.items[to] || (how == SPREAD_GUARD && !may_guard(mesher, source, step, from, to)))
					continue;
				mesher->label.items[to] = mesher->label.items[from] | (how == SPREAD_LENT ? LENT : 0);
				ARRAY_PUSH(&mesher->next_front, to);
				if (how == SPREAD_LENT)
					ARRAY_PUSH(&mesher->lent, to);
			}
		}
		uint32_t *swap = mesher->front.items;
		size_t capacity = mesher->front.capacity;
		mesher->front.items = mesher->next_front.items;
		mesher->front.capacity = mesher->next_front.capacity;
		mesher->front.count = mesher->next_front.count;
		mesher->next_front.items = swap;
		mesher->next_front.capacity = capacity;
	}
}

/* The rim of what is labelled, for the next spreading. */
static void find_front(struct sheet_mesher *mesher)
{
	mesher->front.count = 0;
	const uint32_t *label = mesher->label.items;
	for (uint32_t y = 1; y + 1 < mesher->height; y++) {
		for (uint32_t x = 1; x + 1 < mesher->width; x++) {
			uint32_t i = y * mesher->width + x;
			if (label[i] && (!label[i - 1] || !label[i + 1] || !label[i - mesher->width] || !label[i + mesher->width]))
				ARRAY_PUSH(&mesher->front, i);
		}
	}
}

/* Takes back lent pixels from the rim inwards, as many steps as they were lent in: what lies between is kept. */
static void take_back(struct sheet_mesher *mesher, uint32_t steps)
{
	const int64_t width = mesher->width;
	const int64_t offsets[8] = { 1, -1, width, -width, width + 1, width - 1, -width + 1, -width - 1 };
	uint32_t *label = mesher->label.items;
	for (uint32_t step = 0; step < steps; step++) {
		int neighbours = step % 2 == 0 ? 8 : 4;
		size_t left = 0;
		mesher->next_front.count = 0;
		for (size_t i = 0; i < mesher->lent.count; i++) {
			uint32_t at = mesher->lent.items[i];
			bool rim = false;
			for (int k = 0; k < neighbours && !rim; k++)
				rim = !label[at + offsets[k]];
			if (rim)
				ARRAY_PUSH(&mesher->next_front, at);
			else
				mesher->lent.items[left++] = at;
		}
		mesher->lent.count = left;
		for (size_t i = 0; i < mesher->next_front.count; i++)
			label[mesher->next_front.items[i]] = 0;
	}
}

/* Closes gaps (a morphological closing): lends pixels all around, and takes back those that no gap's other side
 * reaches. */
static void close_gaps(struct sheet_mesher *mesher, const struct sheet_source *source)
{
	find_front(mesher);
	mesher->lent.count = 0;
	spread(mesher, source, SPREAD_LENT, source->options.close_px);
	take_back(mesher, source->options.close_px);
	for (size_t i = 0; i < mesher->lent.count; i++)
		mesher->label.items[mesher->lent.items[i]] &= ~LENT;
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
			meet(&meeting, x < 0 || y < 0 || x >= mesher->width || y >= mesher->height
							   ? 0
							   : mesher->label.items[(size_t)y * mesher->width + (size_t)x]);
	return meeting;
}

/*
 * Moves a point to where the planes that meet there have the same disparity: along a fold the pixels know the border to
 * half a pixel only, and the planes know it exactly. Least squares over the differences to the first plane.
 */
static void move_to_fold(const struct sheet_source *source, const struct meeting *meeting, double *x, double *y)
{
	const struct plane *first = &surface_of(source, meeting->labels[0])->plane;
	double xx = 0, xy = 0, yy = 0, right_x = 0, right_y = 0;
	for (int i = 1; i < meeting->count; i++) {
		const struct plane *other = &surface_of(source, meeting->labels[i])->plane;
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
	double most = meeting->outer ? FOLD_OUTER_PX : FOLD_INNER_PX;
	if (dx * dx + dy * dy > most * most)
		return;
	*x += dx;
	*y += dy;
}

static struct cdt_point lattice_point(const struct sheet_mesher *mesher, const struct sheet_source *source,
	struct contour_point point, const struct meeting *meeting)
{
	double x = (double)point.x + mesher->x, y = (double)point.y + mesher->y;
	if (meeting->count > 1)
		move_to_fold(source, meeting, &x, &y);
	struct cdt_point min = mesher->cdt.points.items[0], max = mesher->cdt.points.items[2];
	return (struct cdt_point){
		clamped(x * MESH_LATTICE, min.x, max.x, (int32_t)source->surfaces->width * MESH_LATTICE),
		clamped(y * MESH_LATTICE, min.y, max.y, (int32_t)source->surfaces->height * MESH_LATTICE),
	};
}

static void start_triangulation(struct sheet_mesher *mesher)
{
	struct cdt_point min = { (mesher->x - 1) * MESH_LATTICE, (mesher->y - 1) * MESH_LATTICE };
	struct cdt_point max = { (mesher->x + (int32_t)mesher->width + 1) * MESH_LATTICE,
		(mesher->y + (int32_t)mesher->height + 1) * MESH_LATTICE };
	cdt_finish(&mesher->cdt);
	cdt_init(&mesher->cdt, min, max);
}

/* How far a point of the window is from where a surface's plane ends: a plane has to end before its horizon, where the
 * disparity is 0, but not before the surface's last pixel. */
static double before_end(const struct sheet_mesher *mesher, const struct surface *surface, struct contour_point point)
{
	double end = fmin(2 * LEAST_SHARE * (double)surface->least_disparity, 0.5 * (double)surface->least_fitted);
	return plane_at(&surface->plane, (double)point.x + mesher->x, (double)point.y + mesher->y) - end;
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
	hull_grow(&mesher->hull, points, chain->count, loop, !chain->left, source->options.price_px2, MESH_REACH_PX);
	if (loop && is_hole(chain, points) && is_idle_hole(mesher, source))
		return;
	const struct surface *surface = surface_of(source, chain->left ? chain->left : chain->right);
	if (surface->least_fitted > 0) {
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

static bool is_large(const struct sheet_source *source, const struct surface *surface)
{
	uint32_t margin = 2 * (source->options.guard_px + RING_PX + MESH_REACH_PX + 2);
	return surface->max_x - surface->min_x + 1u + margin > MESH_PATCH_PX ||
		   surface->max_y - surface->min_y + 1u + margin > MESH_PATCH_PX;
}

static void add_line(struct sheet_mesher *mesher, struct cdt_point from, struct cdt_point to)
{
	uint32_t a = cdt_add_point(&mesher->cdt, from), b = cdt_add_point(&mesher->cdt, to);
	cdt_add_segment(&mesher->cdt, a, b);
}

/* Lines that cut large surfaces into cells. */
static void add_cell_lines(struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet)
{
	int32_t reach = (int32_t)source->options.guard_px + RING_PX + MESH_REACH_PX + 1;
	struct cdt_point low = mesher->cdt.points.items[0], high = mesher->cdt.points.items[2];
	for (uint32_t i = source->sheets->first.items[sheet]; i < source->sheets->first.items[sheet + 1]; i++) {
		const struct surface *surface = &source->surfaces->items.items[source->sheets->members.items[i]];
		if (!is_large(source, surface))
			continue;
		struct cdt_point min = { (surface->min_x - reach) * MESH_LATTICE, (surface->min_y - reach) * MESH_LATTICE };
		struct cdt_point max = { (surface->max_x + reach) * MESH_LATTICE, (surface->max_y + reach) * MESH_LATTICE };
		min = (struct cdt_point){ min.x > low.x ? min.x : low.x, min.y > low.y ? min.y : low.y };
		max = (struct cdt_point){ max.x < high.x ? max.x : high.x, max.y < high.y ? max.y : high.y };
		const int32_t cell = CELL_PX * MESH_LATTICE;
		for (int32_t x = cell; x < max.x; x += cell)
			if (x > min.x)
				add_line(mesher, (struct cdt_point){ x, min.y }, (struct cdt_point){ x, max.y });
		for (int32_t y = cell; y < max.y; y += cell)
			if (y > min.y)
				add_line(mesher, (struct cdt_point){ min.x, y }, (struct cdt_point){ max.x, y });
	}
}

struct corners {
	double x[3], y[3]; /* px of the image */
};

static struct corners corners_of(const struct cdt *cdt, uint32_t triangle)
{
	struct corners corners;
	for (int i = 0; i < 3; i++) {
		struct cdt_point point = cdt->points.items[cdt->triangles.items[triangle].corner[i]];
		corners.x[i] = (double)point.x / MESH_LATTICE;
		corners.y[i] = (double)point.y / MESH_LATTICE;
	}
	return corners;
}

/* Triangles on the same side of all segments, from one of them. Returns whether they reach the rectangle's corners:
 * then they are outside. */
static bool gather_face(struct sheet_mesher *mesher, uint32_t start, uint32_t face)
{
	bool outside = false;
	mesher->members.count = 0;
	mesher->face.items[start] = face;
	ARRAY_PUSH(&mesher->members, start);
	for (size_t i = 0; i < mesher->members.count; i++) {
		const struct cdt_triangle *triangle = &mesher->cdt.triangles.items[mesher->members.items[i]];
		for (int side = 0; side < 3; side++) {
			outside |= triangle->corner[side] < 4;
			uint32_t neighbour = triangle->neighbour[side];
			if (triangle->fixed[side] || neighbour == CDT_NONE || mesher->face.items[neighbour] != UINT32_MAX)
				continue;
			mesher->face.items[neighbour] = face;
			ARRAY_PUSH(&mesher->members, neighbour);
		}
	}
	return outside;
}

static uint32_t label_at(const struct sheet_mesher *mesher, int64_t x, int64_t y)
{
	x -= mesher->x;
	y -= mesher->y;
	if (x < 0 || y < 0 || x >= mesher->width || y >= mesher->height)
		return 0;
	return mesher->label.items[(size_t)y * mesher->width + (size_t)x];
}

/* The label of most pixel centres of the gathered face, if any has one: outlines only grow, so a face with a labelled
 * pixel is inside. Of its first triangle's middle if there are no pixel centres at all. */
static uint32_t vote(struct sheet_mesher *mesher)
{
	uint32_t best = 0, best_votes = 0, pixels = 0;
	int32_t right = mesher->x + (int32_t)mesher->width, bottom = mesher->y + (int32_t)mesher->height;
	for (int pass = 0; pass < 2; pass++) { /* the second takes the votes back */
		for (size_t i = 0; i < mesher->members.count; i++) {
			struct corners corners = corners_of(&mesher->cdt, mesher->members.items[i]);
			struct pixel_run rows = triangle_rows(corners.y, bottom);
			for (int32_t y = rows.from; y < rows.to; y++) {
				struct pixel_run run = triangle_run(corners.x, corners.y, y, right);
				for (int32_t x = run.from; x < run.to; x++) {
					uint32_t label = label_at(mesher, x, y);
					uint32_t *votes = &mesher->votes.items[label];
					*votes = pass || !label ? 0 : *votes + 1;
					pixels++;
					if (*votes > best_votes) {
						best = label;
						best_votes = *votes;
					}
				}
			}
		}
	}
	if (pixels)
		return best;
	struct corners corners = corners_of(&mesher->cdt, mesher->members.items[0]);
	return label_at(mesher, (int64_t)floor((corners.x[0] + corners.x[1] + corners.x[2]) / 3),
		(int64_t)floor((corners.y[0] + corners.y[1] + corners.y[2]) / 3));
}

static void label_faces(struct sheet_mesher *mesher, size_t surfaces)
{
	size_t count = mesher->cdt.triangles.count;
	ARRAY_RESERVE(&mesher->face, count);
	if (mesher->votes.capacity < surfaces + 1) {
		ARRAY_RESERVE(&mesher->votes, surfaces + 1);
		memset(mesher->votes.items, 0, mesher->votes.capacity * sizeof(uint32_t));
	}
	memset(mesher->face.items, 0xff, count * sizeof(uint32_t));
	for (uint32_t i = 0; i < count; i++) {
		if (mesher->face.items[i] != UINT32_MAX)
			continue;
		uint32_t label = gather_face(mesher, i, 0) ? 0 : vote(mesher);
		for (size_t k = 0; k < mesher->members.count; k++)
			mesher->face.items[mesher->members.items[k]] = label;
	}
}

/* Kept triangles in the order of patches: by surface, then by cell of large ones, then as they are. */
static void order_triangles(struct sheet_mesher *mesher, const struct sheet_source *source)
{
	mesher->order.count = 0;
	for (uint32_t i = 0; i < mesher->cdt.triangles.count; i++) {
		uint32_t label = mesher->face.items[i];
		if (!label)
			continue;
		uint64_t cell = 0;
		if (is_large(source, surface_of(source, label))) {
			struct corners corners = corners_of(&mesher->cdt, i);
			uint64_t column = (uint64_t)((corners.x[0] + corners.x[1] + corners.x[2]) / (3 * CELL_PX));
			uint64_t row = (uint64_t)((corners.y[0] + corners.y[1] + corners.y[2]) / (3 * CELL_PX));
			cell = row << 5 | column;
		}
		ARRAY_PUSH(&mesher->order, (uint64_t)label << 38 | cell << 28 | i);
	}
}

static int by_value(const void *left, const void *right)
{
	uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
	return (a > b) - (a < b);
}

/* Each point's disparity: the mean of the surfaces that meet there. */
static void place_points(struct sheet_mesher *mesher, const struct sheet_source *source)
{
	size_t count = mesher->cdt.points.count;
	ARRAY_RESERVE(&mesher->stamp, count);
	ARRAY_RESERVE(&mesher->disparity, count);
	ARRAY_RESERVE(&mesher->sharing, count);
	memset(mesher->stamp.items, 0, count * sizeof(uint32_t));
	memset(mesher->sharing.items, 0, count * sizeof(uint32_t));
	memset(mesher->disparity.items, 0, count * sizeof(double));
	for (size_t i = 0; i < mesher->order.count; i++) {
		const struct cdt_triangle *triangle = &mesher->cdt.triangles.items[mesher->order.items[i] & 0xfffffff];
		uint32_t label = (uint32_t)(mesher->order.items[i] >> 38);
		const struct surface *surface = surface_of(source, label);
		for (int k = 0; k < 3; k++) {
			uint32_t point = triangle->corner[k];
			if (mesher->stamp.items[point] == label)
				continue;
			mesher->stamp.items[point] = label;
			struct cdt_point at = mesher->cdt.points.items[point];
			double w = plane_at(&surface->plane, (double)at.x / MESH_LATTICE, (double)at.y / MESH_LATTICE);
			mesher->disparity.items[point] += fmax(w, LEAST_SHARE * (double)surface->least_disparity);
			mesher->sharing.items[point]++;
		}
	}
	for (size_t i = 0; i < count; i++)
		mesher->disparity.items[i] /= mesher->sharing.items[i] ? mesher->sharing.items[i] : 1;
	memset(mesher->stamp.items, 0xff, count * sizeof(uint32_t));
}

static void add_texels(const struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t label,
	uint32_t sheet, struct impostor_mesh *mesh, struct mesh_patch *patch)
{
	patch->first_texel = (uint32_t)mesh->texels.count;
	const struct surfaces *surfaces = source->surfaces;
	const struct surface *surface = surface_of(source, label);
	for (uint32_t y = patch->min_y; y <= patch->max_y; y++) {
		for (uint32_t x = patch->min_x; x <= patch->max_x; x++) {
			uint32_t pixel = y * surfaces->width + x, own = surfaces->label[pixel];
			size_t at = (size_t)((int32_t)y - mesher->y) * mesher->width + (size_t)((int32_t)x - mesher->x);
			bool shown = mesher->seam.items[at] || (own && source->sheets->sheet_of.items[own - 1] == sheet);
			enum mesh_texel texel = MESH_SHOW;
			if (!shown)
				texel = source->open_below[pixel] ? MESH_FILL : texel_of(source, surface, x, y);
			/* What agrees, but is not the sheet's, is shown by others. */
			if (!shown && texel == MESH_SHOW)
				texel = MESH_CUT;
			ARRAY_PUSH(&mesh->texels, (uint8_t)texel);
		}
	}
}

/* One patch from the ordered triangles [from, to). */
static void add_patch(struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet,
	struct impostor_mesh *mesh, size_t from, size_t to)
{
	uint32_t label = (uint32_t)(mesher->order.items[from] >> 38);
	const struct surface *surface = surface_of(source, label);
	struct mesh_patch patch = {
		.first_vertex = (uint32_t)mesh->vertices.count,
		.first_index = (uint32_t)mesh->indices.count,
		.index_count = (uint32_t)(to - from) * 3,
		.normal_oct = { surface->normal_oct[0], surface->normal_oct[1] },
		.kind = surface->kind,
		.view = source->options.view,
	};
	struct cdt_point min = { INT32_MAX, INT32_MAX }, max = { 0, 0 };
	for (size_t i = from; i < to; i++) {
		const struct cdt_triangle *triangle = &mesher->cdt.triangles.items[mesher->order.items[i] & 0xfffffff];
		for (int k = 0; k < 3; k++) {
			uint32_t point = triangle->corner[k], *stamp = &mesher->stamp.items[point];
			struct cdt_point at = mesher->cdt.points.items[point];
			if (*stamp == UINT32_MAX || *stamp < patch.first_vertex) {
				*stamp = (uint32_t)mesh->vertices.count;
				float disparity = (float)mesher->disparity.items[point];
				ARRAY_PUSH(&mesh->vertices,
					(struct mesh_vertex){ (float)at.x / MESH_LATTICE, (float)at.y / MESH_LATTICE, disparity });
				patch.disparity_max = fmaxf(patch.disparity_max, disparity);
				min = (struct cdt_point){ at.x < min.x ? at.x : min.x, at.y < min.y ? at.y : min.y };
				max = (struct cdt_point){ at.x > max.x ? at.x : max.x, at.y > max.y ? at.y : max.y };
			}
			ARRAY_PUSH(&mesh->indices, *stamp - patch.first_vertex);
		}
	}
	patch.vertex_count = (uint32_t)mesh->vertices.count - patch.first_vertex;
	patch.min_x = (uint16_t)(min.x / MESH_LATTICE);
	patch.min_y = (uint16_t)(min.y / MESH_LATTICE);
	patch.max_x = (uint16_t)((max.x - 1) / MESH_LATTICE);
	patch.max_y = (uint16_t)((max.y - 1) / MESH_LATTICE);
	add_texels(mesher, source, label, sheet, mesh, &patch);
	ARRAY_PUSH(&mesh->patches, patch);
}

static void add_patches(
	struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet, struct impostor_mesh *mesh)
{
	for (size_t from = 0, to; from < mesher->order.count; from = to) {
		for (to = from; to < mesher->order.count; to++)
			if (mesher->order.items[to] >> 28 != mesher->order.items[from] >> 28)
				break;
		add_patch(mesher, source, sheet, mesh, from, to);
	}
}

void sheet_mesh(
	struct sheet_mesher *mesher, const struct sheet_source *source, uint32_t sheet, struct impostor_mesh *mesh)
{
	open_window(mesher, source, sheet);
	spread(mesher, source, SPREAD_GUARD, source->options.guard_px);
	close_gaps(mesher, source);
	find_front(mesher);
	spread(mesher, source, SPREAD_RING, RING_PX);
	contours_trace(&mesher->contours, mesher->label.items, mesher->width, mesher->height);
	start_triangulation(mesher);
	add_chains(mesher, source);
	add_cell_lines(mesher, source, sheet);
	mesher->cuts += mesher->cdt.cuts;
	label_faces(mesher, source->surfaces->items.count);
	order_triangles(mesher, source);
	ARRAY_SORT(&mesher->order, by_value);
	place_points(mesher, source);
	add_patches(mesher, source, sheet, mesh);
}

void sheet_mesher_finish(struct sheet_mesher *mesher)
{
	ARRAY_FINISH(&mesher->label);
	ARRAY_FINISH(&mesher->front);
	ARRAY_FINISH(&mesher->next_front);
	ARRAY_FINISH(&mesher->seam);
	ARRAY_FINISH(&mesher->lent);
	contours_finish(&mesher->contours);
	simplifier_finish(&mesher->simplifier);
	ARRAY_FINISH(&mesher->inner);
	hull_finish(&mesher->hull);
	cdt_finish(&mesher->cdt);
	ARRAY_FINISH(&mesher->face);
	ARRAY_FINISH(&mesher->members);
	ARRAY_FINISH(&mesher->votes);
	ARRAY_FINISH(&mesher->stamp);
	ARRAY_FINISH(&mesher->disparity);
	ARRAY_FINISH(&mesher->sharing);
	ARRAY_FINISH(&mesher->order);
}
