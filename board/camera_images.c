#include "board/camera_images.h"

#include <string.h>

#include "platform/base/log.h"
#include "platform/display/egl_image.h"

static void drop_all(struct camera_images *images)
{
	for (int i = 0; i < CAMERA_IMAGES_MAX; i++) {
		gfx_texture_destroy(images->gfx, images->textures[i]);
		egl_image_destroy(images->images[i]);
		images->textures[i].id = 0;
		images->images[i] = NULL;
	}
}

static bool import(struct camera_images *images, const struct camera_device *camera, uint32_t buffer)
{
	struct camera_dmabuf from;
	if (!camera_dmabuf(camera, buffer, &from) || !egl_image_offered(from.fourcc))
		return false;
	struct egl_dmabuf dmabuf = { .fd = from.fd,
		.width = from.width,
		.height = from.height,
		.fourcc = from.fourcc,
		.planes = from.planes,
		.yuv = from.yuv,
		.bt709 = from.matrix == CAMERA_BT709,
		.full_range = from.full_range };
	memcpy(dmabuf.offset, from.offset, sizeof(dmabuf.offset));
	memcpy(dmabuf.stride, from.stride, sizeof(dmabuf.stride));
	return egl_image_create(&dmabuf, &images->images[buffer]) == 0 &&
		   gfx_texture_import(
			   images->gfx, images->images[buffer], from.width, from.height, &images->textures[buffer]) == 0;
}

static void begin_session(struct camera_images *images, const struct camera_frame *frame, bool *changed)
{
	*changed = images->session != 0;
	drop_all(images);
	images->session = frame->session;
	images->told = false;
	images->refused = !images->wanted || !gfx_caps(images->gfx)->external || frame->buffer >= CAMERA_IMAGES_MAX;
}

gfx_texture camera_images_of(
	struct camera_images *images, const struct camera_device *camera, const struct camera_frame *frame, bool *changed)
{
	const gfx_texture none = { 0 };
	*changed = false;
	if (frame->session != images->session)
		begin_session(images, frame, changed);
	if (images->refused || frame->buffer >= CAMERA_IMAGES_MAX)
		return none;
	if (images->textures[frame->buffer].id)
		return images->textures[frame->buffer];
	if (import(images, camera, frame->buffer)) {
		if (!images->told)
			log_info("camera: its buffers are shown in place, without a copy");
		images->told = true;
		return images->textures[frame->buffer];
	}
	images->refused = true;
	*changed = true;
	drop_all(images);
	log_info("camera: its buffers are copied to the GPU");
	return none;
}

void camera_images_finish(struct camera_images *images)
{
	if (images->gfx)
		drop_all(images);
	*images = (struct camera_images){ 0 };
}
