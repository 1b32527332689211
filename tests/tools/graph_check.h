/*
 * The invariants of a street graph, checked from the arrays alone (nothing shared with the code that builds them but
 * the grid that finds candidate pairs). Each failure prints one line; the number of failures is returned.
 */
#ifndef BLVD_TESTS_TOOLS_GRAPH_CHECK_H
#define BLVD_TESTS_TOOLS_GRAPH_CHECK_H

#include "assets/pkg.h"

/* Euler's formula and areas per connected part of the plane, face cycles, twins, order of out-lists, ends of polylines,
 * no two in-plane edges meet but at nodes, parents hold their components, turns meet at a node and are sorted. */
int graph_check(const struct pkg_graph *graph);

#endif
