/* Turn restrictions into forbidden pairs of half-edges. `only_` ones forbid every other way out of the node. */
#include <stdlib.h>

#include "tools/city/graph_net.h"

struct turns {
	const struct net *net;
	struct graph_data *graph;
	const uint32_t *way_of_half;
};

static bool may_drive(const struct graph_data *graph, uint32_t half)
{
	return graph->edges.items[half / 2].flags & (half & 1 ? PKG_EDGE_BACKWARD : PKG_EDGE_FORWARD);
}

static int64_t way_id(const struct turns *turns, uint32_t half)
{
	return turns->net->city->ways.items[turns->way_of_half[half]].id;
}

/* Half-edges that leave the node by a way; `arriving` ones are returned as the half-edges that come in by it. */
static size_t halves_by_way(const struct turns *turns, const struct pkg_node *node, int64_t way, bool arriving,
	uint32_t *out, size_t limit, bool *on_way)
{
	size_t count = 0;
	for (uint32_t i = 0; i < node->out_count; i++) {
		uint32_t half = turns->graph->outs.items[node->first_out + i];
		if (way_id(turns, half) != way)
			continue;
		*on_way = true;
		half ^= arriving ? 1u : 0u;
		if (may_drive(turns->graph, half) && count < limit)
			out[count++] = half;
	}
	return count;
}

static void forbid(struct turns *turns, uint32_t from, uint32_t to)
{
	ARRAY_PUSH(&turns->graph->turns, (struct pkg_turn){ from, to });
}

static void forbid_others(struct turns *turns, const struct pkg_node *node, uint32_t from, uint32_t allowed)
{
	for (uint32_t i = 0; i < node->out_count; i++) {
		uint32_t half = turns->graph->outs.items[node->first_out + i];
		if (half != allowed && may_drive(turns->graph, half))
			forbid(turns, from, half);
	}
}

/* False when the restriction names streets that do not meet here, or that pass through so that it is not clear which
 * side is meant. A move that no one may make anyway is no fault. */
static bool resolve(struct turns *turns, const struct restriction *rule, const uint32_t *node_of)
{
	uint32_t vertex = net_vertex_by_id(turns->net, rule->via_node);
	uint32_t index = vertex == PKG_NONE ? PKG_NONE : node_of[vertex];
	if (index == PKG_NONE)
		return false;
	const struct pkg_node *node = &turns->graph->nodes.items[index];
	uint32_t from[4], to[4];
	bool from_meets = false, to_meets = false;
	size_t from_count = halves_by_way(turns, node, rule->from_way, true, from, 4, &from_meets);
	size_t to_count = halves_by_way(turns, node, rule->to_way, false, to, 4, &to_meets);
	if (!from_meets || !to_meets)
		return false;
	if (rule->from_way == rule->to_way && !rule->only) {
		for (size_t i = 0; i < from_count; i++)
			if (may_drive(turns->graph, from[i] ^ 1))
				forbid(turns, from[i], from[i] ^ 1);
		return true;
	}
	if (from_count > 1 || to_count > 1)
		return false;
	if (!from_count || !to_count)
		return true;
	if (rule->only)
		forbid_others(turns, node, from[0], to[0]);
	else
		forbid(turns, from[0], to[0]);
	return true;
}

static int order_turns(const void *left, const void *right)
{
	const struct pkg_turn *a = left, *b = right;
	if (a->from_half != b->from_half)
		return a->from_half < b->from_half ? -1 : 1;
	return (a->to_half > b->to_half) - (a->to_half < b->to_half);
}

void turns_build(const struct net *net, struct graph_data *graph, const uint32_t *node_of, const uint32_t *way_of_half)
{
	struct turns turns = { net, graph, way_of_half };
	for (size_t i = 0; i < net->city->restrictions.count; i++) {
		const struct restriction *rule = &net->city->restrictions.items[i];
		if (resolve(&turns, rule, node_of))
			net->city->report->counts[COUNT_RESTRICTIONS]++;
		else
			report_fault(net->city->report, FAULT_RESTRICTION, FAULT_DROPPED, rule->from_way);
	}
	if (!graph->turns.count)
		return;
	qsort(graph->turns.items, graph->turns.count, sizeof(struct pkg_turn), order_turns);
	size_t kept = 1;
	for (size_t i = 1; i < graph->turns.count; i++)
		if (order_turns(&graph->turns.items[i], &graph->turns.items[kept - 1]))
			graph->turns.items[kept++] = graph->turns.items[i];
	graph->turns.count = kept;
}
