#include "tools/bake/buildings.h"

#include <math.h>
#include <stdlib.h>

#include "platform/base/rng.h"

#define TOUCH_M 0.12       /* walls closer than this are one wall */
#define CONTACT_MIN_M 0.25 /* shorter contacts do not count, nor do cuts nearer to a corner */
#define FACING_M 40.0
#define STREET_M 32.0

/* A stretch of a wall that another building's wall touches. */
struct contact {
	double from, to; /* along the wall */
	uint32_t other;
	bool same_side; /* both look the same way: one stands inside the other */
};

struct contact_search {
	const struct plots *plots;
	uint32_t self;
	struct dvec2 a, along, out;
	double length;
	struct contact found[48];
	int count;
};

static void visit_contact(void *context, const struct segment *segment)
{
	struct contact_search *search = context;
	if (segment->owner == search->self || search->count >= 48)
		return;
	struct dvec2 pa = dvec2_sub(segment->a, search->a), pb = dvec2_sub(segment->b, search->a);
	double sa = dvec2_dot(pa, search->along), sb = dvec2_dot(pb, search->along);
	double da = dvec2_dot(pa, search->out), db = dvec2_dot(pb, search->out);
	double span = sb - sa;
	if (fabs(span) < CONTACT_MIN_M || fabs(db - da) > 0.06 * fabs(span))
		return;
	double from = fmax(0.0, fmin(sa, sb)), to = fmin(search->length, fmax(sa, sb));
	double d_from = da + (from - sa) / span * (db - da), d_to = da + (to - sa) / span * (db - da);
	if (to - from < CONTACT_MIN_M || fabs(d_from) > TOUCH_M || fabs(d_to) > TOUCH_M)
		return;
	for (int i = 0; i < search->count; i++) /* the grid shows some segments twice */
		if (search->found[i].other == segment->owner && fabs(search->found[i].from - from) < 1e-9)
			return;
	search->found[search->count++] = (struct contact){ from, to, segment->owner, span > 0.0 };
}

static int contact_order(const void *left, const void *right)
{
	const struct contact *a = left, *b = right;
	if (a->from < b->from || a->from > b->from)
		return a->from < b->from ? -1 : 1;
	return a->other < b->other ? -1 : a->other > b->other;
}

static void hide(struct wall *wall, double from, double to)
{
	if (wall->hidden_count < HIDDEN_LIMIT && to > from + 0.05)
		wall->hidden[wall->hidden_count++] = (struct z_range){ from, to };
}

static void apply_contact(const struct contact_search *search, const struct contact *contact, struct wall *wall)
{
	const struct plot *self = &search->plots->plots.items[search->self];
	const struct plot *other = &search->plots->plots.items[contact->other];
	if (other->base >= self->eaves || other->eaves <= self->base)
		return;
	if (contact->same_side) {
		bool wins =
			other->eaves > self->eaves + 1e-6 || (other->eaves > self->eaves - 1e-6 && contact->other < search->self);
		if (wins)
			hide(wall, other->base, other->eaves);
		return;
	}
	hide(wall, other->base, other->eaves);
	bool kin = self->building->is_part && other->building->is_part;
	bool low = other->eaves - self->ground < 4.5 && self->eaves - other->eaves > 2.2;
	wall->party = true;
	wall->annex |= kin || low || other->building->kind == BUILDING_GARAGE;
	wall->party_high |= other->eaves > self->eaves - 1.5 && other->base < self->eaves - 1.0;
}

static int add_cut(double *cuts, int count, double at, double length)
{
	if (at < CONTACT_MIN_M || at > length - CONTACT_MIN_M)
		return count;
	for (int i = 0; i < count; i++)
		if (fabs(cuts[i] - at) < CONTACT_MIN_M)
			return count;
	if (count < 60)
		cuts[count++] = at;
	return count;
}

static int double_order(const void *left, const void *right)
{
	double a = *(const double *)left, b = *(const double *)right;
	return a < b ? -1 : a > b;
}

static struct wall wall_between(struct dvec2 a, struct dvec2 b)
{
	struct wall wall = { .a = a, .b = b, .street_m = INFINITY, .street_class = -1, .facing_m = INFINITY };
	wall.along = dvec2_sub(b, a);
	wall.length = dvec2_length(wall.along);
	wall.along = dvec2_scale(wall.along, 1.0 / wall.length);
	wall.out = (struct dvec2){ wall.along.y, -wall.along.x };
	return wall;
}

static void add_walls(const struct plots *plots, struct massing *m, struct dvec2 a, struct dvec2 b)
{
	struct wall whole = wall_between(a, b);
	struct contact_search search = {
		.plots = plots, .self = m->index, .a = a, .along = whole.along, .out = whole.out, .length = whole.length
	};
	struct dvec2 min = { fmin(a.x, b.x) - 0.3, fmin(a.y, b.y) - 0.3 },
				 max = { fmax(a.x, b.x) + 0.3, fmax(a.y, b.y) + 0.3 };
	segment_grid_visit(&plots->wall_grid, min, max, visit_contact, &search);
	qsort(search.found, (size_t)search.count, sizeof(search.found[0]), contact_order);
	double cuts[64] = { 0 };
	int count = 0;
	for (int i = 0; i < search.count; i++) {
		count = add_cut(cuts, count, search.found[i].from, whole.length);
		count = add_cut(cuts, count, search.found[i].to, whole.length);
	}
	qsort(cuts, (size_t)count, sizeof(cuts[0]), double_order);
	struct dvec2 from = a;
	double s = 0.0;
	for (int i = 0; i <= count; i++) {
		double next = i < count ? cuts[i] : whole.length, middle = (s + next) / 2.0;
		struct dvec2 to = i < count ? dvec2_add(a, dvec2_scale(whole.along, next)) : b;
		struct wall wall = wall_between(from, to);
		for (int k = 0; k < search.count; k++)
			if (search.found[k].from <= middle && search.found[k].to >= middle)
				apply_contact(&search, &search.found[k], &wall);
		ARRAY_PUSH(&m->walls, wall);
		from = to;
		s = next;
	}
}

struct ray_search {
	const struct plots *plots;
	struct dvec2 from, along, out;
	double best;
	double top;
};

static void visit_ray(void *context, const struct segment *segment)
{
	struct ray_search *ray = context;
	struct dvec2 a = dvec2_sub(segment->a, ray->from), b = dvec2_sub(segment->b, ray->from);
	double sa = dvec2_dot(a, ray->along), sb = dvec2_dot(b, ray->along);
	if ((sa > 0.0) == (sb > 0.0))
		return;
	double da = dvec2_dot(a, ray->out), db = dvec2_dot(b, ray->out);
	double d = da + (0.0 - sa) / (sb - sa) * (db - da);
	double top = ray->plots->plots.items[segment->owner].eaves;
	if (d < 0.2 || d > ray->best + 1e-9 || (d > ray->best - 1e-9 && top <= ray->top))
		return;
	ray->best = d;
	ray->top = top;
}

static void look_ahead(const struct plots *plots, struct wall *wall)
{
	struct dvec2 middle = dvec2_scale(dvec2_add(wall->a, wall->b), 0.5);
	struct dvec2 end = dvec2_add(middle, dvec2_scale(wall->out, FACING_M));
	struct ray_search ray = { plots, middle, wall->along, wall->out, FACING_M, 0.0 };
	segment_grid_visit(&plots->wall_grid, (struct dvec2){ fmin(middle.x, end.x), fmin(middle.y, end.y) },
		(struct dvec2){ fmax(middle.x, end.x), fmax(middle.y, end.y) }, visit_ray, &ray);
	if (ray.best < FACING_M) {
		wall->facing_m = ray.best;
		wall->facing_top = ray.top;
	}
}

struct street_search {
	const struct city *city;
	struct dvec2 middle, out;
	double score, distance;
	int street_class;
};

/* A footway or a service lane is a street only where no other is near. */
static double class_penalty(int street_class)
{
	return street_class == WAY_FOOT || street_class == WAY_CYCLE ? 9.0 : street_class == PKG_STREET_SERVICE ? 6.0 : 0.0;
}

static void visit_street(void *context, const struct segment *segment)
{
	struct street_search *search = context;
	struct dvec2 along = dvec2_sub(segment->b, segment->a), to = dvec2_sub(search->middle, segment->a);
	double length2 = dvec2_dot(along, along), t = length2 > 0.0 ? dvec2_dot(to, along) / length2 : 0.0;
	t = fmin(fmax(t, 0.0), 1.0);
	struct dvec2 reach = dvec2_sub(dvec2_add(segment->a, dvec2_scale(along, t)), search->middle);
	double distance = dvec2_length(reach);
	int street_class = search->city->ways.items[segment->owner].street_class;
	double score = distance + class_penalty(street_class);
	if (distance > STREET_M || dvec2_dot(reach, search->out) < 0.5 * distance || score >= search->score)
		return;
	search->score = score;
	search->distance = distance;
	search->street_class = street_class;
}

static void find_street(const struct plots *plots, struct wall *wall)
{
	struct street_search search = { plots->city, dvec2_scale(dvec2_add(wall->a, wall->b), 0.5), wall->out, INFINITY,
		INFINITY, -1 };
	struct dvec2 m = search.middle;
	segment_grid_visit(&plots->way_grid, (struct dvec2){ m.x - STREET_M, m.y - STREET_M },
		(struct dvec2){ m.x + STREET_M, m.y + STREET_M }, visit_street, &search);
	/* What lies beyond the next wall is not in front of this one. */
	if (search.distance < wall->facing_m + 1.0) {
		wall->street_m = search.distance;
		wall->street_class = search.street_class;
	}
}

static void find_ground(struct massing *m)
{
	bool flat = m->city->terrain.grid.columns == 0;
	double low = INFINITY, high = -INFINITY;
	for (size_t i = 0; i < m->walls.count; i++) {
		struct wall *wall = &m->walls.items[i];
		wall->ground = wall->low = m->ground;
		if (!flat) {
			struct dvec2 middle = dvec2_scale(dvec2_add(wall->a, wall->b), 0.5);
			double za = city_ground(m->city, wall->a), zb = city_ground(m->city, wall->b);
			wall->ground = fmax(fmax(za, zb), fmax(city_ground(m->city, middle), m->ground));
			wall->low = fmax(fmin(za, zb), m->ground);
		}
		low = fmin(low, wall->ground);
		high = fmax(high, wall->ground);
	}
	m->sloping = high - fmin(low, m->ground) > 0.6;
	m->door = high;
}

/* The way in: the wall nearest to a street, long walls preferred. */
static void find_door(struct massing *m)
{
	double best = INFINITY;
	m->door_wall = UINT32_MAX;
	for (size_t i = 0; i < m->walls.count; i++) {
		const struct wall *wall = &m->walls.items[i];
		double score = fmin(wall->street_m, 60.0) - fmin(wall->length, 12.0) * 0.5 + fmax(0.0, wall->ground - m->door);
		if (wall->hidden_count == 0 && wall->length > 2.0 && score < best && i < m->ring_first.items[1]) {
			best = score;
			m->door_wall = (uint32_t)i;
		}
	}
}

static void trace_ring(const struct plots *plots, struct massing *m, size_t first, size_t end)
{
	for (size_t i = first; i < end; i++)
		add_walls(plots, m, plots->points.items[i], plots->points.items[i + 1 < end ? i + 1 : first]);
}

static double outline_area(const struct massing *m)
{
	double twice = 0.0;
	struct dvec2 o = m->walls.items[0].a;
	for (size_t i = 0; i < m->walls.count; i++)
		twice += dvec2_cross(dvec2_sub(m->walls.items[i].a, o), dvec2_sub(m->walls.items[i].b, o));
	return twice / 2.0;
}

void massing_build(const struct plots *plots, uint32_t index, struct massing *m)
{
	m->city = plots->city;
	m->plot = &plots->plots.items[index];
	m->building = m->plot->building;
	m->index = index;
	m->hash = hash_u64((uint64_t)m->building->id + UINT64_C(0x9E3779B97F4A7C15));
	m->base = m->plot->base;
	m->ground = m->plot->ground;
	m->eaves = m->plot->eaves;
	m->top = m->plot->top;
	m->has_ground_floor = m->base < m->ground;
	m->walls.count = m->ring_first.count = 0;
	for (size_t r = 0; r < m->plot->ring_count; r++) {
		ARRAY_PUSH(&m->ring_first, m->walls.count);
		trace_ring(plots, m, plots->ring_first.items[m->plot->first_ring + r],
			plots->ring_first.items[m->plot->first_ring + r + 1]);
	}
	ARRAY_PUSH(&m->ring_first, m->walls.count);
	for (size_t i = 0; i < m->walls.count; i++) {
		struct wall *wall = &m->walls.items[i];
		wall->top = m->eaves;
		if (wall->party && !wall->annex)
			continue;
		look_ahead(plots, wall);
		find_street(plots, wall);
	}
	m->area = outline_area(m);
	find_ground(m);
	find_door(m);
}

void massing_finish(struct massing *m)
{
	ARRAY_FINISH(&m->walls);
	ARRAY_FINISH(&m->ring_first);
	ARRAY_FINISH(&m->triangles);
	ARRAY_FINISH(&m->points);
	skeleton_finish(&m->skeleton);
}

void massing_triangulate(struct massing *m)
{
	m->triangles.count = m->points.count = 0;
	for (size_t i = 0; i < m->walls.count; i++)
		ARRAY_PUSH(&m->points, m->walls.items[i].a);
	if (m->triangulator &&
		triangulate_rings(m->triangulator, m->points.items, m->ring_first.items, m->plot->ring_count, &m->triangles))
		return;
	m->deck_faults++;
	triangulate_face(m->points.items, m->ring_first.items[1], &m->triangles);
}
