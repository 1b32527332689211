/*
 * Is what the camera gives a live picture? Looks at capture times, sequence numbers and digests. An old picture is
 * never live: FROZEN or MISSING is known at most WATCH_AGE_NS after the last true one, for a device that repeats its
 * picture with new numbers at most WATCH_REPEAT_NS. Pure: times come in.
 */
#ifndef BLVD_PLATFORM_CAMERA_CAMERA_WATCH_H
#define BLVD_PLATFORM_CAMERA_CAMERA_WATCH_H

#include "platform/camera/camera.h"

#define WATCH_AGE_NS INT64_C(200000000)    /* an older frame is not shown */
#define WATCH_REPEAT_NS INT64_C(400000000) /* the same picture for so long is no picture */
#define WATCH_START_NS INT64_C(500000000)  /* for its first frame after it was found */

enum watch_state {
	WATCH_STARTING, /* found, and not yet due */
	WATCH_LIVE,
	WATCH_FROZEN,  /* there, but its picture is old or repeated */
	WATCH_MISSING, /* not there, or it never gave a picture */
};

struct camera_watch {
	bool look_for_repeats; /* digests count; set by the owner */
	bool any;              /* a frame of this session has come */
	uint32_t session;
	uint32_t sequence, digest;
	int64_t frame_ns;   /* capture of the newest */
	int64_t changed_ns; /* capture of the first that looked like it */
	int64_t waiting_ns; /* since when there is nothing; 0 not waiting */
	uint64_t backwards; /* frames refused: time or number went back, or times of tomorrow */
};

/* A frame has come at `now_ns`. Returns whether it is a new picture. */
bool camera_watch_frame(struct camera_watch *watch, const struct camera_frame *frame, int64_t now_ns);

/* The state at `now_ns`, if what is shown now is seen `ahead_ns` later (drawing and the display take time). */
enum watch_state camera_watch_state(
	struct camera_watch *watch, enum camera_link link, int64_t now_ns, int64_t ahead_ns);

#endif
