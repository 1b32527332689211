/* blvd shot: a still picture of a package from any pose. */
#include <argp.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "assets/pkg.h"
#include "board/png_write.h"
#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/display/display.h"
#include "render/frame.h"
#include "tools/commands.h"

struct shot {
	const char *package, *output;
	double east_m, north_m, height_m, heading_deg, pitch_deg;
	bool posed;
	struct renderer_config config;
	int camera; /* -1: the pose is the eye's; else the car's */
	int year, month, day, hour, minute;
	bool timed;
	bool stats;
	int repeat;
};

enum {
	OPT_POSE = 256,
	OPT_FOV,
	OPT_SIZE,
	OPT_TIME,
	OPT_DATE,
	OPT_SAMPLES,
	OPT_DEPTH,
	OPT_CAMERA,
	OPT_FAR,
	OPT_TAU,
	OPT_SHOW,
	OPT_BUDGET,
	OPT_STATS,
	OPT_REPEAT
};

static const struct argp_option options[] = {
	{ "pose", OPT_POSE, "E,N,UP,HEADING,PITCH", 0,
		"Eye: metres east and north of the city's origin, metres above ground, degrees clockwise from north, degrees "
		"up",
		0 },
	{ "fov", OPT_FOV, "DEG", 0, "Vertical field of view (45)", 0 },
	{ "size", OPT_SIZE, "WxH", 0, "Pixels (1280x720)", 0 },
	{ "time", OPT_TIME, "HH:MM", 0, "Time of day, local mean time (10:00)", 0 },
	{ "date", OPT_DATE, "YYYY-MM-DD", 0, "Day (2024-06-21)", 0 },
	{ "samples", OPT_SAMPLES, "N", 0, "Samples a pixel: 1, 2, 4, 8 (4)", 0 },
	{ "depth", OPT_DEPTH, "BITS", 0, "Of the depth buffer: 16 or 24 (24)", 0 },
	{ "camera", OPT_CAMERA, "KIND", 0, "The pose is a car's; look by driver, chase, heading-up or north-up", 0 },
	{ "far", OPT_FAR, "NAME", 0, "Representation of the distance: auto, full, none, pvs, impostor (full)", 0 },
	{ "tau", OPT_TAU, "PX", 0, "Draw as geometry what is stored with a larger error (none)", 0 },
	{ "show", OPT_SHOW, "WHAT", 0, "far: tints the distance; wire: and draws its triangles' edges", 0 },
	{ "budget", OPT_BUDGET, "MIB", 0, "GPU memory (512)", 0 },
	{ "stats", OPT_STATS, 0, 0, "Print what was drawn", 0 },
	{ "repeat", OPT_REPEAT, "N", 0, "Draw it N times and print the median frame time", 0 },
	{ "output", 'o', "FILE.png", 0, "Picture to write", 0 },
	{ 0 },
};

static void parse_or_die(bool ok, struct argp_state *state, const char *what, const char *arg)
{
	if (!ok)
		argp_error(state, "%s: not understood: '%s'", what, arg);
}

static error_t parse(int key, char *arg, struct argp_state *state)
{
	struct shot *shot = state->input;
	char end = 0;
	switch (key) {
	case OPT_POSE:
		shot->posed = sscanf(arg, "%lf,%lf,%lf,%lf,%lf%c", &shot->east_m, &shot->north_m, &shot->height_m,
						  &shot->heading_deg, &shot->pitch_deg, &end) == 5;
		parse_or_die(shot->posed, state, "--pose", arg);
		return 0;
	case OPT_FOV:
		parse_or_die(sscanf(arg, "%lf%c", &shot->config.fov_deg, &end) == 1, state, "--fov", arg);
		return 0;
	case OPT_SIZE:
		parse_or_die(sscanf(arg, "%ux%u%c", &shot->config.width, &shot->config.height, &end) == 2 &&
						 shot->config.width - 1 < 8192 && shot->config.height - 1 < 8192,
			state, "--size", arg);
		return 0;
	case OPT_TIME:
		parse_or_die(sscanf(arg, "%d:%d%c", &shot->hour, &shot->minute, &end) == 2 && shot->hour >= 0 &&
						 shot->hour < 24 && shot->minute >= 0 && shot->minute < 60,
			state, "--time", arg);
		shot->timed = true;
		return 0;
	case OPT_DATE:
		parse_or_die(sscanf(arg, "%d-%d-%d%c", &shot->year, &shot->month, &shot->day, &end) == 3 && shot->month >= 1 &&
						 shot->month <= 12 && shot->day >= 1 && shot->day <= 31 && shot->year > 1900 &&
						 shot->year < 2100,
			state, "--date", arg);
		shot->timed = true;
		return 0;
	case OPT_SAMPLES:
		parse_or_die(sscanf(arg, "%u%c", &shot->config.samples, &end) == 1, state, "--samples", arg);
		return 0;
	case OPT_DEPTH:
		shot->config.depth_16 = !strcmp(arg, "16");
		parse_or_die(!strcmp(arg, "16") || !strcmp(arg, "24"), state, "--depth", arg);
		return 0;
	case OPT_CAMERA:
		shot->camera = camera_from_name(arg);
		parse_or_die(shot->camera >= 0, state, "--camera", arg);
		return 0;
	case OPT_FAR:
		shot->config.far_name = arg;
		return 0;
	case OPT_TAU:
		parse_or_die(
			sscanf(arg, "%lf%c", &shot->config.tau_px, &end) == 1 && shot->config.tau_px > 0.0, state, "--tau", arg);
		return 0;
	case OPT_SHOW:
		shot->config.show = !strcmp(arg, "far") ? REPR_SHOW_FAR : REPR_SHOW_WIRE;
		parse_or_die(!strcmp(arg, "far") || !strcmp(arg, "wire"), state, "--show", arg);
		return 0;
	case OPT_BUDGET:
		shot->config.gpu_budget_bytes = strtoull(arg, NULL, 10) << 20;
		return 0;
	case OPT_STATS:
		shot->stats = true;
		return 0;
	case OPT_REPEAT:
		parse_or_die(sscanf(arg, "%d%c", &shot->repeat, &end) == 1 && shot->repeat > 0, state, "--repeat", arg);
		return 0;
	case 'o':
		shot->output = arg;
		return 0;
	case ARGP_KEY_ARG:
		if (shot->package)
			return ARGP_ERR_UNKNOWN;
		shot->package = arg;
		return 0;
	case ARGP_KEY_END:
		if (!shot->package || !shot->output)
			argp_error(state, "a package and -o FILE.png are needed");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

/* Local mean time of the place to UTC. */
static struct renderer_time time_of(const struct shot *shot, const struct pkg *pkg)
{
	struct renderer_time time = { .time_ns = NS_PER_S, .ambient = -1.0 };
	if (!shot->timed)
		return time;
	struct tm tm = { .tm_year = shot->year - 1900,
		.tm_mon = shot->month - 1,
		.tm_mday = shot->day,
		.tm_hour = shot->hour,
		.tm_min = shot->minute };
	time.wall_ns = ((int64_t)timegm(&tm) - llrint(pkg->meta->origin_lon_deg * 240.0)) * NS_PER_S;
	return time;
}

static void draw(const struct shot *shot, const struct pkg *pkg, struct renderer *renderer)
{
	int64_t at_mm[3] = { llrint(shot->east_m * 1e3), llrint(shot->north_m * 1e3), 0 };
	at_mm[2] = pkg_ground_mm(pkg, at_mm[0], at_mm[1]) + llrint(shot->height_m * 1e3);
	struct renderer_time time = time_of(shot, pkg);
	if (!shot->posed) {
		struct camera_pose opening = renderer_camera(renderer)->pose;
		renderer_draw_pose(renderer, &opening, &time);
		return;
	}
	double heading = shot->heading_deg * (BLVD_PI / 180.0);
	if (shot->camera < 0) {
		struct camera_pose pose = { { at_mm[0], at_mm[1], at_mm[2] }, heading, shot->pitch_deg * (BLVD_PI / 180.0),
			0.0 };
		renderer_draw_pose(renderer, &pose, &time);
		return;
	}
	struct nav_view nav = { .located = true,
		.time_ns = time.time_ns,
		.heading_bam = bam_from_rad(heading),
		.half = PKG_NONE,
		.pos_mm = { at_mm[0], at_mm[1], at_mm[2] } };
	renderer_camera(renderer)->kind = (enum camera_kind)shot->camera;
	renderer_draw(renderer, &nav, &time);
}

static int by_value(const void *a, const void *b)
{
	int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
	return (x > y) - (x < y);
}

static void time_frames(const struct shot *shot, const struct pkg *pkg, struct renderer *renderer, uint8_t *pixels)
{
	int64_t *ns = calloc((size_t)shot->repeat, sizeof(*ns));
	if (!ns)
		return;
	int64_t cpu_ns = clock_cpu_ns();
	for (int i = 0; i < shot->repeat; i++) {
		int64_t start = clock_now_ns();
		draw(shot, pkg, renderer);
		renderer_read_pixels(renderer, pixels);
		ns[i] = clock_now_ns() - start;
	}
	cpu_ns = (clock_cpu_ns() - cpu_ns) / shot->repeat;
	qsort(ns, (size_t)shot->repeat, sizeof(*ns), by_value);
	printf("frame median %.2f ms, fastest %.2f ms, CPU %.2f ms, of %d\n", (double)ns[shot->repeat / 2] * 1e-6,
		(double)ns[0] * 1e-6, (double)cpu_ns * 1e-6, shot->repeat);
	free(ns);
}

static void print_stats(const struct renderer *renderer)
{
	struct renderer_stats stats;
	renderer_stats(renderer, &stats);
	printf("%s, %u samples\n%u draws, %u triangles (%u far), %u of %u chunks resident, %u damaged, %u missing\n"
		   "%s%s: error at most %.2f px, %.1f MiB\nGPU %.1f MiB, at most %.1f MiB\n",
		stats.gl_renderer, stats.samples, stats.draws, stats.triangles, stats.far_triangles, stats.chunks_resident,
		stats.chunks, stats.chunks_damaged, stats.chunks_wanted_missing, stats.far_name,
		stats.far_fallback ? " (something stands in)" : "", stats.far_error_px, (double)stats.far_bytes / 1048576.0,
		(double)stats.gpu_bytes / 1048576.0, (double)stats.gpu_bytes_high_water / 1048576.0);
}

static int shoot(struct shot *shot, const struct pkg *pkg, struct arena *arena)
{
	struct display display;
	struct display_config display_config = { .width = shot->config.width, .height = shot->config.height };
	if (display_open(&display, &display_surfaceless, &display_config))
		return EXIT_FAILED;
	struct renderer *renderer;
	int status = EXIT_FAILED;
	shot->config.get_proc = display_get_proc;
	uint8_t *pixels = malloc((size_t)shot->config.width * shot->config.height * 4);
	if (pixels && !renderer_init(&renderer, arena, &shot->config, pkg)) {
		draw(shot, pkg, renderer);
		renderer_read_pixels(renderer, pixels);
		if (shot->repeat)
			time_frames(shot, pkg, renderer, pixels);
		if (!png_write(shot->output, pixels, shot->config.width, shot->config.height))
			status = EXIT_DONE;
		if (shot->stats)
			print_stats(renderer);
		renderer_finish(renderer);
	}
	free(pixels);
	display_close(&display);
	return status;
}

int cmd_shot(int argc, char **argv)
{
	struct shot shot = {
		.camera = -1, .year = 2024, .month = 6, .day = 21, .hour = 10, .config = { .width = 1280, .height = 720 }
	};
	static const struct argp argp = { options, parse, "CITY.blvd -o FILE.png",
		"A still picture of a city from any pose.", NULL, NULL, NULL };
	argp_parse(&argp, argc, argv, 0, NULL, &shot);
	struct pkg pkg;
	struct pkg_fault fault = { 0 };
	int err = pkg_open(&pkg, shot.package, &fault);
	if (err) {
		log_error("%s: %s", shot.package, err == -EBADMSG ? fault.text : strerror(-err));
		return EXIT_BAD_INPUT;
	}
	size_t bytes = (size_t)256 << 20;
	void *memory = malloc(bytes);
	int status = EXIT_FAILED;
	if (memory) {
		struct arena arena;
		arena_init(&arena, "shot", memory, bytes);
		status = shoot(&shot, &pkg, &arena);
	}
	free(memory);
	pkg_close(&pkg);
	return status;
}
