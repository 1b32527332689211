/*
 * From OSM elements to features of the city: what every maker of features needs. Order of the makers: buildings, ways,
 * restrictions, areas, trees (rows keep clear of trees of their own); each marks the fate of the elements it met.
 */
#ifndef BLVD_TOOLS_READ_OSM_READER_H
#define BLVD_TOOLS_READ_OSM_READER_H

#include "tools/city/box_index.h"
#include "tools/city/city.h"
#include "tools/read/osm_store.h"
#include "tools/read/shape.h"
#include "tools/read/tag_value.h"

struct osm_reader {
	struct city *city;       /* borrowed; its frame is set */
	struct osm_store *store; /* borrowed; projected */
	struct shaper shaper;
	struct bounds built; /* of buildings and drivable ways */
	struct ring hull;    /* convex, around the same */
	bool clip;           /* --bbox: nothing beyond `built` is wanted */
	ARRAY(struct node_alias) aliases;
};

/* Two nodes at one place that follow one another in a way are one node. */
struct node_alias {
	int64_t from, to;
};

/* What the bounds of the built-up area are made of. */
bool osm_is_building(const struct osm_tags *tags);
bool osm_is_drivable(const struct osm_tags *tags);

void osm_make_buildings(struct osm_reader *reader);
void osm_make_ways(struct osm_reader *reader);
void osm_make_restrictions(struct osm_reader *reader);
void osm_make_areas(struct osm_reader *reader);
void osm_make_trees(struct osm_reader *reader);

/* Polygons of a closed way, or of a multipolygon's members, appended to `out`. `strict`: what should be an area but is
 * not closed is a fault; otherwise it is simply not an area. `cut_margin_m`: how far beyond the built-up area to draw
 * what the edge of the data cuts, or < 0: such things are dropped. Returns the number appended; marks fates. */
size_t osm_way_polygons(
	struct osm_reader *reader, struct osm_way *way, double least_m2, bool strict, polygon_array *out);
size_t osm_relation_polygons(
	struct osm_reader *reader, struct osm_relation *relation, double least_m2, double cut_margin_m, polygon_array *out);

/* The tags that say what a multipolygon is: its own, or (old style) those of its outer ways. */
struct osm_tags osm_relation_tags(const struct osm_reader *reader, const struct osm_relation *relation);

/* Reads a length or number tag; counts what is mended or bad. False when it is missing or bad or out of range. */
bool osm_length(struct osm_reader *reader, const struct osm_tags *tags, const char *key, int64_t id, double low,
	double high, double *out);
bool osm_number(struct osm_reader *reader, const struct osm_tags *tags, const char *key, int64_t id, double low,
	double high, double *out);

/* The nodes of a used way are used. */
void osm_mark_nodes(struct osm_reader *reader, const struct osm_way *way, enum element_fate fate);

/* A name to keep: "name" copied into the city, or NULL. */
const char *osm_name(struct osm_reader *reader, const struct osm_tags *tags);

#endif
