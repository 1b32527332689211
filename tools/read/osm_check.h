/*
 * Whole-file checks before readosm sees an OSM file: readosm reports no place, and trusts indices and counts that it
 * finds. What passes here is sound; what does not is refused with the place named.
 */
#ifndef BLVD_TOOLS_READ_OSM_CHECK_H
#define BLVD_TOOLS_READ_OSM_CHECK_H

/* `path` is read, `name` is what the user called it. Both return 0, -errno or -EBADMSG after logging one line. */
int osm_check_xml(const char *path, const char *name);
int osm_check_pbf(const char *path, const char *name);

#endif
