/*
 * Lattice lines into streets. Every stretch between two lines is a way of its own; some are left out for the river, the
 * railway, the park, the old town, and at random so that blocks differ.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/synth/synth.h"

#define SAMPLE_M 25.0
#define ROUNDABOUT_M 17.0
#define SHORT_OF_M 0.25 /* streets end this far before what they run into; the graph joins them */

void street_add(struct synth *synth, const struct street_kind *kind, const char *name, const struct dvec2 *points,
	size_t count, int64_t id_from, int64_t id_to)
{
	struct city *city = &synth->city;
	struct way way = {
		.id = (int64_t)city->ways.count + 1,
		.nodes = POOL_ARRAY(&city->pool, struct way_node, count),
		.node_count = count,
		.street_class = kind->street_class,
		.drivable = true,
		.bridge = kind->bridge,
		.tunnel = kind->tunnel,
		.layer = kind->bridge   ? 1
				 : kind->tunnel ? -1
								: 0,
		.roundabout = kind->roundabout,
		.lit = true,
		.oneway = kind->oneway || kind->roundabout,
		.lanes_forward = kind->oneway || kind->roundabout ? kind->lanes : (kind->lanes + 1) / 2,
		.lanes_backward = kind->oneway || kind->roundabout ? 0 : kind->lanes / 2,
		.width_m = kind->width_m,
		.speed_kmh = kind->speed_kmh,
		.speed_posted = true,
		.name = name,
	};
	for (size_t i = 0; i < count; i++)
		way.nodes[i] = (struct way_node){ -(int64_t)(city->ways.count * 4096 + i + 1), points[i], 0 };
	if (id_from)
		way.nodes[0].id = id_from;
	if (id_to)
		way.nodes[count - 1].id = id_to;
	ARRAY_PUSH(&city->ways, way);
	ARRAY_PUSH(&synth->streets, kind->street);
}

struct lattice {
	struct synth *synth;
	struct plan *plan;
	size_t columns, rows;
	bool *up, *right; /* by crossing: the stretch to the next row, to the next column */
	bool *roundabout; /* by crossing */
};

static size_t at(const struct lattice *lattice, size_t i, size_t j)
{
	return i * lattice->rows + j;
}

/* Where rows may cross the railway: quays pass under its bridge; main streets well away from the river. */
static bool crosses_railway(const struct plan *plan, size_t row)
{
	bool quay = plan->river && (row == plan->south_quay || row == plan->north_quay);
	bool border = !row || row + 1 == plan->t.count;
	return quay || ((border || plan->t.items[row].rank == 2) && fabs(plan->t.items[row].at) > 300.0);
}

static bool in_park(const struct plan *plan, size_t i, size_t j, bool up)
{
	if (!plan->park)
		return false;
	if (up)
		return i > plan->park_s0 && i < plan->park_s1 && j >= plan->park_t0 && j < plan->park_t1;
	return j > plan->park_t0 && j < plan->park_t1 && i >= plan->park_s0 && i < plan->park_s1;
}

static bool is_dive(const struct plan *plan, size_t row)
{
	return plan->park && plan->park_s1 - plan->park_s0 > 2 && row == plan->park_t0 + 1;
}

static bool wanted_up(const struct lattice *lattice, size_t i, size_t j)
{
	const struct plan *plan = lattice->plan;
	if (plan->river && j == plan->south_quay) /* a bridge */
		return plan->s.items[i].rank == 2 && !(plan->railway && (i == plan->rail_column || i == plan->rail_column + 1));
	return !in_park(plan, i, j, true);
}

static bool wanted_right(const struct lattice *lattice, size_t i, size_t j)
{
	const struct plan *plan = lattice->plan;
	if (plan->railway && i == plan->rail_column && !crosses_railway(plan, j))
		return false;
	return !in_park(plan, i, j, false);
}

static int degree(const struct lattice *lattice, size_t i, size_t j)
{
	return (i + 1 < lattice->columns && lattice->right[at(lattice, i, j)]) +
		   (i && lattice->right[at(lattice, i - 1, j)]) + (j + 1 < lattice->rows && lattice->up[at(lattice, i, j)]) +
		   (j && lattice->up[at(lattice, i, j - 1)]);
}

/* Takes out side streets where both ends remain crossings of three. */
static void thin_out(struct lattice *lattice)
{
	struct rng rng = synth_rng(lattice->synth, 3, 0);
	for (size_t i = 0; i < lattice->columns; i++) {
		for (size_t j = 0; j < lattice->rows; j++) {
			double chance = rng_unit(&rng), side = rng_unit(&rng);
			bool up = side < 0.5;
			size_t i2 = up ? i : i + 1, j2 = up ? j + 1 : j;
			if (i2 >= lattice->columns || j2 >= lattice->rows)
				continue;
			bool *stretch = up ? &lattice->up[at(lattice, i, j)] : &lattice->right[at(lattice, i, j)];
			int rank = up ? lattice->plan->s.items[i].rank : lattice->plan->t.items[j].rank;
			bool border = up ? !i || i2 + 1 == lattice->columns : !j || j2 + 1 == lattice->rows;
			if (rank || border || !*stretch || degree(lattice, i, j) < 4 || degree(lattice, i2, j2) < 4 ||
				chance > 0.42)
				continue;
			*stretch = false;
		}
	}
}

static void choose_roundabouts(struct lattice *lattice)
{
	struct rng rng = synth_rng(lattice->synth, 4, 0);
	const struct plan *plan = lattice->plan;
	for (size_t i = 1; i + 1 < lattice->columns; i++) {
		for (size_t j = 1; j + 1 < lattice->rows; j++) {
			double chance = rng_unit(&rng);
			if (plan->s.items[i].rank != 2 || plan->t.items[j].rank < 1 || degree(lattice, i, j) < 4 || chance > 0.4)
				continue;
			bool rail = plan->railway && i + 1 >= plan->rail_column && i <= plan->rail_column + 2;
			bool river = plan->river && j + 1 >= plan->south_quay && j <= plan->north_quay + 1;
			bool park = plan->park && i + 1 >= plan->park_s0 && i <= plan->park_s1 + 1 && j + 1 >= plan->park_t0 &&
						j <= plan->park_t1 + 1;
			double old = plan_old_town(plan, plan->s.items[i].at, plan->t.items[j].at);
			if (!rail && !river && !park && old > 60.0)
				lattice->roundabout[at(lattice, i, j)] = true;
		}
	}
}

static struct street_kind kind_of(const struct lattice *lattice, int rank, struct dvec2 where, bool quay)
{
	double centre = plan_centrality(lattice->synth, where);
	if (quay)
		return (struct street_kind){ PKG_STREET_SECONDARY, 9.5, 2, 50, .street = { .trees = true } };
	if (rank == 2 && centre > 0.2)
		return (struct street_kind){ PKG_STREET_PRIMARY, 14.0, 4, 50, .street = { .trees = true } };
	if (rank == 2)
		return (struct street_kind){ PKG_STREET_SECONDARY, 10.0, 2, 60, .street = { .trees = centre > 0.1 } };
	if (rank == 1)
		return (struct street_kind){ PKG_STREET_TERTIARY, 8.5, 2, 50, .street = { .trees = centre > 0.3 } };
	return (struct street_kind){ PKG_STREET_RESIDENTIAL, centre > 0.3 ? 7.0 : 5.5, 2, 30, .street = { 0 } };
}

struct path {
	struct dvec2 points[64];
	size_t count;
};

/* Points along a straight line of the plan. */
static void trace(const struct plan *plan, struct dvec2 from, struct dvec2 to, struct path *path)
{
	int steps = (int)fmin(fmax(1.0, ceil(dvec2_length(dvec2_sub(to, from)) / SAMPLE_M)), 62.0);
	path->count = 0;
	for (int i = 0; i <= steps; i++) {
		double f = (double)i / steps;
		path->points[path->count++] = plan_place(plan, from.x + f * (to.x - from.x), from.y + f * (to.y - from.y));
	}
}

static void add_stretch(struct lattice *lattice, struct dvec2 from, struct dvec2 to, int64_t from_id, int64_t to_id,
	const struct street_kind *kind, const char *name)
{
	struct path path;
	trace(lattice->plan, from, to, &path);
	street_add(lattice->synth, kind, name, path.points, path.count, from_id, to_id);
}

/* Where a stretch that starts outside the old town reaches its ring. */
static double reach_ring(const struct plan *plan, struct dvec2 from, struct dvec2 to)
{
	double low = 0.0, high = 1.0;
	for (int i = 0; i < 40; i++) {
		double f = (low + high) / 2.0;
		if (plan_old_town(plan, from.x + f * (to.x - from.x), from.y + f * (to.y - from.y)) > 0.0)
			low = f;
		else
			high = f;
	}
	return low;
}

static struct dvec2 between(struct dvec2 a, struct dvec2 b, double f)
{
	return (struct dvec2){ a.x + f * (b.x - a.x), a.y + f * (b.y - a.y) };
}

static double ring_side(const struct plan *plan, struct dvec2 p)
{
	return plan_old_town(plan, p.x, p.y);
}

/* The stretch without what lies inside the ring. */
static void add_outside(struct lattice *lattice, struct dvec2 from, struct dvec2 to, int64_t from_id, int64_t to_id,
	const struct street_kind *kind, const char *name)
{
	const struct plan *plan = lattice->plan;
	double a = ring_side(plan, from), b = ring_side(plan, to), length = dvec2_length(dvec2_sub(to, from));
	double least = HUGE_VAL, at_least = 0.5;
	for (int i = 0; i <= 16; i++) {
		double side = ring_side(plan, between(from, to, i / 16.0));
		if (side < least) {
			least = side;
			at_least = i / 16.0;
		}
	}
	if (least > 6.0) {
		add_stretch(lattice, from, to, from_id, to_id, kind, name);
		return;
	}
	if (a > 0.0 && at_least > 0.0) {
		struct dvec2 deepest = between(from, to, fmax(at_least, 1e-3));
		double f = least < 0.0 ? reach_ring(plan, from, deepest) * at_least : at_least;
		if (f * length > 30.0 && least < 0.0)
			add_stretch(lattice, from, between(from, to, f - SHORT_OF_M / length), from_id, 0, kind, name);
	}
	if (b > 0.0 && at_least < 1.0) {
		struct dvec2 deepest = between(from, to, at_least);
		double f = least < 0.0 ? reach_ring(plan, to, deepest) * (1.0 - at_least) : 0.0;
		if (f * length > 30.0)
			add_stretch(lattice, between(from, to, 1.0 - f + SHORT_OF_M / length), to, 0, to_id, kind, name);
	}
}

static int64_t crossing_id(const struct lattice *lattice, size_t i, size_t j)
{
	return lattice->roundabout[at(lattice, i, j)] ? 0 : (int64_t)(1 + at(lattice, i, j));
}

/* A bridge or tunnel over the middle part [from_f, to_f] of a stretch. */
static void add_over(struct lattice *lattice, struct dvec2 from, struct dvec2 to, int64_t from_id, int64_t to_id,
	struct street_kind kind, const char *name, double from_f, double to_f, bool bridge)
{
	int64_t own = (INT64_C(1) << 40) + (int64_t)lattice->synth->city.ways.count * 4;
	struct dvec2 a = between(from, to, from_f), b = between(from, to, to_f);
	struct street_kind middle = kind;
	middle.bridge = bridge;
	middle.tunnel = !bridge;
	middle.street.trees = kind.street.trees = false;
	if (from_f > 0.0)
		add_stretch(lattice, from, a, from_id, own, &kind, name);
	add_stretch(lattice, a, b, from_f > 0.0 ? own : from_id, to_f < 1.0 ? own + 1 : to_id, &middle, name);
	if (to_f < 1.0)
		add_stretch(lattice, b, to, own + 1, to_id, &kind, name);
}

static struct dvec2 crossing(const struct lattice *lattice, size_t i, size_t j)
{
	return (struct dvec2){ lattice->plan->s.items[i].at, lattice->plan->t.items[j].at };
}

/* The end of a stretch, moved off the middle of a roundabout. */
static struct dvec2 stretch_end(const struct lattice *lattice, size_t i, size_t j, struct dvec2 towards)
{
	struct dvec2 here = crossing(lattice, i, j);
	if (!lattice->roundabout[at(lattice, i, j)])
		return here;
	struct dvec2 middle = plan_place(lattice->plan, here.x, here.y);
	double low = 0.0, high = 1.0;
	for (int k = 0; k < 40; k++) {
		double f = (low + high) / 2.0;
		struct dvec2 p = between(here, towards, f), placed = plan_place(lattice->plan, p.x, p.y);
		if (dvec2_length(dvec2_sub(placed, middle)) < ROUNDABOUT_M + 0.05)
			low = f;
		else
			high = f;
	}
	return between(here, towards, high);
}

static void add_lattice_stretch(struct lattice *lattice, size_t i, size_t j, bool up, const char *name)
{
	struct plan *plan = lattice->plan;
	size_t i2 = up ? i : i + 1, j2 = up ? j + 1 : j;
	struct dvec2 from = stretch_end(lattice, i, j, crossing(lattice, i2, j2));
	struct dvec2 to = stretch_end(lattice, i2, j2, crossing(lattice, i, j));
	int64_t from_id = crossing_id(lattice, i, j), to_id = crossing_id(lattice, i2, j2);
	int rank = up ? plan->s.items[i].rank : plan->t.items[j].rank;
	bool quay = plan->river && !up && (j == plan->south_quay || j == plan->north_quay);
	struct dvec2 middle = between(from, to, 0.5);
	struct street_kind kind = kind_of(lattice, rank, plan_place(plan, middle.x, middle.y), quay);
	double length = dvec2_length(dvec2_sub(to, from));
	if (plan->river && up && j == plan->south_quay) {
		add_over(lattice, from, to, from_id, to_id, kind, name, 0.0, 1.0, true);
	} else if (plan->railway && !up && i == plan->rail_column && !quay) {
		bool border = !j || j + 1 == lattice->rows, tunnel = !border && j % 2 == 0;
		double half = (tunnel ? 46.0 : 20.0) / length;
		add_over(lattice, from, to, from_id, to_id, kind, name, 0.5 - half, 0.5 + half, !tunnel);
	} else if (quay) {
		add_stretch(lattice, from, to, from_id, to_id, &kind, name);
	} else {
		add_outside(lattice, from, to, from_id, to_id, &kind, name);
	}
}

/* The arterial that dives under the park: one street from side to side. */
static void add_dive(struct lattice *lattice)
{
	struct plan *plan = lattice->plan;
	size_t row = plan->park_t0 + 1;
	struct dvec2 from = crossing(lattice, plan->park_s0, row), to = crossing(lattice, plan->park_s1, row);
	struct street_kind kind = kind_of(lattice, 2, plan_place(plan, from.x, from.y), false);
	double portal = 80.0 / dvec2_length(dvec2_sub(to, from));
	add_over(lattice, from, to, crossing_id(lattice, plan->park_s0, row), crossing_id(lattice, plan->park_s1, row),
		kind, plan->t.items[row].name, portal, 1.0 - portal, false);
}

static void add_roundabout(struct lattice *lattice, size_t i, size_t j)
{
	struct dvec2 here = crossing(lattice, i, j), middle = plan_place(lattice->plan, here.x, here.y);
	struct dvec2 ring[25];
	for (int k = 0; k < 25; k++) {
		double angle = 2.0 * BLVD_PI * (k % 24) / 24.0;
		ring[k] = (struct dvec2){ middle.x + ROUNDABOUT_M * cos(angle), middle.y + ROUNDABOUT_M * sin(angle) };
	}
	int64_t id = (INT64_C(1) << 41) + (int64_t)at(lattice, i, j);
	struct street_kind kind = { PKG_STREET_SECONDARY, 7.0, 1, 30, .roundabout = true };
	street_add(lattice->synth, &kind, NULL, ring, 25, id, id);
}

/* Main streets run on beyond the last line, to where the map ends. */
static void add_stub(struct lattice *lattice, size_t i, size_t j, double ds, double dt, int rank, const char *name)
{
	struct dvec2 from = crossing(lattice, i, j), to = { from.x + ds, from.y + dt };
	if (rank < 2 || lattice->roundabout[at(lattice, i, j)] || ring_side(lattice->plan, from) < 20.0)
		return;
	struct street_kind kind = kind_of(lattice, rank, plan_place(lattice->plan, from.x, from.y), false);
	kind.street.trees = false;
	add_stretch(lattice, from, to, crossing_id(lattice, i, j), 0, &kind, name);
}

/* Names change where a street meets its third arterial. */
static const char *name_along(struct lattice *lattice, const char *name, bool quay, int rank, int *met)
{
	if (++*met < (rank == 2 ? 6 : 3))
		return name;
	*met = 0;
	return name_street(lattice->synth, quay ? 4 : rank);
}

static void add_columns(struct lattice *lattice)
{
	struct plan *plan = lattice->plan;
	for (size_t i = 0; i < lattice->columns; i++) {
		const char *name = plan->s.items[i].name;
		int met = 0, rank = plan->s.items[i].rank;
		add_stub(lattice, i, 0, 0.0, -60.0, rank, name);
		for (size_t j = 0; j + 1 < lattice->rows; j++) {
			if (lattice->up[at(lattice, i, j)])
				add_lattice_stretch(lattice, i, j, true, name);
			if (plan->t.items[j + 1].rank == 2 || (plan->river && j == plan->south_quay))
				name = name_along(lattice, name, false, rank, &met);
		}
		add_stub(lattice, i, lattice->rows - 1, 0.0, 60.0, rank, name);
	}
}

static void add_rows(struct lattice *lattice)
{
	struct plan *plan = lattice->plan;
	for (size_t j = 0; j < lattice->rows; j++) {
		bool quay = plan->river && (j == plan->south_quay || j == plan->north_quay);
		const char *name = quay ? name_street(lattice->synth, 4) : plan->t.items[j].name;
		int met = 0, rank = plan->t.items[j].rank;
		add_stub(lattice, 0, j, -60.0, 0.0, rank, name);
		for (size_t i = 0; i + 1 < lattice->columns; i++) {
			if (lattice->right[at(lattice, i, j)])
				add_lattice_stretch(lattice, i, j, false, name);
			if (plan->s.items[i + 1].rank == 2)
				name = name_along(lattice, name, quay, rank, &met);
		}
		add_stub(lattice, lattice->columns - 1, j, 60.0, 0.0, rank, name);
	}
	if (plan->park && is_dive(plan, plan->park_t0 + 1))
		add_dive(lattice);
}

/* A one-way street that would trap whoever enters it is opened both ways. */
static void open_traps(struct synth *synth)
{
	uint32_t count = synth->view.node_count;
	size_t capacity = 0, stack_capacity = 0;
	uint8_t *reached = array_grow(NULL, &capacity, count + 1, 1);
	uint32_t *stack = array_grow(NULL, &stack_capacity, count + 1, sizeof(uint32_t));
	for (int pass = 0; count && pass < 64; pass++) {
		bool trapped = false;
		memset(reached, 0, count);
		for (int way = 0; way < 2; way++) { /* forwards, then backwards */
			size_t depth = 0;
			uint8_t bit = (uint8_t)(1 << way);
			uint32_t start = 0;
			while (start + 1 < count && synth->view.nodes[start].component)
				start++;
			stack[depth++] = start;
			reached[start] |= bit;
			while (depth) {
				const struct pkg_node *node = &synth->view.nodes[stack[--depth]];
				for (uint32_t k = 0; k < node->out_count; k++) {
					uint32_t half = synth->view.outs[node->first_out + k], drive = half ^ (uint32_t)way;
					uint32_t flag = drive & 1 ? PKG_EDGE_BACKWARD : PKG_EDGE_FORWARD,
							 to = synth->view.halves[half ^ 1].origin;
					if (!(synth->view.edges[half / 2].flags & flag) || reached[to] & bit)
						continue;
					reached[to] |= bit;
					stack[depth++] = to;
				}
			}
		}
		for (uint32_t e = 0; e < synth->view.edge_count; e++) {
			uint8_t a = reached[synth->view.halves[2 * e].origin], b = reached[synth->view.halves[2 * e + 1].origin];
			struct pkg_edge *edge = &synth->graph.edges.items[e];
			if ((a == 3 && b == 3) || (edge->flags & PKG_EDGE_FORWARD && edge->flags & PKG_EDGE_BACKWARD) ||
				edge->flags & PKG_EDGE_ROUNDABOUT)
				continue;
			edge->flags |= PKG_EDGE_FORWARD | PKG_EDGE_BACKWARD;
			trapped = true;
		}
		if (!trapped)
			break;
	}
	array_free(reached);
	array_free(stack);
}

/* Side streets of the inner city become one-way in turns. */
static void choose_oneways(struct synth *synth)
{
	for (size_t i = 0; i < synth->city.ways.count; i++) {
		struct way *way = &synth->city.ways.items[i];
		struct dvec2 here = way->nodes[0].at;
		uint64_t name_hash = 0;
		for (const char *c = way->name ? way->name : ""; *c; c++)
			name_hash = hash_u64(name_hash ^ (uint8_t)*c);
		if (way->street_class != PKG_STREET_RESIDENTIAL || plan_centrality(synth, here) < 0.4 || name_hash % 3 == 0)
			continue;
		way->oneway = name_hash & 8 ? 1 : -1;
		way->lanes_forward = way->oneway > 0;
		way->lanes_backward = way->oneway < 0;
	}
}

void streets_make(struct synth *synth)
{
	struct lattice lattice = { synth, &synth->plan, synth->plan.s.count, synth->plan.t.count, NULL, NULL, NULL };
	size_t cells = lattice.columns * lattice.rows;
	lattice.up = POOL_ARRAY(&synth->city.pool, bool, cells);
	lattice.right = POOL_ARRAY(&synth->city.pool, bool, cells);
	lattice.roundabout = POOL_ARRAY(&synth->city.pool, bool, cells);
	for (size_t i = 0; i < lattice.columns; i++) {
		for (size_t j = 0; j < lattice.rows; j++) {
			lattice.up[at(&lattice, i, j)] = j + 1 < lattice.rows && wanted_up(&lattice, i, j);
			lattice.right[at(&lattice, i, j)] = i + 1 < lattice.columns && wanted_right(&lattice, i, j);
		}
	}
	thin_out(&lattice);
	choose_roundabouts(&lattice);
	add_columns(&lattice);
	add_rows(&lattice);
	for (size_t i = 0; i < lattice.columns; i++)
		for (size_t j = 0; j < lattice.rows; j++)
			if (lattice.roundabout[at(&lattice, i, j)])
				add_roundabout(&lattice, i, j);
	choose_oneways(synth);
	if (synth->plan.old_town)
		streets_old_town(synth);
	if (synth->plan.railway)
		railway_plan(synth);
	synth->city.report = &synth->report;
	graph_build(&synth->city, &synth->graph);
	synth->view = graph_view(&synth->graph);
	open_traps(synth);
}
