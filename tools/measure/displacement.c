/* Every pixel of the representation offers what it shows to the few pixels of the reference where that belongs. */
#include "tools/measure/displacement.h"

#include <math.h>

#define SAME_PX 0.01    /* below it is the rasterizer's rounding */
#define OFFER_PX 1.5    /* from the place's own position to the reference's pixel, in x and in y */
#define FREE_PX 0.70711 /* half a pixel's diagonal: of this, sampling at pixels is the cause */
#define MARGIN_PX 3.0   /* of depth, in footprints of a pixel */

const double displacement_class_px[DISPLACEMENT_CLASSES] = { SAME_PX, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0,
	DISPLACEMENT_REACH_PX, INFINITY };

/* Hammersley's points in two dimensions. */
const struct dvec2 displacement_samples[DISPLACEMENT_SAMPLES] = { { -7.0 / 16, -7.0 / 16 }, { -5.0 / 16, 1.0 / 16 },
	{ -3.0 / 16, -3.0 / 16 }, { -1.0 / 16, 5.0 / 16 }, { 1.0 / 16, -5.0 / 16 }, { 3.0 / 16, 3.0 / 16 },
	{ 5.0 / 16, -1.0 / 16 }, { 7.0 / 16, 7.0 / 16 } };

/* How deep the pixel's object is around it. */
static struct displacement_depth depth_around(
	const struct truth_image *image, const struct displacement_depth *depths, uint32_t x, uint32_t y)
{
	uint32_t object = image->pixels[(size_t)y * image->width + x].object;
	struct displacement_depth out = { INFINITY, -INFINITY };
	for (uint32_t v = y ? y - 1 : 0; v <= y + 1 && v < image->height; v++) {
		for (uint32_t u = x ? x - 1 : 0; u <= x + 1 && u < image->width; u++) {
			size_t i = (size_t)v * image->width + u;
			if (image->pixels[i].object != object)
				continue;
			out.min_m = fminf(out.min_m, depths[i].min_m);
			out.max_m = fmaxf(out.max_m, depths[i].max_m);
		}
	}
	return out;
}

/* How deep the level plane through a place is, so far above (up) or below the pixel that shows it; infinity above its
 * horizon. */
static double level_depth_m(const struct truth_image *image, const struct truth_pixel *pixel, double up_px)
{
	double depth_m = truth_depth_m(image, pixel), height_m = (double)pixel->from_eye_m[2];
	double rise = height_m / depth_m + up_px / image->focal_px * (double)image->up.z; /* of the ray, for 1 m of depth */
	double out_m = height_m / rise;
	return out_m > 0.0 ? out_m : INFINITY;
}

static bool lies_level(uint32_t object)
{
	return object == TRUTH_GROUND || object == TRUTH_WATER;
}

static bool shows_same(const struct truth_image *reference, const struct displacement_depth *depths, uint32_t x,
	uint32_t y, const struct truth_pixel *shown, double depth_m)
{
	const struct truth_pixel *pixel = &reference->pixels[(size_t)y * reference->width + x];
	if (pixel->object != shown->object)
		return false;
	struct displacement_depth around = depth_around(reference, depths, x, y);
	for (int side = -1; side <= 1 && lies_level(pixel->object); side += 2) {
		float level_m = (float)level_depth_m(reference, pixel, side * OFFER_PX);
		around.min_m = fminf(around.min_m, level_m);
		around.max_m = fmaxf(around.max_m, level_m);
	}
	double margin_m = MARGIN_PX * depth_m / reference->focal_px;
	return depth_m >= (double)around.min_m - margin_m && depth_m <= (double)around.max_m + margin_m;
}

/* The pixels whose centres lie within OFFER_PX of a coordinate: first to last, empty when first > last. */
static void pixels_near(double at, uint32_t size, long *first, long *last)
{
	*first = (long)ceil(at - OFFER_PX - 0.5);
	*last = (long)floor(at + OFFER_PX - 0.5);
	*first = *first < 0 ? 0 : *first;
	*last = *last >= (long)size ? (long)size - 1 : *last;
}

static void offer(const struct truth_image *reference, const struct displacement_depth *depths,
	const struct truth_pixel *shown, struct dvec2 at, double off_px, double depth_m, float *map)
{
	long left, right, top, bottom;
	pixels_near(at.x, reference->width, &left, &right);
	pixels_near(at.y, reference->height, &top, &bottom);
	for (long y = top; y <= bottom; y++) {
		for (long x = left; x <= right; x++) {
			size_t index = (size_t)y * reference->width + (size_t)x;
			double beside_px = hypot((double)x + 0.5 - at.x, (double)y + 0.5 - at.y) - FREE_PX;
			double sum_px = off_px + fmax(0.0, beside_px);
			if (sum_px < (double)map[index] && sum_px <= DISPLACEMENT_REACH_PX &&
				shows_same(reference, depths, (uint32_t)x, (uint32_t)y, shown, depth_m))
				map[index] = (float)sum_px;
		}
	}
}

void displacement_begin(const struct truth_image *reference, float *map)
{
	size_t pixels = (size_t)reference->width * reference->height;
	for (size_t i = 0; i < pixels; i++)
		map[i] = reference->pixels[i].object ? INFINITY : DISPLACEMENT_NOTHING;
}

void displacement_depths(const struct truth_image *reference, struct displacement_depth *depths)
{
	size_t pixels = (size_t)reference->width * reference->height;
	for (size_t i = 0; i < pixels; i++)
		depths[i].min_m = depths[i].max_m = (float)truth_depth_m(reference, &reference->pixels[i]);
}

void displacement_widen(
	const struct truth_image *reference, const struct truth_image *sample, struct displacement_depth *depths)
{
	size_t pixels = (size_t)reference->width * reference->height;
	for (size_t i = 0; i < pixels; i++) {
		if (!sample->pixels[i].object || sample->pixels[i].object != reference->pixels[i].object)
			continue;
		float depth_m = (float)truth_depth_m(sample, &sample->pixels[i]);
		depths[i].min_m = fminf(depths[i].min_m, depth_m);
		depths[i].max_m = fmaxf(depths[i].max_m, depth_m);
	}
}

void displacement_offer(const struct truth_image *reference, const struct displacement_depth *depths,
	const struct truth_image *shown, float *map)
{
	for (uint32_t y = 0; y < shown->height; y++) {
		for (uint32_t x = 0; x < shown->width; x++) {
			const struct truth_pixel *pixel = &shown->pixels[(size_t)y * shown->width + x];
			struct dvec2 at;
			if (!pixel->object || !truth_project(shown, pixel, &at.x, &at.y))
				continue;
			double off_px = hypot(at.x - x - 0.5 - shown->sample_px.x, at.y - y - 0.5 - shown->sample_px.y);
			if (off_px <= DISPLACEMENT_REACH_PX)
				offer(reference, depths, pixel, at, off_px < SAME_PX ? 0.0 : off_px, truth_depth_m(shown, pixel), map);
		}
	}
}

bool far_limit_beyond(const struct far_limit *limit, const struct truth_pixel *pixel)
{
	struct dvec2 at = { (double)pixel->from_eye_m[0], (double)pixel->from_eye_m[1] };
	struct dvec2 axis = dvec2_sub(limit->to_m, limit->from_m), way = dvec2_sub(at, limit->from_m);
	double length2 = dvec2_dot(axis, axis);
	double t = length2 > 0.0 ? fmin(1.0, fmax(0.0, dvec2_dot(way, axis) / length2)) : 0.0;
	return dvec2_length(dvec2_sub(way, dvec2_scale(axis, t))) > limit->near_m;
}

static int class_of(double px)
{
	int class = 0;
	while (px > displacement_class_px[class])
		class ++;
	return class;
}

void displacement_add(struct displacement_count *count, const struct truth_image *reference, const float *map,
	const struct far_limit *limit)
{
	size_t pixels = (size_t)reference->width * reference->height;
	for (size_t i = 0; i < pixels; i++) {
		double px = (double)map[i];
		if (px < 0.0 || (limit && !far_limit_beyond(limit, &reference->pixels[i])))
			continue;
		count->pixels[class_of(px)]++;
		if (isfinite(px))
			count->max_px = fmax(count->max_px, px);
	}
}

void displacement_join(struct displacement_count *count, const struct displacement_count *add)
{
	for (int i = 0; i < DISPLACEMENT_CLASSES; i++)
		count->pixels[i] += add->pixels[i];
	count->max_px = fmax(count->max_px, add->max_px);
}

uint64_t displacement_total(const struct displacement_count *count)
{
	uint64_t sum = 0;
	for (int i = 0; i < DISPLACEMENT_CLASSES; i++)
		sum += count->pixels[i];
	return sum;
}

double displacement_share(const struct displacement_count *count, double px)
{
	uint64_t sum = 0, total = displacement_total(count);
	for (int i = 0; i < DISPLACEMENT_CLASSES && displacement_class_px[i] <= px; i++)
		sum += count->pixels[i];
	return total ? (double)sum / (double)total : 1.0;
}

double displacement_share_lost(const struct displacement_count *count)
{
	uint64_t total = displacement_total(count);
	return total ? (double)count->pixels[DISPLACEMENT_CLASSES - 1] / (double)total : 0.0;
}

double displacement_quantile(const struct displacement_count *count, double quantile)
{
	double wanted = quantile * (double)displacement_total(count), below = 0.0, from = 0.0;
	for (int i = 0; i < DISPLACEMENT_CLASSES; i++) {
		double here = (double)count->pixels[i], to = fmin(displacement_class_px[i], fmax(count->max_px, from));
		if (here > 0.0 && below + here >= wanted) {
			if (i == DISPLACEMENT_CLASSES - 1)
				return INFINITY;
			return i == 0 ? 0.0 : from + (to - from) * (wanted - below) / here;
		}
		below += here;
		from = displacement_class_px[i];
	}
	return 0.0;
}
