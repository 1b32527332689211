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
	DISPLAY_KEY_QUIT,     /* escape, q */
};
enum display_event_kind { DISPLAY_EVENT_KEY, DISPLAY_EVENT_CLOSE, DISPLAY_EVENT_RESIZE };
struct display_event {
	enum display_event_kind kind;
	enum display_key key;   /* of KEY; repeats while held */
	uint32_t width, height; /* of RESIZE, px */
};

struct display_config {
	uint32_t width, height; /* wanted, px; a panel has its own */
	const char *title;      /* of a window; borrowed during open */
	bool vsync;
};

#define DISPLAY_EVENTS_MAX 32
struct display {
	const struct display_ops *ops;
	void *native[4]; /* the implementation's */
	uint32_t width, height;
	struct display_event events[DISPLAY_EVENTS_MAX]; /* ring; when full the oldest is dropped */
	uint32_t event_first, event_count;
};

/* All mandatory. */
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
	/* Gathers what happened since the last call into the ring. Never waits. */
	void (*pump)(struct display *display);
	bool has_window; /* false: there is no default framebuffer to present to */
};

extern const struct display_ops display_surfaceless; /* no screen, no root, no GPU needed */
#ifdef BLVD_HAVE_GLFW
extern const struct display_ops display_window;
#endif

/* By name: "headless", "window". NULL when it is unknown or not built in. */
const struct display_ops *display_by_name(const char *name);

/* Zeroes *display on failure. */
int display_open(struct display *display, const struct display_ops *ops, const struct display_config *config);
/* A zeroed display does nothing. */
void display_close(struct display *display);
int display_use(struct display *display);
int display_present(struct display *display);
/* The next event, oldest first; false when there is none. */
bool display_poll(struct display *display, struct display_event *out);

/* For implementations. */
void display_push(struct display *display, const struct display_event *event);

/* Address of a GL entry point of the current context, or NULL. */
void (*display_get_proc(const char *name))(void);

#endif
