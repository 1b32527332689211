/* One cluster while it is painted. Between atlas_paint.c and atlas_truth.c. */
#ifndef BLVD_TOOLS_IMPOSTOR_ATLAS_PART_H
#define BLVD_TOOLS_IMPOSTOR_ATLAS_PART_H

#include "tools/impostor/atlas_layout.h"

/* One capture while its clusters are painted. */
struct atlas_canvas {
	const struct atlas_layout *layout;
	const struct impostor_mesh *mesh;
	const struct capture_image *image;
	struct dvec3 origin;
	struct impostor *out;
};

/* The part of the capture under a cluster, and the cluster's texels. */
struct atlas_part {
	const struct atlas_cluster *cluster;
	const struct pack_shape *shape;
	int32_t left, top, width, height; /* px, inside the capture */
	uint8_t *owned;                   /* a pixel: its colour is shown */
	uint8_t *cover;                   /* a pixel: enum cover */
	uint32_t columns, rows;           /* texels */
	float (*colour)[5];               /* squares of sRGB, glass, how solid; the last is < 0 while it is not known */
	uint8_t *filled;                  /* a texel: 0, or the turn in which it got its colour */
	struct pkg_truth_texel *truth;    /* or NULL */
};

/* The place at a pixel position of the capture and a disparity. */
void atlas_place(
	const struct atlas_canvas *canvas, double x, double y, double disparity, struct pkg_truth_texel *truth);
/* Puts the texels that are marked as made up, where triangles draw them, on their triangles. */
void atlas_place_made_up(const struct atlas_canvas *canvas, struct atlas_part *part);

#endif
