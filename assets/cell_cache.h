/*
 * The far field's stretches in memory: which ones are wanted, a thread that reads, checks, unpacks and prepares them,
 * and a fixed number of slots. The frame only has to upload what is ready, a slice at a time.
 *
 * One slot holds one stretch: its local set, the impostors of its two cells, and its visible set of distant triangles
 * where that is needed. A slot's bulk (indices, vertices, texels) lies in one of a few staging buffers until the caller
 * says that it has been uploaded; what is needed to draw (ranges, parts, views) stays as long as the slot. So slots can
 * be many and memory small: a slot's index is a good index for the caller's own GPU memory, its generation says when
 * the content has changed.
 *
 * All calls come from one thread, the frame's; only the loading itself is done on another. Everything is taken from the
 * arena at cell_cache_init(), nothing later. A slot changes only in cell_cache_update() and cell_cache_wait(): what was
 * handed out before stays valid until then.
 *
 *   every frame:  cell_cache_update(cache, likely, ...);
 *                 for each slot READY, while the upload slice lasts: upload; cell_cache_uploaded(cache, slot);
 *                 cell_cache_find(cache, here) is UPLOADED: draw it; else: fall back
 */
#ifndef BLVD_ASSETS_CELL_CACHE_H
#define BLVD_ASSETS_CELL_CACHE_H

#include <stdbool.h>
#include <stdint.h>

#include "assets/cells.h"
#include "assets/pkg.h"
#include "platform/base/arena.h"

#define CELL_SLOT_NONE UINT32_MAX
#define CELL_STAGING_MAX (2u << 20) /* so that one bad stretch does not make all slots large */

enum cell_state {
	CELL_EMPTY,     /* not asked for, or the slot has been given to another stretch */
	CELL_WANTED,    /* has a slot, waits for the loader */
	CELL_LOADING,   /* the loader is at it */
	CELL_READY,     /* in a staging buffer: upload it, then call cell_cache_uploaded() */
	CELL_UPLOADED,  /* draw it */
	CELL_DAMAGED,   /* a checksum, stream or index is wrong: logged once, never tried again */
	CELL_TOO_LARGE, /* does not fit into a staging buffer: as DAMAGED */
};

/* One object's triangles of one pass, in the set's indices. */
struct cell_part {
	uint32_t object; /* into OBJS */
	uint32_t first, count;
};

/* One draw: triangles of one chunk, pass and look. Ranges stand in the order of chunks; first and count are indices. */
struct cell_range {
	uint32_t chunk; /* whose vertices (or, with the set's own vertices, whose origin) */
	uint32_t first, count;
	uint32_t first_part, part_count; /* the objects in it, one after another, without gaps */
	uint32_t first_vertex; /* index 0 means this vertex of the set's own; 0 when the set has none: the chunk's first */
	uint8_t pass;          /* enum pkg_pass */
	uint8_t look;          /* what config.look_of() said */
	uint16_t reserved;
};

/* A set of triangles, ready to be drawn. */
struct cell_set {
	const struct cell_range *ranges;
	const struct cell_part *parts;
	uint32_t range_count, part_count;
	uint32_t index_count, vertex_count; /* of the bulk */
	/* bulk: NULL once uploaded */
	const uint16_t *indices;                /* of the chunk's vertices, or of the set's own */
	const struct pkg_mesh_vertex *vertices; /* the set's own, relative to their chunks' origins; NULL: it has none */
};

struct cell_slot {
	uint32_t stretch;    /* PKG_NONE: none */
	uint32_t generation; /* grows whenever the slot's content changes; never 0 in a used slot */
	enum cell_state state;
	bool has_pvs; /* pvs was asked for, and the stretch has it */
	struct cell_set local, pvs;
	/* of cells 2 stretch and 2 stretch + 1; all zero when there is none. vertices, indices and pages are bulk, NULL
	 * once uploaded; head and views stay. */
	struct impostor_view impostor[2];
};

enum cell_pvs {
	CELL_PVS_WHERE_NEEDED, /* of stretches that have a cell of PKG_CELL_GEOMETRY; with vertices of its own, because
							  distant chunks need not be resident */
	CELL_PVS_ALWAYS,       /* of all; indices of the chunks' vertices */
	CELL_PVS_NEVER,
};

/* Zero takes the default. */
struct cell_cache_config {
	uint32_t slot_count;    /* default 16; more than the wanted and the pinned together, or some wait */
	uint32_t staging_count; /* default 2 */
	uint64_t staging_bytes; /* of one; default: what the package's largest stretch needs, but a visible set with
							   vertices of its own does not make it more than CELL_STAGING_MAX. Stretches
							   that need more are TOO_LARGE */
	bool without_impostors; /* load local sets and, by `pvs`, visible sets only */
	enum cell_pvs pvs;
	uint8_t (*look_of)(uint32_t kinds); /* look of triangles whose materials are of these kinds, bits 1 << enum
										   pkg_material_kind; called on the loader's thread, below 8; NULL: 0 */
	/* The same calls give the same states in the same update, whatever the loader's speed: a stretch is ready
	 * `latency_updates` (default 2) updates after its turn came, and the update waits for it if it must. */
	bool deterministic;
	uint32_t latency_updates;
};

struct cell_cache_stats {
	uint64_t loads, loaded_bytes; /* raw, since start */
	uint64_t late_updates;        /* the first of `wanted` was there neither READY nor UPLOADED, nor damaged */
	uint64_t damaged, too_large;  /* stretches */
	uint64_t evictions;
	uint64_t refused; /* wanted, but all slots were pinned or wanted more */
	uint64_t load_ns_max;
	uint64_t bytes; /* memory taken from the arena */
};

struct cell_cache;

/* Bytes that cell_cache_init() will take from its arena. */
uint64_t cell_cache_bytes(const struct pkg *pkg, const struct cell_cache_config *config);

/* The package needs a far field. Returns 0, -ENODATA when it has none, -ENOMEM, or -errno when the thread cannot be
 * started. `pkg` is borrowed until cell_cache_finish(). */
int cell_cache_init(
	struct cell_cache **out, struct arena *arena, const struct pkg *pkg, const struct cell_cache_config *config);
/* Stops and joins the thread. NULL does nothing. */
void cell_cache_finish(struct cell_cache *cache);

/* What one frame wants: stretches, the most urgent first (the one under the eye is wanted[0]), and those that must not
 * go because they are being drawn. Repeats and unknown ids do no harm. Others make place, those longest unwanted first.
 */
void cell_cache_update(struct cell_cache *cache, const uint32_t *wanted, uint32_t wanted_count, const uint32_t *pinned,
	uint32_t pinned_count);

/* Waits until the stretch is READY or UPLOADED (or never will be), making place if it must: for the first frame and for
 * stills. Returns its state. */
enum cell_state cell_cache_wait(struct cell_cache *cache, uint32_t stretch);

/* The state of a stretch as of the last update, and its slot (CELL_SLOT_NONE when it has none). `slot` may be NULL. */
enum cell_state cell_cache_find(const struct cell_cache *cache, uint32_t stretch, uint32_t *slot);

uint32_t cell_cache_slot_count(const struct cell_cache *cache);
const struct cell_slot *cell_cache_slot(const struct cell_cache *cache, uint32_t slot);

/* The READY slot whose stretch is wanted most, CELL_SLOT_NONE when there is none: what to upload next. */
uint32_t cell_cache_next_ready(const struct cell_cache *cache);

/* The bulk of a READY slot has been copied: gives its staging buffer back. */
void cell_cache_uploaded(struct cell_cache *cache, uint32_t slot);

void cell_cache_stats(const struct cell_cache *cache, struct cell_cache_stats *out);

/* What a stretch needs at most, for sizing the caller's own pools: the largest over the package, by the config. */
struct cell_limits {
	uint32_t local_indices, local_parts;
	uint32_t pvs_indices, pvs_vertices, pvs_parts;
	uint32_t impostor_vertices, impostor_indices, impostor_pages; /* of both cells together */
};
void cell_cache_limits(const struct pkg *pkg, const struct cell_cache_config *config, struct cell_limits *out);

#endif
