/*
 * Eaves and cornices: what of a roof sticks out over the walls. Every wall has its overhang, or none; the eaves lines
 * meet in mitres, and where one would turn round or run far out at a sharp corner it is given up.
 */
#include "tools/bake/buildings.h"

#include <math.h>

#define REACH_M 1.2

/* Where two eaves lines meet, each its overhang away from the wall. */
static struct dvec2 mitre(const struct wall *before, const struct wall *after)
{
	double det = dvec2_cross(before->out, after->out);
	if (fabs(det) < 0.08)
		return dvec2_add(after->a, dvec2_scale(after->out, fmin(before->overhang, after->overhang)));
	struct dvec2 d = { (before->overhang * after->out.y - after->overhang * before->out.y) / det,
		(after->overhang * before->out.x - before->overhang * after->out.x) / det };
	return dvec2_add(after->a, d);
}

static bool corner_holds(struct wall *before, struct wall *w)
{
	if (w->overhang <= 0.0 && before->overhang <= 0.0)
		return true;
	bool straight = fabs(dvec2_cross(before->out, w->out)) < 0.08 && fabs(before->overhang - w->overhang) > 0.0;
	if (!straight && dvec2_length(dvec2_sub(mitre(before, w), w->a)) <= REACH_M)
		return true;
	w->overhang = before->overhang = 0.0;
	return false;
}

static bool line_holds(struct wall *before, struct wall *w, struct wall *next)
{
	struct dvec2 a = mitre(before, w), b = mitre(w, next);
	if (dvec2_dot(dvec2_sub(b, a), w->along) >= 0.2 * w->length)
		return true;
	bool none = w->overhang <= 0.0 && before->overhang <= 0.0 && next->overhang <= 0.0;
	w->overhang = before->overhang = next->overhang = 0.0;
	return none;
}

static bool eaves_hold(struct massing *m)
{
	bool good = true;
	for (size_t r = 0; r + 1 < m->ring_first.count; r++)
		for (size_t i = m->ring_first.items[r]; i < m->ring_first.items[r + 1]; i++)
			good &= corner_holds(&m->walls.items[massing_prev(m, r, i)], &m->walls.items[i]);
	for (size_t r = 0; r + 1 < m->ring_first.count && good; r++)
		for (size_t i = m->ring_first.items[r]; i < m->ring_first.items[r + 1]; i++)
			good &= line_holds(
				&m->walls.items[massing_prev(m, r, i)], &m->walls.items[i], &m->walls.items[massing_next(m, r, i)]);
	return good;
}

void eaves_fit(struct massing *m)
{
	for (size_t i = 0; i < m->walls.count + 2 && !eaves_hold(m); i++)
		;
	for (size_t r = 0; r + 1 < m->ring_first.count; r++)
		for (size_t i = m->ring_first.items[r]; i < m->ring_first.items[r + 1]; i++)
			m->walls.items[i].eave = mitre(&m->walls.items[massing_prev(m, r, i)], &m->walls.items[i]);
}

static struct shell_point point_at(struct dvec2 at, double z, double u, double v, double ao)
{
	return (struct shell_point){ { at.x, at.y, z }, (float)u, (float)v, (float)ao };
}

static void draw_run(const struct massing *m, const struct eaves *eaves, struct shell *shell, const struct wall *before,
	const struct wall *w, const struct wall *next)
{
	double low = w->top, high = w->top + eaves->depth, l = fmax(1.0, round(w->length / 3.0));
	struct dvec2 a = w->eave, b = next->eave;
	shell_brush(shell, eaves->front, eaves->rgb);
	shell_face(shell,
		(struct shell_point[4]){ point_at(a, low, 0, 0, 0.9), point_at(b, low, l, 0, 0.9),
			point_at(b, high, l, 0.998, 1), point_at(a, high, 0, 0.998, 1) },
		4);
	shell_brush(shell, MATERIAL_TRIM, eaves->rgb);
	shell_face(shell,
		(struct shell_point[4]){ point_at(w->a, low, 0, 0, 0.5), point_at(w->b, low, l, 0, 0.5),
			point_at(b, low, l, 0.3, 0.7), point_at(a, low, 0, 0.3, 0.7) },
		4);
	if (eaves->lid)
		shell_face(shell,
			(struct shell_point[4]){ point_at(a, high, 0, 0, 1), point_at(b, high, l, 0, 1),
				point_at(w->b, high, l, 0.3, 0.95), point_at(w->a, high, 0, 0.3, 0.95) },
			4);
	double wall_top = eaves->lid ? high : m->eaves;
	if (before->overhang <= 0.0)
		shell_face(shell,
			(struct shell_point[4]){ point_at(w->a, low, 0, 0, 0.9), point_at(a, low, 0.3, 0, 0.9),
				point_at(a, high, 0.3, 0.2, 1), point_at(w->a, wall_top, 0, 0.4, 1) },
			4);
	if (next->overhang <= 0.0)
		shell_face(shell,
			(struct shell_point[4]){ point_at(b, low, 0, 0, 0.9), point_at(w->b, low, 0.3, 0, 0.9),
				point_at(w->b, wall_top, 0.3, 0.4, 1), point_at(b, high, 0, 0.2, 1) },
			4);
}

void eaves_draw(const struct massing *m, const struct eaves *eaves, struct shell *shell)
{
	for (size_t r = 0; r + 1 < m->ring_first.count; r++)
		for (size_t i = m->ring_first.items[r]; i < m->ring_first.items[r + 1]; i++)
			if (m->walls.items[i].overhang > 0.0)
				draw_run(m, eaves, shell, &m->walls.items[massing_prev(m, r, i)], &m->walls.items[i],
					&m->walls.items[massing_next(m, r, i)]);
}
