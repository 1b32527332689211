/*
 * The streets while graph_build() works on them: vertices and straight segments between them, in integer millimetres.
 * Private to graph_*.c. Ways that cars do not drive are in it too, for their heights; they are never part of the plane.
 */
#ifndef BLVD_TOOLS_CITY_GRAPH_NET_H
#define BLVD_TOOLS_CITY_GRAPH_NET_H

#include "tools/bake/bake.h"
#include "tools/city/graph.h"
#include "tools/city/line_grid.h"

struct net_vertex {
	int64_t id;       /* OSM node; 0: made here */
	int32_t x, y;     /* mm */
	uint32_t flags;   /* enum pkg_node_flags */
	bool keep;        /* stays a node of the graph although only two equal streets meet here */
	uint32_t same_as; /* itself, or the vertex that it was merged into */
	double z;         /* m; set by profile_solve() */
};

struct net_segment {
	uint32_t a, b;
	uint32_t way; /* into city->ways; a to b is along the way's nodes */
	int8_t level;
	bool drivable, forward, backward;
	bool off_plane;
	bool shallow; /* a short tunnel: stays on the ground under what is no street */
	bool fresh;   /* not yet compared with the others */
};

struct net {
	struct city *city;
	ARRAY(struct net_vertex) vertices;
	ARRAY(struct net_segment) segments; /* pieces of a way stay together and in order */
	uint32_t *id_slots;                 /* open hash table: vertex + 1 by OSM id */
	size_t id_mask;
};

/* Which segments meet at a vertex: stars->segments[first[v] .. first[v + 1]). */
struct net_stars {
	uint32_t *first, *segments;
};
enum net_kind { NET_DRIVABLE = 1, NET_OTHER = 2 };

struct net_crossing {
	uint32_t upper, lower; /* segments */
	double upper_t, lower_t;
};
typedef ARRAY(struct net_crossing) crossing_array;

/* Cut a segment at a vertex. */
struct net_cut {
	uint32_t segment, vertex;
};
typedef ARRAY(struct net_cut) cut_array;

void net_init(struct net *net, struct city *city);
void net_finish(struct net *net);
uint32_t net_vertex_add(struct net *net, int64_t id, int32_t x, int32_t y); /* id 0, or one not yet there */
uint32_t net_vertex_by_id(const struct net *net, int64_t id);               /* or PKG_NONE */
void net_stars_init(struct net_stars *stars, const struct net *net, unsigned kinds);
void net_stars_finish(struct net_stars *stars);
void net_apply_cuts(struct net *net, cut_array *cuts);
/* Vertex v becomes to[v]; segments without length go, the same stretch twice at one level becomes one. Returns how many
 * stretches were twice there. */
void net_merge_vertices(struct net *net, const uint32_t *to, bool count_duplicates);
struct line_mm net_line(const struct net *net, const struct net_segment *segment);
double net_length(const struct net *net, const struct net_segment *segment); /* m */

/* graph_split.c: ways into segments; ends that nearly touch are joined; ends at the border of the data are marked. */
void split_ways(struct net *net);
void split_mend_ends(struct net *net);
void split_mark_boundary(struct net *net);

/* graph_planar.c: nodes where streets of one level meet or cross. Faults are counted when asked for. */
void planar_cut(struct net *net, bool count_faults);
/* Marks off-plane segments until none of the others meet but at shared vertices, and lists the places where ways pass
 * over each other. */
void planar_levels(struct net *net, crossing_array *crossings);

/* graph_profile.c: vertex heights. profile_refine() first adds the vertices that the heights need. */
void profile_refine(struct net *net);
void profile_solve(struct net *net, const crossing_array *crossings, bool count_faults);
void profile_other_ways(struct net *net); /* writes way.z_m */

/* graph_chains.c: segments into edges and nodes. `node_of` and `ways_at` are for graph_turns.c: node of a vertex or
 * PKG_NONE; way that a half-edge leaves its origin by. The caller frees both arrays. */
void chains_build(struct net *net, struct graph_data *out, uint32_t **node_of, uint32_t **way_of_half);

/* graph_faces.c: out-lists, next and previous, faces, components. */
void faces_build(struct graph_data *graph);
void faces_components(struct graph_data *graph, struct report *report);

/* graph_turns.c */
void turns_build(const struct net *net, struct graph_data *graph, const uint32_t *node_of, const uint32_t *way_of_half);

#endif
