/* Which face is a point in: walks west along its row of a grid to the nearest in-plane edge; exact in integers. A point
 * is treated as lying a trifle north of its coordinates, so that no line of sight passes through a vertex. */
#include "tools/city/graph.h"
#include "tools/city/line_grid.h"

struct face_locator {
	const struct pkg_graph *graph;
	ARRAY(struct line_mm) lines;
	index_array half_of; /* by line: the half-edge that runs along it */
	struct line_grid grid;
};

static void list_edges(struct face_locator *locator)
{
	const struct pkg_graph *graph = locator->graph;
	for (uint32_t e = 0; e < graph->edge_count; e++) {
		if (graph->edges[e].flags & PKG_EDGE_OFF_PLANE)
			continue;
		const struct pkg_point *p = &graph->points[graph->edges[e].first_point];
		for (uint32_t i = 1; i < graph->edges[e].point_count; i++, p++) {
			ARRAY_PUSH(
				&locator->lines, (struct line_mm){ p[0].pos_mm[0], p[0].pos_mm[1], p[1].pos_mm[0], p[1].pos_mm[1] });
			ARRAY_PUSH(&locator->half_of, 2 * e);
		}
	}
}

struct face_locator *face_locator_new(const struct pkg_graph *graph)
{
	size_t capacity = 0;
	struct face_locator *locator = array_grow(NULL, &capacity, 1, sizeof(*locator));
	*locator = (struct face_locator){ .graph = graph };
	list_edges(locator);
	line_grid_init(&locator->grid, locator->lines.items, locator->lines.count);
	return locator;
}

void face_locator_free(struct face_locator *locator)
{
	if (!locator)
		return;
	line_grid_finish(&locator->grid);
	ARRAY_FINISH(&locator->lines);
	ARRAY_FINISH(&locator->half_of);
	array_free(locator);
}

/* Where a line crosses the point's parallel: x = num / den, and the line's slope there dx / den. */
struct crossing_x {
	__int128 num;
	int64_t den, dx;
	uint32_t half; /* the half-edge with the face on the line's east side */
};

static bool crosses(struct line_mm line, uint32_t half, int64_t y, struct crossing_x *out)
{
	bool upward = line.by > line.ay;
	if (!upward)
		line = (struct line_mm){ line.bx, line.by, line.ax, line.ay };
	if (y < line.ay || y >= line.by)
		return false;
	int64_t dx = (int64_t)line.bx - line.ax, dy = (int64_t)line.by - line.ay;
	*out =
		(struct crossing_x){ (__int128)line.ax * dy + (__int128)(y - line.ay) * dx, dy, dx, upward ? half ^ 1u : half };
	return true;
}

static bool west_of_point(const struct crossing_x *c, int64_t x)
{
	__int128 at = (__int128)x * c->den;
	return c->num < at || (c->num == at && c->dx < 0);
}

static bool east_of(const struct crossing_x *a, const struct crossing_x *b)
{
	__int128 left = a->num * b->den, right = b->num * a->den;
	if (left != right)
		return left > right;
	return (__int128)a->dx * b->den > (__int128)b->dx * a->den;
}

/* The half-edge that sees the point on its left, or PKG_NONE. */
static uint32_t nearest_west(const struct face_locator *locator, int64_t x, int64_t y)
{
	const struct line_grid *grid = &locator->grid;
	struct crossing_x best = { .half = PKG_NONE }, c;
	int64_t row = line_grid_row(grid, y);
	for (int64_t column = line_grid_column(grid, x); column >= 0; column--) {
		int64_t cell = row * grid->columns + column;
		for (uint32_t i = grid->first[cell]; i < grid->first[cell + 1]; i++) {
			uint32_t line = grid->items[i];
			if (!crosses(locator->lines.items[line], locator->half_of.items[line], y, &c) || !west_of_point(&c, x))
				continue;
			if (best.half == PKG_NONE || east_of(&c, &best))
				best = c;
		}
		int64_t cell_west = grid->west + column * grid->cell_mm;
		if (best.half != PKG_NONE && best.num >= (__int128)cell_west * best.den)
			break;
	}
	return best.half;
}

uint32_t face_locator_find(const struct face_locator *locator, int64_t east_mm, int64_t north_mm)
{
	uint32_t half = nearest_west(locator, east_mm, north_mm);
	if (half == PKG_NONE)
		return PKG_NONE;
	uint32_t face = locator->graph->halves[half].face;
	return locator->graph->faces[face].flags & PKG_FACE_OUTER ? locator->graph->faces[face].parent : face;
}

struct dvec2 polygon_inner_point(const struct polygon *polygon)
{
	struct dvec2 min, max;
	ring_bounds(&polygon->outer, &min, &max);
	ARRAY(double) xs = { 0 };
	struct dvec2 best = polygon->outer.points[0];
	double best_width = 0.0;
	for (int level = 1; level < 8 && best_width <= 0.0;
		 level++) { /* 1/2, 1/4, 3/4, 1/8 ... should a line see nothing */
		static const double fractions[] = { 0.5, 0.5137, 0.27, 0.73, 0.12, 0.88, 0.04, 0.96 };
		double y = min.y + (max.y - min.y) * fractions[level];
		xs.count = 0;
		for (size_t r = 0; r <= polygon->hole_count; r++) {
			const struct ring *ring = r ? &polygon->holes[r - 1] : &polygon->outer;
			for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++) {
				struct dvec2 a = ring->points[i], b = ring->points[j];
				if ((a.y > y) != (b.y > y))
					ARRAY_PUSH(&xs, a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
			}
		}
		for (size_t i = 1; i < xs.count; i++) /* few: insertion sort */
			for (size_t j = i; j && xs.items[j] < xs.items[j - 1]; j--) {
				double swap = xs.items[j];
				xs.items[j] = xs.items[j - 1];
				xs.items[j - 1] = swap;
			}
		for (size_t i = 0; i + 1 < xs.count; i += 2)
			if (xs.items[i + 1] - xs.items[i] > best_width) {
				best_width = xs.items[i + 1] - xs.items[i];
				best = (struct dvec2){ (xs.items[i] + xs.items[i + 1]) / 2.0, y };
			}
	}
	ARRAY_FINISH(&xs);
	return best;
}
