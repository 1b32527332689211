#include "platform/camera/v4l2_device.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"

#define WHY_SIZE 80
#define FAST_MILLI 24000 /* frames in 1,000 s that count as fast */

/* The order is that of preference among equally fast ones. */
static const struct {
	uint32_t fourcc;
	enum camera_format format;
} known[] = {
	{ V4L2_PIX_FMT_NV12, CAMERA_NV12 },
	{ V4L2_PIX_FMT_YUYV, CAMERA_YUYV },
	{ V4L2_PIX_FMT_UYVY, CAMERA_UYVY },
	{ V4L2_PIX_FMT_XBGR32, CAMERA_BGRX },
	{ V4L2_PIX_FMT_ABGR32, CAMERA_BGRX },
	{ V4L2_PIX_FMT_BGR32, CAMERA_BGRX },
	{ V4L2_PIX_FMT_RGBX32, CAMERA_RGBX },
	{ V4L2_PIX_FMT_MJPEG, CAMERA_MJPEG },
	{ V4L2_PIX_FMT_JPEG, CAMERA_MJPEG },
};
#define KNOWN (sizeof(known) / sizeof(known[0]))

static int control(const struct v4l2_device *device, unsigned long request, void *argument)
{
	int status;
	do
		status = ioctl(device->fd, request, argument);
	while (status < 0 && errno == EINTR);
	return status < 0 ? -errno : 0;
}

static int fail(char *why, int status, const char *what)
{
	snprintf(why, WHY_SIZE, "%s: %s", what, strerror(-status));
	return status;
}

static int look_at(struct v4l2_device *device, char *why)
{
	struct v4l2_capability caps = { 0 };
	int status = control(device, VIDIOC_QUERYCAP, &caps);
	if (status < 0)
		return fail(why, status, "no V4L2 device");
	uint32_t can = caps.capabilities & V4L2_CAP_DEVICE_CAPS ? caps.device_caps : caps.capabilities;
	device->planar = !(can & V4L2_CAP_VIDEO_CAPTURE);
	device->type = device->planar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
	snprintf(device->name, sizeof(device->name), "%.20s: %.40s", (const char *)caps.driver, (const char *)caps.card);
	if (!(can & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) || !(can & V4L2_CAP_STREAMING))
		return fail(why, -ENODEV, "it does not capture video");
	return 0;
}

static bool offers(const struct v4l2_device *device, uint32_t fourcc)
{
	struct v4l2_fmtdesc desc = { .type = device->type };
	for (; desc.index < 256 && control(device, VIDIOC_ENUM_FMT, &desc) == 0; desc.index++)
		if (desc.pixelformat == fourcc)
			return true;
	return false;
}

static void colours(struct v4l2_device *device, uint32_t space, uint32_t encoding, uint32_t range)
{
	bool rgb = device->format == CAMERA_RGBX || device->format == CAMERA_BGRX;
	if (encoding == V4L2_YCBCR_ENC_DEFAULT)
		encoding = V4L2_MAP_YCBCR_ENC_DEFAULT(space);
	if (range == V4L2_QUANTIZATION_DEFAULT)
		range = V4L2_MAP_QUANTIZATION_DEFAULT(rgb, space, encoding);
	device->matrix = encoding == V4L2_YCBCR_ENC_709 || encoding == V4L2_YCBCR_ENC_XV709 ? CAMERA_BT709 : CAMERA_BT601;
	device->full_range = range == V4L2_QUANTIZATION_FULL_RANGE;
}

/* Asks for a format; what is granted comes into `device`. False: something else, or too large. */
static bool set_format(struct v4l2_device *device, const struct camera_config *config, size_t choice)
{
	struct v4l2_format format = { .type = device->type };
	if (device->planar) {
		format.fmt.pix_mp.width = config->width;
		format.fmt.pix_mp.height = config->height;
		format.fmt.pix_mp.pixelformat = known[choice].fourcc;
		format.fmt.pix_mp.field = V4L2_FIELD_ANY;
	} else {
		format.fmt.pix.width = config->width;
		format.fmt.pix.height = config->height;
		format.fmt.pix.pixelformat = known[choice].fourcc;
		format.fmt.pix.field = V4L2_FIELD_ANY;
	}
	if (control(device, VIDIOC_S_FMT, &format) < 0)
		return false;
	const struct v4l2_pix_format_mplane *many = &format.fmt.pix_mp;
	const struct v4l2_pix_format *one = &format.fmt.pix;
	uint32_t fourcc = device->planar ? many->pixelformat : one->pixelformat;
	device->format = known[choice].format;
	device->width = device->planar ? many->width : one->width;
	device->height = device->planar ? many->height : one->height;
	device->stride = device->planar ? many->plane_fmt[0].bytesperline : one->bytesperline;
	if (device->planar)
		colours(device, many->colorspace, many->ycbcr_enc, many->quantization);
	else
		colours(device, one->colorspace, one->ycbcr_enc, one->quantization);
	uint64_t tight = camera_format_bytes(device->format, device->width, 1);
	uint32_t row = device->format == CAMERA_NV12 ? device->width : (uint32_t)tight;
	device->stride = device->stride < row ? row : device->stride;
	device->picture_bytes = device->stride * device->height;
	if (device->format == CAMERA_NV12)
		device->picture_bytes += device->stride * ((device->height + 1) / 2);
	return fourcc == known[choice].fourcc && device->width <= config->width && device->height <= config->height &&
		   device->width >= 16 && device->height >= 16 && (!device->planar || many->num_planes == 1);
}

static void set_rate(struct v4l2_device *device, uint32_t fps)
{
	struct v4l2_streamparm rate = { .type = device->type };
	rate.parm.capture.timeperframe = (struct v4l2_fract){ 1, fps };
	device->fps_milli = 0;
	if (control(device, VIDIOC_S_PARM, &rate) == 0 && rate.parm.capture.timeperframe.numerator)
		device->fps_milli = (uint32_t)(UINT64_C(1000) * rate.parm.capture.timeperframe.denominator /
									   rate.parm.capture.timeperframe.numerator);
}

/* Fast enough counts first, then the picture's size. */
static uint64_t worth(const struct v4l2_device *device, uint32_t fps)
{
	uint32_t enough = fps * 1000 < FAST_MILLI ? fps * 900 : FAST_MILLI;
	bool fast = !device->fps_milli || device->fps_milli >= enough;
	return (uint64_t)fast << 40 | (uint64_t)device->width * device->height;
}

static bool allowed(const struct v4l2_device *device, const struct camera_config *config, bool jpeg, size_t choice)
{
	bool wanted = config->format == CAMERA_FORMAT_ANY || config->format == known[choice].format;
	return wanted && (jpeg || known[choice].format != CAMERA_MJPEG) && offers(device, known[choice].fourcc);
}

static int negotiate(struct v4l2_device *device, const struct camera_config *config, bool jpeg, char *why)
{
	size_t best = KNOWN;
	uint64_t most = 0;
	char words[48], offered[160] = "";
	for (size_t i = 0; i < KNOWN; i++) {
		if (!allowed(device, config, jpeg, i) || !set_format(device, config, i))
			continue;
		set_rate(device, config->fps);
		v4l2_device_words(device, words, sizeof(words));
		size_t used = strlen(offered);
		snprintf(offered + used, sizeof(offered) - used, "%s%s", used ? ", " : "", words);
		if (worth(device, config->fps) > most) {
			most = worth(device, config->fps);
			best = i;
		}
	}
	if (best == KNOWN || !set_format(device, config, best)) {
		snprintf(why, WHY_SIZE, "no %s picture up to %u x %u%s", camera_format_name(config->format), config->width,
			config->height, jpeg ? "" : ", and no JPEG decoder is built in");
		return -ENOTSUP;
	}
	set_rate(device, config->fps);
	v4l2_device_words(device, words, sizeof(words));
	log_info("camera: %s (%s) offers %s; %s taken", config->source, device->name, offered, words);
	return 0;
}

static struct v4l2_buffer describe(const struct v4l2_device *device, uint32_t index, struct v4l2_plane *plane)
{
	struct v4l2_buffer buffer = { .type = device->type, .memory = V4L2_MEMORY_MMAP, .index = index };
	if (device->planar) {
		*plane = (struct v4l2_plane){ 0 };
		buffer.m.planes = plane;
		buffer.length = 1;
	}
	return buffer;
}

static int map_buffer(struct v4l2_device *device, uint32_t index)
{
	struct v4l2_plane plane = { 0 };
	struct v4l2_buffer buffer = describe(device, index, &plane);
	struct v4l2_buffer_memory *memory = &device->buffers[index];
	int status = control(device, VIDIOC_QUERYBUF, &buffer);
	if (status < 0)
		return status;
	memory->bytes = device->planar ? plane.length : buffer.length;
	off_t offset = device->planar ? (off_t)plane.m.mem_offset : (off_t)buffer.m.offset;
	void *at = mmap(NULL, memory->bytes, PROT_READ | PROT_WRITE, MAP_SHARED, device->fd, offset);
	if (at == MAP_FAILED)
		return -errno;
	memory->at = at;
	memory->dmabuf = -1;
	struct v4l2_exportbuffer export = { .type = device->type, .index = index, .flags = O_RDONLY | O_CLOEXEC };
	if (control(device, VIDIOC_EXPBUF, &export) == 0)
		memory->dmabuf = export.fd;
	return 0;
}

/* One shown, one waiting, one on its way back, one for the driver; JPEG is decoded and given back at once. */
static uint32_t fewest(const struct v4l2_device *device)
{
	return device->format == CAMERA_MJPEG ? 2 : 4;
}

static int start(struct v4l2_device *device, char *why)
{
	struct v4l2_requestbuffers request = {
		.count = V4L2_DEVICE_BUFFERS, .type = device->type, .memory = V4L2_MEMORY_MMAP
	};
	int status = control(device, VIDIOC_REQBUFS, &request);
	if (status < 0)
		return fail(why, status, "no buffers");
	device->buffer_count = request.count < V4L2_DEVICE_BUFFERS ? request.count : V4L2_DEVICE_BUFFERS;
	for (uint32_t i = 0; i < device->buffer_count; i++) {
		status = map_buffer(device, i);
		if (status == 0 && device->format != CAMERA_MJPEG && device->buffers[i].bytes < device->picture_bytes)
			status = -EFBIG;
		if (status == 0)
			status = v4l2_device_give(device, i);
		if (status < 0)
			return fail(why, status, "a buffer cannot be mapped");
	}
	if (device->buffer_count < fewest(device))
		return fail(why, -ENOMEM, "too few buffers");
	int type = (int)device->type;
	status = control(device, VIDIOC_STREAMON, &type);
	return status < 0 ? fail(why, status, "it does not start") : 0;
}

int v4l2_device_open(struct v4l2_device *device, const struct camera_config *config, bool jpeg, char *why)
{
	*device = (struct v4l2_device){ .fd = -1 };
	for (int i = 0; i < V4L2_DEVICE_BUFFERS; i++)
		device->buffers[i].dmabuf = -1;
	device->fd = open(config->source, O_RDWR | O_NONBLOCK | O_CLOEXEC);
	if (device->fd < 0)
		return fail(why, -errno, config->source);
	int status = look_at(device, why);
	if (status == 0)
		status = negotiate(device, config, jpeg, why);
	if (status == 0)
		status = start(device, why);
	if (status < 0)
		v4l2_device_close(device);
	return status;
}

void v4l2_device_close(struct v4l2_device *device)
{
	if (device->fd < 0)
		return;
	for (uint32_t i = 0; i < device->buffer_count; i++) {
		if (device->buffers[i].at)
			munmap(device->buffers[i].at, device->buffers[i].bytes);
		if (device->buffers[i].dmabuf >= 0)
			close(device->buffers[i].dmabuf);
	}
	close(device->fd);
	*device = (struct v4l2_device){ .fd = -1 };
}

int v4l2_device_take(struct v4l2_device *device, struct v4l2_filled *out)
{
	struct v4l2_plane plane = { 0 };
	struct v4l2_buffer buffer = describe(device, 0, &plane);
	int status = control(device, VIDIOC_DQBUF, &buffer);
	if (status < 0)
		return status;
	out->index = buffer.index;
	out->bytes = device->planar ? plane.bytesused : buffer.bytesused;
	out->sequence = buffer.sequence;
	out->broken = buffer.flags & V4L2_BUF_FLAG_ERROR;
	bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
	out->time_ns = monotonic ? buffer.timestamp.tv_sec * NS_PER_S + buffer.timestamp.tv_usec * 1000 : clock_now_ns();
	return buffer.index < device->buffer_count ? 0 : -EIO;
}

int v4l2_device_give(struct v4l2_device *device, uint32_t index)
{
	struct v4l2_plane plane = { 0 };
	struct v4l2_buffer buffer = describe(device, index, &plane);
	return control(device, VIDIOC_QBUF, &buffer);
}

void v4l2_device_words(const struct v4l2_device *device, char *out, size_t size)
{
	snprintf(out, size, "%s %ux%u", camera_format_name(device->format), device->width, device->height);
	size_t used = strlen(out);
	if (device->fps_milli)
		snprintf(out + used, size - used, " %.3g/s", device->fps_milli / 1000.0);
}
