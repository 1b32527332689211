/* Memory of another device as an image of EGL, for gfx_texture_import(). Works on whatever display is current. */
#ifndef BLVD_PLATFORM_DISPLAY_EGL_IMAGE_H
#define BLVD_PLATFORM_DISPLAY_EGL_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

struct egl_dmabuf {
	int fd; /* borrowed during the call */
	uint32_t width, height;
	uint32_t fourcc; /* DRM's */
	uint32_t planes;
	uint32_t offset[2], stride[2];
	bool yuv;        /* the two below count */
	bool bt709;      /* else BT.601 */
	bool full_range; /* luma 0 to 255 */
};

/* Whether EGL says that it can, and knows the format. */
bool egl_image_offered(uint32_t fourcc);

/* Returns 0, -ENOTSUP, or -EINVAL when EGL refuses this one. Nothing is logged: there is another way. */
int egl_image_create(const struct egl_dmabuf *from, void **image);
/* NULL does nothing. */
void egl_image_destroy(void *image);

#endif
