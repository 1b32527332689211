/* Reading whole files: the real ones of the data folder, with the counts that they are known to have. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "platform/base/file_map.h"
#include "platform/base/log.h"
#include "platform/base/rng.h"
#include "tools/bake/bake.h"

struct expected {
	const char *file, *buildings_file, *terrain_file; /* the last two NULL: none */
	size_t buildings, parts;                          /* within 2 % and 25 %: mending adds and drops some */
	double drivable_km;                               /* at least */
	size_t trees, areas;                              /* at least */
	double tagged_share;                              /* of heights that the data gives in some way, at least */
	bool right_hand;
	double seconds; /* at most; generous, for slow and shared machines */
};

static const char *data_path(char path[1024], const char *file)
{
	const char *data = getenv("BLVD_DATA");
	snprintf(path, 1024, "%s/%s", data ? data : "../shared/data", file);
	return path;
}

static int read_real(struct city *city, struct report *report, const struct expected *expected)
{
	char path[1024], buildings[1024], terrain[1024];
	const char *inputs[] = { data_path(path, expected->file) }, *sets[] = { buildings }, *grounds[] = { terrain };
	struct read_options options = { .inputs = inputs, .input_count = 1 };
	if (expected->buildings_file) {
		data_path(buildings, expected->buildings_file);
		options.building_files = sets;
		options.building_file_count = 1;
	}
	if (expected->terrain_file) {
		data_path(terrain, expected->terrain_file);
		options.terrain_files = grounds;
		options.terrain_file_count = 1;
	}
	*report = (struct report){ 0 };
	*city = (struct city){ .report = report };
	return read_city(city, &options);
}

static bool is_there(const struct expected *expected)
{
	char path[1024];
	struct file_map map;
	if (!file_map_open(&map, data_path(path, expected->file))) {
		file_map_close(&map);
		return true;
	}
	printf("skipped: no BLVD_DATA (%s)\n", path);
	return false;
}

static double drivable_km(const struct city *city)
{
	double length = 0.0;
	for (size_t i = 0; i < city->ways.count; i++) {
		const struct way *way = &city->ways.items[i];
		for (size_t j = 1; way->drivable && j < way->node_count; j++)
			length += dvec2_length(dvec2_sub(way->nodes[j].at, way->nodes[j - 1].at));
	}
	return length / 1000.0;
}

static void check_ring(const struct ring *ring, bool outer)
{
	assert_true(ring->count >= 3);
	assert_true((ring_area(ring) > 0.0) == outer);
	for (size_t i = 0; i < ring->count; i++)
		assert_true(isfinite(ring->points[i].x) && isfinite(ring->points[i].y));
}

static void check_building(const struct city *city, const struct building *building)
{
	check_ring(&building->footprint.outer, true);
	for (size_t i = 0; i < building->footprint.hole_count; i++)
		check_ring(&building->footprint.holes[i], false);
	assert_true(building->height_m > building->min_height_m);
	assert_true(building->roof_height_m >= 0.0);
	assert_true(building->roof_height_m <= building->height_m - building->min_height_m + 1e-6);
	assert_true(building->levels >= 0.5);
	assert_int_not_equal(building->roof_shape, ROOF_UNKNOWN);
	assert_true(building->outline == PKG_NONE || city->buildings.items[building->outline].has_parts);
}

static void check_ways(const struct city *city)
{
	for (size_t i = 0; i < city->ways.count; i++) {
		const struct way *way = &city->ways.items[i];
		assert_true(way->node_count >= 2 && way->width_m > 0.3);
		assert_true(!way->drivable || way->lanes_forward + way->lanes_backward > 0);
		assert_true(!way->drivable || (way->speed_kmh > 0 && way->speed_kmh <= 255));
		assert_true(way->oneway <= 0 || !way->lanes_backward);
		for (size_t j = 1; j < way->node_count; j++)
			assert_true(way->nodes[j].id != way->nodes[j - 1].id);
	}
}

static bool about(size_t found, size_t wanted, double share)
{
	return fabs((double)found - (double)wanted) <= share * (double)wanted;
}

static void reads_a_real_city(void **state)
{
	const struct expected *expected = *state;
	struct report report;
	struct city city;
	if (!is_there(expected))
		skip();
	assert_int_equal(read_real(&city, &report, expected), 0);
	heights_infer(&city);
	printf("%s: %zu buildings and parts, %zu ways, %.1f km drivable, %zu areas, %zu lines, %zu trees\n", expected->file,
		city.buildings.count, city.ways.count, drivable_km(&city), city.areas.count, city.lines.count,
		city.trees.count);
	report_print(&report, stdout);
	assert_true(about(report.counts[COUNT_BUILDINGS], expected->buildings, 0.02));
	assert_true(about(report.counts[COUNT_PARTS], expected->parts, 0.25));
	assert_true(drivable_km(&city) >= expected->drivable_km);
	assert_true(city.trees.count >= expected->trees && city.areas.count >= expected->areas);
	assert_true(city.right_hand_traffic == expected->right_hand);
	assert_true(report.seconds[STEP_READ] < expected->seconds);
	uint64_t given = report.heights[HEIGHT_TAGGED] + report.heights[HEIGHT_LEVELS] + report.heights[HEIGHT_PARTS];
	assert_true((double)given >= expected->tagged_share * (double)city.buildings.count);
	assert_true((city.terrain.grid.columns > 0) == (expected->terrain_file != NULL));
	check_ways(&city);
	for (size_t i = 0; i < city.buildings.count; i++)
		check_building(&city, &city.buildings.items[i]);
	city_finish(&city);
}

static uint64_t fingerprint(const struct city *city)
{
	uint64_t hash = hash_u64(city->buildings.count * 31 + city->ways.count);
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct building *building = &city->buildings.items[i];
		uint64_t bits;
		memcpy(&bits, &building->height_m, sizeof(bits));
		hash = hash_u64(hash ^ bits) + (uint64_t)building->id + (uint64_t)building->roof_shape;
		memcpy(&bits, &building->footprint.outer.points[0].x, sizeof(bits));
		hash = hash_u64(hash ^ bits);
	}
	for (size_t i = 0; i < city->trees.count; i++)
		hash = hash_u64(hash ^ (uint64_t)llround(city->trees.items[i].at.x * 1e6));
	return hash;
}

static void the_same_file_gives_the_same_city(void **state)
{
	const struct expected *expected = *state;
	uint64_t hashes[2];
	if (!is_there(expected))
		skip();
	for (int i = 0; i < 2; i++) {
		struct report report;
		struct city city;
		assert_int_equal(read_real(&city, &report, expected), 0);
		heights_infer(&city);
		hashes[i] = fingerprint(&city);
		city_finish(&city);
	}
	assert_true(hashes[0] == hashes[1]);
}

/* Streets on a slope: level across to a few per cent, no steeper along than streets are. */
static void streets_follow_the_terrain(void **state)
{
	const struct expected *expected = *state;
	struct report report;
	struct city city;
	size_t samples = 0, tilted = 0, steep = 0;
	double low = INFINITY, high = -INFINITY;
	if (!is_there(expected))
		skip();
	assert_int_equal(read_real(&city, &report, expected), 0);
	for (size_t i = 0; i < city.ways.count; i++) {
		const struct way *way = &city.ways.items[i];
		for (size_t j = 1; way->drivable && !way->tunnel && !way->bridge && j < way->node_count; j++) {
			struct dvec2 a = way->nodes[j - 1].at, along = dvec2_sub(way->nodes[j].at, a);
			double length = dvec2_length(along), half = way->width_m / 2.0;
			along = dvec2_scale(along, 1.0 / length);
			struct dvec2 left = { -along.y * half, along.x * half };
			for (double at = 0.0; at + 4.0 < length; at += 4.0, samples++) {
				struct dvec2 here = dvec2_add(a, dvec2_scale(along, at)),
							 there = dvec2_add(here, dvec2_scale(along, 4.0));
				double height = city_ground(&city, here);
				double across = city_ground(&city, dvec2_add(here, left)) - city_ground(&city, dvec2_sub(here, left));
				tilted += fabs(across) / way->width_m > 0.12;
				steep += fabs(city_ground(&city, there) - height) / 4.0 > 0.25;
				low = fmin(low, height);
				high = fmax(high, height);
			}
		}
	}
	printf("%zu samples, %zu tilted, %zu steep, %.0f to %.0f m\n", samples, tilted, steep, low, high);
	assert_true(low > -1.0 && low < 10.0 && high > 100.0 && high < 330.0);
	assert_true(tilted * 100 < samples * 12);
	assert_true(steep * 100 < samples * 2);
	city_finish(&city);
}

static struct expected rome = { "city/tiny/rome-piazza-vittorio.osm.pbf", NULL, NULL, 716, 68, 19.0, 100, 70, 0.6, true,
	10.0 };
static struct expected soho = { "city/tiny/london-soho.osm.gz", NULL, NULL, 361, 58, 3.0, 10, 14, 0.3, false, 10.0 };
static struct expected geneva = { "city/geneva/geneva.osm.pbf", NULL, NULL, 11801, 53, 300.0, 10000, 2300, 0.13, true,
	30.0 };
static struct expected sf = { "city/sf-downtown/sf-downtown.osm.pbf", NULL, NULL, 7795, 846, 250.0, 2000, 1000, 0.7,
	true, 30.0 };
static struct expected monaco = { "city/monaco/monaco-2023-tilemaker.osm.pbf", NULL, "city/monaco/N43E007.hgt.zip",
	1285, 19, 65.0, 500, 350, 0.15, true, 30.0 };
static struct expected paris = { "city/paris11/paris-roads-valhalla-paris_bss.osm.pbf", "city/paris11/paris11_bdnb.shp",
	NULL, 5227, 0, 30.0, 0, 50, 0.99, true, 30.0 };

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(reads_a_real_city, &rome),
		cmocka_unit_test_prestate(reads_a_real_city, &soho),
		cmocka_unit_test_prestate(reads_a_real_city, &geneva),
		cmocka_unit_test_prestate(reads_a_real_city, &sf),
		cmocka_unit_test_prestate(reads_a_real_city, &monaco),
		cmocka_unit_test_prestate(reads_a_real_city, &paris),
		cmocka_unit_test_prestate(the_same_file_gives_the_same_city, &soho),
		cmocka_unit_test_prestate(the_same_file_gives_the_same_city, &monaco),
		cmocka_unit_test_prestate(streets_follow_the_terrain, &monaco),
	};
	log_init("test", LOG_INFO);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
