#include "tools/sim/hand.h"

#define WHEELBASE_M 2.7
#define WHEELS_MAX_RAD 0.6
#define WHEELS_RATE_RPS 0.7
#define PUSH_RAD 0.05
#define CENTRE_AFTER_S 0.35
#define LATERAL_MPS2 4.0 /* tyres hold no more in comfort */
#define ACCEL_MPS2 2.5
#define BRAKE_MPS2 4.0
#define COAST_MPS2 0.3
#define REVERSE_MAX_MPS 6.0
#define SPEED_MAX_MPS 55.0
#define NEAR_M 60.0

static void find_street(struct hand *hand)
{
	struct graph_hit hit;
	struct dvec2 at = { hand->at.x, hand->at.y };
	if (!graph_nearest(hand->graph, at, NEAR_M, &hit, 1))
		return;
	uint32_t half = hit.edge * 2;
	double along = hit.along_m, length = graph_length_m(hand->graph, half);
	if (cos(graph_at(hand->graph, half, along).heading_rad - hand->heading_rad) < 0.0) {
		half++;
		along = length - along;
	}
	hand->half = half;
	hand->along_m = along;
	hand->at.z = graph_at(hand->graph, half, along).at_m.z;
}

void hand_place(struct hand *hand, const struct graph *graph, uint32_t half, double along_m)
{
	struct graph_pose pose = graph_at(graph, half, along_m);
	double right = graph_lane_offset_m(graph, half, 0);
	*hand = (struct hand){
		.graph = graph,
		.at = { pose.at_m.x + right * cos(pose.heading_rad), pose.at_m.y - right * sin(pose.heading_rad), pose.at_m.z },
		.heading_rad = pose.heading_rad,
		.gear = NAV_GEAR_PARK,
		.half = half,
		.along_m = along_m,
	};
}

void hand_take_over(struct hand *hand, const struct graph *graph, const struct drive_state *from)
{
	*hand = (struct hand){
		.graph = graph,
		.at = from->at,
		.heading_rad = from->heading_rad,
		.speed_mps = from->speed_mps,
		.odometer_m = from->odometer_m,
		.wheels_rad = atan(WHEELBASE_M * from->curvature),
		.wanted_mps = from->speed_mps,
		.gear = from->parked ? NAV_GEAR_PARK : NAV_GEAR_DRIVE,
		.lamp = from->lamp,
		.half = from->half,
		.along_m = from->along_m,
	};
}

static bool moves(enum nav_gear gear)
{
	return gear == NAV_GEAR_DRIVE || gear == NAV_GEAR_REVERSE;
}

void hand_faster(struct hand *hand, double by_mps)
{
	if (by_mps > 0.0 && !moves(hand->gear))
		hand->gear = NAV_GEAR_DRIVE;
	double most = hand->gear == NAV_GEAR_REVERSE ? REVERSE_MAX_MPS : SPEED_MAX_MPS;
	hand->wanted_mps = fmin(fmax(hand->wanted_mps + by_mps, 0.0), most);
}

void hand_push(struct hand *hand, double side)
{
	/* with the wheel half way over at walking pace, a touch on the motorway */
	double most = hand->speed_mps * hand->speed_mps > 1.0
					  ? atan(WHEELBASE_M * LATERAL_MPS2 / (hand->speed_mps * hand->speed_mps))
					  : WHEELS_MAX_RAD;
	double push = fmin(PUSH_RAD, 0.35 * most);
	if (hand->wanted_wheels_rad * side < 0.0)
		hand->wanted_wheels_rad = 0.0; /* the other way: straight first */
	hand->wanted_wheels_rad = fmin(fmax(hand->wanted_wheels_rad + side * push, -most), most);
	hand->held = false;
	hand->released_s = 0.0;
}

void hand_hold(struct hand *hand, double wheels_rad)
{
	hand->wanted_wheels_rad = fmin(fmax(wheels_rad, -WHEELS_MAX_RAD), WHEELS_MAX_RAD);
	hand->held = true;
}

void hand_gear(struct hand *hand, enum nav_gear gear)
{
	if (gear == NAV_GEAR_NEUTRAL || (gear == NAV_GEAR_DRIVE && hand->speed_mps >= 0.0) || hand->speed_mps == 0.0) {
		if (gear != hand->gear)
			hand->wanted_mps = 0.0;
		hand->gear = gear;
		hand->next_gear = NAV_GEAR_UNKNOWN;
		return;
	}
	hand->next_gear = gear;
}

static void follow_pedals(struct hand *hand, double dt_s)
{
	double wanted = hand->gear == NAV_GEAR_REVERSE ? -hand->wanted_mps : hand->wanted_mps, before = hand->speed_mps;
	double rate = fabs(wanted) > fabs(before) ? ACCEL_MPS2 : BRAKE_MPS2;
	if (hand->gear == NAV_GEAR_NEUTRAL) {
		wanted = 0.0;
		rate = COAST_MPS2;
	}
	if (hand->next_gear != NAV_GEAR_UNKNOWN) {
		wanted = 0.0;
		rate = BRAKE_MPS2;
	}
	double step = rate * dt_s;
	hand->speed_mps += fmin(fmax(wanted - before, -step), step);
	hand->accel_mps2 = (hand->speed_mps - before) / dt_s;
	if (hand->next_gear != NAV_GEAR_UNKNOWN && hand->speed_mps == 0.0)
		hand_gear(hand, hand->next_gear);
}

static void follow_wheel(struct hand *hand, double dt_s)
{
	hand->released_s += dt_s;
	if (!hand->held && hand->released_s > CENTRE_AFTER_S)
		hand->wanted_wheels_rad *= exp(-4.0 * dt_s);
	double step = WHEELS_RATE_RPS * dt_s;
	hand->wheels_rad += fmin(fmax(hand->wanted_wheels_rad - hand->wheels_rad, -step), step);
}

void hand_step(struct hand *hand, double dt_s)
{
	follow_pedals(hand, dt_s);
	follow_wheel(hand, dt_s);
	double moved = hand->speed_mps * dt_s, turn = moved * tan(hand->wheels_rad) / WHEELBASE_M;
	double heading = hand->heading_rad + 0.5 * turn;
	hand->at.x += moved * sin(heading);
	hand->at.y += moved * cos(heading);
	hand->heading_rad += turn;
	hand->odometer_m += fabs(moved);
	if (moved != 0.0)
		find_street(hand);
}

struct drive_state hand_state(const struct hand *hand, double time_s)
{
	double curvature = tan(hand->wheels_rad) / WHEELBASE_M;
	return (struct drive_state){
		.time_s = time_s,
		.at = hand->at,
		.heading_rad = hand->heading_rad,
		.speed_mps = hand->speed_mps,
		.accel_mps2 = hand->accel_mps2,
		.yaw_rate_rps = hand->speed_mps * curvature,
		.curvature = curvature,
		.odometer_m = hand->odometer_m,
		.half = hand->half,
		.along_m = hand->along_m,
		.lamp = hand->lamp,
		.parked = hand->gear == NAV_GEAR_PARK,
		.gear = hand->gear,
		.driving = hand->odometer_m > 0.0,
	};
}
