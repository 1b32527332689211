/*
 * Buildings and their parts, as the tags say; nothing is inferred here. Tags:
 * https://wiki.openstreetmap.org/wiki/Simple_3D_Buildings.
 */
#include <stdlib.h>
#include <string.h>

#include "tools/read/osm_kind.h"
#include "tools/read/osm_reader.h"

#define HEIGHT_LIMIT_M 1000.0
#define LEVELS_LIMIT 200.0
#define LEAST_AREA_M2 1.0

static const struct tag_word building_words[] = {
	{ "house", BUILDING_HOUSE },
	{ "detached", BUILDING_HOUSE },
	{ "semidetached_house", BUILDING_HOUSE },
	{ "semi", BUILDING_HOUSE },
	{ "terrace", BUILDING_HOUSE },
	{ "villa", BUILDING_HOUSE },
	{ "bungalow", BUILDING_HOUSE },
	{ "cabin", BUILDING_HOUSE },
	{ "farm", BUILDING_HOUSE },
	{ "houseboat", BUILDING_HOUSE },
	{ "static_caravan", BUILDING_HOUSE },
	{ "apartments", BUILDING_APARTMENTS },
	{ "residential", BUILDING_APARTMENTS },
	{ "dormitory", BUILDING_APARTMENTS },
	{ "hotel", BUILDING_APARTMENTS },
	{ "mixed_use", BUILDING_APARTMENTS },
	{ "mixed", BUILDING_APARTMENTS },
	{ "commercial", BUILDING_COMMERCIAL },
	{ "office", BUILDING_COMMERCIAL },
	{ "offices", BUILDING_COMMERCIAL },
	{ "bank", BUILDING_COMMERCIAL },
	{ "skyscraper", BUILDING_COMMERCIAL },
	{ "retail", BUILDING_RETAIL },
	{ "supermarket", BUILDING_RETAIL },
	{ "shop", BUILDING_RETAIL },
	{ "mall", BUILDING_RETAIL },
	{ "kiosk", BUILDING_RETAIL },
	{ "restaurant", BUILDING_RETAIL },
	{ "industrial", BUILDING_INDUSTRIAL },
	{ "warehouse", BUILDING_INDUSTRIAL },
	{ "factory", BUILDING_INDUSTRIAL },
	{ "manufacture", BUILDING_INDUSTRIAL },
	{ "hangar", BUILDING_INDUSTRIAL },
	{ "depot", BUILDING_INDUSTRIAL },
	{ "barn", BUILDING_INDUSTRIAL },
	{ "farm_auxiliary", BUILDING_INDUSTRIAL },
	{ "stable", BUILDING_INDUSTRIAL },
	{ "service", BUILDING_INDUSTRIAL },
	{ "transformer_tower", BUILDING_TOWER },
	{ "school", BUILDING_CIVIC },
	{ "kindergarten", BUILDING_CIVIC },
	{ "university", BUILDING_CIVIC },
	{ "college", BUILDING_CIVIC },
	{ "hospital", BUILDING_CIVIC },
	{ "public", BUILDING_CIVIC },
	{ "civic", BUILDING_CIVIC },
	{ "government", BUILDING_CIVIC },
	{ "train_station", BUILDING_CIVIC },
	{ "transportation", BUILDING_CIVIC },
	{ "museum", BUILDING_CIVIC },
	{ "theatre", BUILDING_CIVIC },
	{ "library", BUILDING_CIVIC },
	{ "fire_station", BUILDING_CIVIC },
	{ "sports_hall", BUILDING_CIVIC },
	{ "sports_centre", BUILDING_CIVIC },
	{ "stadium", BUILDING_CIVIC },
	{ "castle", BUILDING_CIVIC },
	{ "palace", BUILDING_CIVIC },
	{ "church", BUILDING_CHURCH },
	{ "cathedral", BUILDING_CHURCH },
	{ "chapel", BUILDING_CHURCH },
	{ "basilica", BUILDING_CHURCH },
	{ "mosque", BUILDING_CHURCH },
	{ "synagogue", BUILDING_CHURCH },
	{ "temple", BUILDING_CHURCH },
	{ "shrine", BUILDING_CHURCH },
	{ "monastery", BUILDING_CHURCH },
	{ "religious", BUILDING_CHURCH },
	{ "tower", BUILDING_TOWER },
	{ "bell_tower", BUILDING_TOWER },
	{ "campanile", BUILDING_TOWER },
	{ "water_tower", BUILDING_TOWER },
	{ "chimney", BUILDING_TOWER },
	{ "silo", BUILDING_TOWER },
	{ "garage", BUILDING_GARAGE },
	{ "garages", BUILDING_GARAGE },
	{ "shed", BUILDING_GARAGE },
	{ "hut", BUILDING_GARAGE },
	{ "carport", BUILDING_ROOF },
	{ "parking", BUILDING_INDUSTRIAL },
	{ "roof", BUILDING_ROOF },
	{ "canopy", BUILDING_ROOF },
	{ "greenhouse", BUILDING_GREENHOUSE },
	{ "conservatory", BUILDING_GREENHOUSE },
	{ NULL, 0 },
};

static const struct tag_word amenity_words[] = {
	{ "place_of_worship", BUILDING_CHURCH },
	{ "school", BUILDING_CIVIC },
	{ "kindergarten", BUILDING_CIVIC },
	{ "university", BUILDING_CIVIC },
	{ "college", BUILDING_CIVIC },
	{ "hospital", BUILDING_CIVIC },
	{ "clinic", BUILDING_CIVIC },
	{ "townhall", BUILDING_CIVIC },
	{ "courthouse", BUILDING_CIVIC },
	{ "police", BUILDING_CIVIC },
	{ "fire_station", BUILDING_CIVIC },
	{ "library", BUILDING_CIVIC },
	{ "theatre", BUILDING_CIVIC },
	{ "community_centre", BUILDING_CIVIC },
	{ "fuel", BUILDING_ROOF },
	{ "shelter", BUILDING_ROOF },
	{ NULL, 0 },
};

int osm_building_kind(const char *value)
{
	return tag_word_find(building_words, value, -1);
}

static const char *building_value(const struct osm_tags *tags)
{
	const char *value = osm_tag(tags, "building");
	return value && strcmp(value, "no") != 0 ? value : NULL;
}

static const char *part_value(const struct osm_tags *tags)
{
	const char *value = osm_tag(tags, "building:part");
	return value && strcmp(value, "no") != 0 ? value : NULL;
}

static bool is_underground(const struct osm_tags *tags)
{
	const char *location = osm_tag(tags, "location"), *layer = osm_tag(tags, "layer");
	return (location && !strcmp(location, "underground")) || osm_tag_is(tags, "parking", "underground") ||
		   (layer && *layer == '-' && !osm_tag(tags, "height"));
}

bool osm_is_building(const struct osm_tags *tags)
{
	return (building_value(tags) || part_value(tags)) && !is_underground(tags);
}

static void set_kind(const struct osm_tags *tags, struct building *building)
{
	const char *value = building->is_part ? part_value(tags) : building_value(tags);
	const char *amenity = osm_tag(tags, "amenity"), *man_made = osm_tag(tags, "man_made");
	int kind = value ? osm_building_kind(value) : -1;
	if (man_made && (!strcmp(man_made, "tower") || !strcmp(man_made, "water_tower") || !strcmp(man_made, "chimney") ||
						!strcmp(man_made, "silo")))
		kind = BUILDING_TOWER;
	if (kind < 0 && amenity)
		kind = tag_word_find(amenity_words, amenity, -1);
	if (kind < 0 && osm_tag_yes(tags, "office"))
		kind = BUILDING_COMMERCIAL;
	if (kind < 0 && osm_tag_is(tags, "shop", "supermarket"))
		kind = BUILDING_RETAIL;
	if (kind < 0 && (osm_tag_is(tags, "tourism", "museum") || osm_tag_is(tags, "public_transport", "station") ||
						osm_tag_is(tags, "railway", "station") || osm_tag_is(tags, "historic", "castle")))
		kind = BUILDING_CIVIC;
	if (kind < 0 && osm_tag_is(tags, "power", "substation"))
		kind = BUILDING_INDUSTRIAL;
	building->kind_given = kind >= 0;
	building->kind = kind >= 0 ? (enum building_kind)kind : BUILDING_APARTMENTS;
	const char *historic = osm_tag(tags, "historic");
	building->landmark =
		!building->is_part &&
		(building->kind == BUILDING_TOWER || (building->kind == BUILDING_CHURCH && osm_tag(tags, "name")) ||
			(historic && (!strcmp(historic, "monument") || !strcmp(historic, "castle"))));
	building->shop =
		building->kind == BUILDING_RETAIL || osm_tag_yes(tags, "shop") ||
		(amenity && (!strcmp(amenity, "restaurant") || !strcmp(amenity, "cafe") || !strcmp(amenity, "bank") ||
						!strcmp(amenity, "pharmacy") || !strcmp(amenity, "bar")));
}

static void set_heights(struct osm_reader *reader, const struct osm_tags *tags, struct building *building)
{
	int64_t id = building->id;
	if (!osm_length(reader, tags, "height", id, 0.2, HEIGHT_LIMIT_M, &building->height_m))
		osm_length(reader, tags, "building:height", id, 0.2, HEIGHT_LIMIT_M, &building->height_m);
	building->height_source = HEIGHT_TAGGED;
	if (!osm_length(reader, tags, "min_height", id, 0.0, HEIGHT_LIMIT_M, &building->min_height_m))
		osm_length(reader, tags, "building:min_height", id, 0.0, HEIGHT_LIMIT_M, &building->min_height_m);
	if (!osm_number(reader, tags, "building:levels", id, 0.0, LEVELS_LIMIT, &building->levels))
		osm_number(reader, tags, "levels", id, 0.0, LEVELS_LIMIT, &building->levels);
	if (!osm_number(reader, tags, "building:min_level", id, 0.0, LEVELS_LIMIT, &building->min_level))
		osm_number(reader, tags, "min_level", id, 0.0, LEVELS_LIMIT, &building->min_level);
	double roof_levels = 0.0;
	if (!osm_length(reader, tags, "roof:height", id, 0.0, HEIGHT_LIMIT_M, &building->roof_height_m) &&
		osm_number(reader, tags, "roof:levels", id, 0.0, 20.0, &roof_levels))
		building->roof_height_m = roof_levels * 3.0;
}

static void set_colour(struct osm_reader *reader, const struct osm_tags *tags, const char *key, const char *other_key,
	int64_t id, struct colour *out)
{
	const char *value = osm_tag(tags, key);
	if (!value)
		value = osm_tag(tags, other_key);
	if (!value)
		return;
	enum tag_verdict verdict = tag_colour(value, out);
	if (verdict != TAG_GOOD)
		report_fault(reader->city->report, FAULT_BAD_COLOUR, verdict == TAG_BAD ? FAULT_DROPPED : FAULT_MENDED, id);
}

static void set_looks(struct osm_reader *reader, const struct osm_tags *tags, struct building *building)
{
	const char *shape = osm_tag(tags, "roof:shape"), *direction = osm_tag(tags, "roof:direction");
	const char *wall = osm_tag(tags, "building:material"), *roof = osm_tag(tags, "roof:material");
	if (!shape)
		shape = osm_tag(tags, "building:roof:shape");
	building->roof_shape = shape ? tag_roof_shape(shape) : ROOF_UNKNOWN;
	building->roof_direction_deg = NAN;
	if (direction) {
		enum tag_verdict verdict = tag_direction_deg(direction, &building->roof_direction_deg);
		if (verdict != TAG_GOOD)
			report_fault(reader->city->report, FAULT_BAD_NUMBER, verdict == TAG_BAD ? FAULT_DROPPED : FAULT_MENDED,
				building->id);
	}
	building->ridge_across = osm_tag_is(tags, "roof:orientation", "across");
	building->wall_material = wall ? tag_wall_material(wall) : WALL_UNKNOWN;
	if (!wall && (wall = osm_tag(tags, "building:facade:material")))
		building->wall_material = tag_wall_material(wall);
	building->roof_material = roof ? tag_roof_material(roof) : ROOFING_UNKNOWN;
	set_colour(reader, tags, "building:colour", "building:color", building->id, &building->wall_colour);
	set_colour(reader, tags, "roof:colour", "roof:color", building->id, &building->roof_colour);
	const char *start = osm_tag(tags, "start_date");
	if (start)
		building->start_year = fmax(0.0, strtod(start, NULL));
	if (!(building->start_year >= 500.0 && building->start_year <= 2100.0))
		building->start_year = 0.0;
}

static void push_buildings(
	struct osm_reader *reader, const struct osm_tags *tags, int64_t id, const polygon_array *polygons, size_t first)
{
	struct building building = {
		.id = id,
		.is_part = !building_value(tags) && part_value(tags),
		.outline = PKG_NONE,
		.face = PKG_NONE,
	};
	set_kind(tags, &building);
	set_heights(reader, tags, &building);
	set_looks(reader, tags, &building);
	building.name = osm_name(reader, tags);
	for (size_t i = first; i < polygons->count; i++) {
		building.footprint = polygons->items[i];
		ARRAY_PUSH(&reader->city->buildings, building);
	}
}

static bool outside(const struct osm_reader *reader, const struct polygon *polygon)
{
	struct dvec2 min, max;
	ring_bounds(&polygon->outer, &min, &max);
	double x = (min.x + max.x) / 2.0, y = (min.y + max.y) / 2.0;
	return reader->clip &&
		   (x < reader->built.min.x || x > reader->built.max.x || y < reader->built.min.y || y > reader->built.max.y);
}

/* Buildings belong to the side of the bounds that their middle is on. */
static void drop_outside(const struct osm_reader *reader, polygon_array *polygons)
{
	size_t kept = 0;
	for (size_t i = 0; i < polygons->count; i++)
		if (!outside(reader, &polygons->items[i]))
			polygons->items[kept++] = polygons->items[i];
	polygons->count = kept;
}

/* Old style: the outer ways carry the tags and would be drawn a second time. */
static void claim_outer(struct osm_reader *reader, const struct osm_relation *relation)
{
	for (size_t i = 0; i < relation->member_count; i++) {
		struct osm_way *way =
			relation->members[i].kind == OSM_MEMBER_WAY && strcmp(relation->members[i].role, "inner") != 0
				? osm_store_way(reader->store, relation->members[i].ref)
				: NULL;
		if (way && building_value(&way->tags) && !part_value(&way->tags))
			way->claimed = true;
	}
}

static bool is_shop(const struct osm_tags *tags)
{
	static const char *const amenities[] = { "restaurant", "cafe", "bar", "pub", "fast_food", "bank", "pharmacy",
		"ice_cream", "post_office", "nightclub", "bureau_de_change", "cinema" };
	if (osm_tag_yes(tags, "shop") && !osm_tag_is(tags, "shop", "vacant"))
		return true;
	for (size_t i = 0; i < sizeof(amenities) / sizeof(*amenities); i++)
		if (osm_tag_is(tags, "amenity", amenities[i]))
			return true;
	return false;
}

/* Shops are mostly mapped as nodes inside the building. */
static void mark_shops(struct osm_reader *reader)
{
	struct city *city = reader->city;
	bounds_array boxes = { 0 };
	index_array near = { 0 };
	struct box_index index;
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct bounds box;
		ring_bounds(&city->buildings.items[i].footprint.outer, &box.min, &box.max);
		ARRAY_PUSH(&boxes, box);
	}
	box_index_build(&index, boxes.items, boxes.count, 40.0);
	for (size_t i = 0; i < reader->store->nodes.count; i++) {
		struct osm_node *node = &reader->store->nodes.items[i];
		if (node->bad || !node->tags.count || !is_shop(&node->tags))
			continue;
		box_index_find(&index, (struct bounds){ node->at, node->at }, &near);
		for (size_t k = 0; k < near.count; k++) {
			struct building *building = &city->buildings.items[near.items[k]];
			if (building->min_height_m > 1.0 || !polygon_contains(&building->footprint, node->at))
				continue;
			building->shop = true;
			osm_mark(&node->fate, ELEMENT_USED);
		}
	}
	box_index_finish(&index);
	ARRAY_FINISH(&boxes);
	ARRAY_FINISH(&near);
}

void osm_make_buildings(struct osm_reader *reader)
{
	polygon_array polygons = { 0 };
	for (size_t i = 0; i < reader->store->relations.count; i++) {
		struct osm_relation *relation = &reader->store->relations.items[i];
		if (!osm_tag_is(&relation->tags, "type", "multipolygon"))
			continue;
		struct osm_tags tags = osm_relation_tags(reader, relation);
		if (!osm_is_building(&tags))
			continue;
		polygons.count = 0;
		if (osm_relation_polygons(reader, relation, LEAST_AREA_M2, -1.0, &polygons))
			claim_outer(reader, relation);
		drop_outside(reader, &polygons);
		push_buildings(reader, &tags, -relation->id, &polygons, 0);
	}
	for (size_t i = 0; i < reader->store->ways.count; i++) {
		struct osm_way *way = &reader->store->ways.items[i];
		if (way->claimed || !osm_is_building(&way->tags))
			continue;
		polygons.count = 0;
		osm_way_polygons(reader, way, LEAST_AREA_M2, true, &polygons);
		drop_outside(reader, &polygons);
		push_buildings(reader, &way->tags, way->id, &polygons, 0);
	}
	ARRAY_FINISH(&polygons);
	mark_shops(reader);
}
