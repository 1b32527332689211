/* A log through bus, vehicle and navigator at a fixed step, compared as it goes. */
#include "tools/drive/track.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/can/can_bus.h"
#include "tools/city/pool.h"

#define FRAMES_MAX 256
#define HOPS 6
#define SLACK_M 12.0
#define STRETCH_M 1000.0
#define ALIGN_M 150.0
#define DEG (180.0 / BLVD_PI)

/* --- truth --- */

int truth_read(struct truth *out, const char *path, const struct pkg_graph *net)
{
	*out = (struct truth){ 0 };
	ARRAY(struct truth_row) rows = { 0 };
	FILE *file = fopen(path, "r");
	if (!file) {
		int err = errno;
		log_error("%s: %s", path, strerror(err));
		return -err;
	}
	char line[256];
	double first_s = 0.0;
	int err = 0;
	for (unsigned number = 1; fgets(line, sizeof(line), file); number++) {
		struct truth_row row;
		if (number == 1)
			continue;
		if (sscanf(line, "%lf,%lf,%lf,%lf,%lf,%lf,%u,%lf", &row.time_s, &row.east_m, &row.north_m, &row.up_m,
				&row.heading_deg, &row.speed_mps, &row.half, &row.along_m) != 8 ||
			row.half >= net->half_count) {
			log_error("%s:%u: no row of a truth file of this city", path, number);
			err = -EBADMSG;
			break;
		}
		first_s = rows.count ? first_s : row.time_s;
		row.time_s -= first_s;
		ARRAY_PUSH(&rows, row);
	}
	fclose(file);
	out->rows = rows.items;
	out->count = rows.count;
	if (!err && !rows.count) {
		log_error("%s: empty", path);
		err = -EBADMSG;
	}
	return err;
}

void truth_finish(struct truth *truth)
{
	array_free(truth->rows);
	*truth = (struct truth){ 0 };
}

/* Can one drive from a place to another within `room_m`? */
static bool leads_to(
	const struct graph *graph, uint32_t half, double along_m, uint32_t goal, double goal_m, double room_m, int hops)
{
	if (half == goal)
		return goal_m >= along_m - room_m && goal_m - along_m <= room_m;
	room_m -= graph_length_m(graph, half) - along_m;
	if (room_m < 0.0 || !hops)
		return false;
	uint32_t out[GRAPH_SUCCESSORS_MAX], count = graph_successors(graph, half, GRAPH_PHYSICAL, out);
	for (uint32_t i = 0; i < count; i++)
		if (out[i] != graph_twin(half) && leads_to(graph, out[i], 0.0, goal, goal_m, room_m, hops - 1))
			return true;
	return false;
}

bool track_same_place(const struct graph *graph, uint32_t half, double along_m, const struct truth_row *truth)
{
	if (half == truth->half)
		return true;
	struct dvec3 a = graph_at(graph, half, along_m).at_m, b = graph_at(graph, truth->half, truth->along_m).at_m;
	return hypot(a.x - b.x, a.y - b.y) <= SLACK_M &&
		   (leads_to(graph, half, along_m, truth->half, truth->along_m, 2.0 * SLACK_M, HOPS) ||
			   leads_to(graph, truth->half, truth->along_m, half, along_m, 2.0 * SLACK_M, HOPS));
}

/* --- the run --- */

typedef ARRAY(double) values;

struct fix_row {
	struct dvec2 said, reckoned;
	double travelled_m;
};

struct run {
	const struct track_options *options;
	struct track_result *out;
	struct vehicle vehicle;
	struct vehicle_state state;
	struct destination destination;
	struct nav nav;
	struct reckon alone; /* dead reckoning without any help */
	struct geo_frame frame;
	bool has_frame;
	uint32_t fixes;
	size_t row;
	values pos, heading, along;
	ARRAY(struct fix_row) fix_rows;
	double wrong_m, last_s;
	struct can_frame_rx frames[FRAMES_MAX];
};

static int compare_doubles(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double percentile(values *of, double share)
{
	if (!of->count)
		return 0.0;
	qsort(of->items, of->count, sizeof(double), compare_doubles);
	return of->items[(size_t)(share * (double)(of->count - 1) + 0.5)];
}

static void compare_truth(struct run *run, const struct nav_view *view, double time_s)
{
	const struct truth *truth = run->options->truth;
	while (run->row + 1 < truth->count && truth->rows[run->row + 1].time_s <= time_s + 1e-6)
		run->row++;
	const struct truth_row *row = &truth->rows[run->row];
	if (row->time_s > time_s || time_s - row->time_s > 0.04 || !view->located)
		return;
	struct track_result *out = run->out;
	double moved = row->speed_mps * (time_s - run->last_s);
	run->last_s = time_s;
	bool right = view->on_street && track_same_place(&run->nav.graph, view->half, view->along_m, row);
	out->samples++;
	out->right += right;
	out->exact += view->half == row->half;
	out->on_street += view->on_street;
	run->wrong_m = right ? 0.0 : run->wrong_m + moved;
	out->wrong_run_m = fmax(out->wrong_run_m, run->wrong_m);
	double east = (double)view->pos_mm[0] * 1e-3 - row->east_m, north = (double)view->pos_mm[1] * 1e-3 - row->north_m;
	double heading = bam_to_rad(view->heading_bam) - row->heading_deg / DEG;
	ARRAY_PUSH(&run->pos, hypot(east, north));
	ARRAY_PUSH(&run->heading, fabs(remainder(heading, 2.0 * BLVD_PI)) * DEG);
	if (view->half == row->half)
		ARRAY_PUSH(&run->along, fabs(view->along_m - row->along_m));
}

static void write_trace(const struct run *run, const struct nav_view *view, double time_s)
{
	if (!run->options->trace || !view->located)
		return;
	fprintf(run->options->trace, "%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%u,%.3f,%d,%.3f,%.2f,%d,%.1f,%d,%.1f,%u\n", time_s,
		(double)view->pos_mm[0] * 1e-3, (double)view->pos_mm[1] * 1e-3, (double)view->pos_mm[2] * 1e-3,
		bam_to_rad(view->heading_bam) * DEG, view->speed_mps, view->half, view->along_m, view->on_street,
		run->nav.match.confidence, view->uncertainty_m, view->routed + 2 * view->off_route, view->remaining_m,
		(int)view->next.manoeuvre, view->next.distance_m, view->reroutes);
}

static void note_fix(struct run *run)
{
	if (!run->state.has_fix || run->state.fixes == run->fixes)
		return;
	run->fixes = run->state.fixes;
	struct geo_point geo = { run->state.lat_deg, run->state.lon_deg };
	if (!run->has_frame)
		run->frame = geo_frame_at(geo);
	run->has_frame = true;
	struct fix_row row = { .said = geo_to_plane(&run->frame, geo), .travelled_m = run->alone.travelled_m };
	row.reckoned.x = (double)run->alone.pos_mm[0] * 1e-3;
	row.reckoned.y = (double)run->alone.pos_mm[1] * 1e-3;
	ARRAY_PUSH(&run->fix_rows, row);
}

static void advance(struct run *run, int64_t now_ns, double step_s)
{
	struct nav_view view;
	vehicle_sample(&run->vehicle, now_ns, &run->state);
	struct reckon_input motion = {
		.speed_valid = run->state.speed_usable,
		.speed_mps = run->state.speed_mps,
		.yaw_valid = run->state.yaw_source != VEHICLE_YAW_NONE,
		.yaw_biased = run->state.yaw_source == VEHICLE_YAW_SENSOR,
		.yaw_rate_rps = run->state.yaw_rate_rps,
	};
	reckon_update(&run->alone, &motion, now_ns);
	note_fix(run);
	if (!run->options->pkg)
		return;
	memset(&view, 0, sizeof(view));
	nav_update(&run->nav, &run->state, now_ns, 0, &view);
	double time_s = (double)now_ns * 1e-9;
	run->out->routed = run->out->routed || view.routed;
	run->out->off_route_s += view.off_route ? step_s : 0.0;
	run->out->arrived = run->out->routed && !run->nav.stop_count;
	run->out->reroutes = view.reroutes;
	if (run->options->truth)
		compare_truth(run, &view, time_s);
	write_trace(run, &view, time_s);
	if (run->options->on_view)
		run->options->on_view(run->options->context, &view);
}

static void feed(struct run *run, const struct can_frame_rx *frame)
{
	vehicle_feed(&run->vehicle, frame);
	if (!run->options->pkg || run->options->free || !destination_feed(&run->destination, frame))
		return;
	if (run->destination.stop_count)
		nav_set_stops(&run->nav, run->destination.stops, run->destination.stop_count);
	else
		nav_clear_destination(&run->nav);
}

/* Drift of dead reckoning over a stretch that starts at fix `first`: laid on the fixes by its first 150 m. Returns
 * false when the stretch is not whole. */
static bool stretch_drift(const struct run *run, size_t first, double *drift_m, double *along_m, double *cross_m)
{
	const struct fix_row *rows = run->fix_rows.items, *start = &rows[first], *aim = NULL, *end = NULL;
	for (size_t i = first; i < run->fix_rows.count && !end; i++) {
		double m = rows[i].travelled_m - start->travelled_m;
		aim = !aim && m >= ALIGN_M ? &rows[i] : aim;
		end = m >= STRETCH_M ? &rows[i] : NULL;
	}
	if (!aim || !end)
		return false;
	struct dvec2 a = dvec2_sub(aim->said, start->said), b = dvec2_sub(aim->reckoned, start->reckoned);
	double turn = atan2(dvec2_cross(b, a), dvec2_dot(b, a));
	struct dvec2 d = dvec2_sub(end->reckoned, start->reckoned), said = dvec2_sub(end->said, start->said);
	struct dvec2 laid = { d.x * cos(turn) - d.y * sin(turn), d.x * sin(turn) + d.y * cos(turn) };
	struct dvec2 error = dvec2_sub(laid, said);
	double l = fmax(dvec2_length(said), 1.0);
	*drift_m = dvec2_length(error);
	*along_m = fabs(dvec2_dot(error, said)) / l;
	*cross_m = fabs(dvec2_cross(said, error)) / l;
	return true;
}

static void summarise_drift(struct run *run)
{
	values drift = { 0 }, along = { 0 }, cross = { 0 };
	double next = 0.0;
	for (size_t i = 0; i < run->fix_rows.count; i++) {
		double d, a, c;
		if (run->fix_rows.items[i].travelled_m < next)
			continue;
		next = run->fix_rows.items[i].travelled_m + 0.25 * STRETCH_M;
		if (!stretch_drift(run, i, &d, &a, &c))
			break;
		ARRAY_PUSH(&drift, d);
		ARRAY_PUSH(&along, a);
		ARRAY_PUSH(&cross, c);
	}
	run->out->stretches = (uint32_t)drift.count;
	run->out->drift_p50_m_per_km = percentile(&drift, 0.5);
	run->out->drift_p95_m_per_km = percentile(&drift, 0.95);
	run->out->drift_max_m_per_km = percentile(&drift, 1.0);
	run->out->along_p50_m_per_km = percentile(&along, 0.5);
	run->out->cross_p50_m_per_km = percentile(&cross, 0.5);
	ARRAY_FINISH(&drift);
	ARRAY_FINISH(&along);
	ARRAY_FINISH(&cross);
}

static void summarise(struct run *run, const struct can_bus *bus)
{
	struct track_result *out = run->out;
	out->seconds = (double)bus->last_ns * 1e-9;
	out->km = run->alone.travelled_m * 1e-3;
	out->pos_p50_m = percentile(&run->pos, 0.5);
	out->pos_p95_m = percentile(&run->pos, 0.95);
	out->pos_max_m = percentile(&run->pos, 1.0);
	out->heading_p95_deg = percentile(&run->heading, 0.95);
	out->along_p95_m = percentile(&run->along, 0.95);
	const struct reckon *reckon = run->options->pkg ? &run->nav.reckon : &run->alone;
	out->yaw_bias_deg_s = reckon->yaw_bias_rps * DEG;
	out->speed_scale = reckon->speed_scale;
	out->frames = run->vehicle.frames_in;
	out->frames_bad = run->vehicle.frames_bad;
	summarise_drift(run);
}

static int read_log(struct run *run, struct can_bus *bus)
{
	double step_s = run->options->step_s > 0.0 ? run->options->step_s : 0.02;
	int64_t step_ns = (int64_t)(step_s * 1e9);
	for (int64_t now = 0; !bus->ended; now += step_ns) {
		int count;
		while ((count = can_bus_read(bus, now, run->frames, FRAMES_MAX)) > 0)
			for (int i = 0; i < count; i++)
				feed(run, &run->frames[i]);
		if (count < 0)
			return count;
		advance(run, now, step_s);
	}
	return 0;
}

static int prepare_nav(struct run *run, const struct car *car, struct arena *arena)
{
	if (car->dbc_count)
		destination_init(&run->destination, &car->dbc[0]);
	struct nav_config config = { .seed = 1, .ignore_gnss = !run->options->use_gnss };
	return run->options->pkg ? nav_init(&run->nav, arena, run->options->pkg, &config) : 0;
}

int track_log(const struct car *car, const struct track_options *options, struct track_result *out)
{
	*out = (struct track_result){ 0 };
	size_t bytes = ((size_t)8 << 20) + (options->pkg ? nav_bytes(&options->pkg->graph, &(struct nav_config){ 0 }) : 0);
	uint8_t *memory = malloc(bytes);
	struct run *run = calloc(1, sizeof(*run));
	if (!memory || !run)
		abort();
	struct arena arena;
	arena_init(&arena, "track", memory, bytes);
	run->options = options;
	run->out = out;
	vehicle_init(&run->vehicle, &car->vehicle);
	reckon_init(&run->alone, &(struct reckon_config){ 0 });
	if (options->pkg) {
		run->frame = options->pkg->frame;
		run->has_frame = true;
	}
	struct can_bus *bus = NULL;
	int err = prepare_nav(run, car, &arena);
	if (!err)
		err = can_bus_open(&bus, &can_replay_ops,
			&(struct can_bus_config){
				.path = options->log, .interfaces = car->interfaces, .interface_count = car->interface_count },
			&arena);
	if (!err)
		err = read_log(run, bus);
	if (err)
		log_error("%s: %s", options->log, err == -ENODATA ? "no CAN frame in it" : strerror(-err));
	else
		summarise(run, bus);
	can_bus_close(bus);
	ARRAY_FINISH(&run->pos);
	ARRAY_FINISH(&run->heading);
	ARRAY_FINISH(&run->along);
	ARRAY_FINISH(&run->fix_rows);
	free(run);
	free(memory);
	return err;
}
