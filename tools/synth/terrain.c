/* A hill for a city that has none: OSM says nothing of heights, so it goes beside it, as bare earth in metres. */
#include <errno.h>
#include <gdal.h>
#include <math.h>
#include <ogr_srs_api.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/log.h"
#include "tools/synth/synth.h"

#define POSTS 512
#define HILL_M 55.0
#define BEYOND_M 1200.0 /* a bake's ground goes on beyond the last street */

/* A rounded hill in the north-west, level towards the river. */
static double height_at(const struct synth *synth, struct dvec2 at)
{
	double w = synth->options.width_m, h = synth->options.height_m, reach = 0.42 * fmin(w, h);
	double far = fmin(hypot(at.x + 0.32 * w, at.y - 0.33 * h) / reach, 1.0);
	double from_river = fabs(plan_unplace(&synth->plan, at).y) - synth->plan.quay_m;
	double dry = synth->plan.river ? fmin(fmax(from_river / 150.0, 0.0), 1.0) : 1.0;
	return 4.0 + HILL_M * fmin(1.0, reach / 500.0) * (0.5 + 0.5 * cos(BLVD_PI * far)) * dry * dry * (3.0 - 2.0 * dry);
}

static void fill(const struct synth *synth, const double *to_degrees, float *heights)
{
	for (int row = 0; row < POSTS; row++) {
		for (int column = 0; column < POSTS; column++) {
			struct geo_point at = { to_degrees[3] + (row + 0.5) * to_degrees[5],
				to_degrees[0] + (column + 0.5) * to_degrees[1] };
			heights[row * POSTS + column] = (float)height_at(synth, geo_to_plane(&synth->city.frame, at));
		}
	}
}

static bool write_raster(const struct synth *synth, const char *path, float *heights)
{
	double x = synth->options.width_m / 2.0 + BEYOND_M, y = synth->options.height_m / 2.0 + BEYOND_M;
	struct geo_point low = geo_from_plane(&synth->city.frame, (struct dvec2){ -x, -y });
	struct geo_point high = geo_from_plane(&synth->city.frame, (struct dvec2){ x, y });
	double to_degrees[6] = { low.lon_deg, (high.lon_deg - low.lon_deg) / POSTS, 0.0, high.lat_deg, 0.0,
		(low.lat_deg - high.lat_deg) / POSTS };
	GDALAllRegister();
	GDALDriverH driver = GDALGetDriverByName("GTiff");
	GDALDatasetH file = driver ? GDALCreate(driver, path, POSTS, POSTS, 1, GDT_Float32, NULL) : NULL;
	if (!file)
		return false;
	fill(synth, to_degrees, heights);
	OGRSpatialReferenceH degrees = OSRNewSpatialReference(NULL);
	OSRSetWellKnownGeogCS(degrees, "WGS84");
	bool good = GDALSetGeoTransform(file, to_degrees) == CE_None && GDALSetSpatialRef(file, degrees) == CE_None &&
				GDALRasterIO(GDALGetRasterBand(file, 1), GF_Write, 0, 0, POSTS, POSTS, heights, POSTS, POSTS,
					GDT_Float32, 0, 0) == CE_None;
	OSRDestroySpatialReference(degrees);
	GDALClose(file);
	return good;
}

int terrain_write(const struct synth *synth, const char *path)
{
	char part[4096];
	size_t capacity = 0;
	if (snprintf(part, sizeof(part), "%s.part", path) >= (int)sizeof(part))
		return -ENAMETOOLONG;
	float *heights = array_grow(NULL, &capacity, (size_t)POSTS * POSTS, sizeof(float));
	bool good = write_raster(synth, part, heights);
	array_free(heights);
	if (good && !rename(part, path))
		return 0;
	int error = good ? errno : EIO;
	log_error("%s: %s", path, good ? strerror(error) : "GDAL cannot write it");
	unlink(part);
	return -error;
}
