/*
 * The surface of one building while it is made: a list of faces with a brush (material, tint, seed) for what is drawn
 * next. Reused from building to building; shell_emit() hands the result to the mesh sink.
 */
#ifndef BLVD_TOOLS_BAKE_SHELL_H
#define BLVD_TOOLS_BAKE_SHELL_H

#include <stdbool.h>

#include "tools/bake/mesh.h"

struct shell_point {
	struct dvec3 at;
	float u, v, ao;
};

struct shell {
	ARRAY(struct mesh_vertex) vertices;
	ARRAY(uint32_t) indices;
	uint8_t material; /* the brush */
	uint8_t rgb[3];
	uint8_t seed;
};

void shell_clear(struct shell *shell); /* keeps the memory */
void shell_finish(struct shell *shell);

void shell_brush(struct shell *shell, int material, const uint8_t rgb[3]);

uint32_t shell_vertex(struct shell *shell, const struct shell_point *point, struct vec3 normal);
void shell_triangle(struct shell *shell, uint32_t a, uint32_t b, uint32_t c);

/* A flat convex face, counter-clockwise from outside; its normal is Newell's. A face without area is dropped. */
void shell_face(struct shell *shell, const struct shell_point *points, size_t count);

/* A box that stands on end: its four sides and its top; `bottom` too when asked for. `along` is a unit vector. */
struct shell_box {
	struct dvec2 centre, along;
	double length, width, from, to;
	double tile_m; /* metres of one texture tile */
	float ao;
	bool bottom;
};
void shell_box(struct shell *shell, const struct shell_box *box);

/* All faces as one object; nothing when there are none. */
void shell_emit(const struct shell *shell, const struct mesh_object *object, struct mesh_sink *sink);

#endif
