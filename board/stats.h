/*
 * What a run measured, and its JSON. Samples go into histograms of fixed size, so a run of any length costs the same
 * memory; a quantile is exact to one part in 64.
 */
#ifndef BLVD_BOARD_STATS_H
#define BLVD_BOARD_STATS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "nav/vehicle.h"
#include "platform/can/can_bus.h"
#include "platform/display/display.h"

#define HISTOGRAM_STEPS 128 /* per factor of two */
#define HISTOGRAM_OCTAVES 40

struct histogram {
	uint32_t bins[HISTOGRAM_OCTAVES * HISTOGRAM_STEPS];
	uint64_t count;
	uint64_t max;
};

void histogram_add(struct histogram *histogram, uint64_t value);

/* The smallest value that at least a share `quantile` (0 to 1] of the samples does not exceed; 0 without samples. */
uint64_t histogram_quantile(const struct histogram *histogram, double quantile);

/* The reversing camera (board/reverse.h). */
struct camera_stats {
	bool configured;
	char format[48];
	uint64_t frames, bad, skipped; /* taken from the device; never shown; lost before us */
	uint64_t sessions;             /* times that it was opened */
	uint64_t reversed;             /* times that reverse was put in */
	uint64_t shown;                /* live pictures on the screen */
	uint64_t copied, in_place;     /* pictures that came to the GPU by a copy, as buffers of the device */
	uint64_t frozen, missing;      /* times that it became so */
	uint64_t too_old;              /* pictures older than 200 ms when they were seen */
	uint64_t withdrawn;            /* that became so before they were shown, and were not */
	int64_t decode_ns_max;
	struct histogram age_ns;  /* of pictures when they were seen */
	struct histogram edge_ns; /* from reverse put in to the first live picture on the screen */
};

/* What the driver's hands did, and what that made of the settings. */
struct control_stats {
	bool configured;  /* there are lines or devices */
	uint64_t edges;   /* of lines */
	uint64_t resyncs; /* levels read because edges may have been lost, and once for each line at the start */
	uint64_t losses;  /* times that a line was lost */
	uint64_t actions, dropped;
	const char *fault; /* in words, NULL none */
	const char *view;
	double zoom;
	bool menu_open, reverse, ignition;
};

/* A stretch of the start: processor time of all threads, and time that passed. */
struct start_phase {
	const char *name;
	double cpu_ms, wall_ms;
};
#define START_PHASES_MAX 8

struct stats {
	struct histogram frame_ns, triangles, far_triangles, draws;
	uint64_t frames;
	const char *renderer; /* GL's name; borrowed */
	const char *far_name;
	uint32_t width, height;
	uint32_t samples;
	double tau_px;
	uint64_t cells_entered;                 /* stretches of the far field; directed edges without one */
	uint64_t late_frames;                   /* took longer than a frame may */
	uint64_t fallback_frames;               /* something else stood in for what belongs to the place */
	uint64_t late_cell_frames;              /* because it was not loaded in time */
	uint64_t damaged_chunks, damaged_cells; /* found so far; the picture goes without them */
	double far_error_px;                    /* largest bound of a far point's displacement */
	uint64_t budget_bytes, cpu_high_water_bytes, gpu_high_water_bytes, allocations_after_start;
	double first_frame_ms;
	struct start_phase start_phases[START_PHASES_MAX];
	uint32_t start_phase_count;
	const char *display; /* its name; borrowed */
	char display_detail[64];
	struct display_counts display_counts;
	uint64_t can_frames_in, can_frames_bad;
	uint32_t signal_faults[VEHICLE_INPUT_COUNT][VEHICLE_FAULT_COUNT]; /* samples that were not taken, and why */
	uint64_t can_frames_lost;                                         /* by the kernel, before we read them */
	double can_cpu_ms;                                                /* of the thread that reads the bus */
	const struct can_interface *can_interfaces;                       /* borrowed */
	unsigned can_interface_count;
	uint64_t record_lines, record_lost;
	int64_t stale_ns_max;
	uint64_t reroutes, off_street_frames;
	struct camera_stats camera;
	struct control_stats controls;
};

/* The phase that ends now; `began_ns` is when the process did, clock_now_ns(). */
void stats_phase(struct stats *stats, const char *name, int64_t began_ns);

void stats_print_json(const struct stats *stats, FILE *to);

/* Whole or not at all. Returns 0 or -errno. */
int stats_write(const struct stats *stats, const char *path);

#endif
