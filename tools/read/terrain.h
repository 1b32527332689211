/*
 * Ground heights: elevation files onto the city's grid (terrain.c), then streets made drivable and water level in it
 * (terrain_streets.c, terrain_water.c). Heights are metres above the files' vertical datum.
 */
#ifndef BLVD_TOOLS_READ_TERRAIN_H
#define BLVD_TOOLS_READ_TERRAIN_H

#include "tools/city/city.h"
#include "tools/read/tiles.h"

/* The grid while it is worked on: metres, row by row from the south. */
struct height_field {
	struct dvec2 origin; /* south-west post, city frame */
	double step_m;
	size_t columns, rows;
	float *height_m;
	double source_step_m; /* spacing of the posts in the files */
};

/* Reads `files` (anything GDAL opens; .zip is looked into) for the city's extent and fills city->terrain. Several files
 * are taken in order, the first that has a place wins. Without files the ground is made from `contours`, and without
 * these it stays flat. Returns 0, -errno or -EBADMSG after logging one line. */
int terrain_read(struct city *city, const char *const *files, size_t count, const contour_array *contours);

/* Fills the field from contours; there is at least one. */
void terrain_contours(struct height_field *field, const struct city *city, const contour_array *contours);

static inline struct dvec2 field_place(const struct height_field *field, size_t column, size_t row)
{
	return (struct dvec2){ field->origin.x + (double)column * field->step_m,
		field->origin.y + (double)row * field->step_m };
}

/* Bilinear, clamped at the edge. */
double field_at(const struct height_field *field, struct dvec2 at);

/* Gives the grid under and beside every street on the ground the street's own smoothed profile. */
void terrain_streets(struct height_field *field, const struct city *city);

/* Levels lakes and the sea, and rivers across their course. */
void terrain_water(struct height_field *field, const struct city *city);

#endif
