/* blvd drive: arguments, files, and the order of the steps. */
#include <argp.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "platform/base/log.h"
#include "tools/commands.h"
#include "tools/drive/drive.h"
#include "tools/drive/drive_arguments.h"

#define NS_PER_MINUTE INT64_C(60000000000)

enum {
	KEY_VIA = 256,
	KEY_SEED,
	KEY_MINUTES,
	KEY_GNSS,
	KEY_START,
	KEY_TRUTH,
	KEY_DATE,
	KEY_TIME,
	KEY_SPEED_ERROR,
	KEY_YAW_BIAS
};

struct arguments {
	struct drive_options drive;
	const char *package, *output, *truth;
	int year, month, day, hour, minute;
};

static const struct argp_option option_list[] = {
	{ "output", 'o', "LOG.candump", 0, "where to write the log; - is standard output", 0 },
	{ "via", KEY_VIA, "LAT,LON", 0, "drive there; up to 8 times, the last one is the destination", 0 },
	{ "start", KEY_START, "LAT,LON", 0, "start there; default: the seed chooses", 0 },
	{ "seed", KEY_SEED, "N", 0, "chooses the tour, signals and errors; default 1", 0 },
	{ "minutes", KEY_MINUTES, "M", 0, "end after M minutes; default 5 without --via", 0 },
	{ "gnss", KEY_GNSS, NULL, 0, "satellite fixes all along, with noise and gaps; default: before setting off alone",
		0 },
	{ "date", KEY_DATE, "YYYY-MM-DD", 0, "default 2024-06-21", 0 },
	{ "time", KEY_TIME, "HH:MM", 0, "local time at the start; default 10:00", 0 },
	{ "speed-error", KEY_SPEED_ERROR, "PERCENT", 0, "the speed signal says that much more; default: the seed's", 0 },
	{ "yaw-bias", KEY_YAW_BIAS, "DEG/S", 0, "of the yaw rate signal, clockwise; default: the seed's", 0 },
	{ "truth", KEY_TRUTH, "FILE.csv", 0, "where the car really was, 20 times a second", 0 },
	{ 0 },
};

static void parse_date(const char *text, struct arguments *out, struct argp_state *state)
{
	int used = 0;
	if (sscanf(text, "%4d-%2d-%2d%n", &out->year, &out->month, &out->day, &used) != 3 || text[used] ||
		out->year < 1970 || out->month < 1 || out->month > 12 || out->day < 1 || out->day > 31)
		argp_error(state, "'%s' is no date YYYY-MM-DD", text);
}

static void parse_time(const char *text, struct arguments *out, struct argp_state *state)
{
	int used = 0;
	if (sscanf(text, "%2d:%2d%n", &out->hour, &out->minute, &used) != 2 || text[used] || out->hour < 0 ||
		out->hour > 23 || out->minute < 0 || out->minute > 59)
		argp_error(state, "'%s' is no time HH:MM", text);
}

static error_t parse_option(int key, char *arg, struct argp_state *state)
{
	struct arguments *arguments = state->input;
	struct drive_options *drive = &arguments->drive;
	switch (key) {
	case 'o':
		arguments->output = arg;
		break;
	case KEY_VIA:
		if (drive->via_count == DESTINATION_STOPS_MAX)
			argp_error(state, "at most %d times --via", DESTINATION_STOPS_MAX);
		drive->via[drive->via_count++] = argument_place(arg, state);
		break;
	case KEY_START:
		drive->start = argument_place(arg, state);
		drive->has_start = true;
		break;
	case KEY_SEED:
		drive->seed = argument_seed(arg, state);
		break;
	case KEY_MINUTES:
		drive->minutes = argument_number(arg, 0.2, 600.0, state);
		break;
	case KEY_GNSS:
		drive->gnss = true;
		break;
	case KEY_TRUTH:
		arguments->truth = arg;
		break;
	case KEY_DATE:
		parse_date(arg, arguments, state);
		break;
	case KEY_TIME:
		parse_time(arg, arguments, state);
		break;
	case KEY_SPEED_ERROR:
		drive->speed_error = argument_number(arg, -20.0, 20.0, state) * 0.01;
		break;
	case KEY_YAW_BIAS:
		drive->yaw_bias_rps = argument_number(arg, -5.0, 5.0, state) * (BLVD_PI / 180.0);
		break;
	case ARGP_KEY_ARG:
		if (arguments->package)
			argp_error(state, "one package, please");
		arguments->package = arg;
		break;
	case ARGP_KEY_END:
		if (!arguments->package || !arguments->output)
			argp_error(state, "a package and -o LOG.candump are needed");
		break;
	default:
		return ARGP_ERR_UNKNOWN;
	}
	return 0;
}

static int64_t start_wall_ns(const struct arguments *arguments, const struct pkg *pkg)
{
	struct tm tm = { .tm_year = arguments->year - 1900,
		.tm_mon = arguments->month - 1,
		.tm_mday = arguments->day,
		.tm_hour = arguments->hour,
		.tm_min = arguments->minute };
	return (int64_t)timegm(&tm) * INT64_C(1000000000) - (int32_t)pkg->meta->utc_offset_minutes * NS_PER_MINUTE;
}

/* --- output files: under their final name only when whole --- */

struct out_file {
	const char *path;
	char *part;
	int fd;
};

static int out_open(struct out_file *file, const char *path)
{
	*file = (struct out_file){ .path = path, .fd = STDOUT_FILENO };
	if (!strcmp(path, "-"))
		return 0;
	if (asprintf(&file->part, "%s.part", path) < 0)
		abort();
	file->fd = open(file->part, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
	if (file->fd < 0) {
		log_error("%s: %s", path, strerror(errno));
		free(file->part);
		file->part = NULL;
		return -1;
	}
	return 0;
}

static int out_close(struct out_file *file, bool good)
{
	if (!file->part)
		return 0;
	int err = close(file->fd);
	if (good && !err)
		err = rename(file->part, file->path);
	if (err)
		log_error("%s: %s", file->path, strerror(errno));
	if (!good || err)
		unlink(file->part);
	free(file->part);
	return err;
}

/* --- the drive --- */

static int write_files(const struct arguments *arguments, const struct drive *drive, struct drive_motion *motion)
{
	struct out_file log, truth = { 0 };
	if (out_open(&log, arguments->output))
		return EXIT_FAILED;
	FILE *truth_stream = NULL;
	if (arguments->truth) {
		if (out_open(&truth, arguments->truth)) {
			out_close(&log, false);
			return EXIT_FAILED;
		}
		truth_stream = fdopen(dup(truth.fd), "w");
	}
	int err = bus_write(drive, motion, log.fd, truth_stream);
	if (err)
		log_error("%s: %s", arguments->output, strerror(-err));
	if (truth_stream && fclose(truth_stream)) {
		log_error("%s: %s", arguments->truth, strerror(errno));
		err = -EIO;
	}
	int bad = out_close(&log, !err);
	if (arguments->truth)
		bad |= out_close(&truth, !err);
	return err || bad ? EXIT_FAILED : EXIT_DONE;
}

static int drive_package(struct arguments *arguments, const struct pkg *pkg, struct arena *arena)
{
	struct drive drive;
	struct drive_path path = { 0 };
	struct drive_motion motion = { 0 };
	arguments->drive.wall_ns = start_wall_ns(arguments, pkg);
	if (drive_init(&drive, arena, pkg, &arguments->drive)) {
		log_error("%s: %s", arguments->package, strerror(ENOMEM));
		return EXIT_FAILED;
	}
	int status = EXIT_FAILED;
	if (drive_plan(&drive, &path, &motion) == 0)
		status = write_files(arguments, &drive, &motion);
	if (status == EXIT_DONE)
		log_info("%.2f km, %.1f minutes, %u streets, %u stops", (double)path.points.count * DRIVE_STEP_M * 1e-3,
			motion.end_s / 60.0, drive.route.count, drive.stop_count);
	motion_finish(&motion);
	path_finish(&path);
	return status;
}

int cmd_drive(int argc, char **argv)
{
	static const struct argp argp = { option_list, parse_option, "CITY.blvd",
		"Drives a route through a city and writes what the car's bus would say, as a candump log.", NULL, NULL, NULL };
	struct arguments arguments = {
		.drive = { .seed = 1, .speed_error = NAN, .yaw_bias_rps = NAN },
		.year = 2024,
		.month = 6,
		.day = 21,
		.hour = 10,
	};
	if (argp_parse(&argp, argc, argv, 0, NULL, &arguments))
		return EXIT_USAGE;
	if (!arguments.drive.minutes && !arguments.drive.via_count)
		arguments.drive.minutes = 5.0;
	struct pkg pkg;
	struct pkg_fault fault;
	int err = pkg_open(&pkg, arguments.package, &fault);
	if (err) {
		if (err == -EBADMSG)
			log_error("%s: %s (byte %llu)", arguments.package, fault.text, (unsigned long long)fault.offset);
		else
			log_error("%s: %s", arguments.package, strerror(-err));
		return EXIT_BAD_INPUT;
	}
	int status = EXIT_BAD_INPUT;
	size_t bytes = drive_bytes(&pkg.graph);
	uint8_t *memory = malloc(bytes);
	if (!memory)
		abort();
	struct arena arena;
	arena_init(&arena, "drive", memory, bytes);
	if (!pkg.graph.edge_count)
		log_error("%s: no streets", arguments.package);
	else
		status = drive_package(&arguments, &pkg, &arena);
	free(memory);
	pkg_close(&pkg);
	return status;
}
