/*
 * One opened V4L2 capture device: negotiation, buffers, frames in and out. Every call may take its time: for the
 * camera's own thread (camera_v4l2.c). Single-planar and multi-planar devices, with all of a picture in one buffer.
 */
#ifndef BLVD_PLATFORM_CAMERA_V4L2_DEVICE_H
#define BLVD_PLATFORM_CAMERA_V4L2_DEVICE_H

#include "platform/camera/camera.h"

#define V4L2_DEVICE_BUFFERS 6 /* one shown, one waiting, one on its way back, three for the driver */

struct v4l2_buffer_memory {
	uint8_t *at; /* mapped */
	size_t bytes;
	int dmabuf; /* -1: cannot be exported */
};

struct v4l2_device {
	int fd;        /* -1: closed */
	uint32_t type; /* of buffers: enum v4l2_buf_type */
	bool planar;   /* multi-planar interface */
	enum camera_format format;
	uint32_t width, height, stride, picture_bytes;
	uint32_t fps_milli; /* 0: not told */
	enum camera_matrix matrix;
	bool full_range;
	uint32_t buffer_count;
	struct v4l2_buffer_memory buffers[V4L2_DEVICE_BUFFERS];
	char name[64]; /* "vivid: vivid-000-vid-cap" */
};

/* One buffer that the driver has filled. */
struct v4l2_filled {
	uint32_t index, bytes, sequence;
	int64_t time_ns; /* CLOCK_MONOTONIC */
	bool broken;     /* the driver says so */
};

/* Opens, agrees on the best of what the device and the config have in common (raw pictures before JPEG where they are
 * as fast), maps the buffers and starts. `jpeg`: MJPEG can be decoded. Returns 0 or -errno; `why` (of 80) gets a few
 * words then. Logs what was offered and taken. */
int v4l2_device_open(struct v4l2_device *device, const struct camera_config *config, bool jpeg, char *why);
/* Accepts a closed one. */
void v4l2_device_close(struct v4l2_device *device);

/* Returns 0, -EAGAIN when nothing is filled, else -errno: it is gone. */
int v4l2_device_take(struct v4l2_device *device, struct v4l2_filled *out);
/* Back to the driver. Returns 0 or -errno. */
int v4l2_device_give(struct v4l2_device *device, uint32_t index);

/* "YUYV 640x480 30/s" */
void v4l2_device_words(const struct v4l2_device *device, char *out, size_t size);

#endif
