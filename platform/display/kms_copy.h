/* A picture copied into a buffer of the panel. Pure. */
#ifndef BLVD_PLATFORM_DISPLAY_KMS_COPY_H
#define BLVD_PLATFORM_DISPLAY_KMS_COPY_H

#include <stdint.h>

struct kms_picture {
	const uint8_t *rgba; /* top row first, no gaps */
	uint32_t width, height;
};

/* Writes XRGB8888 (blue first in memory) over all of width x height: turned clockwise by 0, 90, 180 or 270 degrees,
 * stretched to fit by nearest neighbours, colours times `dim`. */
void kms_copy(const struct kms_picture *from, uint8_t *to, uint32_t pitch, uint32_t width, uint32_t height,
	unsigned turn_deg, float dim);

#endif
