/* Kinds of buildings and streets by their OSM names. */
#ifndef BLVD_TOOLS_READ_OSM_KIND_H
#define BLVD_TOOLS_READ_OSM_KIND_H

#include <stdbool.h>

/* enum building_kind of a building=* value, or -1. */
int osm_building_kind(const char *value);

/* A highway=* value that is drawn. */
bool osm_is_highway(const char *value);

#endif
