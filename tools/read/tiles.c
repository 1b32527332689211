#include "tools/read/tiles.h"

#include <cpl_error.h>
#include <dirent.h>
#include <errno.h>
#include <gdal.h>
#include <ogr_api.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "platform/base/log.h"
#include "tools/read/gdal_quiet.h"
#include "tools/read/osm_kind.h"
#include "tools/read/tile_grid.h"

#define WORLD_M 40075016.685578488  /* once around, spherical Mercator */
#define FIRST_ID (INT64_C(1) << 40) /* of made-up ways: clear of OSM's own */
#define TAGS_LIMIT 12

struct tile_file {
	char *path;
	int zoom, x, y;
};

struct tiles {
	struct osm_store *store;
	contour_array *contours;
	ARRAY(struct tile_file) files;
	tile_line_array lines;
	tile_name_array names;
	tile_area_array areas;
	double unit_m; /* Mercator metres of one unit */
	double world_units;
	int64_t next_id;
	struct shaper shaper;
};

bool tiles_is_folder(const char *path)
{
	struct stat status;
	return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

static bool is_tile_name(const char *name)
{
	const char *dot = strrchr(name, '.');
	return dot && (!strcmp(dot, ".mvt") || !strcmp(dot, ".pbf"));
}

/* Numbers from the end of ".../15-5237-12665.mvt" or ".../15/5237/12665.mvt". */
static bool parse_name(const char *path, struct tile_file *file)
{
	int *const numbers[] = { &file->y, &file->x, &file->zoom };
	const char *at = strrchr(path, '.');
	for (int i = 0; at && i < 3; i++) {
		const char *end = at;
		while (at > path && at[-1] >= '0' && at[-1] <= '9')
			at--;
		if (at == end || end - at > 8)
			return false;
		*numbers[i] = atoi(at);
		if (i < 2 && (at == path || (at[-1] != '-' && at[-1] != '/')))
			return false;
		at--;
	}
	return at && file->zoom >= 8 && file->zoom <= 18;
}

static void list_folder(struct tiles *tiles, const char *path, int depth)
{
	DIR *folder = opendir(path);
	if (!folder)
		return;
	for (struct dirent *entry; (entry = readdir(folder));) {
		char *inner = NULL;
		if (entry->d_name[0] == '.' || asprintf(&inner, "%s/%s", path, entry->d_name) < 0)
			continue;
		struct tile_file file = { .path = inner };
		if (is_tile_name(entry->d_name) && parse_name(inner, &file)) {
			ARRAY_PUSH(&tiles->files, file);
			continue;
		}
		if (depth && tiles_is_folder(inner))
			list_folder(tiles, inner, depth - 1);
		free(inner);
	}
	closedir(folder);
}

static int by_tile(const void *a, const void *b)
{
	const struct tile_file *p = a, *q = b;
	if (p->zoom != q->zoom)
		return p->zoom > q->zoom ? -1 : 1;
	if (p->x != q->x)
		return p->x < q->x ? -1 : 1;
	return p->y != q->y ? (p->y < q->y ? -1 : 1) : strcmp(p->path, q->path);
}

struct tag_list {
	struct osm_store *store;
	struct osm_tag items[TAGS_LIMIT];
	size_t count;
};

static void tag(struct tag_list *list, const char *key, const char *value)
{
	if (value && *value && list->count < TAGS_LIMIT)
		list->items[list->count++] =
			(struct osm_tag){ osm_store_text(list->store, key, 0), osm_store_text(list->store, value, 0) };
}

static struct osm_tags tags_of(const struct tag_list *list)
{
	return (
		struct osm_tags){ pool_copy(&list->store->pool, list->items, list->count * sizeof(*list->items)), list->count };
}

/* A field's text, or "". GDAL prints numbers into a buffer that the next one overwrites, hence the copy. */
static const char *field(const struct tiles *tiles, OGRFeatureH feature, const char *name)
{
	int index = OGR_F_GetFieldIndex(feature, name);
	if (index < 0 || !OGR_F_IsFieldSetAndNotNull(feature, index))
		return "";
	return pool_string(&tiles->store->pool, OGR_F_GetFieldAsString(feature, index));
}

static bool is_true(const char *text)
{
	return !strcmp(text, "true") || !strcmp(text, "1");
}

static void units_of(const struct tiles *tiles, OGRGeometryH points, int i, double *east, double *south)
{
	*east = (OGR_G_GetX(points, i) + WORLD_M / 2.0) / tiles->unit_m;
	*south = (WORLD_M / 2.0 - OGR_G_GetY(points, i)) / tiles->unit_m;
}

static tile_place place_of(const struct tiles *tiles, OGRGeometryH points, int i)
{
	double east, south;
	units_of(tiles, points, i, &east, &south);
	east = fmin(fmax(east, 0.0), tiles->world_units);
	south = fmin(fmax(south, 0.0), tiles->world_units);
	return tile_place_of(llround(east), llround(south));
}

static void take_line(struct tiles *tiles, OGRGeometryH geometry, const struct tile_line *like)
{
	if (wkbFlatten(OGR_G_GetGeometryType(geometry)) != wkbLineString) {
		for (int i = 0; i < OGR_G_GetGeometryCount(geometry); i++)
			take_line(tiles, OGR_G_GetGeometryRef(geometry, i), like);
		return;
	}
	struct tile_line line = *like;
	int count = OGR_G_GetPointCount(geometry);
	line.places = POOL_ARRAY(&tiles->store->pool, tile_place, count);
	for (int i = 0; i < count; i++) {
		tile_place place = place_of(tiles, geometry, i);
		if (!line.count || line.places[line.count - 1] != place)
			line.places[line.count++] = place;
	}
	if (line.count >= 2)
		ARRAY_PUSH(&tiles->lines, line);
}

static bool take_ring(struct tiles *tiles, OGRGeometryH from, struct ring *out, bool *on_border)
{
	int count = OGR_G_GetPointCount(from);
	*out = (struct ring){ POOL_ARRAY(&tiles->store->pool, struct dvec2, count), 0 };
	for (int i = 0; i + 1 < count; i++) {
		tile_place place = place_of(tiles, from, i);
		struct dvec2 at = tile_point(place);
		*on_border |= tile_east(place) % TILE_UNITS == 0 || tile_south(place) % TILE_UNITS == 0;
		if (!out->count || out->points[out->count - 1].x != at.x || out->points[out->count - 1].y != at.y)
			out->points[out->count++] = at;
	}
	return out->count >= 3;
}

static void take_area(struct tiles *tiles, OGRGeometryH geometry, const struct tile_area *like)
{
	if (wkbFlatten(OGR_G_GetGeometryType(geometry)) != wkbPolygon) {
		for (int i = 0; i < OGR_G_GetGeometryCount(geometry); i++)
			take_area(tiles, OGR_G_GetGeometryRef(geometry, i), like);
		return;
	}
	struct tile_area area = *like;
	polygon_array clean = { 0 };
	int rings = OGR_G_GetGeometryCount(geometry);
	if (rings < 1 || !take_ring(tiles, OGR_G_GetGeometryRef(geometry, 0), &area.shape.outer, &area.on_border))
		return;
	area.shape.holes = POOL_ARRAY(&tiles->store->pool, struct ring, rings);
	for (int i = 1; i < rings; i++)
		area.shape.hole_count += take_ring(
			tiles, OGR_G_GetGeometryRef(geometry, i), &area.shape.holes[area.shape.hole_count], &area.on_border);
	/* Rounding to the grid may have tied knots. */
	shape_polygons(&tiles->shaper, tiles->next_id, &area.shape, 2.0, &clean);
	for (size_t i = 0; i < clean.count; i++) {
		area.shape = clean.items[i];
		ARRAY_PUSH(&tiles->areas, area);
	}
	ARRAY_FINISH(&clean);
}

/* "service:driveway": the part before the colon is the street's kind. */
static void split_type(const char *type, char kind[32], const char **detail)
{
	size_t length = strcspn(type, ":");
	if (length > 31)
		length = 31;
	memcpy(kind, type, length);
	kind[length] = 0;
	*detail = type[length] ? type + length + 1 : "";
}

static void road_tags(const struct tiles *tiles, struct tag_list *tags, OGRFeatureH feature)
{
	static const struct {
		const char *class, *key, *value;
	} classes[] = {
		{ "street", "highway", "residential" },
		{ "street_limited", "highway", "residential" },
		{ "minor", "highway", "residential" },
		{ "main", "highway", "secondary" },
		{ "motorway", "highway", "motorway" },
		{ "motorway_link", "highway", "motorway_link" },
		{ "trunk", "highway", "trunk" },
		{ "trunk_link", "highway", "trunk_link" },
		{ "primary", "highway", "primary" },
		{ "secondary", "highway", "secondary" },
		{ "tertiary", "highway", "tertiary" },
		{ "link", "highway", "tertiary_link" },
		{ "service", "highway", "service" },
		{ "driveway", "highway", "service" },
		{ "pedestrian", "highway", "pedestrian" },
		{ "path", "highway", "footway" },
		{ "track", "highway", "track" },
		{ "major_rail", "railway", "rail" },
		{ "minor_rail", "railway", "tram" },
		{ "rail", "railway", "rail" },
		{ "transit", "railway", "tram" },
	};
	char kind[32];
	const char *class = field(tiles, feature, "class"), *type = field(tiles, feature, "type"), *detail;
	split_type(*type ? type : field(tiles, feature, "subclass"), kind, &detail);
	for (size_t i = 0; i < sizeof(classes) / sizeof(*classes); i++) {
		if (strcmp(class, classes[i].class) != 0)
			continue;
		bool rail = !strcmp(classes[i].key, "railway"), path = !strcmp(class, "path");
		if (!strcmp(kind, "sidewalk") || !strcmp(kind, "crossing")) {
			tag(tags, "highway", "footway");
			tag(tags, "footway", kind);
		} else if (rail || osm_is_highway(kind) || !path) {
			tag(tags, classes[i].key,
				rail                   ? (*kind ? kind : classes[i].value)
				: osm_is_highway(kind) ? kind
									   : classes[i].value);
		} else {
			tag(tags, "highway", "footway");
		}
		if (!strcmp(kind, "service"))
			tag(tags, "service", detail);
		return;
	}
}

static void take_road(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry)
{
	struct tag_list tags = { .store = tiles->store };
	const char *structure = field(tiles, feature, "structure"), *layer = field(tiles, feature, "layer"),
			   *oneway = field(tiles, feature, "oneway");
	if (!*structure)
		structure = field(tiles, feature, "brunnel");
	bool bridge = !strcmp(structure, "bridge"), tunnel = !strcmp(structure, "tunnel");
	road_tags(tiles, &tags, feature);
	if (!tags.count)
		return;
	if (bridge || tunnel)
		tag(&tags, structure, "yes");
	tag(&tags, "layer", layer);
	if (!strcmp(oneway, "-1"))
		tag(&tags, "oneway", "-1");
	else if (is_true(oneway))
		tag(&tags, "oneway", "yes");
	bool road = !strcmp(tags.items[0].key, "highway");
	take_line(tiles, geometry,
		&(struct tile_line){ .tags = tags_of(&tags), .level = atoi(layer) * 4 + bridge * 2 + tunnel, .road = road });
}

static void take_building(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry)
{
	struct tag_list tags = { .store = tiles->store };
	const char *type = field(tiles, feature, "type"), *height = field(tiles, feature, "height"),
			   *low = field(tiles, feature, "min_height");
	if (is_true(field(tiles, feature, "underground")) || !strcmp(field(tiles, feature, "hide_3d"), "1"))
		return;
	if (!strcmp(type, "building:part")) {
		tag(&tags, "building:part", "yes");
	} else {
		tag(&tags, "building", osm_building_kind(type) >= 0 ? type : "yes");
		if (osm_building_kind(type) < 0)
			tag(&tags, "amenity", type);
	}
	tag(&tags, "height", *height ? height : field(tiles, feature, "render_height"));
	tag(&tags, "min_height", *low ? low : field(tiles, feature, "render_min_height"));
	take_area(tiles, geometry, &(struct tile_area){ .tags = tags_of(&tags), .building = true });
}

static void take_ground(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry)
{
	static const struct {
		const char *class, *type, *key, *value; /* type NULL: any */
	} rules[] = {
		{ "park", "playground", "leisure", "playground" },
		{ "park", "garden", "leisure", "garden" },
		{ "park", "sports_centre", NULL, NULL },
		{ "park", NULL, "leisure", "park" },
		{ "grass", NULL, "landuse", "grass" },
		{ "wood", NULL, "landuse", "forest" },
		{ "scrub", NULL, "natural", "scrub" },
		{ "pitch", NULL, "leisure", "pitch" },
		{ "parking", "rooftop", NULL, NULL },
		{ "parking", "underground", NULL, NULL },
		{ "parking", "multi-storey", NULL, NULL },
		{ "parking", NULL, "amenity", "parking" },
		{ "cemetery", NULL, "landuse", "cemetery" },
		{ "sand", NULL, "natural", "sand" },
		{ "rock", NULL, "natural", "bare_rock" },
		{ "agriculture", NULL, "landuse", "farmland" },
		{ "commercial_area", NULL, "landuse", "commercial" },
	};
	struct tag_list tags = { .store = tiles->store };
	const char *class = field(tiles, feature, "class"), *type = field(tiles, feature, "type");
	for (size_t i = 0; i < sizeof(rules) / sizeof(*rules); i++) {
		if (strcmp(class, rules[i].class) != 0 || (rules[i].type && strcmp(type, rules[i].type) != 0))
			continue;
		tag(&tags, rules[i].key, rules[i].value);
		break;
	}
	if (tags.count)
		take_area(tiles, geometry, &(struct tile_area){ .tags = tags_of(&tags) });
}

static void take_water(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry)
{
	struct tag_list tags = { .store = tiles->store };
	(void)feature;
	tag(&tags, "natural", "water");
	take_area(tiles, geometry, &(struct tile_area){ .tags = tags_of(&tags) });
}

static void take_named_line(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry, const char *key)
{
	struct tag_list tags = { .store = tiles->store };
	tag(&tags, key, field(tiles, feature, "class"));
	take_line(tiles, geometry, &(struct tile_line){ .tags = tags_of(&tags) });
}

static void take_waterway(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry)
{
	take_named_line(tiles, feature, geometry, "waterway");
}

static void take_barrier(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry)
{
	take_named_line(tiles, feature, geometry, "barrier");
}

static void take_label_line(struct tiles *tiles, OGRGeometryH geometry, const char *name)
{
	if (wkbFlatten(OGR_G_GetGeometryType(geometry)) != wkbLineString) {
		for (int i = 0; i < OGR_G_GetGeometryCount(geometry); i++)
			take_label_line(tiles, OGR_G_GetGeometryRef(geometry, i), name);
		return;
	}
	for (int i = 1; i < OGR_G_GetPointCount(geometry); i++) {
		double east[2], south[2];
		units_of(tiles, geometry, i - 1, &east[0], &south[0]);
		units_of(tiles, geometry, i, &east[1], &south[1]);
		ARRAY_PUSH(&tiles->names, (struct tile_name){ { east[0], -south[0] }, { east[1], -south[1] }, name });
	}
}

static void take_label(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry)
{
	const char *name = field(tiles, feature, "name");
	if (*name)
		take_label_line(tiles, geometry, osm_store_text(tiles->store, name, 0));
}

static void degrees_of(const struct tiles *tiles, double east, double south, double *lon, double *lat)
{
	*lon = east / tiles->world_units * 360.0 - 180.0;
	*lat = atan(sinh(BLVD_PI * (1.0 - 2.0 * south / tiles->world_units))) * 180.0 / BLVD_PI;
}

static void take_point(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry)
{
	static const char *const shops[] = { "shop", "restaurant", "cafe", "bar", "beer", "fast-food", "grocery", "bank",
		"pharmacy", "clothing-store", "bakery", "ice-cream" };
	const char *maki = field(tiles, feature, "maki");
	for (size_t i = 0; i < sizeof(shops) / sizeof(*shops); i++) {
		if (strcmp(maki, shops[i]) != 0 || wkbFlatten(OGR_G_GetGeometryType(geometry)) != wkbPoint)
			continue;
		struct tag_list tags = { .store = tiles->store };
		double east, south;
		struct osm_node node = { .id = tiles->next_id++, .fate = ELEMENT_IGNORED };
		tag(&tags, "shop", "yes");
		units_of(tiles, geometry, 0, &east, &south);
		degrees_of(tiles, east, south, &node.lon_deg, &node.lat_deg);
		node.tags = tags_of(&tags);
		osm_store_add_node(tiles->store, &node);
	}
}

static bool ring_in_degrees(struct tiles *tiles, OGRGeometryH from, struct ring *out)
{
	int count = OGR_G_GetPointCount(from);
	*out = (struct ring){ POOL_ARRAY(&tiles->store->pool, struct dvec2, count), (size_t)(count > 0 ? count - 1 : 0) };
	for (int i = 0; i + 1 < count; i++) {
		double east, south;
		units_of(tiles, from, i, &east, &south);
		degrees_of(tiles, east, south, &out->points[i].x, &out->points[i].y);
	}
	return out->count >= 3;
}

static void take_contour_polygon(struct tiles *tiles, OGRGeometryH geometry, double height_m)
{
	if (wkbFlatten(OGR_G_GetGeometryType(geometry)) != wkbPolygon) {
		for (int i = 0; i < OGR_G_GetGeometryCount(geometry); i++)
			take_contour_polygon(tiles, OGR_G_GetGeometryRef(geometry, i), height_m);
		return;
	}
	struct contour contour = { .height_m = height_m };
	int rings = OGR_G_GetGeometryCount(geometry);
	if (rings < 1 || !ring_in_degrees(tiles, OGR_G_GetGeometryRef(geometry, 0), &contour.degrees.outer))
		return;
	contour.degrees.holes = POOL_ARRAY(&tiles->store->pool, struct ring, rings);
	for (int i = 1; i < rings; i++)
		contour.degrees.hole_count += ring_in_degrees(
			tiles, OGR_G_GetGeometryRef(geometry, i), &contour.degrees.holes[contour.degrees.hole_count]);
	ARRAY_PUSH(tiles->contours, contour);
}

static void take_contour(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry)
{
	const char *height = field(tiles, feature, "ele");
	if (*height)
		take_contour_polygon(tiles, geometry, atof(height));
}

static const struct layer_rule {
	const char *name;
	void (*take)(struct tiles *tiles, OGRFeatureH feature, OGRGeometryH geometry);
} layer_rules[] = {
	{ "building", take_building },
	{ "road", take_road },
	{ "transportation", take_road },
	{ "water", take_water },
	{ "waterway", take_waterway },
	{ "landuse", take_ground },
	{ "barrier_line", take_barrier },
	{ "road_label", take_label },
	{ "transportation_name", take_label },
	{ "poi_label", take_point },
	{ "contour", take_contour },
};

static int read_layer(struct tiles *tiles, OGRLayerH layer, const struct layer_rule *rule, const char *path)
{
	OGRFeatureH feature;
	CPLErrorReset();
	while ((feature = OGR_L_GetNextFeature(layer))) {
		OGRGeometryH geometry = OGR_F_GetGeometryRef(feature);
		if (geometry)
			rule->take(tiles, feature, geometry);
		OGR_F_Destroy(feature);
	}
	if (CPLGetLastErrorType() < CE_Failure)
		return 0;
	log_error("%s: layer '%s': %s", path, rule->name, gdal_reason("cannot be read"));
	return -EBADMSG;
}

static int read_tile(struct tiles *tiles, const struct tile_file *file)
{
	char x[16], y[16], z[16];
	snprintf(x, sizeof(x), "X=%d", file->x);
	snprintf(y, sizeof(y), "Y=%d", file->y);
	snprintf(z, sizeof(z), "Z=%d", file->zoom);
	const char *const drivers[] = { "MVT", NULL }, *const options[] = { x, y, z, "METADATA_FILE=", NULL };
	GDALDatasetH dataset = GDALOpenEx(file->path, GDAL_OF_VECTOR | GDAL_OF_READONLY, drivers, options, NULL);
	int status = 0;
	if (!dataset) {
		log_error("%s: no vector tile that can be read: %s", file->path, gdal_reason("not a vector tile"));
		return -EBADMSG;
	}
	for (size_t i = 0; i < sizeof(layer_rules) / sizeof(*layer_rules) && !status; i++) {
		OGRLayerH layer = GDALDatasetGetLayerByName(dataset, layer_rules[i].name);
		if (layer)
			status = read_layer(tiles, layer, &layer_rules[i], file->path);
	}
	GDALClose(dataset);
	return status;
}

typedef ARRAY(tile_place) place_array;

static int by_place(const void *a, const void *b)
{
	tile_place x = *(const tile_place *)a, y = *(const tile_place *)b;
	return x < y ? -1 : x > y;
}

static void add_way(
	struct tiles *tiles, const tile_place *places, size_t count, bool close, struct osm_tags tags, place_array *all)
{
	int64_t *refs = POOL_ARRAY(&tiles->store->pool, int64_t, count + 1);
	for (size_t i = 0; count && i < count + close; i++) {
		refs[i] = places[i % count];
		ARRAY_PUSH(all, refs[i]);
	}
	osm_store_add_way(tiles->store,
		&(struct osm_way){
			.id = tiles->next_id++, .refs = refs, .ref_count = count + close, .tags = tags, .fate = ELEMENT_IGNORED });
}

static void add_ring(struct tiles *tiles, const struct ring *ring, struct osm_tags tags, place_array *all)
{
	tile_place *places = POOL_ARRAY(&tiles->store->pool, tile_place, ring->count);
	for (size_t i = 0; i < ring->count; i++)
		places[i] = tile_place_of(llround(ring->points[i].x), llround(-ring->points[i].y));
	add_way(tiles, places, ring->count, true, tags, all);
}

static void add_area(struct tiles *tiles, const struct tile_area *area, place_array *all)
{
	struct osm_store *store = tiles->store;
	if (!area->shape.hole_count) {
		add_ring(tiles, &area->shape.outer, area->tags, all);
		return;
	}
	size_t count = area->shape.hole_count + 1;
	struct osm_member *members = POOL_ARRAY(&store->pool, struct osm_member, count);
	for (size_t i = 0; i < count; i++) {
		members[i] =
			(struct osm_member){ tiles->next_id, osm_store_text(store, i ? "inner" : "outer", 0), OSM_MEMBER_WAY };
		add_ring(tiles, i ? &area->shape.holes[i - 1] : &area->shape.outer, (struct osm_tags){ 0 }, all);
	}
	struct osm_tag *tags = POOL_ARRAY(&store->pool, struct osm_tag, area->tags.count + 1);
	memcpy(tags, area->tags.items, area->tags.count * sizeof(*tags));
	tags[area->tags.count] =
		(struct osm_tag){ osm_store_text(store, "type", 0), osm_store_text(store, "multipolygon", 0) };
	osm_store_add_relation(store, &(struct osm_relation){ .id = tiles->next_id++,
									  .members = members,
									  .member_count = count,
									  .tags = { tags, area->tags.count + 1 },
									  .fate = ELEMENT_IGNORED });
}

static void add_nodes(struct tiles *tiles, place_array *all)
{
	ARRAY_SORT(all, by_place);
	for (size_t i = 0; i < all->count; i++) {
		struct osm_node node = { .id = all->items[i], .fate = ELEMENT_IGNORED };
		if (i && all->items[i - 1] == all->items[i])
			continue;
		degrees_of(tiles, (double)tile_east(node.id), (double)tile_south(node.id), &node.lon_deg, &node.lat_deg);
		osm_store_add_node(tiles->store, &node);
	}
}

static void add_elements(struct tiles *tiles)
{
	place_array all = { 0 };
	for (size_t i = 0; i < tiles->lines.count; i++)
		add_way(
			tiles, tiles->lines.items[i].places, tiles->lines.items[i].count, false, tiles->lines.items[i].tags, &all);
	for (size_t i = 0; i < tiles->areas.count; i++)
		add_area(tiles, &tiles->areas.items[i], &all);
	add_nodes(tiles, &all);
	ARRAY_FINISH(&all);
}

static int read_files(struct tiles *tiles, const char *path)
{
	int status = 0;
	if (!tiles->files.count) {
		log_error("%s: is a directory, and no vector tiles (z-x-y.mvt or z/x/y.mvt) are in it", path);
		return -EISDIR;
	}
	ARRAY_SORT(&tiles->files, by_tile);
	int zoom = tiles->files.items[0].zoom;
	tiles->world_units = ldexp(TILE_UNITS, zoom);
	tiles->unit_m = WORLD_M / tiles->world_units;
	for (size_t i = 0; i < tiles->files.count && !status; i++)
		if (tiles->files.items[i].zoom == zoom)
			status = read_tile(tiles, &tiles->files.items[i]);
	return status;
}

int tiles_read(struct osm_store *store, contour_array *contours, const char *path)
{
	struct tiles tiles = { .store = store, .contours = contours, .next_id = FIRST_ID };
	gdal_start();
	shaper_init(&tiles.shaper, &store->pool, store->report);
	list_folder(&tiles, path, 3);
	int status = read_files(&tiles, path);
	if (!status) {
		tile_lines_connect(&tiles.lines, &tiles.names, store);
		tile_areas_join(&tiles.areas, &store->pool, store->report);
		add_elements(&tiles);
	}
	for (size_t i = 0; i < tiles.files.count; i++)
		free(tiles.files.items[i].path);
	ARRAY_FINISH(&tiles.files);
	ARRAY_FINISH(&tiles.lines);
	ARRAY_FINISH(&tiles.names);
	ARRAY_FINISH(&tiles.areas);
	shaper_finish(&tiles.shaper);
	return status;
}
