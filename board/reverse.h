/*
 * Reversing: the gear on CAN or the contact of the gear lever brings the camera's picture, with guide lines; forward
 * takes it away. A path of its own: it needs the screen and the camera, neither map nor package.
 *
 * The picture stays HOLD_NS after reverse was left, so that a lever on its way through R, or a contact that bounces,
 * does not make it flicker; not longer, because a driver who has put D wants the way ahead back at once. When the gear
 * is lost while backing (a silent bus), the picture stays, until something says forward: another gear, more than
 * FORWARD_MPS, or at most LOST_NS.
 *
 * A picture is shown only while it is live (camera_watch.h): at most 200 ms old when it is seen. Otherwise words say
 * what is wrong. Times are those of clock_now_ns(), or of the frames where the clock is simulated.
 */
#ifndef BLVD_BOARD_REVERSE_H
#define BLVD_BOARD_REVERSE_H

#include "board/camera_images.h"
#include "board/controls.h"
#include "board/options.h"
#include "board/profile.h"
#include "board/stats.h"
#include "nav/vehicle.h"
#include "platform/camera/camera_watch.h"
#include "render/reverse_view.h"

#define REVERSE_HOLD_NS INT64_C(300000000)
#define REVERSE_LOST_NS INT64_C(10000000000)
#define REVERSE_FORWARD_MPS (10.0 / 3.6)

struct reverse_input {
	int64_t now_ns;
	int64_t frames_to_clock_ns; /* what is added to times of `vehicle` */
	const struct vehicle *vehicle;
	const struct vehicle_state *state;
	const struct control_switch *line; /* the lever's contact */
	bool night;
	const char *note; /* a few words on the picture, NULL none */
};

struct reverse {
	const struct profile *profile;
	struct camera_device camera;
	struct reverse_view view;
	struct camera_images images;
	struct camera_watch watch;
	struct camera_frame frame; /* the newest; its memory is the camera's */
	bool has_frame, uploaded;
	bool warmed; /* the programs have been used */
	bool night;  /* of the last frame */
	bool simulated;
	bool engaged;                   /* the picture is wanted */
	bool was_reverse;               /* the last that was heard was reverse */
	int64_t edge_ns;                /* when reverse was put in */
	int64_t reverse_ns;             /* when it was last heard to be in */
	int64_t lost_ns;                /* since when nothing says anything; 0: something does */
	bool waiting;                   /* no picture yet since the edge */
	bool live;                      /* what was drawn is a live picture */
	int64_t drawn_for_ns, shown_ns; /* times of the frame being made, and of its picture */
	int64_t ahead_ns;               /* from the look at the inputs to the picture on the screen, as it was lately */
	enum watch_state watched;       /* what the watch says of the camera; logged when it changes */
	enum watch_state state;         /* what is drawn: the same, unless the picture got old meanwhile */
	struct camera_stats stats;
};

/* What the profile and --camera ask for. Returns 0, also without any camera (reverse_has_camera()); -ENOMEM; -EINVAL
 * (logged). `screen` and `profile` are borrowed. */
int reverse_open(struct reverse *reverse, const struct options *options, const struct profile *profile,
	const struct screen *screen, bool simulated, struct arena *arena);
/* Accepts a zeroed struct. While the screen is there. */
void reverse_close(struct reverse *reverse);
bool reverse_has_camera(const struct reverse *reverse);

/* Looks at everything; never waits. Returns whether reverse_draw() shall draw this frame instead of the map. */
bool reverse_update(struct reverse *reverse, const struct reverse_input *input);
/* A whole frame on the screen: the picture, or words. */
void reverse_draw(struct reverse *reverse, const struct reverse_input *input);
/* After drawing, before showing: whether the picture has become too old meanwhile. Then words have been drawn instead.
 */
bool reverse_outdated(struct reverse *reverse, int64_t now_ns);
/* What was drawn is seen since `now_ns`. */
void reverse_shown(struct reverse *reverse, int64_t now_ns);

void reverse_stats(const struct reverse *reverse, struct camera_stats *out);

#endif
