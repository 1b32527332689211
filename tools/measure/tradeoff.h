/*
 * Speed against accuracy: what rows of trials (trial.h) come to for each setting, and how it is told: as CSV, JSON, a
 * table of what was asked against what was measured, and a page with plots. A setting is a representation at a tau.
 */
#ifndef BLVD_TOOLS_MEASURE_TRADEOFF_H
#define BLVD_TOOLS_MEASURE_TRADEOFF_H

#include <stdio.h>

#include "tools/measure/trial.h"

/* Of a set of numbers; all 0 without any. */
struct spread {
	double median, p95, p99, p999, max, mean;
};
/* Sorts `values`. A quantile is the smallest value that at least this share of them does not exceed. */
struct spread spread_of(double *values, size_t count);

/* What a package is, whoever draws it. */
struct far_facts {
	uint64_t triangles;                /* of the whole city */
	uint64_t package_bytes, far_bytes; /* the file; what of it is the far field */
	uint64_t resident_bound_bytes;     /* what the package says it needs at most */
	double street_km;
	uint32_t directed_edges;  /* with a far field */
	double edge_bytes_median; /* of these: the cell's impostors, half of what is shared with the other direction */
	double edge_bytes_mean;
	uint32_t cells, impostor_cells, geometry_cells, relaxed_cells;
	struct spread cell_triangles; /* of cells with an impostor */
	double bake_seconds;          /* of the far field; 0: not known */
};
/* Returns 0 or -EBADMSG after logging one line. */
int far_facts_read(struct far_facts *facts, const char *package);

struct setting {
	char name[16];
	double tau_px;
	uint32_t frames, compared;
	struct spread cpu_ms, wall_ms;
	double speed_up; /* median of `full` in the same run by this one's, by CPU time */
	double speed_up_wall;
	double speed_up_pvs; /* over `pvs`, of the frames where `pvs` draws something far; 0: not measured */
	struct spread triangles, far_triangles, draws;
	double start_ms, first_frame_ms;
	uint64_t resident_bytes; /* GPU and CPU, without what only measuring needs */
	double psnr_db, ssim, flip, precision, recall, precision_2, recall_2; /* means */
	double psnr_db_worst, ssim_worst, flip_worst;
	struct displacement_count displacement;
	double uncovered_mean, uncovered_worst; /* shares of the picture */
	uint64_t cracks;
	uint32_t fallback_frames, late_frames, cell_changes;
	/* of frames' rms, L* */
	double popping_inside_p99, popping_change_max, popping_settling_max;
	double popping_ratio; /* the larger of the last two by the first; 0: no changes or nothing to compare with */
	bool pareto;          /* no other setting is as fast and shows less FLIP, or shows as little and is faster */
};

/* One package: a tau, all representations in one run. */
struct tradeoff_run {
	double tau_px;
	const char *package;
	struct far_facts facts;
	struct trial_result trial;
};
struct tradeoff {
	const struct trial_config *config; /* what all runs have in common */
	const char *command;               /* that makes it */
	ARRAY(struct tradeoff_run) runs;
	ARRAY(struct setting) settings;
	struct pool strings;
};
void tradeoff_finish(struct tradeoff *tradeoff);

/* Fills settings from the runs; those of a representation that does not depend on tau come from the first run only. */
void tradeoff_sum_up(struct tradeoff *tradeoff);

/* NULL when there is none. tau_px < 0: any. */
const struct setting *tradeoff_find(const struct tradeoff *tradeoff, const char *name, double tau_px);

/* Which setting to use: the most accurate of those whose median frame takes at most this long, or that need at most
 * this much memory; the fastest of those whose mean FLIP is at most this. NULL: none. */
const struct setting *tradeoff_within_ms(const struct tradeoff *tradeoff, double cpu_ms);
const struct setting *tradeoff_within_flip(const struct tradeoff *tradeoff, double flip);
const struct setting *tradeoff_within_bytes(const struct tradeoff *tradeoff, uint64_t bytes);

/* Each writes a file whole or not at all. Return 0 or -errno after logging one line. */
int tradeoff_write_csv(const struct tradeoff *tradeoff, const char *path);
int tradeoff_write_json(const struct tradeoff *tradeoff, const char *path);
int tradeoff_write_table(const struct tradeoff *tradeoff, const char *path);                    /* Markdown */
int tradeoff_write_page(const struct tradeoff *tradeoff, const char *folder, const char *path); /* HTML */

/* A row of the table. */
struct judged_row {
	char what[120], published[80], asked[80], measured[160];
};
#define JUDGED_ROWS_MAX 16
/* Returns how many. */
unsigned tradeoff_judge(const struct tradeoff *tradeoff, struct judged_row rows[JUDGED_ROWS_MAX]);

/* A file that appears under its name only when it is whole. */
struct new_file {
	FILE *file;
	char path[4096], part[4096];
};
int new_file_open(struct new_file *file, const char *path);
int new_file_close(struct new_file *file, int status);

#endif
