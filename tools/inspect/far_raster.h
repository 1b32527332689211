/* A small rasteriser for impostors, so that checking one needs neither GL nor the renderer that is being checked. */
#ifndef BLVD_TOOLS_INSPECT_FAR_RASTER_H
#define BLVD_TOOLS_INSPECT_FAR_RASTER_H

#include "assets/cells.h"
#include "platform/base/vec.h"

#define RASTER_WIDTH 640
#define RASTER_HEIGHT 360
#define RASTER_FOCAL_PX 434.5 /* 45 degrees from top to bottom */

struct raster_pixel {
	struct dvec3 at, corner;             /* where its texel's middle and corner are drawn, m from the cell's origin */
	const struct pkg_truth_texel *truth; /* of its texel; NULL: nothing is drawn here */
	double depth;
};
struct far_raster {
	const struct impostor_view *impostor; /* borrowed, as is the truth */
	const struct pkg_truth_texel *truth;
	uint8_t *alpha; /* of all pages */
	struct raster_pixel *pixels;
	struct dvec3 eye, right, up, forward;
};
void far_raster_finish(struct far_raster *raster);

/* What is to be drawn by following calls. */
void far_raster_use(
	struct far_raster *raster, const struct impostor_view *impostor, const struct pkg_truth_texel *truth);
/* Draws level with the horizon; heading clockwise from north. */
void far_raster_draw(struct far_raster *raster, struct dvec3 eye, double heading_rad);

/* A point in the view's frame: right, up, forward, m. */
void far_raster_view(const struct far_raster *raster, struct dvec3 point, double out[3]);

#endif
