#include "tools/read/building_set.h"

#include <cpl_error.h>
#include <cpl_string.h>
#include <errno.h>
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "platform/base/log.h"
#include "tools/city/box_index.h"
#include "tools/read/gdal_quiet.h"
#include "tools/read/osm_kind.h"
#include "tools/read/text.h"

#define LEAST_AREA_M2 1.0
#define HEIGHT_LIMIT_M 1000.0
#define NO_DATA_Z (-400.0) /* no land lies lower: what does is a mark for "not known" */
#define GROUND_NEAR_M 150.0
#define LOWEST_HOUSE_M 3.5

static const char *const height_names[] = { "height", "hauteur", "render_height", "building_height", "bdg_height",
	"bldg_height", "bldgheight", "hgt", "measuredheight", "measured_height", "h_max", "altura", "altezza", "hoogte",
	"hoehe", "wysokosc", NULL };
static const char *const min_height_names[] = { "min_height", "render_min_height", NULL };
static const char *const level_names[] = { "building:levels", "building_levels", "levels", "num_floors", "floors",
	"nombre_d_e", "nb_etages", "storeys", NULL };
static const char *const ground_names[] = { "altitude_s", "altitude_sol", "z_min_sol", "ground_z", "ground_height",
	"groundheight", "terrainheight", "maaiveld", NULL };
static const char *const name_names[] = { "name", "nom", NULL };
static const char *const kind_names[] = { "building", "type", NULL };
/* Survey of the French state: measured at the gutter. */
static const char *const eaves_names[] = { "hauteur", NULL };

struct fields {
	int height, min_height, levels, ground, name, kind, underground;
	bool eaves;
};

static int find_field(OGRFeatureDefnH definition, const char *const *names)
{
	for (; *names; names++)
		for (int i = 0; i < OGR_FD_GetFieldCount(definition); i++)
			if (!strcasecmp(OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(definition, i)), *names))
				return i;
	return -1;
}

static void log_missing_field(const char *path, OGRFeatureDefnH definition, const char *wanted)
{
	char list[512] = "";
	size_t used = 0;
	for (int i = 0; i < OGR_FD_GetFieldCount(definition) && used < sizeof(list) - 1; i++) {
		int printed = snprintf(list + used, sizeof(list) - used, "%s%s", i ? ", " : "",
			OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(definition, i)));
		used += printed > 0 ? (size_t)printed : 0;
	}
	log_error("%s: no field '%s'; it has: %s", path, wanted, *list ? list : "none");
}

static int find_fields(const char *path, OGRLayerH layer, const char *height_field, struct fields *out)
{
	OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layer);
	const char *const wanted[] = { height_field, NULL }, *const underground[] = { "underground", NULL };
	out->height = find_field(definition, height_field ? wanted : height_names);
	out->min_height = find_field(definition, min_height_names);
	out->levels = find_field(definition, level_names);
	out->ground = find_field(definition, ground_names);
	out->name = find_field(definition, name_names);
	out->kind = find_field(definition, kind_names);
	out->underground = find_field(definition, underground);
	if (height_field && out->height < 0) {
		log_missing_field(path, definition, height_field);
		return -EBADMSG;
	}
	out->eaves = out->height >= 0 && out->height == find_field(definition, eaves_names);
	return 0;
}

/* The layer that is about buildings, else the first with polygons. */
static OGRLayerH choose_layer(GDALDatasetH dataset)
{
	OGRLayerH polygons = NULL;
	for (int i = 0; i < GDALDatasetGetLayerCount(dataset); i++) {
		OGRLayerH layer = GDALDatasetGetLayer(dataset, i);
		if (strcasestr(OGR_L_GetName(layer), "build"))
			return layer;
		OGRwkbGeometryType type = wkbFlatten(OGR_L_GetGeomType(layer));
		if (!polygons &&
			(type == wkbPolygon || type == wkbMultiPolygon || type == wkbUnknown || type == wkbGeometryCollection))
			polygons = layer;
	}
	return polygons;
}

static bool looks_like_degrees(OGRLayerH layer)
{
	OGREnvelope box;
	return OGR_L_GetExtent(layer, &box, TRUE) == OGRERR_NONE && box.MinX >= -180.0 && box.MaxX <= 180.0 &&
		   box.MinY >= -90.0 && box.MaxY <= 90.0;
}

/* NULL with `fine` set: the coordinates are degrees already. */
static OGRCoordinateTransformationH to_wgs84(OGRLayerH layer, bool *fine)
{
	OGRSpatialReferenceH own = OGR_L_GetSpatialRef(layer);
	*fine = !own && looks_like_degrees(layer);
	if (!own)
		return NULL;
	OGRSpatialReferenceH from = OSRClone(own), to = OSRNewSpatialReference(NULL);
	OSRImportFromEPSG(to, 4326);
	OSRSetAxisMappingStrategy(from, OAMS_TRADITIONAL_GIS_ORDER);
	OSRSetAxisMappingStrategy(to, OAMS_TRADITIONAL_GIS_ORDER);
	OGRCoordinateTransformationH out = OCTNewCoordinateTransformation(from, to);
	OSRDestroySpatialReference(from);
	OSRDestroySpatialReference(to);
	*fine = out != NULL;
	return out;
}

struct set_reader {
	struct building_set *set;
	struct report *report;
	struct fields fields;
	OGRCoordinateTransformationH to_wgs84;
	double z_sum;
	size_t z_count;
};

static bool take_ring(struct set_reader *reader, OGRGeometryH from, struct ring *out)
{
	int count = OGR_G_GetPointCount(from);
	if (count < 4)
		return false;
	*out = (struct ring){ POOL_ARRAY(&reader->set->pool, struct dvec2, count), (size_t)count - 1 };
	for (int i = 0; i + 1 < count; i++) {
		double x = OGR_G_GetX(from, i), y = OGR_G_GetY(from, i), z = OGR_G_GetZ(from, i);
		if (reader->to_wgs84 && !OCTTransform(reader->to_wgs84, 1, &x, &y, NULL))
			return false;
		if (!(fabs(x) <= 360.0 && fabs(y) <= 90.0))
			return false;
		out->points[i] = (struct dvec2){ x, y };
		if (OGR_G_Is3D(from) && z > NO_DATA_Z) {
			reader->z_sum += z;
			reader->z_count++;
		}
	}
	return true;
}

static bool take_polygon(struct set_reader *reader, OGRGeometryH from, struct polygon *out)
{
	int rings = OGR_G_GetGeometryCount(from);
	*out = (struct polygon){ 0 };
	reader->z_sum = 0.0;
	reader->z_count = 0;
	if (rings < 1 || !take_ring(reader, OGR_G_GetGeometryRef(from, 0), &out->outer))
		return false;
	out->holes = POOL_ARRAY(&reader->set->pool, struct ring, rings);
	for (int i = 1; i < rings; i++)
		out->hole_count += take_ring(reader, OGR_G_GetGeometryRef(from, i), &out->holes[out->hole_count]);
	return true;
}

/* A number in range, or 0. */
static double take_number(struct set_reader *reader, OGRFeatureH feature, int field, double low, double high)
{
	if (field < 0 || !OGR_F_IsFieldSetAndNotNull(feature, field))
		return 0.0;
	double value = OGR_F_GetFieldAsDouble(feature, field);
	if (value >= low && value <= high)
		return value;
	if (value != 0.0)
		report_fault(reader->report, FAULT_BAD_NUMBER, FAULT_DROPPED, (int64_t)OGR_F_GetFID(feature));
	return 0.0;
}

static const char *take_text(struct set_reader *reader, OGRFeatureH feature, int field)
{
	if (field < 0 || !OGR_F_IsFieldSetAndNotNull(feature, field))
		return NULL;
	const char *text = OGR_F_GetFieldAsString(feature, field);
	if (!*text)
		return NULL;
	if (text_is_clean(text))
		return pool_string(&reader->set->pool, text);
	report_fault(reader->report, FAULT_BAD_STRING, FAULT_MENDED, (int64_t)OGR_F_GetFID(feature));
	return text_mend(&reader->set->pool, text);
}

static void take_attributes(struct set_reader *reader, OGRFeatureH feature, struct set_building *out)
{
	const struct fields *fields = &reader->fields;
	out->id = (int64_t)OGR_F_GetFID(feature);
	out->height_m = take_number(reader, feature, fields->height, 0.2, HEIGHT_LIMIT_M);
	out->min_height_m = take_number(reader, feature, fields->min_height, 0.0, HEIGHT_LIMIT_M);
	out->levels = take_number(reader, feature, fields->levels, 0.5, 200.0);
	out->eaves = fields->eaves;
	out->name = take_text(reader, feature, fields->name);
	out->kind = take_text(reader, feature, fields->kind);
	out->ground_z_m = NAN;
	if (fields->ground >= 0 && OGR_F_IsFieldSetAndNotNull(feature, fields->ground))
		out->ground_z_m = OGR_F_GetFieldAsDouble(feature, fields->ground);
}

static size_t take_geometry(struct set_reader *reader, OGRGeometryH geometry, const struct set_building *like)
{
	OGRwkbGeometryType type = wkbFlatten(OGR_G_GetGeometryType(geometry));
	size_t made = 0;
	if (type == wkbPolygon) {
		struct set_building building = *like;
		if (!take_polygon(reader, geometry, &building.degrees))
			return 0;
		building.eaves_z_m = reader->z_count ? reader->z_sum / (double)reader->z_count : NAN;
		ARRAY_PUSH(&reader->set->buildings, building);
		return 1;
	}
	for (int i = 0; i < OGR_G_GetGeometryCount(geometry); i++)
		made += take_geometry(reader, OGR_G_GetGeometryRef(geometry, i), like);
	return made;
}

static void take_feature(struct set_reader *reader, OGRFeatureH feature)
{
	OGRGeometryH geometry = OGR_F_GetGeometryRef(feature);
	int underground = reader->fields.underground;
	bool hidden = underground >= 0 && (!strcmp(OGR_F_GetFieldAsString(feature, underground), "true") ||
										  !strcmp(OGR_F_GetFieldAsString(feature, underground), "1"));
	struct set_building building = { 0 };
	enum element_fate fate = ELEMENT_IGNORED;
	if (geometry && !hidden) {
		OGRGeometryH linear = OGR_G_GetLinearGeometry(geometry, 0.0, NULL);
		take_attributes(reader, feature, &building);
		fate = linear && take_geometry(reader, linear, &building) ? ELEMENT_USED : ELEMENT_FAULTY;
		OGR_G_DestroyGeometry(linear);
		if (fate == ELEMENT_FAULTY)
			report_fault(reader->report, FAULT_BAD_GEOMETRY, FAULT_DROPPED, building.id);
	}
	reader->set->fates[fate]++;
}

static int read_layer(struct set_reader *reader, const char *path, OGRLayerH layer)
{
	uint64_t count = 0;
	OGRFeatureH feature;
	CPLErrorReset();
	while ((feature = OGR_L_GetNextFeature(layer))) {
		take_feature(reader, feature);
		OGR_F_Destroy(feature);
		count++;
	}
	if (CPLGetLastErrorType() >= CE_Failure) {
		log_error("%s: feature %llu: %s", path, (unsigned long long)count, gdal_reason("cannot be read"));
		return -EBADMSG;
	}
	if (!count) {
		log_error("%s: no features in it", path);
		return -EBADMSG;
	}
	return 0;
}

static int open_set(const char *path, GDALDatasetH *out)
{
	struct stat status;
	if (stat(path, &status) < 0) {
		log_error("%s: %s", path, strerror(errno));
		return -errno;
	}
	if (!S_ISDIR(status.st_mode) && !status.st_size) {
		log_error("%s: the file is empty", path);
		return -EBADMSG;
	}
	*out = GDALOpenEx(path, GDAL_OF_VECTOR | GDAL_OF_READONLY, NULL, NULL, NULL);
	if (*out)
		return 0;
	log_error("%s: no building set that can be read: %s", path, gdal_reason("no driver knows it"));
	return -EBADMSG;
}

int building_set_read(struct building_set *set, const char *path, const char *height_field, struct report *report)
{
	struct set_reader reader = { .set = set, .report = report };
	GDALDatasetH dataset = NULL;
	bool placed = false;
	gdal_start();
	int status = open_set(path, &dataset);
	if (status)
		return status;
	OGRLayerH layer = choose_layer(dataset);
	if (!layer) {
		log_error("%s: no polygons in it", path);
		status = -EBADMSG;
	}
	if (!status)
		status = find_fields(path, layer, height_field, &reader.fields);
	if (!status) {
		reader.to_wgs84 = to_wgs84(layer, &placed);
		if (!placed) {
			log_error("%s: does not say its coordinate system", path);
			status = -EBADMSG;
		}
	}
	if (!status)
		status = read_layer(&reader, path, layer);
	if (reader.to_wgs84)
		OCTDestroyCoordinateTransformation(reader.to_wgs84);
	GDALClose(dataset);
	return status;
}

void building_set_finish(struct building_set *set)
{
	ARRAY_FINISH(&set->buildings);
	ARRAY_FINISH(&set->areas);
	pool_finish(&set->pool);
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

/* Altitude of the ground at each building that needs it, from the eaves around. `places` in the city's frame. */
static void estimate_ground(const struct building_set *set, const struct bounds *places, double *ground)
{
	struct box_index index;
	index_array near = { 0 };
	double *eaves = malloc((set->buildings.count + 1) * sizeof(double));
	if (!eaves)
		abort();
	box_index_build(&index, places, set->buildings.count, GROUND_NEAR_M);
	for (size_t i = 0; i < set->buildings.count; i++) {
		const struct set_building *building = &set->buildings.items[i];
		size_t count = 0;
		ground[i] = building->ground_z_m;
		if (isnan(building->eaves_z_m) || building->height_m > 0.0 || isfinite(ground[i]))
			continue;
		box_index_find(&index, bounds_grown(places[i], GROUND_NEAR_M), &near);
		for (size_t k = 0; k < near.count; k++)
			if (isfinite(set->buildings.items[near.items[k]].eaves_z_m))
				eaves[count++] = set->buildings.items[near.items[k]].eaves_z_m;
		qsort(eaves, count, sizeof(double), by_value);
		ground[i] = eaves[count / 10] - LOWEST_HOUSE_M;
	}
	box_index_finish(&index);
	ARRAY_FINISH(&near);
	free(eaves);
}

static struct ring projected(const struct geo_frame *frame, struct pool *pool, const struct ring *degrees)
{
	struct ring out = { POOL_ARRAY(pool, struct dvec2, degrees->count), degrees->count };
	for (size_t i = 0; i < degrees->count; i++)
		out.points[i] = geo_to_plane(frame, (struct geo_point){ degrees->points[i].y, degrees->points[i].x });
	return out;
}

static struct polygon projected_polygon(const struct geo_frame *frame, struct pool *pool, const struct polygon *degrees)
{
	struct polygon out = { projected(frame, pool, &degrees->outer), POOL_ARRAY(pool, struct ring, degrees->hole_count),
		degrees->hole_count };
	for (size_t i = 0; i < degrees->hole_count; i++)
		out.holes[i] = projected(frame, pool, &degrees->holes[i]);
	return out;
}

static void push_areas(const struct building_set *set, struct city *city)
{
	for (size_t i = 0; i < set->areas.count; i++) {
		const struct set_area *from = &set->areas.items[i];
		struct area area = { .id = from->id, .kind = from->kind };
		area.shape = projected_polygon(&city->frame, &city->pool, &from->degrees);
		ARRAY_PUSH(&city->areas, area);
	}
}

static void set_walls(const struct set_building *from, struct city *city, struct building *building)
{
	building->walls_3d = POOL_ARRAY(&city->pool, struct dvec3, from->wall_count);
	building->wall_3d_count = from->wall_count;
	for (size_t i = 0; i < from->wall_count; i++) {
		struct dvec2 at = geo_to_plane(&city->frame, (struct geo_point){ from->walls[i].y, from->walls[i].x });
		building->walls_3d[i] = (struct dvec3){ at.x, at.y, from->walls[i].z };
	}
}

void building_set_lift(struct city *city)
{
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct building *building = &city->buildings.items[i];
		const struct ring *ring = &building->footprint.outer;
		double ground = INFINITY;
		if (!building->walls_3d)
			continue;
		for (size_t j = 0; j < ring->count; j++)
			ground = fmin(ground, city_ground(city, ring->points[j]));
		for (size_t j = 0; j < building->wall_3d_count; j++)
			building->walls_3d[j].z += ground;
	}
}

static void push_building(const struct set_building *from, double ground_m, const struct polygon *shape,
	struct city *city, struct shaper *shaper)
{
	polygon_array pieces = { 0 };
	struct polygon clean = { .holes = shape->holes, .hole_count = shape->hole_count };
	if (!shape_ring(shaper, from->id, shape->outer.points, shape->outer.count, &clean.outer)) {
		report_fault(city->report, FAULT_DEGENERATE_RING, FAULT_DROPPED, from->id);
		return;
	}
	shape_polygons(shaper, from->id, &clean, LEAST_AREA_M2, &pieces);
	struct building building = {
		.id = from->id,
		.outline = PKG_NONE,
		.face = PKG_NONE,
		.height_m = from->height_m,
		.min_height_m = from->min_height_m,
		.levels = from->levels,
		.eaves_height = from->eaves,
		.roof_direction_deg = NAN,
		.name = from->name ? pool_string(&city->pool, from->name) : NULL,
		.kind = BUILDING_APARTMENTS,
	};
	int kind = from->kind ? osm_building_kind(from->kind) : -1;
	if (kind >= 0) {
		building.kind = (enum building_kind)kind;
		building.kind_given = true;
	}
	if (building.height_m <= 0.0 && isfinite(from->eaves_z_m) && from->eaves_z_m - ground_m > 1.5) {
		building.height_m = from->eaves_z_m - ground_m;
		building.eaves_height = true;
	}
	for (size_t i = 0; i < pieces.count; i++) {
		building.footprint = pieces.items[i];
		/* Walls belong to the whole: the first piece stands for it, the others would be drawn within. */
		if (from->wall_count && i)
			break;
		if (from->wall_count)
			set_walls(from, city, &building);
		ARRAY_PUSH(&city->buildings, building);
	}
	ARRAY_FINISH(&pieces);
}

void building_set_make(const struct building_set *set, struct city *city, struct shaper *shaper)
{
	size_t count = set->buildings.count;
	struct polygon *shapes = calloc(count + 1, sizeof(*shapes));
	struct bounds *places = calloc(count + 1, sizeof(*places));
	double *ground = calloc(count + 1, sizeof(double));
	if (!shapes || !places || !ground)
		abort();
	for (size_t i = 0; i < count; i++) {
		shapes[i] = projected_polygon(&city->frame, &city->pool, &set->buildings.items[i].degrees);
		places[i].min = places[i].max = shapes[i].outer.points[0];
	}
	estimate_ground(set, places, ground);
	for (size_t i = 0; i < count; i++)
		push_building(&set->buildings.items[i], ground[i], &shapes[i], city, shaper);
	push_areas(set, city);
	for (int fate = 0; fate < ELEMENT_FATE_COUNT; fate++)
		city->report->elements[ELEMENT_FEATURE][fate] += set->fates[fate];
	free(shapes);
	free(places);
	free(ground);
}
