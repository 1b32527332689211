/*
 * Map matching on the street graph: a particle filter that lives on the half-edges (topology-aware tracking; compare
 * Gustafsson et al. 2002, "Particle Filters for Positioning, Navigation, and Tracking", section V-C). Each particle is
 * a place on a half-edge, carried along by the travelled distance, with a heading offset of its own that a scalar
 * Kalman filter tracks. At junctions particles choose ways out by a prior (one-ways, turn restrictions, straightness,
 * turn lamp, planned route); the car's heading against the street's then decides who survives. So a turn taken early or
 * late corrects the distance, and every curve corrects the heading.
 *
 * Fixed pool from the arena, own deterministic random numbers, no work while the car stands. Cost: one pass over the
 * pool for each metre driven.
 */
#ifndef BLVD_NAV_MATCH_H
#define BLVD_NAV_MATCH_H

#include "nav/graph.h"
#include "nav/reckon.h"
#include "platform/base/rng.h"

struct match_config {
	uint32_t particles; /* 0: 384 */
	uint64_t seed;
};

/* What is known beside distance and heading; all optional. */
struct match_hints {
	int lamp;              /* -1 left, +1 right, 0 none */
	const uint32_t *route; /* half-edges expected next, from the one being driven; NULL none */
	uint32_t route_count;  /* the first few are looked at */
	double drift_m;        /* how wrong the reckoned place may be, off the streets; 0: as far as it went, shared out */
};

struct match_particle {
	uint32_t prev, half, next;     /* prev and next: PKG_NONE while not known */
	float prev_gap_m, next_gap_m;  /* centre line that the car's line saves at the corner to prev, to next */
	double along_m;                /* a little below 0 or beyond the length where the car's line is longer */
	double offset_rad, offset_var; /* true heading - reckoned heading */
	double scale;                  /* of the travelled distance */
	double log_weight;
	double misfit; /* squared heading residual over its variance, at most 16, of the last step */
};

struct match {
	const struct graph *graph;
	struct match_particle *particles, *spare;
	uint32_t count;
	struct rng rng;
	/* motion not yet handed to the particles */
	double pending_m, pending_rad, pending_s, pending_unknown_rad;
	double since_gnss_m;
	uint32_t gnss_far;
	bool spread;         /* over a way that nobody saw, and no fix since */
	double misfit;       /* smoothed over the last 20 m; above 8 the street does not fit */
	double misfit_m;     /* travelled since the last placing, up to 1e6 */
	double off_street_m; /* travelled since the street was lost */
	bool trying;         /* off the street, and the particles are on one that may be it */
	double retry_m;      /* travelled since the last try */

	/* the estimate, after each update */
	bool located;
	bool on_street;
	uint32_t half; /* PKG_NONE before the first placing */
	double along_m;
	double offset_rad;    /* add to the reckoned heading */
	double uncertainty_m; /* one sigma along the street */
	double confidence;    /* share of the belief that is on this half-edge */
	uint32_t jumps;       /* the estimate moved to a half-edge that does not touch the last one */
};

int match_init(struct match *match, struct arena *arena, const struct graph *graph, const struct match_config *config);

/* Starts at a known place of a half-edge; `spread_m` is one sigma along it. `heading_bam` is the reckoned heading. */
void match_place(struct match *match, uint32_t half, double along_m, double spread_m, int32_t heading_bam);

/* Starts somewhere near a place. With `heading_known` only half-edges within 60 degrees of the reckoned heading count,
 * if there are any. Returns false, changing nothing, when no street is within `radius_m`. */
bool match_place_near(struct match *match, struct dvec2 at_m, double radius_m, bool heading_known, int32_t heading_bam);

/* One step of dead reckoning; `reckon` has taken it already. `turn_known` is false when no signal told the turn. */
void match_update(struct match *match, const struct reckon *reckon, const struct reckon_step *step, bool turn_known,
	const struct match_hints *hints);

/* A satellite fix. Ignored while standing, unless the place was unknown or the car went on unseen. */
void match_gnss(struct match *match, const struct reckon *reckon, struct dvec2 at_m, double sigma_m);

/* Beside the streets, on ground that no street of the graph runs over; a street is looked for from there. The nearest
 * one counts as the place on the graph. Returns false, changing nothing, when none is within `radius_m`. */
bool match_place_off(struct match *match, struct dvec2 at_m, double radius_m, int32_t heading_bam);

/* The car went on unseen, by up to `by_m`. Without `turns_seen` the reckoned heading is of before, and the streets that
 * it may have taken say how it turned. Costs a few ms for a kilometre; farther is taken as that. */
void match_blur(struct match *match, double by_m, bool turns_seen);

/* The reckoned heading was corrected by `rad`. */
void match_heading_corrected(struct match *match, double rad);

#endif
