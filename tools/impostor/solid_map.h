/*
 * The package's occluders (PKG_OCCL) ready to raise horizons: outlines in metres of the city frame, gathered in tiles.
 * Made once, then read by any number of threads.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_SOLID_MAP_H
#define BLVD_TOOLS_IMPOSTOR_SOLID_MAP_H

#include "assets/pkg.h"
#include "tools/city/pool.h"
#include "tools/impostor/horizon.h"

struct solid_box {
	struct dvec2 min, max;
	double top;
};
struct solid_outline {
	uint32_t first, count; /* points */
};
struct mapped_solid {
	struct solid_box box;
	uint32_t first_outline, outline_count;
};
struct solid_tile {
	struct solid_box box;
	uint32_t first, count; /* solids */
};
struct solid_map {
	ARRAY(struct dvec2) points;
	ARRAY(struct solid_outline) outlines;
	ARRAY(struct mapped_solid) solids; /* by tile */
	ARRAY(struct solid_tile) tiles;
};

/* Outlines that do not close are left out. */
void solid_map_build(struct solid_map *map, const struct pkg *pkg);
void solid_map_finish(struct solid_map *map);

/* Tiles within reach of a place, nearest first. */
typedef ARRAY(uint32_t) tile_list;
void solid_map_near(const struct solid_map *map, struct dvec2 at, double reach_m, tile_list *out);

/* Raises a horizon by the solids of these tiles; best nearest first. A solid that the eye is in is left out. */
void solid_map_raise(const struct solid_map *map, const tile_list *tiles, struct horizon *horizon);

#endif
