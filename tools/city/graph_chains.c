/*
 * Segments into edges: a chain runs on through vertices where exactly two segments meet that are the same street in
 * every respect. Edges run along their way's nodes where they can, so that a one-way street is PKG_EDGE_FORWARD.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/city/graph_net.h"

struct link {
	uint32_t segment;
	bool against; /* walked from b to a */
};
typedef ARRAY(struct link) link_array;

struct chains {
	const struct net *net;
	struct graph_data *out;
	struct net_stars stars;
	bool *used;        /* by segment */
	uint32_t *node_of; /* by vertex */
	index_array way_of_half;
	uint32_t *name_slots; /* open hash table into out->names, index + 1 */
	size_t name_mask;
};

static bool same_text(const char *a, const char *b)
{
	return a == b || (a && b && !strcmp(a, b));
}

static bool same_street(const struct way *a, const struct way *b)
{
	return a->street_class == b->street_class && a->bridge == b->bridge && a->tunnel == b->tunnel &&
		   a->passage == b->passage && a->roundabout == b->roundabout && a->link == b->link &&
		   a->is_private == b->is_private && a->lit == b->lit && a->width_m == b->width_m &&
		   a->speed_kmh == b->speed_kmh && a->speed_posted == b->speed_posted && a->surface == b->surface &&
		   same_text(a->name, b->name) && same_text(a->ref, b->ref);
}

/* Permissions, lanes and sidewalks as they are met walking along the link. */
struct along {
	bool forward, backward, sidewalk_left, sidewalk_right;
	int lanes_forward, lanes_backward;
};

static struct along along(const struct net *net, struct link link)
{
	const struct net_segment *s = &net->segments.items[link.segment];
	const struct way *w = &net->city->ways.items[s->way];
	if (link.against)
		return (struct along){ s->backward, s->forward, w->sidewalk_right, w->sidewalk_left, w->lanes_backward,
			w->lanes_forward };
	return (struct along){ s->forward, s->backward, w->sidewalk_left, w->sidewalk_right, w->lanes_forward,
		w->lanes_backward };
}

static bool runs_on(const struct net *net, struct link from, struct link to)
{
	const struct net_segment *s = &net->segments.items[from.segment], *t = &net->segments.items[to.segment];
	struct along a = along(net, from), b = along(net, to);
	return s->level == t->level && a.forward == b.forward && a.backward == b.backward &&
		   a.sidewalk_left == b.sidewalk_left && a.sidewalk_right == b.sidewalk_right &&
		   a.lanes_forward == b.lanes_forward && a.lanes_backward == b.lanes_backward &&
		   same_street(&net->city->ways.items[s->way], &net->city->ways.items[t->way]);
}

static uint32_t end_of(const struct net *net, struct link link)
{
	const struct net_segment *s = &net->segments.items[link.segment];
	return link.against ? s->a : s->b;
}

static uint32_t start_of(const struct net *net, struct link link)
{
	const struct net_segment *s = &net->segments.items[link.segment];
	return link.against ? s->b : s->a;
}

/* The link after this one, if its chain goes on. */
static bool next_link(const struct chains *chains, struct link link, struct link *next)
{
	uint32_t at = end_of(chains->net, link), first = chains->stars.first[at];
	if (chains->net->vertices.items[at].keep || chains->stars.first[at + 1] - first != 2)
		return false;
	uint32_t other = chains->stars.segments[first];
	if (other == link.segment)
		other = chains->stars.segments[first + 1];
	*next = (struct link){ other, chains->net->segments.items[other].b == at };
	return runs_on(chains->net, link, *next);
}

/* The whole chain around a segment; a closed one starts at the segment itself. */
static void walk_chain(const struct chains *chains, uint32_t segment, link_array *chain)
{
	struct link start = { segment, true }, next;
	chain->count = 0;
	for (struct link back = start; next_link(chains, back, &next); back = next) {
		if (next.segment == segment)
			break;
		start = next;
	}
	struct link link = { start.segment, !start.against };
	uint32_t first = link.segment;
	ARRAY_PUSH(chain, link);
	for (; next_link(chains, link, &next) && next.segment != first; link = next)
		ARRAY_PUSH(chain, next);
}

static uint32_t intern(struct chains *chains, const char *text)
{
	if (!text || !*text)
		return 0;
	uint64_t hash = 0;
	for (const char *c = text; *c; c++)
		hash = hash_u64(hash ^ (uint8_t)*c) + 1;
	size_t slot = (size_t)hash & chains->name_mask;
	for (; chains->name_slots[slot]; slot = (slot + 1) & chains->name_mask)
		if (!strcmp(chains->out->names.items[chains->name_slots[slot] - 1], text))
			return chains->name_slots[slot];
	ARRAY_PUSH(&chains->out->names, text);
	return chains->name_slots[slot] = (uint32_t)chains->out->names.count;
}

static uint32_t node_at(struct chains *chains, uint32_t vertex)
{
	if (chains->node_of[vertex] != PKG_NONE)
		return chains->node_of[vertex];
	const struct net_vertex *v = &chains->net->vertices.items[vertex];
	uint32_t node = (uint32_t)chains->out->nodes.count;
	ARRAY_PUSH(&chains->out->nodes,
		(struct pkg_node){ .pos_mm = { v->x, v->y, (int32_t)lround(v->z * 1000.0) }, .flags = v->flags });
	return chains->node_of[vertex] = node;
}

static void add_point(struct chains *chains, uint32_t vertex)
{
	const struct net_vertex *v = &chains->net->vertices.items[vertex];
	ARRAY_PUSH(&chains->out->points, (struct pkg_point){ { v->x, v->y, (int32_t)lround(v->z * 1000.0) } });
}

static int at_most(int value, int limit)
{
	return value < 0 ? 0 : value > limit ? limit : value;
}

static uint16_t flags_of(const struct way *way, struct along along, bool off_plane)
{
	uint32_t flags = (along.forward ? PKG_EDGE_FORWARD : 0u) | (along.backward ? PKG_EDGE_BACKWARD : 0u) |
					 (way->bridge ? PKG_EDGE_BRIDGE : 0u) | (way->tunnel ? PKG_EDGE_TUNNEL : 0u) |
					 (way->roundabout ? PKG_EDGE_ROUNDABOUT : 0u) | (off_plane ? PKG_EDGE_OFF_PLANE : 0u) |
					 (way->link ? PKG_EDGE_LINK : 0u) | (way->is_private ? PKG_EDGE_PRIVATE : 0u) |
					 (way->lit ? PKG_EDGE_LIT : 0u);
	return (uint16_t)flags;
}

static void add_edge(struct chains *chains, const link_array *chain)
{
	const struct net *net = chains->net;
	struct link first = chain->items[0], last = chain->items[chain->count - 1];
	const struct net_segment *head = &net->segments.items[first.segment];
	const struct way *way = &net->city->ways.items[head->way];
	struct along lanes = along(net, first);
	uint32_t first_point = (uint32_t)chains->out->points.count;
	bool off_plane = false;
	double length_m = 0.0;
	add_point(chains, start_of(net, first));
	for (size_t i = 0; i < chain->count; i++) {
		const struct net_segment *s = &net->segments.items[chain->items[i].segment];
		add_point(chains, end_of(net, chain->items[i]));
		off_plane |= s->off_plane;
		length_m += net_length(net, s);
		chains->used[chain->items[i].segment] = true;
	}
	uint32_t from = node_at(chains, start_of(net, first)), to = node_at(chains, end_of(net, last));
	ARRAY_PUSH(&chains->out->halves, (struct pkg_half){ .origin = from });
	ARRAY_PUSH(&chains->out->halves, (struct pkg_half){ .origin = to });
	ARRAY_PUSH(&chains->way_of_half, head->way);
	ARRAY_PUSH(&chains->way_of_half, net->segments.items[last.segment].way);
	uint32_t name = intern(chains, way->name), ref = intern(chains, way->ref);
	ARRAY_PUSH(
		&chains->out->edges, (struct pkg_edge){
								 .first_point = first_point,
								 .point_count = (uint32_t)chain->count + 1,
								 .length_mm = (uint32_t)fmax(1.0, round(length_m * 1000.0)),
								 .name = name,
								 .ref = ref,
								 .flags = flags_of(way, lanes, off_plane),
								 .width_mm = (uint16_t)at_most((int)lround(fmin(way->width_m, 65.0) * 1000.0), 65535),
								 .street_class = (uint8_t)way->street_class,
								 .lanes_forward = (uint8_t)at_most(lanes.lanes_forward, 255),
								 .lanes_backward = (uint8_t)at_most(lanes.lanes_backward, 255),
								 .speed_kmh = (uint8_t)at_most(way->speed_kmh, 255),
								 .speed_posted = way->speed_posted,
								 .layer = head->level,
								 .source_id = way->id,
							 });
}

static void turn_round(link_array *chain)
{
	for (size_t i = 0, j = chain->count; i < j--; i++) {
		struct link swap = chain->items[i];
		chain->items[i] = (struct link){ chain->items[j].segment, !chain->items[j].against };
		if (i != j)
			chain->items[j] = (struct link){ swap.segment, !swap.against };
	}
}

void chains_build(struct net *net, struct graph_data *out, uint32_t **node_of, uint32_t **way_of_half)
{
	struct chains chains = { .net = net, .out = out, .name_mask = 1023 };
	link_array chain = { 0 };
	size_t capacity = 0;
	while (chains.name_mask < net->city->ways.count * 4)
		chains.name_mask = chains.name_mask * 2 + 1;
	chains.name_slots = array_grow(NULL, &capacity, chains.name_mask + 1, sizeof(uint32_t));
	memset(chains.name_slots, 0, (chains.name_mask + 1) * sizeof(uint32_t));
	capacity = 0;
	chains.used = array_grow(NULL, &capacity, net->segments.count + 1, sizeof(bool));
	memset(chains.used, 0, (net->segments.count + 1) * sizeof(bool));
	capacity = 0;
	chains.node_of = array_grow(NULL, &capacity, net->vertices.count + 1, sizeof(uint32_t));
	memset(chains.node_of, 0xff, (net->vertices.count + 1) * sizeof(uint32_t)); /* PKG_NONE */
	net_stars_init(&chains.stars, net, NET_DRIVABLE);
	for (uint32_t i = 0; i < net->segments.count; i++) {
		if (chains.used[i] || !net->segments.items[i].drivable)
			continue;
		walk_chain(&chains, i, &chain);
		if (chain.items[0].against)
			turn_round(&chain);
		add_edge(&chains, &chain);
	}
	net_stars_finish(&chains.stars);
	ARRAY_FINISH(&chain);
	array_free(chains.name_slots);
	array_free(chains.used);
	*node_of = chains.node_of;
	*way_of_half = chains.way_of_half.items;
}
