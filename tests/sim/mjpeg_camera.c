/*
 * A camera that sends Motion JPEG, for board/test: pictures written to a v4l2loopback device, whole and damaged ones.
 *   mjpeg_camera DEVICE WIDTHxHEIGHT FPS KIND      until it is killed
 * KIND: whole; bare (without Huffman tables, as many cameras send it), padded (zeros behind it): both are whole
 * pictures, grey with a bar that moves. cut (ends in the middle), torn (another one's bytes in the middle), noise (no
 * JPEG), empty (a few bytes): magenta, so that it is seen where one is shown. mixed: a whole one, then one of these,
 * and so on.
 */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <turbojpeg.h>
#include <unistd.h>

#include "platform/base/clock.h"

#define STEPS 8 /* places of the bar */
#define SIDE_MAX 2048
#define PADDING 1000

enum kind { WHOLE, BARE, PADDED, CUT, TORN, NOISE, EMPTY, MIXED, KINDS };
static const char *const kind_names[KINDS] = { "whole", "bare", "padded", "cut", "torn", "noise", "empty", "mixed" };

struct jpeg {
	unsigned char *data; /* turbojpeg's; with room for the padding */
	unsigned long bytes;
};

static int fail(const char *what, const char *why)
{
	fprintf(stderr, "mjpeg_camera: %s: %s\n", what, why);
	return EXIT_FAILURE;
}

/* Grey with a bar of the given step, or magenta: RGB. */
static void paint(unsigned char *rgb, int width, int height, int step, bool magenta)
{
	for (int i = 0; i < width * height; i++) {
		bool bar = i / width > height * 3 / 4 && i % width * STEPS / width == step;
		unsigned char *p = rgb + 3 * (size_t)i;
		p[0] = p[2] = magenta ? 240 : bar ? 60 : 128;
		p[1] = magenta ? 0 : bar ? 60 : 128;
	}
}

/* That picture, 4:2:2, as USB cameras send it. */
static bool make(struct jpeg *out, int width, int height, int step, bool magenta)
{
	static unsigned char rgb[SIDE_MAX * SIDE_MAX * 3];
	tjhandle tj = tjInitCompress();
	out->bytes = tjBufSize(width, height, TJSAMP_422);
	out->data = malloc(out->bytes + PADDING);
	if (!tj || !out->data)
		return false;
	paint(rgb, width, height, step, magenta);
	int status =
		tjCompress2(tj, rgb, width, 0, height, TJPF_RGB, &out->data, &out->bytes, TJSAMP_422, 90, TJFLAG_NOREALLOC);
	tjDestroy(tj);
	return status == 0;
}

/* Takes the segments of Huffman tables out of the header. */
static void strip_tables(struct jpeg *jpeg)
{
	unsigned long at = 2;
	while (at + 4 < jpeg->bytes && jpeg->data[at] == 0xFF && jpeg->data[at + 1] != 0xDA) {
		unsigned long size = 2ul + ((unsigned long)jpeg->data[at + 2] << 8 | jpeg->data[at + 3]);
		if (jpeg->data[at + 1] == 0xC4) {
			memmove(jpeg->data + at, jpeg->data + at + size, jpeg->bytes - at - size);
			jpeg->bytes -= size;
		} else {
			at += size;
		}
	}
}

static void spoil(struct jpeg *jpeg, enum kind kind)
{
	unsigned long from = jpeg->bytes / 3, to = 2 * from;
	switch (kind) {
	case BARE:
		strip_tables(jpeg);
		break;
	case PADDED:
		memset(jpeg->data + jpeg->bytes, 0, PADDING);
		jpeg->bytes += PADDING;
		break;
	case CUT:
		jpeg->bytes /= 2;
		break;
	case TORN:
		for (unsigned long i = from; i < to; i++)
			jpeg->data[i] = (unsigned char)((i * 2654435761u) >> 13);
		break;
	case NOISE:
		for (unsigned long i = 0; i < jpeg->bytes; i++)
			jpeg->data[i] = (unsigned char)((i * 2654435761u) >> 11);
		break;
	case EMPTY:
		jpeg->bytes = 7;
		break;
	default:
		break;
	}
}

static int open_device(const char *path, int width, int height)
{
	int fd = open(path, O_RDWR | O_CLOEXEC);
	struct v4l2_format format = { .type = V4L2_BUF_TYPE_VIDEO_OUTPUT };
	format.fmt.pix.width = (unsigned)width;
	format.fmt.pix.height = (unsigned)height;
	format.fmt.pix.pixelformat = V4L2_PIX_FMT_MJPEG;
	if (fd >= 0 && ioctl(fd, VIDIOC_S_FMT, &format) == 0 && format.fmt.pix.width == (unsigned)width &&
		format.fmt.pix.pixelformat == V4L2_PIX_FMT_MJPEG)
		return fd;
	if (fd >= 0)
		close(fd);
	return -1;
}

/* Writes pictures of that kind at that rate, for ever. */
static int play(int fd, const struct jpeg *whole, const struct jpeg *damaged, enum kind kind, int fps)
{
	int64_t next = clock_now_ns();
	for (unsigned number = 0;; number++) {
		bool sound = kind < CUT || (kind == MIXED && number % 2 == 0);
		const struct jpeg *jpeg = sound ? &whole[number % STEPS] : &damaged[kind == MIXED ? number / 2 % 4 : 0];
		if (write(fd, jpeg->data, jpeg->bytes) < 0)
			return fail("write", strerror(errno));
		next += NS_PER_S / fps;
		clock_sleep_until(next);
	}
}

int main(int argc, char **argv)
{
	static struct jpeg whole[STEPS], damaged[4];
	int width = 0, height = 0, fps = argc == 5 ? atoi(argv[3]) : 0;
	unsigned kind = 0;
	while (argc == 5 && kind < KINDS && strcmp(argv[4], kind_names[kind]) != 0)
		kind++;
	if (argc != 5 || kind == KINDS || fps < 1 || sscanf(argv[2], "%dx%d", &width, &height) != 2 || width < 16 ||
		height < 16 || width > SIDE_MAX || height > SIDE_MAX) {
		fprintf(stderr, "usage: mjpeg_camera DEVICE WIDTHxHEIGHT FPS whole|bare|padded|cut|torn|noise|empty|mixed\n");
		return 2;
	}
	for (int i = 0; i < STEPS; i++) {
		if (!make(&whole[i], width, height, i, false))
			return fail("JPEG", "cannot be made");
		spoil(&whole[i], kind < CUT ? (enum kind)kind : WHOLE);
	}
	for (int i = 0; i < 4; i++) {
		if (!make(&damaged[i], width, height, 0, true))
			return fail("JPEG", "cannot be made");
		spoil(&damaged[i], kind == MIXED ? (enum kind)(CUT + i) : (enum kind)kind);
	}
	int fd = open_device(argv[1], width, height);
	return fd < 0 ? fail(argv[1], "does not take Motion JPEG of this size")
				  : play(fd, whole, damaged, (enum kind)kind, fps);
}
