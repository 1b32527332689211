/*
 * What a capture has to add. A pixel is left to an earlier capture that shows its point: the same object, facing the
 * same way, at a disparity that moves it by less than tau anywhere in the view cell, and sharp enough there. A wall
 * that an earlier capture grazes is worth a second look.
 *
 * Every second pixel of every second row is judged first; what lies between four that are shown, on one object, is
 * shown. About 20 ns a pixel.
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
#define SPECK_PX2 8.0  /* of the screen */
#define OVERLAP_PX 1.6 /* of the screen */

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
	double per_px;   /* pixels of the capture in one of the screen */
	double focal_px; /* of the screen, times texels a pixel */
	struct earlier *earlier;
	size_t earlier_count;
	size_t last; /* earlier capture that showed the last pixel: most likely it shows the next one */
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
	struct dvec3 normal = oct_normal(pixel->normal_oct);
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
	if (!(at[0] > -1 && at[1] > -1 && at[0] < width + 1 && at[1] < height + 1))
		return false;
	int x = (int)(at[0] + 1) - 1, y = (int)(at[1] + 1) - 1;
	double low = INFINITY, high = -INFINITY;
	for (int row = y < 1 ? 0 : y - 1; row <= y + 1 && row < height; row++) {
		for (int column = x < 1 ? 0 : x - 1; column <= x + 1 && column < width; column++) {
			size_t i = (size_t)row * (size_t)width + (size_t)column;
			const struct capture_pixel *there = &image->pixels[i];
			if (there->object != pixel->object || !is_wanted(earlier->capture, i) ||
				!surface_normals_agree(there->normal_oct, pixel->normal_oct))
				continue;
			low = there->disparity < low ? there->disparity : low;
			high = there->disparity > high ? there->disparity : high;
		}
	}
	if (!(low <= high))
		return false;
	if (at[2] >= low && at[2] <= high)
		return true;
	double tolerance = earlier->tau_px * parallax_tolerance(&earlier->parallax, at[0], at[1], at[2]);
	return at[2] >= low - tolerance && at[2] <= high + tolerance;
}

static bool is_shown(struct fusion *fusion, double x, double y, const struct capture_pixel *pixel)
{
	struct dvec3 point = capture_point(&fusion->capture->image.view, x, y, pixel->disparity);
	for (size_t n = 0; n < fusion->earlier_count; n++) {
		size_t k = n ? n - (n <= fusion->last) : fusion->last; /* the last first, the others in order */
		const struct earlier *earlier = &fusion->earlier[k];
		double at[3];
		if (!reproject(&earlier->map, x, y, pixel->disparity, at) || !has_surface(earlier, at, pixel) ||
			!is_sharp_enough(fusion, earlier, point, pixel))
			continue;
		fusion->last = k;
		return true;
	}
	return false;
}

static uint8_t state_of(struct fusion *fusion, uint32_t x, uint32_t y, size_t i)
{
	if (!is_wanted(fusion->capture, i))
		return EMPTY;
	return is_shown(fusion, x + 0.5, y + 0.5, &fusion->capture->image.pixels[i]) ? SHOWN : OWNED;
}

/* Are the even pixels around this one shown, and of its object? */
static bool is_amid_shown(const struct fusion *fusion, const uint8_t *states, uint32_t x, uint32_t y)
{
	const struct capture_image *image = &fusion->capture->image;
	uint32_t width = image->view.width, right = x + x % 2, below = y + y % 2;
	if (right >= width || below >= image->view.height)
		return false;
	uint32_t object = image->pixels[(size_t)y * width + x].object;
	for (int n = 0; n < 4; n++) {
		size_t i = (size_t)(n / 2 ? below : y - y % 2) * width + (n % 2 ? right : x - x % 2);
		if (states[i] != SHOWN || image->pixels[i].object != object)
			return false;
	}
	return true;
}

static void judge(struct fusion *fusion, uint8_t *states)
{
	uint32_t width = fusion->capture->image.view.width, height = fusion->capture->image.view.height;
	for (uint32_t y = 0; y < height; y += 2)
		for (uint32_t x = 0; x < width; x += 2)
			states[(size_t)y * width + x] = state_of(fusion, x, y, (size_t)y * width + x);
	for (uint32_t y = 0; y < height; y++) {
		for (uint32_t x = 1 - y % 2; x < width; x += 2 - y % 2) {
			size_t i = (size_t)y * width + x;
			bool is_between = is_wanted(fusion->capture, i) && is_amid_shown(fusion, states, x, y);
			states[i] = is_between ? SHOWN : state_of(fusion, x, y, i);
		}
	}
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
		bool is_speck =
			beside == island.count ||
			((double)island.count <= SPECK_PX2 * fusion->per_px * fusion->per_px && 2 * beside >= island.count);
		for (size_t k = 0; k < island.count; k++)
			owner[island.items[k]] = !is_speck;
	}
	ARRAY_FINISH(&island);
	pool_finish(&pool);
}

/* Owns the neighbours that go on the surface of pixel i, and notes them. */
static void spread(const struct fusion *fusion, uint8_t *owner, uint32_t i, pixel_list *reached)
{
	const struct capture_image *image = &fusion->capture->image;
	uint32_t width = image->view.width, x = i % width, y = i / width;
	double tolerance = -1;
	for (uint32_t n = 0; n < 9; n++) {
		uint32_t column = x + n % 3 - 1, row = y + n / 3 - 1, k = row * width + column;
		if (column >= width || row >= image->view.height || owner[k] || !image->pixels[k].object)
			continue;
		if (tolerance < 0)
			tolerance =
				fusion->tau_px * parallax_tolerance(&fusion->parallax, x + 0.5, y + 0.5, image->pixels[i].disparity);
		if (!surface_continues(&image->pixels[i], &image->pixels[k], tolerance))
			continue;
		owner[k] = 1;
		ARRAY_PUSH(reached, k);
	}
}

/* Grows what is owned along its surfaces into what others show. */
static void overlap(const struct fusion *fusion, uint8_t *owner)
{
	uint32_t count = fusion->capture->image.view.width * fusion->capture->image.view.height;
	pixel_list lists[2] = { 0 };
	for (uint32_t i = 0; i < count; i++)
		if (owner[i])
			ARRAY_PUSH(&lists[0], i);
	int rounds = (int)lround(OVERLAP_PX * fusion->per_px);
	for (int round = 0; round < rounds; round++) {
		pixel_list *from = &lists[round % 2], *to = &lists[1 - round % 2];
		to->count = 0;
		for (size_t n = 0; n < from->count; n++)
			spread(fusion, owner, from->items[n], to);
	}
	ARRAY_FINISH(&lists[0]);
	ARRAY_FINISH(&lists[1]);
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
		.per_px = view->focal_px / options->focal_px,
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
