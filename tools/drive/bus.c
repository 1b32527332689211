/* What the car's bus says: the messages of board/profiles/boulevard.dbc at their cycle times, with the errors that real
 * sensors have. Ten-millisecond ticks; the messages of a tick follow one another at 250 us. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/log.h"
#include "platform/base/rng.h"
#include "platform/can/candump.h"
#include "platform/can/checksum.h"
#include "platform/can/dbc_boulevard.h"
#include "tools/drive/drive.h"

#define TICK_NS BUS_TICK_NS
#define FRAME_GAP_NS INT64_C(250000)
#define STEERING_RATIO 15.0
#define WHEELBASE_M 2.7
#define TRACK_M 1.55
#define KMH 3.6
#define DEG (180.0 / BLVD_PI)
#define START_FIX_S 2.0
#define ODOMETER_START_KM 12345.0
#define INTERFACE "vcan0"

struct bus {
	const struct drive *drive;
	struct dbc dbc;
	struct bus_sink sink;
	int64_t wall_ns;
	struct rng rng;
	double speed_error, yaw_bias_rps;
	double wander[2]; /* slow error of the fixes, m */
	double dropout_s; /* no fixes until then */
	double next_dropout_s;
	unsigned counter[3];
	double last_steering_deg;
	uint32_t next_stop;
	double ambient;
	double light; /* instead; negative: none */
	bool says_power;
	int ignition;
	int faults;              /* values that the definitions cannot hold */
	uint8_t memory[1 << 18]; /* of the definitions */
};

struct message {
	struct bus *sender;
	const struct dbc_message *definition;
	struct can_frame_rx frame;
};

static bool begin(struct bus *sender, const char *name, struct message *out)
{
	out->sender = sender;
	out->definition = dbc_find_message(&sender->dbc, name);
	if (!out->definition) {
		sender->faults++;
		return false;
	}
	dbc_frame_init(out->definition, &out->frame);
	return true;
}

static const struct dbc_signal *signal_of(const struct message *message, const char *name)
{
	for (const struct dbc_signal *s = message->definition->signals; s; s = s->next)
		if (!strcmp(s->name, name))
			return s;
	return NULL;
}

static void put(struct message *message, const char *name, double value)
{
	const struct dbc_signal *s = signal_of(message, name);
	if (!s || dbc_encode(s, value, &message->frame) == -EINVAL)
		message->sender->faults++;
}

static void send(struct message *message, int slot)
{
	message->frame.time_ns = message->sender->wall_ns + slot * FRAME_GAP_NS;
	message->sender->sink.frame(message->sender->sink.context, &message->frame);
}

static void send_protected(struct message *message, unsigned *counter, int slot)
{
	put(message, "Counter", *counter & 15u);
	++*counter;
	const struct dbc_signal *s = signal_of(message, "Checksum");
	if (!s || can_checksum_put(CAN_CHECKSUM_CRC8, s, &message->frame))
		message->sender->faults++;
	send(message, slot);
}

/* Irwin-Hall, as good as normal here. */
static double noise(struct bus *sender, double sigma)
{
	double sum = 0.0;
	for (int i = 0; i < 4; i++)
		sum += rng_unit(&sender->rng) - 0.5;
	return sum * 1.7320508 * sigma;
}

static void send_motion(struct bus *sender, const struct drive_state *state)
{
	struct message m;
	if (!begin(sender, "MOTION", &m))
		return;
	double speed = fabs(state->speed_mps), said = speed * (1.0 + sender->speed_error);
	if (speed > 0.3)
		said = fmax(said + noise(sender, 0.01), 0.0);
	double rate = state->yaw_rate_rps + sender->yaw_bias_rps + noise(sender, 0.0012);
	put(&m, "Speed", said * KMH);
	put(&m, "YawRate", -rate * DEG);
	put(&m, "LongitudinalAcceleration", state->accel_mps2 + noise(sender, 0.03));
	put(&m, "Standstill", speed <= 0.0);
	send_protected(&m, &sender->counter[0], 1);
}

static void send_wheels(struct bus *sender, const struct drive_state *state)
{
	struct message m;
	if (!begin(sender, "WHEELS", &m))
		return;
	double inner = 0.5 * TRACK_M * state->yaw_rate_rps, said = state->speed_mps * (1.0 + sender->speed_error);
	/* wheels do not say which way they turn */
	double sign = state->speed_mps < 0.0 ? -1.0 : 1.0;
	double left = fmax(sign * (said + inner), 0.0) * KMH, right = fmax(sign * (said - inner), 0.0) * KMH;
	put(&m, "WheelFrontLeft", left);
	put(&m, "WheelFrontRight", right);
	put(&m, "WheelRearLeft", left);
	put(&m, "WheelRearRight", right);
	send(&m, 2);
}

static void send_steering(struct bus *sender, const struct drive_state *state)
{
	struct message m;
	if (!begin(sender, "STEERING", &m))
		return;
	double deg = atan(WHEELBASE_M * state->curvature) * STEERING_RATIO * DEG;
	double rate = (deg - sender->last_steering_deg) / ((double)TICK_NS * 1e-9);
	sender->last_steering_deg = deg;
	put(&m, "SteeringAngle", -deg);
	put(&m, "SteeringRate", fmin(fmax(-rate, -2000.0), 2000.0));
	send_protected(&m, &sender->counter[1], 0);
}

static void send_drivetrain(struct bus *sender, const struct drive_state *state)
{
	struct message m;
	if (!begin(sender, "DRIVETRAIN", &m))
		return;
	static const double said[] = {
		[NAV_GEAR_PARK] = 0.0, [NAV_GEAR_REVERSE] = 1.0, [NAV_GEAR_NEUTRAL] = 2.0, [NAV_GEAR_DRIVE] = 3.0
	};
	enum nav_gear gear = state->gear;
	if (gear == NAV_GEAR_UNKNOWN)
		gear = state->parked ? NAV_GEAR_PARK : NAV_GEAR_DRIVE;
	put(&m, "Gear", said[gear]);
	put(&m, "ParkingBrake", gear == NAV_GEAR_PARK);
	send_protected(&m, &sender->counter[2], 3);
}

static bool in_tunnel(const struct bus *sender, const struct drive_state *state)
{
	return graph_edge(&sender->drive->graph, state->half)->flags & PKG_EDGE_TUNNEL;
}

static void send_body(struct bus *sender, const struct drive_state *state)
{
	struct message m;
	if (!begin(sender, "BODY", &m))
		return;
	double light = in_tunnel(sender, state) ? 0.08 : 1.0;
	double target = (sender->light < 0.0 ? sender->ambient : sender->light) * light + (light < 1.0 ? 0.02 : 0.0);
	put(&m, "TurnLamp", state->lamp < 0 ? 1.0 : state->lamp > 1 ? 3.0 : state->lamp > 0 ? 2.0 : 0.0);
	put(&m, "LowBeam", target < 0.3);
	put(&m, "AmbientLight", fmin(target, 1.0) * 100.0);
	send(&m, 4);
}

static void send_power(struct bus *sender)
{
	struct message m;
	if (!sender->says_power || !begin(sender, "POWER", &m))
		return;
	put(&m, "Ignition", sender->ignition);
	put(&m, "BatteryVoltage", sender->ignition > 1 ? 14.1 : 12.4);
	send(&m, 10);
}

static void send_odometer(struct bus *sender, const struct drive_state *state)
{
	struct message m;
	if (!begin(sender, "ODOMETER", &m))
		return;
	put(&m, "Odometer", ODOMETER_START_KM + state->odometer_m * 1e-3);
	send(&m, 5);
}

/* Errors of fixes: slow wander, quick noise, silence in tunnels and now and then. The fixes before setting off are
 * exact: they tell a replay where it starts. */
static bool fix_error(struct bus *sender, const struct drive_state *state, double error[2])
{
	error[0] = error[1] = 0.0;
	if (!state->driving && state->time_s < START_FIX_S)
		return true;
	for (int k = 0; k < 2; k++) {
		sender->wander[k] += -sender->wander[k] * 0.2 / 30.0 + noise(sender, 2.2 * sqrt(2.0 * 0.2 / 30.0));
		error[k] = sender->wander[k] + noise(sender, 0.5);
	}
	if (state->time_s > sender->next_dropout_s) {
		sender->dropout_s = state->time_s + rng_range(&sender->rng, 3.0, 12.0);
		sender->next_dropout_s = sender->dropout_s + rng_range(&sender->rng, 40.0, 140.0);
	}
	return state->time_s >= sender->dropout_s && !in_tunnel(sender, state);
}

static void send_fix(struct bus *sender, const struct drive_state *state)
{
	struct message position, motion;
	double error[2];
	if (!sender->drive->options->gnss && state->time_s >= START_FIX_S)
		return;
	bool valid = fix_error(sender, state, error);
	if (!begin(sender, "GNSS_POSITION", &position) || !begin(sender, "GNSS_MOTION", &motion))
		return;
	struct dvec2 at = { state->at.x + error[0], state->at.y + error[1] };
	struct geo_point geo = geo_from_plane(&sender->drive->pkg->frame, at);
	if (valid) {
		put(&position, "Latitude", geo.lat_deg);
		put(&position, "Longitude", geo.lon_deg);
	}
	put(&position, "PositionValid", valid);
	bool course = valid && (state->speed_mps > 1.5 || state->time_s < START_FIX_S);
	double deg = fmod(state->heading_rad * DEG + (state->speed_mps > 1.5 ? noise(sender, 1.0) : 0.0), 360.0);
	put(&motion, "Course", course ? fmin(deg < 0.0 ? deg + 360.0 : deg, 359.99) : 0.0);
	put(&motion, "GroundSpeed", valid ? fabs(state->speed_mps) : 0.0);
	put(&motion, "Accuracy", state->time_s < START_FIX_S ? 0.5 : 3.0);
	put(&motion, "Satellites", valid ? 11.0 : 0.0);
	put(&motion, "FixType", valid ? 3.0 : 0.0);
	put(&motion, "CourseValid", course);
	/* The course comes first, so that a start knows its direction as soon as its place. */
	send(&motion, 6);
	send(&position, 7);
}

static void send_time(struct bus *sender)
{
	struct message m;
	if (!begin(sender, "GNSS_TIME", &m))
		return;
	put(&m, "UtcMilliseconds", floor((double)sender->wall_ns * 1e-6));
	send(&m, 8);
}

/* One stop a frame, in turn. */
static void send_destination(struct bus *sender)
{
	struct message m;
	const struct drive *drive = sender->drive;
	if (!drive->stop_count || !begin(sender, "DESTINATION", &m))
		return;
	uint32_t i = sender->next_stop++ % drive->stop_count;
	put(&m, "StopCount", drive->stop_count);
	put(&m, "StopIndex", i);
	put(&m, "Latitude", drive->stop_at[i].lat_deg);
	put(&m, "Longitude", drive->stop_at[i].lon_deg);
	send(&m, 9);
}

void bus_tick(struct bus *sender, const struct drive_state *state, int64_t tick, int64_t wall_ns)
{
	sender->wall_ns = wall_ns;
	if (tick % 500 == 0)
		sender->ambient = ambient_light(sender->drive->pkg->frame.origin, wall_ns);
	send_steering(sender, state);
	if (tick % 2 == 0) {
		send_motion(sender, state);
		send_wheels(sender, state);
	}
	if (tick % 10 == 1)
		send_drivetrain(sender, state);
	if (tick % 10 == 3)
		send_body(sender, state);
	if (tick % 10 == 4)
		send_power(sender);
	if (tick % 20 == 5)
		send_odometer(sender, state);
	if (tick % 20 == 7)
		send_fix(sender, state);
	if (tick % 100 == 9)
		send_time(sender);
	/* A whole list within the first seconds, then at leisure. */
	if (tick % (tick < 300 ? 20 : 100) == 11)
		send_destination(sender);
}

static void write_truth(FILE *truth, const struct bus *sender, const struct drive_state *state)
{
	double deg = fmod(state->heading_rad * DEG, 360.0);
	fprintf(truth, "%lld.%06lld,%.3f,%.3f,%.3f,%.3f,%.3f,%u,%.3f\n", (long long)(sender->wall_ns / 1000000000),
		(long long)(sender->wall_ns / 1000 % 1000000), state->at.x, state->at.y, state->at.z,
		deg < 0.0 ? deg + 360.0 : deg, state->speed_mps, state->half, state->along_m);
}

static void choose_errors(struct bus *sender, const struct drive_options *options)
{
	sender->rng = rng_seed(options->seed ^ 0xCA4);
	sender->speed_error = rng_range(&sender->rng, -0.005, 0.005);
	sender->yaw_bias_rps = rng_range(&sender->rng, -0.1, 0.1) / DEG;
	if (isfinite(options->speed_error))
		sender->speed_error = options->speed_error;
	if (isfinite(options->yaw_bias_rps))
		sender->yaw_bias_rps = options->yaw_bias_rps;
	sender->next_dropout_s = rng_range(&sender->rng, 30.0, 120.0);
}

struct bus *bus_new(const struct drive *drive, const struct bus_sink *sink)
{
	struct bus *made = calloc(1, sizeof(*made));
	struct arena arena;
	struct dbc_note note;
	if (!made)
		abort();
	made->drive = drive;
	made->sink = *sink;
	made->light = -1.0;
	choose_errors(made, drive->options);
	arena_init(&arena, "dbc", made->memory, sizeof(made->memory));
	if (dbc_parse(&made->dbc, dbc_boulevard_text, dbc_boulevard_size, &arena, &note) == 0)
		return made;
	log_error("boulevard.dbc:%u: %s", note.line, note.text);
	free(made);
	return NULL;
}

void bus_free(struct bus *bus)
{
	if (bus && bus->faults)
		log_warn("%d values did not fit the signal definitions", bus->faults);
	free(bus);
}

void bus_say_ignition(struct bus *bus, int ignition)
{
	bus->says_power = true;
	bus->ignition = ignition;
}

void bus_set_light(struct bus *bus, double light)
{
	bus->light = light;
}

const struct dbc *bus_dbc(const struct bus *bus)
{
	return &bus->dbc;
}

/* --- a log --- */

static void to_log(void *context, const struct can_frame_rx *frame)
{
	candump_writer_add(context, INTERFACE, frame);
}

int bus_write(const struct drive *drive, struct drive_motion *motion, int log_fd, FILE *truth)
{
	struct candump_writer *writer = malloc(sizeof(*writer));
	if (!writer)
		abort();
	candump_writer_init(writer, log_fd);
	struct bus *bus = bus_new(drive, &(struct bus_sink){ to_log, writer });
	int err = bus ? 0 : -EINVAL;
	if (truth)
		fputs("time_s,east_m,north_m,up_m,heading_deg,speed_mps,half,along_m\n", truth);
	int64_t ticks = (int64_t)(motion->end_s * 1e9) / TICK_NS;
	for (int64_t tick = 0; !err && tick <= ticks && !writer->error; tick++) {
		struct drive_state state = motion_at(motion, (double)tick * 1e-9 * (double)TICK_NS);
		bus_tick(bus, &state, tick, drive->options->wall_ns + tick * TICK_NS);
		if (truth && tick % 5 == 0)
			write_truth(truth, bus, &state);
	}
	int flush = candump_writer_flush(writer);
	bus_free(bus);
	free(writer);
	return err ? err : flush;
}

double ambient_light(struct geo_point at, int64_t wall_ns)
{
	double days = ((double)wall_ns * 1e-9 - 946728000.0) / 86400.0; /* since 2000-01-01 12:00 */
	double mean = fmod(357.529 + 0.98560028 * days, 360.0) / DEG;
	double longitude = (280.459 + 0.98564736 * days + 1.915 * sin(mean) + 0.020 * sin(2.0 * mean)) / DEG;
	double tilt = 23.439 / DEG;
	double right = atan2(cos(tilt) * sin(longitude), cos(longitude)), declination = asin(sin(tilt) * sin(longitude));
	double sidereal = fmod(280.46062 + 360.98564737 * days + at.lon_deg, 360.0) / DEG;
	double hour = sidereal - right, lat = at.lat_deg / DEG;
	double height = asin(sin(lat) * sin(declination) + cos(lat) * cos(declination) * cos(hour)) * DEG;
	double t = fmin(fmax((height + 7.0) / 22.0, 0.0), 1.0);
	return 0.01 + 0.99 * t * t * (3.0 - 2.0 * t);
}
