#include "graph_check.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/city/line_grid.h"

static int failures;

__attribute__((format(printf, 2, 3))) static void expect(bool holds, const char *format, ...)
{
	if (holds || failures++ > 20)
		return;
	va_list args;
	va_start(args, format);
	fprintf(stderr, "graph: ");
	vfprintf(stderr, format, args);
	fprintf(stderr, "\n");
	va_end(args);
}

static bool in_plane(const struct pkg_graph *g, uint32_t half)
{
	return !(g->edges[half / 2].flags & PKG_EDGE_OFF_PLANE);
}

static uint32_t end_of(const struct pkg_graph *g, uint32_t half)
{
	return g->halves[half ^ 1].origin;
}

static const struct pkg_point *point_of(const struct pkg_graph *g, uint32_t half, uint32_t index)
{
	const struct pkg_edge *e = &g->edges[half / 2];
	return &g->points[e->first_point + (half & 1 ? e->point_count - 1 - index : index)];
}

static void check_edges(const struct pkg_graph *g)
{
	expect(g->half_count == 2 * g->edge_count && g->out_count == g->half_count, "counts of halves, edges and outs");
	for (uint32_t e = 0; e < g->edge_count; e++) {
		const struct pkg_edge *edge = &g->edges[e];
		expect(
			edge->point_count >= 2 && edge->first_point + edge->point_count <= g->point_count, "points of edge %u", e);
		double length = 0.0;
		for (uint32_t i = 0; i + 1 < edge->point_count; i++) {
			const int32_t *a = point_of(g, 2 * e, i)->pos_mm, *b = point_of(g, 2 * e, i + 1)->pos_mm;
			expect(a[0] != b[0] || a[1] != b[1], "edge %u has a piece without length", e);
			length += hypot((double)b[0] - a[0], (double)b[1] - a[1]);
		}
		expect(fabs(length - edge->length_mm) <= 1.0 + (double)edge->point_count, "length of edge %u", e);
		expect(edge->flags & (PKG_EDGE_FORWARD | PKG_EDGE_BACKWARD), "edge %u may not be driven", e);
		expect(!(edge->flags & PKG_EDGE_TUNNEL) || edge->flags & PKG_EDGE_OFF_PLANE, "tunnel %u in the plane", e);
		for (uint32_t side = 0; side < 2; side++) {
			const struct pkg_node *node = &g->nodes[g->halves[2 * e + side].origin];
			expect(!memcmp(node->pos_mm, point_of(g, 2 * e + side, 0)->pos_mm, sizeof(node->pos_mm)),
				"edge %u does not start at its node", e);
		}
	}
}

static bool turns_left(int64_t ax, int64_t ay, int64_t bx, int64_t by)
{
	bool a_low = ay < 0 || (ay == 0 && ax < 0), b_low = by < 0 || (by == 0 && bx < 0);
	return a_low != b_low ? b_low : ax * by - ay * bx > 0;
}

static void check_outs(const struct pkg_graph *g)
{
	uint8_t *seen = calloc(g->half_count + 1, 1);
	uint32_t next_out = 0;
	for (uint32_t n = 0; n < g->node_count; n++) {
		const struct pkg_node *node = &g->nodes[n];
		expect(node->first_out == next_out && node->out_count > 0, "outs of node %u", n);
		next_out += node->out_count;
		uint32_t last = PKG_NONE;
		for (uint32_t i = 0; i < node->out_count; i++) {
			uint32_t h = g->outs[node->first_out + i];
			expect(h < g->half_count && g->halves[h].origin == n && !seen[h], "out %u of node %u", i, n);
			seen[h] = 1;
			if (!in_plane(g, h))
				continue;
			const int32_t *o = node->pos_mm, *p = point_of(g, h, 1)->pos_mm;
			const int32_t *q = last == PKG_NONE ? NULL : point_of(g, last, 1)->pos_mm;
			expect(!q || turns_left(
							 (int64_t)q[0] - o[0], (int64_t)q[1] - o[1], (int64_t)p[0] - o[0], (int64_t)p[1] - o[1]),
				"outs of node %u are not counter-clockwise", n);
			last = h;
		}
	}
	expect(next_out == g->out_count, "outs left over");
	free(seen);
}

static void check_cycles(const struct pkg_graph *g)
{
	uint8_t *seen = calloc(g->half_count + 1, 1);
	uint64_t in_faces = 0;
	for (uint32_t h = 0; h < g->half_count; h++) {
		const struct pkg_half *half = &g->halves[h];
		expect(half->next < g->half_count && half->prev < g->half_count && half->face < g->face_count, "half %u", h);
		expect(g->halves[half->next].prev == h && g->halves[half->prev].next == h, "next and prev of half %u", h);
		expect(g->halves[half->next].origin == end_of(g, h), "half %u and its next do not meet", h);
		expect(in_plane(g, h) == in_plane(g, half->next), "half %u leaves the plane", h);
		expect(in_plane(g, h) || half->next == (h ^ 1), "off-plane half %u has no face of its own", h);
	}
	for (uint32_t f = 0; f < g->face_count && !failures; f++) {
		uint32_t at = g->faces[f].first_half, count = 0;
		do {
			expect(g->halves[at].face == f && !seen[at], "half %u in face %u", at, f);
			seen[at] = 1;
			count++;
			at = g->halves[at].next;
		} while (at != g->faces[f].first_half && count <= g->half_count);
		expect(count == g->faces[f].half_count, "half_count of face %u", f);
		in_faces += count;
	}
	expect(failures || in_faces == g->half_count, "halves outside all faces");
	free(seen);
}

static uint32_t root_of(uint32_t *to, uint32_t at)
{
	while (to[at] != at)
		at = to[at] = to[to[at]];
	return at;
}

/* Connected parts by edges of the plane (or by all edges). */
static uint32_t *parts_of(const struct pkg_graph *g, bool all)
{
	uint32_t *to = calloc(g->node_count + 1, sizeof(uint32_t));
	for (uint32_t n = 0; n < g->node_count; n++)
		to[n] = n;
	for (uint32_t h = 0; h < g->half_count; h += 2)
		if (all || in_plane(g, h))
			to[root_of(to, g->halves[h].origin)] = root_of(to, end_of(g, h));
	for (uint32_t n = 0; n < g->node_count; n++)
		to[n] = root_of(to, n);
	return to;
}

static double shoelace(const struct pkg_graph *g, uint32_t face)
{
	const int32_t *base = g->nodes[g->halves[g->faces[face].first_half].origin].pos_mm;
	double twice = 0.0;
	uint32_t h = g->faces[face].first_half;
	do {
		for (uint32_t i = 0; i + 1 < g->edges[h / 2].point_count; i++) {
			const int32_t *a = point_of(g, h, i)->pos_mm, *b = point_of(g, h, i + 1)->pos_mm;
			twice += ((double)a[0] - base[0]) * ((double)b[1] - base[1]) -
					 ((double)b[0] - base[0]) * ((double)a[1] - base[1]);
		}
		h = g->halves[h].next;
	} while (h != g->faces[face].first_half);
	return twice / 2e6;
}

static void check_euler(const struct pkg_graph *g)
{
	struct part {
		int64_t vertices, edges, faces, outers;
		double inner_m2, outer_m2;
	} *parts = calloc(g->node_count + 1, sizeof(*parts));
	uint32_t *to = parts_of(g, false);
	for (uint32_t n = 0; n < g->node_count; n++)
		parts[to[n]].vertices++;
	for (uint32_t h = 0; h < g->half_count; h += 2)
		parts[to[g->halves[h].origin]].edges += in_plane(g, h);
	for (uint32_t f = 0; f < g->face_count; f++) {
		const struct pkg_face *face = &g->faces[f];
		struct part *part = &parts[to[g->halves[face->first_half].origin]];
		double area = shoelace(g, f);
		bool outer = face->flags & PKG_FACE_OUTER, off = face->flags & PKG_FACE_OFF_PLANE;
		expect(off == !in_plane(g, face->first_half), "flags of face %u", f);
		expect(fabs(area - face->area_m2) <= 1e-6 * fabs(area) + 1e-3, "area of face %u: %g, not %g", f, area,
			face->area_m2);
		expect(off || (outer ? face->area_m2 <= 0.0 : face->area_m2 > 0.0), "sign of face %u: %g", f, face->area_m2);
		part->faces += !off;
		part->outers += outer;
		part->inner_m2 += outer || off ? 0.0 : face->area_m2;
		part->outer_m2 += outer ? face->area_m2 : 0.0;
	}
	for (uint32_t n = 0; n < g->node_count; n++) {
		const struct part *part = &parts[n];
		if (to[n] != n || !part->edges)
			continue;
		expect(part->vertices - part->edges + part->faces == 2, "Euler: %lld - %lld + %lld at node %u",
			(long long)part->vertices, (long long)part->edges, (long long)part->faces, n);
		expect(part->outers == 1, "%lld outer faces at node %u", (long long)part->outers, n);
		expect(fabs(part->inner_m2 + part->outer_m2) <= 1e-6 * part->inner_m2 + 1e-3, "areas at node %u: %g and %g", n,
			part->inner_m2, part->outer_m2);
	}
	free(parts);
	free(to);
}

static void check_components(const struct pkg_graph *g)
{
	uint32_t *to = parts_of(g, true), *number = calloc(g->node_count + 1, sizeof(uint32_t));
	uint32_t *owner = malloc((g->node_count + 1) * sizeof(uint32_t));
	uint64_t *length = calloc(g->node_count + 1, sizeof(uint64_t)), largest = 0;
	memset(owner, 0xff, (g->node_count + 1) * sizeof(uint32_t));
	for (uint32_t n = 0; n < g->node_count; n++) {
		uint32_t c = g->nodes[n].component;
		expect(c < g->node_count && (owner[c] == PKG_NONE || owner[c] == to[n]), "component of node %u", n);
		expect(c == g->nodes[to[n]].component, "component of node %u differs from its neighbour's", n);
		owner[c] = to[n];
	}
	for (uint32_t h = 0; h < g->half_count; h += 2)
		length[g->nodes[g->halves[h].origin].component] += g->edges[h / 2].length_mm;
	for (uint32_t n = 0; n < g->node_count; n++)
		largest = length[n] > largest ? length[n] : largest;
	expect(!g->node_count || length[0] == largest, "component 0 is not the largest");
	free(to);
	free(number);
	free(owner);
	free(length);
}

/* Even-odd test of a point against one face's outline; the point is a node of another component. */
static bool holds(const struct pkg_graph *g, uint32_t face, const int32_t *at)
{
	bool inside = false;
	uint32_t h = g->faces[face].first_half;
	do {
		for (uint32_t i = 0; i + 1 < g->edges[h / 2].point_count; i++) {
			const int32_t *a = point_of(g, h, i)->pos_mm, *b = point_of(g, h, i + 1)->pos_mm;
			if ((a[1] > at[1]) == (b[1] > at[1]))
				continue;
			int64_t side = line_side(a[0], a[1], b[0], b[1], at[0], at[1]);
			if (b[1] > a[1] ? side > 0 : side < 0)
				inside = !inside;
		}
		h = g->halves[h].next;
	} while (h != g->faces[face].first_half);
	return inside;
}

static void check_parents(const struct pkg_graph *g)
{
	for (uint32_t f = 0; f < g->face_count; f++) {
		const struct pkg_face *face = &g->faces[f];
		expect(face->flags & PKG_FACE_OUTER || face->parent == PKG_NONE, "face %u has a parent", f);
		if (face->parent == PKG_NONE)
			continue;
		expect(face->parent < g->face_count && !g->faces[face->parent].flags, "parent of face %u", f);
		expect(holds(g, face->parent, g->nodes[g->halves[face->first_half].origin].pos_mm),
			"face %u is not inside its parent", f);
	}
}

struct piece {
	uint32_t edge, index;
};

static bool share_node(const struct pkg_graph *g, struct piece a, struct piece b, const int32_t *at)
{
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++) {
			uint32_t ha = 2 * a.edge + (uint32_t)i, hb = 2 * b.edge + (uint32_t)j;
			const int32_t *p = g->nodes[g->halves[ha].origin].pos_mm;
			if (g->halves[ha].origin == g->halves[hb].origin && p[0] == at[0] && p[1] == at[1])
				return true;
		}
	return a.edge == b.edge && (a.index + 1 == b.index || b.index + 1 == a.index);
}

static bool on_line(const struct line_mm *l, const int32_t *at)
{
	if (line_side(l->ax, l->ay, l->bx, l->by, at[0], at[1]))
		return false;
	int64_t dot =
		((int64_t)at[0] - l->ax) * ((int64_t)at[0] - l->bx) + ((int64_t)at[1] - l->ay) * ((int64_t)at[1] - l->by);
	return dot <= 0;
}

static bool pieces_clash(
	const struct pkg_graph *g, const struct line_mm *lines, const struct piece *pieces, uint32_t p, uint32_t q)
{
	struct line_mm a = lines[p], b = lines[q];
	int64_t s1 = line_side(a.ax, a.ay, a.bx, a.by, b.ax, b.ay), s2 = line_side(a.ax, a.ay, a.bx, a.by, b.bx, b.by);
	int64_t s3 = line_side(b.ax, b.ay, b.bx, b.by, a.ax, a.ay), s4 = line_side(b.ax, b.ay, b.bx, b.by, a.bx, a.by);
	if (((s1 < 0 && s2 > 0) || (s1 > 0 && s2 < 0)) && ((s3 < 0 && s4 > 0) || (s3 > 0 && s4 < 0)))
		return true;
	int touches = 0;
	const int32_t ends[4][2] = { { a.ax, a.ay }, { a.bx, a.by }, { b.ax, b.ay }, { b.bx, b.by } };
	int32_t where[4][2];
	for (int i = 0; i < 4; i++) {
		if (!on_line(i < 2 ? &b : &a, ends[i]))
			continue;
		bool again = false;
		for (int k = 0; k < touches; k++)
			again |= where[k][0] == ends[i][0] && where[k][1] == ends[i][1];
		if (!again)
			memcpy(where[touches++], ends[i], sizeof(where[0]));
		if (!share_node(g, pieces[p], pieces[q], ends[i]))
			return true;
	}
	return touches > 1; /* two pieces that share more than a point */
}

static void check_crossings(const struct pkg_graph *g)
{
	struct line_mm *lines = calloc(g->point_count + 1, sizeof(*lines));
	struct piece *pieces = calloc(g->point_count + 1, sizeof(*pieces));
	uint32_t count = 0;
	for (uint32_t e = 0; e < g->edge_count; e++)
		for (uint32_t i = 0; in_plane(g, 2 * e) && i + 1 < g->edges[e].point_count; i++) {
			const int32_t *a = point_of(g, 2 * e, i)->pos_mm, *b = point_of(g, 2 * e, i + 1)->pos_mm;
			pieces[count] = (struct piece){ e, i };
			lines[count++] = (struct line_mm){ a[0], a[1], b[0], b[1] };
		}
	struct line_grid grid;
	index_array near = { 0 };
	line_grid_init(&grid, lines, count);
	for (uint32_t p = 0; p < count; p++) {
		line_grid_near(&grid, lines[p], 0, &near);
		for (size_t i = 0; i < near.count; i++)
			if (near.items[i] > p)
				expect(!pieces_clash(g, lines, pieces, p, near.items[i]), "edges %u and %u meet without a node",
					pieces[p].edge, pieces[near.items[i]].edge);
	}
	ARRAY_FINISH(&near);
	line_grid_finish(&grid);
	free(lines);
	free(pieces);
}

static void check_turns(const struct pkg_graph *g)
{
	for (uint32_t i = 0; i < g->turn_count; i++) {
		const struct pkg_turn *t = &g->turns[i], *before = i ? t - 1 : t;
		expect(t->from_half < g->half_count && t->to_half < g->half_count, "turn %u", i);
		expect(g->halves[t->to_half].origin == end_of(g, t->from_half), "turn %u does not meet", i);
		expect(!i || before->from_half < t->from_half ||
				   (before->from_half == t->from_half && before->to_half < t->to_half),
			"turn %u is out of order", i);
	}
}

int graph_check(const struct pkg_graph *g)
{
	failures = 0;
	check_edges(g);
	check_outs(g);
	check_cycles(g);
	if (failures)
		return failures;
	check_euler(g);
	check_components(g);
	check_parents(g);
	check_crossings(g);
	check_turns(g);
	return failures;
}
