/*
 * Makes the streets of one level meet at shared vertices only. Crossings are found exactly (integer orientation) and
 * rounded to the millimetre grid; a rounded crossing bends its streets by up to 0.7 mm, which can make new crossings,
 * so passes go on over what changed until nothing does (iterated snap rounding, after Hobby 1999, "Practical segment
 * intersection with finite precision output"). What would still cross after PASSES_MAX, and what crosses at another
 * level, leaves the plane.
 */
#include <math.h>
#include <stdlib.h>

#include "tools/city/graph_net.h"

#define PASSES_MAX 24

struct meeting {
	struct line_mm p, q;
	int64_t qa_p, qb_p, pa_q, pb_q; /* side of q's ends seen from p, of p's ends seen from q */
};

static struct meeting meet(struct line_mm p, struct line_mm q)
{
	return (struct meeting){
		.p = p,
		.q = q,
		.qa_p = line_side(p.ax, p.ay, p.bx, p.by, q.ax, q.ay),
		.qb_p = line_side(p.ax, p.ay, p.bx, p.by, q.bx, q.by),
		.pa_q = line_side(q.ax, q.ay, q.bx, q.by, p.ax, p.ay),
		.pb_q = line_side(q.ax, q.ay, q.bx, q.by, p.bx, p.by),
	};
}

static bool opposite(int64_t a, int64_t b)
{
	return (a < 0 && b > 0) || (a > 0 && b < 0);
}

static bool cross_properly(const struct meeting *m)
{
	return opposite(m->qa_p, m->qb_p) && opposite(m->pa_q, m->pb_q);
}

static bool between(int64_t a, int64_t b, int64_t at)
{
	return (a <= at && at <= b) || (b <= at && at <= a);
}

/* A point known to be collinear with the line lies on it, ends included. */
static bool within(struct line_mm line, int64_t x, int64_t y)
{
	return between(line.ax, line.bx, x) && between(line.ay, line.by, y);
}

static bool strictly_within(struct line_mm line, int64_t x, int64_t y)
{
	return within(line, x, y) && !(x == line.ax && y == line.ay) && !(x == line.bx && y == line.by);
}

static bool touch(const struct meeting *m)
{
	return cross_properly(m) || (!m->qa_p && within(m->p, m->q.ax, m->q.ay)) ||
		   (!m->qb_p && within(m->p, m->q.bx, m->q.by)) || (!m->pa_q && within(m->q, m->p.ax, m->p.ay)) ||
		   (!m->pb_q && within(m->q, m->p.bx, m->p.by));
}

static double along_p(const struct meeting *m)
{
	double a = (double)m->pa_q, b = (double)m->pb_q;
	return a != b ? fmin(fmax(a / (a - b), 0.0), 1.0) : 0.5;
}

static double along_q(const struct meeting *m)
{
	double a = (double)m->qa_p, b = (double)m->qb_p;
	return a != b ? fmin(fmax(a / (a - b), 0.0), 1.0) : 0.5;
}

struct planar {
	struct net *net;
	struct line_mm *lines;
	struct line_grid grid;
	index_array near;
};

static void planar_init(struct planar *planar, struct net *net)
{
	size_t capacity = 0, count = net->segments.count;
	*planar = (struct planar){ .net = net };
	planar->lines = array_grow(NULL, &capacity, count + 1, sizeof(struct line_mm));
	for (size_t i = 0; i < count; i++)
		planar->lines[i] = net_line(net, &net->segments.items[i]);
	line_grid_init(&planar->grid, planar->lines, count);
}

static void planar_finish(struct planar *planar)
{
	line_grid_finish(&planar->grid);
	array_free(planar->lines);
	ARRAY_FINISH(&planar->near);
}

static uint32_t crossing_vertex(struct net *net, const struct meeting *m)
{
	double t = along_p(m);
	return net_vertex_add(net, 0, (int32_t)lround(m->p.ax + t * ((double)m->p.bx - m->p.ax)),
		(int32_t)lround(m->p.ay + t * ((double)m->p.by - m->p.ay)));
}

/* Cuts two segments where they meet; returns whether they met other than in a shared end. */
static bool cut_pair(struct planar *planar, uint32_t p, uint32_t q, cut_array *cuts)
{
	struct net *net = planar->net;
	struct meeting m = meet(planar->lines[p], planar->lines[q]);
	const struct net_segment *sp = &net->segments.items[p], *sq = &net->segments.items[q];
	uint32_t sp_a = sp->a, sp_b = sp->b, sq_a = sq->a, sq_b = sq->b;
	if (cross_properly(&m)) {
		uint32_t vertex = crossing_vertex(net, &m);
		ARRAY_PUSH(cuts, (struct net_cut){ p, vertex });
		ARRAY_PUSH(cuts, (struct net_cut){ q, vertex });
		return true;
	}
	size_t before = cuts->count;
	if (!m.qa_p && strictly_within(m.p, m.q.ax, m.q.ay))
		ARRAY_PUSH(cuts, (struct net_cut){ p, sq_a });
	if (!m.qb_p && strictly_within(m.p, m.q.bx, m.q.by))
		ARRAY_PUSH(cuts, (struct net_cut){ p, sq_b });
	if (!m.pa_q && strictly_within(m.q, m.p.ax, m.p.ay))
		ARRAY_PUSH(cuts, (struct net_cut){ q, sp_a });
	if (!m.pb_q && strictly_within(m.q, m.p.bx, m.p.by))
		ARRAY_PUSH(cuts, (struct net_cut){ q, sp_b });
	bool overlap = !m.qa_p && !m.qb_p; /* counted as a duplicate when the pieces are joined */
	return cuts->count > before && !overlap;
}

static bool cut_pass(struct net *net, bool count_faults)
{
	struct planar planar;
	cut_array cuts = { 0 };
	size_t count = net->segments.count;
	planar_init(&planar, net);
	for (uint32_t p = 0; p < count; p++) {
		if (!net->segments.items[p].fresh || !net->segments.items[p].drivable)
			continue;
		line_grid_near(&planar.grid, planar.lines[p], 0, &planar.near);
		for (size_t i = 0; i < planar.near.count; i++) {
			uint32_t q = planar.near.items[i];
			const struct net_segment *sp = &net->segments.items[p], *sq = &net->segments.items[q];
			if (q == p || (sq->fresh && q < p) || !sq->drivable || sq->level != sp->level)
				continue;
			int64_t way = net->city->ways.items[sp->way].id;
			if (cut_pair(&planar, p, q, &cuts) && count_faults)
				report_fault(net->city->report, FAULT_CROSSING_WITHOUT_NODE, FAULT_MENDED, way);
		}
	}
	for (size_t i = 0; i < count; i++)
		net->segments.items[i].fresh = false;
	bool changed = cuts.count > 0;
	net_apply_cuts(net, &cuts);
	ARRAY_FINISH(&cuts);
	planar_finish(&planar);
	return changed;
}

struct place {
	int32_t x, y;
	uint32_t vertex, levels; /* bit per level of the streets that meet here */
};

static int order_places(const void *left, const void *right)
{
	const struct place *a = left, *b = right;
	if (a->x != b->x)
		return a->x < b->x ? -1 : 1;
	if (a->y != b->y)
		return a->y < b->y ? -1 : 1;
	return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

/* Vertices at one place whose streets share a level become one, until none do. */
static void join_group(struct net *net, struct place *group, size_t count, uint32_t *to, bool count_faults)
{
	for (bool again = true; again;) {
		again = false;
		for (size_t i = 0; i < count; i++) {
			for (size_t j = i + 1; j < count; j++) {
				if (!(group[i].levels & group[j].levels))
					continue;
				to[group[j].vertex] = group[i].vertex;
				int64_t id = net->vertices.items[group[j].vertex].id;
				if (count_faults && id)
					report_fault(net->city->report, FAULT_NEAR_MISS_NODE, FAULT_MENDED, id);
				group[i].levels |= group[j].levels;
				group[j].levels = 0;
				again = true;
			}
		}
	}
}

static void join_coincident(struct net *net, bool count_faults)
{
	size_t capacity = 0, vertices = net->vertices.count;
	struct place *places = array_grow(NULL, &capacity, vertices + 1, sizeof(*places));
	capacity = 0;
	uint32_t *to = array_grow(NULL, &capacity, vertices + 1, sizeof(uint32_t));
	for (uint32_t v = 0; v < vertices; v++) {
		places[v] = (struct place){ net->vertices.items[v].x, net->vertices.items[v].y, v, 0 };
		to[v] = v;
	}
	for (size_t i = 0; i < net->segments.count; i++) {
		const struct net_segment *s = &net->segments.items[i];
		if (!s->drivable)
			continue;
		places[s->a].levels |= 1u << (s->level + 15);
		places[s->b].levels |= 1u << (s->level + 15);
	}
	qsort(places, vertices, sizeof(*places), order_places);
	for (size_t i = 0, end; i < vertices; i = end) {
		for (end = i + 1; end < vertices && places[end].x == places[i].x && places[end].y == places[i].y;)
			end++;
		if (end - i > 1)
			join_group(net, &places[i], end - i, to, count_faults);
	}
	for (uint32_t v = 0; v < vertices; v++)
		while (to[v] != to[to[v]])
			to[v] = to[to[v]];
	net_merge_vertices(net, to, count_faults);
	array_free(places);
	array_free(to);
}

void planar_cut(struct net *net, bool count_faults)
{
	join_coincident(net, count_faults);
	bool changed = cut_pass(net, count_faults);
	if (changed) /* overlapping streets have the same stretches only now */
		join_coincident(net, count_faults);
	for (int pass = 1; changed && pass < PASSES_MAX; pass++) {
		changed = cut_pass(net, false);
		if (changed)
			join_coincident(net, false);
	}
}

/* Whether two segments meet other than in one shared vertex. */
static bool conflict(const struct net *net, const struct planar *planar, uint32_t p, uint32_t q)
{
	const struct net_segment *s = &net->segments.items[p], *t = &net->segments.items[q];
	struct meeting m = meet(planar->lines[p], planar->lines[q]);
	bool a_shared = s->a == t->a || s->a == t->b, b_shared = s->b == t->a || s->b == t->b;
	if (a_shared && b_shared)
		return true;
	if (!a_shared && !b_shared)
		return touch(&m);
	if (m.qa_p || m.qb_p)
		return false;
	struct line_mm lp = planar->lines[p], lq = planar->lines[q];
	int64_t px = a_shared ? (int64_t)lp.bx - lp.ax : (int64_t)lp.ax - lp.bx;
	int64_t py = a_shared ? (int64_t)lp.by - lp.ay : (int64_t)lp.ay - lp.by;
	bool at_qa = t->a == (a_shared ? s->a : s->b);
	int64_t qx = at_qa ? (int64_t)lq.bx - lq.ax : (int64_t)lq.ax - lq.bx;
	int64_t qy = at_qa ? (int64_t)lq.by - lq.ay : (int64_t)lq.ay - lq.by;
	return px * qx + py * qy > 0;
}

/* The farther from the ground leaves the plane; of two as far, the upper; of two at one level, the later. */
static void leave_plane(struct net *net, uint32_t p, uint32_t q)
{
	struct net_segment *s = &net->segments.items[p], *t = &net->segments.items[q];
	if (s->off_plane || t->off_plane)
		return;
	int far_s = abs(s->level) * 2 + (s->level > 0), far_t = abs(t->level) * 2 + (t->level > 0);
	if (far_s > far_t)
		s->off_plane = true;
	else
		t->off_plane = true;
}

static void list_crossing(
	const struct net *net, const struct planar *planar, uint32_t p, uint32_t q, crossing_array *out)
{
	const struct net_segment *s = &net->segments.items[p], *t = &net->segments.items[q];
	if (s->a == t->a || s->a == t->b || s->b == t->a || s->b == t->b)
		return;
	struct meeting m = meet(planar->lines[p], planar->lines[q]);
	if (!touch(&m))
		return;
	if (s->level > t->level)
		ARRAY_PUSH(out, (struct net_crossing){ p, q, along_p(&m), along_q(&m) });
	else
		ARRAY_PUSH(out, (struct net_crossing){ q, p, along_q(&m), along_p(&m) });
}

void planar_levels(struct net *net, crossing_array *crossings)
{
	struct planar planar;
	planar_init(&planar, net);
	crossings->count = 0;
	for (size_t i = 0; i < net->segments.count; i++) {
		struct net_segment *segment = &net->segments.items[i];
		segment->off_plane = segment->drivable && net->city->ways.items[segment->way].tunnel;
	}
	for (uint32_t p = 0; p < net->segments.count; p++) {
		line_grid_near(&planar.grid, planar.lines[p], 0, &planar.near);
		for (size_t i = 0; i < planar.near.count; i++) {
			uint32_t q = planar.near.items[i];
			const struct net_segment *s = &net->segments.items[p], *t = &net->segments.items[q];
			if (q <= p)
				continue;
			if (s->level != t->level)
				list_crossing(net, &planar, p, q, crossings);
			if (s->drivable && t->drivable && !s->off_plane && !t->off_plane && conflict(net, &planar, p, q))
				leave_plane(net, p, q);
		}
	}
	planar_finish(&planar);
}
