/*
 * Ground heights from contour polygons ("the ground inside is at least this high"). The highest polygon over a post and
 * the next contour above it bound the post's height; between these bounds the surface is the smoothest one, found by
 * averaging neighbours over and over (the membrane through the contours).
 */
#include <stdlib.h>
#include <string.h>

#include "tools/read/terrain.h"

#define PASSES 600

static struct ring projected(const struct city *city, const struct ring *degrees, struct dvec2 *spare)
{
	for (size_t i = 0; i < degrees->count; i++)
		spare[i] = geo_to_plane(&city->frame, (struct geo_point){ degrees->points[i].y, degrees->points[i].x });
	return (struct ring){ spare, degrees->count };
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

struct crossings {
	double *items;
	size_t count, capacity;
};

/* The ring's crossings with each row of the grid. */
static void cross_rows(const struct height_field *field, const struct ring *ring, struct crossings *rows)
{
	for (size_t i = 0, j = ring->count - 1; i < ring->count; j = i++) {
		struct dvec2 a = ring->points[j], b = ring->points[i];
		double low = (fmin(a.y, b.y) - field->origin.y) / field->step_m,
			   high = (fmax(a.y, b.y) - field->origin.y) / field->step_m;
		size_t first = low <= 0.0 ? 0 : (size_t)ceil(low);
		for (size_t row = first; row < field->rows && (double)row < high; row++) {
			double y = field->origin.y + (double)row * field->step_m;
			ARRAY_PUSH(&rows[row], a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
		}
	}
}

static void fill_rows(const struct height_field *field, struct crossings *rows, float height_m, float *low_m)
{
	for (size_t row = 0; row < field->rows; row++) {
		ARRAY_SORT(&rows[row], by_value);
		for (size_t k = 0; k + 1 < rows[row].count; k += 2) {
			double from = (rows[row].items[k] - field->origin.x) / field->step_m;
			double to = (rows[row].items[k + 1] - field->origin.x) / field->step_m;
			for (size_t col = from <= 0.0 ? 0 : (size_t)ceil(from); col < field->columns && (double)col <= to; col++) {
				float *post = &low_m[row * field->columns + col];
				*post = isnan(*post) || *post < height_m ? height_m : *post;
			}
		}
		rows[row].count = 0;
	}
}

static void paint(
	const struct height_field *field, const struct city *city, const contour_array *contours, float *low_m)
{
	struct crossings *rows = calloc(field->rows, sizeof(*rows));
	if (!rows)
		abort();
	for (size_t i = 0; i < contours->count; i++) {
		const struct polygon *shape = &contours->items[i].degrees;
		for (size_t r = 0; r <= shape->hole_count; r++) {
			const struct ring *ring = r ? &shape->holes[r - 1] : &shape->outer;
			struct dvec2 *spare = malloc((ring->count + 1) * sizeof(*spare));
			if (!spare)
				abort();
			struct ring flat = projected(city, ring, spare);
			cross_rows(field, &flat, rows);
			free(spare);
		}
		fill_rows(field, rows, (float)contours->items[i].height_m, low_m);
	}
	for (size_t row = 0; row < field->rows; row++)
		ARRAY_FINISH(&rows[row]);
	free(rows);
}

/* The distance between contours: the least difference of two heights. */
static double interval(const contour_array *contours)
{
	double least = INFINITY;
	for (size_t i = 0; i < contours->count; i++) {
		double difference = fabs(contours->items[i].height_m - contours->items[0].height_m);
		if (difference > 0.01)
			least = fmin(least, difference);
	}
	return isfinite(least) ? least : 10.0;
}

static void relax(const struct height_field *field, const float *low_m, double step_m)
{
	float *h = field->height_m;
	size_t columns = field->columns, rows = field->rows;
	for (int pass = 0; pass < PASSES; pass++) {
		/* Forwards and backwards in turn: no direction is preferred. */
		for (size_t k = 0; k < rows; k++) {
			size_t row = pass % 2 ? rows - 1 - k : k;
			for (size_t l = 0; l < columns; l++) {
				size_t col = pass % 2 ? columns - 1 - l : l, i = row * columns + col;
				double west = (double)h[col ? i - 1 : i], east = (double)h[col + 1 < columns ? i + 1 : i];
				double south = (double)h[row ? i - columns : i], north = (double)h[row + 1 < rows ? i + columns : i];
				double mean = (west + east + south + north) / 4.0, low = (double)low_m[i];
				h[i] = (float)fmin(fmax(mean, low), low + step_m);
			}
		}
	}
}

static size_t inside(double at_m, double low_m, double high_m, double origin_m, double step_m)
{
	return (size_t)lround(
		(fmin(fmax(at_m, low_m + step_m), fmax(high_m - step_m, low_m + step_m)) - origin_m) / step_m);
}

/* Contours end where their tiles do: beyond the city its edge goes on. */
static void extend(struct height_field *field, const struct city *city)
{
	for (size_t row = 0; row < field->rows; row++) {
		for (size_t col = 0; col < field->columns; col++) {
			struct dvec2 at = field_place(field, col, row);
			size_t c = inside(at.x, city->min.x, city->max.x, field->origin.x, field->step_m);
			size_t r = inside(at.y, city->min.y, city->max.y, field->origin.y, field->step_m);
			if (c != col || r != row)
				field->height_m[row * field->columns + col] = field->height_m[r * field->columns + c];
		}
	}
}

void terrain_contours(struct height_field *field, const struct city *city, const contour_array *contours)
{
	size_t count = field->columns * field->rows;
	float *low_m = calloc(count, sizeof(float));
	double lowest = INFINITY, step_m = interval(contours);
	if (!low_m)
		abort();
	for (size_t i = 0; i < count; i++)
		low_m[i] = NAN;
	for (size_t i = 0; i < contours->count; i++)
		lowest = fmin(lowest, contours->items[i].height_m);
	paint(field, city, contours, low_m);
	for (size_t i = 0; i < count; i++) {
		/* No polygon over it: below the lowest contour. */
		low_m[i] = isnan(low_m[i]) ? (float)(lowest - step_m) : low_m[i];
		field->height_m[i] = (float)((double)low_m[i] + 0.5 * step_m);
	}
	relax(field, low_m, step_m);
	extend(field, city);
	free(low_m);
}
