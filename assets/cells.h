/*
 * The far field of a package: which cell a place on the street belongs to, and the blobs of stretches and cells. No
 * heap, no GL.
 */
#ifndef BLVD_ASSETS_CELLS_H
#define BLVD_ASSETS_CELLS_H

#include <stdbool.h>
#include <stdint.h>

#include "assets/blob.h"
#include "assets/pkg.h"
#include "platform/base/arena.h"

/* The stretch of an edge at a distance along its polyline (half-edge 2e's direction), clamped to the edge; PKG_NONE
 * when the edge has none. */
uint32_t cells_stretch_at(const struct pkg *pkg, uint32_t edge, int64_t along_mm);

/* Is the eye in the stretch's view cell? */
bool cells_holds_eye(const struct pkg_stretch *stretch, const int64_t eye_mm[3]);
/* Metres from the eye to the view cell; 0 inside. */
double cells_distance_m(const struct pkg_stretch *stretch, const int64_t eye_mm[3]);

/* Checked views into the raw bytes of a set, or of an impostor; `raw` is aligned to 4. Every index is in range
 * afterwards. An impostor is unfolded in place, once: `scratch` has impostor_fold_bytes() of the cell. Returns 0 or
 * -EBADMSG. */
struct set_view {
	const struct pkg_set_object *objects;
	const uint8_t *masks; /* of the objects that are not whole, in order */
	uint32_t object_count, triangle_count;
};
int set_view_open(struct set_view *set, const struct pkg *pkg, const void *raw, uint32_t raw_bytes);
struct impostor_view {
	struct pkg_impostor_head head;
	const struct pkg_impostor_view *views;
	const struct pkg_impostor_vertex *vertices;
	const uint16_t *indices;
	const uint8_t *pages; /* ETC2 */
};
int impostor_view_open(
	struct impostor_view *impostor, const struct pkg_cell *cell, void *raw, uint32_t raw_bytes, void *scratch);

/* Reads and checks every set and impostor. Takes cells_verify_bytes() from the arena. Returns 0, -ENOMEM, or -EBADMSG
 * with `fault` filled in. For `blvd verify`. */
uint64_t cells_verify_bytes(const struct pkg *pkg);
int cells_verify(const struct pkg *pkg, struct arena *arena, struct pkg_fault *fault);

#endif
