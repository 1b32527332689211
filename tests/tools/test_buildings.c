/* Buildings made from synthetic outlines: closed, outward, within their heights, and sound for any outline. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "platform/base/rng.h"
#include "tools/bake/bake.h"
#include "tools/bake/buildings.h"

struct fixture {
	struct city city;
	struct report report;
	struct plots plots;
	struct massing massing;
	struct shell shell;
	ARRAY(struct building) none;
};

static void start(struct fixture *f)
{
	*f = (struct fixture){ .massing.triangulator = triangulator_new() };
	f->city.report = &f->report;
	f->city.frame = geo_frame_at((struct geo_point){ 46.2, 6.1 });
}

static void finish(struct fixture *f)
{
	triangulator_free(f->massing.triangulator);
	massing_finish(&f->massing);
	shell_finish(&f->shell);
	city_finish(&f->city);
}

static struct ring ring_of(struct fixture *f, const struct dvec2 *points, size_t count)
{
	return (struct ring){ pool_copy(&f->city.pool, points, sizeof(*points) * count), count };
}

static struct building *add(struct fixture *f, const struct dvec2 *points, size_t count, enum roof_shape shape)
{
	struct building building = { .id = (int64_t)f->city.buildings.count + 1,
		.kind = BUILDING_COMMERCIAL,
		.height_m = 8.0,
		.roof_shape = shape,
		.roof_direction_deg = NAN,
		.face = PKG_NONE,
		.outline = PKG_NONE };
	building.footprint.outer = ring_of(f, points, count);
	ARRAY_PUSH(&f->city.buildings, building);
	return &f->city.buildings.items[f->city.buildings.count - 1];
}

static void make(struct fixture *f, uint32_t index)
{
	plots_build(&f->city, &f->plots);
	building_shell(&f->plots, index, &f->massing, &f->shell);
	plots_finish(&f->plots);
}

static struct dvec3 at(const struct shell *shell, size_t corner)
{
	return shell->vertices.items[shell->indices.items[corner]].at;
}

static double volume(const struct shell *shell, struct dvec3 o)
{
	double sum = 0.0;
	for (size_t i = 0; i + 2 < shell->indices.count; i += 3) {
		struct dvec3 a = at(shell, i), b = at(shell, i + 1), c = at(shell, i + 2);
		double x[3] = { a.x - o.x, a.y - o.y, a.z - o.z }, y[3] = { b.x - o.x, b.y - o.y, b.z - o.z };
		double z[3] = { c.x - o.x, c.y - o.y, c.z - o.z };
		sum += x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) +
			   x[2] * (y[0] * z[1] - y[1] * z[0]);
	}
	return sum / 6.0;
}

/* Corners within half a millimetre are one. */
struct corners {
	struct dvec3 *at;
	uint32_t *of; /* shell corner to unique corner */
	size_t count;
};

static struct corners merge(const struct shell *shell)
{
	struct corners out = { malloc(sizeof(struct dvec3) * (shell->indices.count + 1)),
		malloc(sizeof(uint32_t) * (shell->indices.count + 1)), 0 };
	for (size_t i = 0; i < shell->indices.count; i++) {
		struct dvec3 p = at(shell, i);
		size_t k = 0;
		while (k < out.count && fabs(out.at[k].x - p.x) + fabs(out.at[k].y - p.y) + fabs(out.at[k].z - p.z) > 0.0015)
			k++;
		if (k == out.count)
			out.at[out.count++] = p;
		out.of[i] = (uint32_t)k;
	}
	return out;
}

struct half_edge {
	uint32_t low, high;
	int sign;
};

static int edge_order(const void *left, const void *right)
{
	const struct half_edge *a = left, *b = right;
	return a->low != b->low ? (a->low < b->low ? -1 : 1) : a->high != b->high ? (a->high < b->high ? -1 : 1) : 0;
}

struct spot {
	double share;
	uint32_t corner;
};

static int spot_order(const void *left, const void *right)
{
	double a = ((const struct spot *)left)->share, b = ((const struct spot *)right)->share;
	return a < b ? -1 : a > b;
}

/* Cuts the edge at all corners that lie on it. */
static size_t cut_edge(const struct corners *corners, uint32_t from, uint32_t to, struct half_edge *out)
{
	struct dvec3 p = corners->at[from], q = corners->at[to], d = { q.x - p.x, q.y - p.y, q.z - p.z };
	double length2 = d.x * d.x + d.y * d.y + d.z * d.z;
	struct spot spots[256];
	size_t count = 0;
	for (uint32_t i = 0; i < corners->count && count < 254; i++) {
		struct dvec3 c = corners->at[i], e = { c.x - p.x, c.y - p.y, c.z - p.z };
		double share = (d.x * e.x + d.y * e.y + d.z * e.z) / length2;
		double x = e.x - d.x * share, y = e.y - d.y * share, z = e.z - d.z * share;
		if (i != from && i != to && share > 0.0 && share < 1.0 && sqrt(x * x + y * y + z * z) < 0.002)
			spots[count++] = (struct spot){ share, i };
	}
	qsort(spots, count, sizeof(spots[0]), spot_order);
	spots[count] = (struct spot){ 1.0, to };
	for (size_t i = 0; i <= count; i++) {
		uint32_t next = spots[i].corner;
		out[i] = from < next ? (struct half_edge){ from, next, 1 } : (struct half_edge){ next, from, -1 };
		from = next;
	}
	return count + 1;
}

/* Edges that are not matched by one that runs the other way, but for those at the foot of the walls. */
static size_t open_edges(const struct shell *shell, double foot, bool print)
{
	struct corners corners = merge(shell);
	ARRAY(struct half_edge) edges = { 0 };
	for (size_t i = 0; i + 2 < shell->indices.count; i += 3)
		for (size_t k = 0; k < 3; k++) {
			uint32_t from = corners.of[i + k], to = corners.of[i + (k + 1) % 3];
			if (from == to)
				continue;
			struct half_edge pieces[256];
			size_t count = cut_edge(&corners, from, to, pieces);
			for (size_t p = 0; p < count; p++)
				ARRAY_PUSH(&edges, pieces[p]);
		}
	ARRAY_SORT(&edges, edge_order);
	size_t open = 0;
	for (size_t i = 0; i < edges.count;) {
		int sum = 0;
		size_t k = i;
		for (; k < edges.count && edge_order(&edges.items[i], &edges.items[k]) == 0; k++)
			sum += edges.items[k].sign;
		struct dvec3 a = corners.at[edges.items[i].low], b = corners.at[edges.items[i].high];
		if (sum != 0 && (a.z > foot + 0.001 || b.z > foot + 0.001)) {
			open++;
			if (print)
				print_message("open %d: %.4f %.4f %.4f - %.4f %.4f %.4f\n", sum, a.x, a.y, a.z, b.x, b.y, b.z);
		}
		i = k;
	}
	ARRAY_FINISH(&edges);
	free(corners.at);
	free(corners.of);
	return open;
}

static void check_vertices(const struct fixture *f, double low, double high)
{
	for (size_t i = 0; i < f->shell.vertices.count; i++) {
		const struct mesh_vertex *v = &f->shell.vertices.items[i];
		assert_true(isfinite(v->at.x) && isfinite(v->at.y) && isfinite(v->at.z));
		if (v->at.z < low - 0.002 || v->at.z > high + 0.002)
			print_message("material %d kind %d shape %d z %f of %f %f\n", v->material, f->massing.building->kind,
				f->massing.plot->roof, v->at.z, low, high);
		assert_true(v->at.z >= low - 0.002 && v->at.z <= high + 0.002);
		if (!(v->u >= 0.0f && v->u < 255.0f && v->v >= 0.0f && v->v < 255.0f))
			print_message("material %d kind %d uv %f %f z %f\n", v->material, f->massing.building->kind, (double)v->u,
				(double)v->v, v->at.z);
		assert_true(v->u >= 0.0f && v->u < 255.0f && v->v >= 0.0f && v->v < 255.0f);
		assert_true(v->ao >= 0.0f && v->ao <= 1.0f);
		assert_true(fabsf(vec3_dot(v->normal, v->normal) - 1.0f) < 0.01f);
		assert_true(v->material < MATERIAL_WALL_END);
	}
	for (size_t i = 0; i < f->shell.indices.count; i++)
		assert_true(f->shell.indices.items[i] < f->shell.vertices.count);
}

#define POINTS(...)                                                                                                    \
	(const struct dvec2[]){ __VA_ARGS__ }, sizeof((const struct dvec2[]){ __VA_ARGS__ }) / sizeof(struct dvec2)

struct outline {
	const char *name;
	const struct dvec2 *points;
	size_t count;
};

static const struct outline outlines[] = {
	{ "oblong", POINTS({ 0, 0 }, { 16, 0 }, { 16, 9 }, { 0, 9 }) },
	{ "square", POINTS({ 0, 0 }, { 10, 0 }, { 10, 10 }, { 0, 10 }) },
	{ "turned", POINTS({ 0, 0 }, { 12, 5 }, { 8.2, 14.1 }, { -3.8, 9.1 }) },
	{ "L", POINTS({ 0, 0 }, { 20, 0 }, { 20, 8 }, { 9, 8 }, { 9, 18 }, { 0, 18 }) },
	{ "U", POINTS({ 0, 0 }, { 24, 0 }, { 24, 16 }, { 17, 16 }, { 17, 7 }, { 7, 7 }, { 7, 16 }, { 0, 16 }) },
	{ "T", POINTS({ 0, 0 }, { 24, 0 }, { 24, 8 }, { 16, 8 }, { 16, 20 }, { 8, 20 }, { 8, 8 }, { 0, 8 }) },
	{ "triangle", POINTS({ 0, 0 }, { 14, 1 }, { 5, 11 }) },
	{ "hexagon", POINTS({ 6, 0 }, { 3, 5.2 }, { -3, 5.2 }, { -6, 0 }, { -3, -5.2 }, { 3, -5.2 }) },
	{ "wedge", POINTS({ 0, 0 }, { 30, 0 }, { 30, 2.5 }, { 0, 9 }) },
	{ "straight corners",
		POINTS({ 0, 0 }, { 5, 0.02 }, { 11, 0 }, { 16, 0 }, { 16, 4 }, { 15.98, 6 }, { 16, 9 }, { 0, 9 }) },
	{ "centimetre edges", POINTS({ 0, 0 }, { 15.99, 0 }, { 16, 0.01 }, { 16, 9 }, { 0.01, 9 }, { 0, 8.99 }) },
	{ "sliver", POINTS({ 0, 0 }, { 30, 0 }, { 30, 0.6 }, { 0, 0.5 }) },
	{ "notched", POINTS({ 0, 0 }, { 18, 0 }, { 18, 10 }, { 11, 10 }, { 11, 9 }, { 8, 9 }, { 8, 10 }, { 0, 10 }) },
};
static const enum roof_shape shapes[] = { ROOF_FLAT, ROOF_GABLED, ROOF_HIPPED, ROOF_HALF_HIPPED, ROOF_PYRAMIDAL,
	ROOF_SKILLION, ROOF_DOME, ROOF_ONION, ROOF_MANSARD, ROOF_GAMBREL, ROOF_ROUND, ROOF_CONE };
static const char *const shape_names[] = { "flat", "gabled", "hipped", "half-hipped", "pyramidal", "skillion", "dome",
	"onion", "mansard", "gambrel", "round", "cone" };

static size_t count_of(size_t bytes, size_t item)
{
	return bytes / item;
}

static void every_roof_closes_every_outline(void **state)
{
	(void)state;
	size_t bad = 0;
	for (size_t o = 0; o < count_of(sizeof(outlines), sizeof(outlines[0])); o++)
		for (size_t s = 0; s < count_of(sizeof(shapes), sizeof(shapes[0])); s++) {
			struct fixture f;
			start(&f);
			add(&f, outlines[o].points, outlines[o].count, shapes[s]);
			make(&f, 0);
			check_vertices(&f, -0.5, 8.0);
			double got = volume(&f.shell, (struct dvec3){ 5.0, 4.0, -0.5 });
			double least = f.massing.area * (f.massing.eaves + 0.5 - 1.6), most = f.massing.area * 8.5 * 1.25;
			size_t open = open_edges(&f.shell, -0.5, false);
			if (open || f.massing.roof_faults || f.massing.deck_faults || got < least || got > most) {
				print_message("%s, %s: %zu open edges, faults %zu %zu, volume %.1f (%.1f to %.1f)\n", outlines[o].name,
					shape_names[s], open, f.massing.roof_faults, f.massing.deck_faults, got, least, most);
				open_edges(&f.shell, -0.5, true);
				bad++;
			}
			finish(&f);
		}
	assert_int_equal(bad, 0);
}

static void courtyards_keep_their_hole(void **state)
{
	(void)state;
	for (size_t s = 0; s < count_of(sizeof(shapes), sizeof(shapes[0])); s++) {
		struct fixture f;
		start(&f);
		struct building *b = add(&f, POINTS({ 0, 0 }, { 40, 0 }, { 40, 30 }, { 0, 30 }), shapes[s]);
		b->footprint.holes = pool_alloc(&f.city.pool, sizeof(struct ring));
		b->footprint.holes[0] = ring_of(&f, POINTS({ 12, 10 }, { 12, 20 }, { 28, 20 }, { 28, 10 }));
		b->footprint.hole_count = 1;
		make(&f, 0);
		check_vertices(&f, -0.5, 8.0);
		assert_float_equal(f.massing.area, 1200.0 - 160.0, 0.01);
		assert_int_equal(open_edges(&f.shell, -0.5, true), 0);
		assert_int_equal(f.massing.roof_faults, 0);
		assert_true(volume(&f.shell, (struct dvec3){ 5.0, 4.0, -0.5 }) < f.massing.area * 8.5 * 1.05);
		finish(&f);
	}
}

static void parts_in_the_air_have_an_underside(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	struct building *b = add(&f, outlines[0].points, outlines[0].count, ROOF_FLAT);
	b->min_height_m = 4.0;
	make(&f, 0);
	check_vertices(&f, 4.0, 8.0);
	assert_int_equal(open_edges(&f.shell, -100.0, true), 0);
	finish(&f);
}

static float area_facing(const struct shell *shell, float nx, float ny)
{
	double sum = 0.0;
	for (size_t i = 0; i + 2 < shell->indices.count; i += 3) {
		const struct mesh_vertex *v = &shell->vertices.items[shell->indices.items[i]];
		if (v->normal.x * nx + v->normal.y * ny < 0.99f)
			continue;
		struct dvec3 a = at(shell, i), b = at(shell, i + 1), c = at(shell, i + 2);
		double x = (b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y);
		double y = (b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z);
		sum += hypot(x, y) / 2.0;
	}
	return (float)sum;
}

/* Without cornices, whose caps face sideways too. */
static void make_plain(struct fixture *f, uint32_t index)
{
	for (size_t i = 0; i < f->city.buildings.count; i++)
		f->city.buildings.items[i].kind = BUILDING_INDUSTRIAL;
	make(f, index);
}

static void walls_between_neighbours_are_left_out(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	add(&f, POINTS({ 0, 0 }, { 10, 0 }, { 10, 10 }, { 0, 10 }), ROOF_FLAT);
	add(&f, POINTS({ 10, 0 }, { 20, 0 }, { 20, 10 }, { 10, 10 }), ROOF_FLAT)->height_m = 8.5;
	f.city.buildings.items[0].height_m = 6.0;
	make_plain(&f, 0);
	/* Only the inside of the western parapet faces east. */
	assert_float_equal(area_facing(&f.shell, 1.0f, 0.0f), (float)(10.0 * 0.7), 0.01f);
	make_plain(&f, 1);
	/* Above the lower neighbour, and the inside of the eastern parapet. */
	assert_float_equal(area_facing(&f.shell, -1.0f, 0.0f), (float)(10.0 * 2.5 + 10.0 * 0.7), 0.01f);
	for (size_t i = 0; i < f.shell.vertices.count; i++)
		if (f.shell.vertices.items[i].normal.x < -0.99f && f.shell.vertices.items[i].at.z < 6.1)
			assert_true(f.shell.vertices.items[i].material >= MATERIAL_BLANK_PLASTER &&
						f.shell.vertices.items[i].material <= MATERIAL_BLANK_METAL);
	finish(&f);
}

static void a_neighbour_along_half_a_wall_hides_half_of_it(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	add(&f, POINTS({ 0, 0 }, { 10, 0 }, { 10, 10 }, { 0, 10 }), ROOF_FLAT);
	add(&f, POINTS({ 10, 4 }, { 20, 4 }, { 20, 14 }, { 10, 14 }), ROOF_FLAT);
	make_plain(&f, 0);
	assert_float_equal(area_facing(&f.shell, 1.0f, 0.0f), (float)(4.0 * 8.5 + 10.0 * 0.7), 0.01f);
	assert_int_equal(f.massing.walls.count, 5);
	finish(&f);
}

static void of_two_walls_in_one_plane_one_is_drawn(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	struct building *low = add(&f, POINTS({ 0, 0 }, { 20, 0 }, { 20, 10 }, { 0, 10 }), ROOF_FLAT);
	low->is_part = true;
	struct building *tower = add(&f, POINTS({ 0, 0 }, { 8, 0 }, { 8, 8 }, { 0, 8 }), ROOF_FLAT);
	tower->is_part = true;
	tower->height_m = 30.0;
	make_plain(&f, 0);
	/* The tower's southern wall stands for the podium's there. */
	assert_float_equal(area_facing(&f.shell, 0.0f, -1.0f), (float)(12.0 * 8.5 + 20.0 * 0.7), 0.01f);
	make_plain(&f, 1);
	assert_float_equal(area_facing(&f.shell, 0.0f, -1.0f), (float)(8.0 * 30.5 + 8.0 * 0.7), 0.02f);
	finish(&f);
}

static void a_row_of_houses_shares_one_ridge(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	for (int i = 0; i < 3; i++)
		add(&f, POINTS({ i * 7.0, 0 }, { i * 7.0 + 7, 0 }, { i * 7.0 + 7, 11 }, { i * 7.0, 11 }), ROOF_HIPPED);
	make(&f, 1);
	size_t high = 0;
	for (size_t i = 0; i < f.shell.vertices.count; i++) {
		const struct mesh_vertex *v = &f.shell.vertices.items[i];
		if (v->at.z > 7.99) {
			high++;
			assert_true(fabs(v->at.y - 5.5) < 0.05);
		}
	}
	assert_true(high > 0);
	finish(&f);
}

/* A ring around the origin with wild radii: star-shaped, any number of corners, some of them very near each other. */
static size_t wild_ring(struct rng *rng, struct dvec2 *out, double size)
{
	size_t count = 3 + rng_u32(rng) % (rng_u32(rng) % 4 == 0 ? 197 : 14);
	double angle = rng_range(rng, 0.0, 6.0), turn = 2.0 * BLVD_PI / (double)count;
	for (size_t i = 0; i < count; i++) {
		double radius = size * rng_range(rng, 0.3, 1.0);
		double a = angle + turn * ((double)i + 0.8 * rng_unit(rng) * (count > 4));
		out[i] = (struct dvec2){ radius * cos(a), radius * sin(a) };
	}
	return count;
}

/* A staircase of right angles, as buildings have them. */
static size_t square_ring(struct rng *rng, struct dvec2 *out)
{
	size_t count = 0, steps = 1 + rng_u32(rng) % 6;
	double x = 0.0, top[8], width[8];
	for (size_t i = 0; i < steps; i++) {
		width[i] = rng_range(rng, 2.0, 12.0);
		top[i] = rng_range(rng, 4.0, 20.0);
		x += width[i];
	}
	out[count++] = (struct dvec2){ 0.0, 0.0 };
	out[count++] = (struct dvec2){ x, 0.0 };
	for (size_t i = steps; i-- > 0;) {
		out[count++] = (struct dvec2){ x, top[i] };
		x -= width[i];
		out[count++] = (struct dvec2){ x, top[i] };
	}
	double angle = rng_range(rng, 0.0, 6.3);
	for (size_t i = 0; i < count; i++)
		out[i] = (struct dvec2){ out[i].x * cos(angle) - out[i].y * sin(angle),
			out[i].x * sin(angle) + out[i].y * cos(angle) };
	return count;
}

static void any_outline_gives_a_sound_building(void **state)
{
	(void)state;
	struct rng rng = rng_seed(7);
	size_t open = 0, faults = 0, square_faults = 0, square = 0;
	for (int i = 0; i < 3000; i++) {
		struct fixture f;
		start(&f);
		struct dvec2 points[220];
		bool right_angles = i % 2 == 0;
		size_t count = right_angles ? square_ring(&rng, points) : wild_ring(&rng, points, rng_range(&rng, 0.8, 30.0));
		struct building *b = add(&f, points, count, shapes[rng_u32(&rng) % 12]);
		b->kind = (enum building_kind)(rng_u32(&rng) % 11);
		b->height_m = rng_range(&rng, 0.3, 60.0);
		b->levels = (double)(rng_u32(&rng) % 20);
		b->roof_height_m = rng_u32(&rng) % 3 ? 0.0 : rng_range(&rng, 0.1, 30.0);
		b->roof_direction_deg = rng_u32(&rng) % 3 ? NAN : rng_range(&rng, 0.0, 360.0);
		b->shop = rng_u32(&rng) % 2;
		make(&f, 0);
		if (f.shell.vertices.count) {
			check_vertices(&f, -0.5, fmax(b->height_m, 3.0) + 20.0);
			assert_true(f.shell.indices.count / 3 < 60 * count + 400);
			bool plain = b->kind == BUILDING_INDUSTRIAL || b->kind == BUILDING_COMMERCIAL ||
						 b->kind == BUILDING_GREENHOUSE || b->kind == BUILDING_GARAGE;
			if (plain && b->height_m < 9.0 && count < 40)
				open += open_edges(&f.shell, -0.5, false) > 0;
			faults += f.massing.roof_faults;
			square += right_angles;
			square_faults += right_angles ? f.massing.roof_faults : 0;
		}
		finish(&f);
	}
	print_message("3000 outlines: %zu roofs became flat (%zu of %zu with right angles), %zu are not closed\n", faults,
		square_faults, square, open);
	assert_true(square_faults * 100 < square);
	assert_true(faults < 300);
	assert_true(open < 5);
}

static void dirt_is_dropped_or_drawn(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	add(&f, POINTS({ 0, 0 }, { 0, 0 }, { 0, 0 }), ROOF_GABLED);
	add(&f, POINTS({ 0, 0 }, { 10, 0 }, { 20, 0 }, { 10, 0 }), ROOF_HIPPED);
	add(&f, POINTS({ 0, 0 }, { 10, 10 }, { 10, 0 }, { 0, 10 }), ROOF_HIPPED); /* a bow tie */
	add(&f, POINTS({ 0, 0 }, { 10, 0 }, { 10, 10 }, { 5, 10 }, { 5, 14 }, { 5, 10 }, { 0, 10 }), ROOF_HIPPED);
	add(&f, POINTS({ 0, 0 }, { NAN, 0 }, { 10, 0 }, { 10, 10 }), ROOF_HIPPED)->height_m = NAN;
	for (uint32_t i = 0; i < 5; i++) {
		make(&f, i);
		check_vertices(&f, -1.0, 20.0);
	}
	finish(&f);
}

static void windows_are_whole(void **state)
{
	(void)state;
	struct rng rng = rng_seed(3);
	for (int i = 0; i < 200; i++) {
		struct fixture f;
		start(&f);
		double l = rng_range(&rng, 4.0, 40.0), w = rng_range(&rng, 4.0, 20.0);
		struct building *b = add(&f, POINTS({ 0, 0 }, { l, 0 }, { l, w }, { 0, w }), ROOF_FLAT);
		b->kind = BUILDING_APARTMENTS;
		b->id = i;
		b->height_m = rng_range(&rng, 7.0, 30.0);
		make(&f, 0);
		for (size_t t = 0; t + 3 < f.shell.vertices.count; t++) {
			const struct mesh_vertex *v = &f.shell.vertices.items[t];
			if (v->material < MATERIAL_WALL_FIRST || v->material >= MATERIAL_BLANK_PLASTER)
				continue;
			assert_float_equal(v->u, roundf(v->u), 1e-4);
			assert_float_equal(v->v, roundf(v->v), 1e-3);
		}
		finish(&f);
	}
}

static void the_same_building_twice_is_the_same(void **state)
{
	(void)state;
	struct fixture f, g;
	start(&f);
	start(&g);
	add(&f, outlines[3].points, outlines[3].count, ROOF_MANSARD);
	add(&g, outlines[3].points, outlines[3].count, ROOF_MANSARD);
	make(&g, 0);
	make(&f, 0);
	make(&f, 0);
	assert_int_equal(f.shell.vertices.count, g.shell.vertices.count);
	for (size_t i = 0; i < f.shell.vertices.count; i++) {
		const struct mesh_vertex *a = &f.shell.vertices.items[i], *b = &g.shell.vertices.items[i];
		assert_memory_equal(&a->at, &b->at, sizeof(a->at));
		assert_memory_equal(a->rgb, b->rgb, 3);
	}
	finish(&f);
	finish(&g);
}

static void a_canopy_is_closed_and_stands_on_posts(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	add(&f, outlines[0].points, outlines[0].count, ROOF_FLAT)->kind = BUILDING_ROOF;
	make(&f, 0);
	check_vertices(&f, -0.5, 8.0);
	size_t low = 0;
	for (size_t i = 0; i < f.shell.vertices.count; i++)
		low += f.shell.vertices.items[i].at.z < 0.0;
	assert_int_equal(low, 4 * 4 * 2);
	finish(&f);
}

/* Walls and roofs of CityJSON surfaces are told apart by where they face. */
static void surfaces_are_dressed_by_their_normals(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	struct building *b = add(&f, outlines[0].points, outlines[0].count, ROOF_FLAT);
	struct dvec3 faces[] = { { 0, 0, 0 }, { 9, 0, 0 }, { 9, 0, 7 }, { 0, 0, 7 }, { 9, 0, 7 }, { 9, 9, 9 }, { 0, 0, 0 },
		{ 0, 9, 0 }, { 9, 9, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 0, NAN, 0 }, { 1, 0, 0 }, { 0, 1, 0 } };
	b->walls_3d = pool_copy(&f.city.pool, faces, sizeof(faces));
	b->wall_3d_count = sizeof(faces) / sizeof(faces[0]);
	make(&f, 0);
	assert_int_equal(f.shell.indices.count, 9);
	check_vertices(&f, 0.0, 9.0);
	for (size_t i = 0; i < f.shell.indices.count; i++) {
		const struct mesh_vertex *v = &f.shell.vertices.items[f.shell.indices.items[i]];
		bool roof = v->material >= MATERIAL_ROOF_TILES && v->material <= MATERIAL_ROOF_GRASS;
		assert_int_equal(roof, v->normal.z > 0.35f);
	}
	finish(&f);
}

static void a_city_is_the_same_whatever_its_threads_do(void **state)
{
	(void)state;
	struct fixture f;
	start(&f);
	for (int i = 0; i < 60; i++) {
		double x = i % 10 * 18.0, y = i / 10 * 30.0;
		struct building *b =
			add(&f, POINTS({ x, y }, { x + 18, y }, { x + 18, y + 12 }, { x, y + 12 }), shapes[i % 12]);
		b->kind = i % 3 ? BUILDING_APARTMENTS : BUILDING_HOUSE;
		b->height_m = 6.0 + i % 7 * 2.5;
	}
	struct mesh_chunks chunks[2];
	for (int k = 0; k < 2; k++) {
		struct mesh_sink *sink = mesh_sink_new();
		buildings_build(&f.city, NULL, sink);
		mesh_finish_chunks(sink, &chunks[k]);
		mesh_sink_free(sink);
	}
	assert_int_equal(chunks[0].objects.count, 60);
	assert_int_equal(chunks[0].geometry.count, chunks[1].geometry.count);
	assert_memory_equal(chunks[0].geometry.items, chunks[1].geometry.items, chunks[0].geometry.count);
	mesh_chunks_finish(&chunks[0]);
	mesh_chunks_finish(&chunks[1]);
	finish(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_roof_closes_every_outline),
		cmocka_unit_test(courtyards_keep_their_hole),
		cmocka_unit_test(parts_in_the_air_have_an_underside),
		cmocka_unit_test(walls_between_neighbours_are_left_out),
		cmocka_unit_test(a_neighbour_along_half_a_wall_hides_half_of_it),
		cmocka_unit_test(of_two_walls_in_one_plane_one_is_drawn),
		cmocka_unit_test(a_row_of_houses_shares_one_ridge),
		cmocka_unit_test(any_outline_gives_a_sound_building),
		cmocka_unit_test(dirt_is_dropped_or_drawn),
		cmocka_unit_test(windows_are_whole),
		cmocka_unit_test(the_same_building_twice_is_the_same),
		cmocka_unit_test(a_canopy_is_closed_and_stands_on_posts),
		cmocka_unit_test(surfaces_are_dressed_by_their_normals),
		cmocka_unit_test(a_city_is_the_same_whatever_its_threads_do),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
