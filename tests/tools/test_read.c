/* Reading whole files: the real ones of the data folder, with the counts that they are known to have. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "platform/base/log.h"
#include "tools/bake/bake.h"

struct expected {
	const char *file;
	size_t buildings, parts, drivable_at_least;
	double km_at_least;
	bool right_hand;
};

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

static void print_city(const struct city *city, const char *file)
{
	printf(
		"%s: %zu buildings and parts, %zu ways, %.1f km drivable, %zu areas, %zu lines, %zu trees, %zu restrictions, "
		"%.0f x %.0f m\n",
		file, city->buildings.count, city->ways.count, drivable_km(city), city->areas.count, city->lines.count,
		city->trees.count, city->restrictions.count, city->max.x - city->min.x, city->max.y - city->min.y);
	report_print(city->report, stdout);
}

static void reads_a_real_city(void **state)
{
	const struct expected *expected = *state;
	const char *data = getenv("BLVD_DATA");
	char path[1024];
	snprintf(path, sizeof(path), "%s/city/%s", data ? data : "../shared/data", expected->file);
	FILE *file = fopen(path, "rb");
	if (!file) {
		printf("skipped: no BLVD_DATA (%s)\n", path);
		skip();
	}
	fclose(file);
	struct report report = { 0 };
	struct city city = { .report = &report };
	const char *inputs[] = { path };
	assert_int_equal(read_city(&city, &(struct read_options){ .inputs = inputs, .input_count = 1 }), 0);
	print_city(&city, expected->file);
	assert_true(drivable_km(&city) >= expected->km_at_least);
	assert_true(city.right_hand_traffic == expected->right_hand);
	city_finish(&city);
}

static struct expected rome = { "tiny/rome-piazza-vittorio.osm.pbf", 716, 0, 100, 10.0, true };
static struct expected soho = { "tiny/london-soho.osm.gz", 361, 46, 50, 3.0, false };
static struct expected geneva = { "geneva/geneva.osm.pbf", 11801, 0, 3000, 150.0, true };
static struct expected sf = { "sf-downtown/sf-downtown.osm.pbf", 7795, 846, 1000, 100.0, true };
static struct expected monaco = { "monaco/monaco-2023-tilemaker.osm.pbf", 1285, 0, 500, 40.0, true };

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(reads_a_real_city, &rome),
		cmocka_unit_test_prestate(reads_a_real_city, &soho),
		cmocka_unit_test_prestate(reads_a_real_city, &geneva),
		cmocka_unit_test_prestate(reads_a_real_city, &sf),
		cmocka_unit_test_prestate(reads_a_real_city, &monaco),
	};
	log_init("test", LOG_INFO);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
