/* Which roof a building gets; flat and single-pitch roofs, and what stands on them. */
#include "tools/bake/buildings.h"

#include <math.h>

#define PARAPET_M 0.7
#define CORNICE_M 0.55
#define CORNICE_OUT_M 0.34

static struct shell_point deck_point(const struct massing *m, struct dvec2 at, double z, float ao)
{
	struct dvec2 o = m->walls.items[0].a, d = dvec2_sub(at, o), axis = m->plot->axis;
	double along = dvec2_dot(d, axis), across = dvec2_cross(axis, d);
	/* Far enough into the positive for any footprint's size, by whole tiles. */
	return (struct shell_point){ { at.x, at.y, z }, (float)(along / ROOF_TILE_M), (float)(across / ROOF_TILE_M), ao };
}

static void shift_positive(struct shell_point *points, size_t count)
{
	float u = 0.0f, v = 0.0f;
	for (size_t i = 0; i < count; i++) {
		u = fminf(u, points[i].u);
		v = fminf(v, points[i].v);
	}
	for (size_t i = 0; i < count; i++) {
		points[i].u -= floorf(u);
		points[i].v -= floorf(v);
	}
}

/* All of a deck's triangles share their vertices. */
static void draw_deck(struct massing *m, struct shell *shell, double z, float ao, bool down)
{
	uint32_t first = (uint32_t)shell->vertices.count;
	struct vec3 normal = { 0.0f, 0.0f, down ? -1.0f : 1.0f };
	float u = 0.0f, v = 0.0f;
	for (size_t i = 0; i < m->walls.count; i++) {
		struct shell_point point = deck_point(m, m->walls.items[i].a, z, ao);
		u = fminf(u, point.u);
		v = fminf(v, point.v);
		shell_vertex(shell, &point, normal);
	}
	for (size_t i = first; i < shell->vertices.count; i++) {
		shell->vertices.items[i].u -= floorf(u);
		shell->vertices.items[i].v -= floorf(v);
	}
	for (size_t i = 0; i + 2 < m->triangles.count; i += 3) {
		const uint32_t *t = &m->triangles.items[i];
		/* cppcheck-suppress objectIndex */
		shell_triangle(shell, first + t[0], first + t[down ? 2 : 1], first + t[down ? 1 : 2]);
	}
}

/* The largest circle in one of the deck's triangles: room for what stands on the roof. */
static double roomiest(const struct massing *m, struct dvec2 *centre)
{
	double best = 0.0;
	for (size_t i = 0; i + 2 < m->triangles.count; i += 3) {
		struct dvec2 p[3];
		double side[3], around = 0.0;
		for (int k = 0; k < 3; k++)
			p[k] = m->walls.items[m->triangles.items[i + (size_t)k]].a;
		for (int k = 0; k < 3; k++)
			around += side[k] = dvec2_length(dvec2_sub(p[(k + 1) % 3], p[(k + 2) % 3]));
		double area = fabs(dvec2_cross(dvec2_sub(p[1], p[0]), dvec2_sub(p[2], p[0]))) / 2.0;
		if (around < 1e-6 || 2.0 * area / around <= best)
			continue;
		best = 2.0 * area / around;
		centre->x = (side[0] * p[0].x + side[1] * p[1].x + side[2] * p[2].x) / around;
		centre->y = (side[0] * p[0].y + side[1] * p[1].y + side[2] * p[2].y) / around;
	}
	return best;
}

static void rooftop_box(const struct massing *m, struct shell *shell, double z)
{
	struct dvec2 centre = { 0.0, 0.0 };
	double room = roomiest(m, &centre);
	if (room < 2.6 || m->building->is_part || m->top - m->ground < 9.0 || m->hash % 100 >= 75)
		return;
	double size = fmin(room * 1.2, 3.0 + m->plot->half_width * 0.25), height = 2.0 + (double)(m->hash >> 8 & 3) * 0.35;
	struct shell_box box = { .centre = centre,
		.along = m->plot->axis,
		.length = size * 1.3,
		.width = size * 0.8,
		.from = z,
		.to = z + height,
		.tile_m = 3.0,
		.ao = 0.9f };
	static const uint8_t grey[3] = { 196, 194, 190 };
	shell_brush(shell, m->hash >> 12 & 1 ? MATERIAL_BLANK_METAL : MATERIAL_BLANK_PLASTER, grey);
	shell_box(shell, &box);
}

static void draw_parapet(const struct massing *m, struct shell *shell, double deck)
{
	for (size_t i = 0; i < m->walls.count; i++) {
		const struct wall *w = &m->walls.items[i];
		float length = (float)(w->length / 3.0), height = (float)((m->top - deck) / 3.0);
		struct shell_point points[4] = { { { w->b.x, w->b.y, deck }, 0.0f, 0.0f, 0.75f },
			{ { w->a.x, w->a.y, deck }, length, 0.0f, 0.75f }, { { w->a.x, w->a.y, m->top }, length, height, 1.0f },
			{ { w->b.x, w->b.y, m->top }, 0.0f, height, 1.0f } };
		shell_face(shell, points, 4);
	}
}

/* A cornice sticks out where nothing stands in its way; elsewhere it is only painted. */
static void lay_cornice(struct massing *m)
{
	bool high = m->facade.cornice && m->top - fmax(m->base, m->ground) > 6.0;
	m->cornice = high ? CORNICE_M : 0.0;
	for (size_t i = 0; i < m->walls.count; i++) {
		struct wall *w = &m->walls.items[i];
		bool clear = !w->party && w->hidden_count == 0 && !(w->facing_m < 1.6);
		w->overhang = high && clear ? CORNICE_OUT_M : 0.0;
	}
	eaves_fit(m);
	for (size_t i = 0; i < m->walls.count; i++) {
		struct wall *w = &m->walls.items[i];
		w->top = w->overhang > 0.0 ? m->top - CORNICE_M : m->top;
		w->eave_z = m->top;
	}
}

void roof_flat(struct massing *m, struct shell *shell)
{
	double deck = m->facade.parapet ? m->top - PARAPET_M : m->top;
	m->eaves = m->top;
	lay_cornice(m);
	massing_triangulate(m);
	int roofing = m->facade.roofing;
	/* Tiles and slates do not lie flat. */
	if (roofing == MATERIAL_ROOF_TILES || roofing == MATERIAL_ROOF_SLATE)
		roofing = MATERIAL_ROOF_GRAVEL;
	shell_brush(shell, roofing, m->facade.roof_rgb);
	draw_deck(m, shell, deck, 0.95f, false);
	if (m->facade.parapet) {
		shell_brush(shell, MATERIAL_BLANK_PLASTER, m->facade.wall_rgb);
		draw_parapet(m, shell, deck);
	}
	eaves_draw(m, &(struct eaves){ CORNICE_M, MATERIAL_CORNICE, m->facade.wall_rgb, true }, shell);
	rooftop_box(m, shell, deck);
}

/* The way that a single pitch falls: as given, else towards the longest wall that no neighbour hides. */
static struct dvec2 fall_of(const struct massing *m)
{
	double bearing = m->building->roof_direction_deg * BLVD_PI / 180.0;
	if (isfinite(bearing))
		return (struct dvec2){ sin(bearing), cos(bearing) };
	const struct wall *best = &m->walls.items[0];
	for (size_t i = 1; i < m->walls.count; i++) {
		const struct wall *wall = &m->walls.items[i];
		if (wall->length - (wall->party ? 1000.0 : 0.0) > best->length - (best->party ? 1000.0 : 0.0))
			best = wall;
	}
	return best->out;
}

struct pitch {
	struct dvec2 fall;
	double low, high; /* along -fall */
	double eaves, top;
};

static double pitch_z(const struct pitch *pitch, struct dvec2 at)
{
	double share = (-dvec2_dot(at, pitch->fall) - pitch->low) / fmax(pitch->high - pitch->low, 0.01);
	return pitch->eaves + (pitch->top - pitch->eaves) * fmin(fmax(share, 0.0), 1.0);
}

void roof_skillion(struct massing *m, struct shell *shell)
{
	struct pitch pitch = { fall_of(m), INFINITY, -INFINITY, m->eaves, m->top };
	for (size_t i = 0; i < m->walls.count; i++) {
		double up = -dvec2_dot(m->walls.items[i].a, pitch.fall);
		pitch.low = fmin(pitch.low, up);
		pitch.high = fmax(pitch.high, up);
	}
	massing_triangulate(m);
	shell_brush(shell, m->facade.roofing, m->facade.roof_rgb);
	for (size_t i = 0; i + 2 < m->triangles.count; i += 3) {
		struct shell_point points[3];
		for (int k = 0; k < 3; k++) {
			struct dvec2 at = m->walls.items[m->triangles.items[i + (size_t)k]].a, o = m->walls.items[0].a;
			points[k].at = (struct dvec3){ at.x, at.y, pitch_z(&pitch, at) };
			points[k].u = (float)(dvec2_cross(pitch.fall, dvec2_sub(at, o)) / ROOF_TILE_M);
			points[k].v = (float)(-dvec2_dot(dvec2_sub(at, o), pitch.fall) / ROOF_TILE_M);
			points[k].ao = 1.0f;
		}
		shift_positive(points, 3);
		shell_face(shell, points, 3);
	}
	shell_brush(shell, m->facade.blank, m->facade.wall_rgb);
	for (size_t i = 0; i < m->walls.count; i++) {
		const struct wall *w = &m->walls.items[i];
		double za = pitch_z(&pitch, w->a), zb = pitch_z(&pitch, w->b);
		struct shell_point points[4] = { { { w->a.x, w->a.y, m->eaves }, 0, 0, 1 },
			{ { w->b.x, w->b.y, m->eaves }, (float)(w->length / 3.0), 0, 1 },
			{ { w->b.x, w->b.y, zb }, (float)(w->length / 3.0), (float)((zb - m->eaves) / 3.0), 1 },
			{ { w->a.x, w->a.y, za }, 0, (float)((za - m->eaves) / 3.0), 1 } };
		bool a_up = za > m->eaves + 0.001, b_up = zb > m->eaves + 0.001;
		if (a_up && b_up)
			shell_face(shell, points, 4);
		else if (b_up)
			shell_face(shell, points, 3);
		else if (a_up)
			shell_face(shell, (struct shell_point[3]){ points[0], points[1], points[3] }, 3);
	}
}

static bool try_roof(struct massing *m, struct shell *shell)
{
	switch (m->plot->roof) {
	case ROOF_SKILLION:
		roof_skillion(m, shell);
		return true;
	case ROOF_PYRAMIDAL:
	case ROOF_DOME:
	case ROOF_ONION:
	case ROOF_CONE:
		return roof_radial(m, shell) || roof_pitched(m, shell);
	case ROOF_GABLED:
	case ROOF_HIPPED:
	case ROOF_HALF_HIPPED:
	case ROOF_MANSARD:
	case ROOF_GAMBREL:
	case ROOF_ROUND:
		return roof_pitched(m, shell);
	case ROOF_FLAT:
	case ROOF_UNKNOWN:
		break;
	}
	return false;
}

void roof_build(struct massing *m, struct shell *shell)
{
	m->cornice = 0.0;
	for (size_t i = 0; i < m->walls.count; i++)
		m->walls.items[i].overhang = 0.0;
	bool flat = m->plot->roof == ROOF_FLAT || m->plot->roof == ROOF_UNKNOWN || m->top - m->eaves < 0.3;
	if (!flat && try_roof(m, shell))
		return;
	m->roof_faults += !flat;
	roof_flat(m, shell);
}

void facade_underside(struct massing *m, struct shell *shell)
{
	massing_triangulate(m);
	shell_brush(shell, MATERIAL_BLANK_CONCRETE, m->facade.wall_rgb);
	draw_deck(m, shell, m->base, 0.5f, true);
}
