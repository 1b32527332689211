/* The command line of boulevard. */
#ifndef BLVD_BOARD_OPTIONS_H
#define BLVD_BOARD_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "platform/base/geo.h"

#define OPTIONS_LIST_MAX 8

enum exit_code { EXIT_CODE_DONE = 0, EXIT_CODE_FAILED = 1, EXIT_CODE_USAGE = 2, EXIT_CODE_BAD_INPUT = 3 };

/* Zero, NULL or a negative number: not given; the profile or a default decides. Strings are borrowed from argv. */
struct options {
	const char *package;
	const char *replay;
	const char *can[OPTIONS_LIST_MAX];
	int can_count;
	const char *dbc[OPTIONS_LIST_MAX];
	int dbc_count;
	const char *gpio;   /* a chip, or "sim:" and a script */
	const char *camera; /* a device, or "sim" or "sim:" and a script */
	const char *profile;
	const char *display; /* "headless", "window", "kms" */
	const char *device;  /* after "kms:" */
	const char *mode;    /* "1280x720@60" */
	const char *far_name;
	const char *camera_view;     /* --view */
	const char *frames;          /* folder */
	const char *stats;           /* file */
	const char *record;          /* file */
	uint64_t record_limit_bytes; /* 0: default */
	const char *state;           /* folder */
	const char *gnss;            /* --gnss */
	uint32_t width, height;
	uint32_t fps;
	uint32_t every; /* >= 1 */
	uint64_t limit; /* 0: none */
	double tau_px;  /* 0: whatever the package was baked with */
	uint64_t budget_bytes;
	int samples; /* -1: profile */
	struct geo_point start;
	bool has_start, has_heading;
	double start_heading_deg;
	struct geo_point destination;
	bool has_destination;
	bool verbose;
};

/* Fills `out`; ends the program with status 2 and one line on stderr when the command line is wrong. */
void options_parse(struct options *out, int argc, char **argv);

#endif
