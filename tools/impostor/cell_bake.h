/*
 * Everything of one stretch: its local set, its visible set of distant triangles, and for each of its two cells the
 * decision between nothing, geometry and an impostor, with the impostor (DESIGN "Baking" 5 and 6; [S97] 4.2).
 */
#ifndef BLVD_TOOLS_IMPOSTOR_CELL_BAKE_H
#define BLVD_TOOLS_IMPOSTOR_CELL_BAKE_H

#include "assets/pkg.h"
#include "tools/impostor/triangle_set.h"
#include "tools/impostor/visibility.h"

/* Zero takes the default. */
struct cell_options {
	bool pvs, impostor;     /* what is made; pvs is made for cells of geometry in any case */
	double tau_px;          /* 1 */
	double focal_px;        /* of the screen; 869: 720 rows at 45 degrees */
	double texels_per_px;   /* of the screen, at the middle of the cell; 1 */
	double far_m;           /* nothing farther counts; default: all of the package */
	uint32_t triangles_max; /* of an impostor; 3,000 */
	uint32_t pages_max;     /* of an impostor; 16 */
	bool grid;              /* a regular grid inside surfaces ([S97] 4.2) instead of planes */
	bool truth;             /* keep what every texel shows, for measuring */
};
struct cell_options cell_options_settled(const struct cell_options *options, const struct pkg *pkg);

/* With tighter bounds on triangles and pages, so with more error and fewer bytes: half of them at every level. */
#define CELL_LEVELS 5
struct cell_options cell_options_at_level(const struct cell_options *settled, unsigned level);

/*
 * What a stretch is made of, and its hash: two inputs with the same hash give the same bytes on one machine and driver.
 * `object_hashes` is of the package's objects.
 */
uint64_t *cell_object_hashes(const struct pkg *pkg); /* freed by the caller with array_free() */
uint64_t cell_package_hash(const struct pkg *pkg);   /* of what all objects share: textures, materials */
uint64_t cell_input_hash(const struct pkg_stretch *stretch, const struct visible_sets *sets,
	const uint64_t *object_hashes, uint64_t package_hash, const struct cell_options *options);

/* The result. Blob offsets count from the start of `bytes`, in the order of PKG_CELD, each aligned. */
struct baked_stretch {
	struct pkg_stretch stretch;
	struct pkg_cell cells[2];
	byte_array bytes;
};
void baked_stretch_finish(struct baked_stretch *baked);

/* Where the processor time went, seconds. */
struct cell_times {
	double look, capture, wanted, build, store;
};

/* One baker belongs to one thread. Opens its GL context when it first needs it. */
struct cell_baker;
struct cell_baker *cell_baker_new(const struct pkg *pkg);
void cell_baker_free(struct cell_baker *baker);
const struct cell_times *cell_baker_times(const struct cell_baker *baker);

/* `stretch` as stretches_cut() made it, `sets` as visible_set() did, `hash` as cell_input_hash() did with the same
 * settled options. Replaces `out`. Returns 0, or -errno after logging one line. */
int cell_baker_run(struct cell_baker *baker, const struct cell_options *options, const struct pkg_stretch *stretch,
	const struct visible_sets *sets, uint64_t hash, struct baked_stretch *out);

#endif
