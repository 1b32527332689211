#include "tools/measure/trial_compare.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "assets/cells.h"
#include "tools/measure/coverage.h"
#include "tools/measure/flip.h"
#include "tools/measure/holes.h"
#include "tools/measure/metrics.h"

#define NEAR_M 150.0 /* where the package has no stretch */
#define PSNR_EQUAL 99.0

static struct image rgb_of(const struct entrant *entrant)
{
	size_t pixels = (size_t)entrant->config.width * entrant->config.height;
	struct image out = { .width = entrant->config.width,
		.height = entrant->config.height,
		.rgb = array_grow(NULL, &(size_t){ 0 }, pixels, 3) };
	for (size_t i = 0; i < pixels; i++)
		for (size_t c = 0; c < 3; c++)
			out.rgb[3 * i + c] = entrant->pixels[4 * i + c];
	return out;
}

static void compare_pictures(const struct entrant *full, const struct entrant *shown, struct trial_row *row)
{
	struct image a = rgb_of(full), b = rgb_of(shown);
	struct image_difference difference;
	struct image_coverage coverage;
	struct flip_summary flip;
	float *map = array_grow(NULL, &(size_t){ 0 }, (size_t)a.width * a.height, sizeof(float));
	image_compare(&a, &b, &difference);
	image_cover(&a, &b, NULL, &coverage);
	flip_map(&a, &b, FLIP_DEFAULT_PPD, map);
	flip_summarise(map, a.width, a.height, &flip);
	row->psnr_db = fmin(PSNR_EQUAL, difference.psnr_db);
	row->ssim = difference.ssim;
	row->flip = flip.mean;
	row->precision = coverage.precision;
	row->recall = coverage.recall;
	row->precision_2 = coverage.precision_within_2;
	row->recall_2 = coverage.recall_within_2;
	array_free(map);
	image_finish(&a);
	image_finish(&b);
}

/* The stretch that the car is on says what is far; from the eye. */
static struct far_limit limit_of(const struct pkg *pkg, const struct trial_row *row, const int64_t eye_mm[3])
{
	if (row->stretch == PKG_NONE)
		return (struct far_limit){ .near_m = NEAR_M };
	const struct pkg_stretch *stretch = &pkg->stretches[row->stretch];
	return (struct far_limit){
		.from_m = { (double)(stretch->start_mm[0] - eye_mm[0]) * 1e-3,
			(double)(stretch->start_mm[1] - eye_mm[1]) * 1e-3 },
		.to_m = { (double)(stretch->end_mm[0] - eye_mm[0]) * 1e-3, (double)(stretch->end_mm[1] - eye_mm[1]) * 1e-3 },
		.near_m = stretch->near_mm * 1e-3,
	};
}

static int write_map(
	const struct truth_image *reference, const float *map, const struct far_limit *limit, const char *path)
{
	size_t pixels = (size_t)reference->width * reference->height;
	struct image out = {
		.width = reference->width, .height = reference->height, .rgb = array_grow(NULL, &(size_t){ 0 }, pixels, 3)
	};
	for (size_t i = 0; i < pixels; i++) {
		bool something = map[i] >= 0.0f, far = something && far_limit_beyond(limit, &reference->pixels[i]);
		uint8_t bright = far ? 255 : 80;
		out.rgb[3 * i] = something && map[i] > 1.0f ? bright : 0;
		out.rgb[3 * i + 1] = something && isfinite(map[i]) ? bright : 0;
		out.rgb[3 * i + 2] = something ? 0 : 50;
	}
	int status = image_write_png(&out, path);
	image_finish(&out);
	return status;
}

static const struct dvec2 middle = { 0, 0 };

static struct truth_image image_of(const struct replay_frame *frame, const struct entrant *entrant, struct dvec2 at_px)
{
	struct view view;
	camera_view(
		&frame->pose, entrant->config.width, entrant->config.height, 1.0, 2.0, &view); /* slices do not matter */
	return truth_image_of(&view, at_px, entrant->truth);
}

int trial_reference(const struct replay_frame *frame, struct entrant *full, struct trial_reference *out)
{
	size_t pixels = (size_t)full->config.width * full->config.height;
	int status = entrant_read_truth(full, middle);
	*out = (struct trial_reference){
		.truth = array_grow(NULL, &(size_t){ 0 }, pixels, sizeof(*out->truth)),
		.open = array_grow(NULL, &(size_t){ 0 }, pixels, 1),
		.depths = array_grow(NULL, &(size_t){ 0 }, pixels, sizeof(*out->depths)),
		.map = array_grow(NULL, &(size_t){ 0 }, pixels, sizeof(*out->map)),
	};
	memcpy(out->truth, full->truth, pixels * sizeof(*out->truth));
	out->image = image_of(frame, full, middle);
	out->image.pixels = out->truth;
	displacement_depths(&out->image, out->depths);
	memset(out->open, 0, pixels);
	for (int i = 0; i < DISPLACEMENT_SAMPLES && !status; i++) {
		status = entrant_read_truth(full, displacement_samples[i]);
		struct truth_image sample = image_of(frame, full, displacement_samples[i]);
		holes_mark_open(&sample, out->open);
		displacement_widen(&out->image, &sample, out->depths);
	}
	return status;
}

void trial_reference_finish(struct trial_reference *reference)
{
	array_free(reference->truth);
	array_free(reference->open);
	array_free(reference->depths);
	array_free(reference->map);
	*reference = (struct trial_reference){ 0 };
}

static int displace(const struct replay_frame *frame, const struct trial_reference *reference, struct entrant *shown)
{
	displacement_begin(&reference->image, reference->map);
	for (int i = 0; i <= DISPLACEMENT_SAMPLES; i++) { /* the middle last: it stays */
		struct dvec2 at_px = i < DISPLACEMENT_SAMPLES ? displacement_samples[i] : middle;
		int status = entrant_read_truth(shown, at_px);
		if (status)
			return status;
		struct truth_image image = image_of(frame, shown, at_px);
		displacement_offer(&reference->image, reference->depths, &image, reference->map);
	}
	return 0;
}

static int compare_truth(const struct pkg *pkg, const struct replay_frame *frame,
	const struct trial_reference *reference, struct entrant *shown, struct trial_row *row, const char *picture)
{
	struct far_limit limit = limit_of(pkg, row, frame->pose.eye_mm);
	int status = displace(frame, reference, shown);
	if (status)
		return status;
	displacement_add(&row->displacement, &reference->image, reference->map, &limit);
	struct truth_image image = image_of(frame, shown, middle);
	struct holes holes;
	holes_find(&reference->image, reference->open, &image, &holes, NULL);
	row->pixels = holes.pixels;
	row->drawn = holes.drawn;
	row->uncovered = holes.uncovered;
	row->cracks = holes.cracks;
	return picture ? write_map(&reference->image, reference->map, &limit, picture) : 0;
}

int trial_compare(const struct pkg *pkg, const struct replay_frame *frame, const struct entrant *full,
	const struct trial_reference *reference, struct entrant *shown, struct trial_row *row, const char *map)
{
	row->compared = true;
	compare_pictures(full, shown, row);
	return compare_truth(pkg, frame, reference, shown, row, map);
}

int trial_write_pictures(const char *folder, uint32_t number, const struct entrant *full, const struct entrant *shown)
{
	char path[PATH_MAX];
	struct image a = rgb_of(full), b = rgb_of(shown);
	snprintf(path, sizeof(path), "%s/%s-%06u.png", folder, shown->config.name, number);
	int status = image_write_png(&b, path);
	if (status == 0 && shown != full) {
		snprintf(path, sizeof(path), "%s/%s-%06u-difference.png", folder, shown->config.name, number);
		status = image_write_difference(&a, &b, path);
	}
	image_finish(&a);
	image_finish(&b);
	return status;
}
