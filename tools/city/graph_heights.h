/*
 * Heights of one kind of ways (streets, or all others) at the vertices of the net: height = base + up + down.
 * graph_decks.c makes the base: the ground, and a taut line over it on bridges and under it in tunnels. graph_ramps.c
 * adds humps and dips. graph_profile.c decides where they are needed. Private to these three.
 */
#ifndef BLVD_TOOLS_CITY_GRAPH_HEIGHTS_H
#define BLVD_TOOLS_CITY_GRAPH_HEIGHTS_H

#include "tools/city/graph_net.h"

struct heights {
	struct net *net;
	unsigned kind; /* enum net_kind */
	struct net_stars stars;
	double *ground, *base, *up, *down; /* by vertex, m; down <= 0 */
	double *portal; /* by vertex: way along bridges and tunnels to the nearest end of them; HUGE_VAL on the ground */
	bool *pinned;   /* by vertex: base is final (a street's, seen from other ways) */
	bool *junction; /* by vertex: streets meet on the ground; better left where it is */
	bool *on_ramp;  /* by segment: lifted or lowered */
	struct ramp_search *search;
};

struct ramp {
	uint32_t segment;
	double t;               /* place on it, 0 to 1 */
	double height_m;        /* negative: dip */
	double flat_m;          /* full height this far to both sides */
	double grade, steepest; /* wanted, and where it has to end before a junction */
};

void heights_init(struct heights *heights, struct net *net, unsigned kind);
void heights_finish(struct heights *heights);
static inline double heights_at(const struct heights *heights, uint32_t vertex)
{
	return heights->base[vertex] + heights->up[vertex] + heights->down[vertex];
}

/* Bridge or tunnel. */
bool heights_is_structure(const struct heights *heights, uint32_t segment);

/* Fills base and portal. */
void decks_lay(struct heights *heights);

/* Raises up (or lowers down) along all ways that are connected, level for flat_m, then in an S as steep as `grade` in
 * its middle. Of overlapping ramps the higher counts. Ends before the nearest junction if it need not be steeper than
 * `steepest` for that, and before the nearest pinned vertex at any rate. */
struct ramp_search *ramp_search_new(size_t vertex_count);
void ramp_search_free(struct ramp_search *search);
void ramp_add(struct heights *heights, const struct ramp *ramp);
/* Distances from all vertices where `distance` is 0, over structures only; HUGE_VAL where not reached. */
void ramp_spread(struct ramp_search *search, const struct heights *heights, double *distance);

/* 0 at x <= 0, 1 at x >= 1; level at both, straight in between but for a parabola of EASE at each end. */
#define EASE 0.25
#define EASE_STEEPEST (1.0 / (1.0 - EASE))
static inline double ease(double x)
{
	double t = x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x, far = t > 0.5 ? 1.0 - t : t;
	double rise = far < EASE ? far * far / (2.0 * EASE) : far - EASE / 2.0;
	return t > 0.5 ? 1.0 - rise * EASE_STEEPEST : rise * EASE_STEEPEST;
}

#endif
