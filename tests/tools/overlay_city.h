/* A small made-up city for tests of the overlay: a grid of named streets on a slope, with a font from the bake. */
#ifndef BLVD_TESTS_OVERLAY_CITY_H
#define BLVD_TESTS_OVERLAY_CITY_H

#include <stdbool.h>

#include "assets/pkg.h"
#include "nav/nav.h"
#include "render/camera.h"
#include "tools/bake/bake.h"

#define OVERLAY_GRID 12
#define OVERLAY_STEP_M 90.0
#define OVERLAY_NAMES 24

struct overlay_city {
	struct pkg pkg;
	struct pkg_meta meta;
	struct text_data text;
	char strings[2048];
	struct pkg_node nodes[OVERLAY_GRID * OVERLAY_GRID];
	uint32_t outs[4 * OVERLAY_GRID * OVERLAY_GRID];
	struct pkg_half halves[4 * OVERLAY_GRID * OVERLAY_GRID];
	struct pkg_edge edges[2 * OVERLAY_GRID * OVERLAY_GRID];
	struct pkg_point points[4 * OVERLAY_GRID * OVERLAY_GRID];
	uint32_t name[OVERLAY_NAMES]; /* STRS offsets */
	uint32_t credit;
};

/* False without usable fonts. */
bool overlay_city_make(struct overlay_city *city);
void overlay_city_finish(struct overlay_city *city);

/* The half-edge between neighbouring nodes (column, row); PKG_NONE when they are not. */
uint32_t overlay_city_half(const struct overlay_city *city, int column, int row, int to_column, int to_row);

/* A route along grid corners; returns the number of half-edges. */
uint32_t overlay_city_route(
	const struct overlay_city *city, const int (*corners)[2], uint32_t corner_count, uint32_t *out, uint32_t capacity);

/* Puts the car `driven_m` along the route and fills in what guidance would: next manoeuvre, rest of the way. */
void overlay_city_drive(const struct overlay_city *city, const uint32_t *route, uint32_t count, double driven_m,
	double speed_mps, struct nav_view *nav);

/* A plain view for a camera kind: eye behind or above the car. */
void overlay_city_view(
	const struct nav_view *nav, enum camera_kind kind, uint32_t width, uint32_t height, struct view *view);

#endif
