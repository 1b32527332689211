/* The ground covers every tile once, paint lies on carriageways, nothing stands in one, terrain is followed exactly,
 * and the same city gives the same bytes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "make_city.h"

struct fixture {
	struct report report;
	struct city city;
	struct graph_data graph;
	struct mesh_chunks mesh;
	lamp_array lamps;
};

static void finish(struct fixture *f)
{
	mesh_chunks_finish(&f->mesh);
	ARRAY_FINISH(&f->lamps);
	graph_data_finish(&f->graph);
	city_finish(&f->city);
}

static struct area *add_area(struct city *city, enum area_kind kind, double x0, double y0, double x1, double y1)
{
	struct area area = { .id = (int64_t)city->areas.count + 1, .kind = kind };
	struct ring *ring = &area.shape.outer;
	ring->points = POOL_ARRAY(&city->pool, struct dvec2, 4);
	ring->count = 4;
	ring->points[0] = (struct dvec2){ x0, y0 };
	ring->points[1] = (struct dvec2){ x1, y0 };
	ring->points[2] = (struct dvec2){ x1, y1 };
	ring->points[3] = (struct dvec2){ x0, y1 };
	ARRAY_PUSH(&city->areas, area);
	return &city->areas.items[city->areas.count - 1];
}

static void add_building(struct city *city, double x0, double y0, double x1, double y1)
{
	struct building building = {
		.id = (int64_t)city->buildings.count + 1000, .outline = PKG_NONE, .height_m = 15.0, .face = PKG_NONE
	};
	struct ring *ring = &building.footprint.outer;
	ring->points = POOL_ARRAY(&city->pool, struct dvec2, 4);
	ring->count = 4;
	ring->points[0] = (struct dvec2){ x0, y0 };
	ring->points[1] = (struct dvec2){ x1, y0 };
	ring->points[2] = (struct dvec2){ x1, y1 };
	ring->points[3] = (struct dvec2){ x0, y1 };
	ARRAY_PUSH(&city->buildings, building);
}

/* A main street with a crossing and signals, a side street, a river with a bridge, a park, houses. */
static void small_town(struct fixture *f)
{
	city_start(&f->city, &f->report);
	f->city.min = (struct dvec2){ -200, -200 };
	f->city.max = (struct dvec2){ 200, 200 };
	struct way *main_street = city_street(
		&f->city, 1, 4, (const double[][3]){ { 1, -190, -40 }, { 2, 0, -40 }, { 3, 60, -38 }, { 4, 190, 10 } });
	main_street->street_class = PKG_STREET_SECONDARY;
	main_street->lanes_forward = main_street->lanes_backward = 2;
	main_street->width_m = 13.0;
	main_street->sidewalk_left = main_street->sidewalk_right = true;
	main_street->nodes[1].flags = PKG_NODE_SIGNALS;
	main_street->nodes[2].flags = PKG_NODE_CROSSING;
	struct way *side = city_street(&f->city, 2, 2, (const double[][3]){ { 2, 0, -40 }, { 5, 10, -190 } });
	side->sidewalk_left = true;
	side->lit = true;
	city_street(&f->city, 3, 2, (const double[][3]){ { 2, 0, -40 }, { 6, 0, 40 } });
	struct way *bridge = city_street(&f->city, 4, 2, (const double[][3]){ { 6, 0, 40 }, { 7, 0, 110 } });
	bridge->bridge = true;
	bridge->layer = 1;
	city_street(&f->city, 5, 2, (const double[][3]){ { 7, 0, 110 }, { 8, 5, 190 } });
	struct way *path =
		city_street(&f->city, 6, 3, (const double[][3]){ { 0, -150, -120 }, { 0, -60, -150 }, { 0, -20, -60 } });
	path->drivable = false;
	path->street_class = WAY_FOOT;
	path->width_m = 2.0;
	add_area(&f->city, AREA_WATER, -400, 50, 400, 100);
	add_area(&f->city, AREA_PARK, -180, -180, -20, -60);
	for (int i = 0; i < 8; i++)
		add_building(&f->city, -180 + 44 * i, -30, -150 + 44 * i, -12 + (i > 4 ? 40 : 0));
}

static void hills(struct fixture *f)
{
	struct pkg_height_grid *grid = &f->city.terrain.grid;
	*grid = (struct pkg_height_grid){ .origin_mm = { -700000, -710000 }, .step_mm = 30000, .columns = 48, .rows = 48 };
	f->city.terrain.height_mm = array_grow(NULL, &(size_t){ 0 }, 48 * 48, sizeof(int32_t));
	for (int row = 0; row < 48; row++)
		for (int col = 0; col < 48; col++)
			f->city.terrain.height_mm[row * 48 + col] =
				(int32_t)(20000.0 + 4000.0 * sin(col * 0.4) * cos(row * 0.3) + 60.0 * col);
}

static void build(struct fixture *f)
{
	graph_build(&f->city, &f->graph);
	struct pkg_graph graph = graph_view(&f->graph);
	struct mesh_sink *sink = mesh_sink_new();
	ground_build(&f->city, &graph, sink, &f->lamps);
	trees_build(&f->city, &graph, sink);
	mesh_finish_chunks(sink, &f->mesh);
	mesh_sink_free(sink);
}

struct triangle {
	struct dvec3 at[3];
	const struct pkg_mesh_vertex *vertex[3];
	const struct pkg_object *object;
	enum pkg_pass pass;
};

typedef void (*visit_fn)(struct fixture *f, const struct triangle *triangle, void *context);

static void visit_triangles(struct fixture *f, visit_fn visit, void *context)
{
	for (size_t i = 0; i < f->mesh.objects.count; i++) {
		const struct pkg_object *object = &f->mesh.objects.items[i];
		const struct pkg_chunk *chunk = &f->mesh.chunks.items[object->chunk];
		const struct pkg_mesh_vertex *vertices = (const void *)(f->mesh.geometry.items + chunk->vertex_offset);
		const uint16_t *indices = (const void *)(f->mesh.geometry.items + chunk->index_offset);
		for (int pass = 0; pass < PKG_PASS_COUNT; pass++)
			for (uint32_t k = 0; k < object->index_count[pass]; k += 3) {
				struct triangle triangle = { .object = object, .pass = (enum pkg_pass)pass };
				for (uint32_t c = 0; c < 3; c++) {
					const struct pkg_mesh_vertex *vertex = vertices + indices[object->first_index[pass] + k + c];
					triangle.vertex[c] = vertex;
					triangle.at[c] = (struct dvec3){ (vertex->pos_mm[0] + (double)chunk->origin_mm[0]) / 1000.0,
						(vertex->pos_mm[1] + (double)chunk->origin_mm[1]) / 1000.0,
						(vertex->pos_mm[2] + (double)chunk->origin_mm[2]) / 1000.0 };
				}
				visit(f, &triangle, context);
			}
	}
}

static double plan_area(const struct triangle *t)
{
	return ((t->at[1].x - t->at[0].x) * (t->at[2].y - t->at[0].y) -
			   (t->at[2].x - t->at[0].x) * (t->at[1].y - t->at[0].y)) /
		   2.0;
}

#define TILES 9 /* -512 to 640 m: the town's ground and a margin */

struct coverage {
	double area[TILES][TILES];
};

static void add_coverage(struct fixture *f, const struct triangle *t, void *context)
{
	(void)f;
	struct coverage *coverage = context;
	bool ground = t->object->kind == PKG_OBJECT_GROUND || t->object->kind == PKG_OBJECT_WATER;
	double x = (t->at[0].x + t->at[1].x + t->at[2].x) / 3.0, y = (t->at[0].y + t->at[1].y + t->at[2].y) / 3.0;
	int col = (int)floor(x / MESH_TILE_M) + 4, row = (int)floor(y / MESH_TILE_M) + 4;
	if (!ground || t->pass != PKG_PASS_OPAQUE || col < 0 || row < 0 || col >= TILES || row >= TILES)
		return;
	double area = plan_area(t);
	assert_true(area >= -1e-3); /* nothing on the ground faces down */
	coverage->area[row][col] += area;
}

static void check_coverage(struct fixture *f)
{
	struct coverage coverage = { 0 };
	visit_triangles(f, add_coverage, &coverage);
	double whole = MESH_TILE_M * MESH_TILE_M;
	for (int row = 1; row < 7; row++)
		for (int col = 1; col < 7; col++)
			if (fabs(coverage.area[row][col] - whole) > whole * 1e-3)
				fail_msg("tile %d %d: %.1f m2 of %.1f", col, row, coverage.area[row][col], whole);
}

static void ground_covers_every_tile_once(void **state)
{
	(void)state;
	for (int terrain = 0; terrain < 2; terrain++) {
		struct fixture f = { 0 };
		small_town(&f);
		if (terrain)
			hills(&f);
		build(&f);
		check_coverage(&f);
		assert_int_equal(f.report.faults[FAULT_BAD_GEOMETRY][FAULT_DROPPED], 0);
		finish(&f);
	}
}

/* Distance to the nearest drivable way, less half its width: negative inside. */
static double outside_carriageway(const struct city *city, struct dvec2 at)
{
	double nearest = INFINITY;
	for (size_t i = 0; i < city->ways.count; i++) {
		const struct way *way = &city->ways.items[i];
		for (size_t k = 0; way->drivable && k + 1 < way->node_count; k++) {
			struct dvec2 a = way->nodes[k].at, d = dvec2_sub(way->nodes[k + 1].at, a), p = dvec2_sub(at, a);
			double t = fmin(fmax(dvec2_dot(p, d) / dvec2_dot(d, d), 0.0), 1.0);
			nearest = fmin(nearest, dvec2_length(dvec2_sub(p, dvec2_scale(d, t))) - way->width_m / 2.0);
		}
	}
	return nearest;
}

struct counts {
	size_t paint, crossing;
};

static void check_paint(struct fixture *f, const struct triangle *t, void *context)
{
	struct counts *counts = context;
	if (t->pass != PKG_PASS_DECAL || t->vertex[0]->material != MATERIAL_MARKING)
		return;
	counts->paint++;
	for (int c = 0; c < 3; c++)
		assert_true(outside_carriageway(&f->city, (struct dvec2){ t->at[c].x, t->at[c].y }) < 0.02);
	counts->crossing += fabs(t->at[0].x - 60.0) < 2.5 && fabs(t->at[0].y + 38.0) < 7.0;
}

static void paint_lies_on_carriageways(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	small_town(&f);
	build(&f);
	struct counts counts = { 0 };
	visit_triangles(&f, check_paint, &counts);
	assert_true(counts.paint > 50);
	assert_true(counts.crossing >= 16); /* a zebra of eight bars and more */
	finish(&f);
}

static void lamps_hang_above_the_street(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	small_town(&f);
	build(&f);
	assert_true(f.lamps.count > 5);
	for (size_t i = 0; i < f.lamps.count; i++)
		assert_true(f.lamps.items[i].at.z > 3.0 && isfinite(f.lamps.items[i].at.x));
	finish(&f);
}

static void check_foot(struct fixture *f, const struct triangle *t, void *context)
{
	size_t *feet = context;
	bool furniture = t->object->kind == PKG_OBJECT_FURNITURE, tree = t->object->kind == PKG_OBJECT_TREE;
	for (int c = 0; c < 3 && (furniture || tree); c++) {
		struct dvec2 at = { t->at[c].x, t->at[c].y };
		if (t->at[c].z > city_ground(&f->city, at) + 0.5 || fabs(at.x) < 12.0)
			continue; /* not its foot; or on the bridge */
		(*feet)++;
		assert_true(outside_carriageway(&f->city, at) > 0.0);
	}
}

static void nothing_stands_in_a_carriageway(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	small_town(&f);
	for (int i = 0; i < 40; i++) /* trees that the data puts into the main street */
		ARRAY_PUSH(
			&f.city.trees, (struct tree){ .at = { -180.0 + 4.0 * i, -34.5 }, .height_m = 8.0f, .from_data = true });
	build(&f);
	size_t feet = 0;
	visit_triangles(&f, check_foot, &feet);
	assert_true(feet > 300);
	finish(&f);
}

static void check_terrain(struct fixture *f, const struct triangle *t, void *context)
{
	double *worst = context;
	uint8_t material = t->vertex[0]->material;
	bool floor_or_paint =
		material == MATERIAL_ASPHALT || material == MATERIAL_ASPHALT_OLD || material == MATERIAL_MARKING;
	if (t->object->kind != PKG_OBJECT_GROUND || !floor_or_paint)
		return;
	/* the corners and the middle: a plane that meets the terrain in all of them lies on it */
	struct dvec3 middle = { (t->at[0].x + t->at[1].x + t->at[2].x) / 3.0, (t->at[0].y + t->at[1].y + t->at[2].y) / 3.0,
		(t->at[0].z + t->at[1].z + t->at[2].z) / 3.0 };
	*worst = fmax(*worst, fabs(middle.z - city_ground(&f->city, (struct dvec2){ middle.x, middle.y })));
	for (int c = 0; c < 3; c++)
		*worst = fmax(*worst, fabs(t->at[c].z - city_ground(&f->city, (struct dvec2){ t->at[c].x, t->at[c].y })));
}

static void streets_and_paint_lie_on_the_terrain(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	small_town(&f);
	hills(&f);
	build(&f);
	double worst = 0.0;
	visit_triangles(&f, check_terrain, &worst);
	assert_true(worst > 0.0 && worst < 0.004);
	finish(&f);
}

/* What lies straight above and below a place. */
struct column {
	struct dvec2 at;
	double ground, deck, road_below, ceiling; /* NAN: none */
};

static bool covers(const struct triangle *t, struct dvec2 at)
{
	int left = 0, right = 0;
	for (int c = 0; c < 3; c++) {
		struct dvec3 a = t->at[c], b = t->at[(c + 1) % 3];
		double side = (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
		left += side > 0.0;
		right += side < 0.0;
	}
	return left == 3 || right == 3;
}

static void probe(struct fixture *f, const struct triangle *t, void *context)
{
	(void)f;
	struct column *column = context;
	if (t->pass != PKG_PASS_OPAQUE || fabs(plan_area(t)) < 1e-6 || !covers(t, column->at))
		return;
	bool up = plan_area(t) > 0.0;
	double z = (t->at[0].z + t->at[1].z + t->at[2].z) / 3.0;
	if (t->object->kind == PKG_OBJECT_GROUND && up)
		column->ground = z;
	else if (t->object->kind == PKG_OBJECT_BRIDGE && up)
		column->deck = fmax(z, isnan(column->deck) ? z : column->deck);
	else if (t->object->kind == PKG_OBJECT_TUNNEL)
		*(up ? &column->road_below : &column->ceiling) = z;
}

static struct column probe_at(struct fixture *f, double x, double y)
{
	struct column column = { { x, y }, NAN, NAN, NAN, NAN };
	visit_triangles(f, probe, &column);
	return column;
}

/* A street dives under another: open ramps on both sides, a closed tube in the middle, never soil in the way. */
static void a_tunnel_opens_the_ground_only_over_its_ramps(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	city_start(&f.city, &f.report);
	f.city.min = (struct dvec2){ -400, -100 };
	f.city.max = (struct dvec2){ 400, 100 };
	city_street(&f.city, 1, 2, (const double[][3]){ { 1, -390, 0.3 }, { 2, -20, 0.3 } });
	struct way *tunnel = city_street(&f.city, 2, 2, (const double[][3]){ { 2, -20, 0.3 }, { 3, 20, 0.3 } });
	tunnel->tunnel = true;
	tunnel->layer = -1;
	city_street(&f.city, 3, 2, (const double[][3]){ { 3, 20, 0.3 }, { 4, 390, 0.3 } });
	city_street(&f.city, 4, 2, (const double[][3]){ { 5, 0.2, -90 }, { 6, 0.2, 90 } });
	build(&f);
	struct column middle = probe_at(&f, 0.7, 0.8), ramp = probe_at(&f, -60.3, 0.8), away = probe_at(&f, -360.3, 0.8);
	assert_true(fabs(middle.ground) < 0.01 && middle.road_below < -5.0 && middle.ceiling > middle.road_below + 4.0 &&
				middle.ceiling < -0.1);
	assert_true(isnan(ramp.ground) && ramp.road_below < -0.5 && isnan(ramp.ceiling));
	assert_true(fabs(away.ground) < 0.01 && isnan(away.road_below));
	/* seen from above there is ground or a street everywhere along it */
	for (double x = -300.1; x < 300.0; x += 3.0) {
		struct column at = probe_at(&f, x, 1.1);
		assert_true(!isnan(at.ground) || !isnan(at.road_below));
	}
	finish(&f);
}

static void a_bridge_carries_its_street_over_the_river(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	small_town(&f);
	build(&f);
	struct column river = probe_at(&f, 0.4, 75.3), bank = probe_at(&f, 0.4, 20.3);
	assert_true(river.deck > -0.05 && isnan(river.ground)); /* water is no ground object */
	assert_true(isnan(bank.deck) && fabs(bank.ground) < 0.01);
	for (double y = 35.1; y < 115.0; y += 0.5) {
		struct column at = probe_at(&f, 0.4, y);
		assert_true(fmax(isnan(at.deck) ? -9.0 : at.deck, isnan(at.ground) ? -9.0 : at.ground) > -0.05);
	}
	finish(&f);
}

static void same_city_same_bytes(void **state)
{
	(void)state;
	struct fixture f[2] = { 0 };
	for (int i = 0; i < 2; i++) {
		small_town(&f[i]);
		build(&f[i]);
	}
	assert_int_equal(f[0].mesh.geometry.count, f[1].mesh.geometry.count);
	assert_memory_equal(f[0].mesh.geometry.items, f[1].mesh.geometry.items, f[0].mesh.geometry.count);
	finish(&f[0]);
	finish(&f[1]);
}

static void dirty_areas_and_streets_do_no_harm(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	small_town(&f);
	/* a bow tie, a needle, areas that share borders and corners, a street over itself */
	struct area *bow = add_area(&f.city, AREA_GRASS, 60, -180, 120, -120);
	struct dvec2 swap = bow->shape.outer.points[2];
	bow->shape.outer.points[2] = bow->shape.outer.points[3];
	bow->shape.outer.points[3] = swap;
	add_area(&f.city, AREA_SAND, 60, -120, 180, -119.999);
	add_area(&f.city, AREA_PITCH, 60, -180, 120, -120);
	add_area(&f.city, AREA_WATER, -128, -128, 128, 0);
	city_street(
		&f.city, 50, 4, (const double[][3]){ { 0, 100, -60 }, { 0, 150, -60 }, { 0, 120, -60 }, { 0, 130, -59.99 } });
	build(&f);
	check_coverage(&f);
	finish(&f);
}

static void a_city_without_streets_is_ground_all_over(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	city_start(&f.city, &f.report);
	f.city.min = (struct dvec2){ -200, -200 };
	f.city.max = (struct dvec2){ 200, 200 };
	build(&f);
	check_coverage(&f);
	finish(&f);
}

static void light_map_is_darker_in_a_courtyard(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	city_start(&f.city, &f.report);
	f.city.min = (struct dvec2){ -100, -100 };
	f.city.max = (struct dvec2){ 100, 100 };
	add_building(&f.city, -20, -20, 20, -8);
	add_building(&f.city, -20, 8, 20, 20);
	add_building(&f.city, -20, -8, -8, 8);
	add_building(&f.city, 8, -8, 20, 8);
	ARRAY_PUSH(&f.lamps, (struct lamp){ { 60, 60, 8 }, 15.0f });
	struct light_map map;
	light_map_bake(&f.city, &f.lamps, &map);
	const struct pkg_light_map *h = &map.header;
	size_t col = (size_t)(-h->origin_mm[0]) / h->texel_mm, row = (size_t)(-h->origin_mm[1]) / h->texel_mm;
	size_t courtyard = row * h->width + col, open = (row + 40) * h->width + col + 40;
	size_t lamp =
		(size_t)(60000 - h->origin_mm[1]) / h->texel_mm * h->width + (size_t)(60000 - h->origin_mm[0]) / h->texel_mm;
	assert_true(map.texels[2 * courtyard] + 60 < map.texels[2 * open]);
	assert_true(map.texels[2 * open] > 245);
	assert_true(map.texels[2 * lamp + 1] > 120);
	assert_int_equal(map.texels[2 * courtyard + 1], 0);
	light_map_finish(&map);
	finish(&f);
}

struct kind_count {
	uint64_t triangles[PKG_OBJECT_FURNITURE + 1];
};

static void count_kind(struct fixture *f, const struct triangle *t, void *context)
{
	(void)f;
	struct kind_count *count = context;
	count->triangles[t->object->kind]++;
}

static void trees_and_lamps_are_lean(void **state)
{
	(void)state;
	struct fixture f = { 0 };
	city_start(&f.city, &f.report);
	f.city.min = (struct dvec2){ -200, -200 };
	f.city.max = (struct dvec2){ 200, 200 };
	city_street(&f.city, 1, 2, (const double[][3]){ { 1, -190, 0 }, { 2, 190, 0 } })->lit = true;
	enum { TREES = 30 };
	for (int i = 0; i < TREES; i++)
		ARRAY_PUSH(&f.city.trees,
			(struct tree){
				.at = { -150.0 + 10.0 * i, 12.0 }, .height_m = 8.0f, .from_data = true, .needle = i % 4 == 0 });
	build(&f);
	struct kind_count count = { 0 };
	visit_triangles(&f, count_kind, &count);
	assert_true(count.triangles[PKG_OBJECT_TREE] >= TREES * 20 && count.triangles[PKG_OBJECT_TREE] <= TREES * 48);
	assert_true(f.lamps.count > 5 && count.triangles[PKG_OBJECT_FURNITURE] <= f.lamps.count * 32);
	finish(&f);
}

static void ground_spends_no_triangles_on_what_is_hidden(void **state)
{
	(void)state;
	uint64_t triangles[2];
	for (int hidden = 0; hidden < 2; hidden++) {
		struct fixture f = { 0 };
		city_start(&f.city, &f.report);
		f.city.min = (struct dvec2){ -200, -200 };
		f.city.max = (struct dvec2){ 200, 200 };
		add_area(&f.city, AREA_PARK, -100, -100, 100, 100);
		for (int i = 0; hidden && i < 9; i++) /* parks in the park */
			add_area(&f.city, AREA_PARK, -90 + 20 * i, -80, -75 + 20 * i, 80);
		build(&f);
		check_coverage(&f);
		struct kind_count count = { 0 };
		visit_triangles(&f, count_kind, &count);
		triangles[hidden] = count.triangles[PKG_OBJECT_GROUND];
		finish(&f);
	}
	assert_int_equal(triangles[0], triangles[1]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ground_covers_every_tile_once),
		cmocka_unit_test(paint_lies_on_carriageways),
		cmocka_unit_test(lamps_hang_above_the_street),
		cmocka_unit_test(nothing_stands_in_a_carriageway),
		cmocka_unit_test(streets_and_paint_lie_on_the_terrain),
		cmocka_unit_test(a_tunnel_opens_the_ground_only_over_its_ramps),
		cmocka_unit_test(a_bridge_carries_its_street_over_the_river),
		cmocka_unit_test(same_city_same_bytes),
		cmocka_unit_test(dirty_areas_and_streets_do_no_harm),
		cmocka_unit_test(a_city_without_streets_is_ground_all_over),
		cmocka_unit_test(trees_and_lamps_are_lean),
		cmocka_unit_test(ground_spends_no_triangles_on_what_is_hidden),
		cmocka_unit_test(light_map_is_darker_in_a_courtyard),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
