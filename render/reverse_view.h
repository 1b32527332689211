/*
 * The reversing picture, and words in its place when there is none. Needs a screen and nothing else: no package, no
 * font, no map. All GL objects are made at reverse_view_init() for the largest picture that may come; nothing grows.
 *
 * Per frame: reverse_view_upload() when a new frame has come, then reverse_view_draw() or reverse_view_notice(), each a
 * whole frame with its pass, ready for screen_present().
 */
#ifndef BLVD_RENDER_REVERSE_VIEW_H
#define BLVD_RENDER_REVERSE_VIEW_H

#include "platform/camera/camera.h"
#include "render/guide.h"
#include "render/screen.h"

struct reverse_view_config {
	uint32_t width, height; /* the most that a frame may have */
	struct guide_config guide;
};

enum reverse_view_layout { /* which program draws it */
	REVERSE_VIEW_PLANES,
	REVERSE_VIEW_PACKED,
	REVERSE_VIEW_SWAPPED,
	REVERSE_VIEW_RGB,
	REVERSE_VIEW_EXTERNAL, /* a buffer of the device itself; where the GPU can */
	REVERSE_VIEW_LAYOUTS,
};

struct reverse_view {
	struct reverse_view_config config;
	const struct screen *screen;
	struct gfx *gfx;
	struct canvas canvas;
	gfx_program programs[REVERSE_VIEW_LAYOUTS];
	gfx_pipeline pipelines[REVERSE_VIEW_LAYOUTS];
	gfx_texture one, two, four; /* of so many bytes a texel */
	gfx_texture external;       /* the owner's, of the frame that was shown last */
	bool any;                   /* a frame has been uploaded */
	enum reverse_view_layout layout;
	struct camera_frame frame; /* its sizes and colours; the planes may be gone */
};

/* Returns 0, -ENOMEM, -EINVAL (shader). `screen` is borrowed. */
int reverse_view_init(struct reverse_view *view, struct arena *arena, const struct screen *screen,
	const struct reverse_view_config *config);
/* Accepts a zeroed view. */
void reverse_view_finish(struct reverse_view *view);

/* Returns false, and nothing changes, for a frame that is larger than was agreed. */
bool reverse_view_upload(struct reverse_view *view, const struct camera_frame *frame);

/* The same without a copy: `texture` is gfx_texture_import()'s of the frame's buffer, and its owner's. */
void reverse_view_use(struct reverse_view *view, const struct camera_frame *frame, gfx_texture texture);
/* Its owner destroys textures that were used: no frame is left. */
void reverse_view_forget(struct reverse_view *view);

struct reverse_view_state {
	bool night;
	bool angle_known; /* of the road wheels */
	double angle_rad; /* clockwise positive */
	const char *note; /* a few words at the bottom, NULL none */
};

/* The frame that was uploaded last, with guide lines. */
void reverse_view_draw(struct reverse_view *view, const struct reverse_view_state *state);
/* No picture: what is wrong in large letters, and what to do about it. */
void reverse_view_notice(struct reverse_view *view, const char *title, const char *text, bool warning, bool night);

#endif
