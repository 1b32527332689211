/* Puts the room together: vehicle -> reckon -> match -> route -> view. Cost an update: constant but for the bounded
 * step of a route search; a few thousand half-edges at most. */
#include "nav/nav.h"

#include <errno.h>
#include <string.h>

#include "nav/doubt.h"
#include "nav/likely.h"
#include "nav/vehicle.h"

#define SETTLE_PER_UPDATE 1500
#define START_RADIUS_M 150.0
#define STOP_RADIUS_M 1000.0
#define PULL_M 18.0      /* the shown position follows the matched one over this distance */
#define JUMP_M 40.0      /* farther away it is put there at once */
#define OFF_ROUTE_M 30.0 /* beside the route for this long: look for a new one */
#define RETRY_M 80.0     /* after a search that found nothing */
#define WINDOW_AHEAD 32  /* half-edges of the route in which the car is looked for */
#define WINDOW_BEHIND 4
#define LANE_TURN_M 150.0 /* before a turn across, counted from the end of the street's piece */
#define PLACED_M 3.0      /* where a position was pointed at or measured */
#define PLACED_RAD 0.1
#define ARRIVED_M 20.0
#define HEADING_SIGMA 0.03
#define LESSON_S 4.0
#define STRETCH_M 150.0
#define STRETCH_TURN_RAD 0.35

size_t nav_bytes(const struct pkg_graph *net, const struct nav_config *config)
{
	size_t route = config->route_capacity ? config->route_capacity : (size_t)net->half_count + ROUTE_STOPS_MAX + 1;
	size_t particles = config->particles ? config->particles : 1024;
	size_t cells = 262144 * 2 + (size_t)net->point_count * 4;
	return 4096 + (size_t)net->point_count * 4 + (size_t)net->half_count * 4 + cells * 4 + (size_t)net->edge_count * 8 +
		   (size_t)net->half_count * (sizeof(struct route_label) + 8) +
		   route * (4 + 4 + 8 + 4 + sizeof(struct guidance_step)) + particles * 2 * sizeof(struct match_particle);
}

int nav_init(struct nav *nav, struct arena *arena, const struct pkg *pkg, const struct nav_config *config)
{
	*nav = (struct nav){ .pkg = pkg, .config = *config, .failed_m = -1.0, .stretch_turn_rad = -1.0 };
	if (!nav->config.settle_per_update)
		nav->config.settle_per_update = SETTLE_PER_UPDATE;
	bool right_hand = !pkg->meta || pkg->meta->right_hand_traffic;
	if (graph_init(&nav->graph, arena, &pkg->graph, right_hand) ||
		route_init(&nav->search, arena, &nav->graph, config->route_capacity) ||
		guidance_init(&nav->guidance, arena, &nav->search) ||
		match_init(&nav->match, arena, &nav->graph,
			&(struct match_config){ .particles = config->particles, .seed = config->seed }))
		return -ENOMEM;
	nav->route.capacity = nav->search.route.capacity;
	nav->route.halves = ARENA_ARRAY(arena, uint32_t, nav->route.capacity);
	reckon_init(&nav->reckon, &config->reckon);
	doubt_init(nav);
	return nav->route.halves ? 0 : -ENOMEM;
}

/* --- where the car is --- */

/* Which lane a driver keeps: the one at the kerb, the innermost before a turn across the traffic. */
static uint32_t likely_lane(struct nav *nav)
{
	uint32_t lanes = graph_lanes(&nav->graph, nav->match.half);
	if (lanes < 2 || !nav->routed || nav->off_route_m > 0.0)
		return 0;
	struct nav_step step = guidance_step_ahead(&nav->guidance, nav->route_at, nav->match.along_m, 0);
	double deg = bam_to_rad(step.angle_bam) * (180.0 / BLVD_PI);
	bool across = nav->graph.right_hand ? deg < -30.0 : deg > 30.0;
	double after_half = step.distance_m - graph_length_m(&nav->graph, nav->match.half) + nav->match.along_m;
	return across && step.manoeuvre != NAV_MANOEUVRE_ROUNDABOUT && after_half < LANE_TURN_M ? lanes - 1 : 0;
}

/* Point on the lane that the matched place means. */
static struct dvec2 lane_point(struct nav *nav, struct graph_pose *pose)
{
	*pose = graph_at(&nav->graph, nav->match.half, nav->match.along_m);
	double offset = graph_lane_offset_m(&nav->graph, nav->match.half, likely_lane(nav));
	return (
		struct dvec2){ pose->at_m.x + offset * cos(pose->heading_rad), pose->at_m.y - offset * sin(pose->heading_rad) };
}

/* Puts the shown position onto the matched lane. */
static void place_on_lane(struct nav *nav, bool heading)
{
	struct graph_pose pose;
	struct dvec2 at = lane_point(nav, &pose);
	int64_t pos_mm[2] = { llrint(at.x * 1e3), llrint(at.y * 1e3) };
	int32_t before = nav->reckon.heading_bam;
	reckon_place(&nav->reckon, pos_mm, heading ? bam_from_rad(pose.heading_rad) : before);
	match_heading_corrected(&nav->match, bam_to_rad(bam_diff(nav->reckon.heading_bam, before)));
	nav->height_m = pose.at_m.z;
}

/* The shown pose becomes the matched one at once. */
static void place_as_matched(struct nav *nav)
{
	double turn = nav->match.offset_rad;
	place_on_lane(nav, false);
	reckon_turn(&nav->reckon, turn);
	match_heading_corrected(&nav->match, turn);
}

static struct dvec2 reckoned_m(const struct nav *nav)
{
	return (struct dvec2){ (double)nav->reckon.pos_mm[0] * 1e-3, (double)nav->reckon.pos_mm[1] * 1e-3 };
}

static void forget_route(struct nav *nav)
{
	nav->routed = nav->searching = false;
	nav->off_route_m = 0.0;
	nav->failed_m = -1.0;
	guidance_clear(&nav->guidance);
}

static void placed(struct nav *nav, bool heading)
{
	place_on_lane(nav, heading);
	forget_route(nav);
	drift_hold(
		&nav->drift, &nav->reckon, bam_to_rad(nav->reckon.heading_bam), nav->match.uncertainty_m, PLACED_M, PLACED_RAD);
	nav->remembered = false;
}

bool nav_set_start(struct nav *nav, double lat_deg, double lon_deg, double heading_deg)
{
	struct dvec2 at = geo_to_plane(&nav->pkg->frame, (struct geo_point){ lat_deg, lon_deg });
	bool known = isfinite(heading_deg);
	int32_t heading = known ? bam_from_rad(heading_deg * (BLVD_PI / 180.0)) : nav->reckon.heading_bam;
	bool found = false;
	for (double radius = 15.0; !found && radius <= START_RADIUS_M; radius += 45.0)
		found = match_place_near(&nav->match, at, radius, known, heading);
	if (!found)
		return false;
	match_heading_corrected(&nav->match, bam_to_rad(bam_diff(nav->reckon.heading_bam, heading)));
	placed(nav, true);
	nav->heading_known = known;
	return true;
}

bool nav_set_start_half(struct nav *nav, uint32_t half, double along_m)
{
	if (half >= nav->graph.net->half_count || !isfinite(along_m))
		return false;
	match_place(&nav->match, half, along_m, 1.0, nav->reckon.heading_bam);
	placed(nav, true);
	nav->heading_known = true;
	return true;
}

/* Straight stretches between fixes tell how far the car really went. */
static void learn_scale(struct nav *nav, struct dvec2 at, double sigma_m)
{
	if (nav->stretch_turn_rad >= 0.0 && nav->stretch_turn_rad < STRETCH_TURN_RAD && nav->stretch_m < STRETCH_M)
		return;
	if (nav->stretch_turn_rad >= 0.0 && nav->stretch_turn_rad < STRETCH_TURN_RAD) {
		double true_m = hypot(at.x - nav->stretch_at.x, at.y - nav->stretch_at.y);
		/* Not a wild fix: nobody's speed is a tenth wrong. */
		if (fabs(true_m - nav->stretch_m) < 0.1 * nav->stretch_m)
			reckon_distance_reference(&nav->reckon, true_m, nav->stretch_m, 1.5 * sigma_m);
	}
	nav->stretch_at = at;
	nav->stretch_m = nav->stretch_turn_rad = 0.0;
}

/* How far from a fix the street may be. */
static double fix_radius_m(double sigma_m)
{
	return fmin(15.0 + 3.0 * sigma_m, 60.0);
}

/* A fix after a way that nobody saw. With a course both are known; without one, the first fix is all there is, and the
 * shown pose does not wait for the car to move on. */
static void find_after_unseen(struct nav *nav, const struct nav_input *input, struct dvec2 at, double sigma)
{
	bool first = nav->moved_unseen, course = input->heading_valid && isfinite(input->heading_rad);
	int32_t heading = course ? bam_from_rad(input->heading_rad) : nav->reckon.heading_bam;
	nav->moved_unseen = false;
	if (!nav->match.on_street || !(first || course))
		return;
	if (first && !course && !nav->match.gnss_far) {
		place_as_matched(nav);
		return;
	}
	if (!match_place_near(&nav->match, at, fix_radius_m(sigma), true, heading))
		return;
	nav->turned_unseen = nav->turned_unseen && !course;
	nav->reckon.heading_bam = heading;
	placed(nav, !course); /* in a corner a course is no street's */
}

/* The remembered place is not this one, and the heading there is a guess until a course tells. */
static void find_elsewhere(struct nav *nav, const struct nav_input *input, struct dvec2 at, double sigma)
{
	nav->heading_known = input->heading_valid && isfinite(input->heading_rad);
	if (nav->heading_known)
		nav->reckon.heading_bam = bam_from_rad(input->heading_rad);
	if (match_place_near(&nav->match, at, fix_radius_m(sigma), true, nav->reckon.heading_bam))
		placed(nav, true);
}

/* The first fix says where we are, later ones help the matching. */
static void take_fix(struct nav *nav, const struct nav_input *input)
{
	if (!input->fix_valid || (nav->fix_used && input->fix_number == nav->fix_number) || !isfinite(input->lat_deg) ||
		!isfinite(input->lon_deg) || fabs(input->lat_deg) > 90.0)
		return;
	nav->fix_used = true;
	nav->fix_number = input->fix_number;
	struct dvec2 at = geo_to_plane(&nav->pkg->frame, (struct geo_point){ input->lat_deg, input->lon_deg });
	double sigma = input->fix_sigma_m > 0.0 ? input->fix_sigma_m : 5.0;
	if (!nav->match.located) {
		if (match_place_near(&nav->match, at, fix_radius_m(sigma), nav->heading_known, nav->reckon.heading_bam))
			placed(nav, true);
		return;
	}
	if (nav->config.ignore_gnss)
		return;
	if (doubt_refutes_memory(nav, at, sigma)) {
		find_elsewhere(nav, input, at, sigma);
		return;
	}
	learn_scale(nav, at, sigma);
	uint32_t half = nav->match.half;
	match_gnss(&nav->match, &nav->reckon, at, sigma);
	if (!nav->match.on_street && nav->reckon.still_s <= 0.0)
		doubt_fix(nav, at, sigma);
	if (nav->moved_unseen || nav->turned_unseen)
		find_after_unseen(nav, input, at, sigma);
	else if (half != nav->match.half && nav->match.since_gnss_m == 0.0 && nav->match.gnss_far)
		place_on_lane(nav, false);
}

/* A heading matters until the car has moved: afterwards the streets know better. */
static void take_heading(struct nav *nav, const struct nav_input *input)
{
	if (!input->heading_valid || !isfinite(input->heading_rad) || nav->heading_known)
		return;
	if (nav->match.located && nav->reckon.travelled_m > 3.0)
		return;
	nav->reckon.heading_bam = bam_from_rad(input->heading_rad);
	nav->heading_known = true;
	nav->match.located = nav->fix_used = false; /* the next fix finds the street's direction too */
}

/* The shown pose follows the matched one gently while the car moves; not at all while it stands. */
static void pull(struct nav *nav, const struct reckon_step *step)
{
	double moved = fabs(step->distance_m);
	if (!nav->match.located || !nav->match.on_street || moved <= 0.0)
		return;
	struct graph_pose pose;
	struct dvec2 lane = lane_point(nav, &pose), here = reckoned_m(nav);
	double east = lane.x - here.x, north = lane.y - here.y;
	nav->height_m = pose.at_m.z;
	if (hypot(east, north) > JUMP_M) {
		place_as_matched(nav);
		return;
	}
	/* In a tight corner the reckoned arc is truer than the street's kink. */
	double curvature = fabs(step->turn_rad) / moved;
	double share = (1.0 - exp(-moved / PULL_M)) / (1.0 + 30.0 * curvature);
	reckon_shift(&nav->reckon, share * east, share * north);
	double turn = (1.0 - exp(-moved / 12.0)) * nav->match.offset_rad;
	reckon_turn(&nav->reckon, turn);
	match_heading_corrected(&nav->match, turn);
	nav->learn_rad += turn;
	nav->learn_s += step->dt_s;
	if (nav->learn_s >= LESSON_S) {
		reckon_bias_reference(&nav->reckon, nav->learn_rad, nav->learn_s, HEADING_SIGMA);
		nav->learn_rad = nav->learn_s = 0.0;
	}
}

static struct match_hints hints_for(const struct nav *nav, const struct nav_input *input)
{
	struct match_hints hints = { .drift_m = drift_ellipse(&nav->drift).major_m };
	hints.lamp = input->turn_lamp == NAV_TURN_LAMP_LEFT ? -1 : input->turn_lamp == NAV_TURN_LAMP_RIGHT ? 1 : 0;
	if (nav->routed) {
		hints.route = &nav->route.halves[nav->route_at];
		hints.route_count = nav->route.count - nav->route_at;
	}
	return hints;
}

/* --- where it goes --- */

static bool set_places(struct nav *nav, const struct route_place *places, uint32_t count)
{
	if (!count || count > ROUTE_STOPS_MAX)
		return false;
	memcpy(nav->stops, places, count * sizeof(*places));
	nav->stop_count = count;
	nav->stops_reached = 0;
	forget_route(nav);
	return true;
}

bool nav_set_stops(struct nav *nav, const struct geo_point *stops, uint32_t count)
{
	struct route_place places[ROUTE_STOPS_MAX];
	for (uint32_t i = 0; i < count && i < ROUTE_STOPS_MAX; i++)
		if (!route_snap(&nav->graph, geo_to_plane(&nav->pkg->frame, stops[i]), STOP_RADIUS_M, &places[i]))
			return false;
	return set_places(nav, places, count);
}

bool nav_set_destination(struct nav *nav, double lat_deg, double lon_deg)
{
	return nav_set_stops(nav, &(struct geo_point){ lat_deg, lon_deg }, 1);
}

bool nav_set_destination_half(struct nav *nav, uint32_t half, double along_m)
{
	if (half >= nav->graph.net->half_count || !isfinite(along_m))
		return false;
	return set_places(nav, &(struct route_place){ half, along_m }, 1);
}

void nav_clear_destination(struct nav *nav)
{
	nav->stop_count = 0;
	forget_route(nav);
}

static void begin_search(struct nav *nav)
{
	struct route_request request = { .start = { nav->match.half, nav->match.along_m } };
	uint32_t left = nav->stop_count - nav->stops_reached;
	memcpy(request.stops, nav->stops + nav->stops_reached, left * sizeof(*request.stops));
	request.stop_count = left;
	request.start_either =
		!graph_drivable(&nav->graph, nav->match.half) || (!nav->heading_known && nav->reckon.travelled_m < 5.0);
	route_begin(&nav->search, &request);
	nav->searching = true;
}

static void adopt_route(struct nav *nav)
{
	uint32_t *halves = nav->route.halves, capacity = nav->route.capacity;
	const struct route *found = &nav->search.route;
	nav->reroutes += nav->routed;
	nav->route = *found;
	nav->route.halves = halves;
	nav->route.capacity = capacity;
	memcpy(halves, found->halves, found->count * sizeof(*halves));
	nav->routed = true;
	nav->route_at = 0;
	nav->off_route_m = 0.0;
	guidance_build(&nav->guidance, &nav->route);
}

static void go_on_searching(struct nav *nav)
{
	enum route_state state = route_step(&nav->search, nav->config.settle_per_update);
	if (state == ROUTE_WORKING)
		return;
	nav->searching = false;
	if (state == ROUTE_FOUND)
		adopt_route(nav);
	nav->failed_m = state == ROUTE_FOUND ? -1.0 : 0.0;
}

/* Finds the half-edge being driven on the route, near the last one. Returns false when it is not there. */
static bool find_on_route(struct nav *nav)
{
	uint32_t low = nav->route_at > WINDOW_BEHIND ? nav->route_at - WINDOW_BEHIND : 0;
	uint32_t high = nav->route_at + WINDOW_AHEAD;
	for (uint32_t i = nav->route_at; i < high && i < nav->route.count; i++) {
		if (nav->route.halves[i] == nav->match.half) {
			nav->route_at = i;
			return true;
		}
	}
	for (uint32_t i = nav->route_at; i-- > low;) {
		if (nav->route.halves[i] == nav->match.half) {
			nav->route_at = i;
			return true;
		}
	}
	return false;
}

static void tick_off_stops(struct nav *nav, double speed_mps)
{
	/* Legs of the present route are the stops that were left when it was found. */
	uint32_t first = nav->stop_count - nav->route.leg_count;
	while (nav->stops_reached + 1 < nav->stop_count) {
		uint32_t leg = nav->stops_reached - first;
		if (nav->route_at < nav->route.leg_last[leg] ||
			(nav->route_at == nav->route.leg_last[leg] && nav->match.along_m < nav->route.leg_along_m[leg] - ARRIVED_M))
			break;
		nav->stops_reached++;
	}
	uint32_t last = nav->route.count - 1;
	double rest = nav->route.end_along_m - nav->match.along_m;
	if (nav->route_at == last && (rest < -ARRIVED_M || (rest < ARRIVED_M && fabs(speed_mps) < 0.3)))
		nav_clear_destination(nav);
}

static void follow_route(struct nav *nav, const struct reckon_step *step, double speed_mps)
{
	if (!nav->stop_count || !nav->match.located || !nav->match.on_street)
		return;
	if (nav->failed_m >= 0.0)
		nav->failed_m += fabs(step->distance_m);
	if (nav->routed && find_on_route(nav)) {
		nav->off_route_m = 0.0;
		tick_off_stops(nav, speed_mps);
		return;
	}
	if (nav->routed)
		nav->off_route_m += fabs(step->distance_m);
	if (nav->searching) {
		go_on_searching(nav);
		return;
	}
	bool sure = nav->match.confidence > 0.6;
	bool wanted = !nav->routed || (nav->off_route_m > OFF_ROUTE_M && sure);
	if (wanted && (nav->failed_m < 0.0 || nav->failed_m > RETRY_M))
		begin_search(nav);
}

void nav_advance(struct nav *nav, const struct nav_input *input, int64_t now_ns)
{
	struct reckon_step step = reckon_update(&nav->reckon, &input->motion, now_ns);
	take_heading(nav, input);
	nav->stretch_m += step.distance_m;
	nav->stretch_turn_rad += nav->stretch_turn_rad >= 0.0 ? fabs(step.turn_rad) + (step.gap ? 1.0 : 0.0) : 0.0;
	doubt_grow(nav, input, &step);
	struct match_hints hints = hints_for(nav, input);
	match_update(&nav->match, &nav->reckon, &step, input->motion.yaw_valid, &hints);
	take_fix(nav, input);
	pull(nav, &step);
	doubt_settle(nav, input, &step);
	follow_route(nav, &step, input->motion.speed_valid ? input->motion.speed_mps : 1.0);
}

/* --- the view --- */

static void view_place(struct nav *nav, struct nav_view *out)
{
	out->located = nav->match.located;
	out->on_street = nav->match.located && nav->match.on_street;
	out->pos_mm[0] = nav->reckon.pos_mm[0];
	out->pos_mm[1] = nav->reckon.pos_mm[1];
	out->pos_mm[2] = llrint(nav->height_m * 1e3);
	out->heading_bam = nav->reckon.heading_bam;
	out->speed_mps = nav->reckon.last.speed_valid ? nav->reckon.last.speed_mps : 0.0;
	out->yaw_rate_rps = nav->reckon.last.yaw_valid ? nav->reckon.last.yaw_rate_rps - nav->reckon.yaw_bias_rps : 0.0;
	out->half = nav->match.half;
	out->along_m = nav->match.along_m;
	out->uncertainty_m = nav->match.uncertainty_m;
	doubt_view(nav, &out->doubt);
	out->offset_m = 0.0;
	out->street = 0;
	out->limit_kmh = 0;
	out->limit_posted = false;
	if (!nav->match.located)
		return;
	struct graph_pose pose = graph_at(&nav->graph, nav->match.half, nav->match.along_m);
	struct dvec2 here = reckoned_m(nav);
	out->offset_m = (here.x - pose.at_m.x) * cos(pose.heading_rad) - (here.y - pose.at_m.y) * sin(pose.heading_rad);
	if (!nav->match.on_street)
		return;
	const struct pkg_edge *edge = graph_edge(&nav->graph, nav->match.half);
	out->street = edge->name ? edge->name : edge->ref;
	out->limit_kmh = edge->speed_kmh;
	out->limit_posted = edge->speed_posted;
}

static void view_route(struct nav *nav, struct nav_view *out)
{
	out->routed = nav->routed;
	out->off_route = nav->stop_count && (nav->searching || nav->off_route_m > OFF_ROUTE_M);
	out->reroutes = nav->reroutes;
	out->route_count = 0;
	out->route_complete = false;
	out->route_end_along_m = out->remaining_m = out->remaining_s = 0.0;
	out->next = out->after_next = (struct nav_step){ .from_half = PKG_NONE, .to_half = PKG_NONE };
	if (!nav->routed)
		return;
	uint32_t left = nav->route.count - nav->route_at;
	out->route_count = left < NAV_ROUTE_AHEAD_MAX ? left : NAV_ROUTE_AHEAD_MAX;
	memcpy(out->route, nav->route.halves + nav->route_at, out->route_count * sizeof(*out->route));
	out->route_complete = out->route_count == left;
	out->route_end_along_m = out->route_complete ? nav->route.end_along_m : 0.0;
	bool on_it = nav->route.halves[nav->route_at] == nav->match.half;
	double along = on_it ? nav->match.along_m : graph_length_m(&nav->graph, nav->route.halves[nav->route_at]);
	guidance_remaining(&nav->guidance, nav->route_at, along, &out->remaining_m, &out->remaining_s);
	out->next = guidance_step_ahead(&nav->guidance, nav->route_at, along, 0);
	out->after_next = guidance_step_ahead(&nav->guidance, nav->route_at, along, 1);
}

void nav_snapshot(struct nav *nav, struct nav_view *out)
{
	out->time_ns = nav->reckon.time_ns;
	view_place(nav, out);
	view_route(nav, out);
	out->likely_count = likely_stretches(&nav->graph, nav->pkg, out, out->likely);
}

/* --- the car's signals --- */

static struct nav_input input_from(const struct vehicle_state *vehicle)
{
	return (struct nav_input){
		.motion = {
			.speed_valid = vehicle->speed_usable,
			.speed_mps = vehicle->speed_mps,
			.yaw_valid = vehicle->yaw_source != VEHICLE_YAW_NONE,
			.yaw_biased = vehicle->yaw_source == VEHICLE_YAW_SENSOR,
			.yaw_rate_rps = vehicle->yaw_rate_rps,
		},
		.gear = vehicle->gear,
		.turn_lamp = vehicle->turn_lamp,
		.heading_valid = vehicle->heading_usable,
		.heading_rad = vehicle->heading_rad,
		.fix_valid = vehicle->has_fix,
		.fix_number = vehicle->fixes,
		.lat_deg = vehicle->lat_deg,
		.lon_deg = vehicle->lon_deg,
		.fix_sigma_m = vehicle->fix_sigma_m,
	};
}

static void view_inputs(const struct vehicle_state *vehicle, struct nav_view *out)
{
	out->gear = vehicle->gear;
	out->turn_lamp = vehicle->turn_lamp;
	out->ambient = vehicle->ambient;
	for (int i = 0; i < NAV_SIGNAL_COUNT; i++) {
		out->signal[i] = vehicle->state[i];
		out->signal_age_ns[i] = vehicle->age_ns[i];
	}
}

void nav_without_map(const struct vehicle_state *vehicle, int64_t now_ns, int64_t wall_ns, struct nav_view *out)
{
	*out = (struct nav_view){ .time_ns = now_ns, .wall_ns = wall_ns, .half = PKG_NONE };
	out->next = out->after_next = (struct nav_step){ .from_half = PKG_NONE, .to_half = PKG_NONE };
	view_inputs(vehicle, out);
}

void nav_update(
	struct nav *nav, const struct vehicle_state *vehicle, int64_t now_ns, int64_t wall_ns, struct nav_view *out)
{
	struct nav_input input = input_from(vehicle);
	nav_advance(nav, &input, now_ns);
	if (!out)
		return;
	view_inputs(vehicle, out);
	nav_snapshot(nav, out);
	out->wall_ns = wall_ns;
}
