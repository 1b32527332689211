/* The finished street graph into the document: one way an edge, signals and crossings, restrictions, street trees. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/synth/synth.h"

#define STUB_M 30.0 /* dead ends shorter than this are not written */
#define TREE_STEP_M 11.0
#define STRAIGHT_M 0.05

static const char *const class_words[PKG_STREET_CLASS_COUNT] = { "motorway", "trunk", "primary", "secondary",
	"tertiary", "unclassified", "residential", "living_street", "service" };

struct writer {
	struct synth *synth;
	uint32_t *node_id; /* by graph node; 0: not written yet */
	uint32_t *way_id;  /* by edge; 0: left out */
};

struct dvec2 street_point(const struct synth *synth, uint32_t half, uint32_t index)
{
	const struct pkg_edge *edge = &synth->view.edges[half / 2];
	uint32_t at = half & 1 ? edge->point_count - 1 - index : index;
	const int32_t *mm = synth->view.points[edge->first_point + at].pos_mm;
	return (struct dvec2){ mm[0] / 1000.0, mm[1] / 1000.0 };
}

static bool is_stub(const struct synth *synth, uint32_t e)
{
	if (synth->view.nodes[synth->view.halves[2 * e].origin].component)
		return true;
	for (uint32_t side = 0; side < 2; side++) {
		const struct pkg_node *node = &synth->view.nodes[synth->view.halves[2 * e + side].origin];
		if (node->out_count == 1 && !(node->flags & PKG_NODE_BOUNDARY) &&
			synth->view.edges[e].length_mm < STUB_M * 1000.0)
			return true;
	}
	return false;
}

static bool is_main(const struct pkg_edge *edge)
{
	return edge->street_class <= PKG_STREET_SECONDARY;
}

static bool has_signals(const struct synth *synth, uint32_t n)
{
	const struct pkg_node *node = &synth->view.nodes[n];
	uint32_t main = 0, collecting = 0;
	for (uint32_t k = 0; k < node->out_count; k++) {
		const struct pkg_edge *edge = &synth->view.edges[synth->view.outs[node->first_out + k] / 2];
		if (edge->flags & (PKG_EDGE_ROUNDABOUT | PKG_EDGE_TUNNEL))
			return false;
		main += is_main(edge);
		collecting += edge->street_class <= PKG_STREET_TERTIARY;
	}
	return node->out_count >= 3 && main >= 2 && collecting >= 3;
}

static uint32_t node_id(struct writer *writer, uint32_t n)
{
	if (writer->node_id[n])
		return writer->node_id[n];
	const int32_t *mm = writer->synth->view.nodes[n].pos_mm;
	writer->node_id[n] = osm_doc_node(writer->synth->doc, (struct dvec2){ mm[0] / 1000.0, mm[1] / 1000.0 });
	if (has_signals(writer->synth, n))
		osm_doc_tag(writer->synth->doc, "highway", "traffic_signals");
	return writer->node_id[n];
}

struct track {
	struct dvec2 *points;
	double *along;
	size_t count;
};

/* Points of an edge without those that the heights asked for. */
static void straighten(const struct synth *synth, uint32_t e, struct track *track)
{
	uint32_t count = synth->view.edges[e].point_count;
	track->count = 0;
	for (uint32_t i = 0; i < count; i++) {
		struct dvec2 p = street_point(synth, 2 * e, i);
		if (i && i + 1 < count) {
			struct dvec2 a = track->points[track->count - 1], b = street_point(synth, 2 * e, i + 1),
						 d = dvec2_sub(b, a);
			if (fabs(dvec2_cross(d, dvec2_sub(p, a))) < STRAIGHT_M * dvec2_length(d))
				continue;
		}
		track->along[track->count] =
			track->count ? track->along[track->count - 1] + dvec2_length(dvec2_sub(p, track->points[track->count - 1]))
						 : 0.0;
		track->points[track->count++] = p;
	}
}

static struct dvec2 track_at(const struct track *track, double along, struct dvec2 *direction)
{
	size_t i = 1;
	while (i + 1 < track->count && track->along[i] < along)
		i++;
	struct dvec2 a = track->points[i - 1], d = dvec2_sub(track->points[i], a);
	double length = track->along[i] - track->along[i - 1],
		   f = length > 0.0 ? (along - track->along[i - 1]) / length : 0.0;
	if (direction)
		*direction = dvec2_scale(d, 1.0 / fmax(length, 1e-9));
	return dvec2_add(a, dvec2_scale(d, f));
}

/* Where pedestrians cross before a junction with signals, from the half-edge's origin; 0: nowhere. */
static double crossing_before(const struct synth *synth, uint32_t half)
{
	uint32_t n = synth->view.halves[half].origin;
	const struct pkg_edge *edge = &synth->view.edges[half / 2];
	if (!has_signals(synth, n) || edge->street_class > PKG_STREET_TERTIARY || edge->length_mm < 60000 ||
		edge->flags & (PKG_EDGE_BRIDGE | PKG_EDGE_TUNNEL))
		return 0.0;
	const struct pkg_node *node = &synth->view.nodes[n];
	double widest = 0.0;
	for (uint32_t k = 0; k < node->out_count; k++) {
		uint32_t other = synth->view.outs[node->first_out + k];
		if (other / 2 != half / 2)
			widest = fmax(widest, synth->view.edges[other / 2].width_mm / 1000.0);
	}
	return widest / 2.0 + 5.0;
}

static void write_plants(struct synth *synth, uint32_t e, const struct track *track)
{
	const struct pkg_edge *edge = &synth->view.edges[e];
	const struct street *street = &synth->streets.items[edge->source_id - 1];
	if (!street->trees || edge->flags & (PKG_EDGE_BRIDGE | PKG_EDGE_TUNNEL | PKG_EDGE_ROUNDABOUT))
		return;
	struct rng rng = synth_rng(synth, 20, e);
	double length = track->along[track->count - 1], aside = edge->width_mm / 2000.0 + 1.7;
	for (double at = 16.0; at < length - 16.0; at += TREE_STEP_M / fmin(synth->options.density, 2.0)) {
		for (int side = -1; side <= 1; side += 2) {
			struct dvec2 d, p = track_at(track, at + rng_range(&rng, -0.6, 0.6), &d);
			if (rng_unit(&rng) < 0.08)
				continue;
			tree_write(synth, (struct dvec2){ p.x - d.y * aside * side, p.y + d.x * aside * side }, &rng, 9.0);
		}
	}
}

static void tag_way(struct synth *synth, const struct pkg_edge *edge)
{
	struct osm_doc *doc = synth->doc;
	const struct street *street = &synth->streets.items[edge->source_id - 1];
	bool forward = edge->flags & PKG_EDGE_FORWARD, backward = edge->flags & PKG_EDGE_BACKWARD;
	osm_doc_tag(doc, "highway", class_words[edge->street_class]);
	if (edge->name)
		osm_doc_tag(doc, "name", synth->graph.names.items[edge->name - 1]);
	if (edge->flags & PKG_EDGE_ROUNDABOUT)
		osm_doc_tag(doc, "junction", "roundabout");
	else if (!forward || !backward)
		osm_doc_tag(doc, "oneway", "yes");
	int lanes = edge->lanes_forward + edge->lanes_backward;
	osm_doc_tag_number(doc, "lanes", forward && backward && lanes < 2 ? 2 : lanes, 0);
	osm_doc_tag_number(doc, "maxspeed", edge->speed_kmh, 0);
	osm_doc_tag_number(doc, "width", edge->width_mm / 1000.0, 1);
	osm_doc_tag(doc, "surface", street->surface ? street->surface : "asphalt");
	osm_doc_tag(doc, "lit", "yes");
	osm_doc_tag(doc, "sidewalk", edge->flags & PKG_EDGE_TUNNEL ? "no" : "both");
	if (edge->flags & PKG_EDGE_BRIDGE)
		osm_doc_tag(doc, "bridge", "yes");
	if (edge->flags & PKG_EDGE_TUNNEL)
		osm_doc_tag(doc, "tunnel", "yes");
	if (edge->flags & (PKG_EDGE_BRIDGE | PKG_EDGE_TUNNEL))
		osm_doc_tag_number(doc, "layer", edge->layer, 0);
}

static void write_edge(struct writer *writer, uint32_t e, struct track *track)
{
	struct synth *synth = writer->synth;
	const struct pkg_edge *edge = &synth->view.edges[e];
	straighten(synth, e, track);
	double length = track->along[track->count - 1];
	double first = crossing_before(synth, 2 * e), last = crossing_before(synth, 2 * e + 1);
	double stops[2] = { first > 0.0 ? first : -1.0, last > 0.0 ? length - last : -1.0 };
	node_array nodes = { 0 };
	ARRAY_PUSH(&nodes, node_id(writer, synth->view.halves[2 * e].origin));
	for (size_t i = 1; i < track->count; i++) {
		for (int k = 0; k < 2; k++) {
			if (stops[k] <= track->along[i - 1] + 0.5 || stops[k] >= track->along[i] - 0.5)
				continue;
			ARRAY_PUSH(&nodes, osm_doc_node(synth->doc, track_at(track, stops[k], NULL)));
			osm_doc_tag(synth->doc, "highway", "crossing");
			osm_doc_tag(synth->doc, "crossing", "traffic_signals");
		}
		if (i + 1 < track->count)
			ARRAY_PUSH(&nodes, osm_doc_node(synth->doc, track->points[i]));
	}
	ARRAY_PUSH(&nodes, node_id(writer, synth->view.halves[2 * e + 1].origin));
	if (!(edge->flags & PKG_EDGE_FORWARD)) /* one-way streets along their nodes */
		for (size_t i = 0, j = nodes.count - 1; i < j; i++, j--) {
			uint32_t swap = nodes.items[i];
			nodes.items[i] = nodes.items[j];
			nodes.items[j] = swap;
		}
	writer->way_id[e] = osm_doc_way(synth->doc, nodes.items, nodes.count);
	ARRAY_FINISH(&nodes);
	tag_way(synth, edge);
	write_plants(synth, e, track);
}

static double turn_of(const struct synth *synth, uint32_t arriving, uint32_t leaving)
{
	uint32_t count = synth->view.edges[arriving / 2].point_count;
	struct dvec2 end = street_point(synth, leaving, 0);
	struct dvec2 in = dvec2_sub(end, street_point(synth, arriving, count - 2)),
				 out = dvec2_sub(street_point(synth, leaving, 1), end);
	return atan2(dvec2_cross(in, out), dvec2_dot(in, out));
}

/* At some crossings of two main streets one may not turn left. */
static void write_restrictions(struct writer *writer)
{
	struct synth *synth = writer->synth;
	for (uint32_t n = 0; n < synth->view.node_count; n++) {
		const struct pkg_node *node = &synth->view.nodes[n];
		struct rng rng = synth_rng(synth, 21, n);
		if (!has_signals(synth, n) || node->out_count != 4 || rng_unit(&rng) > 0.25)
			continue;
		uint32_t from = synth->view.outs[node->first_out + rng_u32(&rng) % 4];
		for (uint32_t k = 0; k < 4; k++) {
			uint32_t to = synth->view.outs[node->first_out + k];
			double turn = turn_of(synth, from ^ 1, to);
			if (to == from || turn < 0.9 || turn > 2.2 || !writer->way_id[from / 2] || !writer->way_id[to / 2])
				continue;
			osm_doc_relation(synth->doc);
			osm_doc_member(synth->doc, 'w', writer->way_id[from / 2], "from");
			osm_doc_member(synth->doc, 'n', writer->node_id[n], "via");
			osm_doc_member(synth->doc, 'w', writer->way_id[to / 2], "to");
			osm_doc_tag(synth->doc, "type", "restriction");
			osm_doc_tag(synth->doc, "restriction", "no_left_turn");
		}
	}
}

void streets_write(struct synth *synth)
{
	struct writer writer = { .synth = synth };
	struct track track = { 0 };
	uint32_t most = 2;
	for (uint32_t e = 0; e < synth->view.edge_count; e++)
		most = synth->view.edges[e].point_count > most ? synth->view.edges[e].point_count : most;
	writer.node_id = POOL_ARRAY(&synth->city.pool, uint32_t, synth->view.node_count + 1);
	writer.way_id = POOL_ARRAY(&synth->city.pool, uint32_t, synth->view.edge_count + 1);
	track.points = POOL_ARRAY(&synth->city.pool, struct dvec2, most);
	track.along = POOL_ARRAY(&synth->city.pool, double, most);
	for (uint32_t e = 0; e < synth->view.edge_count; e++)
		if (!is_stub(synth, e))
			write_edge(&writer, e, &track);
	write_restrictions(&writer);
}
