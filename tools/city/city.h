/*
 * The city in memory while it is baked: what the readers found, mended, in the city's metric frame
 * (platform/base/geo.h: x east, y north, metres, double). Readers fill it (tools/read), later steps refine it (heights,
 * graph, blocks), generators read it. Everything is owned by `city->pool` or by the arrays themselves; city_finish()
 * frees it all.
 */
#ifndef BLVD_TOOLS_CITY_CITY_H
#define BLVD_TOOLS_CITY_CITY_H

#include <stdbool.h>
#include <stdint.h>

#include "assets/pkg_format.h"
#include "platform/base/geo.h"
#include "tools/city/pool.h"
#include "tools/city/report.h"

/* A simple closed ring without the repeated first point. Outer rings are counter-clockwise, holes clockwise. */
struct ring {
	struct dvec2 *points;
	size_t count;
};

struct polygon {
	struct ring outer;
	struct ring *holes;
	size_t hole_count;
};

/* Colour as the data says it, or `given` false. sRGB. */
struct colour {
	uint8_t rgb[3];
	bool given;
};

/* Ways that are drawn but cars do not drive follow the drivable classes of enum pkg_street_class. */
enum way_class {
	WAY_FOOT = PKG_STREET_CLASS_COUNT, /* footway, path, sidewalk of its own */
	WAY_PEDESTRIAN,                    /* pedestrian street */
	WAY_CYCLE,
	WAY_STEPS,
	WAY_TRACK,
	WAY_RAIL,
	WAY_TRAM,
};

enum way_surface { SURFACE_ASPHALT, SURFACE_PAVED, SURFACE_COBBLE, SURFACE_GRAVEL, SURFACE_GROUND };

struct way_node {
	int64_t id; /* OSM node; shared ids are shared junctions; negative ids were made by a mend */
	struct dvec2 at;
	uint32_t flags; /* enum pkg_node_flags, as the data has them */
};

struct way {
	int64_t id;
	struct way_node *nodes;
	size_t node_count; /* >= 2 */
	int street_class;  /* enum pkg_street_class or enum way_class */
	bool drivable;     /* part of the street graph */
	bool bridge, tunnel, roundabout, link, is_private, lit;
	bool passage; /* tunnel=building_passage or covered=*: at ground level under a building; `tunnel` is then false */
	bool is_sidewalk, is_crossing; /* a footway that is a street's own sidewalk, or crosses one */
	int oneway;                    /* 0 both ways, 1 along the nodes, -1 against them */
	int layer;
	int lanes_forward, lanes_backward; /* > 0 where driving is allowed; inferred by class where missing */
	double width_m;                    /* carriageway (or path); inferred from lanes and class where missing */
	int speed_kmh;                     /* limit, inferred by class where missing */
	bool speed_posted;
	bool sidewalk_left, sidewalk_right; /* drawn when the street is built up; default by class */
	enum way_surface surface;
	const char *name; /* UTF-8 or NULL */
	const char *ref;  /* or NULL */
	double *z_m;      /* surface at each node, in the pool; set by graph_build() on ways that leave the ground
						 (bridges, tunnels, their ramps) and are not drivable; NULL: on the ground */
};

struct restriction {
	int64_t from_way, via_node, to_way;
	bool only; /* `only_...`: everything else at this node is forbidden; else this move is */
};

enum building_kind {
	BUILDING_HOUSE,      /* detached, terrace, villa */
	BUILDING_APARTMENTS, /* the default of a city centre */
	BUILDING_COMMERCIAL, /* offices */
	BUILDING_RETAIL,
	BUILDING_INDUSTRIAL,
	BUILDING_CIVIC,  /* school, hospital, public, university, station */
	BUILDING_CHURCH, /* church, cathedral, mosque, temple */
	BUILDING_TOWER,  /* tower, campanile, chimney, water tower */
	BUILDING_GARAGE, /* garages, sheds, huts, carports */
	BUILDING_ROOF,   /* a roof on posts: canopy, petrol station */
	BUILDING_GREENHOUSE,
};

enum roof_shape {
	ROOF_UNKNOWN,
	ROOF_FLAT,
	ROOF_GABLED,
	ROOF_HIPPED,
	ROOF_HALF_HIPPED,
	ROOF_PYRAMIDAL,
	ROOF_SKILLION,
	ROOF_DOME,
	ROOF_ONION,
	ROOF_MANSARD,
	ROOF_GAMBREL,
	ROOF_ROUND,
	ROOF_CONE,
};

enum wall_material {
	WALL_UNKNOWN,
	WALL_PLASTER,
	WALL_BRICK,
	WALL_STONE,
	WALL_CONCRETE,
	WALL_GLASS,
	WALL_METAL,
	WALL_WOOD,
};

enum roof_material {
	ROOFING_UNKNOWN,
	ROOFING_TILES,
	ROOFING_SLATE,
	ROOFING_METAL,
	ROOFING_COPPER,
	ROOFING_GRAVEL,
	ROOFING_CONCRETE,
	ROOFING_GLASS,
	ROOFING_GRASS
};

enum height_source {
	HEIGHT_TAGGED, /* height=* or the height field of a building set */
	HEIGHT_LEVELS, /* building:levels */
	HEIGHT_PARTS,  /* the tallest of its parts */
	HEIGHT_NEIGHBOURS,
	HEIGHT_KIND, /* kind and footprint alone */
	HEIGHT_SOURCE_COUNT,
};

struct building {
	int64_t id; /* OSM way, or minus the relation; record number for other sets */
	struct polygon footprint;
	enum building_kind kind;
	bool kind_given;     /* false: building=yes and nothing else told the kind; BUILDING_APARTMENTS until inferred */
	bool is_part;        /* building:part */
	bool has_parts;      /* an outline whose parts are drawn instead of it */
	uint32_t outline;    /* for a part: index of the outline it belongs to, or PKG_NONE */
	bool landmark;       /* church, tower, monument, or far taller than its neighbours */
	bool shop;           /* shop front at ground level: retail, or in a commercial street */
	double height_m;     /* top of the roof above the ground; 0: not known yet */
	bool eaves_height;   /* height_m is up to the eaves so far; heights_infer() adds the roof */
	double min_height_m; /* bottom of the walls above the ground */
	double levels;       /* storeys below the roof; 0: not known */
	double min_level;
	enum height_source height_source;
	enum roof_shape roof_shape; /* ROOF_UNKNOWN until inferred */
	double roof_height_m;       /* part of height_m; 0: not known */
	double roof_direction_deg;  /* compass bearing that the roof falls to; NAN: not given */
	bool ridge_across;          /* roof:orientation=across */
	struct colour wall_colour, roof_colour;
	enum wall_material wall_material;
	enum roof_material roof_material;
	const char *name;       /* UTF-8 or NULL */
	double ground_m;        /* set with the terrain: lowest ground under the footprint */
	uint32_t face;          /* block of the street graph, or PKG_NONE */
	double start_year;      /* 0: not given */
	struct dvec3 *walls_3d; /* CityJSON LoD2 surfaces, triangulated: 3 points a triangle, z in the city frame; NULL:
							   extrude the footprint */
	size_t wall_3d_count;   /* points */
};

enum area_kind {
	AREA_WATER,
	AREA_GRASS, /* grass, meadow, garden, village green */
	AREA_PARK,
	AREA_FOREST,
	AREA_PITCH,
	AREA_SAND,
	AREA_PARKING,
	AREA_PEDESTRIAN, /* squares */
	AREA_CEMETERY,
	AREA_CONSTRUCTION,
	AREA_RAILWAY,
	AREA_FARM,
	AREA_COMMERCIAL, /* landuse: not drawn by itself; tells shop streets */
	AREA_BRIDGE,     /* man_made=bridge outline */
	AREA_PIER,
	AREA_ROCK,
};

struct area {
	int64_t id;
	enum area_kind kind;
	struct polygon shape;
	int layer;
	const char *name;
};

/* Watercourses drawn as lines, walls and hedges. */
enum line_kind { LINE_RIVER, LINE_STREAM, LINE_WALL, LINE_HEDGE, LINE_FENCE };
struct line {
	int64_t id;
	enum line_kind kind;
	struct dvec2 *points;
	size_t count;
	double width_m;
	double height_m;
	bool tunnel;
	int layer;
};

struct tree {
	struct dvec2 at;
	float height_m, crown_radius_m; /* inferred where missing */
	bool needle;
	bool from_data; /* false: planted by the bake in forests and along tree rows */
};

struct terrain {
	struct pkg_height_grid grid; /* columns 0: flat */
	int32_t *height_mm;
};

struct city {
	struct pool pool;
	struct geo_frame frame;
	const char *name;
	const char *attribution;
	bool right_hand_traffic;
	struct dvec2 min, max; /* bounds of buildings and drivable ways */
	ARRAY(struct way) ways;
	ARRAY(struct restriction) restrictions;
	ARRAY(struct building) buildings;
	ARRAY(struct area) areas;
	ARRAY(struct line) lines;
	ARRAY(struct tree) trees;
	struct terrain terrain;
	struct report *report; /* borrowed */
};

void city_finish(struct city *city);

/* Ground height in m, linear on the triangles of struct pkg_height_grid; 0 without terrain. */
double city_ground(const struct city *city, struct dvec2 at);

/* Signed area in m^2, counter-clockwise positive. */
double ring_area(const struct ring *ring);
bool ring_contains(const struct ring *ring, struct dvec2 at);
bool polygon_contains(const struct polygon *polygon, struct dvec2 at);
void ring_bounds(const struct ring *ring, struct dvec2 *min, struct dvec2 *max);

#endif
