/* Loose triangles of the ground's generators, sorted into tiles when they are written. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/bake/ground.h"

static const float scales[] = {
	[MATERIAL_ASPHALT] = 6.0f,
	[MATERIAL_ASPHALT_OLD] = 6.0f,
	[MATERIAL_COBBLE] = 3.0f,
	[MATERIAL_PAVING] = 4.0f,
	[MATERIAL_KERB] = 4.0f,
	[MATERIAL_SQUARE] = 6.0f,
	[MATERIAL_GRAVEL] = 4.0f,
	[MATERIAL_SAND] = 6.0f,
	[MATERIAL_GRASS] = 8.0f,
	[MATERIAL_PARK] = 8.0f,
	[MATERIAL_FOREST] = 8.0f,
	[MATERIAL_PITCH] = 16.0f,
	[MATERIAL_SOIL] = 8.0f,
	[MATERIAL_YARD] = 8.0f,
	[MATERIAL_WATER] = 16.0f,
	[MATERIAL_BALLAST] = 3.0f,
	[MATERIAL_MARKING] = 2.0f,
	[MATERIAL_MARKING_YELLOW] = 2.0f,
	[MATERIAL_CONCRETE] = 4.0f,
	[MATERIAL_METAL] = 1.0f,
	[MATERIAL_LAMP] = 1.0f,
	[MATERIAL_BARK] = 1.0f,
	[MATERIAL_LEAF] = 2.0f,
	[MATERIAL_NEEDLE] = 2.0f,
	[MATERIAL_ROCK] = 6.0f,
};

double material_scale(enum material_id material)
{
	size_t count = sizeof(scales) / sizeof(*scales);
	return material < count && scales[material] > 0.0f ? (double)scales[material] : 4.0;
}

void soup_finish(struct soup *soup)
{
	ARRAY_FINISH(&soup->vertices);
	ARRAY_FINISH(&soup->triangles);
}

uint32_t soup_vertex(struct soup *soup, struct dvec3 at, struct vec3 normal, double u, double v)
{
	struct soup_vertex vertex = {
		.at = at, .normal = normal, .u = u, .v = v, .ao = soup->ao, .material = soup->material
	};
	memcpy(vertex.rgb, soup->rgb, sizeof(vertex.rgb));
	ARRAY_PUSH(&soup->vertices, vertex);
	return (uint32_t)soup->vertices.count - 1;
}

void soup_triangle(struct soup *soup, uint32_t a, uint32_t b, uint32_t c)
{
	ARRAY_PUSH(&soup->triangles, (struct soup_triangle){ .v = { a, b, c }, .pass = soup->pass, .kind = soup->kind });
}

void soup_rebase(struct soup *soup, uint32_t first)
{
	double u = INFINITY, v = INFINITY;
	for (size_t i = first; i < soup->vertices.count; i++) {
		u = fmin(u, floor(soup->vertices.items[i].u));
		v = fmin(v, floor(soup->vertices.items[i].v));
	}
	for (size_t i = first; i < soup->vertices.count; i++) {
		soup->vertices.items[i].u -= u;
		soup->vertices.items[i].v -= v;
	}
}

static struct vec3 quad_normal(struct dvec3 a, struct dvec3 b, struct dvec3 c, struct dvec3 d)
{
	struct vec3 p = { (float)(c.x - a.x), (float)(c.y - a.y), (float)(c.z - a.z) };
	struct vec3 q = { (float)(d.x - b.x), (float)(d.y - b.y), (float)(d.z - b.z) };
	return vec3_normalize(vec3_cross(p, q));
}

void soup_quad(struct soup *soup, struct dvec3 a, struct dvec3 b, struct dvec3 c, struct dvec3 d)
{
	const struct dvec3 corners[4] = { a, b, c, d };
	struct vec3 normal = quad_normal(a, b, c, d);
	double scale = material_scale(soup->material);
	bool floor = fabsf(normal.z) > 0.7f;
	double length = hypot(b.x - a.x, b.y - a.y);
	struct dvec2 along =
		length > 0.0 ? (struct dvec2){ (b.x - a.x) / length, (b.y - a.y) / length } : (struct dvec2){ 1.0, 0.0 };
	uint32_t at[4];
	for (int i = 0; i < 4; i++) {
		double u = floor ? corners[i].x : corners[i].x * along.x + corners[i].y * along.y;
		double v = floor ? corners[i].y : corners[i].z;
		at[i] = soup_vertex(soup, corners[i], normal, u / scale, v / scale);
	}
	soup_rebase(soup, at[0]);
	soup_triangle(soup, at[0], at[1], at[2]);
	soup_triangle(soup, at[0], at[2], at[3]);
}

void soup_wall(
	struct soup *soup, struct dvec2 a, struct dvec2 b, double a_low, double b_low, double a_high, double b_high)
{
	soup_quad(soup, (struct dvec3){ a.x, a.y, a_low }, (struct dvec3){ b.x, b.y, b_low },
		(struct dvec3){ b.x, b.y, b_high }, (struct dvec3){ a.x, a.y, a_high });
}

void soup_box(struct soup *soup, struct dvec3 bottom, struct dvec2 direction, double half_length, double half_width,
	double height)
{
	struct dvec2 l = dvec2_scale(direction, half_length), w = { -direction.y * half_width, direction.x * half_width };
	struct dvec2 c = { bottom.x, bottom.y };
	const struct dvec2 corners[4] = { dvec2_sub(dvec2_sub(c, l), w), dvec2_sub(dvec2_add(c, l), w),
		dvec2_add(dvec2_add(c, l), w), dvec2_add(dvec2_sub(c, l), w) };
	double low = bottom.z, high = bottom.z + height;
	for (int i = 0; i < 4; i++)
		soup_wall(soup, corners[i], corners[(i + 1) % 4], low, low, high, high);
	soup_quad(soup, (struct dvec3){ corners[0].x, corners[0].y, high },
		(struct dvec3){ corners[1].x, corners[1].y, high }, (struct dvec3){ corners[2].x, corners[2].y, high },
		(struct dvec3){ corners[3].x, corners[3].y, high });
}

#define RAILING_POST_M 5.0

/* An upright band seen from both sides, between two heights above its foot. */
static void add_band(struct soup *soup, struct dvec3 a, struct dvec3 b, double low, double high)
{
	struct dvec2 p = { a.x, a.y }, q = { b.x, b.y };
	soup_wall(soup, p, q, a.z + low, b.z + low, a.z + high, b.z + high);
	soup_wall(soup, q, p, b.z + low, a.z + low, b.z + high, a.z + high);
}

static void add_spike(struct soup *soup, struct dvec3 foot, struct dvec2 across, double height)
{
	for (int side = -1; side <= 1; side += 2) {
		struct vec3 normal = vec3_normalize((struct vec3){ (float)(across.y * side), (float)(-across.x * side), 0.0f });
		uint32_t a = soup_vertex(soup,
			(struct dvec3){ foot.x - across.x * side, foot.y - across.y * side, foot.z - 0.15 }, normal, 0.0, 0.0);
		uint32_t b = soup_vertex(soup,
			(struct dvec3){ foot.x + across.x * side, foot.y + across.y * side, foot.z - 0.15 }, normal, 0.1, 0.0);
		uint32_t c = soup_vertex(soup, (struct dvec3){ foot.x, foot.y, foot.z + height }, normal, 0.05, 1.0);
		soup_triangle(soup, a, b, c);
	}
}

void soup_railing(struct soup *soup, struct dvec3 a, struct dvec3 b, double height)
{
	struct dvec3 d = { b.x - a.x, b.y - a.y, b.z - a.z };
	double length = hypot(d.x, d.y);
	if (length < 0.05)
		return;
	add_band(soup, a, b, height - 0.08, height);
	add_band(soup, a, b, height * 0.4, height * 0.4 + 0.05);
	/* a post is a slim upright triangle, turned so that it shows from the street and from along the railing */
	struct dvec2 across = { (d.x - d.y) / length * 0.04, (d.x + d.y) / length * 0.04 };
	int posts = (int)round(length / RAILING_POST_M);
	for (int i = 0; i < posts; i++) {
		double t = (double)i / posts;
		add_spike(soup, (struct dvec3){ a.x + t * d.x, a.y + t * d.y, a.z + t * d.z }, across, height);
	}
}

/* ---- draping ---- */

#define CLIP_MAX 16

/* Keeps what is to the left of a -> b (Sutherland, Hodgman 1974). */
static size_t clip_half_plane(struct dvec2 *points, size_t count, struct dvec2 a, struct dvec2 b)
{
	struct dvec2 out[CLIP_MAX];
	size_t kept = 0;
	struct dvec2 d = dvec2_sub(b, a);
	for (size_t i = 0; i < count && kept + 2 <= CLIP_MAX; i++) {
		struct dvec2 p = points[i], q = points[(i + 1) % count];
		double side_p = dvec2_cross(d, dvec2_sub(p, a)), side_q = dvec2_cross(d, dvec2_sub(q, a));
		if (side_p >= 0.0)
			out[kept++] = p;
		if ((side_p > 0.0 && side_q < 0.0) || (side_p < 0.0 && side_q > 0.0))
			out[kept++] = dvec2_add(p, dvec2_scale(dvec2_sub(q, p), side_p / (side_p - side_q)));
	}
	memcpy(points, out, kept * sizeof(*out));
	return kept;
}

static double polygon_area(const struct dvec2 *points, size_t count)
{
	double twice = 0.0;
	for (size_t i = 1; i + 1 < count; i++)
		twice += dvec2_cross(dvec2_sub(points[i], points[0]), dvec2_sub(points[i + 1], points[0]));
	return twice / 2.0;
}

static void lay(struct soup *soup, const struct city *city, const struct dvec2 *points, size_t count, double lift_m)
{
	if (count < 3 || polygon_area(points, count) < 1e-5)
		return;
	double scale = material_scale(soup->material);
	uint32_t first = (uint32_t)soup->vertices.count;
	for (size_t i = 0; i < count; i++)
		soup_vertex(soup, (struct dvec3){ points[i].x, points[i].y, city_ground(city, points[i]) + lift_m },
			(struct vec3){ 0, 0, 1 }, points[i].x / scale, points[i].y / scale);
	soup_rebase(soup, first);
	for (uint32_t i = 1; i + 1 < count; i++)
		soup_triangle(soup, first, first + i, first + i + 1);
}

static void lay_in_square(struct soup *soup, const struct city *city, const struct dvec2 *points, size_t count,
	double lift_m, struct dvec2 corner, double step)
{
	struct dvec2 sw = corner, ne = { corner.x + step, corner.y + step };
	const struct dvec2 thirds[2] = { { ne.x, sw.y }, { sw.x, ne.y } };
	for (int half = 0; half < 2; half++) {
		struct dvec2 piece[CLIP_MAX];
		memcpy(piece, points, count * sizeof(*points));
		struct dvec2 a = sw, b = half ? ne : thirds[0], c = half ? thirds[1] : ne;
		size_t left = clip_half_plane(piece, count, a, b);
		left = left ? clip_half_plane(piece, left, b, c) : 0;
		left = left ? clip_half_plane(piece, left, c, a) : 0;
		lay(soup, city, piece, left, lift_m);
	}
}

void soup_drape(struct soup *soup, const struct city *city, const struct dvec2 *points, size_t count, double lift_m)
{
	const struct pkg_height_grid *grid = &city->terrain.grid;
	struct ring ring = { (struct dvec2 *)(uintptr_t)points, count };
	struct dvec2 min, max;
	ring_bounds(&ring, &min, &max);
	double step = grid->step_mm / 1000.0, x0 = grid->origin_mm[0] / 1000.0, y0 = grid->origin_mm[1] / 1000.0;
	if (grid->columns < 2 || grid->rows < 2 || min.x < x0 || min.y < y0 || max.x > x0 + step * (grid->columns - 1) ||
		max.y > y0 + step * (grid->rows - 1)) {
		lay(soup, city, points, count, lift_m);
		return;
	}
	int64_t col0 = (int64_t)floor((min.x - x0) / step), col1 = (int64_t)floor((max.x - x0) / step);
	int64_t row0 = (int64_t)floor((min.y - y0) / step), row1 = (int64_t)floor((max.y - y0) / step);
	for (int64_t row = row0; row <= row1; row++)
		for (int64_t col = col0; col <= col1; col++)
			lay_in_square(soup, city, points, count, lift_m,
				(struct dvec2){ x0 + (double)col * step, y0 + (double)row * step }, step);
}

/* ---- writing ---- */

struct placed {
	int32_t row, col;
	uint32_t triangle;
	uint8_t kind;
};

static int compare_placed(const void *left, const void *right)
{
	const struct placed *a = left, *b = right;
	if (a->row != b->row)
		return a->row < b->row ? -1 : 1;
	if (a->col != b->col)
		return a->col < b->col ? -1 : 1;
	if (a->kind != b->kind)
		return a->kind < b->kind ? -1 : 1;
	return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

static struct placed place_triangle(const struct soup *soup, uint32_t index)
{
	const struct soup_triangle *triangle = &soup->triangles.items[index];
	struct dvec2 sum = { 0, 0 };
	for (int i = 0; i < 3; i++) {
		const struct dvec3 *at = &soup->vertices.items[triangle->v[i]].at;
		sum = dvec2_add(sum, (struct dvec2){ at->x, at->y });
	}
	return (struct placed){ .row = (int32_t)floor(sum.y / 3.0 / MESH_TILE_M),
		.col = (int32_t)floor(sum.x / 3.0 / MESH_TILE_M),
		.triangle = index,
		.kind = triangle->kind };
}

/* One run of triangles with the same tile and kind. `index_of` maps soup vertices to the object's, PKG_NONE before. */
static void write_object(
	struct soup *soup, struct mesh_sink *sink, const struct placed *placed, size_t count, uint32_t *index_of)
{
	double u0 = INFINITY, v0 = INFINITY;
	for (size_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++) {
			const struct soup_vertex *vertex = &soup->vertices.items[soup->triangles.items[placed[i].triangle].v[k]];
			u0 = fmin(u0, floor(vertex->u));
			v0 = fmin(v0, floor(vertex->v));
		}
	struct mesh_object object = { .kind = placed->kind, .face = PKG_NONE };
	mesh_begin(sink, &object);
	for (size_t i = 0; i < count; i++) {
		const struct soup_triangle *triangle = &soup->triangles.items[placed[i].triangle];
		for (int k = 0; k < 3; k++) {
			if (index_of[triangle->v[k]] != PKG_NONE)
				continue;
			const struct soup_vertex *from = &soup->vertices.items[triangle->v[k]];
			struct mesh_vertex vertex = { .at = from->at,
				.normal = from->normal,
				.u = (float)(from->u - u0),
				.v = (float)(from->v - v0),
				.ao = from->ao,
				.material = from->material };
			memcpy(vertex.rgb, from->rgb, sizeof(vertex.rgb));
			index_of[triangle->v[k]] = mesh_add_vertex(sink, &vertex);
		}
		mesh_add_triangle(
			sink, triangle->pass, index_of[triangle->v[0]], index_of[triangle->v[1]], index_of[triangle->v[2]]);
	}
	mesh_end(sink);
	for (size_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			index_of[soup->triangles.items[placed[i].triangle].v[k]] = PKG_NONE;
}

void soup_flush(struct soup *soup, struct mesh_sink *sink)
{
	size_t count = soup->triangles.count;
	struct placed *placed = array_grow(NULL, &(size_t){ 0 }, count + 1, sizeof(*placed));
	uint32_t *index_of = array_grow(NULL, &(size_t){ 0 }, soup->vertices.count + 1, sizeof(*index_of));
	for (size_t i = 0; i < soup->vertices.count; i++)
		index_of[i] = PKG_NONE;
	for (uint32_t i = 0; i < count; i++)
		placed[i] = place_triangle(soup, i);
	qsort(placed, count, sizeof(*placed), compare_placed);
	for (size_t from = 0, to; from < count; from = to) {
		for (to = from + 1; to < count; to++)
			if (placed[to].row != placed[from].row || placed[to].col != placed[from].col ||
				placed[to].kind != placed[from].kind)
				break;
		write_object(soup, sink, placed + from, to - from, index_of);
	}
	array_free(placed);
	array_free(index_of);
	soup->vertices.count = soup->triangles.count = 0;
}
