/*
 * The steps of a bake, in order (DESIGN "Baking" 1 to 4, and what near geometry needs). Each step reads what the ones
 * before it left in `struct city`, counts its faults in city->report, and is deterministic: same input, same output,
 * whatever the threads.
 */
#ifndef BLVD_TOOLS_BAKE_BAKE_H
#define BLVD_TOOLS_BAKE_BAKE_H

#include "assets/pkg.h"
#include "tools/bake/materials.h"
#include "tools/bake/mesh.h"
#include "tools/city/city.h"

/* tools/read: all inputs into one city. Returns 0, -errno, or -EBADMSG after logging one line that names file and
 * place. */
struct read_options {
	const char *const *inputs; /* .osm .osm.pbf .osm.gz .osm.bz2 .city.json .json, .gz of these */
	size_t input_count;
	const char *const *building_files; /* --buildings, GDAL; may be empty */
	size_t building_file_count;
	const char *height_field;         /* --height-field, or NULL: looks for usual names */
	const char *const *terrain_files; /* --terrain; may be empty */
	size_t terrain_file_count;
	const double *bounds; /* --bbox: west, south, east, north degrees; or NULL */
	const char *name;     /* --name, or NULL: from the first file's name */
};
int read_city(struct city *city, const struct read_options *options);

/* tools/city/heights.c: heights, roof shapes and kinds that the data lacks; the rule is documented there. */
void heights_infer(struct city *city);

/* tools/city/graph.c: the street graph; owned arrays in the on-disk form. */
struct graph_data {
	ARRAY(struct pkg_node) nodes;
	ARRAY(uint32_t) outs;
	ARRAY(struct pkg_half) halves;
	ARRAY(struct pkg_edge) edges; /* name, ref: index into `names` + 1 until written */
	ARRAY(struct pkg_point) points;
	ARRAY(struct pkg_face) faces;
	ARRAY(struct pkg_turn) turns;
	ARRAY(const char *) names; /* borrowed from the city */
};
void graph_build(struct city *city, struct graph_data *out);
void graph_data_finish(struct graph_data *graph);
struct pkg_graph graph_view(const struct graph_data *graph);

/* tools/city/blocks.c: building->face and ground_m; reports buildings that a street runs through. */
void blocks_assign(struct city *city, const struct pkg_graph *graph);

/* tools/bake/light_map.c: ambient occlusion from the buildings' heights, street light from the lamps. */
struct light_map {
	struct pkg_light_map header;
	uint8_t *texels; /* as the header's format says; owned */
	size_t bytes;
};
struct lamp {
	struct dvec3 at; /* of the light, city frame */
	float radius_m;
};
typedef ARRAY(struct lamp) lamp_array;
void light_map_bake(const struct city *city, const lamp_array *lamps, struct light_map *out);
/* Puts plain texels into blocks. */
void light_map_pack(struct light_map *map);
void light_map_finish(struct light_map *map);

/* tools/bake/ground_*.c: everything on the ground (streets, kerbs, markings, areas, water, bridges, tunnels,
 * furniture), trees in trees.c. `lamps` receives the street lamps. */
void ground_build(const struct city *city, const struct pkg_graph *graph, struct mesh_sink *sink, lamp_array *lamps);
void trees_build(const struct city *city, const struct pkg_graph *graph, struct mesh_sink *sink);

/* tools/bake/facade_*.c, roof_*.c: buildings. Sets AO per vertex. */
void buildings_build(const struct city *city, const struct pkg_graph *graph, struct mesh_sink *sink);

/* tools/bake/occluders.c: what hides what is behind it (PKG_OCCL). */
struct occluders {
	ARRAY(struct pkg_occluder) walls;
	uint32_t solid_count;
};
void occluders_build(const struct city *city, struct occluders *out);
void occluders_finish(struct occluders *occluders);

/* tools/bake/font.c: glyph atlas and shaped strings. `strings` are unique; text.string is the index into `strings`
 * until written. */
struct text_data {
	ARRAY(uint8_t) font; /* FONT section */
	ARRAY(struct pkg_text) texts;
	ARRAY(struct pkg_glyph_at) runs;
	ARRAY(const char *) strings; /* borrowed */
};
/* `font_files`: tried in order for each script; the first also gives the UI's characters. Returns 0 or -errno after
 * logging one line. */
int text_bake(const char *const *font_files, size_t font_file_count, const char *const *strings, size_t string_count,
	struct text_data *out);
void text_data_finish(struct text_data *text);
/* The readable fonts among the usual ones of Debian, in the order text_bake() wants; at most `capacity`. */
size_t text_default_fonts(const char **files, size_t capacity);

/* tools/bake/pkg_write.c: the whole package; written to PATH.part, synced, renamed. Any member may be NULL but graph
 * and city. */
struct pkg_content {
	const struct city *city;
	const struct graph_data *graph;
	const struct mesh_chunks *mesh;
	const struct materials *materials;
	const struct light_map *light_map;
	const struct text_data *text;
	const struct occluders *occluders;
	uint64_t source_hash;
};
int pkg_write(const char *path, const struct pkg_content *content);

#endif
