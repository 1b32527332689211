/*
 * What a capture has to add. A pixel is left to an earlier capture that shows its point: the same object, facing the
 * same way, at a disparity that moves it by less than tau anywhere in the view cell, and sharp enough there. A wall
 * that an earlier capture grazes is worth a second look. About 30 ns a pixel and capture.
 */
#include <string.h>

#include "tools/impostor/impostor.h"
#include "tools/impostor/parallax.h"
#include "tools/impostor/surface_match.h"

/* An earlier capture is sharp enough with this share of the texels that the nearest eye asks for, or when the later
 * one gains less than GAIN_MIN on it. */
#define SHARP_ENOUGH 0.5
#define GAIN_MIN 1.5
/* Islands of so many pixels whose surface is shown right beside them are the sampling's noise. */
#define SPECK_PX 12
#define OVERLAP_PX 2

enum pixel_state { EMPTY, SHOWN, OWNED };

struct earlier {
	const struct impostor_capture *capture;
	struct reprojection map;
	struct parallax parallax;
	double tau_px; /* of the capture */
};

struct fusion {
	const struct impostor_capture *capture;
	struct parallax parallax;
	double tau_px;
	struct dvec3 corners[VIEW_CELL_CORNERS];
	double focal_px; /* of the screen, times texels a pixel */
	struct earlier *earlier;
	size_t earlier_count;
};

static bool is_wanted(const struct impostor_capture *capture, size_t i)
{
	return capture->image.pixels[i].object && (!capture->wanted || capture->wanted[i]);
}

/* Pixels of an image across one metre of a surface seen from `eye`, where it is foreshortened most. Leaves face all
 * ways. */
static double sharpness(double focal_px, struct dvec3 eye, struct dvec3 point, const struct capture_pixel *pixel)
{
	struct dvec3 to_eye = { eye.x - point.x, eye.y - point.y, eye.z - point.z };
	double distance2 = to_eye.x * to_eye.x + to_eye.y * to_eye.y + to_eye.z * to_eye.z;
	if (pixel->kind == PKG_MATERIAL_FOLIAGE)
		return focal_px / sqrt(distance2);
	struct dvec3 normal = surface_normal(pixel->normal_oct);
	double length = sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
	double facing = normal.x * to_eye.x + normal.y * to_eye.y + normal.z * to_eye.z;
	return focal_px * fabs(facing) / (length * distance2);
}

static bool is_sharp_enough(
	const struct fusion *fusion, const struct earlier *earlier, struct dvec3 point, const struct capture_pixel *pixel)
{
	const struct capture_view *view = &earlier->capture->image.view, *own = &fusion->capture->image.view;
	double there = sharpness(view->focal_px, view->eye, point, pixel);
	if (there * GAIN_MIN >= sharpness(own->focal_px, own->eye, point, pixel))
		return true;
	double asked = 0;
	for (int i = 0; i < VIEW_CELL_CORNERS; i++)
		asked = fmax(asked, sharpness(fusion->focal_px, fusion->corners[i], point, pixel));
	return there >= SHARP_ENOUGH * asked;
}

/* Does the earlier capture show this surface at `at`, within what its neighbouring pixels span? */
static bool has_surface(const struct earlier *earlier, const double at[3], const struct capture_pixel *pixel)
{
	const struct capture_image *image = &earlier->capture->image;
	int width = (int)image->view.width, height = (int)image->view.height;
	int x = (int)floor(fmin(fmax(at[0], -2), width + 1)), y = (int)floor(fmin(fmax(at[1], -2), height + 1));
	double low = INFINITY, high = -INFINITY;
	for (int row = y < 1 ? 0 : y - 1; row <= y + 1 && row < height; row++) {
		for (int column = x < 1 ? 0 : x - 1; column <= x + 1 && column < width; column++) {
			size_t i = (size_t)row * (size_t)width + (size_t)column;
			const struct capture_pixel *there = &image->pixels[i];
			if (there->object != pixel->object || !is_wanted(earlier->capture, i) ||
				!surface_normals_agree(there->normal_oct, pixel->normal_oct))
				continue;
			low = fmin(low, there->disparity);
			high = fmax(high, there->disparity);
		}
	}
	if (!(low <= high))
		return false;
	if (at[2] >= low && at[2] <= high)
		return true;
	double tolerance = earlier->tau_px * parallax_tolerance(&earlier->parallax, at[0], at[1], at[2]);
	return at[2] >= low - tolerance && at[2] <= high + tolerance;
}

static bool is_shown(const struct fusion *fusion, double x, double y, const struct capture_pixel *pixel)
{
	struct dvec3 point = capture_point(&fusion->capture->image.view, x, y, pixel->disparity);
	for (size_t k = 0; k < fusion->earlier_count; k++) {
		const struct earlier *earlier = &fusion->earlier[k];
		double at[3];
		if (reproject(&earlier->map, x, y, pixel->disparity, at) && has_surface(earlier, at, pixel) &&
			is_sharp_enough(fusion, earlier, point, pixel))
			return true;
	}
	return false;
}

static void judge(const struct fusion *fusion, uint8_t *states)
{
	const struct capture_image *image = &fusion->capture->image;
	for (uint32_t y = 0, i = 0; y < image->view.height; y++)
		for (uint32_t x = 0; x < image->view.width; x++, i++)
			states[i] = !is_wanted(fusion->capture, i)                          ? EMPTY
						: is_shown(fusion, x + 0.5, y + 0.5, &image->pixels[i]) ? SHOWN
																				: OWNED;
}

/* Is a neighbour of pixel i in this state, and the same surface? */
static bool touches(const struct fusion *fusion, const uint8_t *states, size_t i, uint8_t state)
{
	const struct capture_image *image = &fusion->capture->image;
	uint32_t width = image->view.width, x = (uint32_t)(i % width), y = (uint32_t)(i / width);
	double tolerance = -1;
	for (int n = 0; n < 9; n++) {
		uint32_t column = x + (uint32_t)(n % 3) - 1, row = y + (uint32_t)(n / 3) - 1;
		if (column >= width || row >= image->view.height || states[(size_t)row * width + column] != state)
			continue;
		if (tolerance < 0)
			tolerance =
				fusion->tau_px * parallax_tolerance(&fusion->parallax, x + 0.5, y + 0.5, image->pixels[i].disparity);
		if (surface_continues(&image->pixels[i], &image->pixels[(size_t)row * width + column], tolerance))
			return true;
	}
	return false;
}

typedef ARRAY(uint32_t) pixel_list;

/* Takes the island of owned pixels around `seed`: their states become EMPTY, their places go to `island`. */
static void take_island(const struct capture_view *view, uint8_t *states, uint32_t seed, pixel_list *island)
{
	island->count = 0;
	ARRAY_PUSH(island, seed);
	states[seed] = EMPTY;
	for (size_t taken = 0; taken < island->count; taken++) {
		uint32_t x = island->items[taken] % view->width, y = island->items[taken] / view->width;
		for (uint32_t n = 0; n < 9; n++) {
			uint32_t column = x + n % 3 - 1, row = y + n / 3 - 1, i = row * view->width + column;
			if (column >= view->width || row >= view->height || states[i] != OWNED)
				continue;
			states[i] = EMPTY;
			ARRAY_PUSH(island, i);
		}
	}
}

/* Small islands, and slivers a pixel or two wide, of surfaces that are shown beside them are dropped. */
static void drop_specks(const struct fusion *fusion, const uint8_t *states, uint8_t *owner)
{
	const struct capture_view *view = &fusion->capture->image.view;
	size_t count = (size_t)view->width * view->height;
	struct pool pool = { 0 };
	uint8_t *left = POOL_ARRAY(&pool, uint8_t, count);
	memcpy(left, states, count);
	pixel_list island = { 0 };
	for (uint32_t i = 0; i < count; i++) {
		if (left[i] != OWNED)
			continue;
		take_island(view, left, i, &island);
		size_t beside = 0;
		for (size_t k = 0; k < island.count; k++)
			beside += touches(fusion, states, island.items[k], SHOWN);
		bool is_speck = beside == island.count || (island.count <= SPECK_PX && 2 * beside >= island.count);
		for (size_t k = 0; k < island.count; k++)
			owner[island.items[k]] = !is_speck;
	}
	ARRAY_FINISH(&island);
	pool_finish(&pool);
}

/* Grows what is owned along its surfaces into what others show. */
static void overlap(const struct fusion *fusion, uint8_t *owner)
{
	size_t count = (size_t)fusion->capture->image.view.width * fusion->capture->image.view.height;
	struct pool pool = { 0 };
	uint8_t *before = POOL_ARRAY(&pool, uint8_t, count);
	for (int round = 0; round < OVERLAP_PX; round++) {
		memcpy(before, owner, count);
		for (size_t i = 0; i < count; i++)
			if (!before[i] && fusion->capture->image.pixels[i].object)
				owner[i] = touches(fusion, before, i, 1);
	}
	pool_finish(&pool);
}

void impostor_fuse(const struct view_cell *cell, const struct impostor_capture *captures, size_t which,
	const struct impostor_options *options, uint8_t *owner)
{
	const struct capture_view *view = &captures[which].image.view;
	size_t count = (size_t)view->width * view->height;
	memset(owner, 0, count);
	if (!which) {
		for (size_t i = 0; i < count; i++)
			owner[i] = is_wanted(&captures[0], i);
		return;
	}
	struct pool pool = { 0 };
	struct fusion fusion = { .capture = &captures[which],
		.parallax = parallax_of(cell, view),
		.tau_px = options->tau_px * view->focal_px / options->focal_px,
		.focal_px = options->focal_px * options->texels_per_px,
		.earlier = POOL_ARRAY(&pool, struct earlier, which),
		.earlier_count = which };
	view_cell_corners(cell, fusion.corners);
	for (size_t k = 0; k < which; k++) {
		const struct capture_view *there = &captures[k].image.view;
		fusion.earlier[k] = (struct earlier){ &captures[k], reprojection_of(view, there), parallax_of(cell, there),
			options->tau_px * there->focal_px / options->focal_px };
	}
	uint8_t *states = POOL_ARRAY(&pool, uint8_t, count);
	judge(&fusion, states);
	drop_specks(&fusion, states, owner);
	overlap(&fusion, owner);
	pool_finish(&pool);
}
