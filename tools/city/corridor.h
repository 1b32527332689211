/*
 * Keeps carriageways free of buildings, so that no camera on a street is ever inside a wall. The corridor of a street
 * is its carriageway, at least CORRIDOR_LEAST_M wide, from its surface to CORRIDOR_HEAD_M above it.
 */
#ifndef BLVD_TOOLS_CITY_CORRIDOR_H
#define BLVD_TOOLS_CITY_CORRIDOR_H

#include "tools/city/graph.h"

#define CORRIDOR_LEAST_M 3.0
#define CORRIDOR_HEAD_M 4.5

/*
 * Mends every building that reaches into a corridor: a passage (the way says so, or a lane of service or living class
 * runs through high walls) becomes an arch, the building is split into what stands beside the lane and what goes on
 * above it; otherwise the corridor is cut out of the footprint. What is left with hardly anything goes. New pieces are
 * appended to city->buildings; indices of the others do not change, those that go are marked by an empty outer ring.
 * Counts FAULT_STREET_THROUGH_BUILDING where a centre line runs through, FAULT_BUILDING_IN_STREET elsewhere.
 */
void corridor_clear(struct city *city, const struct pkg_graph *graph);

#endif
