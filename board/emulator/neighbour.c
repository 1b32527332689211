/*
 * Another program on the same machine, as far as terminals and the screen go: for board/test, as root. Not part of the
 * product.
 *   board_neighbour to N             switches to terminal N as a keyboard would; 1 when it is not in front after 5 s
 *   board_neighbour active           the number of the terminal in front
 *   board_neighbour terminal N       "text auto", "graphics process", ...: what it shows, and how it is left
 *   board_neighbour paint RRGGBB     takes the screen in its present or first mode and paints it, until it is killed;
 *                                    writes a line when it is seen, or says why not
 */
#include <drm.h>
#include <drm_mode.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/kd.h>
#include <linux/vt.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "platform/base/clock.h"

#define WAIT_NS (5 * NS_PER_S)
#define POLL_NS (10 * NS_PER_MS)
#define MODES 128
#define CARDS 8

static int fail(const char *what)
{
	fprintf(stderr, "board_neighbour: %s: %s\n", what, strerror(errno));
	return EXIT_FAILURE;
}

/* --- terminals ------------------------------------------------------------------------------------------------- */

static unsigned active_terminal(int fd)
{
	struct vt_stat state;
	return ioctl(fd, VT_GETSTATE, &state) ? 0 : state.v_active;
}

static int go_to(int fd, unsigned number)
{
	int64_t end = clock_now_ns() + WAIT_NS;
	if (ioctl(fd, VT_ACTIVATE, number))
		return fail("VT_ACTIVATE");
	while (active_terminal(fd) != number) {
		if (clock_now_ns() > end) {
			fprintf(stderr, "board_neighbour: terminal %u does not come to the front\n", number);
			return EXIT_FAILURE;
		}
		clock_sleep_until(clock_now_ns() + POLL_NS);
	}
	return EXIT_SUCCESS;
}

static int describe(const char *number)
{
	char path[32];
	struct vt_mode mode;
	int shows;
	snprintf(path, sizeof(path), "/dev/tty%s", number);
	int fd = open(path, O_RDWR | O_CLOEXEC | O_NOCTTY);
	if (fd < 0 || ioctl(fd, KDGETMODE, &shows) || ioctl(fd, VT_GETMODE, &mode))
		return fail(path);
	printf("%s %s\n", shows == KD_GRAPHICS ? "graphics" : "text", mode.mode == VT_PROCESS ? "process" : "auto");
	return EXIT_SUCCESS;
}

static int on_terminals(int argc, char **argv)
{
	int fd = open("/dev/tty0", O_RDWR | O_CLOEXEC | O_NOCTTY);
	if (fd < 0)
		return fail("/dev/tty0");
	if (!strcmp(argv[1], "to") && argc == 3)
		return go_to(fd, (unsigned)atoi(argv[2]));
	printf("%u\n", active_terminal(fd));
	return EXIT_SUCCESS;
}

/* --- the screen ------------------------------------------------------------------------------------------------ */

struct screen {
	int fd;
	uint32_t crtc, connector;
	struct drm_mode_modeinfo mode;
};

static bool find_screen(struct screen *screen)
{
	static struct drm_mode_modeinfo modes[MODES];
	struct drm_mode_card_res res = { .crtc_id_ptr = (uintptr_t)&screen->crtc,
		.count_crtcs = 1,
		.connector_id_ptr = (uintptr_t)&screen->connector,
		.count_connectors = 1 };
	if (ioctl(screen->fd, DRM_IOCTL_MODE_GETRESOURCES, &res))
		return false;
	struct drm_mode_get_connector probe = { .connector_id = screen->connector }; /* asking for nothing asks the panel */
	ioctl(screen->fd, DRM_IOCTL_MODE_GETCONNECTOR, &probe);
	struct drm_mode_get_connector connector = {
		.connector_id = screen->connector, .modes_ptr = (uintptr_t)modes, .count_modes = MODES
	};
	struct drm_mode_crtc now = { .crtc_id = screen->crtc };
	if (ioctl(screen->fd, DRM_IOCTL_MODE_GETCONNECTOR, &connector) || !connector.count_modes ||
		connector.count_modes > MODES)
		return false;
	screen->mode = modes[0];
	if (!ioctl(screen->fd, DRM_IOCTL_MODE_GETCRTC, &now) && now.mode_valid)
		screen->mode = now.mode;
	return true;
}

/* A buffer of that colour. 0: none. */
static uint32_t make_picture(const struct screen *screen, uint32_t colour)
{
	uint32_t width = screen->mode.hdisplay, height = screen->mode.vdisplay;
	struct drm_mode_create_dumb buffer = { .width = width, .height = height, .bpp = 32 };
	if (ioctl(screen->fd, DRM_IOCTL_MODE_CREATE_DUMB, &buffer))
		return 0;
	struct drm_mode_map_dumb map = { .handle = buffer.handle };
	struct drm_mode_fb_cmd fb = {
		.width = width, .height = height, .pitch = buffer.pitch, .bpp = 32, .depth = 24, .handle = buffer.handle
	};
	if (ioctl(screen->fd, DRM_IOCTL_MODE_MAP_DUMB, &map) || ioctl(screen->fd, DRM_IOCTL_MODE_ADDFB, &fb))
		return 0;
	uint32_t *pixels = mmap(NULL, buffer.size, PROT_READ | PROT_WRITE, MAP_SHARED, screen->fd, (off_t)map.offset);
	if (pixels == MAP_FAILED)
		return 0;
	for (size_t i = 0; i < buffer.size / 4; i++)
		pixels[i] = colour;
	munmap(pixels, buffer.size);
	return fb.fb_id;
}

/* The first card that has a screen. */
static bool open_screen(struct screen *screen)
{
	for (int card = 0; card < CARDS; card++) {
		char path[32];
		snprintf(path, sizeof(path), "/dev/dri/card%d", card);
		*screen = (struct screen){ .fd = open(path, O_RDWR | O_CLOEXEC) };
		if (screen->fd >= 0 && find_screen(screen))
			return true;
		if (screen->fd >= 0)
			close(screen->fd);
	}
	return false;
}

static int paint(uint32_t colour)
{
	struct screen screen;
	if (!open_screen(&screen))
		return fail("no screen");
	if (ioctl(screen.fd, DRM_IOCTL_SET_MASTER, 0))
		return fail("the screen is somebody else's");
	uint32_t fb = make_picture(&screen, colour);
	struct drm_mode_crtc crtc = { .crtc_id = screen.crtc,
		.fb_id = fb,
		.set_connectors_ptr = (uintptr_t)&screen.connector,
		.count_connectors = 1,
		.mode = screen.mode,
		.mode_valid = 1 };
	if (!fb || ioctl(screen.fd, DRM_IOCTL_MODE_SETCRTC, &crtc))
		return fail("no picture");
	puts("painted");
	fflush(stdout);
	for (;;)
		pause();
}

int main(int argc, char **argv)
{
	if ((argc == 3 && !strcmp(argv[1], "to")) || (argc == 2 && !strcmp(argv[1], "active")))
		return on_terminals(argc, argv);
	if (argc == 3 && !strcmp(argv[1], "terminal"))
		return describe(argv[2]);
	if (argc == 3 && !strcmp(argv[1], "paint"))
		return paint((uint32_t)strtoul(argv[2], NULL, 16));
	fprintf(stderr, "usage: board_neighbour to N | active | terminal N | paint RRGGBB\n");
	return 2;
}
