/* A car on a test's streets: drives a list of half-edges along their centre lines, rounding corners, and tells a
 * navigator its speed and yaw rate at a fixed rate. Header only. */
#ifndef BLVD_TESTS_NAV_RIDE_H
#define BLVD_TESTS_NAV_RIDE_H

#include "nav/nav.h"
#include "platform/base/clock.h"
#include "platform/base/rng.h"
#include "tests/nav/streets.h"

#define RIDE_ROUND_M 6.0
#define RIDE_STEP_NS (20 * NS_PER_MS)

struct ride {
	struct streets *streets;
	struct nav nav;
	uint8_t *memory;
	struct nav_input input;
	int64_t now_ns;
	struct rng rng;
	double speed_error, yaw_bias, yaw_noise;
	/* the way */
	uint32_t halves[512];
	uint32_t count;
	double at_m; /* along the way, from the first half-edge's origin */
	double heading;
	/* score */
	double driven_m, wrong_m, wrong_run_m;
	double run_m;
};

static inline void ride_start(struct ride *ride, struct streets *streets, bool right_hand)
{
	memset(ride, 0, sizeof(*ride));
	const struct pkg *pkg = streets_finish(streets, right_hand);
	ride->streets = streets;
	struct nav_config config = { .seed = 1 };
	size_t bytes = nav_bytes(&pkg->graph, &config);
	ride->memory = malloc(bytes);
	struct arena arena;
	arena_init(&arena, "ride", ride->memory, bytes);
	if (!ride->memory || nav_init(&ride->nav, &arena, pkg, &config))
		abort();
	ride->rng = rng_seed(99);
	ride->input.motion = (struct reckon_input){ .speed_valid = true, .yaw_valid = true, .yaw_biased = true };
}

static inline void ride_end(struct ride *ride)
{
	free(ride->memory);
	free(ride->streets);
}

static inline struct dvec2 ride_point(const struct ride *ride, double at_m)
{
	const struct graph *graph = &ride->nav.graph;
	uint32_t i = 0;
	for (; i + 1 < ride->count && at_m > graph_length_m(graph, ride->halves[i]); i++)
		at_m -= graph_length_m(graph, ride->halves[i]);
	struct dvec3 p = graph_at(graph, ride->halves[i], at_m).at_m;
	return (struct dvec2){ p.x, p.y };
}

static inline double ride_heading(const struct ride *ride)
{
	struct dvec2 a = ride_point(ride, ride->at_m - RIDE_ROUND_M), b = ride_point(ride, ride->at_m + RIDE_ROUND_M);
	return atan2(b.x - a.x, b.y - a.y);
}

static inline uint32_t ride_half(const struct ride *ride, double *along_m)
{
	double at = ride->at_m;
	uint32_t i = 0;
	for (; i + 1 < ride->count && at > graph_length_m(&ride->nav.graph, ride->halves[i]); i++)
		at -= graph_length_m(&ride->nav.graph, ride->halves[i]);
	*along_m = at;
	return ride->halves[i];
}

static inline void ride_tell(struct ride *ride, double speed, double yaw_rate)
{
	ride->now_ns += RIDE_STEP_NS;
	ride->input.motion.speed_mps = speed * (1.0 + ride->speed_error);
	ride->input.motion.yaw_rate_rps = yaw_rate + ride->yaw_bias + rng_range(&ride->rng, -1.0, 1.0) * ride->yaw_noise;
	nav_advance(&ride->nav, &ride->input, ride->now_ns);
}

static inline void ride_stand(struct ride *ride, double seconds)
{
	for (int64_t until = ride->now_ns + (int64_t)(seconds * 1e9); ride->now_ns < until;)
		ride_tell(ride, 0.0, 0.0);
}

/* Is the matched place the true one, give or take 12 m around a node? */
static inline bool ride_right(const struct ride *ride)
{
	double along;
	uint32_t half = ride_half(ride, &along), matched = ride->nav.match.half;
	if (matched == half)
		return true;
	double before = graph_length_m(&ride->nav.graph, matched) - ride->nav.match.along_m;
	double rest = graph_length_m(&ride->nav.graph, half) - along;
	if (graph_end(&ride->nav.graph, matched) == graph_origin(&ride->nav.graph, half))
		return before + along < 12.0;
	return graph_end(&ride->nav.graph, half) == graph_origin(&ride->nav.graph, matched) &&
		   rest + ride->nav.match.along_m < 12.0;
}

/* Drives on at a speed; negative backs up. Slower in corners. */
static inline void ride_drive(struct ride *ride, double metres, double speed)
{
	double goal = ride->at_m + metres, before = ride_heading(ride);
	while (metres > 0.0 ? ride->at_m < goal : ride->at_m > goal) {
		double step = speed * 1e-9 * (double)RIDE_STEP_NS;
		ride->at_m += step;
		double heading = ride_heading(ride);
		ride_tell(ride, speed, remainder(heading - before, 2.0 * BLVD_PI) / (1e-9 * (double)RIDE_STEP_NS));
		before = heading;
		ride->driven_m += fabs(step);
		bool right = ride_right(ride);
		ride->wrong_m += right ? 0.0 : fabs(step);
		ride->run_m = right ? 0.0 : ride->run_m + fabs(step);
		ride->wrong_run_m = fmax(ride->wrong_run_m, ride->run_m);
	}
	ride->heading = before;
}

/* Moves freely, off the way. */
static inline void ride_free(struct ride *ride, double seconds, double speed, double yaw_rate)
{
	for (int64_t until = ride->now_ns + (int64_t)(seconds * 1e9); ride->now_ns < until;)
		ride_tell(ride, speed, yaw_rate);
}

/* A way of `count` half-edges at random, without turning back. */
static inline void ride_wander(struct ride *ride, uint32_t start, uint32_t count)
{
	ride->halves[0] = start;
	for (ride->count = 1; ride->count < count; ride->count++) {
		uint32_t out[GRAPH_SUCCESSORS_MAX];
		uint32_t n = graph_successors(&ride->nav.graph, ride->halves[ride->count - 1], GRAPH_LEGAL, out);
		if (!n)
			break;
		ride->halves[ride->count] = out[rng_u32(&ride->rng) % n];
	}
}

#endif
