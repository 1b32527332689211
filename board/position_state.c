#include "board/position_state.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"

#define MOVED_M 20.0   /* less is not worth a write */
#define TURNED_RAD 0.3 /* nor is this */
#define STOPPED_MPS 0.1
#define STOPPED_NS (2 * NS_PER_S) /* standing for so long is a stop: the next thing may be the key */
#define SAME_ODOMETER_M 15.0      /* it is told once a second */
#define ODOMETER_MAX_M 1e5        /* more since the last run is another car */

/* On the medium. Little-endian like the package; unknown bytes at the end are passed over, missing ones are zero. */
struct position_stored {
	double lat_deg, lon_deg, height_m, heading_rad;
	double position_var[3], heading_var;
	double speed_scale, scale_var, yaw_bias_rps, bias_var;
	double along_m;
	double odometer_m; /* NAN unknown */
	uint64_t package;  /* identity: half and along_m are of this one */
	int64_t wall_ns;   /* when, 0 unknown */
	uint32_t half;
	uint32_t on_street;
	char city[48]; /* for people */
};
static_assert(sizeof(struct position_stored) == 184, "on-disk layout");
static_assert(sizeof(struct position_stored) <= sizeof(((struct position_state *)0)->bytes), "fits");

static void pack(const struct position_state *state, const struct nav_memory *from, double odometer_m, int64_t wall_ns,
	struct position_stored *out)
{
	*out = (struct position_stored){
		.lat_deg = from->lat_deg,
		.lon_deg = from->lon_deg,
		.height_m = from->height_m,
		.heading_rad = from->heading_rad,
		.position_var = { from->position_var[0], from->position_var[1], from->position_var[2] },
		.heading_var = from->heading_var,
		.speed_scale = from->speed_scale,
		.scale_var = from->scale_var,
		.yaw_bias_rps = from->yaw_bias_rps,
		.bias_var = from->bias_var,
		.along_m = from->along_m,
		.odometer_m = odometer_m,
		.package = state->package,
		.wall_ns = wall_ns,
		.half = from->half,
		.on_street = from->on_street,
	};
	memcpy(out->city, state->city, sizeof(out->city));
}

static struct nav_memory unpack(const struct position_stored *from)
{
	return (struct nav_memory){
		.lat_deg = from->lat_deg,
		.lon_deg = from->lon_deg,
		.height_m = from->height_m,
		.heading_rad = from->heading_rad,
		.position_var = { from->position_var[0], from->position_var[1], from->position_var[2] },
		.heading_var = from->heading_var,
		.speed_scale = from->speed_scale,
		.scale_var = from->scale_var,
		.yaw_bias_rps = from->yaw_bias_rps,
		.bias_var = from->bias_var,
		.half = from->half,
		.on_street = from->on_street != 0,
		.along_m = from->along_m,
	};
}

/* The worker's side: everything it touches is its own from worker_give() to worker_take(). */
static void write_record(void *context, uint32_t job)
{
	struct position_state *state = context;
	(void)job;
	state->failed = record_save(&state->record, POSITION_VERSION, state->bytes, state->size);
}

int position_state_open(struct position_state *state, const struct file_ops *ops, void *context, const char *folder)
{
	memset(state, 0, sizeof(*state));
	state->saved_ns = state->stopped_ns = INT64_MIN;
	state->saved_odometer_m = (double)NAN;
	if (ops == &file_ops_system && mkdir(folder, 0700) < 0 && errno != EEXIST)
		log_warn("%s: the last position cannot be kept there: %s", folder, strerror(errno));
	int found = record_open(
		&state->record, ops, context, folder, POSITION_RECORD, POSITION_VERSION, state->bytes, sizeof(state->bytes));
	if (found < 0) {
		log_warn("%.80s...: the last position cannot be kept there: %s", folder, strerror(-found));
		return found;
	}
	state->size = (uint32_t)found;
	int status = worker_init(&state->worker, "position", write_record, state);
	if (status < 0)
		log_warn("the last position cannot be kept: %s", strerror(-status));
	return status;
}

static void describe(const struct position_stored *stored, const struct position_state *state, bool taken, bool same)
{
	char city[sizeof(stored->city) + 1] = { 0 };
	memcpy(city, stored->city, sizeof(stored->city));
	if (!taken)
		log_info("the last position, in %s, is not in this city: waiting for a satellite position", city);
	else if (same)
		log_info("going on at the last position, known to %.0f m", sqrt(fmax(stored->position_var[0], 0.0)));
	else
		log_info("going on at the last position in another map (%s, now %s)", city, state->city);
}

bool position_state_begin(struct position_state *state, struct nav *nav, const struct pkg *pkg, bool restore)
{
	struct position_stored stored;
	uint32_t size = state->size;
	state->package = pkg->meta->source_hash;
	snprintf(state->city, sizeof(state->city), "%s", pkg_string(pkg, pkg->meta->city_name));
	state->size = 0;
	if (!restore || !size)
		return false;
	memset(&stored, 0, sizeof(stored));
	memcpy(&stored, state->bytes, size < sizeof(stored) ? size : sizeof(stored));
	bool same = stored.package == state->package;
	struct nav_memory memory = unpack(&stored);
	bool taken = nav_restore(nav, &memory, same);
	describe(&stored, state, taken, same);
	if (!taken)
		return false;
	state->saved = memory;
	state->saved_odometer_m = stored.odometer_m;
	state->has_saved = state->restored = true;
	return true;
}

static bool changed(const struct position_state *state, const struct nav_memory *now)
{
	const struct nav_memory *was = &state->saved;
	if (!state->has_saved || was->on_street != now->on_street)
		return true;
	double north = (now->lat_deg - was->lat_deg) * 111e3;
	double east = geo_lon_diff(now->lon_deg, was->lon_deg) * 111e3 * cos(now->lat_deg * (BLVD_PI / 180.0));
	return hypot(east, north) > MOVED_M ||
		   fabs(remainder(now->heading_rad - was->heading_rad, 2.0 * BLVD_PI)) > TURNED_RAD;
}

static double odometer_of(const struct vehicle_state *vehicle)
{
	return vehicle->odometer_usable ? vehicle->odometer_m : (double)NAN;
}

static void take_result(struct position_state *state)
{
	static const char *const what = "the last position could not be written";
	uint32_t job;
	if (!state->busy || !worker_take(&state->worker, false, &job))
		return;
	state->busy = false;
	if (!state->failed) {
		if (state->failing)
			log_info("%s: the last position is written again", state->record.folder);
		state->failing = false;
		state->writes++;
		return;
	}
	state->refused++;
	if (!state->failing)
		log_warn("%s: %s: %s", state->record.folder, what, strerror(-state->failed));
	state->failing = true;
	state->has_saved = false; /* tried again after the rest */
}

static void give(
	struct position_state *state, const struct nav_memory *memory, double odometer_m, int64_t now_ns, int64_t wall_ns)
{
	struct position_stored stored;
	pack(state, memory, odometer_m, wall_ns, &stored);
	memcpy(state->bytes, &stored, sizeof(stored));
	state->size = sizeof(stored);
	if (!worker_give(&state->worker, 0))
		return;
	state->busy = true;
	state->saved = *memory;
	state->saved_odometer_m = odometer_m;
	state->saved_ns = now_ns;
	state->has_saved = true;
	state->urgent = false;
}

/* The odometer went on without us: with the program not running, or the bus silent. */
static void compare_odometer(struct position_state *state, struct nav *nav, const struct vehicle_state *vehicle)
{
	if (!state->restored || !vehicle->odometer_usable)
		return;
	state->restored = false;
	double unseen = vehicle->odometer_m - state->saved_odometer_m;
	if (!(unseen > SAME_ODOMETER_M) || unseen > ODOMETER_MAX_M)
		return;
	log_info("the car went %.1f km since the last position was kept", unseen * 1e-3);
	nav_moved_unseen(nav, unseen);
}

static void note_stop(struct position_state *state, const struct vehicle_state *vehicle, int64_t now_ns)
{
	bool stands = vehicle->speed_usable && fabs(vehicle->speed_mps) < STOPPED_MPS;
	if (!stands)
		state->stopped_ns = INT64_MIN;
	else if (state->stopped_ns == INT64_MIN)
		state->stopped_ns = now_ns;
}

static bool is_due(const struct position_state *state, int64_t now_ns)
{
	bool stopped = state->stopped_ns != INT64_MIN && now_ns - state->stopped_ns >= STOPPED_NS;
	int64_t rest = stopped || state->urgent ? POSITION_URGENT_NS : POSITION_REST_NS;
	if (state->failing)
		rest = POSITION_REST_NS; /* a full disk is not asked every moment */
	return state->saved_ns == INT64_MIN || now_ns - state->saved_ns >= rest || now_ns < state->saved_ns;
}

void position_state_follow(
	struct position_state *state, struct nav *nav, const struct vehicle_state *vehicle, int64_t now_ns, int64_t wall_ns)
{
	struct nav_memory memory;
	if (!state->worker.started)
		return;
	compare_odometer(state, nav, vehicle);
	take_result(state);
	note_stop(state, vehicle, now_ns);
	if (state->busy || !is_due(state, now_ns) || !nav_remember(nav, &memory) || !changed(state, &memory))
		return;
	give(state, &memory, odometer_of(vehicle), now_ns, wall_ns);
}

void position_state_hurry(struct position_state *state)
{
	state->urgent = true;
}

void position_state_close(
	struct position_state *state, struct nav *nav, const struct vehicle_state *vehicle, int64_t wall_ns)
{
	struct nav_memory memory;
	uint32_t job;
	if (!state->worker.started)
		return;
	while (worker_take(&state->worker, true, &job))
		state->busy = false;
	if (nav->pkg && nav_remember(nav, &memory)) {
		give(state, &memory, odometer_of(vehicle), state->saved_ns, wall_ns);
		while (worker_take(&state->worker, true, &job)) {
			if (state->failed && !state->failing)
				log_warn(
					"%s: the last position could not be written: %s", state->record.folder, strerror(-state->failed));
			state->writes += !state->failed;
			state->refused += state->failed != 0;
		}
	}
	worker_finish(&state->worker);
	state->worker.started = false;
}
