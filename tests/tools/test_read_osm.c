/* Small hand-written OSM files: what tags become, and each fault with its count. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/log.h"
#include "tools/bake/bake.h"

/* Nodes 1 to 99 on a grid of 10 x 10, some 10 m apart: node 10 r + c lies at row r (north) and column c (east). */
#define GRID_STEP "0.0001"

static struct city city;
static struct report report;
static char path[64];

static void write_file(const char *text)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static int read_file(const double *bounds)
{
	const char *inputs[] = { path };
	report = (struct report){ 0 };
	city = (struct city){ .report = &report };
	return read_city(&city, &(struct read_options){ .inputs = inputs, .input_count = 1, .bounds = bounds });
}

static void check_sums(void)
{
	uint64_t ways = report.elements[ELEMENT_WAY][ELEMENT_USED] + report.elements[ELEMENT_WAY][ELEMENT_FAULTY] +
					report.elements[ELEMENT_WAY][ELEMENT_IGNORED];
	assert_true(ways > 0);
}

/* The grid of nodes and `body` behind it. */
static void read_text(const char *body)
{
	static char text[65536];
	int used = snprintf(text, sizeof(text), "<?xml version='1.0' encoding='UTF-8'?>\n<osm version='0.6'>\n");
	for (int i = 0; i < 100; i++)
		used += snprintf(text + used, sizeof(text) - (size_t)used, "<node id='%d' lat='%.7f' lon='%.7f'/>\n", i,
			46.2 + i / 10 * 0.0001, 6.1 + i % 10 * 0.0001);
	snprintf(text + used, sizeof(text) - (size_t)used, "%s</osm>\n", body);
	write_file(text);
	assert_int_equal(read_file(NULL), 0);
	check_sums();
}

static uint64_t mended(enum fault_kind kind)
{
	return report.faults[kind][FAULT_MENDED];
}

static uint64_t dropped(enum fault_kind kind)
{
	return report.faults[kind][FAULT_DROPPED];
}

static int set_up(void **state)
{
	(void)state;
	snprintf(path, sizeof(path), "/tmp/blvd-read-%d.osm", (int)getpid());
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	unlink(path);
	return 0;
}

static int finish(void **state)
{
	(void)state;
	city_finish(&city);
	return 0;
}

#define TAG(k, v) "<tag k='" k "' v='" v "'/>"
#define ND(id) "<nd ref='" id "'/>"
#define WAY(id, content) "<way id='" id "'>" content "</way>\n"
#define SQUARE ND("11") ND("13") ND("33") ND("31") ND("11")
#define STREET ND("0") ND("1") ND("2")
#define LAST_WAY (city.ways.items[city.ways.count - 1])

static void streets_have_lanes_speed_and_direction(void **state)
{
	static const struct {
		const char *tags;
		int street_class, oneway, forward, backward, speed;
		bool posted, drivable, is_private;
	} cases[] = {
		{ TAG("highway", "residential"), PKG_STREET_RESIDENTIAL, 0, 1, 1, 50, false, true, false },
		{ TAG("highway", "primary") TAG("lanes", "5") TAG("maxspeed", "60"), PKG_STREET_PRIMARY, 0, 3, 2, 60, true,
			true, false },
		{ TAG("highway", "primary") TAG("lanes", "3") TAG("lanes:backward", "2"), PKG_STREET_PRIMARY, 0, 1, 2, 50,
			false, true, false },
		{ TAG("highway", "motorway"), PKG_STREET_MOTORWAY, 1, 2, 0, 120, false, true, false },
		{ TAG("highway", "secondary") TAG("oneway", "-1") TAG("lanes", "2"), PKG_STREET_SECONDARY, -1, 0, 2, 50, false,
			true, false },
		{ TAG("highway", "tertiary") TAG("junction", "roundabout") TAG("maxspeed", "30 mph"), PKG_STREET_TERTIARY, 1, 1,
			0, 48, true, true, false },
		{ TAG("highway", "service") TAG("access", "private"), PKG_STREET_SERVICE, 0, 1, 1, 20, false, true, true },
		{ TAG("highway", "service") TAG("access", "no") TAG("motor_vehicle", "destination"), PKG_STREET_SERVICE, 0, 1,
			1, 20, false, true, true },
		{ TAG("highway", "residential") TAG("motor_vehicle", "no"), PKG_STREET_RESIDENTIAL, 0, 1, 1, 50, false, false,
			false },
		{ TAG("highway", "residential") TAG("maxspeed", "CH:urban"), PKG_STREET_RESIDENTIAL, 0, 1, 1, 50, true, true,
			false },
		{ TAG("highway", "footway"), WAY_FOOT, 0, 0, 0, 0, false, false, false },
		{ TAG("railway", "tram"), WAY_TRAM, 0, 0, 0, 0, false, false, false },
	};
	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		char text[1024];
		snprintf(text, sizeof(text), WAY("500", SQUARE TAG("building", "yes")) WAY("501", STREET "%s"), cases[i].tags);
		read_text(text);
		assert_int_equal(city.ways.count, 1);
		const struct way *way = &city.ways.items[0];
		assert_int_equal(way->street_class, cases[i].street_class);
		assert_int_equal(way->oneway, cases[i].oneway);
		assert_int_equal(way->lanes_forward, cases[i].forward);
		assert_int_equal(way->lanes_backward, cases[i].backward);
		assert_int_equal(way->speed_kmh, cases[i].speed);
		assert_int_equal(way->speed_posted, cases[i].posted);
		assert_int_equal(way->drivable, cases[i].drivable);
		assert_int_equal(way->is_private, cases[i].is_private);
		assert_true(way->width_m > 1.0);
		city_finish(&city);
	}
	read_text(WAY("500", STREET TAG("highway", "residential")));
}

static void streets_have_levels_surface_and_sidewalks(void **state)
{
	(void)state;
	read_text(WAY("500", STREET TAG("highway", "primary") TAG("bridge", "yes") TAG("surface", "sett") TAG("sidewalk",
							 "left") TAG("width", "9.5 m") TAG("name", "Rue &quot;A&quot;") TAG("ref", "K 1"))
			WAY("501", ND("3") ND("4") TAG("highway", "service") TAG("tunnel", "building_passage"))
				WAY("502", ND("5") ND("6") TAG("highway", "service") TAG("tunnel", "yes"))
					WAY("503", ND("7") ND("8") TAG("highway", "footway") TAG("footway", "sidewalk")));
	const struct way *ways = city.ways.items;
	assert_true(ways[0].bridge && ways[0].layer == 1 && ways[0].surface == SURFACE_COBBLE);
	assert_true(ways[0].sidewalk_left && !ways[0].sidewalk_right);
	assert_true(fabs(ways[0].width_m - 9.5) < 1e-9);
	assert_string_equal(ways[0].name, "Rue \"A\"");
	assert_string_equal(ways[0].ref, "K 1");
	assert_true(ways[1].passage && !ways[1].tunnel && ways[1].layer == 0);
	assert_true(ways[2].tunnel && ways[2].layer == -1);
	assert_true(ways[3].is_sidewalk);
}

static void signals_and_crossings_are_flags_of_nodes(void **state)
{
	(void)state;
	read_text("<node id='200' lat='46.2' lon='6.101'>" TAG("highway",
		"traffic_signals") "</node>"
						   "<node id='201' lat='46.2' lon='6.102'>" TAG("highway", "crossing") TAG("crossing",
							   "traffic_signals") "</node>"
												  "<node id='202' lat='46.2' lon='6.103'>" TAG(
													  "highway", "stop") "</node>"
																		 "<node id='203' lat='46.2' lon='6.104'>" TAG(
																			 "highway", "give_way") "</node>" WAY("500",
																			 ND("200") ND("201") ND("202") ND("203")
																				 TAG("highway", "residential")));
	static const uint32_t flags[] = { PKG_NODE_SIGNALS, PKG_NODE_SIGNALS | PKG_NODE_CROSSING, PKG_NODE_STOP,
		PKG_NODE_GIVE_WAY };
	for (size_t i = 0; i < 4; i++)
		assert_int_equal(city.ways.items[0].nodes[i].flags, flags[i]);
}

static void restrictions_name_streets_that_meet(void **state)
{
	(void)state;
#define RESTRICTION(id, kind, from, via, to, more)                                                                     \
	"<relation id='" id "'><member type='way' ref='" from "' role='from'/>" via "<member type='way' ref='" to          \
	"' role='to'/>" TAG("type", "restriction") TAG("restriction", kind) more "</relation>\n"
#define VIA_NODE(id) "<member type='node' ref='" id "' role='via'/>"
#define VIA_WAY(id) "<member type='way' ref='" id "' role='via'/>"
	read_text(WAY("500", ND("0") ND("1") TAG("highway", "residential")) WAY(
		"501", ND("1") ND("2") TAG("highway", "residential")) WAY("502", ND("7") ND("8") TAG("highway", "residential"))
			RESTRICTION("900", "no_left_turn", "500", VIA_NODE("1"), "501", "") RESTRICTION("901", "only_straight_on",
				"500", VIA_NODE("1"), "501", "") RESTRICTION("902", "no_u_turn", "500", VIA_NODE("1"), "502", "")
				RESTRICTION("903", "no_u_turn", "500", VIA_WAY("501"), "502", "")
					RESTRICTION("904", "no_u_turn", "500", VIA_NODE("1"), "777", "")
						RESTRICTION("905", "no_left_turn", "500", VIA_NODE("1"), "501", TAG("except", "motorcar"))
							RESTRICTION("906", "perhaps", "500", VIA_NODE("1"), "501", ""));
	assert_int_equal(city.restrictions.count, 2);
	assert_false(city.restrictions.items[0].only);
	assert_true(city.restrictions.items[1].only);
	assert_int_equal(dropped(FAULT_RESTRICTION), 3);
	assert_int_equal(dropped(FAULT_MISSING_MEMBER), 1);
	assert_int_equal(report.elements[ELEMENT_RELATION][ELEMENT_USED], 2);
	assert_int_equal(report.elements[ELEMENT_RELATION][ELEMENT_FAULTY], 4);
	assert_int_equal(report.elements[ELEMENT_RELATION][ELEMENT_IGNORED], 1);
}

static void buildings_have_heights_roofs_and_colours(void **state)
{
	(void)state;
	read_text(WAY("500",
		SQUARE TAG("building", "church") TAG("height", "40 ft") TAG("building:levels", "3") TAG("roof:shape", "gabled")
			TAG("roof:height", "4") TAG("roof:direction", "SE") TAG("roof:orientation", "across") TAG("building:colour",
				"#102030") TAG("roof:material", "slate") TAG("building:material", "brick") TAG("name", "Dom")));
	const struct building *building = &city.buildings.items[0];
	assert_true(fabs(building->height_m - 12.192) < 1e-9 && building->levels == 3.0);
	assert_int_equal(building->kind, BUILDING_CHURCH);
	assert_true(building->kind_given && building->landmark);
	assert_int_equal(building->roof_shape, ROOF_GABLED);
	assert_true(building->roof_height_m == 4.0 && building->roof_direction_deg == 135.0 && building->ridge_across);
	assert_int_equal(building->wall_colour.rgb[2], 0x30);
	assert_int_equal(building->roof_material, ROOFING_SLATE);
	assert_int_equal(building->wall_material, WALL_BRICK);
	assert_true(ring_area(&building->footprint.outer) > 100.0);
}

static void courtyards_are_holes(void **state)
{
	(void)state;
	/* The outer ring in two ways, one of them drawn backwards; the roles say nothing. */
	read_text(WAY("500", ND("0") ND("5") ND("55")) WAY("501", ND("0") ND("50") ND("55")) WAY(
		"502", ND("22") ND("23") ND("33") ND("32") ND("22")) "<relation id='900'><member type='way' ref='500' "
															 "role=''/><member type='way' ref='501' role='outer'/>"
															 "<member type='way' ref='502' role='inner'/>" TAG("type",
																 "multipolygon") TAG("building", "yes") "</relation>");
	assert_int_equal(city.buildings.count, 1);
	assert_int_equal(city.buildings.items[0].id, -900);
	assert_int_equal(city.buildings.items[0].footprint.hole_count, 1);
	assert_true(ring_area(&city.buildings.items[0].footprint.holes[0]) < 0.0);
	assert_int_equal(report.elements[ELEMENT_WAY][ELEMENT_USED], 3);
}

static void old_multipolygons_are_drawn_once(void **state)
{
	(void)state;
	read_text(WAY("500",
		SQUARE TAG("building", "house")) "<relation id='900'><member type='way' ref='500' role='outer'/>" TAG("type",
		"multipolygon") "</relation>");
	assert_int_equal(city.buildings.count, 1);
	assert_int_equal(city.buildings.items[0].kind, BUILDING_HOUSE);
}

static void parts_stand_for_their_outline(void **state)
{
	(void)state;
	read_text(
		WAY("500", ND("0") ND("4") ND("44") ND("40") ND("0") TAG("building", "office") TAG("building:colour", "red"))
			WAY("501", ND("0") ND("2") ND("42") ND("40") ND("0") TAG("building:part", "yes") TAG("height", "30")) WAY(
				"502", ND("66") ND("67") ND("77") ND("76") ND("66") TAG("building:part", "yes") TAG("height", "8")));
	/* Outline, two parts, and the half of the outline that its part leaves bare. */
	assert_int_equal(city.buildings.count, 4);
	assert_true(city.buildings.items[0].has_parts);
	assert_int_equal(city.buildings.items[1].outline, 0);
	assert_true(city.buildings.items[1].wall_colour.given);
	assert_int_equal(city.buildings.items[1].kind, BUILDING_COMMERCIAL);
	assert_false(city.buildings.items[2].is_part);
	assert_int_equal(city.buildings.items[3].outline, 0);
	assert_int_equal(mended(FAULT_PART_WITHOUT_OUTLINE), 1);
	assert_int_equal(mended(FAULT_PARTS_INCOMPLETE), 1);
	heights_infer(&city);
	assert_true(city.buildings.items[0].height_m == 30.0);
	assert_int_equal(city.buildings.items[0].height_source, HEIGHT_PARTS);
}

static void areas_lines_and_trees_are_read(void **state)
{
	(void)state;
	read_text("<node id='200' lat='46.2001' lon='6.1001'>" TAG("natural", "tree") TAG("height", "20")
			TAG("leaf_type", "needleleaved") "</node>" WAY("500", STREET TAG("highway", "residential")) WAY("501",
				SQUARE TAG("leisure", "park")) WAY("502", SQUARE TAG("natural", "water") TAG("name", "Lac")) WAY("503",
				ND("5") ND("95") TAG("waterway", "stream")) WAY("504", ND("60") ND("69") TAG("natural", "tree_row"))
				WAY("505", ND("70") ND("79") TAG("barrier", "hedge")) WAY("506", SQUARE TAG("landuse", "made_up")));
	assert_int_equal(city.areas.count, 2);
	assert_int_equal(city.areas.items[0].kind, AREA_PARK);
	assert_int_equal(city.areas.items[1].kind, AREA_WATER);
	assert_string_equal(city.areas.items[1].name, "Lac");
	assert_int_equal(city.lines.count, 2);
	assert_true(city.trees.count > 5 && city.trees.items[0].from_data && city.trees.items[0].needle);
	assert_true(fabsf(city.trees.items[0].height_m - 20.0f) < 1e-6f);
	assert_false(city.trees.items[1].from_data);
	assert_int_equal(report.elements[ELEMENT_WAY][ELEMENT_IGNORED], 1);
}

struct fault_case {
	const char *name, *body;
	enum fault_kind kind;
	uint64_t mended, dropped;
	size_t buildings, ways;
};

static const struct fault_case fault_cases[] = {
	{ "a street with a node that is not there",
		WAY("500", ND("0") ND("1") ND("777") ND("2") ND("3") TAG("highway", "residential")), FAULT_MISSING_NODE, 1, 0,
		0, 2 },
	{ "a street with one node that is there",
		WAY("500", ND("0") ND("777") TAG("highway", "residential")) WAY("501", STREET TAG("highway", "residential")),
		FAULT_MISSING_NODE, 0, 1, 0, 1 },
	{ "a building with a nearly closed outline",
		WAY("500", ND("11") ND("18") ND("88") ND("81") ND("21") TAG("building", "yes")), FAULT_OPEN_RING, 1, 0, 1, 0 },
	{ "a building with an open outline",
		WAY("500", ND("11") ND("18") ND("88") TAG("building", "yes")) WAY("501", STREET TAG("highway", "residential")),
		FAULT_OPEN_RING, 0, 1, 0, 1 },
	{ "a building that crosses itself", WAY("500", ND("11") ND("33") ND("13") ND("31") ND("11") TAG("building", "yes")),
		FAULT_SELF_CROSSING, 1, 0, 2, 0 },
	{ "a street with the same node twice", WAY("500", ND("0") ND("1") ND("1") ND("2") TAG("highway", "residential")),
		FAULT_DUPLICATE_NODE, 1, 0, 0, 1 },
	{ "a building with the same corner twice",
		WAY("500", ND("11") ND("13") ND("13") ND("33") ND("31") ND("11") TAG("building", "yes")), FAULT_DUPLICATE_NODE,
		1, 0, 1, 0 },
	{ "a building without area",
		WAY("500", ND("11") ND("12") ND("13") ND("11") TAG("building", "yes"))
			WAY("501", STREET TAG("highway", "residential")),
		FAULT_DEGENERATE_RING, 0, 1, 0, 1 },
	{ "a street of one node",
		WAY("500", ND("11") TAG("highway", "residential")) WAY("501", STREET TAG("highway", "residential")),
		FAULT_DEGENERATE_WAY, 0, 1, 0, 1 },
	{ "a height that is no number", WAY("500", SQUARE TAG("building", "yes") TAG("height", "high")), FAULT_BAD_NUMBER,
		0, 1, 1, 0 },
	{ "a height with a comma", WAY("500", SQUARE TAG("building", "yes") TAG("height", "12,5")), FAULT_BAD_NUMBER, 1, 0,
		1, 0 },
	{ "lanes beyond reason", WAY("500", STREET TAG("highway", "residential") TAG("lanes", "99")), FAULT_BAD_NUMBER, 0,
		1, 0, 1 },
	{ "a colour that is none", WAY("500", SQUARE TAG("building", "yes") TAG("building:colour", "bluish")),
		FAULT_BAD_COLOUR, 0, 1, 1, 0 },
	{ "a building whose bottom is above its top",
		WAY("500", SQUARE TAG("building", "yes") TAG("height", "10") TAG("min_height", "12")), FAULT_HEIGHT_ORDER, 1, 0,
		1, 0 },
	{ "a roof higher than its building",
		WAY("500", SQUARE TAG("building", "yes") TAG("height", "10") TAG("roof:height", "12")), FAULT_HEIGHT_ORDER, 1,
		0, 1, 0 },
	{ "the same building twice",
		WAY("500", SQUARE TAG("building", "yes")) WAY("501", SQUARE TAG("building", "yes") TAG("height", "9")),
		FAULT_OVERLAPPING_BUILDING, 0, 1, 1, 0 },
	{ "a name with a control character", WAY("500", STREET TAG("highway", "residential") TAG("name", "A&#9;B")),
		FAULT_BAD_STRING, 1, 0, 0, 1 },
	{ "a name that is no UTF-8",
		WAY("500", STREET TAG("highway", "residential") TAG("name", "Gen\xE8"
																	"ve")),
		FAULT_BAD_STRING, 1, 0, 0, 1 },
	{ "a node off the earth", "<node id='300' lat='146.2' lon='6.1'/>" WAY("500", STREET TAG("highway", "residential")),
		FAULT_BAD_NUMBER, 0, 1, 0, 1 },
	{ "a node on another continent",
		"<node id='300' lat='0' lon='0'/>" WAY("500", STREET ND("300") TAG("highway", "residential")), FAULT_BAD_NUMBER,
		0, 1, 0, 1 },
	{ "a relation with a member that is not there",
		WAY("500", STREET TAG("highway",
					   "residential")) "<relation id='900'><member type='way' ref='700' role='outer'/>" TAG("type",
			"multipolygon") TAG("building", "yes") "</relation>",
		FAULT_MISSING_MEMBER, 0, 1, 0, 1 },
};

static void each_fault_is_counted_once(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(fault_cases) / sizeof(*fault_cases); i++) {
		const struct fault_case *fault = &fault_cases[i];
		read_text(fault->body);
		if (mended(fault->kind) != fault->mended || dropped(fault->kind) != fault->dropped ||
			city.buildings.count != fault->buildings || city.ways.count != fault->ways)
			fail_msg("%s: %d mended, %d dropped, %zu buildings, %zu ways", fault->name, (int)mended(fault->kind),
				(int)dropped(fault->kind), city.buildings.count, city.ways.count);
		city_finish(&city);
	}
	read_text(WAY("500", STREET TAG("highway", "residential")));
}

static void nodes_in_one_place_become_one(void **state)
{
	(void)state;
	read_text("<node id='300' lat='46.2' lon='6.1001'/>" WAY(
		"500", ND("0") ND("1") ND("300") ND("2") TAG("highway", "residential"))
			WAY("501", ND("300") ND("11") TAG("highway", "residential")));
	assert_int_equal(city.ways.items[0].node_count, 3);
	assert_int_equal(city.ways.items[1].nodes[0].id, 1);
}

static void bounds_cut_streets_and_keep_buildings_whole(void **state)
{
	static const double bounds[] = { 6.09995, 46.19995, 6.10025, 46.2005 };
	(void)state;
	read_text(WAY("500", ND("0") ND("1") ND("2") ND("3") ND("4") ND("5") TAG("highway", "residential")) WAY("501",
		SQUARE TAG("building", "yes")) WAY("502", ND("66") ND("68") ND("88") ND("86") ND("66") TAG("building", "yes")));
	city_finish(&city);
	assert_int_equal(read_file(bounds), 0);
	assert_int_equal(city.buildings.count, 1);
	assert_int_equal(city.ways.items[0].node_count, 4);
	assert_true(city.ways.items[0].nodes[3].flags & PKG_NODE_BOUNDARY);
}

static void bad_files_are_refused(void **state)
{
	static const struct {
		const char *text;
		int status;
	} cases[] = {
		{ "", -EBADMSG },
		{ "<osm><node id='1' lat='1' lon='1'>\n<way></osm>", -EBADMSG },
		{ "<gpx></gpx>", -EBADMSG },
		{ "no data at all", -EBADMSG },
		{ "<osm></osm>", -EBADMSG },
		{ "{\"type\":\"FeatureCollection\"}", -EBADMSG },
	};
	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		write_file(cases[i].text);
		assert_int_equal(read_file(NULL), cases[i].status);
		city_finish(&city);
	}
	unlink(path);
	assert_int_equal(read_file(NULL), -ENOENT);
	city_finish(&city);
	assert_int_equal(mkdir(path, 0700), 0);
	assert_true(read_file(NULL) < 0);
	rmdir(path);
}

static void the_frame_does_not_mind_the_antimeridian(void **state)
{
	(void)state;
	write_file("<osm><node id='1' lat='-17.0' lon='179.9995'/><node id='2' lat='-17.0' lon='-179.9995'/>" WAY(
		"500", ND("1") ND("2") TAG("highway", "residential")) "</osm>");
	assert_int_equal(read_file(NULL), 0);
	assert_true(city.max.x - city.min.x < 200.0);
	assert_false(city.right_hand_traffic); /* Fiji */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_teardown(streets_have_lanes_speed_and_direction, finish),
		cmocka_unit_test_teardown(streets_have_levels_surface_and_sidewalks, finish),
		cmocka_unit_test_teardown(signals_and_crossings_are_flags_of_nodes, finish),
		cmocka_unit_test_teardown(restrictions_name_streets_that_meet, finish),
		cmocka_unit_test_teardown(buildings_have_heights_roofs_and_colours, finish),
		cmocka_unit_test_teardown(courtyards_are_holes, finish),
		cmocka_unit_test_teardown(old_multipolygons_are_drawn_once, finish),
		cmocka_unit_test_teardown(parts_stand_for_their_outline, finish),
		cmocka_unit_test_teardown(areas_lines_and_trees_are_read, finish),
		cmocka_unit_test_teardown(each_fault_is_counted_once, finish),
		cmocka_unit_test_teardown(nodes_in_one_place_become_one, finish),
		cmocka_unit_test_teardown(bounds_cut_streets_and_keep_buildings_whole, finish),
		cmocka_unit_test_teardown(bad_files_are_refused, finish),
		cmocka_unit_test_teardown(the_frame_does_not_mind_the_antimeridian, finish),
	};
	log_init("test", LOG_WARN);
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
