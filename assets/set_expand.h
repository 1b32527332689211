/*
 * From a set of triangles as it is stored, masks by object, to lists of indices that are drawn as they are: one range a
 * chunk, pass and look. Used on the loader's thread; no heap, no locks.
 */
#ifndef BLVD_ASSETS_SET_EXPAND_H
#define BLVD_ASSETS_SET_EXPAND_H

#include "assets/cell_cache.h"

#define SET_LOOKS 8

/* Belongs to one thread. */
struct set_expander {
	const struct pkg *pkg;
	uint8_t (*look_of)(uint32_t kinds);
	uint8_t *chunk_checked; /* by chunk: not yet, good, damaged */
	uint8_t *looks;         /* of the objects of one chunk */
	uint32_t looks_capacity;
	uint16_t *moved; /* by vertex of a chunk: its number among the set's own, or none */
};

/* Where an expanded set goes. Capacities are in elements. */
struct set_room {
	struct cell_range *ranges;
	struct cell_part *parts;
	uint16_t *indices;
	struct pkg_mesh_vertex *vertices; /* NULL: indices stay those of the chunks */
	uint32_t range_capacity, part_capacity, index_capacity, vertex_capacity;
};

/* `objects`: the most that one set has. Returns 0 or -ENOMEM. */
int set_expander_init(struct set_expander *expander, struct arena *arena, const struct pkg *pkg,
	uint8_t (*look_of)(uint32_t kinds), uint32_t objects);
uint64_t set_expander_bytes(const struct pkg *pkg, uint32_t objects);

/* Objects of damaged chunks are left out. Returns 0, or -E2BIG when the room is too small. */
int set_expand(
	struct set_expander *expander, const struct set_view *set, const struct set_room *room, struct cell_set *out);

#endif
