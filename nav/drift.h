/*
 * How wrong the reckoned position may be: the covariance of dead reckoning. Five errors grow together: east and north,
 * the heading, the yaw rate's bias and the speed's scale; first order, as in an extended Kalman filter (Thrun, Burgard,
 * Fox, "Probabilistic Robotics", 2005, ch. 3.3). On a street the map matching says how well the place is known and the
 * errors are held to that; off it, in a car park, they grow until a fix or a street takes them away again.
 *
 * Figures that come out: a scale known to 1 % is 10 m a km along; a bias known to 0.1 deg/s is 44 m sideways after 60 s
 * at 14 m/s.
 */
#ifndef BLVD_NAV_DRIFT_H
#define BLVD_NAV_DRIFT_H

#include "nav/reckon.h"
#include "platform/base/vec.h"

enum { DRIFT_EAST, DRIFT_NORTH, DRIFT_HEADING, DRIFT_BIAS, DRIFT_SCALE, DRIFT_SIZE };

struct drift {
	double cov[DRIFT_SIZE][DRIFT_SIZE]; /* m, m, rad, rad/s, 1 */
	double blind_mps;                   /* speed before its signal was lost: the car may go on at it */
	double blind_m;                     /* how far it may have gone since */
};

/* One sigma in every direction, as an ellipse. */
struct drift_ellipse {
	double major_m, minor_m;
	double heading_rad; /* of the longer axis, clockwise from north */
};

/* The place is known to `along_m` in the direction of `heading_rad` and `across_m` beside it, the heading to
 * `heading_sigma_rad`; bias and scale as well as `reckon` knows them. */
void drift_hold(struct drift *drift, const struct reckon *reckon, double heading_rad, double along_m, double across_m,
	double heading_sigma_rad);

/* One step of dead reckoning that `reckon` has taken. `input` is what it was taken by: without a turn the heading
 * becomes unknown, without a speed the car may be anywhere between standing and going on as before. */
void drift_step(
	struct drift *drift, const struct reckon *reckon, const struct reckon_step *step, const struct reckon_input *input);

/* A position measured `east_m`, `north_m` from the reckoned one, known to `sigma_m`. Takes the correction to it: where
 * to shift and how far to turn (clockwise). A fix beyond four sigma is taken for a wild one: nothing is corrected and
 * false returned. */
bool drift_fix(
	struct drift *drift, double east_m, double north_m, double sigma_m, struct dvec2 *shift_m, double *turn_rad);

/* The same as a position from elsewhere was known: variances in m^2 (east, north, and what they have in common) and
 * rad^2. Returns false, changing nothing, when they cannot be. */
bool drift_restore(struct drift *drift, const struct reckon *reckon, const double position_var[3], double heading_var);

struct drift_ellipse drift_ellipse(const struct drift *drift);

#endif
