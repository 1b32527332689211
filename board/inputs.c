#include "board/inputs.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"

#define STEP_NS (10 * NS_PER_MS)
#define RECORD_LIMIT_BYTES (UINT64_C(1) << 30)

static int open_bus(struct inputs *inputs, const struct options *options, struct arena *arena)
{
	struct can_bus_config config = {
		.path = options->replay,
		.interfaces = inputs->car.interfaces,
		.interface_count = inputs->car.interface_count,
		.filters = inputs->car.filters,
		.filter_count = options->record ? 0 : inputs->car.filter_count, /* a recording holds everything */
	};
	/* the built-in profile is for drives without a car; one that was chosen knows its interfaces */
	bool from_profile = options->profile && config.interface_count > 0;
	if (!options->replay && !options->can_count && !from_profile)
		return 0;
	const struct can_bus_ops *ops = options->replay ? &can_replay_ops : &can_live_ops;
	int status = can_bus_open(&inputs->bus, ops, &config, arena);
	const char *what = options->replay ? options->replay : config.interfaces[0];
	if (status == -ENODATA)
		log_error("%s: not a single CAN frame in it", what);
	else if (status < 0)
		log_error("%s: cannot open: %s", what, strerror(-status));
	/* A board whose kernel has no CAN still shows its picture, and says so in it. */
	inputs->bus_missing = status < 0 && !options->replay && !options->can_count;
	inputs->bus_missing_ns = clock_now_ns();
	inputs->machine_fault = status < 0 && !options->replay;
	return inputs->bus_missing ? 0 : status;
}

/* Of a live bus the newest are kept, within bounds; of a replay everything. */
static int open_recorder(struct inputs *inputs, const struct options *options, struct arena *arena)
{
	struct can_record_config config = {
		.path = options->record,
		.limit_bytes = options->record_limit_bytes,
		.wait = options->replay != NULL,
	};
	if (!config.limit_bytes && !options->replay)
		config.limit_bytes = RECORD_LIMIT_BYTES;
	int status = can_record_open(&inputs->recorder, &config, arena);
	if (status < 0)
		log_error("%s: cannot write: %s", options->record, strerror(-status));
	inputs->machine_fault = status < 0;
	return status;
}

static void set_course(struct inputs *inputs, const struct options *options, const struct profile *profile)
{
	bool started = true;
	if (options->has_start)
		started = nav_set_start(&inputs->nav, options->start.lat_deg, options->start.lon_deg,
			options->has_heading ? options->start_heading_deg : (double)NAN);
	else if (profile->has_start)
		started = nav_set_start(&inputs->nav, profile->start.lat_deg, profile->start.lon_deg,
			profile->has_heading ? profile->start_heading_deg : (double)NAN);
	if (!started)
		log_warn("no street near the start position; waiting for a satellite position");
	if (options->has_destination &&
		!nav_set_destination(&inputs->nav, options->destination.lat_deg, options->destination.lon_deg))
		log_warn("no street near the destination");
}

static void set_stops(struct inputs *inputs)
{
	if (!inputs->destination.stop_count)
		nav_clear_destination(&inputs->nav);
	else if (!nav_set_stops(&inputs->nav, inputs->destination.stops, inputs->destination.stop_count))
		log_warn("no street near the destination that the car asks for");
}

int inputs_map(struct inputs *inputs, const struct options *options, const struct profile *profile,
	const struct pkg *pkg, struct arena *arena)
{
	struct nav_config config = { 0 };
	int status = nav_init(&inputs->nav, arena, pkg, &config);
	if (status < 0) {
		log_error("the memory budget is too small for the street graph of this city (%zu bytes)",
			nav_bytes(&pkg->graph, &config));
		inputs->nav.pkg = NULL;
		return status;
	}
	set_course(inputs, options, profile);
	if (inputs->destination_waits)
		set_stops(inputs);
	return 0;
}

/* A replay hears the receiver of its own drive, or none: a daemon of today says nothing about it. */
static int open_receiver(
	struct inputs *inputs, const struct options *options, const struct profile *profile, struct arena *arena)
{
	const char *spec = options->gnss ? options->gnss : options->replay ? NULL : profile->gnss;
	return receiver_open(&inputs->receiver, spec, inputs->bus ? inputs->bus->wall_offset_ns : 0, arena);
}

int inputs_open(struct inputs *inputs, const struct options *options, const struct profile *profile,
	const struct pkg *pkg, struct arena *arena)
{
	*inputs = (struct inputs){ 0 };
	int status = car_init(&inputs->car, profile, options->dbc, (unsigned)options->dbc_count, options->can,
		(unsigned)options->can_count, arena);
	if (status < 0)
		return status;
	vehicle_init(&inputs->vehicle, &inputs->car.vehicle);
	obd_init(&inputs->obd, &inputs->car.obd, 0);
	destination_init(&inputs->destination, inputs->car.destination);
	if (pkg && (status = inputs_map(inputs, options, profile, pkg, arena)) < 0)
		return status;
	if ((status = open_bus(inputs, options, arena)) < 0)
		return status;
	if ((status = open_receiver(inputs, options, profile, arena)) < 0)
		return status;
	return options->record ? open_recorder(inputs, options, arena) : 0;
}

static void record(struct inputs *inputs, const struct can_frame_rx *frame)
{
	if (!inputs->recorder || frame->bus >= inputs->bus->interface_count)
		return;
	struct can_frame_rx stamped = *frame;
	stamped.time_ns += inputs->bus->wall_offset_ns;
	can_record_add(inputs->recorder, inputs->bus->interfaces[frame->bus].name, &stamped);
}

static void take_frame(struct inputs *inputs, struct can_frame_rx *frame)
{
	record(inputs, frame);
	if (inputs->car.obd.pid_count && !obd_take(&inputs->obd, frame))
		return;
	vehicle_feed(&inputs->vehicle, frame);
	if (!inputs->destination.count_signal || !destination_feed(&inputs->destination, frame))
		return;
	inputs->destinations++;
	if (inputs->nav.pkg)
		set_stops(inputs);
	else
		inputs->destination_waits = true;
}

/* The one thing that is ever sent. A controller that is off or sees many errors is left alone. */
static void ask_car(struct inputs *inputs, int64_t now_ns)
{
	struct can_frame_rx question;
	if (!inputs->bus || !inputs->bus->ops->write || !inputs->car.obd.pid_count)
		return;
	enum can_health health = inputs->bus->interfaces[inputs->car.obd.bus].health;
	if (health == CAN_HEALTH_OFF || health == CAN_HEALTH_DOWN || health == CAN_HEALTH_PASSIVE)
		return;
	if (!obd_ask(&inputs->obd, now_ns, &question))
		return;
	if (can_bus_write(inputs->bus, &question) < 0)
		obd_failed(&inputs->obd, now_ns);
	else
		record(inputs, &question);
}

static void read_bus(struct inputs *inputs, int64_t until_ns)
{
	while (inputs->bus && !inputs->read_error) {
		int count = can_bus_read(inputs->bus, until_ns, inputs->batch, INPUTS_BATCH);
		if (count < 0) {
			inputs->read_error = count;
			log_error("the CAN bus cannot be read any more: %s", strerror(-count));
		}
		for (int i = 0; i < count; i++)
			take_frame(inputs, &inputs->batch[i]);
		if (count < INPUTS_BATCH)
			return;
	}
}

/* The bus that is worst off, for the driver. */
static void tell_bus(const struct inputs *inputs, int64_t now_ns, struct nav_view *out)
{
	static const enum nav_bus_state states[] = {
		[CAN_HEALTH_PASSIVE] = NAV_BUS_ERRORS,
		[CAN_HEALTH_OFF] = NAV_BUS_OFF,
		[CAN_HEALTH_DOWN] = NAV_BUS_DOWN,
	};
	const struct can_interface *worst = NULL;
	for (unsigned i = 0; inputs->bus && i < inputs->bus->interface_count; i++) {
		const struct can_interface *interface = &inputs->bus->interfaces[i];
		if (states[interface->health] > (worst ? states[worst->health] : NAV_BUS_GOOD))
			worst = interface;
	}
	memset(out->bus_name, 0, sizeof(out->bus_name));
	out->bus = inputs->bus_missing ? NAV_BUS_DOWN : worst ? states[worst->health] : NAV_BUS_GOOD;
	int64_t since_ns = inputs->bus_missing ? inputs->bus_missing_ns : worst ? worst->health_ns : now_ns;
	out->bus_age_ns = now_ns > since_ns ? now_ns - since_ns : 0;
	if (inputs->bus_missing)
		can_bus_short_name(inputs->car.interfaces[0], out->bus_name);
	else if (worst)
		memcpy(out->bus_name, worst->name, sizeof(out->bus_name));
}

void inputs_advance(struct inputs *inputs, int64_t now_ns, struct nav_view *out)
{
	struct vehicle_state *state = &inputs->state;
	while (inputs->nav.pkg && inputs->now_ns < now_ns - STEP_NS) {
		/* After a long pause of ours only the last second is stepped through finely. */
		int64_t behind = now_ns - inputs->now_ns;
		inputs->now_ns += behind > 60 * NS_PER_S ? behind - NS_PER_S : STEP_NS;
		read_bus(inputs, inputs->now_ns);
		vehicle_sample(&inputs->vehicle, inputs->now_ns, state);
		receiver_merge(&inputs->receiver, state);
		nav_update(&inputs->nav, state, inputs->now_ns, inputs_wall_ns(inputs, inputs->now_ns), NULL);
	}
	inputs->now_ns = now_ns;
	read_bus(inputs, now_ns);
	ask_car(inputs, now_ns);
	vehicle_sample(&inputs->vehicle, now_ns, state);
	receiver_merge(&inputs->receiver, state);
	if (inputs->nav.pkg)
		nav_update(&inputs->nav, state, now_ns, inputs_wall_ns(inputs, now_ns), out);
	else
		nav_without_map(state, now_ns, inputs_wall_ns(inputs, now_ns), out);
	tell_bus(inputs, now_ns, out);
}

bool inputs_ended(const struct inputs *inputs)
{
	return inputs->read_error || (inputs->bus && inputs->bus->ended);
}

int64_t inputs_wall_ns(const struct inputs *inputs, int64_t now_ns)
{
	return inputs->bus && inputs->bus->wall_offset_ns ? now_ns + inputs->bus->wall_offset_ns : 0;
}

void inputs_stats(const struct inputs *inputs, struct stats *out)
{
	const struct can_bus *bus = inputs->bus;
	out->can_frames_in = inputs->vehicle.frames_in;
	out->can_frames_bad = inputs->vehicle.frames_bad + (bus ? bus->stats.bad : 0);
	for (int i = 0; i < VEHICLE_INPUT_COUNT; i++)
		memcpy(out->signal_faults[i], inputs->vehicle.inputs[i].faults, sizeof(out->signal_faults[i]));
	out->can_frames_lost = bus ? bus->stats.dropped : 0;
	out->can_cpu_ms = bus ? (double)bus->stats.reader_cpu_ns / 1e6 : 0.0;
	out->can_interfaces = bus ? bus->interfaces : NULL;
	out->can_interface_count = bus ? bus->interface_count : 0;
	if (inputs->recorder) {
		struct can_record_stats recorded;
		can_record_stats(inputs->recorder, &recorded);
		out->record_lines = recorded.lines;
		out->record_lost = recorded.lost;
	}
	out->stale_ns_max = inputs->vehicle.stale_ns_max;
	out->reroutes = inputs->nav.reroutes;
}

int inputs_close(struct inputs *inputs)
{
	int status = can_record_close(inputs->recorder);
	receiver_close(&inputs->receiver);
	can_bus_close(inputs->bus);
	inputs->bus = NULL;
	inputs->recorder = NULL;
	return status;
}
