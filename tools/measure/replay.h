/*
 * A recorded drive as frames: what the runtime would hand its renderer at a fixed rate, and the driver's eye, without
 * drawing anything. The same log, package and rate give the same frames, as `boulevard --replay --headless` does. It
 * begins where the car's position is known.
 */
#ifndef BLVD_TOOLS_MEASURE_REPLAY_H
#define BLVD_TOOLS_MEASURE_REPLAY_H

#include "assets/pkg.h"
#include "nav/nav_view.h"
#include "render/camera.h"
#include "render/frame.h"

struct replay_config {
	const char *log;     /* candump */
	const char *profile; /* NULL: the virtual car */
	uint32_t fps;
};

struct replay_frame {
	uint32_t number; /* from 0 at the start of the log: the first ones may be left out */
	struct nav_view nav;
	struct camera_pose pose;
	struct renderer_time time;
};

struct replay;

/* Returns 0 or -errno after logging one line. `pkg` and the strings are borrowed. */
int replay_open(struct replay **out, const struct pkg *pkg, const struct replay_config *config);
/* NULL does nothing. */
void replay_close(struct replay *replay);

/* The next frame with a position; false at the end of the log. */
bool replay_next(struct replay *replay, struct replay_frame *out);

#endif
