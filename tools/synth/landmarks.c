/* What a driver steers by: cathedral, town hall, opera, television tower, station, parish churches. Each takes a block
 * and stands in its middle, in parts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tools/synth/synth.h"

struct site {
	struct synth *synth;
	struct dvec2 middle;
	double angle, scale;
};

static struct dvec2 on_site(const struct site *site, double u, double v)
{
	struct dvec2 p = { u * site->scale, v * site->scale };
	return dvec2_add(site->middle, turned(p, site->angle));
}

static void box(const struct site *site, double u0, double v0, double u1, double v1, const struct house *house)
{
	struct dvec2 points[4] = { on_site(site, u0, v0), on_site(site, u1, v0), on_site(site, u1, v1),
		on_site(site, u0, v1) };
	building_write(site->synth, points, 4, house);
}

static void round_part(const struct site *site, double u, double v, double radius, const struct house *house)
{
	struct dvec2 points[24];
	for (int i = 0; i < 24; i++) {
		double angle = 2.0 * BLVD_PI * i / 24.0;
		points[i] = on_site(site, u + radius * cos(angle), v + radius * sin(angle));
	}
	building_write(site->synth, points, 24, house);
}

static struct house stone_part(const struct site *site, double height, const char *roof, double roof_height)
{
	return (struct house){ .kind = "yes",
		.part = true,
		.height_m = height * site->scale,
		.roof_shape = roof,
		.roof_height_m = roof_height * site->scale,
		.wall_colour = "#d9d0bc",
		.wall_material = "stone",
		.roof_colour = "#5b6068",
		.roof_material = "slate" };
}

static void outline(const struct site *site, const double (*uv)[2], size_t count, struct house house)
{
	struct dvec2 points[32];
	for (size_t i = 0; i < count; i++)
		points[i] = on_site(site, uv[i][0], uv[i][1]);
	house.height_m *= site->scale;
	building_write(site->synth, points, count, &house);
}

/* 60 m long at scale 1, two towers in the west, a spire over the crossing. */
static void cathedral(const struct site *site, const char *name)
{
	static const double cross[][2] = { { -30, -11 }, { -20, -11 }, { -20, -8 }, { 6, -8 }, { 6, -16 }, { 18, -16 },
		{ 18, -8 }, { 26, -8 }, { 30, -4 }, { 30, 4 }, { 26, 8 }, { 18, 8 }, { 18, 16 }, { 6, 16 }, { 6, 8 },
		{ -20, 8 }, { -20, 11 }, { -30, 11 } };
	outline(site, cross, 18,
		(struct house){ .kind = "cathedral",
			.height_m = 62.0,
			.name = name,
			.wall_colour = "#d9d0bc",
			.wall_material = "stone",
			.key = "amenity",
			.value = "place_of_worship" });
	struct house nave = stone_part(site, 26.0, "gabled", 9.0), arm = stone_part(site, 25.0, "gabled", 8.0);
	struct house tower = stone_part(site, 62.0, "pyramidal", 18.0), porch = stone_part(site, 20.0, "gabled", 5.0);
	struct house apse = stone_part(site, 17.0, "pyramidal", 5.0), spire = stone_part(site, 46.0, "pyramidal", 18.0);
	spire.min_height_m = 24.0 * site->scale;
	box(site, -20, -8, 26, 8, &nave);
	box(site, 6, -16, 18, -8, &arm);
	box(site, 6, 8, 18, 16, &arm);
	box(site, -30, -11, -20, -2, &tower);
	box(site, -30, 2, -20, 11, &tower);
	box(site, -30, -2, -20, 2, &porch);
	struct dvec2 end[4] = { on_site(site, 26, -8), on_site(site, 30, -4), on_site(site, 30, 4), on_site(site, 26, 8) };
	building_write(site->synth, end, 4, &apse);
	box(site, 9.5, -2.5, 14.5, 2.5, &spire);
}

static void church(const struct site *site, const char *name)
{
	static const double shape[][2] = { { -18, -4 }, { -11, -4 }, { -11, -7 }, { 15, -7 }, { 15, 7 }, { -11, 7 },
		{ -11, 4 }, { -18, 4 } };
	outline(site, shape, 8,
		(struct house){ .kind = "church",
			.height_m = 42.0,
			.name = name,
			.wall_colour = "#e6ddc8",
			.wall_material = "plaster",
			.key = "amenity",
			.value = "place_of_worship" });
	struct house nave = stone_part(site, 19.0, "gabled", 7.0), tower = stone_part(site, 42.0, "pyramidal", 15.0);
	nave.roof_colour = "#9c4a2f";
	nave.roof_material = "roof_tiles";
	tower.roof_colour = "#6ba08c";
	tower.roof_material = "copper";
	nave.wall_colour = tower.wall_colour = "#e6ddc8";
	box(site, -11, -7, 15, 7, &nave);
	box(site, -18, -4, -11, 4, &tower);
}

static void town_hall(const struct site *site)
{
	static const double shape[][2] = { { -17, -10 }, { 17, -10 }, { 17, 10 }, { -17, 10 } };
	outline(site, shape, 4,
		(struct house){ .kind = "townhall",
			.height_m = 54.0,
			.name = "Town Hall",
			.wall_colour = "#b9785a",
			.wall_material = "brick",
			.key = "amenity",
			.value = "townhall" });
	struct house hall = stone_part(site, 24.0, "hipped", 7.0), tower = stone_part(site, 54.0, "pyramidal", 14.0);
	hall.wall_colour = tower.wall_colour = "#b9785a";
	hall.wall_material = tower.wall_material = "brick";
	hall.levels = 4.0;
	tower.roof_colour = "#6ba08c";
	tower.roof_material = "copper";
	box(site, -17, -10, 17, 10, &hall);
	tower.min_height_m = 14.0 * site->scale;
	box(site, -3.5, -9.9, 3.5, -2.9, &tower);
}

static void opera(const struct site *site)
{
	static const double shape[][2] = { { -28, -18 }, { 28, -18 }, { 28, 18 }, { -28, 18 } };
	outline(site, shape, 4,
		(struct house){ .kind = "theatre",
			.height_m = 36.0,
			.name = "Opera",
			.wall_colour = "#e4d8bd",
			.wall_material = "stone",
			.key = "amenity",
			.value = "theatre" });
	struct house front = stone_part(site, 17.0, "flat", 0.0), house = stone_part(site, 24.0, "hipped", 5.0);
	struct house stage = stone_part(site, 31.0, "flat", 0.0), dome = stone_part(site, 36.0, "dome", 9.0);
	front.levels = 3.0;
	dome.roof_colour = house.roof_colour = "#6ba08c";
	dome.roof_material = house.roof_material = "copper";
	dome.min_height_m = 19.0 * site->scale;
	box(site, -28, -18, -16, 18, &front);
	box(site, -16, -18, 12, 18, &house);
	box(site, 12, -18, 28, 18, &stage);
	round_part(site, -4, 0, 10.5, &dome);
}

static void television_tower(const struct site *site)
{
	struct dvec2 ring[24];
	for (int i = 0; i < 24; i++)
		ring[i] = on_site(site, 13.0 * cos(2.0 * BLVD_PI * i / 24.0), 13.0 * sin(2.0 * BLVD_PI * i / 24.0));
	struct house whole = { .kind = "tower",
		.height_m = 215.0,
		.name = "Television Tower",
		.wall_colour = "#d5d7d6",
		.wall_material = "concrete",
		.key = "man_made",
		.value = "tower" };
	building_write(site->synth, ring, 24, &whole);
	struct house foot = { .kind = "yes",
		.part = true,
		.height_m = 7.0,
		.levels = 2.0,
		.roof_shape = "flat",
		.wall_colour = "#b9c3c6",
		.wall_material = "glass" };
	struct house shaft = { .kind = "yes",
		.part = true,
		.height_m = 166.0,
		.min_height_m = 7.0,
		.roof_shape = "flat",
		.wall_colour = "#d5d7d6",
		.wall_material = "concrete" };
	struct house pod = { .kind = "yes",
		.part = true,
		.height_m = 141.0,
		.min_height_m = 124.0,
		.levels = 4.0,
		.roof_shape = "dome",
		.roof_height_m = 4.0,
		.wall_colour = "#7f99a8",
		.wall_material = "glass",
		.roof_material = "metal" };
	struct house mast = { .kind = "yes",
		.part = true,
		.height_m = 215.0,
		.min_height_m = 166.0,
		.roof_shape = "pyramidal",
		.roof_height_m = 20.0,
		.wall_colour = "#b5473a",
		.wall_material = "metal",
		.roof_material = "metal" };
	struct site same = *site;
	same.scale = 1.0;
	round_part(&same, 0, 0, 12.5, &foot);
	round_part(&same, 0, 0, 4.2, &shaft);
	round_part(&same, 0, 0, 11.5, &pod);
	round_part(&same, 0, 0, 1.4, &mast);
}

/* The nearest block of one of the uses (bits) with room for a circle, or NULL. */
static struct block *nearest(struct synth *synth, struct dvec2 to, unsigned uses, double room_m)
{
	struct block *best = NULL;
	double best_distance = HUGE_VAL;
	for (size_t i = 0; i < synth->blocks.count; i++) {
		struct block *block = &synth->blocks.items[i];
		double distance = dvec2_length(dvec2_sub(block->middle, to));
		if (!(uses & 1u << block->use) || block->room_m < room_m || distance >= best_distance)
			continue;
		best = block;
		best_distance = distance;
	}
	return best;
}

/* Takes the block: paves it or lays a lawn, plants a ring of trees as far out as there is room. */
static struct site take(
	struct synth *synth, struct block *block, bool paved, double radius_m, double least_scale, double most_scale)
{
	struct rng rng = synth_rng(synth, 60, block->face);
	struct site site = { synth, block->middle, longest_side(&block->land.outer), 1.0 };
	site.scale = fmin(fmax(block->room_m * 0.93 / radius_m, least_scale), most_scale);
	block->use = BLOCK_LANDMARK;
	area_write(synth, &block->land, paved ? "highway" : "leisure", paved ? "pedestrian" : "park", NULL);
	double ring = block->room_m + 2.0, built = radius_m * site.scale + 5.0;
	for (int i = 0; i < 26; i++) {
		double angle = 2.0 * BLVD_PI * i / 26.0;
		struct dvec2 at = { site.middle.x + fmax(ring, built) * cos(angle),
			site.middle.y + fmax(ring, built) * sin(angle) };
		struct dvec2 further = { at.x + 2.0 * cos(angle), at.y + 2.0 * sin(angle) };
		if (polygon_contains(&block->land, at) && polygon_contains(&block->land, further))
			tree_write(synth, at, &rng, 8.0);
	}
	return site;
}

static void churches(struct synth *synth)
{
	static const char *const saints[] = { "St. Brigid", "St. Cosmas", "St. Dunstan", "Holy Cross", "St. Gallus",
		"St. Hedwig", "St. Ivo", "Our Lady", "St. Lucia", "St. Nicholas", "St. Odile", "St. Petronilla", "Trinity",
		"St. Ursula" };
	double step = 850.0, half_w = synth->options.width_m / 2.0, half_h = synth->options.height_m / 2.0;
	int count = 0;
	for (double y = -half_h + step * 0.5; y < half_h; y += step) {
		for (double x = -half_w + step * 0.5; x < half_w; x += step) {
			unsigned uses = 1u << BLOCK_PERIMETER | 1u << BLOCK_SLABS | 1u << BLOCK_VILLAS;
			struct block *block = nearest(synth, (struct dvec2){ x, y }, uses, 17.0);
			if (!block || dvec2_length(dvec2_sub(block->middle, (struct dvec2){ x, y })) > step * 0.5)
				continue;
			struct site site = take(synth, block, false, 20.0, 0.7, 1.15);
			char name[64];
			snprintf(name, sizeof(name), "%s Church", saints[count++ % 14]);
			church(&site, name);
		}
	}
}

void landmarks_write(struct synth *synth)
{
	const struct plan *plan = &synth->plan;
	unsigned town = 1u << BLOCK_PERIMETER | 1u << BLOCK_SLABS, old = 1u << BLOCK_OLD | 1u << BLOCK_SQUARE;
	double w = synth->options.width_m, h = synth->options.height_m;
	struct block *block = nearest(synth, plan_place(plan, plan->old_middle.x, plan->old_middle.y), old, 13.0);
	if (block) {
		struct site site = take(synth, block, true, 33.0, 0.4, 1.25);
		cathedral(&site, "St. Aurelia Cathedral");
	}
	block =
		nearest(synth, plan_place(plan, plan->old_middle.x + plan->old_radius_m * 0.5, plan->old_middle.y), old, 11.0);
	if (block) {
		struct site site = take(synth, block, true, 20.0, 0.55, 1.2);
		town_hall(&site);
	}
	block = nearest(
		synth, plan_place(plan, plan->old_middle.x + plan->old_radius_m * 1.4, plan->quay_m + 60.0), town, 24.0);
	if (block) {
		struct site site = take(synth, block, true, 34.0, 0.7, 1.2);
		opera(&site);
	}
	block = nearest(synth, (struct dvec2){ -0.30 * w, 0.30 * h }, town | 1u << BLOCK_VILLAS | 1u << BLOCK_PARK, 16.0);
	if (block && fmin(w, h) > 700.0) {
		struct site site = take(synth, block, false, 14.0, 1.0, 1.0);
		television_tower(&site);
	}
	churches(synth);
}
