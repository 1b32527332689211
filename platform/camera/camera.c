#include "platform/camera/camera.h"

#include <string.h>

#define DIGEST_ROWS 48 /* spread over the picture; a sensor's noise is in every row */

static const char *const names[CAMERA_FORMAT_COUNT] = {
	[CAMERA_FORMAT_ANY] = "auto",
	[CAMERA_YUYV] = "yuyv",
	[CAMERA_UYVY] = "uyvy",
	[CAMERA_NV12] = "nv12",
	[CAMERA_PLANES] = "planes",
	[CAMERA_RGBX] = "rgbx",
	[CAMERA_BGRX] = "bgrx",
	[CAMERA_MJPEG] = "mjpeg",
};

int camera_open(
	struct camera_device *camera, const struct camera_ops *ops, const struct camera_config *config, struct arena *arena)
{
	struct camera_config whole = *config;
	whole.width = whole.width ? whole.width : 1280;
	whole.height = whole.height ? whole.height : 720;
	whole.fps = whole.fps ? whole.fps : 30;
	*camera = (struct camera_device){ .ops = ops };
	int status = ops->open(camera, &whole, arena);
	if (status < 0)
		*camera = (struct camera_device){ 0 };
	return status;
}

void camera_close(struct camera_device *camera)
{
	if (camera->ops)
		camera->ops->close(camera);
	*camera = (struct camera_device){ 0 };
}

bool camera_latest(struct camera_device *camera, int64_t now_ns, struct camera_frame *out)
{
	return camera->ops && camera->ops->latest(camera, now_ns, out);
}

void camera_status(const struct camera_device *camera, struct camera_status *out)
{
	*out = (struct camera_status){ 0 };
	if (camera->ops)
		camera->ops->status(camera, out);
}

bool camera_dmabuf(const struct camera_device *camera, uint32_t buffer, struct camera_dmabuf *out)
{
	return camera->ops && camera->ops->dmabuf && camera->ops->dmabuf(camera, buffer, out);
}

const char *camera_format_name(enum camera_format format)
{
	return names[format];
}

enum camera_format camera_format_by_name(const char *name)
{
	int format = 0;
	while (format < CAMERA_FORMAT_COUNT && strcmp(names[format], name) != 0)
		format++;
	return (enum camera_format)format;
}

uint64_t camera_format_bytes(enum camera_format format, uint32_t width, uint32_t height)
{
	uint64_t pixels = (uint64_t)width * height;
	switch (format) {
	case CAMERA_YUYV:
	case CAMERA_UYVY:
		return pixels * 2;
	case CAMERA_NV12:
		return pixels + (uint64_t)((width + 1) / 2) * ((height + 1) / 2) * 2;
	case CAMERA_PLANES:
		return pixels * 3;
	case CAMERA_RGBX:
	case CAMERA_BGRX:
		return pixels * 4;
	default:
		return 0;
	}
}

void camera_frame_layout(struct camera_frame *frame, const uint8_t *memory, uint32_t stride)
{
	frame->plane[0] = memory;
	frame->stride[0] = stride;
	frame->plane[1] = NULL;
	frame->stride[1] = frame->chroma_width = frame->chroma_height = 0;
	if (frame->format != CAMERA_NV12)
		return;
	frame->plane[1] = memory + (size_t)stride * frame->height;
	frame->stride[1] = stride;
	frame->chroma_width = (frame->width + 1) / 2;
	frame->chroma_height = (frame->height + 1) / 2;
}

static uint32_t row_bytes(const struct camera_frame *frame)
{
	uint32_t pixel = frame->format == CAMERA_RGBX || frame->format == CAMERA_BGRX   ? 4
					 : frame->format == CAMERA_YUYV || frame->format == CAMERA_UYVY ? 2
																					: 1;
	return frame->width * pixel;
}

/* Two multiplications a word: memory is what costs. */
uint32_t camera_digest(const struct camera_frame *frame)
{
	uint64_t sum = 0x9E3779B97F4A7C15u;
	uint32_t bytes = row_bytes(frame), step = frame->height / DIGEST_ROWS ? frame->height / DIGEST_ROWS : 1;
	for (uint32_t y = step / 2; y < frame->height; y += step) {
		const uint8_t *row = frame->plane[0] + (size_t)y * frame->stride[0];
		uint64_t word = 0;
		for (uint32_t x = 0; x + sizeof(word) <= bytes; x += sizeof(word)) {
			memcpy(&word, row + x, sizeof(word));
			sum = (sum ^ word) * 0x9E3779B97F4A7C15u;
			sum ^= sum >> 29;
		}
	}
	return (uint32_t)(sum >> 32) ^ (uint32_t)sum;
}
