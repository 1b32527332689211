/*
 * A folder of Mapbox vector tiles as if it were OSM data: buildings with heights, roads, water, land use, shops
 * (schemas: Mapbox Streets v7 and v8; of OpenMapTiles the buildings and roads), and contour lines as ground heights.
 * Tiles carry pictures of streets, not streets: everything lies on the tiles' grid of 1/4096, so one place of the grid
 * is one node; what the tiles' borders cut is joined again, and ends that meet a street between two of its points
 * become junctions. Files: z-x-y.mvt or z/x/y.mvt, .pbf as well, gzipped or not; one zoom level (the deepest) is read.
 */
#ifndef BLVD_TOOLS_READ_TILES_H
#define BLVD_TOOLS_READ_TILES_H

#include "tools/read/osm_store.h"
#include "tools/read/shape.h"

struct contour {
	double height_m;        /* the ground inside is at least this high */
	struct polygon degrees; /* x longitude, y latitude */
};
typedef ARRAY(struct contour) contour_array;

/* True for a folder; tiles_read() says whether there are tiles in it. */
bool tiles_is_folder(const char *path);

/* Returns 0, -errno or -EBADMSG after logging one line. Contours live in the store's pool. */
int tiles_read(struct osm_store *store, contour_array *contours, const char *path);

#endif
