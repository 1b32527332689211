#include "tools/bake/borders.h"

#include <math.h>
#include <string.h>

struct border_edge {
	uint32_t ends[2];
	double tolerance_m;
	bool taken;
};

struct borders {
	const struct partition *from;
	ARRAY(struct border_edge) edges;
	uint32_t *first_at; /* by vertex, into edge_at; one more at the end */
	uint32_t *edge_at;
	ARRAY(struct dvec2) chain;
	ARRAY(uint8_t) kept;
};

static void find_edges(struct borders *borders, border_tolerance_fn tolerance, const void *context)
{
	const struct cdt *cdt = &borders->from->cdt;
	for (uint32_t t = 0; t < cdt->triangles.count; t++)
		for (int i = 0; i < 3; i++) {
			const struct cdt_triangle *triangle = &cdt->triangles.items[t];
			uint32_t u = triangle->neighbour[i];
			if (u == CDT_NONE || u < t || borders->from->face_of.items[t] == borders->from->face_of.items[u])
				continue;
			double far = tolerance(context, borders->from->face_of.items[t], borders->from->face_of.items[u]);
			if (far >= 0.0)
				ARRAY_PUSH(&borders->edges,
					(struct border_edge){
						{ triangle->corner[(i + 1) % 3], triangle->corner[(i + 2) % 3] }, far, false });
		}
}

static void index_edges(struct borders *borders)
{
	size_t vertices = borders->from->cdt.points.count;
	borders->first_at = array_grow(NULL, &(size_t){ 0 }, vertices + 2, sizeof(*borders->first_at));
	borders->edge_at = array_grow(NULL, &(size_t){ 0 }, 2 * borders->edges.count + 1, sizeof(*borders->edge_at));
	memset(borders->first_at, 0, (vertices + 2) * sizeof(*borders->first_at));
	for (size_t i = 0; i < borders->edges.count; i++)
		for (int end = 0; end < 2; end++)
			borders->first_at[borders->edges.items[i].ends[end] + 2]++;
	for (size_t v = 0; v < vertices; v++)
		borders->first_at[v + 2] += borders->first_at[v + 1];
	for (uint32_t i = 0; i < borders->edges.count; i++)
		for (int end = 0; end < 2; end++)
			borders->edge_at[borders->first_at[borders->edges.items[i].ends[end] + 1]++] = i;
}

static uint32_t degree(const struct borders *borders, uint32_t v)
{
	return borders->first_at[v + 1] - borders->first_at[v];
}

/* Ramer 1972, Douglas and Peucker 1973: keeps what is needed between two kept points. */
static void keep_between(struct borders *borders, size_t first, size_t last, double tolerance_m)
{
	const struct dvec2 *points = borders->chain.items;
	struct dvec2 d = dvec2_sub(points[last], points[first]);
	double square = dvec2_dot(d, d), worst = tolerance_m;
	size_t farthest = 0;
	for (size_t i = first + 1; i < last; i++) {
		struct dvec2 p = dvec2_sub(points[i], points[first]);
		double t = square > 0.0 ? fmin(fmax(dvec2_dot(p, d) / square, 0.0), 1.0) : 0.0;
		double off = dvec2_length(dvec2_sub(p, dvec2_scale(d, t)));
		if (off > worst) {
			worst = off;
			farthest = i;
		}
	}
	if (!farthest)
		return;
	borders->kept.items[farthest] = 1;
	keep_between(borders, first, farthest, tolerance_m);
	keep_between(borders, farthest, last, tolerance_m);
}

static void draw_chain(struct borders *borders, double tolerance_m, struct partition *to)
{
	size_t count = borders->chain.count, last = 0;
	borders->kept.count = 0;
	for (size_t i = 0; i < count; i++)
		ARRAY_PUSH(&borders->kept, (uint8_t)(i == 0 || i + 1 == count));
	keep_between(borders, 0, count - 1, tolerance_m);
	for (size_t i = 1; i < count; i++)
		if (borders->kept.items[i]) {
			partition_cut(to, borders->chain.items[last], borders->chain.items[i]);
			last = i;
		}
}

/* From an edge's end `v` along vertices that no other border meets. */
static void follow(struct borders *borders, uint32_t edge, uint32_t v, struct partition *to)
{
	double tolerance_m = borders->edges.items[edge].tolerance_m;
	borders->chain.count = 0;
	ARRAY_PUSH(&borders->chain, partition_vertex(borders->from, v));
	for (bool more = true; more;) {
		struct border_edge *at = &borders->edges.items[edge];
		at->taken = true;
		v = at->ends[0] == v ? at->ends[1] : at->ends[0];
		ARRAY_PUSH(&borders->chain, partition_vertex(borders->from, v));
		more = false;
		for (uint32_t i = borders->first_at[v]; degree(borders, v) == 2 && i < borders->first_at[v + 1]; i++)
			if (!borders->edges.items[borders->edge_at[i]].taken) {
				edge = borders->edge_at[i];
				more = true;
			}
	}
	draw_chain(borders, tolerance_m, to);
}

void borders_redraw(
	const struct partition *from, border_tolerance_fn tolerance, const void *context, struct partition *to)
{
	struct borders borders = { .from = from };
	find_edges(&borders, tolerance, context);
	index_edges(&borders);
	for (int loops = 0; loops < 2; loops++) /* chains between ends first; what is left are rings */
		for (uint32_t i = 0; i < borders.edges.count; i++)
			for (int end = 0; end < 2; end++) {
				const struct border_edge *edge = &borders.edges.items[i];
				if (!edge->taken && (loops || degree(&borders, edge->ends[end]) != 2))
					follow(&borders, i, edge->ends[end], to);
			}
	ARRAY_FINISH(&borders.edges);
	ARRAY_FINISH(&borders.chain);
	ARRAY_FINISH(&borders.kept);
	array_free(borders.first_at);
	array_free(borders.edge_at);
}
