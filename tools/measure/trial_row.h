/*
 * One frame of one representation, as measured, and files of them. A file is written whole or not at all, so a run that
 * was stopped goes on with the first file that is missing.
 */
#ifndef BLVD_TOOLS_MEASURE_TRIAL_ROW_H
#define BLVD_TOOLS_MEASURE_TRIAL_ROW_H

#include "tools/city/pool.h"
#include "tools/measure/displacement.h"
#include "tools/measure/popping.h"

enum trial_place {
	TRIAL_OFF,     /* in no cell: the package has none here, the car is off its streets, or something stood in */
	TRIAL_INSIDE,  /* in the same cell as in the frame before */
	TRIAL_CHANGE,  /* the first frame in another cell */
	TRIAL_SETTLING /* soon after: the dissolve */
};

struct trial_row {
	uint32_t frame;
	uint32_t half;    /* half-edge, or PKG_NONE */
	uint32_t stretch; /* or PKG_NONE */
	uint32_t place;   /* enum trial_place */
	uint32_t triangles, far_triangles, draws;
	uint64_t gpu_bytes;
	bool fallback;   /* something else stood in for what belongs there ... */
	bool late;       /* ... because it was not loaded in time */
	double error_px; /* bound of the displacement, as the representation knows it */
	bool popping_known;
	struct popping_frame popping;
	/* only on sampled frames: against `full` */
	bool compared;
	double psnr_db, ssim, flip, precision, recall, precision_2, recall_2;
	uint64_t pixels, drawn, uncovered, cracks; /* tools/measure/holes.h */
	struct displacement_count displacement;
	/* what depends on the machine stands last */
	double cpu_ms, wall_ms;
};
struct trial_rows {
	ARRAY(struct trial_row) rows;
};

/* Returns 0 or -errno; logs one line. */
int trial_rows_write(const struct trial_rows *rows, const char *path);
/* Adds a file's rows. Returns 0, -ENOENT without a word, or -EBADMSG after logging the file and line. */
int trial_rows_read(struct trial_rows *rows, const char *path);

#endif
