/*
 * Normals of crowns. The geometry's crowns are lit smoothly, from vertex to vertex, while a capture knows one normal a
 * triangle. So the normals that a capture shows of a tree are fitted by a function affine in the image (for a ball seen
 * from afar that is what they are, but for the part towards the eye), and every vertex of its patches gets its own. A
 * crown then needs no borders between its faces.
 */
#ifndef BLVD_TOOLS_IMPOSTOR_FOLIAGE_LIGHT_H
#define BLVD_TOOLS_IMPOSTOR_FOLIAGE_LIGHT_H

#include <stdbool.h>

#include "tools/city/pool.h"
#include "tools/impostor/capture.h"

/* Sums over the pixels of a tree. */
struct crown {
	uint32_t object; /* + 1 */
	double pixels, x, y, xx, xy, yy;
	double normal[3], normal_x[3], normal_y[3]; /* of the unit normal, and times x and y */
};
struct foliage_light {
	ARRAY(struct crown) crowns;
	ARRAY(uint32_t) slots; /* hash table: index of the crown + 1; its size is a power of two */
};

/* Of all foliage in the image, whether it is to be shown or not. Owned. */
void foliage_light_find(struct foliage_light *light, const struct capture_image *image);
void foliage_light_finish(struct foliage_light *light);

/* The normal of a tree at a pixel position. False: the image does not show its foliage. */
bool foliage_light_at(const struct foliage_light *light, uint32_t object, double x, double y, int8_t normal_oct[2]);

#endif
