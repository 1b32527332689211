/*
 * What the driver must be told along a route: turns, forks, roundabouts, merges, arrival. A street that only bends, or
 * only changes its name, is no manoeuvre.
 *
 * guidance_build() walks the whole route once when it is found (linear in its half-edges); questions while driving look
 * only at the step ahead. Arrays come from the arena at init.
 */
#ifndef BLVD_NAV_GUIDANCE_H
#define BLVD_NAV_GUIDANCE_H

#include <stddef.h>

#include "nav/nav_view.h"
#include "nav/route.h"

struct guidance_step {
	enum nav_manoeuvre manoeuvre;
	uint8_t exit;
	int32_t angle_bam;
	uint32_t index;  /* into the route: the half-edge after the manoeuvre's node */
	uint32_t last;   /* the half-edge after all of it: the exit of a roundabout; else as index */
	uint32_t street; /* STRS offset of the first name after it, or of its number, 0 none */
	double at_m;     /* from the route's start */
};

struct guidance {
	const struct graph *graph;
	const struct route_search *search; /* for travel times */
	const struct route *route;         /* NULL: no route */
	struct guidance_step *steps;
	uint32_t step_count, step_capacity;
	double *origin_m;    /* by route index: distance of the half-edge's origin from the route's start; first one <= 0 */
	uint32_t *origin_ms; /* time likewise, turns included */
	uint32_t capacity;
	uint32_t next_step; /* cursor */
};

/* `capacity` half-edges, as route_search has it. Returns 0 or -ENOMEM. */
int guidance_init(struct guidance *guidance, struct arena *arena, const struct route_search *search);

/* Takes over a route (borrowed until the next build or clear). */
void guidance_build(struct guidance *guidance, const struct route *route);
void guidance_clear(struct guidance *guidance);

/* Rest of the route from a place on it. */
void guidance_remaining(
	const struct guidance *guidance, uint32_t index, double along_m, double *remaining_m, double *remaining_s);

/* The n-th manoeuvre ahead (0 the next one) as the renderer wants it; NAV_MANOEUVRE_NONE when there is none. */
struct nav_step guidance_step_ahead(struct guidance *guidance, uint32_t index, double along_m, uint32_t n);

/* "Turn left into Rue de Lausanne", "At the roundabout take the 2nd exit", UTF-8, cut at a character to fit. `street`
 * may be empty. Returns the length. */
size_t guidance_text(enum nav_manoeuvre manoeuvre, unsigned exit, const char *street, char *out, size_t size);

/* "50 m", "1.2 km": rounded to what a driver needs; 0 m becomes "now". Returns the length. */
size_t guidance_distance_text(double distance_m, char *out, size_t size);

#endif
