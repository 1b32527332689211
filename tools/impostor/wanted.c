/* Every second pixel of the capture is looked for in the poses, and what is found is widened: a quarter of the work,
 * and the margin is wider than the gaps. A pixel is mostly seen from where its neighbour was, so that pose is asked
 * first. */
#include "tools/impostor/wanted.h"

#include <assert.h>
#include <string.h>

#include "tools/impostor/parallax.h"

#define STEP_MAX 3u /* px between rows that are looked at, and between pixels of such a row */
/* Share of the disparity that the pose's may differ by, on top of what lies between neighbouring pixels. Too many
 * wanted pixels cost some bytes, too few leave a hole. */
#define SLACK 0.01

static bool agrees(double disparity, double low, double high)
{
	return disparity >= low * (1 - SLACK) && disparity <= high * (1 + SLACK);
}

/* Is the object at this place and disparity, in the range that it spans around the pixel? */
static bool is_seen(const struct capture_image *pose, const double at[3], uint32_t object)
{
	const struct capture_view *view = &pose->view;
	if (!(at[0] > -1 && at[1] > -1 && at[0] < view->width + 1.0 && at[1] < view->height + 1.0))
		return false;
	int x = (int)(at[0] + 1) - 1, y = (int)(at[1] + 1) - 1;
	int first_x = x > 0 ? x - 1 : 0, last_x = x + 1 < (int)view->width ? x + 1 : (int)view->width - 1;
	int first_y = y > 0 ? y - 1 : 0, last_y = y + 1 < (int)view->height ? y + 1 : (int)view->height - 1;
	double low = INFINITY, high = -INFINITY;
	for (int row = first_y; row <= last_y; row++) {
		const struct capture_pixel *pixels = &pose->pixels[(size_t)row * view->width];
		for (int column = first_x; column <= last_x; column++) {
			if (pixels[column].object != object)
				continue;
			double disparity = pixels[column].disparity;
			low = disparity < low ? disparity : low;
			high = disparity > high ? disparity : high;
		}
	}
	return agrees(at[2], low, high);
}

struct look {
	const struct capture_image *pose;
	struct reprojection map;
};

static void find(
	const struct look *looks, size_t look_count, const struct capture_image *far, unsigned step, uint8_t *found)
{
	size_t last = 0;
	for (uint32_t y = 0; y < far->view.height; y += step) {
		for (uint32_t x = y / step % 2 * (step / 2); x < far->view.width; x += step) {
			size_t i = (size_t)y * far->view.width + x;
			const struct capture_pixel *pixel = &far->pixels[i];
			for (size_t n = 0; n < look_count && pixel->object && !found[i]; n++) {
				size_t k = n ? n - (n <= last) : last; /* the last first, the others in order */
				double at[3];
				if (!reproject(&looks[k].map, x + 0.5, y + 0.5, pixel->disparity, at) ||
					!is_seen(looks[k].pose, at, pixel->object))
					continue;
				found[i] = 1;
				last = k;
			}
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
	unsigned step = margin_px / 2 < STEP_MAX ? margin_px / 2 : STEP_MAX;
	assert(step > 0);
	uint32_t width = far->view.width, height = far->view.height;
	size_t count = (size_t)width * height;
	struct pool pool = { 0 };
	uint8_t *found = POOL_ARRAY(&pool, uint8_t, count), *rows = POOL_ARRAY(&pool, uint8_t, count);
	struct look *looks = POOL_ARRAY(&pool, struct look, pose_count);
	for (size_t i = 0; i < pose_count; i++)
		looks[i] = (struct look){ &poses[i], reprojection_of(&far->view, &poses[i].view) };
	find(looks, pose_count, far, step, found);
	for (uint32_t y = 0; y < height; y++)
		widen_line(found + (size_t)y * width, rows + (size_t)y * width, width, 1, margin_px);
	memset(wanted, 0, count);
	for (uint32_t x = 0; x < width; x++)
		widen_line(rows + x, wanted + x, height, width, margin_px);
	for (size_t i = 0; i < count; i++)
		wanted[i] = wanted[i] && far->pixels[i].object;
	pool_finish(&pool);
}
