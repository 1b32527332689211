/*
 * The streets that a recorded drive may need: the log goes through the navigator, and from everywhere it says the car
 * is, whatever can be reached within SELECT_AHEAD_M is marked. From one street only the first time.
 */
#include "board/car.h"
#include "platform/base/log.h"
#include "tools/drive/track.h"
#include "tools/far/plan.h"

struct marking {
	const struct graph *graph;
	uint8_t *edges;
	float *room_m; /* by half-edge: most that was left when it was entered; negative: never was */
	uint32_t last;
};

static void mark_ahead(struct marking *marking, uint32_t half, double room_m)
{
	if (room_m <= marking->room_m[half])
		return;
	marking->room_m[half] = (float)room_m;
	marking->edges[half / 2] = 1;
	room_m -= graph_length_m(marking->graph, half);
	if (room_m <= 0.0)
		return;
	uint32_t next[GRAPH_SUCCESSORS_MAX], count = graph_successors(marking->graph, half, GRAPH_PHYSICAL, next);
	for (uint32_t i = 0; i < count; i++)
		mark_ahead(marking, next[i], room_m);
}

static void note_view(void *context, const struct nav_view *view)
{
	struct marking *marking = context;
	if (!view->located || view->half == PKG_NONE || view->half == marking->last)
		return;
	marking->last = view->half;
	/* All of the street counts: the horizon is that of its far end. */
	mark_ahead(marking, view->half, SELECT_AHEAD_M + graph_length_m(marking->graph, view->half));
	marking->edges[view->half / 2] = 1;
}

static int follow(
	const struct pkg *pkg, const char *log, struct marking *marking, struct pool *pool, struct arena *arena)
{
	struct profile *profile = pool_alloc(pool, sizeof(*profile));
	struct car *car = pool_alloc(pool, sizeof(*car));
	struct track_options options = { .log = log, .pkg = pkg, .on_view = note_view, .context = marking };
	struct track_result result;
	int err = profile_load(profile, NULL, arena);
	if (!err)
		err = car_init(car, profile, NULL, 0, NULL, 0, arena);
	return err ? err : track_log(car, &options, &result);
}

int far_select_drive(const struct pkg *pkg, const char *log, uint8_t *edges)
{
	size_t graph_room = 64 + 16 * (size_t)pkg->graph.half_count + 4 * (size_t)pkg->graph.point_count;
	size_t bytes = ((size_t)64 << 20) + 8 * graph_room;
	struct pool pool = { 0 };
	struct arena arena;
	struct graph graph;
	arena_init(&arena, "drive", pool_alloc(&pool, bytes), bytes);
	int err = graph_init(&graph, &arena, &pkg->graph, pkg->meta->right_hand_traffic);
	struct marking marking = {
		.graph = &graph, .edges = edges, .room_m = POOL_ARRAY(&pool, float, pkg->graph.half_count + 1), .last = PKG_NONE
	};
	for (uint32_t i = 0; i < pkg->graph.half_count; i++)
		marking.room_m[i] = -1.0f;
	if (!err)
		err = follow(pkg, log, &marking, &pool, &arena);
	pool_finish(&pool);
	return err;
}
