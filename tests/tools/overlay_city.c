#include "overlay_city.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/log.h"

static const char *const street_names[OVERLAY_NAMES] = {
	"Rue de Lausanne",
	"Quai du Mont-Blanc",
	"Boulevard Georges-Favon",
	"Rue du Rh\xC3\xB4ne",
	"Place Neuve",
	("Rue de la Conf\xC3\xA9"
	 "d\xC3\xA9ration"),
	"Avenue de la Gare-des-Eaux-Vives",
	"Rue Verte",
	"Cours de Rive",
	"Chemin des Cr\xC3\xAAts",
	"Rue Jean-Jacques",
	"Boulevard Carl-Vogt",
	"\xCE\x9F\xCE\xB4\xCF\x8C\xCF\x82 \xCE\x95\xCF\x81\xCE\xBC\xCE\xBF\xCF\x8D",
	("\xD0\x9D\xD0\xB5\xD0\xB2\xD1\x81\xD0\xBA\xD0\xB8\xD0\xB9 "
	 "\xD0\xBF\xD1\x80\xD0\xBE\xD1\x81\xD0\xBF\xD0\xB5\xD0\xBA\xD1\x82"),
	"\xD8\xB4\xD8\xA7\xD8\xB1\xD8\xB9 \xD8\xA7\xD9\x84\xD9\x85\xD9\x84\xD9\x83",
	"\xD7\xA8\xD7\x97\xD7\x95\xD7\x91 \xD7\x99\xD7\xA4\xD7\x95",
	"Queen Street",
	"Hafenstra\xC3\x9F\x65",
	"Via Appia",
	"Calle Mayor",
	"Rua Augusta",
	"Main Street",
	"Kungsgatan",
	"Ring",
};

static uint32_t add_string(struct overlay_city *city, uint32_t *used, const char *text)
{
	uint32_t at = *used;
	memcpy(city->strings + at, text, strlen(text) + 1);
	*used += (uint32_t)strlen(text) + 1;
	return at;
}

static int32_t height_mm(double x, double y)
{
	return (int32_t)lrint(4000.0 * sin(x / 300.0) + 3000.0 * cos(y / 250.0));
}

static void add_edge(
	struct overlay_city *city, uint32_t id, uint32_t from, uint32_t to, uint32_t name, int street_class)
{
	struct pkg_edge *edge = &city->edges[id];
	const int32_t *a = city->nodes[from].pos_mm, *b = city->nodes[to].pos_mm;
	*edge = (struct pkg_edge){
		.first_point = 2 * id,
		.point_count = 2,
		.length_mm = (uint32_t)lrint(hypot((double)b[0] - a[0], (double)b[1] - a[1])),
		.name = name,
		.flags = PKG_EDGE_FORWARD | PKG_EDGE_BACKWARD,
		.width_mm = 9000,
		.street_class = (uint8_t)street_class,
		.lanes_forward = 1,
		.lanes_backward = 1,
		.speed_kmh = 50,
		.speed_posted = 1,
	};
	memcpy(city->points[2 * id].pos_mm, a, sizeof(city->points[0].pos_mm));
	memcpy(city->points[2 * id + 1].pos_mm, b, sizeof(city->points[0].pos_mm));
	city->halves[2 * id].origin = from;
	city->halves[2 * id + 1].origin = to;
}

static uint32_t make_graph(struct overlay_city *city)
{
	uint32_t edges = 0;
	for (int row = 0; row < OVERLAY_GRID; row++)
		for (int column = 0; column < OVERLAY_GRID; column++) {
			int32_t *at = city->nodes[row * OVERLAY_GRID + column].pos_mm;
			/* every street leans a little, so that corners are not all right angles */
			double x = column * OVERLAY_STEP_M + 6.0 * sin(row * 1.3),
				   y = row * OVERLAY_STEP_M + 9.0 * sin(column * 0.9);
			at[0] = (int32_t)lrint(x * 1e3);
			at[1] = (int32_t)lrint(y * 1e3);
			at[2] = height_mm(x, y);
		}
	for (uint32_t row = 0; row < OVERLAY_GRID; row++)
		for (uint32_t column = 0; column < OVERLAY_GRID; column++) {
			uint32_t node = row * OVERLAY_GRID + column;
			if (column + 1 < OVERLAY_GRID)
				add_edge(city, edges++, node, node + 1, city->name[row],
					row % 3 ? PKG_STREET_RESIDENTIAL : PKG_STREET_PRIMARY);
			if (row + 1 < OVERLAY_GRID)
				add_edge(city, edges++, node, node + OVERLAY_GRID, city->name[12 + column], PKG_STREET_TERTIARY);
		}
	return edges;
}

static uint32_t fill_outs(struct overlay_city *city, uint32_t edges)
{
	uint32_t used = 0;
	for (uint32_t node = 0; node < OVERLAY_GRID * OVERLAY_GRID; node++) {
		city->nodes[node].first_out = used;
		for (uint32_t half = 0; half < 2 * edges; half++)
			if (city->halves[half].origin == node)
				city->outs[used++] = half;
		city->nodes[node].out_count = used - city->nodes[node].first_out;
	}
	return used;
}

static bool bake_text(struct overlay_city *city)
{
	const char *files[64], *strings[OVERLAY_NAMES + 1];
	uint32_t offsets[OVERLAY_NAMES + 1];
	size_t count = text_default_fonts(files, 64);
	for (uint32_t i = 0; i <= OVERLAY_NAMES; i++) {
		offsets[i] = i < OVERLAY_NAMES ? city->name[i] : city->credit;
		strings[i] = city->strings + offsets[i];
	}
	if (!count || text_bake(files, count, strings, OVERLAY_NAMES + 1, &city->text) < 0)
		return false;
	for (size_t i = 0; i < city->text.texts.count; i++)
		city->text.texts.items[i].string = offsets[city->text.texts.items[i].string];
	struct pkg *pkg = &city->pkg;
	pkg->font = (const struct pkg_font *)(const void *)city->text.font.items;
	pkg->font_atlas = city->text.font.items + sizeof(struct pkg_font);
	pkg->glyphs = (const struct pkg_glyph *)(const void *)(city->text.font.items + pkg->font->glyphs_offset);
	pkg->texts = city->text.texts.items;
	pkg->text_count = (uint32_t)city->text.texts.count;
	pkg->glyph_runs = city->text.runs.items;
	pkg->glyph_run_count = (uint32_t)city->text.runs.count;
	return true;
}

bool overlay_city_make(struct overlay_city *city)
{
	uint32_t used = 1;
	memset(city, 0, sizeof(*city));
	log_init("test", LOG_ERROR);
	for (uint32_t i = 0; i < OVERLAY_NAMES; i++)
		city->name[i] = add_string(city, &used, street_names[i]);
	city->credit = add_string(city, &used, "\xC2\xA9 OpenStreetMap contributors");
	city->meta.origin_lat_deg = 46.2;
	city->meta.origin_lon_deg = 6.14;
	city->meta.right_hand_traffic = 1;
	city->meta.attribution = city->credit;
	uint32_t edges = make_graph(city), outs = fill_outs(city, edges);
	city->pkg.meta = &city->meta;
	city->pkg.strings = city->strings;
	city->pkg.strings_bytes = used;
	city->pkg.graph = (struct pkg_graph){
		.nodes = city->nodes,
		.outs = city->outs,
		.halves = city->halves,
		.edges = city->edges,
		.points = city->points,
		.node_count = OVERLAY_GRID * OVERLAY_GRID,
		.out_count = outs,
		.half_count = 2 * edges,
		.edge_count = edges,
		.point_count = 2 * edges,
	};
	return bake_text(city);
}

void overlay_city_finish(struct overlay_city *city)
{
	text_data_finish(&city->text);
}

uint32_t overlay_city_half(const struct overlay_city *city, int column, int row, int to_column, int to_row)
{
	uint32_t from = (uint32_t)(row * OVERLAY_GRID + column), to = (uint32_t)(to_row * OVERLAY_GRID + to_column);
	for (uint32_t half = 0; half < city->pkg.graph.half_count; half++)
		if (city->halves[half].origin == from && city->halves[half ^ 1].origin == to)
			return half;
	return PKG_NONE;
}

uint32_t overlay_city_route(
	const struct overlay_city *city, const int (*corners)[2], uint32_t corner_count, uint32_t *out, uint32_t capacity)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i + 1 < corner_count; i++) {
		int column = corners[i][0], row = corners[i][1];
		while (column != corners[i + 1][0] || row != corners[i + 1][1]) {
			int dx = (corners[i + 1][0] > column) - (corners[i + 1][0] < column);
			int dy = (corners[i + 1][1] > row) - (corners[i + 1][1] < row);
			if (count < capacity)
				out[count++] = overlay_city_half(city, column, row, column + dx, row + dy);
			column += dx;
			row += dy;
		}
	}
	return count;
}

static int32_t heading_of(const struct overlay_city *city, uint32_t half)
{
	const int32_t *a = city->nodes[city->halves[half].origin].pos_mm;
	const int32_t *b = city->nodes[city->halves[half ^ 1].origin].pos_mm;
	return bam_from_dir((double)b[0] - a[0], (double)b[1] - a[1]);
}

static double length_of(const struct overlay_city *city, uint32_t half)
{
	return city->edges[half / 2].length_mm * 1e-3;
}

static void add_step(
	const struct overlay_city *city, struct nav_step *step, uint32_t from, uint32_t to, double distance)
{
	int32_t turn = bam_diff(heading_of(city, to), heading_of(city, from));
	*step = (struct nav_step){
		.manoeuvre = turn > 0 ? NAV_MANOEUVRE_RIGHT : NAV_MANOEUVRE_LEFT,
		.angle_bam = turn,
		.distance_m = distance,
		.street = city->edges[to / 2].name,
		.from_half = from,
		.to_half = to,
	};
	memcpy(step->at_mm, city->nodes[city->halves[to].origin].pos_mm, sizeof(step->at_mm));
}

static int32_t turned(int32_t heading, double by_bam)
{
	return bam_from_rad(bam_to_rad(heading) + by_bam * (BLVD_PI / 2147483648.0));
}

/* Turns over the last 9 m before and the first 9 m after a corner. */
static int32_t smooth_heading(
	const struct overlay_city *city, const uint32_t *route, uint32_t count, uint32_t at, double along)
{
	const double reach = 9.0;
	int32_t own = heading_of(city, route[at]);
	double left = length_of(city, route[at]) - along;
	if (left < reach && at + 1 < count)
		return turned(own, bam_diff(heading_of(city, route[at + 1]), own) * 0.5 * (1.0 - left / reach));
	if (along < reach && at > 0)
		return turned(own, bam_diff(heading_of(city, route[at - 1]), own) * 0.5 * (1.0 - along / reach));
	return own;
}

void overlay_city_drive(const struct overlay_city *city, const uint32_t *route, uint32_t count, double driven_m,
	double speed_mps, struct nav_view *nav)
{
	uint32_t at = 0;
	while (at + 1 < count && driven_m > length_of(city, route[at]))
		driven_m -= length_of(city, route[at++]);
	*nav = (struct nav_view){ .located = true, .on_street = true, .routed = true, .route_complete = true };
	nav->half = route[at];
	nav->along_m = driven_m;
	nav->heading_bam = smooth_heading(city, route, count, at, driven_m);
	nav->speed_mps = speed_mps;
	nav->street = city->edges[route[at] / 2].name;
	nav->limit_kmh = 50;
	nav->limit_posted = true;
	nav->ambient = 1.0;
	const int32_t *a = city->nodes[city->halves[route[at]].origin].pos_mm;
	const int32_t *b = city->nodes[city->halves[route[at] ^ 1].origin].pos_mm;
	double t = driven_m / length_of(city, route[at]), heading = bam_to_rad(heading_of(city, route[at]));
	for (int axis = 0; axis < 3; axis++)
		nav->pos_mm[axis] = (int64_t)llrint(a[axis] + ((double)b[axis] - a[axis]) * t);
	nav->pos_mm[0] += (int64_t)llrint(2250.0 * cos(heading));
	nav->pos_mm[1] -= (int64_t)llrint(2250.0 * sin(heading));
	double ahead = length_of(city, route[at]) - driven_m;
	for (uint32_t i = at; i < count && nav->route_count < NAV_ROUTE_AHEAD_MAX; i++) {
		nav->route[nav->route_count++] = route[i];
		nav->remaining_m += length_of(city, route[i]);
	}
	nav->remaining_m -= driven_m;
	nav->remaining_s = nav->remaining_m / 9.0;
	nav->route_end_along_m = length_of(city, route[count - 1]) * 0.6;
	for (uint32_t i = at; i + 1 < count; i++) {
		int32_t turn = bam_diff(heading_of(city, route[i + 1]), heading_of(city, route[i]));
		if (abs(turn) > (1 << 29) && nav->after_next.manoeuvre == NAV_MANOEUVRE_NONE)
			add_step(city, nav->next.manoeuvre == NAV_MANOEUVRE_NONE ? &nav->next : &nav->after_next, route[i],
				route[i + 1], ahead);
		ahead += length_of(city, route[i + 1]);
	}
	if (nav->next.manoeuvre == NAV_MANOEUVRE_NONE) {
		nav->next.manoeuvre = NAV_MANOEUVRE_ARRIVE;
		nav->next.distance_m = nav->remaining_m;
	}
	for (int i = 0; i < NAV_SIGNAL_COUNT; i++)
		nav->signal[i] = NAV_SIGNAL_GOOD;
}

static struct mat4 projection(const struct view *view, double near_m, double far_m)
{
	struct mat4 out = { { 0 } };
	out.m[0] = 1.0f / view->tan_half_x;
	out.m[5] = 1.0f / view->tan_half_y;
	out.m[10] = (float)(-(far_m + near_m) / (far_m - near_m));
	out.m[11] = -1.0f;
	out.m[14] = (float)(-2.0 * far_m * near_m / (far_m - near_m));
	return out;
}

static struct mat4 rotation(const struct view *view)
{
	const struct vec3 *r = &view->right, *u = &view->up, *f = &view->forward;
	return (struct mat4){ { r->x, u->x, -f->x, 0, r->y, u->y, -f->y, 0, r->z, u->z, -f->z, 0, 0, 0, 0, 1 } };
}

void overlay_city_view(
	const struct nav_view *nav, enum camera_kind kind, uint32_t width, uint32_t height, struct view *view)
{
	static const struct {
		double back, up, pitch;
	} rows[CAMERA_KIND_COUNT] = { { 0.0, 3.0, -0.06 }, { 18.0, 9.0, -0.3 }, { 200.0, 520.0, -1.15 },
		{ 0.0, 600.0, -1.5707 } };
	double heading = kind == CAMERA_NORTH_UP ? 0.0 : bam_to_rad(nav->heading_bam), pitch = rows[kind].pitch;
	*view = (struct view){ .width = width, .height = height, .tan_half_y = 0.41f };
	view->tan_half_x = view->tan_half_y * (float)width / (float)height;
	view->focal_px = (float)height / 2.0f / view->tan_half_y;
	view->eye_mm[0] = nav->pos_mm[0] - (int64_t)(sin(heading) * rows[kind].back * 1e3);
	view->eye_mm[1] = nav->pos_mm[1] - (int64_t)(cos(heading) * rows[kind].back * 1e3);
	view->eye_mm[2] = nav->pos_mm[2] + (int64_t)(rows[kind].up * 1e3);
	view->forward =
		(struct vec3){ (float)(sin(heading) * cos(pitch)), (float)(cos(heading) * cos(pitch)), (float)sin(pitch) };
	view->right = (struct vec3){ (float)cos(heading), (float)-sin(heading), 0.0f };
	view->up = vec3_cross(view->right, view->forward);
	const double near_m[VIEW_SLICE_COUNT] = { 0.3, 150.0 }, far_m[VIEW_SLICE_COUNT] = { 160.0, 6000.0 };
	struct mat4 turn = rotation(view);
	for (int i = 0; i < VIEW_SLICE_COUNT; i++) {
		struct mat4 flat = projection(view, near_m[i], far_m[i]);
		view->slice[i] = (struct view_slice){ .near_m = (float)near_m[i],
			.far_m = (float)far_m[i],
			.depth_near = i ? 0.5f : 0.0f,
			.depth_far = i ? 1.0f : 0.5f,
			.clip_from_eye = mat4_mul(&flat, &turn) };
	}
}
