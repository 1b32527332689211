/*
 * One capture into patches: surfaces, sheets, their triangles, and the error that is left.
 *
 * How tau is shared out: a plane may miss its pixels by PLANE_SHARE of it, by SURFACE_ERROR_MAX times that at most;
 * vertices on a border between two planes take the mean of the two, which adds at most half of JOIN_SHARE there. The
 * contours' own error is no displacement: the texture shows each pixel on the plane that it belongs to. What is left
 * are places within INNER_PX of a border between joined surfaces, that the other surface shows.
 */
#include <math.h>
#include <string.h>

#include "tools/impostor/displacement.h"
#include "tools/impostor/sheet_mesh.h"
#include "tools/impostor/triangle_rows.h"

/* Pixels at the corners of a screen, 16 to 9 and 45 degrees high, to an angle, over those in its middle: what turns
 * into view keeps tau there too. */
#define CORNER_STRETCH 1.72
#define PLANE_SHARE 0.9
#define JOIN_SHARE 0.2
/* These are pixels of the screen, whatever the capture's resolution. */
#define GUARD_PX 2.5
#define SEAM_PX 1.6
#define CLOSE_PX 5.0
#define RING_PX 1.2
#define REACH_PX 6.5
#define PRICE_PX2 51.0
#define INNER_PX 0.8 /* but a pixel of the capture at least */
#define SWALLOW_PX2 10.0
/* Of the regular grid: its contours keep nearer to the pixels, whose disparities they take. */
#define GRID_PX 16
#define GRID_REACH_PX 1.6
#define GRID_PRICE_PX2 2.5
/* With too many triangles, tau grows by the excess to this power, from one try to the next by more at least. */
#define COARSER_POWER 0.8
#define COARSER_MIN 1.25
#define COARSER_MAX 4.0
#define TRIES 12

struct meshing {
	const struct impostor_capture *capture;
	const struct impostor_options *options;
	struct displacement displacement;
	struct foliage_light foliage;
	uint32_t width, height;
	double per_px; /* pixels of the capture in one of the screen, in its middle */
	uint8_t *owned, *open_below;
	float *tolerance, *scaled; /* of disparity for tau; the same, for this try */
	float *error_px;           /* by pixel; negative: not shown */
	uint32_t pixels;           /* owned */
	struct sheet_mesher mesher;
};

static void *image_bytes(const struct meshing *meshing, size_t bytes)
{
	size_t capacity = 0, count = (size_t)meshing->width * meshing->height + 1;
	void *out = array_grow(NULL, &capacity, count, bytes);
	memset(out, 0, count * bytes);
	return out;
}

static void find_owned(struct meshing *meshing, const uint8_t *owner)
{
	const struct impostor_capture *capture = meshing->capture;
	for (uint32_t i = 0; i < meshing->width * meshing->height; i++) {
		const struct capture_pixel *pixel = &capture->image.pixels[i];
		bool shown = pixel->object && owner[i] && (!capture->wanted || capture->wanted[i]) && pixel->disparity > 0 &&
					 isfinite(pixel->disparity);
		meshing->owned[i] = shown;
		meshing->pixels += shown;
	}
	for (uint32_t y = meshing->height; y-- > 0;) {
		for (uint32_t x = 0; x < meshing->width; x++) {
			uint32_t i = y * meshing->width + x;
			bool below = y + 1 == meshing->height || meshing->open_below[i + meshing->width];
			meshing->open_below[i] = below && !capture->image.pixels[i].object;
		}
	}
}

static float largest_disparity(const struct meshing *meshing)
{
	float largest = 0;
	for (uint32_t i = 0; i < meshing->width * meshing->height; i++)
		if (meshing->owned[i])
			largest = fmaxf(largest, meshing->capture->image.pixels[i].disparity);
	return largest;
}

static double tau_px(const struct impostor_options *options)
{
	return options->tau_px > 0 ? options->tau_px : 1;
}

static void find_tolerances(struct meshing *meshing)
{
	for (uint32_t y = 0, i = 0; y < meshing->height; y++)
		for (uint32_t x = 0; x < meshing->width; x++, i++)
			if (meshing->owned[i])
				meshing->tolerance[i] = (float)displacement_tolerance(&meshing->displacement, x + 0.5, y + 0.5,
					meshing->capture->image.pixels[i].disparity, tau_px(meshing->options));
}

static void scale_tolerances(struct meshing *meshing, double factor)
{
	for (uint32_t i = 0; i < meshing->width * meshing->height; i++)
		meshing->scaled[i] = meshing->tolerance[i] * (float)factor;
}

static uint32_t capture_px(const struct meshing *meshing, double screen_px)
{
	return (uint32_t)lround(screen_px * meshing->per_px);
}

static double capture_px2(const struct meshing *meshing, double screen_px2)
{
	return screen_px2 * meshing->per_px * meshing->per_px;
}

static struct surfaces_input surfaces_input_of(const struct meshing *meshing, double coarse)
{
	return (struct surfaces_input){ .image = &meshing->capture->image,
		.continuous = meshing->options->interior == IMPOSTOR_GRID,
		.owned = meshing->owned,
		.tolerance = meshing->scaled,
		.per_px = meshing->per_px,
		.gap_px = 2.0f * (float)capture_px(meshing, CLOSE_PX),
		.swallow_px = (uint32_t)lround(capture_px2(meshing, SWALLOW_PX2) * coarse) };
}

static struct sheet_options sheet_options_of(const struct meshing *meshing, double coarse, uint8_t view)
{
	const struct impostor_options *options = meshing->options;
	if (options->interior == IMPOSTOR_GRID)
		return (struct sheet_options){ .per_px = meshing->per_px,
			.ring_px = capture_px(meshing, RING_PX),
			.seam_px = capture_px(meshing, SEAM_PX),
			.reach_px = capture_px(meshing, GRID_REACH_PX),
			.price_px2 = capture_px2(meshing, GRID_PRICE_PX2) * coarse,
			.grid_px = (uint32_t)((options->grid_px ? options->grid_px : GRID_PX) * coarse),
			.view = view };
	return (struct sheet_options){ .per_px = meshing->per_px,
		.guard_px = capture_px(meshing, GUARD_PX),
		.seam_px = capture_px(meshing, SEAM_PX),
		.ring_px = capture_px(meshing, RING_PX),
		.close_px = capture_px(meshing, CLOSE_PX),
		.reach_px = capture_px(meshing, REACH_PX),
		.price_px2 = capture_px2(meshing, PRICE_PX2) * coarse,
		.inner_px = fmax(1, INNER_PX * meshing->per_px) * sqrt(coarse),
		.view = view };
}

/* Appends the capture's patches, with tolerances widened by `factor`. */
static void mesh_once(struct meshing *meshing, double factor, uint8_t view, struct impostor_mesh *mesh)
{
	double coarse = fmax(factor, 1);
	bool grid = meshing->options->interior == IMPOSTOR_GRID;
	scale_tolerances(meshing, grid ? factor : factor * PLANE_SHARE);
	struct surfaces surfaces;
	struct surfaces_input input = surfaces_input_of(meshing, coarse);
	surfaces_find(&surfaces, &input);
	struct sheets sheets = { 0 };
	scale_tolerances(meshing, factor);
	sheets_find(&sheets, &surfaces, meshing->scaled, grid ? -1 : JOIN_SHARE);
	struct sheet_source source = { .image = &meshing->capture->image,
		.surfaces = &surfaces,
		.sheets = &sheets,
		.tolerance = meshing->scaled,
		.displacement = &meshing->displacement,
		.tau_px = tau_px(meshing->options) * factor,
		.foliage = &meshing->foliage,
		.open_below = meshing->open_below,
		.options = sheet_options_of(meshing, coarse, view) };
	for (uint32_t i = 0; i + 1 < sheets.first.count; i++)
		sheet_mesh(&meshing->mesher, &source, i, mesh);
	sheets_finish(&sheets);
	surfaces_finish(&surfaces);
}

static void measure_triangle(
	struct meshing *meshing, const struct impostor_mesh *mesh, const struct mesh_patch *patch, const uint32_t index[3])
{
	const struct mesh_vertex *corner[3];
	double x[3], y[3], w[3];
	for (int i = 0; i < 3; i++) {
		corner[i] = &mesh->vertices.items[patch->first_vertex + index[i]];
		x[i] = corner[i]->x;
		y[i] = corner[i]->y;
		w[i] = corner[i]->disparity;
	}
	double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
	double slope_x = ((w[1] - w[0]) * (y[2] - y[0]) - (w[2] - w[0]) * (y[1] - y[0])) / area;
	double slope_y = ((w[2] - w[0]) * (x[1] - x[0]) - (w[1] - w[0]) * (x[2] - x[0])) / area;
	uint32_t columns = patch->max_x - patch->min_x + 1u;
	struct pixel_run rows = triangle_rows(y, (int32_t)meshing->height);
	for (int32_t row = rows.from; row < rows.to; row++) {
		struct pixel_run run = triangle_run(x, y, row, (int32_t)meshing->width);
		for (int32_t column = run.from; column < run.to; column++) {
			uint32_t pixel = (uint32_t)row * meshing->width + (uint32_t)column;
			size_t texel = patch->first_texel + ((uint32_t)row - patch->min_y) * (size_t)columns +
						   ((uint32_t)column - patch->min_x);
			if (!meshing->owned[pixel] || mesh->texels.items[texel] != MESH_SHOW)
				continue;
			double drawn = w[0] + slope_x * (column + 0.5 - x[0]) + slope_y * (row + 0.5 - y[0]);
			double error = displacement_px(&meshing->displacement, column + 0.5, row + 0.5,
				meshing->capture->image.pixels[pixel].disparity, drawn);
			meshing->error_px[pixel] = fmaxf(meshing->error_px[pixel], (float)error);
		}
	}
}

/* Draws the capture's patches and compares every pixel that is to be shown. Of patches that overlap any may be in front
 * from somewhere: the largest error counts. */
static void measure(struct meshing *meshing, size_t first_patch, struct impostor_mesh *mesh)
{
	for (uint32_t i = 0; i < meshing->width * meshing->height; i++)
		meshing->error_px[i] = -1;
	for (size_t i = first_patch; i < mesh->patches.count; i++) {
		const struct mesh_patch *patch = &mesh->patches.items[i];
		for (uint32_t k = 0; k < patch->index_count; k += 3)
			measure_triangle(meshing, mesh, patch, mesh->indices.items + patch->first_index + k);
	}
	for (uint32_t i = 0; i < meshing->width * meshing->height; i++) {
		if (!meshing->owned[i])
			continue;
		mesh->over_px += meshing->error_px[i] < 0 || (double)meshing->error_px[i] > tau_px(meshing->options);
		mesh->error_px = fmax(mesh->error_px, (double)meshing->error_px[i]);
	}
	mesh->shown_px += meshing->pixels;
	mesh->over_share = (double)mesh->over_px / (double)mesh->shown_px;
}

static void cut_back(struct impostor_mesh *mesh, const struct impostor_mesh *to)
{
	mesh->vertices.count = to->vertices.count;
	mesh->indices.count = to->indices.count;
	mesh->patches.count = to->patches.count;
	mesh->texels.count = to->texels.count;
}

/* With ever wider tolerances, until there are few enough triangles. What needs too many in any case is left out. */
static void mesh_within(struct meshing *meshing, uint8_t view, struct impostor_mesh *mesh)
{
	const struct impostor_mesh before = *mesh;
	size_t used = before.indices.count / 3, limit = SIZE_MAX;
	if (meshing->options->triangles_max)
		limit = meshing->options->triangles_max > used ? meshing->options->triangles_max - used : 0;
	double factor = 1;
	for (int i = 0; i < TRIES && limit; i++) {
		mesh_once(meshing, factor, view, mesh);
		size_t made = mesh->indices.count / 3 - used;
		if (made <= limit)
			return;
		cut_back(mesh, &before);
		factor *= fmin(fmax(pow((double)made / (double)limit, COARSER_POWER), COARSER_MIN * (i + 1)), COARSER_MAX);
	}
}

void impostor_mesh_add(struct impostor_mesh *mesh, const struct view_cell *cell, const struct impostor_capture *capture,
	const uint8_t *owner, uint8_t view, const struct impostor_options *options)
{
	struct meshing meshing = {
		.capture = capture, .options = options, .width = capture->image.view.width, .height = capture->image.view.height
	};
	meshing.per_px = capture->image.view.focal_px / options->focal_px;
	meshing.owned = image_bytes(&meshing, 1);
	meshing.open_below = image_bytes(&meshing, 1);
	find_owned(&meshing, owner);
	if (meshing.pixels) {
		meshing.tolerance = image_bytes(&meshing, sizeof(float));
		meshing.scaled = image_bytes(&meshing, sizeof(float));
		meshing.error_px = image_bytes(&meshing, sizeof(float));
		displacement_init(&meshing.displacement, cell, &capture->image.view, options->focal_px * CORNER_STRETCH,
			(double)largest_disparity(&meshing));
		find_tolerances(&meshing);
		foliage_light_find(&meshing.foliage, &capture->image);
		size_t first_patch = mesh->patches.count;
		mesh_within(&meshing, view, mesh);
		measure(&meshing, first_patch, mesh);
		displacement_finish(&meshing.displacement);
		foliage_light_finish(&meshing.foliage);
	}
	sheet_mesher_finish(&meshing.mesher);
	array_free(meshing.owned);
	array_free(meshing.open_below);
	array_free(meshing.tolerance);
	array_free(meshing.scaled);
	array_free(meshing.error_px);
}
