/*
 * A panel without a window system: the parts that the KMS display is made of. kms_common.c is the whole of it (device,
 * output, what to do when it goes or comes back); each other file is one way to do one thing:
 *
 *   kms_mode      which mode               kms_atomic, kms_legacy   how a picture gets onto the panel
 *   kms_output    which connector, CRTC, plane, and their properties
 *   kms_gbm, kms_dumb   where pictures are drawn: by the GPU into buffers of GBM, or copied into plain memory
 *   kms_vt        virtual terminals        kms_hotplug   being told of panels that come and go
 *   kms_dim       brightness
 *
 * Single-threaded. Nothing waits but kms_show(), for the picture before.
 */
#ifndef BLVD_PLATFORM_DISPLAY_KMS_H
#define BLVD_PLATFORM_DISPLAY_KMS_H

#include <stdbool.h>

#include "platform/display/display.h"
#include "platform/display/kms_drm.h"
#include "platform/display/kms_mode.h"

/* Property ids; 0: the object has none of that name. */
struct kms_connector_properties {
	uint32_t crtc_id;
};
struct kms_crtc_properties {
	uint32_t active, mode_id, gamma_lut, gamma_lut_size, ctm;
	uint64_t gamma_size; /* entries of the table; 0 none */
};
struct kms_plane_properties {
	uint32_t fb_id, crtc_id, src_x, src_y, src_w, src_h, crtc_x, crtc_y, crtc_w, crtc_h, rotation;
	uint64_t rotations; /* DRM_MODE_ROTATE_... that the plane can do; 0 none */
};

/* One panel and the way to it. */
struct kms_output {
	uint32_t connector, crtc, plane; /* plane 0: not known (legacy) */
	int crtc_index;
	char name[32]; /* "HDMI-A-1" */
	bool connected;
	drmModeModeInfo mode;
	drmModeModeInfo candidates[KMS_MODES_MAX]; /* in the order in which to try them; [0] is `mode` at first */
	uint32_t candidate_count;
	bool shown_before; /* somebody's picture is on it in this very mode */
	uint32_t legacy_gamma_size;
	struct kms_connector_properties connector_properties;
	struct kms_crtc_properties crtc_properties;
	struct kms_plane_properties plane_properties;
};

struct kms;

/* How a picture gets onto the panel. All return 0 or -errno. */
struct kms_commit {
	const char *name;
	/* Would `mode` work, with `fb` turned by the plane? Changes nothing. -EOPNOTSUPP: cannot be asked. */
	int (*test)(struct kms *kms, const drmModeModeInfo *mode, uint32_t fb, unsigned turn_deg);
	/* Mode and picture, waits until both are there. */
	int (*modeset)(struct kms *kms, uint32_t fb);
	/* The next picture, at the next vertical blank; kms->flip_done comes with an event. */
	int (*flip)(struct kms *kms, uint32_t fb);
	/* Scales all colours by `level`. -EOPNOTSUPP: not this device. */
	int (*dim)(struct kms *kms, float level);
};
extern const struct kms_commit kms_atomic, kms_legacy;

/* A picture on its way: a frame buffer and what must be given back once another one has replaced it. */
struct kms_frame {
	uint32_t fb; /* 0: none */
	void *owner; /* the buffers' own */
};

/* Where pictures are drawn. */
struct kms_buffers {
	const char *name;
	enum display_surface surface;
	/* With a context current afterwards. 0, or an errno when this device cannot. */
	int (*open)(struct kms *kms);
	void (*close)(struct kms *kms);
	int (*use)(struct kms *kms); /* makes the context current */
	/* Buffers for kms->output.mode, instead of those before. Nothing is pending or on screen. */
	int (*resize)(struct kms *kms);
	/* The picture that was drawn last. */
	int (*take)(struct kms *kms, struct kms_frame *out);
	/* It is no longer on screen. */
	void (*give_back)(struct kms *kms, const struct kms_frame *frame);
};
extern const struct kms_buffers kms_gbm, kms_dumb;

enum kms_state {
	KMS_NO_PANEL, /* nothing is connected */
	KMS_AWAY,     /* the screen is somebody else's: another terminal, another master */
	KMS_FRESH,    /* the next picture is a modeset */
	KMS_ON,
};

#define KMS_GBM_BUFFERS 8
struct kms_gbm_buffer {
	void *bo; /* NULL: free */
	uint32_t fb;
};

/* What the buffers keep. */
struct kms_gbm_state {
	void *device, *surface;       /* gbm_device, gbm_surface */
	void *egl, *config, *context; /* EGL's */
	void *window;                 /* EGLSurface */
	struct kms_gbm_buffer buffers[KMS_GBM_BUFFERS];
};
#define KMS_DUMB_BUFFERS 2
struct kms_dumb_state {
	void *egl, *context;
	struct kms_dumb_buffer buffers[KMS_DUMB_BUFFERS];
	uint32_t fbs[KMS_DUMB_BUFFERS];
	bool busy[KMS_DUMB_BUFFERS];
	uint32_t drawn;
};

struct kms_vt {
	int fd; /* -1: no terminal is watched */
	bool graphics;
	bool away; /* another terminal is in front */
};

/* A black picture for whoever is left with the screen. */
struct kms_dark {
	struct kms_dumb_buffer buffer;
	uint32_t fb; /* 0: none */
};

struct kms_hotplug {
	int fd; /* of the kernel's messages; -1: the panel is asked now and then */
	int64_t asked_ns;
};

/* How the light is changed; the first that works. */
enum kms_dim_way { KMS_DIM_BACKLIGHT, KMS_DIM_DEVICE, KMS_DIM_DRAWN };
struct kms_dim {
	enum kms_dim_way way;
	int backlight_fd; /* -1 none */
	unsigned backlight_max, backlight_found;
	float wanted, shown; /* 0 to 1; below 0: nothing was asked for yet */
	uint32_t blob;       /* property value in use */
};

struct kms {
	const struct kms_drm *drm;
	const struct display_config *config;
	int fd;
	char device[64];
	enum kms_state state;
	bool is_master;
	const struct kms_commit *commit;
	const struct kms_buffers *buffers;
	struct kms_output output;
	struct kms_mode_wish wish;
	unsigned plane_turn_deg; /* what the plane turns */
	uint32_t mode_blob;      /* of output.mode; 0 none */
	struct kms_frame on_screen, pending;
	struct kms_dark dark;
	bool shut_out; /* the screen is free, but this opening of the device cannot have it: see kms_pump() */
	int64_t flip_asked_ns;
	int64_t retry_ns; /* when to try again for the screen or the panel */
	struct kms_gbm_state gbm;
	struct kms_dumb_state dumb;
	struct kms_vt vt;
	struct kms_hotplug hotplug;
	struct kms_dim dim;
	struct display_counts counts;
};

/* kms_common.c. `config` must outlive it. Returns 0, -ENODEV or -errno; logs one line when it fails. The screen stays
 * as it is until the first kms_show(). */
int kms_open(struct kms *kms, const struct kms_drm *drm, const struct display_config *config);
void kms_close(struct kms *kms);
/* Terminals, panels, flips: whatever has happened. Never waits, but where another terminal is asked for: for the
 * picture before. Sets `shut_out` when the process has to end to have the screen: without root only who opens a free
 * device gets it, and this one was opened while another program had it. */
void kms_pump(struct kms *kms, int64_t now_ns);
/* Shows what was drawn. Waits for the picture before, at most for a second. A picture that cannot be shown is dropped
 * and counted; that is no failure. */
int kms_show(struct kms *kms);
/* Until the picture before is on screen, at most for a second. */
void kms_wait(struct kms *kms);
/* Is a picture worth drawing? */
bool kms_visible(const struct kms *kms);
/* Size of what is drawn, px, before it is turned. */
void kms_size(const struct kms *kms, uint32_t *width, uint32_t *height);
/* How far whoever draws has to turn the picture. */
unsigned kms_turn_left(const struct kms *kms);
void kms_brightness(struct kms *kms, float level);

/* kms_dumb.c. The buffer to draw the next picture into, at the size of kms_size(); NULL: all are on screen or on their
 * way there. */
struct kms_dumb_buffer *kms_dumb_free(struct kms *kms);

/* kms_output.c. Finds `out`'s connector (config.connector, or the first that is connected, or the first), a CRTC (the
 * one that it has, when it has one) and a plane. Returns 0, or -ENODEV when the device has no connector. */
int kms_output_find(struct kms *kms, struct kms_output *out);
/* Asks the panel again: connected, modes. */
void kms_output_ask(struct kms *kms, struct kms_output *output);

/* kms_vt.c. `name`: a terminal's device; "none"; NULL or "auto": the terminal that is our input, else the active one.
 * Comes to the front, but not where a program was killed behind another terminal: then `away` is set until somebody
 * switches. Not being able to is a warning where the name is a terminal's, else a debug message. */
void kms_vt_open(struct kms_vt *vt, const char *name);
void kms_vt_close(struct kms_vt *vt);
enum kms_vt_change { KMS_VT_SAME, KMS_VT_LEAVING, KMS_VT_ENTERED };
/* What was asked for since the last call. After LEAVING, call kms_vt_leave() once the screen is let go. */
enum kms_vt_change kms_vt_poll(struct kms_vt *vt);
void kms_vt_leave(struct kms_vt *vt);

/* kms_hotplug.c */
void kms_hotplug_open(struct kms_hotplug *hotplug);
void kms_hotplug_close(struct kms_hotplug *hotplug);
/* True when the panel should be asked: the kernel said so, or without its messages every two seconds. */
bool kms_hotplug_poll(struct kms_hotplug *hotplug, int64_t now_ns);

/* kms_dim.c */
void kms_dim_open(struct kms *kms);
void kms_dim_close(struct kms *kms);
void kms_dim_set(struct kms *kms, float level);
/* For whoever has the screen next: full light by the device, and a backlight that is not off. */
void kms_dim_rest(struct kms *kms);
/* Puts the present level onto a device that may have forgotten it. */
void kms_dim_again(struct kms *kms);

#endif
