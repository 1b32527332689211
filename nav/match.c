/* Particle filter on half-edges: propagate, weigh, resample, estimate. See match.h for the idea and the cost. */
#include "nav/match.h"

#include <errno.h>
#include <string.h>

#define PARTICLES 384
#define STEP_M 1.0
#define STEP_RAD 0.06
#define CHORD_M 5.0   /* the street's heading is that of a chord this far to both sides: a car rounds corners */
#define DECIDE_M 25.0 /* before the end of a half-edge the particle chooses how to go on */
#define CORNER_MIN_RAD 0.3
#define CORNER_MAX_RAD 2.0
#define CORNER_RADIUS_M 7.5
#define CORNER_REACH_M 15.0
#define CORNER_ROOM 0.5 /* of the shorter half-edge */
#define ROUTE_FAVOUR_M 40.0
#define ROUTE_FAVOUR 8.0 /* the planned way counts so much more while the belief is split */
#define HEADING_SIGMA 0.12
#define CORRELATION_M 5.0 /* residuals closer than this are not independent */
#define OFFSET_CORRELATION_M 10.0
#define OFFSET_WALK 1.9e-5 /* rad^2 / s: a quarter of a degree a second, squared */
#define MISFIT_MAX 16.0
#define LOST_MISFIT 8.0
#define GOOD_MISFIT 3.0
#define RETURN_RADIUS_M 12.0
#define RETURN_MISFIT 5.0
#define RETURN_AFTER_M 25.0
#define RETURN_TURN_RAD 0.6
#define RETRY_M 5.0
#define BLUR_MAX_M 1000.0
#define GNSS_REST_M 3.0 /* driven from one fix that counts to the next */
#define BLUR_PIECE_M 20.0
#define MODES_MAX 96
#define HOPS_MAX 24

static double wrap_rad(double rad)
{
	return remainder(rad, 2.0 * BLVD_PI);
}

/* Irwin-Hall: four uniforms are normal enough, and cost no logarithm. */
static double normal(struct rng *rng)
{
	double sum = rng_unit(rng) + rng_unit(rng) + rng_unit(rng) + rng_unit(rng);
	return (sum - 2.0) * 1.7320508;
}

int match_init(struct match *match, struct arena *arena, const struct graph *graph, const struct match_config *config)
{
	uint32_t count = config->particles ? config->particles : PARTICLES;
	*match = (struct match){ .graph = graph, .count = count, .half = PKG_NONE, .rng = rng_seed(config->seed + 1) };
	match->particles = ARENA_ARRAY(arena, struct match_particle, count);
	match->spare = ARENA_ARRAY(arena, struct match_particle, count);
	return match->particles && match->spare ? 0 : -ENOMEM;
}

/* --- placing --- */

static struct match_particle new_particle(struct match *match, uint32_t half, double along_m, int32_t heading_bam)
{
	double length = graph_length_m(match->graph, half);
	double along = fmin(fmax(along_m, 0.0), length);
	double street = graph_at(match->graph, half, along).heading_rad;
	return (struct match_particle){
		.prev = PKG_NONE,
		.half = half,
		.next = PKG_NONE,
		.along_m = along,
		.offset_rad = wrap_rad(street - bam_to_rad(heading_bam)),
		.offset_var = 0.1 * 0.1,
		.scale = 1.0 + 0.008 * normal(&match->rng),
	};
}

static void forget(struct match *match)
{
	match->pending_m = match->pending_rad = match->pending_s = match->pending_unknown_rad = 0.0;
	match->misfit = 0.0;
	match->misfit_m = 0.0;
	match->gnss_far = 0;
	match->spread = false;
}

static const struct match_hints no_hints;

static void estimate(struct match *match, const struct match_hints *hints);

void match_place(struct match *match, uint32_t half, double along_m, double spread_m, int32_t heading_bam)
{
	for (uint32_t i = 0; i < match->count; i++)
		match->particles[i] = new_particle(match, half, along_m + spread_m * normal(&match->rng), heading_bam);
	forget(match);
	match->located = match->on_street = true;
	match->half = half;
	estimate(match, &no_hints);
}

struct candidate {
	uint32_t half;
	double along_m, weight;
};

/* How far a place is from where a car on this half-edge would be: its lanes are as wide as they are. */
static double beside_lanes(const struct graph *graph, uint32_t half, double along_m, struct dvec2 at_m)
{
	struct graph_pose pose = graph_at(graph, half, along_m);
	double right = (at_m.x - pose.at_m.x) * cos(pose.heading_rad) - (at_m.y - pose.at_m.y) * sin(pose.heading_rad);
	double far = hypot(at_m.x - pose.at_m.x, at_m.y - pose.at_m.y);
	double ahead = sqrt(fmax(far * far - right * right, 0.0));
	double a = graph_lane_offset_m(graph, half, 0), b = graph_lane_offset_m(graph, half, graph_lanes(graph, half) - 1);
	double side = fmax(fmax(fmin(a, b) - right, right - fmax(a, b)), 0.0);
	return hypot(ahead, side);
}

/* Places are pointed at or measured under the open sky, and drives seldom begin on a motorway or its viaduct. */
static double start_prior(const struct pkg_edge *edge)
{
	double prior = edge->street_class == PKG_STREET_MOTORWAY ? 0.02
				   : edge->street_class == PKG_STREET_TRUNK  ? 0.1
															 : 1.0;
	if (edge->flags & PKG_EDGE_TUNNEL)
		prior *= 0.02;
	return edge->flags & PKG_EDGE_BRIDGE ? 0.4 * prior : prior;
}

static uint32_t candidates_near(const struct match *match, struct dvec2 at_m, double radius_m, double max_turn_rad,
	int32_t heading_bam, struct candidate out[64])
{
	struct graph_hit hits[32];
	uint32_t hit_count = graph_nearest(match->graph, at_m, radius_m, hits, 32), count = 0;
	for (uint32_t i = 0; i < hit_count; i++) {
		for (uint32_t side = 0; side < 2; side++) {
			uint32_t half = hits[i].edge * 2 + side;
			if (!graph_drivable(match->graph, half))
				continue;
			double length = graph_length_m(match->graph, half);
			double along = side ? length - hits[i].along_m : hits[i].along_m;
			double turn = wrap_rad(graph_at(match->graph, half, along).heading_rad - bam_to_rad(heading_bam));
			if (fabs(turn) > max_turn_rad)
				continue;
			double d = beside_lanes(match->graph, half, along, at_m) / (0.12 * radius_m + 1.0);
			double weight = exp(-0.5 * d * d) + 1e-9;
			if (max_turn_rad < BLVD_PI)
				weight *= exp(-0.5 * turn * turn / (0.2 * 0.2)) + 1e-6;
			out[count++] = (struct candidate){ half, along, weight * start_prior(graph_edge(match->graph, half)) };
		}
	}
	return count;
}

static void seed_candidates(struct match *match, const struct candidate *from, uint32_t count, double spread_m,
	bool heading_known, int32_t heading_bam)
{
	double total = 0.0;
	for (uint32_t i = 0; i < count; i++)
		total += from[i].weight;
	double sum = from[0].weight;
	uint32_t c = 0;
	for (uint32_t i = 0; i < match->count; i++) {
		double target = total * (i + 0.5) / match->count;
		while (sum < target && c + 1 < count)
			sum += from[++c].weight;
		struct match_particle *particle = &match->particles[i];
		*particle = new_particle(match, from[c].half, from[c].along_m + spread_m * normal(&match->rng), heading_bam);
		if (heading_known)
			particle->offset_rad *= 0.3;
	}
}

static bool place_by_heading(
	struct match *match, struct dvec2 at_m, double radius_m, double turn_rad, int32_t heading_bam)
{
	struct candidate candidates[64];
	uint32_t count = candidates_near(match, at_m, radius_m, turn_rad, heading_bam, candidates);
	if (!count)
		return false;
	seed_candidates(match, candidates, count, 2.0 + 0.1 * radius_m, true, heading_bam);
	forget(match);
	match->located = match->on_street = true;
	match->half = PKG_NONE;
	estimate(match, &no_hints);
	return true;
}

bool match_place_near(struct match *match, struct dvec2 at_m, double radius_m, bool heading_known, int32_t heading_bam)
{
	struct candidate candidates[64];
	if (heading_known && place_by_heading(match, at_m, radius_m, BLVD_PI / 3.0, heading_bam))
		return true;
	uint32_t count = candidates_near(match, at_m, radius_m, 4.0, heading_bam, candidates);
	if (!count)
		return false;
	seed_candidates(match, candidates, count, 2.0 + 0.1 * radius_m, false, heading_bam);
	forget(match);
	match->located = match->on_street = true;
	match->half = PKG_NONE;
	estimate(match, &no_hints);
	return true;
}

/* --- moving on --- */

static bool follows_route(const struct match_hints *hints, uint32_t half, uint32_t to)
{
	for (uint32_t i = 0; i + 1 < hints->route_count && i < 24; i++)
		if (hints->route[i] == half && hints->route[i + 1] == to)
			return true;
	return false;
}

/* How likely drivers go from one half-edge into another, up to a factor. */
static double prior(
	const struct match *match, const struct match_hints *hints, uint32_t half, uint32_t to, bool dead_end)
{
	const struct graph *graph = match->graph;
	const struct pkg_edge *from_edge = graph_edge(graph, half), *to_edge = graph_edge(graph, to);
	double turn = bam_to_rad(graph_turn_bam(graph, half, to)), weight = 1.0;
	if (to == graph_twin(half))
		return dead_end ? 1.0 : 0.004;
	if (!graph_drivable(graph, to))
		weight *= 0.01;
	else if (graph_turn_forbidden(graph, half, to))
		weight *= 0.03;
	if ((to_edge->flags & PKG_EDGE_PRIVATE) && !(from_edge->flags & PKG_EDGE_PRIVATE))
		weight *= 0.3;
	if (to_edge->street_class >= PKG_STREET_SERVICE && from_edge->street_class < PKG_STREET_SERVICE)
		weight *= 0.5;
	if (fabs(turn) < 0.5)
		weight *= 2.0;
	if (fabs(turn) > 0.4 && hints->lamp)
		weight *= (turn > 0.0) == (hints->lamp > 0) ? 3.0 : 0.4;
	if (follows_route(hints, half, to))
		weight *= 6.0;
	return weight;
}

static uint32_t choose_next(struct match *match, const struct match_hints *hints, uint32_t half)
{
	uint32_t out[GRAPH_SUCCESSORS_MAX];
	double weight[GRAPH_SUCCESSORS_MAX], total = 0.0;
	uint32_t count = graph_successors(match->graph, half, GRAPH_PHYSICAL, out);
	bool dead_end = true;
	for (uint32_t i = 0; i < count; i++)
		dead_end = dead_end && (out[i] == graph_twin(half) || !graph_drivable(match->graph, out[i]));
	for (uint32_t i = 0; i < count; i++) {
		weight[i] = prior(match, hints, half, out[i], dead_end);
		total += weight[i];
	}
	double pick = total * rng_unit(&match->rng);
	for (uint32_t i = 0; i < count; i++) {
		pick -= weight[i];
		if (pick < 0.0)
			return out[i];
	}
	return count ? out[count - 1] : graph_twin(half);
}

/* A car that turns to the side of its lane cuts the corner of the centre lines, one that turns across it goes farther;
 * both round it. Returns the centre line's length less the car's; half of it lies on each side of the node. */
static float corner_gap(const struct graph *graph, uint32_t from, uint32_t to)
{
	double turn = bam_to_rad(graph_turn_bam(graph, from, to)), size = fmin(fabs(turn), CORNER_MAX_RAD);
	if (size < CORNER_MIN_RAD || to == graph_twin(from))
		return 0.0f;
	bool across = graph->right_hand ? turn < 0.0 : turn > 0.0;
	double a = graph_lane_offset_m(graph, from, across ? graph_lanes(graph, from) - 1 : 0);
	double b = graph_lane_offset_m(graph, to, across ? graph_lanes(graph, to) - 1 : 0);
	double inside = 0.5 * (turn > 0.0 ? a + b : -a - b);
	double gap = 2.0 * inside * tan(0.5 * size) + CORNER_RADIUS_M * (2.0 * tan(0.5 * size) - size);
	double room = CORNER_ROOM * fmin(graph_length_m(graph, from), graph_length_m(graph, to));
	return (float)fmin(fmax(gap, -room), room);
}

static void decide_next(struct match *match, const struct match_hints *hints, struct match_particle *particle)
{
	particle->next = choose_next(match, hints, particle->half);
	particle->next_gap_m = corner_gap(match->graph, particle->half, particle->next);
}

/* Half-edge that the car came from, for reversing: the way back from the start, looked at from the twin. */
static void decide_prev(struct match *match, const struct match_hints *hints, struct match_particle *particle)
{
	struct match_hints none = { .lamp = -hints->lamp };
	particle->prev = graph_twin(choose_next(match, &none, graph_twin(particle->half)));
	particle->prev_gap_m = corner_gap(match->graph, particle->prev, particle->half);
}

static double end_of(const struct match *match, const struct match_particle *particle)
{
	return graph_length_m(match->graph, particle->half) - 0.5 * (double)particle->next_gap_m;
}

static void to_next(struct match *match, struct match_particle *particle)
{
	double beyond = particle->along_m - end_of(match, particle);
	particle->prev = particle->half;
	particle->prev_gap_m = particle->next_gap_m;
	particle->half = particle->next;
	particle->next = PKG_NONE;
	particle->next_gap_m = 0.0f;
	particle->along_m = beyond + 0.5 * (double)particle->prev_gap_m;
}

static void to_prev(struct match *match, struct match_particle *particle)
{
	double before = 0.5 * (double)particle->prev_gap_m - particle->along_m;
	particle->next = particle->half;
	particle->next_gap_m = particle->prev_gap_m;
	particle->half = particle->prev;
	particle->prev = PKG_NONE;
	particle->prev_gap_m = 0.0f;
	particle->along_m = end_of(match, particle) - before;
}

static void cross_nodes(
	struct match *match, const struct match_hints *hints, struct match_particle *particle, bool forwards)
{
	for (int hop = 0; hop < HOPS_MAX; hop++) {
		double length = graph_length_m(match->graph, particle->half);
		if (forwards) {
			if (particle->next == PKG_NONE && particle->along_m > length - DECIDE_M)
				decide_next(match, hints, particle);
			if (particle->next == PKG_NONE || particle->along_m <= end_of(match, particle))
				return;
			to_next(match, particle);
		} else {
			if (particle->prev == PKG_NONE && particle->along_m < 0.0)
				decide_prev(match, hints, particle);
			if (particle->prev == PKG_NONE || particle->along_m >= 0.5 * (double)particle->prev_gap_m)
				return;
			to_prev(match, particle);
		}
	}
	double length = graph_length_m(match->graph, particle->half);
	particle->along_m = fmin(fmax(particle->along_m, 0.0), length);
}

struct motion {
	double distance_m, turn_rad, unknown_rad, dt_s;
};

/* Is the particle so near a corner that the turn belongs to it, not to a bend of the street? */
static bool at_corner(const struct match *match, const struct match_particle *particle)
{
	return (fabsf(particle->prev_gap_m) > 0.0f && particle->along_m < CORNER_REACH_M) ||
		   (fabsf(particle->next_gap_m) > 0.0f &&
			   particle->along_m > graph_length_m(match->graph, particle->half) - CORNER_REACH_M);
}

static void propagate(
	struct match *match, const struct match_hints *hints, const struct motion *motion, struct match_particle *particle)
{
	particle->offset_var += OFFSET_WALK * motion->dt_s + motion->unknown_rad * motion->unknown_rad;
	if (motion->distance_m == 0.0)
		return;
	double noise2 = 0.006 * fabs(motion->distance_m) + 1.5 * fabs(motion->turn_rad), bend = 0.0;
	/* A driver on the inside of a bend travels less than the centre line. */
	if (motion->distance_m > 0.0 && !at_corner(match, particle))
		bend = fmin(fmax(graph_lane_offset_m(match->graph, particle->half, 0), -8.0), 8.0) * motion->turn_rad;
	particle->along_m += motion->distance_m * particle->scale + bend + sqrt(noise2) * normal(&match->rng);
	cross_nodes(match, hints, particle, motion->distance_m > 0.0);
}

static struct dvec3 path_point(const struct match *match, const struct match_particle *particle, double along_m)
{
	const struct graph *graph = match->graph;
	double start = 0.5 * (double)particle->prev_gap_m, end = end_of(match, particle);
	if (along_m < start && particle->prev != PKG_NONE)
		return graph_at(graph, particle->prev, graph_length_m(graph, particle->prev) - start + along_m - start).at_m;
	if (along_m > end && particle->next != PKG_NONE)
		return graph_at(graph, particle->next, 0.5 * (double)particle->next_gap_m + along_m - end).at_m;
	return graph_at(graph, particle->half, along_m).at_m;
}

/* Reckoned heading against the street's. The street's is the range between its directions a few metres before and after
 * the particle: in a corner any heading of the turn fits, for nobody knows how the driver rounds it. */
static double heading_residual(const struct match *match, const struct match_particle *particle, double heading)
{
	struct dvec3 a = path_point(match, particle, particle->along_m - CHORD_M);
	struct dvec3 m = path_point(match, particle, particle->along_m);
	struct dvec3 b = path_point(match, particle, particle->along_m + CHORD_M);
	double before = hypot(m.x - a.x, m.y - a.y), after = hypot(b.x - m.x, b.y - m.y);
	double street = graph_at(match->graph, particle->half, particle->along_m).heading_rad;
	double first = before > 1.0 ? atan2(m.x - a.x, m.y - a.y) : street;
	double last = after > 1.0 ? atan2(b.x - m.x, b.y - m.y) : street;
	double span = wrap_rad(last - first), from_first = wrap_rad(heading - first), from_last = wrap_rad(heading - last);
	if (from_first * span >= 0.0 && fabs(from_first) <= fabs(span))
		return 0.0;
	return fabs(from_first) < fabs(from_last) ? -from_first : -from_last;
}

static void turn_round(struct match *match, struct match_particle *particle)
{
	particle->along_m = graph_length_m(match->graph, particle->half) - particle->along_m;
	particle->half = graph_twin(particle->half);
	particle->prev = particle->next = PKG_NONE;
	particle->prev_gap_m = particle->next_gap_m = 0.0f;
	if (!graph_drivable(match->graph, particle->half))
		particle->log_weight -= 2.0;
}

static void weigh(struct match *match, struct match_particle *particle, double reckoned_rad, double moved_m)
{
	double residual = heading_residual(match, particle, reckoned_rad + particle->offset_rad);
	double var = HEADING_SIGMA * HEADING_SIGMA + particle->offset_var;
	particle->misfit = fmin(residual * residual / var, MISFIT_MAX);
	particle->log_weight -= 0.5 * particle->misfit * fmin(moved_m / CORRELATION_M, 1.0);
	if (residual != 0.0 && fabs(residual) < 0.7) {
		double measured = HEADING_SIGMA * HEADING_SIGMA * OFFSET_CORRELATION_M / fmax(moved_m, 0.1);
		double gain = particle->offset_var / (particle->offset_var + measured);
		particle->offset_rad = wrap_rad(particle->offset_rad + gain * residual);
		particle->offset_var *= 1.0 - gain;
	} else if (fabs(residual) > 2.1 && rng_unit(&match->rng) < 0.06 * moved_m) {
		turn_round(match, particle); /* the car faces the other way: it may have turned in the street */
	}
}

/* Largest weight becomes 1. Returns the effective number of particles. */
static double normalise(struct match *match)
{
	double most = -INFINITY, sum = 0.0, sum2 = 0.0;
	for (uint32_t i = 0; i < match->count; i++)
		most = fmax(most, match->particles[i].log_weight);
	for (uint32_t i = 0; i < match->count; i++) {
		struct match_particle *particle = &match->particles[i];
		particle->log_weight = fmax(particle->log_weight - most, -60.0);
		double w = exp(particle->log_weight);
		sum += w;
		sum2 += w * w;
	}
	return sum * sum / sum2;
}

/* Systematic resampling (Kitagawa 1996). */
static void resample(struct match *match)
{
	double total = 0.0, sum = 0.0;
	for (uint32_t i = 0; i < match->count; i++)
		total += exp(match->particles[i].log_weight);
	double step = total / match->count, target = step * rng_unit(&match->rng);
	uint32_t from = 0;
	sum = exp(match->particles[0].log_weight);
	for (uint32_t i = 0; i < match->count; i++, target += step) {
		while (sum < target && from + 1 < match->count)
			sum += exp(match->particles[++from].log_weight);
		match->spare[i] = match->particles[from];
		match->spare[i].log_weight = 0.0;
		match->spare[i].scale += 0.0004 * normal(&match->rng);
		match->spare[i].scale = fmin(fmax(match->spare[i].scale, 0.95), 1.05);
	}
	struct match_particle *swap = match->particles;
	match->particles = match->spare;
	match->spare = swap;
}

/* --- estimate --- */

struct mode {
	uint32_t half;
	double weight, along, along2, offset;
	double offset_ref; /* of the first particle: offsets are averaged as differences, so that 180 degrees is no edge */
};

static uint32_t collect_modes(const struct match *match, struct mode modes[MODES_MAX])
{
	uint32_t count = 0, last = 0;
	for (uint32_t i = 0; i < match->count; i++) {
		const struct match_particle *particle = &match->particles[i];
		uint32_t m = last;
		if (!count || modes[m].half != particle->half)
			for (m = 0; m < count && modes[m].half != particle->half;)
				m++;
		if (m == MODES_MAX)
			continue;
		if (m == count)
			modes[count++] = (struct mode){ .half = particle->half, .offset_ref = particle->offset_rad };
		last = m;
		double w = exp(particle->log_weight);
		modes[m].weight += w;
		modes[m].along += w * particle->along_m;
		modes[m].along2 += w * particle->along_m * particle->along_m;
		modes[m].offset += w * wrap_rad(particle->offset_rad - modes[m].offset_ref);
	}
	return count;
}

static bool touches(const struct graph *graph, uint32_t a, uint32_t b)
{
	return a == b || graph_end(graph, a) == graph_origin(graph, b) || graph_end(graph, b) == graph_origin(graph, a) ||
		   graph_end(graph, a) == graph_end(graph, b);
}

/* Is it on the next stretch of the planned route? Farther on a route may pass by here again. */
static bool on_route(const struct graph *graph, const struct match_hints *hints, uint32_t half)
{
	double ahead = 0.0;
	for (uint32_t i = 0; i < hints->route_count && i < 24 && ahead < ROUTE_FAVOUR_M; i++) {
		if (hints->route[i] == half)
			return true;
		ahead += i ? graph_length_m(graph, hints->route[i]) : 0.0;
	}
	return false;
}

static void estimate(struct match *match, const struct match_hints *hints)
{
	struct mode modes[MODES_MAX];
	uint32_t count = collect_modes(match, modes), best = 0;
	if (!count)
		return; /* no particles at all: a pool of 0 */
	double total = 0.0, best_weight = 0.0;
	for (uint32_t i = 0; i < count; i++) {
		double weight = modes[i].half == match->half ? 1.15 * modes[i].weight : modes[i].weight;
		if (on_route(match->graph, hints, modes[i].half))
			weight *= ROUTE_FAVOUR;
		total += modes[i].weight;
		if (weight > best_weight) {
			best_weight = weight;
			best = i;
		}
	}
	const struct mode *mode = &modes[best];
	if (match->half != PKG_NONE && !touches(match->graph, match->half, mode->half))
		match->jumps++;
	double mean = mode->along / mode->weight;
	match->half = mode->half;
	match->along_m = fmin(fmax(mean, 0.0), graph_length_m(match->graph, mode->half));
	match->offset_rad = wrap_rad(mode->offset_ref + mode->offset / mode->weight);
	match->confidence = mode->weight / total;
	double var = fmax(mode->along2 / mode->weight - mean * mean, 0.0);
	match->uncertainty_m = sqrt(var) / fmax(match->confidence, 0.1);
	match->misfit_m = fmin(match->misfit_m, 1e6);
}

static void follow_misfit(struct match *match, double moved_m)
{
	double sum = 0.0, total = 0.0;
	for (uint32_t i = 0; i < match->count; i++) {
		double w = exp(match->particles[i].log_weight);
		sum += w * match->particles[i].misfit;
		total += w;
	}
	match->misfit_m += moved_m;
	match->misfit += (sum / total - match->misfit) * (1.0 - exp(-moved_m / 20.0));
}

/* --- leaving the street and coming back --- */

/* Beside the streets: now and then a street near the reckoned place that runs the way the car is heading is tried;
 * when it fits for a while and the reckoned place has stayed beside it, the car is on it. */
static void try_return(
	struct match *match, const struct match_hints *hints, const struct reckon *reckon, double moved_m)
{
	struct dvec2 at = { (double)reckon->pos_mm[0] * 1e-3, (double)reckon->pos_mm[1] * 1e-3 };
	double radius = fmin(fmax(RETURN_RADIUS_M + 0.03 * match->off_street_m, 2.0 * hints->drift_m), 60.0);
	match->off_street_m += moved_m;
	if (match->trying && match->misfit < RETURN_MISFIT) {
		struct dvec3 street = graph_at(match->graph, match->half, match->along_m).at_m;
		if (hypot(street.x - at.x, street.y - at.y) > radius + 8.0)
			match->trying = false;
		else if (match->misfit_m > RETURN_AFTER_M && match->misfit < GOOD_MISFIT)
			match->on_street = true;
		return;
	}
	match->trying = false;
	match->retry_m += moved_m;
	if (match->retry_m < RETRY_M)
		return;
	match->retry_m = 0.0;
	uint32_t half = match->half;
	match->trying = place_by_heading(match, at, radius, RETURN_TURN_RAD, reckon->heading_bam);
	if (!match->trying)
		match->half = half;
	match->on_street = false;
}

static void leave_and_return(
	struct match *match, const struct match_hints *hints, const struct reckon *reckon, double moved_m)
{
	if (!match->on_street) {
		try_return(match, hints, reckon, moved_m);
		return;
	}
	if (match->misfit <= LOST_MISFIT || match->misfit_m < 15.0)
		return;
	match->on_street = match->trying = false;
	match->off_street_m = match->retry_m = 0.0;
}

static void step_particles(struct match *match, const struct reckon *reckon, const struct match_hints *hints)
{
	struct motion motion = { match->pending_m, match->pending_rad, match->pending_unknown_rad, match->pending_s };
	match->pending_m = match->pending_rad = match->pending_s = match->pending_unknown_rad = 0.0;
	double moved = fabs(motion.distance_m), reckoned = bam_to_rad(reckon->heading_bam);
	for (uint32_t i = 0; i < match->count; i++) {
		propagate(match, hints, &motion, &match->particles[i]);
		weigh(match, &match->particles[i], reckoned, moved);
	}
	double effective = normalise(match);
	follow_misfit(match, moved);
	if (effective < 0.5 * match->count)
		resample(match);
	estimate(match, hints);
	leave_and_return(match, hints, reckon, moved);
}

void match_update(struct match *match, const struct reckon *reckon, const struct reckon_step *step, bool turn_known,
	const struct match_hints *hints)
{
	if (!match->located || step->still || step->dt_s <= 0.0)
		return;
	/* A long step (a gap in the data) is taken in pieces so that no junction is stepped over. */
	uint32_t pieces = 1 + (uint32_t)fmin(fabs(step->distance_m) / (2.0 * STEP_M), 400.0);
	match->since_gnss_m += fabs(step->distance_m);
	for (uint32_t i = 0; i < pieces; i++) {
		match->pending_m += step->distance_m / pieces;
		match->pending_rad += step->turn_rad / pieces;
		match->pending_s += step->dt_s / pieces;
		if (step->gap || !turn_known)
			match->pending_unknown_rad += fmin(0.4 * step->dt_s, 1.0) / pieces;
		if (fabs(match->pending_m) >= STEP_M || (fabs(match->pending_rad) >= STEP_RAD && match->pending_m != 0.0))
			step_particles(match, reckon, hints);
	}
}

void match_gnss(struct match *match, const struct reckon *reckon, struct dvec2 at_m, double sigma_m)
{
	double sigma = fmax(sigma_m, 6.0), nearest = INFINITY;
	if (!match->located) {
		match_place_near(match, at_m, 40.0, false, reckon->heading_bam);
		return;
	}
	if (match->since_gnss_m < GNSS_REST_M)
		return;
	for (uint32_t i = 0; i < match->count; i++) {
		struct dvec3 at = graph_at(match->graph, match->particles[i].half, match->particles[i].along_m).at_m;
		nearest = fmin(nearest, hypot(at.x - at_m.x, at.y - at_m.y));
	}
	/* One wild fix is noise; a row of them far from every particle means that we are somewhere else. */
	match->gnss_far = nearest > 5.0 * sigma + 10.0 ? match->gnss_far + 1 : 0;
	match->since_gnss_m = 0.0;
	if (match->gnss_far >= 5) {
		match_place_near(match, at_m, 8.0 * sigma, true, reckon->heading_bam);
		return;
	}
	if (!match->on_street)
		return;
	if (match->gnss_far)
		return;
	for (uint32_t i = 0; i < match->count; i++) {
		struct match_particle *particle = &match->particles[i];
		struct dvec3 at = graph_at(match->graph, particle->half, particle->along_m).at_m;
		double d = hypot(at.x - at_m.x, at.y - at_m.y) / sigma;
		particle->log_weight -= 0.5 * (match->spread ? d * d : fmin(d * d, MISFIT_MAX) * 0.3);
	}
	match->spread = false;
	if (normalise(match) < 0.5 * match->count)
		resample(match);
	estimate(match, &no_hints);
}

bool match_place_off(struct match *match, struct dvec2 at_m, double radius_m, int32_t heading_bam)
{
	if (!match_place_near(match, at_m, radius_m, true, heading_bam))
		return false;
	match->on_street = match->trying = false;
	match->off_street_m = match->retry_m = 0.0;
	return true;
}

static double street_rad(const struct match *match, const struct match_particle *particle)
{
	double length = graph_length_m(match->graph, particle->half);
	return graph_at(match->graph, particle->half, fmin(fmax(particle->along_m, 0.0), length)).heading_rad;
}

void match_blur(struct match *match, double by_m, bool turns_seen)
{
	double most = fmin(by_m, BLUR_MAX_M);
	for (uint32_t i = 0; i < match->count && match->located; i++) {
		struct match_particle *particle = &match->particles[i];
		double before_rad = street_rad(match, particle);
		/* in pieces, so that no junction is stepped over */
		for (double left = most * rng_unit(&match->rng); left > 0.0; left -= BLUR_PIECE_M) {
			particle->along_m += fmin(left, BLUR_PIECE_M);
			cross_nodes(match, &no_hints, particle, true);
		}
		if (!turns_seen)
			particle->offset_rad = wrap_rad(particle->offset_rad + street_rad(match, particle) - before_rad);
	}
	/* the next fix tells more than the belief does, even standing */
	match->since_gnss_m = fmax(match->since_gnss_m, GNSS_REST_M);
	match->spread = match->spread || !turns_seen;
	if (match->located)
		estimate(match, &no_hints);
}

void match_heading_corrected(struct match *match, double rad)
{
	for (uint32_t i = 0; i < match->count; i++)
		match->particles[i].offset_rad = wrap_rad(match->particles[i].offset_rad - rad);
	match->offset_rad = wrap_rad(match->offset_rad - rad);
}
