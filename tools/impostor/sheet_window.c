/* Spreading by fronts, a pixel a step; cost follows the window and what is spread. */
#include "tools/impostor/sheet_window.h"

#include <math.h>
#include <string.h>

/* Of the tolerance: what another sheet shows within this share is at the same disparity, and spread over. */
#define AGREE_SHARE 0.8

enum mesh_texel sheet_texel(const struct sheet_source *source, const struct surface *surface, uint32_t x, uint32_t y)
{
	uint32_t pixel = y * source->surfaces->width + x;
	const struct capture_pixel *seen = &source->image->pixels[pixel];
	if (!seen->object)
		return MESH_CUT;
	double expected = plane_at(&surface->plane, x + 0.5, y + 0.5), step = (double)seen->disparity - expected;
	/* Only owned pixels have theirs from the start. */
	float *allowed = &source->tolerance[pixel];
	if (*allowed <= 0 && seen->disparity > 0)
		*allowed =
			(float)displacement_tolerance(source->displacement, x + 0.5, y + 0.5, seen->disparity, source->tau_px);
	return fabs(step) <= AGREE_SHARE * (double)*allowed ? MESH_SHOW : step > 0 ? MESH_FILL : MESH_CUT;
}

static void take_pixels(struct sheet_window *window, const struct sheet_source *source, uint32_t sheet)
{
	const struct sheet_options *options = &source->options;
	int32_t margin = (int32_t)(options->guard_px + options->close_px + options->reach_px + options->ring_px) + 2;
	int32_t min_x = INT32_MAX, min_y = INT32_MAX, max_x = 0, max_y = 0;
	const struct sheets *sheets = source->sheets;
	for (uint32_t i = sheets->first.items[sheet]; i < sheets->first.items[sheet + 1]; i++) {
		const struct surface *surface = &source->surfaces->items.items[sheets->members.items[i]];
		min_x = surface->min_x < min_x ? surface->min_x : min_x;
		min_y = surface->min_y < min_y ? surface->min_y : min_y;
		max_x = surface->max_x > max_x ? surface->max_x : max_x;
		max_y = surface->max_y > max_y ? surface->max_y : max_y;
	}
	window->x = min_x - margin;
	window->y = min_y - margin;
	window->width = (uint32_t)(max_x - min_x + 1 + 2 * margin);
	window->height = (uint32_t)(max_y - min_y + 1 + 2 * margin);
	size_t count = (size_t)window->width * window->height;
	ARRAY_RESERVE(&window->label, count);
	memset(window->label.items, 0, count * sizeof(uint32_t));
	ARRAY_RESERVE(&window->seam, count);
	memset(window->seam.items, 0, count);
	window->front.count = 0;
	for (int32_t y = min_y; y <= max_y; y++) {
		const uint32_t *row = source->surfaces->label + (size_t)y * source->surfaces->width;
		size_t to = (size_t)(y - window->y) * window->width + (size_t)(min_x - window->x);
		for (int32_t x = min_x; x <= max_x; x++, to++) {
			if (!row[x] || sheets->sheet_of.items[row[x] - 1] != sheet)
				continue;
			window->label.items[to] = row[x];
			ARRAY_PUSH(&window->front, (uint32_t)to);
		}
	}
}

#define LENT (UINT32_C(1) << 31) /* of a label: taken back where it closes no gap */

enum spread { SPREAD_GUARD, SPREAD_RING, SPREAD_LENT };

/* Under what is nearer; over what is tied to it, which is to be overlapped; down to the near ground. */
static bool may_guard(
	struct sheet_window *window, const struct sheet_source *source, uint32_t step, uint32_t from, uint32_t to)
{
	int64_t x = window->x + (int64_t)(to % window->width), y = window->y + (int64_t)(to / window->width);
	if (x < 0 || y < 0 || x >= source->surfaces->width || y >= source->surfaces->height)
		return false;
	size_t pixel = (size_t)y * source->surfaces->width + (size_t)x;
	if (source->open_below[pixel])
		return to == from + window->width;
	uint32_t label = window->label.items[from];
	enum mesh_texel texel = sheet_texel(source, sheet_surface(source, label), (uint32_t)x, (uint32_t)y);
	bool agrees = texel == MESH_SHOW && step < source->options.seam_px;
	if (agrees)
		window->seam.items[to] = 1;
	return texel == MESH_FILL || agrees;
}

/* By one pixel a step; every other step diagonally too, which makes octagons of points. */
static void spread(struct sheet_window *window, const struct sheet_source *source, enum spread how, uint32_t steps)
{
	int64_t width = window->width;
	const int64_t offsets[8] = { 1, -1, width, -width, width + 1, width - 1, -width + 1, -width - 1 };
	for (uint32_t step = 0; step < steps; step++) {
		window->next_front.count = 0;
		int neighbours = how != SPREAD_GUARD && step % 2 == 0 ? 8 : 4;
		for (size_t i = 0; i < window->front.count; i++) {
			uint32_t from = window->front.items[i];
			for (int k = 0; k < neighbours; k++) {
				uint32_t to = (uint32_t)(from + offsets[k]);
				if (window->label.items[to] || (how == SPREAD_GUARD && !may_guard(window, source, step, from, to)))
					continue;
				window->label.items[to] = window->label.items[from] | (how == SPREAD_LENT ? LENT : 0);
				ARRAY_PUSH(&window->next_front, to);
				if (how == SPREAD_LENT)
					ARRAY_PUSH(&window->lent, to);
			}
		}
		uint32_t *swap = window->front.items;
		size_t capacity = window->front.capacity;
		window->front.items = window->next_front.items;
		window->front.capacity = window->next_front.capacity;
		window->front.count = window->next_front.count;
		window->next_front.items = swap;
		window->next_front.capacity = capacity;
	}
}

/* The rim of what is labelled, for the next spreading. */
static void find_front(struct sheet_window *window)
{
	window->front.count = 0;
	const uint32_t *label = window->label.items;
	for (uint32_t y = 1; y + 1 < window->height; y++) {
		for (uint32_t x = 1; x + 1 < window->width; x++) {
			uint32_t i = y * window->width + x;
			if (label[i] && (!label[i - 1] || !label[i + 1] || !label[i - window->width] || !label[i + window->width]))
				ARRAY_PUSH(&window->front, i);
		}
	}
}

/* Takes back lent pixels from the rim inwards, as many steps as they were lent in: what lies between is kept. */
static void take_back(struct sheet_window *window, uint32_t steps)
{
	const int64_t width = window->width;
	const int64_t offsets[8] = { 1, -1, width, -width, width + 1, width - 1, -width + 1, -width - 1 };
	uint32_t *label = window->label.items;
	for (uint32_t step = 0; step < steps; step++) {
		int neighbours = step % 2 == 0 ? 8 : 4;
		size_t left = 0;
		window->next_front.count = 0;
		for (size_t i = 0; i < window->lent.count; i++) {
			uint32_t at = window->lent.items[i];
			bool rim = false;
			for (int k = 0; k < neighbours && !rim; k++)
				rim = !label[at + offsets[k]];
			if (rim)
				ARRAY_PUSH(&window->next_front, at);
			else
				window->lent.items[left++] = at;
		}
		window->lent.count = left;
		for (size_t i = 0; i < window->next_front.count; i++)
			label[window->next_front.items[i]] = 0;
	}
}

/* Closes gaps (a morphological closing): lends pixels all around, and takes back those that no gap's other side
 * reaches. */
static void close_gaps(struct sheet_window *window, const struct sheet_source *source)
{
	find_front(window);
	window->lent.count = 0;
	spread(window, source, SPREAD_LENT, source->options.close_px);
	take_back(window, source->options.close_px);
	for (size_t i = 0; i < window->lent.count; i++)
		window->label.items[window->lent.items[i]] &= ~LENT;
}

void sheet_window_open(struct sheet_window *window, const struct sheet_source *source, uint32_t sheet)
{
	take_pixels(window, source, sheet);
	spread(window, source, SPREAD_GUARD, source->options.guard_px);
	close_gaps(window, source);
	find_front(window);
	spread(window, source, SPREAD_RING, source->options.ring_px);
}

void sheet_window_finish(struct sheet_window *window)
{
	ARRAY_FINISH(&window->label);
	ARRAY_FINISH(&window->seam);
	ARRAY_FINISH(&window->front);
	ARRAY_FINISH(&window->next_front);
	ARRAY_FINISH(&window->lent);
}
