/*
 * Somewhere to show pictures, with a current OpenGL ES 3.0 context. Chosen once at start by name; every display answers
 * the same operations. A display is used from the thread that opened it. There is one window at a time, but there may
 * be several displays without a screen: display_use() changes between them.
 */
#ifndef BLVD_PLATFORM_DISPLAY_DISPLAY_H
#define BLVD_PLATFORM_DISPLAY_DISPLAY_H

#include <stdbool.h>
#include <stdint.h>

enum display_key {
	DISPLAY_KEY_NONE,
	DISPLAY_KEY_UP,
	DISPLAY_KEY_DOWN,
	DISPLAY_KEY_LEFT,
	DISPLAY_KEY_RIGHT,
	DISPLAY_KEY_ZOOM_IN,  /* plus */
	DISPLAY_KEY_ZOOM_OUT, /* minus */
	DISPLAY_KEY_CAMERA,   /* c: the next camera */
	DISPLAY_KEY_NIGHT,    /* n: day or night look */
	DISPLAY_KEY_PAUSE,    /* space */
	DISPLAY_KEY_PUSH,     /* return: the menu, and what is chosen in it */
	DISPLAY_KEY_BACK,     /* backspace */
	DISPLAY_KEY_ESCAPE,   /* closes the menu, else ends the program */
	DISPLAY_KEY_QUIT,     /* q */
};
enum display_event_kind { DISPLAY_EVENT_KEY, DISPLAY_EVENT_CLOSE, DISPLAY_EVENT_RESIZE };
struct display_event {
	enum display_event_kind kind;
	enum display_key key;   /* of KEY; repeats while held */
	uint32_t width, height; /* of RESIZE, px */
};

/* Where pictures go, once a display is open. */
enum display_surface {
	DISPLAY_SURFACE_NONE,   /* nowhere: who wants them reads them back */
	DISPLAY_SURFACE_WINDOW, /* the context's default framebuffer; then display_present() */
	DISPLAY_SURFACE_PIXELS, /* display_show_pixels() */
};

enum display_buffers { DISPLAY_BUFFERS_AUTO, DISPLAY_BUFFERS_GBM, DISPLAY_BUFFERS_DUMB };

/* Zeroes and NULLs take the defaults. Strings are borrowed until display_close(). */
struct display_config {
	uint32_t width, height; /* wanted, px; a panel has its own */
	const char *title;      /* of a window */
	bool vsync;
	/* of a panel (KMS) */
	const char *device;           /* "/dev/dri/card0"; default the first with something connected */
	const char *connector;        /* "HDMI-A-1"; default the first that is connected */
	const char *mode;             /* "1280x720@60", "1280x720"; default the one that the panel prefers */
	const char *vt;               /* "/dev/tty1"; default the active one, "none" leaves the terminals alone */
	const char *backlight;        /* folder under /sys/class/backlight, or a path; default none */
	unsigned rotation_deg;        /* clockwise: 0, 90, 180, 270 */
	enum display_buffers buffers; /* default: whatever works */
};

/* Since opening. */
struct display_counts {
	uint64_t flips;    /* pictures that reached the panel */
	uint64_t missed;   /* pictures given up: no panel, not ours at that time, or an answer that never came */
	uint32_t modesets; /* first pictures after a start, a hotplug or a switch of terminals */
	uint32_t hotplugs; /* times that a panel came or went */
	uint32_t switches; /* times that the screen was somebody else's */
};

#define DISPLAY_EVENTS_MAX 32
struct display {
	const struct display_ops *ops;
	void *native[4];        /* the implementation's */
	uint32_t width, height; /* as the viewer sees it */
	enum display_surface surface;
	bool hidden;       /* nobody can see it now: a picture need not be drawn; goes on by itself */
	unsigned turn_deg; /* clockwise: by how much whoever fills the window has to turn the picture */
	float dim;         /* 0 to 1: what whoever fills the window has to multiply colours with */
	char detail[64];   /* "1280x720@60, HDMI-A-1, atomic, GBM", or empty */
	struct display_counts counts;
	struct display_event events[DISPLAY_EVENTS_MAX]; /* ring; when full the oldest is dropped */
	uint32_t event_first, event_count;
};

/* Mandatory but where it says otherwise. */
struct display_ops {
	const char *name;
	/* Opens, makes the context current. Returns 0, -ENODEV when there is no such display here, or -EIO; logs one line.
	 */
	int (*open)(struct display *display, const struct display_config *config);
	void (*close)(struct display *display);
	/* Makes the context current again after another display's was. Returns 0 or -EIO. */
	int (*use)(struct display *display);
	/* Shows what was drawn into the context's default framebuffer; waits for the panel when vsync was asked for.
	 * Returns 0 or -EIO. */
	int (*present)(struct display *display);
	/* Of a DISPLAY_SURFACE_PIXELS: shows a picture of RGBA8, top row first, any size. Returns 0 or -EIO. Optional. */
	int (*show_pixels)(struct display *display, const uint8_t *rgba, uint32_t width, uint32_t height);
	/* 0 dark to 1. Optional: without it the picture is dimmed by whoever draws it. */
	void (*set_brightness)(struct display *display, float level);
	/* Gathers what happened since the last call into the ring. Never waits. */
	void (*pump)(struct display *display);
};

extern const struct display_ops display_surfaceless; /* no screen, no root, no GPU needed */
#ifdef BLVD_HAVE_GLFW
extern const struct display_ops display_window;
#endif
#ifdef BLVD_HAVE_KMS
extern const struct display_ops display_kms; /* a panel without a window system */
#endif

/* By name: "headless", "window", "kms". NULL when it is unknown or not built in. */
const struct display_ops *display_by_name(const char *name);

/* Zeroes *display on failure. */
int display_open(struct display *display, const struct display_ops *ops, const struct display_config *config);
/* A zeroed display does nothing. */
void display_close(struct display *display);
int display_use(struct display *display);
int display_present(struct display *display);
int display_show_pixels(struct display *display, const uint8_t *rgba, uint32_t width, uint32_t height);
/* By the panel's light where there is a way, else by display->dim. Small changes cost nothing. */
void display_set_brightness(struct display *display, float level);
/* The next event, oldest first; false when there is none. */
bool display_poll(struct display *display, struct display_event *out);

/* For implementations. */
void display_push(struct display *display, const struct display_event *event);

/* Address of a GL entry point of the current context, or NULL. */
void (*display_get_proc(const char *name))(void);

#endif
