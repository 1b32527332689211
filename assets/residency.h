/*
 * Which chunks of a package are in memory, and where: one fixed pool of vertices, one of indices, reserved once. When
 * the whole city fits, every chunk has its place along a Hilbert curve, and is loaded when it is first seen, or by and
 * by. Otherwise the nearest chunks are loaded first, a slice of bytes a frame, and the farthest make place. No GL here:
 * the caller uploads.
 */
#ifndef BLVD_ASSETS_RESIDENCY_H
#define BLVD_ASSETS_RESIDENCY_H

#include <stdbool.h>
#include <stdint.h>

#include "assets/pkg.h"
#include "assets/range_pool.h"

enum residency_state {
	RESIDENCY_ABSENT,
	RESIDENCY_PRESENT,
	RESIDENCY_DAMAGED, /* its bytes failed pkg_chunk_check(); never loaded */
};
struct residency_chunk {
	uint32_t first_vertex, first_index; /* in the pools, when present */
	uint32_t index_count;
	uint8_t state; /* enum residency_state */
};

/* Copies a chunk's bytes to its place in the pools; the ranges are the chunk's own. */
typedef void (*residency_upload)(void *context, uint32_t chunk, const struct residency_chunk *place);

struct residency {
	const struct pkg *pkg;
	struct residency_chunk *chunks; /* one per chunk of the package */
	uint32_t *order;                /* chunk ids; nearest first, or along the curve */
	uint64_t *key;                  /* of order[i] */
	uint32_t *listed;               /* of use within an update */
	struct range_pool vertices, indices;
	bool whole;       /* everything fits */
	uint32_t rest_at; /* whole: order[] before this has been looked at */
	bool sorted;
	int64_t sorted_at_mm[3];
	uint32_t present, damaged;
	uint64_t dropped, evicted; /* since start */
	uint64_t pending_bytes;    /* wanted, not present, after the last update */
};

/* Bytes of all of a package's chunks. */
void residency_totals(const struct pkg *pkg, uint64_t *vertices, uint64_t *indices);

/* The most that the chunks within a radius of a place on any street sum up to, vertices and indices each for itself.
 * Memory from the arena is given back. Returns 0 or -ENOMEM. */
int residency_bound(const struct pkg *pkg, struct arena *arena, double radius_m, uint64_t *vertices, uint64_t *indices);

/* Pools in which all chunks within a radius of the eye find room, wherever on a street it is: that bound, a share for
 * the holes between chunks, and two of the largest; never more than all. Returns 0 or -ENOMEM. */
int residency_pools(const struct pkg *pkg, struct arena *arena, double radius_m, uint64_t *vertices, uint64_t *indices);

/* What residency_init() takes from the arena, but for padding. */
uint64_t residency_arena_bytes(const struct pkg *pkg);
/* Capacities in vertices and indices. Returns 0 or -ENOMEM. */
int residency_init(struct residency *residency, struct arena *arena, const struct pkg *pkg, uint32_t vertex_capacity,
	uint32_t index_capacity);

/* Loads at most `slice_bytes` (but at least one chunk, when one is wanted) of what is nearest to the eye and within
 * `far_mm`; evicts what is farther than that when the pools are full. */
void residency_update(struct residency *residency, const int64_t eye_mm[3], int64_t far_mm, uint64_t slice_bytes,
	residency_upload upload, void *context);

/* When the whole city fits: loads this chunk now, unless it is there or damaged. */
void residency_load_now(struct residency *residency, uint32_t chunk, residency_upload upload, void *context);

/* Is all of the city there? */
bool residency_complete(const struct residency *residency);

#endif
