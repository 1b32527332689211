/*
 * Streets lie in the ground as they are built: even along, level across. Every street on the ground becomes a chain of
 * stations, stations at one junction are one, and their heights are relaxed until they are smooth along the streets and
 * no steeper than the class of street allows, yet close to the ground. Then the posts of the grid under and beside a
 * carriageway take the height of its closest point, and those further away blend into the ground.
 */
#include <stdlib.h>
#include <string.h>

#include "tools/city/box_index.h"
#include "tools/read/terrain.h"

#define STATION_M 10.0
#define PASSES 400
#define GROUND_PULL 0.02 /* per pass, towards the ground; against smoothness */
#define BLEND_STEPS 2.5  /* of the grid, from the carriageway's surroundings back to the ground */

struct station {
	int64_t node; /* OSM node, or 0 between two */
	struct dvec2 at;
	double height_m, ground_m;
	double sum_m, weight; /* of one pass */
};

struct link {
	uint32_t a, b;
	double length_m, slope_limit;
	double half_width_m;
};

struct profile {
	ARRAY(struct station) stations;
	ARRAY(struct link) links;
};

struct node_key {
	int64_t node;
	uint32_t way_node; /* order met */
	uint32_t station;
};
typedef ARRAY(struct node_key) key_array;

static bool on_ground(const struct way *way)
{
	bool wide = way->street_class < PKG_STREET_CLASS_COUNT || way->street_class == WAY_PEDESTRIAN ||
				way->street_class == WAY_TRACK || way->street_class == WAY_RAIL || way->street_class == WAY_TRAM;
	return wide && !way->tunnel && !way->bridge;
}

static double slope_limit(const struct way *way)
{
	if (way->street_class >= WAY_RAIL)
		return 0.05;
	return way->street_class <= PKG_STREET_PRIMARY ? 0.09 : way->street_class <= PKG_STREET_TERTIARY ? 0.13 : 0.19;
}

static int by_node(const void *a, const void *b)
{
	const struct node_key *x = a, *y = b;
	if (x->node != y->node)
		return x->node < y->node ? -1 : 1;
	return x->way_node < y->way_node ? -1 : x->way_node > y->way_node;
}

static uint32_t add_station(struct profile *profile, const struct height_field *field, int64_t node, struct dvec2 at)
{
	double ground = field_at(field, at);
	ARRAY_PUSH(&profile->stations, (struct station){ node, at, ground, ground, 0.0, 0.0 });
	return (uint32_t)(profile->stations.count - 1);
}

/* One station a node, whatever the number of ways through it. */
static void node_stations(
	struct profile *profile, const struct height_field *field, const struct city *city, key_array *keys)
{
	for (size_t i = 0; i < city->ways.count; i++)
		for (size_t j = 0; on_ground(&city->ways.items[i]) && j < city->ways.items[i].node_count; j++)
			ARRAY_PUSH(keys, (struct node_key){ city->ways.items[i].nodes[j].id, (uint32_t)keys->count, 0 });
	struct dvec2 *places = calloc(keys->count + 1, sizeof(*places));
	uint32_t *station_of = malloc((keys->count + 1) * sizeof(*station_of));
	size_t next = 0;
	if (!places || !station_of)
		abort();
	for (size_t i = 0; i < city->ways.count; i++)
		for (size_t j = 0; on_ground(&city->ways.items[i]) && j < city->ways.items[i].node_count; j++)
			places[next++] = city->ways.items[i].nodes[j].at;
	ARRAY_SORT(keys, by_node);
	for (size_t i = 0; i < keys->count; i++) {
		struct node_key *key = &keys->items[i];
		bool same = i && keys->items[i - 1].node == key->node;
		key->station =
			same ? keys->items[i - 1].station : add_station(profile, field, key->node, places[key->way_node]);
		station_of[key->way_node] = key->station;
	}
	/* Back in the order of the ways. */
	for (size_t i = 0; i < keys->count; i++)
		keys->items[i].station = station_of[i];
	free(places);
	free(station_of);
}

static void link_ways(
	struct profile *profile, const struct height_field *field, const struct city *city, const key_array *keys)
{
	size_t next = 0;
	for (size_t i = 0; i < city->ways.count; i++) {
		const struct way *way = &city->ways.items[i];
		if (!on_ground(way))
			continue;
		uint32_t last = keys->items[next++].station;
		for (size_t j = 1; j < way->node_count; j++) {
			uint32_t end = keys->items[next++].station;
			struct dvec2 a = way->nodes[j - 1].at, b = way->nodes[j].at;
			double length = dvec2_length(dvec2_sub(b, a));
			size_t pieces = (size_t)fmin(fmax(ceil(length / STATION_M), 1.0), 10000.0);
			for (size_t k = 1; k <= pieces; k++) {
				struct dvec2 at = dvec2_add(a, dvec2_scale(dvec2_sub(b, a), (double)k / (double)pieces));
				uint32_t station = k == pieces ? end : add_station(profile, field, 0, at);
				ARRAY_PUSH(&profile->links, (struct link){ last, station, fmax(length / (double)pieces, 0.1),
												slope_limit(way), way->width_m / 2.0 });
				last = station;
			}
		}
	}
}

/* Jacobi steps: each station moves towards the weighted mean of its neighbours (near ones weigh more) and its ground.
 */
static void smooth_pass(struct profile *profile)
{
	for (size_t i = 0; i < profile->links.count; i++) {
		const struct link *link = &profile->links.items[i];
		struct station *a = &profile->stations.items[link->a], *b = &profile->stations.items[link->b];
		double weight = 1.0 / link->length_m;
		a->sum_m += weight * b->height_m;
		b->sum_m += weight * a->height_m;
		a->weight += weight;
		b->weight += weight;
	}
	for (size_t i = 0; i < profile->stations.count; i++) {
		struct station *station = &profile->stations.items[i];
		if (station->weight > 0.0) {
			double mean = station->sum_m / station->weight;
			station->height_m +=
				0.5 * (mean - station->height_m) + GROUND_PULL * (station->ground_m - station->height_m);
		}
		station->sum_m = station->weight = 0.0;
	}
}

/* Both ends of what is too steep move towards one another. */
static void slope_pass(struct profile *profile)
{
	for (size_t i = 0; i < profile->links.count; i++) {
		const struct link *link = &profile->links.items[i];
		struct station *a = &profile->stations.items[link->a], *b = &profile->stations.items[link->b];
		double rise = b->height_m - a->height_m, most = link->slope_limit * link->length_m;
		double excess = rise > most ? rise - most : rise < -most ? rise + most : 0.0;
		a->height_m += 0.45 * excess;
		b->height_m -= 0.45 * excess;
	}
}

static double distance_to(const struct profile *profile, const struct link *link, struct dvec2 at, double *height)
{
	const struct station *a = &profile->stations.items[link->a], *b = &profile->stations.items[link->b];
	struct dvec2 along = dvec2_sub(b->at, a->at), to = dvec2_sub(at, a->at);
	double squared = dvec2_dot(along, along);
	double t = squared > 0.0 ? fmin(fmax(dvec2_dot(along, to) / squared, 0.0), 1.0) : 0.0;
	*height = a->height_m + t * (b->height_m - a->height_m);
	return dvec2_length(dvec2_sub(to, dvec2_scale(along, t)));
}

/* Weights by closeness to the carriageway, so that posts between two streets do not jump from one to the other. */
static void stamp_post(const struct height_field *field, const struct profile *profile, const index_array *near,
	struct dvec2 at, float *height_m)
{
	double reach = 1.45 * field->step_m, sum = 0.0, weight = 0.0, share = 0.0;
	for (size_t k = 0; k < near->count; k++) {
		const struct link *link = &profile->links.items[near->items[k]];
		double height, beside = fmax(distance_to(profile, link, at, &height) - link->half_width_m, 0.0);
		double own = 1.0 - (beside - reach) / (BLEND_STEPS * field->step_m);
		if (own <= 0.0)
			continue;
		double w = 1.0 / ((beside + 0.5) * (beside + 0.5) * (beside + 0.5));
		sum += w * height;
		weight += w;
		share = fmax(share, fmin(own, 1.0));
	}
	if (weight > 0.0) {
		share = share * share * (3.0 - 2.0 * share);
		*height_m = (float)((double)*height_m + share * (sum / weight - (double)*height_m));
	}
}

static void stamp(struct height_field *field, const struct profile *profile)
{
	bounds_array boxes = { 0 };
	index_array near = { 0 };
	struct box_index index;
	double reach = (1.45 + BLEND_STEPS) * field->step_m;
	for (size_t i = 0; i < profile->links.count; i++) {
		const struct link *link = &profile->links.items[i];
		struct dvec2 a = profile->stations.items[link->a].at, b = profile->stations.items[link->b].at;
		struct bounds box = { { fmin(a.x, b.x), fmin(a.y, b.y) }, { fmax(a.x, b.x), fmax(a.y, b.y) } };
		ARRAY_PUSH(&boxes, bounds_grown(box, reach + link->half_width_m));
	}
	box_index_build(&index, boxes.items, boxes.count, 64.0);
	for (size_t row = 0; row < field->rows; row++) {
		for (size_t col = 0; col < field->columns; col++) {
			struct dvec2 at = field_place(field, col, row);
			box_index_find(&index, (struct bounds){ at, at }, &near);
			stamp_post(field, profile, &near, at, &field->height_m[row * field->columns + col]);
		}
	}
	box_index_finish(&index);
	ARRAY_FINISH(&boxes);
	ARRAY_FINISH(&near);
}

void terrain_streets(struct height_field *field, const struct city *city)
{
	struct profile profile = { 0 };
	key_array keys = { 0 };
	node_stations(&profile, field, city, &keys);
	link_ways(&profile, field, city, &keys);
	for (int pass = 0; pass < PASSES; pass++) {
		smooth_pass(&profile);
		slope_pass(&profile);
	}
	if (profile.links.count)
		stamp(field, &profile);
	ARRAY_FINISH(&keys);
	ARRAY_FINISH(&profile.stations);
	ARRAY_FINISH(&profile.links);
}
