#include "tools/far/workers.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/base/rng.h"
#include "tools/far/unit.h"

#define JOBS_MAX 256

/* Common memory of the workers. */
struct board {
	atomic_uint next, failed;
	atomic_ullong stretches, reused, bytes;
	struct worker_times {
		double visible_s;
		struct cell_times times;
	} times[JOBS_MAX];
	uint64_t hashes[]; /* of units */
};

/* Stretches of the old package by their hash. */
struct old_stretch {
	uint64_t hash;
	uint32_t stretch;
};

struct worker {
	const struct far_work *work;
	struct board *board;
	struct worker_times *times;
	struct visibility *visibility;
	uint64_t *object_hashes, package_hash;
	ARRAY(struct old_stretch) old;
	struct cell_baker *baker;
	struct visible_sets sets[UNIT_STRETCHES];
	struct baked_stretch baked[UNIT_STRETCHES];
	uint64_t hashes[UNIT_STRETCHES];
};

/* --- stretches that an old package has --- */

static int compare_old(const void *left, const void *right)
{
	const struct old_stretch *a = left, *b = right;
	return a->hash < b->hash ? -1 : a->hash > b->hash;
}

static void index_old(struct worker *worker)
{
	const struct pkg *old = worker->work->old;
	for (uint32_t i = 0; old && i < old->stretch_count; i++)
		ARRAY_PUSH(&worker->old, (struct old_stretch){ old->stretches[i].input_hash, i });
	ARRAY_SORT(&worker->old, compare_old);
}

static bool copy_blob(const struct pkg *old, struct pkg_blob *blob, byte_array *out)
{
	if (!blob->stored_bytes)
		return true;
	const uint8_t *from = old->blobs + blob->offset;
	if ((uint32_t)crc32(0, from, blob->stored_bytes) != blob->crc32)
		return false;
	size_t at = (out->count + PKG_BLOB_ALIGN - 1) / PKG_BLOB_ALIGN * PKG_BLOB_ALIGN;
	ARRAY_RESERVE(out, at + blob->stored_bytes);
	memset(out->items + out->count, 0, at - out->count);
	memcpy(out->items + at, from, blob->stored_bytes);
	blob->offset = at;
	out->count = at + blob->stored_bytes;
	return true;
}

/* Takes a stretch from the old package. False: it has none of this hash, or a damaged one. */
static bool take_old(struct worker *worker, uint64_t hash, struct baked_stretch *out)
{
	const struct pkg *old = worker->work->old;
	struct old_stretch key = { hash, 0 };
	const struct old_stretch *found =
		worker->old.count ? bsearch(&key, worker->old.items, worker->old.count, sizeof(key), compare_old) : NULL;
	if (!found)
		return false;
	out->bytes.count = 0;
	out->stretch = old->stretches[found->stretch];
	memcpy(out->cells, &old->cells[2 * (size_t)found->stretch], sizeof(out->cells));
	return copy_blob(old, &out->stretch.local, &out->bytes) && copy_blob(old, &out->stretch.pvs, &out->bytes) &&
		   copy_blob(old, &out->cells[0].impostor, &out->bytes) && copy_blob(old, &out->cells[0].truth, &out->bytes) &&
		   copy_blob(old, &out->cells[1].impostor, &out->bytes) && copy_blob(old, &out->cells[1].truth, &out->bytes);
}

/* --- one unit --- */

static uint64_t look_at_inputs(struct worker *worker, uint32_t first, uint32_t count)
{
	const struct far_work *work = worker->work;
	uint64_t unit = hash_u64(count);
	clock_t since = clock();
	for (uint32_t i = 0; i < count; i++) {
		const struct pkg_stretch *stretch = &work->plan->stretches.items[first + i];
		struct view_cell cell = view_cell_of(stretch);
		visible_set(worker->visibility, &cell, stretch->near_mm * 1e-3, work->cells->far_m, &worker->sets[i]);
		struct cell_options options = cell_options_at_level(work->cells, work->plan->levels.items[first + i]);
		worker->hashes[i] =
			cell_input_hash(stretch, &worker->sets[i], worker->object_hashes, worker->package_hash, &options);
		unit = hash_u64(unit ^ worker->hashes[i]);
	}
	worker->times->visible_s += (double)(clock() - since) / CLOCKS_PER_SEC;
	return unit;
}

static int bake_unit(struct worker *worker, uint32_t first, uint32_t count, uint64_t hash)
{
	const struct far_work *work = worker->work;
	for (uint32_t i = 0; i < count; i++) {
		const struct pkg_stretch *stretch = &work->plan->stretches.items[first + i];
		struct baked_stretch *out = &worker->baked[i];
		if (take_old(worker, worker->hashes[i], out)) {
			atomic_fetch_add(&worker->board->reused, 1);
		} else {
			if (!worker->baker)
				worker->baker = cell_baker_new(work->pkg);
			struct cell_options options = cell_options_at_level(work->cells, work->plan->levels.items[first + i]);
			int err = cell_baker_run(worker->baker, &options, stretch, &worker->sets[i], worker->hashes[i], out);
			if (err)
				return err;
			worker->times->times = *cell_baker_times(worker->baker);
		}
		atomic_fetch_add(&worker->board->stretches, 1);
	}
	return unit_write(work->folder, hash, worker->baked, count);
}

static int run_unit(struct worker *worker, uint32_t unit)
{
	const struct far_plan *plan = worker->work->plan;
	uint32_t first = plan->unit_first.items[unit], count = plan->unit_first.items[unit + 1] - first;
	uint64_t hash = look_at_inputs(worker, first, count);
	struct unit_file file;
	worker->board->hashes[unit] = hash;
	if (!unit_open(&file, worker->work->folder, hash)) {
		atomic_fetch_add(&worker->board->bytes, file.head->bytes);
		atomic_fetch_add(&worker->board->stretches, count);
		atomic_fetch_add(&worker->board->reused, count);
		unit_close(&file);
		return 0;
	}
	int err = bake_unit(worker, first, count, hash);
	for (uint32_t i = 0; i < count && !err; i++)
		atomic_fetch_add(&worker->board->bytes, worker->baked[i].bytes.count);
	return err;
}

/* --- processes --- */

static int work_on(struct worker *worker)
{
	uint32_t units = far_plan_units(worker->work->plan);
	for (uint32_t unit;
		 !atomic_load(&worker->board->failed) && (unit = atomic_fetch_add(&worker->board->next, 1)) < units;) {
		int err = worker->work->skip && worker->work->skip[unit] ? 0 : run_unit(worker, unit);
		if (err) {
			atomic_store(&worker->board->failed, 1);
			return err;
		}
	}
	return 0;
}

static void be_worker(struct worker *worker)
{
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	/* One process a core: the rasteriser's own threads would only be in each other's way. */
	setenv("LP_NUM_THREADS", "0", 0);
	int err = work_on(worker);
	cell_baker_free(worker->baker);
	_exit(err ? 1 : 0);
}

static uint64_t stretches_to_do(const struct far_work *work)
{
	const struct far_plan *plan = work->plan;
	uint64_t sum = 0;
	for (uint32_t unit = 0; unit < far_plan_units(plan); unit++)
		if (!work->skip || !work->skip[unit])
			sum += plan->unit_first.items[unit + 1] - plan->unit_first.items[unit];
	return sum;
}

static void show(const struct far_work *work, const struct board *board, int64_t started)
{
	uint64_t done = board->stretches, all = stretches_to_do(work);
	double spent = (double)(clock_now_ns() - started) * 1e-9;
	int left = done ? (int)(spent * (double)(all - done) / (double)done + 0.5) : 0;
	fprintf(stderr, "\r\033[Kfar field: %llu of %llu stretches, %.1f MiB", (unsigned long long)done,
		(unsigned long long)all, (double)board->bytes / 1048576.0);
	if (done)
		fprintf(stderr, ", %d:%02d:%02d left", left / 3600, left / 60 % 60, left % 60);
	fflush(stderr);
}

/* Waits for all workers; false when one did not end well. */
static bool wait_for(const struct far_work *work, struct board *board, const pid_t *pids, unsigned count)
{
	bool well = true;
	int64_t started = clock_now_ns();
	for (unsigned i = 0; i < count; i++) {
		int status;
		pid_t ended;
		while ((ended = waitpid(pids[i], &status, work->show_progress ? WNOHANG : 0)) == 0 ||
			   (ended < 0 && errno == EINTR)) {
			if (!work->show_progress)
				continue;
			show(work, board, started);
			nanosleep(&(struct timespec){ .tv_nsec = 200000000 }, NULL);
		}
		if (ended > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0)
			continue;
		if (ended > 0 && WIFSIGNALED(status))
			log_error("a worker was ended by signal %d", WTERMSIG(status));
		atomic_store(&board->failed, 1);
		well = false;
	}
	if (work->show_progress)
		fputs("\r\033[K", stderr);
	return well;
}

static void collect(const struct board *board, unsigned jobs, struct far_counts *counts)
{
	*counts = (struct far_counts){ .stretches = board->stretches, .reused = board->reused, .bytes = board->bytes };
	for (unsigned i = 0; i < jobs; i++) {
		const struct worker_times *from = &board->times[i];
		counts->visible_s += from->visible_s;
		counts->times.look += from->times.look;
		counts->times.capture += from->times.capture;
		counts->times.wanted += from->times.wanted;
		counts->times.build += from->times.build;
		counts->times.store += from->times.store;
	}
}

static int run_workers(struct worker *worker, unsigned jobs)
{
	pid_t pids[JOBS_MAX];
	unsigned started = 0;
	fflush(NULL);
	for (; started < jobs; started++) {
		worker->times = &worker->board->times[started];
		pids[started] = fork();
		if (pids[started] == 0)
			be_worker(worker);
		if (pids[started] < 0)
			break;
	}
	if (!started) {
		log_error("cannot start a worker: %s", strerror(errno));
		return -EAGAIN;
	}
	return wait_for(worker->work, worker->board, pids, started) ? 0 : -EIO;
}

int far_work_run(const struct far_work *work, uint64_t *unit_hashes, struct far_counts *counts)
{
	uint32_t units = far_plan_units(work->plan);
	unsigned jobs = work->jobs < JOBS_MAX ? work->jobs : JOBS_MAX;
	jobs = jobs > units ? units : jobs;
	size_t bytes = sizeof(struct board) + (units + 1) * sizeof(uint64_t);
	struct board *board = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (board == MAP_FAILED) {
		log_error("cannot start workers: %s", strerror(errno));
		return -ENOMEM;
	}
	struct worker *worker = array_grow(NULL, &(size_t){ 0 }, 1, sizeof(*worker));
	*worker = (struct worker){ .work = work, .board = board };
	memcpy(board->hashes, unit_hashes, units * sizeof(*unit_hashes));
	worker->visibility = visibility_new(work->pkg);
	worker->object_hashes = cell_object_hashes(work->pkg);
	worker->package_hash = cell_package_hash(work->pkg);
	index_old(worker);
	int err = jobs ? run_workers(worker, jobs) : 0;
	collect(board, jobs, counts);
	memcpy(unit_hashes, board->hashes, units * sizeof(*unit_hashes));
	visibility_free(worker->visibility);
	array_free(worker->object_hashes);
	ARRAY_FINISH(&worker->old);
	array_free(worker);
	munmap(board, bytes);
	return err;
}
