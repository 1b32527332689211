/* Where the car goes: the stops asked for, or a varied tour by the seed, and the route as the navigator will find it.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/log.h"
#include "platform/base/rng.h"
#include "tools/drive/drive.h"

#define SNAP_M 1000.0
#define TRIES 40
#define TOUR_STOPS DESTINATION_STOPS_MAX

size_t drive_bytes(const struct pkg_graph *net)
{
	size_t route = (size_t)net->half_count + 64;
	return (size_t)64 * 1024 + ((size_t)net->point_count * 5 + 262144 * 2 + 16) * 4 + (size_t)net->edge_count * 8 +
		   route * (sizeof(struct route_label) + 12) + route * (sizeof(struct guidance_step) + 24);
}

int drive_init(struct drive *drive, struct arena *arena, const struct pkg *pkg, const struct drive_options *options)
{
	*drive = (struct drive){ .pkg = pkg, .options = options };
	if (graph_init(&drive->graph, arena, &pkg->graph, pkg->meta->right_hand_traffic) ||
		route_init(&drive->search, arena, &drive->graph, 0) || guidance_init(&drive->guidance, arena, &drive->search))
		return -ENOMEM;
	return 0;
}

/* What a place becomes on its way over the bus: whole microdegrees, snapped again by the navigator. */
static bool as_heard(
	const struct drive *drive, struct geo_point wanted, struct route_place *place, struct geo_point *at)
{
	at->lat_deg = rint(wanted.lat_deg * 1e6) * 1e-6;
	at->lon_deg = rint(remainder(wanted.lon_deg, 360.0) * 1e6) * 1e-6;
	return route_snap(&drive->graph, geo_to_plane(&drive->pkg->frame, *at), SNAP_M, place);
}

static struct geo_point geo_of(const struct drive *drive, struct route_place place)
{
	struct dvec3 at = graph_at(&drive->graph, place.half, place.along_m).at_m;
	return geo_from_plane(&drive->pkg->frame, (struct dvec2){ at.x, at.y });
}

static enum route_state find(
	struct drive *drive, struct route_place start, const struct route_place *stops, uint32_t count)
{
	struct route_request request = { .start = start, .stop_count = count };
	memcpy(request.stops, stops, count * sizeof(*stops));
	return route_find(&drive->search, &request);
}

static int final_route(struct drive *drive)
{
	enum route_state state = find(drive, drive->start, drive->stops, drive->stop_count);
	drive->route = drive->search.route;
	if (state == ROUTE_FOUND)
		return 0;
	if (state == ROUTE_TOO_LONG)
		log_error("the route has more than %u streets", drive->search.route.capacity);
	else
		log_error("no route to stop %u", drive->search.leg + 1);
	return -1;
}

/* --- a tour --- */

static bool is_pleasing(const struct graph *graph, uint32_t half)
{
	const struct pkg_edge *edge = graph_edge(graph, half);
	return graph_drivable(graph, half) && edge->street_class >= PKG_STREET_PRIMARY &&
		   edge->street_class <= PKG_STREET_RESIDENTIAL && graph_length_m(graph, half) > 25.0 &&
		   !(edge->flags & (PKG_EDGE_ROUNDABOUT | PKG_EDGE_TUNNEL | PKG_EDGE_LINK | PKG_EDGE_PRIVATE)) &&
		   !graph->net->nodes[graph_origin(graph, half)].component;
}

/* A city without streets of that kind: any that can be driven. */
static bool random_place(const struct drive *drive, struct rng *rng, struct route_place *out)
{
	const struct graph *graph = &drive->graph;
	uint32_t count = graph->net->half_count;
	for (uint32_t i = 0; count && i < 4000; i++) {
		uint32_t half = (uint32_t)(rng_unit(rng) * count);
		if (i < 3000 ? !is_pleasing(graph, half) : !graph_drivable(graph, half))
			continue;
		*out = (struct route_place){ half, graph_length_m(graph, half) * rng_range(rng, 0.3, 0.7) };
		return true;
	}
	return false;
}

static double distance_between(const struct drive *drive, struct route_place a, struct route_place b)
{
	struct dvec3 p = graph_at(&drive->graph, a.half, a.along_m).at_m,
				 q = graph_at(&drive->graph, b.half, b.along_m).at_m;
	return hypot(p.x - q.x, p.y - q.y);
}

/* How much one likes a leg: new streets, few turns back, no U-turn, no private ground. Negative: not at all. */
static double leg_score(const struct drive *drive, const uint8_t *used, double wanted_ms)
{
	const struct route *route = &drive->search.route;
	double length = 0.0, again = 0.0, small = 0.0;
	uint32_t names = 0, last_name = 0;
	for (uint32_t i = 0; i < route->count; i++) {
		uint32_t half = route->halves[i];
		const struct pkg_edge *edge = graph_edge(&drive->graph, half);
		if ((i && half == graph_twin(route->halves[i - 1])) || (edge->flags & PKG_EDGE_PRIVATE))
			return -1.0;
		double m = graph_length_m(&drive->graph, half) + 0.1;
		length += m;
		again += used[half >> 1] ? m : 0.0;
		small += edge->street_class >= PKG_STREET_LIVING ? m : 0.0;
		names += edge->name && edge->name != last_name;
		last_name = edge->name ? edge->name : last_name;
	}
	double off = fabs((double)route->cost_ms - wanted_ms) / wanted_ms;
	return 2.0 + 100.0 * names / (length + 200.0) - 1.5 * again / length - small / length - off;
}

static void mark_used(const struct drive *drive, uint8_t *used)
{
	for (uint32_t i = 0; i < drive->search.route.count; i++)
		used[drive->search.route.halves[i] >> 1] = 1;
}

static bool best_leg(struct drive *drive, struct rng *rng, struct route_place from, const uint8_t *used,
	double wanted_ms, struct route_place *stop, struct geo_point *at)
{
	double best = -1.0, wanted_m = wanted_ms * 1e-3 * 5.0; /* city speed in a straight line */
	int good = 0;
	for (int i = 0; i < TRIES && good < 6; i++) {
		struct route_place place, heard;
		struct geo_point heard_at;
		if (!random_place(drive, rng, &place) || !as_heard(drive, geo_of(drive, place), &heard, &heard_at))
			continue;
		double distance = distance_between(drive, from, heard);
		if (distance > 1.6 * wanted_m || (i < TRIES / 2 && distance < 0.4 * wanted_m))
			continue;
		if (find(drive, from, &heard, 1) != ROUTE_FOUND)
			continue;
		double score = leg_score(drive, used, wanted_ms);
		good += score >= 0.0;
		if (score > best) {
			best = score;
			*stop = heard;
			*at = heard_at;
		}
	}
	return best > -1.0;
}

static bool tour_from(struct drive *drive, struct rng *rng, uint8_t *used)
{
	double total_ms = (drive->options->minutes > 0.0 ? drive->options->minutes : 5.0) * 60000.0 * 1.25, done_ms = 0.0;
	struct route_place from = drive->start;
	double leg_ms = fmax(total_ms / (TOUR_STOPS - 1), 60000.0);
	drive->stop_count = 0;
	while (drive->stop_count < TOUR_STOPS && done_ms < total_ms) {
		struct route_place stop;
		if (!best_leg(drive, rng, from, used, leg_ms, &stop, &drive->stop_at[drive->stop_count]))
			break;
		drive->stops[drive->stop_count++] = stop;
		find(drive, from, &stop, 1);
		mark_used(drive, used);
		done_ms += (double)drive->search.route.cost_ms;
		from.half = drive->search.route.halves[drive->search.route.count - 1];
		from.along_m = drive->search.route.end_along_m;
	}
	return done_ms >= 0.8 * total_ms || (drive->stop_count == TOUR_STOPS && done_ms > 0.4 * total_ms);
}

static int choose_tour(struct drive *drive)
{
	struct rng rng = rng_seed(drive->options->seed);
	uint8_t *used = calloc(drive->graph.net->edge_count + 1, 1);
	bool good = false;
	for (int attempt = 0; used && !good && attempt < 12; attempt++) {
		memset(used, 0, drive->graph.net->edge_count);
		if (!drive->options->has_start && !random_place(drive, &rng, &drive->start))
			break;
		good = tour_from(drive, &rng, used);
	}
	free(used);
	if (!drive->stop_count) {
		log_error("no route: the city has no two connected streets");
		return -1;
	}
	return final_route(drive);
}

/* The start is a place of the street in the direction that leads on. */
static bool choose_start(struct drive *drive)
{
	struct geo_point heard;
	if (!as_heard(drive, drive->options->start, &drive->start, &heard))
		return false;
	struct route_place back = { graph_twin(drive->start.half),
		graph_length_m(&drive->graph, drive->start.half) - drive->start.along_m };
	if (!graph_drivable(&drive->graph, back.half) || !drive->stop_count)
		return true;
	uint64_t cost = UINT64_MAX;
	if (find(drive, drive->start, drive->stops, drive->stop_count) == ROUTE_FOUND)
		cost = drive->search.route.cost_ms;
	if (find(drive, back, drive->stops, drive->stop_count) == ROUTE_FOUND && drive->search.route.cost_ms < cost)
		drive->start = back;
	return true;
}

int drive_choose(struct drive *drive)
{
	const struct drive_options *options = drive->options;
	for (uint32_t i = 0; i < options->via_count; i++) {
		if (!as_heard(drive, options->via[i], &drive->stops[i], &drive->stop_at[i])) {
			log_error("no street within 1 km of %.6f,%.6f", options->via[i].lat_deg, options->via[i].lon_deg);
			return -1;
		}
		drive->stop_count++;
	}
	if (options->has_start && !choose_start(drive)) {
		log_error("no street within 1 km of %.6f,%.6f", options->start.lat_deg, options->start.lon_deg);
		return -1;
	}
	if (!options->via_count)
		return choose_tour(drive);
	struct rng rng = rng_seed(options->seed);
	for (int i = 0; !options->has_start && i < TRIES; i++)
		if (random_place(drive, &rng, &drive->start) &&
			find(drive, drive->start, drive->stops, drive->stop_count) == ROUTE_FOUND)
			break;
	return final_route(drive);
}

int drive_cut(struct drive *drive, uint32_t route_index, double along_m)
{
	uint32_t kept = 0;
	while (kept < drive->route.leg_count &&
		   (drive->route.leg_last[kept] < route_index ||
			   (drive->route.leg_last[kept] == route_index && drive->route.leg_along_m[kept] < along_m - 5.0)))
		kept++;
	if (kept == drive->stop_count)
		return 0;
	struct route_place place = { drive->route.halves[route_index], along_m };
	if (!as_heard(drive, geo_of(drive, place), &drive->stops[kept], &drive->stop_at[kept]))
		return 0;
	drive->stop_count = kept + 1;
	return final_route(drive);
}
