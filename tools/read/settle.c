#include "tools/read/settle.h"

#include <stdlib.h>
#include <string.h>

#include "tools/city/box_index.h"

#define STOREY_M 3.2
/* Of the smaller footprint, covered by the other: they are one building, or one lies in the other. */
#define OVERLAP_SHARE 0.8
/* Of the larger footprint as well: they are one building. */
#define SAME_SHARE 0.65
/* A part that starts higher than this stands on something; lower, it is an overhang or a passage. */
#define HOVERING_M 6.0
#define COVERED_SHARE 0.9
#define REST_LEAST_M2 4.0

static void mend_height_order(struct city *city, struct building *building)
{
	if (building->min_height_m <= 0.0 && building->min_level > 0.0) {
		double storey =
			building->height_m > 0.0 && building->levels > 0.0 ? building->height_m / building->levels : STOREY_M;
		building->min_height_m = building->min_level * storey;
		/* Levels that count from min_level on say less than the height does. */
		if (building->height_m > 0.0 && building->min_height_m >= building->height_m)
			building->min_height_m = 0.0;
	}
	bool wrong = false;
	if (building->height_m > 0.0 && building->min_height_m >= building->height_m) {
		/* Parts are often given their own height instead of that of their top. */
		if (building->is_part)
			building->height_m += building->min_height_m;
		else
			building->min_height_m = 0.0;
		wrong = true;
	}
	double body = building->height_m - building->min_height_m;
	if (building->height_m > 0.0 && building->roof_height_m > body + 0.01) {
		building->roof_height_m = body;
		wrong = true;
	}
	if (wrong)
		report_fault(city->report, FAULT_HEIGHT_ORDER, FAULT_MENDED, building->id);
}

static struct bounds box_of(const struct building *building)
{
	struct bounds box;
	ring_bounds(&building->footprint.outer, &box.min, &box.max);
	return box;
}

static void index_buildings(const struct city *city, bounds_array *boxes, struct box_index *index)
{
	ARRAY_RESERVE(boxes, city->buildings.count + 1);
	for (size_t i = 0; i < city->buildings.count; i++)
		ARRAY_PUSH(boxes, box_of(&city->buildings.items[i]));
	box_index_build(index, boxes->items, boxes->count, 40.0);
}

static double box_overlap(struct bounds a, struct bounds b)
{
	double x = fmin(a.max.x, b.max.x) - fmax(a.min.x, b.min.x), y = fmin(a.max.y, b.max.y) - fmax(a.min.y, b.min.y);
	return x > 0.0 && y > 0.0 ? x * y : 0.0;
}

static double common_area(const struct shaper *shaper, const struct polygon *a, const struct polygon *b)
{
	GEOSGeometry *first = shape_to_geos(shaper, a), *second = shape_to_geos(shaper, b);
	GEOSGeometry *both = first && second ? GEOSIntersection_r(shaper->geos, first, second) : NULL;
	double area = 0.0;
	if (both)
		GEOSArea_r(shaper->geos, both, &area);
	GEOSGeom_destroy_r(shaper->geos, first);
	GEOSGeom_destroy_r(shaper->geos, second);
	GEOSGeom_destroy_r(shaper->geos, both);
	return area;
}

static int knowledge(const struct building *building)
{
	return 4 * (building->height_m > 0.0) + 2 * (building->levels > 0.0) + building->kind_given +
		   (building->name != NULL);
}

/* Which of an overlapping pair goes: 0 the first, 1 the second, -1 neither. */
static int loser(
	const struct city *city, size_t i, size_t j, double common, const double area[2], size_t preferred_first)
{
	const struct building *a = &city->buildings.items[i], *b = &city->buildings.items[j];
	double least = fmin(area[0], area[1]), most = fmax(area[0], area[1]);
	bool preferred[2] = { i >= preferred_first, j >= preferred_first };
	if (preferred[0] != preferred[1]) { /* two sources: the set wins where the other is mostly covered */
		size_t other = preferred[0] ? 1 : 0;
		return common > 0.5 * area[other] ? (int)other : -1;
	}
	if (common < OVERLAP_SHARE * least)
		return -1;
	bool apart =
		(a->height_m > 0.0 && a->height_m <= b->min_height_m) || (b->height_m > 0.0 && b->height_m <= a->min_height_m);
	if (apart)
		return -1;
	if (common > SAME_SHARE * most)
		return knowledge(b) > knowledge(a) ? 0 : 1;
	/* One inside the other: a tower that rises out of it stays. */
	int inner = area[0] < area[1] ? 0 : 1;
	const struct building *small = inner ? b : a, *large = inner ? a : b;
	double small_top = small->height_m > 0.0 ? small->height_m : small->levels * STOREY_M;
	double large_top = large->height_m > 0.0 ? large->height_m : large->levels * STOREY_M;
	return small_top > large_top + 1.0 ? -1 : inner;
}

static void find_losers(
	struct city *city, const struct shaper *shaper, size_t preferred_first, const struct box_index *index, bool *lost)
{
	index_array near = { 0 };
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct building *a = &city->buildings.items[i];
		if (a->is_part || lost[i])
			continue;
		box_index_find(index, index->boxes[i], &near);
		for (size_t k = 0; k < near.count && !lost[i]; k++) {
			size_t j = near.items[k];
			const struct building *b = &city->buildings.items[j];
			if (j <= i || b->is_part || lost[j])
				continue;
			double area[2] = { polygon_area(&a->footprint), polygon_area(&b->footprint) };
			if (box_overlap(index->boxes[i], index->boxes[j]) < 0.4 * fmin(area[0], area[1]))
				continue;
			double common = common_area(shaper, &a->footprint, &b->footprint);
			int which = loser(city, i, j, common, area, preferred_first);
			if (which < 0)
				continue;
			size_t gone = which ? j : i;
			lost[gone] = true;
			report_fault(city->report, FAULT_OVERLAPPING_BUILDING, FAULT_DROPPED, city->buildings.items[gone].id);
		}
	}
	ARRAY_FINISH(&near);
}

static void drop_duplicates(struct city *city, const struct shaper *shaper, size_t preferred_first, id_array *dropped)
{
	bounds_array boxes = { 0 };
	struct box_index index;
	bool *lost = calloc(city->buildings.count + 1, sizeof(bool));
	if (!lost)
		abort();
	index_buildings(city, &boxes, &index);
	find_losers(city, shaper, preferred_first, &index, lost);
	size_t kept = 0;
	for (size_t i = 0; i < city->buildings.count; i++)
		if (!lost[i])
			city->buildings.items[kept++] = city->buildings.items[i];
		else if (i < preferred_first)
			ARRAY_PUSH(dropped, city->buildings.items[i].id);
	city->buildings.count = kept;
	box_index_finish(&index);
	ARRAY_FINISH(&boxes);
	free(lost);
}

/* The smallest outline that holds most of the part. */
static uint32_t outline_of(
	const struct city *city, const struct shaper *shaper, const struct box_index *index, size_t part, index_array *near)
{
	const struct building *building = &city->buildings.items[part];
	double own = polygon_area(&building->footprint), best_area = INFINITY;
	uint32_t best = PKG_NONE;
	box_index_find(index, index->boxes[part], near);
	for (size_t k = 0; k < near->count; k++) {
		const struct building *outline = &city->buildings.items[near->items[k]];
		double area = outline->is_part ? 0.0 : polygon_area(&outline->footprint);
		if (outline->is_part || area >= best_area ||
			box_overlap(index->boxes[part], index->boxes[near->items[k]]) < 0.5 * own)
			continue;
		if (common_area(shaper, &building->footprint, &outline->footprint) > 0.5 * own) {
			best = near->items[k];
			best_area = area;
		}
	}
	return best;
}

struct part_list {
	uint32_t *first; /* per outline, PKG_NONE none */
	uint32_t *next;  /* per part */
};

/* What the parts leave of the outline's ground. NULL when that is nothing. */
static GEOSGeometry *rest_of(
	const struct city *city, const struct shaper *shaper, const struct part_list *parts, uint32_t outline)
{
	GEOSContextHandle_t geos = shaper->geos;
	const struct building *building = &city->buildings.items[outline];
	GEOSGeometry *rest = shape_to_geos(shaper, &building->footprint);
	double whole = polygon_area(&building->footprint), left = 0.0;
	for (uint32_t i = parts->first[outline]; rest && i != PKG_NONE; i = parts->next[i]) {
		const struct building *part = &city->buildings.items[i];
		if (part->min_height_m > HOVERING_M)
			continue;
		GEOSGeometry *hole = shape_to_geos(shaper, &part->footprint);
		GEOSGeometry *less = hole ? GEOSDifference_r(geos, rest, hole) : NULL;
		GEOSGeom_destroy_r(geos, hole);
		if (less) {
			GEOSGeom_destroy_r(geos, rest);
			rest = less;
		}
	}
	if (!rest)
		return NULL;
	/* Slivers between parts that nearly touch vanish by opening. */
	GEOSGeometry *thin = GEOSBufferWithStyle_r(geos, rest, -0.4, 1, GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_MITRE, 2.0);
	GEOSGeometry *open =
		thin ? GEOSBufferWithStyle_r(geos, thin, 0.4, 1, GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_MITRE, 2.0) : NULL;
	GEOSGeometry *clean = open ? GEOSIntersection_r(geos, open, rest) : NULL;
	if (clean)
		GEOSArea_r(geos, clean, &left);
	GEOSGeom_destroy_r(geos, thin);
	GEOSGeom_destroy_r(geos, open);
	GEOSGeom_destroy_r(geos, rest);
	if (clean && left > (1.0 - COVERED_SHARE) * whole && left > REST_LEAST_M2)
		return clean;
	GEOSGeom_destroy_r(geos, clean);
	return NULL;
}

/* How high the rest is: up to where the lowest hovering part starts; else, when the outline is no higher than its
 * parts, as high as the lowest of these. 0: as the outline says, or to be inferred. */
static double rest_height(const struct city *city, const struct part_list *parts, uint32_t outline)
{
	double floor_m = INFINITY, lowest = INFINITY, highest = 0.0;
	for (uint32_t i = parts->first[outline]; i != PKG_NONE; i = parts->next[i]) {
		const struct building *part = &city->buildings.items[i];
		if (part->min_height_m > HOVERING_M)
			floor_m = fmin(floor_m, part->min_height_m);
		else if (part->height_m > 0.0)
			lowest = fmin(lowest, part->height_m);
		highest = fmax(highest, part->height_m);
	}
	double own = city->buildings.items[outline].height_m;
	if (isfinite(floor_m))
		return floor_m;
	if (own > highest + 0.5 || !isfinite(lowest))
		return own;
	return lowest;
}

static void push_rest(struct city *city, const struct shaper *shaper, const struct part_list *parts, uint32_t outline)
{
	GEOSGeometry *rest = rest_of(city, shaper, parts, outline);
	if (!rest)
		return;
	polygon_array pieces = { 0 };
	shape_from_geos(shaper, rest, REST_LEAST_M2, &pieces);
	struct building part = city->buildings.items[outline];
	double height = rest_height(city, parts, outline);
	if (height <= part.min_height_m)
		height = part.height_m;
	if (height != part.height_m) {
		part.height_m = height;
		part.levels = 0.0;
		part.roof_height_m = 0.0;
		part.roof_shape = ROOF_UNKNOWN;
	}
	part.is_part = true;
	part.has_parts = false;
	part.outline = outline;
	for (size_t i = 0; i < pieces.count; i++) {
		part.footprint = pieces.items[i];
		ARRAY_PUSH(&city->buildings, part);
	}
	report_fault(city->report, FAULT_PARTS_INCOMPLETE, FAULT_MENDED, part.id);
	ARRAY_FINISH(&pieces);
	GEOSGeom_destroy_r(shaper->geos, rest);
}

/* What a part does not say for itself is as its outline has it. */
static void inherit(struct building *part, const struct building *outline)
{
	if (!part->wall_colour.given)
		part->wall_colour = outline->wall_colour;
	if (part->wall_material == WALL_UNKNOWN)
		part->wall_material = outline->wall_material;
	if (!part->roof_colour.given)
		part->roof_colour = outline->roof_colour;
	if (part->roof_material == ROOFING_UNKNOWN)
		part->roof_material = outline->roof_material;
	if (!part->kind_given) {
		part->kind = outline->kind;
		part->kind_given = outline->kind_given;
	}
	if (part->min_height_m < 1.0)
		part->shop |= outline->shop;
	if (part->start_year <= 0.0)
		part->start_year = outline->start_year;
}

static void assign_parts(struct city *city, const struct shaper *shaper)
{
	size_t count = city->buildings.count;
	bounds_array boxes = { 0 };
	index_array near = { 0 };
	struct box_index index;
	struct part_list parts = { malloc((count + 1) * sizeof(uint32_t)), malloc((count + 1) * sizeof(uint32_t)) };
	if (!parts.first || !parts.next)
		abort();
	memset(parts.first, 0xFF, (count + 1) * sizeof(uint32_t));
	index_buildings(city, &boxes, &index);
	for (size_t i = 0; i < count; i++) {
		struct building *part = &city->buildings.items[i];
		if (!part->is_part)
			continue;
		part->outline = outline_of(city, shaper, &index, i, &near);
		if (part->outline == PKG_NONE) {
			report_fault(city->report, FAULT_PART_WITHOUT_OUTLINE, FAULT_MENDED, part->id);
			continue;
		}
		parts.next[i] = parts.first[part->outline];
		parts.first[part->outline] = (uint32_t)i;
		city->buildings.items[part->outline].has_parts = true;
		inherit(part, &city->buildings.items[part->outline]);
	}
	for (size_t i = 0; i < count; i++) {
		if (city->buildings.items[i].is_part && city->buildings.items[i].outline == PKG_NONE)
			city->buildings.items[i].is_part = false;
		if (city->buildings.items[i].has_parts)
			push_rest(city, shaper, &parts, (uint32_t)i);
	}
	box_index_finish(&index);
	ARRAY_FINISH(&boxes);
	ARRAY_FINISH(&near);
	free(parts.first);
	free(parts.next);
}

void settle_buildings(struct city *city, struct shaper *shaper, size_t preferred_first, id_array *dropped)
{
	for (size_t i = 0; i < city->buildings.count; i++)
		mend_height_order(city, &city->buildings.items[i]);
	drop_duplicates(city, shaper, preferred_first, dropped);
	assign_parts(city, shaper);
}
