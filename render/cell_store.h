/*
 * What the far field has on the GPU: for each slot of assets/cell_cache.h a fixed place for its sets' indices, its
 * impostors' triangles and their texture pages, sized at start by the package's largest stretch. A slot is uploaded in
 * steps, so that no frame pays for all of it.
 */
#ifndef BLVD_RENDER_CELL_STORE_H
#define BLVD_RENDER_CELL_STORE_H

#include "assets/cell_cache.h"
#include "render/draw_list.h"
#include "render/gfx.h"

/* The uniform block `Impostor` of impostor.vert, byte for byte (std140). */
struct impostor_block {
	float axis[PKG_IMPOSTOR_VIEWS_MAX][4]; /* of each capture: struct pkg_impostor_view */
};

/* One cell's impostor on the GPU. */
struct stored_impostor {
	uint32_t first_vertex, first_index, index_count; /* in the store's buffers; 0 indices: nothing to draw */
	uint32_t first_layer;                            /* of the pages' texture array */
	gfx_buffer block;
};

enum stored_step { STORED_NOTHING, STORED_SETS, STORED_TRIANGLES, STORED_ALL };
struct stored_slot {
	uint32_t generation; /* of the cache's slot that this is */
	enum stored_step step;
	uint32_t pages_done; /* of both impostors */
	struct draw_set local, pvs;
	struct stored_impostor impostor[2];
};

struct cell_store {
	struct gfx *gfx;
	const struct pkg *pkg;
	struct cell_limits limits;
	uint32_t slot_count;
	struct stored_slot *slots;
	gfx_buffer set_indices, set_vertices, impostor_vertices, impostor_indices;
	gfx_buffer impostor_lines; /* twice as many indices: the triangles' edges; none unless asked for */
	gfx_texture pages;
	uint64_t bytes; /* of all of these, and the blocks */
};

/* `lines`: keeps the triangles' edges too. Returns 0 or -ENOMEM; what was made until then is cell_store_finish()'s. */
int cell_store_init(struct cell_store *store, struct arena *arena, struct gfx *gfx, const struct pkg *pkg,
	const struct cell_limits *limits, uint32_t slot_count, bool lines);
/* GPU bytes that one slot takes. */
uint64_t cell_store_slot_bytes(const struct cell_limits *limits);
void cell_store_finish(struct cell_store *store);

/* Forgets what slots held whose content has changed in the cache. */
void cell_store_follow(struct cell_store *store, const struct cell_cache *cache);

/* Copies more of a READY slot while `left_bytes` lasts (but at least one step), and takes from it. True when all of the
 * slot is there. */
bool cell_store_upload(struct cell_store *store, uint32_t index, const struct cell_slot *slot, uint64_t *left_bytes);

#endif
