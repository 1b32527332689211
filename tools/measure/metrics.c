/* Image measures; linear in the number of pixels, SSIM by separable windows. */
#include "tools/measure/metrics.h"

#include <math.h>
#include <stdlib.h>

#include "tools/city/pool.h"

#define WINDOW 11
#define RADIUS (WINDOW / 2)

static void compare_channels(const struct image *a, const struct image *b, struct image_difference *out)
{
	size_t pixels = (size_t)a->width * a->height, differing = 0, within = 0;
	double sum = 0.0, squares = 0.0;
	for (size_t i = 0; i < pixels; i++) {
		int worst = 0;
		for (size_t c = 0; c < 3; c++) {
			int d = abs(a->rgb[3 * i + c] - b->rgb[3 * i + c]);
			worst = d > worst ? d : worst;
			sum += d;
			squares += (double)d * d;
		}
		differing += worst > 0;
		within += worst <= 2;
		out->max = worst > out->max ? worst : out->max;
	}
	out->mean = sum / (3.0 * (double)pixels);
	out->mse = squares / (3.0 * (double)pixels);
	out->psnr_db = out->mse > 0.0 ? 10.0 * log10(255.0 * 255.0 / out->mse) : INFINITY;
	out->differing = (double)differing / (double)pixels;
	out->within_2 = (double)within / (double)pixels;
}

/* Luma of ITU-R BT.601. */
static double *luma_of(const struct image *image)
{
	size_t pixels = (size_t)image->width * image->height;
	double *out = array_grow(NULL, &(size_t){ 0 }, pixels, sizeof(double));
	for (size_t i = 0; i < pixels; i++)
		out[i] = 0.299 * image->rgb[3 * i] + 0.587 * image->rgb[3 * i + 1] + 0.114 * image->rgb[3 * i + 2];
	return out;
}

static void window_weights(double weights[WINDOW])
{
	double sum = 0.0;
	for (int i = 0; i < WINDOW; i++)
		sum += weights[i] = exp(-(i - RADIUS) * (i - RADIUS) / (2.0 * 1.5 * 1.5));
	for (int i = 0; i < WINDOW; i++)
		weights[i] /= sum;
}

/* Five moments of a window: means, squares, product. */
struct moments {
	double a, b, aa, bb, ab;
};

static struct moments moments_add(struct moments sum, struct moments add, double weight)
{
	return (struct moments){ sum.a + weight * add.a, sum.b + weight * add.b, sum.aa + weight * add.aa,
		sum.bb + weight * add.bb, sum.ab + weight * add.ab };
}

static double ssim_of(struct moments m)
{
	const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
	double va = m.aa - m.a * m.a, vb = m.bb - m.b * m.b, cov = m.ab - m.a * m.b;
	return (2 * m.a * m.b + c1) * (2 * cov + c2) / ((m.a * m.a + m.b * m.b + c1) * (va + vb + c2));
}

static double mean_ssim(const double *a, const double *b, uint32_t width, uint32_t height)
{
	double weights[WINDOW], sum = 0.0;
	window_weights(weights);
	uint32_t columns = width - WINDOW + 1, rows = height - WINDOW + 1;
	/* Horizontal pass over all rows, then vertical. */
	struct moments *lines = array_grow(NULL, &(size_t){ 0 }, (size_t)columns * height, sizeof(*lines));
	for (uint32_t y = 0; y < height; y++) {
		for (uint32_t x = 0; x < columns; x++) {
			struct moments m = { 0 };
			for (uint32_t k = 0; k < WINDOW; k++) {
				double va = a[(size_t)y * width + x + k], vb = b[(size_t)y * width + x + k];
				m = moments_add(m, (struct moments){ va, vb, va * va, vb * vb, va * vb }, weights[k]);
			}
			lines[(size_t)y * columns + x] = m;
		}
	}
	for (uint32_t y = 0; y < rows; y++) {
		for (uint32_t x = 0; x < columns; x++) {
			struct moments m = { 0 };
			for (uint32_t k = 0; k < WINDOW; k++)
				m = moments_add(m, lines[(size_t)(y + k) * columns + x], weights[k]);
			sum += ssim_of(m);
		}
	}
	array_free(lines);
	return sum / ((double)columns * rows);
}

void image_compare(const struct image *a, const struct image *b, struct image_difference *out)
{
	*out = (struct image_difference){ 0 };
	compare_channels(a, b, out);
	if (a->width < WINDOW || a->height < WINDOW) {
		out->ssim = out->max == 0;
		return;
	}
	double *luma_a = luma_of(a), *luma_b = luma_of(b);
	out->ssim = mean_ssim(luma_a, luma_b, a->width, a->height);
	array_free(luma_a);
	array_free(luma_b);
}

int image_write_difference(const struct image *a, const struct image *b, const char *path)
{
	size_t bytes = (size_t)a->width * a->height * 3;
	struct image out = { .width = a->width, .height = a->height, .rgb = array_grow(NULL, &(size_t){ 0 }, bytes, 1) };
	for (size_t i = 0; i < bytes; i++) {
		int value = 128 + 8 * (b->rgb[i] - a->rgb[i]);
		out.rgb[i] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
	}
	int status = image_write_png(&out, path);
	image_finish(&out);
	return status;
}
