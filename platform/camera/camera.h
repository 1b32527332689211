/*
 * A camera: V4L2 (camera_v4l2.c), or one that is not there (camera_sim.c). A camera that is missing, unplugged or
 * broken is a state, never an error to end on: it is looked for again until camera_close().
 *
 * All calls come from the frame's thread; none waits, opens or allocates after camera_open(). What takes time (opening,
 * negotiating, decoding) is done by a thread of the implementation.
 */
#ifndef BLVD_PLATFORM_CAMERA_CAMERA_H
#define BLVD_PLATFORM_CAMERA_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

#include "platform/base/arena.h"
#include "platform/camera/lens.h"

/* Layout of a frame in memory. */
enum camera_format {
	CAMERA_FORMAT_ANY, /* in a config: the best that the device has */
	CAMERA_YUYV,       /* 4:2:2, Y0 U Y1 V */
	CAMERA_UYVY,
	CAMERA_NV12,   /* 4:2:0, a plane of Y, one of U V */
	CAMERA_PLANES, /* a plane of Y, one of U V of any size: what a JPEG is decoded to */
	CAMERA_RGBX,   /* bytes R G B x */
	CAMERA_BGRX,   /* bytes B G R x: V4L2's XR24 */
	CAMERA_MJPEG,  /* of a device; its frames arrive as CAMERA_PLANES */
	CAMERA_FORMAT_COUNT,
};

enum camera_matrix { CAMERA_BT601, CAMERA_BT709 };

struct camera_config {
	const char *source;     /* of camera_v4l2: "/dev/video0"; of camera_sim: its script. Borrowed */
	uint32_t width, height; /* wanted, and the most that will be taken; 0: 1280 x 720 */
	uint32_t fps;           /* wanted; 0: 30 */
	enum camera_format format;
	struct lens lens; /* of the simulated camera's picture */
	struct camera_mount mount;
};

/* One picture. `plane` is valid until the next camera_latest() that returns true, camera_close(), or a camera_status()
 * that says ABSENT or tells another number of sessions. */
struct camera_frame {
	enum camera_format format; /* neither ANY nor MJPEG */
	uint32_t width, height;
	uint32_t chroma_width, chroma_height; /* of plane 1; 0 without one */
	const uint8_t *plane[2];
	uint32_t stride[2]; /* bytes from row to row */
	enum camera_matrix matrix;
	bool full_range;   /* luma 0 to 255 instead of 16 to 235 */
	int64_t time_ns;   /* of capture, on the clock of camera_latest() */
	uint32_t sequence; /* of the device, in this session */
	uint32_t session;  /* counts openings of the device, from 1: what belongs to a buffer dies with its session */
	uint32_t buffer;   /* of the device; UINT32_MAX: not one of its own */
	uint32_t digest;   /* of some of its bytes: a picture that is repeated has the same */
};

enum camera_link {
	CAMERA_ABSENT,    /* no such device now, or it refuses */
	CAMERA_OPENING,   /* there, no frame yet */
	CAMERA_STREAMING, /* frames have come */
};

struct camera_status {
	enum camera_link link;
	uint32_t sessions;     /* openings that led to a stream */
	uint64_t frames;       /* taken from the device, good ones */
	uint64_t bad;          /* of a wrong size, torn, marked as faulty or not to be decoded: never shown */
	uint64_t skipped;      /* lost before us, by sequence numbers */
	int64_t decode_ns_max; /* CPU time of one decoding */
	bool zero_copy;        /* the device's buffers can be exported */
	char format[48];       /* in words: "YUYV 640x480 30/s" */
	char trouble[80];      /* why it is ABSENT, or "" */
};

/* A device buffer for the GPU to read in place. */
struct camera_dmabuf {
	int fd;                         /* the camera's */
	uint32_t width, height, fourcc; /* DRM's */
	uint32_t planes;
	uint32_t offset[2], stride[2];
	bool yuv; /* the two below count */
	enum camera_matrix matrix;
	bool full_range;
};

struct camera_device {
	const struct camera_ops *ops;
	void *impl;
};

/* `dmabuf` may be NULL, all others are mandatory. */
struct camera_ops {
	const char *name;
	int (*open)(struct camera_device *camera, const struct camera_config *config, struct arena *arena);
	void (*close)(struct camera_device *camera);
	bool (*latest)(struct camera_device *camera, int64_t now_ns, struct camera_frame *out);
	void (*status)(const struct camera_device *camera, struct camera_status *out);
	bool (*dmabuf)(const struct camera_device *camera, uint32_t buffer, struct camera_dmabuf *out);
};

extern const struct camera_ops camera_sim;
#ifdef __linux__
extern const struct camera_ops camera_v4l2;
#endif

/* Starts it. Returns 0; -ENOMEM; -EINVAL for a script or a size that cannot be (logged). */
int camera_open(struct camera_device *camera, const struct camera_ops *ops, const struct camera_config *config,
	struct arena *arena);
/* A zeroed camera does nothing. */
void camera_close(struct camera_device *camera);

/* The newest frame that came since the last call; false when none has. */
bool camera_latest(struct camera_device *camera, int64_t now_ns, struct camera_frame *out);
void camera_status(const struct camera_device *camera, struct camera_status *out);
/* The buffer of a frame, while its session lasts; false when it cannot be exported. */
bool camera_dmabuf(const struct camera_device *camera, uint32_t buffer, struct camera_dmabuf *out);

/* A word for logs and profiles: "yuyv", "nv12"... CAMERA_FORMAT_COUNT when there is no such. */
const char *camera_format_name(enum camera_format format);
enum camera_format camera_format_by_name(const char *name);
/* Bytes of a tight picture in memory; 0 for MJPEG and ANY. */
uint64_t camera_format_bytes(enum camera_format format, uint32_t width, uint32_t height);
/* Fills plane, stride and chroma sizes for a picture at `memory` whose first plane has rows of `stride` bytes. */
void camera_frame_layout(struct camera_frame *frame, const uint8_t *memory, uint32_t stride);
/* camera_frame.digest: some rows of the first plane. */
uint32_t camera_digest(const struct camera_frame *frame);

#endif
