/* An RGB picture in memory and as PNG. */
#ifndef BLVD_TOOLS_MEASURE_IMAGE_H
#define BLVD_TOOLS_MEASURE_IMAGE_H

#include <stdint.h>

struct image {
	uint32_t width, height;
	uint8_t *rgb; /* top row first; owned */
};

/* Returns 0 or -errno (-EBADMSG when it is no PNG) after logging one line. */
int image_read_png(struct image *image, const char *path);
int image_write_png(const struct image *image, const char *path);
void image_finish(struct image *image);

#endif
