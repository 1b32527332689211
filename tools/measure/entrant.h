/*
 * One of several renderers in one process, each with a GL context, memory and a representation of its own, which draw
 * the same frames in turn.
 */
#ifndef BLVD_TOOLS_MEASURE_ENTRANT_H
#define BLVD_TOOLS_MEASURE_ENTRANT_H

#include "platform/display/display.h"
#include "tools/measure/popping.h"
#include "tools/measure/replay.h"
#include "tools/measure/truth_image.h"

struct entrant_config {
	const char *name; /* of the representation */
	double tau_px;
	uint32_t width, height, samples;
	uint64_t budget_bytes; /* of all its memory, as boulevard's; 0: the renderer's default */
	bool overlay;          /* draw the route, names and read-outs too */
	bool truth;            /* entrant_read_truth() will be called: takes memory that a renderer does not need */
};

struct entrant {
	struct entrant_config config;
	const struct pkg *pkg;
	struct display display;
	struct arena arena;
	struct renderer *renderer;
	uint8_t *pixels;           /* RGBA8 of the last frame */
	struct truth_pixel *truth; /* of the last entrant_read_truth() */
	float *lightness;          /* of the last frame, by entrant_see() */
	struct popping popping;
	double start_ms;        /* CPU time of making the renderer */
	double cpu_ms, wall_ms; /* of the last frame: all threads' time, and the time that went by */
};

/* Returns 0 or -errno after logging one line. */
int entrant_open(struct entrant *entrant, const struct pkg *pkg, const struct entrant_config *config);
/* A zeroed entrant does nothing. */
void entrant_close(struct entrant *entrant);

/* Draws and reads back. Returns 0 or -EIO. */
int entrant_draw(struct entrant *entrant, const struct replay_frame *frame);
/* What is seen where in the frame just drawn, into entrant->truth; `at_px` from the pixels' centres. Returns 0 or
 * -EIO. */
int entrant_read_truth(struct entrant *entrant, struct dvec2 at_px);
/* Fills `lightness` from `pixels`; `work` has room for as many. */
void entrant_see(struct entrant *entrant, float *work);

#endif
