/*
 * A V4L2 camera. Its thread opens the device, hands filled buffers over (decoding JPEG first) and opens it anew when it
 * has gone or stands still; the frame's thread only looks into a mailbox. The newest frame wins: older ones go straight
 * back to the driver, so what is shown is never late for want of drawing.
 *
 * Memory that the frame's thread may still look at is not unmapped: before a session ends, the thread says so and
 * waits for the next camera_latest().
 */
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/base/thread.h"
#include "platform/camera/camera.h"
#include "platform/camera/jpeg_planes.h"
#include "platform/camera/v4l2_device.h"

#define STACK_BYTES (256u << 10)
#define RETRY_MS 250  /* from one look for the device to the next */
#define STILL_MS 1000 /* without a frame: open it anew */
#define BROKEN_MAX 30 /* frames in a row that are no good: open it anew */
#define DECODED 3     /* pictures: shown, waiting, in the making */
#define NONE UINT32_MAX

struct v4l2 {
	struct camera_config config;
	pthread_t thread;
	bool started;
	int wake; /* eventfd: the thread shall look at `stop` */
	/* of the thread */
	struct v4l2_device device;
	struct jpeg_planes jpeg;
	uint8_t *decoded[DECODED];
	uint32_t last_sequence;
	bool any_sequence;
	uint32_t broken; /* in a row */
	char told[80];   /* the last trouble that was logged */
	/* guarded */
	pthread_mutex_t mutex;
	pthread_cond_t released;
	bool stop, ending; /* ending: the session's memory goes away once `shown` is NONE */
	struct camera_frame waiting;
	uint32_t waiting_slot, shown_slot, returned_slot; /* NONE, a buffer, or a decoded picture */
	struct camera_status status;
};

static bool stopped(struct v4l2 *v4l2)
{
	pthread_mutex_lock(&v4l2->mutex);
	bool stop = v4l2->stop;
	pthread_mutex_unlock(&v4l2->mutex);
	return stop;
}

/* Sleeps until the device has something, at most `ms`. */
static bool wait_for_frame(struct v4l2 *v4l2, int ms)
{
	struct pollfd fds[2] = { { .fd = v4l2->wake, .events = POLLIN }, { .fd = v4l2->device.fd, .events = POLLIN } };
	return poll(fds, v4l2->device.fd >= 0 ? 2 : 1, ms) > 0 && fds[1].revents;
}

static void note_trouble(struct v4l2 *v4l2, const char *why)
{
	if (strcmp(why, v4l2->told) != 0)
		log_warn("camera: %s", why);
	snprintf(v4l2->told, sizeof(v4l2->told), "%s", why);
	pthread_mutex_lock(&v4l2->mutex);
	v4l2->status.link = CAMERA_ABSENT;
	snprintf(v4l2->status.trouble, sizeof(v4l2->status.trouble), "%s", why);
	pthread_mutex_unlock(&v4l2->mutex);
}

static bool open_session(struct v4l2 *v4l2)
{
	char why[80];
	if (v4l2_device_open(&v4l2->device, &v4l2->config, v4l2->jpeg.decoder != NULL, why) < 0) {
		note_trouble(v4l2, why);
		return false;
	}
	v4l2->told[0] = 0;
	v4l2->any_sequence = false;
	v4l2->broken = 0;
	pthread_mutex_lock(&v4l2->mutex);
	struct camera_status *status = &v4l2->status;
	status->link = CAMERA_OPENING;
	status->sessions++;
	status->trouble[0] = 0;
	status->zero_copy = v4l2->device.format != CAMERA_MJPEG && v4l2->device.buffers[0].dmabuf >= 0;
	v4l2_device_words(&v4l2->device, status->format, sizeof(status->format));
	pthread_mutex_unlock(&v4l2->mutex);
	return true;
}

/* Waits until nothing of the session is looked at any more. */
static void end_session(struct v4l2 *v4l2, const char *why)
{
	note_trouble(v4l2, why);
	pthread_mutex_lock(&v4l2->mutex);
	v4l2->ending = true;
	v4l2->waiting_slot = v4l2->returned_slot = NONE;
	while (v4l2->shown_slot != NONE && !v4l2->stop)
		pthread_cond_wait(&v4l2->released, &v4l2->mutex);
	v4l2->ending = false;
	pthread_mutex_unlock(&v4l2->mutex);
	v4l2_device_close(&v4l2->device);
}

/* Which of the decoded pictures nobody has. */
static uint32_t free_picture(struct v4l2 *v4l2)
{
	uint32_t slot = 0;
	pthread_mutex_lock(&v4l2->mutex);
	while (slot == v4l2->waiting_slot || slot == v4l2->shown_slot)
		slot++;
	pthread_mutex_unlock(&v4l2->mutex);
	return slot;
}

/* Makes a frame of a filled buffer; `slot` is where it lies. False: it is no good. */
static bool make_frame(struct v4l2 *v4l2, const struct v4l2_filled *filled, struct camera_frame *frame, uint32_t *slot)
{
	const struct v4l2_device *device = &v4l2->device;
	const uint8_t *data = device->buffers[filled->index].at;
	if (filled->broken)
		return false;
	if (device->format == CAMERA_MJPEG) {
		*slot = free_picture(v4l2);
		int64_t began_ns = clock_now_ns();
		int status = jpeg_planes_decode(&v4l2->jpeg, data, filled->bytes, v4l2->decoded[*slot], frame);
		int64_t took_ns = clock_now_ns() - began_ns;
		pthread_mutex_lock(&v4l2->mutex);
		if (took_ns > v4l2->status.decode_ns_max)
			v4l2->status.decode_ns_max = took_ns;
		pthread_mutex_unlock(&v4l2->mutex);
		return status == 0;
	}
	*slot = filled->index;
	*frame = (struct camera_frame){ .format = device->format,
		.width = device->width,
		.height = device->height,
		.matrix = device->matrix,
		.full_range = device->full_range,
		.buffer = filled->index };
	camera_frame_layout(frame, data, device->stride);
	return filled->bytes >= device->picture_bytes;
}

/* Into the mailbox; what it takes the place of goes back to the driver. */
static void hand_over(struct v4l2 *v4l2, const struct camera_frame *frame, uint32_t slot)
{
	uint32_t back[2];
	pthread_mutex_lock(&v4l2->mutex);
	back[0] = v4l2->waiting_slot;
	back[1] = v4l2->returned_slot;
	v4l2->returned_slot = NONE;
	v4l2->waiting = *frame;
	v4l2->waiting_slot = slot;
	v4l2->status.frames++;
	v4l2->status.link = CAMERA_STREAMING;
	pthread_mutex_unlock(&v4l2->mutex);
	for (int i = 0; i < 2 && v4l2->device.format != CAMERA_MJPEG; i++)
		if (back[i] != NONE)
			v4l2_device_give(&v4l2->device, back[i]);
}

static void count(struct v4l2 *v4l2, uint64_t bad, uint64_t skipped)
{
	pthread_mutex_lock(&v4l2->mutex);
	v4l2->status.bad += bad;
	v4l2->status.skipped += skipped;
	pthread_mutex_unlock(&v4l2->mutex);
}

/* Returns 0 or -errno when the device is gone. */
static int take_frame(struct v4l2 *v4l2)
{
	struct v4l2_filled filled;
	struct camera_frame frame;
	uint32_t slot;
	int status = v4l2_device_take(&v4l2->device, &filled);
	if (status < 0)
		return status == -EAGAIN ? 0 : status;
	bool good = make_frame(v4l2, &filled, &frame, &slot);
	count(v4l2, !good, v4l2->any_sequence ? filled.sequence - v4l2->last_sequence - 1 : 0);
	v4l2->last_sequence = filled.sequence;
	v4l2->any_sequence = true;
	v4l2->broken = good ? 0 : v4l2->broken + 1;
	if (good) {
		frame.time_ns = filled.time_ns;
		frame.sequence = filled.sequence;
		frame.session = v4l2->status.sessions; /* written by this thread only */
		frame.digest = camera_digest(&frame);
		hand_over(v4l2, &frame, slot);
	}
	if (!good || v4l2->device.format == CAMERA_MJPEG)
		return v4l2_device_give(&v4l2->device, filled.index);
	return 0;
}

static void session(struct v4l2 *v4l2)
{
	char why[80];
	int64_t last_ns = clock_now_ns();
	for (;;) {
		if (stopped(v4l2))
			return;
		if (wait_for_frame(v4l2, STILL_MS / 4)) {
			int status = take_frame(v4l2);
			if (status < 0) {
				snprintf(why, sizeof(why), "%.40s: %s", v4l2->config.source, strerror(-status));
				end_session(v4l2, why);
				return;
			}
			last_ns = clock_now_ns();
		}
		if (clock_now_ns() - last_ns > STILL_MS * NS_PER_MS || v4l2->broken > BROKEN_MAX) {
			snprintf(why, sizeof(why), "%.40s: %s", v4l2->config.source,
				v4l2->broken > BROKEN_MAX ? "nothing but broken frames" : "stands still");
			end_session(v4l2, why);
			return;
		}
	}
}

static void *run(void *argument)
{
	struct v4l2 *v4l2 = argument;
	while (!stopped(v4l2)) {
		if (open_session(v4l2))
			session(v4l2);
		else
			wait_for_frame(v4l2, RETRY_MS);
	}
	return NULL;
}

/* Decoding needs memory, which is taken only where a JPEG may come. */
static int make_decoder(struct v4l2 *v4l2, struct arena *arena)
{
	const struct camera_config *config = &v4l2->config;
	if (config->format != CAMERA_MJPEG && config->format != CAMERA_FORMAT_ANY)
		return 0;
	int status = jpeg_planes_init(&v4l2->jpeg, config->width, config->height, arena);
	if (status == -ENOTSUP) {
		log_info("camera: built without a JPEG decoder");
		return 0;
	}
	for (int i = 0; i < DECODED && status == 0; i++) {
		v4l2->decoded[i] = arena_alloc(arena, (size_t)jpeg_planes_bytes(config->width, config->height), 64);
		status = v4l2->decoded[i] ? 0 : -ENOMEM;
	}
	return status;
}

static int v4l2_open(struct camera_device *camera, const struct camera_config *config, struct arena *arena)
{
	struct v4l2 *v4l2 = ARENA_ARRAY(arena, struct v4l2, 1);
	if (!v4l2)
		return -ENOMEM;
	v4l2->config = *config;
	v4l2->device.fd = -1;
	v4l2->waiting_slot = v4l2->shown_slot = v4l2->returned_slot = NONE;
	int status = make_decoder(v4l2, arena);
	if (status < 0)
		goto err_decoder;
	v4l2->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (v4l2->wake < 0) {
		status = -errno;
		goto err_decoder;
	}
	pthread_mutex_init(&v4l2->mutex, NULL);
	pthread_cond_init(&v4l2->released, NULL);
	status = thread_start(&v4l2->thread, "camera", STACK_BYTES, run, v4l2);
	if (status == 0) {
		camera->impl = v4l2;
		return 0;
	}
	pthread_cond_destroy(&v4l2->released);
	pthread_mutex_destroy(&v4l2->mutex);
	close(v4l2->wake);
err_decoder:
	jpeg_planes_finish(&v4l2->jpeg);
	return status;
}

static void v4l2_close(struct camera_device *camera)
{
	struct v4l2 *v4l2 = camera->impl;
	pthread_mutex_lock(&v4l2->mutex);
	v4l2->stop = true;
	pthread_cond_signal(&v4l2->released);
	pthread_mutex_unlock(&v4l2->mutex);
	eventfd_write(v4l2->wake, 1);
	pthread_join(v4l2->thread, NULL);
	v4l2_device_close(&v4l2->device);
	pthread_cond_destroy(&v4l2->released);
	pthread_mutex_destroy(&v4l2->mutex);
	close(v4l2->wake);
	jpeg_planes_finish(&v4l2->jpeg);
}

static bool v4l2_latest(struct camera_device *camera, int64_t now_ns, struct camera_frame *out)
{
	struct v4l2 *v4l2 = camera->impl;
	(void)now_ns;
	pthread_mutex_lock(&v4l2->mutex);
	bool any = v4l2->waiting_slot != NONE && !v4l2->ending && v4l2->returned_slot == NONE;
	if (any) {
		v4l2->returned_slot = v4l2->shown_slot;
		v4l2->shown_slot = v4l2->waiting_slot;
		v4l2->waiting_slot = NONE;
		*out = v4l2->waiting;
	} else if (v4l2->ending) {
		v4l2->shown_slot = NONE;
		pthread_cond_signal(&v4l2->released);
	}
	pthread_mutex_unlock(&v4l2->mutex);
	return any;
}

static void v4l2_status(const struct camera_device *camera, struct camera_status *out)
{
	struct v4l2 *v4l2 = camera->impl;
	pthread_mutex_lock(&v4l2->mutex);
	*out = v4l2->status;
	pthread_mutex_unlock(&v4l2->mutex);
}

/* DRM's names of formats are those of V4L2 for these two; RGB is counted from the other end. */
static uint32_t drm_fourcc(enum camera_format format)
{
	return format == CAMERA_YUYV   ? 0x56595559
		   : format == CAMERA_UYVY ? 0x59565955
		   : format == CAMERA_NV12 ? 0x3231564E
		   : format == CAMERA_BGRX ? 0x34325258
								   : 0x34324258;
}

static bool v4l2_dmabuf(const struct camera_device *camera, uint32_t buffer, struct camera_dmabuf *out)
{
	struct v4l2 *v4l2 = camera->impl;
	const struct v4l2_device *device = &v4l2->device;
	pthread_mutex_lock(&v4l2->mutex);
	/* while a frame of the session is shown, the session cannot end */
	bool can = v4l2->shown_slot != NONE && v4l2->status.zero_copy && buffer < device->buffer_count;
	if (can)
		*out = (struct camera_dmabuf){ .fd = device->buffers[buffer].dmabuf,
			.width = device->width,
			.height = device->height,
			.fourcc = drm_fourcc(device->format),
			.planes = device->format == CAMERA_NV12 ? 2 : 1,
			.offset = { 0, device->stride * device->height },
			.stride = { device->stride, device->stride },
			.yuv = device->format != CAMERA_BGRX && device->format != CAMERA_RGBX,
			.matrix = device->matrix,
			.full_range = device->full_range };
	pthread_mutex_unlock(&v4l2->mutex);
	return can && out->fd >= 0;
}

const struct camera_ops camera_v4l2 = {
	.name = "v4l2",
	.open = v4l2_open,
	.close = v4l2_close,
	.latest = v4l2_latest,
	.status = v4l2_status,
	.dmabuf = v4l2_dmabuf,
};
