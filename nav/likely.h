/*
 * Which stretches of the far field the car is on or may soon be on: what should be in memory. The street graph is
 * walked from the car's place in the order of how soon each stretch could be reached; less likely turns, and what lies
 * behind, count as farther away than they are.
 */
#ifndef BLVD_NAV_LIKELY_H
#define BLVD_NAV_LIKELY_H

#include "nav/graph.h"
#include "nav/nav_view.h"

/* Looks no farther than this, or than 8 s at the present speed. */
#define LIKELY_HORIZON_M 150.0
#define LIKELY_HORIZON_S 8.0

/* The stretch that the car is on first, then the others by urgency, each once. Off the street the nearest streets are
 * where it starts. Returns how many there are: 0 without a position, or without a far field. The view's likely[] is not
 * read. */
uint32_t likely_stretches(
	const struct graph *graph, const struct pkg *pkg, const struct nav_view *view, uint32_t out[static NAV_LIKELY_MAX]);

#endif
