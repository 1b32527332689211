/* Walls, hedges and fences as thin boxes; and the ground beyond the data, out to the horizon. */
#include <math.h>
#include <string.h>

#include "tools/bake/ground.h"

#define APRON_M 4000.0
#define PIECE_M 15.0
#define SMOOTH_M 0.15
#define APRON_SINK_M 0.35 /* below the last tiles' skirts' tops, so that it never shows through */

static void paint(struct soup *soup, enum material_id material, uint8_t r, uint8_t g, uint8_t b, float ao)
{
	soup->material = (uint8_t)material;
	soup->rgb[0] = r;
	soup->rgb[1] = g;
	soup->rgb[2] = b;
	soup->ao = ao;
}

struct barrier {
	double half_width_m, height_m;
};

static struct barrier barrier_of(struct soup *soup, const struct line *line)
{
	double height = line->height_m > 0.0 ? fmin(line->height_m, 8.0) : 0.0;
	switch (line->kind) {
	case LINE_HEDGE:
		paint(soup, MATERIAL_LEAF, 190, 205, 170, 0.85f);
		return (struct barrier){ 0.35, height > 0.0 ? height : 1.3 };
	case LINE_FENCE:
		paint(soup, MATERIAL_METAL, 130, 134, 132, 0.9f);
		return (struct barrier){ 0.03, height > 0.0 ? height : 1.1 };
	default:
		paint(soup, MATERIAL_CONCRETE, 226, 220, 208, 0.9f);
		return (struct barrier){ 0.15, height > 0.0 ? height : 1.4 };
	}
}

/* One straight piece. Its ends follow the ground, so it is no box of soup_box(). */
static void add_piece(struct soup *soup, const struct city *city, struct dvec2 a, struct dvec2 b, struct barrier size)
{
	struct dvec2 d = dvec2_sub(b, a);
	double length = dvec2_length(d);
	if (length < 0.05)
		return;
	struct dvec2 w = { -d.y / length * size.half_width_m, d.x / length * size.half_width_m };
	struct dvec2 al = dvec2_add(a, w), ar = dvec2_sub(a, w), bl = dvec2_add(b, w), br = dvec2_sub(b, w);
	double low_a = city_ground(city, a) - 0.2, low_b = city_ground(city, b) - 0.2;
	double top_a = low_a + 0.2 + KERB_M + size.height_m, top_b = low_b + 0.2 + KERB_M + size.height_m;
	soup_wall(soup, ar, br, low_a, low_b, top_a, top_b);
	soup_wall(soup, bl, al, low_b, low_a, top_b, top_a);
	soup_wall(soup, al, ar, low_a, low_a, top_a, top_a);
	soup_wall(soup, br, bl, low_b, low_b, top_b, top_b);
	soup_quad(soup, (struct dvec3){ ar.x, ar.y, top_a }, (struct dvec3){ br.x, br.y, top_b },
		(struct dvec3){ bl.x, bl.y, top_b }, (struct dvec3){ al.x, al.y, top_a });
}

/* The next corner that matters: all points between stand within SMOOTH_M of the straight line. */
static size_t next_corner(const struct line *line, size_t from)
{
	size_t to = from + 1;
	for (; to + 1 < line->count; to++) {
		struct dvec2 a = line->points[from], d = dvec2_sub(line->points[to + 1], a);
		double square = fmax(dvec2_dot(d, d), 1e-9);
		for (size_t i = from + 1; i <= to; i++) {
			struct dvec2 p = dvec2_sub(line->points[i], a);
			double t = dvec2_dot(p, d) / square;
			if (t < 0.0 || t > 1.0 || fabs(dvec2_cross(d, p)) > SMOOTH_M * sqrt(square))
				return to;
		}
	}
	return to;
}

static struct dvec3 on_ground(const struct city *city, struct dvec2 at)
{
	return (struct dvec3){ at.x, at.y, city_ground(city, at) + KERB_M };
}

static void add_barrier(
	const struct ground_plan *plan, struct soup *soup, enum line_kind kind, struct barrier size, struct dvec2 ends[2])
{
	if (kind != LINE_FENCE)
		add_piece(soup, plan->city, ends[0], ends[1], size);
	else
		soup_railing(soup, on_ground(plan->city, ends[0]), on_ground(plan->city, ends[1]), size.height_m);
}

/* Nothing where streets pass: a gate. A fence that is seen from no street is too thin to be seen at all. */
static bool stands(const struct ground_plan *plan, enum line_kind kind, struct dvec2 middle)
{
	return !ground_on_any_road(plan, middle, 0.0) &&
		   (kind != LINE_FENCE || ground_near_street(plan, middle, STREET_SIDE_M));
}

/* Pieces follow the terrain; without one those that stand in a row are one. */
static void add_straight(const struct ground_plan *plan, struct soup *soup, enum line_kind kind, struct barrier size,
	struct dvec2 a, struct dvec2 b)
{
	struct dvec2 d = dvec2_sub(b, a), run[2] = { a, a };
	int pieces = (int)ceil(dvec2_length(d) / PIECE_M);
	bool open = false;
	for (int p = 0; p < pieces; p++) {
		bool here = stands(plan, kind, dvec2_add(a, dvec2_scale(d, (p + 0.5) / pieces)));
		if (open && (!here || plan->has_terrain))
			add_barrier(plan, soup, kind, size, run);
		if (here && (!open || plan->has_terrain))
			run[0] = dvec2_add(a, dvec2_scale(d, (double)p / pieces));
		if (here)
			run[1] = dvec2_add(a, dvec2_scale(d, (p + 1.0) / pieces));
		open = here;
	}
	if (open)
		add_barrier(plan, soup, kind, size, run);
}

void ground_lines_build(const struct ground_plan *plan, struct soup *soup)
{
	soup->pass = PKG_PASS_OPAQUE;
	soup->kind = PKG_OBJECT_FURNITURE;
	for (size_t i = 0; i < plan->city->lines.count; i++) {
		const struct line *line = &plan->city->lines.items[i];
		if (line->kind == LINE_RIVER || line->kind == LINE_STREAM || line->layer < 0)
			continue;
		struct barrier size = barrier_of(soup, line);
		for (size_t k = 0, next; k + 1 < line->count; k = next) {
			next = next_corner(line, k);
			struct dvec2 a = line->points[k], b = line->points[next];
			if (a.x >= plan->min.x && a.x <= plan->max.x && a.y >= plan->min.y && a.y <= plan->max.y)
				add_straight(plan, soup, line->kind, size, a, b);
		}
	}
}

/* ---- apron ---- */

/* One cell from the tiles' border at a, b outwards to c, d. */
static void apron_cell(
	const struct ground_plan *plan, struct soup *soup, struct dvec2 a, struct dvec2 b, struct dvec2 outwards)
{
	struct dvec2 middle = dvec2_scale(dvec2_add(a, b), 0.5);
	const struct ground_area *water = ground_area_at(plan, dvec2_sub(middle, dvec2_scale(outwards, 4.0)), REGION_WATER);
	double drop = APRON_SINK_M;
	paint(soup, MATERIAL_GRASS, 246, 244, 226, 1.0f);
	if (water)
		paint(soup, MATERIAL_WATER, 255, 255, 255, 1.0f);
	double scale = 48.0; /* a coarse texture: it is seen from afar only */
	const struct dvec2 corners[4] = { a, b, dvec2_add(b, dvec2_scale(outwards, APRON_M)),
		dvec2_add(a, dvec2_scale(outwards, APRON_M)) };
	uint32_t at[4];
	for (int i = 0; i < 4; i++) {
		struct dvec2 shore = i == 0 || i == 3 ? a : b;
		double z = water ? ground_water_z(plan, water, middle) - 0.02 : city_ground(plan->city, shore) - drop;
		at[i] = soup_vertex(soup, (struct dvec3){ corners[i].x, corners[i].y, z }, (struct vec3){ 0, 0, 1 },
			corners[i].x / scale, corners[i].y / scale);
	}
	soup_rebase(soup, at[0]);
	soup_triangle(soup, at[0], at[1], at[2]);
	soup_triangle(soup, at[0], at[2], at[3]);
}

static void apron_corner(
	const struct ground_plan *plan, struct soup *soup, struct dvec2 at, double sign_x, double sign_y)
{
	paint(soup, MATERIAL_GRASS, 246, 244, 226, 1.0f);
	double z = city_ground(plan->city, at) - APRON_SINK_M, scale = 48.0;
	struct dvec2 corners[4] = { at, { at.x + sign_x * APRON_M, at.y },
		{ at.x + sign_x * APRON_M, at.y + sign_y * APRON_M }, { at.x, at.y + sign_y * APRON_M } };
	uint32_t v[4];
	for (int i = 0; i < 4; i++)
		v[i] = soup_vertex(soup, (struct dvec3){ corners[i].x, corners[i].y, z }, (struct vec3){ 0, 0, 1 },
			corners[i].x / scale, corners[i].y / scale);
	soup_rebase(soup, v[0]);
	bool turn = sign_x * sign_y < 0.0;
	soup_triangle(soup, v[0], v[turn ? 2 : 1], v[turn ? 1 : 2]);
	soup_triangle(soup, v[0], v[turn ? 3 : 2], v[turn ? 2 : 3]);
}

void ground_apron_build(const struct ground_plan *plan, struct soup *soup)
{
	soup->pass = PKG_PASS_OPAQUE;
	soup->kind = PKG_OBJECT_GROUND;
	struct dvec2 min = plan->min, max = plan->max;
	int cols = (int)llround((max.x - min.x) / MESH_TILE_M), rows = (int)llround((max.y - min.y) / MESH_TILE_M);
	for (int i = 0; i < cols; i++) {
		double x0 = min.x + i * MESH_TILE_M, x1 = x0 + MESH_TILE_M;
		apron_cell(plan, soup, (struct dvec2){ x1, min.y }, (struct dvec2){ x0, min.y }, (struct dvec2){ 0, -1 });
		apron_cell(plan, soup, (struct dvec2){ x0, max.y }, (struct dvec2){ x1, max.y }, (struct dvec2){ 0, 1 });
	}
	for (int i = 0; i < rows; i++) {
		double y0 = min.y + i * MESH_TILE_M, y1 = y0 + MESH_TILE_M;
		apron_cell(plan, soup, (struct dvec2){ min.x, y0 }, (struct dvec2){ min.x, y1 }, (struct dvec2){ -1, 0 });
		apron_cell(plan, soup, (struct dvec2){ max.x, y1 }, (struct dvec2){ max.x, y0 }, (struct dvec2){ 1, 0 });
	}
	apron_corner(plan, soup, min, -1, -1);
	apron_corner(plan, soup, (struct dvec2){ max.x, min.y }, 1, -1);
	apron_corner(plan, soup, max, 1, 1);
	apron_corner(plan, soup, (struct dvec2){ min.x, max.y }, -1, 1);
}
