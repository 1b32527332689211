/*
 * Which side of the road is driven on. In this order: driving_side=* of the streets; which way round the roundabouts of
 * the data go; the country, by a list of rectangles.
 */
#ifndef BLVD_TOOLS_READ_TRAFFIC_SIDE_H
#define BLVD_TOOLS_READ_TRAFFIC_SIDE_H

#include "tools/city/city.h"
#include "tools/read/osm_store.h"

bool traffic_side_right(const struct city *city, const struct osm_store *store);

/* The last step alone. */
bool traffic_side_right_at(struct geo_point at);

#endif
