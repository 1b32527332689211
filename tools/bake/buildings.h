/*
 * How a building is made; internal to buildings.c, plots.c, massing.c, facade_*.c and roof_*.c.
 *
 * 1. plots_build(): every drawn building with a clean outline and its heights, walls of all of them in one grid.
 * 2. massing_build(): one building's walls cut where neighbours begin and end, each with what stands or lies before it.
 * 3. facade_choose(): what it wears: materials, bays, storeys, colours, all from its id, kind, age, place and block.
 * 4. roof_build(): the roof, which says how high each wall goes; facade_build(): the walls.
 * Steps 2 to 4 run on several threads, a building at a time.
 *
 * All z are metres of the city frame. Outlines keep their interior to the left.
 */
#ifndef BLVD_TOOLS_BAKE_BUILDINGS_H
#define BLVD_TOOLS_BAKE_BUILDINGS_H

#include "tools/bake/materials.h"
#include "tools/bake/segment_grid.h"
#include "tools/bake/shell.h"
#include "tools/bake/skeleton.h"
#include "tools/bake/triangulate.h"
#include "tools/city/city.h"

#define ROOF_TILE_M 4.0
#define FOOT_M 0.5 /* walls reach this far into the ground */

struct plot {
	const struct building *building; /* NULL: not drawn from its outline */
	size_t first_point;              /* into plots.points */
	size_t first_ring, ring_count;   /* into plots.ring_first: ring_count + 1 indices into plots.points */
	double base, ground, eaves, top; /* base: where the walls begin */
	enum roof_shape roof;
	double half_width; /* half the shorter side of the smallest rectangle around it */
	struct dvec2 axis; /* unit, along the longer side of that rectangle */
	double fill;       /* share of the rectangle that it covers */
};

struct plots {
	const struct city *city;
	ARRAY(struct plot) plots; /* one a building, same index */
	ARRAY(struct dvec2) points;
	ARRAY(size_t) ring_first;
	ARRAY(struct segment) walls; /* owner: building index */
	ARRAY(struct segment) ways;  /* owner: way index */
	struct segment_grid wall_grid, way_grid;
};

void plots_build(const struct city *city, struct plots *out);
void plots_finish(struct plots *plots);

/* Drops repeated points, points on a straight line and spikes; returns how many points are left, in place. */
size_t ring_clean(struct dvec2 *points, size_t count);

struct z_range {
	double from, to;
};
#define HIDDEN_LIMIT 4

struct wall {
	struct dvec2 a, b;
	struct dvec2 along, out; /* unit */
	double length;
	double ground;   /* highest ground below it */
	double low;      /* lowest */
	double street_m; /* to the street in front of it; INFINITY: none near */
	int street_class;
	double facing_m, facing_top; /* the next wall in front; INFINITY: none near */
	struct z_range hidden[HIDDEN_LIMIT];
	int hidden_count;
	bool party;        /* touches a neighbour: no windows */
	bool party_high;   /* and that one is as high: the roof ends in a gable */
	bool annex;        /* touches something low or a part of the same building: windows above it */
	double overhang;   /* of the roof, set by roof_build() */
	double top;        /* set by roof_build() */
	struct dvec2 eave; /* where its start goes in the eaves line */
	double eave_z;
};

struct facade {
	uint8_t upper, ground, door, shop, blank; /* materials; 0: none */
	uint8_t gate;
	uint8_t roofing;
	double bay_m, storey_m;
	double ground_ratio; /* ground floor over upper storey */
	double overhang;
	bool cornice, parapet;
	uint8_t wall_rgb[3], base_rgb[3], trim_rgb[3], roof_rgb[3];
};

struct massing {
	const struct city *city;
	const struct building *building;
	const struct plot *plot;
	uint32_t index;
	uint64_t hash; /* of the building's id */
	ARRAY(struct wall) walls;
	ARRAY(size_t) ring_first; /* into walls, one more than rings */
	struct facade facade;
	double base, ground, eaves, top;
	double door; /* z where ground floors begin, when the ground is flat enough for one of them */
	bool sloping;
	bool has_ground_floor;
	double cornice;     /* height kept free for it below the eaves */
	uint32_t door_wall; /* UINT32_MAX: none */
	double area;
	/* working memory, one set a thread */
	struct triangulator *triangulator;
	struct skeleton skeleton;
	index_array triangles;
	ARRAY(struct dvec2) points;
	size_t roof_faults; /* roofs that became flat for want of a skeleton */
	size_t deck_faults; /* outlines that GEOS would not triangulate */
};

void massing_build(const struct plots *plots, uint32_t index, struct massing *massing);
void massing_finish(struct massing *massing);

static inline size_t massing_next(const struct massing *massing, size_t ring, size_t wall)
{
	return wall + 1 < massing->ring_first.items[ring + 1] ? wall + 1 : massing->ring_first.items[ring];
}
static inline size_t massing_prev(const struct massing *massing, size_t ring, size_t wall)
{
	return wall > massing->ring_first.items[ring] ? wall - 1 : massing->ring_first.items[ring + 1] - 1;
}

void facade_choose(struct massing *massing);

/* Sets walls' top; draws the roof and everything on it. */
void roof_build(struct massing *massing, struct shell *shell);
bool roof_pitched(struct massing *massing, struct shell *shell); /* false: no skeleton, nothing drawn */
bool roof_radial(struct massing *massing, struct shell *shell);  /* domes, cones; false: not star-shaped */
void roof_flat(struct massing *massing, struct shell *shell);
void roof_skillion(struct massing *massing, struct shell *shell);
void roof_turret(struct massing *massing, struct shell *shell, struct dvec2 at, double z, double half_m);

/* Takes overhangs off where eaves lines cannot meet; sets every wall's `eave`. */
void eaves_fit(struct massing *massing);
/* Front, underside, and caps where the eaves end; walls' `top` is where the underside meets them. */
struct eaves {
	double depth; /* of the front */
	int front;    /* its material: one tile high */
	const uint8_t *rgb;
	bool lid; /* closed on top, level; else the roof comes down to the front's upper edge */
};
void eaves_draw(const struct massing *massing, const struct eaves *eaves, struct shell *shell);

/* Triangles of the outline into massing->triangles, indices of walls' starts; falls back to the outer ring. */
void massing_triangulate(struct massing *massing);

void facade_build(struct massing *massing, struct shell *shell);
void facade_underside(struct massing *massing, struct shell *shell);
void facade_balconies(const struct massing *massing, const struct wall *wall, double first, double storey, int storeys,
	struct shell *shell);
void facade_awning(
	const struct massing *massing, const struct wall *wall, double s0, double s1, double z, struct shell *shell);
void facade_canopy(struct massing *massing, struct shell *shell);
float wall_ao(const struct massing *massing, const struct wall *wall, double z);

/* CityJSON surfaces. */
void building_surfaces(const struct building *building, const struct facade *facade, struct shell *shell);

/* Everything of one building; `shell` is cleared first. */
void building_shell(const struct plots *plots, uint32_t index, struct massing *massing, struct shell *shell);

#endif
