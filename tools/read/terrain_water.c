/* Water is level. A lake or the sea takes one height: a low one among those of its posts, since what a survey from
 * space adds to water (boats, bridges, banks) is added upwards. A river is level across and falls along: each of its
 * posts takes the lowest height near it, smoothed. */
#include <stdlib.h>
#include <string.h>

#include "tools/read/terrain.h"

#define RIVER_COMPACTNESS 0.15 /* 4 pi area / perimeter^2; a circle has 1 */
#define RIVER_REACH_M 60.0
#define LEAST_POSTS 3
#define SHORE_M 0.7 /* land at the water lies at least this much higher */

struct water_posts {
	size_t *items;
	size_t count, capacity;
};

static double compactness(const struct ring *ring)
{
	double length = 0.0;
	for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++)
		length += dvec2_length(dvec2_sub(ring->points[i], ring->points[j]));
	return 4.0 * BLVD_PI * fabs(ring_area(ring)) / (length * length);
}

static size_t clamp_index(double at, size_t count)
{
	return at <= 0.0 ? 0 : at >= (double)count - 1.0 ? count - 1 : (size_t)at;
}

static void gather(const struct height_field *field, const struct polygon *shape, struct water_posts *out)
{
	struct dvec2 min, max;
	ring_bounds(&shape->outer, &min, &max);
	size_t col0 = clamp_index((min.x - field->origin.x) / field->step_m, field->columns);
	size_t col1 = clamp_index((max.x - field->origin.x) / field->step_m + 1.0, field->columns);
	size_t row0 = clamp_index((min.y - field->origin.y) / field->step_m, field->rows);
	size_t row1 = clamp_index((max.y - field->origin.y) / field->step_m + 1.0, field->rows);
	out->count = 0;
	for (size_t row = row0; row <= row1; row++)
		for (size_t col = col0; col <= col1; col++)
			if (polygon_contains(shape, field_place(field, col, row)))
				ARRAY_PUSH(out, row * field->columns + col);
}

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return x < y ? -1 : x > y;
}

static void level_lake(struct height_field *field, const struct water_posts *posts)
{
	float *values = malloc(posts->count * sizeof(float));
	if (!values)
		abort();
	for (size_t i = 0; i < posts->count; i++)
		values[i] = field->height_m[posts->items[i]];
	qsort(values, posts->count, sizeof(float), by_value);
	float level = values[posts->count / 5];
	for (size_t i = 0; i < posts->count; i++)
		field->height_m[posts->items[i]] = level;
	free(values);
}

/* One pass over the river's posts: the least, or the mean, of the river's posts within reach. */
static void filter_river(struct height_field *field, const struct water_posts *posts, const bool *wet, bool least)
{
	float *result = malloc(posts->count * sizeof(float));
	size_t reach = (size_t)ceil(RIVER_REACH_M / field->step_m);
	if (!result)
		abort();
	for (size_t i = 0; i < posts->count; i++) {
		size_t col = posts->items[i] % field->columns, row = posts->items[i] / field->columns;
		size_t col0 = col > reach ? col - reach : 0, row0 = row > reach ? row - reach : 0;
		double sum = 0.0, lowest = INFINITY;
		size_t count = 0;
		for (size_t r = row0; r <= row + reach && r < field->rows; r++) {
			for (size_t c = col0; c <= col + reach && c < field->columns; c++) {
				size_t at = r * field->columns + c;
				if (!wet[at])
					continue;
				sum += (double)field->height_m[at];
				lowest = fmin(lowest, (double)field->height_m[at]);
				count++;
			}
		}
		result[i] = (float)(least ? lowest : sum / (double)count);
	}
	for (size_t i = 0; i < posts->count; i++)
		field->height_m[posts->items[i]] = result[i];
	free(result);
}

/* Dry posts beside water stay above it. */
static void raise_shores(struct height_field *field, const bool *wet)
{
	for (size_t row = 0; row < field->rows; row++) {
		for (size_t col = 0; col < field->columns; col++) {
			size_t at = row * field->columns + col;
			double level = -INFINITY;
			for (int k = 0; !wet[at] && k < 9; k++) {
				size_t c = col + (size_t)(k % 3) - 1, r = row + (size_t)(k / 3) - 1;
				if (c < field->columns && r < field->rows && wet[r * field->columns + c])
					level = fmax(level, (double)field->height_m[r * field->columns + c]);
			}
			if ((double)field->height_m[at] < level + SHORE_M)
				field->height_m[at] = (float)(level + SHORE_M);
		}
	}
}

void terrain_water(struct height_field *field, const struct city *city)
{
	struct water_posts posts = { 0 };
	size_t count = field->columns * field->rows;
	bool *wet = calloc(count, sizeof(bool)), *own = calloc(count, sizeof(bool));
	if (!wet || !own)
		abort();
	for (size_t i = 0; i < city->areas.count; i++) {
		const struct area *area = &city->areas.items[i];
		if (area->kind != AREA_WATER || area->layer > 0)
			continue;
		gather(field, &area->shape, &posts);
		if (posts.count < LEAST_POSTS)
			continue;
		for (size_t k = 0; k < posts.count; k++)
			wet[posts.items[k]] = own[posts.items[k]] = true;
		if (compactness(&area->shape.outer) < RIVER_COMPACTNESS && posts.count > 200) {
			filter_river(field, &posts, own, true);
			filter_river(field, &posts, own, false);
		} else {
			level_lake(field, &posts);
		}
		for (size_t k = 0; k < posts.count; k++)
			own[posts.items[k]] = false;
	}
	raise_shores(field, wet);
	ARRAY_FINISH(&posts);
	free(wet);
	free(own);
}
