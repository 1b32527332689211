/*
 * How well the car's place is known, from one update to the next: joins the drift of dead reckoning (drift.h) with what
 * the streets (match.h) and fixes say. Part of nav.c, in a file of its own; the caller is nav_advance().
 */
#ifndef BLVD_NAV_DOUBT_H
#define BLVD_NAV_DOUBT_H

#include "nav/nav.h"

#define DOUBT_BEGIN_M 12.0 /* one sigma: more is a drifting place */
#define DOUBT_END_M 8.0    /* less is a sure one again */

void doubt_init(struct nav *nav);

/* After dead reckoning moved by `step`, before the matching: the drift grows. A speed that comes back after a silence
 * spreads the belief over the way that may have been gone. */
void doubt_grow(struct nav *nav, const struct nav_input *input, const struct reckon_step *step);

/* A fix while the place is reckoned beside the streets: corrects the reckoned position. */
void doubt_fix(struct nav *nav, struct dvec2 at_m, double sigma_m);

/* Does a fix tell that the remembered place is not where the car is? If it agrees, the place is no longer only
 * remembered. */
bool doubt_refutes_memory(struct nav *nav, struct dvec2 at_m, double sigma_m);

/* After the matching: where the streets say the place, the drift is held to what they know. */
void doubt_settle(struct nav *nav, const struct nav_input *input, const struct reckon_step *step);

void doubt_view(const struct nav *nav, struct nav_doubt *out);

#endif
