/*
 * Rings and polygons. Members of a multipolygon are joined at shared end nodes; what is outer and what is inner is
 * decided by nesting, so that wrong or missing roles do no harm
 * (https://wiki.openstreetmap.org/wiki/Relation:multipolygon).
 */
#include <stdlib.h>
#include <string.h>

#include "tools/read/osm_cut.h"
#include "tools/read/osm_reader.h"

/* An open ring is closed when its gap is below either of these. */
#define GAP_LIMIT_M 5.0
#define GAP_LIMIT_SHARE 0.1

void osm_mark_nodes(struct osm_reader *reader, const struct osm_way *way, enum element_fate fate)
{
	for (size_t i = 0; i < way->ref_count; i++) {
		struct osm_node *node = osm_store_node(reader->store, way->refs[i]);
		if (node)
			osm_mark(&node->fate, fate);
	}
}

/* The places of nodes that are there; `missing` counts the others. Owned by the caller. */
static struct dvec2 *places(struct osm_reader *reader, const int64_t *refs, size_t count, size_t *found)
{
	struct dvec2 *out = calloc(count + 1, sizeof(*out));
	*found = 0;
	for (size_t i = 0; out && i < count; i++) {
		const struct osm_node *node = osm_store_node(reader->store, refs[i]);
		if (node)
			out[(*found)++] = node->at;
	}
	return out;
}

static double length_of(const struct dvec2 *points, size_t count)
{
	double length = 0.0;
	for (size_t i = 1; i < count; i++)
		length += dvec2_length(dvec2_sub(points[i], points[i - 1]));
	return length;
}

static bool small_gap(const struct dvec2 *points, size_t count)
{
	if (count < 3)
		return false;
	double gap = dvec2_length(dvec2_sub(points[0], points[count - 1]));
	return gap < GAP_LIMIT_M || gap < GAP_LIMIT_SHARE * length_of(points, count);
}

static size_t give_up(struct osm_reader *reader, struct osm_way *way, enum fault_kind kind)
{
	report_fault(reader->city->report, kind, FAULT_DROPPED, way->id);
	osm_mark(&way->fate, ELEMENT_FAULTY);
	return 0;
}

size_t osm_way_polygons(
	struct osm_reader *reader, struct osm_way *way, double least_m2, bool strict, polygon_array *out)
{
	bool closed = way->ref_count >= 4 && way->refs[0] == way->refs[way->ref_count - 1];
	if (!closed && !strict)
		return 0;
	size_t found;
	struct dvec2 *points = places(reader, way->refs, way->ref_count, &found);
	size_t count = 0;
	struct polygon polygon = { 0 };
	if (!points || (!closed && !small_gap(points, found))) {
		give_up(reader, way, way->ref_count < 3 ? FAULT_DEGENERATE_RING : FAULT_OPEN_RING);
	} else if (!shape_ring(&reader->shaper, way->id, points, found, &polygon.outer)) {
		give_up(reader, way, found < way->ref_count ? FAULT_MISSING_NODE : FAULT_DEGENERATE_RING);
	} else {
		count = shape_polygons(&reader->shaper, way->id, &polygon, least_m2, out);
		if (found < way->ref_count)
			report_fault(reader->city->report, FAULT_MISSING_NODE, count ? FAULT_MENDED : FAULT_DROPPED, way->id);
		if (!closed)
			report_fault(reader->city->report, FAULT_OPEN_RING, count ? FAULT_MENDED : FAULT_DROPPED, way->id);
		osm_mark(&way->fate, count ? ELEMENT_USED : ELEMENT_FAULTY);
		osm_mark_nodes(reader, way, count ? ELEMENT_USED : ELEMENT_IGNORED);
	}
	free(points);
	return count;
}

static void chain_join(struct chain *to, const struct chain *from, bool at_start, bool reversed)
{
	size_t count = to->count + from->count - 1;
	int64_t *refs = malloc(count * sizeof(*refs));
	if (!refs)
		abort();
	/* `from` starts (or, reversed, ends) where `to` ends; at_start: ends where `to` starts. */
	for (size_t i = 0; i < from->count; i++) {
		int64_t ref = from->refs[reversed ? from->count - 1 - i : i];
		refs[at_start ? i : to->count - 1 + i] = ref;
	}
	memcpy(refs + (at_start ? from->count - 1 : 0), to->refs, to->count * sizeof(*refs));
	free(to->refs);
	to->refs = refs;
	to->count = count;
}

static bool is_closed(const struct chain *chain)
{
	return chain->count >= 4 && chain->refs[0] == chain->refs[chain->count - 1];
}

static bool try_join(struct chain *a, const struct chain *b, bool may_reverse)
{
	int64_t a0 = a->refs[0], a1 = a->refs[a->count - 1], b0 = b->refs[0], b1 = b->refs[b->count - 1];
	if (a1 == b0)
		chain_join(a, b, false, false);
	else if (a0 == b1)
		chain_join(a, b, true, false);
	else if (may_reverse && a1 == b1)
		chain_join(a, b, false, true);
	else if (may_reverse && a0 == b0)
		chain_join(a, b, true, true);
	else
		return false;
	return true;
}

void chains_join(chain_array *chains, bool may_reverse)
{
	for (size_t i = 0; i < chains->count; i++) {
		for (size_t j = i + 1; j < chains->count && !is_closed(&chains->items[i]);) {
			struct chain *a = &chains->items[i], *b = &chains->items[j];
			if (is_closed(b) || !try_join(a, b, may_reverse)) {
				j++;
				continue;
			}
			free(b->refs);
			memmove(b, b + 1, (chains->count - j - 1) * sizeof(*b));
			chains->count--;
			j = i + 1;
		}
	}
}

void chains_add_way(struct osm_reader *reader, const struct osm_way *way, chain_array *out)
{
	for (size_t i = 0; i < way->ref_count;) {
		size_t start = i;
		while (i < way->ref_count && osm_store_node(reader->store, way->refs[i]))
			i++;
		if (i - start >= 2) {
			struct chain chain = { malloc((i - start) * sizeof(int64_t)), i - start };
			if (!chain.refs)
				abort();
			memcpy(chain.refs, way->refs + start, (i - start) * sizeof(int64_t));
			ARRAY_PUSH(out, chain);
		}
		while (i < way->ref_count && !osm_store_node(reader->store, way->refs[i]))
			i++;
	}
}

void chains_finish(chain_array *chains)
{
	for (size_t i = 0; i < chains->count; i++)
		free(chains->items[i].refs);
	ARRAY_FINISH(chains);
}

static bool has_area_role(const struct osm_member *member)
{
	static const char *const roles[] = { "", "outer", "inner", "outline", "part", "footprint" };
	if (member->kind != OSM_MEMBER_WAY)
		return false;
	for (size_t i = 0; i < sizeof(roles) / sizeof(*roles); i++)
		if (!strcmp(member->role, roles[i]))
			return true;
	return false;
}

/* Returns how many members the file does not hold. */
static size_t gather(struct osm_reader *reader, const struct osm_relation *relation, chain_array *chains)
{
	size_t missing = 0;
	for (size_t i = 0; i < relation->member_count; i++) {
		const struct osm_member *member = &relation->members[i];
		if (!has_area_role(member))
			continue;
		const struct osm_way *way = osm_store_way(reader->store, member->ref);
		bool repeated = false; /* the same way twice in one relation */
		for (size_t j = 0; j < i && !repeated; j++)
			repeated = relation->members[j].kind == OSM_MEMBER_WAY && relation->members[j].ref == member->ref;
		if (!way)
			missing++;
		else if (!repeated)
			chains_add_way(reader, way, chains);
	}
	return missing;
}

/* Pulls the open chains out of `chains`. */
static void split_open(chain_array *chains, chain_array *open)
{
	size_t kept = 0;
	for (size_t i = 0; i < chains->count; i++) {
		if (is_closed(&chains->items[i]))
			chains->items[kept++] = chains->items[i];
		else
			ARRAY_PUSH(open, chains->items[i]);
	}
	chains->count = kept;
}

struct nested_ring {
	struct ring ring;
	double area;
	int depth;
};

static int by_area(const void *a, const void *b)
{
	double x = ((const struct nested_ring *)a)->area, y = ((const struct nested_ring *)b)->area;
	if (x != y)
		return x < y ? 1 : -1;
	/* Equal rings in the order of their places: sorting must not depend on the library. */
	struct dvec2 p = ((const struct nested_ring *)a)->ring.points[0],
				 q = ((const struct nested_ring *)b)->ring.points[0];
	return p.x != q.x ? (p.x < q.x ? -1 : 1) : p.y != q.y ? (p.y < q.y ? -1 : 1) : 0;
}

/* Most of the inner ring's corners inside: rings that touch share some. */
static bool ring_inside(const struct ring *inner, const struct ring *outer)
{
	size_t inside = 0;
	for (size_t i = 0; i < inner->count; i++) {
		struct dvec2 a = inner->points[i], b = inner->points[(i + 1) % inner->count];
		inside += ring_contains(outer, dvec2_scale(dvec2_add(a, b), 0.5));
	}
	return 2 * inside > inner->count;
}

static size_t nest(
	struct osm_reader *reader, int64_t id, struct nested_ring *rings, size_t count, double least_m2, polygon_array *out)
{
	size_t made = 0;
	qsort(rings, count, sizeof(*rings), by_area);
	for (size_t i = 0; i < count; i++)
		for (size_t j = 0; j < i; j++)
			rings[i].depth += ring_inside(&rings[i].ring, &rings[j].ring);
	for (size_t i = 0; i < count; i++) {
		if (rings[i].depth % 2)
			continue;
		struct polygon polygon = { .outer = rings[i].ring,
			.holes = POOL_ARRAY(reader->shaper.pool, struct ring, count) };
		for (size_t j = i + 1; j < count; j++)
			if (rings[j].depth == rings[i].depth + 1 && ring_inside(&rings[j].ring, &rings[i].ring))
				polygon.holes[polygon.hole_count++] = rings[j].ring;
		made += shape_polygons(&reader->shaper, id, &polygon, least_m2, out);
	}
	return made;
}

/* Closes what is nearly closed, drops the rest. */
static void close_or_drop(struct osm_reader *reader, int64_t id, chain_array *open, chain_array *chains)
{
	for (size_t i = 0; i < open->count; i++) {
		size_t found;
		struct dvec2 *points = places(reader, open->items[i].refs, open->items[i].count, &found);
		bool closes = points && small_gap(points, found);
		free(points);
		report_fault(reader->city->report, FAULT_OPEN_RING, closes ? FAULT_MENDED : FAULT_DROPPED, id);
		if (closes)
			ARRAY_PUSH(chains, open->items[i]);
		else
			free(open->items[i].refs);
	}
	open->count = 0;
}

static size_t polygons_of(
	struct osm_reader *reader, int64_t id, const chain_array *chains, double least_m2, polygon_array *out)
{
	struct nested_ring *rings = calloc(chains->count + 1, sizeof(*rings));
	size_t ring_count = 0, made = 0;
	for (size_t i = 0; rings && i < chains->count; i++) {
		size_t found;
		struct dvec2 *points = places(reader, chains->items[i].refs, chains->items[i].count, &found);
		struct nested_ring *ring = &rings[ring_count];
		if (points && shape_ring(&reader->shaper, id, points, found, &ring->ring)) {
			ring->area = fabs(ring_area(&ring->ring));
			ring_count++;
		} else {
			report_fault(reader->city->report, FAULT_DEGENERATE_RING, FAULT_DROPPED, id);
		}
		free(points);
	}
	if (rings)
		made = nest(reader, id, rings, ring_count, least_m2, out);
	free(rings);
	return made;
}

static void mark_members(struct osm_reader *reader, const struct osm_relation *relation, bool used)
{
	for (size_t i = 0; i < relation->member_count; i++) {
		if (!has_area_role(&relation->members[i]))
			continue;
		struct osm_way *way = osm_store_way(reader->store, relation->members[i].ref);
		if (!way)
			continue;
		osm_mark(&way->fate, used ? ELEMENT_USED : ELEMENT_IGNORED);
		osm_mark_nodes(reader, way, used ? ELEMENT_USED : ELEMENT_IGNORED);
	}
}

size_t osm_relation_polygons(
	struct osm_reader *reader, struct osm_relation *relation, double least_m2, double cut_margin_m, polygon_array *out)
{
	chain_array chains = { 0 }, open = { 0 };
	size_t missing = gather(reader, relation, &chains), made = 0;
	chains_join(&chains, true);
	split_open(&chains, &open);
	int64_t id = -relation->id;
	if (open.count && cut_margin_m >= 0.0 && cut_reaches_out(reader, &open)) {
		/* An extract's edge runs through it: its rings are closed along the edge, all of them together. */
		made = cut_polygons(reader, &chains, &open, cut_margin_m, false, out);
		report_fault(reader->city->report, FAULT_OPEN_RING, made ? FAULT_MENDED : FAULT_DROPPED, id);
	} else {
		close_or_drop(reader, id, &open, &chains);
		made = polygons_of(reader, id, &chains, least_m2, out);
	}
	if (missing)
		report_fault(reader->city->report, FAULT_MISSING_MEMBER, made ? FAULT_MENDED : FAULT_DROPPED, id);
	osm_mark(&relation->fate, made ? ELEMENT_USED : ELEMENT_FAULTY);
	mark_members(reader, relation, made > 0);
	chains_finish(&chains);
	chains_finish(&open);
	return made;
}

/* Keys that say nothing about what an area is. */
static bool is_plain(const struct osm_tags *tags)
{
	static const char *const silent[] = { "type", "source", "created_by", "note", "fixme", "attribution" };
	for (size_t i = 0; i < tags->count; i++) {
		bool known = false;
		for (size_t j = 0; j < sizeof(silent) / sizeof(*silent) && !known; j++)
			known = !strcmp(tags->items[i].key, silent[j]);
		if (!known)
			return false;
	}
	return true;
}

struct osm_tags osm_relation_tags(const struct osm_reader *reader, const struct osm_relation *relation)
{
	if (!is_plain(&relation->tags))
		return relation->tags;
	for (size_t i = 0; i < relation->member_count; i++) {
		const struct osm_member *member = &relation->members[i];
		if (member->kind != OSM_MEMBER_WAY || !strcmp(member->role, "inner"))
			continue;
		const struct osm_way *way = osm_store_way(reader->store, member->ref);
		if (way && !is_plain(&way->tags))
			return way->tags;
	}
	return relation->tags;
}
