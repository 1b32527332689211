/*
 * What a building wears. Kind, height, age and data decide the family; the id's hash picks within it; the block's hash
 * picks the few colours that its houses share, so that a street hangs together without being uniform. Where a city
 * lies decides which families are common at all.
 */
#include "tools/bake/buildings.h"

#include <math.h>

#include "platform/base/rng.h"

enum region { REGION_CENTRAL, REGION_SOUTH, REGION_PARIS, REGION_BRITAIN, REGION_AMERICA };

static enum region region_of(const struct geo_point at)
{
	if (at.lon_deg < -30.0)
		return REGION_AMERICA;
	if (at.lat_deg > 49.5 && at.lon_deg < 1.8 && at.lon_deg > -11.0)
		return REGION_BRITAIN;
	if (at.lat_deg > 48.6 && at.lat_deg < 49.1 && at.lon_deg > 2.0 && at.lon_deg < 2.8)
		return REGION_PARIS;
	return at.lat_deg < 44.8 ? REGION_SOUTH : REGION_CENTRAL;
}

#define PALETTE 8
static const uint8_t plasters[][PALETTE][3] = {
	[REGION_CENTRAL] = { { 236, 229, 214 }, { 226, 219, 204 }, { 233, 221, 194 }, { 219, 211, 200 }, { 240, 236, 228 },
		{ 224, 206, 180 }, { 214, 212, 206 }, { 230, 212, 198 } },
	[REGION_SOUTH] = { { 232, 213, 182 }, { 224, 200, 170 }, { 236, 222, 196 }, { 216, 190, 166 }, { 238, 229, 212 },
		{ 226, 204, 186 }, { 222, 208, 184 }, { 210, 184, 160 } },
	[REGION_PARIS] = { { 232, 222, 200 }, { 226, 215, 193 }, { 238, 230, 212 }, { 220, 209, 188 }, { 230, 224, 208 },
		{ 216, 206, 188 }, { 240, 234, 220 }, { 224, 212, 186 } },
	[REGION_BRITAIN] = { { 232, 228, 218 }, { 238, 236, 230 }, { 222, 216, 204 }, { 212, 206, 196 }, { 230, 220, 200 },
		{ 226, 226, 222 }, { 216, 208, 192 }, { 236, 230, 214 } },
	[REGION_AMERICA] = { { 226, 222, 212 }, { 208, 206, 198 }, { 232, 224, 204 }, { 204, 212, 214 }, { 236, 232, 226 },
		{ 220, 208, 190 }, { 210, 200, 186 }, { 218, 212, 196 } },
};
static const uint8_t timbers[PALETTE][3] = { { 232, 230, 224 }, { 206, 214, 216 }, { 226, 218, 196 }, { 196, 204, 196 },
	{ 214, 200, 188 }, { 236, 226, 206 }, { 188, 198, 208 }, { 222, 206, 198 } };
static const uint8_t bricks[PALETTE][3] = { { 184, 146, 126 }, { 174, 134, 118 }, { 194, 160, 136 }, { 178, 146, 126 },
	{ 202, 180, 150 }, { 166, 130, 116 }, { 188, 152, 136 }, { 206, 188, 160 } };
static const uint8_t stones[PALETTE][3] = { { 222, 212, 192 }, { 214, 206, 190 }, { 228, 220, 204 }, { 206, 198, 182 },
	{ 218, 210, 198 }, { 226, 214, 188 }, { 210, 206, 198 }, { 200, 192, 178 } };
static const uint8_t concretes[PALETTE][3] = { { 208, 206, 200 }, { 216, 214, 210 }, { 200, 198, 192 },
	{ 222, 218, 210 }, { 206, 204, 204 }, { 214, 208, 198 }, { 194, 194, 192 }, { 226, 224, 220 } };
static const uint8_t metals[PALETTE][3] = { { 206, 210, 214 }, { 190, 198, 206 }, { 214, 214, 210 }, { 180, 190, 198 },
	{ 200, 206, 200 }, { 218, 220, 222 }, { 196, 196, 192 }, { 186, 194, 190 } };

static const uint8_t clays[6][3] = { { 180, 140, 120 }, { 170, 132, 116 }, { 188, 150, 128 }, { 164, 130, 116 },
	{ 178, 146, 126 }, { 158, 128, 114 } };
static const uint8_t slates[4][3] = { { 112, 118, 126 }, { 122, 126, 132 }, { 104, 108, 116 }, { 130, 132, 136 } };
static const uint8_t zincs[4][3] = { { 148, 156, 164 }, { 158, 164, 170 }, { 138, 146, 156 }, { 164, 168, 172 } };

static void set_rgb(uint8_t out[3], const uint8_t from[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = from[i];
}

static uint8_t scaled(double value)
{
	return (uint8_t)lrint(fmin(fmax(value, 0.0), 255.0));
}

static void shade_rgb(uint8_t rgb[3], double light)
{
	for (int i = 0; i < 3; i++)
		rgb[i] = scaled(rgb[i] * light);
}

/* Pulls a colour from the data towards what a calm picture bears. */
static void calm_rgb(uint8_t rgb[3], double low, double high)
{
	double mean = (rgb[0] + rgb[1] + rgb[2]) / 3.0, wanted = fmin(fmax(mean, low), high);
	for (int i = 0; i < 3; i++)
		rgb[i] = scaled(wanted + (rgb[i] - mean) * 0.75);
}

struct pick {
	uint64_t bits;
};

static unsigned pick_one(struct pick *pick, unsigned count)
{
	unsigned out = (unsigned)(pick->bits % count);
	pick->bits = hash_u64(pick->bits + 0x51ED27);
	return out;
}

static bool pick_chance(struct pick *pick, unsigned percent)
{
	return pick_one(pick, 100) < percent;
}

/* Three of the palette's colours for a block, and half a step of lightness for each house. */
static void pick_colour(const struct massing *m, struct pick *pick, const uint8_t palette[PALETTE][3], uint8_t out[3])
{
	uint64_t block = hash_u64((m->building->face != PKG_NONE ? m->building->face : (uint64_t)m->building->id) + 77);
	unsigned slot = (unsigned)(block >> 8 * pick_one(pick, 3)) % PALETTE;
	if (pick_chance(pick, 18))
		slot = pick_one(pick, PALETTE);
	set_rgb(out, palette[slot]);
	shade_rgb(out, 0.96 + 0.01 * pick_one(pick, 9));
}

static const uint8_t (*palette_of(enum wall_material material, enum region region))[3]
{
	switch (material) {
	case WALL_BRICK:
		return bricks;
	case WALL_STONE:
		return stones;
	case WALL_CONCRETE:
		return concretes;
	case WALL_METAL:
	case WALL_GLASS:
		return metals;
	case WALL_WOOD:
		return timbers;
	case WALL_PLASTER:
	case WALL_UNKNOWN:
		break;
	}
	return plasters[region];
}

static int blank_of(enum wall_material material)
{
	static const int blanks[] = { [WALL_UNKNOWN] = MATERIAL_BLANK_PLASTER,
		[WALL_PLASTER] = MATERIAL_BLANK_PLASTER,
		[WALL_BRICK] = MATERIAL_BLANK_BRICK,
		[WALL_STONE] = MATERIAL_BLANK_STONE,
		[WALL_CONCRETE] = MATERIAL_BLANK_CONCRETE,
		[WALL_GLASS] = MATERIAL_BLANK_CONCRETE,
		[WALL_METAL] = MATERIAL_BLANK_METAL,
		[WALL_WOOD] = MATERIAL_BLANK_BOARDS };
	return blanks[material];
}

struct wear {
	uint8_t upper, ground, door;
	double bay_m, storey_m, ground_ratio;
	enum wall_material material;
	bool cornice;
	uint8_t weight[5]; /* by enum region; 0: not there */
};

/* Flats and town houses up to some seven storeys. */
static const struct wear town[] = {
	{ MATERIAL_WALL_TALL, MATERIAL_GROUND_RUSTIC, MATERIAL_DOOR_PORTAL, 2.7, 3.3, 1.15, WALL_PLASTER, true,
		{ 24, 18, 10, 14, 4 } },
	{ MATERIAL_WALL_SHUTTER_GREEN, MATERIAL_GROUND_PLASTER, MATERIAL_DOOR_PANEL, 3.0, 3.1, 1.1, WALL_PLASTER, false,
		{ 7, 18, 0, 0, 0 } },
	{ MATERIAL_WALL_SHUTTER_GREY, MATERIAL_GROUND_RUSTIC, MATERIAL_DOOR_PORTAL, 2.9, 3.1, 1.15, WALL_PLASTER, true,
		{ 20, 8, 12, 0, 0 } },
	{ MATERIAL_WALL_SHUTTER_BROWN, MATERIAL_GROUND_PLASTER, MATERIAL_DOOR_PANEL, 3.0, 3.1, 1.1, WALL_PLASTER, false,
		{ 8, 20, 0, 0, 0 } },
	{ MATERIAL_WALL_FRENCH, MATERIAL_GROUND_RUSTIC, MATERIAL_DOOR_PORTAL, 2.8, 3.1, 1.15, WALL_PLASTER, true,
		{ 12, 8, 22, 3, 0 } },
	{ MATERIAL_WALL_ASHLAR, MATERIAL_GROUND_RUSTIC, MATERIAL_DOOR_PORTAL, 2.6, 3.2, 1.2, WALL_STONE, true,
		{ 12, 3, 40, 8, 5 } },
	{ MATERIAL_WALL_PEDIMENT, MATERIAL_GROUND_RUSTIC, MATERIAL_DOOR_PORTAL, 3.0, 3.5, 1.2, WALL_PLASTER, true,
		{ 6, 18, 4, 3, 4 } },
	{ MATERIAL_WALL_PAIR, MATERIAL_GROUND_PLASTER, MATERIAL_DOOR_PANEL, 3.3, 3.1, 1.1, WALL_PLASTER, true,
		{ 5, 5, 4, 3, 6 } },
	{ MATERIAL_WALL_WIDE, MATERIAL_GROUND_MODERN, MATERIAL_DOOR_GLASS, 3.5, 2.85, 1.1, WALL_PLASTER, false,
		{ 7, 4, 5, 3, 6 } },
	{ MATERIAL_WALL_BALCONY, MATERIAL_GROUND_MODERN, MATERIAL_DOOR_GLASS, 3.9, 2.9, 1.1, WALL_PLASTER, false,
		{ 5, 4, 3, 2, 4 } },
	{ MATERIAL_WALL_BRICK_SASH, MATERIAL_GROUND_BRICK, MATERIAL_DOOR_BRICK, 2.7, 3.1, 1.1, WALL_BRICK, true,
		{ 0, 0, 4, 50, 14 } },
	{ MATERIAL_WALL_BRICK_WIDE, MATERIAL_GROUND_BRICK, MATERIAL_DOOR_BRICK, 3.3, 3.2, 1.15, WALL_BRICK, true,
		{ 0, 0, 3, 12, 14 } },
	{ MATERIAL_WALL_BAY, MATERIAL_GROUND_BOARDS, MATERIAL_DOOR_BOARDS, 3.2, 3.0, 1.05, WALL_WOOD, true,
		{ 0, 0, 0, 0, 24 } },
	{ MATERIAL_WALL_BOARDS, MATERIAL_GROUND_BOARDS, MATERIAL_DOOR_BOARDS, 2.9, 3.0, 1.05, WALL_WOOD, true,
		{ 0, 0, 0, 0, 18 } },
};
static const struct wear houses[] = {
	{ MATERIAL_WALL_VILLA, MATERIAL_GROUND_PLASTER, MATERIAL_DOOR_PANEL, 3.3, 2.8, 1.0, WALL_PLASTER, false,
		{ 30, 22, 20, 10, 12 } },
	{ MATERIAL_WALL_SHUTTER_GREY, MATERIAL_GROUND_PLASTER, MATERIAL_DOOR_PANEL, 3.1, 2.8, 1.0, WALL_PLASTER, false,
		{ 22, 8, 20, 0, 0 } },
	{ MATERIAL_WALL_SHUTTER_GREEN, MATERIAL_GROUND_PLASTER, MATERIAL_DOOR_PANEL, 3.1, 2.8, 1.0, WALL_PLASTER, false,
		{ 18, 24, 10, 0, 0 } },
	{ MATERIAL_WALL_SHUTTER_BROWN, MATERIAL_GROUND_PLASTER, MATERIAL_DOOR_PANEL, 3.1, 2.8, 1.0, WALL_PLASTER, false,
		{ 14, 24, 6, 0, 0 } },
	{ MATERIAL_WALL_SMALL, MATERIAL_GROUND_PLASTER, MATERIAL_DOOR_PANEL, 3.4, 2.7, 1.0, WALL_PLASTER, false,
		{ 14, 14, 10, 8, 8 } },
	{ MATERIAL_WALL_BRICK_SASH, MATERIAL_GROUND_BRICK, MATERIAL_DOOR_BRICK, 2.8, 2.9, 1.05, WALL_BRICK, false,
		{ 0, 0, 6, 60, 8 } },
	{ MATERIAL_WALL_BOARDS, MATERIAL_GROUND_BOARDS, MATERIAL_DOOR_BOARDS, 2.9, 2.9, 1.05, WALL_WOOD, false,
		{ 0, 0, 0, 0, 36 } },
	{ MATERIAL_WALL_BAY, MATERIAL_GROUND_BOARDS, MATERIAL_DOOR_BOARDS, 3.2, 2.9, 1.05, WALL_WOOD, false,
		{ 0, 0, 0, 0, 40 } },
};
static const struct wear offices[] = {
	{ MATERIAL_WALL_STRIP, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 3.0, 3.4, 1.2, WALL_CONCRETE, false,
		{ 22, 20, 16, 16, 16 } },
	{ MATERIAL_WALL_GRID, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 3.1, 3.3, 1.2, WALL_CONCRETE, false,
		{ 20, 18, 14, 14, 20 } },
	{ MATERIAL_WALL_CURTAIN_BLUE, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 3.0, 3.6, 1.25, WALL_GLASS, false,
		{ 10, 8, 8, 10, 12 } },
	{ MATERIAL_WALL_CURTAIN_GREY, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 3.0, 3.5, 1.25, WALL_GLASS, false,
		{ 12, 8, 10, 12, 10 } },
	{ MATERIAL_WALL_ASHLAR, MATERIAL_GROUND_RUSTIC, MATERIAL_DOOR_PORTAL, 2.7, 3.4, 1.25, WALL_STONE, true,
		{ 20, 14, 36, 16, 10 } },
	{ MATERIAL_WALL_PEDIMENT, MATERIAL_GROUND_RUSTIC, MATERIAL_DOOR_PORTAL, 3.1, 3.6, 1.2, WALL_STONE, true,
		{ 10, 22, 8, 6, 4 } },
	{ MATERIAL_WALL_PIER, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 2.7, 3.6, 1.3, WALL_STONE, true,
		{ 4, 4, 4, 8, 20 } },
	{ MATERIAL_WALL_BRICK_WIDE, MATERIAL_GROUND_BRICK, MATERIAL_DOOR_GLASS, 3.3, 3.4, 1.2, WALL_BRICK, true,
		{ 0, 2, 4, 18, 14 } },
};
static const struct wear towers[] = {
	{ MATERIAL_WALL_CURTAIN_BLUE, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 3.0, 3.7, 1.4, WALL_GLASS, false,
		{ 22, 20, 20, 24, 22 } },
	{ MATERIAL_WALL_CURTAIN_GREY, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 3.0, 3.6, 1.4, WALL_GLASS, false,
		{ 20, 18, 18, 20, 18 } },
	{ MATERIAL_WALL_CURTAIN_DARK, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 3.0, 3.6, 1.4, WALL_GLASS, false,
		{ 12, 10, 10, 12, 14 } },
	{ MATERIAL_WALL_PIER, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 2.7, 3.7, 1.4, WALL_STONE, false,
		{ 10, 10, 10, 10, 26 } },
	{ MATERIAL_WALL_GRID, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 3.2, 3.4, 1.3, WALL_CONCRETE, false,
		{ 22, 26, 24, 18, 14 } },
	{ MATERIAL_WALL_STRIP, MATERIAL_GROUND_LOBBY, MATERIAL_DOOR_GLASS, 3.0, 3.5, 1.3, WALL_CONCRETE, false,
		{ 14, 16, 18, 16, 10 } },
};
static const struct wear flats_high[] = {
	{ MATERIAL_WALL_BALCONY, MATERIAL_GROUND_MODERN, MATERIAL_DOOR_GLASS, 3.9, 2.9, 1.2, WALL_CONCRETE, false,
		{ 36, 36, 30, 30, 26 } },
	{ MATERIAL_WALL_WIDE, MATERIAL_GROUND_MODERN, MATERIAL_DOOR_GLASS, 3.5, 2.85, 1.2, WALL_PLASTER, false,
		{ 34, 34, 36, 24, 24 } },
	{ MATERIAL_WALL_GRID, MATERIAL_GROUND_MODERN, MATERIAL_DOOR_GLASS, 3.2, 3.0, 1.2, WALL_CONCRETE, false,
		{ 20, 20, 24, 20, 24 } },
	{ MATERIAL_WALL_BRICK_WIDE, MATERIAL_GROUND_BRICK, MATERIAL_DOOR_GLASS, 3.4, 3.0, 1.2, WALL_BRICK, false,
		{ 4, 4, 6, 26, 20 } },
};
static const struct wear civic[] = {
	{ MATERIAL_WALL_CIVIC, MATERIAL_GROUND_RUSTIC, MATERIAL_DOOR_PORTAL, 3.3, 3.9, 1.1, WALL_STONE, true,
		{ 36, 40, 50, 26, 24 } },
	{ MATERIAL_WALL_PEDIMENT, MATERIAL_GROUND_RUSTIC, MATERIAL_DOOR_PORTAL, 3.2, 3.8, 1.1, WALL_PLASTER, true,
		{ 20, 30, 16, 14, 10 } },
	{ MATERIAL_WALL_SCHOOL, MATERIAL_GROUND_MODERN, MATERIAL_DOOR_GLASS, 3.4, 3.5, 1.1, WALL_PLASTER, false,
		{ 30, 22, 20, 20, 30 } },
	{ MATERIAL_WALL_BRICK_WIDE, MATERIAL_GROUND_BRICK, MATERIAL_DOOR_BRICK, 3.3, 3.6, 1.1, WALL_BRICK, true,
		{ 2, 2, 8, 36, 20 } },
};

static bool suits(const struct wear *wear, const struct massing *m)
{
	enum wall_material wanted = m->building->wall_material;
	if (wanted != WALL_UNKNOWN && wanted != wear->material)
		return false;
	double year = m->building->start_year;
	bool modern = wear->material == WALL_GLASS || wear->material == WALL_CONCRETE || wear->door == MATERIAL_DOOR_GLASS;
	return year <= 0.0 || (modern ? year >= 1930.0 : year <= 1965.0 || wear->material == WALL_BRICK);
}

static const struct wear *pick_wear(
	const struct massing *m, struct pick *pick, enum region region, const struct wear *list, size_t count)
{
	for (int strict = 1; strict >= 0; strict--) {
		unsigned total = 0;
		for (size_t i = 0; i < count; i++)
			total += !strict || suits(&list[i], m) ? list[i].weight[region] : 0;
		if (total == 0)
			continue;
		unsigned chosen = pick_one(pick, total);
		for (size_t i = 0; i < count; i++) {
			unsigned weight = !strict || suits(&list[i], m) ? list[i].weight[region] : 0;
			if (chosen < weight)
				return &list[i];
			chosen -= weight;
		}
	}
	return &list[0];
}

#define PICK_WEAR(list) pick_wear(m, pick, region, list, sizeof(list) / sizeof((list)[0]))

static const struct wear *wear_of(const struct massing *m, struct pick *pick, enum region region)
{
	double height = m->top - m->ground;
	bool glass = m->building->wall_material == WALL_GLASS;
	switch (m->building->kind) {
	case BUILDING_HOUSE:
		return height > 13.0 ? PICK_WEAR(town) : PICK_WEAR(houses);
	case BUILDING_COMMERCIAL:
	case BUILDING_RETAIL:
		if (height > 45.0 || glass)
			return PICK_WEAR(towers);
		/* Shops below flats are the rule in a centre; offices stand among them. */
		return m->building->kind == BUILDING_RETAIL && height > 9.0 ? PICK_WEAR(town) : PICK_WEAR(offices);
	case BUILDING_CIVIC:
		return height > 40.0 ? PICK_WEAR(towers) : PICK_WEAR(civic);
	case BUILDING_APARTMENTS:
		break;
	default:
		return &houses[4];
	}
	if (height > 75.0 || glass)
		return PICK_WEAR(towers);
	return height > 27.0 ? PICK_WEAR(flats_high) : PICK_WEAR(town);
}

static void wear_town(struct massing *m, struct pick *pick, enum region region)
{
	struct facade *f = &m->facade;
	const struct wear *wear = wear_of(m, pick, region);
	f->upper = wear->upper;
	f->ground = wear->ground;
	f->door = wear->door;
	f->bay_m = wear->bay_m * (0.94 + 0.02 * pick_one(pick, 8));
	f->storey_m = wear->storey_m;
	f->ground_ratio = wear->ground_ratio;
	f->cornice = wear->cornice;
	enum wall_material material = m->building->wall_material ? m->building->wall_material : wear->material;
	f->blank = (uint8_t)blank_of(wear->material);
	pick_colour(m, pick, palette_of(material, region), f->wall_rgb);
}

static void wear_plain(struct massing *m, struct pick *pick, enum region region, enum wall_material usual)
{
	struct facade *f = &m->facade;
	enum wall_material material = m->building->wall_material ? m->building->wall_material : usual;
	f->blank = f->upper = f->ground = (uint8_t)blank_of(material);
	f->storey_m = 3.2;
	f->bay_m = 3.0;
	f->ground_ratio = 1.0;
	pick_colour(m, pick, palette_of(material, region), f->wall_rgb);
}

static void wear_by_kind(struct massing *m, struct pick *pick, enum region region)
{
	struct facade *f = &m->facade;
	switch (m->building->kind) {
	case BUILDING_INDUSTRIAL:
		wear_plain(m, pick, region, WALL_METAL);
		f->upper = f->ground = MATERIAL_WALL_INDUSTRIAL;
		f->gate = MATERIAL_GATE_INDUSTRIAL;
		f->bay_m = 4.8;
		f->storey_m = 4.5;
		break;
	case BUILDING_CHURCH:
		wear_plain(m, pick, region, WALL_STONE);
		f->upper = f->ground = MATERIAL_WALL_CHURCH;
		f->door = MATERIAL_DOOR_CHURCH;
		f->bay_m = 4.5;
		break;
	case BUILDING_TOWER:
		wear_plain(m, pick, region, WALL_STONE);
		break;
	case BUILDING_GARAGE:
	case BUILDING_ROOF:
		wear_plain(m, pick, region, WALL_PLASTER);
		f->gate = MATERIAL_GATE_GARAGE;
		break;
	case BUILDING_GREENHOUSE:
		wear_plain(m, pick, region, WALL_GLASS);
		f->upper = f->ground = f->blank = MATERIAL_WALL_GREENHOUSE;
		break;
	default:
		wear_town(m, pick, region);
	}
}

static int usual_roofing(const struct massing *m, struct pick *pick, enum region region)
{
	enum roof_shape shape = m->plot->roof;
	if (m->building->kind == BUILDING_GREENHOUSE)
		return MATERIAL_ROOF_GLASS;
	if (shape == ROOF_FLAT || shape == ROOF_UNKNOWN)
		return pick_chance(pick, 70) ? MATERIAL_ROOF_GRAVEL : MATERIAL_ROOF_CONCRETE;
	if (shape == ROOF_DOME || shape == ROOF_ONION)
		return pick_chance(pick, 60) ? MATERIAL_ROOF_COPPER : MATERIAL_ROOF_METAL;
	if (m->building->kind == BUILDING_INDUSTRIAL || shape == ROOF_ROUND)
		return MATERIAL_ROOF_METAL;
	if (shape == ROOF_MANSARD || region == REGION_PARIS)
		return pick_chance(pick, region == REGION_PARIS ? 30 : 60) ? MATERIAL_ROOF_SLATE : MATERIAL_ROOF_METAL;
	if (region == REGION_AMERICA || region == REGION_BRITAIN)
		return pick_chance(pick, 70) ? MATERIAL_ROOF_SLATE : MATERIAL_ROOF_TILES;
	if (m->building->kind == BUILDING_CHURCH && region == REGION_CENTRAL)
		return pick_chance(pick, 50) ? MATERIAL_ROOF_SLATE : MATERIAL_ROOF_TILES;
	return pick_chance(pick, region == REGION_SOUTH ? 96 : 86) ? MATERIAL_ROOF_TILES : MATERIAL_ROOF_SLATE;
}

static void choose_roofing(struct massing *m, struct pick *pick, enum region region)
{
	static const int given[] = { [ROOFING_TILES] = MATERIAL_ROOF_TILES,
		[ROOFING_SLATE] = MATERIAL_ROOF_SLATE,
		[ROOFING_METAL] = MATERIAL_ROOF_METAL,
		[ROOFING_COPPER] = MATERIAL_ROOF_COPPER,
		[ROOFING_GRAVEL] = MATERIAL_ROOF_GRAVEL,
		[ROOFING_CONCRETE] = MATERIAL_ROOF_CONCRETE,
		[ROOFING_GLASS] = MATERIAL_ROOF_GLASS,
		[ROOFING_GRASS] = MATERIAL_ROOF_GRASS };
	static const uint8_t copper[3] = { 126, 164, 148 }, gravel[3] = { 176, 174, 168 }, concrete[3] = { 188, 186, 182 },
						 glass[3] = { 236, 240, 242 }, grass[3] = { 132, 154, 104 };
	struct facade *f = &m->facade;
	int usual = usual_roofing(m, pick, region);
	f->roofing = (uint8_t)(m->building->roof_material ? given[m->building->roof_material] : usual);
	unsigned at = pick_one(pick, 12);
	const uint8_t *rgb = gravel;
	switch (f->roofing) {
	case MATERIAL_ROOF_TILES:
		rgb = clays[at % 6];
		break;
	case MATERIAL_ROOF_SLATE:
		rgb = slates[at % 4];
		break;
	case MATERIAL_ROOF_METAL:
		rgb = zincs[at % 4];
		break;
	case MATERIAL_ROOF_COPPER:
		rgb = copper;
		break;
	case MATERIAL_ROOF_CONCRETE:
		rgb = concrete;
		break;
	case MATERIAL_ROOF_GLASS:
		rgb = glass;
		break;
	case MATERIAL_ROOF_GRASS:
		rgb = grass;
		break;
	}
	set_rgb(f->roof_rgb, rgb);
	shade_rgb(f->roof_rgb, 0.96 + 0.02 * (at % 5));
	if (m->building->roof_colour.given) {
		set_rgb(f->roof_rgb, m->building->roof_colour.rgb);
		calm_rgb(f->roof_rgb, 70.0, 225.0);
	}
}

static double usual_overhang(const struct massing *m)
{
	switch (m->building->kind) {
	case BUILDING_HOUSE:
		return m->top - m->ground > 11.0 ? 0.4 : 0.55;
	case BUILDING_APARTMENTS:
	case BUILDING_RETAIL:
	case BUILDING_CIVIC:
		return 0.45;
	case BUILDING_COMMERCIAL:
	case BUILDING_CHURCH:
		return 0.3;
	case BUILDING_INDUSTRIAL:
		return 0.2;
	default:
		return 0.12;
	}
}

static const uint8_t fronts[] = { MATERIAL_SHOP_CLASSIC, MATERIAL_SHOP_GLASS, MATERIAL_SHOP_AWNING, MATERIAL_SHOP_CAFE,
	MATERIAL_SHOP_STONE };

/* A shop where the data says so, and in some houses of any busy or pedestrian street. */
static bool has_shop(const struct massing *m, struct pick *pick)
{
	enum building_kind kind = m->building->kind;
	bool luck = pick_chance(pick, 45), rare = pick_chance(pick, 16);
	if (!m->has_ground_floor || kind == BUILDING_HOUSE || kind == BUILDING_CIVIC || kind >= BUILDING_CHURCH ||
		kind == BUILDING_INDUSTRIAL)
		return false;
	if (m->building->shop || kind == BUILDING_RETAIL)
		return true;
	if (m->door_wall == UINT32_MAX || m->top - m->ground < 8.0)
		return false;
	const struct wall *wall = &m->walls.items[m->door_wall];
	bool busy = wall->street_class == WAY_PEDESTRIAN ||
				(wall->street_class >= PKG_STREET_PRIMARY && wall->street_class <= PKG_STREET_TERTIARY);
	bool quiet = wall->street_class == PKG_STREET_RESIDENTIAL || wall->street_class == PKG_STREET_LIVING;
	return wall->street_m < 16.0 && ((busy && luck) || (quiet && rare && m->top - m->ground > 12.0));
}

void facade_choose(struct massing *m)
{
	enum region region = region_of(m->city->frame.origin);
	/* Parts of one building wear the same. */
	uint64_t key = m->hash;
	if (m->building->is_part && m->building->outline != PKG_NONE && m->building->outline < m->city->buildings.count)
		key = hash_u64((uint64_t)m->city->buildings.items[m->building->outline].id + UINT64_C(0x9E3779B97F4A7C15));
	struct pick pick = { key };
	struct facade *f = &m->facade;
	*f = (struct facade){ 0 };
	wear_by_kind(m, &pick, region);
	if (m->building->wall_colour.given) {
		set_rgb(f->wall_rgb, m->building->wall_colour.rgb);
		calm_rgb(f->wall_rgb, 120.0, 238.0);
	}
	choose_roofing(m, &pick, region);
	f->overhang = usual_overhang(m);
	f->parapet = m->top - m->base > 5.0 && m->building->kind != BUILDING_ROOF;
	f->shop = has_shop(m, &pick) ? fronts[pick_one(&pick, sizeof(fronts))] : 0;
	set_rgb(f->base_rgb, f->wall_rgb);
	if (f->ground == MATERIAL_GROUND_RUSTIC || f->shop) {
		/* The stone of a base is greyer than the wall above it. */
		for (int i = 0; i < 3; i++)
			f->base_rgb[i] = scaled(f->wall_rgb[i] * 0.55 + stones[pick.bits % PALETTE][i] * 0.42);
	}
	static const uint8_t trims[4][3] = { { 226, 222, 214 }, { 150, 138, 126 }, { 206, 202, 196 }, { 122, 116, 110 } };
	set_rgb(f->trim_rgb, trims[pick_one(&pick, 4)]);
}
