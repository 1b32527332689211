/*
 * CityJSON 1.x and 2.0 (https://www.cityjson.org/specs/): buildings as footprints with heights (LoD1), and as
 * triangulated surfaces where the file has them (LoD2); water, plants, roads, squares, bridges as areas.
 */
#ifndef BLVD_TOOLS_READ_CITYJSON_H
#define BLVD_TOOLS_READ_CITYJSON_H

#include "tools/read/building_set.h"

/* Adds what the file at `path` holds; `name` is what the user called it. Returns 0, -errno or -EBADMSG after logging
 * one line that names file and place. */
int cityjson_read(struct building_set *set, const char *path, const char *name, struct report *report);

#endif
