/*
 * Decks over the ground, cuts into it and tubes under it. Roads of one course that go on in one another are one
 * structure: its outline is cut into faces like the ground's (partition.h), with a cut across at every point of the
 * profile so that heights are linear on every triangle; borders get parapets, slabs' sides or retaining walls.
 */
#include <math.h>
#include <stdlib.h>

#include "tools/bake/ground.h"
#include "tools/bake/partition.h"

#define UPSTAND_M 0.28 /* solid foot of the railing */
#define RAILING_M 0.75 /* above it */
#define FOOT_DECK_M 0.35
#define FOOT_LOW_M 0.7 /* below this a walkway is solid down to the ground */
#define PARAPET_WIDTH_M 0.22
#define SHOULDER_M 0.6
#define PIER_SPACING_M 24.0
#define FOOT_PIER_SPACING_M 14.0
#define PIER_MIN_HEIGHT_M 2.5
#define OVERLAP_M 0.04 /* the ground reaches this far under a structure's border */
#define CAP_M 0.08
#define CAP_STEP_MAX_M 1.5 /* a higher end is no meeting with the ground */
#define SKIRT_M 0.5
#define WALKED_SINK_M 0.02 /* walkways that overlap wider decks lie under them */
#define SIZE_MAX_M 5000.0

enum face_tag { FACE_OUTSIDE, FACE_ROAD, FACE_SIDE };

/* A free end: where the structure meets the ground. */
struct cap {
	struct dvec2 at, direction;
	double half_width;
};

/* The nearest place on a centre line. */
struct foot {
	double z;
	const struct road *road;
	size_t segment;
};

struct structure {
	const struct ground_plan *plan;
	const uint32_t *roads;
	size_t road_count;
	bool cut;
	struct partition partition;
	struct outline carriageway, whole;
	ARRAY(struct cap) caps;
	ARRAY(uint8_t) covered;     /* by face: the tube is closed here */
	ARRAY(uint8_t) spans;       /* by face: a bridge, not an embankment */
	ARRAY(struct foot) foot_of; /* by vertex */
	ARRAY(uint32_t) next, prev; /* along the border, by vertex */
	struct soup *soup;
};

double road_structure_half_width(const struct road *road)
{
	if (road->street_class >= PKG_STREET_CLASS_COUNT)
		return road->half_width_m;
	return road->half_width_m + fmax(fmax(road->side_left_m, road->side_right_m), SHOULDER_M);
}

static bool is_walked(const struct road *road)
{
	return road->street_class >= PKG_STREET_CLASS_COUNT && road->street_class != WAY_RAIL &&
		   road->street_class != WAY_TRAM;
}

static double depth_at(const struct ground_plan *plan, const struct road *road, size_t point)
{
	struct dvec3 at = road->points[point];
	return city_ground(plan->city, (struct dvec2){ at.x, at.y }) - at.z;
}

/* Both footprints and tubes ask here, so that the ground opens exactly where the tube does. */
static bool segment_covered(const struct ground_plan *plan, const struct road *road, size_t segment)
{
	return road->tunnel && depth_at(plan, road, segment) > TUBE_COVER_M &&
		   depth_at(plan, road, segment + 1) > TUBE_COVER_M;
}

static bool segment_breaks_ground(const struct ground_plan *plan, const struct road *road, size_t segment)
{
	if (road->course == ROAD_CUT)
		return !segment_covered(plan, road, segment);
	return -depth_at(plan, road, segment) < DECK_LOW_M || -depth_at(plan, road, segment + 1) < DECK_LOW_M;
}

static void add_disc(struct shape_set *set, struct dvec3 at, double radius)
{
	const struct dvec2 points[2] = { { at.x - 0.005, at.y }, { at.x + 0.005, at.y } };
	shape_add_line(set, points, 2, radius, false);
}

void ground_structure_footprint(const struct ground_plan *plan, const struct road *road, struct shape_set *set)
{
	double half_width = road_structure_half_width(road) - OVERLAP_M;
	size_t last = road->count - 1;
	double from = road->start_joins ? 0.0 : OVERLAP_M, to = road_length(road) - (road->end_joins ? 0.0 : OVERLAP_M);
	struct dvec2 *run = array_grow(NULL, &(size_t){ 0 }, road->count, sizeof(*run));
	size_t count = 0;
	for (size_t k = 0; k < last; k++) {
		if (segment_breaks_ground(plan, road, k)) {
			struct dvec3 a = road_at(road, fmax(road->along[k], from), NULL);
			struct dvec3 b = road_at(road, fmin(road->along[k + 1], to), NULL);
			if (!count)
				run[count++] = (struct dvec2){ a.x, a.y };
			run[count++] = (struct dvec2){ b.x, b.y };
		} else {
			shape_add_line(set, run, count, half_width, true);
			count = 0;
		}
	}
	shape_add_line(set, run, count, half_width, true);
	array_free(run);
	if (road->start_joins && segment_breaks_ground(plan, road, 0))
		add_disc(set, road->points[0], half_width);
	if (road->end_joins && segment_breaks_ground(plan, road, last - 1))
		add_disc(set, road->points[last], half_width);
}

/* ---- faces ---- */

static void outline_structure(struct structure *structure, GEOSContextHandle_t geos, struct tile_faults *faults)
{
	struct shape_set inner = { .geos = geos, .faults = &faults->mended };
	struct shape_set outer = { .geos = geos, .faults = &faults->mended };
	for (size_t i = 0; i < structure->road_count; i++) {
		const struct road *road = &structure->plan->roads.items[structure->roads[i]];
		struct dvec2 *line = array_grow(NULL, &(size_t){ 0 }, road->count, sizeof(*line));
		road_offset(road, 0.0, line);
		double half_width = road_structure_half_width(road);
		shape_add_line(&inner, line, road->count, road->half_width_m, true);
		shape_add_line(&outer, line, road->count, half_width, true);
		array_free(line);
		for (int end = 0; end < 2; end++) {
			size_t point = end ? road->count - 1 : 0;
			if (end ? road->end_joins : road->start_joins) {
				add_disc(&inner, road->points[point], road->half_width_m);
				add_disc(&outer, road->points[point], half_width);
				continue;
			}
			struct dvec2 direction;
			road_at(road, road->along[point], &direction);
			ARRAY_PUSH(&structure->caps,
				(struct cap){ { road->points[point].x, road->points[point].y }, direction, half_width + 0.1 });
		}
	}
	shape_unite(&inner, &structure->carriageway);
	shape_unite(&outer, &structure->whole);
}

static void cut_outline(struct partition *partition, const struct outline *outline)
{
	for (size_t ring = 0; ring < outline->starts.count; ring++) {
		size_t first = outline->starts.items[ring];
		size_t end = ring + 1 < outline->starts.count ? outline->starts.items[ring + 1] : outline->points.count;
		partition_cut_line(partition, outline->points.items + first, end - first, true);
	}
}

static void cut_across(struct structure *structure, const struct road *road)
{
	double reach = road_structure_half_width(road) + 0.3;
	struct dvec2 *left = array_grow(NULL, &(size_t){ 0 }, 2 * road->count, sizeof(*left)), *right = left + road->count;
	road_offset(road, reach, left);
	road_offset(road, -reach, right);
	for (size_t i = 0; i < road->count; i++)
		partition_cut(&structure->partition, left[i], right[i]);
	array_free(left);
}

static struct foot find_foot(const struct structure *structure, struct dvec2 at)
{
	struct foot best = { 0 };
	double nearest = INFINITY;
	for (size_t i = 0; i < structure->road_count; i++) {
		const struct road *road = &structure->plan->roads.items[structure->roads[i]];
		double reach = road_structure_half_width(road) + 2.0;
		if (at.x < road->min.x - reach || at.x > road->max.x + reach || at.y < road->min.y - reach ||
			at.y > road->max.y + reach)
			continue;
		for (size_t k = 0; k + 1 < road->count; k++) {
			struct dvec3 a = road->points[k], b = road->points[k + 1];
			struct dvec2 d = { b.x - a.x, b.y - a.y }, p = { at.x - a.x, at.y - a.y };
			double t = fmin(fmax(dvec2_dot(p, d) / fmax(dvec2_dot(d, d), 1e-9), 0.0), 1.0);
			double distance = dvec2_length(dvec2_sub(p, dvec2_scale(d, t)));
			if (distance >= nearest)
				continue;
			nearest = distance;
			best = (struct foot){ a.z + t * (b.z - a.z), road, k };
		}
	}
	return best;
}

static bool on_this_cap(const struct cap *cap, struct dvec2 at)
{
	struct dvec2 p = dvec2_sub(at, cap->at);
	return fabs(dvec2_dot(p, cap->direction)) < CAP_M && fabs(dvec2_cross(cap->direction, p)) < cap->half_width;
}

/* Where the structure meets the ground it takes the ground's slope across, so that the street goes on without a step.
 */
static double meet_ground(const struct structure *structure, struct dvec2 at, double z)
{
	double ground = city_ground(structure->plan->city, at);
	for (size_t i = 0; i < structure->caps.count; i++)
		if (on_this_cap(&structure->caps.items[i], at) && fabs(z - ground) < CAP_STEP_MAX_M)
			return ground;
	return z;
}

static void name_faces(struct structure *structure)
{
	struct partition *partition = &structure->partition;
	for (size_t i = 0; i < partition->faces.count; i++) {
		struct partition_face *face = &partition->faces.items[i];
		face->tag = outline_contains(&structure->carriageway, face->inside) ? FACE_ROAD
					: outline_contains(&structure->whole, face->inside)     ? FACE_SIDE
																			: FACE_OUTSIDE;
		struct foot foot = face->tag == FACE_OUTSIDE ? (struct foot){ 0 } : find_foot(structure, face->inside);
		if (!foot.road)
			face->tag = FACE_OUTSIDE;
		ARRAY_PUSH(&structure->covered,
			(uint8_t)(foot.road && structure->cut && segment_covered(structure->plan, foot.road, foot.segment)));
		ARRAY_PUSH(&structure->spans, (uint8_t)(foot.road && foot.road->bridge));
	}
	for (uint32_t v = 0; v < partition->cdt.points.count; v++) {
		struct dvec2 at = partition_vertex(partition, v);
		struct foot foot = find_foot(structure, at);
		if (foot.road && is_walked(foot.road) && foot.road->street_class != WAY_PEDESTRIAN)
			foot.z -= WALKED_SINK_M;
		foot.z = meet_ground(structure, at, foot.z);
		ARRAY_PUSH(&structure->foot_of, foot);
	}
}

static enum face_tag tag_of(const struct structure *structure, uint32_t triangle)
{
	if (triangle == CDT_NONE)
		return FACE_OUTSIDE;
	return (enum face_tag)structure->partition.faces.items[structure->partition.face_of.items[triangle]].tag;
}

static bool covered_at(const struct structure *structure, uint32_t triangle)
{
	return structure->covered.items[structure->partition.face_of.items[triangle]];
}

static void link_borders(struct structure *structure)
{
	const struct cdt *cdt = &structure->partition.cdt;
	for (size_t v = 0; v < cdt->points.count; v++) {
		ARRAY_PUSH(&structure->next, CDT_NONE);
		ARRAY_PUSH(&structure->prev, CDT_NONE);
	}
	for (uint32_t t = 0; t < cdt->triangles.count; t++)
		for (int i = 0; i < 3; i++) {
			const struct cdt_triangle *triangle = &cdt->triangles.items[t];
			if (tag_of(structure, t) == FACE_OUTSIDE || tag_of(structure, triangle->neighbour[i]) != FACE_OUTSIDE)
				continue;
			uint32_t a = triangle->corner[(i + 1) % 3], b = triangle->corner[(i + 2) % 3];
			structure->next.items[a] = b;
			structure->prev.items[b] = a;
		}
}

/* ---- emission ---- */

static struct dvec2 place(const struct structure *structure, uint32_t v)
{
	return partition_vertex(&structure->partition, v);
}

static struct dvec3 lifted(const struct structure *structure, uint32_t v, double lift)
{
	struct dvec2 at = place(structure, v);
	return (struct dvec3){ at.x, at.y, structure->foot_of.items[v].z + lift };
}

static double ground_at(const struct structure *structure, uint32_t v)
{
	return city_ground(structure->plan->city, place(structure, v));
}

static void paint(struct soup *soup, enum material_id material, uint8_t grey, float ao)
{
	soup->material = (uint8_t)material;
	soup->rgb[0] = grey;
	soup->rgb[1] = grey;
	soup->rgb[2] = grey == 255 ? grey : (uint8_t)(grey - grey / 32);
	soup->ao = ao;
}

static void emit_floor(struct structure *structure, uint32_t t, double lift, bool down)
{
	const uint32_t *v = structure->partition.cdt.triangles.items[t].corner;
	double scale = material_scale(structure->soup->material);
	uint32_t at[3];
	for (int i = 0; i < 3; i++) {
		struct dvec3 p = lifted(structure, v[i], lift);
		at[i] = soup_vertex(structure->soup, p, (struct vec3){ 0, 0, down ? -1.0f : 1.0f }, p.x / scale, p.y / scale);
	}
	soup_rebase(structure->soup, at[0]);
	soup_triangle(structure->soup, at[0], at[down ? 2 : 1], at[down ? 1 : 2]);
}

static bool over_water(const struct structure *structure, uint32_t v)
{
	return ground_area_at(structure->plan, place(structure, v), REGION_WATER) != NULL;
}

static void emit_triangle(struct structure *structure, uint32_t t)
{
	enum face_tag tag = tag_of(structure, t);
	struct soup *soup = structure->soup;
	const struct road *road = structure->foot_of.items[structure->partition.cdt.triangles.items[t].corner[0]].road;
	if (!road || tag == FACE_OUTSIDE)
		return;
	enum material_id top = road->region < REGION_COUNT ? region_looks[road->region].material : MATERIAL_BALLAST;
	paint(soup, tag == FACE_ROAD ? top : MATERIAL_PAVING, 255, covered_at(structure, t) ? 0.55f : 1.0f);
	emit_floor(structure, t, tag == FACE_ROAD ? 0.0 : KERB_M, false);
	if (structure->cut) {
		paint(soup, MATERIAL_CONCRETE, 200, 0.5f);
		if (covered_at(structure, t))
			emit_floor(structure, t, TUBE_HEIGHT_M, true);
		return;
	}
	paint(soup, MATERIAL_CONCRETE, 190, 0.5f);
	if (is_walked(road))
		emit_floor(structure, t, -FOOT_DECK_M, true);
	else if (structure->spans.items[structure->partition.face_of.items[t]])
		emit_floor(structure, t, -DECK_THICKNESS_M, true);
}

static bool on_cap(const struct structure *structure, uint32_t a, uint32_t b)
{
	for (size_t i = 0; i < structure->caps.count; i++)
		if (on_this_cap(&structure->caps.items[i], place(structure, a)) &&
			on_this_cap(&structure->caps.items[i], place(structure, b)))
			return true;
	return false;
}

static struct dvec2 left_normal(const struct structure *structure, uint32_t a, uint32_t b)
{
	struct dvec2 d = dvec2_sub(place(structure, b), place(structure, a));
	double length = fmax(dvec2_length(d), 1e-6);
	return (struct dvec2){ -d.y / length, d.x / length };
}

/* The border's point moved inwards (left), mitred with the border edge before or after. */
static struct dvec2 inwards(const struct structure *structure, uint32_t v, uint32_t a, uint32_t b, double distance)
{
	struct dvec2 normal = left_normal(structure, a, b), at = place(structure, v);
	uint32_t other = v == a ? structure->prev.items[v] : structure->next.items[v];
	if (other != CDT_NONE) {
		struct dvec2 sum =
			dvec2_add(normal, v == a ? left_normal(structure, other, v) : left_normal(structure, v, other));
		double square = dvec2_dot(sum, sum);
		if (square > 0.6)
			normal = dvec2_scale(sum, 2.0 / square);
	}
	return dvec2_add(at, dvec2_scale(normal, distance));
}

/* A low wall along a -> b from the border inwards, from `base` (at both ends) to `top`. */
static void emit_parapet(struct structure *structure, uint32_t a, uint32_t b, double width, const double low[2],
	const double base[2], const double top[2])
{
	struct soup *soup = structure->soup;
	struct dvec2 p = place(structure, a), q = place(structure, b);
	struct dvec2 pi = inwards(structure, a, a, b, width), qi = inwards(structure, b, a, b, width);
	paint(soup, MATERIAL_CONCRETE, 232, 0.85f);
	if (width > 0.0)
		soup_wall(soup, p, q, low[0], low[1], top[0], top[1]);
	else
		soup_wall(soup, pi, qi, base[0], base[1], top[0], top[1]);
	paint(soup, MATERIAL_CONCRETE, 246, 1.0f);
	struct dvec3 corners[4] = { { p.x, p.y, top[0] }, { q.x, q.y, top[1] }, { qi.x, qi.y, top[1] },
		{ pi.x, pi.y, top[0] } };
	if (width > 0.0)
		soup_quad(soup, corners[0], corners[1], corners[2], corners[3]);
	else
		soup_quad(soup, corners[3], corners[2], corners[1], corners[0]);
	paint(soup, MATERIAL_CONCRETE, 232, 0.85f);
	if (width > 0.0)
		soup_wall(soup, qi, pi, base[1], base[0], top[1], top[0]);
	else
		soup_wall(soup, q, p, low[1], low[0], top[1], top[0]);
}

static void emit_railing(struct structure *structure, uint32_t a, uint32_t b, double inset, const double foot[2])
{
	struct dvec2 p = inwards(structure, a, a, b, inset), q = inwards(structure, b, a, b, inset);
	paint(structure->soup, MATERIAL_METAL, 124, 1.0f);
	soup_railing(structure->soup, (struct dvec3){ p.x, p.y, foot[0] }, (struct dvec3){ q.x, q.y, foot[1] }, RAILING_M);
}

/* Is the border in a carriageway on the ground? Streets that overlap get no railing between them. */
static bool on_street(const struct structure *structure, uint32_t a, uint32_t b)
{
	struct dvec2 middle = dvec2_scale(dvec2_add(place(structure, a), place(structure, b)), 0.5);
	return ground_on_road(structure->plan, middle, -0.2, PKG_NONE);
}

static bool is_member(const struct structure *structure, uint32_t road)
{
	for (size_t i = 0; i < structure->road_count; i++)
		if (structure->roads[i] == road)
			return true;
	return false;
}

/* Does the border run over another deck of the same height? Where walkways meet, neither fences the other off. */
static bool on_other_deck(const struct structure *structure, uint32_t a, uint32_t b)
{
	struct dvec2 at = dvec2_scale(dvec2_add(place(structure, a), place(structure, b)), 0.5);
	double height = structure->foot_of.items[a].z;
	struct bin_items near = bins_near(&structure->plan->segment_bins, at);
	for (size_t i = 0; i < near.count; i++) {
		struct road_segment segment = structure->plan->segments.items[near.entries[i].item];
		const struct road *road = &structure->plan->roads.items[segment.road];
		if (road->course != ROAD_DECK || is_member(structure, segment.road))
			continue;
		struct dvec3 p = road->points[segment.point], q = road->points[segment.point + 1];
		struct dvec2 d = { q.x - p.x, q.y - p.y }, r = { at.x - p.x, at.y - p.y };
		double t = dvec2_dot(r, d) / fmax(dvec2_dot(d, d), 1e-9);
		if (t >= 0.0 && t <= 1.0 && fabs(p.z + t * (q.z - p.z) - height) < 0.6 &&
			dvec2_length(dvec2_sub(r, dvec2_scale(d, t))) < road_structure_half_width(road) - 0.15)
			return true;
	}
	return false;
}

static void emit_deck_border(struct structure *structure, uint32_t t, uint32_t a, uint32_t b)
{
	bool spans = structure->spans.items[structure->partition.face_of.items[t]];
	const uint32_t ends[2] = { a, b };
	double low[2], base[2], top[2];
	const struct road *road = structure->foot_of.items[a].road;
	bool walked = road && is_walked(road);
	bool rail = road && (road->street_class == WAY_RAIL || road->street_class == WAY_TRAM);
	for (int i = 0; i < 2; i++) {
		double z = structure->foot_of.items[ends[i]].z, ground = ground_at(structure, ends[i]);
		base[i] = z;
		low[i] = z - (walked ? FOOT_DECK_M : DECK_THICKNESS_M);
		bool solid = walked ? z - ground < FOOT_LOW_M : !spans || z - ground < DECK_LOW_M;
		if (solid && !over_water(structure, ends[i]))
			low[i] = fmin(low[i], ground - PIT_DROP_M);
		top[i] = rail ? z : z + (walked ? KERB_M : UPSTAND_M);
	}
	if (rail) {
		paint(structure->soup, MATERIAL_CONCRETE, 214, 0.85f);
		soup_wall(structure->soup, place(structure, a), place(structure, b), low[0], low[1], top[0], top[1]);
		return;
	}
	double rise = base[0] - ground_at(structure, a);
	if ((rise < DECK_LOW_M && on_street(structure, a, b)) || on_other_deck(structure, a, b)) {
		paint(structure->soup, MATERIAL_CONCRETE, 214, 0.85f);
		soup_wall(structure->soup, place(structure, a), place(structure, b), low[0], low[1], base[0], base[1]);
		return;
	}
	emit_parapet(structure, a, b, walked ? 0.1 : PARAPET_WIDTH_M, low, base, top);
	double inset = walked ? 0.05 : PARAPET_WIDTH_M / 2.0;
	emit_railing(structure, a, b, inset, top);
}

/* Inside a tube its wall; in an open cut a retaining wall that ends in a parapet above the ground. */
static void emit_cut_border(struct structure *structure, uint32_t t, uint32_t a, uint32_t b)
{
	struct soup *soup = structure->soup;
	struct dvec2 p = place(structure, a), q = place(structure, b);
	double z[2] = { structure->foot_of.items[a].z, structure->foot_of.items[b].z };
	if (covered_at(structure, t)) {
		paint(soup, MATERIAL_CONCRETE, 225, 0.6f);
		soup_wall(soup, q, p, z[1], z[0], z[1] + TUBE_HEIGHT_M, z[0] + TUBE_HEIGHT_M);
		return;
	}
	/* below the ground the tile's own wall stands, OVERLAP_M nearer */
	double low[2], top[2], deepest = 0.0;
	for (int i = 0; i < 2; i++) {
		double ground = ground_at(structure, i ? b : a), depth = fmax(ground - z[i], 0.0);
		top[i] = fmax(ground, z[i]) + KERB_M + fmin(depth, UPSTAND_M);
		low[i] = fmin(ground, z[i]) - 0.3;
		deepest = fmax(deepest, depth);
	}
	if (on_street(structure, a, b))
		return;
	emit_parapet(structure, a, b, -PARAPET_WIDTH_M, low, low, top);
	if (deepest > 0.8)
		emit_railing(structure, a, b, -PARAPET_WIDTH_M / 2.0, top);
}

static void emit_edge(struct structure *structure, uint32_t t, int i)
{
	const struct cdt_triangle *triangle = &structure->partition.cdt.triangles.items[t];
	uint32_t a = triangle->corner[(i + 1) % 3], b = triangle->corner[(i + 2) % 3], u = triangle->neighbour[i];
	enum face_tag here = tag_of(structure, t), there = tag_of(structure, u);
	struct soup *soup = structure->soup;
	struct dvec2 p = place(structure, a), q = place(structure, b);
	double z[2] = { structure->foot_of.items[a].z, structure->foot_of.items[b].z };
	if (there == FACE_OUTSIDE) {
		bool cap = on_cap(structure, a, b);
		if (cap && structure->cut && covered_at(structure, t)) {
			paint(soup, MATERIAL_CONCRETE, 90, 0.4f); /* the data ends in a tunnel */
			soup_wall(soup, q, p, z[1], z[0], z[1] + TUBE_HEIGHT_M, z[0] + TUBE_HEIGHT_M);
		} else if (cap) {
			paint(soup, MATERIAL_CONCRETE, 200, 0.8f);
			soup_wall(soup, p, q, z[0] - SKIRT_M, z[1] - SKIRT_M, z[0], z[1]);
		} else if (structure->cut) {
			emit_cut_border(structure, t, a, b);
		} else {
			emit_deck_border(structure, t, a, b);
		}
		return;
	}
	if (here == FACE_SIDE && there == FACE_ROAD) {
		paint(soup, MATERIAL_KERB, 255, 0.85f);
		soup_wall(soup, p, q, z[0], z[1], z[0] + KERB_M, z[1] + KERB_M);
	}
	if (structure->cut && !covered_at(structure, t) && covered_at(structure, u)) {
		paint(soup, MATERIAL_CONCRETE, 236, 0.9f);
		soup_wall(soup, q, p, z[1] + TUBE_HEIGHT_M, z[0] + TUBE_HEIGHT_M, ground_at(structure, b) + UPSTAND_M,
			ground_at(structure, a) + UPSTAND_M);
		/* and its back, towards the street above */
		soup_wall(soup, p, q, ground_at(structure, a) - 0.3, ground_at(structure, b) - 0.3,
			ground_at(structure, a) + UPSTAND_M, ground_at(structure, b) + UPSTAND_M);
	}
}

static void emit_piers(struct structure *structure, const struct road *road)
{
	bool walked = is_walked(road);
	double length = road_length(road), thickness = walked ? FOOT_DECK_M : DECK_THICKNESS_M;
	int spans = (int)(length / (walked ? FOOT_PIER_SPACING_M : PIER_SPACING_M));
	paint(structure->soup, MATERIAL_CONCRETE, 224, 0.8f);
	for (int i = 1; i < spans + 1 && (road->bridge || walked); i++) {
		struct dvec2 direction;
		struct dvec3 at = road_at(road, length * i / (spans + 1), &direction);
		struct dvec2 flat = { at.x, at.y };
		const struct ground_area *water = ground_area_at(structure->plan, flat, REGION_WATER);
		double bottom =
			water ? ground_water_z(structure->plan, water, flat) - 1.0 : city_ground(structure->plan->city, flat) - 0.5;
		double height = at.z - thickness - bottom;
		if ((height < PIER_MIN_HEIGHT_M && !water) || height < 0.3 ||
			ground_on_road(structure->plan, flat, 1.2, PKG_NONE))
			continue;
		soup_box(structure->soup, (struct dvec3){ at.x, at.y, bottom }, (struct dvec2){ -direction.y, direction.x },
			walked ? 0.18 : road->half_width_m * 0.75, walked ? 0.18 : 0.6, height + 0.2);
	}
}

/* Two rails on a deck; those on the ground belong to its tiles. */
static void emit_rails(struct structure *structure, const struct road *road)
{
	struct soup *soup = structure->soup;
	if (road->street_class != WAY_RAIL && road->street_class != WAY_TRAM)
		return;
	soup->pass = PKG_PASS_DECAL;
	soup->material = MATERIAL_METAL;
	soup->rgb[0] = soup->rgb[1] = soup->rgb[2] = 196;
	struct dvec2 *line = array_grow(NULL, &(size_t){ 0 }, 2 * road->count, sizeof(*line)), *other = line + road->count;
	for (int side = -1; side <= 1; side += 2) {
		road_offset(road, side * 0.7175 - 0.06, line);
		road_offset(road, side * 0.7175 + 0.06, other);
		for (size_t i = 0; i + 1 < road->count; i++) {
			double z = road->points[i].z, z_next = road->points[i + 1].z;
			soup_quad(soup, (struct dvec3){ line[i].x, line[i].y, z },
				(struct dvec3){ line[i + 1].x, line[i + 1].y, z_next },
				(struct dvec3){ other[i + 1].x, other[i + 1].y, z_next }, (struct dvec3){ other[i].x, other[i].y, z });
		}
	}
	array_free(line);
	soup->pass = PKG_PASS_OPAQUE;
}

static void finish_structure(struct structure *structure)
{
	partition_finish(&structure->partition);
	outline_finish(&structure->carriageway);
	outline_finish(&structure->whole);
	ARRAY_FINISH(&structure->caps);
	ARRAY_FINISH(&structure->covered);
	ARRAY_FINISH(&structure->spans);
	ARRAY_FINISH(&structure->foot_of);
	ARRAY_FINISH(&structure->next);
	ARRAY_FINISH(&structure->prev);
}

static void build_structure(struct structure *structure, GEOSContextHandle_t geos, struct tile_faults *faults);

/* Larger than a lattice can be: road by road. */
static void build_apart(struct structure *structure, GEOSContextHandle_t geos, struct tile_faults *faults)
{
	finish_structure(structure);
	for (size_t i = 0; i < structure->road_count && structure->road_count > 1; i++) {
		struct structure part = { .plan = structure->plan,
			.roads = structure->roads + i,
			.road_count = 1,
			.soup = structure->soup,
			.cut = structure->cut };
		build_structure(&part, geos, faults);
	}
	if (structure->road_count == 1)
		faults->dropped++;
	else
		faults->mended++;
}

static void build_structure(struct structure *structure, GEOSContextHandle_t geos, struct tile_faults *faults)
{
	outline_structure(structure, geos, faults);
	if (!structure->whole.starts.count) {
		faults->dropped++;
		finish_structure(structure);
		return;
	}
	struct dvec2 min = structure->whole.min, max = structure->whole.max;
	if (fmax(max.x - min.x, max.y - min.y) > SIZE_MAX_M) {
		build_apart(structure, geos, faults);
		return;
	}
	partition_begin(
		&structure->partition, (struct dvec2){ min.x - 1.0, min.y - 1.0 }, (struct dvec2){ max.x + 1.0, max.y + 1.0 });
	cut_outline(&structure->partition, &structure->whole);
	cut_outline(&structure->partition, &structure->carriageway);
	for (size_t i = 0; i < structure->road_count; i++)
		cut_across(structure, &structure->plan->roads.items[structure->roads[i]]);
	partition_faces(&structure->partition);
	faults->mended += structure->partition.cdt.dropped;
	name_faces(structure);
	link_borders(structure);
	structure->soup->pass = PKG_PASS_OPAQUE;
	structure->soup->kind = structure->cut ? PKG_OBJECT_TUNNEL : PKG_OBJECT_BRIDGE;
	for (uint32_t t = 0; t < structure->partition.cdt.triangles.count; t++) {
		if (tag_of(structure, t) == FACE_OUTSIDE)
			continue;
		emit_triangle(structure, t);
		for (int i = 0; i < 3; i++)
			emit_edge(structure, t, i);
	}
	for (size_t i = 0; i < structure->road_count; i++)
		emit_rails(structure, &structure->plan->roads.items[structure->roads[i]]);
	for (size_t i = 0; i < structure->road_count && !structure->cut; i++)
		emit_piers(structure, &structure->plan->roads.items[structure->roads[i]]);
	finish_structure(structure);
}

/* ---- which roads are one structure ---- */

struct member {
	uint32_t root, road;
};

static uint32_t find_root(uint32_t *parent, uint32_t road)
{
	while (parent[road] != road)
		road = parent[road] = parent[parent[road]];
	return road;
}

struct joint {
	int64_t x_mm, y_mm;
	uint32_t road;
};

static int compare_joints(const void *left, const void *right)
{
	const struct joint *a = left, *b = right;
	if (a->x_mm != b->x_mm)
		return a->x_mm < b->x_mm ? -1 : 1;
	if (a->y_mm != b->y_mm)
		return a->y_mm < b->y_mm ? -1 : 1;
	return (a->road > b->road) - (a->road < b->road);
}

static int compare_members(const void *left, const void *right)
{
	const struct member *a = left, *b = right;
	if (a->root != b->root)
		return a->root < b->root ? -1 : 1;
	return (a->road > b->road) - (a->road < b->road);
}

static void unite_joined(const struct ground_plan *plan, uint32_t *parent)
{
	ARRAY(struct joint) joints = { 0 };
	for (uint32_t i = 0; i < plan->roads.count; i++) {
		const struct road *road = &plan->roads.items[i];
		for (int end = 0; end < 2 && road->course != ROAD_GROUND; end++) {
			struct dvec3 at = road->points[end ? road->count - 1 : 0];
			if (end ? road->end_joins : road->start_joins)
				ARRAY_PUSH(&joints, (struct joint){ llround(at.x * 1000.0), llround(at.y * 1000.0), i });
		}
	}
	if (joints.count)
		qsort(joints.items, joints.count, sizeof(*joints.items), compare_joints);
	for (size_t i = 1; i < joints.count; i++) {
		const struct joint *a = &joints.items[i - 1], *b = &joints.items[i];
		if (a->x_mm != b->x_mm || a->y_mm != b->y_mm ||
			plan->roads.items[a->road].course != plan->roads.items[b->road].course)
			continue;
		uint32_t root_a = find_root(parent, a->road), root_b = find_root(parent, b->road);
		parent[root_a > root_b ? root_a : root_b] = root_a > root_b ? root_b : root_a;
	}
	ARRAY_FINISH(&joints);
}

void ground_structures_build(
	const struct ground_plan *plan, GEOSContextHandle_t geos, struct soup *soup, struct tile_faults *faults)
{
	uint32_t *parent = array_grow(NULL, &(size_t){ 0 }, plan->roads.count + 1, sizeof(*parent));
	for (uint32_t i = 0; i < plan->roads.count; i++)
		parent[i] = i;
	unite_joined(plan, parent);
	ARRAY(struct member) members = { 0 };
	for (uint32_t i = 0; i < plan->roads.count; i++)
		if (plan->roads.items[i].course != ROAD_GROUND)
			ARRAY_PUSH(&members, (struct member){ find_root(parent, i), i });
	if (members.count)
		qsort(members.items, members.count, sizeof(*members.items), compare_members);
	ARRAY(uint32_t) roads = { 0 };
	for (size_t from = 0, to; from < members.count; from = to) {
		roads.count = 0;
		for (to = from; to < members.count && members.items[to].root == members.items[from].root; to++)
			ARRAY_PUSH(&roads, members.items[to].road);
		struct structure structure = { .plan = plan,
			.roads = roads.items,
			.road_count = roads.count,
			.soup = soup,
			.cut = plan->roads.items[roads.items[0]].course == ROAD_CUT };
		build_structure(&structure, geos, faults);
	}
	ARRAY_FINISH(&roads);
	ARRAY_FINISH(&members);
	array_free(parent);
}
