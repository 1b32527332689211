/* Every second pixel of the capture is looked for in the poses, and what is found is widened: a quarter of the work,
 * and the margin is wider than the gaps. About 10 ns a pixel and pose. */
#include "tools/impostor/wanted.h"

#include <assert.h>
#include <string.h>

#include "tools/impostor/parallax.h"

#define STEP 2
/* Share of the disparity that the pose's may differ by, on top of what lies between neighbouring pixels. Too many
 * wanted pixels cost some bytes, too few leave a hole. */
#define SLACK 0.01

/* Is the object at this place and disparity, in the range that it spans around the pixel? */
static bool is_seen(const struct capture_image *pose, const double at[3], uint32_t object)
{
	const struct capture_view *view = &pose->view;
	if (!(at[0] > -1 && at[1] > -1 && at[0] < view->width + 1.0 && at[1] < view->height + 1.0))
		return false;
	int x = (int)floor(at[0]), y = (int)floor(at[1]);
	double low = INFINITY, high = -INFINITY;
	for (int row = y - 1; row <= y + 1; row++) {
		for (int column = x - 1; column <= x + 1; column++) {
			if (row < 0 || column < 0 || row >= (int)view->height || column >= (int)view->width)
				continue;
			const struct capture_pixel *pixel = &pose->pixels[(size_t)row * view->width + (size_t)column];
			if (pixel->object != object)
				continue;
			low = fmin(low, pixel->disparity);
			high = fmax(high, pixel->disparity);
		}
	}
	return at[2] >= low * (1 - SLACK) && at[2] <= high * (1 + SLACK);
}

static void look_from(const struct capture_image *pose, const struct capture_image *far, uint8_t *found)
{
	struct reprojection map = reprojection_of(&far->view, &pose->view);
	for (uint32_t y = 0; y < far->view.height; y += STEP) {
		for (uint32_t x = 0; x < far->view.width; x += STEP) {
			size_t i = (size_t)y * far->view.width + x;
			const struct capture_pixel *pixel = &far->pixels[i];
			double at[3];
			if (pixel->object && !found[i] && reproject(&map, x + 0.5, y + 0.5, pixel->disparity, at))
				found[i] = is_seen(pose, at, pixel->object);
		}
	}
}

/* Distance along a line to the nearest byte that is set, spread both ways; out gets what is within `margin`. */
static void widen_line(const uint8_t *from, uint8_t *out, size_t count, size_t stride, unsigned margin)
{
	for (int back = 0; back < 2; back++) {
		unsigned since = margin + 1;
		for (size_t n = 0; n < count; n++) {
			size_t i = (back ? count - 1 - n : n) * stride;
			since = from[i] ? 0 : since + 1;
			if (since <= margin)
				out[i] = 1;
		}
	}
}

void impostor_wanted(const struct capture_image *poses, size_t pose_count, const struct capture_image *far,
	unsigned margin_px, uint8_t *wanted)
{
	assert(margin_px >= STEP);
	uint32_t width = far->view.width, height = far->view.height;
	size_t count = (size_t)width * height;
	struct pool pool = { 0 };
	uint8_t *found = POOL_ARRAY(&pool, uint8_t, count), *rows = POOL_ARRAY(&pool, uint8_t, count);
	for (size_t i = 0; i < pose_count; i++)
		look_from(&poses[i], far, found);
	for (uint32_t y = 0; y < height; y++)
		widen_line(found + (size_t)y * width, rows + (size_t)y * width, width, 1, margin_px);
	memset(wanted, 0, count);
	for (uint32_t x = 0; x < width; x++)
		widen_line(rows + x, wanted + x, height, width, margin_px);
	for (size_t i = 0; i < count; i++)
		wanted[i] = wanted[i] && far->pixels[i].object;
	pool_finish(&pool);
}
