/*
 * The camera's own buffers as textures, without a copy, where the driver of the camera exports them and that of the GPU
 * takes them. Everything else goes by upload; so does a camera of which one buffer is refused.
 */
#ifndef BLVD_BOARD_CAMERA_IMAGES_H
#define BLVD_BOARD_CAMERA_IMAGES_H

#include "platform/camera/camera.h"
#include "render/gfx.h"

#define CAMERA_IMAGES_MAX 8

struct camera_images {
	struct gfx *gfx;
	bool wanted;
	uint32_t session; /* whose buffers these are */
	bool refused;     /* not in this session */
	bool told;        /* that it works, in this session */
	void *images[CAMERA_IMAGES_MAX];
	gfx_texture textures[CAMERA_IMAGES_MAX];
};

/* The texture of the frame's buffer, made when it is first seen; the zero handle: upload it. `changed` is set when
 * textures of an earlier session were destroyed. */
gfx_texture camera_images_of(
	struct camera_images *images, const struct camera_device *camera, const struct camera_frame *frame, bool *changed);
/* Accepts a zeroed one. */
void camera_images_finish(struct camera_images *images);

#endif
