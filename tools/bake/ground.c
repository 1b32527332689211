/* Everything on the ground, in a fixed order whatever the threads: tiles, then structures, paint, furniture. */
#include "tools/bake/ground.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#define THREADS 2

struct tile_job {
	struct mesh_sink *sink;
	struct tile_faults faults;
};

struct tile_work {
	const struct ground_plan *plan;
	int32_t col0, row0, cols;
	size_t count;
	struct tile_job *jobs;
	atomic_size_t next;
};

/* GEOS tells why an operation failed; the bake counts it instead. */
static void ignore_message(const char *message, void *context)
{
	(void)message;
	(void)context;
}

static GEOSContextHandle_t open_geos(void)
{
	GEOSContextHandle_t geos = GEOS_init_r();
	GEOSContext_setNoticeMessageHandler_r(geos, ignore_message, NULL);
	GEOSContext_setErrorMessageHandler_r(geos, ignore_message, NULL);
	return geos;
}

static void *build_tiles(void *context)
{
	struct tile_work *work = context;
	GEOSContextHandle_t geos = open_geos();
	for (size_t i; (i = atomic_fetch_add(&work->next, 1)) < work->count;) {
		struct tile_job *job = &work->jobs[i];
		job->sink = mesh_sink_new();
		ground_tile_build(work->plan, geos, work->col0 + (int32_t)(i % (size_t)work->cols),
			work->row0 + (int32_t)(i / (size_t)work->cols), job->sink, &job->faults);
	}
	GEOS_finish_r(geos);
	return NULL;
}

static void count_faults(struct report *report, const struct tile_faults *faults)
{
	for (uint64_t i = 0; i < faults->mended; i++)
		report_fault(report, FAULT_BAD_GEOMETRY, FAULT_MENDED, 0);
	for (uint64_t i = 0; i < faults->dropped; i++)
		report_fault(report, FAULT_BAD_GEOMETRY, FAULT_DROPPED, 0);
}

static void build_all_tiles(const struct ground_plan *plan, struct mesh_sink *sink)
{
	struct tile_work work = { .plan = plan };
	work.col0 = (int32_t)floor(plan->min.x / MESH_TILE_M + 0.5);
	work.row0 = (int32_t)floor(plan->min.y / MESH_TILE_M + 0.5);
	work.cols = (int32_t)floor(plan->max.x / MESH_TILE_M + 0.5) - work.col0;
	int32_t rows = (int32_t)floor(plan->max.y / MESH_TILE_M + 0.5) - work.row0;
	work.count = (size_t)work.cols * (size_t)rows;
	work.jobs = array_grow(NULL, &(size_t){ 0 }, work.count, sizeof(*work.jobs));
	for (size_t i = 0; i < work.count; i++)
		work.jobs[i] = (struct tile_job){ 0 };
	pthread_t threads[THREADS - 1];
	int started = 0;
	while (started < THREADS - 1 && pthread_create(&threads[started], NULL, build_tiles, &work) == 0)
		started++;
	build_tiles(&work);
	for (int i = 0; i < started; i++)
		pthread_join(threads[i], NULL);
	for (size_t i = 0; i < work.count; i++) {
		mesh_append(sink, work.jobs[i].sink);
		mesh_sink_free(work.jobs[i].sink);
		count_faults(plan->city->report, &work.jobs[i].faults);
	}
	array_free(work.jobs);
}

void ground_build(const struct city *city, const struct pkg_graph *graph, struct mesh_sink *sink, lamp_array *lamps)
{
	struct ground_plan plan;
	ground_plan_build(&plan, city, graph);
	build_all_tiles(&plan, sink);
	struct soup soup = { 0 };
	struct tile_faults faults = { 0 };
	GEOSContextHandle_t geos = open_geos();
	ground_structures_build(&plan, geos, &soup, &faults);
	GEOS_finish_r(geos);
	count_faults(city->report, &faults);
	soup_flush(&soup, sink);
	ground_markings_build(&plan, &soup);
	ground_furniture_build(&plan, &soup, lamps);
	ground_lines_build(&plan, &soup);
	ground_apron_build(&plan, &soup);
	soup_flush(&soup, sink);
	soup_finish(&soup);
	ground_plan_finish(&plan);
}
