/*
 * Pitched roofs of any outline: gabled, hipped, half-hipped, mansard, gambrel, barrel. The straight skeleton says which
 * face a place belongs to and how far it is from its eaves; a profile turns that distance into height. Walls that a
 * neighbour of the same height touches are gables, so that rows of houses get one ridge along the street.
 */
#include "tools/bake/buildings.h"

#include <math.h>
#include <stdlib.h>

#include "platform/base/rng.h"

#define STRAIGHT_M 0.05 /* corners flatter than this do not bend the roof */
#define GUTTER_M 0.16
#define PROFILE_LIMIT 8

/* Height over distance from the eaves: linear between the breaks, level behind the last. */
struct profile {
	double t[PROFILE_LIMIT], z[PROFILE_LIMIT];
	int count;
};

/* The outline's corners, and the walls between them. */
struct corner {
	size_t wall;  /* that starts here */
	size_t walls; /* up to the next corner */
	size_t ring;
	double speed, delay, length;
	struct dvec2 out;
};

struct roof {
	struct massing *m;
	struct shell *shell;
	ARRAY(struct corner) corners;
	ARRAY(size_t) ring_first;
	ARRAY(struct dvec2) points;
	ARRAY(double) speeds;
	ARRAY(double) delays;
	ARRAY(struct dvec2) face;       /* one face's polygon: plan, or along and height */
	ARRAY(struct roof_point) spots; /* the same corners */
	index_array ears;
	struct profile profile;
	bool level_eaves; /* a steep roof's eaves stick out level, as a cornice; a gentle one's follow the slope */
};

struct roof_point {
	struct dvec2 at;
	double t;
	size_t wall; /* at whose start it is, or NONE */
	bool inset;  /* on the wall, not on the eaves line */
};
#define NONE ((size_t)-1)

static bool bends(struct dvec2 a, struct dvec2 p, struct dvec2 b)
{
	struct dvec2 ab = dvec2_sub(b, a), ap = dvec2_sub(p, a), pb = dvec2_sub(b, p);
	double length = dvec2_length(ab);
	if (length < 1e-6 || dvec2_dot(ap, pb) < 0.0)
		return true;
	double off = fabs(dvec2_cross(ab, ap)) / length;
	double sine = fabs(dvec2_cross(ap, pb)) / (dvec2_length(ap) * dvec2_length(pb));
	return off > STRAIGHT_M && sine > 0.03;
}

static void find_corners(struct roof *roof)
{
	struct massing *m = roof->m;
	for (size_t r = 0; r + 1 < m->ring_first.count; r++) {
		size_t first = m->ring_first.items[r], count = m->ring_first.items[r + 1] - first;
		size_t start = roof->corners.count;
		ARRAY_PUSH(&roof->ring_first, start);
		struct dvec2 last = m->walls.items[massing_prev(m, r, first)].a;
		for (size_t i = 0; i < count; i++) {
			const struct wall *w = &m->walls.items[first + i];
			bool must = count - i <= 3 && roof->corners.count - start + (count - i) <= 3;
			if (!bends(last, w->a, w->b) && !must)
				continue;
			ARRAY_PUSH(&roof->corners, (struct corner){ .wall = first + i, .ring = r });
			last = w->a;
		}
		for (size_t i = start; i < roof->corners.count; i++) {
			size_t next =
				i + 1 < roof->corners.count ? roof->corners.items[i + 1].wall : roof->corners.items[start].wall + count;
			roof->corners.items[i].walls = next - roof->corners.items[i].wall;
		}
	}
	ARRAY_PUSH(&roof->ring_first, roof->corners.count);
}

static size_t wall_of(const struct roof *roof, const struct corner *corner, size_t step)
{
	size_t first = roof->m->ring_first.items[corner->ring], end = roof->m->ring_first.items[corner->ring + 1];
	size_t wall = corner->wall + step;
	return wall < end ? wall : first + (wall - end);
}

static size_t next_corner(const struct roof *roof, size_t corner)
{
	size_t ring = roof->corners.items[corner].ring;
	return corner + 1 < roof->ring_first.items[ring + 1] ? corner + 1 : roof->ring_first.items[ring];
}

static size_t prev_corner(const struct roof *roof, size_t corner)
{
	size_t ring = roof->corners.items[corner].ring;
	return corner > roof->ring_first.items[ring] ? corner - 1 : roof->ring_first.items[ring + 1] - 1;
}

static struct dvec2 corner_at(const struct roof *roof, size_t corner)
{
	return roof->m->walls.items[roof->corners.items[corner].wall].a;
}

static void measure_corners(struct roof *roof)
{
	for (size_t i = 0; i < roof->corners.count; i++) {
		struct corner *c = &roof->corners.items[i];
		struct dvec2 along = dvec2_sub(corner_at(roof, next_corner(roof, i)), corner_at(roof, i));
		c->length = fmax(dvec2_length(along), 1e-9);
		c->out = (struct dvec2){ along.y / c->length, -along.x / c->length };
		c->speed = 1.0;
	}
}

static bool convex(const struct roof *roof, size_t corner)
{
	return dvec2_cross(roof->corners.items[prev_corner(roof, corner)].out, roof->corners.items[corner].out) > 0.2;
}

static bool party_gable(const struct roof *roof, const struct corner *c)
{
	double party = 0.0;
	for (size_t k = 0; k < c->walls; k++) {
		const struct wall *w = &roof->m->walls.items[wall_of(roof, c, k)];
		party += w->party_high ? w->length : 0.0;
	}
	return party > 0.6 * c->length;
}

/* The direction of the ridge: across the fall if that is given, else along the rectangle's longer side. */
static struct dvec2 ridge_of(const struct massing *m)
{
	double bearing = m->building->roof_direction_deg * BLVD_PI / 180.0;
	struct dvec2 axis = m->plot->axis;
	if (isfinite(bearing))
		return (struct dvec2){ cos(bearing), -sin(bearing) };
	return m->building->ridge_across ? (struct dvec2){ -axis.y, axis.x } : axis;
}

/* A wing's end: two square corners, and shorter than the walls beside it. */
static bool wing_end(const struct roof *roof, size_t i)
{
	const struct corner *c = &roof->corners.items[i];
	size_t next = next_corner(roof, i), prev = prev_corner(roof, i);
	return convex(roof, i) && convex(roof, next) && c->length < 14.0 &&
		   c->length < roof->corners.items[next].length * 1.05 && c->length < roof->corners.items[prev].length * 1.05;
}

static void choose_gables(struct roof *roof)
{
	const struct massing *m = roof->m;
	enum roof_shape shape = m->plot->roof;
	bool gables = shape == ROOF_GABLED || shape == ROOF_HALF_HIPPED || shape == ROOF_GAMBREL || shape == ROOF_ROUND;
	struct dvec2 ridge = ridge_of(m);
	bool plain = m->plot->fill > 0.78 && m->ring_first.count == 2;
	for (size_t i = 0; i < roof->corners.count; i++) {
		struct corner *c = &roof->corners.items[i];
		bool end = plain ? fabs(dvec2_dot(c->out, ridge)) > 0.75 : wing_end(roof, i);
		bool party = party_gable(roof, c);
		if ((gables && end) || party)
			c->speed = 0.0;
		if (shape == ROOF_HALF_HIPPED && end && !party)
			c->delay = m->plot->half_width * 0.5;
	}
}

/* A roof with hardly any eaves is no roof. */
static bool falls_enough(const struct roof *roof)
{
	double moving = 0.0, whole = 0.0;
	size_t count = 0;
	for (size_t i = 0; i < roof->corners.count; i++) {
		const struct corner *c = &roof->corners.items[i];
		whole += c->length;
		moving += c->speed > 0.0 ? c->length : 0.0;
		count += c->speed > 0.0;
	}
	return count >= 2 && moving > 0.3 * whole;
}

static bool run_skeleton(struct roof *roof)
{
	roof->points.count = roof->speeds.count = roof->delays.count = 0;
	for (size_t i = 0; i < roof->corners.count; i++) {
		ARRAY_PUSH(&roof->points, corner_at(roof, i));
		ARRAY_PUSH(&roof->speeds, roof->corners.items[i].speed);
		ARRAY_PUSH(&roof->delays, roof->corners.items[i].delay);
	}
	struct skeleton_outline outline = { roof->points.items, roof->ring_first.items, roof->ring_first.count - 1,
		roof->speeds.items, roof->delays.items };
	return skeleton_build(&outline, &roof->m->skeleton);
}

static bool find_skeleton(struct roof *roof)
{
	if (roof->corners.count > 160)
		return false;
	choose_gables(roof);
	if (falls_enough(roof) && run_skeleton(roof))
		return true;
	/* Without gables it is simpler. */
	for (size_t i = 0; i < roof->corners.count; i++) {
		roof->corners.items[i].speed = 1.0;
		roof->corners.items[i].delay = 0.0;
	}
	return run_skeleton(roof);
}

static void add_break(struct profile *profile, double t, double z)
{
	if (profile->count < PROFILE_LIMIT) {
		profile->t[profile->count] = t;
		profile->z[profile->count++] = z;
	}
}

static struct profile profile_of(const struct massing *m)
{
	double rise = m->top - m->eaves, t_max = fmax(m->skeleton.t_max, 0.05);
	struct profile out = { .count = 0 };
	add_break(&out, 0.0, 0.0);
	switch (m->plot->roof) {
	case ROOF_MANSARD:
		add_break(&out, fmin(fmin(rise * 0.75 * 0.36, t_max * 0.4), 1.4), rise * 0.75);
		add_break(&out, fmin(t_max, out.t[1] + rise * 0.25 / 0.2), rise);
		return out;
	case ROOF_GAMBREL:
		add_break(&out, t_max * 0.4, rise * 0.68);
		add_break(&out, t_max, rise);
		return out;
	case ROOF_ROUND:
	case ROOF_DOME:
		for (int i = 1; i <= 5; i++) {
			double angle = BLVD_PI / 2.0 * i / 5.0;
			add_break(&out, t_max * (1.0 - cos(angle)), rise * sin(angle));
		}
		return out;
	default:
		break;
	}
	/* Deep buildings would get a steep mountain or a flat one: theirs ends in a level top. */
	double slope = rise / t_max;
	add_break(&out, slope >= 0.25 ? t_max : rise / 0.55, rise);
	return out;
}

static double profile_z(const struct profile *profile, double t)
{
	for (int i = 1; i < profile->count; i++)
		if (t <= profile->t[i])
			return profile->z[i - 1] + (profile->z[i] - profile->z[i - 1]) * (t - profile->t[i - 1]) /
										   fmax(profile->t[i] - profile->t[i - 1], 1e-6);
	return profile->z[profile->count - 1];
}

static double first_slope(const struct profile *profile)
{
	return profile->z[1] / fmax(profile->t[1], 0.01);
}

/* Eaves. Every wall of one straight run has the same overhang, or none when a neighbour touches any of it. */
static void set_overhangs(struct roof *roof, double slope)
{
	struct massing *m = roof->m;
	/* Eaves do not hang down into doors. */
	double room = (m->eaves - fmax(m->base, m->ground) - GUTTER_M - 1.9) / fmax(slope, 0.1);
	double most = room < 0.08 || m->skeleton.t_max < 0.8 ? 0.0 : fmin(room, m->facade.overhang);
	for (size_t i = 0; i < roof->corners.count; i++) {
		const struct corner *c = &roof->corners.items[i];
		double overhang = c->speed > 0.0 ? most : 0.0;
		for (size_t k = 0; k < c->walls; k++) {
			const struct wall *w = &m->walls.items[wall_of(roof, c, k)];
			if (w->party || w->hidden_count || w->facing_m < 1.6)
				overhang = 0.0;
		}
		for (size_t k = 0; k < c->walls; k++)
			m->walls.items[wall_of(roof, c, k)].overhang = overhang;
	}
}

static void lay_eaves(struct roof *roof)
{
	struct massing *m = roof->m;
	double slope = first_slope(&roof->profile);
	set_overhangs(roof, slope);
	eaves_fit(m);
	roof->level_eaves = slope >= 1.3;
	double fall = roof->level_eaves ? 0.0 : slope;
	for (size_t r = 0; r + 1 < m->ring_first.count; r++)
		for (size_t i = m->ring_first.items[r]; i < m->ring_first.items[r + 1]; i++) {
			struct wall *w = &m->walls.items[i];
			const struct wall *before = &m->walls.items[massing_prev(m, r, i)];
			w->eave_z = m->eaves - fmax(w->overhang, before->overhang) * fall;
			w->top = w->overhang > 0.0 ? m->eaves - w->overhang * fall - GUTTER_M : m->eaves;
		}
}

static void add_spot(struct roof *roof, uint32_t node, bool inset)
{
	struct skeleton_node at = roof->m->skeleton.nodes.items[node];
	size_t wall = node < roof->corners.count ? roof->corners.items[node].wall : NONE;
	ARRAY_PUSH(&roof->spots, (struct roof_point){ at.at, at.t, wall, inset });
}

/* The corners between a base's ends that the skeleton was spared. Without an overhang of its own the base stays on the
 * wall, but for its ends, which lie on the eaves lines beside it. */
static void outline_base(struct roof *roof, const struct skeleton_face *face, const uint32_t *nodes)
{
	const struct corner *c = &roof->corners.items[face->edge];
	bool inset = roof->m->walls.items[c->wall].overhang <= 0.0 && !face->upright && !roof->level_eaves;
	if (inset)
		add_spot(roof, nodes[0], true);
	for (size_t k = 1; k < c->walls; k++) {
		size_t wall = wall_of(roof, c, k);
		ARRAY_PUSH(&roof->spots, (struct roof_point){ roof->m->walls.items[wall].a, 0.0, wall, inset });
	}
	if (inset)
		add_spot(roof, nodes[1], true);
}

/* The polygon of one face: its base, then the skeleton's nodes. */
static void outline_face(struct roof *roof, const struct skeleton_face *face)
{
	const uint32_t *nodes = roof->m->skeleton.face_nodes.items + face->first;
	roof->spots.count = 0;
	for (uint32_t i = 0; i < face->count; i++) {
		add_spot(roof, nodes[i], false);
		if (i == 0 && nodes[0] == face->edge)
			outline_base(roof, face, nodes);
	}
}

struct face_frame {
	struct dvec2 origin, along;
	double s_min;
	bool upright;
	uint8_t rgb[3];
};

static struct shell_point place(const struct roof *roof, const struct face_frame *frame, const struct roof_point *spot)
{
	const struct massing *m = roof->m;
	struct dvec2 at = spot->at;
	double z = m->eaves + profile_z(&roof->profile, spot->t);
	if (spot->wall != NONE && !frame->upright && !roof->level_eaves && !spot->inset) {
		at = m->walls.items[spot->wall].eave;
		z = m->walls.items[spot->wall].eave_z;
	}
	double s = dvec2_dot(dvec2_sub(at, frame->origin), frame->along) - frame->s_min + 2.0;
	double tile = frame->upright ? 3.0 : ROOF_TILE_M;
	double up = frame->upright ? z - m->eaves : hypot(spot->t, z - m->eaves) + 1.0;
	return (struct shell_point){ { at.x, at.y, z }, (float)(s / tile), (float)(up / tile), 1.0f };
}

/* Where the line between two spots passes t; from the lower one's side, so that both faces beside it agree. */
static struct roof_point cut(const struct roof_point *a, const struct roof_point *b, double t)
{
	bool swap = a->at.x > b->at.x || (!(a->at.x < b->at.x) && a->at.y > b->at.y);
	const struct roof_point *p = swap ? b : a, *q = swap ? a : b;
	double share = (t - p->t) / (q->t - p->t);
	struct dvec2 at = dvec2_add(p->at, dvec2_scale(dvec2_sub(q->at, p->at), share));
	return (struct roof_point){ at, t, NONE, false };
}

static void draw_piece(struct roof *roof, const struct face_frame *frame, const struct roof_point *spots, size_t count)
{
	struct shell_point points[6];
	for (size_t i = 0; i < count; i++)
		points[i] = place(roof, frame, &spots[i]);
	shell_face(roof->shell, points, count);
}

/* Cuts a convex piece at the profile's breaks, lowest first, and draws what lies between them. */
static void draw_cut(struct roof *roof, const struct face_frame *frame, const struct roof_point corner[3])
{
	struct roof_point rest[8];
	size_t rest_count = 3;
	for (int i = 0; i < 3; i++)
		rest[i] = corner[i];
	for (int b = 1; b < roof->profile.count && rest_count >= 3; b++) {
		double t = roof->profile.t[b];
		struct roof_point low[8], high[8];
		size_t lows = 0, highs = 0;
		for (size_t i = 0; i < rest_count; i++) {
			const struct roof_point *p = &rest[i], *q = &rest[i + 1 < rest_count ? i + 1 : 0];
			bool p_low = p->t <= t + 1e-4, q_low = q->t <= t + 1e-4;
			if (p_low)
				low[lows++] = *p;
			if (!p_low || p->t >= t - 1e-4)
				high[highs++] = *p;
			if (p_low != q_low && fabs(p->t - t) > 1e-4 && fabs(q->t - t) > 1e-4) {
				struct roof_point between = cut(p, q, t);
				low[lows++] = between;
				high[highs++] = between;
			}
		}
		bool all_low = true;
		for (size_t i = 0; i < highs; i++)
			all_low = all_low && high[i].t <= t + 1e-4;
		if (lows >= 3)
			draw_piece(roof, frame, low, lows);
		rest_count = all_low ? 0 : highs;
		for (size_t i = 0; i < rest_count; i++)
			rest[i] = high[i];
	}
	if (rest_count >= 3)
		draw_piece(roof, frame, rest, rest_count);
}

static struct face_frame frame_of(const struct roof *roof, const struct skeleton_face *face)
{
	const struct corner *c = &roof->corners.items[face->edge];
	struct face_frame frame = {
		.origin = corner_at(roof, face->edge), .along = { -c->out.y, c->out.x }, .upright = face->upright
	};
	for (size_t i = 0; i < roof->spots.count; i++)
		frame.s_min = fmin(frame.s_min, dvec2_dot(dvec2_sub(roof->spots.items[i].at, frame.origin), frame.along));
	return frame;
}

/* A whole face without breaks that is convex enough goes out as it is: fewer vertices. */
static void draw_face(struct roof *roof, const struct skeleton_face *face)
{
	outline_face(roof, face);
	if (roof->spots.count < 3)
		return;
	struct face_frame frame = frame_of(roof, face);
	roof->face.count = roof->ears.count = 0;
	for (size_t i = 0; i < roof->spots.count; i++) {
		struct roof_point spot = roof->spots.items[i];
		double s = dvec2_dot(dvec2_sub(spot.at, frame.origin), frame.along);
		ARRAY_PUSH(&roof->face, face->upright ? (struct dvec2){ s, profile_z(&roof->profile, spot.t) } : spot.at);
	}
	triangulate_face(roof->face.items, roof->face.count, &roof->ears);
	for (size_t i = 0; i + 2 < roof->ears.count; i += 3) {
		struct roof_point corner[3];
		for (int k = 0; k < 3; k++)
			corner[k] = roof->spots.items[roof->ears.items[i + (size_t)k]];
		draw_cut(roof, &frame, corner);
	}
}

static void draw_faces(struct roof *roof)
{
	struct massing *m = roof->m;
	for (size_t i = 0; i < m->skeleton.faces.count; i++) {
		const struct skeleton_face *face = &m->skeleton.faces.items[i];
		if (face->upright)
			shell_brush(roof->shell, m->facade.blank, m->facade.wall_rgb);
		else
			shell_brush(roof->shell, m->facade.roofing, m->facade.roof_rgb);
		draw_face(roof, face);
	}
}

/* A place on the ridge: between the two highest nodes that one roof face shares, or the highest alone. */
static struct dvec2 ridge_place(const struct roof *roof, double share)
{
	const struct skeleton *skeleton = &roof->m->skeleton;
	size_t best = 0;
	for (size_t i = 0; i < skeleton->nodes.count; i++)
		if (skeleton->nodes.items[i].t > skeleton->nodes.items[best].t + 0.01)
			best = i;
	size_t mate = best;
	double far = 0.3;
	for (size_t f = 0; f < skeleton->faces.count; f++) {
		const struct skeleton_face *face = &skeleton->faces.items[f];
		for (uint32_t i = 0; i < face->count && !face->upright; i++) {
			uint32_t a = skeleton->face_nodes.items[face->first + i],
					 b = skeleton->face_nodes.items[face->first + (i + 1) % face->count];
			size_t other = a == best ? b : b == best ? a : best;
			double length = dvec2_length(dvec2_sub(skeleton->nodes.items[other].at, skeleton->nodes.items[best].at));
			if (skeleton->nodes.items[other].t > skeleton->nodes.items[best].t * 0.85 && length > far) {
				far = length;
				mate = other;
			}
		}
	}
	struct dvec2 p = skeleton->nodes.items[best].at, q = skeleton->nodes.items[mate].at;
	return dvec2_add(p, dvec2_scale(dvec2_sub(q, p), share));
}

static bool stands_clear(const struct massing *m, struct dvec2 at, double room)
{
	for (int i = 0; i < 4; i++) {
		struct dvec2 corner = { at.x + (i & 1 ? room : -room), at.y + (i & 2 ? room : -room) };
		if (!polygon_contains(&m->building->footprint, corner))
			return false;
	}
	return true;
}

static void draw_chimney(struct roof *roof)
{
	struct massing *m = roof->m;
	enum building_kind kind = m->building->kind;
	bool home = kind == BUILDING_HOUSE || kind == BUILDING_APARTMENTS || kind == BUILDING_RETAIL;
	if (!home || m->area < 45.0 || (m->hash >> 20) % 100 >= 70 || m->skeleton.t_max < 2.0 || m->top - m->ground < 4.0)
		return;
	double ridge_m = dvec2_length(dvec2_sub(ridge_place(roof, 0.0), ridge_place(roof, 1.0)));
	int count = m->area > 260.0 && ridge_m > 6.0 ? 2 : 1;
	for (int i = 0; i < count; i++) {
		uint64_t hash = hash_u64(m->hash + (uint64_t)i + 3);
		struct dvec2 ridge = m->plot->axis, across = { -ridge.y, ridge.x };
		struct dvec2 at = ridge_place(roof, 0.2 + 0.3 * (double)(hash % 100) / 100.0 + 0.4 * i);
		at = dvec2_add(at, dvec2_scale(across, hash >> 9 & 1 ? 0.5 : -0.5));
		if (!stands_clear(m, at, 0.8))
			continue;
		struct shell_box box = { .centre = at,
			.along = ridge,
			.length = 0.9,
			.width = 0.55,
			.from = m->top - 1.4,
			.to = m->top + 0.7,
			.tile_m = 3.0,
			.ao = 0.95f };
		static const uint8_t brick[3] = { 186, 150, 130 };
		bool red = m->facade.roofing == MATERIAL_ROOF_TILES && hash >> 10 & 1;
		shell_brush(roof->shell, red ? MATERIAL_BLANK_BRICK : MATERIAL_BLANK_PLASTER, red ? brick : m->facade.wall_rgb);
		shell_box(roof->shell, &box);
	}
}

/* A small house on the slope: window in front, two cheeks, a lid. */
static void draw_dormer(struct roof *roof, const struct wall *w, double s, double t_front, double width)
{
	struct massing *m = roof->m;
	double height = 1.5, z = m->eaves + profile_z(&roof->profile, t_front), lid = z + height, t_back = t_front;
	if (lid > m->top - 0.15)
		lid = m->top - 0.15;
	if (lid - z < 1.0)
		return;
	while (t_back < m->skeleton.t_max && m->eaves + profile_z(&roof->profile, t_back) < lid)
		t_back += 0.1;
	struct dvec2 corner[4];
	for (int i = 0; i < 4; i++) {
		double along = s + (i == 1 || i == 2 ? width / 2.0 : -width / 2.0), in = i < 2 ? t_front : t_back;
		corner[i] = dvec2_add(w->a, dvec2_add(dvec2_scale(w->along, along), dvec2_scale(w->out, -in)));
	}
	shell_brush(roof->shell, MATERIAL_DORMER, m->facade.wall_rgb);
	struct shell_point front[4] = { { { corner[0].x, corner[0].y, z }, 0, 0, 0.9f },
		{ { corner[1].x, corner[1].y, z }, 1, 0, 0.9f }, { { corner[1].x, corner[1].y, lid }, 1, 1, 1 },
		{ { corner[0].x, corner[0].y, lid }, 0, 1, 1 } };
	shell_face(roof->shell, front, 4);
	shell_brush(roof->shell, m->facade.roofing, m->facade.roof_rgb);
	struct shell_point a = front[0], b = front[1], c = front[2], d = front[3];
	struct shell_point back_b = { { corner[2].x, corner[2].y, lid }, 0.3f, 0.4f, 1 },
					   back_a = { { corner[3].x, corner[3].y, lid }, 0, 0.4f, 1 };
	a.u = b.u = c.u = d.u = 0.0f;
	a.v = b.v = 0.0f;
	c.v = d.v = 0.4f;
	c.u = 0.3f;
	shell_face(roof->shell, (struct shell_point[3]){ b, back_b, c }, 3);
	shell_face(roof->shell, (struct shell_point[3]){ a, d, back_a }, 3);
	back_a.v = back_b.v = 0.8f;
	shell_face(roof->shell, (struct shell_point[4]){ d, c, back_b, back_a }, 4);
}

static void draw_dormers(struct roof *roof)
{
	struct massing *m = roof->m;
	enum building_kind kind = m->building->kind;
	bool mansard = m->plot->roof == ROOF_MANSARD;
	bool home =
		kind == BUILDING_HOUSE || kind == BUILDING_APARTMENTS || kind == BUILDING_RETAIL || kind == BUILDING_CIVIC;
	if (!(home || mansard) || m->top - m->eaves < 2.2 || (!mansard && (m->hash >> 30) % 100 >= 30) ||
		m->skeleton.t_max < 2.5)
		return;
	for (size_t i = 0; i < roof->corners.count; i++) {
		const struct corner *c = &roof->corners.items[i];
		const struct wall *w = &m->walls.items[c->wall];
		if (c->speed <= 0.0 || c->length < 6.0 || w->street_m > 30.0 || !convex(roof, i) ||
			!convex(roof, next_corner(roof, i)))
			continue;
		double pitch = m->facade.bay_m * (mansard ? 1.0 : 2.0), room = c->length - (mansard ? 1.6 : 4.5);
		int count = (int)(room / pitch);
		count = count > 10 ? 10 : count;
		for (int k = 0; k < count; k++) {
			double s = c->length / 2.0 + pitch * (k - (count - 1) / 2.0);
			draw_dormer(roof, w, s, mansard ? 0.22 : 0.6, 1.3);
		}
	}
}

/* A church without towers in the data gets a small one on its ridge: it is what one steers by. */
static void draw_turret(struct roof *roof)
{
	struct massing *m = roof->m;
	if (m->building->kind != BUILDING_CHURCH || m->building->is_part || m->area < 140.0 || m->skeleton.t_max < 3.0 ||
		m->top - m->ground < 7.0)
		return;
	double half = fmin(1.6, 0.8 + m->plot->half_width * 0.08);
	roof_turret(m, roof->shell, ridge_place(roof, 0.12), m->top, half);
}

void roof_turret(struct massing *m, struct shell *shell, struct dvec2 at, double z, double half_m)
{
	struct shell_box box = { .centre = at,
		.along = m->plot->axis,
		.length = half_m * 2.0,
		.width = half_m * 2.0,
		.from = z - half_m * 1.6,
		.to = z + half_m * 1.8,
		.tile_m = half_m * 2.0,
		.ao = 1.0f };
	shell_brush(shell, MATERIAL_WALL_BELFRY, m->facade.wall_rgb);
	shell_box(shell, &box);
	shell_brush(shell, m->facade.roofing == MATERIAL_ROOF_TILES ? MATERIAL_ROOF_SLATE : m->facade.roofing,
		m->facade.roofing == MATERIAL_ROOF_TILES ? (const uint8_t[3]){ 116, 122, 130 } : m->facade.roof_rgb);
	struct dvec2 along = box.along, across = { -along.y, along.x };
	double out = half_m * 1.12, tip = box.to + half_m * 4.2;
	for (int i = 0; i < 4; i++) {
		static const double corner[5][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 }, { -1, -1 } };
		struct shell_point points[3] = { { .ao = 1, .v = 0 }, { .ao = 1, .u = 0.7f },
			{ .ao = 1, .u = 0.35f, .v = 1.5f } };
		for (int k = 0; k < 2; k++) {
			points[k].at.x = at.x + along.x * corner[i + k][0] * out + across.x * corner[i + k][1] * out;
			points[k].at.y = at.y + along.y * corner[i + k][0] * out + across.y * corner[i + k][1] * out;
			points[k].at.z = box.to;
		}
		points[2].at = (struct dvec3){ at.x, at.y, tip };
		shell_face(shell, points, 3);
	}
}

bool roof_pitched(struct massing *m, struct shell *shell)
{
	struct roof roof = { .m = m, .shell = shell };
	find_corners(&roof);
	measure_corners(&roof);
	bool good = find_skeleton(&roof) && m->skeleton.t_max > 0.2;
	if (good) {
		roof.profile = profile_of(m);
		lay_eaves(&roof);
		draw_faces(&roof);
		struct eaves eaves = { GUTTER_M, MATERIAL_TRIM, m->facade.trim_rgb, roof.level_eaves };
		eaves_draw(m, &eaves, shell);
		draw_chimney(&roof);
		draw_dormers(&roof);
		draw_turret(&roof);
	}
	ARRAY_FINISH(&roof.corners);
	ARRAY_FINISH(&roof.ring_first);
	ARRAY_FINISH(&roof.points);
	ARRAY_FINISH(&roof.speeds);
	ARRAY_FINISH(&roof.delays);
	ARRAY_FINISH(&roof.face);
	ARRAY_FINISH(&roof.spots);
	ARRAY_FINISH(&roof.ears);
	return good;
}
