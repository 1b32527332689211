#include "tools/city/graph_net.h"

void graph_build(struct city *city, struct graph_data *out)
{
	struct net net;
	crossing_array crossings = { 0 };
	uint32_t *node_of, *way_of_half;
	*out = (struct graph_data){ 0 };
	net_init(&net, city);
	split_mend_ends(&net);
	planar_cut(&net, true);
	split_mark_boundary(&net);
	profile_refine(&net);
	planar_cut(&net, false);
	planar_levels(&net, &crossings);
	profile_solve(&net, &crossings, true);
	profile_other_ways(&net);
	chains_build(&net, out, &node_of, &way_of_half);
	faces_build(out);
	faces_components(out, city->report);
	turns_build(&net, out, node_of, way_of_half);
	city->report->counts[COUNT_NODES] = out->nodes.count;
	city->report->counts[COUNT_EDGES] = out->edges.count;
	city->report->counts[COUNT_FACES] = out->faces.count;
	array_free(node_of);
	array_free(way_of_half);
	ARRAY_FINISH(&crossings);
	net_finish(&net);
}

void graph_data_finish(struct graph_data *graph)
{
	ARRAY_FINISH(&graph->nodes);
	ARRAY_FINISH(&graph->outs);
	ARRAY_FINISH(&graph->halves);
	ARRAY_FINISH(&graph->edges);
	ARRAY_FINISH(&graph->points);
	ARRAY_FINISH(&graph->faces);
	ARRAY_FINISH(&graph->turns);
	ARRAY_FINISH(&graph->names);
}

struct pkg_graph graph_view(const struct graph_data *graph)
{
	return (struct pkg_graph){
		.nodes = graph->nodes.items,
		.outs = graph->outs.items,
		.halves = graph->halves.items,
		.edges = graph->edges.items,
		.points = graph->points.items,
		.faces = graph->faces.items,
		.turns = graph->turns.items,
		.node_count = (uint32_t)graph->nodes.count,
		.out_count = (uint32_t)graph->outs.count,
		.half_count = (uint32_t)graph->halves.count,
		.edge_count = (uint32_t)graph->edges.count,
		.point_count = (uint32_t)graph->points.count,
		.face_count = (uint32_t)graph->faces.count,
		.turn_count = (uint32_t)graph->turns.count,
	};
}
