/* Joining goes by samples; this looks at every pixel and takes out those that do not fit after all. Regions of such
 * pixels are looked at again: what they have in common is a border, not yet a plane. */
#include <math.h>

#include "tools/impostor/surface_merger.h"

#define PASSES 4

struct ejection {
	struct merger *merger;
	const struct surfaces_input *input;
	uint32_t *label;
	uint32_t known;             /* labels greater than this are new */
	const struct plane *planes; /* by label - 1 */
	uint32_t *from;             /* by new label - known - 1: which label its pixels had */
};

static bool is_off(const struct ejection *ejection, uint32_t pixel, double x, double y)
{
	double expected = plane_at(&ejection->planes[ejection->label[pixel] - 1], x, y);
	double off = fabs(expected - (double)ejection->input->image->pixels[pixel].disparity);
	return off > SURFACE_ERROR_MAX * (double)ejection->input->tolerance[pixel];
}

/* May a pixel go where its neighbour went? */
static bool follows(const struct ejection *ejection, uint32_t pixel, uint32_t neighbour)
{
	uint32_t label = ejection->label[neighbour];
	if (label <= ejection->known || ejection->from[label - ejection->known - 1] != ejection->label[pixel])
		return false;
	const struct capture_pixel *pixels = ejection->input->image->pixels;
	double step = (double)pixels[pixel].disparity - (double)pixels[neighbour].disparity;
	return fabs(step) <= (double)ejection->input->tolerance[pixel];
}

static void eject(struct ejection *ejection, uint32_t pixel, uint32_t x, uint32_t y)
{
	struct merger *merger = ejection->merger;
	uint32_t width = ejection->input->image->view.width, old = ejection->label[pixel];
	merger->seeds.fits.items[old - 1].pixels--;
	if (x && follows(ejection, pixel, pixel - 1)) {
		ejection->label[pixel] = ejection->label[pixel - 1];
	} else if (y && follows(ejection, pixel, pixel - width)) {
		ejection->label[pixel] = ejection->label[pixel - width];
	} else {
		uint32_t label = surface_seeds_new(&merger->seeds, &ejection->input->image->pixels[pixel]);
		ejection->label[pixel] = label;
		ejection->from[label - ejection->known - 1] = old;
	}
}

/* Returns whether there were any; `checked` labels have been looked at before. */
static bool eject_once(struct merger *merger, const struct surfaces_input *input, uint32_t *label, uint32_t checked)
{
	struct pool pool = { 0 };
	struct ejection ejection = {
		.merger = merger, .input = input, .label = label, .known = (uint32_t)merger->seeds.fits.count
	};
	struct plane *planes = POOL_ARRAY(&pool, struct plane, ejection.known + 1);
	for (uint32_t i = checked; i < ejection.known; i++)
		planes[i] = plane_fit_solve(&merger->seeds.fits.items[i]);
	ejection.planes = planes;
	ejection.from = POOL_ARRAY(&pool, uint32_t, SURFACE_SEEDS_MAX);
	const struct capture_view *view = &input->image->view;
	for (uint32_t y = 0, i = 0; y < view->height; y++)
		for (uint32_t x = 0; x < view->width; x++, i++)
			if (label[i] > checked && label[i] <= ejection.known && merger->seeds.fits.count < SURFACE_SEEDS_MAX &&
				is_off(&ejection, i, x + 0.5, y + 0.5))
				eject(&ejection, i, x, y);
	surface_seeds_sum(&merger->seeds, input, label, ejection.known);
	for (uint32_t i = ejection.known; i < merger->seeds.fits.count; i++) {
		ARRAY_PUSH(&merger->parent, i);
		ARRAY_PUSH(&merger->largest, merger->seeds.fits.items[i].pixels);
	}
	pool_finish(&pool);
	return merger->seeds.fits.count > ejection.known;
}

void surfaces_eject(struct merger *merger, const struct surfaces_input *input, uint32_t *label)
{
	uint32_t checked = 0;
	for (int pass = 0; pass < PASSES; pass++) {
		uint32_t known = (uint32_t)merger->seeds.fits.count;
		if (!eject_once(merger, input, label, checked))
			return;
		checked = known;
	}
}
