#include "board/options.h"

#include <argp.h>
#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *argp_program_version = "boulevard " BLVD_VERSION;

enum {
	OPT_REPLAY = 256,
	OPT_CAN,
	OPT_CAMERA,
	OPT_GPIO,
	OPT_DBC,
	OPT_HEADLESS,
	OPT_SIZE,
	OPT_FPS,
	OPT_DISPLAY,
	OPT_MODE,
	OPT_PROFILE,
	OPT_FAR,
	OPT_TAU,
	OPT_BUDGET,
	OPT_FRAMES,
	OPT_EVERY,
	OPT_LIMIT,
	OPT_STATS,
	OPT_RECORD,
	OPT_RECORD_LIMIT,
	OPT_START,
	OPT_DESTINATION,
	OPT_VIEW,
	OPT_SAMPLES,
	OPT_STATE,
	OPT_GNSS,
};

static const struct argp_option option_table[] = {
	{ "replay", OPT_REPLAY, "LOG.candump", 0, "replay a log; with --headless the clock is simulated", 0 },
	{ "can", OPT_CAN, "INTERFACE", 0, "read a CAN interface; repeat for more", 0 },
	{ "camera", OPT_CAMERA, "DEVICE", 0, "reversing camera: /dev/video0, sim or sim:SCRIPT, none", 0 },
	{ "gpio", OPT_GPIO, "CHIP", 0, "chip of the profile's lines; sim:FILE plays a script instead", 0 },
	{ "headless", OPT_HEADLESS, NULL, 0, "the same as --display headless: no display, no GPU, no root", 0 },
	{ "display", OPT_DISPLAY, "NAME", 0, "window, headless or kms[:DEVICE]", 0 },
	{ "mode", OPT_MODE, "WxH[@HZ]", 0, "mode of a panel; default the one that it prefers", 0 },
	{ "size", OPT_SIZE, "WxH", 0, "picture size in pixels", 0 },
	{ "fps", OPT_FPS, "N", 0, "frames a second", 0 },
	{ "profile", OPT_PROFILE, "FILE", 0, "board profile; options override it", 0 },
	{ "dbc", OPT_DBC, "FILE", 0, "signal definitions; repeat for more", 0 },
	{ "far", OPT_FAR, "NAME", 0, "representation of what is far: auto, full, none, pvs, impostor", 0 },
	{ "tau", OPT_TAU, "PX", 0,
		"draw as geometry what the package stores with a larger error than this, where it has both", 0 },
	{ "budget", OPT_BUDGET, "MIB", 0, "memory budget; default from the profile", 0 },
	{ "frames", OPT_FRAMES, "DIR", 0, "write frames as PNG", 0 },
	{ "every", OPT_EVERY, "N", 0, "write every Nth frame only", 0 },
	{ "limit", OPT_LIMIT, "N", 0, "stop after N frames", 0 },
	{ "stats", OPT_STATS, "FILE", 0, "write stats as JSON at the end and on SIGUSR1", 0 },
	{ "record", OPT_RECORD, "FILE", 0, "write the frames read from CAN as a candump log", 0 },
	{ "record-limit", OPT_RECORD_LIMIT, "MIB", 0, "keep the newest of the recording; default 1024, all of a replay",
		0 },
	{ "gnss", OPT_GNSS, "SOURCE", 0, "a receiver beside the bus: gpsd, gpsd:HOST:PORT, or a log of gpspipe -w", 0 },
	{ "state", OPT_STATE, "DIR", 0, "keep the last position there; default $STATE_DIRECTORY, but not with --replay",
		0 },
	{ "start", OPT_START, "LAT,LON[,HEADING]", 0, "where the drive starts, degrees", 0 },
	{ "to", OPT_DESTINATION, "LAT,LON", 0, "destination", 0 },
	{ "view", OPT_VIEW, "NAME", 0, "camera at start: driver, chase, heading-up, north-up", 0 },
	{ "samples", OPT_SAMPLES, "N", 0, "samples a pixel: 0 (off), 2, 4, 8", 0 },
	{ "verbose", 'v', NULL, 0, "log more", 0 },
	{ 0 },
};

static uint64_t parse_count(const char *what, const char *text, uint64_t low, uint64_t high, struct argp_state *state)
{
	char *end;
	errno = 0;
	unsigned long long value = strtoull(text, &end, 10);
	if (errno || end == text || *end || text[0] == '-' || value < low || value > high)
		argp_error(state, "%s wants a whole number from %llu to %llu, not '%s'", what, (unsigned long long)low,
			(unsigned long long)high, text);
	return value;
}

static void parse_size(struct options *out, const char *text, struct argp_state *state)
{
	char extra;
	if (sscanf(text, "%ux%u%c", &out->width, &out->height, &extra) != 2 || out->width < 64 || out->height < 64 ||
		out->width > 16384 || out->height > 16384)
		argp_error(state, "--size wants WIDTHxHEIGHT from 64x64 to 16384x16384, not '%s'", text);
}

static void parse_place(const char *what, const char *text, struct geo_point *out, double *heading, bool *has_heading,
	struct argp_state *state)
{
	char extra;
	double angle;
	int fields = sscanf(text, "%lf,%lf%c", &out->lat_deg, &out->lon_deg, &extra);
	if (heading && fields == 3 && sscanf(text, "%*f,%*f,%lf%c", &angle, &extra) == 1 && isfinite(angle)) {
		*heading = angle;
		*has_heading = true;
		fields = 2;
	}
	if (fields != 2 || !(fabs(out->lat_deg) <= 90.0) || !(fabs(out->lon_deg) <= 360.0))
		argp_error(state, "%s wants LATITUDE,LONGITUDE in degrees, not '%s'", what, text);
}

static void list_add(const char **list, int *count, const char *what, const char *value, struct argp_state *state)
{
	if (*count == OPTIONS_LIST_MAX)
		argp_error(state, "%s more than %d times", what, OPTIONS_LIST_MAX);
	list[(*count)++] = value;
}

static double parse_tau(const char *text, struct argp_state *state)
{
	char *end;
	double tau = strtod(text, &end);
	if (end == text || *end || !(tau >= 1.0 / 16.0 && tau <= 64.0))
		argp_error(state, "--tau wants pixels from 0.0625 to 64, not '%s'", text);
	return tau;
}

/* "kms:/dev/dri/card1" */
static void parse_display(struct options *out, char *value)
{
	char *device = strchr(value, ':');
	out->display = value;
	out->device = device ? device + 1 : NULL;
	if (device)
		*device = 0;
}

static void check_display(const struct options *out, struct argp_state *state)
{
	static const char *const names[] = { "headless", "window", "kms" };
	bool known = false;
	if (!out->display)
		return;
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]) && !known; i++)
		known = !strcmp(out->display, names[i]);
	if (!known)
		argp_error(state, "no display called '%s': window, headless or kms", out->display);
	if (out->device && (strcmp(out->display, "kms") != 0 || !*out->device))
		argp_error(state, "only kms takes a device: kms:/dev/dri/card0");
}

static error_t parse_input(int key, char *value, struct options *out, struct argp_state *state)
{
	switch (key) {
	case OPT_REPLAY:
		out->replay = value;
		return 0;
	case OPT_CAN:
		list_add(out->can, &out->can_count, "--can", value, state);
		return 0;
	case OPT_CAMERA:
		out->camera = value;
		return 0;
	case OPT_GPIO:
		out->gpio = value;
		return 0;
	case OPT_DBC:
		list_add(out->dbc, &out->dbc_count, "--dbc", value, state);
		return 0;
	case OPT_PROFILE:
		out->profile = value;
		return 0;
	case OPT_START:
		parse_place("--start", value, &out->start, &out->start_heading_deg, &out->has_heading, state);
		out->has_start = true;
		return 0;
	case OPT_DESTINATION:
		parse_place("--to", value, &out->destination, NULL, NULL, state);
		out->has_destination = true;
		return 0;
	case ARGP_KEY_ARG:
		if (out->package)
			argp_error(state, "one city package, please");
		out->package = value;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static error_t parse_picture(int key, char *value, struct options *out, struct argp_state *state)
{
	switch (key) {
	case OPT_HEADLESS:
		out->display = "headless";
		return 0;
	case OPT_DISPLAY:
		parse_display(out, value);
		return 0;
	case OPT_MODE:
		out->mode = value;
		return 0;
	case OPT_SIZE:
		parse_size(out, value, state);
		return 0;
	case OPT_FPS:
		out->fps = (uint32_t)parse_count("--fps", value, 1, 240, state);
		return 0;
	case OPT_FAR:
		out->far_name = value;
		return 0;
	case OPT_TAU:
		out->tau_px = parse_tau(value, state);
		return 0;
	case OPT_BUDGET:
		out->budget_bytes = parse_count("--budget", value, 4, 4096, state) << 20;
		return 0;
	case OPT_VIEW:
		out->camera_view = value;
		return 0;
	case OPT_SAMPLES:
		out->samples = (int)parse_count("--samples", value, 0, 16, state);
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static error_t parse_output(int key, char *value, struct options *out, struct argp_state *state)
{
	switch (key) {
	case OPT_FRAMES:
		out->frames = value;
		return 0;
	case OPT_EVERY:
		out->every = (uint32_t)parse_count("--every", value, 1, 1000000, state);
		return 0;
	case OPT_LIMIT:
		out->limit = parse_count("--limit", value, 1, UINT32_MAX, state);
		return 0;
	case OPT_STATS:
		out->stats = value;
		return 0;
	case OPT_RECORD:
		out->record = value;
		return 0;
	case OPT_RECORD_LIMIT:
		out->record_limit_bytes = parse_count("--record-limit", value, 1, UINT32_MAX, state) << 20;
		return 0;
	case OPT_GNSS:
		out->gnss = value;
		return 0;
	case OPT_STATE:
		out->state = value;
		return 0;
	case 'v':
		out->verbose = true;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static void check_whole(const struct options *out, struct argp_state *state)
{
	if (!out->package)
		argp_error(state, "no city package");
	if (out->replay && out->can_count)
		argp_error(state, "--replay and --can exclude each other");
	check_display(out, state);
}

static error_t parse_option(int key, char *value, struct argp_state *state)
{
	struct options *out = state->input;
	assert(out);
	if (key == ARGP_KEY_END) {
		check_whole(out, state);
		return 0;
	}
	error_t status = parse_input(key, value, out, state);
	if (status == ARGP_ERR_UNKNOWN)
		status = parse_picture(key, value, out, state);
	if (status == ARGP_ERR_UNKNOWN)
		status = parse_output(key, value, out, state);
	return status;
}

void options_parse(struct options *out, int argc, char **argv)
{
	static const struct argp parser = {
		.options = option_table,
		.parser = parse_option,
		.args_doc = "CITY.blvd",
		.doc = "Draws the city from the driver's street.\vExit status: 0 done, 1 failed while running, 2 wrong usage, "
			   "3 bad input file.",
	};
	*out = (struct options){ .every = 1, .samples = -1 };
	argp_err_exit_status = EXIT_CODE_USAGE;
	argp_parse(&parser, argc, argv, 0, NULL, out);
}
