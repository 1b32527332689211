/*
 * Vertices and indices of an impostor as they are stored: differences from one to the next, the bytes that are alike
 * beside each other, which packs to nine tenths of what they would take as they are drawn. SPEC.md, "An impostor".
 */
#ifndef BLVD_ASSETS_IMPOSTOR_FOLD_H
#define BLVD_ASSETS_IMPOSTOR_FOLD_H

#include <stdint.h>

#include "assets/pkg_format.h"

/* Both work in place and want so many bytes besides. */
static inline uint64_t impostor_fold_bytes(uint64_t vertex_count, uint64_t index_count)
{
	return 4 * vertex_count > 2 * index_count ? 4 * vertex_count : 2 * index_count;
}

/* `vertices` and the indices behind them. Positions are rounded to 2^head->step_log2 mm, coordinates to eight units. */
void impostor_fold(const struct pkg_impostor_head *head, void *vertices, void *scratch);
/* The other way round. Any bytes are taken, what comes out may be anything: impostor_view_open() checks it. */
void impostor_unfold(const struct pkg_impostor_head *head, void *vertices, void *scratch);

#endif
