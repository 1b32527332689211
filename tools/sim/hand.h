/*
 * A car that is driven by hand: speed and steering wheel are asked for, the car follows as a car does (a bicycle model
 * on flat ground; its height is that of the nearest street).
 */
#ifndef BLVD_TOOLS_SIM_HAND_H
#define BLVD_TOOLS_SIM_HAND_H

#include "tools/drive/drive.h"

struct hand {
	const struct graph *graph; /* borrowed */
	struct dvec3 at;           /* rear axle, city frame, m */
	double heading_rad, speed_mps, accel_mps2, odometer_m;
	double wheels_rad;        /* at the road wheels, clockwise positive */
	double wanted_mps;        /* without sign */
	double wanted_wheels_rad; /* the steering wheel centres itself when nobody holds it */
	bool held;
	double released_s;             /* since the last push to a side */
	enum nav_gear gear, next_gear; /* the next one: as soon as it stands; UNKNOWN none */
	int lamp;                      /* as struct drive_state has it */
	uint32_t half;
	double along_m;
};

/* Parked on its lane of a street. */
void hand_place(struct hand *hand, const struct graph *graph, uint32_t half, double along_m);
/* Goes on from where another driver was. */
void hand_take_over(struct hand *hand, const struct graph *graph, const struct drive_state *from);

void hand_faster(struct hand *hand, double by_mps); /* negative brakes; out of P when asked for more */
void hand_push(struct hand *hand, double side);     /* a push of the steering wheel: 1 to the right, -1 left */
void hand_hold(struct hand *hand, double wheels_rad);
void hand_gear(struct hand *hand, enum nav_gear gear); /* stands still first where it has to */

void hand_step(struct hand *hand, double dt_s);
struct drive_state hand_state(const struct hand *hand, double time_s);

#endif
