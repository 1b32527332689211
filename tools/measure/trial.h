/*
 * Representations against each other: on the same drive, in one process, frame by frame in turn, each compared with
 * `full`. Frames are cut into chunks; a chunk's files are written when it is done, one for each representation, so a
 * stopped run goes on where it was.
 */
#ifndef BLVD_TOOLS_MEASURE_TRIAL_H
#define BLVD_TOOLS_MEASURE_TRIAL_H

#include "tools/measure/entrant.h"
#include "tools/measure/trial_row.h"

#define TRIAL_ENTRANTS_MAX 8
#define TRIAL_CHUNK_FRAMES 50u

struct trial_config {
	const char *package, *log, *profile;
	const char *folder;                    /* made when it is not there; its parent must be */
	const char *names[TRIAL_ENTRANTS_MAX]; /* the first is "full" */
	uint32_t count;
	double tau_px;
	uint32_t width, height, samples, fps;
	uint32_t frames;       /* at most; 0: the whole drive */
	uint32_t every;        /* accuracy is measured on each such frame */
	uint32_t pictures;     /* compared frames written as PNG, evenly spread */
	uint64_t budget_bytes; /* of every representation but `full`; 0: the renderer's default */
	bool overlay;
	bool show_progress;
	const char *title; /* for the progress: "tau 1" */
};

/* A representation's own figures, before the first frame of the run. */
struct trial_entrant {
	char name[16];
	double start_ms, first_frame_ms; /* CPU time: making the renderer; the first picture, loading included */
	uint64_t cpu_bytes, gpu_bytes;   /* high-water marks */
};
struct trial_result {
	uint32_t count;
	struct trial_entrant entrants[TRIAL_ENTRANTS_MAX];
	struct trial_rows rows[TRIAL_ENTRANTS_MAX];
	char gl_renderer[96];
};

/* Runs what is missing and reads all of it. Returns 0; -EBADMSG when the package or the log is bad; -EEXIST when the
 * folder holds a run with other settings; other -errno. Logs one line. */
int trial_run(const struct trial_config *config, struct trial_result *out);
void trial_result_finish(struct trial_result *result);

#endif
