/*
 * Cuts the street graph into stretches (assets/pkg_format.h, PKG_STRC): parts of edges that are straight enough for a
 * box of eyes around their axis, and short enough that nothing distant grows by more than a factor m from one end to
 * the other (FACTS, "Parallax": L <= z_s (1 - 1/m), m = 2).
 */
#ifndef BLVD_TOOLS_IMPOSTOR_STRETCHES_H
#define BLVD_TOOLS_IMPOSTOR_STRETCHES_H

#include "assets/pkg.h"
#include "tools/city/pool.h"

struct stretch_options {
	double near_m;               /* what is nearer is local; 0: 300. A stretch has at least 2.5 times its length */
	double length_max_m;         /* 0: 60; never more than near_m / 2 */
	double eye_min_m, eye_max_m; /* above the carriageway; both 0: 1.2 and 4 */
};

typedef ARRAY(struct pkg_stretch) stretch_array;
typedef ARRAY(uint32_t) first_stretch_array;

/*
 * The stretches of every edge that cars may use in one direction at least, sorted by edge and place; edges that none
 * may use have none. `first` gets edge_count + 1 entries. What a stretch sees, its blobs and its hash stay 0. Both
 * arrays are replaced.
 *
 * half_width_mm is half of the carriageway, plus how far the polyline strays from the axis, plus half a metre for who
 * drives at the kerb. The axis is never a point: an edge of no length has one of a millimetre, to the north.
 */
void stretches_cut(
	const struct pkg_graph *net, const struct stretch_options *options, stretch_array *out, first_stretch_array *first);

#endif
