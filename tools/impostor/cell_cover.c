#include "tools/impostor/cell_cover.h"

#include <math.h>
#include <string.h>

#define SAMPLE_PX 2
#define SLACK 0.01 /* of the disparity, beyond what neighbouring pixels span */
#define COMPANY 4  /* points left among a point and its eight neighbours that make it worth showing */

static bool in_front(const struct capture_view *view, struct dvec3 point, struct dvec3 axis)
{
	return (point.x - view->eye.x) * axis.x + (point.y - view->eye.y) * axis.y > 0.0;
}

static void add_points(
	const struct cell_looks *looks, size_t look, const struct triangle_set *set, struct dvec3 axis, cover_array *points)
{
	const struct capture_image *image = &looks->images.items[look];
	for (uint32_t y = 0; y < image->view.height; y += SAMPLE_PX) {
		for (uint32_t x = 0; x < image->view.width; x += SAMPLE_PX) {
			const struct capture_pixel *pixel = &image->pixels[(size_t)y * image->view.width + x];
			if (!cell_looks_item(looks, set, pixel))
				continue;
			struct dvec3 at = capture_point(&image->view, x + 0.5, y + 0.5, pixel->disparity);
			if (!in_front(&image->view, at, axis))
				continue;
			ARRAY_PUSH(points, (struct cover_point){
								   .at = at,
								   .object = pixel->object,
								   .look = (uint16_t)look,
								   .x = (uint16_t)(x / SAMPLE_PX),
								   .y = (uint16_t)(y / SAMPLE_PX),
							   });
		}
	}
}

void cover_points(struct cell_looks *looks, const struct pkg *pkg, const struct triangle_set *set, struct dvec3 axis,
	cover_array *points)
{
	points->count = 0;
	cell_looks_mark(looks, pkg, set, true);
	for (size_t i = 0; i < looks->count; i++)
		add_points(looks, i, set, axis, points);
	cell_looks_mark(looks, pkg, set, false);
}

/* Does the image show this object at the place and about the disparity, in a pixel that is wanted? */
static bool shows(const struct capture_image *image, const uint8_t *wanted, const struct cover_point *point)
{
	double x, y, z, low = INFINITY, high = -INFINITY;
	if (!capture_project(&image->view, point->at, &x, &y, &z) || !(x >= 0.0) || !(y >= 0.0) ||
		!(x < image->view.width) || !(y < image->view.height))
		return false;
	int column = (int)x, row = (int)y, width = (int)image->view.width, height = (int)image->view.height;
	for (int v = row > 0 ? row - 1 : 0; v <= row + 1 && v < height; v++) {
		for (int u = column > 0 ? column - 1 : 0; u <= column + 1 && u < width; u++) {
			size_t i = (size_t)v * (size_t)width + (size_t)u;
			if (image->pixels[i].object != point->object || !wanted[i])
				continue;
			low = fmin(low, image->pixels[i].disparity);
			high = fmax(high, image->pixels[i].disparity);
		}
	}
	return 1.0 / z >= low * (1.0 - SLACK) && 1.0 / z <= high * (1.0 + SLACK);
}

void cover_strike(cover_array *points, const struct capture_image *image, const uint8_t *wanted)
{
	for (size_t i = 0; i < points->count; i++)
		if (!points->items[i].shown)
			points->items[i].shown = shows(image, wanted, &points->items[i]);
}

/* Marks the points of one look, from first on, that have no company; returns where the next look begins. */
static size_t mark_alone(cover_array *points, size_t first, const struct cell_looks *looks, uint8_t *grid)
{
	const struct capture_view *view = &looks->images.items[points->items[first].look].view;
	size_t across = view->width / SAMPLE_PX + 3, down = view->height / SAMPLE_PX + 3, end = first;
	memset(grid, 0, across * down);
	for (; end < points->count && points->items[end].look == points->items[first].look; end++)
		grid[(points->items[end].y + 1) * across + points->items[end].x + 1] = !points->items[end].shown;
	for (size_t i = first; i < end; i++) {
		const uint8_t *at = &grid[points->items[i].y * across + points->items[i].x];
		unsigned company = 0;
		for (int row = 0; row < 3; row++, at += across)
			company += (unsigned)(at[0] + at[1] + at[2]);
		points->items[i].alone = company < COMPANY;
	}
	return end;
}

static size_t grid_bytes(const struct cell_looks *looks)
{
	size_t most = 0;
	for (size_t i = 0; i < looks->count; i++) {
		const struct capture_view *view = &looks->images.items[i].view;
		size_t bytes = (size_t)(view->width / SAMPLE_PX + 3) * (view->height / SAMPLE_PX + 3);
		most = bytes > most ? bytes : most;
	}
	return most;
}

bool cover_next(cover_array *points, const struct cell_looks *looks, size_t at_most, struct dvec3 *eye)
{
	struct pool pool = { 0 };
	uint8_t *grid = POOL_ARRAY(&pool, uint8_t, grid_bytes(looks) + 1);
	size_t left = 0, most = at_most;
	struct dvec3 here = { NAN, NAN, NAN };
	for (size_t first = 0; first < points->count;) {
		size_t end = mark_alone(points, first, looks, grid);
		const struct dvec3 *from = &looks->images.items[points->items[first].look].view.eye;
		/* The faces of one eye follow one another. */
		left = same_eye(from, &here) ? left : 0;
		here = *from;
		for (; first < end; first++)
			left += !points->items[first].shown && !points->items[first].alone;
		if (left > most) {
			most = left;
			*eye = here;
		}
	}
	pool_finish(&pool);
	return most > at_most;
}

static bool is_left(const struct cover_point *point, const struct cell_looks *looks, const struct dvec3 *eye)
{
	return !point->shown && !point->alone && (!eye || same_eye(&looks->images.items[point->look].view.eye, eye));
}

void cover_strike_eye(cover_array *points, const struct cell_looks *looks, const struct dvec3 *eye)
{
	for (size_t i = 0; i < points->count; i++)
		if (same_eye(&looks->images.items[points->items[i].look].view.eye, eye))
			points->items[i].shown = true;
}

bool cover_crop(const cover_array *points, const struct cell_looks *looks, const struct dvec3 *eye, double margin_px,
	struct capture_view *view)
{
	double min_x = INFINITY, min_y = INFINITY, max_x = -INFINITY, max_y = -INFINITY;
	for (size_t i = 0; i < points->count; i++) {
		double x, y, z;
		if (!is_left(&points->items[i], looks, eye) || !capture_project(view, points->items[i].at, &x, &y, &z) ||
			x < 0.0 || y < 0.0 || x > view->width || y > view->height)
			continue;
		min_x = fmin(min_x, x);
		max_x = fmax(max_x, x);
		min_y = fmin(min_y, y);
		max_y = fmax(max_y, y);
	}
	if (!(max_x >= min_x))
		return false;
	double left = fmax(floor(min_x - margin_px), 0.0), top = fmax(floor(min_y - margin_px), 0.0);
	double right = fmin(ceil(max_x + margin_px), view->width), bottom = fmin(ceil(max_y + margin_px), view->height);
	if (!(right > left) || !(bottom > top))
		return false;
	*view = capture_cut(view,
		&(struct capture_rect){ (uint32_t)left, (uint32_t)top, (uint32_t)(right - left), (uint32_t)(bottom - top) });
	return true;
}

void cover_wanted(const cover_array *points, const struct cell_looks *looks, const struct capture_image *image,
	int radius_px, uint8_t *wanted)
{
	int width = (int)image->view.width, height = (int)image->view.height;
	memset(wanted, 0, (size_t)width * (size_t)height);
	for (size_t i = 0; i < points->count; i++) {
		double x, y, z;
		if (!is_left(&points->items[i], looks, &image->view.eye) ||
			!capture_project(&image->view, points->items[i].at, &x, &y, &z) || !(fabs(x) < 1e6) || !(fabs(y) < 1e6))
			continue;
		int low_x = (int)fmax(x - radius_px, 0.0), high_x = (int)fmin(x + radius_px, width - 1);
		int low_y = (int)fmax(y - radius_px, 0.0), high_y = (int)fmin(y + radius_px, height - 1);
		size_t across = high_x >= low_x ? (size_t)high_x - (size_t)low_x + 1 : 0;
		for (int row = low_y; row <= high_y; row++)
			memset(wanted + (size_t)row * (size_t)width + (size_t)low_x, 1, across);
	}
	for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
		wanted[i] = wanted[i] && image->pixels[i].object;
}
