/* Parks with paths, a pond and trees; squares; woods. */
#include <math.h>

#include "tools/synth/synth.h"

static const char *const park_names[] = { "Belvedere Park", "City Park", "Linden Gardens", "Orangery Park",
	"Poplar Green", "Rose Garden", "Observatory Hill", "Chestnut Green", "Fountain Gardens", "Willow Park" };

static void write_path(struct synth *synth, const struct dvec2 *points, size_t count)
{
	node_array nodes = { 0 };
	for (size_t i = 0; i < count; i++)
		ARRAY_PUSH(&nodes, osm_doc_node(synth->doc, points[i]));
	osm_doc_way(synth->doc, nodes.items, nodes.count);
	osm_doc_tag(synth->doc, "highway", "footway");
	osm_doc_tag(synth->doc, "surface", "fine_gravel");
	osm_doc_tag(synth->doc, "width", "3");
	ARRAY_FINISH(&nodes);
}

/* Ways from the middle to points of the outline, a little bent. */
static void write_paths(struct synth *synth, const struct block *block, double from_m, struct rng *rng)
{
	const struct ring *ring = &block->land.outer;
	double start = rng_range(rng, 0.0, 1.0);
	for (int k = 0; k < 5; k++) {
		double angle = 2.0 * BLVD_PI * (k + start) / 5.0;
		struct dvec2 d = { cos(angle), sin(angle) };
		double reach = from_m;
		while (reach < 1000.0 && ring_contains(ring, dvec2_add(block->middle, dvec2_scale(d, reach + 2.0))))
			reach += 2.0;
		if (reach < from_m + 12.0)
			continue;
		struct dvec2 points[5];
		double bend = rng_range(rng, -0.12, 0.12) * (reach - from_m);
		for (int i = 0; i < 5; i++) {
			double f = i / 4.0, r = from_m + f * (reach - from_m), off = bend * sin(BLVD_PI * f);
			points[i] = (struct dvec2){ block->middle.x + d.x * r - d.y * off, block->middle.y + d.y * r + d.x * off };
		}
		write_path(synth, points, 5);
	}
}

static struct polygon blob(struct synth *synth, struct dvec2 middle, double radius, struct rng *rng)
{
	struct polygon out = { .outer = { POOL_ARRAY(&synth->city.pool, struct dvec2, 24), 24 } };
	double a = rng_range(rng, 0.0, 6.28), b = rng_range(rng, 0.0, 6.28);
	for (int i = 0; i < 24; i++) {
		double angle = 2.0 * BLVD_PI * i / 24.0,
			   r = radius * (0.82 + 0.12 * sin(2.0 * angle + a) + 0.06 * sin(3.0 * angle + b));
		out.outer.points[i] = (struct dvec2){ middle.x + r * cos(angle), middle.y + r * sin(angle) };
	}
	return out;
}

/* Trees of the lawn, not in the pond. */
static void plant(struct synth *synth, const struct block *block, double free_m, double per_hectare, struct rng *rng)
{
	struct polygon lawn = block->land;
	struct polygon middle = blob(synth, block->middle, free_m * 1.3, rng);
	struct ring hole = middle.outer;
	if (free_m > 0.0 && !lawn.hole_count) {
		lawn.holes = &hole;
		lawn.hole_count = 1;
	}
	trees_scatter(synth, &lawn, per_hectare, rng, 11.0);
}

void park_write(struct synth *synth, struct block *block)
{
	struct rng rng = synth_rng(synth, 40, block->face);
	bool large = block->room_m > 45.0;
	area_write(synth, &block->land, "leisure", "park", large || rng_unit(&rng) < 0.5 ? PICK(&rng, park_names) : NULL);
	double pond = large ? fmin(block->room_m * 0.38, 42.0) : 0.0;
	if (large) {
		struct polygon water = blob(synth, block->middle, pond, &rng);
		area_write(synth, &water, "natural", "water", NULL);
		osm_doc_tag(synth->doc, "water", "pond");
	}
	write_paths(synth, block, large ? pond * 1.15 : 4.0, &rng);
	plant(synth, block, pond, large ? 70.0 : 90.0, &rng);
}

void square_write(struct synth *synth, struct block *block)
{
	struct rng rng = synth_rng(synth, 41, block->face);
	area_write(synth, &block->land, "highway", "pedestrian", NULL);
	double ring = block->room_m * 0.6;
	int trees = (int)(2.0 * BLVD_PI * ring / 8.0);
	for (int i = 0; i < trees && ring > 3.0; i++) {
		double angle = 2.0 * BLVD_PI * i / trees;
		struct dvec2 at = { block->middle.x + ring * cos(angle), block->middle.y + ring * sin(angle) };
		tree_write(synth, at, &rng, 8.0);
	}
}

/* Copses beyond the last street, so that the city does not end at nothing. */
void outskirts_write(struct synth *synth)
{
	struct rng rng = synth_rng(synth, 42, 0);
	double half_w = synth->options.width_m / 2.0 + 20.0, half_h = synth->options.height_m / 2.0 + 20.0;
	int count = (int)((half_w + half_h) / 45.0);
	for (int i = 0; i < count; i++) {
		double along = rng_range(&rng, -1.0, 1.0), out = rng_range(&rng, 0.0, 120.0),
			   radius = rng_range(&rng, 30.0, 75.0);
		int side = (int)(rng_u32(&rng) % 4);
		double s = side < 2 ? along * half_w : (side == 2 ? -1.0 : 1.0) * (half_w + radius + out);
		double t = side >= 2 ? along * half_h : (side == 0 ? -1.0 : 1.0) * (half_h + radius + out);
		double clear = synth->plan.river ? synth->plan.quay_m + 90.0 : 0.0;
		double rail =
			synth->plan.railway ? fabs(s - (synth->plan.s.items[synth->plan.rail_column].at + 140.0)) : HUGE_VAL;
		struct polygon copse = blob(synth, plan_place(&synth->plan, s, t), radius, &rng);
		if (fabs(t) > clear && rail > 110.0)
			area_write(synth, &copse, "natural", "wood", NULL);
	}
}

void wood_write(struct synth *synth, struct block *block)
{
	area_write(synth, &block->land, "natural", "wood", NULL);
}
