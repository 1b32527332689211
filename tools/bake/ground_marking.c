/*
 * Paint on the carriageways: centre and lane lines, edge lines, stop lines, give-way rows, zebra crossings. Lines end
 * before junctions and crossings, and are left out wherever another carriageway lies under them.
 */
#include <math.h>
#include <string.h>

#include "tools/bake/ground.h"

#define LINE_M 0.13
#define PIECE_M 4.0 /* lines are checked against other carriageways in pieces */
#define CLEAR_CROSSING_M 2.4
#define SOLID_BEFORE_M 16.0
#define STOP_LINE_M 0.4
#define BAR_M 0.5

enum place_rules {
	RULES_WHITE,
	RULES_YELLOW_CENTRE,    /* North America: yellow parts the directions */
	RULES_YELLOW_CROSSINGS, /* Switzerland */
};

struct marker {
	const struct ground_plan *plan;
	const struct road *road;
	uint32_t index; /* of the road */
	struct soup *soup;
	enum place_rules rules;
	struct road_events events;
	double from, to;            /* own stretch of the road */
	uint32_t forward, backward; /* lanes */
	struct dvec2 *left, *right; /* scratch: a line's borders at the road's points */
};

/* By the city's place alone: good enough for the colour of paint. */
static enum place_rules rules_of(const struct city *city)
{
	double lat = city->frame.origin.lat_deg, lon = city->frame.origin.lon_deg;
	if (lat > 15.0 && lat < 72.0 && lon > -170.0 && lon < -52.0)
		return RULES_YELLOW_CENTRE;
	if (lat > 45.9 && lat < 47.7 && lon > 5.97 && lon < 9.7)
		return RULES_YELLOW_CROSSINGS;
	return RULES_WHITE;
}

static void choose_paint(struct marker *marker, bool yellow)
{
	marker->soup->material = (uint8_t)(yellow ? MATERIAL_MARKING_YELLOW : MATERIAL_MARKING);
}

/* ---- strips along the road ---- */

static struct dvec2 between(struct dvec2 a, struct dvec2 b, double t)
{
	return dvec2_add(a, dvec2_scale(dvec2_sub(b, a), t));
}

static void lay_quad(struct marker *marker, const struct dvec2 corners[4], const double z[2])
{
	const struct road *road = marker->road;
	if (road->course == ROAD_GROUND) {
		soup_drape(marker->soup, marker->plan->city, corners, 4, 0.0);
		return;
	}
	double scale = material_scale(marker->soup->material);
	uint32_t at[4];
	for (int i = 0; i < 4; i++) /* corners: right at z[0], right at z[1], left at z[1], left at z[0] */
		at[i] = soup_vertex(marker->soup, (struct dvec3){ corners[i].x, corners[i].y, z[i == 1 || i == 2] },
			(struct vec3){ 0, 0, 1 }, corners[i].x / scale, corners[i].y / scale);
	soup_rebase(marker->soup, at[0]);
	soup_triangle(marker->soup, at[0], at[1], at[2]);
	soup_triangle(marker->soup, at[0], at[2], at[3]);
}

/* From s0 to s1 along the road, between two offsets to the left (low < high). */
static void lay_strip(struct marker *marker, double s0, double s1, double low, double high)
{
	const struct road *road = marker->road;
	road_offset(road, high, marker->left);
	road_offset(road, low, marker->right);
	for (size_t k = 0; k + 1 < road->count; k++) {
		double length = road->along[k + 1] - road->along[k];
		double a = fmax(s0, road->along[k]), b = fmin(s1, road->along[k + 1]);
		if (b - a < 0.01 || length < 1e-6)
			continue;
		double ta = (a - road->along[k]) / length, tb = (b - road->along[k]) / length;
		const struct dvec2 corners[4] = { between(marker->right[k], marker->right[k + 1], ta),
			between(marker->right[k], marker->right[k + 1], tb), between(marker->left[k], marker->left[k + 1], tb),
			between(marker->left[k], marker->left[k + 1], ta) };
		double za = road->points[k].z, zb = road->points[k + 1].z;
		const double z[2] = { za + ta * (zb - za), za + tb * (zb - za) };
		lay_quad(marker, corners, z);
	}
}

static struct dvec2 place_at(const struct road *road, double along, double offset)
{
	struct dvec2 direction;
	struct dvec3 at = road_at(road, along, &direction);
	return (struct dvec2){ at.x - direction.y * offset, at.y + direction.x * offset };
}

static bool is_free(const struct marker *marker, double along, double offset)
{
	if (marker->road->course != ROAD_GROUND)
		return true;
	return !ground_on_road(marker->plan, place_at(marker->road, along, offset), -0.25, marker->road->edge);
}

/* Lays what is free of a stretch. */
static void lay_free(struct marker *marker, double s0, double s1, double offset)
{
	int pieces = (int)fmax(ceil((s1 - s0) / PIECE_M), 1.0);
	double open = NAN;
	for (int i = 0; i <= pieces; i++) {
		double from = s0 + (s1 - s0) * i / pieces, middle = from + (s1 - s0) / pieces / 2.0;
		bool free = i < pieces && is_free(marker, middle, offset);
		if (free && isnan(open))
			open = from;
		if (!free && !isnan(open)) {
			lay_strip(marker, open, from, offset - LINE_M / 2.0, offset + LINE_M / 2.0);
			open = NAN;
		}
	}
}

/* ---- lines ---- */

static double next_obstacle(const struct marker *marker, double from, double *end)
{
	double nearest = INFINITY;
	for (size_t i = 0; i < marker->events.count; i++) {
		const struct road_event *event = &marker->events.items[i];
		double start = event->along_m - CLEAR_CROSSING_M;
		if (event->flags != PKG_NODE_CROSSING || event->along_m + CLEAR_CROSSING_M <= from || start >= nearest)
			continue;
		nearest = start;
		*end = event->along_m + CLEAR_CROSSING_M;
	}
	return nearest;
}

struct line_style {
	double dash_m, gap_m; /* gap 0: solid */
	double solid_to_m;    /* from the start of the stretch, solid up to here */
	double solid_from_m;  /* and from here on */
};

static void lay_line_between(struct marker *marker, double s0, double s1, double offset, const struct line_style *style)
{
	if (style->gap_m == 0.0) {
		lay_free(marker, s0, s1, offset);
		return;
	}
	double period = style->dash_m + style->gap_m;
	/* Dashes keep their rhythm along the whole road, so that parallel lines step together. */
	for (double s = floor(s0 / period) * period; s < s1; s += period) {
		double a = fmax(s, s0), b = fmin(s + style->dash_m, s1);
		if (b - a > 0.8)
			lay_free(marker, a, b, offset);
	}
	if (style->solid_to_m > s0)
		lay_free(marker, s0, fmin(style->solid_to_m, s1), offset);
	if (style->solid_from_m < s1)
		lay_free(marker, fmax(style->solid_from_m, s0), s1, offset);
}

static void lay_line(struct marker *marker, double offset, const struct line_style *style)
{
	double at = marker->from + 0.3;
	while (at < marker->to - 0.3) {
		double end = at, obstacle = next_obstacle(marker, at, &end);
		double stop = fmin(obstacle, marker->to - 0.3);
		if (stop - at > 1.0)
			lay_line_between(marker, at, stop, offset, style);
		if (obstacle >= marker->to)
			break;
		at = end;
	}
}

static bool has_stop(const struct marker *marker, bool forward)
{
	for (size_t i = 0; i < marker->events.count; i++)
		if (marker->events.items[i].flags != PKG_NODE_CROSSING &&
			(forward ? marker->events.items[i].forward : marker->events.items[i].backward))
			return true;
	return false;
}

static double centre_offset(const struct marker *marker)
{
	double width = 2.0 * marker->road->half_width_m, lanes = marker->forward + marker->backward;
	double forward_width = width * marker->forward / lanes;
	double right = marker->plan->city->right_hand_traffic ? 1.0 : -1.0;
	return right * (forward_width - marker->road->half_width_m);
}

static void lay_lane_lines(struct marker *marker)
{
	const struct road *road = marker->road;
	uint32_t lanes = marker->forward + marker->backward;
	double lane = 2.0 * road->half_width_m / lanes, centre = centre_offset(marker);
	bool main_street = road->street_class <= PKG_STREET_TERTIARY;
	bool wide = road->street_class <= PKG_STREET_RESIDENTIAL && road->half_width_m >= 3.1;
	if ((!main_street && !wide) || lane < 2.1)
		return;
	bool stop_at_end = has_stop(marker, true), stop_at_start = has_stop(marker, false);
	for (uint32_t k = 1; k < lanes; k++) {
		double offset = -road->half_width_m + k * lane;
		bool parts = fabs(offset - centre) < 0.01 && marker->forward && marker->backward;
		struct line_style style = { 3.0, 6.0, -INFINITY, INFINITY };
		if (!parts && lane < 2.5)
			continue;
		if (stop_at_end && (parts || offset < centre || !marker->backward))
			style.solid_from_m = marker->to - SOLID_BEFORE_M;
		if (stop_at_start && (parts || offset > centre || !marker->forward))
			style.solid_to_m = marker->from + SOLID_BEFORE_M;
		if (parts && lanes >= 4)
			style.gap_m = 0.0;
		choose_paint(marker, parts && marker->rules == RULES_YELLOW_CENTRE);
		lay_line(marker, offset, &style);
	}
}

static void lay_edge_lines(struct marker *marker)
{
	const struct road *road = marker->road;
	if (road->street_class > PKG_STREET_PRIMARY || road->side_left_m > 0.0 || road->side_right_m > 0.0 ||
		road->half_width_m < 3.0)
		return;
	choose_paint(marker, false);
	const struct line_style solid = { 3.0, 0.0, -INFINITY, INFINITY };
	lay_line(marker, road->half_width_m - 0.35, &solid);
	lay_line(marker, 0.35 - road->half_width_m, &solid);
}

/* ---- across the road ---- */

static void lay_crossing(struct marker *marker, double along)
{
	const struct road *road = marker->road;
	double usable = 2.0 * (road->half_width_m - 0.25);
	int bars = (int)floor((usable + BAR_M) / (2.0 * BAR_M));
	double first = -(bars - 0.5) * BAR_M;
	double s0 = fmax(along - CROSSING_HALF_M, 0.0), s1 = fmin(along + CROSSING_HALF_M, road_length(road));
	if (road->street_class > PKG_STREET_LIVING || bars < 2 || s1 - s0 < 1.0)
		return;
	choose_paint(marker, marker->rules == RULES_YELLOW_CROSSINGS);
	/* at a joint of edges the next one is no other street */
	double inside = fmin(fmax(along, 0.9), road_length(road) - 0.9);
	for (int i = 0; i < bars; i++) {
		double low = first + 2.0 * BAR_M * i;
		if (is_free(marker, inside, low + BAR_M / 2.0))
			lay_strip(marker, s0, s1, low, low + BAR_M);
	}
}

/* The lanes of those who stop: between two offsets. */
static void stopping_lanes(const struct marker *marker, bool forward, double *low, double *high)
{
	double half_width = marker->road->half_width_m, centre = centre_offset(marker);
	bool right = forward == marker->plan->city->right_hand_traffic;
	*low = right ? -half_width + 0.2 : centre + 0.1;
	*high = right ? centre - 0.1 : half_width - 0.2;
}

static void lay_stop(struct marker *marker, double along, bool forward, bool teeth)
{
	double low, high;
	stopping_lanes(marker, forward, &low, &high);
	double s0 = forward ? along - STOP_LINE_M : along, s1 = s0 + STOP_LINE_M;
	if (high - low < 1.0 || s0 < marker->from - 4.0 || s1 > marker->to + 4.0 || s0 < 0.0 ||
		s1 > road_length(marker->road) || !is_free(marker, s0, (low + high) / 2.0))
		return;
	choose_paint(marker, false);
	if (!teeth) {
		lay_strip(marker, s0, s1, low, high);
		return;
	}
	if (marker->road->course != ROAD_GROUND)
		return;
	int count = (int)((high - low) / 0.9);
	for (int i = 0; i < count; i++) {
		double left = low + (high - low) * (i + 0.85) / count, right = low + (high - low) * (i + 0.15) / count;
		double tip = forward ? along - 0.65 : along + 0.65;
		struct dvec2 corners[3] = { place_at(marker->road, along, left), place_at(marker->road, along, right),
			place_at(marker->road, tip, (left + right) / 2.0) };
		if (dvec2_cross(dvec2_sub(corners[1], corners[0]), dvec2_sub(corners[2], corners[0])) < 0.0) {
			struct dvec2 swap = corners[1];
			corners[1] = corners[2];
			corners[2] = swap;
		}
		soup_drape(marker->soup, marker->plan->city, corners, 3, 0.0);
	}
}

static void lay_events(struct marker *marker)
{
	for (size_t i = 0; i < marker->events.count; i++) {
		const struct road_event *event = &marker->events.items[i];
		if (event->flags == PKG_NODE_CROSSING) {
			lay_crossing(marker, event->along_m);
			continue;
		}
		bool teeth = event->flags == PKG_NODE_GIVE_WAY;
		if (marker->road->street_class > PKG_STREET_LIVING)
			continue;
		if (event->forward)
			lay_stop(marker, ground_stop_place(marker->plan, marker->index, event->along_m, true), true, teeth);
		if (event->backward)
			lay_stop(marker, ground_stop_place(marker->plan, marker->index, event->along_m, false), false, teeth);
	}
}

static void mark_road(struct marker *marker)
{
	const struct pkg_edge *edge = &marker->plan->graph->edges[marker->road->edge];
	marker->forward = edge->flags & PKG_EDGE_FORWARD ? (edge->lanes_forward ? edge->lanes_forward : 1u) : 0u;
	marker->backward = edge->flags & PKG_EDGE_BACKWARD ? (edge->lanes_backward ? edge->lanes_backward : 1u) : 0u;
	if (!marker->forward && !marker->backward)
		return;
	marker->left = array_grow(NULL, &(size_t){ 0 }, 2 * marker->road->count, sizeof(*marker->left));
	marker->right = marker->left + marker->road->count;
	marker->events = ground_events_of(marker->plan, marker->index);
	ground_own_stretch(marker->plan, marker->road, &marker->from, &marker->to);
	if (marker->road->region < REGION_ROAD_COBBLE) {
		lay_lane_lines(marker);
		lay_edge_lines(marker);
	}
	lay_events(marker);
	array_free(marker->left);
}

void ground_markings_build(const struct ground_plan *plan, struct soup *soup)
{
	soup->pass = PKG_PASS_DECAL;
	soup->kind = PKG_OBJECT_GROUND;
	soup->ao = 1.0f;
	memset(soup->rgb, 255, sizeof(soup->rgb));
	enum place_rules rules = rules_of(plan->city);
	for (uint32_t i = 0; i < plan->roads.count; i++) {
		struct marker marker = {
			.plan = plan, .road = &plan->roads.items[i], .index = i, .soup = soup, .rules = rules
		};
		if (marker.road->edge != PKG_NONE)
			mark_road(&marker);
	}
}
