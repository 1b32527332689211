/* Parallel rows across a block, cut to its outline by GEOS. */
#include <math.h>

#include "tools/synth/synth.h"

void rows_across(struct synth *synth, const struct polygon *in, double angle, double depth_m, double gap_m,
	double piece_m, double least_m2, polygon_array *out)
{
	GEOSContextHandle_t geos = synth->shaper.geos;
	GEOSGeometry *block = shape_to_geos(&synth->shaper, in);
	double low_u = HUGE_VAL, high_u = -HUGE_VAL, low_v = HUGE_VAL, high_v = -HUGE_VAL;
	for (size_t i = 0; i < in->outer.count; i++) {
		struct dvec2 p = turned(in->outer.points[i], -angle);
		low_u = fmin(low_u, p.x);
		high_u = fmax(high_u, p.x);
		low_v = fmin(low_v, p.y);
		high_v = fmax(high_v, p.y);
	}
	int rows = (int)floor((high_v - low_v + gap_m) / (depth_m + gap_m));
	int pieces = (int)fmax(1.0, ceil((high_u - low_u) / piece_m));
	double step_u = (high_u - low_u) / pieces, spare = high_v - low_v - rows * (depth_m + gap_m) + gap_m;
	for (int r = 0; block && r < rows; r++) {
		double v = low_v + spare / 2.0 + r * (depth_m + gap_m);
		for (int k = 0; k < pieces; k++) {
			double u0 = low_u + k * step_u + (k ? gap_m / 4.0 : 0.0), u1 = low_u + (k + 1) * step_u - gap_m / 4.0;
			struct dvec2 corners[4] = { turned((struct dvec2){ u0, v }, angle), turned((struct dvec2){ u1, v }, angle),
				turned((struct dvec2){ u1, v + depth_m }, angle), turned((struct dvec2){ u0, v + depth_m }, angle) };
			GEOSGeometry *row = shape_to_geos(&synth->shaper, &(struct polygon){ .outer = { corners, 4 } });
			GEOSGeometry *piece = row ? GEOSIntersection_r(geos, row, block) : NULL;
			if (piece)
				shape_from_geos(&synth->shaper, piece, least_m2, out);
			GEOSGeom_destroy_r(geos, piece);
			GEOSGeom_destroy_r(geos, row);
		}
	}
	GEOSGeom_destroy_r(geos, block);
}
