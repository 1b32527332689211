/* From every stretch a search over the nodes, shortest way first come or not: a node is looked at again when it is
 * reached with more room left. Cost: the streets within the horizon, for each stretch. */
#include "tools/far/resident.h"

#include <string.h>

#define VERTICES_PER_TRIANGLE 3u

uint64_t resident_stretch_bytes(const struct pkg_stretch *stretch, const struct pkg_cell cells[2])
{
	uint64_t sum = (uint64_t)stretch->local_triangles * 3 * sizeof(uint16_t);
	bool geometry = false;
	for (int way = 0; way < 2; way++) {
		sum += cells[way].impostor.raw_bytes;
		geometry = geometry || cells[way].kind == PKG_CELL_GEOMETRY;
	}
	if (geometry)
		sum += (uint64_t)stretch->pvs_triangles * 3 * sizeof(uint16_t) +
			   (uint64_t)stretch->pvs_triangles * VERTICES_PER_TRIANGLE * sizeof(struct pkg_mesh_vertex);
	return sum;
}

struct search {
	const struct pkg_graph *net;
	const uint32_t *first;
	const struct far_sections *sections;
	uint64_t *bytes; /* of stretches */
	double *room_m;  /* by node, in this search */
	uint32_t *stamp; /* by stretch: the search that found it */
	uint32_t run;
	ARRAY(uint32_t) touched; /* nodes */
	ARRAY(uint32_t) found;   /* stretches */
	uint64_t sum;
};

static void find(struct search *search, uint32_t stretch)
{
	if (search->stamp[stretch] == search->run)
		return;
	search->stamp[stretch] = search->run;
	search->sum += search->bytes[stretch];
	ARRAY_PUSH(&search->found, stretch);
}

static void walk_node(struct search *search, uint32_t node, double room_m);

/* Along a half-edge from a place on it, until the room is used up. */
static void walk_half(struct search *search, uint32_t half, uint32_t from_mm, double room_m)
{
	const struct pkg_edge *edge = &search->net->edges[half / 2];
	bool back = half & 1;
	uint32_t low = search->first[half / 2], high = search->first[half / 2 + 1];
	for (uint32_t n = low; n < high; n++) {
		uint32_t i = back ? high - 1 - (n - low) : n;
		const struct pkg_stretch *stretch = &search->sections->stretches.items[i];
		double begins = back ? (double)from_mm - stretch->to_mm : (double)stretch->from_mm - from_mm;
		double ends = back ? (double)from_mm - stretch->from_mm : (double)stretch->to_mm - from_mm;
		if (ends >= 0.0 && begins <= room_m * 1e3)
			find(search, i);
	}
	double left = room_m - (back ? (double)from_mm : (double)edge->length_mm - from_mm) * 1e-3;
	if (left > 0.0)
		walk_node(search, search->net->halves[half ^ 1].origin, left);
}

static void walk_node(struct search *search, uint32_t node, double room_m)
{
	if (search->room_m[node] >= room_m)
		return;
	if (search->room_m[node] < 0.0)
		ARRAY_PUSH(&search->touched, node);
	search->room_m[node] = room_m;
	const struct pkg_node *at = &search->net->nodes[node];
	for (uint32_t i = 0; i < at->out_count; i++) {
		uint32_t half = search->net->outs[at->first_out + i];
		walk_half(search, half, half & 1 ? search->net->edges[half / 2].length_mm : 0, room_m);
	}
}

static void search_from(struct search *search, uint32_t stretch)
{
	const struct pkg_stretch *at = &search->sections->stretches.items[stretch];
	for (size_t i = 0; i < search->touched.count; i++)
		search->room_m[search->touched.items[i]] = -1.0;
	search->touched.count = search->found.count = 0;
	search->sum = 0;
	search->run++;
	find(search, stretch);
	walk_half(search, 2 * at->edge, at->to_mm, RESIDENT_AHEAD_M);
	walk_half(search, 2 * at->edge + 1, at->from_mm, RESIDENT_AHEAD_M);
}

void resident_bound(const struct pkg_graph *net, const uint32_t *first, const struct far_sections *sections,
	uint64_t limit_bytes, struct resident *out)
{
	struct pool pool = { 0 };
	uint32_t count = (uint32_t)sections->stretches.count;
	struct search search = { .net = net,
		.first = first,
		.sections = sections,
		.bytes = POOL_ARRAY(&pool, uint64_t, count + 1),
		.room_m = POOL_ARRAY(&pool, double, net->node_count + 1),
		.stamp = POOL_ARRAY(&pool, uint32_t, count + 1) };
	for (uint32_t i = 0; i < net->node_count; i++)
		search.room_m[i] = -1.0;
	for (uint32_t i = 0; i < count; i++)
		search.bytes[i] = resident_stretch_bytes(&sections->stretches.items[i], &sections->cells.items[2 * (size_t)i]);
	out->bound_bytes = 0;
	out->worst = PKG_NONE;
	out->over_count = 0;
	for (uint32_t i = 0; i < count; i++) {
		search_from(&search, i);
		if (search.sum > out->bound_bytes || out->worst == PKG_NONE) {
			out->bound_bytes = search.sum;
			out->worst = i;
		}
		if (!limit_bytes || search.sum <= limit_bytes)
			continue;
		out->over_count++;
		for (size_t k = 0; k < search.found.count && out->over; k++)
			out->over[search.found.items[k]] = 1;
	}
	ARRAY_FINISH(&search.touched);
	ARRAY_FINISH(&search.found);
	pool_finish(&pool);
}
