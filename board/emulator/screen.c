/*
 * What is on the screen, asked of the kernel (KMS), whoever draws it: for board/test, as root. Not part of the product.
 *   board_screen shot FILE.png     the picture that is scanned out now
 *   board_screen watch SECONDS     one line of JSON: pictures, the longest time between two, time without any
 *   board_screen colours FILE.png  how many different colours it has, of 4096: a plain picture has few
 *   board_screen differ A.png B.png    how many of a million pixels differ clearly
 *   board_screen step A.png B.png      the greatest difference of a channel, of 255
 *   board_screen pixel FILE.png X Y    its colour there, RRGGBB
 * The plain kernel interface is enough; dumb and linear buffers only, which is what a machine without a GPU scans out.
 */
#include <drm.h>
#include <drm_fourcc.h>
#include <drm_mode.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <png.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "board/png_write.h"
#include "platform/base/clock.h"

#define CARDS 8
#define CRTCS 16
#define POLL_NS (4 * NS_PER_MS)
#define CLEARLY 25 /* of 255, in any channel */

struct screen_source {
	int fd;
	uint32_t crtc;
};

static int fail(const char *what)
{
	fprintf(stderr, "board_screen: %s: %s\n", what, strerror(errno));
	return EXIT_FAILURE;
}

static bool read_crtc(const struct screen_source *source, uint32_t id, struct drm_mode_crtc *out)
{
	*out = (struct drm_mode_crtc){ .crtc_id = id };
	return ioctl(source->fd, DRM_IOCTL_MODE_GETCRTC, out) == 0;
}

/* The first card with a CRTC; one that shows something is preferred. */
static bool find_screen(struct screen_source *out)
{
	*out = (struct screen_source){ .fd = -1 };
	for (int card = 0; card < CARDS; card++) {
		char path[32];
		uint32_t crtcs[CRTCS] = { 0 };
		snprintf(path, sizeof(path), "/dev/dri/card%d", card);
		struct screen_source source = { .fd = open(path, O_RDWR | O_CLOEXEC) };
		if (source.fd < 0)
			continue;
		struct drm_mode_card_res res = { .crtc_id_ptr = (uintptr_t)crtcs, .count_crtcs = CRTCS };
		bool found = ioctl(source.fd, DRM_IOCTL_MODE_GETRESOURCES, &res) == 0 && res.count_crtcs > 0;
		source.crtc = found ? crtcs[0] : 0;
		for (uint32_t i = 0; found && i < res.count_crtcs && i < CRTCS; i++) {
			struct drm_mode_crtc crtc;
			if (read_crtc(&source, crtcs[i], &crtc) && crtc.mode_valid)
				source.crtc = crtcs[i];
		}
		if (found) {
			*out = source;
			/* It must not be the master, which would keep the program under test from drawing. */
			ioctl(source.fd, DRM_IOCTL_DROP_MASTER, 0);
			return true;
		}
		close(source.fd);
	}
	errno = ENODEV;
	return false;
}

static void copy_rows(uint8_t *to, const uint8_t *from, const struct drm_mode_fb_cmd2 *fb, bool red_first)
{
	for (uint32_t y = 0; y < fb->height; y++) {
		const uint8_t *row = from + fb->offsets[0] + (size_t)y * fb->pitches[0];
		for (uint32_t x = 0; x < fb->width; x++, row += 4, to += 4) {
			to[0] = row[red_first ? 0 : 2];
			to[1] = row[1];
			to[2] = row[red_first ? 2 : 0];
			to[3] = 255;
		}
	}
}

static int shoot(const struct screen_source *source, const char *path)
{
	struct drm_mode_crtc crtc;
	if (!read_crtc(source, source->crtc, &crtc))
		return fail("GETCRTC");
	if (!crtc.mode_valid || !crtc.fb_id) {
		fprintf(stderr, "board_screen: the screen is dark\n");
		return EXIT_FAILURE;
	}
	struct drm_mode_fb_cmd2 fb = { .fb_id = crtc.fb_id };
	if (ioctl(source->fd, DRM_IOCTL_MODE_GETFB2, &fb) < 0)
		return fail("GETFB2");
	uint32_t format = fb.pixel_format;
	if ((format != DRM_FORMAT_XRGB8888 && format != DRM_FORMAT_ARGB8888 && format != DRM_FORMAT_XBGR8888 &&
			format != DRM_FORMAT_ABGR8888) ||
		((fb.flags & DRM_MODE_FB_MODIFIERS) && fb.modifier[0] != DRM_FORMAT_MOD_LINEAR)) {
		fprintf(stderr, "board_screen: pixels of format %.4s are not known\n", (const char *)&format);
		return EXIT_FAILURE;
	}
	struct drm_mode_map_dumb map = { .handle = fb.handles[0] };
	if (ioctl(source->fd, DRM_IOCTL_MODE_MAP_DUMB, &map) < 0)
		return fail("MAP_DUMB");
	size_t size = fb.offsets[0] + (size_t)fb.pitches[0] * fb.height;
	void *pixels = mmap(NULL, size, PROT_READ, MAP_SHARED, source->fd, (off_t)map.offset);
	if (pixels == MAP_FAILED)
		return fail("mmap");
	size_t bytes = (size_t)fb.width * fb.height * 4;
	uint8_t *copy = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	if (copy == MAP_FAILED)
		return fail("mmap");
	copy_rows(copy, pixels, &fb, format == DRM_FORMAT_XBGR8888 || format == DRM_FORMAT_ABGR8888);
	int status = png_write(path, copy, fb.width, fb.height);
	munmap(copy, bytes);
	munmap(pixels, size);
	return status < 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

static int watch(const struct screen_source *source, double seconds)
{
	int64_t began = clock_now_ns(), changed = began, gap = 0, dark = 0, last = began;
	int64_t end = began + (int64_t)(seconds * 1e9);
	uint32_t shown = 0;
	unsigned pictures = 0;
	while (last < end) {
		clock_sleep_until(last + POLL_NS);
		int64_t now = clock_now_ns();
		struct drm_mode_crtc crtc;
		bool lit = read_crtc(source, source->crtc, &crtc) && crtc.mode_valid && crtc.fb_id;
		if (!lit)
			dark += now - last;
		if (lit && crtc.fb_id != shown) {
			shown = crtc.fb_id;
			pictures++;
			changed = now;
		}
		if (now - changed > gap)
			gap = now - changed;
		if (!lit)
			shown = 0;
		last = now;
	}
	printf("{\"seconds\":%.3f, \"pictures\":%u, \"longest_gap_ms\":%.0f, \"dark_ms\":%.0f}\n",
		(double)(last - began) / 1e9, pictures, (double)gap / 1e6, (double)dark / 1e6);
	return EXIT_SUCCESS;
}

struct picture {
	png_image image;
	uint8_t *pixels; /* RGBA */
};

static bool load(struct picture *out, const char *path)
{
	*out = (struct picture){ .image = { .version = PNG_IMAGE_VERSION } };
	if (!png_image_begin_read_from_file(&out->image, path)) {
		fprintf(stderr, "board_screen: %s: %s\n", path, out->image.message);
		return false;
	}
	out->image.format = PNG_FORMAT_RGBA;
	out->pixels = mmap(NULL, PNG_IMAGE_SIZE(out->image), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	return out->pixels != MAP_FAILED && png_image_finish_read(&out->image, NULL, out->pixels, 0, NULL);
}

static int count_colours(const char *path)
{
	static bool seen[4096];
	struct picture picture;
	unsigned count = 0;
	if (!load(&picture, path))
		return EXIT_FAILURE;
	for (size_t i = 0; i < PNG_IMAGE_SIZE(picture.image); i += 4) {
		const uint8_t *p = picture.pixels + i;
		bool *at = &seen[(p[0] >> 4) << 8 | (p[1] >> 4) << 4 | p[2] >> 4];
		count += !*at;
		*at = true;
	}
	printf("%u\n", count);
	return EXIT_SUCCESS;
}

static bool load_both(struct picture *a, struct picture *b, const char *path_a, const char *path_b)
{
	if (!load(a, path_a) || !load(b, path_b))
		return false;
	bool same = a->image.width == b->image.width && a->image.height == b->image.height;
	if (!same)
		fprintf(stderr, "board_screen: the pictures are of different sizes\n");
	return same;
}

static int greatest_step(const char *path_a, const char *path_b)
{
	struct picture a, b;
	int step = 0;
	if (!load_both(&a, &b, path_a, path_b))
		return EXIT_FAILURE;
	for (size_t i = 0; i < PNG_IMAGE_SIZE(a.image); i++)
		if (abs(a.pixels[i] - b.pixels[i]) > step)
			step = abs(a.pixels[i] - b.pixels[i]);
	printf("%d\n", step);
	return EXIT_SUCCESS;
}

static int count_differences(const char *path_a, const char *path_b)
{
	struct picture a, b;
	if (!load_both(&a, &b, path_a, path_b))
		return EXIT_FAILURE;
	uint64_t count = 0;
	for (size_t i = 0; i < PNG_IMAGE_SIZE(a.image); i += 4) {
		const uint8_t *p = a.pixels + i, *q = b.pixels + i;
		count += abs(p[0] - q[0]) > CLEARLY || abs(p[1] - q[1]) > CLEARLY || abs(p[2] - q[2]) > CLEARLY;
	}
	printf("%" PRIu64 "\n", count * 1000000 / ((uint64_t)a.image.width * a.image.height));
	return EXIT_SUCCESS;
}

static int tell_pixel(const char *path, int x, int y)
{
	struct picture picture;
	if (!load(&picture, path))
		return EXIT_FAILURE;
	if (x < 0 || y < 0 || (uint32_t)x >= picture.image.width || (uint32_t)y >= picture.image.height) {
		fprintf(stderr, "board_screen: %s is of %u x %u pixels\n", path, picture.image.width, picture.image.height);
		return EXIT_FAILURE;
	}
	const uint8_t *p = picture.pixels + ((size_t)y * picture.image.width + (size_t)x) * 4;
	printf("%02X%02X%02X\n", p[0], p[1], p[2]);
	return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
	if (argc == 3 && !strcmp(argv[1], "colours"))
		return count_colours(argv[2]);
	if (argc == 4 && !strcmp(argv[1], "differ"))
		return count_differences(argv[2], argv[3]);
	if (argc == 4 && !strcmp(argv[1], "step"))
		return greatest_step(argv[2], argv[3]);
	if (argc == 5 && !strcmp(argv[1], "pixel"))
		return tell_pixel(argv[2], atoi(argv[3]), atoi(argv[4]));
	struct screen_source source;
	bool shot = argc == 3 && !strcmp(argv[1], "shot");
	if (!shot && !(argc == 3 && !strcmp(argv[1], "watch") && atof(argv[2]) > 0)) {
		fprintf(stderr, "usage: board_screen shot FILE.png | watch SECONDS | colours FILE.png | differ A.png B.png |"
						" step A.png B.png | pixel FILE.png X Y\n");
		return 2;
	}
	if (!find_screen(&source))
		return fail("no screen");
	int code = shot ? shoot(&source, argv[2]) : watch(&source, atof(argv[2]));
	close(source.fd);
	return code;
}
