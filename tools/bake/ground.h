/*
 * What the ground_*.c files share. ground_plan.c turns the city and its graph into roads (stretches of street, path
 * and rail, each on the ground, on a deck or in a cut) and finds things by place. ground_tile.c makes the surface of a
 * tile from it; ground_structure.c decks, cuts and tubes; ground_marking.c paint; ground_furniture.c what stands
 * around.
 *
 * Heights: a carriageway lies on city_ground(). Everything else on land is KERB_M higher; water lies lower, behind
 * quay walls.
 */
#ifndef BLVD_TOOLS_BAKE_GROUND_H
#define BLVD_TOOLS_BAKE_GROUND_H

#include <geos_c.h>

#include "tools/bake/bake.h"
#include "tools/bake/bins.h"

#define KERB_M 0.12
#define RIVER_DROP_M 1.8
#define POND_DROP_M 0.25
#define DECK_THICKNESS_M 0.9
#define DECK_LOW_M 1.5    /* below this a deck lies in a pit of the ground */
#define TUBE_HEIGHT_M 4.7 /* from a tunnel's carriageway to its ceiling */
#define TUBE_COVER_M 5.1  /* deeper than this a tunnel is closed, else an open cut */
#define PIT_DROP_M 1.1    /* of the ground under low decks */
#define SLACK_M 0.15      /* a profile this near the ground is on it */

/* What a face of the ground is. The first that contains a place wins. */
enum ground_region {
	REGION_VOID, /* open cut: no ground */
	REGION_PIT,  /* under a low deck */
	REGION_ROAD, /* carriageways: REGION_ROAD to REGION_ROAD_GRAVEL */
	REGION_ROAD_OLD,
	REGION_ROAD_COBBLE,
	REGION_ROAD_GRAVEL,
	REGION_SIDEWALK,
	REGION_CYCLE,
	REGION_PATH,
	REGION_PATH_GRAVEL,
	REGION_STEPS,
	REGION_PEDESTRIAN, /* pedestrian streets and squares */
	REGION_RAIL,
	REGION_WATER,
	REGION_PARKING,
	REGION_PITCH,
	REGION_SAND,
	REGION_ROCK,
	REGION_GRASS,
	REGION_PARK,
	REGION_FOREST,
	REGION_FARM,
	REGION_CONSTRUCTION,
	REGION_RAILWAY,
	REGION_YARD, /* between the buildings of a block */
	REGION_OPEN, /* land that nothing is known of */
	REGION_COUNT,
};

struct region_look {
	enum material_id material;
	double level_m; /* above the terrain */
	uint8_t rgb[3];
};
extern const struct region_look region_looks[REGION_COUNT];

static inline bool region_is_road(enum ground_region region)
{
	return region >= REGION_ROAD && region <= REGION_ROAD_GRAVEL;
}

enum road_course {
	ROAD_GROUND,
	ROAD_DECK,
	ROAD_CUT,
	ROAD_ABSORBED, /* a walkway on a street's bridge: part of its deck; never stored */
};

/* A stretch of one street, path or rail track that takes one course. */
struct road {
	struct dvec3 *points;             /* z: surface */
	double *along;                    /* from the first point, horizontal */
	size_t count;                     /* >= 2 */
	double half_width_m;              /* of carriageway, path or ballast */
	double side_left_m, side_right_m; /* sidewalks */
	enum road_course course;
	enum ground_region region; /* on the ground */
	int street_class;          /* enum pkg_street_class or enum way_class */
	bool bridge, tunnel;
	bool starts_open, ends_open; /* off the ground: the street goes on beyond this end on the ground */
	bool start_joins, end_joins; /* another road of this course begins or ends here */
	uint32_t edge;               /* of the graph, or PKG_NONE */
	double edge_start_m;         /* where on the edge this stretch begins */
	const struct way *way;       /* that it comes from, or NULL */
	struct dvec2 min, max;       /* of the centre line */
};

/* Fills the corner between two streets of a junction. */
struct corner {
	struct dvec2 points[14];
	size_t count;
	enum ground_region region;
};

struct ground_area {
	const struct area *area;
	enum ground_region region;
	double size_m2;
	double water_z; /* flat water: its level; NAN: follows the ground */
	double drop_m;  /* water: below the ground */
	struct dvec2 min, max;
};

/* Crossings, signals, stop and give-way signs along a road. */
struct road_event {
	uint32_t road;
	double along_m;
	uint32_t flags;         /* one of enum pkg_node_flags */
	bool forward, backward; /* for whom: drivers along the points, against them */
};

struct road_segment {
	uint32_t road;
	uint32_t point; /* from this one to the next */
};

struct ground_plan {
	const struct city *city;
	const struct pkg_graph *graph;
	struct pool pool;
	ARRAY(struct road) roads;
	ARRAY(struct ground_area) areas; /* in order of precedence */
	const struct way **edge_ways;    /* by edge; NULL members where the way is not known */
	double *half_trim_m;             /* by half-edge: carriageway that it shares with others from its origin on */
	ARRAY(struct corner) corners;    /* rounded inner corners of junctions */
	struct bins corner_bins;         /* MESH_TILE_M */
	struct bins road_bins;           /* MESH_TILE_M */
	struct bins area_bins;           /* MESH_TILE_M */
	struct bins line_bins;           /* MESH_TILE_M: watercourses */
	struct bins building_bins;       /* 32 m */
	struct bins segment_bins;        /* 16 m: index into segments */
	ARRAY(struct road_segment) segments;
	ARRAY(struct road_event) events; /* by road, then along */
	float *coverage;                 /* share of built ground in squares of COVERAGE_STEP_M, smoothed */
	int32_t coverage_col0, coverage_row0, coverage_cols, coverage_rows;
	struct face_locator *blocks; /* NULL without streets */
	float *block_share;          /* of built ground, by face */
	struct dvec2 min, max;       /* of the ground that is built */
	bool has_terrain;
};

/* ground_events.c: fills events of a plan with roads; queries them. */
void ground_events_build(struct ground_plan *plan);
struct road_events {
	const struct road_event *items;
	size_t count;
};
struct road_events ground_events_of(const struct ground_plan *plan, uint32_t road);
/* The stretch of a road that is its own: behind and before the junctions at its ends. from > to: none. */
void ground_own_stretch(const struct ground_plan *plan, const struct road *road, double *from, double *to);
/* Where drivers stop before a place along a road: before the crossings next to it too. `forward`: they drive along. */
double ground_stop_place(const struct ground_plan *plan, uint32_t road, double along_m, bool forward);
#define CROSSING_HALF_M 1.6 /* of a zebra, along the road */

/* ground_roads.c: fills roads, corners and trims of a plan whose city, graph and coverage are set. */
void ground_roads_build(struct ground_plan *plan);

void ground_plan_build(struct ground_plan *plan, const struct city *city, const struct pkg_graph *graph);
void ground_plan_finish(struct ground_plan *plan);

/* Is the place on a carriageway of the ground, or within `margin_m` of one? Roads of `except` (an edge) do not count.
 */
bool ground_on_road(const struct ground_plan *plan, struct dvec2 at, double margin_m, uint32_t except);
/* The same for streets of any course whose surface is near the ground: nothing may stand there. */
bool ground_on_any_road(const struct ground_plan *plan, struct dvec2 at, double margin_m);
/* Distance to the nearest centre line of a street of a course, in its half widths; INFINITY beyond a few metres.
 * `z` (may be NULL) is the street's surface there. */
double ground_road_nearness(const struct ground_plan *plan, struct dvec2 at, enum road_course course, double *z);
/* As ground_on_road() for what is walked on, cycled on or railed. */
bool ground_on_path(const struct ground_plan *plan, struct dvec2 at, double margin_m);
/* Does a street for cars pass within about `reach_m`? What is farther is seen from afar only. */
bool ground_near_street(const struct ground_plan *plan, struct dvec2 at, double reach_m);
#define STREET_SIDE_M 40.0
/* Is the place inside a footprint that reaches the ground? */
bool ground_in_building(const struct ground_plan *plan, struct dvec2 at);
/* Is the neighbourhood? */
bool ground_is_built_up(const struct ground_plan *plan, struct dvec2 at);
/* Are the yards of the block around the place paved, rather than gardens? A whole block answers the same, but for
 * blocks too small or too large to tell. */
bool ground_block_is_paved(const struct ground_plan *plan, struct dvec2 at);
/* The area of a kind that contains the place, or NULL. */
const struct ground_area *ground_area_at(const struct ground_plan *plan, struct dvec2 at, enum ground_region region);
/* The area that shows at a place where no road or path is, or NULL. */
const struct ground_area *ground_top_area(const struct ground_plan *plan, struct dvec2 at);
double ground_water_z(const struct ground_plan *plan, const struct ground_area *area, struct dvec2 at);

/* Position and unit direction at a distance along a road, clamped to it. */
struct dvec3 road_at(const struct road *road, double along_m, struct dvec2 *direction);
static inline double road_length(const struct road *road)
{
	return road->along[road->count - 1];
}
/* The line at an offset to the left (negative: right), mitred; `out` has road->count points. */
void road_offset(const struct road *road, double left_m, struct dvec2 *out);

/*
 * Triangles from here and there, handed to a sink tile by tile and kind by kind. Texture coordinates may be anywhere;
 * they are moved by whole tiles when an object is written.
 */
struct soup_vertex {
	struct dvec3 at;
	struct vec3 normal;
	double u, v;
	float ao;
	uint8_t material;
	uint8_t rgb[3];
};
struct soup_triangle {
	uint32_t v[3];
	uint8_t pass, kind; /* enum pkg_pass, enum pkg_object_kind */
};
struct soup {
	ARRAY(struct soup_vertex) vertices;
	ARRAY(struct soup_triangle) triangles;
	uint8_t pass, kind; /* of what is added next */
	uint8_t material;
	uint8_t rgb[3];
	float ao;
};
void soup_finish(struct soup *soup);
/* Metres that one tile of a material's texture covers on horizontal surfaces. */
double material_scale(enum material_id material);
uint32_t soup_vertex(struct soup *soup, struct dvec3 at, struct vec3 normal, double u, double v);
/* Moves the texture of the vertices from `first` on by whole tiles, to start near 0: a surface that shares no vertices
 * with others may lie anywhere. */
void soup_rebase(struct soup *soup, uint32_t first);
void soup_triangle(struct soup *soup, uint32_t a, uint32_t b, uint32_t c);
/* Corners counter-clockwise seen from the front; flat. Texture by length and height (walls) or by the plane (floors).
 */
void soup_quad(struct soup *soup, struct dvec3 a, struct dvec3 b, struct dvec3 c, struct dvec3 d);
/* A wall over a -> b seen from the right of a -> b; bottom and top heights at both ends. */
void soup_wall(
	struct soup *soup, struct dvec2 a, struct dvec2 b, double a_low, double b_low, double a_high, double b_high);
/* An upright box: centre of its bottom, unit direction of its length, half sizes, height. No bottom. */
void soup_box(struct soup *soup, struct dvec3 bottom, struct dvec2 direction, double half_length, double half_width,
	double height);
/* Posts and two rails over a -> b, seen through and from both sides; z: of its foot. */
void soup_railing(struct soup *soup, struct dvec3 a, struct dvec3 b, double height);
/* A horizontal convex polygon, counter-clockwise, `lift_m` above the terrain and exactly parallel to it: cut along the
 * terrain's triangles. count <= 8. */
void soup_drape(struct soup *soup, const struct city *city, const struct dvec2 *points, size_t count, double lift_m);
/* Writes everything, in tiles of MESH_TILE_M, in a fixed order, and empties the soup. */
void soup_flush(struct soup *soup, struct mesh_sink *sink);

/* Polygons from GEOS as plain rings; even-odd over all of them. */
struct outline {
	ARRAY(struct dvec2) points;
	ARRAY(size_t) starts; /* of each ring; its end is the next start or points.count */
	struct dvec2 min, max;
};
void outline_finish(struct outline *outline);
bool outline_contains(const struct outline *outline, struct dvec2 at);
/* Adds the polygons in a GEOS geometry. */
void outline_add(struct outline *outline, GEOSContextHandle_t geos, const GEOSGeometry *geometry);

struct shape_line {
	GEOSGeometry *line;
	double radius_m;
	bool flat; /* flat ends; else round */
};

/* Buffers of lines by width, united. Faults are counted in `*faults`; what failed is left as its parts. */
struct shape_set {
	GEOSContextHandle_t geos;
	ARRAY(struct shape_line) lines;
	ARRAY(GEOSGeometry *) polygons;
	uint64_t *faults;
};
void shape_add_line(struct shape_set *set, const struct dvec2 *points, size_t count, double radius_m, bool flat);
/* A simple polygon, any direction, open ring. */
void shape_add_polygon(struct shape_set *set, const struct dvec2 *points, size_t count);
/* Unites and empties the set into `out`. */
void shape_unite(struct shape_set *set, struct outline *out);

/* The surface of one tile. Thread safe for different tiles and sinks. */
struct tile_faults {
	uint64_t mended, dropped;
};
void ground_tile_build(const struct ground_plan *plan, GEOSContextHandle_t geos, int32_t col, int32_t row,
	struct mesh_sink *sink, struct tile_faults *faults);
/* Horizontal ground around the data, out to the horizon. */
void ground_apron_build(const struct ground_plan *plan, struct soup *soup);

void ground_structures_build(
	const struct ground_plan *plan, GEOSContextHandle_t geos, struct soup *soup, struct tile_faults *faults);
/* Half the width of a deck or a cut, sidewalks included. */
double road_structure_half_width(const struct road *road);
/* The part of a cut that is open to the sky (for REGION_VOID), or of a deck that lies low (for REGION_PIT): polygons
 * over the road's stretch, added to `set`. */
void ground_structure_footprint(const struct ground_plan *plan, const struct road *road, struct shape_set *set);
void ground_markings_build(const struct ground_plan *plan, struct soup *soup);
void ground_furniture_build(const struct ground_plan *plan, struct soup *soup, lamp_array *lamps);
void ground_lines_build(const struct ground_plan *plan, struct soup *soup);

#endif
