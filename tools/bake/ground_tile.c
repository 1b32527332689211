/*
 * The surface of one tile as a planar partition: every outline (carriageways, sidewalks, areas, water) and every line
 * of the terrain's triangulation cuts it, each face is what the first shape around its inner point says, and faces of
 * different height are joined by walls: kerbs, quays. So the ground covers the tile once and closes by construction.
 * Skirts at the tile's border hide what rounding leaves between neighbours.
 */
#include <math.h>
#include <string.h>

#include "tools/bake/borders.h"
#include "tools/bake/ground.h"

#define SKIRT_M 0.6
#define STRAIGHT_M 0.08       /* borders of carriageways may move this far to save corners */
#define STRAIGHT_LAND_M 0.15  /* others */
#define STRAIGHT_EXACT_M 0.01 /* where a structure meets them */
#define KERB_STONE_M 0.18
#define SHAPE_REACH_M 3.0 /* lines are cut this far outside the tile, beyond their width */
#define KERB_HEIGHT_MAX_M 0.4

struct surface {
	enum ground_region region;
	const struct ground_area *water; /* NULL for land and for watercourses drawn from lines */
};

/* What makes up one tile. */
struct tile {
	const struct ground_plan *plan;
	const struct city *city;
	GEOSContextHandle_t geos;
	struct dvec2 min, max;
	int32_t col, row;
	struct outline outlines[REGION_COUNT]; /* of roads, paths, watercourses */
	struct partition partition;
	ARRAY(struct surface) surfaces; /* by face tag */
	struct tile_faults *faults;
	struct mesh_sink *sink;
	ARRAY(uint32_t) vertex_of; /* partition vertex to mesh vertex, PKG_NONE */
};

static struct dvec2 flat(struct dvec3 at)
{
	return (struct dvec2){ at.x, at.y };
}

static double surface_z(const struct tile *tile, const struct surface *surface, struct dvec2 at)
{
	if (surface->region == REGION_WATER)
		return ground_water_z(tile->plan, surface->water, at);
	double z = city_ground(tile->city, at) + region_looks[surface->region].level_m, deck;
	/* across a slope the ground may rise over the deck's far side: the pit goes under it */
	if (surface->region == REGION_PIT && ground_road_nearness(tile->plan, at, ROAD_DECK, &deck) < INFINITY)
		z = fmin(z, deck - PIT_DROP_M);
	return z;
}

/* ---- shapes ---- */

static bool near_tile(const struct tile *tile, struct dvec3 a, struct dvec3 b, double reach)
{
	return fmax(a.x, b.x) > tile->min.x - reach && fmin(a.x, b.x) < tile->max.x + reach &&
		   fmax(a.y, b.y) > tile->min.y - reach && fmin(a.y, b.y) < tile->max.y + reach;
}

/* Adds the parts of a line that come near the tile. */
static void add_near(struct tile *tile, struct shape_set *set, const struct dvec3 *points, size_t count, double radius)
{
	double reach = 2.0 * radius + SHAPE_REACH_M;
	ARRAY(struct dvec2) part = { 0 };
	for (size_t i = 0; i + 1 < count; i++) {
		if (near_tile(tile, points[i], points[i + 1], reach)) {
			if (!part.count)
				ARRAY_PUSH(&part, flat(points[i]));
			ARRAY_PUSH(&part, flat(points[i + 1]));
		} else if (part.count) {
			shape_add_line(set, part.items, part.count, radius, false);
			part.count = 0;
		}
	}
	if (part.count)
		shape_add_line(set, part.items, part.count, radius, false);
	ARRAY_FINISH(&part);
}

/* A sidewalk on one side only: a strip around its middle line, reaching well under the carriageway. */
static void add_one_sided(struct tile *tile, struct shape_set *set, const struct road *road, bool left)
{
	double side = left ? road->side_left_m : road->side_right_m;
	double middle = road->half_width_m + side / 2.0 - 0.25;
	struct dvec2 *line = array_grow(NULL, &(size_t){ 0 }, road->count, sizeof(*line));
	road_offset(road, left ? middle : -middle, line);
	struct dvec3 *line3 = array_grow(NULL, &(size_t){ 0 }, road->count, sizeof(*line3));
	for (size_t i = 0; i < road->count; i++)
		line3[i] = (struct dvec3){ line[i].x, line[i].y, 0.0 };
	add_near(tile, set, line3, road->count, side / 2.0 + 0.25);
	array_free(line);
	array_free(line3);
}

static void add_road_shapes(struct tile *tile, struct shape_set *sets, const struct road *road)
{
	if (road->course != ROAD_GROUND) {
		ground_structure_footprint(tile->plan, road, &sets[road->course == ROAD_CUT ? REGION_VOID : REGION_PIT]);
		return;
	}
	if (road->region == REGION_COUNT)
		return;
	add_near(tile, &sets[road->region], road->points, road->count, road->half_width_m);
	if (road->side_left_m > 0.0 && road->side_left_m == road->side_right_m) {
		add_near(tile, &sets[REGION_SIDEWALK], road->points, road->count, road->half_width_m + road->side_left_m);
	} else {
		if (road->side_left_m > 0.0)
			add_one_sided(tile, &sets[REGION_SIDEWALK], road, true);
		if (road->side_right_m > 0.0)
			add_one_sided(tile, &sets[REGION_SIDEWALK], road, false);
	}
}

static void add_watercourse(struct tile *tile, struct shape_set *sets, const struct line *line)
{
	struct dvec3 *points = array_grow(NULL, &(size_t){ 0 }, line->count, sizeof(*points));
	for (size_t i = 0; i < line->count; i++)
		points[i] = (struct dvec3){ line->points[i].x, line->points[i].y, 0.0 };
	add_near(tile, &sets[REGION_WATER], points, line->count, fmax(line->width_m, 1.0) / 2.0);
	array_free(points);
}

static void collect_outlines(struct tile *tile)
{
	struct shape_set sets[REGION_COUNT];
	for (int region = 0; region < REGION_COUNT; region++)
		sets[region] = (struct shape_set){ .geos = tile->geos, .faults = &tile->faults->mended };
	struct bin_items roads = bins_at(&tile->plan->road_bins, tile->col, tile->row);
	for (size_t i = 0; i < roads.count; i++)
		add_road_shapes(tile, sets, &tile->plan->roads.items[roads.entries[i].item]);
	struct bin_items corners = bins_at(&tile->plan->corner_bins, tile->col, tile->row);
	for (size_t i = 0; i < corners.count; i++) {
		const struct corner *corner = &tile->plan->corners.items[corners.entries[i].item];
		shape_add_polygon(&sets[corner->region], corner->points, corner->count);
	}
	struct bin_items lines = bins_at(&tile->plan->line_bins, tile->col, tile->row);
	for (size_t i = 0; i < lines.count; i++)
		add_watercourse(tile, sets, &tile->city->lines.items[lines.entries[i].item]);
	for (int region = 0; region < REGION_COUNT; region++)
		shape_unite(&sets[region], &tile->outlines[region]);
}

/* ---- cutting and naming faces ---- */

static void cut_outlines(struct tile *tile)
{
	for (int region = 0; region < REGION_COUNT; region++) {
		const struct outline *outline = &tile->outlines[region];
		for (size_t ring = 0; ring < outline->starts.count; ring++) {
			size_t first = outline->starts.items[ring];
			size_t end = ring + 1 < outline->starts.count ? outline->starts.items[ring + 1] : outline->points.count;
			partition_cut_line(&tile->partition, outline->points.items + first, end - first, true);
		}
	}
}

static void cut_areas(struct tile *tile)
{
	struct bin_items areas = bins_at(&tile->plan->area_bins, tile->col, tile->row);
	for (size_t i = 0; i < areas.count; i++) {
		const struct polygon *shape = &tile->plan->areas.items[areas.entries[i].item].area->shape;
		partition_cut_line(&tile->partition, shape->outer.points, shape->outer.count, true);
		for (size_t k = 0; k < shape->hole_count; k++)
			partition_cut_line(&tile->partition, shape->holes[k].points, shape->holes[k].count, true);
	}
}

/* Nothing but level water, which needs no terrain. */
static bool is_open_water(const struct tile *tile)
{
	const struct ground_area *area = ground_top_area(tile->plan, dvec2_scale(dvec2_add(tile->min, tile->max), 0.5));
	bool uncut = tile->partition.cdt.points.count == 4;
	return uncut && area && area->region == REGION_WATER && !isnan(area->water_z);
}

/* The terrain's squares and their diagonals, so that every triangle of the ground lies in one of the terrain's. */
static void cut_terrain(struct tile *tile)
{
	if (!tile->plan->has_terrain || is_open_water(tile))
		return;
	const struct pkg_height_grid *grid = &tile->city->terrain.grid;
	double step = grid->step_mm / 1000.0, x0 = grid->origin_mm[0] / 1000.0, y0 = grid->origin_mm[1] / 1000.0;
	struct dvec2 min = tile->min, max = tile->max;
	int64_t col0 = (int64_t)ceil((min.x - x0) / step), col1 = (int64_t)floor((max.x - x0) / step);
	int64_t row0 = (int64_t)ceil((min.y - y0) / step), row1 = (int64_t)floor((max.y - y0) / step);
	for (int64_t col = col0; col <= col1; col++) {
		double x = x0 + (double)col * step;
		partition_cut(&tile->partition, (struct dvec2){ x, min.y }, (struct dvec2){ x, max.y });
	}
	for (int64_t row = row0; row <= row1; row++) {
		double y = y0 + (double)row * step;
		partition_cut(&tile->partition, (struct dvec2){ min.x, y }, (struct dvec2){ max.x, y });
	}
	double width = max.x - min.x, height = max.y - min.y;
	int64_t first = (int64_t)floor((min.x - x0 - (max.y - y0)) / step);
	int64_t last = (int64_t)ceil((max.x - x0 - (min.y - y0)) / step);
	for (int64_t k = first; k <= last; k++) {
		double x = x0 + (double)k * step + (min.y - y0); /* of the diagonal at the tile's south side */
		partition_cut(&tile->partition, (struct dvec2){ x - width - height, min.y - width - height },
			(struct dvec2){ x + width + height, min.y + width + height });
	}
}

static struct surface surface_at(const struct tile *tile, struct dvec2 at)
{
	for (int region = 0; region < REGION_COUNT; region++) {
		if (!outline_contains(&tile->outlines[region], at))
			continue;
		if (region == REGION_PIT &&
			(ground_area_at(tile->plan, at, REGION_WATER) || outline_contains(&tile->outlines[REGION_WATER], at)))
			continue;
		/* where streets on the ground and in a cut overlap, the nearer one has it */
		if (region == REGION_VOID && ground_road_nearness(tile->plan, at, ROAD_GROUND, NULL) <
										 fmin(ground_road_nearness(tile->plan, at, ROAD_CUT, NULL), 1.0))
			continue;
		return (struct surface){ (enum ground_region)region, NULL };
	}
	const struct ground_area *area = ground_top_area(tile->plan, at);
	if (area)
		return (struct surface){ area->region, area->region == REGION_WATER ? area : NULL };
	return (struct surface){ ground_block_is_paved(tile->plan, at) ? REGION_YARD : REGION_OPEN, NULL };
}

static uint32_t surface_index(struct tile *tile, struct surface surface)
{
	for (uint32_t i = 0; i < tile->surfaces.count; i++)
		if (tile->surfaces.items[i].region == surface.region && tile->surfaces.items[i].water == surface.water)
			return i;
	ARRAY_PUSH(&tile->surfaces, surface);
	return (uint32_t)tile->surfaces.count - 1;
}

static void name_faces(struct tile *tile)
{
	partition_faces(&tile->partition);
	tile->faults->mended += tile->partition.cdt.dropped;
	for (size_t i = 0; i < tile->partition.faces.count; i++)
		tile->partition.faces.items[i].tag =
			surface_index(tile, surface_at(tile, tile->partition.faces.items[i].inside));
}

static double border_tolerance(const void *context, uint32_t face_a, uint32_t face_b)
{
	const struct tile *tile = context;
	uint32_t a = tile->partition.faces.items[face_a].tag, b = tile->partition.faces.items[face_b].tag;
	if (a == b)
		return -1.0;
	enum ground_region first = tile->surfaces.items[a].region, second = tile->surfaces.items[b].region;
	if (first <= REGION_PIT || second <= REGION_PIT)
		return STRAIGHT_EXACT_M;
	return region_is_road(first) || region_is_road(second) ? STRAIGHT_M : STRAIGHT_LAND_M;
}

/* Cuts once with everything to see which borders show, and then with these alone. */
static void cut_tile(struct tile *tile)
{
	partition_begin(&tile->partition, tile->min, tile->max);
	cut_outlines(tile);
	cut_areas(tile);
	name_faces(tile);
	struct partition shown;
	partition_begin(&shown, tile->min, tile->max);
	borders_redraw(&tile->partition, border_tolerance, tile, &shown);
	partition_finish(&tile->partition);
	tile->partition = shown;
	cut_terrain(tile);
	name_faces(tile);
}

/* ---- triangles ---- */

static const struct surface *surface_of(const struct tile *tile, uint32_t triangle)
{
	uint32_t face = tile->partition.face_of.items[triangle];
	return &tile->surfaces.items[tile->partition.faces.items[face].tag];
}

static struct vec3 terrain_normal(const struct tile *tile, struct dvec2 at)
{
	if (!tile->plan->has_terrain)
		return (struct vec3){ 0, 0, 1 };
	double d = tile->city->terrain.grid.step_mm / 2000.0;
	double dx = city_ground(tile->city, (struct dvec2){ at.x + d, at.y }) -
				city_ground(tile->city, (struct dvec2){ at.x - d, at.y });
	double dy = city_ground(tile->city, (struct dvec2){ at.x, at.y + d }) -
				city_ground(tile->city, (struct dvec2){ at.x, at.y - d });
	return vec3_normalize((struct vec3){ (float)(-dx / (2.0 * d)), (float)(-dy / (2.0 * d)), 1.0f });
}

/* Texture coordinates in whole tiles from outside the tile's south-west corner. */
static struct mesh_vertex floor_vertex(const struct tile *tile, struct dvec2 at, double z, enum material_id material)
{
	double scale = material_scale(material);
	struct mesh_vertex vertex = {
		.at = { at.x, at.y, z },
		.normal = terrain_normal(tile, at),
		.u = (float)(at.x / scale - floor(tile->min.x / scale) + 1.0),
		.v = (float)(at.y / scale - floor(tile->min.y / scale) + 1.0),
		.ao = 1.0f,
		.material = (uint8_t)material,
	};
	return vertex;
}

static uint32_t mesh_vertex_of(struct tile *tile, const struct surface *surface, uint32_t v)
{
	uint32_t *known = &tile->vertex_of.items[v];
	if (*known != PKG_NONE)
		return *known;
	const struct region_look *look = &region_looks[surface->region];
	struct dvec2 at = partition_vertex(&tile->partition, v);
	struct mesh_vertex vertex = floor_vertex(tile, at, surface_z(tile, surface, at), look->material);
	if (surface->region == REGION_WATER)
		vertex.normal = (struct vec3){ 0, 0, 1 };
	memcpy(vertex.rgb, look->rgb, sizeof(vertex.rgb));
	return *known = mesh_add_vertex(tile->sink, &vertex);
}

static void emit_surface(struct tile *tile, uint32_t index)
{
	const struct surface *surface = &tile->surfaces.items[index];
	const struct cdt *cdt = &tile->partition.cdt;
	for (size_t v = 0; v < cdt->points.count; v++)
		tile->vertex_of.items[v] = PKG_NONE;
	for (uint32_t t = 0; t < cdt->triangles.count; t++) {
		if (surface_of(tile, t) != surface)
			continue;
		const uint32_t *v = cdt->triangles.items[t].corner;
		uint32_t a = mesh_vertex_of(tile, surface, v[0]), b = mesh_vertex_of(tile, surface, v[1]);
		mesh_add_triangle(tile->sink, PKG_PASS_OPAQUE, a, b, mesh_vertex_of(tile, surface, v[2]));
	}
}

static void emit_surfaces(struct tile *tile, bool water)
{
	for (uint32_t i = 0; i < tile->surfaces.count; i++) {
		enum ground_region region = tile->surfaces.items[i].region;
		if (region != REGION_VOID && (region == REGION_WATER) == water)
			emit_surface(tile, i);
	}
}

/* ---- walls between faces ---- */

static void emit_wall(
	struct tile *tile, struct dvec2 a, struct dvec2 b, const double low[2], const double high[2], bool kerb)
{
	enum material_id material = kerb ? MATERIAL_KERB : MATERIAL_CONCRETE;
	double scale = material_scale(material), length = dvec2_length(dvec2_sub(b, a));
	struct dvec2 d = dvec2_scale(dvec2_sub(b, a), 1.0 / fmax(length, 1e-6));
	double u0 = dvec2_dot(d, a) / scale, base = floor(fmin(u0, u0 + length / scale));
	double z0 = floor(fmin(low[0], low[1]) / scale);
	const double z[4] = { low[0], low[1], high[1], high[0] };
	uint32_t at[4];
	for (int i = 0; i < 4; i++) {
		bool far = i == 1 || i == 2;
		struct mesh_vertex vertex = {
			.at = { far ? b.x : a.x, far ? b.y : a.y, z[i] },
			.normal = { (float)d.y, (float)-d.x, 0.0f },
			.u = (float)(u0 + (far ? length / scale : 0.0) - base),
			.v = (float)(z[i] / scale - z0),
			.ao = i < 2 ? 0.72f : 0.95f,
			.material = (uint8_t)material,
			.rgb = { 255, 255, 255 },
		};
		at[i] = mesh_add_vertex(tile->sink, &vertex);
	}
	mesh_add_triangle(tile->sink, PKG_PASS_OPAQUE, at[0], at[1], at[2]);
	mesh_add_triangle(tile->sink, PKG_PASS_OPAQUE, at[0], at[2], at[3]);
}

/* Edge i of triangle t, t on its left. */
static void edge_ends(const struct tile *tile, uint32_t t, int i, uint32_t ends[2])
{
	const struct cdt_triangle *triangle = &tile->partition.cdt.triangles.items[t];
	ends[0] = triangle->corner[(i + 1) % 3];
	ends[1] = triangle->corner[(i + 2) % 3];
}

static void emit_step(struct tile *tile, uint32_t t, int i, const struct surface *here, const struct surface *there)
{
	uint32_t ends[2];
	edge_ends(tile, t, i, ends);
	struct dvec2 at[2] = { partition_vertex(&tile->partition, ends[0]), partition_vertex(&tile->partition, ends[1]) };
	double z_here[2], z_there[2];
	for (int k = 0; k < 2; k++) {
		z_here[k] = surface_z(tile, here, at[k]);
		z_there[k] = surface_z(tile, there, at[k]);
	}
	double step = fmax(z_here[0] - z_there[0], z_here[1] - z_there[1]);
	if (step < 0.005)
		return; /* level, or the other side's wall */
	bool kerb = step < KERB_HEIGHT_MAX_M;
	emit_wall(tile, at[0], at[1], z_there, z_here, kerb);
}

/* The next edge along the tile's border in the same triangle fan: from vertex v on, `t` lies before it. */
static uint32_t next_at_border(const struct cdt *cdt, uint32_t t, uint32_t v, int *side)
{
	for (;;) {
		const struct cdt_triangle *triangle = &cdt->triangles.items[t];
		int at = triangle->corner[0] == v ? 0 : triangle->corner[1] == v ? 1 : 2;
		*side = (at + 2) % 3; /* v to the corner after it */
		if (triangle->neighbour[*side] == CDT_NONE)
			return t;
		t = triangle->neighbour[*side];
	}
}

static bool goes_on_straight(struct dvec3 a, struct dvec3 b, struct dvec3 c)
{
	double ab = hypot(b.x - a.x, b.y - a.y), ac = hypot(c.x - a.x, c.y - a.y);
	double aside = fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / fmax(ac, 1e-6);
	return aside < 1e-3 && fabs(a.z + (c.z - a.z) * ab / fmax(ac, 1e-6) - b.z) < 2e-3;
}

static struct dvec3 floor_at(const struct tile *tile, const struct surface *surface, uint32_t v)
{
	struct dvec2 at = partition_vertex(&tile->partition, v);
	return (struct dvec3){ at.x, at.y, surface_z(tile, surface, at) };
}

static void emit_skirt(struct tile *tile, struct dvec3 a, struct dvec3 b)
{
	const double high[2] = { a.z, b.z }, low[2] = { a.z - SKIRT_M, b.z - SKIRT_M };
	emit_wall(tile, flat(a), flat(b), low, high, false);
}

/* Once round the tile, counter-clockwise; what lies straight in plan and height is one skirt. */
static void emit_skirts(struct tile *tile)
{
	const struct cdt *cdt = &tile->partition.cdt;
	uint32_t start = 0;
	while (start < cdt->triangles.count && cdt->triangles.items[start].corner[0] != 0 &&
		   cdt->triangles.items[start].corner[1] != 0 && cdt->triangles.items[start].corner[2] != 0)
		start++;
	int side;
	uint32_t v = 0, t = next_at_border(cdt, start, v, &side);
	bool open = false;
	struct dvec3 from = { 0 }, to = { 0 };
	do {
		uint32_t ends[2];
		edge_ends(tile, t, side, ends);
		const struct surface *here = surface_of(tile, t);
		bool solid = here->region != REGION_VOID;
		struct dvec3 a = floor_at(tile, here, ends[0]), b = floor_at(tile, here, ends[1]);
		if (open && solid && fabs(a.z - to.z) < 1e-6 && goes_on_straight(from, a, b)) {
			to = b;
		} else {
			if (open)
				emit_skirt(tile, from, to);
			from = a;
			to = b;
			open = solid;
		}
		v = ends[1];
		t = next_at_border(cdt, t, v, &side);
	} while (v != 0);
	if (open)
		emit_skirt(tile, from, to);
}

/* The ground's edge at an open cut: a wall down to the street in it. */
static void emit_cut_wall(struct tile *tile, uint32_t t, int i, const struct surface *here)
{
	uint32_t ends[2];
	edge_ends(tile, t, i, ends);
	struct dvec2 at[2] = { partition_vertex(&tile->partition, ends[0]), partition_vertex(&tile->partition, ends[1]) };
	double high[2], low[2];
	for (int k = 0; k < 2; k++) {
		high[k] = surface_z(tile, here, at[k]);
		low[k] = high[k] - 1.0;
		ground_road_nearness(tile->plan, at[k], ROAD_CUT, &low[k]);
		low[k] -= 0.1;
	}
	if (low[0] < high[0] || low[1] < high[1])
		emit_wall(tile, at[0], at[1], low, high, false);
}

static void emit_walls(struct tile *tile)
{
	const struct cdt *cdt = &tile->partition.cdt;
	for (uint32_t t = 0; t < cdt->triangles.count; t++) {
		const struct surface *here = surface_of(tile, t);
		for (int i = 0; i < 3 && here->region != REGION_VOID; i++) {
			uint32_t u = cdt->triangles.items[t].neighbour[i];
			if (u == CDT_NONE)
				continue;
			if (surface_of(tile, u)->region == REGION_VOID)
				emit_cut_wall(tile, t, i, here);
			else if (surface_of(tile, u) != here)
				emit_step(tile, t, i, here, surface_of(tile, u));
		}
	}
}

/* ---- kerb stones ---- */

/* Border of the carriageways: for each vertex the one border edge that leaves and the one that arrives, the raised side
 * on the left. A vertex with more of them gets no mitre. */
struct border {
	uint32_t next, prev; /* vertices; CDT_NONE none */
	bool shared;
};

static bool is_kerb(const struct surface *raised, const struct surface *road)
{
	return region_is_road(road->region) && raised->region > REGION_ROAD_GRAVEL && raised->region != REGION_WATER &&
		   raised->region != REGION_PARKING;
}

static void link_border(struct border *borders, uint32_t a, uint32_t b)
{
	if (borders[a].next != CDT_NONE)
		borders[a].shared = true;
	if (borders[b].prev != CDT_NONE)
		borders[b].shared = true;
	borders[a].next = b;
	borders[b].prev = a;
}

static struct dvec2 left_of(const struct tile *tile, uint32_t a, uint32_t b)
{
	struct dvec2 d = dvec2_sub(partition_vertex(&tile->partition, b), partition_vertex(&tile->partition, a));
	double length = fmax(dvec2_length(d), 1e-6);
	return (struct dvec2){ -d.y / length, d.x / length };
}

/* The stone's inner corner at vertex v of the edge a -> b. */
static struct dvec2 full_inner_corner(
	const struct tile *tile, const struct border *borders, uint32_t v, uint32_t a, uint32_t b)
{
	struct dvec2 at = partition_vertex(&tile->partition, v), normal = left_of(tile, a, b);
	const struct border *border = &borders[v];
	if (!border->shared && border->next != CDT_NONE && border->prev != CDT_NONE) {
		struct dvec2 other = v == a ? left_of(tile, border->prev, a) : left_of(tile, b, border->next);
		struct dvec2 sum = dvec2_add(normal, other);
		double square = dvec2_dot(sum, sum);
		if (square > 0.6)
			normal = dvec2_scale(sum, 2.0 / square);
	}
	return dvec2_add(at, dvec2_scale(normal, KERB_STONE_M));
}

/* The same, nearer to the border where the raised ground is narrower than a stone. `t` lies at the edge. */
static struct dvec2 inner_corner(
	const struct tile *tile, const struct border *borders, uint32_t v, uint32_t a, uint32_t b, uint32_t t)
{
	struct dvec2 from = partition_vertex(&tile->partition, v), to = full_inner_corner(tile, borders, v, a, b);
	for (int halving = 0; halving < 3; halving++) {
		uint32_t there = partition_triangle_at(&tile->partition, t, to);
		if (there == CDT_NONE || !region_is_road(surface_of(tile, there)->region))
			return to;
		to = dvec2_scale(dvec2_add(from, to), 0.5);
	}
	return from;
}

static void emit_stone(struct tile *tile, const struct border *borders, uint32_t a, uint32_t b, uint32_t t)
{
	const struct dvec2 corners[4] = { partition_vertex(&tile->partition, a), partition_vertex(&tile->partition, b),
		inner_corner(tile, borders, b, a, b, t), inner_corner(tile, borders, a, a, b, t) };
	uint32_t at[4];
	for (int i = 0; i < 4; i++) {
		struct mesh_vertex vertex =
			floor_vertex(tile, corners[i], city_ground(tile->city, corners[i]) + KERB_M, MATERIAL_KERB);
		vertex.rgb[0] = vertex.rgb[1] = vertex.rgb[2] = 255;
		at[i] = mesh_add_vertex(tile->sink, &vertex);
	}
	mesh_add_triangle(tile->sink, PKG_PASS_DECAL, at[0], at[1], at[2]);
	mesh_add_triangle(tile->sink, PKG_PASS_DECAL, at[0], at[2], at[3]);
}

static void emit_kerb_stones(struct tile *tile)
{
	const struct cdt *cdt = &tile->partition.cdt;
	struct border *borders = array_grow(NULL, &(size_t){ 0 }, cdt->points.count, sizeof(*borders));
	for (size_t i = 0; i < cdt->points.count; i++)
		borders[i] = (struct border){ CDT_NONE, CDT_NONE, false };
	for (int pass = 0; pass < 2; pass++)
		for (uint32_t t = 0; t < cdt->triangles.count; t++)
			for (int i = 0; i < 3; i++) {
				uint32_t u = cdt->triangles.items[t].neighbour[i], ends[2];
				if (u == CDT_NONE || !is_kerb(surface_of(tile, t), surface_of(tile, u)))
					continue;
				edge_ends(tile, t, i, ends);
				if (pass)
					emit_stone(tile, borders, ends[0], ends[1], t);
				else
					link_border(borders, ends[0], ends[1]);
			}
	array_free(borders);
}

/* ---- rails ---- */

#define RAIL_GAUGE_M 1.435
#define RAIL_HALF_M 0.06

/* The surface that a track lies on at a place; NULL where it lies on none. */
static const struct surface *track_bed(const struct tile *tile, struct dvec2 at)
{
	uint32_t face = partition_face_at(&tile->partition, at);
	if (face == CDT_NONE)
		return NULL;
	const struct surface *surface = &tile->surfaces.items[tile->partition.faces.items[face].tag];
	bool none = surface->region == REGION_VOID || surface->region == REGION_PIT || surface->region == REGION_WATER;
	return none ? NULL : surface;
}

static void emit_rails(
	const struct tile *tile, struct soup *soup, struct dvec2 a, struct dvec2 b, enum ground_region region)
{
	struct dvec2 d = dvec2_sub(b, a);
	double length = fmax(dvec2_length(d), 1e-6);
	struct dvec2 left = { -d.y / length, d.x / length };
	/* dark grooves in the street, worn steel on ballast */
	bool ballast = region == REGION_RAIL || region == REGION_RAILWAY;
	memset(soup->rgb, ballast ? 196 : 62, sizeof(soup->rgb));
	for (int side = -1; side <= 1; side += 2) {
		double inner_m = side * RAIL_GAUGE_M / 2.0 - RAIL_HALF_M, outer_m = side * RAIL_GAUGE_M / 2.0 + RAIL_HALF_M;
		struct dvec2 inner = dvec2_scale(left, inner_m), outer = dvec2_scale(left, outer_m);
		const struct dvec2 corners[4] = { dvec2_add(a, inner), dvec2_add(b, inner), dvec2_add(b, outer),
			dvec2_add(a, outer) };
		soup_drape(soup, tile->city, corners, 4, region_looks[region].level_m);
	}
}

#define RAIL_PIECE_M 4.0

/* Pieces on the same surface are one. */
static void emit_straight_track(const struct tile *tile, struct soup *soup, struct dvec2 a, struct dvec2 b)
{
	struct dvec2 d = dvec2_sub(b, a);
	int pieces = (int)ceil(dvec2_length(d) / RAIL_PIECE_M), from = 0;
	const struct surface *bed = NULL;
	for (int i = 0; i <= pieces; i++) {
		const struct surface *here =
			i < pieces ? track_bed(tile, dvec2_add(a, dvec2_scale(d, (i + 0.5) / pieces))) : NULL;
		if (here == bed)
			continue;
		if (bed)
			emit_rails(tile, soup, dvec2_add(a, dvec2_scale(d, (double)from / pieces)),
				dvec2_add(a, dvec2_scale(d, (double)i / pieces)), bed->region);
		bed = here;
		from = i;
	}
}

static void emit_track(const struct tile *tile, struct soup *soup, const struct road *road)
{
	for (size_t k = 0; k + 1 < road->count; k++) {
		struct dvec2 a = flat(road->points[k]), b = flat(road->points[k + 1]);
		if (clip_segment(tile->min, tile->max, &a, &b))
			emit_straight_track(tile, soup, a, b);
	}
}

static void emit_tracks(struct tile *tile)
{
	struct soup soup = { .pass = PKG_PASS_DECAL,
		.kind = PKG_OBJECT_GROUND,
		.material = MATERIAL_METAL,
		.rgb = { 120, 116, 112 },
		.ao = 1.0f };
	struct bin_items roads = bins_at(&tile->plan->road_bins, tile->col, tile->row);
	for (size_t i = 0; i < roads.count; i++) {
		const struct road *road = &tile->plan->roads.items[roads.entries[i].item];
		if (road->course == ROAD_GROUND && (road->street_class == WAY_RAIL || road->street_class == WAY_TRAM))
			emit_track(tile, &soup, road);
	}
	soup_flush(&soup, tile->sink);
	soup_finish(&soup);
}

void ground_tile_build(const struct ground_plan *plan, GEOSContextHandle_t geos, int32_t col, int32_t row,
	struct mesh_sink *sink, struct tile_faults *faults)
{
	struct tile tile = {
		.plan = plan, .city = plan->city, .geos = geos, .col = col, .row = row, .faults = faults, .sink = sink
	};
	tile.min = (struct dvec2){ col * MESH_TILE_M, row * MESH_TILE_M };
	tile.max = (struct dvec2){ tile.min.x + MESH_TILE_M, tile.min.y + MESH_TILE_M };
	collect_outlines(&tile);
	cut_tile(&tile);
	size_t vertices = tile.partition.cdt.points.count;
	ARRAY_RESERVE(&tile.vertex_of, vertices);
	mesh_begin(sink, &(struct mesh_object){ .kind = PKG_OBJECT_GROUND, .face = PKG_NONE });
	emit_surfaces(&tile, false);
	emit_skirts(&tile);
	emit_walls(&tile);
	emit_kerb_stones(&tile);
	mesh_end(sink);
	mesh_begin(sink, &(struct mesh_object){ .kind = PKG_OBJECT_WATER, .face = PKG_NONE });
	emit_surfaces(&tile, true);
	mesh_end(sink);
	emit_tracks(&tile);
	for (int region = 0; region < REGION_COUNT; region++)
		outline_finish(&tile.outlines[region]);
	partition_finish(&tile.partition);
	ARRAY_FINISH(&tile.surfaces);
	ARRAY_FINISH(&tile.vertex_of);
}
