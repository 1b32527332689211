/*
 * The bookkeeping of slots, all of it on the frame's thread: the loader's thread only ever sees the slots whose jobs it
 * has been given, from worker_give() to worker_take(). Per frame: a few walks over the slots.
 */
#include "assets/cell_cache.h"

#include <assert.h>
#include <errno.h>
#include <string.h>

#include "assets/cell_loader.h"
#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/base/worker.h"

#define SLOTS_DEFAULT 16
#define STAGING_DEFAULT 2
#define LATENCY_DEFAULT 2
#define URGENT_RANKS 2
#define NO_RANK UINT32_MAX
#define NO_STAGING UINT32_MAX

struct entry {
	struct cell_slot shown; /* what the caller sees */
	struct cell_keep keep;
	uint32_t rank; /* place among what is wanted; NO_RANK: not wanted */
	bool pinned;
	uint64_t used_at; /* update in which it was last wanted or pinned */
	uint32_t staging; /* buffer that it has, or NO_STAGING */
	uint64_t due;     /* LOADING: the update from which on it may be shown */
	/* the loader's, while LOADING */
	struct cell_slot loaded;
	int status;
	int64_t took_ns;
};

struct cell_cache {
	const struct pkg *pkg;
	struct cell_cache_config config;
	struct cell_limits limits;
	struct cell_loader loader;
	struct worker worker;
	struct entry *entries;
	uint8_t **staging;
	uint32_t *staging_free;
	uint32_t staging_free_count;
	uint8_t *verdict; /* by stretch: enum cell_state, if it never will be there; else CELL_EMPTY */
	uint64_t updates, last_due;
	uint32_t generation;
	struct cell_cache_stats stats;
};

static struct cell_cache_config with_defaults(const struct pkg *pkg, const struct cell_cache_config *config)
{
	struct cell_cache_config full = *config;
	full.slot_count = full.slot_count ? full.slot_count : SLOTS_DEFAULT;
	full.staging_count = full.staging_count ? full.staging_count : STAGING_DEFAULT;
	if (full.staging_count > WORKER_JOBS_MAX)
		full.staging_count = WORKER_JOBS_MAX;
	full.latency_updates = full.latency_updates ? full.latency_updates : LATENCY_DEFAULT;
	for (uint32_t i = 0; !config->staging_bytes && i < pkg->stretch_count; i++) {
		uint64_t bytes = cell_loader_staging_bytes(config, pkg, i);
		if (cell_loader_copies_pvs(config) && cell_loader_wants_pvs(config, pkg, i) && bytes > CELL_STAGING_MAX)
			continue;
		full.staging_bytes = bytes > full.staging_bytes ? bytes : full.staging_bytes;
	}
	return full;
}

static void raise(uint32_t *most, uint64_t value)
{
	*most = value > *most ? (uint32_t)(value < UINT32_MAX ? value : UINT32_MAX) : *most;
}

/* Every object in a set has at least one triangle, and a part for each of two passes at most. */
static uint64_t parts_of(const struct pkg_blob *blob, uint64_t triangles)
{
	uint64_t objects = blob->raw_bytes / sizeof(struct pkg_set_object);
	return 2 * objects < triangles ? 2 * objects : triangles;
}

void cell_cache_limits(const struct pkg *pkg, const struct cell_cache_config *given, struct cell_limits *out)
{
	const struct cell_cache_config full = with_defaults(pkg, given), *config = &full;
	*out = (struct cell_limits){ 0 };
	for (uint32_t i = 0; i < pkg->stretch_count; i++) {
		if (cell_loader_staging_bytes(config, pkg, i) > config->staging_bytes)
			continue;
		const struct pkg_stretch *stretch = &pkg->stretches[i];
		const struct pkg_cell *cells = &pkg->cells[2 * (uint64_t)i];
		raise(&out->local_indices, stretch->local_triangles * 3ull);
		raise(&out->local_parts, parts_of(&stretch->local, stretch->local_triangles));
		if (cell_loader_wants_pvs(config, pkg, i)) {
			raise(&out->pvs_indices, stretch->pvs_triangles * 3ull);
			raise(&out->pvs_parts, parts_of(&stretch->pvs, stretch->pvs_triangles));
			if (cell_loader_copies_pvs(config))
				raise(&out->pvs_vertices, stretch->pvs_triangles * 3ull);
		}
		if (config->without_impostors)
			continue;
		raise(&out->impostor_vertices, (uint64_t)cells[0].vertex_count + cells[1].vertex_count);
		raise(&out->impostor_indices, (uint64_t)cells[0].index_count + cells[1].index_count);
		raise(&out->impostor_pages, (uint64_t)cells[0].page_count + cells[1].page_count);
	}
}

static uint64_t keep_bytes(const struct cell_limits *limits)
{
	const uint64_t part = sizeof(struct cell_range) + sizeof(struct cell_part);
	return ((uint64_t)limits->local_parts + limits->pvs_parts) * part +
		   2 * PKG_IMPOSTOR_VIEWS_MAX * sizeof(struct pkg_impostor_view) + 64;
}

uint64_t cell_cache_bytes(const struct pkg *pkg, const struct cell_cache_config *config)
{
	struct cell_cache_config full = with_defaults(pkg, config);
	struct cell_limits limits;
	cell_cache_limits(pkg, &full, &limits);
	return sizeof(struct cell_cache) + full.slot_count * (sizeof(struct entry) + keep_bytes(&limits)) +
		   full.staging_count * (full.staging_bytes + 64 + sizeof(uint8_t *) + sizeof(uint32_t)) + pkg->stretch_count +
		   cell_loader_bytes(pkg, &full) + 1024;
}

static int make_keep(struct cell_keep *keep, struct arena *arena, const struct cell_limits *limits)
{
	*keep = (struct cell_keep){
		.local_ranges = ARENA_ARRAY(arena, struct cell_range, limits->local_parts),
		.pvs_ranges = ARENA_ARRAY(arena, struct cell_range, limits->pvs_parts),
		.local_parts = ARENA_ARRAY(arena, struct cell_part, limits->local_parts),
		.pvs_parts = ARENA_ARRAY(arena, struct cell_part, limits->pvs_parts),
	};
	for (int side = 0; side < 2; side++)
		keep->views[side] = ARENA_ARRAY(arena, struct pkg_impostor_view, PKG_IMPOSTOR_VIEWS_MAX);
	bool all = keep->local_ranges && keep->pvs_ranges && keep->local_parts && keep->pvs_parts && keep->views[0] &&
			   keep->views[1];
	return all ? 0 : -ENOMEM;
}

static void clear(struct entry *entry)
{
	entry->shown = (struct cell_slot){ .stretch = PKG_NONE, .generation = entry->shown.generation };
	entry->staging = NO_STAGING;
	entry->rank = NO_RANK;
	entry->pinned = false;
	entry->used_at = 0;
}

static int make_memory(struct cell_cache *cache, struct arena *arena)
{
	const struct cell_cache_config *config = &cache->config;
	cache->entries = ARENA_ARRAY(arena, struct entry, config->slot_count);
	cache->staging = ARENA_ARRAY(arena, uint8_t *, config->staging_count);
	cache->staging_free = ARENA_ARRAY(arena, uint32_t, config->staging_count);
	cache->verdict = ARENA_ARRAY(arena, uint8_t, cache->pkg->stretch_count + 1);
	if (!cache->entries || !cache->staging || !cache->staging_free || !cache->verdict)
		return -ENOMEM;
	for (uint32_t i = 0; i < config->slot_count; i++) {
		clear(&cache->entries[i]);
		if (make_keep(&cache->entries[i].keep, arena, &cache->limits) < 0)
			return -ENOMEM;
	}
	for (uint32_t i = 0; i < config->staging_count; i++) {
		cache->staging[i] = arena_alloc(arena, (size_t)config->staging_bytes + 1, 64);
		cache->staging_free[cache->staging_free_count++] = i;
		if (!cache->staging[i])
			return -ENOMEM;
	}
	return cell_loader_init(&cache->loader, arena, cache->pkg, config);
}

/* On the loader's thread. */
static void load(void *context, uint32_t slot)
{
	struct cell_cache *cache = context;
	struct entry *entry = &cache->entries[slot];
	int64_t began = clock_now_ns();
	entry->status = cell_loader_load(&cache->loader, entry->shown.stretch, &cache->limits, &entry->keep,
		cache->staging[entry->staging], cache->config.staging_bytes, &entry->loaded);
	entry->took_ns = clock_now_ns() - began;
}

int cell_cache_init(
	struct cell_cache **out, struct arena *arena, const struct pkg *pkg, const struct cell_cache_config *config)
{
	*out = NULL;
	if (!pkg->stretches)
		return -ENODATA;
	size_t before = arena->used;
	struct cell_cache *cache = ARENA_ARRAY(arena, struct cell_cache, 1);
	if (!cache)
		return -ENOMEM;
	cache->pkg = pkg;
	cache->config = with_defaults(pkg, config);
	cell_cache_limits(pkg, &cache->config, &cache->limits);
	int status = make_memory(cache, arena);
	if (status < 0)
		return status;
	cache->stats.bytes = arena->used - before;
	status = worker_init(&cache->worker, "cells", load, cache);
	if (status < 0) {
		log_error("cannot start the loader's thread: %s", strerror(-status));
		worker_finish(&cache->worker);
		return status;
	}
	*out = cache;
	return 0;
}

void cell_cache_finish(struct cell_cache *cache)
{
	if (cache)
		worker_finish(&cache->worker);
}

static struct entry *entry_of(struct cell_cache *cache, uint32_t stretch)
{
	for (uint32_t i = 0; i < cache->config.slot_count; i++)
		if (cache->entries[i].shown.stretch == stretch)
			return &cache->entries[i];
	return NULL;
}

static void give_staging_back(struct cell_cache *cache, struct entry *entry)
{
	if (entry->staging != NO_STAGING)
		cache->staging_free[cache->staging_free_count++] = entry->staging;
	entry->staging = NO_STAGING;
}

static void condemn(struct cell_cache *cache, struct entry *entry)
{
	uint32_t id = entry->shown.stretch;
	bool large = entry->status == -E2BIG;
	cache->verdict[id] = large ? CELL_TOO_LARGE : CELL_DAMAGED;
	cache->stats.too_large += large;
	cache->stats.damaged += !large;
	log_warn("stretch %u on edge %u: its far field %s: drawn without it", id, cache->pkg->stretches[id].edge,
		large ? "does not fit into the memory for it" : "is damaged");
	give_staging_back(cache, entry);
	clear(entry);
}

static void show(struct cell_cache *cache, struct entry *entry)
{
	struct cell_cache_stats *stats = &cache->stats;
	stats->load_ns_max = entry->took_ns > (int64_t)stats->load_ns_max ? (uint64_t)entry->took_ns : stats->load_ns_max;
	if (entry->status < 0) {
		condemn(cache, entry);
		return;
	}
	stats->loads++;
	stats->loaded_bytes += cell_loader_raw_bytes(&cache->config, cache->pkg, entry->shown.stretch);
	entry->shown = entry->loaded;
	entry->shown.state = CELL_READY;
	entry->shown.generation = ++cache->generation;
}

/* The oldest job, NULL when none is under way: jobs are shown in the order in which they were given. */
static struct entry *oldest_loading(struct cell_cache *cache)
{
	struct entry *oldest = NULL;
	for (uint32_t i = 0; i < cache->config.slot_count; i++) {
		struct entry *entry = &cache->entries[i];
		if (entry->shown.state == CELL_LOADING && (!oldest || entry->due < oldest->due))
			oldest = entry;
	}
	return oldest;
}

static bool take_one(struct cell_cache *cache, bool wait)
{
	uint32_t slot;
	if (!worker_take(&cache->worker, wait, &slot))
		return false;
	show(cache, &cache->entries[slot]);
	return true;
}

static void take_loaded(struct cell_cache *cache)
{
	if (!cache->config.deterministic) {
		while (take_one(cache, false))
			;
		return;
	}
	struct entry *oldest;
	while ((oldest = oldest_loading(cache)) && oldest->due <= cache->updates)
		take_one(cache, true);
}

static void note_wishes(struct cell_cache *cache, const uint32_t *wanted, uint32_t wanted_count, const uint32_t *pinned,
	uint32_t pinned_count)
{
	for (uint32_t i = 0; i < cache->config.slot_count; i++) {
		struct entry *entry = &cache->entries[i];
		entry->rank = NO_RANK;
		entry->pinned = false;
		if (entry->shown.stretch == PKG_NONE)
			continue;
		for (uint32_t k = 0; k < wanted_count && entry->rank == NO_RANK; k++)
			if (wanted[k] == entry->shown.stretch)
				entry->rank = k;
		for (uint32_t k = 0; k < pinned_count; k++)
			entry->pinned |= pinned[k] == entry->shown.stretch;
		if (entry->rank != NO_RANK || entry->pinned)
			entry->used_at = cache->updates;
	}
}

/* What has not been uploaded and is not wanted any more goes at once: its staging buffer is needed. */
static void drop_unwanted(struct cell_cache *cache)
{
	for (uint32_t i = 0; i < cache->config.slot_count; i++) {
		struct entry *entry = &cache->entries[i];
		bool waits = entry->shown.state == CELL_WANTED || entry->shown.state == CELL_READY;
		if (!waits || entry->rank != NO_RANK || entry->pinned)
			continue;
		give_staging_back(cache, entry);
		clear(entry);
	}
}

/* Which of two must go first? */
static bool goes_before(const struct entry *a, const struct entry *b)
{
	if (a->rank != b->rank)
		return a->rank > b->rank; /* NO_RANK is the greatest */
	return a->used_at < b->used_at;
}

/* Wishes that change places from frame to frame must not throw each other out; what is under the eye, or next, may. */
static uint32_t safe_rank(const struct cell_cache *cache, uint32_t rank)
{
	return rank < URGENT_RANKS ? rank : rank + cache->config.slot_count / 4;
}

/* A slot for a wish of this rank: an empty one, or that of what is wanted least and clearly less than it. */
static struct entry *make_room(struct cell_cache *cache, uint32_t rank)
{
	const uint32_t safe = safe_rank(cache, rank);
	struct entry *victim = NULL;
	for (uint32_t i = 0; i < cache->config.slot_count; i++) {
		struct entry *entry = &cache->entries[i];
		if (entry->shown.stretch == PKG_NONE)
			return entry;
		if (entry->pinned || entry->shown.state == CELL_LOADING || entry->rank <= safe)
			continue;
		if (!victim || goes_before(entry, victim))
			victim = entry;
	}
	if (!victim)
		return NULL;
	cache->stats.evictions += victim->shown.state == CELL_UPLOADED;
	give_staging_back(cache, victim);
	clear(victim);
	return victim;
}

static struct entry *want(struct cell_cache *cache, uint32_t stretch, uint32_t rank)
{
	struct entry *entry = entry_of(cache, stretch);
	if (!entry && (entry = make_room(cache, rank))) {
		entry->shown.stretch = stretch;
		entry->shown.state = CELL_WANTED;
		entry->rank = rank;
		entry->used_at = cache->updates;
	}
	return entry;
}

static bool can_be(const struct cell_cache *cache, uint32_t stretch)
{
	return stretch < cache->pkg->stretch_count && cache->verdict[stretch] == CELL_EMPTY;
}

static struct entry *most_wanted(struct cell_cache *cache, enum cell_state state)
{
	struct entry *best = NULL;
	for (uint32_t i = 0; i < cache->config.slot_count; i++) {
		struct entry *entry = &cache->entries[i];
		if (entry->shown.state == state && (!best || entry->rank < best->rank))
			best = entry;
	}
	return best;
}

/* The READY entry that is wanted least, and less than by this rank, must be loaded again. */
static void send_back(struct cell_cache *cache, uint32_t rank)
{
	struct entry *worst = NULL;
	for (uint32_t i = 0; i < cache->config.slot_count; i++) {
		struct entry *entry = &cache->entries[i];
		bool less = entry->shown.state == CELL_READY && !entry->pinned && entry->rank > rank;
		if (less && (!worst || entry->rank > worst->rank))
			worst = entry;
	}
	if (!worst)
		return;
	give_staging_back(cache, worst);
	worst->shown = (struct cell_slot){ .stretch = worst->shown.stretch, .state = CELL_WANTED };
}

static bool begin_load(struct cell_cache *cache, struct entry *entry)
{
	if (!cache->staging_free_count)
		return false;
	if (cell_loader_staging_bytes(&cache->config, cache->pkg, entry->shown.stretch) > cache->config.staging_bytes) {
		entry->status = -E2BIG;
		condemn(cache, entry);
		return true;
	}
	entry->staging = cache->staging_free[--cache->staging_free_count];
	entry->shown.state = CELL_LOADING;
	uint64_t due = cache->updates + cache->config.latency_updates;
	cache->last_due = due > cache->last_due ? due : cache->last_due + 1;
	entry->due = cache->last_due;
	bool given = worker_give(&cache->worker, (uint32_t)(entry - cache->entries));
	assert(given); /* there are no more staging buffers than the worker takes jobs */
	(void)given;
	return true;
}

static void begin_loads(struct cell_cache *cache)
{
	struct entry *first = most_wanted(cache, CELL_WANTED);
	if (first && first->rank == 0 && !cache->staging_free_count)
		send_back(cache, 0);
	while (first && begin_load(cache, first))
		first = most_wanted(cache, CELL_WANTED);
}

static void count_late(struct cell_cache *cache, const uint32_t *wanted, uint32_t wanted_count)
{
	if (!wanted_count || !can_be(cache, wanted[0]))
		return;
	enum cell_state state = cell_cache_find(cache, wanted[0], NULL);
	cache->stats.late_updates += state != CELL_READY && state != CELL_UPLOADED;
}

void cell_cache_update(struct cell_cache *cache, const uint32_t *wanted, uint32_t wanted_count, const uint32_t *pinned,
	uint32_t pinned_count)
{
	cache->updates++;
	take_loaded(cache);
	note_wishes(cache, wanted, wanted_count, pinned, pinned_count);
	drop_unwanted(cache);
	for (uint32_t i = 0; i < wanted_count; i++)
		if (can_be(cache, wanted[i]) && !want(cache, wanted[i], i))
			cache->stats.refused++;
	begin_loads(cache);
	count_late(cache, wanted, wanted_count);
}

/* This one is wanted before all others. */
static void put_first(struct cell_cache *cache, uint32_t stretch)
{
	for (uint32_t i = 0; i < cache->config.slot_count; i++) {
		struct entry *entry = &cache->entries[i];
		if (entry->shown.stretch == stretch)
			entry->rank = 0;
		else if (entry->rank < NO_RANK - 1)
			entry->rank++;
	}
}

enum cell_state cell_cache_wait(struct cell_cache *cache, uint32_t stretch)
{
	put_first(cache, stretch);
	for (;;) {
		enum cell_state state = cell_cache_find(cache, stretch, NULL);
		if (state == CELL_READY || state == CELL_UPLOADED || !can_be(cache, stretch))
			return state;
		struct entry *entry = want(cache, stretch, 0);
		if (entry && entry->shown.state == CELL_WANTED) {
			if (!cache->staging_free_count)
				send_back(cache, 0);
			if (begin_load(cache, entry))
				continue;
		}
		if (!take_one(cache, true))
			return state; /* nothing is under way, and all is pinned */
	}
}

enum cell_state cell_cache_find(const struct cell_cache *cache, uint32_t stretch, uint32_t *slot)
{
	if (slot)
		*slot = CELL_SLOT_NONE;
	if (stretch >= cache->pkg->stretch_count)
		return CELL_EMPTY;
	for (uint32_t i = 0; i < cache->config.slot_count; i++) {
		if (cache->entries[i].shown.stretch != stretch)
			continue;
		if (slot)
			*slot = i;
		return cache->entries[i].shown.state;
	}
	return (enum cell_state)cache->verdict[stretch];
}

uint32_t cell_cache_slot_count(const struct cell_cache *cache)
{
	return cache->config.slot_count;
}

const struct cell_slot *cell_cache_slot(const struct cell_cache *cache, uint32_t slot)
{
	return &cache->entries[slot].shown;
}

uint32_t cell_cache_next_ready(const struct cell_cache *cache)
{
	const struct entry *best = NULL;
	for (uint32_t i = 0; i < cache->config.slot_count; i++) {
		const struct entry *entry = &cache->entries[i];
		if (entry->shown.state == CELL_READY && (!best || entry->rank < best->rank))
			best = entry;
	}
	return best ? (uint32_t)(best - cache->entries) : CELL_SLOT_NONE;
}

void cell_cache_uploaded(struct cell_cache *cache, uint32_t slot)
{
	struct entry *entry = &cache->entries[slot];
	assert(entry->shown.state == CELL_READY);
	entry->shown.state = CELL_UPLOADED;
	struct cell_set *const sets[] = { &entry->shown.local, &entry->shown.pvs };
	for (int i = 0; i < 2; i++) {
		sets[i]->indices = NULL;
		sets[i]->vertices = NULL;
		entry->shown.impostor[i].vertices = NULL;
		entry->shown.impostor[i].indices = NULL;
		entry->shown.impostor[i].pages = NULL;
	}
	give_staging_back(cache, entry);
}

void cell_cache_stats(const struct cell_cache *cache, struct cell_cache_stats *out)
{
	*out = cache->stats;
}
