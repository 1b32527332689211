/* OSM files into a store: .osm, .osm.pbf, and .gz or .bz2 of these. */
#ifndef BLVD_TOOLS_READ_OSM_PARSE_H
#define BLVD_TOOLS_READ_OSM_PARSE_H

#include "tools/read/osm_store.h"

/* Returns 0, -errno, or -EBADMSG; everything but 0 after logging one line that names the file and the place in it. */
int osm_parse(struct osm_store *store, const char *path);

#endif
