/* Footprints and areas into the document. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tools/synth/synth.h"

#define SAME_PLACE_M 0.05 /* coordinates are rounded to a centimetre or so */

static uint32_t write_ring(struct synth *synth, const struct dvec2 *points, size_t count)
{
	node_array nodes = { 0 };
	struct dvec2 last = points[count - 1];
	for (size_t i = 0; i < count; last = points[i++])
		if (dvec2_length(dvec2_sub(points[i], last)) > SAME_PLACE_M)
			ARRAY_PUSH(&nodes, osm_doc_node(synth->doc, points[i]));
	ARRAY_PUSH(&nodes, nodes.items[0]);
	uint32_t way = osm_doc_way(synth->doc, nodes.items, nodes.count);
	ARRAY_FINISH(&nodes);
	return way;
}

static void tag_house(struct synth *synth, const struct house *house)
{
	struct osm_doc *doc = synth->doc;
	osm_doc_tag(doc, house->part ? "building:part" : "building", house->kind ? house->kind : "yes");
	osm_doc_tag_number(doc, "height", house->height_m, 1);
	if (house->min_height_m > 0.0)
		osm_doc_tag_number(doc, "min_height", house->min_height_m, 1);
	if (house->levels > 0.0)
		osm_doc_tag_number(doc, "building:levels", house->levels, 0);
	osm_doc_tag(doc, "roof:shape", house->roof_shape ? house->roof_shape : "flat");
	if (house->roof_height_m > 0.0)
		osm_doc_tag_number(doc, "roof:height", house->roof_height_m, 1);
	if (house->ridge_across)
		osm_doc_tag(doc, "roof:orientation", "across");
	osm_doc_tag(doc, "building:colour", house->wall_colour);
	osm_doc_tag(doc, "building:material", house->wall_material);
	osm_doc_tag(doc, "roof:colour", house->roof_colour);
	osm_doc_tag(doc, "roof:material", house->roof_material);
	osm_doc_tag(doc, "name", house->name);
	osm_doc_tag(doc, "shop", house->shop);
	if (house->key)
		osm_doc_tag(doc, house->key, house->value);
}

void building_write(struct synth *synth, const struct dvec2 *points, size_t count, const struct house *house)
{
	if (count < 3)
		return;
	write_ring(synth, points, count);
	tag_house(synth, house);
}

/* A relation's members come before it; its tags are its own. */
static void write_multipolygon(struct synth *synth, const struct polygon *polygon)
{
	uint32_t outer = write_ring(synth, polygon->outer.points, polygon->outer.count), inner[64];
	size_t holes = polygon->hole_count < 64 ? polygon->hole_count : 64;
	for (size_t i = 0; i < holes; i++)
		inner[i] = write_ring(synth, polygon->holes[i].points, polygon->holes[i].count);
	osm_doc_relation(synth->doc);
	osm_doc_member(synth->doc, 'w', outer, "outer");
	for (size_t i = 0; i < holes; i++)
		osm_doc_member(synth->doc, 'w', inner[i], "inner");
	osm_doc_tag(synth->doc, "type", "multipolygon");
}

void building_write_polygon(struct synth *synth, const struct polygon *polygon, const struct house *house)
{
	if (!polygon->hole_count) {
		building_write(synth, polygon->outer.points, polygon->outer.count, house);
		return;
	}
	write_multipolygon(synth, polygon);
	tag_house(synth, house);
}

void area_write(
	struct synth *synth, const struct polygon *polygon, const char *key, const char *value, const char *name)
{
	if (polygon->outer.count < 3)
		return;
	if (polygon->hole_count)
		write_multipolygon(synth, polygon);
	else
		write_ring(synth, polygon->outer.points, polygon->outer.count);
	osm_doc_tag(synth->doc, key, value);
	if (!strcmp(key, "highway"))
		osm_doc_tag(synth->doc, "area", "yes");
	osm_doc_tag(synth->doc, "name", name);
}

void tree_write(struct synth *synth, struct dvec2 at, struct rng *rng, double height_m)
{
	osm_doc_node(synth->doc, at);
	osm_doc_tag(synth->doc, "natural", "tree");
	osm_doc_tag_number(synth->doc, "height", height_m * rng_range(rng, 0.7, 1.3), 1);
}

void trees_scatter(struct synth *synth, const struct polygon *in, double per_hectare, struct rng *rng, double height_m)
{
	struct dvec2 min, max;
	ring_bounds(&in->outer, &min, &max);
	double step = 100.0 / sqrt(per_hectare * fmin(fmax(synth->options.density, 0.1), 4.0));
	for (double y = min.y; y < max.y; y += step) {
		for (double x = min.x; x < max.x; x += step) {
			struct dvec2 p = { x + rng_range(rng, 0.1, 0.9) * step, y + rng_range(rng, 0.1, 0.9) * step };
			if (rng_unit(rng) < 0.85 && polygon_contains(in, p))
				tree_write(synth, p, rng, height_m);
		}
	}
}
