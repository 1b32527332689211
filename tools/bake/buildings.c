/*
 * All buildings, on a few threads: each takes a fixed share of them and fills a sink of its own; the sinks are joined
 * in order, so the result does not depend on the threads.
 */
#include "tools/bake/buildings.h"

#include <math.h>
#include <pthread.h>

#include "platform/base/rng.h"
#include "tools/bake/bake.h"

#define THREADS 2
#define SHARES 8

struct share {
	const struct plots *plots;
	uint32_t from, to;
	struct mesh_sink *sink;
	ARRAY(int64_t) mended; /* buildings whose roof or deck was drawn simpler */
};

struct crew {
	struct share shares[SHARES];
	pthread_mutex_t lock;
	int next;
};

static void fill_surfaces(const struct plots *plots, uint32_t index, struct massing *m, struct shell *shell)
{
	static const struct plot none = { .roof = ROOF_GABLED, .half_width = 4.0, .axis = { 1.0, 0.0 }, .fill = 1.0 };
	m->city = plots->city;
	m->building = &plots->city->buildings.items[index];
	m->plot = &none;
	m->index = index;
	m->hash = hash_u64((uint64_t)m->building->id + UINT64_C(0x9E3779B97F4A7C15));
	m->ground = m->building->ground_m;
	m->top = m->ground + m->building->height_m;
	m->base = m->ground - FOOT_M;
	m->has_ground_floor = false;
	m->door_wall = UINT32_MAX;
	facade_choose(m);
	shell->seed = (uint8_t)(m->hash >> 56);
	building_surfaces(m->building, &m->facade, shell);
}

void building_shell(const struct plots *plots, uint32_t index, struct massing *m, struct shell *shell)
{
	shell_clear(shell);
	const struct building *building = &plots->city->buildings.items[index];
	if (building->walls_3d && !building->has_parts) {
		fill_surfaces(plots, index, m, shell);
		return;
	}
	if (!plots->plots.items[index].building)
		return;
	massing_build(plots, index, m);
	facade_choose(m);
	shell->seed = (uint8_t)(m->hash >> 56);
	roof_build(m, shell);
	if (building->kind == BUILDING_ROOF) {
		facade_canopy(m, shell);
		return;
	}
	facade_build(m, shell);
	if (!m->has_ground_floor)
		facade_underside(m, shell);
}

static void emit(const struct building *building, const struct shell *shell, struct mesh_sink *sink)
{
	struct mesh_object object = { .kind = PKG_OBJECT_BUILDING,
		.flags = building->landmark ? PKG_OBJECT_LANDMARK : 0,
		.source_id = building->id,
		.face = building->face,
		.name = building->name };
	shell_emit(shell, &object, sink);
}

static void work(struct share *share)
{
	struct massing massing = { .triangulator = triangulator_new() };
	struct shell shell = { 0 };
	for (uint32_t i = share->from; i < share->to; i++) {
		size_t before = massing.roof_faults + massing.deck_faults;
		building_shell(share->plots, i, &massing, &shell);
		const struct building *building = &share->plots->city->buildings.items[i];
		if (massing.roof_faults + massing.deck_faults > before)
			ARRAY_PUSH(&share->mended, building->id);
		emit(building, &shell, share->sink);
	}
	shell_finish(&shell);
	triangulator_free(massing.triangulator);
	massing_finish(&massing);
}

static void *run(void *context)
{
	struct crew *crew = context;
	for (;;) {
		pthread_mutex_lock(&crew->lock);
		int mine = crew->next++;
		pthread_mutex_unlock(&crew->lock);
		if (mine >= SHARES)
			return NULL;
		work(&crew->shares[mine]);
	}
}

static void run_crew(struct crew *crew)
{
	pthread_t threads[THREADS];
	int started = 0;
	pthread_mutex_init(&crew->lock, NULL);
	while (started < THREADS - 1 && pthread_create(&threads[started], NULL, run, crew) == 0)
		started++;
	run(crew);
	for (int i = 0; i < started; i++)
		pthread_join(threads[i], NULL);
	pthread_mutex_destroy(&crew->lock);
}

void buildings_build(const struct city *city, const struct pkg_graph *graph, struct mesh_sink *sink)
{
	(void)graph; /* doors look at all ways, not only at those that cars drive */
	struct plots plots;
	plots_build(city, &plots);
	struct crew crew = { .next = 0 };
	size_t count = city->buildings.count;
	for (size_t i = 0; i < SHARES; i++)
		crew.shares[i] = (struct share){ .plots = &plots,
			.from = (uint32_t)(count * i / SHARES),
			.to = (uint32_t)(count * (i + 1) / SHARES),
			.sink = mesh_sink_new() };
	run_crew(&crew);
	for (int i = 0; i < SHARES; i++) {
		struct share *share = &crew.shares[i];
		mesh_append(sink, share->sink);
		mesh_sink_free(share->sink);
		for (size_t k = 0; k < share->mended.count; k++)
			report_fault(city->report, FAULT_BAD_GEOMETRY, FAULT_MENDED, share->mended.items[k]);
		ARRAY_FINISH(&share->mended);
	}
	plots_finish(&plots);
}
