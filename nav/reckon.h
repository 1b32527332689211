/*
 * Dead reckoning: position from speed and yaw rate alone, in the city frame. Position is int64 mm
 * with the fraction kept apart, heading a binary angle, so nothing loses precision however far or long the drive is.
 *
 * The yaw rate's bias is learned while the car stands, and slowly from heading references while it drives; the speed's
 * scale from distance references. Standing still changes nothing: no drift.
 */
#ifndef BLVD_NAV_RECKON_H
#define BLVD_NAV_RECKON_H

#include <stdbool.h>
#include <stdint.h>

struct reckon_config {
	int64_t gap_ns; /* the car is taken to go on as before over a silence up to this; 0: 12 s */
};

/* What the car says now. Between updates values are taken to change linearly. */
struct reckon_input {
	bool speed_valid, yaw_valid;
	bool yaw_biased;     /* from a gyroscope, whose bias is to be learned; false: from steering or wheels */
	double speed_mps;    /* negative backwards */
	double yaw_rate_rps; /* clockwise positive */
};

/* What one update did. */
struct reckon_step {
	double dt_s;
	double distance_m; /* signed, scale applied */
	double turn_rad;   /* bias taken off */
	bool still;        /* the car stood all the time */
	bool gap;          /* the turn is a guess: no update for more than a second */
};

struct reckon {
	struct reckon_config config;
	int64_t pos_mm[2];
	double fraction_mm[2]; /* what does not make a whole mm yet */
	int32_t heading_bam;
	double fraction_bam;
	int64_t time_ns;
	bool started;
	struct reckon_input last;
	double speed_scale; /* true speed = speed_scale * said speed */
	double scale_var;
	double yaw_bias_rps; /* true rate = said rate - yaw_bias_rps */
	double bias_var;     /* (rad/s)^2 */
	double still_s;      /* standing for this long */
	double travelled_m;  /* sum of |distance| */
	uint32_t steps_back; /* times the clock went backwards */
};

void reckon_init(struct reckon *reckon, const struct reckon_config *config);

/* Puts the car somewhere; keeps what was learned of bias and scale. */
void reckon_place(struct reckon *reckon, const int64_t pos_mm[2], int32_t heading_bam);

/* Moves on to `now_ns`. The first update, an update at the same time and one from the past move nothing. */
struct reckon_step reckon_update(struct reckon *reckon, const struct reckon_input *input, int64_t now_ns);

/* The heading had to be turned by `corrected_rad` over the last `over_s` seconds to agree with streets or fixes, which
 * know headings to `sigma_rad`: teaches the yaw rate's bias. */
void reckon_bias_reference(struct reckon *reckon, double corrected_rad, double over_s, double sigma_rad);

/* A distance is known from elsewhere: true and reckoned metres over the same stretch, sigma of the true one. */
void reckon_distance_reference(struct reckon *reckon, double true_m, double reckoned_m, double sigma_m);

/* Moves the position by a correction, m east and north; turns the heading by one. */
void reckon_shift(struct reckon *reckon, double east_m, double north_m);
void reckon_turn(struct reckon *reckon, double rad);

#endif
