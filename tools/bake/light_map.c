/*
 * The ground's light map. Occlusion: the buildings' heights on a grid, and for every texel how much of the sky their
 * horizon leaves, in a few directions (Max, "Horizon mapping", 1988), softened. Lamps: smooth discs.
 */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>

#include "tools/bake/bake.h"
#include "tools/bake/eac.h"

#define TEXEL_M 2.0
#define SIDE_MAX 4096
#define MARGIN_M 60.0
#define DIRECTIONS 10
#define DARKEST 0.38 /* of the occlusion: a navigation picture needs no black courtyards */

static const double steps_m[] = { 2.0, 4.5, 7.5, 11.0, 16.0, 23.0, 32.0 };
#define STEPS (sizeof(steps_m) / sizeof(*steps_m))

struct height_map {
	struct dvec2 origin;
	double texel_m;
	int32_t width, height;
	float *top_m; /* of the buildings above the ground; 0 open */
	float *sky;
};

/* ---- buildings on the grid ---- */

static int compare_doubles(const void *left, const void *right)
{
	const double *a = left, *b = right;
	return (*a > *b) - (*a < *b);
}

typedef ARRAY(double) double_array;

static void cross_ring(const struct ring *ring, double y, double_array *crossings)
{
	for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++) {
		struct dvec2 a = ring->points[j], b = ring->points[i];
		if ((a.y <= y) != (b.y <= y))
			ARRAY_PUSH(crossings, a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
	}
}

static void fill_row(struct height_map *map, int32_t row, const double_array *crossings, float top_m)
{
	for (size_t i = 0; i + 1 < crossings->count; i += 2) {
		int32_t from = (int32_t)ceil((crossings->items[i] - map->origin.x) / map->texel_m - 0.5);
		int32_t to = (int32_t)floor((crossings->items[i + 1] - map->origin.x) / map->texel_m - 0.5);
		for (int32_t col = from < 0 ? 0 : from; col <= to && col < map->width; col++) {
			float *at = &map->top_m[(size_t)row * (size_t)map->width + (size_t)col];
			*at = fmaxf(*at, top_m);
		}
	}
}

static void draw_building(struct height_map *map, const struct building *building, double_array *crossings)
{
	if (building->footprint.outer.count < 3 || building->has_parts || building->min_height_m > 4.0)
		return;
	struct dvec2 min, max;
	ring_bounds(&building->footprint.outer, &min, &max);
	int32_t from = (int32_t)fmax(floor((min.y - map->origin.y) / map->texel_m), 0.0);
	int32_t to = (int32_t)fmin(ceil((max.y - map->origin.y) / map->texel_m), map->height - 1.0);
	for (int32_t row = from; row <= to; row++) {
		double y = map->origin.y + (row + 0.5) * map->texel_m;
		crossings->count = 0;
		cross_ring(&building->footprint.outer, y, crossings);
		for (size_t i = 0; i < building->footprint.hole_count; i++)
			cross_ring(&building->footprint.holes[i], y, crossings);
		if (crossings->count)
			qsort(crossings->items, crossings->count, sizeof(double), compare_doubles);
		fill_row(map, row, crossings, (float)building->height_m);
	}
}

/* ---- sky ---- */

struct sky_work {
	struct height_map *map;
	int32_t from, to;
};

static float sky_of(const struct height_map *map, int32_t col, int32_t row, int32_t offsets[DIRECTIONS][STEPS][2])
{
	double sum = 0.0;
	for (int d = 0; d < DIRECTIONS; d++) {
		double steepest = 0.0;
		for (size_t s = 0; s < STEPS; s++) {
			int32_t x = col + offsets[d][s][0], y = row + offsets[d][s][1];
			if (x < 0 || y < 0 || x >= map->width || y >= map->height)
				break;
			double slope = (double)map->top_m[(size_t)y * (size_t)map->width + (size_t)x] / steps_m[s];
			steepest = slope > steepest ? slope : steepest;
		}
		sum += 1.0 / (1.0 + steepest * steepest); /* squared cosine of the horizon */
	}
	return (float)(sum / DIRECTIONS);
}

static void *compute_sky(void *context)
{
	struct sky_work *work = context;
	struct height_map *map = work->map;
	int32_t offsets[DIRECTIONS][STEPS][2];
	for (int d = 0; d < DIRECTIONS; d++)
		for (size_t s = 0; s < STEPS; s++) {
			double turn = 2.0 * BLVD_PI * (d + 0.3) / DIRECTIONS, reach = steps_m[s] / map->texel_m;
			offsets[d][s][0] = (int32_t)lround(cos(turn) * fmax(reach, 1.0));
			offsets[d][s][1] = (int32_t)lround(sin(turn) * fmax(reach, 1.0));
		}
	for (int32_t row = work->from; row < work->to; row++)
		for (int32_t col = 0; col < map->width; col++)
			map->sky[(size_t)row * (size_t)map->width + (size_t)col] = sky_of(map, col, row, offsets);
	return NULL;
}

static void compute_all_sky(struct height_map *map)
{
	struct sky_work halves[2] = { { map, 0, map->height / 2 }, { map, map->height / 2, map->height } };
	pthread_t thread;
	bool threaded = pthread_create(&thread, NULL, compute_sky, &halves[0]) == 0;
	if (!threaded)
		compute_sky(&halves[0]);
	compute_sky(&halves[1]);
	if (threaded)
		pthread_join(thread, NULL);
}

static double sky_at(const struct height_map *map, int32_t col, int32_t row)
{
	col = col < 0 ? 0 : col >= map->width ? map->width - 1 : col;
	row = row < 0 ? 0 : row >= map->height ? map->height - 1 : row;
	return (double)map->sky[(size_t)row * (size_t)map->width + (size_t)col];
}

/* Blurred with 1 2 1 both ways; courtyards stay readable. */
static uint8_t occlusion_texel(const struct height_map *map, int32_t col, int32_t row)
{
	double sum = 0.0;
	for (int32_t dy = -1; dy <= 1; dy++)
		for (int32_t dx = -1; dx <= 1; dx++)
			sum += sky_at(map, col + dx, row + dy) * (2 - abs(dx)) * (2 - abs(dy));
	return (uint8_t)lrint(255.0 * (DARKEST + (1.0 - DARKEST) * sqrt(fmin(sum / 16.0, 1.0))));
}

/* ---- lamps ---- */

static void add_lamp(struct height_map *map, float *light, const struct lamp *lamp)
{
	double radius = (double)lamp->radius_m;
	int32_t col0 = (int32_t)floor((lamp->at.x - radius - map->origin.x) / map->texel_m);
	int32_t row0 = (int32_t)floor((lamp->at.y - radius - map->origin.y) / map->texel_m);
	int32_t reach = (int32_t)ceil(2.0 * radius / map->texel_m) + 1;
	for (int32_t row = row0; row <= row0 + reach; row++)
		for (int32_t col = col0; col <= col0 + reach; col++) {
			if (col < 0 || row < 0 || col >= map->width || row >= map->height)
				continue;
			double x = map->origin.x + (col + 0.5) * map->texel_m - lamp->at.x;
			double y = map->origin.y + (row + 0.5) * map->texel_m - lamp->at.y;
			double falloff = 1.0 - (x * x + y * y) / (radius * radius);
			if (falloff > 0.0)
				light[(size_t)row * (size_t)map->width + (size_t)col] += (float)(falloff * falloff);
		}
}

static void place_map(const struct city *city, struct height_map *map)
{
	struct dvec2 min = { city->min.x - MARGIN_M, city->min.y - MARGIN_M };
	struct dvec2 max = { city->max.x + MARGIN_M, city->max.y + MARGIN_M };
	double side = fmax(max.x - min.x, max.y - min.y);
	map->texel_m = fmax(TEXEL_M, ceil(side / SIDE_MAX * 4.0) / 4.0);
	map->origin = (struct dvec2){ floor(min.x), floor(min.y) };
	map->width = (int32_t)fmin(ceil((max.x - map->origin.x) / map->texel_m), SIDE_MAX);
	map->height = (int32_t)fmin(ceil((max.y - map->origin.y) / map->texel_m), SIDE_MAX);
}

void light_map_bake(const struct city *city, const lamp_array *lamps, struct light_map *out)
{
	*out = (struct light_map){ 0 };
	struct height_map map = { 0 };
	place_map(city, &map);
	if (map.width < 1 || map.height < 1)
		return;
	size_t texels = (size_t)map.width * (size_t)map.height;
	struct pool pool = { 0 };
	map.top_m = POOL_ARRAY(&pool, float, texels);
	map.sky = POOL_ARRAY(&pool, float, texels);
	float *light = POOL_ARRAY(&pool, float, texels);
	double_array crossings = { 0 };
	for (size_t i = 0; i < city->buildings.count; i++)
		draw_building(&map, &city->buildings.items[i], &crossings);
	ARRAY_FINISH(&crossings);
	compute_all_sky(&map);
	for (size_t i = 0; i < lamps->count; i++)
		add_lamp(&map, light, &lamps->items[i]);
	out->header = (struct pkg_light_map){ .origin_mm = { (int32_t)llround(map.origin.x * 1000.0),
											  (int32_t)llround(map.origin.y * 1000.0) },
		.texel_mm = (uint32_t)llround(map.texel_m * 1000.0),
		.width = (uint32_t)map.width,
		.height = (uint32_t)map.height };
	out->bytes = 2 * texels;
	out->texels = array_grow(NULL, &(size_t){ 0 }, out->bytes, 1);
	for (int32_t row = 0; row < map.height; row++)
		for (int32_t col = 0; col < map.width; col++) {
			size_t at = (size_t)row * (size_t)map.width + (size_t)col;
			out->texels[2 * at] = occlusion_texel(&map, col, row);
			out->texels[2 * at + 1] = (uint8_t)lrint(255.0 * (1.0 - exp(-(double)light[at])));
		}
	pool_finish(&pool);
}

/* ---- blocks ---- */

struct pack_work {
	const struct light_map *map;
	uint8_t *blocks;
	uint32_t first, end; /* rows of blocks */
};

static void *pack_rows(void *context)
{
	const struct pack_work *work = context;
	const struct pkg_light_map *header = &work->map->header;
	eac_rg_encode(
		work->blocks, (const uint8_t(*)[2])work->map->texels, header->width, header->height, work->first, work->end);
	return NULL;
}

void light_map_pack(struct light_map *map)
{
	if (!map->texels || map->header.format != PKG_LIGHT_RG8)
		return;
	size_t bytes = eac_rg_bytes(map->header.width, map->header.height);
	uint8_t *blocks = array_grow(NULL, &(size_t){ 0 }, bytes, 1);
	uint32_t rows = (map->header.height + 3) / 4;
	struct pack_work halves[2] = { { map, blocks, 0, rows / 2 }, { map, blocks, rows / 2, rows } };
	pthread_t thread;
	bool threaded = pthread_create(&thread, NULL, pack_rows, &halves[0]) == 0;
	if (!threaded)
		pack_rows(&halves[0]);
	pack_rows(&halves[1]);
	if (threaded)
		pthread_join(thread, NULL);
	array_free(map->texels);
	map->texels = blocks;
	map->bytes = bytes;
	map->header.format = PKG_LIGHT_EAC_RG11;
}

void light_map_finish(struct light_map *map)
{
	array_free(map->texels);
	*map = (struct light_map){ 0 };
}
