/*
 * The elements of OSM files as they were read, sorted by id, with their tags interned. Stage: between the parsers
 * (osm_xml.c, osm_pbf_check.c and readosm) and the makers of features (osm_ways.c, osm_buildings.c, osm_areas.c). Every
 * element carries its fate, so that read == used + faulty + ignored holds by construction.
 */
#ifndef BLVD_TOOLS_READ_OSM_STORE_H
#define BLVD_TOOLS_READ_OSM_STORE_H

#include <stdbool.h>
#include <stdint.h>

#include "platform/base/geo.h"
#include "tools/city/pool.h"
#include "tools/city/report.h"

struct osm_tag {
	const char *key, *value; /* interned; UTF-8 without control characters */
};

struct osm_tags {
	const struct osm_tag *items; /* borrowed from the store */
	size_t count;
};

struct osm_node {
	int64_t id;
	double lat_deg, lon_deg;
	struct dvec2 at; /* city frame, once osm_store_project() ran */
	struct osm_tags tags;
	uint8_t fate; /* enum element_fate */
	bool bad;     /* no place on earth: treated as missing */
};

struct osm_way {
	int64_t id;
	const int64_t *refs;
	size_t ref_count;
	struct osm_tags tags;
	uint8_t fate;
	bool claimed; /* drawn by the relation that has it as a member */
	bool built;   /* a drivable street or (part of) a building: tells where the city is */
};

enum osm_member_kind { OSM_MEMBER_NODE, OSM_MEMBER_WAY, OSM_MEMBER_RELATION };
struct osm_member {
	int64_t ref;
	const char *role;
	enum osm_member_kind kind;
};

struct osm_relation {
	int64_t id;
	const struct osm_member *members;
	size_t member_count;
	struct osm_tags tags;
	uint8_t fate;
};

struct osm_store {
	struct pool pool;
	ARRAY(struct osm_node) nodes;
	ARRAY(struct osm_way) ways;
	ARRAY(struct osm_relation) relations;
	uint64_t duplicates[ELEMENT_KIND_COUNT]; /* the same id twice: the later one counts */
	struct report *report;                   /* borrowed */
	struct osm_interned *interned;
	size_t interned_count, interned_capacity;
};

void osm_store_init(struct osm_store *store, struct report *report);
void osm_store_finish(struct osm_store *store);

/* The parsers' side. `id` is of the element that has the text, for the report. Tags must come from osm_store_tags(). */
const char *osm_store_text(struct osm_store *store, const char *text, int64_t id);
void osm_store_add_node(struct osm_store *store, const struct osm_node *node);
void osm_store_add_way(struct osm_store *store, const struct osm_way *way);
void osm_store_add_relation(struct osm_store *store, const struct osm_relation *relation);

/* Sorts and drops duplicates: needed before any look-up. */
void osm_store_sort(struct osm_store *store);

/* NULL when the files do not hold it (or hold it without a place). */
struct osm_node *osm_store_node(const struct osm_store *store, int64_t id);
struct osm_way *osm_store_way(const struct osm_store *store, int64_t id);
struct osm_relation *osm_store_relation(const struct osm_store *store, int64_t id);

void osm_store_project(struct osm_store *store, const struct geo_frame *frame);

/* A used element stays used, whatever else it is part of. */
void osm_mark(uint8_t *fate, enum element_fate next);

/* Adds everything up in the report. */
void osm_store_tally(const struct osm_store *store);

/* The tag's value, or NULL. */
const char *osm_tag(const struct osm_tags *tags, const char *key);
bool osm_tag_is(const struct osm_tags *tags, const char *key, const char *value);
/* True when the key is there and its value is not "no". */
bool osm_tag_yes(const struct osm_tags *tags, const char *key);

#endif
