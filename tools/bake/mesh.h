/*
 * Where generators put triangles. A sink collects objects; mesh_finish_chunks() packs them into chunks of at most
 * 65,536 vertices, block by block and tile by tile, in an order that depends on nothing but the input. A sink is not
 * shared between threads: make one per generator and append them in a fixed order.
 */
#ifndef BLVD_TOOLS_BAKE_MESH_H
#define BLVD_TOOLS_BAKE_MESH_H

#include <stdint.h>

#include "assets/pkg_format.h"
#include "platform/base/vec.h"
#include "tools/city/pool.h"

struct mesh_vertex {
	struct dvec3 at;    /* city frame, m */
	struct vec3 normal; /* unit */
	float u, v;         /* texture tiles; -127 to 127 after the object's whole-tile shift, see mesh_vertex() */
	float ao;           /* 0 to 1, 1 open */
	uint8_t material;   /* enum material_id of tools/bake/materials.h */
	uint8_t rgb[3];
	uint8_t seed;
};

struct mesh_object {
	enum pkg_object_kind kind;
	uint16_t flags; /* enum pkg_object_flags */
	int64_t source_id;
	uint32_t face;    /* block, or PKG_NONE: goes to the chunk of its tile */
	const char *name; /* borrowed until the sink is finished, or NULL */
};

struct mesh_sink;

struct mesh_sink *mesh_sink_new(void);
void mesh_sink_free(struct mesh_sink *sink);

/* Objects do not nest. An object without triangles leaves no trace. Ground objects are to be cut by tile (MESH_TILE_M)
 * by the caller, so that chunks stay small. */
#define MESH_TILE_M 128.0
void mesh_begin(struct mesh_sink *sink, const struct mesh_object *object);
/* Returns the vertex's index within the object. uv outside 0..255.99 tiles is wrapped per triangle-safe whole tiles by
 * the caller: keep each surface's uv span below 255 tiles and non-negative. */
uint32_t mesh_add_vertex(struct mesh_sink *sink, const struct mesh_vertex *vertex);
/* Counter-clockwise seen from the front. Degenerate triangles (two equal indices) are dropped. */
void mesh_add_triangle(struct mesh_sink *sink, enum pkg_pass pass, uint32_t a, uint32_t b, uint32_t c);
void mesh_end(struct mesh_sink *sink);

/* Adds all of `from`'s objects behind those of `to`. */
void mesh_append(struct mesh_sink *to, const struct mesh_sink *from);

/* The packed result; owned by the sink's caller, freed by mesh_chunks_finish(). Names are indices into `names`. */
struct mesh_chunks {
	ARRAY(struct pkg_chunk) chunks;
	ARRAY(struct pkg_object)
	objects; /* name: index into names + 1, 0 none; the package writer turns it into a STRS offset */
	ARRAY(const char *) names;
	ARRAY(uint8_t) geometry;
	uint64_t triangles;
};
void mesh_finish_chunks(const struct mesh_sink *sink, struct mesh_chunks *out);
void mesh_chunks_finish(struct mesh_chunks *chunks);

#endif
