/* OSM files into a store, XML or PBF, by readosm. */
#ifndef BLVD_TOOLS_READ_OSM_PARSE_H
#define BLVD_TOOLS_READ_OSM_PARSE_H

#include "tools/read/osm_store.h"
#include "tools/read/stage.h"

/* `name` is what the user called the file; its text is mended first where that is needed. Returns 0, -errno, or
 * -EBADMSG; everything but 0 after logging one line that names the file and the place in it. */
int osm_parse(struct osm_store *store, struct staged *staged, const char *name);

#endif
