/* When the car is where: speed by limits, curves, signals and stops along the line, then time. Linear in the line. */
#include <math.h>
#include <stdlib.h>

#include "platform/base/rng.h"
#include "tools/drive/drive.h"

#define LATERAL_MPS2 2.0
#define YAW_RPS 0.75 /* nobody whirls, however tight the corner */
#define BRAKE_MPS2 1.7
#define START_S 3.0 /* standing at both ends */
#define END_S 4.0
#define STOP_BEFORE_M 6.0
#define LAMP_AHEAD_M 45.0
#define LAMP_AFTER_M 5.0

static double acceleration(double speed)
{
	return fmax(1.9 - 0.055 * speed, 0.5);
}

/* --- limits --- */

static void limit_by_street(const struct drive *drive, const struct drive_path *path, double *limit)
{
	for (size_t i = 0; i < path->points.count; i++) {
		const struct drive_point *point = &path->points.items[i];
		const struct pkg_edge *edge = graph_edge(&drive->graph, drive->route.halves[point->index]);
		double kmh = edge->speed_kmh ? edge->speed_kmh : 30.0;
		/* The same street is always driven alike: 86 to 98 % of the limit. */
		uint64_t key =
			hash_u64(drive->options->seed * 977 + (edge->name ? edge->name : drive->route.halves[point->index]));
		limit[i] = kmh / 3.6 * (0.86 + 0.12 * (double)(key >> 40) / 16777216.0);
		double curve = fabs(point->curvature);
		if (curve > 1e-4)
			limit[i] = fmin(limit[i], fmax(fmin(sqrt(LATERAL_MPS2 / curve), YAW_RPS / curve), 0.7));
	}
}

/* First point on the half-edge at a route index, or the last one before it. */
static size_t point_at_index(const struct drive_path *path, uint32_t index)
{
	size_t low = 0, high = path->points.count;
	while (low < high) {
		size_t mid = (low + high) / 2;
		if (path->points.items[mid].index < index)
			low = mid + 1;
		else
			high = mid;
	}
	return low < path->points.count ? low : path->points.count - 1;
}

static size_t before(size_t point, size_t floor, double by_m)
{
	size_t steps = (size_t)(by_m / DRIVE_STEP_M);
	return point > floor + steps ? point - steps : floor;
}

static void stand(struct drive_motion *motion, double *limit, size_t point, double seconds)
{
	limit[point] = 0.0;
	motion->dwell.items[point] = fmax(motion->dwell.items[point], seconds);
}

/* A sign at a junction means the smaller street. */
static bool has_to_yield(const struct drive *drive, uint32_t half)
{
	const struct pkg_node *node = &drive->graph.net->nodes[graph_end(&drive->graph, half)];
	uint8_t own = graph_edge(&drive->graph, half)->street_class;
	for (uint32_t i = 0; i < node->out_count; i++)
		if (graph_edge(&drive->graph, drive->graph.net->outs[node->first_out + i])->street_class < own)
			return true;
	return node->out_count <= 2;
}

static void limit_at_node(
	const struct drive *drive, struct drive_motion *motion, double *limit, uint32_t index, size_t *last_stop)
{
	uint32_t half = drive->route.halves[index - 1], next = drive->route.halves[index];
	uint32_t flags = drive->graph.net->nodes[graph_end(&drive->graph, half)].flags;
	size_t node = point_at_index(motion->path, index), floor = point_at_index(motion->path, index - 1);
	size_t line = before(node, floor, STOP_BEFORE_M);
	uint64_t luck = hash_u64(drive->options->seed ^ ((uint64_t)index << 32 | half));
	bool enters_roundabout = (graph_edge(&drive->graph, next)->flags & PKG_EDGE_ROUNDABOUT) &&
							 !(graph_edge(&drive->graph, half)->flags & PKG_EDGE_ROUNDABOUT);
	if (line < *last_stop + (size_t)(45.0 / DRIVE_STEP_M) && *last_stop)
		return; /* one crossing, many signals */
	if (flags & PKG_NODE_SIGNALS) {
		*last_stop = line + 1;
		if (luck % 100 < 38)
			stand(motion, limit, line, 4.0 + (double)(luck >> 8 & 1023) / 1024.0 * 18.0);
		return;
	}
	if (flags & PKG_NODE_STOP && has_to_yield(drive, half)) {
		*last_stop = line + 1;
		stand(motion, limit, line, 1.2 + (double)(luck >> 8 & 1023) / 1024.0 * 2.0);
	} else if (enters_roundabout || (flags & PKG_NODE_GIVE_WAY && has_to_yield(drive, half))) {
		limit[line] = fmin(limit[line], 4.5);
	}
}

/* --- speed and time --- */

static double step_m(const struct drive_path *path, size_t i)
{
	const struct dvec3 *a = &path->points.items[i - 1].at, *b = &path->points.items[i].at;
	return hypot(b->x - a->x, b->y - a->y);
}

static void plan_speed(struct drive_motion *motion, const double *limit)
{
	size_t n = motion->path->points.count;
	double *speed = motion->speed.items;
	for (size_t i = 0; i < n; i++)
		speed[i] = limit[i];
	for (size_t i = 1; i < n; i++) {
		double a = acceleration(speed[i - 1]);
		speed[i] = fmin(speed[i], sqrt(speed[i - 1] * speed[i - 1] + 2.0 * a * step_m(motion->path, i)));
	}
	for (size_t i = n - 1; i-- > 0;)
		speed[i] = fmin(speed[i], sqrt(speed[i + 1] * speed[i + 1] + 2.0 * BRAKE_MPS2 * step_m(motion->path, i + 1)));
}

static void plan_time(struct drive_motion *motion)
{
	double now = 0.0;
	for (size_t i = 0; i < motion->path->points.count; i++) {
		if (i) {
			double mean = 0.5 * (motion->speed.items[i - 1] + motion->speed.items[i]);
			now += mean > 1e-9 ? step_m(motion->path, i) / mean : 0.0;
		}
		motion->time.items[i] = now;
		now += motion->dwell.items[i];
	}
	motion->end_s = now;
}

/* --- lamps --- */

static int lamp_of(const struct guidance_step *step)
{
	switch (step->manoeuvre) {
	case NAV_MANOEUVRE_SLIGHT_LEFT:
	case NAV_MANOEUVRE_LEFT:
	case NAV_MANOEUVRE_SHARP_LEFT:
	case NAV_MANOEUVRE_KEEP_LEFT:
		return -1;
	case NAV_MANOEUVRE_SLIGHT_RIGHT:
	case NAV_MANOEUVRE_RIGHT:
	case NAV_MANOEUVRE_SHARP_RIGHT:
	case NAV_MANOEUVRE_KEEP_RIGHT:
		return 1;
	default:
		return 0;
	}
}

static void plan_lamps(const struct drive *drive, struct drive_motion *motion)
{
	for (uint32_t s = 0; s < drive->guidance.step_count; s++) {
		const struct guidance_step *step = &drive->guidance.steps[s];
		int lamp = lamp_of(step);
		double ahead = LAMP_AHEAD_M;
		uint32_t at = step->index;
		if (step->manoeuvre == NAV_MANOEUVRE_ROUNDABOUT) {
			lamp = drive->graph.right_hand ? 1 : -1;
			ahead = 15.0;
			at = step->last;
		} else if (step->manoeuvre == NAV_MANOEUVRE_U_TURN) {
			lamp = drive->graph.right_hand ? -1 : 1;
		}
		if (!lamp)
			continue;
		size_t node = point_at_index(motion->path, at), first = before(node, 0, ahead);
		size_t last = point_at_index(motion->path, step->last) + (size_t)(LAMP_AFTER_M / DRIVE_STEP_M);
		for (size_t i = first; i <= last && i < motion->lamp.count; i++)
			motion->lamp.items[i] = lamp;
	}
}

void motion_build(const struct drive *drive, const struct drive_path *path, struct drive_motion *out)
{
	size_t n = path->points.count, last_stop = 0;
	*out = (struct drive_motion){ .drive = drive, .path = path };
	double *limit = calloc(n, sizeof(*limit));
	if (!limit)
		abort();
	for (size_t i = 0; i < n; i++) {
		ARRAY_PUSH(&out->speed, 0.0);
		ARRAY_PUSH(&out->time, 0.0);
		ARRAY_PUSH(&out->dwell, 0.0);
		ARRAY_PUSH(&out->lamp, 0);
	}
	limit_by_street(drive, path, limit);
	for (uint32_t i = 1; i < drive->route.count; i++)
		limit_at_node(drive, out, limit, i, &last_stop);
	stand(out, limit, 0, START_S);
	stand(out, limit, n - 1, END_S);
	plan_speed(out, limit);
	plan_time(out);
	plan_lamps(drive, out);
	free(limit);
}

void motion_finish(struct drive_motion *motion)
{
	ARRAY_FINISH(&motion->speed);
	ARRAY_FINISH(&motion->time);
	ARRAY_FINISH(&motion->dwell);
	ARRAY_FINISH(&motion->lamp);
}

/* Point i has been left, point i + 1 not reached; between them the acceleration is constant. */
static void between_points(const struct drive_motion *motion, size_t i, double since_s, struct drive_state *out)
{
	const struct drive_point *a = &motion->path->points.items[i], *b = a + 1;
	double l = step_m(motion->path, i + 1), v0 = motion->speed.items[i], v1 = motion->speed.items[i + 1];
	double accel = l > 0.0 ? (v1 * v1 - v0 * v0) / (2.0 * l) : 0.0;
	double done = fmin(v0 * since_s + 0.5 * accel * since_s * since_s, l), t = l > 0.0 ? done / l : 0.0;
	out->at = (struct dvec3){ a->at.x + t * (b->at.x - a->at.x), a->at.y + t * (b->at.y - a->at.y),
		a->at.z + t * (b->at.z - a->at.z) };
	out->heading_rad = a->heading_rad + t * (b->heading_rad - a->heading_rad);
	out->curvature = a->curvature + t * (b->curvature - a->curvature);
	out->speed_mps = fmax(v0 + accel * since_s, 0.0);
	out->accel_mps2 = accel;
	out->odometer_m = (double)i * DRIVE_STEP_M + done;
	const struct drive_point *near = t < 0.5 ? a : b;
	out->half = motion->drive->route.halves[near->index];
	out->along_m = near->along_m;
	if (a->index == b->index)
		out->along_m = a->along_m + t * (b->along_m - a->along_m);
}

struct drive_state motion_at(struct drive_motion *motion, double time_s)
{
	struct drive_state out = { .time_s = time_s };
	size_t last = motion->path->points.count - 1;
	while (motion->cursor < last && time_s >= motion->time.items[motion->cursor + 1])
		motion->cursor++;
	size_t i = motion->cursor;
	double since = time_s - motion->time.items[i] - motion->dwell.items[i];
	const struct drive_point *point = &motion->path->points.items[i];
	if (since <= 0.0 || i == last) {
		out.at = point->at;
		out.heading_rad = point->heading_rad;
		out.curvature = point->curvature;
		out.odometer_m = (double)i * DRIVE_STEP_M;
		out.half = motion->drive->route.halves[point->index];
		out.along_m = point->along_m;
	} else {
		between_points(motion, i, since, &out);
	}
	out.yaw_rate_rps = out.speed_mps * out.curvature;
	out.lamp = motion->lamp.items[i];
	out.parked = time_s < 1.0 || (i == last && since > 1.5 - END_S);
	out.driving = i > 0 && i < last;
	return out;
}
