/* Streets, paths and tracks as roads: cut where they leave the ground, with sidewalks where the town is, and with what
 * they share at junctions. */
#include "tools/bake/ground.h"

#include <math.h>
#include <stdlib.h>

#define SAMPLE_M 4.0
#define DECK_PIECE_M 14.0
#define BURIED_M 0.5
#define DECK_SIDE_MAX_M 4.5
#define DECK_SAME_M 1.0   /* higher or lower is another deck */
#define GROUND_GAP_M 10.0 /* a shorter touch of the ground between two ramps is no street on the ground */
#define TRIM_MAX_M 30.0
#define TANGENT_MAX_M 9.0
#define ARM_LOOK_M 14.0 /* the heading of a junction's arm is that of its first metres */
#define FOOT_MIN_WIDTH_M 1.6
#define BALLAST_HALF_M 1.9

struct dvec3 road_at(const struct road *road, double along_m, struct dvec2 *direction)
{
	size_t k = 0;
	while (k + 2 < road->count && road->along[k + 1] < along_m)
		k++;
	struct dvec3 a = road->points[k], b = road->points[k + 1];
	double length = road->along[k + 1] - road->along[k];
	double t = length > 0.0 ? fmin(fmax((along_m - road->along[k]) / length, 0.0), 1.0) : 0.0;
	if (direction)
		*direction =
			length > 0.0 ? (struct dvec2){ (b.x - a.x) / length, (b.y - a.y) / length } : (struct dvec2){ 1.0, 0.0 };
	return (struct dvec3){ a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z) };
}

static struct dvec2 unit(struct dvec2 v)
{
	double length = dvec2_length(v);
	return length > 1e-9 ? dvec2_scale(v, 1.0 / length) : (struct dvec2){ 1.0, 0.0 };
}

void road_offset(const struct road *road, double left_m, struct dvec2 *out)
{
	for (size_t i = 0; i < road->count; i++) {
		const struct dvec3 *at = &road->points[i];
		size_t before = i ? i - 1 : 0, after = i + 1 < road->count ? i + 1 : i;
		struct dvec2 in = { at->x - road->points[before].x, at->y - road->points[before].y };
		struct dvec2 on = { road->points[after].x - at->x, road->points[after].y - at->y };
		in = unit(i ? in : on);
		on = unit(i + 1 < road->count ? on : in);
		struct dvec2 mid = unit(dvec2_add(in, on));
		double stretch = 1.0 / fmax(dvec2_dot(mid, on), 0.5);
		out[i] = (struct dvec2){ at->x - mid.y * left_m * stretch, at->y + mid.x * left_m * stretch };
	}
}

/* ---- cutting into courses ---- */

struct sample {
	struct dvec3 at;
	double along;
	int course;
};
typedef ARRAY(struct sample) sample_array;

/* `relative`: the points' z are rises above the ground, between them too. */
static void sample_line(const struct city *city, const struct dvec3 *points, size_t count, const struct road *about,
	bool relative, sample_array *out)
{
	double along = 0.0;
	for (size_t i = 0; i < count; i++) {
		struct dvec3 a = points[i ? i - 1 : 0], b = points[i];
		double length = hypot(b.x - a.x, b.y - a.y);
		int steps = i ? (int)fmax(ceil(length / SAMPLE_M), 1.0) : 1;
		if (i && length < 1e-6)
			continue;
		for (int s = 1; s <= steps; s++) {
			double t = (double)s / steps;
			struct dvec3 at = { a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z) };
			double ground = city_ground(city, (struct dvec2){ at.x, at.y });
			if (relative)
				at.z += ground;
			double rise = at.z - ground;
			/* a bridge that a coarse terrain buries is a cut all the same */
			bool deck = rise > SLACK_M || (about->bridge && rise > -BURIED_M);
			int course = deck ? ROAD_DECK : rise < -SLACK_M ? ROAD_CUT : ROAD_GROUND;
			if (about->tunnel && course == ROAD_DECK)
				course = ROAD_GROUND;
			ARRAY_PUSH(out, (struct sample){ at, along + t * length, course });
		}
		along += length;
	}
}

static size_t run_end(const sample_array *samples, size_t from)
{
	size_t to = from;
	while (to + 1 < samples->count && samples->items[to + 1].course == samples->items[from].course)
		to++;
	return to;
}

static double run_height(const struct city *city, const sample_array *samples, size_t from, size_t to)
{
	double most = 0.0;
	for (size_t i = from; i <= to; i++) {
		struct dvec3 at = samples->items[i].at;
		most = fmax(most, fabs(at.z - city_ground(city, (struct dvec2){ at.x, at.y })));
	}
	return most;
}

static void set_run(sample_array *samples, size_t from, size_t to, int course)
{
	for (size_t i = from; i <= to; i++)
		samples->items[i].course = course;
}

/* Drops runs that are not worth a structure, then gaps between structures. */
static void settle_courses(const struct city *city, sample_array *samples, bool bridge)
{
	for (size_t from = 0, to; from < samples->count && !bridge; from = to + 1) {
		to = run_end(samples, from);
		if (samples->items[from].course != ROAD_GROUND && run_height(city, samples, from, to) < 0.35)
			set_run(samples, from, to, ROAD_GROUND);
	}
	for (size_t from = 0, to; from < samples->count; from = to + 1) {
		to = run_end(samples, from);
		if (samples->items[from].course != ROAD_GROUND || !from || to + 1 >= samples->count)
			continue;
		if (samples->items[to].along - samples->items[from].along < GROUND_GAP_M &&
			samples->items[from - 1].course == samples->items[to + 1].course)
			set_run(samples, from, to, samples->items[from - 1].course);
	}
}

/* Does the line go on straight from a over b to c? Heights count on decks, whose pieces stay short, too. */
static bool is_even(const struct dvec3 *a, const struct dvec3 *b, const struct dvec3 *c, bool deck)
{
	double length = hypot(c->x - a->x, c->y - a->y), first = hypot(b->x - a->x, b->y - a->y);
	double bend = fabs((b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x));
	if (bend >= 0.01 * length)
		return false;
	double z = a->z + (c->z - a->z) * first / fmax(length, 1e-6);
	return !deck || (length < DECK_PIECE_M && fabs(z - b->z) < 0.005);
}

/* Adds samples [from, to] as a road. Points on a straight line are left out, but in cuts. */
static void add_road(
	struct ground_plan *plan, const struct road *about, const sample_array *samples, size_t from, size_t to)
{
	struct road road = *about;
	size_t count = to - from + 1;
	if (count < 2)
		return;
	road.points = POOL_ARRAY(&plan->pool, struct dvec3, count);
	road.along = POOL_ARRAY(&plan->pool, double, count);
	road.course = samples->items[from].course == samples->items[to].course ? (enum road_course)samples->items[to].course
																		   : about->course;
	road.edge_start_m = samples->items[from].along;
	for (size_t i = from; i <= to; i++) {
		const struct sample *sample = &samples->items[i];
		if (road.course != ROAD_CUT && i > from && i < to &&
			is_even(&road.points[road.count - 1], &sample->at, &samples->items[i + 1].at, road.course == ROAD_DECK))
			continue;
		road.points[road.count] = sample->at;
		road.along[road.count++] = sample->along - road.edge_start_m;
	}
	/* A ramp meets the street on the ground without a step. */
	if (road.course != ROAD_GROUND && road.starts_open)
		road.points[0].z = city_ground(plan->city, (struct dvec2){ road.points[0].x, road.points[0].y });
	struct dvec3 *end = &road.points[road.count - 1];
	if (road.course != ROAD_GROUND && road.ends_open)
		end->z = city_ground(plan->city, (struct dvec2){ end->x, end->y });
	road.min = road.max = (struct dvec2){ road.points[0].x, road.points[0].y };
	for (size_t i = 1; i < road.count; i++) {
		road.min = (struct dvec2){ fmin(road.min.x, road.points[i].x), fmin(road.min.y, road.points[i].y) };
		road.max = (struct dvec2){ fmax(road.max.x, road.points[i].x), fmax(road.max.y, road.points[i].y) };
	}
	ARRAY_PUSH(&plan->roads, road);
}

/* The deck of a street that a place lies on or beside, or NULL; `*left` tells how far from its centre line. */
static struct road *street_deck_at(struct ground_plan *plan, struct dvec3 at, double *left)
{
	for (size_t i = 0; i < plan->roads.count; i++) {
		struct road *road = &plan->roads.items[i];
		double reach = road->half_width_m + DECK_SIDE_MAX_M;
		if (road->course != ROAD_DECK || road->edge == PKG_NONE || at.x < road->min.x - reach ||
			at.x > road->max.x + reach || at.y < road->min.y - reach || at.y > road->max.y + reach)
			continue;
		for (size_t k = 0; k + 1 < road->count; k++) {
			struct dvec3 a = road->points[k], b = road->points[k + 1];
			struct dvec2 d = unit((struct dvec2){ b.x - a.x, b.y - a.y }), p = { at.x - a.x, at.y - a.y };
			double along = dvec2_dot(p, d),
				   z = a.z + (b.z - a.z) * along / fmax(road->along[k + 1] - road->along[k], 0.1);
			*left = dvec2_cross(d, p);
			if (along >= -1.0 && along <= road->along[k + 1] - road->along[k] + 1.0 && fabs(*left) < reach &&
				fabs(at.z - z) < DECK_SAME_M)
				return road;
		}
	}
	return NULL;
}

/* Walkways on a street's bridge are its sidewalks, which widen for them. */
static void absorb_walkways(struct ground_plan *plan, sample_array *samples, double half_width)
{
	for (size_t i = 0; i < samples->count; i++) {
		double left = 0.0;
		struct road *deck =
			samples->items[i].course == ROAD_DECK ? street_deck_at(plan, samples->items[i].at, &left) : NULL;
		if (!deck)
			continue;
		double *side = left > 0.0 ? &deck->side_left_m : &deck->side_right_m;
		*side = fmax(*side, fmin(fabs(left) + half_width - deck->half_width_m, DECK_SIDE_MAX_M));
		samples->items[i].course = ROAD_ABSORBED;
	}
}

static void add_line(
	struct ground_plan *plan, const struct road *about, const struct dvec3 *points, size_t count, bool relative)
{
	sample_array samples = { 0 };
	sample_line(plan->city, points, count, about, relative, &samples);
	settle_courses(plan->city, &samples, about->bridge);
	if (about->edge == PKG_NONE)
		absorb_walkways(plan, &samples, about->half_width_m);
	for (size_t from = 0, to; from < samples.count; from = to) {
		to = run_end(&samples, from);
		struct road road = *about;
		road.course = (enum road_course)samples.items[from].course;
		/* A stretch off the ground reaches to the first sample on it, so that nothing is left between. */
		size_t first = from, last = to;
		if (road.course != ROAD_GROUND) {
			first = from && samples.items[from - 1].course == ROAD_GROUND ? from - 1 : from;
			last = to + 1 < samples.count ? to + 1 : to;
			road.starts_open = first < from;
			road.ends_open = last > to && samples.items[last].course == ROAD_GROUND;
		}
		int keep_first = samples.items[first].course, keep_last = samples.items[last].course;
		samples.items[first].course = samples.items[last].course = (int)road.course;
		if (road.course != ROAD_ABSORBED)
			add_road(plan, &road, &samples, first, last);
		samples.items[first].course = keep_first;
		samples.items[last].course = keep_last;
		to++;
		if (to >= samples.count)
			break;
	}
	ARRAY_FINISH(&samples);
}

/* ---- what a street looks like ---- */

struct way_by_id {
	int64_t id;
	const struct way *way;
};

static int compare_ways(const void *left, const void *right)
{
	const struct way_by_id *a = left, *b = right;
	if (a->id != b->id)
		return a->id < b->id ? -1 : 1;
	return (a->way > b->way) - (a->way < b->way);
}

static void find_edge_ways(struct ground_plan *plan)
{
	size_t count = plan->city->ways.count;
	struct way_by_id *sorted = array_grow(NULL, &(size_t){ 0 }, count + 1, sizeof(*sorted));
	for (size_t i = 0; i < count; i++)
		sorted[i] = (struct way_by_id){ plan->city->ways.items[i].id, &plan->city->ways.items[i] };
	qsort(sorted, count, sizeof(*sorted), compare_ways);
	plan->edge_ways = POOL_ARRAY(&plan->pool, const struct way *, plan->graph->edge_count + 1);
	for (uint32_t e = 0; e < plan->graph->edge_count; e++) {
		size_t low = 0, high = count;
		while (low < high) {
			size_t mid = (low + high) / 2;
			if (sorted[mid].id < plan->graph->edges[e].source_id)
				low = mid + 1;
			else
				high = mid;
		}
		if (low < count && sorted[low].id == plan->graph->edges[e].source_id)
			plan->edge_ways[e] = sorted[low].way;
	}
	array_free(sorted);
}

static enum ground_region street_region(int street_class, const struct way *way)
{
	enum way_surface surface = way ? way->surface : SURFACE_ASPHALT;
	if (surface == SURFACE_GRAVEL || surface == SURFACE_GROUND)
		return REGION_ROAD_GRAVEL;
	/* paving on a main road is concrete */
	if (surface == SURFACE_PAVED && street_class <= PKG_STREET_TERTIARY)
		return REGION_ROAD_OLD;
	if (surface == SURFACE_COBBLE || surface == SURFACE_PAVED)
		return REGION_ROAD_COBBLE;
	return street_class <= PKG_STREET_TERTIARY ? REGION_ROAD : REGION_ROAD_OLD;
}

static double sidewalk_width(int street_class)
{
	switch (street_class) {
	case PKG_STREET_PRIMARY:
	case PKG_STREET_SECONDARY:
		return 3.2;
	case PKG_STREET_TERTIARY:
		return 2.8;
	case PKG_STREET_UNCLASSIFIED:
	case PKG_STREET_RESIDENTIAL:
	case PKG_STREET_LIVING:
		return 2.2;
	default:
		return 0.0;
	}
}

static bool along_town(const struct ground_plan *plan, const struct dvec3 *points, size_t count)
{
	size_t built = 0;
	for (size_t i = 0; i < count; i++)
		built += ground_is_built_up(plan, (struct dvec2){ points[i].x, points[i].y });
	return built * 2 >= count;
}

static void add_edge_road(struct ground_plan *plan, uint32_t e)
{
	const struct pkg_edge *edge = &plan->graph->edges[e];
	const struct way *way = plan->edge_ways[e];
	struct dvec3 *points = array_grow(NULL, &(size_t){ 0 }, edge->point_count, sizeof(*points));
	for (uint32_t i = 0; i < edge->point_count; i++) {
		const int32_t *mm = plan->graph->points[edge->first_point + i].pos_mm;
		points[i] = (struct dvec3){ mm[0] / 1000.0, mm[1] / 1000.0, mm[2] / 1000.0 };
	}
	struct road about = {
		.half_width_m = fmax(edge->width_mm / 2000.0, 1.2),
		.region = street_region(edge->street_class, way),
		.street_class = edge->street_class,
		.bridge = edge->flags & PKG_EDGE_BRIDGE,
		.tunnel = edge->flags & PKG_EDGE_TUNNEL,
		.edge = e,
		.way = way,
	};
	double side = sidewalk_width(edge->street_class);
	if (about.bridge && side > 0.0)
		about.side_left_m = about.side_right_m = 1.8;
	if (side > 0.0 && along_town(plan, points, edge->point_count)) {
		about.side_left_m = !way || way->sidewalk_left ? side : 0.0;
		about.side_right_m = !way || way->sidewalk_right ? side : 0.0;
	}
	add_line(plan, &about, points, edge->point_count, false);
	array_free(points);
}

static enum ground_region path_region(const struct way *way)
{
	switch (way->street_class) {
	case WAY_PEDESTRIAN:
		return REGION_PEDESTRIAN;
	case WAY_CYCLE:
		return REGION_CYCLE;
	case WAY_STEPS:
		return REGION_STEPS;
	case WAY_TRACK:
		return way->surface == SURFACE_ASPHALT ? REGION_CYCLE : REGION_PATH_GRAVEL;
	case WAY_RAIL:
		return REGION_RAIL;
	case WAY_TRAM:
		return REGION_COUNT;
	case WAY_FOOT:
		if (way->is_sidewalk || way->is_crossing)
			return REGION_SIDEWALK;
		return way->surface == SURFACE_GRAVEL || way->surface == SURFACE_GROUND ? REGION_PATH_GRAVEL : REGION_PATH;
	default:
		return street_region(way->street_class, way);
	}
}

static void add_way_road(struct ground_plan *plan, const struct way *way)
{
	/* Walkers' and trains' tunnels are not shown; their ramps lie flat. */
	bool below = way->tunnel;
	if (way->drivable || way->node_count < 2 || below)
		return;
	struct dvec3 *points = array_grow(NULL, &(size_t){ 0 }, way->node_count, sizeof(*points));
	for (size_t i = 0; i < way->node_count; i++) {
		struct dvec2 at = way->nodes[i].at;
		double ground = city_ground(plan->city, at), rise = way->z_m ? fmax(way->z_m[i] - ground, 0.0) : 0.0;
		points[i] = (struct dvec3){ at.x, at.y, way->bridge ? ground + rise : rise };
	}
	bool rail = way->street_class == WAY_RAIL || way->street_class == WAY_TRAM;
	struct road about = {
		.half_width_m = rail ? BALLAST_HALF_M : fmax(way->width_m, FOOT_MIN_WIDTH_M) / 2.0,
		.region = path_region(way),
		.street_class = way->street_class,
		.bridge = way->bridge,
		.tunnel = way->tunnel,
		.edge = PKG_NONE,
		.way = way,
	};
	add_line(plan, &about, points, way->node_count, !way->bridge);
	array_free(points);
}

/* ---- junctions ---- */

struct arm {
	uint32_t half;
	struct dvec2 direction;
	double half_width, length;
	bool off_ground;
	int street_class;
};

/* Walks a half-edge's points from its origin until ARM_LOOK_M from `from`; returns the length walked. `*to` is where it
 * ended, relative to `from`. */
static double walk_half(
	const struct pkg_graph *graph, uint32_t half, const int32_t *from, double length, struct dvec2 *to)
{
	const struct pkg_edge *edge = &graph->edges[half / 2];
	const struct pkg_point *points = graph->points + edge->first_point;
	uint32_t last = edge->point_count - 1;
	for (uint32_t i = 1; i <= last && length < ARM_LOOK_M; i++) {
		const int32_t *mm = points[half & 1 ? last - i : i].pos_mm;
		struct dvec2 at = { (mm[0] - from[0]) / 1000.0, (mm[1] - from[1]) / 1000.0 };
		length += dvec2_length(dvec2_sub(at, *to));
		*to = at;
	}
	return length;
}

/* The half-edge that goes on where this one ends, when nothing else does; or PKG_NONE. */
static uint32_t continuation(const struct pkg_graph *graph, uint32_t half)
{
	const struct pkg_node *end = &graph->nodes[graph->halves[half ^ 1].origin];
	if (end->out_count != 2)
		return PKG_NONE;
	uint32_t first = graph->outs[end->first_out], second = graph->outs[end->first_out + 1];
	return first == (half ^ 1) ? second : first;
}

static struct arm arm_of(const struct ground_plan *plan, uint32_t half)
{
	const struct pkg_graph *graph = plan->graph;
	const struct pkg_edge *edge = &graph->edges[half / 2];
	const int32_t *from = graph->nodes[graph->halves[half].origin].pos_mm;
	struct dvec2 to = { 0, 0 };
	double length = walk_half(graph, half, from, 0.0, &to);
	uint32_t next = half;
	for (int i = 0; i < 3 && length < ARM_LOOK_M && (next = continuation(graph, next)) != PKG_NONE; i++)
		length = walk_half(graph, next, from, length, &to);
	struct arm arm = { .half = half,
		.half_width = fmax(edge->width_mm / 2000.0, 1.2),
		.length = length,
		.street_class = edge->street_class };
	arm.direction = unit(to);
	double rise = from[2] / 1000.0 - city_ground(plan->city, (struct dvec2){ from[0] / 1000.0, from[1] / 1000.0 });
	arm.off_ground = fabs(rise) > 2.0 * SLACK_M || edge->flags & (PKG_EDGE_BRIDGE | PKG_EDGE_TUNNEL);
	return arm;
}

static double corner_radius(int class_a, int class_b)
{
	int minor = class_a > class_b ? class_a : class_b, major = class_a > class_b ? class_b : class_a;
	if (minor >= PKG_STREET_SERVICE)
		return 2.5;
	return major <= PKG_STREET_SECONDARY ? 5.5 : 4.0;
}

/* The corner between arm a and the next one counter-clockwise: how far along each the carriageways are one, and the
 * rounding beyond. */
static void join_arms(struct ground_plan *plan, struct dvec2 node, const struct arm *a, const struct arm *b)
{
	double cosine = dvec2_dot(a->direction, b->direction), sine = dvec2_cross(a->direction, b->direction);
	double angle = atan2(sine, cosine);
	if (angle < 0.0)
		angle += 2.0 * BLVD_PI;
	if (angle > BLVD_PI * 0.94)
		return;
	double reach_a = TRIM_MAX_M, reach_b = TRIM_MAX_M;
	if (sine > 0.05) {
		reach_a = fmin((b->half_width + a->half_width * cosine) / sine, TRIM_MAX_M);
		reach_b = fmin((a->half_width + b->half_width * cosine) / sine, TRIM_MAX_M);
	}
	reach_a = fmax(reach_a, 0.0);
	reach_b = fmax(reach_b, 0.0);
	/* the largest rounding that the arms have room for */
	double room = fmin(fmin(a->length - reach_a, b->length - reach_b) - 0.1, TANGENT_MAX_M);
	double radius = fmin(corner_radius(a->street_class, b->street_class), room * tan(angle / 2.0));
	double tangent = radius / tan(angle / 2.0);
	bool round = angle > 0.45 && angle < 2.7 && !a->off_ground && !b->off_ground && radius > 0.5;
	double rounding = round ? tangent * 0.7 : 0.0;
	plan->half_trim_m[a->half] = fmax(plan->half_trim_m[a->half], reach_a + rounding);
	plan->half_trim_m[b->half] = fmax(plan->half_trim_m[b->half], reach_b + rounding);
	if (!round)
		return;
	struct dvec2 left = { -a->direction.y, a->direction.x }, right = { b->direction.y, -b->direction.x };
	struct dvec2 along_a = dvec2_add(node, dvec2_scale(a->direction, reach_a + tangent));
	struct dvec2 along_b = dvec2_add(node, dvec2_scale(b->direction, reach_b + tangent));
	struct dvec2 touch_a = dvec2_add(along_a, dvec2_scale(left, a->half_width));
	struct dvec2 touch_b = dvec2_add(along_b, dvec2_scale(right, b->half_width));
	struct dvec2 centre = dvec2_add(touch_a, dvec2_scale(left, radius));
	struct corner corner = { .region = street_region(a->street_class, plan->edge_ways[a->half / 2]) };
	enum ground_region other = street_region(b->street_class, plan->edge_ways[b->half / 2]);
	if (other < corner.region)
		corner.region = other;
	double from = atan2(touch_a.y - centre.y, touch_a.x - centre.x);
	double sweep = remainder(atan2(touch_b.y - centre.y, touch_b.x - centre.x) - from, 2.0 * BLVD_PI);
	int steps = 3 + (int)(fabs(sweep) / 0.4);
	steps = steps > 9 ? 9 : steps;
	corner.points[corner.count++] = node;
	corner.points[corner.count++] = along_a;
	for (int i = 0; i <= steps; i++) {
		double turn = from + sweep * i / steps;
		corner.points[corner.count++] = (struct dvec2){ centre.x + radius * cos(turn), centre.y + radius * sin(turn) };
	}
	corner.points[corner.count++] = along_b;
	ARRAY_PUSH(&plan->corners, corner);
}

static int compare_arms(const void *left, const void *right)
{
	const struct arm *a = left, *b = right;
	double heading_a = atan2(a->direction.y, a->direction.x), heading_b = atan2(b->direction.y, b->direction.x);
	if (heading_a != heading_b)
		return heading_a < heading_b ? -1 : 1;
	return (a->half > b->half) - (a->half < b->half);
}

static void join_streets(struct ground_plan *plan)
{
	enum { ARMS_MAX = 32 };
	plan->half_trim_m = POOL_ARRAY(&plan->pool, double, plan->graph->half_count + 1);
	for (uint32_t n = 0; n < plan->graph->node_count; n++) {
		const struct pkg_node *node = &plan->graph->nodes[n];
		if (node->out_count < 2 || node->out_count > ARMS_MAX)
			continue;
		struct arm arms[ARMS_MAX];
		for (uint32_t i = 0; i < node->out_count; i++)
			arms[i] = arm_of(plan, plan->graph->outs[node->first_out + i]);
		qsort(arms, node->out_count, sizeof(*arms), compare_arms);
		struct dvec2 at = { node->pos_mm[0] / 1000.0, node->pos_mm[1] / 1000.0 };
		for (uint32_t i = 0; i < node->out_count && node->out_count > 2; i++)
			join_arms(plan, at, &arms[i], &arms[(i + 1) % node->out_count]);
	}
}

/* ---- structures that go on in one another ---- */

struct road_end {
	int64_t x_mm, y_mm;
	uint32_t road;
	bool is_end;
};

static int compare_ends(const void *left, const void *right)
{
	const struct road_end *a = left, *b = right;
	if (a->x_mm != b->x_mm)
		return a->x_mm < b->x_mm ? -1 : 1;
	if (a->y_mm != b->y_mm)
		return a->y_mm < b->y_mm ? -1 : 1;
	return (a->road > b->road) - (a->road < b->road);
}

static void mark_joined(struct ground_plan *plan, const struct road_end *ends, size_t count)
{
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < count; k++) {
			struct road *road = &plan->roads.items[ends[i].road], *other = &plan->roads.items[ends[k].road];
			if (i == k || other->course != road->course)
				continue;
			if (ends[i].is_end)
				road->end_joins = true;
			else
				road->start_joins = true;
		}
}

static void join_roads(struct ground_plan *plan)
{
	ARRAY(struct road_end) ends = { 0 };
	for (uint32_t i = 0; i < plan->roads.count; i++) {
		const struct road *road = &plan->roads.items[i];
		for (int k = 0; k < 2 && road->course != ROAD_GROUND; k++) {
			struct dvec3 at = road->points[k ? road->count - 1 : 0];
			ARRAY_PUSH(&ends, (struct road_end){ llround(at.x * 1000.0), llround(at.y * 1000.0), i, k });
		}
	}
	if (ends.count)
		qsort(ends.items, ends.count, sizeof(*ends.items), compare_ends);
	for (size_t from = 0, to; from < ends.count; from = to) {
		for (to = from + 1; to < ends.count; to++)
			if (ends.items[to].x_mm != ends.items[from].x_mm || ends.items[to].y_mm != ends.items[from].y_mm)
				break;
		mark_joined(plan, ends.items + from, to - from);
	}
	ARRAY_FINISH(&ends);
}

void ground_roads_build(struct ground_plan *plan)
{
	find_edge_ways(plan);
	for (uint32_t e = 0; e < plan->graph->edge_count; e++)
		add_edge_road(plan, e);
	for (size_t i = 0; i < plan->city->ways.count; i++)
		add_way_road(plan, &plan->city->ways.items[i]);
	join_streets(plan);
	join_roads(plan);
}
