/*
 * The renderer as the main program and the tools see it: a package and a nav view in, a picture out. Needs a current GL
 * context of ES 3.0 (or the dummy back end). All memory comes from the arenas handed to renderer_init(); all GL objects
 * are made there; renderer_draw() allocates nothing.
 */
#ifndef BLVD_RENDER_FRAME_H
#define BLVD_RENDER_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "assets/pkg.h"
#include "nav/nav.h"
#include "platform/base/arena.h"
#include "render/camera.h"
#include "render/gfx.h"
#include "render/overlay.h"
#include "render/repr.h"
#include "render/screen.h"

struct renderer;

/* Zero takes the default. */
struct renderer_config {
	uint32_t width, height; /* of the picture; required */
	uint32_t samples;       /* per pixel; default 4, 1 is none */
	bool depth_16;          /* a depth buffer of 16 bits instead of 24 */
	uint64_t budget_bytes;  /* for all that the arena holds and everything on the GPU; the arena is cut to its part */
	uint64_t gpu_budget_bytes;   /* for everything on the GPU, without budget_bytes; default 512 MiB */
	uint64_t upload_slice_bytes; /* per frame, once drawing; default 4 MiB */
	const char *far_name;        /* of a representation (repr.h), or "auto"; default "full" */
	double tau_px;               /* what is stored with a larger error is drawn as geometry; 0: as it is */
	bool deterministic;          /* loading takes the same number of frames, whatever the machine's speed */
	enum repr_show show;         /* pictures for looking at what is far */
	const struct gfx_ops *gfx;   /* default gfx_gles3 */
	const struct screen *screen; /* what to draw into, shared with others and borrowed; NULL: one of its own */
	void (*(*get_proc)(const char *name))(void); /* display_get_proc, or NULL */
	bool overlay;                                /* route ribbon, labels, read-outs */
	struct overlay_config overlay_config;
	double fov_deg; /* vertical; default 45 (driver's eye); 10 to 120 */
	double far_m;   /* nothing is drawn beyond; default 6,000 */
	bool truth;     /* for measuring: makes what renderer_draw_truth() needs */
};

struct renderer_stats {
	uint64_t frames;
	uint32_t draws, triangles, far_triangles; /* of the last frame */
	const char *far_name;                     /* of the representation */
	bool far_fallback;                        /* something else stood in for what belongs to this place, last frame */
	bool far_late;                            /* because it was not loaded in time */
	uint64_t far_entered;                     /* stretches, since start */
	uint64_t far_damaged;                     /* stretches that cannot be read: all geometry stands in for them */
	double far_error_px;                      /* bound of displacement, last frame */
	uint64_t far_bytes;                       /* on the GPU, of the representation's own */
	uint64_t gpu_bytes, gpu_bytes_high_water;
	uint32_t chunks, chunks_resident, chunks_wanted_missing; /* missing ones were in view in the last frame */
	uint32_t chunks_damaged;                                 /* checksum or index range wrong: never drawn */
	uint64_t chunks_dropped;                                 /* uploads that found the pool full, since start */
	uint64_t chunks_evicted;
	uint64_t upload_pending_bytes; /* known to be wanted, not yet there */
	double night;                  /* 0 day to 1 night: how the last frame was lit */
	const char *gl_renderer;
	uint32_t samples;
};

/* Returns 0; -ENOMEM when an arena or the GPU budget is too small; -EFBIG when the package's own bound of what must be
 * resident for its cells is more than the budget leaves; -EINVAL when far_name is unknown or a shader does
 * not compile; -ENOTSUP when the context is too old. Logs one line on failure. `pkg` is borrowed until
 * renderer_finish(). */
int renderer_init(
	struct renderer **out, struct arena *city_arena, const struct renderer_config *config, const struct pkg *pkg);
/* Upper bound of what it takes from the arena. Where budget_bytes is given, it finds out itself, and better. */
uint64_t renderer_arena_bytes(const struct renderer_config *config, const struct pkg *pkg);
/* NULL does nothing. */
void renderer_finish(struct renderer *renderer);

/* What the light is like. */
struct renderer_time {
	int64_t time_ns;                     /* simulated or monotonic: drives the camera's springs and water */
	int64_t wall_ns;                     /* UTC since 1970: where the sun stands; 0: late morning in June */
	bool force_night;                    /* the driver asked for the night look */
	bool force_day;                      /* or for that of the day */
	double ambient;                      /* sensor, 0 dark to 1; negative: unknown, the sun alone decides */
	const char *message;                 /* shown to the driver, NULL none */
	const struct overlay_driver *driver; /* NULL: as configured, no menu */
};
void renderer_draw(struct renderer *renderer, const struct nav_view *nav, const struct renderer_time *time);

/* The same from an eye of the caller's choosing: for renderers that are compared on the same poses. */
void renderer_draw_from(struct renderer *renderer, const struct nav_view *nav, const struct camera_pose *pose,
	const struct renderer_time *time);

/* A still from an eye of the caller's choosing, without camera motion and overlay. */
void renderer_draw_pose(struct renderer *renderer, const struct camera_pose *pose, const struct renderer_time *time);

/* What renderer_draw_pose() shows, for measuring: per pixel, at its centre, the object + 1 and the place seen, metres
 * from the eye (x, y, z) as float bits; all 0 where nothing is. Rows from the top, width * height * 4 words. Wants
 * config.truth. The picture stays as it was. */
void renderer_draw_truth(
	struct renderer *renderer, const struct camera_pose *pose, const struct renderer_time *time, uint32_t *out);
/* The same of the last frame, whichever way it was drawn: from the draws that it was made of; not at the pixels'
 * centres but `at_px` from them, x right and y down. */
void renderer_read_truth(struct renderer *renderer, struct dvec2 at_px, uint32_t *out);

/* Turns of the knob. */
struct camera *renderer_camera(struct renderer *renderer);

/* Copies the picture to the context's window of the given size. */
void renderer_present(struct renderer *renderer, uint32_t width, uint32_t height);

/* RGBA8, top row first, width * height * 4 bytes. */
void renderer_read_pixels(struct renderer *renderer, uint8_t *out);

void renderer_stats(const struct renderer *renderer, struct renderer_stats *out);

#endif
