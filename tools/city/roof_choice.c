#include "tools/city/roof_choice.h"

#include "platform/base/rng.h"

#define VOTES_NEEDED 25
#define ROW_M 70.0 /* roofs of one kind come in stretches of this length */

static bool between(double value, double low, double high)
{
	return value >= low && value <= high;
}

static struct roof_style style_by_place(struct geo_point at)
{
	double lon = remainder(at.lon_deg, 360.0), lat = at.lat_deg;
	bool europe = between(lat, 35.0, 72.0) && between(lon, -25.0, 45.0);
	bool mansards = between(lat, 42.5, 51.5) && between(lon, -5.0, 8.0); /* France and around it */
	if (europe)
		return (struct roof_style){ 0.14, mansards ? 0.5 : 0.15, true };
	return (struct roof_style){ 0.95, 0.1, false };
}

/* The share that the data shows replaces the region's usual one as votes come in. */
static double corrected(double usual, double seen, double votes)
{
	return votes < VOTES_NEEDED ? usual : (usual * VOTES_NEEDED + seen) / (VOTES_NEEDED + votes);
}

struct roof_style roof_style_of(const struct city *city)
{
	struct roof_style style = style_by_place(city->frame.origin);
	double votes = 0.0, flat = 0.0, mansard = 0.0;
	for (size_t i = 0; i < city->buildings.count; i++) {
		const struct building *building = &city->buildings.items[i];
		bool block = building->kind == BUILDING_APARTMENTS || building->kind == BUILDING_COMMERCIAL;
		if (building->is_part || !block || building->roof_shape == ROOF_UNKNOWN)
			continue;
		votes += 1.0;
		flat += building->roof_shape == ROOF_FLAT;
		mansard += building->roof_shape == ROOF_MANSARD;
	}
	style.flat = corrected(style.flat, flat, votes);
	style.mansard = corrected(style.mansard, mansard, votes - flat);
	/* Mappers give the roofs that are worth it: never let them take all of the others away. */
	style.flat = fmin(fmax(style.flat, 0.05), 0.95);
	return style;
}

static double unit_of(uint64_t key)
{
	return (double)(hash_u64(key) >> 40) / 16777216.0;
}

/* Mostly the row's own value, sometimes the building's. */
static double row_unit(const struct building *building, const struct site *site, uint64_t salt)
{
	uint64_t col = (uint64_t)(int64_t)floor(site->centre.x / ROW_M),
			 row = (uint64_t)(int64_t)floor(site->centre.y / ROW_M);
	uint64_t own = hash_u64((uint64_t)building->id ^ salt);
	if (own % 100 < 35)
		return unit_of(own);
	return unit_of(hash_u64(col * UINT64_C(0x9E3779B97F4A7C15) + row) ^ salt);
}

static enum roof_shape pitched(const struct roof_style *style, const struct building *building, const struct site *site)
{
	double dense = fmin(fmax((site->density - 0.2) / 0.25, 0.0), 1.0);
	double unit = row_unit(building, site, 2);
	bool simple = site->filled > 0.85 && !building->footprint.hole_count;
	if (building->levels >= 4.0 && unit < style->mansard * (0.4 + 0.6 * dense))
		return ROOF_MANSARD;
	if (!simple)
		return ROOF_HIPPED;
	unit = row_unit(building, site, 3);
	if (site->attached) /* ends of rows are party walls */
		return unit < 0.75 ? ROOF_GABLED : ROOF_HIPPED;
	return unit < 0.45 ? ROOF_GABLED : unit < 0.55 ? ROOF_HALF_HIPPED : ROOF_HIPPED;
}

static enum roof_shape choose_block(
	const struct roof_style *style, const struct building *building, const struct site *site)
{
	bool modern = building->start_year >= 1950.0, old = building->start_year > 0.0 && building->start_year < 1930.0;
	bool slab = !site->attached && site->area_m2 > 350.0 && building->levels >= 6.0 && site->density < 0.3;
	double flat = style->flat;
	if (modern || slab)
		flat = fmax(flat, 0.85);
	else if (old)
		flat *= 0.3;
	/* Courtyard infill, deep plans and high-rise have flat roofs nearly everywhere. */
	if (building->levels >= 10.0 || site->span_m > 30.0 || site->area_m2 > 4000.0)
		flat = 1.0;
	else if (!site->fronts_street && site->attached && site->area_m2 < 200.0)
		flat = fmax(flat, 0.6);
	return row_unit(building, site, 1) < flat ? ROOF_FLAT : pitched(style, building, site);
}

static enum roof_shape choose_house(
	const struct roof_style *style, const struct building *building, const struct site *site)
{
	double flat = style->europe ? 0.08 : site->density > 0.3 ? 0.8 : 0.25;
	if (row_unit(building, site, 1) < flat || site->span_m > 25.0)
		return ROOF_FLAT;
	return pitched(style, building, site);
}

enum roof_shape roof_choose(const struct roof_style *style, const struct building *building, const struct site *site)
{
	double unit = unit_of((uint64_t)building->id ^ 7);
	bool church = building->kind == BUILDING_CHURCH || building->kind == BUILDING_TOWER;
	if (building->is_part && !church)
		return ROOF_FLAT;
	switch (building->kind) {
	case BUILDING_HOUSE:
		return choose_house(style, building, site);
	case BUILDING_CHURCH:
		return site->span_m > 40.0 ? ROOF_FLAT : site->filled > 0.8 && !site->attached ? ROOF_GABLED : ROOF_HIPPED;
	case BUILDING_TOWER:
		return building->height_m > 0.0 && building->height_m < 60.0 && site->narrow_m < 12.0 && style->europe
				   ? ROOF_PYRAMIDAL
				   : ROOF_FLAT;
	case BUILDING_GARAGE:
		return unit < 0.7 || site->area_m2 > 60.0 ? ROOF_FLAT : ROOF_GABLED;
	case BUILDING_GREENHOUSE:
		return site->span_m < 16.0 ? ROOF_GABLED : ROOF_FLAT;
	case BUILDING_INDUSTRIAL:
		return site->filled > 0.85 && site->span_m < 30.0 && unit < 0.45 ? ROOF_GABLED : ROOF_FLAT;
	case BUILDING_ROOF:
	case BUILDING_RETAIL:
		return ROOF_FLAT;
	case BUILDING_CIVIC:
		return style->europe && site->span_m < 22.0 && unit > 0.35 ? pitched(style, building, site) : ROOF_FLAT;
	default:
		return choose_block(style, building, site);
	}
}

double roof_height(const struct building *building, enum roof_shape shape, const struct site *site)
{
	double span = site->span_m;
	bool church = building->kind == BUILDING_CHURCH, tower = building->kind == BUILDING_TOWER;
	bool low = building->kind == BUILDING_INDUSTRIAL || building->kind == BUILDING_GREENHOUSE;
	switch (shape) {
	case ROOF_GABLED:
	case ROOF_HIPPED:
	case ROOF_HALF_HIPPED:
		return church ? fmin(fmax(0.5 * span, 2.5), 12.0)
			   : low  ? fmin(0.16 * span, 4.0)
					  : fmin(fmax(0.34 * span, 1.0), 5.5);
	case ROOF_GAMBREL:
		return fmin(fmax(0.42 * span, 1.5), 6.0);
	case ROOF_MANSARD:
		return fmin(fmax(0.3 * span, 2.2), 4.2);
	case ROOF_PYRAMIDAL:
	case ROOF_CONE:
		return tower || church ? fmin(fmax(1.3 * span, 2.0), 25.0) : fmin(fmax(0.4 * span, 1.0), 8.0);
	case ROOF_DOME:
		return 0.5 * span;
	case ROOF_ONION:
		return 1.0 * span;
	case ROOF_SKILLION:
		return fmin(fmax(0.14 * span, 0.4), 4.0);
	case ROOF_ROUND:
		return 0.3 * span;
	case ROOF_FLAT:
	case ROOF_UNKNOWN:
		break;
	}
	return 0.0;
}
