/*
 * Walls: a strip for the ground floor, a strip for the storeys above it, each a whole number of bays wide and storeys
 * high, so that no window is cut. What a neighbour hides is left out.
 */
#include "tools/bake/buildings.h"

#include <math.h>

#include "platform/base/rng.h"

#define BLANK_TILE_M 3.0
#define FRONT_BAY_M 3.9

struct strip {
	double s0, s1, z0, z1;
	double u0, u1, v0, v1;
};

/* How a wall is divided. */
struct storeys {
	double door, first, top; /* z: ground floor, first floor, end of the top storey (where the eaves were planned) */
	int upper;               /* storeys from `first` to `top` */
};

/* Openness of the sky: less near the ground, less in a narrow street or court. */
float wall_ao(const struct massing *m, const struct wall *w, double z)
{
	double above = fmin(fmax((z - w->ground) / 3.5, -0.15), 1.0);
	double contact = 0.66 + 0.34 * above, open = 1.0;
	if (isfinite(w->facing_m)) {
		double hidden = atan2(fmax(w->facing_top - z, 0.0), fmax(w->facing_m, 0.5)) / (BLVD_PI / 2.0);
		open = 1.0 - 0.5 * hidden;
	}
	(void)m;
	return (float)(contact * open);
}

static void draw_strip(const struct massing *m, struct shell *shell, const struct wall *w, const struct strip *strip)
{
	if (strip->s1 - strip->s0 < 0.005 || strip->z1 - strip->z0 < 0.005)
		return;
	struct dvec2 a = strip->s0 > 0.001 ? dvec2_add(w->a, dvec2_scale(w->along, strip->s0)) : w->a;
	struct dvec2 b = strip->s1 < w->length - 0.001 ? dvec2_add(w->a, dvec2_scale(w->along, strip->s1)) : w->b;
	float low = wall_ao(m, w, strip->z0), high = wall_ao(m, w, strip->z1);
	struct shell_point points[4] = { { { a.x, a.y, strip->z0 }, (float)strip->u0, (float)strip->v0, low },
		{ { b.x, b.y, strip->z0 }, (float)strip->u1, (float)strip->v0, low },
		{ { b.x, b.y, strip->z1 }, (float)strip->u1, (float)strip->v1, high },
		{ { a.x, a.y, strip->z1 }, (float)strip->u0, (float)strip->v1, high } };
	shell_face(shell, points, 4);
}

static void draw_blank(const struct massing *m, struct shell *shell, const struct wall *w, double z0, double z1)
{
	shell_brush(shell, m->facade.blank, m->facade.wall_rgb);
	struct strip strip = { 0.0, w->length, z0, z1, 0.0, w->length / BLANK_TILE_M, 0.0, (z1 - z0) / BLANK_TILE_M };
	draw_strip(m, shell, w, &strip);
}

static int whole(double value)
{
	int out = (int)lrint(value);
	return out < 1 ? 1 : out > 90 ? 90 : out;
}

static int bays_of(const struct wall *w, double bay_m)
{
	return w->length < 0.62 * bay_m ? 0 : whole(w->length / bay_m);
}

/* Windows of different walls light up differently: each starts at its own bay number. */
static double first_bay(const struct massing *m, const struct wall *w)
{
	size_t index = (size_t)(w - m->walls.items);
	return (double)((index * 23 + (m->hash >> 40 & 63)) % 128);
}

static struct storeys divide(const struct massing *m, const struct wall *w)
{
	const struct facade *f = &m->facade;
	struct storeys out = { .door = m->sloping ? w->ground : m->door, .top = m->eaves };
	out.top -= m->cornice;
	if (!m->has_ground_floor) {
		out.door = out.first = m->base;
		out.upper = whole((out.top - out.first) / f->storey_m);
		return out;
	}
	double height = out.top - out.door, ratio = f->shop ? fmax(f->ground_ratio, 1.2) : f->ground_ratio;
	double levels = round(m->building->levels);
	if (levels < 1.0 || height / levels < 2.3 || height / levels > 5.5)
		levels = fmax(1.0, round(height / f->storey_m - (ratio - 1.0)));
	double storey = height / (levels - 1.0 + ratio);
	out.upper = (int)levels - 1;
	out.first = out.upper > 0 ? out.door + storey * ratio : out.top;
	return out;
}

static bool on_street(const struct wall *w)
{
	return w->street_m < 26.0;
}

/* Below the door's level, where the ground falls along the house, a plain base shows; where it falls by more than a
 * storey, the house has storeys there. */
static double draw_base(
	const struct massing *m, struct shell *shell, const struct wall *w, const struct storeys *st, bool windows)
{
	if (st->door - m->base < 1.3)
		return m->base;
	const struct facade *f = &m->facade;
	int bays = bays_of(w, f->bay_m);
	int below = windows && bays > 0 && f->upper != f->blank ? (int)((st->door - w->low - 0.4) / f->storey_m) : 0;
	double z1 = below > 0 ? st->door - below * f->storey_m : st->door - 0.3;
	bool stone = f->blank == MATERIAL_BLANK_PLASTER || f->blank == MATERIAL_BLANK_STONE;
	shell_brush(shell, stone ? MATERIAL_BLANK_STONE : f->blank, f->base_rgb);
	struct strip strip = { 0.0, w->length, m->base, z1, 0.0, w->length / BLANK_TILE_M, 0.0,
		(z1 - m->base) / BLANK_TILE_M };
	draw_strip(m, shell, w, &strip);
	if (below <= 0)
		return z1;
	double u = first_bay(m, w);
	shell_brush(shell, f->upper, f->base_rgb);
	strip = (struct strip){ 0.0, w->length, z1, st->door, u, u + bays, 60.0, 60.0 + below };
	draw_strip(m, shell, w, &strip);
	return st->door;
}

struct run {
	int material;
	int bays;
	double s0, s1;
};

/* A piece of the ground floor; its tile starts at the door's level, so that what lies below shows the plain top of the
 * tile under it. */
static void draw_run(const struct massing *m, struct shell *shell, const struct wall *w, const struct storeys *st,
	double low, const struct run *run)
{
	double height = st->first - st->door, u = first_bay(m, w);
	shell_brush(shell, run->material, m->facade.base_rgb);
	struct strip strip = { run->s0, run->s1, low, st->first, u, u + run->bays, 1.0 - (st->door - low) / height, 2.0 };
	draw_strip(m, shell, w, &strip);
}

/* Neighbouring shops differ; an arcade of stone does not. */
static int front_of(const struct massing *m, uint64_t hash, int last)
{
	static const uint8_t fronts[8] = { MATERIAL_SHOP_CLASSIC, MATERIAL_SHOP_GLASS, MATERIAL_SHOP_AWNING,
		MATERIAL_SHOP_CAFE, MATERIAL_SHOP_CLASSIC_BLUE, MATERIAL_SHOP_CLASSIC_RED, MATERIAL_SHOP_GLASS,
		MATERIAL_SHOP_PALE };
	if (m->facade.shop == MATERIAL_SHOP_STONE)
		return MATERIAL_SHOP_STONE;
	int out = fronts[hash & 7];
	return out == last ? fronts[(hash + 1) & 7] : out;
}

static void draw_fronts(
	const struct massing *m, struct shell *shell, const struct wall *w, const struct storeys *st, double low, bool door)
{
	int bays = whole(w->length / FRONT_BAY_M);
	double bay = w->length / bays, s = 0.0;
	uint64_t hash = hash_u64(m->hash + (uint64_t)(w - m->walls.items) * 31);
	int left = bays;
	/* The way to the flats above. */
	if (door && bays >= 2) {
		draw_run(m, shell, w, st, low, &(struct run){ m->facade.door, 1, 0.0, bay * 0.8 });
		s = bay * 0.8;
		left--;
		bay = (w->length - s) / left;
	}
	for (int i = 0, last = 0; left > 0; i++) {
		uint64_t pick = hash_u64(hash + (uint64_t)i);
		int width = left <= 3 ? left : 2 + (int)(pick & 1);
		int material = front_of(m, pick >> 8, last);
		draw_run(m, shell, w, st, low, &(struct run){ material, width, s, s + bay * width });
		if (material == MATERIAL_SHOP_AWNING || material == MATERIAL_SHOP_CAFE)
			facade_awning(m, w, s + 0.1, s + bay * width - 0.1, st->door + (st->first - st->door) * 0.74, shell);
		s += bay * width;
		left -= width;
		last = material;
	}
}

static void draw_doorway(
	const struct massing *m, struct shell *shell, const struct wall *w, const struct storeys *st, double low, int bays)
{
	double bay = w->length / bays;
	int at = bays == 1 ? 0 : bays / 2 - (int)(m->hash >> 50 & 1) * (bays % 2 == 0);
	if (at > 0)
		draw_run(m, shell, w, st, low, &(struct run){ m->facade.ground, at, 0.0, bay * at });
	draw_run(m, shell, w, st, low, &(struct run){ m->facade.door, 1, bay * at, bay * (at + 1) });
	if (at + 1 < bays)
		draw_run(m, shell, w, st, low, &(struct run){ m->facade.ground, bays - at - 1, bay * (at + 1), w->length });
}

static void draw_gates(
	const struct massing *m, struct shell *shell, const struct wall *w, const struct storeys *st, double low)
{
	double pitch = m->facade.gate == MATERIAL_GATE_GARAGE ? 3.0 : 4.6;
	int bays = whole(w->length / pitch);
	int gates = m->facade.gate == MATERIAL_GATE_GARAGE ? bays : bays >= 6 ? 2 : 1;
	double bay = w->length / bays;
	draw_run(m, shell, w, st, low, &(struct run){ m->facade.gate, gates, 0.0, bay * gates });
	if (gates < bays)
		draw_run(m, shell, w, st, low, &(struct run){ m->facade.ground, bays - gates, bay * gates, w->length });
}

static void draw_ground_floor(
	const struct massing *m, struct shell *shell, const struct wall *w, const struct storeys *st, double low)
{
	const struct facade *f = &m->facade;
	bool door = m->door_wall == (uint32_t)(w - m->walls.items);
	int bays = bays_of(w, f->bay_m);
	bool deep = st->first - st->door > 2.1;
	bool court = isfinite(w->facing_m) && w->facing_m < 1.6;
	if (f->shop && on_street(w) && w->length > 2.2 && deep)
		draw_fronts(m, shell, w, st, low, door && f->door);
	else if (door && f->gate && w->length > 2.0 && deep)
		draw_gates(m, shell, w, st, low);
	else if (door && f->door && bays > 0 && deep)
		draw_doorway(m, shell, w, st, low, bays);
	else if (bays > 0 && deep && !court && f->ground != f->blank)
		draw_run(m, shell, w, st, low, &(struct run){ f->ground, bays, 0.0, w->length });
	else
		draw_blank(m, shell, w, low, st->first);
}

/* `upto` may lie below the planned top: eaves hang down over the last storey's lintels. */
static void draw_upper(const struct massing *m, struct shell *shell, const struct wall *w, const struct storeys *st,
	double from, double upto)
{
	const struct facade *f = &m->facade;
	int bays = bays_of(w, f->bay_m);
	bool court = isfinite(w->facing_m) && w->facing_m < 1.6;
	if (bays == 0 || court || f->upper == f->blank) {
		draw_blank(m, shell, w, from, upto);
		return;
	}
	double storey = (st->top - st->first) / st->upper, u = first_bay(m, w);
	shell_brush(shell, f->upper, f->wall_rgb);
	struct strip strip = { 0.0, w->length, from, upto, u, u + bays, 2.0 + (from - st->first) / storey,
		2.0 + (upto - st->first) / storey };
	draw_strip(m, shell, w, &strip);
}

static void draw_cornice(const struct massing *m, struct shell *shell, const struct wall *w, double from, double to)
{
	shell_brush(shell, MATERIAL_CORNICE, m->facade.wall_rgb);
	struct strip strip = { 0.0, w->length, from, to, 0.0, fmax(1.0, round(w->length / 3.0)), 0.0, 0.998 };
	draw_strip(m, shell, w, &strip);
}

static void draw_free_wall(const struct massing *m, struct shell *shell, const struct wall *w)
{
	struct storeys st = divide(m, w);
	double end = fmin(st.top, w->top);
	if (end - st.door < 1.9) {
		draw_blank(m, shell, w, m->base, w->top);
		return;
	}
	double from = m->base;
	if (m->has_ground_floor) {
		from = draw_base(m, shell, w, &st, true);
		if (st.upper == 0)
			st.first = w->top > st.top ? st.top : w->top;
		draw_ground_floor(m, shell, w, &st, from);
		from = st.first;
	}
	if (st.upper > 0) {
		draw_upper(m, shell, w, &st, from, end);
		facade_balconies(m, w, st.first, (st.top - st.first) / st.upper, st.upper, shell);
	}
	if (w->top > end + 0.01)
		draw_cornice(m, shell, w, end, w->top);
}

/* What neighbours leave open of base..top, lowest first. */
static int open_ranges(const struct wall *w, double base, double top, struct z_range out[HIDDEN_LIMIT + 1])
{
	int count = 1;
	out[0] = (struct z_range){ base, top };
	for (int h = 0; h < w->hidden_count; h++) {
		struct z_range hidden = w->hidden[h];
		for (int i = 0; i < count; i++) {
			struct z_range piece = out[i];
			if (hidden.to <= piece.from || hidden.from >= piece.to)
				continue;
			out[i] = (struct z_range){ piece.from, fmin(piece.to, hidden.from) };
			struct z_range rest = { fmax(piece.from, hidden.to), piece.to };
			if (out[i].to - out[i].from < 0.03)
				out[i] = rest;
			else if (rest.to - rest.from > 0.03 && count <= HIDDEN_LIMIT)
				out[count++] = rest;
		}
	}
	return count;
}

static void draw_party_wall(const struct massing *m, struct shell *shell, const struct wall *w)
{
	struct z_range open[HIDDEN_LIMIT + 1];
	int count = open_ranges(w, m->base, w->top, open);
	struct storeys st = divide(m, w);
	for (int i = 0; i < count; i++) {
		double from = open[i].from, to = open[i].to, storey = st.upper ? (st.top - st.first) / st.upper : 99.0;
		if (to - from < 0.03)
			continue;
		double floor_z = st.first + ceil(fmax(from - st.first, 0.0) / storey - 0.05) * storey;
		if (!w->annex || to < w->top - 0.01 || fmin(to, st.top) - floor_z < storey * 0.9) {
			draw_blank(m, shell, w, from, to);
			continue;
		}
		if (floor_z > from)
			draw_blank(m, shell, w, from, floor_z);
		draw_upper(m, shell, w, &st, fmax(floor_z, from), fmin(to, st.top));
		if (to > st.top + 0.01)
			draw_cornice(m, shell, w, st.top, to);
	}
}

/* A church wall is one window high, whatever its height. */
static void draw_church_wall(const struct massing *m, struct shell *shell, const struct wall *w)
{
	double door = m->sloping ? w->ground : m->door, height = w->top - door;
	int bays = bays_of(w, fmin(fmax(height * 0.45, 2.6), 5.5));
	if (w->party || w->hidden_count || bays == 0 || height < 3.0 || !m->has_ground_floor) {
		draw_party_wall(m, shell, w);
		return;
	}
	double low = draw_base(m, shell, w, &(struct storeys){ .door = door }, false);
	double u = first_bay(m, w), bay = w->length / bays;
	bool entrance = m->door_wall == (uint32_t)(w - m->walls.items) && height > 6.0;
	int at = entrance ? bays / 2 : bays;
	struct strip strip = { 0.0, bay * at, low, w->top, u, u + at, 1.0 - (door - low) / height, 2.0 };
	shell_brush(shell, m->facade.upper, m->facade.wall_rgb);
	draw_strip(m, shell, w, &strip);
	if (!entrance)
		return;
	strip = (struct strip){ bay * (at + 1), w->length, low, w->top, u, u + bays - at - 1, strip.v0, 2.0 };
	draw_strip(m, shell, w, &strip);
	double lintel = door + fmin(5.0, height * 0.7);
	shell_brush(shell, m->facade.door, m->facade.wall_rgb);
	strip =
		(struct strip){ bay * at, bay * (at + 1), low, lintel, 0.0, 1.0, 1.0 - (door - low) / (lintel - door), 2.0 };
	draw_strip(m, shell, w, &strip);
	shell_brush(shell, m->facade.blank, m->facade.wall_rgb);
	strip = (struct strip){ bay * at, bay * (at + 1), lintel, w->top, 0.0, bay / BLANK_TILE_M, 0.0,
		(w->top - lintel) / BLANK_TILE_M };
	draw_strip(m, shell, w, &strip);
}

static void draw_tower_wall(const struct massing *m, struct shell *shell, const struct wall *w)
{
	double height = w->top - fmax(m->base, m->ground), belfry = fmin(5.0, height * 0.4);
	if (height < 9.0 || m->area < 14.0 || w->party || w->hidden_count || w->length < 2.2) {
		draw_party_wall(m, shell, w);
		return;
	}
	draw_blank(m, shell, w, m->base, w->top - belfry);
	shell_brush(shell, MATERIAL_WALL_BELFRY, m->facade.wall_rgb);
	struct strip strip = { 0.0, w->length, w->top - belfry, w->top, 0.0, whole(w->length / 4.0), 0.0, 1.0 };
	draw_strip(m, shell, w, &strip);
}

void facade_build(struct massing *m, struct shell *shell)
{
	for (size_t i = 0; i < m->walls.count; i++) {
		const struct wall *w = &m->walls.items[i];
		if (w->top - m->base < 0.02)
			continue;
		if (m->facade.upper == MATERIAL_WALL_CHURCH)
			draw_church_wall(m, shell, w);
		else if (m->building->kind == BUILDING_TOWER)
			draw_tower_wall(m, shell, w);
		else if (w->party || w->hidden_count)
			draw_party_wall(m, shell, w);
		else
			draw_free_wall(m, shell, w);
	}
}

#define SLAB_M 0.45

static void draw_posts(const struct massing *m, struct shell *shell, double under)
{
	static const uint8_t grey[3] = { 198, 198, 196 };
	shell_brush(shell, MATERIAL_TRIM, grey);
	size_t count = m->ring_first.items[1], posts = 0;
	for (size_t i = 0; i < count && posts < 8; i++) {
		const struct wall *w = &m->walls.items[i], *before = &m->walls.items[i ? i - 1 : count - 1];
		if (dvec2_cross(before->along, w->along) < 0.4 || w->length < 1.2)
			continue;
		struct dvec2 in = dvec2_add(dvec2_scale(before->out, -0.35), dvec2_scale(w->out, -0.35));
		struct shell_box box = { .centre = dvec2_add(w->a, in),
			.along = w->along,
			.length = 0.24,
			.width = 0.24,
			.from = m->base,
			.to = under,
			.tile_m = 2.0,
			.ao = 0.85f };
		shell_box(shell, &box);
		posts++;
	}
}

/* A roof on posts: a slab and what carries it. */
void facade_canopy(struct massing *m, struct shell *shell)
{
	double base = m->base;
	m->base = fmax(m->eaves - SLAB_M, m->base + 0.3);
	shell_brush(shell, MATERIAL_TRIM, m->facade.trim_rgb);
	for (size_t i = 0; i < m->walls.count; i++) {
		const struct wall *w = &m->walls.items[i];
		struct strip strip = { 0.0, w->length, m->base, w->top, 0.0, w->length / 2.0, 0.0, (w->top - m->base) / 2.0 };
		draw_strip(m, shell, w, &strip);
	}
	facade_underside(m, shell);
	double under = m->base;
	m->base = base;
	if (m->has_ground_floor)
		draw_posts(m, shell, under);
}
