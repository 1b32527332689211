/* Manoeuvres of a route: one walk when the route is found, then a cursor. */
#include "nav/guidance.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define STRAIGHT_DEG 30.0
#define FORK_DEG 50.0
#define MERGE_STEPS_M 18.0 /* two turns closer than this are one: the car crosses a divided street */
#define STREET_AHEAD_M 80.0

int guidance_init(struct guidance *guidance, struct arena *arena, const struct route_search *search)
{
	uint32_t capacity = search->route.capacity;
	*guidance = (struct guidance){ .graph = search->graph, .search = search, .capacity = capacity };
	guidance->step_capacity = capacity < 4096 ? capacity + 1 : 4096;
	guidance->steps = ARENA_ARRAY(arena, struct guidance_step, guidance->step_capacity);
	guidance->origin_m = ARENA_ARRAY(arena, double, capacity);
	guidance->origin_ms = ARENA_ARRAY(arena, uint32_t, capacity);
	return guidance->steps && guidance->origin_m && guidance->origin_ms ? 0 : -ENOMEM;
}

void guidance_clear(struct guidance *guidance)
{
	guidance->route = NULL;
	guidance->step_count = guidance->next_step = 0;
}

static double deg_of(int32_t bam)
{
	return bam_to_rad(bam) * (180.0 / BLVD_PI);
}

static double turn_deg(const struct graph *graph, uint32_t from, uint32_t to)
{
	return deg_of(graph_turn_bam(graph, from, to));
}

static enum nav_manoeuvre manoeuvre_by_angle(double deg)
{
	double size = fabs(deg);
	bool left = deg < 0.0;
	if (size < STRAIGHT_DEG)
		return NAV_MANOEUVRE_STRAIGHT;
	if (size < FORK_DEG)
		return left ? NAV_MANOEUVRE_SLIGHT_LEFT : NAV_MANOEUVRE_SLIGHT_RIGHT;
	if (size < 130.0)
		return left ? NAV_MANOEUVRE_LEFT : NAV_MANOEUVRE_RIGHT;
	if (size < 165.0)
		return left ? NAV_MANOEUVRE_SHARP_LEFT : NAV_MANOEUVRE_SHARP_RIGHT;
	return NAV_MANOEUVRE_U_TURN;
}

static bool same_street(const struct pkg_edge *a, const struct pkg_edge *b)
{
	if (a->name || b->name)
		return a->name == b->name;
	return a->ref && a->ref == b->ref && a->street_class == b->street_class;
}

/* Is `to` a way that a driver sees as a choice? A yard or a driveway beside a street is none. */
static bool is_choice(const struct graph *graph, uint32_t from, uint32_t taken, uint32_t to)
{
	if (to == taken || to == graph_twin(from) || !graph_drivable(graph, to))
		return false;
	const struct pkg_edge *a = graph_edge(graph, from), *b = graph_edge(graph, taken), *c = graph_edge(graph, to);
	bool on_street = a->street_class < PKG_STREET_SERVICE && b->street_class < PKG_STREET_SERVICE;
	return !on_street || (c->street_class < PKG_STREET_SERVICE && !(c->flags & PKG_EDGE_PRIVATE));
}

struct choices {
	uint32_t count;
	double straightest_deg;           /* least |angle| of the others */
	bool straight_is_ours;            /* the straightest other one is the same street as `from` */
	uint32_t forks_left, forks_right; /* others near ahead, on our left and right */
	bool fork_main;                   /* one of them is a bigger or the same street as `from` */
};

static struct choices look_around(const struct graph *graph, uint32_t from, uint32_t to)
{
	struct choices seen = { .straightest_deg = 180.0 };
	const struct pkg_node *node = &graph->net->nodes[graph_end(graph, from)];
	const struct pkg_edge *edge_from = graph_edge(graph, from), *edge_to = graph_edge(graph, to);
	double taken = turn_deg(graph, from, to);
	for (uint32_t i = 0; i < node->out_count; i++) {
		uint32_t other = graph->net->outs[node->first_out + i];
		if (!is_choice(graph, from, to, other))
			continue;
		const struct pkg_edge *edge = graph_edge(graph, other);
		double deg = turn_deg(graph, from, other);
		seen.count++;
		if (fabs(deg) < seen.straightest_deg) {
			seen.straightest_deg = fabs(deg);
			seen.straight_is_ours = same_street(edge_from, edge);
		}
		if (fabs(deg) >= FORK_DEG || fabs(deg - taken) > 65.0)
			continue;
		if (deg < taken)
			seen.forks_left++;
		else
			seen.forks_right++;
		seen.fork_main = seen.fork_main || edge->street_class <= edge_to->street_class || same_street(edge_from, edge);
	}
	return seen;
}

static bool is_fast(const struct pkg_edge *edge)
{
	return edge->street_class <= PKG_STREET_TRUNK;
}

static enum nav_manoeuvre classify(const struct graph *graph, uint32_t from, uint32_t to)
{
	const struct pkg_edge *edge_from = graph_edge(graph, from), *edge_to = graph_edge(graph, to);
	if (to == graph_twin(from))
		return NAV_MANOEUVRE_U_TURN;
	double deg = turn_deg(graph, from, to), size = fabs(deg);
	if ((edge_from->flags & PKG_EDGE_LINK) && !(edge_to->flags & PKG_EDGE_LINK) && is_fast(edge_to) && size < 40.0)
		return NAV_MANOEUVRE_MERGE;
	struct choices seen = look_around(graph, from, to);
	bool same = same_street(edge_from, edge_to);
	if (!seen.count) {
		/* The only way on; still a turn where the street ends at another one. */
		bool ends = graph->net->nodes[graph_end(graph, from)].out_count > 2 && !same && size >= FORK_DEG;
		return ends ? manoeuvre_by_angle(deg) : NAV_MANOEUVRE_NONE;
	}
	if (size < FORK_DEG && seen.forks_left + seen.forks_right > 0) {
		bool obvious = size + 12.0 < seen.straightest_deg && (same || !seen.fork_main);
		bool main_goes_on = same && !seen.straight_is_ours && size < STRAIGHT_DEG;
		if (obvious || main_goes_on)
			return NAV_MANOEUVRE_NONE;
		if (!seen.forks_left)
			return size < STRAIGHT_DEG ? NAV_MANOEUVRE_KEEP_LEFT : NAV_MANOEUVRE_SLIGHT_LEFT;
		if (!seen.forks_right)
			return size < STRAIGHT_DEG ? NAV_MANOEUVRE_KEEP_RIGHT : NAV_MANOEUVRE_SLIGHT_RIGHT;
		return NAV_MANOEUVRE_STRAIGHT;
	}
	if (size < STRAIGHT_DEG)
		return NAV_MANOEUVRE_NONE;
	bool bends = seen.straightest_deg > size + (same ? 12.0 : 40.0);
	if (bends && size < (same ? 75.0 : 45.0))
		return NAV_MANOEUVRE_NONE;
	return manoeuvre_by_angle(deg);
}

/* First name, else number, at a route index or a little further. */
static uint32_t street_from(const struct guidance *guidance, uint32_t index)
{
	const struct route *route = guidance->route;
	uint32_t ref = 0;
	for (uint32_t i = index; i < route->count; i++) {
		const struct pkg_edge *edge = graph_edge(guidance->graph, route->halves[i]);
		if (edge->name)
			return edge->name;
		ref = ref ? ref : edge->ref;
		if (guidance->origin_m[i] > guidance->origin_m[index] + STREET_AHEAD_M)
			break;
	}
	return ref;
}

static void add_step(struct guidance *guidance, struct guidance_step step)
{
	if (guidance->step_count == guidance->step_capacity)
		return;
	guidance->steps[guidance->step_count++] = step;
}

static bool is_turn(const struct guidance_step *step)
{
	return step->manoeuvre != NAV_MANOEUVRE_ROUNDABOUT && step->manoeuvre != NAV_MANOEUVRE_ARRIVE;
}

/* Two turns in quick succession are told as one. */
static bool join_steps(struct guidance *guidance, const struct guidance_step *step)
{
	if (!guidance->step_count || !is_turn(step))
		return false;
	struct guidance_step *last = &guidance->steps[guidance->step_count - 1];
	if (!is_turn(last) || step->at_m - last->at_m > MERGE_STEPS_M)
		return false;
	last->angle_bam = (int32_t)((uint32_t)last->angle_bam + (uint32_t)step->angle_bam);
	last->last = step->last;
	last->street = step->street;
	last->manoeuvre = manoeuvre_by_angle(deg_of(last->angle_bam));
	return true;
}

static void add_turn(struct guidance *guidance, uint32_t index)
{
	uint32_t from = guidance->route->halves[index - 1], to = guidance->route->halves[index];
	enum nav_manoeuvre manoeuvre = classify(guidance->graph, from, to);
	if (manoeuvre == NAV_MANOEUVRE_NONE)
		return;
	struct guidance_step step = {
		.manoeuvre = manoeuvre,
		.angle_bam = graph_turn_bam(guidance->graph, from, to),
		.index = index,
		.last = index,
		.street = street_from(guidance, index),
		.at_m = guidance->origin_m[index],
	};
	if (!join_steps(guidance, &step))
		add_step(guidance, step);
}

static bool on_roundabout(const struct guidance *guidance, uint32_t index)
{
	return graph_edge(guidance->graph, guidance->route->halves[index])->flags & PKG_EDGE_ROUNDABOUT;
}

/* Ways off the roundabout at the end of one of its half-edges. */
static uint32_t exits_at_end(const struct graph *graph, uint32_t half)
{
	const struct pkg_node *node = &graph->net->nodes[graph_end(graph, half)];
	uint32_t exits = 0;
	for (uint32_t i = 0; i < node->out_count; i++) {
		uint32_t to = graph->net->outs[node->first_out + i];
		exits += to != graph_twin(half) && graph_drivable(graph, to) &&
				 !(graph_edge(graph, to)->flags & PKG_EDGE_ROUNDABOUT);
	}
	return exits;
}

/* Walks over the roundabout that begins at `index`; returns the index after it. */
static uint32_t add_roundabout(struct guidance *guidance, uint32_t index)
{
	const struct route *route = guidance->route;
	uint32_t exits = 0, i = index;
	for (; i < route->count && on_roundabout(guidance, i); i++)
		exits += i + 1 < route->count && on_roundabout(guidance, i + 1)
					 ? exits_at_end(guidance->graph, route->halves[i])
					 : 0;
	if (i == route->count)
		return i; /* the destination lies on it */
	struct guidance_step step = {
		.manoeuvre = NAV_MANOEUVRE_ROUNDABOUT,
		.exit = (uint8_t)(exits + 1 < 255 ? exits + 1 : 255),
		.angle_bam = graph_turn_bam(guidance->graph, route->halves[index - 1], route->halves[i]),
		.index = index,
		.last = i,
		.street = street_from(guidance, i),
		.at_m = guidance->origin_m[index],
	};
	add_step(guidance, step);
	return i + 1;
}

static void measure_route(struct guidance *guidance)
{
	const struct route *route = guidance->route;
	double sum_m = -route->start_along_m;
	uint32_t sum_ms = 0;
	for (uint32_t i = 0; i < route->count; i++) {
		uint32_t half = route->halves[i];
		if (i) {
			uint32_t turn = route_turn_ms(guidance->graph, route->halves[i - 1], half);
			sum_ms += turn == ROUTE_FORBIDDEN ? 0 : turn;
		}
		guidance->origin_m[i] = sum_m;
		guidance->origin_ms[i] = sum_ms;
		sum_m += graph_length_m(guidance->graph, half);
		sum_ms += route_edge_ms(guidance->search, half);
	}
}

void guidance_build(struct guidance *guidance, const struct route *route)
{
	guidance_clear(guidance);
	if (!route->count || route->count > guidance->capacity)
		return;
	guidance->route = route;
	measure_route(guidance);
	for (uint32_t i = 1; i < route->count;) {
		if (on_roundabout(guidance, i) && !on_roundabout(guidance, i - 1)) {
			i = add_roundabout(guidance, i);
			continue;
		}
		/* Setting off on a roundabout: leaving it needs no words of its own. */
		if (!on_roundabout(guidance, i - 1))
			add_turn(guidance, i);
		i++;
	}
	uint32_t last = route->count - 1;
	add_step(guidance, (struct guidance_step){
						   .manoeuvre = NAV_MANOEUVRE_ARRIVE,
						   .index = last,
						   .last = last,
						   .street = street_from(guidance, last),
						   .at_m = guidance->origin_m[last] + route->end_along_m,
					   });
}

void guidance_remaining(
	const struct guidance *guidance, uint32_t index, double along_m, double *remaining_m, double *remaining_s)
{
	*remaining_m = *remaining_s = 0.0;
	const struct route *route = guidance->route;
	if (!route || index >= route->count)
		return;
	uint32_t last = route->count - 1;
	double end_m = guidance->origin_m[last] + route->end_along_m;
	*remaining_m = fmax(end_m - guidance->origin_m[index] - along_m, 0.0);
	double end_ms =
		guidance->origin_ms[last] + (double)route_part_ms(guidance->search, route->halves[last], route->end_along_m);
	double at_ms = guidance->origin_ms[index] + (double)route_part_ms(guidance->search, route->halves[index], along_m);
	*remaining_s = fmax(end_ms - at_ms, 0.0) * 1e-3;
}

static uint32_t half_of(const struct guidance *guidance, uint32_t index)
{
	return guidance->route->halves[index];
}

struct nav_step guidance_step_ahead(struct guidance *guidance, uint32_t index, double along_m, uint32_t n)
{
	struct nav_step out = { .manoeuvre = NAV_MANOEUVRE_NONE, .from_half = PKG_NONE, .to_half = PKG_NONE };
	const struct route *route = guidance->route;
	if (!route || index >= route->count)
		return out;
	double here = guidance->origin_m[index] + along_m;
	uint32_t at = guidance->next_step;
	/* A manoeuvre is done when the car is on the half-edge after its node; arriving is done when the route is cleared.
	 */
	while (at + 1 < guidance->step_count && guidance->steps[at].index <= index)
		at++;
	while (at > 0 && guidance->steps[at - 1].index > index)
		at--;
	guidance->next_step = at;
	if (at + n >= guidance->step_count)
		return out;
	const struct guidance_step *step = &guidance->steps[at + n];
	bool arrive = step->manoeuvre == NAV_MANOEUVRE_ARRIVE;
	out.manoeuvre = step->manoeuvre;
	out.exit = step->exit;
	out.angle_bam = step->angle_bam;
	out.distance_m = fmax(step->at_m - here, 0.0);
	out.street = step->street;
	out.from_half = half_of(guidance, arrive ? step->index : step->index - 1);
	out.to_half = half_of(guidance, step->last);
	struct dvec3 place =
		graph_at(guidance->graph, half_of(guidance, step->index), arrive ? route->end_along_m : 0.0).at_m;
	out.at_mm[0] = (int32_t)llrint(place.x * 1e3);
	out.at_mm[1] = (int32_t)llrint(place.y * 1e3);
	out.at_mm[2] = (int32_t)llrint(place.z * 1e3);
	return out;
}

/* --- words --- */

/* Cuts at the start of a UTF-8 character. */
static size_t fit(char *out, size_t size, int wanted)
{
	if (!size || wanted < 0)
		return 0;
	if ((size_t)wanted < size)
		return (size_t)wanted;
	size_t length = strlen(out);
	size_t start = length;
	while (start > 0 && ((unsigned char)out[start - 1] & 0xC0) == 0x80)
		start--;
	if (start > 0 && ((unsigned char)out[start - 1] & 0x80)) {
		unsigned char lead = (unsigned char)out[start - 1];
		size_t need = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
		if (length - (start - 1) < need)
			length = start - 1;
	}
	out[length] = 0;
	return length;
}

static const char *ordinal(unsigned n)
{
	if (n % 100 >= 11 && n % 100 <= 13)
		return "th";
	return n % 10 == 1 ? "st" : n % 10 == 2 ? "nd" : n % 10 == 3 ? "rd" : "th";
}

size_t guidance_text(enum nav_manoeuvre manoeuvre, unsigned exit, const char *street, char *out, size_t size)
{
	static const struct {
		const char *text, *joint; /* joint: before the street's name */
	} words[] = {
		[NAV_MANOEUVRE_NONE] = { "Follow the road", "Follow" },
		[NAV_MANOEUVRE_STRAIGHT] = { "Go straight on", " into " },
		[NAV_MANOEUVRE_SLIGHT_LEFT] = { "Bear left", " into " },
		[NAV_MANOEUVRE_LEFT] = { "Turn left", " into " },
		[NAV_MANOEUVRE_SHARP_LEFT] = { "Turn sharp left", " into " },
		[NAV_MANOEUVRE_SLIGHT_RIGHT] = { "Bear right", " into " },
		[NAV_MANOEUVRE_RIGHT] = { "Turn right", " into " },
		[NAV_MANOEUVRE_SHARP_RIGHT] = { "Turn sharp right", " into " },
		[NAV_MANOEUVRE_U_TURN] = { "Turn round", " on " },
		[NAV_MANOEUVRE_ROUNDABOUT] = { "At the roundabout take the", " into " },
		[NAV_MANOEUVRE_KEEP_LEFT] = { "Keep left", " onto " },
		[NAV_MANOEUVRE_KEEP_RIGHT] = { "Keep right", " onto " },
		[NAV_MANOEUVRE_MERGE] = { "Merge", " onto " },
		[NAV_MANOEUVRE_ARRIVE] = { "Destination", ": " },
	};
	if ((unsigned)manoeuvre >= sizeof(words) / sizeof(words[0]))
		manoeuvre = NAV_MANOEUVRE_NONE;
	bool named = street && *street;
	if (manoeuvre == NAV_MANOEUVRE_NONE)
		return fit(out, size, snprintf(out, size, named ? "Follow %s" : "Follow the road", named ? street : ""));
	char count[32] = "";
	if (manoeuvre == NAV_MANOEUVRE_ROUNDABOUT)
		snprintf(count, sizeof(count), " %u%s exit", exit, ordinal(exit));
	return fit(out, size,
		snprintf(out, size, "%s%s%s%s", words[manoeuvre].text, count, named ? words[manoeuvre].joint : "",
			named ? street : ""));
}

size_t guidance_distance_text(double distance_m, char *out, size_t size)
{
	if (!(distance_m >= 10.0))
		return fit(out, size, snprintf(out, size, "now"));
	double step = distance_m < 300.0 ? 10.0 : 50.0;
	double rounded = step * floor(distance_m / step + 0.5);
	if (rounded < 1000.0)
		return fit(out, size, snprintf(out, size, "%.0f m", rounded));
	if (distance_m < 9950.0)
		return fit(out, size, snprintf(out, size, "%.1f km", fmax(distance_m, 1000.0) * 1e-3));
	return fit(out, size, snprintf(out, size, "%.0f km", fmin(distance_m, 1e8) * 1e-3));
}
