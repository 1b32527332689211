#include "tools/read/terrain.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <errno.h>
#include <gdal.h>
#include <ogr_srs_api.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/read/gdal_quiet.h"

#define MARGIN_M 300.0
#define POSTS_LIMIT 6000000.0
#define WINDOW_LIMIT 100000000.0
#define LOWEST_M (-500.0)
#define HIGHEST_M 9000.0
/* Heights from space have the houses in them and jump by whole metres: smoothed over this part of their spacing. */
#define SMOOTHING 0.8
#define COARSE_SOURCE_M 15.0

/* The part of one file that the city needs, in the file's own pixels. */
struct window {
	const char *path;
	double to_pixel[6]; /* inverse geotransform */
	int left, top, columns, rows;
	float *height_m; /* NAN: void, until filled */
	OGRCoordinateTransformationH from_wgs84;
	double step_m;
};

double field_at(const struct height_field *field, struct dvec2 at)
{
	double x = fmin(fmax((at.x - field->origin.x) / field->step_m, 0.0), (double)field->columns - 1.0);
	double y = fmin(fmax((at.y - field->origin.y) / field->step_m, 0.0), (double)field->rows - 1.0);
	size_t col = (size_t)fmin(x, (double)field->columns - 2.0), row = (size_t)fmin(y, (double)field->rows - 2.0);
	const float *south = field->height_m + row * field->columns + col, *north = south + field->columns;
	double fx = x - (double)col, fy = y - (double)row;
	return (1.0 - fy) * ((1.0 - fx) * (double)south[0] + fx * (double)south[1]) +
		   fy * ((1.0 - fx) * (double)north[0] + fx * (double)north[1]);
}

static void lay_out(struct height_field *field, const struct city *city)
{
	double width = city->max.x - city->min.x + 2.0 * MARGIN_M, height = city->max.y - city->min.y + 2.0 * MARGIN_M;
	double longest = fmax(width, height);
	field->step_m = longest <= 8000.0 ? 8.0 : longest <= 14000.0 ? 12.0 : 16.0;
	while ((width / field->step_m + 2.0) * (height / field->step_m + 2.0) > POSTS_LIMIT)
		field->step_m += 4.0;
	/* Whole metres: the origin is kept in millimetres. */
	field->origin = (struct dvec2){ floor(city->min.x - MARGIN_M), floor(city->min.y - MARGIN_M) };
	field->columns = (size_t)ceil(width / field->step_m) + 2;
	field->rows = (size_t)ceil(height / field->step_m) + 2;
	size_t capacity = 0;
	field->height_m = array_grow(NULL, &capacity, field->columns * field->rows, sizeof(float));
}

/* "/vsizip/FILE.zip/INNER" for archives: the first inside with a raster's ending. */
static char *inner_path(const char *path)
{
	size_t length = strlen(path);
	if (length < 4 || strcasecmp(path + length - 4, ".zip") != 0)
		return strdup(path);
	char *folder = NULL, *out = NULL;
	if (asprintf(&folder, "/vsizip/%s", path) < 0)
		return NULL;
	char **names = VSIReadDir(folder);
	for (char **name = names; name && *name && !out; name++) {
		const char *dot = strrchr(*name, '.');
		if (dot && (!strcasecmp(dot, ".hgt") || !strcasecmp(dot, ".tif") || !strcasecmp(dot, ".tiff")) &&
			asprintf(&out, "%s/%s", folder, *name) < 0)
			out = NULL;
	}
	CSLDestroy(names);
	free(folder);
	return out;
}

static OGRCoordinateTransformationH transformation_to(GDALDatasetH dataset)
{
	OGRSpatialReferenceH wgs84 = OSRNewSpatialReference(NULL), own = GDALGetSpatialRef(dataset);
	OSRImportFromEPSG(wgs84, 4326);
	OSRSetAxisMappingStrategy(wgs84, OAMS_TRADITIONAL_GIS_ORDER);
	OGRSpatialReferenceH target = own ? OSRClone(own) : OSRClone(wgs84);
	OSRSetAxisMappingStrategy(target, OAMS_TRADITIONAL_GIS_ORDER);
	OGRCoordinateTransformationH out = OCTNewCoordinateTransformation(wgs84, target);
	OSRDestroySpatialReference(wgs84);
	OSRDestroySpatialReference(target);
	return out;
}

/* Pixel coordinates of a place; pixel centres are at .5. */
static bool pixel_of(const struct window *window, const struct city *city, struct dvec2 at, struct dvec2 *out)
{
	struct geo_point geo = geo_from_plane(&city->frame, at);
	double x = geo.lon_deg, y = geo.lat_deg;
	if (!OCTTransform(window->from_wgs84, 1, &x, &y, NULL))
		return false;
	const double *t = window->to_pixel;
	*out = (struct dvec2){ t[0] + x * t[1] + y * t[2], t[3] + x * t[4] + y * t[5] };
	return isfinite(out->x) && isfinite(out->y);
}

/* The pixels that the grid's border covers, and some more to interpolate with; false when the file lies elsewhere. */
static bool find_window(
	struct window *window, const struct city *city, const struct height_field *field, int width, int height)
{
	struct dvec2 low = { INFINITY, INFINITY }, high = { -INFINITY, -INFINITY };
	for (size_t i = 0; i <= 8; i++) {
		for (size_t j = 0; j <= 8; j++) {
			struct dvec2 pixel, at = field_place(field, (field->columns - 1) * i / 8, (field->rows - 1) * j / 8);
			if (!pixel_of(window, city, at, &pixel))
				continue;
			low = (struct dvec2){ fmin(low.x, pixel.x), fmin(low.y, pixel.y) };
			high = (struct dvec2){ fmax(high.x, pixel.x), fmax(high.y, pixel.y) };
		}
	}
	low = (struct dvec2){ fmax(floor(low.x) - 4.0, 0.0), fmax(floor(low.y) - 4.0, 0.0) };
	high = (struct dvec2){ fmin(ceil(high.x) + 4.0, width), fmin(ceil(high.y) + 4.0, height) };
	if (!(high.x - low.x >= 2.0 && high.y - low.y >= 2.0) || (high.x - low.x) * (high.y - low.y) > WINDOW_LIMIT)
		return false;
	window->left = (int)low.x;
	window->top = (int)low.y;
	window->columns = (int)(high.x - low.x);
	window->rows = (int)(high.y - low.y);
	struct dvec2 a, b, middle = field_place(field, field->columns / 2, field->rows / 2);
	window->step_m = 30.0;
	if (pixel_of(window, city, middle, &a) &&
		pixel_of(window, city, dvec2_add(middle, (struct dvec2){ 0.0, 100.0 }), &b))
		window->step_m = 100.0 / fmax(dvec2_length(dvec2_sub(a, b)), 1e-3);
	return true;
}

static int read_window(struct window *window, GDALRasterBandH band)
{
	size_t count = (size_t)window->columns * (size_t)window->rows, capacity = 0;
	int has_void = 0;
	double none = GDALGetRasterNoDataValue(band, &has_void);
	window->height_m = array_grow(NULL, &capacity, count, sizeof(float));
	if (GDALRasterIO(band, GF_Read, window->left, window->top, window->columns, window->rows, window->height_m,
			window->columns, window->rows, GDT_Float32, 0, 0) != CE_None) {
		log_error("%s: rows %d to %d: cannot read heights: %s", window->path, window->top,
			window->top + window->rows - 1, CPLGetLastErrorMsg());
		return -EBADMSG;
	}
	for (size_t i = 0; i < count; i++) {
		double height = (double)window->height_m[i];
		if ((has_void && height == none) || !(height > LOWEST_M && height < HIGHEST_M))
			window->height_m[i] = NAN;
	}
	return 0;
}

/* Mean of the neighbours that are known, ring by ring from the rim of each void. */
static void fill_voids(struct window *window, struct report *report)
{
	size_t columns = (size_t)window->columns, rows = (size_t)window->rows, left = 0, known = 0;
	for (size_t i = 0; i < columns * rows; i++)
		*(isnan(window->height_m[i]) ? &left : &known) += 1;
	if (!known)
		return;
	size_t capacity = 0;
	float *next = array_grow(NULL, &capacity, columns * rows, sizeof(float));
	while (left) {
		memcpy(next, window->height_m, columns * rows * sizeof(float));
		for (size_t i = 0; i < columns * rows; i++) {
			double sum = 0.0;
			int count = 0;
			for (int k = 0; isnan(window->height_m[i]) && k < 9; k++) {
				size_t col = i % columns + (size_t)(k % 3) - 1, row = i / columns + (size_t)(k / 3) - 1;
				if (col >= columns || row >= rows || isnan(window->height_m[row * columns + col]))
					continue;
				sum += (double)window->height_m[row * columns + col];
				count++;
			}
			if (!count)
				continue;
			next[i] = (float)(sum / count);
			report_fault(report, FAULT_TERRAIN_VOID, FAULT_MENDED, (int64_t)i);
			left--;
		}
		memcpy(window->height_m, next, columns * rows * sizeof(float));
	}
	array_free(next);
}

static void window_close(struct window *window)
{
	array_free(window->height_m);
	if (window->from_wgs84)
		OCTDestroyCoordinateTransformation(window->from_wgs84);
	*window = (struct window){ 0 };
}

/* Returns 1 when the file has nothing for the city. */
static int window_open(struct window *window, const char *path, struct city *city, const struct height_field *field)
{
	char *inner = inner_path(path);
	*window = (struct window){ .path = path };
	GDALDatasetH dataset = inner ? GDALOpenEx(inner, GDAL_OF_RASTER | GDAL_OF_READONLY, NULL, NULL, NULL) : NULL;
	free(inner);
	if (!dataset) {
		log_error("%s: no elevation file that can be read: %s", path, gdal_reason("not a raster"));
		return -EBADMSG;
	}
	double transform[6];
	int status = 0;
	if (GDALGetRasterCount(dataset) < 1 || GDALGetGeoTransform(dataset, transform) != CE_None ||
		!GDALInvGeoTransform(transform, window->to_pixel) || !(window->from_wgs84 = transformation_to(dataset))) {
		log_error("%s: does not say where on earth it is", path);
		status = -EBADMSG;
	} else if (!find_window(window, city, field, GDALGetRasterXSize(dataset), GDALGetRasterYSize(dataset))) {
		status = 1;
	} else {
		status = read_window(window, GDALGetRasterBand(dataset, 1));
	}
	if (!status)
		fill_voids(window, city->report);
	GDALClose(dataset);
	if (status)
		window_close(window);
	return status;
}

/* Catmull and Rom's cubic through four posts. */
static double cubic(double a, double b, double c, double d, double t)
{
	return b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
}

static double post(const struct window *window, int col, int row)
{
	col = col < 0 ? 0 : col >= window->columns ? window->columns - 1 : col;
	row = row < 0 ? 0 : row >= window->rows ? window->rows - 1 : row;
	return (double)window->height_m[(size_t)row * (size_t)window->columns + (size_t)col];
}

static bool sample(const struct window *window, const struct city *city, struct dvec2 at, double *out)
{
	struct dvec2 pixel;
	if (!window->height_m || !pixel_of(window, city, at, &pixel))
		return false;
	double x = pixel.x - 0.5 - window->left, y = pixel.y - 0.5 - window->top;
	if (x < -0.51 || y < -0.51 || x > window->columns - 0.49 || y > window->rows - 0.49)
		return false;
	int col = (int)floor(x), row = (int)floor(y);
	double lines[4];
	for (int i = 0; i < 4; i++)
		lines[i] = cubic(post(window, col - 1, row - 1 + i), post(window, col, row - 1 + i),
			post(window, col + 1, row - 1 + i), post(window, col + 2, row - 1 + i), x - col);
	*out = cubic(lines[0], lines[1], lines[2], lines[3], y - row);
	return isfinite(*out);
}

/* Returns how many posts no file has. */
static size_t sample_all(
	struct height_field *field, const struct city *city, const struct window *windows, size_t count)
{
	size_t missing = 0;
	for (size_t row = 0; row < field->rows; row++) {
		for (size_t col = 0; col < field->columns; col++) {
			double height = NAN;
			for (size_t i = 0; i < count; i++)
				if (sample(&windows[i], city, field_place(field, col, row), &height))
					break;
			field->height_m[row * field->columns + col] = (float)height;
			missing += isnan(height) ? 1 : 0;
		}
	}
	return missing;
}

/* What the files leave open at the city's edge continues the closest height, by rows and then by columns. */
static void extend_line(float *line, size_t count, size_t stride)
{
	for (size_t i = 1; i < count; i++)
		if (isnan(line[i * stride]))
			line[i * stride] = line[(i - 1) * stride];
	for (size_t i = count - 1; i-- > 0;)
		if (isnan(line[i * stride]))
			line[i * stride] = line[(i + 1) * stride];
}

static void blur_line(float *line, size_t count, size_t stride, const double *kernel, size_t radius, float *spare)
{
	for (size_t i = 0; i < count; i++) {
		double sum = 0.0;
		for (size_t k = 0; k <= 2 * radius; k++) {
			size_t j = i + k < radius ? 0 : i + k - radius;
			sum += kernel[k] * (double)line[(j < count ? j : count - 1) * stride];
		}
		spare[i] = (float)sum;
	}
	for (size_t i = 0; i < count; i++)
		line[i * stride] = spare[i];
}

static void smooth(struct height_field *field)
{
	double sigma = SMOOTHING * field->source_step_m / field->step_m;
	size_t radius = (size_t)(2.5 * sigma + 1.0), capacity = 0,
		   most = field->columns > field->rows ? field->columns : field->rows;
	if (field->source_step_m < COARSE_SOURCE_M || radius > 64)
		return;
	double kernel[129], sum = 0.0;
	for (size_t k = 0; k <= 2 * radius; k++) {
		double d = ((double)k - (double)radius) / sigma;
		sum += kernel[k] = exp(-0.5 * d * d);
	}
	for (size_t k = 0; k <= 2 * radius; k++)
		kernel[k] /= sum;
	float *spare = array_grow(NULL, &capacity, most, sizeof(float));
	for (size_t row = 0; row < field->rows; row++)
		blur_line(field->height_m + row * field->columns, field->columns, 1, kernel, radius, spare);
	for (size_t col = 0; col < field->columns; col++)
		blur_line(field->height_m + col, field->rows, field->columns, kernel, radius, spare);
	array_free(spare);
}

static void store(struct city *city, const struct height_field *field)
{
	size_t count = field->columns * field->rows, capacity = 0;
	city->terrain.height_mm = array_grow(NULL, &capacity, count, sizeof(int32_t));
	for (size_t i = 0; i < count; i++)
		city->terrain.height_mm[i] = (int32_t)lround((double)field->height_m[i] * 1000.0);
	city->terrain.grid = (struct pkg_height_grid){
		.origin_mm = { (int32_t)lround(field->origin.x * 1000.0), (int32_t)lround(field->origin.y * 1000.0) },
		.step_mm = (uint32_t)lround(field->step_m * 1000.0),
		.columns = (uint32_t)field->columns,
		.rows = (uint32_t)field->rows,
	};
}

static int fill_field(
	struct height_field *field, struct city *city, const char *const *files, const struct window *windows, size_t count)
{
	size_t total = field->columns * field->rows, missing = sample_all(field, city, windows, count);
	if (missing == total) {
		log_error("%s: has no heights for the city (at %.4f, %.4f)", files[0], city->frame.origin.lat_deg,
			city->frame.origin.lon_deg);
		return -EBADMSG;
	}
	if (missing) {
		log_warn("%s: %zu %% of the city lies outside the elevation files; its edge is continued", files[0],
			missing * 100 / total);
		for (size_t i = 0; i < missing; i++)
			report_fault(city->report, FAULT_TERRAIN_VOID, FAULT_MENDED, 0);
		for (size_t row = 0; row < field->rows; row++)
			extend_line(field->height_m + row * field->columns, field->columns, 1);
		for (size_t col = 0; col < field->columns; col++)
			extend_line(field->height_m + col, field->rows, field->columns);
	}
	for (size_t i = 0; i < count; i++)
		field->source_step_m = fmax(field->source_step_m, windows[i].step_m);
	smooth(field);
	return 0;
}

static int read_files(struct height_field *field, struct city *city, const char *const *files, size_t count)
{
	int status = 0;
	struct window *windows = calloc(count, sizeof(*windows));
	if (!windows)
		return -ENOMEM;
	gdal_start();
	for (size_t i = 0; i < count && status >= 0; i++)
		status = window_open(&windows[i], files[i], city, field);
	if (status >= 0)
		status = fill_field(field, city, files, windows, count);
	for (size_t i = 0; i < count; i++)
		window_close(&windows[i]);
	free(windows);
	return status;
}

int terrain_read(struct city *city, const char *const *files, size_t count, const contour_array *contours)
{
	struct height_field field = { 0 };
	int status = 0;
	if (!count && !contours->count)
		return 0;
	lay_out(&field, city);
	if (count)
		status = read_files(&field, city, files, count);
	else
		terrain_contours(&field, city, contours);
	if (!status) {
		terrain_water(&field, city);
		terrain_streets(&field, city);
		store(city, &field);
	}
	array_free(field.height_m);
	return status;
}
