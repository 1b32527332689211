/* Between the files of the tile reader: places on the tiles' grid, lines and areas before they become OSM elements. */
#ifndef BLVD_TOOLS_READ_TILE_GRID_H
#define BLVD_TOOLS_READ_TILE_GRID_H

#include "tools/read/osm_store.h"
#include "tools/read/shape.h"

#define TILE_UNITS 4096

/* A place: eastings and southings of the whole world's grid at the zoom level, in one number that is also the node's
 * id. */
typedef int64_t tile_place;

static inline tile_place tile_place_of(int64_t east, int64_t south)
{
	return east << 32 | south;
}
static inline int64_t tile_east(tile_place place)
{
	return place >> 32;
}
static inline int64_t tile_south(tile_place place)
{
	return place & INT64_C(0xFFFFFFFF);
}
static inline struct dvec2 tile_point(tile_place place)
{
	return (struct dvec2){ (double)tile_east(place), -(double)tile_south(place) };
}

struct tile_line {
	tile_place *places; /* in the store's pool */
	size_t count;
	struct osm_tags tags;
	int level; /* lines of different levels do not meet between their points */
	bool road;
};
typedef ARRAY(struct tile_line) tile_line_array;

struct tile_name {
	struct dvec2 a, b; /* a piece of a labelled street, in units */
	const char *name;
};
typedef ARRAY(struct tile_name) tile_name_array;

struct tile_area {
	struct polygon shape; /* in units, y north */
	struct osm_tags tags;
	bool building, on_border;
};
typedef ARRAY(struct tile_area) tile_area_array;

/* tile_lines.c: makes streets of pictures of streets: joins across borders, makes junctions, splits there, names. */
void tile_lines_connect(tile_line_array *lines, const tile_name_array *names, struct osm_store *store);

/* tile_areas.c: joins the pieces of buildings that borders cut. */
void tile_areas_join(tile_area_array *areas, struct pool *pool, struct report *report);

#endif
