/* Domes, onions, cones and pyramids: the outline drawn in towards its centre while it rises along a profile. */
#include "tools/bake/buildings.h"

#include <math.h>

struct step {
	double r, z; /* shares of the outline's radius and of the rise */
};

static const struct step dome[] = { { 1.0, 0.0 }, { 0.966, 0.259 }, { 0.866, 0.5 }, { 0.707, 0.707 }, { 0.5, 0.866 },
	{ 0.259, 0.966 }, { 0.0, 1.0 } };
static const struct step onion[] = { { 1.0, 0.0 }, { 1.13, 0.12 }, { 1.15, 0.24 }, { 1.0, 0.40 }, { 0.68, 0.56 },
	{ 0.34, 0.70 }, { 0.13, 0.84 }, { 0.0, 1.0 } };
static const struct step cone[] = { { 1.0, 0.0 }, { 0.0, 1.0 } };

struct turn {
	const struct step *steps;
	size_t count;
	struct dvec2 centre;
	double from, rise;
	bool smooth;
};

static struct dvec2 centroid(const struct massing *m)
{
	struct dvec2 o = m->walls.items[0].a, sum = { 0.0, 0.0 };
	double twice = 0.0;
	for (size_t i = 0; i < m->walls.count; i++) {
		struct dvec2 a = dvec2_sub(m->walls.items[i].a, o), b = dvec2_sub(m->walls.items[i].b, o);
		double cross = dvec2_cross(a, b);
		twice += cross;
		sum = dvec2_add(sum, dvec2_scale(dvec2_add(a, b), cross));
	}
	return dvec2_add(o, dvec2_scale(sum, 1.0 / (3.0 * twice)));
}

static bool star_shaped(const struct massing *m, struct dvec2 centre)
{
	if (m->ring_first.count != 2)
		return false;
	for (size_t i = 0; i < m->walls.count; i++) {
		const struct wall *w = &m->walls.items[i];
		if (dvec2_dot(dvec2_sub(w->a, centre), w->out) < 0.25)
			return false;
	}
	return true;
}

static struct shell_point ring_point(const struct turn *turn, struct dvec2 corner, size_t step, double u, double v)
{
	struct dvec2 at = dvec2_add(turn->centre, dvec2_scale(dvec2_sub(corner, turn->centre), turn->steps[step].r));
	return (struct shell_point){ { at.x, at.y, turn->from + turn->rise * turn->steps[step].z },
		(float)(u / ROOF_TILE_M), (float)(v / ROOF_TILE_M), 1.0f };
}

static struct vec3 turned_normal(const struct turn *turn, struct dvec2 corner, size_t step)
{
	size_t before = step ? step - 1 : step, after = step + 1 < turn->count ? step + 1 : step;
	struct dvec2 out = dvec2_sub(corner, turn->centre);
	double radius = dvec2_length(out);
	double run = (turn->steps[before].r - turn->steps[after].r) * radius;
	double rise = (turn->steps[after].z - turn->steps[before].z) * turn->rise;
	return vec3_normalize((struct vec3){ (float)(out.x / radius * rise), (float)(out.y / radius * rise), (float)run });
}

static void draw_smooth(
	struct shell *shell, const struct turn *turn, const struct wall *w, size_t s, const struct shell_point corner[4])
{
	bool tip = s + 2 == turn->count;
	uint32_t a = shell_vertex(shell, &corner[0], turned_normal(turn, w->a, s));
	uint32_t b = shell_vertex(shell, &corner[1], turned_normal(turn, w->b, s));
	struct vec3 up = { 0.0f, 0.0f, 1.0f };
	uint32_t c = shell_vertex(shell, &corner[2], tip ? up : turned_normal(turn, w->b, s + 1));
	shell_triangle(shell, a, b, c);
	if (!tip)
		shell_triangle(shell, a, c, shell_vertex(shell, &corner[3], turned_normal(turn, w->a, s + 1)));
}

static void draw_side(struct shell *shell, const struct turn *turn, const struct wall *w)
{
	double v = 0.0;
	for (size_t s = 0; s + 1 < turn->count; s++) {
		double run = (turn->steps[s + 1].r - turn->steps[s].r) * dvec2_length(dvec2_sub(w->a, turn->centre));
		double next = v + hypot(run, (turn->steps[s + 1].z - turn->steps[s].z) * turn->rise);
		struct shell_point corner[4] = { ring_point(turn, w->a, s, 0.0, v), ring_point(turn, w->b, s, w->length, v),
			ring_point(turn, w->b, s + 1, w->length, next), ring_point(turn, w->a, s + 1, 0.0, next) };
		bool tip = s + 2 == turn->count;
		if (turn->smooth)
			draw_smooth(shell, turn, w, s, corner);
		else
			shell_face(shell, corner, tip ? 3 : 4);
		v = next;
	}
}

bool roof_radial(struct massing *m, struct shell *shell)
{
	struct turn turn = { cone, 2, centroid(m), m->eaves, m->top - m->eaves, false };
	if (!star_shaped(m, turn.centre))
		return false;
	if (m->plot->roof == ROOF_DOME) {
		turn.steps = dome;
		turn.count = sizeof(dome) / sizeof(dome[0]);
	} else if (m->plot->roof == ROOF_ONION) {
		turn.steps = onion;
		turn.count = sizeof(onion) / sizeof(onion[0]);
	}
	turn.smooth = m->walls.count >= 8;
	shell_brush(shell, m->facade.roofing, m->facade.roof_rgb);
	for (size_t i = 0; i < m->walls.count; i++)
		draw_side(shell, &turn, &m->walls.items[i]);
	return true;
}
