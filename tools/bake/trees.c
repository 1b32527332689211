/*
 * Trees: those of the data, and planted ones in forests and parks. A crown is two dozen triangles, a rounded body or
 * stacked cones, its outline roughened by the tree's own hash, with the normals of the smooth body: light wraps round
 * it. A trunk is six more. Inside a forest trees stand wider apart, with larger crowns: only its edge is seen.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/bake/ground.h"

#define SIDES 6     /* at most */
#define FAR_SIDES 5 /* away from streets */
#define PLANTED_MAX 40000.0
#define FOREST_EDGE_M 16.0
#define FOREST_INSIDE_SHARE 0.4 /* of the edge's trees */
#define CELL_M 32.0             /* trees of one square are one object */

struct tree_look {
	struct dvec3 foot;
	double height, crown_radius, crown_low; /* crown_low: of the crown's lower end above the foot */
	bool needle, inside;                    /* inside: of a forest, whose trunks nobody sees */
	int sides;
	uint64_t hash;
	uint8_t rgb[3];
};

struct tree_place {
	struct tree tree;
	int32_t row, col;
	bool inside; /* of a forest */
};
typedef ARRAY(struct tree_place) tree_array;

/* ---- one tree ---- */

/* In [0, 1), one of many per tree. */
static double roll(uint64_t hash, uint32_t index)
{
	return (double)(hash_u64(hash + index * UINT64_C(0x9E3779B97F4A7C15)) >> 40) / 16777216.0;
}

/* `x`, `y` in crown radii, `level` 0 at the crown's lower end, 1 at its top; `slope` of the smooth surface there. */
static uint32_t crown_vertex(
	struct mesh_sink *sink, const struct tree_look *look, double x, double y, double level, double slope, double u)
{
	double crown = look->height - look->crown_low;
	struct vec3 normal = vec3_normalize((struct vec3){ (float)x, (float)y, (float)slope });
	struct mesh_vertex vertex = {
		.at = { look->foot.x + x * look->crown_radius, look->foot.y + y * look->crown_radius,
			look->foot.z + look->crown_low + level * crown },
		.normal = normal,
		.u = (float)u,
		.v = (float)(level * 2.0 + 0.1),
		.ao = (float)(0.7 + 0.3 * sqrt(fmin(fmax(level, 0.0), 1.0))),
		.material = (uint8_t)(look->needle ? MATERIAL_NEEDLE : MATERIAL_LEAF),
		.seed = (uint8_t)look->hash,
	};
	memcpy(vertex.rgb, look->rgb, sizeof(vertex.rgb));
	return mesh_add_vertex(sink, &vertex);
}

struct ring_shape {
	double radius, level, slope;
};

static void add_ring(struct mesh_sink *sink, const struct tree_look *look, const struct ring_shape *shape,
	uint32_t index, uint32_t out[SIDES])
{
	double twist = roll(look->hash, 1) * 6.3 + (index & 1 ? BLVD_PI / look->sides : 0.0);
	for (int i = 0; i < look->sides; i++) {
		double rough = 0.9 + 0.22 * roll(look->hash, 16 + index * SIDES + (uint32_t)i);
		double turn = twist + 2.0 * BLVD_PI * i / look->sides;
		double lift = 0.08 * (roll(look->hash, 64 + index * SIDES + (uint32_t)i) - 0.5);
		/* the texture is mirrored half way round: no seam */
		double u = 3.0 * fabs(1.0 - 2.0 * i / look->sides);
		out[i] = crown_vertex(sink, look, cos(turn) * shape->radius * rough, sin(turn) * shape->radius * rough,
			shape->level + lift, shape->slope, u);
	}
}

/* high[i] stands between low[i] and the next one. */
static void join_rings(struct mesh_sink *sink, int sides, const uint32_t *low, const uint32_t *high)
{
	for (int i = 0; i < sides; i++) {
		int k = (i + 1) % sides;
		mesh_add_triangle(sink, PKG_PASS_OPAQUE, low[i], low[k], high[i]);
		mesh_add_triangle(sink, PKG_PASS_OPAQUE, low[k], high[k], high[i]);
	}
}

static void close_ring(struct mesh_sink *sink, int sides, const uint32_t *ring, uint32_t apex, bool top)
{
	for (int i = 0; i < sides; i++) {
		int k = (i + 1) % sides;
		mesh_add_triangle(sink, PKG_PASS_OPAQUE, ring[top ? i : k], ring[top ? k : i], apex);
	}
}

/* Three body shapes by the tree's hash: broad, round, tall. */
static void add_leaf_crown(struct mesh_sink *sink, const struct tree_look *look)
{
	static const struct ring_shape shapes[3][2] = {
		{ { 0.98, 0.27, -0.25 }, { 0.80, 0.78, 0.80 } },
		{ { 0.94, 0.30, -0.30 }, { 0.76, 0.80, 0.85 } },
		{ { 0.88, 0.26, -0.20 }, { 0.66, 0.76, 0.70 } },
	};
	const struct ring_shape *shape = shapes[(look->hash >> 8) % 3];
	uint32_t rings[2][SIDES];
	uint32_t low = crown_vertex(sink, look, 0.0, 0.0, 0.0, -1.0, 1.5);
	for (uint32_t i = 0; i < 2; i++)
		add_ring(sink, look, &shape[i], i, rings[i]);
	double lean = 0.2 * (roll(look->hash, 3) - 0.5);
	uint32_t top = crown_vertex(sink, look, lean, -lean, 0.98, 1.0, 1.5);
	close_ring(sink, look->sides, rings[0], low, false);
	join_rings(sink, look->sides, rings[0], rings[1]);
	close_ring(sink, look->sides, rings[1], top, true);
}

static void add_needle_crown(struct mesh_sink *sink, const struct tree_look *look)
{
	static const struct ring_shape tiers[2] = { { 1.0, 0.04, 0.3 }, { 0.7, 0.42, 0.4 } };
	static const double tops[2] = { 0.74, 1.0 };
	for (uint32_t i = 0; i < 2; i++) {
		uint32_t ring[SIDES];
		add_ring(sink, look, &tiers[i], i, ring);
		uint32_t low = crown_vertex(sink, look, 0.0, 0.0, tiers[i].level + 0.06, -1.0, 1.5);
		uint32_t top = crown_vertex(sink, look, 0.0, 0.0, tops[i], 1.0, 1.5);
		close_ring(sink, look->sides, ring, low, false);
		close_ring(sink, look->sides, ring, top, true);
	}
}

/* Three sides from the ground into the crown. */
static void add_trunk(struct mesh_sink *sink, const struct tree_look *look)
{
	enum { TRUNK_SIDES = 3 };
	double top = look->crown_low + (look->height - look->crown_low) * 0.25;
	double radius = 0.1 + 0.016 * look->height, twist = roll(look->hash, 2) * 2.0;
	uint32_t ring[2][TRUNK_SIDES];
	for (int end = 0; end < 2; end++)
		for (int i = 0; i < TRUNK_SIDES; i++) {
			double turn = twist + 2.0 * BLVD_PI * i / TRUNK_SIDES, r = end ? radius * 0.6 : radius;
			struct mesh_vertex vertex = {
				.at = { look->foot.x + cos(turn) * r, look->foot.y + sin(turn) * r,
					look->foot.z + (end ? top : -0.25) },
				.normal = { (float)cos(turn), (float)sin(turn), 0.0f },
				.u = (float)i / TRUNK_SIDES,
				.v = end ? (float)top : 0.0f,
				.ao = end ? 0.6f : 0.8f,
				.material = MATERIAL_BARK,
				.rgb = { 255, 255, 255 },
			};
			ring[end][i] = mesh_add_vertex(sink, &vertex);
		}
	for (int i = 0; i < TRUNK_SIDES; i++) {
		int k = (i + 1) % TRUNK_SIDES;
		mesh_add_triangle(sink, PKG_PASS_OPAQUE, ring[0][i], ring[0][k], ring[1][k]);
		mesh_add_triangle(sink, PKG_PASS_OPAQUE, ring[0][i], ring[1][k], ring[1][i]);
	}
}

static uint8_t shade(double base, double factor)
{
	return (uint8_t)lrint(fmin(fmax(base * factor, 0.0), 255.0));
}

static void add_tree(struct mesh_sink *sink, const struct ground_plan *plan, const struct tree_place *place)
{
	const struct tree *tree = &place->tree;
	const struct city *city = plan->city;
	struct tree_look look = { .needle = tree->needle, .inside = place->inside };
	look.sides = ground_near_street(plan, tree->at, STREET_SIDE_M) ? SIDES : FAR_SIDES;
	look.hash =
		hash_u64((uint64_t)llround(tree->at.x * 100.0) * UINT64_C(1000003) ^ (uint64_t)llround(tree->at.y * 100.0));
	look.foot = (struct dvec3){ tree->at.x, tree->at.y, city_ground(city, tree->at) + KERB_M };
	look.height = tree->height_m > 1.0f ? fmin((double)tree->height_m, 40.0) : 9.0;
	look.height *= 0.92 + 0.16 * roll(look.hash, 5);
	look.crown_radius = tree->crown_radius_m > 0.3f ? fmin((double)tree->crown_radius_m, 12.0) : look.height * 0.32;
	look.crown_low = look.needle ? look.height * 0.12 : fmin(fmax(look.height * 0.27, 1.9), look.height * 0.5);
	/* plane, lime, maple, chestnut */
	static const double tones[4][3] = { { 250, 246, 232 }, { 244, 250, 206 }, { 255, 240, 196 }, { 222, 238, 220 } };
	const double *tone = tones[(look.hash >> 16) % 4];
	double warm = roll(look.hash, 6) - 0.5, bright = 0.92 + 0.12 * roll(look.hash, 7);
	look.rgb[0] = shade(tone[0] + 16.0 * warm, bright);
	look.rgb[1] = shade(tone[1], bright);
	look.rgb[2] = shade(tone[2] - 16.0 * warm, bright);
	if (look.needle)
		add_needle_crown(sink, &look);
	else
		add_leaf_crown(sink, &look);
	if (!look.inside)
		add_trunk(sink, &look);
}

/* ---- where they stand ---- */

static bool may_stand(const struct ground_plan *plan, struct dvec2 at, double clearance)
{
	return !ground_on_any_road(plan, at, clearance) && !ground_in_building(plan, at) &&
		   !ground_area_at(plan, at, REGION_WATER);
}

static void place_tree(tree_array *trees, const struct tree *tree, bool inside)
{
	ARRAY_PUSH(trees,
		(struct tree_place){ *tree, (int32_t)floor(tree->at.y / CELL_M), (int32_t)floor(tree->at.x / CELL_M), inside });
}

/* A tree that the data puts into a street stood beside it: it is moved to the kerb, if it fits there. */
static void place_mapped(const struct ground_plan *plan, tree_array *trees, const struct tree *tree)
{
	struct tree moved = *tree;
	for (int ring = 0; ring < 5; ring++)
		for (int turn = 0; turn < (ring ? 8 : 1); turn++) {
			double angle = BLVD_PI / 4.0 * turn, reach = 0.8 * ring;
			moved.at = (struct dvec2){ tree->at.x + reach * cos(angle), tree->at.y + reach * sin(angle) };
			if (!may_stand(plan, moved.at, 0.4))
				continue;
			place_tree(trees, &moved, false);
			return;
		}
}

static double planting_step(const struct ground_area *area)
{
	if (area->region == REGION_FOREST)
		return 8.5;
	if (area->region == REGION_PARK)
		return area->area->kind == AREA_CEMETERY ? 22.0 : 15.0;
	return 0.0;
}

static bool inside_forest(const struct ground_plan *plan, const struct ground_area *area, struct dvec2 at)
{
	static const double reach[4][2] = { { FOREST_EDGE_M, 0 }, { -FOREST_EDGE_M, 0 }, { 0, FOREST_EDGE_M },
		{ 0, -FOREST_EDGE_M } };
	for (int i = 0; i < 4; i++) {
		struct dvec2 there = { at.x + reach[i][0], at.y + reach[i][1] };
		if (ground_on_any_road(plan, there, 4.0) || ground_top_area(plan, there) != area)
			return false;
	}
	return true;
}

static void plant_at(
	const struct ground_plan *plan, tree_array *trees, const struct ground_area *area, struct dvec2 at, uint64_t hash)
{
	if (at.x < plan->min.x || at.x > plan->max.x || at.y < plan->min.y || at.y > plan->max.y ||
		ground_top_area(plan, at) != area || !may_stand(plan, at, 2.0) || ground_on_path(plan, at, 0.9))
		return;
	bool forest = area->region == REGION_FOREST, inside = forest && inside_forest(plan, area, at);
	if (inside && roll(hash, 12) > FOREST_INSIDE_SHARE)
		return;
	struct tree tree = { .at = at };
	tree.needle = roll(hash, 10) < (forest ? 0.25 : 0.08);
	tree.height_m = (float)((forest ? 10.0 : 8.0) + 7.0 * roll(hash, 11));
	tree.crown_radius_m = tree.height_m * (tree.needle ? 0.22f : 0.33f) * (inside ? 1.4f : 1.0f);
	place_tree(trees, &tree, inside);
}

/* A jittered grid over the area's box, the same grid for all areas. */
static void plant(const struct ground_plan *plan, tree_array *trees, const struct ground_area *area, double step)
{
	struct dvec2 min = { fmax(area->min.x, plan->min.x), fmax(area->min.y, plan->min.y) };
	struct dvec2 max = { fmin(area->max.x, plan->max.x), fmin(area->max.y, plan->max.y) };
	for (int64_t row = (int64_t)floor(min.y / step); (double)row * step < max.y; row++)
		for (int64_t col = (int64_t)floor(min.x / step); (double)col * step < max.x; col++) {
			uint64_t hash = hash_u64((uint64_t)row * UINT64_C(0x100000001B3) ^ (uint64_t)col);
			struct dvec2 at = { ((double)col + 0.15 + 0.7 * roll(hash, 8)) * step,
				((double)row + 0.15 + 0.7 * roll(hash, 9)) * step };
			plant_at(plan, trees, area, at, hash);
		}
}

/* Sparser everywhere when the woods are large. */
static double planting_stretch(const struct ground_plan *plan)
{
	double wanted = 0.0;
	for (size_t i = 0; i < plan->areas.count; i++) {
		const struct ground_area *area = &plan->areas.items[i];
		double step = planting_step(area);
		double width = fmin(area->max.x, plan->max.x) - fmax(area->min.x, plan->min.x);
		double height = fmin(area->max.y, plan->max.y) - fmax(area->min.y, plan->min.y);
		if (step > 0.0 && width > 0.0 && height > 0.0)
			wanted += fmin(area->size_m2, width * height) / (step * step);
	}
	return wanted > PLANTED_MAX ? sqrt(wanted / PLANTED_MAX) : 1.0;
}

static int compare_places(const void *left, const void *right)
{
	const struct tree_place *a = left, *b = right;
	if (a->row != b->row)
		return a->row < b->row ? -1 : 1;
	if (a->col != b->col)
		return a->col < b->col ? -1 : 1;
	if (a->tree.at.y != b->tree.at.y)
		return a->tree.at.y < b->tree.at.y ? -1 : 1;
	return (a->tree.at.x > b->tree.at.x) - (a->tree.at.x < b->tree.at.x);
}

void trees_build(const struct city *city, const struct pkg_graph *graph, struct mesh_sink *sink)
{
	struct ground_plan plan;
	ground_plan_build(&plan, city, graph);
	tree_array trees = { 0 };
	for (size_t i = 0; i < city->trees.count; i++)
		place_mapped(&plan, &trees, &city->trees.items[i]);
	double stretch = planting_stretch(&plan);
	for (size_t i = 0; i < plan.areas.count; i++)
		if (planting_step(&plan.areas.items[i]) > 0.0)
			plant(&plan, &trees, &plan.areas.items[i], planting_step(&plan.areas.items[i]) * stretch);
	if (trees.count)
		qsort(trees.items, trees.count, sizeof(*trees.items), compare_places);
	for (size_t from = 0, to; from < trees.count; from = to) {
		mesh_begin(sink, &(struct mesh_object){ .kind = PKG_OBJECT_TREE, .face = PKG_NONE });
		for (to = from; to < trees.count && trees.items[to].row == trees.items[from].row &&
						trees.items[to].col == trees.items[from].col;
			 to++)
			add_tree(sink, &plan, &trees.items[to]);
		mesh_end(sink);
	}
	ARRAY_FINISH(&trees);
	ground_plan_finish(&plan);
}
