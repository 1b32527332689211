/* All inputs into one city: what each file is, where the city lies, and in which order things are made. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "tools/bake/bake.h"
#include "tools/read/building_set.h"
#include "tools/read/cityjson.h"
#include "tools/read/osm_cut.h"
#include "tools/read/osm_parse.h"
#include "tools/read/osm_reader.h"
#include "tools/read/settle.h"
#include "tools/read/stage.h"
#include "tools/read/terrain.h"
#include "tools/read/traffic_side.h"

#define OSM_CREDIT "\xC2\xA9 OpenStreetMap contributors, ODbL"
/* A node of a street or house this far from the middle of all of them is a mistake. */
#define FAR_DEG 1.0
/* Beyond it the plane of the frame is no map of the city any more. */
#define EXTENT_LIMIT_M 200000.0

bool osm_length(struct osm_reader *reader, const struct osm_tags *tags, const char *key, int64_t id, double low,
	double high, double *out)
{
	const char *value = osm_tag(tags, key);
	double number = 0.0;
	if (!value)
		return false;
	enum tag_verdict verdict = tag_length_m(value, &number);
	if (verdict == TAG_BAD || number < low || number > high) {
		report_fault(reader->city->report, FAULT_BAD_NUMBER, FAULT_DROPPED, id);
		return false;
	}
	if (verdict == TAG_MENDED)
		report_fault(reader->city->report, FAULT_BAD_NUMBER, FAULT_MENDED, id);
	*out = number;
	return true;
}

bool osm_number(struct osm_reader *reader, const struct osm_tags *tags, const char *key, int64_t id, double low,
	double high, double *out)
{
	const char *value = osm_tag(tags, key);
	double number = 0.0;
	if (!value)
		return false;
	enum tag_verdict verdict = tag_number(value, &number);
	if (verdict == TAG_BAD || number < low || number > high) {
		report_fault(reader->city->report, FAULT_BAD_NUMBER, FAULT_DROPPED, id);
		return false;
	}
	if (verdict == TAG_MENDED)
		report_fault(reader->city->report, FAULT_BAD_NUMBER, FAULT_MENDED, id);
	*out = number;
	return true;
}

const char *osm_name(struct osm_reader *reader, const struct osm_tags *tags)
{
	const char *name = osm_tag(tags, "name");
	return name && *name ? pool_string(&reader->city->pool, name) : NULL;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

/* Bounds in degrees, longitudes relative to `base_lon`. */
struct geo_bounds {
	double south, west, north, east, base_lon;
	bool any;
};

static void extend(struct geo_bounds *bounds, double lat, double lon)
{
	if (!bounds->any)
		*bounds = (struct geo_bounds){ lat, 0.0, lat, 0.0, lon, true };
	double x = geo_lon_diff(lon, bounds->base_lon);
	bounds->south = fmin(bounds->south, lat);
	bounds->north = fmax(bounds->north, lat);
	bounds->west = fmin(bounds->west, x);
	bounds->east = fmax(bounds->east, x);
}

typedef ARRAY(double) double_array;

static double median(double_array *values)
{
	ARRAY_SORT(values, by_value);
	return values->items[values->count / 2];
}

static void mark_built(struct osm_store *store)
{
	for (size_t i = 0; i < store->ways.count; i++) {
		struct osm_way *way = &store->ways.items[i];
		way->built = osm_is_building(&way->tags) || osm_is_drivable(&way->tags);
	}
	for (size_t i = 0; i < store->relations.count; i++) {
		const struct osm_relation *relation = &store->relations.items[i];
		for (size_t j = 0; osm_is_building(&relation->tags) && j < relation->member_count; j++) {
			struct osm_way *way =
				relation->members[j].kind == OSM_MEMBER_WAY ? osm_store_way(store, relation->members[j].ref) : NULL;
			if (way)
				way->built = true;
		}
	}
}

/* Nodes of buildings and drivable ways; those far from the others are marked bad and counted. */
static void osm_bounds(struct osm_store *store, struct geo_bounds *out)
{
	double_array lats = { 0 }, lons = { 0 };
	double base = 0.0, lat = 0.0, lon = 0.0;
	for (int pass = 0; pass < 2; pass++) {
		for (size_t i = 0; i < store->ways.count; i++) {
			const struct osm_way *way = &store->ways.items[i];
			for (size_t j = 0; way->built && j < way->ref_count; j++) {
				struct osm_node *node = osm_store_node(store, way->refs[j]);
				if (!node)
					continue;
				base = lats.count ? base : node->lon_deg;
				if (!pass) {
					ARRAY_PUSH(&lats, node->lat_deg);
					ARRAY_PUSH(&lons, geo_lon_diff(node->lon_deg, base));
				} else if (fabs(node->lat_deg - lat) > FAR_DEG ||
						   fabs(geo_lon_diff(node->lon_deg, base) - lon) * cos(lat * BLVD_PI / 180.0) > FAR_DEG) {
					node->bad = true;
					report_fault(store->report, FAULT_BAD_NUMBER, FAULT_DROPPED, node->id);
					osm_mark(&node->fate, ELEMENT_FAULTY);
				} else {
					extend(out, node->lat_deg, node->lon_deg);
				}
			}
		}
		if (!lats.count)
			break;
		if (!pass) {
			lat = median(&lats);
			lon = median(&lons);
		}
	}
	ARRAY_FINISH(&lats);
	ARRAY_FINISH(&lons);
}

static void set_frame(struct city *city, const struct geo_bounds *bounds)
{
	struct geo_point origin = { (bounds->south + bounds->north) / 2.0,
		remainder(bounds->base_lon + (bounds->west + bounds->east) / 2.0, 360.0) };
	/* A round origin: the same city from two extracts that differ by a metre has the same one more often than not. */
	origin.lat_deg = round(origin.lat_deg * 1e5) / 1e5;
	origin.lon_deg = round(origin.lon_deg * 1e5) / 1e5;
	city->frame = geo_frame_at(origin);
}

static void cover(struct bounds *bounds, struct dvec2 at)
{
	bounds->min = (struct dvec2){ fmin(bounds->min.x, at.x), fmin(bounds->min.y, at.y) };
	bounds->max = (struct dvec2){ fmax(bounds->max.x, at.x), fmax(bounds->max.y, at.y) };
}

static struct bounds plane_bounds(const struct city *city, const struct geo_bounds *geo)
{
	struct bounds bounds = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };
	/* The sides bulge a little between the corners. */
	for (int i = 0; i <= 2; i++)
		for (int j = 0; j <= 2; j++)
			cover(&bounds,
				geo_to_plane(&city->frame, (struct geo_point){ geo->south + (geo->north - geo->south) * i / 2.0,
											   geo->base_lon + geo->west + (geo->east - geo->west) * j / 2.0 }));
	return bounds;
}

static void set_extent(struct city *city)
{
	struct bounds bounds = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct dvec2 min, max;
		ring_bounds(&city->buildings.items[i].footprint.outer, &min, &max);
		cover(&bounds, min);
		cover(&bounds, max);
	}
	for (size_t i = 0; i < city->ways.count; i++)
		for (size_t j = 0; city->ways.items[i].drivable && j < city->ways.items[i].node_count; j++)
			cover(&bounds, city->ways.items[i].nodes[j].at);
	if (bounds.min.x > bounds.max.x)
		bounds = (struct bounds){ { 0.0, 0.0 }, { 0.0, 0.0 } };
	city->min = bounds.min;
	city->max = bounds.max;
}

/* Buildings of sets whose middle is beyond the bounds asked for. */
static void drop_outside(struct city *city, const struct bounds *bounds, size_t first)
{
	size_t kept = first;
	for (size_t i = first; i < city->buildings.count; i++) {
		struct bounds box;
		ring_bounds(&city->buildings.items[i].footprint.outer, &box.min, &box.max);
		struct dvec2 middle = dvec2_scale(dvec2_add(box.min, box.max), 0.5);
		if (bounds_touch((struct bounds){ middle, middle }, *bounds))
			city->buildings.items[kept++] = city->buildings.items[i];
	}
	city->buildings.count = kept;
}

/* An element whose building turned out to be another's double was read in vain. */
static void mark_dropped(struct osm_store *store, int64_t id)
{
	if (id < 0) {
		struct osm_relation *relation = osm_store_relation(store, -id);
		if (relation)
			relation->fate = ELEMENT_FAULTY;
	} else {
		struct osm_way *way = osm_store_way(store, id);
		if (way)
			way->fate = ELEMENT_FAULTY;
	}
}

/* What was read and is not in the city yet. */
struct sources {
	struct osm_store osm;
	struct building_set set;
	contour_array contours;
};

static void make_features(struct city *city, struct sources *sources, const struct geo_bounds *bounds, bool clip)
{
	struct osm_store *store = &sources->osm;
	struct osm_reader reader = { .city = city, .store = store, .clip = clip };
	osm_store_project(store, &city->frame);
	shaper_init(&reader.shaper, &city->pool, city->report);
	reader.built = plane_bounds(city, bounds);
	reader.hull = cut_hull(&reader);
	osm_make_buildings(&reader);
	osm_make_ways(&reader);
	osm_make_restrictions(&reader);
	osm_make_areas(&reader);
	osm_make_trees(&reader);
	size_t of_osm = city->buildings.count;
	id_array dropped = { 0 };
	building_set_make(&sources->set, city, &reader.shaper);
	if (clip)
		drop_outside(city, &reader.built, of_osm);
	settle_buildings(city, &reader.shaper, of_osm, &dropped);
	for (size_t i = 0; i < dropped.count; i++)
		mark_dropped(store, dropped.items[i]);
	ARRAY_FINISH(&dropped);
	shaper_finish(&reader.shaper);
	ARRAY_FINISH(&reader.aliases);
}

/* "geneva" of "dir/geneva.osm.pbf". */
static const char *name_of(struct city *city, const char *path)
{
	const char *slash = strrchr(path, '/');
	char *name = pool_string(&city->pool, slash ? slash + 1 : path);
	char *dot = strchr(name, '.');
	if (dot && dot != name)
		*dot = 0;
	return name;
}

static void count_results(struct city *city)
{
	uint64_t *counts = city->report->counts;
	for (size_t i = 0; i < city->buildings.count; i++)
		counts[city->buildings.items[i].is_part ? COUNT_PARTS : COUNT_BUILDINGS]++;
	for (size_t i = 0; i < city->ways.count; i++)
		counts[COUNT_DRIVABLE_WAYS] += city->ways.items[i].drivable;
	counts[COUNT_WAYS] += city->ways.count;
	counts[COUNT_TREES] += city->trees.count;
	counts[COUNT_AREAS] += city->areas.count;
	counts[COUNT_RESTRICTIONS] += city->restrictions.count;
}

static void set_bounds_of(const struct building_set *set, struct geo_bounds *out)
{
	for (size_t i = 0; i < set->buildings.count; i++) {
		const struct ring *ring = &set->buildings.items[i].degrees.outer;
		for (size_t j = 0; j < ring->count; j++)
			extend(out, ring->points[j].y, ring->points[j].x);
	}
}

/* Tiles, CityJSON or OSM: the content tells. */
static int read_input(struct sources *sources, const char *path, struct report *report)
{
	struct staged staged;
	if (tiles_is_folder(path))
		return tiles_read(&sources->osm, &sources->contours, path);
	int status = stage_open(&staged, path);
	if (status)
		return status;
	status = staged.format == INPUT_JSON ? cityjson_read(&sources->set, staged.path, path, report)
										 : osm_parse(&sources->osm, &staged, path);
	stage_close(&staged);
	return status;
}

static int read_sources(struct sources *sources, const struct read_options *options, struct report *report)
{
	int status = 0;
	for (size_t i = 0; i < options->input_count && !status; i++)
		status = read_input(sources, options->inputs[i], report);
	for (size_t i = 0; i < options->building_file_count && !status; i++)
		status = building_set_read(&sources->set, options->building_files[i], options->height_field, report);
	osm_store_sort(&sources->osm);
	return status;
}

/* Who is to be named wherever the city is drawn: OpenStreetMap, and other sets by the names of their files. */
static const char *credit_of(struct city *city, const struct read_options *options, const struct sources *sources)
{
	char text[256];
	bool osm = sources->osm.nodes.count > 0;
	size_t used = (size_t)snprintf(text, sizeof(text), "%s", osm ? OSM_CREDIT : "");
	const char *const *more = osm ? options->building_files : options->inputs;
	size_t count = osm ? options->building_file_count : options->input_count;
	for (size_t i = 0; i < count && used < sizeof(text); i++)
		used += (size_t)snprintf(text + used, sizeof(text) - used, "%s%s", used ? "; " : "", name_of(city, more[i]));
	return pool_string(&city->pool, text);
}

static int make_city(struct city *city, const struct read_options *options, struct sources *sources)
{
	struct geo_bounds bounds = { 0 };
	mark_built(&sources->osm);
	osm_bounds(&sources->osm, &bounds);
	set_bounds_of(&sources->set, &bounds);
	if (options->bounds) {
		bounds = (struct geo_bounds){ 0 };
		extend(&bounds, options->bounds[1], options->bounds[0]);
		extend(&bounds, options->bounds[3], options->bounds[2]);
	}
	if (!bounds.any) {
		log_error("%s: neither streets nor buildings in it", options->input_count ? options->inputs[0] : "input");
		return -EBADMSG;
	}
	set_frame(city, &bounds);
	struct bounds extent = plane_bounds(city, &bounds);
	double width = extent.max.x - extent.min.x, height = extent.max.y - extent.min.y;
	if (!(fmax(width, height) < EXTENT_LIMIT_M)) {
		log_error("%s: the inputs cover %.0f x %.0f km; a city is at most %.0f km wide (--bbox cuts one out)",
			options->input_count ? options->inputs[0] : "input", width / 1000.0, height / 1000.0,
			EXTENT_LIMIT_M / 1000.0);
		return -EBADMSG;
	}
	make_features(city, sources, &bounds, options->bounds != NULL);
	city->attribution = credit_of(city, options, sources);
	city->right_hand_traffic = traffic_side_right(city, &sources->osm);
	set_extent(city);
	osm_store_tally(&sources->osm);
	int status = terrain_read(city, options->terrain_files, options->terrain_file_count, &sources->contours);
	if (!status)
		building_set_lift(city);
	return status;
}

int read_city(struct city *city, const struct read_options *options)
{
	struct sources sources = { 0 };
	int64_t start = clock_now_ns();
	osm_store_init(&sources.osm, city->report);
	city->name = options->name ? pool_string(&city->pool, options->name)
							   : name_of(city, options->input_count ? options->inputs[0] : "city");
	int status = read_sources(&sources, options, city->report);
	if (!status)
		status = make_city(city, options, &sources);
	building_set_finish(&sources.set);
	ARRAY_FINISH(&sources.contours);
	osm_store_finish(&sources.osm);
	if (!status)
		count_results(city);
	city->report->seconds[STEP_READ] += (double)(clock_now_ns() - start) * 1e-9;
	return status;
}
