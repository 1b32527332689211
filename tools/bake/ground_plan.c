/* The plan of the ground: roads, areas and buildings by place, and how densely a neighbourhood is built. */
#include "tools/bake/ground.h"

#include <math.h>
#include <stdlib.h>

#include "tools/city/graph.h"

#define MARGIN_M 260.0 /* of ground beyond the city's bounds */
#define BUILDING_BIN_M 32.0
#define SEGMENT_BIN_M 16.0
#define COVERAGE_STEP_M 32.0
#define BUILT_UP_SHARE 0.07 /* of the ground under buildings: sidewalks, lamps */
#define PAVED_SHARE 0.24    /* courtyards; less are gardens */
#define SMALL_BLOCK_M2 2500.0
#define LARGE_BLOCK_M2 400000.0
#define POND_M2 2500.0
#define HEADROOM_M 3.0           /* under a higher deck things may stand */
#define FLAT_WATER_SPREAD_M 25.0 /* a shore that varies more is a river in the hills, and follows the ground */

const struct region_look region_looks[REGION_COUNT] = {
	[REGION_VOID] = { MATERIAL_SOIL, 0.0, { 255, 255, 255 } },
	[REGION_PIT] = { MATERIAL_SOIL, -PIT_DROP_M, { 230, 228, 224 } },
	[REGION_ROAD] = { MATERIAL_ASPHALT, 0.0, { 255, 255, 255 } },
	[REGION_ROAD_OLD] = { MATERIAL_ASPHALT_OLD, 0.0, { 255, 255, 255 } },
	[REGION_ROAD_COBBLE] = { MATERIAL_COBBLE, 0.0, { 255, 255, 255 } },
	[REGION_ROAD_GRAVEL] = { MATERIAL_GRAVEL, 0.0, { 255, 255, 255 } },
	[REGION_SIDEWALK] = { MATERIAL_PAVING, KERB_M, { 255, 255, 255 } },
	[REGION_CYCLE] = { MATERIAL_ASPHALT_OLD, KERB_M, { 255, 236, 226 } },
	[REGION_PATH] = { MATERIAL_PAVING, KERB_M, { 255, 255, 255 } },
	[REGION_PATH_GRAVEL] = { MATERIAL_GRAVEL, KERB_M, { 255, 255, 255 } },
	[REGION_STEPS] = { MATERIAL_SQUARE, KERB_M, { 236, 234, 230 } },
	[REGION_PEDESTRIAN] = { MATERIAL_SQUARE, KERB_M, { 255, 255, 255 } },
	[REGION_RAIL] = { MATERIAL_BALLAST, KERB_M, { 255, 255, 255 } },
	[REGION_WATER] = { MATERIAL_WATER, -RIVER_DROP_M, { 255, 255, 255 } },
	[REGION_PARKING] = { MATERIAL_ASPHALT_OLD, 0.0, { 255, 255, 255 } },
	[REGION_PITCH] = { MATERIAL_PITCH, KERB_M, { 255, 255, 255 } },
	[REGION_SAND] = { MATERIAL_SAND, KERB_M, { 255, 255, 255 } },
	[REGION_ROCK] = { MATERIAL_ROCK, KERB_M, { 255, 255, 255 } },
	[REGION_GRASS] = { MATERIAL_GRASS, KERB_M, { 255, 255, 255 } },
	[REGION_PARK] = { MATERIAL_PARK, KERB_M, { 255, 255, 255 } },
	[REGION_FOREST] = { MATERIAL_FOREST, KERB_M, { 255, 255, 255 } },
	[REGION_FARM] = { MATERIAL_GRASS, KERB_M, { 255, 246, 222 } },
	[REGION_CONSTRUCTION] = { MATERIAL_SOIL, KERB_M, { 255, 250, 242 } },
	[REGION_RAILWAY] = { MATERIAL_BALLAST, KERB_M, { 244, 240, 232 } },
	[REGION_YARD] = { MATERIAL_YARD, KERB_M, { 255, 255, 255 } },
	[REGION_OPEN] = { MATERIAL_GRASS, KERB_M, { 252, 250, 238 } },
};

/* ---- buildings ---- */

static double footprint_area(const struct building *building)
{
	double area = fabs(ring_area(&building->footprint.outer));
	for (size_t i = 0; i < building->footprint.hole_count; i++)
		area -= fabs(ring_area(&building->footprint.holes[i]));
	return area;
}

static void blur_coverage(struct ground_plan *plan)
{
	int32_t cols = plan->coverage_cols, rows = plan->coverage_rows;
	float *from = plan->coverage;
	float *to = POOL_ARRAY(&plan->pool, float, (size_t)cols *(size_t)rows);
	for (int32_t row = 0; row < rows; row++)
		for (int32_t col = 0; col < cols; col++) {
			float sum = 0.0f, weights = 0.0f;
			for (int32_t dy = -2; dy <= 2; dy++)
				for (int32_t dx = -2; dx <= 2; dx++) {
					int32_t x = col + dx, y = row + dy;
					float weight = (float)((3 - abs(dx)) * (3 - abs(dy)));
					weights += weight;
					if (x >= 0 && y >= 0 && x < cols && y < rows)
						sum += weight * from[(size_t)y * (size_t)cols + (size_t)x];
				}
			to[(size_t)row * (size_t)cols + (size_t)col] = sum / weights;
		}
	plan->coverage = to;
}

static void measure_coverage(struct ground_plan *plan)
{
	plan->coverage_col0 = (int32_t)floor(plan->min.x / COVERAGE_STEP_M);
	plan->coverage_row0 = (int32_t)floor(plan->min.y / COVERAGE_STEP_M);
	plan->coverage_cols = (int32_t)floor(plan->max.x / COVERAGE_STEP_M) - plan->coverage_col0 + 1;
	plan->coverage_rows = (int32_t)floor(plan->max.y / COVERAGE_STEP_M) - plan->coverage_row0 + 1;
	plan->coverage = POOL_ARRAY(&plan->pool, float, (size_t)plan->coverage_cols *(size_t)plan->coverage_rows);
	const struct city *city = plan->city;
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct building *building = &city->buildings.items[i];
		if (building->is_part || building->footprint.outer.count < 3)
			continue;
		struct dvec2 min, max;
		ring_bounds(&building->footprint.outer, &min, &max);
		int32_t col = (int32_t)floor((min.x + max.x) / 2.0 / COVERAGE_STEP_M) - plan->coverage_col0;
		int32_t row = (int32_t)floor((min.y + max.y) / 2.0 / COVERAGE_STEP_M) - plan->coverage_row0;
		if (col >= 0 && row >= 0 && col < plan->coverage_cols && row < plan->coverage_rows)
			plan->coverage[(size_t)row * (size_t)plan->coverage_cols + (size_t)col] +=
				(float)(footprint_area(building) / (COVERAGE_STEP_M * COVERAGE_STEP_M));
	}
	blur_coverage(plan);
}

static void measure_blocks(struct ground_plan *plan)
{
	const struct pkg_graph *graph = plan->graph;
	if (!graph->face_count)
		return;
	plan->blocks = face_locator_new(graph);
	plan->block_share = POOL_ARRAY(&plan->pool, float, graph->face_count);
	for (size_t i = 0; i < plan->city->buildings.count; i++) {
		const struct building *building = &plan->city->buildings.items[i];
		if (building->is_part || building->face >= graph->face_count || building->footprint.outer.count < 3)
			continue;
		double area = fmax(graph->faces[building->face].area_m2, 1.0);
		plan->block_share[building->face] += (float)(footprint_area(building) / area);
	}
}

static double coverage_at(const struct ground_plan *plan, struct dvec2 at)
{
	int32_t col = (int32_t)floor(at.x / COVERAGE_STEP_M) - plan->coverage_col0;
	int32_t row = (int32_t)floor(at.y / COVERAGE_STEP_M) - plan->coverage_row0;
	if (col < 0 || row < 0 || col >= plan->coverage_cols || row >= plan->coverage_rows)
		return 0.0;
	return (double)plan->coverage[(size_t)row * (size_t)plan->coverage_cols + (size_t)col];
}

bool ground_is_built_up(const struct ground_plan *plan, struct dvec2 at)
{
	return coverage_at(plan, at) > BUILT_UP_SHARE;
}

bool ground_block_is_paved(const struct ground_plan *plan, struct dvec2 at)
{
	uint32_t face =
		plan->blocks ? face_locator_find(plan->blocks, llround(at.x * 1000.0), llround(at.y * 1000.0)) : PKG_NONE;
	double area = face == PKG_NONE ? 0.0 : plan->graph->faces[face].area_m2;
	bool telling = area > SMALL_BLOCK_M2 && area < LARGE_BLOCK_M2;
	return (telling ? (double)plan->block_share[face] : coverage_at(plan, at)) > PAVED_SHARE;
}

static void bin_buildings(struct ground_plan *plan)
{
	plan->building_bins.step_m = BUILDING_BIN_M;
	for (size_t i = 0; i < plan->city->buildings.count; i++) {
		const struct building *building = &plan->city->buildings.items[i];
		if (building->footprint.outer.count < 3 || building->min_height_m > 2.5)
			continue;
		struct dvec2 min, max;
		ring_bounds(&building->footprint.outer, &min, &max);
		bins_add(&plan->building_bins, min, max, (uint32_t)i);
	}
	bins_build(&plan->building_bins);
}

bool ground_in_building(const struct ground_plan *plan, struct dvec2 at)
{
	struct bin_items near = bins_near(&plan->building_bins, at);
	for (size_t i = 0; i < near.count; i++)
		if (polygon_contains(&plan->city->buildings.items[near.entries[i].item].footprint, at))
			return true;
	return false;
}

/* ---- areas ---- */

static enum ground_region area_region(const struct area *area)
{
	static const uint8_t regions[] = {
		[AREA_WATER] = REGION_WATER,
		[AREA_GRASS] = REGION_GRASS,
		[AREA_PARK] = REGION_PARK,
		[AREA_FOREST] = REGION_FOREST,
		[AREA_PITCH] = REGION_PITCH,
		[AREA_SAND] = REGION_SAND,
		[AREA_PARKING] = REGION_PARKING,
		[AREA_PEDESTRIAN] = REGION_PEDESTRIAN,
		[AREA_CEMETERY] = REGION_PARK,
		[AREA_CONSTRUCTION] = REGION_CONSTRUCTION,
		[AREA_RAILWAY] = REGION_RAILWAY,
		[AREA_FARM] = REGION_FARM,
		[AREA_COMMERCIAL] = REGION_COUNT,
		[AREA_BRIDGE] = REGION_COUNT,
		[AREA_PIER] = REGION_PEDESTRIAN,
		[AREA_ROCK] = REGION_ROCK,
	};
	if ((size_t)area->kind >= sizeof(regions) || (area->layer < 0 && area->kind != AREA_WATER))
		return REGION_COUNT;
	return regions[area->kind];
}

/* Lower comes first: piers over water, water over land, what was built over what it was built in; then small over
 * large. */
static int area_rank(const struct ground_area *area)
{
	if (area->area->kind == AREA_PIER)
		return 0;
	if (area->region == REGION_WATER)
		return 1;
	bool backdrop =
		area->region == REGION_FARM || area->region == REGION_RAILWAY || area->region == REGION_CONSTRUCTION;
	return backdrop ? 3 : 2;
}

static int compare_areas(const void *left, const void *right)
{
	const struct ground_area *a = left, *b = right;
	int rank = area_rank(a) - area_rank(b);
	if (rank)
		return rank;
	if (a->size_m2 != b->size_m2)
		return a->size_m2 < b->size_m2 ? -1 : 1;
	return (a->area > b->area) - (a->area < b->area);
}

static int compare_doubles(const void *left, const void *right)
{
	const double *a = left, *b = right;
	return (*a > *b) - (*a < *b);
}

/* A lake is level, at the height of the lower part of its shore. */
static void level_water(const struct ground_plan *plan, struct ground_area *area)
{
	area->drop_m = area->size_m2 > POND_M2 ? RIVER_DROP_M : POND_DROP_M;
	area->water_z = NAN;
	if (!plan->has_terrain)
		return;
	const struct ring *shore = &area->area->shape.outer;
	double *heights = array_grow(NULL, &(size_t){ 0 }, shore->count, sizeof(*heights));
	for (size_t i = 0; i < shore->count; i++)
		heights[i] = city_ground(plan->city, shore->points[i]);
	qsort(heights, shore->count, sizeof(*heights), compare_doubles);
	double low = heights[shore->count / 10], high = heights[shore->count - 1 - shore->count / 10];
	if (high - low < FLAT_WATER_SPREAD_M || area->size_m2 > 1e6)
		area->water_z = low - fmin(area->drop_m, 1.0);
	array_free(heights);
}

double ground_water_z(const struct ground_plan *plan, const struct ground_area *area, struct dvec2 at)
{
	double ground = city_ground(plan->city, at);
	if (!area)
		return ground - 1.0; /* a watercourse drawn from its line */
	return isnan(area->water_z) ? ground - area->drop_m : area->water_z;
}

static void collect_areas(struct ground_plan *plan)
{
	for (size_t i = 0; i < plan->city->areas.count; i++) {
		const struct area *area = &plan->city->areas.items[i];
		struct ground_area out = { .area = area, .region = area_region(area) };
		if (out.region == REGION_COUNT || area->shape.outer.count < 3)
			continue;
		out.size_m2 = fabs(ring_area(&area->shape.outer));
		ring_bounds(&area->shape.outer, &out.min, &out.max);
		if (out.region == REGION_WATER)
			level_water(plan, &out);
		ARRAY_PUSH(&plan->areas, out);
	}
	if (plan->areas.count)
		qsort(plan->areas.items, plan->areas.count, sizeof(*plan->areas.items), compare_areas);
	plan->area_bins.step_m = MESH_TILE_M;
	for (uint32_t i = 0; i < plan->areas.count; i++) {
		const struct ground_area *area = &plan->areas.items[i];
		struct dvec2 min = { fmax(area->min.x, plan->min.x), fmax(area->min.y, plan->min.y) };
		struct dvec2 max = { fmin(area->max.x, plan->max.x), fmin(area->max.y, plan->max.y) };
		if (min.x <= max.x && min.y <= max.y)
			bins_add(&plan->area_bins, min, max, i);
	}
	bins_build(&plan->area_bins);
}

const struct ground_area *ground_area_at(const struct ground_plan *plan, struct dvec2 at, enum ground_region region)
{
	struct bin_items near = bins_near(&plan->area_bins, at);
	for (size_t i = 0; i < near.count; i++) {
		const struct ground_area *area = &plan->areas.items[near.entries[i].item];
		if (area->region == region && polygon_contains(&area->area->shape, at))
			return area;
	}
	return NULL;
}

const struct ground_area *ground_top_area(const struct ground_plan *plan, struct dvec2 at)
{
	struct bin_items near = bins_near(&plan->area_bins, at); /* in order of precedence */
	for (size_t i = 0; i < near.count; i++) {
		const struct ground_area *area = &plan->areas.items[near.entries[i].item];
		if (at.x >= area->min.x && at.x <= area->max.x && at.y >= area->min.y && at.y <= area->max.y &&
			polygon_contains(&area->area->shape, at))
			return area;
	}
	return NULL;
}

/* ---- roads by place ---- */

static void bin_roads(struct ground_plan *plan)
{
	plan->road_bins.step_m = MESH_TILE_M;
	plan->segment_bins.step_m = SEGMENT_BIN_M;
	plan->corner_bins.step_m = MESH_TILE_M;
	for (uint32_t i = 0; i < plan->roads.count; i++) {
		const struct road *road = &plan->roads.items[i];
		double reach = road->half_width_m + fmax(road->side_left_m, road->side_right_m) + 1.0;
		bins_add(&plan->road_bins, (struct dvec2){ road->min.x - reach, road->min.y - reach },
			(struct dvec2){ road->max.x + reach, road->max.y + reach }, i);
		if (road->course == ROAD_CUT && road->edge == PKG_NONE)
			continue;
		for (uint32_t k = 0; k + 1 < road->count; k++) {
			struct dvec3 a = road->points[k], b = road->points[k + 1];
			double margin = road_structure_half_width(road) + 2.0;
			ARRAY_PUSH(&plan->segments, (struct road_segment){ i, k });
			bins_add(&plan->segment_bins, (struct dvec2){ fmin(a.x, b.x) - margin, fmin(a.y, b.y) - margin },
				(struct dvec2){ fmax(a.x, b.x) + margin, fmax(a.y, b.y) + margin }, (uint32_t)plan->segments.count - 1);
		}
	}
	for (uint32_t i = 0; i < plan->corners.count; i++) {
		struct ring ring = { plan->corners.items[i].points, plan->corners.items[i].count };
		struct dvec2 min, max;
		ring_bounds(&ring, &min, &max);
		bins_add(&plan->corner_bins, min, max, i);
	}
	bins_build(&plan->road_bins);
	bins_build(&plan->segment_bins);
	bins_build(&plan->corner_bins);
}

/* Ends are flat, so that a street's own continuation does not count as crossing it. */
static bool near_segment(const struct road *road, uint32_t point, struct dvec2 at, double margin_m)
{
	struct dvec2 a = { road->points[point].x, road->points[point].y };
	struct dvec2 b = { road->points[point + 1].x, road->points[point + 1].y };
	struct dvec2 d = dvec2_sub(b, a), p = dvec2_sub(at, a);
	double length2 = dvec2_dot(d, d), t = length2 > 0.0 ? dvec2_dot(p, d) / length2 : 0.0;
	if ((t < 0.0 && point == 0) || (t > 1.0 && point + 2 == road->count))
		return false;
	t = fmin(fmax(t, 0.0), 1.0);
	return dvec2_length(dvec2_sub(p, dvec2_scale(d, t))) < road->half_width_m + margin_m;
}

bool ground_on_road(const struct ground_plan *plan, struct dvec2 at, double margin_m, uint32_t except)
{
	struct bin_items near = bins_near(&plan->segment_bins, at);
	for (size_t i = 0; i < near.count; i++) {
		struct road_segment segment = plan->segments.items[near.entries[i].item];
		const struct road *road = &plan->roads.items[segment.road];
		if (road->course == ROAD_GROUND && region_is_road(road->region) &&
			(except == PKG_NONE || road->edge != except) && near_segment(road, segment.point, at, margin_m))
			return true;
	}
	return false;
}

bool ground_on_any_road(const struct ground_plan *plan, struct dvec2 at, double margin_m)
{
	struct bin_items near = bins_near(&plan->segment_bins, at);
	double ground = city_ground(plan->city, at);
	for (size_t i = 0; i < near.count; i++) {
		struct road_segment segment = plan->segments.items[near.entries[i].item];
		const struct road *road = &plan->roads.items[segment.road];
		double side = road->course == ROAD_GROUND ? 0.0 : road_structure_half_width(road) - road->half_width_m;
		double rise = road->points[segment.point].z - ground;
		bool clear = road->course == ROAD_DECK ? rise > HEADROOM_M
											   : road->course == ROAD_CUT && road->tunnel && rise < -TUBE_COVER_M;
		if (region_is_road(road->region) && !clear && near_segment(road, segment.point, at, margin_m + side))
			return true;
	}
	return false;
}

double ground_road_nearness(const struct ground_plan *plan, struct dvec2 at, enum road_course course, double *z)
{
	struct bin_items near = bins_near(&plan->segment_bins, at);
	double nearest = INFINITY;
	for (size_t i = 0; i < near.count; i++) {
		struct road_segment segment = plan->segments.items[near.entries[i].item];
		const struct road *road = &plan->roads.items[segment.road];
		if (road->course != course || !region_is_road(road->region))
			continue;
		struct dvec3 a = road->points[segment.point], b = road->points[segment.point + 1];
		struct dvec2 d = { b.x - a.x, b.y - a.y }, p = { at.x - a.x, at.y - a.y };
		double t = fmin(fmax(dvec2_dot(p, d) / fmax(dvec2_dot(d, d), 1e-9), 0.0), 1.0);
		double nearness = dvec2_length(dvec2_sub(p, dvec2_scale(d, t))) / road->half_width_m;
		if (nearness >= nearest)
			continue;
		nearest = nearness;
		if (z)
			*z = a.z + t * (b.z - a.z);
	}
	return nearest;
}

bool ground_on_path(const struct ground_plan *plan, struct dvec2 at, double margin_m)
{
	struct bin_items near = bins_near(&plan->segment_bins, at);
	for (size_t i = 0; i < near.count; i++) {
		struct road_segment segment = plan->segments.items[near.entries[i].item];
		const struct road *road = &plan->roads.items[segment.road];
		if (road->course == ROAD_GROUND && !region_is_road(road->region) &&
			near_segment(road, segment.point, at, margin_m))
			return true;
	}
	return false;
}

bool ground_near_street(const struct ground_plan *plan, struct dvec2 at, double reach_m)
{
	int32_t squares = (int32_t)ceil(reach_m / SEGMENT_BIN_M);
	for (int32_t row = -squares; row <= squares; row++)
		for (int32_t col = -squares; col <= squares; col++) {
			struct bin_items near = bins_near(
				&plan->segment_bins, (struct dvec2){ at.x + col * SEGMENT_BIN_M, at.y + row * SEGMENT_BIN_M });
			for (size_t i = 0; i < near.count; i++)
				if (plan->roads.items[plan->segments.items[near.entries[i].item].road].edge != PKG_NONE)
					return true;
		}
	return false;
}

static void bin_lines(struct ground_plan *plan)
{
	plan->line_bins.step_m = MESH_TILE_M;
	for (uint32_t i = 0; i < plan->city->lines.count; i++) {
		const struct line *line = &plan->city->lines.items[i];
		if ((line->kind != LINE_RIVER && line->kind != LINE_STREAM) || line->tunnel || line->count < 2)
			continue;
		struct ring ring = { line->points, line->count };
		struct dvec2 min, max;
		ring_bounds(&ring, &min, &max);
		double reach = line->width_m / 2.0 + 1.0;
		bins_add(&plan->line_bins, (struct dvec2){ min.x - reach, min.y - reach },
			(struct dvec2){ max.x + reach, max.y + reach }, i);
	}
	bins_build(&plan->line_bins);
}

void ground_plan_build(struct ground_plan *plan, const struct city *city, const struct pkg_graph *graph)
{
	*plan = (struct ground_plan){ .city = city, .graph = graph };
	plan->has_terrain = city->terrain.grid.columns >= 2 && city->terrain.grid.rows >= 2;
	plan->min = (struct dvec2){ floor((city->min.x - MARGIN_M) / MESH_TILE_M) * MESH_TILE_M,
		floor((city->min.y - MARGIN_M) / MESH_TILE_M) * MESH_TILE_M };
	plan->max = (struct dvec2){ ceil((city->max.x + MARGIN_M) / MESH_TILE_M) * MESH_TILE_M,
		ceil((city->max.y + MARGIN_M) / MESH_TILE_M) * MESH_TILE_M };
	measure_coverage(plan);
	measure_blocks(plan);
	bin_buildings(plan);
	collect_areas(plan);
	bin_lines(plan);
	ground_roads_build(plan);
	bin_roads(plan);
	ground_events_build(plan);
}

void ground_plan_finish(struct ground_plan *plan)
{
	face_locator_free(plan->blocks);
	ARRAY_FINISH(&plan->roads);
	ARRAY_FINISH(&plan->areas);
	ARRAY_FINISH(&plan->corners);
	ARRAY_FINISH(&plan->events);
	ARRAY_FINISH(&plan->segments);
	bins_finish(&plan->road_bins);
	bins_finish(&plan->area_bins);
	bins_finish(&plan->line_bins);
	bins_finish(&plan->building_bins);
	bins_finish(&plan->segment_bins);
	bins_finish(&plan->corner_bins);
	pool_finish(&plan->pool);
}
