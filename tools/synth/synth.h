/*
 * A city made up: streets, blocks and buildings from a seed, written as OSM. The steps, each in its own file, run in
 * the order in which they are declared; the same options give the same bytes. Private to tools/synth.
 *
 * The plan is a lattice in plan coordinates: s along the river, t across it. plan_place() bends it into the plane, so
 * that the quays follow the river and no street is quite straight. The streets go through the same graph_build() as
 * real data, so what is written crosses nothing without a node, and its blocks are exactly those that a bake will find.
 */
#ifndef BLVD_TOOLS_SYNTH_SYNTH_H
#define BLVD_TOOLS_SYNTH_SYNTH_H

#include <stdbool.h>

#include "platform/base/rng.h"
#include "tools/bake/bake.h"
#include "tools/city/graph.h"
#include "tools/read/shape.h"
#include "tools/synth/osm_doc.h"

struct synth_options {
	uint64_t seed;
	double width_m, height_m;
	double density; /* 1: as planned; more: narrower lots, more trees */
};

/* A street in the making; its index + 1 is the id of its way in synth->city. */
struct street {
	const char *surface; /* NULL: asphalt */
	bool trees;
};

enum block_use {
	BLOCK_NONE, /* not a block: the river, tunnels */
	BLOCK_OLD,
	BLOCK_PERIMETER,
	BLOCK_DOWNTOWN,
	BLOCK_SLABS,
	BLOCK_VILLAS,
	BLOCK_INDUSTRY, /* with the railway through it */
	BLOCK_PARK,
	BLOCK_WOOD,
	BLOCK_SQUARE,
	BLOCK_LANDMARK, /* taken */
};

struct block {
	uint32_t face;
	enum block_use use;
	struct polygon land; /* inside the sidewalks; the largest piece */
	double area_m2;
	struct dvec2 middle; /* of the largest circle in it */
	double room_m;       /* its radius */
	double centrality;   /* 0 at the edge of the city, 1 in its middle */
};

struct lattice_line {
	double at;
	int rank; /* 0 street, 1 secondary, 2 arterial */
	const char *name;
};

struct plan {
	bool river, railway, old_town, park;
	double river_half_m, quay_m; /* from the river's middle: bank, middle of the quay street */
	ARRAY(struct lattice_line) s, t;
	size_t rail_column; /* between s[rail_column] and the next */
	size_t south_quay, north_quay;
	struct dvec2 old_middle; /* plan coordinates */
	double old_radius_m;
	struct dvec2 downtown; /* plane */
	double downtown_radius_m;
	size_t park_s0, park_s1, park_t0, park_t1; /* lattice lines around it */
	double phase[8];
};

struct synth {
	struct synth_options options;
	struct plan plan;
	struct city city; /* its streets */
	struct report report;
	ARRAY(struct street) streets;
	struct graph_data graph;
	struct pkg_graph view;
	ARRAY(struct block) blocks; /* by face */
	struct shaper shaper;
	struct osm_doc *doc;
	ARRAY(struct dvec2) rail; /* its middle line */
	uint64_t names_used;
};

static inline struct rng synth_rng(const struct synth *synth, uint64_t what, uint64_t index)
{
	return rng_seed(hash_u64(synth->options.seed * UINT64_C(0x9E3779B97F4A7C15) + hash_u64(what * 1000003 + index)));
}

/* plan.c: the lattice, the river, where things are. */
void plan_make(struct synth *synth);
struct dvec2 plan_place(const struct plan *plan, double s, double t);
/* Its inverse. */
struct dvec2 plan_unplace(const struct plan *plan, struct dvec2 at);
/* 0 on the ring around the old town, negative inside, m. */
double plan_old_town(const struct plan *plan, double s, double t);
double plan_centrality(const struct synth *synth, struct dvec2 at);

/* names.c: a new street name each time; `rank` 3 is a lane of the old town, 4 a quay, 5 a way through villas. */
const char *name_street(struct synth *synth, int rank);

/* streets.c: ways of synth->city, then the graph. */
void streets_make(struct synth *synth);
struct street_kind {
	int street_class;
	double width_m;
	int lanes; /* both ways together */
	int speed_kmh;
	bool bridge, tunnel, roundabout, oneway;
	struct street street;
};
/* `ids`: of the two ends, 0 for an end of its own. */
void street_add(struct synth *synth, const struct street_kind *kind, const char *name, const struct dvec2 *points,
	size_t count, int64_t id_from, int64_t id_to);
/* streets_old.c: square, radials and rings. */
void streets_old_town(struct synth *synth);
/* streets_write.c: ways, signals, crossings, restrictions and street trees into the document. */
void streets_write(struct synth *synth);
struct dvec2 street_point(const struct synth *synth, uint32_t half, uint32_t index);

/* blocks_make.c: the faces, their land and their use. */
void blocks_make(struct synth *synth);
void blocks_finish(struct synth *synth);

/* river.c, railway.c, park.c (parks, woods, squares): areas, lines and trees into the document. */
void river_write(struct synth *synth);
void railway_plan(struct synth *synth);
void railway_write(struct synth *synth);
void park_write(struct synth *synth, struct block *block);
void square_write(struct synth *synth, struct block *block);
void wood_write(struct synth *synth, struct block *block);
void outskirts_write(struct synth *synth);
void tree_write(struct synth *synth, struct dvec2 at, struct rng *rng, double height_m);
/* `per_hectare` trees at random in a polygon. */
void trees_scatter(struct synth *synth, const struct polygon *in, double per_hectare, struct rng *rng, double height_m);

/* landmarks.c: takes blocks for the cathedral, the opera, the town hall, churches and the television tower. */
void landmarks_write(struct synth *synth);

/* houses.c: buildings of one block by its use. */
void houses_write(struct synth *synth, struct block *block);

/* building_write.c */
struct house {
	const char *kind; /* building=* */
	double levels;
	double height_m, min_height_m; /* height_m: top of the roof */
	const char *roof_shape;
	double roof_height_m;
	const char *wall_colour, *wall_material, *roof_colour, *roof_material;
	const char *name;
	const char *shop; /* shop=* */
	bool part;
	const char *key, *value; /* one more tag, or NULL */
	bool ridge_across;
};
void building_write(struct synth *synth, const struct dvec2 *points, size_t count, const struct house *house);
void building_write_polygon(struct synth *synth, const struct polygon *polygon, const struct house *house);
void area_write(
	struct synth *synth, const struct polygon *polygon, const char *key, const char *value, const char *name);
const char *pick(struct rng *rng, const char *const *from, size_t count);
#define PICK(rng, list) pick(rng, list, sizeof(list) / sizeof((list)[0]))

/* lots.c: a block cut along its sides. */
struct lot {
	struct dvec2 points[8]; /* counter-clockwise, the street side first */
	size_t count;
	bool corner;
	struct dvec2 front_a, front_b; /* of its street side */
};
typedef ARRAY(struct lot) lot_array;
struct lot_rule {
	double depth_m, least_m, most_m, corner_m; /* of the row, of a lot's front, of the front of a corner to each side */
};
/* False when the block is too narrow or too crooked. `yard` is the ring inside the row, in the pool. */
bool lots_around(struct pool *pool, const struct ring *block, const struct lot_rule *rule, struct rng *rng,
	lot_array *lots, struct ring *yard);

/* rows.c: stripes across a block, cut to it, in pieces no longer than piece_m. */
void rows_across(struct synth *synth, const struct polygon *in, double angle, double depth_m, double gap_m,
	double piece_m, double least_m2, polygon_array *out);
/* Direction of the longest side, radians from east. */
double longest_side(const struct ring *ring);
struct dvec2 turned(struct dvec2 v, double angle);

/* terrain.c: a hill in the north-west as a GeoTIFF. Returns 0 or -errno after logging one line. */
int terrain_write(const struct synth *synth, const char *path);

/* All steps; the caller writes and frees synth->doc by synth_finish(). */
void synth_make(struct synth *synth, const struct synth_options *options);
void synth_finish(struct synth *synth);

#endif
