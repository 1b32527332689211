#include "tools/read/cityjson.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <ogr_srs_api.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/file_map.h"
#include "platform/base/log.h"
#include "tools/read/cityjson_shape.h"
#include "tools/read/gdal_quiet.h"

#define LEAST_HEIGHT_M 1.5

struct vertices {
	struct dvec3 *items; /* the file's coordinates, transformed, less `origin` */
	size_t count;
	struct dvec3 origin;
};

struct json_reader {
	struct building_set *set;
	struct report *report;
	const char *name;
	struct shaper shaper;
	struct vertices vertices;
	OGRCoordinateTransformationH to_wgs84;
};

static int64_t id_of(const char *text)
{
	uint64_t hash = UINT64_C(0xCBF29CE484222325); /* FNV-1a */
	for (; *text; text++)
		hash = (hash ^ (unsigned char)*text) * UINT64_C(0x100000001B3);
	return (int64_t)(hash >> 1);
}

static bool numbers(const cJSON *array, double out[3])
{
	const cJSON *item = array ? array->child : NULL;
	for (int i = 0; i < 3; i++, item = item->next) {
		if (!item || !cJSON_IsNumber(item))
			return false;
		out[i] = item->valuedouble;
	}
	return true;
}

static int refuse(const struct json_reader *reader, const char *problem)
{
	log_error("%s: %s", reader->name, problem);
	return -EBADMSG;
}

static int read_vertices(struct json_reader *reader, const cJSON *root)
{
	const cJSON *list = cJSON_GetObjectItem(root, "vertices"), *transform = cJSON_GetObjectItem(root, "transform"),
				*item;
	double scale[3] = { 1.0, 1.0, 1.0 }, translate[3] = { 0.0, 0.0, 0.0 }, v[3];
	size_t capacity = 0;
	if (transform && (!numbers(cJSON_GetObjectItem(transform, "scale"), scale) ||
						 !numbers(cJSON_GetObjectItem(transform, "translate"), translate)))
		return refuse(reader, "its transform is no scale and translate of three numbers");
	struct vertices *vertices = &reader->vertices;
	vertices->items = array_grow(NULL, &capacity, (size_t)cJSON_GetArraySize(list) + 1, sizeof(struct dvec3));
	cJSON_ArrayForEach(item, list)
	{
		if (!numbers(item, v)) {
			log_error("%s: vertex %zu is not three numbers", reader->name, vertices->count);
			return -EBADMSG;
		}
		struct dvec3 at = { v[0] * scale[0] + translate[0], v[1] * scale[1] + translate[1],
			v[2] * scale[2] + translate[2] };
		if (!vertices->count)
			vertices->origin = (struct dvec3){ at.x, at.y, 0.0 };
		vertices->items[vertices->count++] =
			(struct dvec3){ at.x - vertices->origin.x, at.y - vertices->origin.y, at.z };
	}
	return vertices->count ? 0 : refuse(reader, "no vertices in it");
}

/* ".../EPSG/0/28992", "urn:ogc:def:crs:EPSG::28992", "EPSG:28992": the last number. */
static int epsg_of(const cJSON *root)
{
	const cJSON *system = cJSON_GetObjectItem(cJSON_GetObjectItem(root, "metadata"), "referenceSystem");
	const char *text = cJSON_GetStringValue(system), *at = text ? text + strlen(text) : NULL;
	if (!text || !strcasestr(text, "epsg"))
		return 0;
	while (at > text && at[-1] >= '0' && at[-1] <= '9')
		at--;
	return atoi(at);
}

static int find_transformation(struct json_reader *reader, const cJSON *root)
{
	int code = epsg_of(root);
	if (!code)
		return refuse(reader, "does not say its coordinate system (metadata.referenceSystem)");
	OGRSpatialReferenceH from = OSRNewSpatialReference(NULL), to = OSRNewSpatialReference(NULL);
	if (OSRImportFromEPSG(from, code) == OGRERR_NONE) {
		/* Heights are used as they are; what matters is where things lie. */
		OSRStripVertical(from);
		OSRImportFromEPSG(to, 4326);
		OSRSetAxisMappingStrategy(from, OAMS_TRADITIONAL_GIS_ORDER);
		OSRSetAxisMappingStrategy(to, OAMS_TRADITIONAL_GIS_ORDER);
		reader->to_wgs84 = OCTNewCoordinateTransformation(from, to);
	}
	OSRDestroySpatialReference(from);
	OSRDestroySpatialReference(to);
	if (reader->to_wgs84)
		return 0;
	log_error("%s: coordinate system EPSG:%d is not known: %s", reader->name, code, gdal_reason("no such code"));
	return -EBADMSG;
}

static bool take_ring(struct json_reader *reader, const cJSON *list, struct surface_ring *out)
{
	const cJSON *item;
	*out = (struct surface_ring){ POOL_ARRAY(reader->shaper.pool, struct dvec3, cJSON_GetArraySize(list)), 0 };
	cJSON_ArrayForEach(item, list)
	{
		if (!cJSON_IsNumber(item) || item->valuedouble < 0.0 || item->valuedouble >= (double)reader->vertices.count)
			return false;
		out->points[out->count++] = reader->vertices.items[(size_t)item->valuedouble];
	}
	return out->count >= 3;
}

/* [[outer], [hole], ...] */
static bool take_surface(struct json_reader *reader, const cJSON *rings, bool ground, surface_array *out)
{
	struct surface surface = { .ground = ground,
		.rings = POOL_ARRAY(reader->shaper.pool, struct surface_ring, cJSON_GetArraySize(rings)) };
	const cJSON *ring;
	cJSON_ArrayForEach(ring, rings)
	{
		if (take_ring(reader, ring, &surface.rings[surface.ring_count]))
			surface.ring_count++;
		else if (!surface.ring_count)
			return false;
	}
	if (surface.ring_count)
		ARRAY_PUSH(out, surface);
	return surface.ring_count > 0;
}

/* Which of the semantic surfaces a value names is the ground. */
static bool names_ground(const cJSON *surfaces, const cJSON *value)
{
	const cJSON *semantic = cJSON_IsNumber(value) ? cJSON_GetArrayItem(surfaces, value->valueint) : NULL;
	const char *type = cJSON_GetStringValue(cJSON_GetObjectItem(semantic, "type"));
	return type && !strcmp(type, "GroundSurface");
}

/* Shells, solids and the like nest: `depth` says how many lists are around the surfaces; values nest alike. */
static bool take_boundaries(struct json_reader *reader, const cJSON *list, const cJSON *values, const cJSON *surfaces,
	int depth, surface_array *out)
{
	const cJSON *item, *value = cJSON_IsArray(values) ? values->child : NULL;
	bool sound = cJSON_IsArray(list);
	cJSON_ArrayForEach(item, list)
	{
		if (depth)
			sound &= take_boundaries(reader, item, value, surfaces, depth - 1, out);
		else
			sound &= take_surface(reader, item, names_ground(surfaces, value), out);
		value = value ? value->next : NULL;
	}
	return sound;
}

static double level_of_detail(const cJSON *geometry)
{
	const cJSON *lod = cJSON_GetObjectItem(geometry, "lod");
	return cJSON_IsNumber(lod) ? lod->valuedouble : cJSON_IsString(lod) ? atof(lod->valuestring) : 0.0;
}

/* The finest that is no finer than LoD2: LoD3 has rooms and window frames. */
static const cJSON *choose_geometry(const cJSON *object)
{
	const cJSON *item, *best = NULL;
	cJSON_ArrayForEach(item, cJSON_GetObjectItem(object, "geometry"))
	{
		double lod = level_of_detail(item), best_lod = best ? level_of_detail(best) : -1.0;
		if ((lod < 3.0 && lod > best_lod) || !best)
			best = item;
	}
	return best;
}

static bool take_geometry(struct json_reader *reader, const cJSON *geometry, surface_array *out)
{
	static const struct {
		const char *type;
		int depth;
	} types[] = { { "MultiSurface", 0 }, { "CompositeSurface", 0 }, { "Solid", 1 }, { "MultiSolid", 2 },
		{ "CompositeSolid", 2 } };
	const char *type = cJSON_GetStringValue(cJSON_GetObjectItem(geometry, "type"));
	const cJSON *semantics = cJSON_GetObjectItem(geometry, "semantics");
	for (size_t i = 0; type && i < sizeof(types) / sizeof(*types); i++)
		if (!strcmp(type, types[i].type))
			return take_boundaries(reader, cJSON_GetObjectItem(geometry, "boundaries"),
				cJSON_GetObjectItem(semantics, "values"), cJSON_GetObjectItem(semantics, "surfaces"), types[i].depth,
				out);
	return false;
}

static bool to_degrees(const struct json_reader *reader, struct dvec2 at, struct dvec2 *out)
{
	double x = at.x + reader->vertices.origin.x, y = at.y + reader->vertices.origin.y;
	if (!OCTTransform(reader->to_wgs84, 1, &x, &y, NULL) || !(fabs(x) <= 360.0 && fabs(y) <= 90.0))
		return false;
	*out = (struct dvec2){ x, y };
	return true;
}

static bool ring_to_degrees(struct json_reader *reader, const struct ring *from, struct ring *out)
{
	*out = (struct ring){ POOL_ARRAY(&reader->set->pool, struct dvec2, from->count), from->count };
	for (size_t i = 0; i < from->count; i++)
		if (!to_degrees(reader, from->points[i], &out->points[i]))
			return false;
	return true;
}

static bool polygon_to_degrees(struct json_reader *reader, const struct polygon *from, struct polygon *out)
{
	*out = (struct polygon){ .holes = POOL_ARRAY(&reader->set->pool, struct ring, from->hole_count),
		.hole_count = from->hole_count };
	bool fine = ring_to_degrees(reader, &from->outer, &out->outer);
	for (size_t i = 0; fine && i < from->hole_count; i++)
		fine = ring_to_degrees(reader, &from->holes[i], &out->holes[i]);
	return fine;
}

static void height_range(const surface_array *surfaces, double *low, double *high)
{
	*low = INFINITY;
	*high = -INFINITY;
	for (size_t i = 0; i < surfaces->count; i++)
		for (size_t r = 0; r < surfaces->items[i].ring_count; r++)
			for (size_t k = 0; k < surfaces->items[i].rings[r].count; k++) {
				*low = fmin(*low, surfaces->items[i].rings[r].points[k].z);
				*high = fmax(*high, surfaces->items[i].rings[r].points[k].z);
			}
}

/* A closed surface that faces inwards has a negative volume. */
static void face_outwards(triangle_array *triangles)
{
	double volume = 0.0;
	for (size_t i = 0; i + 2 < triangles->count; i += 3) {
		const struct dvec3 *p = &triangles->items[i], o = triangles->items[0];
		struct dvec3 a = { p[0].x - o.x, p[0].y - o.y, p[0].z - o.z }, b = { p[1].x - o.x, p[1].y - o.y, p[1].z - o.z };
		struct dvec3 c = { p[2].x - o.x, p[2].y - o.y, p[2].z - o.z };
		volume += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
	}
	for (size_t i = 0; volume < 0.0 && i + 2 < triangles->count; i += 3) {
		struct dvec3 swap = triangles->items[i];
		triangles->items[i] = triangles->items[i + 1];
		triangles->items[i + 1] = swap;
	}
}

static void set_walls(
	struct json_reader *reader, const surface_array *surfaces, double foot, struct set_building *building)
{
	triangle_array all = { 0 };
	for (size_t i = 0; i < surfaces->count; i++)
		if (!surface_triangles(&reader->shaper, &surfaces->items[i], &all))
			report_fault(reader->report, FAULT_DEGENERATE_RING, FAULT_DROPPED, building->id);
	face_outwards(&all);
	building->walls = POOL_ARRAY(&reader->set->pool, struct dvec3, all.count);
	for (size_t i = 0; i < all.count; i++) {
		struct dvec2 at;
		if (!to_degrees(reader, (struct dvec2){ all.items[i].x, all.items[i].y }, &at))
			break;
		building->walls[building->wall_count++] = (struct dvec3){ at.x, at.y, all.items[i].z - foot };
	}
	building->wall_count -= building->wall_count % 3;
	ARRAY_FINISH(&all);
}

static void drop_ground(surface_array *surfaces)
{
	size_t kept = 0;
	for (size_t i = 0; i < surfaces->count; i++)
		if (!surfaces->items[i].ground)
			surfaces->items[kept++] = surfaces->items[i];
	surfaces->count = kept;
}

static enum element_fate make_building(
	struct json_reader *reader, const cJSON *object, int64_t id, const cJSON *geometry, surface_array *surfaces)
{
	polygon_array footprint = { 0 };
	const cJSON *measured = cJSON_GetObjectItem(cJSON_GetObjectItem(object, "attributes"), "measuredHeight");
	struct set_building building = { .id = id, .eaves_z_m = NAN, .ground_z_m = NAN };
	double low, high;
	enum element_fate fate = ELEMENT_FAULTY;
	height_range(surfaces, &low, &high);
	bool tall = high - low >= LEAST_HEIGHT_M;
	/* A footprint alone (LoD0) may still say how high it is. */
	building.height_m = tall ? high - low : cJSON_IsNumber(measured) ? fmax(measured->valuedouble, 0.0) : 0.0;
	surfaces_footprint(&reader->shaper, surfaces, &footprint);
	if (level_of_detail(geometry) >= 2.0 && tall) {
		drop_ground(surfaces);
		set_walls(reader, surfaces, low, &building);
	}
	size_t largest = 0;
	for (size_t i = 0; i < footprint.count; i++)
		if (polygon_area(&footprint.items[i]) > polygon_area(&footprint.items[largest]))
			largest = i;
	for (size_t i = 0; i < footprint.count; i++) {
		struct set_building piece = building;
		if (building.wall_count && i != largest)
			continue;
		if (!polygon_to_degrees(reader, &footprint.items[i], &piece.degrees))
			continue;
		ARRAY_PUSH(&reader->set->buildings, piece);
		fate = ELEMENT_USED;
	}
	ARRAY_FINISH(&footprint);
	return fate;
}

static int area_kind_of(const char *type, const cJSON *attributes)
{
	static const struct {
		const char *type;
		enum area_kind kind;
	} types[] = {
		{ "WaterBody", AREA_WATER },
		{ "PlantCover", AREA_GRASS },
		{ "Road", AREA_PARKING },
		{ "TransportSquare", AREA_PEDESTRIAN },
		{ "TransportationComplex", AREA_PEDESTRIAN },
		{ "Railway", AREA_RAILWAY },
		{ "Bridge", AREA_BRIDGE },
	};
	/* The Dutch base map, from which most files with areas are made. */
	static const char *const walks[] = { "voetpad", "voetgangersgebied", "fietspad", "inrit", "woonerf" };
	const char *function = cJSON_GetStringValue(cJSON_GetObjectItem(attributes, "function"));
	const char *class = cJSON_GetStringValue(cJSON_GetObjectItem(attributes, "class"));
	for (size_t i = 0; !strcmp(type, "Road") && function && i < sizeof(walks) / sizeof(*walks); i++)
		if (!strcmp(function, walks[i]))
			return AREA_PEDESTRIAN;
	if (!strcmp(type, "PlantCover") && class && (strstr(class, "bos") || strstr(class, "forest")))
		return AREA_FOREST;
	for (size_t i = 0; i < sizeof(types) / sizeof(*types); i++)
		if (!strcmp(type, types[i].type))
			return (int)types[i].kind;
	return -1;
}

static enum element_fate make_areas(struct json_reader *reader, int64_t id, int kind, const surface_array *surfaces)
{
	polygon_array shapes = { 0 };
	enum element_fate fate = ELEMENT_FAULTY;
	surfaces_footprint(&reader->shaper, surfaces, &shapes);
	for (size_t i = 0; i < shapes.count; i++) {
		struct set_area area = { .id = id, .kind = (enum area_kind)kind };
		if (!polygon_to_degrees(reader, &shapes.items[i], &area.degrees))
			continue;
		ARRAY_PUSH(&reader->set->areas, area);
		fate = ELEMENT_USED;
	}
	ARRAY_FINISH(&shapes);
	return fate;
}

static enum element_fate make_object(struct json_reader *reader, const cJSON *object)
{
	const char *type = cJSON_GetStringValue(cJSON_GetObjectItem(object, "type"));
	const cJSON *geometry = choose_geometry(object);
	bool building = type && (!strcmp(type, "Building") || !strcmp(type, "BuildingPart"));
	int kind = type ? area_kind_of(type, cJSON_GetObjectItem(object, "attributes")) : -1;
	int64_t id = object->string ? id_of(object->string) : 0;
	if (!geometry || (!building && kind < 0))
		return ELEMENT_IGNORED;
	surface_array surfaces = { 0 };
	bool sound = take_geometry(reader, geometry, &surfaces);
	enum element_fate fate = ELEMENT_FAULTY;
	if (surfaces.count)
		fate =
			building ? make_building(reader, object, id, geometry, &surfaces) : make_areas(reader, id, kind, &surfaces);
	if (!sound)
		report_fault(reader->report, FAULT_BAD_GEOMETRY, fate == ELEMENT_FAULTY ? FAULT_DROPPED : FAULT_MENDED, id);
	else if (fate == ELEMENT_FAULTY) /* nothing of it is larger than a square metre */
		report_fault(reader->report, FAULT_DEGENERATE_RING, FAULT_DROPPED, id);
	ARRAY_FINISH(&surfaces);
	return fate;
}

static int read_root(struct json_reader *reader, const cJSON *root)
{
	const char *type = cJSON_GetStringValue(cJSON_GetObjectItem(root, "type"));
	const cJSON *object;
	if (!type || strcmp(type, "CityJSON") != 0)
		return refuse(reader, "byte 0: JSON, but not CityJSON (give building sets such as GeoJSON with --buildings)");
	int status = read_vertices(reader, root);
	if (!status)
		status = find_transformation(reader, root);
	if (status)
		return status;
	cJSON_ArrayForEach(object, cJSON_GetObjectItem(root, "CityObjects"))
	{
		reader->set->fates[make_object(reader, object)]++;
	}
	return 0;
}

int cityjson_read(struct building_set *set, const char *path, const char *name, struct report *report)
{
	struct json_reader reader = { .set = set, .report = report, .name = name };
	struct pool scratch = { 0 };
	struct file_map map;
	int status = file_map_open(&map, path);
	if (status) {
		log_error("%s: %s", name, strerror(-status));
		return status;
	}
	gdal_start();
	shaper_init(&reader.shaper, &scratch, report);
	const char *end = NULL;
	cJSON *root = cJSON_ParseWithLengthOpts((const char *)map.bytes.data, map.bytes.size, &end, false);
	if (root) {
		status = read_root(&reader, root);
	} else {
		log_error("%s: byte %zu: malformed JSON", name, end ? (size_t)(end - (const char *)map.bytes.data) : 0);
		status = -EBADMSG;
	}
	cJSON_Delete(root);
	if (reader.to_wgs84)
		OCTDestroyCoordinateTransformation(reader.to_wgs84);
	array_free(reader.vertices.items);
	shaper_finish(&reader.shaper);
	pool_finish(&scratch);
	file_map_close(&map);
	return status;
}
