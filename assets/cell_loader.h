/*
 * Reads one stretch's blobs into memory that the caller gives: what is copied to the GPU into a staging buffer, what is
 * kept into the slot's own arrays. One thread at a time; no heap, no locks.
 */
#ifndef BLVD_ASSETS_CELL_LOADER_H
#define BLVD_ASSETS_CELL_LOADER_H

#include "assets/cell_cache.h"
#include "assets/set_expand.h"

struct cell_loader {
	const struct pkg *pkg;
	const struct cell_cache_config *config;
	struct blob_reader *reader;
	struct set_expander expander;
	void *scratch; /* a set as stored, before it is expanded; what unfolding an impostor wants besides */
};

/* Arrays of one slot that stay while it is used. */
struct cell_keep {
	struct cell_range *local_ranges, *pvs_ranges;
	struct cell_part *local_parts, *pvs_parts;
	struct pkg_impostor_view *views[2]; /* PKG_IMPOSTOR_VIEWS_MAX each */
};

/* Is the stretch's visible set wanted, by the config? */
bool cell_loader_wants_pvs(const struct cell_cache_config *config, const struct pkg *pkg, uint32_t stretch);
/* Are its vertices copied? */
static inline bool cell_loader_copies_pvs(const struct cell_cache_config *config)
{
	return config->pvs == CELL_PVS_WHERE_NEEDED;
}

/* Staging bytes that a stretch needs at most. */
uint64_t cell_loader_staging_bytes(const struct cell_cache_config *config, const struct pkg *pkg, uint32_t stretch);
/* Raw bytes that are read for it. */
uint64_t cell_loader_raw_bytes(const struct cell_cache_config *config, const struct pkg *pkg, uint32_t stretch);

uint64_t cell_loader_bytes(const struct pkg *pkg, const struct cell_cache_config *config);
/* `config` is borrowed. Returns 0 or -ENOMEM. */
int cell_loader_init(
	struct cell_loader *loader, struct arena *arena, const struct pkg *pkg, const struct cell_cache_config *config);

/* The arrays of `keep` have the capacities of `limits`; `staging` has cell_loader_staging_bytes() and is aligned to 64.
 * Fills in the content of `out`, not its state. Returns 0, -EBADMSG when anything is damaged, or -E2BIG. */
int cell_loader_load(struct cell_loader *loader, uint32_t stretch, const struct cell_limits *limits,
	const struct cell_keep *keep, uint8_t *staging, uint64_t staging_bytes, struct cell_slot *out);

#endif
