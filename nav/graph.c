/* Queries over the street graph. Everything is constant time or logarithmic, but for graph_nearest(), whose cost is the
 * number of edges in the cells around the place. */
#include "nav/graph.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>

#define LEAVE_CHORD_M 12.0
#define CELL_MM INT64_C(80000)
#define CELLS_MAX 262144

static const struct pkg_point *first_point(const struct graph *graph, const struct pkg_edge *edge)
{
	return &graph->net->points[edge->first_point];
}

static uint32_t edge_length_mm(const struct graph *graph, const struct pkg_edge *edge)
{
	return graph->along_mm[edge->first_point + edge->point_count - 1];
}

double graph_length_m(const struct graph *graph, uint32_t half)
{
	return edge_length_mm(graph, graph_edge(graph, half)) * 1e-3;
}

static double span_mm(const struct pkg_point *a, const struct pkg_point *b)
{
	return hypot((double)b->pos_mm[0] - a->pos_mm[0], (double)b->pos_mm[1] - a->pos_mm[1]);
}

static void measure_edge(struct graph *graph, const struct pkg_edge *edge)
{
	const struct pkg_point *points = first_point(graph, edge);
	uint32_t *along = &graph->along_mm[edge->first_point];
	double sum = 0.0;
	along[0] = 0;
	for (uint32_t i = 1; i < edge->point_count; i++) {
		sum = fmin(sum + span_mm(&points[i - 1], &points[i]), 4e9);
		along[i] = (uint32_t)(sum + 0.5);
	}
}

/* Segment of an edge that holds a distance along it; never one of length 0 unless the whole edge is. */
static uint32_t find_segment(const struct graph *graph, const struct pkg_edge *edge, double along_mm)
{
	const uint32_t *along = &graph->along_mm[edge->first_point];
	uint32_t low = 0, high = edge->point_count - 1;
	while (high - low > 1) {
		uint32_t mid = (low + high) / 2;
		if (along[mid] <= along_mm)
			low = mid;
		else
			high = mid;
	}
	while (low > 0 && along[low + 1] == along[low])
		low--;
	return low;
}

struct graph_pose graph_at(const struct graph *graph, uint32_t half, double along_m)
{
	const struct pkg_edge *edge = graph_edge(graph, half);
	double length = edge_length_mm(graph, edge);
	double at = fmin(fmax(along_m * 1e3, 0.0), length);
	if (half & 1)
		at = length - at;
	uint32_t segment = find_segment(graph, edge, at);
	const struct pkg_point *a = first_point(graph, edge) + segment, *b = a + 1;
	double a_mm = graph->along_mm[edge->first_point + segment];
	double b_mm = graph->along_mm[edge->first_point + segment + 1];
	double t = b_mm > a_mm ? fmin((at - a_mm) / (b_mm - a_mm), 1.0) : 0.0;
	double d[3];
	for (int k = 0; k < 3; k++)
		d[k] = (double)b->pos_mm[k] - a->pos_mm[k];
	double sign = half & 1 ? -1.0 : 1.0;
	return (struct graph_pose){
		.at_m = { (a->pos_mm[0] + t * d[0]) * 1e-3, (a->pos_mm[1] + t * d[1]) * 1e-3,
			(a->pos_mm[2] + t * d[2]) * 1e-3 },
		.heading_rad = atan2(sign * d[0], sign * d[1]),
	};
}

static int32_t chord_bam(const struct graph *graph, uint32_t half)
{
	double length = graph_length_m(graph, half);
	struct graph_pose a = graph_at(graph, half, 0.0);
	struct graph_pose b = graph_at(graph, half, fmin(length, LEAVE_CHORD_M));
	return bam_from_dir(b.at_m.x - a.at_m.x, b.at_m.y - a.at_m.y);
}

/* --- grid --- */

static void grid_bounds(struct graph *graph)
{
	const struct pkg_graph *net = graph->net;
	int64_t max_mm[2] = { 0, 0 };
	for (int k = 0; k < 2; k++) {
		graph->min_mm[k] = net->point_count ? net->points[0].pos_mm[k] : 0;
		max_mm[k] = graph->min_mm[k];
		for (uint32_t i = 1; i < net->point_count; i++) {
			int64_t v = net->points[i].pos_mm[k];
			graph->min_mm[k] = v < graph->min_mm[k] ? v : graph->min_mm[k];
			max_mm[k] = v > max_mm[k] ? v : max_mm[k];
		}
	}
	int64_t width = max_mm[0] - graph->min_mm[0], height = max_mm[1] - graph->min_mm[1];
	graph->cell_mm = CELL_MM;
	while ((width / graph->cell_mm + 1) * (height / graph->cell_mm + 1) > CELLS_MAX)
		graph->cell_mm *= 2;
	graph->columns = (uint32_t)(width / graph->cell_mm + 1);
	graph->rows = (uint32_t)(height / graph->cell_mm + 1);
}

static uint32_t clamp_cell(int64_t offset_mm, int64_t cell_mm, uint32_t count)
{
	if (offset_mm < 0)
		return 0;
	int64_t cell = offset_mm / cell_mm;
	return cell >= count ? count - 1 : (uint32_t)cell;
}

typedef void visit_cell(struct graph *graph, uint32_t cell, uint32_t edge, uint32_t *stamp);

static void count_cell(struct graph *graph, uint32_t cell, uint32_t edge, uint32_t *stamp)
{
	if (stamp[cell] == edge + 1)
		return;
	stamp[cell] = edge + 1;
	graph->cell_first[cell + 1]++;
}

/* While filling, cell_first[cell + 1] is the end of what is written so far; it ends as the start of the next cell. */
static void fill_cell(struct graph *graph, uint32_t cell, uint32_t edge, uint32_t *stamp)
{
	if (stamp[cell] == edge + 1)
		return;
	stamp[cell] = edge + 1;
	graph->cell_edge[graph->cell_first[cell + 1]++] = edge;
}

/* Cells of one segment: row by row, the columns between where it enters and leaves the row, one more for rounding. */
static void visit_segment(struct graph *graph, const struct pkg_point *a, const struct pkg_point *b, uint32_t edge,
	visit_cell *visit, uint32_t *stamp)
{
	if (a->pos_mm[1] > b->pos_mm[1]) {
		const struct pkg_point *swap = a;
		a = b;
		b = swap;
	}
	int64_t ax = a->pos_mm[0], ay = a->pos_mm[1], bx = b->pos_mm[0], by = b->pos_mm[1];
	uint32_t row0 = clamp_cell(ay - graph->min_mm[1], graph->cell_mm, graph->rows);
	uint32_t row1 = clamp_cell(by - graph->min_mm[1], graph->cell_mm, graph->rows);
	for (uint32_t row = row0; row <= row1; row++) {
		double y0 = (double)(graph->min_mm[1] + row * graph->cell_mm), y1 = y0 + (double)graph->cell_mm;
		double t0 = by > ay ? fmin(fmax((y0 - (double)ay) / (double)(by - ay), 0.0), 1.0) : 0.0;
		double t1 = by > ay ? fmin(fmax((y1 - (double)ay) / (double)(by - ay), 0.0), 1.0) : 1.0;
		double x0 = (double)ax + t0 * (double)(bx - ax), x1 = (double)ax + t1 * (double)(bx - ax);
		int64_t west = (int64_t)floor(fmin(x0, x1)) - 1, east = (int64_t)ceil(fmax(x0, x1)) + 1;
		uint32_t col1 = clamp_cell(east - graph->min_mm[0], graph->cell_mm, graph->columns);
		for (uint32_t col = clamp_cell(west - graph->min_mm[0], graph->cell_mm, graph->columns); col <= col1; col++)
			visit(graph, row * graph->columns + col, edge, stamp);
	}
}

static void visit_all(struct graph *graph, visit_cell *visit, uint32_t *stamp)
{
	for (uint32_t e = 0; e < graph->net->edge_count; e++) {
		const struct pkg_edge *edge = &graph->net->edges[e];
		const struct pkg_point *points = first_point(graph, edge);
		for (uint32_t i = 1; i < edge->point_count; i++)
			visit_segment(graph, &points[i - 1], &points[i], e, visit, stamp);
	}
}

static int grid_init(struct graph *graph, struct arena *arena)
{
	grid_bounds(graph);
	uint32_t cells = graph->columns * graph->rows;
	graph->cell_first = ARENA_ARRAY(arena, uint32_t, cells + 1);
	uint32_t *stamp = ARENA_ARRAY(arena, uint32_t, cells);
	if (!graph->cell_first || !stamp)
		return -ENOMEM;
	visit_all(graph, count_cell, stamp);
	for (uint32_t c = 0; c < cells; c++)
		graph->cell_first[c + 1] += graph->cell_first[c];
	uint32_t total = graph->cell_first[cells];
	graph->cell_edge = ARENA_ARRAY(arena, uint32_t, total + 1);
	if (!graph->cell_edge)
		return -ENOMEM;
	for (uint32_t c = cells; c > 0; c--)
		graph->cell_first[c] = graph->cell_first[c - 1];
	for (uint32_t c = 0; c < cells; c++)
		stamp[c] = 0;
	visit_all(graph, fill_cell, stamp);
	return 0;
}

int graph_init(struct graph *graph, struct arena *arena, const struct pkg_graph *net, bool right_hand_traffic)
{
	*graph = (struct graph){ .net = net, .right_hand = right_hand_traffic };
	graph->along_mm = ARENA_ARRAY(arena, uint32_t, net->point_count + 1);
	graph->leave_bam = ARENA_ARRAY(arena, int32_t, net->half_count + 1);
	if (!graph->along_mm || !graph->leave_bam)
		return -ENOMEM;
	for (uint32_t e = 0; e < net->edge_count; e++)
		measure_edge(graph, &net->edges[e]);
	for (uint32_t h = 0; h < net->half_count; h++)
		graph->leave_bam[h] = chord_bam(graph, h);
	return grid_init(graph, arena);
}

struct graph_hit graph_project(const struct graph *graph, uint32_t edge_index, struct dvec2 at_m)
{
	const struct pkg_edge *edge = &graph->net->edges[edge_index];
	const struct pkg_point *points = first_point(graph, edge);
	double x = at_m.x * 1e3, y = at_m.y * 1e3, best = INFINITY, along = 0.0;
	for (uint32_t i = 1; i < edge->point_count; i++) {
		const int32_t *a = points[i - 1].pos_mm, *b = points[i].pos_mm;
		double dx = (double)b[0] - a[0], dy = (double)b[1] - a[1], length2 = dx * dx + dy * dy;
		double t = length2 > 0.0 ? ((x - a[0]) * dx + (y - a[1]) * dy) / length2 : 0.0;
		t = fmin(fmax(t, 0.0), 1.0);
		double distance = hypot(x - a[0] - t * dx, y - a[1] - t * dy);
		if (distance < best) {
			best = distance;
			along = graph->along_mm[edge->first_point + i - 1] + t * sqrt(length2);
		}
	}
	return (struct graph_hit){ .edge = edge_index, .along_m = along * 1e-3, .distance_m = best * 1e-3 };
}

/* Keeps `out` sorted by distance, then edge. Returns the new count. */
static uint32_t insert_hit(struct graph_hit *out, uint32_t count, uint32_t max, struct graph_hit hit)
{
	uint32_t at = count;
	while (at > 0 && (out[at - 1].distance_m > hit.distance_m ||
						 (out[at - 1].distance_m == hit.distance_m && out[at - 1].edge > hit.edge)))
		at--;
	if (at == max)
		return count;
	uint32_t last = count < max ? count : max - 1;
	for (uint32_t i = last; i > at; i--)
		out[i] = out[i - 1];
	out[at] = hit;
	return last + 1;
}

static bool has_hit(const struct graph_hit *out, uint32_t count, uint32_t edge)
{
	for (uint32_t i = 0; i < count; i++)
		if (out[i].edge == edge)
			return true;
	return false;
}

uint32_t graph_nearest(
	const struct graph *graph, struct dvec2 at_m, double radius_m, struct graph_hit *out, uint32_t max)
{
	if (!max || !graph->net->edge_count || !isfinite(at_m.x) || !isfinite(at_m.y) || fabs(at_m.x) > 1e7 ||
		fabs(at_m.y) > 1e7)
		return 0;
	double r = fmin(radius_m, 1e7) * 1e3;
	int64_t west = (int64_t)(at_m.x * 1e3 - r) - graph->min_mm[0];
	int64_t east = (int64_t)(at_m.x * 1e3 + r) - graph->min_mm[0];
	int64_t south = (int64_t)(at_m.y * 1e3 - r) - graph->min_mm[1];
	int64_t north = (int64_t)(at_m.y * 1e3 + r) - graph->min_mm[1];
	uint32_t col0 = clamp_cell(west, graph->cell_mm, graph->columns);
	uint32_t col1 = clamp_cell(east, graph->cell_mm, graph->columns);
	uint32_t row0 = clamp_cell(south, graph->cell_mm, graph->rows);
	uint32_t row1 = clamp_cell(north, graph->cell_mm, graph->rows);
	uint32_t count = 0;
	for (uint32_t row = row0; row <= row1; row++) {
		for (uint32_t c = row * graph->columns + col0; c <= row * graph->columns + col1; c++) {
			for (uint32_t i = graph->cell_first[c]; i < graph->cell_first[c + 1]; i++) {
				uint32_t edge = graph->cell_edge[i];
				if (!(graph->net->edges[edge].flags & (PKG_EDGE_FORWARD | PKG_EDGE_BACKWARD)) ||
					has_hit(out, count, edge))
					continue;
				struct graph_hit hit = graph_project(graph, edge, at_m);
				if (hit.distance_m <= radius_m)
					count = insert_hit(out, count, max, hit);
			}
		}
	}
	return count;
}

/* --- moves --- */

bool graph_turn_forbidden(const struct graph *graph, uint32_t from, uint32_t to)
{
	const struct pkg_turn *turns = graph->net->turns;
	uint32_t low = 0, high = graph->net->turn_count;
	while (low < high) {
		uint32_t mid = low + (high - low) / 2;
		if (turns[mid].from_half < from || (turns[mid].from_half == from && turns[mid].to_half < to))
			low = mid + 1;
		else
			high = mid;
	}
	return low < graph->net->turn_count && turns[low].from_half == from && turns[low].to_half == to;
}

uint32_t graph_successors(
	const struct graph *graph, uint32_t half, enum graph_rule rule, uint32_t out[static GRAPH_SUCCESSORS_MAX])
{
	const struct pkg_node *node = &graph->net->nodes[graph_end(graph, half)];
	uint32_t count = 0, open = 0;
	for (uint32_t i = 0; i < node->out_count && count < GRAPH_SUCCESSORS_MAX; i++) {
		uint32_t to = graph->net->outs[node->first_out + i];
		if (rule == GRAPH_PHYSICAL) {
			out[count++] = to;
			continue;
		}
		if (to == graph_twin(half) || !graph_drivable(graph, to))
			continue;
		open++;
		if (!graph_turn_forbidden(graph, half, to))
			out[count++] = to;
	}
	/* Where all other ways are one-way towards us the street is a dead end as well. */
	if (rule == GRAPH_LEGAL && !open && graph_drivable(graph, graph_twin(half)))
		out[count++] = graph_twin(half);
	return count;
}

/* --- lanes --- */

uint32_t graph_lanes(const struct graph *graph, uint32_t half)
{
	const struct pkg_edge *edge = graph_edge(graph, half);
	uint32_t lanes = half & 1 ? edge->lanes_backward : edge->lanes_forward;
	return lanes ? lanes : 1;
}

double graph_lane_offset_m(const struct graph *graph, uint32_t half, uint32_t lane)
{
	const struct pkg_edge *edge = graph_edge(graph, half);
	uint32_t own = graph_lanes(graph, half);
	uint32_t other = graph_drivable(graph, graph_twin(half)) ? graph_lanes(graph, graph_twin(half)) : 0;
	double width = edge->width_mm * 1e-3;
	double lane_width = width / (own + other);
	if (lane >= own)
		lane = own - 1;
	double from_centre = 0.5 * width - (lane + 0.5) * lane_width;
	return graph->right_hand ? from_centre : -from_centre;
}
