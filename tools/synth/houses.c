/* Buildings of a block by its use. */
#include <math.h>
#include <stdlib.h>

#include "tools/synth/synth.h"

static const char *const old_walls[] = { "#e2b78b", "#d98e73", "#e7cf9f", "#c9d1b8", "#b9c6cf", "#e6dccb", "#cf9c6e",
	"#dcc0a0", "#e3a98a", "#d7d0bd" };
static const char *const town_walls[] = { "#e8dcc3", "#d9c7a3", "#e3d2b4", "#cfae84", "#d8b48f", "#e6c9a8", "#c9b79c",
	"#dfd8c8", "#bfae98", "#d6a27e", "#c98f6b", "#e9e2d0", "#c7c2b4" };
static const char *const villa_walls[] = { "#f0ece2", "#e9e4d6", "#f2efe8", "#d9cdb8", "#e6dcc2", "#dfe3df",
	"#d8c8a8" };
static const char *const slab_walls[] = { "#d8d4ca", "#c9c6be", "#e2ded4", "#b9b6ae", "#cfc9bb", "#d6cfc0" };
static const char *const glass_walls[] = { "#7f99a8", "#6d8696", "#8fa7b3", "#5f7480", "#93a3a0", "#6f8f95" };
static const char *const tile_roofs[] = { "#9c4a2f", "#a5573a", "#8a4630", "#7a3f2c", "#93523c" };
static const char *const slate_roofs[] = { "#5b6068", "#4e545c", "#676b70" };
static const char *const hall_walls[] = { "#a9b0b3", "#9aa4a8", "#c2b8a6", "#8f9a94", "#b3a08c" };
static const char *const shops[] = { "bakery", "clothes", "books", "florist", "butcher", "shoes", "kiosk", "jewelry" };

static bool inset(struct synth *synth, const struct polygon *polygon, double by_m, double least_m2, polygon_array *out)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	GEOSGeometry *from = shape_to_geos(&synth->shaper, polygon);
	GEOSGeometry *inner =
		from ? GEOSBufferWithStyle_r(geos, from, -by_m, 2, GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_MITRE, 2.0) : NULL;
	size_t before = out->count;
	if (inner)
		shape_from_geos(&synth->shaper, inner, least_m2, out);
	GEOSGeom_destroy_r(geos, inner);
	GEOSGeom_destroy_r(geos, from);
	return out->count > before;
}

static void pitched(struct house *house, struct rng *rng, double pitch_m, bool slate)
{
	house->roof_height_m = pitch_m * rng_range(rng, 0.85, 1.15);
	house->roof_colour = slate ? PICK(rng, slate_roofs) : PICK(rng, tile_roofs);
	house->roof_material = slate ? "slate" : "roof_tiles";
}

static struct house old_house(struct rng *rng, double base_levels)
{
	struct house house = { .kind = "apartments", .wall_colour = PICK(rng, old_walls), .wall_material = "plaster" };
	double dice = rng_unit(rng);
	house.levels = fmax(2.0, base_levels + floor(rng_range(rng, -1.0, 1.6)));
	house.roof_shape = dice < 0.78 ? "gabled" : dice < 0.9 ? "hipped" : "mansard";
	pitched(&house, rng, dice < 0.9 ? 4.2 : 3.4, dice >= 0.9);
	house.height_m = house.levels * 3.0 + 0.6 + house.roof_height_m;
	if (rng_unit(rng) < 0.5)
		house.shop = PICK(rng, shops);
	return house;
}

static struct house town_house(struct rng *rng, double base_levels, bool corner)
{
	struct house house = { .kind = "apartments", .wall_colour = PICK(rng, town_walls) };
	double dice = rng_unit(rng);
	house.wall_material = rng_unit(rng) < 0.14 ? "brick" : rng_unit(rng) < 0.2 ? "stone" : "plaster";
	if (house.wall_material[0] == 'b')
		house.wall_colour = "#a5614a";
	house.levels = fmax(3.0, base_levels + floor(rng_range(rng, -1.0, 1.9)) + (corner && rng_unit(rng) < 0.4));
	house.roof_shape = dice < 0.4 ? "gabled" : dice < 0.68 ? "mansard" : dice < 0.78 ? "hipped" : "flat";
	if (corner && house.roof_shape[0] == 'g')
		house.roof_shape = "hipped";
	if (house.roof_shape[0] == 'f')
		house.roof_material = "gravel";
	else
		pitched(&house, rng, house.roof_shape[0] == 'm' ? 3.6 : 4.0, house.roof_shape[0] == 'm' || rng_unit(rng) < 0.3);
	house.height_m = house.levels * 3.25 + 0.9 + house.roof_height_m;
	if (rng_unit(rng) < 0.45)
		house.shop = PICK(rng, shops);
	return house;
}

static void write_whole(struct synth *synth, const struct block *block, const struct house *house)
{
	building_write_polygon(synth, &block->land, house);
}

/* Holes a little larger than the buildings, for planting between them. */
static void plant_between(
	struct synth *synth, const struct polygon *land, const polygon_array *built, double per_hectare, struct rng *rng)
{
	struct polygon lawn = *land;
	lawn.hole_count = built->count + land->hole_count;
	lawn.holes = POOL_ARRAY(&synth->city.pool, struct ring, lawn.hole_count + 1);
	for (size_t i = 0; i < land->hole_count; i++)
		lawn.holes[i] = land->holes[i];
	for (size_t i = 0; i < built->count; i++) {
		const struct ring *from = &built->items[i].outer;
		struct ring *to = &lawn.holes[land->hole_count + i];
		struct dvec2 min, max;
		ring_bounds(from, &min, &max);
		struct dvec2 middle = { (min.x + max.x) / 2.0, (min.y + max.y) / 2.0 };
		*to = (struct ring){ POOL_ARRAY(&synth->city.pool, struct dvec2, from->count), from->count };
		for (size_t k = 0; k < from->count; k++) {
			struct dvec2 out = dvec2_sub(from->points[k], middle);
			to->points[k] = dvec2_add(from->points[k], dvec2_scale(out, 4.5 / fmax(dvec2_length(out), 1.0)));
		}
	}
	trees_scatter(synth, &lawn, per_hectare, rng, 9.0);
}

/* Where a closed row does not fit: detached houses in rows. */
static void crooked_block(
	struct synth *synth, struct block *block, const struct house *like, double piece_m, struct rng *rng)
{
	polygon_array inner = { 0 }, rows = { 0 };
	if (inset(synth, &block->land, like->levels > 2.0 ? 1.0 : 4.0, 80.0, &inner))
		for (size_t i = 0; i < inner.count; i++)
			rows_across(synth, &inner.items[i], longest_side(&block->land.outer), like->levels > 2.0 ? 12.5 : 9.5, 15.0,
				piece_m, 70.0, &rows);
	area_write(synth, &block->land, "landuse", "grass", NULL);
	for (size_t i = 0; i < rows.count; i++) {
		struct house house = like->levels > 2.0 ? town_house(rng, like->levels, true) : *like;
		building_write_polygon(synth, &rows.items[i], &house);
	}
	plant_between(synth, &block->land, &rows, 50.0, rng);
	ARRAY_FINISH(&inner);
	ARRAY_FINISH(&rows);
}

static void old_block(struct synth *synth, struct block *block, struct rng *rng)
{
	lot_array lots = { 0 };
	struct ring yard;
	double base = 3.0 + floor(rng_range(rng, 0.0, 2.0));
	struct lot_rule rule = { fmin(9.5, block->room_m * 0.62), 6.5, 11.0, 6.5 };
	if (block->room_m < 8.0 || block->land.hole_count ||
		!lots_around(&synth->city.pool, &block->land.outer, &rule, rng, &lots, &yard)) {
		struct house house = old_house(rng, base);
		house.roof_shape = "hipped";
		if (block->area_m2 < 600.0 && !block->land.hole_count)
			write_whole(synth, block, &house);
		else
			crooked_block(synth, block, &house, 16.0, rng);
		ARRAY_FINISH(&lots);
		return;
	}
	for (size_t i = 0; i < lots.count; i++) {
		struct house house = old_house(rng, base);
		if (lots.items[i].corner && house.roof_shape[0] == 'g')
			house.roof_shape = "hipped";
		building_write(synth, lots.items[i].points, lots.items[i].count, &house);
	}
	ARRAY_FINISH(&lots);
}

static void fill_yard(struct synth *synth, const struct ring *yard, double base_levels, struct rng *rng)
{
	struct polygon garden = { .outer = *yard };
	double area = ring_area(yard);
	polygon_array wings = { 0 };
	if (area < 100.0)
		return;
	area_write(synth, &garden, "leisure", "garden", NULL);
	if (area > 1500.0 && rng_unit(rng) < 0.5 && inset(synth, &garden, 9.0, 150.0, &wings)) {
		polygon_array pieces = { 0 };
		rows_across(synth, &wings.items[0], longest_side(yard), 11.0, 40.0, 34.0, 110.0, &pieces);
		struct house house = town_house(rng, fmax(2.0, base_levels - 2.0), false);
		house.shop = NULL;
		for (size_t i = 0; i < pieces.count && i < 1; i++) {
			building_write_polygon(synth, &pieces.items[i], &house);
			garden.holes = &pieces.items[i].outer;
			garden.hole_count = 1;
		}
		trees_scatter(synth, &garden, 60.0, rng, 8.0);
		ARRAY_FINISH(&pieces);
	} else {
		trees_scatter(synth, &garden, 70.0, rng, 8.0);
	}
	ARRAY_FINISH(&wings);
}

/* A school or a ministry: one building around its court. */
static void one_ring(struct synth *synth, const struct block *block, const struct ring *yard, struct rng *rng)
{
	struct ring court = { POOL_ARRAY(&synth->city.pool, struct dvec2, yard->count), yard->count };
	for (size_t i = 0; i < yard->count; i++)
		court.points[i] = yard->points[yard->count - 1 - i];
	struct polygon whole = { .outer = block->land.outer, .holes = &court, .hole_count = 1 };
	struct house house = { .kind = rng_unit(rng) < 0.5 ? "school" : "public",
		.levels = 4.0,
		.height_m = 19.0,
		.roof_shape = "flat",
		.wall_colour = "#d8c7a0",
		.wall_material = "stone",
		.roof_material = "metal" };
	building_write_polygon(synth, &whole, &house);
}

static void perimeter_block(struct synth *synth, struct block *block, struct rng *rng)
{
	lot_array lots = { 0 };
	struct ring yard;
	double base = 3.0 + floor(3.2 * fmin(1.0, block->centrality * 1.3) * rng_range(rng, 0.75, 1.1));
	double narrow = fmin(fmax(synth->options.density, 0.5), 2.0);
	struct lot_rule rule = { 13.0, 13.0 / narrow, 23.0 / narrow, 13.0 };
	bool laid = false;
	for (int attempt = 0; attempt < 3 && !laid && !block->land.hole_count; attempt++) {
		laid = lots_around(&synth->city.pool, &block->land.outer, &rule, rng, &lots, &yard);
		rule.depth_m *= 0.78;
		rule.corner_m *= 0.8;
	}
	if (!laid) {
		struct house house = town_house(rng, base, true);
		house.roof_shape = "flat";
		house.roof_height_m = 0.0;
		house.roof_material = "gravel";
		house.roof_colour = NULL;
		house.height_m = house.levels * 3.25 + 0.9;
		if (block->area_m2 < 700.0)
			write_whole(synth, block, &house);
		else
			crooked_block(synth, block, &house, 24.0, rng);
	} else if (block->area_m2 > 3000.0 && rng_unit(rng) < 0.05) {
		one_ring(synth, block, &yard, rng);
	} else {
		for (size_t i = 0; i < lots.count; i++) {
			struct house house = town_house(rng, base, lots.items[i].corner);
			if (!lots.items[i].corner && rng_unit(rng) < 0.025)
				continue; /* a gap in the row */
			building_write(synth, lots.items[i].points, lots.items[i].count, &house);
		}
		fill_yard(synth, &yard, base, rng);
	}
	ARRAY_FINISH(&lots);
}

static void write_tower(struct synth *synth, const struct polygon *plot, double near_middle, struct rng *rng)
{
	polygon_array upper = { 0 };
	struct house outline = { .kind = "office",
		.wall_colour = PICK(rng, glass_walls),
		.wall_material = "glass",
		.roof_shape = "flat",
		.roof_material = "concrete" };
	double podium_levels = 3.0 + rng_u32(rng) % 4;
	double levels =
		podium_levels + 6.0 + floor(rng_range(rng, 0.0, 1.0) * rng_range(rng, 0.3, 1.0) * 30.0 * near_middle);
	if (rng_unit(rng) < 0.3 || !inset(synth, plot, rng_range(rng, 4.0, 6.5), 180.0, &upper)) {
		outline.levels = podium_levels + 3.0 + rng_u32(rng) % 6;
		outline.height_m = outline.levels * 3.6 + 1.2;
		outline.wall_colour = PICK(rng, slab_walls);
		outline.wall_material = rng_unit(rng) < 0.5 ? "concrete" : "stone";
		building_write_polygon(synth, plot, &outline);
		ARRAY_FINISH(&upper);
		return;
	}
	outline.levels = levels;
	outline.height_m = levels * 3.6 + 2.0;
	building_write_polygon(synth, plot, &outline);
	struct house podium = outline;
	podium.part = true;
	podium.kind = "yes";
	podium.levels = podium_levels;
	podium.height_m = podium_levels * 3.8;
	podium.wall_colour = PICK(rng, slab_walls);
	podium.wall_material = "stone";
	building_write_polygon(synth, plot, &podium);
	struct house tower = outline;
	tower.part = true;
	tower.kind = "yes";
	tower.min_height_m = podium.height_m;
	building_write_polygon(synth, &upper.items[0], &tower);
	ARRAY_FINISH(&upper);
}

static void downtown_block(struct synth *synth, struct block *block, struct rng *rng)
{
	polygon_array plots = { 0 };
	if (block->room_m < 17.0 || block->land.hole_count) {
		perimeter_block(synth, block, rng);
		return;
	}
	double away = dvec2_length(dvec2_sub(block->middle, synth->plan.downtown)) / synth->plan.downtown_radius_m;
	double width = rng_range(rng, 30.0, 38.0);
	area_write(synth, &block->land, "highway", "pedestrian", NULL);
	rows_across(synth, &block->land, longest_side(&block->land.outer), width, 8.0, 44.0, 260.0, &plots);
	for (size_t i = 0; i < plots.count; i++)
		write_tower(synth, &plots.items[i], 1.15 - 0.7 * away, rng);
	ARRAY_FINISH(&plots);
}

static void slab_block(struct synth *synth, struct block *block, struct rng *rng)
{
	polygon_array inner = { 0 }, rows = { 0 };
	double base = 4.0 + rng_u32(rng) % 5, turn = rng_unit(rng) < 0.4 ? BLVD_PI / 2.0 : 0.0;
	if (inset(synth, &block->land, 5.0, 400.0, &inner))
		rows_across(synth, &inner.items[0], longest_side(&block->land.outer) + turn, 12.5, 24.0, 56.0, 230.0, &rows);
	if (!rows.count) {
		perimeter_block(synth, block, rng);
	} else {
		area_write(synth, &block->land, "landuse", "grass", NULL);
		for (size_t i = 0; i < rows.count; i++) {
			struct house house = { .kind = "apartments",
				.levels = base + rng_u32(rng) % 2,
				.roof_shape = "flat",
				.wall_colour = PICK(rng, slab_walls),
				.wall_material = rng_unit(rng) < 0.5 ? "concrete" : "plaster",
				.roof_material = "gravel" };
			house.height_m = house.levels * 2.9 + 1.0;
			building_write_polygon(synth, &rows.items[i], &house);
		}
		plant_between(synth, &block->land, &rows, 45.0, rng);
	}
	ARRAY_FINISH(&inner);
	ARRAY_FINISH(&rows);
}

struct frame {
	struct dvec2 origin, along, inward;
};

static struct dvec2 in_frame(const struct frame *frame, double u, double v)
{
	return dvec2_add(frame->origin, dvec2_add(dvec2_scale(frame->along, u), dvec2_scale(frame->inward, v)));
}

static bool box_in_lot(
	const struct lot *lot, const struct frame *frame, double u0, double v0, double u1, double v1, struct dvec2 *box)
{
	struct ring ring = { (struct dvec2 *)lot->points, lot->count };
	box[0] = in_frame(frame, u0, v0);
	box[1] = in_frame(frame, u1, v0);
	box[2] = in_frame(frame, u1, v1);
	box[3] = in_frame(frame, u0, v1);
	for (int i = 0; i < 4; i++)
		if (!ring_contains(&ring, box[i]))
			return false;
	return true;
}

static void villa(struct synth *synth, const struct lot *lot, struct rng *rng)
{
	struct dvec2 d = dvec2_sub(lot->front_b, lot->front_a), box[4];
	double front = dvec2_length(d), width = fmin(rng_range(rng, 9.0, 13.5), front - 5.0),
		   depth = rng_range(rng, 8.0, 11.0);
	struct frame frame = { lot->front_a, dvec2_scale(d, 1.0 / fmax(front, 1e-9)), { 0, 0 } };
	frame.inward = (struct dvec2){ -frame.along.y, frame.along.x };
	double setback = rng_range(rng, 4.5, 7.0), side = lot->corner ? 5.5 : (front - width) * rng_range(rng, 0.35, 0.65);
	struct house house = { .kind = "house",
		.levels = 1.0 + rng_u32(rng) % 2 + (rng_unit(rng) < 0.2),
		.wall_colour = PICK(rng, villa_walls),
		.wall_material = "plaster" };
	if (width < 6.0 || !box_in_lot(lot, &frame, side, setback, side + width, setback + depth, box))
		return;
	double dice = rng_unit(rng);
	house.roof_shape = dice < 0.55 ? "gabled" : dice < 0.8 ? "hipped" : dice < 0.9 ? "half-hipped" : "flat";
	if (house.roof_shape[0] != 'f')
		pitched(&house, rng, 3.4, rng_unit(rng) < 0.25);
	house.height_m = house.levels * 2.9 + 0.5 + house.roof_height_m;
	building_write(synth, box, 4, &house);
	if (!lot->corner && front - side - width > 4.6 && rng_unit(rng) < 0.4) {
		struct house garage = { .kind = "garage",
			.levels = 1.0,
			.height_m = 2.8,
			.roof_shape = "flat",
			.wall_colour = house.wall_colour,
			.wall_material = "plaster" };
		if (box_in_lot(lot, &frame, side + width + 0.6, setback + 2.0, side + width + 3.8, setback + 8.0, box))
			building_write(synth, box, 4, &garage);
	}
	for (int i = 0; i < 3; i++) {
		struct dvec2 tree =
			in_frame(&frame, rng_range(rng, 1.5, front - 1.5), setback + depth + rng_range(rng, 3.0, 9.0));
		struct ring ring = { (struct dvec2 *)lot->points, lot->count };
		if (rng_unit(rng) < 0.6 * fmin(synth->options.density, 1.6) && ring_contains(&ring, tree))
			tree_write(synth, tree, rng, 7.0);
	}
}

static void villa_block(struct synth *synth, struct block *block, struct rng *rng)
{
	lot_array lots = { 0 };
	struct ring yard;
	struct lot_rule rule = { fmin(28.0, block->room_m * 0.82), 17.0, 26.0, 20.0 };
	bool laid = !block->land.hole_count && lots_around(&synth->city.pool, &block->land.outer, &rule, rng, &lots, &yard);
	if (!laid) {
		struct house house = { .kind = "house",
			.levels = 2.0,
			.height_m = 9.6,
			.roof_shape = "gabled",
			.roof_height_m = 3.4,
			.wall_colour = PICK(rng, villa_walls),
			.wall_material = "plaster",
			.roof_colour = PICK(rng, tile_roofs),
			.roof_material = "roof_tiles" };
		crooked_block(synth, block, &house, 24.0, rng);
		ARRAY_FINISH(&lots);
		return;
	}
	area_write(synth, &block->land, "landuse", "grass", NULL);
	for (size_t i = 0; i < lots.count; i++)
		villa(synth, &lots.items[i], rng);
	if (ring_area(&yard) > 300.0)
		trees_scatter(synth, &(struct polygon){ .outer = yard }, 60.0, rng, 9.0);
	ARRAY_FINISH(&lots);
}

static GEOSGeometry *rail_band(struct synth *synth, double half_m)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	if (synth->rail.count < 2)
		return NULL;
	GEOSCoordSequence *points = GEOSCoordSeq_create_r(geos, (unsigned)synth->rail.count, 2);
	for (unsigned i = 0; i < synth->rail.count; i++)
		GEOSCoordSeq_setXY_r(geos, points, i, synth->rail.items[i].x, synth->rail.items[i].y);
	GEOSGeometry *line = GEOSGeom_createLineString_r(geos, points);
	GEOSGeometry *band =
		line ? GEOSBufferWithStyle_r(geos, line, half_m, 4, GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_ROUND, 2.0) : NULL;
	GEOSGeom_destroy_r(geos, line);
	return band;
}

/* The block without (or within) the railway's ground. */
static void beside_rail(struct synth *synth, const struct block *block, bool within, polygon_array *out)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	GEOSGeometry *band = rail_band(synth, 9.0), *land = shape_to_geos(&synth->shaper, &block->land);
	GEOSGeometry *part = NULL;
	if (band && land)
		part = within ? GEOSIntersection_r(geos, land, band) : GEOSDifference_r(geos, land, band);
	if (part)
		shape_from_geos(&synth->shaper, part, 200.0, out);
	GEOSGeom_destroy_r(geos, part);
	GEOSGeom_destroy_r(geos, land);
	GEOSGeom_destroy_r(geos, band);
}

static void write_silos(struct synth *synth, struct dvec2 at, struct rng *rng)
{
	for (int k = 0; k < 3; k++) {
		struct dvec2 ring[12];
		for (int i = 0; i < 12; i++) {
			double angle = 2.0 * BLVD_PI * i / 12.0;
			ring[i] = (struct dvec2){ at.x + 10.0 * k + 4.2 * cos(angle), at.y + 4.2 * sin(angle) };
		}
		struct house silo = { .kind = "silo",
			.height_m = rng_range(rng, 16.0, 21.0),
			.roof_shape = "dome",
			.roof_height_m = 2.5,
			.wall_colour = "#c8cac8",
			.wall_material = "metal",
			.roof_material = "metal",
			.key = "man_made",
			.value = "silo" };
		building_write(synth, ring, 12, &silo);
	}
}

static void industry_block(struct synth *synth, struct block *block, struct rng *rng)
{
	polygon_array sides = { 0 }, bed = { 0 };
	bool inner_city = block->centrality > 0.3;
	beside_rail(synth, block, true, &bed);
	for (size_t i = 0; i < bed.count; i++)
		area_write(synth, &bed.items[i], "landuse", "railway", NULL);
	beside_rail(synth, block, false, &sides);
	for (size_t i = 0; i < sides.count; i++) {
		polygon_array inner = { 0 }, halls = { 0 };
		double angle = longest_side(&sides.items[i].outer);
		if (inset(synth, &sides.items[i], 9.0, 600.0, &inner))
			rows_across(synth, &inner.items[0], angle, inner_city ? 15.0 : rng_range(rng, 26.0, 34.0), 14.0,
				inner_city ? 38.0 : rng_range(rng, 46.0, 80.0), inner_city ? 200.0 : 380.0, &halls);
		for (size_t k = 0; k < halls.count; k++) {
			double dice = rng_unit(rng);
			if (inner_city) {
				struct house office = town_house(rng, 5.0, true);
				office.kind = dice < 0.5 ? "office" : "commercial";
				building_write_polygon(synth, &halls.items[k], &office);
				continue;
			}
			struct house hall = { .kind = dice < 0.5 ? "industrial" : "warehouse",
				.levels = 1.0 + (dice > 0.75),
				.roof_shape = dice < 0.6 ? "flat" : "gabled",
				.roof_height_m = dice < 0.6 ? 0.0 : 2.4,
				.wall_colour = PICK(rng, hall_walls),
				.wall_material = dice < 0.3 ? "brick" : "metal",
				.roof_material = "metal" };
			hall.height_m = rng_range(rng, 7.0, 12.0) + hall.roof_height_m;
			if (rng_unit(rng) < 0.1) {
				area_write(synth, &halls.items[k], "amenity", "parking", NULL);
				continue;
			}
			if (rng_unit(rng) < 0.03 && polygon_area(&halls.items[k]) > 1100.0) {
				write_silos(synth, polygon_inner_point(&halls.items[k]), rng);
				continue;
			}
			building_write_polygon(synth, &halls.items[k], &hall);
		}
		ARRAY_FINISH(&inner);
		ARRAY_FINISH(&halls);
	}
	ARRAY_FINISH(&sides);
	ARRAY_FINISH(&bed);
}

void houses_write(struct synth *synth, struct block *block)
{
	struct rng rng = synth_rng(synth, 50, block->face);
	switch (block->use) {
	case BLOCK_OLD:
		old_block(synth, block, &rng);
		break;
	case BLOCK_PERIMETER:
		perimeter_block(synth, block, &rng);
		break;
	case BLOCK_DOWNTOWN:
		downtown_block(synth, block, &rng);
		break;
	case BLOCK_SLABS:
		slab_block(synth, block, &rng);
		break;
	case BLOCK_VILLAS:
		villa_block(synth, block, &rng);
		break;
	case BLOCK_INDUSTRY:
		industry_block(synth, block, &rng);
		break;
	case BLOCK_PARK:
		park_write(synth, block);
		break;
	case BLOCK_WOOD:
		wood_write(synth, block);
		break;
	case BLOCK_SQUARE:
		square_write(synth, block);
		break;
	case BLOCK_NONE:
	case BLOCK_LANDMARK:
		break;
	}
}
