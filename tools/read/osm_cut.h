/*
 * Areas that the edge of the data cuts: rivers, forests, the sea. Their borders come as open chains that leave the
 * built-up area; the chains and a frame around the area divide it into faces, and the faces on two sides of a chain are
 * of two kinds.
 */
#ifndef BLVD_TOOLS_READ_OSM_CUT_H
#define BLVD_TOOLS_READ_OSM_CUT_H

#include "tools/read/osm_reader.h"

/* Node ids in order; all of them are in the store. */
struct chain {
	int64_t *refs; /* malloc */
	size_t count;  /* >= 2 */
};
typedef ARRAY(struct chain) chain_array;

void chains_add_way(struct osm_reader *reader, const struct osm_way *way, chain_array *out);
/* Joins chains at shared ends; without `may_reverse` only end to start (coastlines have a direction). */
void chains_join(chain_array *chains, bool may_reverse);
void chains_finish(chain_array *chains);

/* The convex hull of the built-up area as a ring, counter-clockwise, in the reader's pool. */
struct ring cut_hull(struct osm_reader *reader);

/* Every end of the open chains lies beyond the built-up area, or close to its border. */
bool cut_reaches_out(const struct osm_reader *reader, const chain_array *open);

/* Appends the faces on the inner side, within the hull grown by `margin_m`; chains that end before its border go on
 * straight to it. `coast`: the chains have water on their right; otherwise that side is inside which holds less of the
 * street network. */
size_t cut_polygons(struct osm_reader *reader, const chain_array *closed, const chain_array *open, double margin_m,
	bool coast, polygon_array *out);

#endif
