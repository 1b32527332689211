/* Street lamps and traffic signals: small meshes, few triangles. */
#include <math.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/bake/ground.h"

#define FOOT_M (-0.1) /* posts start below the pavement */
#define LAMP_OFF_KERB_M 0.6
#define POST_SIDES 3

static void paint(struct soup *soup, enum material_id material, uint8_t r, uint8_t g, uint8_t b, float ao)
{
	soup->material = (uint8_t)material;
	soup->rgb[0] = r;
	soup->rgb[1] = g;
	soup->rgb[2] = b;
	soup->ao = ao;
}

/* A slim post from one point to another, narrowing. */
static void add_post(struct soup *soup, struct dvec3 from, struct dvec3 to, double from_radius, double to_radius)
{
	struct dvec3 d = { to.x - from.x, to.y - from.y, to.z - from.z };
	bool level = hypot(d.x, d.y) > fabs(d.z);
	uint32_t ring[2][POST_SIDES];
	for (int end = 0; end < 2; end++)
		for (int i = 0; i < POST_SIDES; i++) {
			double turn = 2.0 * BLVD_PI * i / POST_SIDES + 0.5, radius = end ? to_radius : from_radius;
			double c = cos(turn), s = sin(turn);
			struct dvec3 at = end ? to : from;
			double length = fmax(hypot(d.x, d.y), 1e-6);
			struct vec3 normal = level
									 ? (struct vec3){ (float)(-d.y / length * c), (float)(d.x / length * c), (float)s }
									 : (struct vec3){ (float)c, (float)s, 0.0f };
			at.x += (double)normal.x * radius;
			at.y += (double)normal.y * radius;
			at.z += (double)normal.z * radius;
			ring[end][i] = soup_vertex(soup, at, normal, (double)i / POST_SIDES, end ? 1.0 : 0.0);
		}
	/* A level arm's ring turns the other way round its axis. */
	for (int i = 0; i < POST_SIDES; i++) {
		int k = (i + 1) % POST_SIDES;
		soup_triangle(soup, ring[0][i], ring[0][k], ring[1][k]);
		soup_triangle(soup, ring[0][i], ring[1][k], ring[1][i]);
	}
}

/* ---- lamps ---- */

struct lamp_style {
	double spacing_m, height_m, reach_m, radius_m;
	bool both_sides;
};

static bool lamp_style_of(const struct ground_plan *plan, const struct road *road, struct lamp_style *style)
{
	bool lit = road->way && road->way->lit;
	struct dvec3 middle = road_at(road, road_length(road) / 2.0, NULL);
	bool urban = ground_is_built_up(plan, (struct dvec2){ middle.x, middle.y });
	if (road->edge == PKG_NONE || (road->course == ROAD_CUT) || (!lit && !urban))
		return false;
	switch (road->street_class) {
	case PKG_STREET_MOTORWAY:
	case PKG_STREET_TRUNK:
		*style = (struct lamp_style){ 45.0, 10.0, 2.2, 24.0, false };
		return lit;
	case PKG_STREET_PRIMARY:
	case PKG_STREET_SECONDARY:
		*style = (struct lamp_style){ 34.0, 8.5, 1.8, 22.0, true };
		return true;
	case PKG_STREET_TERTIARY:
	case PKG_STREET_UNCLASSIFIED:
		*style = (struct lamp_style){ 32.0, 7.0, 1.3, 20.0, false };
		return true;
	case PKG_STREET_RESIDENTIAL:
	case PKG_STREET_LIVING:
		*style = (struct lamp_style){ 30.0, 5.5, 0.8, 18.0, false };
		return true;
	default:
		*style = (struct lamp_style){ 35.0, 5.0, 0.6, 15.0, false };
		return lit;
	}
}

/* A ridge over the lamp: two slopes and two gables. */
static void add_head(struct soup *soup, struct dvec3 end, struct dvec2 along)
{
	struct dvec2 l = dvec2_scale(along, 0.38), w = { -along.y * 0.13, along.x * 0.13 };
	double low = end.z - 0.05, high = end.z + 0.08;
	const struct dvec3 corners[4] = { { end.x - l.x - w.x, end.y - l.y - w.y, low },
		{ end.x + l.x - w.x, end.y + l.y - w.y, low }, { end.x + l.x + w.x, end.y + l.y + w.y, low },
		{ end.x - l.x + w.x, end.y - l.y + w.y, low } };
	const struct dvec3 ridge[2] = { { end.x - l.x, end.y - l.y, high }, { end.x + l.x, end.y + l.y, high } };
	soup_quad(soup, corners[0], corners[1], ridge[1], ridge[0]);
	soup_quad(soup, corners[2], corners[3], ridge[0], ridge[1]);
	for (int side = 0; side < 2; side++) {
		struct vec3 normal = { (float)(side ? along.x : -along.x), (float)(side ? along.y : -along.y), 0.0f };
		uint32_t a = soup_vertex(soup, corners[side ? 1 : 3], normal, 0.0, 0.0);
		uint32_t b = soup_vertex(soup, corners[side ? 2 : 0], normal, 0.2, 0.0);
		soup_triangle(soup, a, b, soup_vertex(soup, ridge[side], normal, 0.1, 0.1));
	}
}

static void add_lamp(
	struct soup *soup, lamp_array *lamps, struct dvec3 foot, struct dvec2 to_road, const struct lamp_style *style)
{
	struct dvec3 top = { foot.x, foot.y, foot.z + style->height_m };
	struct dvec3 end = { top.x + to_road.x * style->reach_m, top.y + to_road.y * style->reach_m, top.z + 0.15 };
	foot.z += FOOT_M;
	paint(soup, MATERIAL_METAL, 96, 102, 104, 0.9f);
	add_post(soup, foot, top, 0.09, 0.05);
	add_post(soup, top, end, 0.045, 0.035);
	add_head(soup, end, to_road);
	paint(soup, MATERIAL_LAMP, 255, 244, 220, 1.0f);
	struct dvec2 across = { -to_road.y, to_road.x };
	struct dvec3 corners[4];
	for (int i = 0; i < 4; i++) {
		double l = i == 0 || i == 3 ? -0.34 : 0.34, w = i < 2 ? 0.11 : -0.11;
		corners[i] =
			(struct dvec3){ end.x + to_road.x * l + across.x * w, end.y + to_road.y * l + across.y * w, end.z - 0.06 };
	}
	soup_quad(soup, corners[0], corners[1], corners[2], corners[3]);
	ARRAY_PUSH(lamps, (struct lamp){ .at = { end.x, end.y, end.z - 0.1 }, .radius_m = (float)style->radius_m });
}

static bool lamp_fits(const struct ground_plan *plan, const struct road *road, struct dvec2 at)
{
	if (road->course != ROAD_GROUND)
		return true;
	return !ground_on_any_road(plan, at, 0.35) && !ground_in_building(plan, at) &&
		   !ground_area_at(plan, at, REGION_WATER);
}

static void light_side(const struct ground_plan *plan, struct soup *soup, lamp_array *lamps, const struct road *road,
	const struct lamp_style *style, double side, double phase)
{
	double from, to;
	ground_own_stretch(plan, road, &from, &to);
	for (double along = from + 3.0 + phase; along < to - 3.0; along += style->spacing_m) {
		struct dvec2 direction;
		struct dvec3 at = road_at(road, along, &direction);
		struct dvec2 out = { -direction.y * side, direction.x * side };
		double off = road->half_width_m + LAMP_OFF_KERB_M;
		struct dvec2 foot = { at.x + out.x * off, at.y + out.y * off };
		if (!lamp_fits(plan, road, foot))
			continue;
		double z = road->course == ROAD_GROUND ? city_ground(plan->city, foot) : at.z;
		add_lamp(soup, lamps, (struct dvec3){ foot.x, foot.y, z + KERB_M }, (struct dvec2){ -out.x, -out.y }, style);
	}
}

static void light_road(const struct ground_plan *plan, struct soup *soup, lamp_array *lamps, const struct road *road)
{
	struct lamp_style style;
	if (!lamp_style_of(plan, road, &style))
		return;
	double length = road_length(road);
	uint64_t hash = hash_u64((uint64_t)(road->way ? road->way->id : (int64_t)road->edge));
	double side = hash & 1 ? 1.0 : -1.0, phase = fmin(style.spacing_m / 2.0, fmax(length / 2.0 - 8.0, 0.0));
	bool wide = style.both_sides && road->half_width_m > 4.0;
	if (!wide && road->half_width_m > 3.0) { /* alternating */
		style.spacing_m *= 2.0;
		light_side(plan, soup, lamps, road, &style, side, phase);
		light_side(plan, soup, lamps, road, &style, -side, phase + style.spacing_m / 2.0);
		return;
	}
	light_side(plan, soup, lamps, road, &style, side, phase);
	if (wide)
		light_side(plan, soup, lamps, road, &style, -side, phase);
}

/* ---- signals ---- */

static void add_signal(struct soup *soup, struct dvec3 foot, struct dvec2 towards)
{
	const double height = 3.1;
	foot.z += FOOT_M;
	paint(soup, MATERIAL_METAL, 84, 88, 90, 0.9f);
	add_post(soup, foot, (struct dvec3){ foot.x, foot.y, foot.z + height }, 0.06, 0.06);
	/* The head: a dark box whose front shows the three lights. */
	paint(soup, MATERIAL_METAL, 40, 44, 44, 1.0f);
	double low = foot.z + height - 0.95;
	soup_box(soup, (struct dvec3){ foot.x, foot.y, low }, towards, 0.14, 0.17, 0.98);
	static const uint8_t colours[3][3] = { { 70, 150, 90 }, { 190, 150, 60 }, { 196, 60, 48 } };
	struct dvec2 across = { -towards.y, towards.x };
	for (int i = 0; i < 3; i++) {
		paint(soup, MATERIAL_METAL, colours[i][0], colours[i][1], colours[i][2], 1.0f);
		struct dvec3 corners[4];
		for (int k = 0; k < 4; k++) {
			double w = k == 0 || k == 3 ? 0.1 : -0.1, h = k < 2 ? -0.1 : 0.1;
			corners[k] = (struct dvec3){ foot.x + towards.x * 0.15 - across.x * w,
				foot.y + towards.y * 0.15 - across.y * w, low + 0.2 + 0.29 * i + h };
		}
		soup_quad(soup, corners[0], corners[1], corners[2], corners[3]);
	}
}

static void signal_for(const struct ground_plan *plan, struct soup *soup, uint32_t index, double along, bool forward)
{
	const struct road *road = &plan->roads.items[index];
	struct dvec2 direction;
	struct dvec3 at = road_at(road, ground_stop_place(plan, index, along, forward), &direction);
	double side = forward == plan->city->right_hand_traffic ? -1.0 : 1.0;
	struct dvec2 out = { -direction.y * side, direction.x * side };
	double off = road->half_width_m + 0.45;
	struct dvec2 foot = { at.x + out.x * off, at.y + out.y * off };
	if (!lamp_fits(plan, road, foot))
		return;
	double z = road->course == ROAD_GROUND ? city_ground(plan->city, foot) : at.z;
	/* the head looks at those who come */
	struct dvec2 towards = forward ? (struct dvec2){ -direction.x, -direction.y } : direction;
	add_signal(soup, (struct dvec3){ foot.x, foot.y, z + KERB_M }, towards);
}

void ground_furniture_build(const struct ground_plan *plan, struct soup *soup, lamp_array *lamps)
{
	soup->pass = PKG_PASS_OPAQUE;
	soup->kind = PKG_OBJECT_FURNITURE;
	for (uint32_t i = 0; i < plan->roads.count; i++)
		light_road(plan, soup, lamps, &plan->roads.items[i]);
	for (size_t i = 0; i < plan->events.count; i++) {
		const struct road_event *event = &plan->events.items[i];
		if (event->flags != PKG_NODE_SIGNALS)
			continue;
		if (event->forward)
			signal_for(plan, soup, event->road, event->along_m, true);
		if (event->backward)
			signal_for(plan, soup, event->road, event->along_m, false);
	}
}
