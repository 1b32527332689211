/*
 * Heights, kinds, storeys and roofs that the data does not give. The rule is told in tools/README.md, "Heights"; it
 * depends on nothing but the city, so that the same city always looks the same. Cost: some 0.3 s for 12,000 buildings.
 */
#include <stdlib.h>
#include <string.h>

#include "platform/base/rng.h"
#include "tools/bake/bake.h"
#include "tools/city/roof_choice.h"
#include "tools/city/site.h"

#define NEAR_M 220.0        /* neighbours count up to here */
#define NEAR_SIGMA_M 90.0   /* and less with distance */
#define NEAR_LIMIT 64       /* the nearest of them */
#define EVIDENCE_ENOUGH 1.5 /* sum of weights from which on the neighbours are the source */

struct storey_rule {
	double height_m, ground_extra_m;
};

/* By enum building_kind. */
static const struct storey_rule storey_rules[] = {
	[BUILDING_HOUSE] = { 2.8, 0.3 },
	[BUILDING_APARTMENTS] = { 3.1, 0.6 },
	[BUILDING_COMMERCIAL] = { 3.6, 1.0 },
	[BUILDING_RETAIL] = { 4.0, 0.5 },
	[BUILDING_INDUSTRIAL] = { 4.5, 1.0 },
	[BUILDING_CIVIC] = { 3.8, 0.6 },
	[BUILDING_CHURCH] = { 5.0, 0.0 },
	[BUILDING_TOWER] = { 4.0, 0.0 },
	[BUILDING_GARAGE] = { 2.6, 0.0 },
	[BUILDING_ROOF] = { 4.2, 0.0 },
	[BUILDING_GREENHOUSE] = { 3.0, 0.0 },
};

struct inference {
	struct city *city;
	struct sites sites;
	struct roof_style style;
	bool *known; /* had a height, levels or parts that do */
};

static double unit_of(int64_t id, uint64_t salt)
{
	return (double)(hash_u64((uint64_t)id ^ salt << 56) >> 40) / 16777216.0;
}

static double clamp(double value, double low, double high)
{
	return fmin(fmax(value, low), high);
}

/* 0 in the open, 1 where blocks are closed. */
static double dense(const struct site *site)
{
	return clamp((site->density - 0.12) / 0.33, 0.0, 1.0);
}

static double walls_of_levels(const struct building *building, double levels)
{
	const struct storey_rule *rule = &storey_rules[building->kind];
	return levels * rule->height_m + (levels >= 1.0 ? rule->ground_extra_m : 0.0);
}

static double levels_of_walls(const struct building *building, double walls_m)
{
	const struct storey_rule *rule = &storey_rules[building->kind];
	return fmax(1.0, floor((walls_m - rule->ground_extra_m) / rule->height_m + 0.5));
}

/* Detached houses, terraces, and rows of town houses that are known to be low. `top`: height, 0 not known. */
static bool looks_like_house(const struct site *site, double top)
{
	bool loose =
		site->attached ? site->area_m2 < 130.0 && site->density < 0.2 : site->area_m2 < 320.0 && site->density < 0.27;
	return (loose && top < 11.0) || (site->area_m2 < 240.0 && top > 0.0 && top < 12.5);
}

static void infer_kind(struct building *building, const struct site *site)
{
	double top = building->height_m > 0.0 ? building->height_m : building->levels * 3.1;
	if (building->kind_given)
		return;
	if (building->landmark && site->area_m2 < 200.0)
		building->kind = BUILDING_TOWER; /* monuments */
	else if (site->area_m2 < 32.0 && (top <= 0.0 || top < 5.0))
		building->kind = BUILDING_GARAGE;
	else if (top > 45.0)
		building->kind = BUILDING_COMMERCIAL;
	else if (looks_like_house(site, top))
		building->kind = BUILDING_HOUSE;
	else if (!site->attached && site->area_m2 > 2500.0 && top < 12.0 && site->density < 0.4)
		building->kind = BUILDING_INDUSTRIAL;
	else
		building->kind = BUILDING_APARTMENTS;
}

/* Walls in m, by kind, footprint and surroundings alone. */
static double walls_by_kind(const struct inference *inference, const struct building *building, const struct site *site)
{
	double unit = unit_of(building->id, 1), packed = dense(site), levels = 2.0;
	switch (building->kind) {
	case BUILDING_HOUSE:
		levels = site->area_m2 < 60.0 ? 1.0 : unit < 0.2 ? 3.0 : 2.0;
		break;
	case BUILDING_APARTMENTS:
		if (!site->fronts_street && site->area_m2 < 220.0 && packed > 0.4)
			levels = 1.0 + 2.0 * unit; /* in the courtyard */
		else if (site->attached || site->density > 0.3)
			levels = 3.6 + 3.0 * packed;
		else
			levels = clamp(3.5 + site->area_m2 / 350.0, 4.0, 8.0);
		break;
	case BUILDING_COMMERCIAL:
		levels = (inference->style.europe ? 4.0 : 5.0) + 3.0 * packed + clamp(site->area_m2 / 800.0, 0.0, 3.0);
		break;
	case BUILDING_RETAIL:
		levels = site->attached && packed > 0.5 ? 4.0 : 1.5;
		break;
	case BUILDING_INDUSTRIAL:
		return clamp(5.0 + sqrt(site->area_m2) / 10.0, 4.5, 12.0);
	case BUILDING_CIVIC:
		levels = site->area_m2 < 150.0 ? 1.5 : 3.0 + packed;
		break;
	case BUILDING_CHURCH:
		return clamp(0.75 * site->narrow_m + 2.0, 5.0, 18.0);
	case BUILDING_TOWER:
		return clamp(3.0 * site->narrow_m + 8.0, 12.0, 40.0);
	case BUILDING_GARAGE:
	case BUILDING_ROOF:
	case BUILDING_GREENHOUSE:
		return storey_rules[building->kind].height_m;
	}
	return walls_of_levels(building, levels);
}

/* Kinds that follow their neighbours, and which those are. */
static int height_group(enum building_kind kind)
{
	switch (kind) {
	case BUILDING_APARTMENTS:
	case BUILDING_COMMERCIAL:
		return 1;
	case BUILDING_HOUSE:
		return 2;
	case BUILDING_INDUSTRIAL:
		return 3;
	case BUILDING_GARAGE:
		return 4;
	default:
		return 0;
	}
}

struct sample {
	double height_m, weight;
	uint32_t index;
};

static int by_weight(const void *a, const void *b)
{
	const struct sample *x = a, *y = b;
	if (x->weight != y->weight)
		return x->weight > y->weight ? -1 : 1;
	return x->index < y->index ? -1 : x->index > y->index;
}

static int by_height(const void *a, const void *b)
{
	const struct sample *x = a, *y = b;
	if (x->height_m != y->height_m)
		return x->height_m < y->height_m ? -1 : 1;
	return x->index < y->index ? -1 : x->index > y->index;
}

typedef ARRAY(struct sample) sample_array;

/* Known heights around, of the same group; near ones and ones of like size weigh more. */
static void gather_samples(const struct inference *inference, size_t i, index_array *near, sample_array *out)
{
	const struct building *building = &inference->city->buildings.items[i];
	const struct site *site = &inference->sites.items[i];
	struct bounds here = { site->centre, site->centre };
	out->count = 0;
	box_index_find(&inference->sites.index, bounds_grown(here, NEAR_M), near);
	for (size_t k = 0; k < near->count; k++) {
		uint32_t j = near->items[k];
		const struct building *other = &inference->city->buildings.items[j];
		const struct site *there = &inference->sites.items[j];
		if (j == i || other->is_part || !inference->known[j] || other->landmark ||
			height_group(other->kind) != height_group(building->kind))
			continue;
		double away = dvec2_length(dvec2_sub(there->centre, site->centre)) / NEAR_SIGMA_M;
		double size = fabs(log(fmax(there->area_m2, 1.0) / fmax(site->area_m2, 1.0)));
		double weight = exp(-away * away) / (1.0 + size) * (there->fronts_street == site->fronts_street ? 1.0 : 0.5);
		ARRAY_PUSH(out, (struct sample){ other->height_m - other->roof_height_m, weight, j });
	}
	if (out->count > NEAR_LIMIT) {
		qsort(out->items, out->count, sizeof(struct sample), by_weight);
		out->count = NEAR_LIMIT;
	}
}

/* Weighted median; `evidence` is the sum of the weights. */
static double median_of(sample_array *samples, double *evidence)
{
	*evidence = 0.0;
	for (size_t i = 0; i < samples->count; i++)
		*evidence += samples->items[i].weight;
	if (samples->count)
		qsort(samples->items, samples->count, sizeof(struct sample), by_height);
	double sum = 0.0;
	for (size_t i = 0; i < samples->count; i++) {
		sum += samples->items[i].weight;
		if (2.0 * sum >= *evidence)
			return samples->items[i].height_m;
	}
	return 0.0;
}

/* One storey more or less for a few, by their id: rows are even, not ruled. */
static double varied(const struct building *building, double levels)
{
	double unit = unit_of(building->id, 2);
	if (building->kind != BUILDING_APARTMENTS && building->kind != BUILDING_COMMERCIAL)
		return levels;
	return levels + (unit < 0.14 ? -1.0 : unit > 0.86 ? 1.0 : 0.0);
}

static void infer_walls(struct inference *inference, size_t i, index_array *near, sample_array *samples)
{
	struct building *building = &inference->city->buildings.items[i];
	const struct site *site = &inference->sites.items[i];
	double walls = walls_by_kind(inference, building, site), evidence = 0.0;
	building->height_source = HEIGHT_KIND;
	bool courtyard = !site->fronts_street && site->area_m2 < 220.0 && dense(site) > 0.4;
	if (height_group(building->kind) && !courtyard) {
		gather_samples(inference, i, near, samples);
		double seen = median_of(samples, &evidence);
		walls = (walls + 2.0 * evidence * seen) / (1.0 + 2.0 * evidence);
		if (evidence >= EVIDENCE_ENOUGH)
			building->height_source = HEIGHT_NEIGHBOURS;
	}
	bool storeyed = building->kind <= BUILDING_CIVIC && building->kind != BUILDING_INDUSTRIAL;
	building->levels = storeyed ? fmax(1.0, varied(building, levels_of_walls(building, walls))) : 1.0;
	building->height_m = storeyed ? walls_of_levels(building, building->levels) : walls;
	/* Centimetres of difference between neighbours: eaves of a row are not one line. */
	building->height_m += storeyed && building->levels > 1.0 ? 0.5 * unit_of(building->id, 3) : 0.0;
	report_fault(inference->city->report, FAULT_MISSING_HEIGHT, FAULT_MENDED, building->id);
}

/* Shape, height of the roof, and storeys below it. `walls_only`: height_m does not have the roof in it yet. */
static void finish_roof(struct inference *inference, size_t i, bool walls_only)
{
	struct building *building = &inference->city->buildings.items[i];
	const struct site *site = &inference->sites.items[i];
	bool given = building->roof_shape != ROOF_UNKNOWN;
	if (!given)
		building->roof_shape = building->roof_height_m > 0.5 && !building->is_part
								   ? ROOF_HIPPED
								   : roof_choose(&inference->style, building, site);
	if (building->roof_shape == ROOF_FLAT)
		building->roof_height_m = 0.0;
	else if (building->roof_height_m <= 0.0)
		building->roof_height_m = roof_height(building, building->roof_shape, site);
	if (walls_only)
		building->height_m = fmax(building->height_m, building->min_height_m + 2.5);
	double body = building->height_m - building->min_height_m;
	if (walls_only) {
		building->height_m += building->roof_height_m;
	} else if (building->roof_shape == ROOF_DOME || building->roof_shape == ROOF_ONION || building->is_part) {
		building->roof_height_m = fmin(building->roof_height_m, body);
	} else if (building->roof_height_m > 0.45 * body) {
		/* A roof that the data does not give leaves room for a storey, or is none. */
		building->roof_height_m = fmin(building->roof_height_m, 0.45 * body);
		if (!given && building->roof_height_m < 0.6) {
			building->roof_shape = ROOF_FLAT;
			building->roof_height_m = 0.0;
		}
	}
	if (building->levels <= 0.0)
		building->levels = levels_of_walls(building, building->height_m - building->roof_height_m);
}

static void start_known(struct inference *inference, size_t i)
{
	struct building *building = &inference->city->buildings.items[i];
	if (building->height_m > 0.0) {
		inference->known[i] = true;
		building->height_source = HEIGHT_TAGGED;
		if (building->eaves_height && building->levels <= 0.0)
			building->levels = levels_of_walls(building, building->height_m);
		finish_roof(inference, i, building->eaves_height);
		building->eaves_height = false;
	} else if (building->levels > 0.0) {
		inference->known[i] = true;
		building->height_source = HEIGHT_LEVELS;
		building->height_m = fmax(walls_of_levels(building, building->levels), building->min_height_m + 2.5);
		finish_roof(inference, i, true);
	}
}

/* An outline without a height of its own is as high as the highest of its parts that has one. */
static void heights_from_parts(struct inference *inference)
{
	struct city *city = inference->city;
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct building *part = &city->buildings.items[i];
		if (!part->is_part || part->outline == PKG_NONE || !inference->known[i])
			continue;
		struct building *outline = &city->buildings.items[part->outline];
		bool taken = inference->known[part->outline] && outline->height_source != HEIGHT_PARTS;
		if (taken || part->height_m <= outline->height_m)
			continue;
		inference->known[part->outline] = true;
		outline->height_source = HEIGHT_PARTS;
		outline->height_m = part->height_m;
		outline->min_height_m = 0.0;
		outline->roof_shape = outline->roof_shape == ROOF_UNKNOWN ? ROOF_FLAT : outline->roof_shape;
		outline->levels = levels_of_walls(outline, part->height_m);
	}
}

/* Parts that say nothing go up to where their outline does. */
static void heights_of_parts(struct inference *inference)
{
	struct city *city = inference->city;
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct building *part = &city->buildings.items[i];
		if (!part->is_part || inference->known[i])
			continue;
		const struct building *outline = part->outline == PKG_NONE ? NULL : &city->buildings.items[part->outline];
		part->height_m = fmax(outline ? outline->height_m : 9.0, part->min_height_m + 3.0);
		part->height_source = outline ? outline->height_source : HEIGHT_KIND;
		report_fault(city->report, FAULT_MISSING_HEIGHT, FAULT_MENDED, part->id);
		finish_roof(inference, i, false);
	}
}

static void mark_landmarks(struct inference *inference, index_array *near)
{
	struct city *city = inference->city;
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct building *building = &city->buildings.items[i];
		if (building->kind == BUILDING_TOWER && building->height_m < 15.0)
			building->landmark = false; /* tanks and silos */
		if (building->is_part || building->height_m < 35.0)
			continue;
		size_t higher = 0, others = 0;
		box_index_find(&inference->sites.index, bounds_grown(inference->sites.boxes.items[i], 250.0), near);
		for (size_t k = 0; k < near->count; k++) {
			const struct building *other = &city->buildings.items[near->items[k]];
			if (other->is_part || near->items[k] == i)
				continue;
			others++;
			higher += other->height_m > 0.55 * building->height_m;
		}
		building->landmark |= higher * 40 < others || !others;
	}
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct building *part = &city->buildings.items[i];
		if (part->is_part && part->outline != PKG_NONE)
			part->landmark = city->buildings.items[part->outline].landmark;
	}
}

/* Where the data has no shops, the ground floors of main and pedestrian streets in dense places have them. */
static void mark_shops(struct inference *inference)
{
	struct city *city = inference->city;
	size_t shops = 0;
	for (size_t i = 0; i < city->buildings.count; i++)
		shops += city->buildings.items[i].shop;
	bool mapped = shops * 50 > city->buildings.count;
	for (size_t i = 0; i < city->buildings.count; i++) {
		struct building *building = &city->buildings.items[i];
		const struct site *site = &inference->sites.items[i];
		int class = site->street_class;
		bool main_street = class == PKG_STREET_PRIMARY || class == PKG_STREET_SECONDARY ||
						   class == PKG_STREET_TERTIARY || class == WAY_PEDESTRIAN;
		bool fits = building->kind == BUILDING_APARTMENTS || building->kind == BUILDING_COMMERCIAL;
		if (!mapped && fits && main_street && site->fronts_street && site->density > 0.28 &&
			building->min_height_m < 1.0)
			building->shop |= unit_of(building->id, 4) < 0.7;
	}
}

void heights_infer(struct city *city)
{
	struct inference inference = { .city = city };
	index_array near = { 0 };
	sample_array samples = { 0 };
	size_t count = city->buildings.count;
	inference.known = calloc(count + 1, sizeof(bool));
	if (!inference.known)
		abort();
	sites_build(&inference.sites, city);
	inference.style = roof_style_of(city);
	for (size_t i = 0; i < count; i++)
		infer_kind(&city->buildings.items[i], &inference.sites.items[i]);
	for (size_t i = 0; i < count; i++)
		start_known(&inference, i);
	heights_from_parts(&inference);
	for (size_t i = 0; i < count; i++) {
		if (city->buildings.items[i].is_part || inference.known[i])
			continue;
		infer_walls(&inference, i, &near, &samples);
		finish_roof(&inference, i, true);
	}
	heights_of_parts(&inference);
	mark_landmarks(&inference, &near);
	mark_shops(&inference);
	for (size_t i = 0; i < count; i++)
		city->report->heights[city->buildings.items[i].height_source]++;
	sites_finish(&inference.sites);
	ARRAY_FINISH(&near);
	ARRAY_FINISH(&samples);
	free(inference.known);
}
