/* Kinds of buildings by their OSM names. */
#ifndef BLVD_TOOLS_READ_OSM_KIND_H
#define BLVD_TOOLS_READ_OSM_KIND_H

/* enum building_kind of a building=* value, or -1. */
int osm_building_kind(const char *value);

#endif
