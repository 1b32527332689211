/*
 * Opens a city package and hands out const views into it. The file is mapped, so nothing is copied; every view is
 * valid until pkg_close(). After pkg_open() every index, offset and count in every section but GEOM's bytes is known to
 * be in range; a chunk's bytes are checked by pkg_chunk_check() when they are first used.
 */
#ifndef BLVD_ASSETS_PKG_H
#define BLVD_ASSETS_PKG_H

#include <stdbool.h>

#include "assets/pkg_format.h"
#include "platform/base/file_map.h"
#include "platform/base/geo.h"

struct pkg_fault {
	char text[200];  /* "section CHNK, element 17: vertex_offset out of range" */
	uint64_t offset; /* byte in the file */
};

/* The street graph as arrays; also what nav/graph.h works on. Borrowed from the package (or from the bake). */
struct pkg_graph {
	const struct pkg_node *nodes;
	const uint32_t *outs;
	const struct pkg_half *halves;
	const struct pkg_edge *edges;
	const struct pkg_point *points;
	const struct pkg_face *faces;
	const struct pkg_turn *turns;
	uint32_t node_count, out_count, half_count, edge_count, point_count, face_count, turn_count;
};

struct pkg {
	struct file_map map;
	const struct pkg_meta *meta;
	struct geo_frame frame;
	const char *strings;
	uint32_t strings_bytes;
	struct pkg_graph graph;
	const struct pkg_height_grid *heights; /* NULL: flat, 0 */
	const int32_t *height_mm;
	const struct pkg_material *materials;
	uint32_t material_count;
	const struct pkg_texture_array *textures; /* NULL: none */
	const uint8_t *texture_bytes;
	const struct pkg_light_map *light_map; /* NULL: none */
	const uint8_t *light_map_bytes;
	const struct pkg_chunk *chunks;
	uint32_t chunk_count;
	const struct pkg_object *objects;
	uint32_t object_count;
	const uint8_t *geometry;
	uint64_t geometry_bytes;
	const struct pkg_font *font; /* NULL: none */
	const uint8_t *font_atlas;
	const struct pkg_glyph *glyphs;
	const struct pkg_text *texts;
	uint32_t text_count;
	const struct pkg_glyph_at *glyph_runs;
	uint32_t glyph_run_count;
	const struct pkg_stretch *stretches; /* NULL: no far field */
	uint32_t stretch_count;
	const uint32_t *first_stretch; /* of edge e; edge_count + 1 of them */
	const struct pkg_cell *cells;  /* 2 a stretch */
	const uint8_t *blobs;          /* CELD */
	uint64_t blobs_bytes;
	const struct pkg_occluder *occluders; /* NULL: none */
	uint32_t occluder_count;
};

/* Returns 0, -errno from the file system, or -EBADMSG with `fault` filled in. On failure `pkg` is zeroed. */
int pkg_open(struct pkg *pkg, const char *path, struct pkg_fault *fault);
void pkg_close(struct pkg *pkg);

/* CRC and index range of one chunk's bytes. Returns 0 or -EBADMSG. */
int pkg_chunk_check(const struct pkg *pkg, uint32_t chunk, struct pkg_fault *fault);

/* Everything pkg_open() checks, and every chunk, every face cycle, padding bytes, sorting. For `blvd verify`. */
int pkg_verify(const struct pkg *pkg, struct pkg_fault *fault);

/* A string by STRS offset; never NULL. */
static inline const char *pkg_string(const struct pkg *pkg, uint32_t offset)
{
	return pkg->strings + offset;
}

/* Ground height in mm at a place of the city frame, clamped to the grid's edge outside it. */
int32_t pkg_ground_mm(const struct pkg *pkg, int64_t east_mm, int64_t north_mm);

/* The shaped form of a string, or NULL. Binary search. */
const struct pkg_text *pkg_text_find(const struct pkg *pkg, uint32_t string);

static inline const struct pkg_mesh_vertex *pkg_chunk_vertices(const struct pkg *pkg, const struct pkg_chunk *chunk)
{
	return (const struct pkg_mesh_vertex *)(const void *)(pkg->geometry + chunk->vertex_offset);
}

static inline const uint16_t *pkg_chunk_indices(const struct pkg *pkg, const struct pkg_chunk *chunk)
{
	return (const uint16_t *)(const void *)(pkg->geometry + chunk->index_offset);
}

#endif
