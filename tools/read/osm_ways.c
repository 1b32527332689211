/*
 * Streets, paths, rails, and turn restrictions. What a street lacks (lanes, width, speed, sidewalks) is inferred by its
 * class; the tables are here. Tags: https://wiki.openstreetmap.org/wiki/Key:highway, Key:lanes, Key:oneway, Key:access,
 * Key:maxspeed, Relation:restriction.
 */
#include <stdlib.h>
#include <string.h>

#include "tools/read/osm_kind.h"
#include "tools/read/osm_reader.h"

#define LANES_LIMIT 12
#define LAYER_LIMIT 10

/* By enum pkg_street_class. */
static const struct class_default {
	int lanes_both, lanes_oneway; /* total of a street both ways; of a one-way */
	double lane_m, edge_m;        /* width of a lane; kept beside the lanes, both sides together */
	int speed_kmh, link_kmh;
	bool sidewalks, lit;
} class_defaults[PKG_STREET_CLASS_COUNT] = {
	[PKG_STREET_MOTORWAY] = { 4, 2, 3.75, 3.0, 120, 60, false, false },
	[PKG_STREET_TRUNK] = { 2, 2, 3.5, 1.5, 80, 60, false, true },
	[PKG_STREET_PRIMARY] = { 2, 1, 3.3, 0.8, 50, 50, true, true },
	[PKG_STREET_SECONDARY] = { 2, 1, 3.25, 0.8, 50, 50, true, true },
	[PKG_STREET_TERTIARY] = { 2, 1, 3.0, 0.6, 50, 50, true, true },
	[PKG_STREET_UNCLASSIFIED] = { 2, 1, 2.8, 0.6, 50, 50, true, true },
	[PKG_STREET_RESIDENTIAL] = { 2, 1, 2.8, 0.6, 50, 50, true, true },
	[PKG_STREET_LIVING] = { 2, 1, 2.6, 0.4, 20, 20, true, true },
	[PKG_STREET_SERVICE] = { 2, 1, 2.4, 0.2, 20, 20, false, false },
};

/* By enum way_class, from WAY_FOOT. */
static const double path_width_m[] = { 1.8, 6.0, 2.0, 2.0, 2.6, 3.2, 3.0 };

enum { LINK = 0x100 };
static const struct tag_word highway_words[] = {
	{ "motorway", PKG_STREET_MOTORWAY },
	{ "motorway_link", PKG_STREET_MOTORWAY | LINK },
	{ "trunk", PKG_STREET_TRUNK },
	{ "trunk_link", PKG_STREET_TRUNK | LINK },
	{ "primary", PKG_STREET_PRIMARY },
	{ "primary_link", PKG_STREET_PRIMARY | LINK },
	{ "secondary", PKG_STREET_SECONDARY },
	{ "secondary_link", PKG_STREET_SECONDARY | LINK },
	{ "tertiary", PKG_STREET_TERTIARY },
	{ "tertiary_link", PKG_STREET_TERTIARY | LINK },
	{ "unclassified", PKG_STREET_UNCLASSIFIED },
	{ "road", PKG_STREET_UNCLASSIFIED },
	{ "residential", PKG_STREET_RESIDENTIAL },
	{ "living_street", PKG_STREET_LIVING },
	{ "service", PKG_STREET_SERVICE },
	{ "services", PKG_STREET_SERVICE },
	{ "busway", PKG_STREET_SERVICE },
	{ "footway", WAY_FOOT },
	{ "path", WAY_FOOT },
	{ "bridleway", WAY_FOOT },
	{ "pedestrian", WAY_PEDESTRIAN },
	{ "cycleway", WAY_CYCLE },
	{ "steps", WAY_STEPS },
	{ "track", WAY_TRACK },
	{ NULL, 0 },
};

static const struct tag_word railway_words[] = {
	{ "rail", WAY_RAIL },
	{ "light_rail", WAY_RAIL },
	{ "narrow_gauge", WAY_RAIL },
	{ "subway", WAY_RAIL },
	{ "monorail", WAY_RAIL },
	{ "funicular", WAY_RAIL },
	{ "tram", WAY_TRAM },
	{ NULL, 0 },
};

bool osm_is_highway(const char *value)
{
	return tag_word_find(highway_words, value, -1) >= 0;
}

/* Class with LINK, or -1: nothing that is drawn. */
static int class_of(const struct osm_tags *tags)
{
	const char *highway = osm_tag(tags, "highway");
	if (highway)
		return tag_word_find(highway_words, highway, -1);
	const char *railway = osm_tag(tags, "railway");
	return railway ? tag_word_find(railway_words, railway, -1) : -1;
}

/* The most specific of the access tags that applies to a car. */
static const char *car_access(const struct osm_tags *tags)
{
	static const char *const keys[] = { "motorcar", "motor_vehicle", "vehicle", "access" };
	for (size_t i = 0; i < sizeof(keys) / sizeof(*keys); i++) {
		const char *value = osm_tag(tags, keys[i]);
		if (value)
			return value;
	}
	return "yes";
}

static bool is_forbidden(const char *access)
{
	static const char *const values[] = { "no", "agricultural", "forestry", "agricultural;forestry", "psv", "bus",
		"foot", "bicycle", "emergency", "military", "use_sidepath", "dismount", "taxi", "tourist_bus" };
	for (size_t i = 0; i < sizeof(values) / sizeof(*values); i++)
		if (!strcmp(access, values[i]))
			return true;
	return false;
}

static bool is_private(const char *access)
{
	static const char *const values[] = { "private", "destination", "delivery", "customers", "permit", "residents",
		"private;delivery", "delivery;private", "restricted", "employees" };
	for (size_t i = 0; i < sizeof(values) / sizeof(*values); i++)
		if (!strcmp(access, values[i]))
			return true;
	return false;
}

static bool is_area(const struct osm_tags *tags)
{
	return osm_tag_is(tags, "area", "yes");
}

bool osm_is_drivable(const struct osm_tags *tags)
{
	int class = class_of(tags);
	return class >= 0 && (class & ~LINK) < PKG_STREET_CLASS_COUNT && !is_area(tags) &&
		   !osm_tag_is(tags, "highway", "busway") && !is_forbidden(car_access(tags));
}

static int count_tag(struct osm_reader *reader, const struct osm_tags *tags, const char *key, int64_t id)
{
	double value;
	return osm_number(reader, tags, key, id, 0.5, LANES_LIMIT, &value) ? (int)(value + 0.5) : 0;
}

static int oneway_of(const struct osm_tags *tags, int class, bool roundabout)
{
	const char *value = osm_tag(tags, "oneway");
	if (value) {
		if (!strcmp(value, "yes") || !strcmp(value, "1") || !strcmp(value, "true"))
			return 1;
		if (!strcmp(value, "-1") || !strcmp(value, "reverse"))
			return -1;
		return 0;
	}
	return roundabout || (class & ~LINK) == PKG_STREET_MOTORWAY;
}

static void set_lanes(struct osm_reader *reader, const struct osm_tags *tags, struct way *way)
{
	const struct class_default *defaults = &class_defaults[way->street_class];
	int total = count_tag(reader, tags, "lanes", way->id);
	int forward = count_tag(reader, tags, "lanes:forward", way->id);
	int backward = count_tag(reader, tags, "lanes:backward", way->id);
	if (way->oneway) {
		int lanes = total ? total : way->link ? 1 : defaults->lanes_oneway;
		way->lanes_forward = way->oneway > 0 ? lanes : 0;
		way->lanes_backward = way->oneway < 0 ? lanes : 0;
		return;
	}
	if (!total)
		total = forward && backward ? forward + backward : defaults->lanes_both;
	if (!forward)
		forward = backward && total > backward ? total - backward : (total + 1) / 2;
	if (!backward)
		backward = total > forward ? total - forward : 1;
	way->lanes_forward = forward;
	way->lanes_backward = backward;
}

/* Narrow streets both ways share their one lane. */
static double inferred_width(struct osm_reader *reader, const struct osm_tags *tags, const struct way *way)
{
	if (way->street_class >= PKG_STREET_CLASS_COUNT)
		return path_width_m[way->street_class - PKG_STREET_CLASS_COUNT];
	const struct class_default *defaults = &class_defaults[way->street_class];
	int lanes = way->lanes_forward + way->lanes_backward;
	bool shared = !way->oneway && osm_tag_is(tags, "lanes", "1");
	(void)reader;
	if (shared)
		lanes = 1;
	double width = defaults->lane_m * lanes + defaults->edge_m;
	const char *service = osm_tag(tags, "service");
	if (service && way->street_class == PKG_STREET_SERVICE)
		width = !strcmp(service, "alley") || !strcmp(service, "driveway") ? 3.0
				: !strcmp(service, "parking_aisle")                       ? 5.0
																		  : width;
	return lanes == 1 ? fmax(width, way->street_class == PKG_STREET_SERVICE ? 2.8 : 3.5) : width;
}

static void set_width(struct osm_reader *reader, const struct osm_tags *tags, struct way *way)
{
	if (osm_length(reader, tags, "width:carriageway", way->id, 1.0, 60.0, &way->width_m) ||
		osm_length(reader, tags, "width", way->id, 0.5, 60.0, &way->width_m) ||
		osm_length(reader, tags, "est_width", way->id, 0.5, 60.0, &way->width_m)) {
		/* Cars must fit in what they drive on. */
		if (way->drivable && way->width_m < 2.2)
			way->width_m = 2.2;
		return;
	}
	way->width_m = inferred_width(reader, tags, way);
}

static void set_speed(struct osm_reader *reader, const struct osm_tags *tags, struct way *way)
{
	static const char *const keys[] = { "maxspeed", "maxspeed:forward", "maxspeed:backward", "maxspeed:type",
		"source:maxspeed", "zone:maxspeed" };
	const struct class_default *defaults = &class_defaults[way->street_class];
	way->speed_kmh = way->link ? defaults->link_kmh : defaults->speed_kmh;
	for (size_t i = 0; i < sizeof(keys) / sizeof(*keys); i++) {
		const char *value = osm_tag(tags, keys[i]);
		int speed = 0;
		if (!value)
			continue;
		enum tag_verdict verdict = tag_speed_kmh(value, &speed);
		/* The last three hold remarks as often as speeds. */
		if (verdict != TAG_GOOD && i < 3)
			report_fault(
				reader->city->report, FAULT_BAD_NUMBER, verdict == TAG_BAD ? FAULT_DROPPED : FAULT_MENDED, way->id);
		if (verdict != TAG_BAD && speed) {
			way->speed_kmh = speed;
			way->speed_posted = true;
			return;
		}
	}
}

static void set_sidewalks(const struct osm_tags *tags, struct way *way)
{
	bool usual = class_defaults[way->street_class].sidewalks && !way->link && !way->tunnel && !way->roundabout;
	const char *both = osm_tag(tags, "sidewalk");
	if (!both)
		both = osm_tag(tags, "sidewalk:both");
	const char *left = osm_tag(tags, "sidewalk:left"), *right = osm_tag(tags, "sidewalk:right");
	way->sidewalk_left = way->sidewalk_right = usual;
	if (both) {
		bool everywhere = !strcmp(both, "both") || !strcmp(both, "yes") || !strcmp(both, "separate");
		way->sidewalk_left = everywhere || !strcmp(both, "left");
		way->sidewalk_right = everywhere || !strcmp(both, "right");
	}
	if (left)
		way->sidewalk_left = strcmp(left, "no") != 0;
	if (right)
		way->sidewalk_right = strcmp(right, "no") != 0;
}

static enum way_surface surface_of(const struct osm_tags *tags, int street_class)
{
	static const struct tag_word words[] = {
		{ "asphalt", SURFACE_ASPHALT },
		{ "concrete", SURFACE_PAVED },
		{ "concrete:plates", SURFACE_PAVED },
		{ "concrete:lanes", SURFACE_PAVED },
		{ "paved", SURFACE_ASPHALT },
		{ "paving_stones", SURFACE_PAVED },
		{ "paving_stones:lanes", SURFACE_PAVED },
		{ "bricks", SURFACE_PAVED },
		{ "brick", SURFACE_PAVED },
		{ "tiles", SURFACE_PAVED },
		{ "wood", SURFACE_PAVED },
		{ "metal", SURFACE_PAVED },
		{ "sett", SURFACE_COBBLE },
		{ "cobblestone", SURFACE_COBBLE },
		{ "cobblestone:flattened", SURFACE_COBBLE },
		{ "unhewn_cobblestone", SURFACE_COBBLE },
		{ "stone", SURFACE_COBBLE },
		{ "gravel", SURFACE_GRAVEL },
		{ "fine_gravel", SURFACE_GRAVEL },
		{ "compacted", SURFACE_GRAVEL },
		{ "pebblestone", SURFACE_GRAVEL },
		{ "unpaved", SURFACE_GRAVEL },
		{ "ground", SURFACE_GROUND },
		{ "dirt", SURFACE_GROUND },
		{ "earth", SURFACE_GROUND },
		{ "grass", SURFACE_GROUND },
		{ "sand", SURFACE_GROUND },
		{ "mud", SURFACE_GROUND },
		{ NULL, 0 },
	};
	int usual = street_class == WAY_PEDESTRIAN ? SURFACE_PAVED
				: street_class == WAY_TRACK    ? SURFACE_GRAVEL
											   : SURFACE_ASPHALT;
	const char *value = osm_tag(tags, "surface");
	return (enum way_surface)(value ? tag_word_find(words, value, usual) : usual);
}

static void set_levels(struct osm_reader *reader, const struct osm_tags *tags, struct way *way)
{
	double layer = 0.0;
	osm_number(reader, tags, "layer", way->id, -LAYER_LIMIT, LAYER_LIMIT, &layer);
	const char *tunnel = osm_tag(tags, "tunnel"), *covered = osm_tag(tags, "covered");
	way->layer = (int)layer;
	way->bridge = osm_tag_yes(tags, "bridge");
	way->passage = (tunnel && !strcmp(tunnel, "building_passage")) || (covered && strcmp(covered, "no") != 0);
	way->tunnel = tunnel && strcmp(tunnel, "no") != 0 && strcmp(tunnel, "building_passage") != 0;
	/* "indoor" passages and platforms of other levels are inside buildings. */
	if (way->bridge && way->layer == 0)
		way->layer = 1;
	if (way->tunnel && way->layer >= 0)
		way->layer = -1;
}

static void set_street(struct osm_reader *reader, const struct osm_tags *tags, struct way *way, int class)
{
	const char *junction = osm_tag(tags, "junction"), *access = car_access(tags);
	way->roundabout = junction && (!strcmp(junction, "roundabout") || !strcmp(junction, "circular"));
	way->drivable = !is_forbidden(access) && !osm_tag_is(tags, "highway", "busway");
	way->is_private = is_private(access);
	way->oneway = oneway_of(tags, class, way->roundabout);
	const char *lit = osm_tag(tags, "lit");
	way->lit = lit ? strcmp(lit, "no") != 0 : class_defaults[way->street_class].lit;
	set_lanes(reader, tags, way);
	set_speed(reader, tags, way);
	set_sidewalks(tags, way);
}

static uint32_t node_flags(const struct osm_tags *tags)
{
	static const struct tag_word words[] = {
		{ "traffic_signals", PKG_NODE_SIGNALS },
		{ "stop", PKG_NODE_STOP },
		{ "give_way", PKG_NODE_GIVE_WAY },
		{ "crossing", PKG_NODE_CROSSING },
		{ "mini_roundabout", PKG_NODE_ROUNDABOUT },
		{ NULL, 0 },
	};
	const char *highway = osm_tag(tags, "highway"), *crossing = osm_tag(tags, "crossing");
	uint32_t flags = highway ? (uint32_t)tag_word_find(words, highway, 0) : 0;
	if (crossing && strcmp(crossing, "no") != 0)
		flags |= PKG_NODE_CROSSING;
	if ((crossing && !strcmp(crossing, "traffic_signals")) || osm_tag_is(tags, "crossing:signals", "yes"))
		flags |= PKG_NODE_SIGNALS;
	return flags;
}

static bool same_place(struct dvec2 a, struct dvec2 b)
{
	return dvec2_length(dvec2_sub(a, b)) < 1e-3;
}

/* The run of nodes from `*next` up to a missing one; repeated places are taken out. */
static size_t take_run(
	struct osm_reader *reader, const struct osm_way *from, size_t *next, struct way_node *nodes, bool *duplicates)
{
	size_t count = 0;
	for (; *next < from->ref_count; (*next)++) {
		const struct osm_node *node = osm_store_node(reader->store, from->refs[*next]);
		if (!node)
			break;
		uint32_t flags = node_flags(&node->tags);
		if (count && (nodes[count - 1].id == node->id || same_place(nodes[count - 1].at, node->at))) {
			*duplicates = true;
			if (nodes[count - 1].id != node->id)
				ARRAY_PUSH(&reader->aliases, (struct node_alias){ node->id, nodes[count - 1].id });
			nodes[count - 1].flags |= flags;
			continue;
		}
		nodes[count++] = (struct way_node){ node->id, node->at, flags };
	}
	return count;
}

static bool segment_near(const struct bounds *bounds, struct dvec2 a, struct dvec2 b)
{
	return fmax(a.x, b.x) >= bounds->min.x && fmin(a.x, b.x) <= bounds->max.x && fmax(a.y, b.y) >= bounds->min.y &&
		   fmin(a.y, b.y) <= bounds->max.y;
}

static void push_way(struct osm_reader *reader, const struct way *like, const struct way_node *nodes, size_t count)
{
	struct way way = *like;
	way.nodes = pool_copy(&reader->city->pool, nodes, count * sizeof(*nodes));
	way.node_count = count;
	ARRAY_PUSH(&reader->city->ways, way);
}

/* With --bbox: the parts of a run that touch the bounds; where it is cut the street goes on beyond the data. */
static size_t push_clipped(struct osm_reader *reader, const struct way *like, struct way_node *nodes, size_t count)
{
	size_t made = 0;
	if (!reader->clip) {
		push_way(reader, like, nodes, count);
		return 1;
	}
	for (size_t i = 0; i + 1 < count;) {
		size_t start = i;
		while (i + 1 < count && segment_near(&reader->built, nodes[i].at, nodes[i + 1].at))
			i++;
		if (i > start) {
			if (start > 0)
				nodes[start].flags |= PKG_NODE_BOUNDARY;
			if (i + 1 < count)
				nodes[i].flags |= PKG_NODE_BOUNDARY;
			push_way(reader, like, nodes + start, i - start + 1);
			made++;
		}
		i = i > start ? i : i + 1;
	}
	return made;
}

/* Pushes what there is of the way. Returns the number of pieces, or -1 when nothing is left for a fault. */
static int push_runs(struct osm_reader *reader, const struct osm_way *from, const struct way *like)
{
	struct way_node *nodes = calloc(from->ref_count + 1, sizeof(*nodes));
	size_t next = 0, pieces = 0, runs = 0, missing = 0;
	bool duplicates = false, was_missing = false;
	if (!nodes)
		abort();
	while (next < from->ref_count) {
		size_t count = take_run(reader, from, &next, nodes, &duplicates);
		bool cut = next < from->ref_count;
		if (count >= 2) {
			if (was_missing)
				nodes[0].flags |= PKG_NODE_BOUNDARY;
			if (cut)
				nodes[count - 1].flags |= PKG_NODE_BOUNDARY;
			pieces += push_clipped(reader, like, nodes, count);
			runs++;
		}
		missing += cut;
		was_missing = cut;
		next += cut;
	}
	free(nodes);
	struct report *report = reader->city->report;
	if (missing)
		report_fault(report, FAULT_MISSING_NODE, runs ? FAULT_MENDED : FAULT_DROPPED, from->id);
	if (duplicates)
		report_fault(report, FAULT_DUPLICATE_NODE, runs ? FAULT_MENDED : FAULT_DROPPED, from->id);
	if (!runs && !missing && !duplicates)
		report_fault(report, FAULT_DEGENERATE_WAY, FAULT_DROPPED, from->id);
	return runs ? (int)pieces : -1;
}

static void make_way(struct osm_reader *reader, struct osm_way *from, int class)
{
	const struct osm_tags *tags = &from->tags;
	struct way way = { .id = from->id, .street_class = class & ~LINK, .link = class & LINK };
	set_levels(reader, tags, &way);
	/* Underground railways are never seen. */
	if (way.street_class >= WAY_RAIL && (way.tunnel || way.layer < 0 || osm_tag_is(tags, "railway", "subway")) &&
		!way.bridge)
		return;
	if (way.street_class < PKG_STREET_CLASS_COUNT)
		set_street(reader, tags, &way, class);
	set_width(reader, tags, &way);
	way.surface = surface_of(tags, way.street_class);
	const char *footway = osm_tag(tags, "footway");
	way.is_sidewalk = footway && !strcmp(footway, "sidewalk");
	way.is_crossing = (footway && !strcmp(footway, "crossing")) || osm_tag_is(tags, "cycleway", "crossing") ||
					  osm_tag_is(tags, "path", "crossing");
	way.name = osm_name(reader, tags);
	const char *ref = osm_tag(tags, "ref");
	way.ref = ref && *ref ? pool_string(&reader->city->pool, ref) : NULL;
	int pieces = push_runs(reader, from, &way);
	osm_mark(&from->fate, pieces > 0 ? ELEMENT_USED : pieces < 0 ? ELEMENT_FAULTY : ELEMENT_IGNORED);
	if (pieces > 0)
		osm_mark_nodes(reader, from, ELEMENT_USED);
}

static int by_from(const void *a, const void *b)
{
	int64_t x = ((const struct node_alias *)a)->from, y = ((const struct node_alias *)b)->from;
	return x < y ? -1 : x > y;
}

static int64_t resolve(const struct osm_reader *reader, int64_t id)
{
	/* Chains of aliases are short; the bound keeps a ring of them from turning for ever. */
	for (int steps = 0; reader->aliases.count && steps < 16; steps++) {
		struct node_alias key = { id, 0 };
		const struct node_alias *alias =
			bsearch(&key, reader->aliases.items, reader->aliases.count, sizeof(key), by_from);
		if (!alias || alias->to == id)
			break;
		id = alias->to;
	}
	return id;
}

static void apply_aliases(struct osm_reader *reader)
{
	if (!reader->aliases.count)
		return;
	ARRAY_SORT(&reader->aliases, by_from);
	for (size_t i = 0; i < reader->city->ways.count; i++) {
		struct way *way = &reader->city->ways.items[i];
		for (size_t j = 0; j < way->node_count; j++)
			way->nodes[j].id = resolve(reader, way->nodes[j].id);
	}
}

void osm_make_ways(struct osm_reader *reader)
{
	for (size_t i = 0; i < reader->store->ways.count; i++) {
		struct osm_way *way = &reader->store->ways.items[i];
		int class = class_of(&way->tags);
		if (class < 0 || is_area(&way->tags) || osm_tag_is(&way->tags, "indoor", "yes"))
			continue;
		make_way(reader, way, class);
	}
	apply_aliases(reader);
}

/* The kind that applies to cars: "restriction", or the one for motor vehicles. */
static const char *restriction_kind(const struct osm_tags *tags)
{
	static const char *const keys[] = { "restriction", "restriction:motorcar", "restriction:motor_vehicle" };
	for (size_t i = 0; i < sizeof(keys) / sizeof(*keys); i++) {
		const char *value = osm_tag(tags, keys[i]);
		if (value)
			return value;
	}
	return NULL;
}

static bool cars_are_excepted(const struct osm_tags *tags)
{
	const char *except = osm_tag(tags, "except");
	return except && (strstr(except, "motorcar") || strstr(except, "motor_vehicle"));
}

struct members {
	int64_t from[8], to[8], via;
	size_t from_count, to_count, via_count;
	bool via_way, missing;
};

static void sort_members(const struct osm_reader *reader, const struct osm_relation *relation, struct members *out)
{
	for (size_t i = 0; i < relation->member_count; i++) {
		const struct osm_member *member = &relation->members[i];
		bool is_way = member->kind == OSM_MEMBER_WAY;
		bool there = is_way ? osm_store_way(reader->store, member->ref) != NULL
							: osm_store_node(reader->store, member->ref) != NULL;
		bool from = !strcmp(member->role, "from"), to = !strcmp(member->role, "to"), via = !strcmp(member->role, "via");
		if (!from && !to && !via)
			continue;
		out->missing |= !there;
		if (from && is_way && out->from_count < 8)
			out->from[out->from_count++] = member->ref;
		if (to && is_way && out->to_count < 8)
			out->to[out->to_count++] = member->ref;
		if (via) {
			out->via = member->ref;
			out->via_way |= member->kind != OSM_MEMBER_NODE;
			out->via_count++;
		}
	}
}

static bool drives(const struct osm_reader *reader, int64_t id)
{
	const struct osm_way *way = osm_store_way(reader->store, id);
	return way && way->fate == ELEMENT_USED && osm_is_drivable(&way->tags);
}

static bool passes(const struct osm_reader *reader, int64_t id, int64_t node)
{
	const struct osm_way *way = osm_store_way(reader->store, id);
	for (size_t i = 0; way && i < way->ref_count; i++)
		if (way->refs[i] == node)
			return true;
	return false;
}

static void drop_restriction(struct osm_reader *reader, struct osm_relation *relation, enum fault_kind kind)
{
	report_fault(reader->city->report, kind, FAULT_DROPPED, -relation->id);
	osm_mark(&relation->fate, ELEMENT_FAULTY);
}

static void push_restrictions(
	struct osm_reader *reader, struct osm_relation *relation, const struct members *members, bool only)
{
	size_t pushed = 0;
	bool apart = false;
	for (size_t i = 0; i < members->from_count; i++) {
		for (size_t j = 0; j < members->to_count; j++) {
			int64_t from = members->from[i], to = members->to[j];
			if (!passes(reader, from, members->via) || !passes(reader, to, members->via)) {
				apart = true;
			} else if (drives(reader, from) && drives(reader, to)) {
				ARRAY_PUSH(
					&reader->city->restrictions, (struct restriction){ from, resolve(reader, members->via), to, only });
				pushed++;
			}
		}
	}
	if (pushed)
		osm_mark(&relation->fate, ELEMENT_USED);
	else if (apart)
		drop_restriction(reader, relation, FAULT_RESTRICTION);
}

void osm_make_restrictions(struct osm_reader *reader)
{
	for (size_t i = 0; i < reader->store->relations.count; i++) {
		struct osm_relation *relation = &reader->store->relations.items[i];
		const char *type = osm_tag(&relation->tags, "type"), *kind = restriction_kind(&relation->tags);
		if (!type || strncmp(type, "restriction", 11) != 0 || !kind || cars_are_excepted(&relation->tags))
			continue;
		bool no = !strncmp(kind, "no_", 3), only = !strncmp(kind, "only_", 5);
		struct members members = { 0 };
		sort_members(reader, relation, &members);
		bool plain =
			(no || only) && !members.via_way && members.via_count == 1 && members.from_count && members.to_count;
		if ((no || only) && members.missing)
			drop_restriction(reader, relation, FAULT_MISSING_MEMBER);
		else if (!plain)
			drop_restriction(reader, relation, FAULT_RESTRICTION);
		else
			push_restrictions(reader, relation, &members, only);
	}
}
