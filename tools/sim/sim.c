/* The car and its bus. */
#include "tools/sim/sim.h"

#include <string.h>

#include "platform/base/log.h"

#define BUS_SLEEPS_S 3.0    /* after the ignition */
#define ERROR_PASSIVE 0x04u /* linux/can/error.h: what a controller tells of itself */
#define ERROR_STATE 0x10u
#define BUS_OFF 0x40u
#define RESTARTED 0x100u

static void take_frame(void *context, const struct can_frame_rx *frame)
{
	struct sim *sim = context;
	struct can_frame_rx out = *frame;
	bool asleep = !sim->ignition && sim->time_s - sim->ignition_s > BUS_SLEEPS_S;
	if (asleep)
		return;
	if (!faults_apply(&sim->faults, &out))
		sim->withheld++;
	else if (sim->frame_count < SIM_FRAMES_MAX)
		sim->frames[sim->frame_count++] = out;
}

static void send_error(struct sim *sim, uint32_t id, uint8_t controller, int64_t wall_ns)
{
	if (sim->frame_count == SIM_FRAMES_MAX)
		return;
	struct can_frame_rx *frame = &sim->frames[sim->frame_count++];
	*frame = (struct can_frame_rx){ .time_ns = wall_ns, .id = id, .flags = CAN_FRAME_ERROR, .len = 8 };
	frame->data[1] = controller;
}

/* Any street that pleases, when nobody says where. */
static int place_by_hand(struct sim *sim)
{
	struct drive_options one = *sim->drive.options;
	one.via_count = 0;
	one.minutes = 1.0;
	sim->drive.options = &one;
	int status = drive_choose(&sim->drive);
	sim->drive.options = &sim->options->drive;
	sim->drive.stop_count = 0;
	if (status)
		return status;
	hand_place(&sim->hand, &sim->drive.graph, sim->drive.start.half, sim->drive.start.along_m);
	return 0;
}

static int make_car(struct sim *sim)
{
	int status = sim->by_hand ? place_by_hand(sim) : drive_plan(&sim->drive, &sim->path, &sim->motion);
	if (status)
		return status;
	sim->bus = bus_new(&sim->drive, &(struct bus_sink){ take_frame, sim });
	if (!sim->bus)
		return -1;
	bus_say_ignition(sim->bus, 2);
	faults_init(&sim->faults, bus_dbc(sim->bus), sim->options->drive.seed);
	return 0;
}

int sim_init(struct sim *sim, struct arena *arena, const struct pkg *pkg, const struct sim_options *options)
{
	memset(sim, 0, sizeof(*sim));
	sim->options = options;
	sim->by_hand = options->by_hand;
	sim->factor = options->factor;
	sim->ignition = true;
	sim->light = -1.0;
	if (drive_init(&sim->drive, arena, pkg, &options->drive)) {
		log_error("not enough memory for the streets");
		return -1;
	}
	return make_car(sim);
}

void sim_finish(struct sim *sim)
{
	bus_free(sim->bus);
	motion_finish(&sim->motion);
	path_finish(&sim->path);
}

/* The route is driven on a clock of its own, so that its speed can be changed; what is felt changes with it. */
static struct drive_state route_state(struct sim *sim)
{
	double rate = sim->time_s < sim->options->wait_s || !sim->ignition ? 0.0 : sim->factor;
	sim->route_s = fmin(sim->route_s + rate * SIM_TICK_S, sim->motion.end_s);
	sim->ended = sim->route_s >= sim->motion.end_s;
	struct drive_state state = motion_at(&sim->motion, sim->route_s);
	state.speed_mps *= rate;
	state.yaw_rate_rps *= rate;
	state.accel_mps2 *= rate * rate;
	return state;
}

static struct drive_state hand_driven(struct sim *sim)
{
	if (!sim->ignition)
		hand_gear(&sim->hand, NAV_GEAR_PARK);
	hand_step(&sim->hand, SIM_TICK_S);
	/* before it moves, its fixes are exact, as before a drive: they tell a listener where it stands and how */
	return hand_state(&sim->hand, sim->hand.odometer_m > 0.0 ? sim->time_s + 10.0 : 0.0);
}

static void tell_world(struct sim *sim, const struct sim_world *world, const struct fault_event *event, int64_t wall_ns)
{
	if (event->kind == FAULT_BUS_OFF && event->begins) {
		send_error(sim, ERROR_PASSIVE, ERROR_STATE, wall_ns);
		send_error(sim, BUS_OFF, 0, wall_ns);
	} else if (event->kind == FAULT_BUS_OFF) {
		send_error(sim, RESTARTED, 0, wall_ns);
	}
	if (event->kind == FAULT_CLOCK && event->begins)
		sim->clock_s += strtod(event->target, NULL);
	if (world && world->fault)
		world->fault(world->context, event);
}

static void step_faults(struct sim *sim, const struct sim_world *world, int64_t wall_ns)
{
	for (struct fault_event event; (event = faults_step(&sim->faults, sim->time_s)).kind != FAULT_KINDS;)
		tell_world(sim, world, &event, wall_ns);
}

void sim_tick(struct sim *sim, int64_t wall_ns, const struct sim_world *world)
{
	bool backwards = sim->state.gear == NAV_GEAR_REVERSE;
	sim->frame_count = 0;
	step_faults(sim, world, wall_ns);
	sim->state = sim->by_hand ? hand_driven(sim) : route_state(sim);
	if (sim->by_hand && backwards != (sim->state.gear == NAV_GEAR_REVERSE) && world && world->line)
		world->line(world->context, "reverse", !backwards);
	bus_set_light(sim->bus, sim->light);
	bus_tick(sim->bus, &sim->state, sim->tick, wall_ns + (int64_t)(sim->clock_s * 1e9));
	for (unsigned i = 0; i < sim->frame_count; i++)
		if (!(sim->frames[i].flags & CAN_FRAME_ERROR))
			sim->frames[i].time_ns -= (int64_t)(sim->clock_s * 1e9); /* what it says is wrong, not when it says it */
	sim->tick++;
	sim->time_s = (double)sim->tick * SIM_TICK_S;
}

void sim_take_wheel(struct sim *sim)
{
	if (sim->by_hand)
		return;
	hand_take_over(&sim->hand, &sim->drive.graph, &sim->state);
	sim->by_hand = true;
	sim->ended = false;
}

void sim_set_ignition(struct sim *sim, bool on)
{
	sim->ignition = on;
	sim->ignition_s = sim->time_s;
	bus_say_ignition(sim->bus, on ? 2 : 0);
}
