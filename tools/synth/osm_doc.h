/*
 * An OSM document in memory, written as OSM XML: nodes, ways and relations with tags, ids from 1 in the order in which
 * they are added. Coordinates are rounded to 1e-7 degree when they are added, as the format has them.
 */
#ifndef BLVD_TOOLS_SYNTH_OSM_DOC_H
#define BLVD_TOOLS_SYNTH_OSM_DOC_H

#include <stdint.h>

#include "platform/base/geo.h"
#include "tools/city/pool.h"

typedef ARRAY(uint32_t) node_array; /* node ids */

struct osm_doc;

struct osm_doc *osm_doc_new(struct geo_frame frame);
void osm_doc_free(struct osm_doc *doc);

/* Each starts a new element; osm_tag_add() tags the newest one. Returns its id. */
uint32_t osm_doc_node(struct osm_doc *doc, struct dvec2 at);
uint32_t osm_doc_way(struct osm_doc *doc, const uint32_t *nodes, size_t count);
uint32_t osm_doc_relation(struct osm_doc *doc);
void osm_doc_member(struct osm_doc *doc, char type, uint32_t ref, const char *role); /* type: 'n' or 'w' */

/* Copies both. Nothing is added for an empty value. */
void osm_doc_tag(struct osm_doc *doc, const char *key, const char *value);
void osm_doc_tag_number(struct osm_doc *doc, const char *key, double value, int decimals);

/* Whole or not at all: written beside and renamed. Returns 0 or -errno after logging one line. */
int osm_doc_write(const struct osm_doc *doc, const char *path);

size_t osm_doc_way_count(const struct osm_doc *doc);
size_t osm_doc_node_count(const struct osm_doc *doc);

#endif
