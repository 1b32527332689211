/* FLIP; names of constants as in the paper. Linear in pixels; every filter is separable or a sum of two that are. */
#include "tools/measure/flip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/city/pool.h"
#include "tools/measure/colour.h"
#include "tools/measure/filter.h"

#define PI 3.14159265358979323846

static const double qc = 0.7, pc = 0.4, pt = 0.95; /* remap of colour distances */
static const double qf = 0.5, wf_deg = 0.082;      /* features: exponent, line width */

struct sensitivity {
	double a[2], b[2]; /* in space: sum of a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees */
};

static const struct sensitivity sensitivities[3] = {
	{ { 1.0, 0.0 }, { 0.0047, 1e-5 } },  /* lightness */
	{ { 1.0, 0.0 }, { 0.0053, 1e-5 } },  /* red - green */
	{ { 34.1, 13.5 }, { 0.04, 0.025 } }, /* blue - yellow */
};

static float *plane_new(size_t pixels)
{
	return array_grow(NULL, &(size_t){ 0 }, pixels, sizeof(float));
}

/* One of the two Gaussians, normalised; returns the sum that it had in one dimension. */
static double sensitivity_filter(double b, int radius, double ppd, struct filter *out)
{
	double sum = 0.0;
	for (int i = -radius; i <= radius; i++)
		sum += exp(-PI * PI * (i / ppd) * (i / ppd) / b);
	out->radius = radius;
	for (int i = -radius; i <= radius; i++)
		out->weights[i + radius] = (float)(exp(-PI * PI * (i / ppd) * (i / ppd) / b) / sum);
	return sum;
}

struct blur {
	float *part, *between;
	uint32_t width, height;
};

static void blur_channel(float *plane, const struct sensitivity *s, double ppd, const struct blur *blur)
{
	int radius = (int)ceil(3.0 * sqrt(fmax(s->b[0], s->b[1]) / (2.0 * PI * PI)) * ppd);
	struct filter filters[2];
	double share[2], total = 0.0;
	for (int i = 0; i < 2; i++) {
		double sum = sensitivity_filter(s->b[i], radius, ppd, &filters[i]);
		total += share[i] = s->a[i] * sqrt(PI / s->b[i]) * sum * sum;
	}
	filter_apply(plane, blur->part, blur->between, blur->width, blur->height, &filters[0], &filters[0]);
	if (share[1] > 0.0)
		filter_apply(plane, plane, blur->between, blur->width, blur->height, &filters[1], &filters[1]);
	size_t pixels = (size_t)blur->width * blur->height;
	float first = (float)(share[0] / total), second = (float)(share[1] / total);
	for (size_t i = 0; i < pixels; i++)
		plane[i] = first * blur->part[i] + second * plane[i];
}

static struct colour hunt_lab(struct colour linear)
{
	struct colour lab = colour_lab_of_linear(linear);
	return (struct colour){ lab.x, 0.01f * lab.x * lab.y, 0.01f * lab.x * lab.z };
}

static double hyab(struct colour a, struct colour b)
{
	double da = a.y - b.y, db = a.z - b.z;
	return fabs((double)a.x - b.x) + sqrt(da * da + db * db);
}

static float clamp01(float value)
{
	return value < 0.0f ? 0.0f : value > 1.0f ? 1.0f : value;
}

static void split_ycxcz(const struct image *image, float *planes[3])
{
	float linear[256];
	for (int i = 0; i < 256; i++)
		linear[i] = colour_linear((uint8_t)i);
	size_t pixels = (size_t)image->width * image->height;
	for (size_t i = 0; i < pixels; i++) {
		const uint8_t *p = image->rgb + 3 * i;
		struct colour c = colour_ycxcz_of_linear((struct colour){ linear[p[0]], linear[p[1]], linear[p[2]] });
		planes[0][i] = c.x;
		planes[1][i] = c.y;
		planes[2][i] = c.z;
	}
}

/* What the eye sees of a picture, ready for HyAB. */
static void perceive(float *planes[3], size_t pixels, double ppd, const struct blur *blur)
{
	for (int c = 0; c < 3; c++)
		blur_channel(planes[c], &sensitivities[c], ppd, blur);
	for (size_t i = 0; i < pixels; i++) {
		struct colour rgb = colour_linear_of_ycxcz((struct colour){ planes[0][i], planes[1][i], planes[2][i] });
		struct colour lab = hunt_lab((struct colour){ clamp01(rgb.x), clamp01(rgb.y), clamp01(rgb.z) });
		planes[0][i] = lab.x;
		planes[1][i] = lab.y;
		planes[2][i] = lab.z;
	}
}

/* Gaussian, its first derivative and its second; weights above zero sum to 1, those below to -1. */
struct feature_filters {
	struct filter smooth, edge, point;
};

static void normalise_signs(struct filter *filter, const double *raw)
{
	double above = 0.0, below = 0.0;
	for (int i = 0; i <= 2 * filter->radius; i++) {
		above += fmax(raw[i], 0.0);
		below -= fmin(raw[i], 0.0);
	}
	for (int i = 0; i <= 2 * filter->radius; i++)
		filter->weights[i] = (float)(raw[i] > 0.0 ? raw[i] / above : raw[i] < 0.0 ? raw[i] / below : 0.0);
}

static void feature_filters_init(struct feature_filters *out, double ppd)
{
	double sigma = 0.5 * wf_deg * ppd, g[2 * FILTER_MAX_RADIUS + 1] = { 0 }, raw[2 * FILTER_MAX_RADIUS + 1] = { 0 };
	int radius = (int)ceil(3.0 * sigma);
	out->smooth.radius = out->edge.radius = out->point.radius = radius;
	for (int i = -radius; i <= radius; i++)
		g[i + radius] = exp(-i * i / (2.0 * sigma * sigma));
	normalise_signs(&out->smooth, g);
	/* Correlation: the kernel -x g of the paper, mirrored. Only magnitudes are used. */
	for (int i = -radius; i <= radius; i++)
		raw[i + radius] = i * g[i + radius];
	normalise_signs(&out->edge, raw);
	for (int i = -radius; i <= radius; i++)
		raw[i + radius] = (i * i / (sigma * sigma) - 1.0) * g[i + radius];
	normalise_signs(&out->point, raw);
}

/* Length of the response to a filter across and to the same down. */
static void feature_strength(
	const float *light, float *out, const struct blur *blur, const struct filter *sharp, const struct filter *smooth)
{
	size_t pixels = (size_t)blur->width * blur->height;
	filter_apply(light, out, blur->between, blur->width, blur->height, sharp, smooth);
	filter_apply(light, blur->part, blur->between, blur->width, blur->height, smooth, sharp);
	for (size_t i = 0; i < pixels; i++)
		out[i] = sqrtf(out[i] * out[i] + blur->part[i] * blur->part[i]);
}

struct picture {
	float *planes[3]; /* YCxCz, then Hunt's L*a*b* */
	float *edge, *point;
};

static void picture_init(struct picture *picture, const struct image *image, double ppd)
{
	size_t pixels = (size_t)image->width * image->height;
	struct blur blur = { plane_new(pixels), plane_new(pixels), image->width, image->height };
	struct feature_filters filters;
	feature_filters_init(&filters, ppd);
	for (int c = 0; c < 3; c++)
		picture->planes[c] = plane_new(pixels);
	picture->edge = plane_new(pixels);
	picture->point = plane_new(pixels);
	split_ycxcz(image, picture->planes);
	float *light = plane_new(pixels);
	for (size_t i = 0; i < pixels; i++)
		light[i] = (picture->planes[0][i] + 16.0f) / 116.0f;
	feature_strength(light, picture->edge, &blur, &filters.edge, &filters.smooth);
	feature_strength(light, picture->point, &blur, &filters.point, &filters.smooth);
	array_free(light);
	perceive(picture->planes, pixels, ppd, &blur);
	array_free(blur.part);
	array_free(blur.between);
}

static void picture_finish(struct picture *picture)
{
	for (int c = 0; c < 3; c++)
		array_free(picture->planes[c]);
	array_free(picture->edge);
	array_free(picture->point);
}

static double colour_error(double distance, double cmax)
{
	double value = pow(distance, qc), knee = pc * cmax;
	return value < knee ? pt / knee * value : pt + (value - knee) / (cmax - knee) * (1.0 - pt);
}

static struct colour picture_colour(const struct picture *picture, size_t i)
{
	return (struct colour){ picture->planes[0][i], picture->planes[1][i], picture->planes[2][i] };
}

void flip_map(const struct image *a, const struct image *b, double ppd, float *map)
{
	double cmax = pow(hyab(hunt_lab((struct colour){ 0, 1, 0 }), hunt_lab((struct colour){ 0, 0, 1 })), qc);
	struct picture pa, pb;
	picture_init(&pa, a, ppd);
	picture_init(&pb, b, ppd);
	size_t pixels = (size_t)a->width * a->height;
	for (size_t i = 0; i < pixels; i++) {
		double colour = colour_error(hyab(picture_colour(&pa, i), picture_colour(&pb, i)), cmax);
		double feature = fmax(fabs((double)pa.edge[i] - pb.edge[i]), fabs((double)pa.point[i] - pb.point[i]));
		feature = pow(feature / sqrt(2.0), qf);
		map[i] = colour > 0.0 ? clamp01((float)pow(colour, 1.0 - fmin(feature, 1.0))) : 0.0f;
	}
	picture_finish(&pa);
	picture_finish(&pb);
}

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static double weighted_percentile(const float *sorted, size_t count, double wanted)
{
	double sum = 0.0;
	size_t i = 0;
	for (; i + 1 < count; i++) {
		sum += sorted[i];
		if (sum >= wanted)
			break;
	}
	return sorted[i];
}

void flip_summarise(const float *map, uint32_t width, uint32_t height, struct flip_summary *out)
{
	size_t pixels = (size_t)width * height;
	float *sorted = plane_new(pixels);
	memcpy(sorted, map, pixels * sizeof(float));
	qsort(sorted, pixels, sizeof(float), by_value);
	double sum = 0.0;
	for (size_t i = 0; i < pixels; i++)
		sum += sorted[i];
	out->mean = sum / (double)pixels;
	out->max = sorted[pixels - 1];
	out->weighted_p25 = weighted_percentile(sorted, pixels, 0.25 * sum);
	out->weighted_p50 = weighted_percentile(sorted, pixels, 0.50 * sum);
	out->weighted_p75 = weighted_percentile(sorted, pixels, 0.75 * sum);
	out->weighted_p95 = weighted_percentile(sorted, pixels, 0.95 * sum);
	array_free(sorted);
}

/* Lightness rises evenly, so the map reads in grey too. */
static void heat_colour(float value, uint8_t rgb[3])
{
	static const float stops[][3] = { { 0, 0, 0 }, { 46, 16, 92 }, { 122, 28, 120 }, { 196, 54, 96 }, { 242, 110, 70 },
		{ 252, 182, 112 }, { 255, 252, 200 } };
	const int last = (int)(sizeof(stops) / sizeof(stops[0])) - 1;
	float place = clamp01(value) * (float)last;
	int from = (int)place < last ? (int)place : last - 1;
	float t = place - (float)from;
	for (int c = 0; c < 3; c++)
		rgb[c] = (uint8_t)(stops[from][c] + t * (stops[from + 1][c] - stops[from][c]) + 0.5f);
}

int flip_write_heat(const float *map, uint32_t width, uint32_t height, const char *path)
{
	size_t pixels = (size_t)width * height;
	struct image out = { .width = width, .height = height, .rgb = array_grow(NULL, &(size_t){ 0 }, pixels, 3) };
	for (size_t i = 0; i < pixels; i++)
		heat_colour(map[i], out.rgb + 3 * i);
	int status = image_write_png(&out, path);
	image_finish(&out);
	return status;
}
