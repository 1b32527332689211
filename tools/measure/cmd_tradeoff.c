/* blvd tradeoff: speed against accuracy of representations, over a drive and for several tau. */
#include <argp.h>
#include <errno.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "render/repr.h"
#include "tools/commands.h"
#include "tools/measure/tau_package.h"
#include "tools/measure/tradeoff.h"

#define TAUS_MAX 12

struct tau_choice {
	double tau_px;
	const char *path;
};

struct tradeoff_options {
	const char *city, *output;
	struct trial_config trial;
	struct tau_choice taus[TAUS_MAX];
	unsigned tau_count, given_count;
	bool tau_asked, far_asked;
	struct tau_choice given[TAUS_MAX];
	bool quiet;
};

enum {
	KEY_REPLAY = 256,
	KEY_FAR,
	KEY_TAU,
	KEY_PACKAGE,
	KEY_SIZE,
	KEY_SAMPLES,
	KEY_FPS,
	KEY_FRAMES,
	KEY_EVERY,
	KEY_PICTURES,
	KEY_BUDGET,
	KEY_PROFILE,
	KEY_OVERLAY,
};

static const struct argp_option option_table[] = {
	{ "replay", KEY_REPLAY, "LOG.candump", 0, "the drive", 0 },
	{ "output", 'o', "DIR", 0, "where everything goes; a stopped run in it goes on", 0 },
	{ "far", KEY_FAR, "NAME,...", 0, "representations besides full; default: all that the package has", 0 },
	{ "tau", KEY_TAU, "PX,...", 0, "accuracies; a package is baked for each that has none", 0 },
	{ "package", KEY_PACKAGE, "TAU=FILE.blvd", 0, "the package of a tau; repeat", 0 },
	{ "size", KEY_SIZE, "WxH", 0, "pixels (1280x720)", 0 },
	{ "samples", KEY_SAMPLES, "N", 0, "a pixel: 1, 2, 4, 8 (1)", 0 },
	{ "fps", KEY_FPS, "N", 0, "frames of a second of the drive (10)", 0 },
	{ "frames", KEY_FRAMES, "N", 0, "at most so many; default: the whole drive", 0 },
	{ "every", KEY_EVERY, "N", 0, "measure accuracy on each Nth frame (50)", 0 },
	{ "pictures", KEY_PICTURES, "N", 0, "frames kept as pictures (6)", 0 },
	{ "budget", KEY_BUDGET, "MIB", 0,
		"memory of each representation but full, as boulevard's; default: as much as it uses", 0 },
	{ "profile", KEY_PROFILE, "FILE", 0, "names of the car's signals; default: the virtual car", 0 },
	{ "overlay", KEY_OVERLAY, NULL, 0, "draw the route, names and read-outs too", 0 },
	{ "quiet", 'q', NULL, 0, "no progress", 0 },
	{ 0 },
};

static uint32_t parse_count(const char *arg, uint32_t min, uint32_t max, struct argp_state *state)
{
	char *end;
	unsigned long value = strtoul(arg, &end, 10);
	if (end == arg || *end || *arg == '-' || value < min || value > max)
		argp_error(state, "'%s' is no number from %u to %u", arg, min, max);
	return (uint32_t)value;
}

static double parse_tau(const char *text, size_t length, struct argp_state *state)
{
	char *end;
	double tau = strtod(text, &end);
	if (end != text + length || !length || !(tau >= 1.0 / 16.0 && tau <= 64.0))
		argp_error(state, "'%.*s' is no tau from 1/16 to 64 px", (int)length, text);
	return tau;
}

static void parse_taus(struct tradeoff_options *options, const char *arg, struct argp_state *state)
{
	options->tau_asked = true;
	for (options->tau_count = 0; *arg; arg += *arg == ',') {
		size_t length = strcspn(arg, ",");
		if (options->tau_count == TAUS_MAX)
			argp_error(state, "more than %d tau", TAUS_MAX);
		options->taus[options->tau_count++].tau_px = parse_tau(arg, length, state);
		arg += length;
	}
}

static void parse_package(struct tradeoff_options *options, const char *arg, struct argp_state *state)
{
	size_t length = strcspn(arg, "=");
	if (!arg[length] || !arg[length + 1])
		argp_error(state, "--package wants TAU=FILE, not '%s'", arg);
	if (options->given_count == TAUS_MAX)
		argp_error(state, "more than %d packages", TAUS_MAX);
	options->given[options->given_count++] = (struct tau_choice){ parse_tau(arg, length, state), arg + length + 1 };
}

/* `full` is always there, and first. */
static void parse_names(struct tradeoff_options *options, char *arg, struct argp_state *state)
{
	options->far_asked = true;
	options->trial.count = 1;
	for (char *name = strsep(&arg, ","); name; name = strsep(&arg, ",")) {
		if (!strcmp(name, "auto") || !repr_by_name(name, NULL))
			argp_error(state, "no representation '%s'", name);
		bool again = false;
		for (uint32_t i = 0; i < options->trial.count; i++)
			again = again || !strcmp(options->trial.names[i], name);
		if (again)
			continue;
		if (options->trial.count == TRIAL_ENTRANTS_MAX)
			argp_error(state, "more than %d representations", TRIAL_ENTRANTS_MAX);
		options->trial.names[options->trial.count++] = name;
	}
}

static void parse_size(struct trial_config *config, const char *arg, struct argp_state *state)
{
	char end;
	if (sscanf(arg, "%ux%u%c", &config->width, &config->height, &end) != 2 || config->width - 64 > 8192 - 64 ||
		config->height - 64 > 8192 - 64)
		argp_error(state, "'%s' is no size from 64x64 to 8192x8192", arg);
}

static error_t parse_option(int key, char *arg, struct argp_state *state)
{
	struct tradeoff_options *options = state->input;
	struct trial_config *trial = &options->trial;
	switch (key) {
	case KEY_REPLAY:
		trial->log = arg;
		break;
	case 'o':
		options->output = arg;
		break;
	case KEY_FAR:
		parse_names(options, arg, state);
		break;
	case KEY_TAU:
		parse_taus(options, arg, state);
		break;
	case KEY_PACKAGE:
		parse_package(options, arg, state);
		break;
	case KEY_SIZE:
		parse_size(trial, arg, state);
		break;
	case KEY_SAMPLES:
		trial->samples = parse_count(arg, 1, 16, state);
		break;
	case KEY_FPS:
		trial->fps = parse_count(arg, 1, 240, state);
		break;
	case KEY_FRAMES:
		trial->frames = parse_count(arg, 1, 10000000, state);
		break;
	case KEY_EVERY:
		trial->every = parse_count(arg, 1, 1000000, state);
		break;
	case KEY_PICTURES:
		trial->pictures = parse_count(arg, 0, 1000, state);
		break;
	case KEY_BUDGET:
		trial->budget_bytes = (uint64_t)parse_count(arg, 4, 1 << 20, state) << 20;
		break;
	case KEY_PROFILE:
		trial->profile = arg;
		break;
	case KEY_OVERLAY:
		trial->overlay = true;
		break;
	case 'q':
		options->quiet = true;
		break;
	case ARGP_KEY_ARG:
		if (options->city)
			argp_error(state, "one city, please");
		options->city = arg;
		break;
	case ARGP_KEY_END:
		if (!options->city || !trial->log || !options->output)
			argp_error(state, "a city, --replay LOG.candump and -o DIR are needed");
		break;
	default:
		return ARGP_ERR_UNKNOWN;
	}
	return 0;
}

/* The city's own when no tau was asked for, or its own was. Otherwise the one given, or one that is made. */
static int settle_package(const struct tradeoff_options *options, const struct tau_choice *tau, double own_tau_px,
	char path[PATH_MAX], double *bake_seconds)
{
	const char *given = NULL;
	*bake_seconds = 0.0;
	for (unsigned i = 0; i < options->given_count; i++)
		given = options->given[i].tau_px == tau->tau_px ? options->given[i].path : given;
	if (given || !options->tau_asked || own_tau_px == tau->tau_px) {
		snprintf(path, PATH_MAX, "%s", given ? given : options->city);
		return 0;
	}
	if (snprintf(path, PATH_MAX, "%s/tau-%g.blvd", options->output, tau->tau_px) >= PATH_MAX)
		return -ENAMETOOLONG;
	return tau_package_make(options->city, options->trial.log, tau->tau_px, path, bake_seconds);
}

/* What is measured when nothing was asked for: what the city's package has. */
static void settle_names(struct tradeoff_options *options, bool far_field)
{
	static const char *const all[] = { "none", "pvs", "impostor" };
	for (size_t i = 0; i < (far_field ? 3 : 1) && !options->far_asked; i++)
		options->trial.names[options->trial.count++] = all[i];
}

/* Arguments as they were given, for whoever wants to do it again. */
static void join_arguments(int argc, char **argv, char *out, size_t size)
{
	size_t at = 0;
	for (int i = 0; i < argc && at < size; i++)
		at += (size_t)snprintf(out + at, size - at, "%s%s", i ? " " : "", argv[i]);
}

static int run_tau(
	const struct tradeoff_options *options, struct tradeoff *tradeoff, const struct tau_choice *tau, double own_tau_px)
{
	struct trial_config config = options->trial;
	char folder[PATH_MAX], title[32], path[PATH_MAX];
	snprintf(title, sizeof(title), "tau %g", tau->tau_px);
	if (snprintf(folder, sizeof(folder), "%s/tau-%g", options->output, tau->tau_px) >= (int)sizeof(folder))
		return -ENAMETOOLONG;
	struct tradeoff_run run = { .tau_px = tau->tau_px };
	double bake_seconds;
	int status = settle_package(options, tau, own_tau_px, path, &bake_seconds);
	if (status)
		return status;
	config.package = run.package = pool_string(&tradeoff->strings, path);
	config.tau_px = tau->tau_px;
	config.folder = folder;
	config.title = title;
	config.show_progress = !options->quiet && isatty(STDERR_FILENO);
	status = far_facts_read(&run.facts, path);
	run.facts.bake_seconds = bake_seconds;
	if (!status)
		status = trial_run(&config, &run.trial);
	ARRAY_PUSH(&tradeoff->runs, run);
	return status;
}

static int write_all(const struct tradeoff *tradeoff, const char *folder)
{
	static const struct {
		const char *name;
		int (*write)(const struct tradeoff *tradeoff, const char *path);
	} files[] = { { "settings.csv", tradeoff_write_csv }, { "summary.json", tradeoff_write_json },
		{ "table.md", tradeoff_write_table } };
	char path[PATH_MAX];
	int status = 0;
	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]) && !status; i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, files[i].name);
		status = files[i].write(tradeoff, path);
	}
	snprintf(path, sizeof(path), "%s/index.html", folder);
	return status ? status : tradeoff_write_page(tradeoff, folder, path);
}

/* Without --tau: the packages given, or else the city's own. */
static void settle_taus(struct tradeoff_options *options, double own_tau_px)
{
	if (options->tau_count)
		return;
	memcpy(options->taus, options->given, sizeof(options->taus));
	options->tau_count = options->given_count;
	if (!options->tau_count)
		options->taus[options->tau_count++].tau_px = own_tau_px > 0.0 ? own_tau_px : 1.0;
}

static int run_all(struct tradeoff_options *options, struct tradeoff *tradeoff)
{
	double own_tau_px = tau_package_tau(options->city);
	if (own_tau_px < 0.0)
		return -EBADMSG;
	settle_taus(options, own_tau_px);
	settle_names(options, own_tau_px > 0.0 || options->given_count || options->tau_asked);
	if (mkdir(options->output, 0777) < 0 && errno != EEXIST) {
		int status = -errno;
		log_error("%s: %s", options->output, strerror(-status));
		return status;
	}
	int status = 0;
	for (unsigned i = 0; i < options->tau_count && !status; i++)
		status = run_tau(options, tradeoff, &options->taus[i], own_tau_px);
	if (status)
		return status;
	tradeoff_sum_up(tradeoff);
	status = write_all(tradeoff, options->output);
	if (!status)
		printf("%s/index.html\n", options->output);
	return status;
}

int cmd_tradeoff(int argc, char **argv)
{
	static const struct argp argp = { option_table, parse_option, "CITY.blvd",
		"Draws a drive with several representations in turn and tells what each costs and how much it differs from "
		"`full`: "
		"pictures, displacement, holes, popping. Writes CSV, JSON, a table and a page.",
		NULL, NULL, NULL };
	struct tradeoff_options options = { .trial = { .names = { "full" },
											.count = 1,
											.width = 1280,
											.height = 720,
											.samples = 1,
											.fps = 10,
											.every = 50,
											.pictures = 6 } };
	char command[4096];
	join_arguments(argc, argv, command, sizeof(command));
	argp_parse(&argp, argc, argv, 0, NULL, &options);
	struct tradeoff tradeoff = { .config = &options.trial, .command = command };
	int status = run_all(&options, &tradeoff);
	tradeoff_finish(&tradeoff);
	return !status ? EXIT_DONE : status == -EBADMSG ? EXIT_BAD_INPUT : status == -EEXIST ? EXIT_USAGE : EXIT_FAILED;
}
