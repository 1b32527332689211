/* Where names could stand: along the way ahead for a driver, everywhere in sight for an overview. */
#include "render/labels.h"

#include <errno.h>
#include <math.h>

#include "platform/base/rng.h"

#define AHEAD_M 420.0
#define AHEAD_HALVES 40u
#define ARM_M 13.0       /* a crossing street's name stands this far into it */
#define HEIGHT_MM 6200   /* above the carriageway */
#define SAME_NAME_M 70.0 /* carriageways of one street: one name */
#define CELL_MM 250000
#define GRID_SIDE_MAX 512u
#define OVERVIEW_EDGES_MAX 6000u

static uint32_t half_end(const struct pkg_graph *graph, uint32_t half)
{
	return graph->halves[half ^ 1].origin;
}

/* Point `along_m` from the origin of a half-edge, at most its middle. */
static void point_on_half(const struct pkg_graph *graph, uint32_t half, double along_m, int32_t out[3])
{
	const struct pkg_edge *edge = &graph->edges[half / 2];
	const struct pkg_point *points = graph->points + edge->first_point;
	double left = fmin(along_m, edge->length_mm * 0.5e-3) * 1e3;
	uint32_t last = edge->point_count - 1;
	for (uint32_t i = 0; i < last; i++) {
		const int32_t *a = points[half & 1 ? last - i : i].pos_mm;
		const int32_t *b = points[half & 1 ? last - i - 1 : i + 1].pos_mm;
		double dx = (double)b[0] - a[0], dy = (double)b[1] - a[1], length = hypot(dx, dy);
		if (left <= length || i + 1 == last) {
			double t = length > 0.0 ? fmin(left / length, 1.0) : 0.0;
			for (int axis = 0; axis < 3; axis++)
				out[axis] = (int32_t)lrint(a[axis] + ((double)b[axis] - a[axis]) * t);
			return;
		}
		left -= length;
	}
}

static struct dvec2 start_direction(const struct pkg_graph *graph, uint32_t half)
{
	int32_t at[3] = { 0 };
	const int32_t *from = graph->nodes[graph->halves[half].origin].pos_mm;
	point_on_half(graph, half, 12.0, at);
	struct dvec2 out = { (double)at[0] - from[0], (double)at[1] - from[1] };
	double length = dvec2_length(out);
	return length > 0.0 ? dvec2_scale(out, 1.0 / length) : (struct dvec2){ 0.0, 1.0 };
}

static bool better(const struct label_candidate *a, const struct label_candidate *b)
{
	if (a->rank != b->rank)
		return a->rank > b->rank;
	return a->order != b->order ? a->order < b->order : a->key < b->key;
}

/* Keeps the list sorted; a full list loses its worst. */
static void add_candidate(struct labels *labels, const struct label_candidate *candidate)
{
	uint32_t at = labels->candidate_count;
	if (at == LABEL_CANDIDATES_MAX) {
		if (!better(candidate, &labels->candidates[at - 1]))
			return;
		at--;
	} else
		labels->candidate_count++;
	for (; at > 0 && better(candidate, &labels->candidates[at - 1]); at--)
		labels->candidates[at] = labels->candidates[at - 1];
	labels->candidates[at] = *candidate;
}

/* The half-edge that goes straightest on; PKG_NONE at a dead end. */
static uint32_t straight_on(const struct pkg_graph *graph, uint32_t half)
{
	const struct pkg_node *node = &graph->nodes[half_end(graph, half)];
	struct dvec2 back = start_direction(graph, half ^ 1);
	uint32_t best = PKG_NONE;
	double best_dot = 0.5;
	for (uint32_t i = 0; i < node->out_count; i++) {
		uint32_t out = graph->outs[node->first_out + i];
		double dot = out == (half ^ 1) ? 2.0 : dvec2_dot(back, start_direction(graph, out));
		bool same = graph->edges[out / 2].name && graph->edges[out / 2].name == graph->edges[half / 2].name;
		dot -= same ? 0.5 : 0.0;
		if (out != (half ^ 1) && dot < best_dot) {
			best = out;
			best_dot = dot;
		}
	}
	return best;
}

struct arm {
	uint32_t half;
	double score; /* how well it is seen: sideways, to the right of the road user's side */
};

static bool name_near(const struct labels *labels, uint32_t name, const int32_t at[3], double within_m)
{
	for (uint32_t i = 0; i < labels->candidate_count; i++) {
		const struct label_candidate *other = &labels->candidates[i];
		double dx = (double)other->at_mm[0] - at[0], dy = (double)other->at_mm[1] - at[1];
		if (other->string == name && hypot(dx, dy) < within_m * 1e3)
			return true;
	}
	return false;
}

static void add_arm(struct labels *labels, uint32_t half, enum label_rank rank, uint32_t order)
{
	const struct pkg_graph *graph = &labels->pkg->graph;
	const struct pkg_edge *edge = &graph->edges[half / 2];
	struct label_candidate candidate = { .string = edge->name, .rank = rank, .order = order };
	candidate.key = hash_u64((uint64_t)graph->halves[half].origin << 32 | edge->name);
	point_on_half(graph, half, ARM_M, candidate.at_mm);
	if (name_near(labels, edge->name, candidate.at_mm, SAME_NAME_M))
		return;
	candidate.at_mm[2] += HEIGHT_MM;
	memcpy(candidate.towards_mm, candidate.at_mm, sizeof(candidate.towards_mm));
	add_candidate(labels, &candidate);
}

/* Crossing streets at the end of `half`: for each name the arm that shows best. */
static void add_crossings(struct labels *labels, uint32_t half, uint32_t next, uint32_t own_name, uint32_t order)
{
	const struct pkg_graph *graph = &labels->pkg->graph;
	const struct pkg_node *node = &graph->nodes[half_end(graph, half)];
	struct dvec2 back = start_direction(graph, half ^ 1);
	double right_side = labels->pkg->meta->right_hand_traffic ? 1.0 : -1.0;
	for (uint32_t i = 0; i < node->out_count; i++) {
		uint32_t out = graph->outs[node->first_out + i];
		uint32_t name = graph->edges[out / 2].name;
		if (out == (half ^ 1) || out == next || !name || name == own_name)
			continue;
		struct arm best = { PKG_NONE, -1e9 };
		for (uint32_t k = 0; k < node->out_count; k++) {
			uint32_t other = graph->outs[node->first_out + k];
			if (graph->edges[other / 2].name != name || other == (half ^ 1))
				continue;
			struct dvec2 direction = start_direction(graph, other);
			double sideways = dvec2_cross(back, direction) * right_side;
			double score = 0.3 * sideways - dvec2_dot(back, direction);
			if (score > best.score)
				best = (struct arm){ other, score };
		}
		if (best.half == out)
			add_arm(labels, out, LABEL_STREET, order + graph->edges[out / 2].street_class);
	}
}

static void find_ahead(struct labels *labels, const struct labels_input *input)
{
	const struct pkg_graph *graph = &labels->pkg->graph;
	const struct nav_view *nav = input->nav;
	uint32_t half = nav->half;
	if (!nav->located || half >= graph->half_count)
		return;
	double distance = graph->edges[half / 2].length_mm * 1e-3 - nav->along_m;
	bool turning = nav->routed && nav->next.to_half < graph->half_count && nav->next.manoeuvre != NAV_MANOEUVRE_NONE &&
				   nav->next.manoeuvre != NAV_MANOEUVRE_ARRIVE && nav->next.manoeuvre != NAV_MANOEUVRE_STRAIGHT;
	if (turning && nav->next.distance_m < AHEAD_M && graph->edges[nav->next.to_half / 2].name)
		add_arm(labels, nav->next.to_half, LABEL_MANOEUVRE, 0);
	for (uint32_t i = 0; i < AHEAD_HALVES && distance < AHEAD_M && half != PKG_NONE; i++) {
		bool on_route = nav->routed && i + 1 < nav->route_count && nav->route[i] == half;
		uint32_t next = on_route ? nav->route[i + 1] : straight_on(graph, half);
		if (next != PKG_NONE && (next >= graph->half_count || graph->halves[next].origin != half_end(graph, half)))
			return;
		uint32_t own = graph->edges[half / 2].name;
		uint32_t order = (uint32_t)(i * 16);
		add_crossings(labels, half, next, own, order);
		if (next != PKG_NONE && graph->edges[next / 2].name && graph->edges[next / 2].name != own)
			add_arm(labels, next, LABEL_STREET, order + 1);
		half = next;
		distance += next == PKG_NONE ? 0.0 : graph->edges[next / 2].length_mm * 1e-3;
	}
}

static bool middle_of(const struct pkg_graph *graph, uint32_t edge, int32_t out[3])
{
	if (!graph->edges[edge].name || graph->edges[edge].point_count < 2)
		return false;
	point_on_half(graph, 2 * edge, 1e9, out);
	return true;
}

static uint32_t cell_of(const struct labels *labels, const int32_t at[3])
{
	int64_t x = ((int64_t)at[0] - labels->grid_mm[0]) / labels->cell_mm;
	int64_t y = ((int64_t)at[1] - labels->grid_mm[1]) / labels->cell_mm;
	x = x < 0 ? 0 : x >= labels->columns ? labels->columns - 1 : x;
	y = y < 0 ? 0 : y >= labels->rows ? labels->rows - 1 : y;
	return (uint32_t)(y * labels->columns + x);
}

int label_grid_init(struct labels *labels, struct arena *arena)
{
	const struct pkg_graph *graph = &labels->pkg->graph;
	int64_t low[2] = { INT32_MAX, INT32_MAX }, high[2] = { INT32_MIN, INT32_MIN };
	for (uint32_t i = 0; i < graph->node_count; i++)
		for (int axis = 0; axis < 2; axis++) {
			low[axis] = graph->nodes[i].pos_mm[axis] < low[axis] ? graph->nodes[i].pos_mm[axis] : low[axis];
			high[axis] = graph->nodes[i].pos_mm[axis] > high[axis] ? graph->nodes[i].pos_mm[axis] : high[axis];
		}
	if (!graph->node_count)
		low[0] = low[1] = high[0] = high[1] = 0;
	int64_t side = high[0] - low[0] > high[1] - low[1] ? high[0] - low[0] : high[1] - low[1];
	int64_t cell = side / (GRID_SIDE_MAX - 1) + 1;
	labels->cell_mm = (int32_t)(cell > CELL_MM ? cell : CELL_MM);
	labels->columns = (uint32_t)((high[0] - low[0]) / labels->cell_mm) + 1;
	labels->rows = (uint32_t)((high[1] - low[1]) / labels->cell_mm) + 1;
	labels->grid_mm[0] = (int32_t)low[0];
	labels->grid_mm[1] = (int32_t)low[1];
	uint32_t cells = labels->columns * labels->rows;
	labels->cell_first = ARENA_ARRAY(arena, uint32_t, cells + 2);
	labels->cell_edges = ARENA_ARRAY(arena, uint32_t, graph->edge_count + 1);
	if (!labels->cell_first || !labels->cell_edges)
		return -ENOMEM;
	/* Counting sort: counts one place to the right, so that filling leaves each cell's start in its own place. */
	int32_t at[3] = { 0 };
	for (uint32_t i = 0; i < graph->edge_count; i++)
		if (middle_of(graph, i, at))
			labels->cell_first[cell_of(labels, at) + 2]++;
	for (uint32_t i = 0; i < cells; i++)
		labels->cell_first[i + 2] += labels->cell_first[i + 1];
	for (uint32_t i = 0; i < graph->edge_count; i++)
		if (middle_of(graph, i, at))
			labels->cell_edges[labels->cell_first[cell_of(labels, at) + 1]++] = i;
	return 0;
}

/* Where an eye-relative point is on the screen, -1 to 1 across it; outside of that when it is not seen. */
static bool on_screen(const struct view *view, const int32_t at_mm[3])
{
	int64_t at[3] = { at_mm[0], at_mm[1], at_mm[2] };
	struct vec3 eye = view_relative(view, at);
	float depth = vec3_dot(eye, view->forward);
	return depth > 0.5f && fabsf(vec3_dot(eye, view->right)) < depth * view->tan_half_x &&
		   fabsf(vec3_dot(eye, view->up)) < depth * view->tan_half_y;
}

/* An edge whose name, on the screen, is at most 1 / `share` of its length. A name stands once within `apart_m`. */
struct edge_rule {
	double m_per_px, share, apart_m;
};

static void add_edge(
	struct labels *labels, const struct labels_input *input, uint32_t edge_id, const struct edge_rule *rule)
{
	const struct pkg_graph *graph = &labels->pkg->graph;
	const struct pkg_edge *edge = &graph->edges[edge_id];
	struct text_line line = text_line_string(labels->font, edge->name);
	double width_m = text_width_em(labels->font, &line) * 24.0 * input->scale * rule->m_per_px;
	if (width_m <= 0.0 || edge->length_mm * 1e-3 < rule->share * width_m)
		return;
	struct label_candidate candidate = { .string = edge->name, .along = true, .edge = edge_id };
	bool current = input->nav->located && edge->name == input->nav->street;
	double middle_m = edge->length_mm * 0.5e-3;
	candidate.rank = current ? LABEL_CURRENT : LABEL_STREET;
	candidate.order = edge->street_class * 1000000u + 999999u - (uint32_t)fmin(edge->length_mm * 0.1, 999999.0);
	candidate.key = hash_u64((uint64_t)edge_id << 32 | UINT64_C(0x80000000) | edge->name);
	point_on_half(graph, 2 * edge_id, middle_m, candidate.at_mm);
	point_on_half(graph, 2 * edge_id, fmax(middle_m - 15.0, 0.0), candidate.towards_mm);
	candidate.at_mm[2] += 500;
	candidate.towards_mm[2] += 500;
	if (on_screen(input->view, candidate.at_mm) && !name_near(labels, edge->name, candidate.at_mm, rule->apart_m))
		add_candidate(labels, &candidate);
}

/* Names that stand already go first: they keep their places while the picture moves. */
static void add_living(struct labels *labels, const struct labels_input *input, const struct edge_rule *rule)
{
	for (uint32_t i = 0; i < LABELS_MAX; i++)
		if (labels->slots[i].used && labels->slots[i].on && labels->slots[i].what.along)
			add_edge(labels, input, labels->slots[i].what.edge, rule);
}

/* Where the middle of the picture meets the ground, and how far from it can be seen; clamped to a few km. */
static void ground_in_view(const struct view *view, int32_t ground_mm, int64_t center_mm[2], double *radius_m)
{
	double height = fmax((double)(view->eye_mm[2] - ground_mm) * 1e-3, 10.0);
	double down = fmax(-view->forward.z, 0.2);
	double reach = fmin(height / down, 4000.0);
	for (int axis = 0; axis < 2; axis++)
		center_mm[axis] =
			view->eye_mm[axis] + (int64_t)((axis ? (double)view->forward.y : (double)view->forward.x) * reach * 1e3);
	*radius_m = fmin(1.3 * reach * fmax(view->tan_half_x, view->tan_half_y), 4000.0);
}

static void add_cells(struct labels *labels, const struct labels_input *input, const int64_t center[2], double radius_m,
	const struct edge_rule *rule)
{
	uint32_t seen = 0;
	int64_t reach = (int64_t)(radius_m * 1e3);
	int32_t low[3] = { 0 }, high[3] = { 0 };
	for (int axis = 0; axis < 2; axis++) {
		low[axis] = (int32_t)fmax((double)(center[axis] - reach), (double)INT32_MIN);
		high[axis] = (int32_t)fmin((double)(center[axis] + reach), (double)INT32_MAX);
	}
	uint32_t first = cell_of(labels, low), last = cell_of(labels, high);
	for (uint32_t row = first / labels->columns; row <= last / labels->columns; row++)
		for (uint32_t column = first % labels->columns; column <= last % labels->columns; column++) {
			uint32_t cell = row * labels->columns + column;
			for (uint32_t i = labels->cell_first[cell]; i < labels->cell_first[cell + 1]; i++)
				if (seen++ < OVERVIEW_EDGES_MAX)
					add_edge(labels, input, labels->cell_edges[i], rule);
		}
}

/* First edges that their names fit well, then shorter ones. */
static void find_around(struct labels *labels, const struct labels_input *input)
{
	int64_t center[2];
	double radius_m;
	ground_in_view(input->view, (int32_t)input->nav->pos_mm[2], center, &radius_m);
	double distance_m = fmax((double)(input->view->eye_mm[2] - input->nav->pos_mm[2]) * 1e-3, 10.0) /
						fmax(-(double)input->view->forward.z, 0.2);
	struct edge_rule rule = { .m_per_px = distance_m / fmax((double)input->view->focal_px, 1.0), .share = 0.5 };
	rule.apart_m = 420.0 * input->scale * rule.m_per_px;
	add_living(labels, input, &rule);
	rule.share = 1.0;
	add_cells(labels, input, center, radius_m, &rule);
	rule.share = 0.6;
	add_cells(labels, input, center, radius_m, &rule);
}

void label_candidates_find(struct labels *labels, const struct labels_input *input)
{
	labels->candidate_count = 0;
	if (!labels->pkg->graph.edge_count)
		return;
	if (input->kind == CAMERA_HEADING_UP || input->kind == CAMERA_NORTH_UP)
		find_around(labels, input);
	else
		find_ahead(labels, input);
}
