/*
 * Areas of the ground, watercourses, walls, hedges and trees. Large areas are clipped to a frame around the built-up
 * area: extracts carry whole lakes and forests. Tags: https://wiki.openstreetmap.org/wiki/Map_features.
 */
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/read/osm_cut.h"
#include "tools/read/osm_reader.h"

#define LEAST_AREA_M2 4.0
#define NOT_AN_AREA (-1)
#define ROW_SPACING_M 8.0
#define ROW_CLEARANCE_M 4.0

static const struct area_rule {
	const char *key, *value; /* value NULL: any but "no" */
	enum area_kind kind;
} area_rules[] = {
	{ "man_made", "bridge", AREA_BRIDGE },
	{ "man_made", "pier", AREA_PIER },
	{ "man_made", "breakwater", AREA_PIER },
	{ "man_made", "groyne", AREA_PIER },
	{ "natural", "water", AREA_WATER },
	{ "natural", "bay", NOT_AN_AREA }, /* named sea, drawn by the coastline */
	{ "waterway", "riverbank", AREA_WATER },
	{ "waterway", "dock", AREA_WATER },
	{ "landuse", "reservoir", AREA_WATER },
	{ "landuse", "basin", AREA_WATER },
	{ "leisure", "swimming_pool", AREA_WATER },
	{ "amenity", "fountain", AREA_WATER },
	{ "leisure", "pitch", AREA_PITCH },
	{ "leisure", "track", AREA_PITCH },
	{ "leisure", "playground", AREA_SAND },
	{ "leisure", "park", AREA_PARK },
	{ "leisure", "garden", AREA_GRASS },
	{ "leisure", "golf_course", AREA_GRASS },
	{ "leisure", "common", AREA_GRASS },
	{ "leisure", "dog_park", AREA_GRASS },
	{ "leisure", "marina", NOT_AN_AREA },
	{ "natural", "wood", AREA_FOREST },
	{ "landuse", "forest", AREA_FOREST },
	{ "natural", "scrub", AREA_FOREST },
	{ "natural", "grassland", AREA_GRASS },
	{ "natural", "heath", AREA_GRASS },
	{ "natural", "shrubbery", AREA_GRASS },
	{ "natural", "wetland", AREA_GRASS },
	{ "landuse", "grass", AREA_GRASS },
	{ "landuse", "meadow", AREA_GRASS },
	{ "landuse", "village_green", AREA_GRASS },
	{ "landuse", "flowerbed", AREA_GRASS },
	{ "landuse", "recreation_ground", AREA_GRASS },
	{ "landuse", "greenfield", AREA_GRASS },
	{ "landuse", "allotments", AREA_GRASS },
	{ "landuse", "orchard", AREA_GRASS },
	{ "landuse", "vineyard", AREA_FARM },
	{ "landuse", "farmland", AREA_FARM },
	{ "natural", "sand", AREA_SAND },
	{ "natural", "beach", AREA_SAND },
	{ "natural", "bare_rock", AREA_ROCK },
	{ "natural", "scree", AREA_ROCK },
	{ "natural", "shingle", AREA_ROCK },
	{ "natural", "rock", AREA_ROCK },
	{ "amenity", "parking", AREA_PARKING },
	{ "amenity", "marketplace", AREA_PEDESTRIAN },
	{ "highway", "pedestrian", AREA_PEDESTRIAN },
	{ "highway", "footway", AREA_PEDESTRIAN },
	{ "highway", "path", AREA_PEDESTRIAN },
	{ "highway", "service", AREA_PARKING },
	{ "highway", "residential", AREA_PARKING },
	{ "highway", "unclassified", AREA_PARKING },
	{ "place", "square", AREA_PEDESTRIAN },
	{ "railway", "platform", AREA_PEDESTRIAN },
	{ "public_transport", "platform", AREA_PEDESTRIAN },
	{ "landuse", "cemetery", AREA_CEMETERY },
	{ "amenity", "grave_yard", AREA_CEMETERY },
	{ "landuse", "construction", AREA_CONSTRUCTION },
	{ "landuse", "brownfield", AREA_CONSTRUCTION },
	{ "landuse", "railway", AREA_RAILWAY },
	{ "landuse", "commercial", AREA_COMMERCIAL },
	{ "landuse", "retail", AREA_COMMERCIAL },
};

static int area_kind_of(const struct osm_tags *tags)
{
	if (osm_is_building(tags))
		return NOT_AN_AREA;
	for (size_t i = 0; i < sizeof(area_rules) / sizeof(*area_rules); i++) {
		const char *value = osm_tag(tags, area_rules[i].key);
		if (value && !strcmp(value, area_rules[i].value))
			return (int)area_rules[i].kind;
	}
	return NOT_AN_AREA;
}

/* Closed streets and platforms are rings unless they say that they are areas. */
static bool must_say_area(const struct osm_tags *tags)
{
	return osm_tag(tags, "highway") || osm_tag(tags, "barrier") || osm_tag_is(tags, "man_made", "pier") ||
		   osm_tag_is(tags, "man_made", "breakwater") || osm_tag_is(tags, "man_made", "groyne");
}

/* What is an area whatever else: when it does not close, that is a fault. Piers, platforms, tracks are lines as well.
 */
static bool is_strict(const struct osm_tags *tags)
{
	static const char *const lines[] = { "highway", "barrier", "man_made", "railway", "public_transport", "waterway",
		"place", "natural", "area" };
	for (size_t i = 0; i < sizeof(lines) / sizeof(*lines); i++)
		if (osm_tag(tags, lines[i]))
			return osm_tag_is(tags, "natural", "water");
	return !osm_tag_is(tags, "leisure", "track");
}

static bool is_below_ground(const struct osm_tags *tags)
{
	const char *tunnel = osm_tag(tags, "tunnel"), *covered = osm_tag(tags, "covered");
	return (tunnel && strcmp(tunnel, "no") != 0) || (covered && !strcmp(covered, "yes")) ||
		   osm_tag_is(tags, "location", "underground") || osm_tag_is(tags, "parking", "underground") ||
		   osm_tag_is(tags, "parking", "multi-storey") || osm_tag_is(tags, "indoor", "yes");
}

/* Lakes and the sea are seen from afar. */
static double margin_of(int kind)
{
	return kind == AREA_WATER ? 1500.0 : 40.0;
}

static struct bounds frame_of(const struct osm_reader *reader, int kind)
{
	return bounds_grown(reader->built, reader->clip ? 0.0 : fmax(margin_of(kind), 400.0));
}

static size_t clip(struct osm_reader *reader, int64_t id, int kind, const struct polygon *polygon, polygon_array *out)
{
	struct bounds frame = frame_of(reader, kind);
	struct dvec2 min, max;
	ring_bounds(&polygon->outer, &min, &max);
	if (min.x >= frame.min.x && min.y >= frame.min.y && max.x <= frame.max.x && max.y <= frame.max.y) {
		ARRAY_PUSH(out, *polygon);
		return 1;
	}
	if (max.x <= frame.min.x || max.y <= frame.min.y || min.x >= frame.max.x || min.y >= frame.max.y)
		return 0;
	GEOSGeometry *whole = shape_to_geos(&reader->shaper, polygon);
	GEOSGeometry *part =
		whole ? GEOSClipByRect_r(reader->shaper.geos, whole, frame.min.x, frame.min.y, frame.max.x, frame.max.y) : NULL;
	if (!part)
		report_fault(reader->city->report, FAULT_BAD_GEOMETRY, FAULT_DROPPED, id);
	size_t count = shape_from_geos(&reader->shaper, part, LEAST_AREA_M2, out);
	GEOSGeom_destroy_r(reader->shaper.geos, whole);
	GEOSGeom_destroy_r(reader->shaper.geos, part);
	return count;
}

static void push_areas(
	struct osm_reader *reader, const struct osm_tags *tags, int64_t id, int kind, const polygon_array *polygons)
{
	double layer = 0.0;
	osm_number(reader, tags, "layer", id, -10.0, 10.0, &layer);
	struct area area = { .id = id, .kind = (enum area_kind)kind, .layer = (int)layer, .name = osm_name(reader, tags) };
	polygon_array clipped = { 0 };
	for (size_t i = 0; i < polygons->count; i++)
		clip(reader, id, kind, &polygons->items[i], &clipped);
	for (size_t i = 0; i < clipped.count; i++) {
		area.shape = clipped.items[i];
		ARRAY_PUSH(&reader->city->areas, area);
	}
	ARRAY_FINISH(&clipped);
}

static void claim_outer(struct osm_reader *reader, const struct osm_relation *relation, int kind)
{
	for (size_t i = 0; i < relation->member_count; i++) {
		struct osm_way *way =
			relation->members[i].kind == OSM_MEMBER_WAY && strcmp(relation->members[i].role, "inner") != 0
				? osm_store_way(reader->store, relation->members[i].ref)
				: NULL;
		if (way && area_kind_of(&way->tags) == kind)
			way->claimed = true;
	}
}

static void areas_of_relations(struct osm_reader *reader)
{
	polygon_array polygons = { 0 };
	for (size_t i = 0; i < reader->store->relations.count; i++) {
		struct osm_relation *relation = &reader->store->relations.items[i];
		if (!osm_tag_is(&relation->tags, "type", "multipolygon"))
			continue;
		struct osm_tags tags = osm_relation_tags(reader, relation);
		int kind = area_kind_of(&tags);
		if (kind == NOT_AN_AREA || is_below_ground(&tags))
			continue;
		polygons.count = 0;
		if (osm_relation_polygons(reader, relation, LEAST_AREA_M2, margin_of(kind), &polygons))
			claim_outer(reader, relation, kind);
		push_areas(reader, &tags, -relation->id, kind, &polygons);
	}
	ARRAY_FINISH(&polygons);
}

static void areas_of_ways(struct osm_reader *reader)
{
	polygon_array polygons = { 0 };
	for (size_t i = 0; i < reader->store->ways.count; i++) {
		struct osm_way *way = &reader->store->ways.items[i];
		const struct osm_tags *tags = &way->tags;
		int kind = way->claimed || !tags->count ? NOT_AN_AREA : area_kind_of(tags);
		if (kind == NOT_AN_AREA || is_below_ground(tags) || osm_tag_is(tags, "area", "no") ||
			(must_say_area(tags) && !osm_tag_is(tags, "area", "yes") && kind != AREA_BRIDGE))
			continue;
		polygons.count = 0;
		osm_way_polygons(reader, way, LEAST_AREA_M2, is_strict(tags), &polygons);
		push_areas(reader, tags, way->id, kind, &polygons);
	}
	ARRAY_FINISH(&polygons);
}

/* Land is left of a coastline (https://wiki.openstreetmap.org/wiki/Tag:natural=coastline). */
static void make_sea(struct osm_reader *reader)
{
	chain_array chains = { 0 }, open = { 0 };
	polygon_array polygons = { 0 };
	int64_t id = 0;
	for (size_t i = 0; i < reader->store->ways.count; i++) {
		struct osm_way *way = &reader->store->ways.items[i];
		if (!osm_tag_is(&way->tags, "natural", "coastline"))
			continue;
		chains_add_way(reader, way, &chains);
		osm_mark(&way->fate, ELEMENT_USED);
		osm_mark_nodes(reader, way, ELEMENT_USED);
		id = id ? id : way->id;
	}
	chains_join(&chains, false);
	size_t kept = 0;
	for (size_t i = 0; i < chains.count; i++) {
		bool closed =
			chains.items[i].count >= 4 && chains.items[i].refs[0] == chains.items[i].refs[chains.items[i].count - 1];
		if (closed)
			chains.items[kept++] = chains.items[i];
		else
			ARRAY_PUSH(&open, chains.items[i]);
	}
	chains.count = kept;
	if (chains.count + open.count) {
		if (cut_polygons(reader, &chains, &open, margin_of(AREA_WATER), true, &polygons))
			push_areas(reader, &(struct osm_tags){ 0 }, id, AREA_WATER, &polygons);
		if (open.count && !cut_reaches_out(reader, &open))
			report_fault(reader->city->report, FAULT_OPEN_RING, FAULT_MENDED, id);
	}
	ARRAY_FINISH(&polygons);
	chains_finish(&chains);
	chains_finish(&open);
}

static const struct line_rule {
	const char *key, *value;
	enum line_kind kind;
	double width_m, height_m;
} line_rules[] = {
	{ "waterway", "river", LINE_RIVER, 12.0, 0.0 },
	{ "waterway", "canal", LINE_RIVER, 8.0, 0.0 },
	{ "waterway", "stream", LINE_STREAM, 2.0, 0.0 },
	{ "waterway", "ditch", LINE_STREAM, 1.0, 0.0 },
	{ "waterway", "drain", LINE_STREAM, 1.0, 0.0 },
	{ "barrier", "wall", LINE_WALL, 0.3, 1.8 },
	{ "barrier", "city_wall", LINE_WALL, 1.5, 6.0 },
	{ "barrier", "retaining_wall", LINE_WALL, 0.4, 1.2 },
	{ "barrier", "hedge", LINE_HEDGE, 0.8, 1.4 },
	{ "barrier", "fence", LINE_FENCE, 0.06, 1.4 },
};

static const struct line_rule *line_rule_of(const struct osm_tags *tags)
{
	for (size_t i = 0; i < sizeof(line_rules) / sizeof(*line_rules); i++)
		if (osm_tag_is(tags, line_rules[i].key, line_rules[i].value))
			return &line_rules[i];
	return NULL;
}

static bool touches_frame(const struct osm_reader *reader, const struct dvec2 *points, size_t count)
{
	struct bounds frame = frame_of(reader, AREA_PARK);
	struct ring ring = { (struct dvec2 *)(uintptr_t)points, count };
	struct dvec2 min, max;
	ring_bounds(&ring, &min, &max);
	return max.x >= frame.min.x && max.y >= frame.min.y && min.x <= frame.max.x && min.y <= frame.max.y;
}

static void make_line(struct osm_reader *reader, struct osm_way *way, const struct line_rule *rule)
{
	struct line line = { .id = way->id, .kind = rule->kind, .width_m = rule->width_m, .height_m = rule->height_m };
	struct dvec2 *points = POOL_ARRAY(&reader->city->pool, struct dvec2, way->ref_count);
	size_t missing = 0;
	for (size_t i = 0; i < way->ref_count; i++) {
		const struct osm_node *node = osm_store_node(reader->store, way->refs[i]);
		missing += !node;
		if (node && (!line.count || dvec2_length(dvec2_sub(points[line.count - 1], node->at)) > 1e-3))
			points[line.count++] = node->at;
	}
	if (missing)
		report_fault(reader->city->report, FAULT_MISSING_NODE, line.count >= 2 ? FAULT_MENDED : FAULT_DROPPED, way->id);
	else if (line.count < 2)
		report_fault(reader->city->report, FAULT_DEGENERATE_WAY, FAULT_DROPPED, way->id);
	if (line.count < 2) {
		osm_mark(&way->fate, ELEMENT_FAULTY);
		return;
	}
	if (!touches_frame(reader, points, line.count))
		return;
	double layer = 0.0;
	osm_number(reader, &way->tags, "layer", way->id, -10.0, 10.0, &layer);
	osm_length(reader, &way->tags, "width", way->id, 0.05, 200.0, &line.width_m);
	if (line.height_m > 0.0)
		osm_length(reader, &way->tags, "height", way->id, 0.1, 30.0, &line.height_m);
	line.points = points;
	line.layer = (int)layer;
	line.tunnel = osm_tag_yes(&way->tags, "tunnel");
	ARRAY_PUSH(&reader->city->lines, line);
	osm_mark(&way->fate, ELEMENT_USED);
	osm_mark_nodes(reader, way, ELEMENT_USED);
}

void osm_make_areas(struct osm_reader *reader)
{
	make_sea(reader);
	areas_of_relations(reader);
	areas_of_ways(reader);
	for (size_t i = 0; i < reader->store->ways.count; i++) {
		struct osm_way *way = &reader->store->ways.items[i];
		const struct line_rule *rule = line_rule_of(&way->tags);
		if (rule)
			make_line(reader, way, rule);
	}
}

static bool is_needle(const struct osm_tags *tags)
{
	static const char *const genera[] = { "Pinus", "Picea", "Abies", "Cedrus", "Cupressus", "Larix", "Taxus", "Sequoia",
		"Sequoiadendron", "Thuja", "Metasequoia", "Juniperus" };
	const char *leaf = osm_tag(tags, "leaf_type"), *genus = osm_tag(tags, "genus"), *species = osm_tag(tags, "species");
	if (leaf)
		return !strcmp(leaf, "needleleaved");
	const char *name = genus ? genus : species;
	for (size_t i = 0; name && i < sizeof(genera) / sizeof(*genera); i++)
		if (!strncmp(name, genera[i], strlen(genera[i])))
			return true;
	return false;
}

/* Trees of a size that belongs to their id: 7 to 13 m, crowns a third as wide as the tree is high. */
static struct tree tree_at(struct dvec2 at, uint64_t key, bool needle)
{
	double unit = (double)(hash_u64(key) >> 40) / 16777216.0;
	double height = 7.0 + 6.0 * unit + (needle ? 4.0 : 0.0);
	double radius = height * (needle ? 0.18 : 0.30);
	return (struct tree){ .at = at, .height_m = (float)height, .crown_radius_m = (float)radius, .needle = needle };
}

static bool beyond_frame(const struct osm_reader *reader, struct dvec2 at)
{
	return !touches_frame(reader, &at, 1);
}

static void make_tree(struct osm_reader *reader, struct osm_node *node)
{
	if (beyond_frame(reader, node->at))
		return;
	struct tree tree = tree_at(node->at, (uint64_t)node->id, is_needle(&node->tags));
	double height = 0.0, crown = 0.0;
	if (osm_length(reader, &node->tags, "height", node->id, 0.5, 90.0, &height)) {
		tree.crown_radius_m *= (float)height / tree.height_m;
		tree.height_m = (float)height;
	}
	if (osm_length(reader, &node->tags, "diameter_crown", node->id, 0.3, 40.0, &crown))
		tree.crown_radius_m = (float)crown / 2.0f;
	tree.from_data = true;
	ARRAY_PUSH(&reader->city->trees, tree);
	osm_mark(&node->fate, ELEMENT_USED);
}

/* A tree of its own at a node of the row, or near: the row is there already. */
static bool has_trees(const struct osm_reader *reader, const struct osm_way *way)
{
	for (size_t i = 0; i < way->ref_count; i++) {
		const struct osm_node *node = osm_store_node(reader->store, way->refs[i]);
		if (node && osm_tag_is(&node->tags, "natural", "tree"))
			return true;
	}
	return false;
}

static bool is_free(const struct city *city, size_t count, struct dvec2 at)
{
	for (size_t i = 0; i < count; i++) {
		struct dvec2 d = dvec2_sub(city->trees.items[i].at, at);
		if (fabs(d.x) < ROW_CLEARANCE_M && fabs(d.y) < ROW_CLEARANCE_M)
			return false;
	}
	return true;
}

static void plant_row(struct osm_reader *reader, struct osm_way *way, size_t trees_of_data)
{
	double travelled = ROW_SPACING_M; /* the first tree stands at the row's start */
	bool needle = is_needle(&way->tags);
	uint64_t key = (uint64_t)way->id << 12;
	const struct osm_node *last = NULL;
	for (size_t i = 0; i < way->ref_count; i++) {
		const struct osm_node *node = osm_store_node(reader->store, way->refs[i]);
		if (!node)
			continue;
		struct dvec2 along = last ? dvec2_sub(node->at, last->at) : (struct dvec2){ 0.0, 0.0 };
		double length = dvec2_length(along), at = ROW_SPACING_M - travelled;
		for (; last && at <= length && length > 0.0; at += ROW_SPACING_M) {
			struct dvec2 place = dvec2_add(last->at, dvec2_scale(along, at / length));
			if (!beyond_frame(reader, place) && is_free(reader->city, trees_of_data, place))
				ARRAY_PUSH(&reader->city->trees, tree_at(place, key++, needle));
		}
		if (last)
			travelled = length - (at - ROW_SPACING_M);
		last = node;
	}
	osm_mark(&way->fate, ELEMENT_USED);
	osm_mark_nodes(reader, way, ELEMENT_USED);
}

void osm_make_trees(struct osm_reader *reader)
{
	for (size_t i = 0; i < reader->store->nodes.count; i++) {
		struct osm_node *node = &reader->store->nodes.items[i];
		if (!node->bad && osm_tag_is(&node->tags, "natural", "tree"))
			make_tree(reader, node);
	}
	size_t trees_of_data = reader->city->trees.count;
	for (size_t i = 0; i < reader->store->ways.count; i++) {
		struct osm_way *way = &reader->store->ways.items[i];
		if (osm_tag_is(&way->tags, "natural", "tree_row") && way->ref_count >= 2 && !has_trees(reader, way))
			plant_row(reader, way, trees_of_data);
	}
}
