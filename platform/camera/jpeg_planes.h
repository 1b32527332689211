/*
 * Motion JPEG to a plane of luma and one of U V pairs, into memory of the caller; libjpeg-turbo does the work and needs
 * some memory of its own. Built without it (no pkg-config libturbojpeg), jpeg_planes_init() says -ENOTSUP.
 */
#ifndef BLVD_PLATFORM_CAMERA_JPEG_PLANES_H
#define BLVD_PLATFORM_CAMERA_JPEG_PLANES_H

#include "platform/camera/camera.h"

struct jpeg_planes {
	void *decoder;
	uint32_t width, height; /* the most */
	uint8_t *apart;         /* U, then V */
};

/* Scratch memory from the arena. Returns 0, -ENOMEM, -ENOTSUP. */
int jpeg_planes_init(struct jpeg_planes *jpeg, uint32_t width, uint32_t height, struct arena *arena);
void jpeg_planes_finish(struct jpeg_planes *jpeg);

/* Bytes of `memory` below. */
uint64_t jpeg_planes_bytes(uint32_t width, uint32_t height);
/* `out` gets format, size, planes and colours. Returns 0; -EBADMSG for what is no whole JPEG; -EFBIG. */
int jpeg_planes_decode(
	struct jpeg_planes *jpeg, const uint8_t *data, size_t size, uint8_t *memory, struct camera_frame *out);

#endif
