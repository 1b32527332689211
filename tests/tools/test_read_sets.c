/* Building sets (GeoJSON through GDAL), CityJSON, terrain, and the report's file. */
#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/file_map.h"
#include "platform/base/log.h"
#include "tools/bake/bake.h"

static struct city city;
static struct report report;
static char folder[64], osm[96], set[96], json[96], ground[96];

/* A street of 200 m and a house of OSM beside it. */
static const char osm_text[] = "<osm><node id='1' lat='46.2' lon='6.1'/><node id='2' lat='46.2' lon='6.1026'/>"
							   "<node id='11' lat='46.2001' lon='6.1'/><node id='12' lat='46.2001' lon='6.1002'/>"
							   "<node id='13' lat='46.2002' lon='6.1002'/><node id='14' lat='46.2002' lon='6.1'/>"
							   "<way id='1'><nd ref='1'/><nd ref='2'/><tag k='highway' v='residential'/></way>"
							   "<way id='2'><nd ref='11'/><nd ref='12'/><nd ref='13'/><nd ref='14'/><nd ref='11'/><tag "
							   "k='building' v='yes'/></way></osm>";

static void write_file(const char *path, const char *text)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static int set_up(void **state)
{
	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/blvd-sets-XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	snprintf(osm, sizeof(osm), "%s/city.osm", folder);
	snprintf(set, sizeof(set), "%s/set.geojson", folder);
	snprintf(json, sizeof(json), "%s/city.json", folder);
	snprintf(ground, sizeof(ground), "%s/N46E006.hgt", folder);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	unlink(osm);
	unlink(set);
	unlink(json);
	unlink(ground);
	return rmdir(folder);
}

static int finish(void **state)
{
	(void)state;
	city_finish(&city);
	return 0;
}

static int read_with(const char *input, const char *buildings, const char *field, const char *terrain)
{
	const char *inputs[] = { input }, *sets[] = { buildings }, *grounds[] = { terrain };
	report = (struct report){ 0 };
	city = (struct city){ .report = &report };
	return read_city(&city, &(struct read_options){ .inputs = inputs,
								.input_count = 1,
								.building_files = sets,
								.building_file_count = buildings != NULL,
								.height_field = field,
								.terrain_files = grounds,
								.terrain_file_count = terrain != NULL });
}

#define FEATURE(properties, x, y)                                                                                      \
	"{\"type\":\"Feature\",\"properties\":{" properties "},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[[" x   \
	"0," y "1],[" x "2," y "1],[" x "2," y "2],[" x "0," y "2],[" x "0," y "1]]]}}"
#define COLLECTION(features) "{\"type\":\"FeatureCollection\",\"features\":[" features "]}"

static void a_set_replaces_buildings_that_it_covers(void **state)
{
	(void)state;
	write_file(osm, osm_text);
	write_file(set, COLLECTION(FEATURE("\"HEIGHT\":21.5,\"name\":\"Hall\"", "6.100", "46.200") "," FEATURE(
						"\"HEIGHT\":-1000", "6.101", "46.200") "," FEATURE("\"HEIGHT\":null", "6.102", "46.200")));
	assert_int_equal(read_with(osm, set, NULL, NULL), 0);
	assert_int_equal(city.buildings.count, 3);
	assert_true(city.buildings.items[0].height_m == 21.5);
	assert_string_equal(city.buildings.items[0].name, "Hall");
	assert_true(city.buildings.items[1].height_m == 0.0 && city.buildings.items[2].height_m == 0.0);
	assert_int_equal(report.faults[FAULT_OVERLAPPING_BUILDING][FAULT_DROPPED], 1);
	assert_int_equal(report.faults[FAULT_BAD_NUMBER][FAULT_DROPPED], 1);
	assert_int_equal(report.elements[ELEMENT_FEATURE][ELEMENT_USED], 3);
}

static void the_field_asked_for_must_be_there(void **state)
{
	(void)state;
	write_file(osm, osm_text);
	write_file(set, COLLECTION(FEATURE("\"top\":12,\"height\":3", "6.101", "46.200")));
	assert_int_equal(read_with(osm, set, "roof", NULL), -EBADMSG);
	city_finish(&city);
	assert_int_equal(read_with(osm, set, "top", NULL), 0);
	assert_true(city.buildings.items[1].height_m == 12.0);
}

static void bad_sets_are_refused(void **state)
{
	static const char *const texts[] = { "", "nonsense", "{\"type\":\"FeatureCollection\",\"features\":[",
		COLLECTION(
			"{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Point\",\"coordinates\":[6.1,46.2]}}") };
	(void)state;
	write_file(osm, osm_text);
	for (size_t i = 0; i < sizeof(texts) / sizeof(*texts); i++) {
		write_file(set, texts[i]);
		assert_int_equal(read_with(osm, set, NULL, NULL), -EBADMSG);
		city_finish(&city);
	}
	unlink(set);
	assert_int_equal(read_with(osm, set, NULL, NULL), -ENOENT);
}

/* A house of 10 x 8 m with a gable, in the Dutch grid; walls face outwards, the ground is marked. */
#define GABLE(lod)                                                                                                     \
	"{\"type\":\"CityJSON\",\"version\":\"2.0\",\"transform\":{\"scale\":[0.001,0.001,0.001],\"translate\":[90000,"    \
	"435000,0]},"                                                                                                      \
	"\"metadata\":{\"referenceSystem\":\"https://www.opengis.net/def/crs/EPSG/0/28992\"},"                             \
	"\"CityObjects\":{\"a\":{\"type\":\"Building\",\"geometry\":[{\"type\":\"MultiSurface\",\"lod\":\"" lod "\","      \
	"\"boundaries\":[[[0,3,2,1]],[[0,1,5,4]],[[2,3,7,6]],[[1,2,6,9,5]],[[3,0,4,8,7]],[[4,5,9,8]],[[6,7,8,9]]],"        \
	"\"semantics\":{\"surfaces\":[{\"type\":\"GroundSurface\"},{\"type\":\"WallSurface\"},{\"type\":\"RoofSurface\"}]" \
	","                                                                                                                \
	"\"values\":[0,1,1,1,1,2,2]}}]},"                                                                                  \
	"\"w\":{\"type\":\"WaterBody\",\"geometry\":[{\"type\":\"MultiSurface\",\"lod\":\"1\",\"boundaries\":[[[0,3,2,1]]" \
	"]}]},"                                                                                                            \
	"\"x\":{\"type\":\"CityFurniture\"}},"                                                                             \
	"\"vertices\":[[0,0,1000],[10000,0,1000],[10000,8000,1000],[0,8000,1000],[0,0,6000],[10000,0,6000],[10000,8000,"   \
	"6000],"                                                                                                           \
	"[0,8000,6000],[0,4000,9000],[10000,4000,9000]]}"

static void cityjson_has_surfaces_or_blocks(void **state)
{
	(void)state;
	for (int lod = 1; lod <= 2; lod++) {
		write_file(json, lod == 2 ? GABLE("2") : GABLE("1.2"));
		assert_int_equal(read_with(json, NULL, NULL, NULL), 0);
		assert_int_equal(city.buildings.count, 1);
		const struct building *building = &city.buildings.items[0];
		assert_true(fabs(building->height_m - 8.0) < 1e-6);
		assert_true(fabs(ring_area(&building->footprint.outer) - 80.0) < 0.5);
		assert_int_equal(city.areas.items[0].kind, AREA_WATER);
		/* Two walls of four corners, two of five, two roofs: 2 * 2 + 2 * 3 + 2 * 2 triangles. */
		assert_int_equal(building->wall_3d_count, lod == 2 ? 42 : 0);
		double volume = 0.0, low = INFINITY;
		for (size_t i = 0; i + 2 < building->wall_3d_count; i += 3) {
			const struct dvec3 *p = &building->walls_3d[i];
			volume += p[0].x * (p[1].y * p[2].z - p[1].z * p[2].y) + p[0].y * (p[1].z * p[2].x - p[1].x * p[2].z) +
					  p[0].z * (p[1].x * p[2].y - p[1].y * p[2].x);
			low = fmin(low, fmin(p[0].z, fmin(p[1].z, p[2].z)));
		}
		assert_true(lod == 1 || (fabs(volume / 6.0 - 520.0) < 3.0 && fabs(low) < 1e-6));
		assert_int_equal(report.elements[ELEMENT_FEATURE][ELEMENT_USED], 2);
		assert_int_equal(report.elements[ELEMENT_FEATURE][ELEMENT_IGNORED], 1);
		city_finish(&city);
	}
	read_with(json, NULL, NULL, NULL);
}

static void bad_cityjson_is_refused(void **state)
{
	static const char *const texts[] = {
		"{\"type\":\"CityJSON\",",
		"{\"type\":\"Topology\"}",
		"{\"type\":\"CityJSON\",\"vertices\":[]}",
		"{\"type\":\"CityJSON\",\"vertices\":[[1,2,\"3\"]]}",
		"{\"type\":\"CityJSON\",\"vertices\":[[1,2,3]]}",
		"{\"type\":\"CityJSON\",\"vertices\":[[1,2,3]],\"metadata\":{\"referenceSystem\":\"EPSG:99999999\"}}",
		/* an index beyond the vertices: the building goes, and nothing is left */
		"{\"type\":\"CityJSON\",\"vertices\":[[1,2,3]],\"metadata\":{\"referenceSystem\":\"EPSG:28992\"},"
		"\"CityObjects\":{\"a\":"
		"{\"type\":\"Building\",\"geometry\":[{\"type\":\"Solid\",\"lod\":1,\"boundaries\":[[[[0,1,2]]]]}]}}}",
		"{\"type\":\"CityJSON\",\"vertices\":[[1,2,3]],\"metadata\":{\"referenceSystem\":\"EPSG:28992\"},"
		"\"CityObjects\":{\"a\":"
		"{\"type\":\"Building\",\"geometry\":[{\"type\":\"Solid\",\"lod\":1,\"boundaries\":7}]}}}",
	};
	(void)state;
	for (size_t i = 0; i < sizeof(texts) / sizeof(*texts); i++) {
		write_file(json, texts[i]);
		assert_int_equal(read_with(json, NULL, NULL, NULL), -EBADMSG);
		city_finish(&city);
	}
}

/* 1201 x 1201 big-endian heights: a slope to the north, with a hole. */
static void write_ground(bool whole)
{
	FILE *file = fopen(ground, "wb");
	assert_non_null(file);
	for (int row = 0; row < (whole ? 1201 : 100); row++) {
		for (int col = 0; col < 1201; col++) {
			int height = row > 955 && row < 965 && col > 115 && col < 130 ? -32768 : 1400 - row;
			fputc(height >> 8 & 0xFF, file);
			fputc(height & 0xFF, file);
		}
	}
	fclose(file);
}

static void terrain_is_sampled_and_its_voids_are_filled(void **state)
{
	(void)state;
	write_file(osm, osm_text);
	write_ground(true);
	assert_int_equal(read_with(osm, NULL, NULL, ground), 0);
	assert_int_equal(city.terrain.grid.step_mm, 8000);
	assert_true(report.faults[FAULT_TERRAIN_VOID][FAULT_MENDED] > 0);
	/* Row 960 is 46.2 degrees north. */
	assert_true(fabs(city_ground(&city, (struct dvec2){ 0.0, 0.0 }) - 440.0) < 5.0);
	struct dvec2 north = { 0.0, city.max.y + 150.0 }, south = { 0.0, city.min.y - 150.0 };
	assert_true(city_ground(&city, north) > city_ground(&city, south) + 2.0);
}

static void bad_terrain_is_refused(void **state)
{
	(void)state;
	write_file(osm, osm_text);
	write_ground(false);
	assert_int_equal(read_with(osm, NULL, NULL, ground), -EBADMSG);
	city_finish(&city);
	write_file(ground, "");
	assert_int_equal(read_with(osm, NULL, NULL, ground), -EBADMSG);
	city_finish(&city);
	assert_int_equal(read_with(osm, NULL, NULL, osm), -EBADMSG);
}

static void the_report_is_written_whole_or_not_at_all(void **state)
{
	char path[128], missing[128];
	struct file_map map;
	(void)state;
	write_file(osm, osm_text);
	assert_int_equal(read_with(osm, NULL, NULL, NULL), 0);
	snprintf(path, sizeof(path), "%s/report.json", folder);
	snprintf(missing, sizeof(missing), "%s/none/report.json", folder);
	assert_int_equal(report_write_json(&report, missing), -ENOENT);
	assert_int_equal(report_write_json(&report, path), 0);
	assert_int_equal(file_map_open(&map, path), 0);
	cJSON *root = cJSON_ParseWithLength((const char *)map.bytes.data, map.bytes.size), *fault;
	assert_non_null(root);
	cJSON_ArrayForEach(fault, cJSON_GetObjectItem(root, "faults")) assert_true(
		cJSON_GetObjectItem(fault, "found")->valuedouble ==
		cJSON_GetObjectItem(fault, "mended")->valuedouble + cJSON_GetObjectItem(fault, "dropped")->valuedouble);
	const cJSON *ways = cJSON_GetObjectItem(cJSON_GetObjectItem(root, "elements"), "ways");
	assert_true(cJSON_GetObjectItem(ways, "read")->valuedouble == 2.0);
	assert_true(cJSON_GetObjectItem(ways, "used")->valuedouble == 2.0);
	cJSON_Delete(root);
	file_map_close(&map);
	unlink(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_teardown(a_set_replaces_buildings_that_it_covers, finish),
		cmocka_unit_test_teardown(the_field_asked_for_must_be_there, finish),
		cmocka_unit_test_teardown(bad_sets_are_refused, finish),
		cmocka_unit_test_teardown(cityjson_has_surfaces_or_blocks, finish),
		cmocka_unit_test_teardown(bad_cityjson_is_refused, finish),
		cmocka_unit_test_teardown(terrain_is_sampled_and_its_voids_are_filled, finish),
		cmocka_unit_test_teardown(bad_terrain_is_refused, finish),
		cmocka_unit_test_teardown(the_report_is_written_whole_or_not_at_all, finish),
	};
	log_init("test", LOG_WARN);
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
