/*
 * Seeds by one pass of union-find over the image, then a fit each. What is not flat after all is cut into ever smaller
 * squares. Linear in the pixels.
 */
#include "tools/impostor/surface_seeds.h"
#include "tools/impostor/oct_normal.h"

#include <math.h>
#include <string.h>

#define LINK_SHARE 0.25 /* of the tolerance: by how much a neighbour may miss the plane of a pixel */
#define FLAT_SHARE 0.7  /* of the tolerance: by how much a pixel may miss the seed's plane */
#define GRAZING 0.01    /* least cosine between ray and normal that slopes are taken from */

struct slopes {
	const struct capture_view *view;
	int8_t oct[2];       /* what `normal` was made from */
	struct dvec3 normal; /* right, up, forward */
	bool valid;
};

static void use_normal(struct slopes *slopes, const int8_t oct[2])
{
	if (slopes->valid && slopes->oct[0] == oct[0] && slopes->oct[1] == oct[1])
		return;
	memcpy(slopes->oct, oct, sizeof(slopes->oct));
	slopes->valid = true;
	struct dvec3 n = oct_normal(oct);
	double scale = 1 / sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
	const struct capture_view *view = slopes->view;
	slopes->normal = (struct dvec3){ scale * (n.x * view->right.x + n.y * view->right.y + n.z * view->right.z),
		scale * (n.x * view->up.x + n.y * view->up.y + n.z * view->up.z),
		scale * (n.x * view->forward.x + n.y * view->forward.y + n.z * view->forward.z) };
}

/* Slopes of the disparity at a pixel whose surface has this normal: w / (n . d) is constant on a plane. */
static void slopes_at(struct slopes *slopes, const struct capture_pixel *pixel, double x, double y, double out[2])
{
	use_normal(slopes, pixel->normal_oct);
	const struct capture_view *view = slopes->view;
	double facing = slopes->normal.x * (x - view->centre_x) / view->focal_px +
					slopes->normal.y * (view->centre_y - y) / view->focal_px + slopes->normal.z;
	if (fabs(facing) < GRAZING)
		facing = facing < 0 ? -GRAZING : GRAZING;
	double scale = pixel->disparity / (facing * view->focal_px);
	out[0] = slopes->normal.x * scale;
	out[1] = -slopes->normal.y * scale;
}

static uint32_t root_of(uint32_t *parent, uint32_t item)
{
	while (parent[item] != item)
		item = parent[item] = parent[parent[item]];
	return item;
}

/* The smaller index stays the root, so roots come first in the order of pixels. */
static void unite(uint32_t *parent, uint32_t a, uint32_t b)
{
	a = root_of(parent, a);
	b = root_of(parent, b);
	if (a < b)
		parent[b] = a;
	else
		parent[a] = b;
}

static bool alike(const struct capture_pixel *a, const struct capture_pixel *b)
{
	return a->object == b->object && a->kind == b->kind && a->normal_oct[0] == b->normal_oct[0] &&
		   a->normal_oct[1] == b->normal_oct[1];
}

struct linking {
	const struct surfaces_input *input;
	struct slopes slopes;
	uint32_t *parent;
};

/* Is pixel b, one to the left or one above, on the surface of pixel a? `slope` is of the disparity on the way. */
static bool is_linked(const struct linking *linking, uint32_t a, uint32_t b, double slope)
{
	const struct capture_pixel *pixels = linking->input->image->pixels;
	double miss = (double)pixels[a].disparity - slope - pixels[b].disparity, tolerance = linking->input->tolerance[a];
	/* Without a jump: a fold may be anywhere between two pixels, so a slope may begin with the second. */
	if (linking->input->continuous)
		return fabs(miss) <= tolerance || fabs(miss + slope) <= tolerance;
	return fabs(miss) <= LINK_SHARE * tolerance;
}

static void link_pixel(struct linking *linking, uint32_t x, uint32_t y)
{
	const struct surfaces_input *input = linking->input;
	const struct capture_pixel *pixels = input->image->pixels;
	uint32_t width = input->image->view.width, i = y * width + x;
	bool left = x && input->owned[i - 1] && (input->continuous || alike(&pixels[i], &pixels[i - 1]));
	bool above = y && input->owned[i - width] && (input->continuous || alike(&pixels[i], &pixels[i - width]));
	if (!left && !above)
		return;
	double slope[2];
	slopes_at(&linking->slopes, &pixels[i], x + 0.5, y + 0.5, slope);
	if (left && is_linked(linking, i, i - 1, slope[0]))
		unite(linking->parent, i, i - 1);
	if (above && is_linked(linking, i, i - width, slope[1]))
		unite(linking->parent, i, i - width);
}

static void link_pixels(const struct surfaces_input *input, uint32_t *parent)
{
	const struct capture_view *view = &input->image->view;
	struct linking linking = { input, { .view = view }, parent };
	for (uint32_t y = 0, i = 0; y < view->height; y++) {
		for (uint32_t x = 0; x < view->width; x++, i++) {
			parent[i] = i;
			if (input->owned[i])
				link_pixel(&linking, x, y);
		}
	}
}

static struct fit_sample sample_at(const struct surfaces_input *input, uint32_t pixel)
{
	uint32_t width = input->image->view.width;
	return (struct fit_sample){ (float)(pixel % width) + 0.5f, (float)(pixel / width) + 0.5f,
		input->image->pixels[pixel].disparity, 1 / input->tolerance[pixel] };
}

uint32_t surface_seeds_new(struct surface_seeds *seeds, const struct capture_pixel *pixel)
{
	ARRAY_PUSH(&seeds->fits, (struct plane_fit){ 0 });
	ARRAY_PUSH(&seeds->kinds, *pixel);
	return (uint32_t)seeds->fits.count;
}

void surface_seeds_sum(
	struct surface_seeds *seeds, const struct surfaces_input *input, const uint32_t *label, size_t from)
{
	struct slopes slopes = { .view = &input->image->view };
	uint32_t width = slopes.view->width, count = width * slopes.view->height;
	for (uint32_t i = 0; i < count; i++) {
		if (label[i] <= from)
			continue;
		struct plane_fit *fit = &seeds->fits.items[label[i] - 1];
		struct fit_sample sample = sample_at(input, i);
		double slope[2];
		slopes_at(&slopes, &input->image->pixels[i], sample.x, sample.y, slope);
		if (fit->pixels)
			plane_fit_add(fit, sample, slope[0], slope[1]);
		else
			plane_fit_start(fit, sample, slope[0], slope[1]);
	}
}

/* Gives the pixels of seeds that are not flat new seeds by squares of `square` pixels. Returns whether there were any.
 */
static bool cut_bent(struct surface_seeds *seeds, const struct surfaces_input *input, uint32_t *label, uint32_t square,
	uint32_t *seed_of_square)
{
	uint32_t width = input->image->view.width, height = input->image->view.height;
	uint32_t known = (uint32_t)seeds->fits.count;
	size_t capacity = 0;
	struct plane *planes = array_grow(NULL, &capacity, known + 1, sizeof(*planes));
	bool *bent = array_grow(NULL, &(size_t){ 0 }, known + 1, sizeof(*bent));
	memset(bent, 0, known + 1);
	for (uint32_t i = 0; i < known; i++)
		if (seeds->fits.items[i].pixels)
			planes[i] = plane_fit_solve(&seeds->fits.items[i]);
	bool any = false;
	for (uint32_t i = 0; i < width * height; i++) {
		if (!label[i] || bent[label[i] - 1])
			continue;
		struct fit_sample sample = sample_at(input, i);
		if (plane_fit_residual(&planes[label[i] - 1], &sample) > FLAT_SHARE)
			any = bent[label[i] - 1] = true;
	}
	uint64_t bent_pixels = 0, squares = (width / square + 1) * (uint64_t)(height / square + 1);
	for (uint32_t i = 0; i < known; i++)
		bent_pixels += bent[i] ? seeds->fits.items[i].pixels : 0;
	if (known + (bent_pixels < squares ? bent_pixels : squares) > SURFACE_SEEDS_MAX) {
		any = false;
		memset(bent, 0, known);
	}
	/* Two seeds may meet in a square: the last one seen there is remembered, so some squares give more than one. */
	uint32_t columns = width / square + 1;
	memset(seed_of_square, 0, (size_t)columns * 2 * sizeof(*seed_of_square));
	for (uint32_t y = 0, i = 0; any && y < height; y++) {
		if (y % square == 0)
			memset(seed_of_square, 0, (size_t)columns * 2 * sizeof(*seed_of_square));
		for (uint32_t x = 0; x < width; x++, i++) {
			if (!label[i] || label[i] > known || !bent[label[i] - 1])
				continue;
			uint32_t *cell = &seed_of_square[2 * (x / square)], old = label[i];
			if (!cell[0] || (cell[1] != old && seeds->fits.count < SURFACE_SEEDS_MAX)) {
				cell[0] = surface_seeds_new(seeds, &input->image->pixels[i]);
				cell[1] = old;
			}
			label[i] = cell[0];
		}
	}
	for (uint32_t i = 0; i < known; i++)
		if (bent[i])
			seeds->fits.items[i].pixels = 0;
	array_free(planes);
	array_free(bent);
	if (any)
		surface_seeds_sum(seeds, input, label, known);
	return any;
}

/* Labels of roots, in the order of pixels. Returns how many. */
static uint32_t number_roots(const struct surfaces_input *input, uint32_t *parent, uint32_t *label)
{
	uint32_t count = input->image->view.width * input->image->view.height, known = 0;
	for (uint32_t i = 0; i < count; i++) {
		label[i] = 0;
		if (input->owned[i]) {
			uint32_t root = root_of(parent, i);
			label[i] = root == i ? ++known : label[root];
		}
	}
	return known;
}

/* Noise: squares instead of what is connected, ever larger until there are few enough. */
static uint32_t number_squares(const struct surfaces_input *input, uint32_t *label)
{
	uint32_t width = input->image->view.width, height = input->image->view.height, square = 2;
	while ((width / square + 1) * (uint64_t)(height / square + 1) > SURFACE_SEEDS_MAX / 2)
		square *= 2;
	for (uint32_t y = 0, i = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++, i++)
			label[i] = input->owned[i] ? y / square * (width / square + 1) + x / square + 1 : 0;
	return (width / square + 1) * (height / square + 1);
}

void surface_seeds_find(struct surface_seeds *seeds, const struct surfaces_input *input, uint32_t *label)
{
	uint32_t width = input->image->view.width, count = width * input->image->view.height;
	size_t capacity = 0;
	uint32_t *parent = array_grow(NULL, &capacity, count + 1, sizeof(*parent));
	link_pixels(input, parent);
	uint32_t known = number_roots(input, parent, label);
	bool noise = known > SURFACE_SEEDS_MAX / 2;
	if (noise)
		known = number_squares(input, label);
	seeds->fits.count = seeds->kinds.count = 0;
	for (uint32_t i = 0; i < known; i++)
		surface_seeds_new(seeds, &(struct capture_pixel){ 0 });
	for (uint32_t i = count; i-- > 0;)
		if (label[i])
			seeds->kinds.items[label[i] - 1] = input->image->pixels[i];
	surface_seeds_sum(seeds, input, label, 0);
	uint32_t *seed_of_square = array_grow(NULL, &(size_t){ 0 }, 2 * ((size_t)width + 1), sizeof(uint32_t));
	for (uint32_t square = 32; !noise && !input->continuous && square && seeds->fits.count < SURFACE_SEEDS_MAX / 2;
		 square /= 2)
		if (!cut_bent(seeds, input, label, square, seed_of_square))
			break;
	array_free(seed_of_square);
	array_free(parent);
}

void surface_seeds_finish(struct surface_seeds *seeds)
{
	ARRAY_FINISH(&seeds->fits);
	ARRAY_FINISH(&seeds->kinds);
}
